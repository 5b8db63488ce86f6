//! What the experiment shows beside the stiffness: load states, single postures, extra terms, the next posture.

use super::joints::Joints;
use super::story::angles;
use super::{counted, shown};
use crate::identified::{influence_figure, load_states_figure};
use crate::summary::{Block, DataTable, Number, Quantity, Section, Text};
use stiffarm::ask::identify::Identified;
use stiffarm::estimate::diagnose::PooledStates;
use stiffarm::estimate::next_posture::NextPosture;
use stiffarm::findings::{list, visible};

/// Extra terms that the table shows.
const SHOWN_TERMS: usize = 5;

/// Linearity and hysteresis.
pub(super) fn states(identified: &Identified) -> Option<Section> {
    let states = identified.diagnosis.as_ref()?.load_states.as_ref()?;
    let mut table = DataTable::new(
        "Load states of all postures together",
        ["what", "found", "standard error", "probability by chance [%]"],
    );
    let mut row = |name: &str, pooled: Option<&PooledStates>, is_length: bool| {
        let Some(pooled) = pooled else { return };
        let shown =
            |number: Number| Text::from(number.of(if is_length { Quantity::LENGTH } else { Quantity::PERCENT }));
        let chance = Number::new(pooled.p_value).of(Quantity::PERCENT.bare());
        table.row(name, [shown(Number::new(pooled.value)), shown(Number::new(pooled.standard_error)), chance.into()]);
    };
    row("offset at zero load (lost motion)", states.offset.as_ref(), true);
    row("curvature (softens where positive)", states.curvature.as_ref(), false);
    row("loop, down minus up (hysteresis)", states.hysteresis.as_ref(), true);
    let blocks = vec![Block::Figure(load_states_figure(states)), Block::Table(table)];
    Some(Section::new("load-states", "Loads going up and down", blocks))
}

/// Torque and displacement of each joint.
pub(super) fn signals(identified: &Identified) -> Option<Section> {
    let signals = &identified.diagnosis.as_ref()?.signals;
    let names = signals.iter().map(|s| visible(&s.name).into_owned());
    let table = DataTable::of("Torque on each joint, and what its compliance moves", "joint", names)
        .numbers("torque RMS", Quantity::TORQUE, |j| Some(Number::new(signals[j].torque_rms_nm)))
        .numbers("displacement RMS", Quantity::LENGTH, |j| Some(Number::new(signals[j].displacement_rms_m)))
        .numbers("displacement / residual", Quantity::RATIO, |j| Some(Number::new(signals[j].to_residual)));
    let title = "What each joint carries";
    Some(Section::new("signals", title, vec![Block::Table(table)]))
}

/// What hangs on single postures.
pub(super) fn influence(identified: &Identified) -> Option<Section> {
    let influence = identified.diagnosis.as_ref()?.influence.as_ref()?;
    let mut blocks = vec![Block::Figure(influence_figure(influence))];
    let needed = influence.postures.iter().filter(|p| !p.lost.is_empty());
    let needed: Vec<Text> = needed
        .map(|p| {
            let lost = shown(&p.lost);
            Text::new(format!("Only posture {} shows {}.", visible(&p.posture), list(&lost)))
        })
        .collect();
    if !needed.is_empty() {
        blocks.push(Block::List(needed));
    }
    Some(Section::new("influence", "What hangs on single postures", blocks))
}

