//! How many postures, and under which of the cell's loads, a time beside the robot is spent on.

use crate::error::{Error, Result};
use crate::findings::minutes;
use crate::model::cell::{Cell, MeasuringTime};
use crate::model::load::{Load, LoadCase};
use crate::model::observation::PostureTerms;
use crate::numerics::control::Control;
use crate::numerics::order::sort_by_number;
use crate::plan::check::{both_loads, springs_left_out};
use crate::plan::index::Index;
use crate::plan::index::prediction::PredictionModel;
use crate::plan::select::{GlobalOptions, MOST_POSTURES, select};
use crate::units::STANDARD_GRAVITY;
use serde::{Deserialize, Serialize};

/// With more loads than these, each alone and those up to each are weighed, not every choice of some.
const MOST_LOADS: usize = 3;
/// Rounds of the search for each way.
const ROUNDS: u64 = 1;

/// What one way to load the arm gives in a time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InTime {
    /// Names of the load cases that every posture is measured under; empty under the one load of the cell.
    pub loads: Vec<String>,
    /// Mass of a weight that is hung in every posture as well, of which the cell knows nothing \[kg\]; `null` without.
    pub further_mass_kg: Option<f64>,
    /// Postures.
    pub postures: usize,
    /// What they take \[s\].
    pub time_s: f64,
    /// The index prediction of the best found in one round, for the work of the whole cell \[m\].
    pub prediction: f64,
}

/// The cell under the loads that are best in `seconds`, how many postures there are for them, and what each way gives,
/// the best first. Under another index than prediction all loads are taken, and nothing is weighed.
///
/// # Errors
/// Too little time for a posture, or too much; as [`select`].
pub(super) fn in_time(
    cell: Cell,
    index: Index,
    seconds: f64,
    global: &GlobalOptions,
    control: Control<'_>,
) -> Result<(Cell, usize, Vec<InTime>)> {
    let within = |load: &Load| cell.time.postures_within(seconds, load);
    let all = within(&cell.setup.load);
    let ways = if index == Index::Prediction { ways(&cell) } else { Vec::new() };
    let most = ways.iter().map(|way| within(&way.cell.setup.load));
    let most = most.chain([all]).max().unwrap_or(all);
    if most == 0 {
        return Err(too_short(&cell.time, seconds, &cell.setup.load));
    }
    if most > MOST_POSTURES {
        let message = format!("{} would do for {most} postures.", minutes(seconds));
        let hint = format!("a plan has {MOST_POSTURES} at most: give less time");
        return Err(Error::invalid(message).hint(hint));
    }
    let options = GlobalOptions { rounds: Some(global.rounds.unwrap_or(ROUNDS).min(ROUNDS)), ..global.clone() };
    let model = (ways.len() > 1).then(|| PredictionModel::of_cell(&cell)).transpose()?;
    let mut candidates: Vec<(InTime, Loading)> = Vec::new();
    for way in ways {
        let (Some(model), load) = (&model, &way.cell.setup.load) else {
            continue;
        };
        let postures = within(load);
        if postures == 0 {
            continue;
        }
        control.check()?;
        // What cannot determine every joint, or finds nothing, is no way.
        let best = select(&way.cell, index, postures, &options, control.quiet());
        let Some(prediction) = best.ok().and_then(|best| value(model, &way.cell, &best.group)) else {
            continue;
        };
        // The load of a cell that has one has no name, and neither has what would be beside it.
        let named = load.cases().iter().filter(|_| way.further_mass_kg.is_none());
        let choice = InTime {
            loads: named.map(|case| case.name.clone()).collect(),
            further_mass_kg: way.further_mass_kg,
            postures,
            time_s: cell.time.of(postures, load),
            prediction,
        };
        candidates.push((choice, way));
    }
    sort_by_number(&mut candidates, |(choice, _)| choice.prediction);
    let chosen = candidates.iter().find(|(_, way)| way.further_mass_kg.is_none());
    let (chosen, postures) = match chosen {
        Some((choice, way)) => (way.cell.clone(), choice.postures),
        None if all == 0 => return Err(too_short(&cell.time, seconds, &cell.setup.load)),
        None => (cell, all),
    };
    let choices = candidates.into_iter().map(|(choice, _)| choice).collect();
    Ok((chosen, postures, choices))
}

/// A way to load the arm.
struct Loading {
    /// The cell under these loads alone.
    cell: Cell,
    further_mass_kg: Option<f64>,
}

/// The ways to load the arm that determine what all loads of the cell determine: choices of its load cases, in their
/// order; or its only load, alone and with a weight as heavy as it pulls.
fn ways(cell: &Cell) -> Vec<Loading> {
    let under = |load: Load, further_mass_kg: Option<f64>| {
        let mut cell = cell.clone();
        cell.setup.load = load;
        Loading { cell, further_mass_kg }
    };
    let cases = cell.setup.load.cases();
    let count = cases.len();
    let choices: Vec<Vec<usize>> = if count <= MOST_LOADS {
        let some = |set: usize| (0..count).filter(|i| set >> i & 1 == 1).collect();
        (1..1 << count).map(some).collect()
    } else {
        let alone = (0..count).map(|i| vec![i]);
        alone.chain((2..=count).map(|up_to| (0..up_to).collect())).collect()
    };
    let chosen = |choice: &Vec<usize>| -> Vec<LoadCase> { choice.iter().map(|i| cases[*i].clone()).collect() };
    let mut ways: Vec<Loading> = choices.iter().map(|choice| under(Load::Cases(chosen(choice)), None)).collect();
    if cases.is_empty() {
        ways.push(under(cell.setup.load.clone(), None));
        let pull = match &cell.setup.load {
            Load::Rope { magnitude, .. } => Some(magnitude.abs()),
            Load::Constant { wrench, .. } => Some(wrench.force.norm()),
            _ => None,
        };
        ways.extend(pull.map(|pull| {
            let weight = cell.setup.under_weight(pull).load;
            let both = both_loads(&cell.setup.load, &weight);
            under(both, Some(pull / STANDARD_GRAVITY))
        }));
    }
    ways.retain(|way| springs_left_out(&way.cell).is_empty());
    ways
}

/// What postures of a way are worth for the work of the whole cell \[m\].
fn value(model: &PredictionModel, under: &Cell, postures: &[Vec<f64>]) -> Option<f64> {
    let cases = under.setup.cases();
    let terms = |q: &Vec<f64>| -> Option<Vec<PostureTerms>> {
        let each = cases.iter().map(|setup| PostureTerms::new(setup, q, None).ok());
        each.collect()
    };
    let terms: Option<Vec<Vec<PostureTerms>>> = postures.iter().map(terms).collect();
    model.value(&terms?)
}

fn too_short(time: &MeasuringTime, seconds: f64, load: &Load) -> Error {
    let message = format!(
        "In {} no posture can be measured: one takes {} under the loads of this cell.",
        minutes(seconds),
        minutes(time.of(1, load))
    );
    Error::invalid(message).hint("give more time, or what measuring takes in your cell: [time]")
}
