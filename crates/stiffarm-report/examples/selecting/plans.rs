//! A group of postures and what it is worth, in the numbers of the page.

use serde::Serialize;
use stiffarm::Control;
use stiffarm::Result;
use stiffarm::internals::information::Factor;
use stiffarm::model::cell::Cell;
use stiffarm::model::observation::{PostureTerms, Rows, observation_matrix};
use stiffarm::plan::index::{Index, Indices, evaluate};
use stiffarm::plan::select::{GlobalOptions, StartKind, random_group, select};

/// Relative standard error beyond which the first order understates.
const FIRST_ORDER: f64 = 0.1;

/// A group of postures with everything the page says of it. SI units,
/// errors as fractions.
#[derive(Debug, Clone, Serialize)]
pub struct Plan {
    pub name: String,
    pub postures: usize,
    /// Rounds of the global search, where there was one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rounds: Option<u64>,
    pub indices: Indices,
    pub expected_deviation: Vec<f64>,
    pub mean_expected_deviation: f64,
    /// Some joint has a relative standard error above 10 %.
    pub beyond_first_order: bool,
    pub singular_values: Vec<f64>,
    /// RMS over all rows of what each joint's give adds to a displacement.
    pub signal_m: Vec<f64>,
    /// Share of each joint's signal that no combination of the others
    /// imitates, 0 to 1.
    pub own_share: Vec<f64>,
    /// RMS over the postures of each joint's torque.
    pub torque_nm: Vec<f64>,
    pub rope_length_m: [f64; 2],
    pub loading_points_m: Vec<[f64; 3]>,
    /// Largest distance between two loading points.
    pub loading_point_spread_m: f64,
    pub k_jn: Vec<Option<f64>>,
    pub postures_deg: Vec<Vec<f64>>,
    #[serde(skip)]
    pub group: Vec<Vec<f64>>,
}

impl Plan {
    /// Evaluates a group (controller angles, rad).
    pub fn new(cell: &Cell, name: &str, group: &[Vec<f64>]) -> Result<Self> {
        let evaluation = evaluate(cell, name, group)?;
        let psi = observation_matrix(&cell.setup, group, Rows::Translations)?;
        let inverse = Factor::new(&psi)?.inverse_information();
        let prior = cell.require_prior()?;
        let norms: Vec<f64> = psi.column_iter().map(|c| c.norm()).collect();
        let rows = (psi.nrows() as f64).sqrt();
        let mut points = Vec::new();
        let mut torque = vec![0.0; prior.len()];
        let mut rope = [f64::INFINITY, f64::NEG_INFINITY];
        for q in group {
            let terms = PostureTerms::new(&cell.setup, q, None)?;
            let loads = terms.spring_loads(&cell.setup.robot);
            for (sum, load) in torque.iter_mut().zip(loads.iter()) {
                *sum += load * load / group.len() as f64;
            }
            let point = *terms.loading_point();
            if let Some(length) = cell.setup.load.rope_length(&point) {
                rope = [rope[0].min(length), rope[1].max(length)];
            }
            points.push(point);
        }
        let spread = points.iter().flat_map(|a| points.iter().map(move |b| (a - b).norm()));
        let degrees = |a: &f64| (a.to_degrees() * 1e4).round() / 1e4;
        Ok(Plan {
            name: name.into(),
            postures: group.len(),
            rounds: None,
            indices: evaluation.indices,
            expected_deviation: evaluation.expected_deviation.iter().map(|d| d.unwrap_or(f64::NAN)).collect(),
            mean_expected_deviation: evaluation.mean_expected_deviation().unwrap_or(f64::NAN),
            beyond_first_order: evaluation.relative_standard_error.iter().any(|e| e.is_none_or(|e| e > FIRST_ORDER)),
            singular_values: evaluation.singular_values,
            signal_m: norms.iter().zip(prior).map(|(norm, k)| norm / (k * rows)).collect(),
            own_share: norms.iter().enumerate().map(|(j, norm)| 1.0 / (norm * inverse[(j, j)].sqrt())).collect(),
            torque_nm: torque.iter().map(|t| t.sqrt()).collect(),
            rope_length_m: rope,
            loading_points_m: points.iter().map(|p| (*p).into()).collect(),
            loading_point_spread_m: spread.fold(0.0, f64::max),
            k_jn: evaluation.k_jn,
            postures_deg: group.iter().map(|q| q.iter().map(degrees).collect()).collect(),
            group: group.to_vec(),
        })
    }

    /// Selects `count` postures under an index, in a fixed number of rounds.
    pub fn select(cell: &Cell, index: Index, count: usize, seed: u64, rounds: u64) -> Result<Self> {
        let mut options = GlobalOptions::default();
        options.seed = seed;
        options.rounds = Some(rounds);
        let selection = select(cell, index, count, &options, Control::default())?;
        let name = index.as_str().replace('_', "-");
        let mut plan = Plan::new(cell, &name, &selection.group)?;
        plan.rounds = Some(rounds);
        Ok(plan)
    }

    /// Value of an index; not a number where it does not exist.
    pub fn index(&self, index: Index) -> f64 {
        self.indices.get(index).unwrap_or(f64::NAN)
    }
}

/// Mean expected deviation and expected error of many random groups.
#[derive(Debug, Clone, Serialize)]
pub struct Band {
    pub groups: usize,
    pub postures: usize,
    /// 5 %, 50 % and 95 % quantile of the mean expected deviation.
    pub mean_expected_deviation: [f64; 3],
    /// The same of the expected error.
    pub expected_error: [f64; 3],
    /// The same of each joint's expected deviation.
    pub expected_deviation: Vec<[f64; 3]>,
    /// The same of the novel index.
    pub novel: [f64; 3],
}

impl Band {
    /// Random groups within bounds and limits.
    pub fn new(cell: &Cell, groups: usize, postures: usize) -> Result<Self> {
        let mut plans = Vec::with_capacity(groups);
        for stream in 0..groups {
            let group = random_group(cell, StartKind::Uniform, postures, 1, stream as u64)?;
            plans.push(Plan::new(cell, "random", &group)?);
        }
        let of = |value: &dyn Fn(&Plan) -> f64| quantiles(plans.iter().map(value).collect());
        let joints = cell.bounds.len();
        Ok(Band {
            groups,
            postures,
            mean_expected_deviation: of(&|p| p.mean_expected_deviation),
            expected_error: of(&|p| p.index(Index::ExpectedError)),
            expected_deviation: (0..joints).map(|j| of(&|p| p.expected_deviation[j])).collect(),
            novel: of(&|p| p.index(Index::Novel)),
        })
    }
}

/// 5 %, 50 % and 95 % quantile.
pub fn quantiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [0.05, 0.5, 0.95].map(|share| {
        let at = share * (values.len() - 1) as f64;
        let below = at.floor() as usize;
        let above = (below + 1).min(values.len() - 1);
        values[below] + (at - below as f64) * (values[above] - values[below])
    })
}