/// Extra terms by how well the postures predict each other with them.
pub(super) fn terms(identified: &Identified) -> Option<Section> {
    let trials = identified.diagnosis.as_ref()?.terms.as_ref()?;
    // The first row is the model without any of them.
    let names = trials.trials.iter().take(SHOWN_TERMS);
    let names = names.map(|trial| visible(&trial.name).into_owned());
    let trial = |row: usize| Some(&trials.trials[row.checked_sub(1)?]);
    let names = ["none".to_string()].into_iter().chain(names);
    let table = DataTable::of("Each posture predicted from the others, with each extra term alone", "term", names)
        .numbers("leave-one-out RMS", Quantity::LENGTH, |row| {
            Some(Number::new(match trial(row) {
                Some(trial) => trial.rms_m,
                None => trials.rms_m,
            }))
        })
        .numbers("change", Quantity::PERCENT, |row| Some(Number::computed(trial(row)?.ratio? - 1.0)))
        .words("estimate", |row| {
            trial(row)
                .map(|trial| {
                    let (Some(v), Some(e)) = (trial.value, trial.standard_error) else {
                        return Text::default();
                    };
                    let gap = |v: f64| Number::computed(v).of(Quantity::GAP);
                    if trial.term.is_spring() && v > 0.0 {
                        Text::from(Number::computed(1.0 / v).of(Quantity::STIFFNESS))
                            .words(" ")
                            .number(Number::computed(e / v).of(Quantity::PERCENT).plus_minus())
                    } else if trial.term.is_spring() {
                        "negative".into()
                    } else {
                        Text::from(gap(v).bare()).words(" ").number(gap(e).plus_minus())
                    }
                })
                .unwrap_or_default()
        })
        .words("then not determined", |row| {
            let lost = trial(row).map(|trial| shown(&trial.lost_joints));
            lost.unwrap_or_default().join(", ").into()
        });
    let title = "Extra terms";
    let section = Section::new("terms", title, vec![Block::Table(table)]);
    (!trials.trials.is_empty()).then_some(section)
}

/// The next posture, and what it would give.
pub(super) fn next_step(joints: &Joints<'_>, identified: &Identified) -> Option<Section> {
    let title = "The next posture";
    let Some(advice) = &identified.next_posture else {
        let reason = identified.next_posture_missing.as_ref()?;
        let text = Text::new(format!("None can be given: {}", visible(reason)));
        return Some(Section::new("next", title, vec![Block::Text(text)]));
    };
    let text = angles(Text::new("q = "), &advice.angles).words(format!(
        ", measured as posture {} was, {} at the same points and in the same load states; noise as in this fit.",
        visible(&advice.measured_as),
        counted(advice.displacements, "displacement")
    ));
    let mut blocks = vec![Block::Text(text)];
    blocks.extend(assumed_load(advice).map(Block::Text));
    let error = |all: &[Option<f64>], j: usize| all.get(j).map(|error| Number::new(*error));
    blocks.push(Block::Table(
        DataTable::of(
            "Relative standard error of each joint's stiffness by the scatter of the readings",
            "joint",
            joints.row_names(),
        )
        .numbers("now", Quantity::PERCENT.digits(3), |j| error(&advice.before, j))
        .numbers("with it", Quantity::PERCENT.digits(3), |j| error(&advice.after, j)),
    ));
    Some(Section::new("next", title, blocks))
}

/// The load that the next posture is assumed to be measured with.
fn assumed_load(advice: &NextPosture) -> Option<Text> {
    let load = advice.assumed_load.as_ref()?;
    let force = Number::new(load.magnitude_n).significant(3).unit("N");
    let vector = |v: [f64; 3], unit: f64, digits: usize| v.map(|c| format!("{:.*}", digits, c * unit + 0.0)).join(", ");
    let (begin, end) = match (load.anchor_m, load.direction) {
        (Some(anchor), _) => {
            let at = vector(anchor, 1e3, 0);
            let end = format!("({at}) mm, where the measured forces meet.");
            if load.pushes {
                ("a cylinder that pushes with ", format!(" from {end}"))
            } else {
                ("a rope of ", format!(" to {end}"))
            }
        }
        (None, Some(direction)) => {
            let along = vector(direction, 1.0, 2);
            ("a force of ", format!(" along ({along}), as measured on average."))
        }
        (None, None) => return None,
    };
    Some(Text::new(format!("Assumed: {begin}")).number(force).words(end))
}
