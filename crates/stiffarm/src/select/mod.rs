//! Choosing postures: the paper's procedure, from an initial group (Section III.B).

mod random;

pub use random::{SMALL_WRIST_RAD, StartKind, random_group};

use crate::cell::Cell;
use crate::error::{Code, Error, Result};
use crate::findings::list;
use crate::index::{GroupEvaluation, Index, IndexFunction, Indices, evaluate};
use crate::observation::{PostureTerms, check_angles};
use crate::optimise::{Control, Evaluation, Options, Solution, Termination, minimise};
use crate::posture::PostureGroup;
use crate::units::rad_to_shortest_deg;
use serde::{Deserialize, Serialize};
use std::cell::RefCell;

/// Margin kept from hard limits so that rounding never crosses them \[m\].
const LIMIT_GUARD: f64 = 5e-10;
/// First size of the move off a singular start \[rad\], doubled each time.
const FIRST_NUDGE: f64 = 5e-3;
/// Moves off a singular start before it counts as hopeless.
const NUDGES: u32 = 5;
/// Range of the epigraph variable, the logarithm of an index part.
const EPIGRAPH_RANGE: [f64; 2] = [-200.0, 200.0];

/// Limits closer than this are constraints of a search round; the others are
/// checked after it and join the next round when they are crossed \[m\].
const WATCH_DISTANCE: f64 = 0.5;
/// Rounds of adding crossed limits.
const WATCH_ROUNDS: usize = 12;
/// Stages of the smoothing of coalescing singular values; the last is off by
/// at most ln(6)/p = 3·10⁻⁵ of the index.
const SHARPNESS: [Option<f64>; 5] = [Some(30.0), Some(300.0), Some(3e3), Some(3e4), Some(6e4)];

/// Result of a selection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Selection {
    /// The index that was minimised (maximised for O1 to O5).
    pub index: Index,
    /// Its value at the selected postures.
    pub value: f64,
    /// Its value at the initial group, moved onto the bounds; `None` where it
    /// does not exist there. A start outside the limits may well be better than
    /// any group inside them.
    pub start_value: Option<f64>,
    /// Every index of the selected postures.
    pub indices: Indices,
    /// Selected postures, controller angles \[deg\].
    pub postures_deg: Vec<Vec<f64>>,
    /// Why the search ended.
    pub termination: Termination,
    /// Number of initial groups tried.
    pub starts: usize,
    /// Evaluations of index, limits and their derivatives.
    pub evaluations: u64,
    /// Iterations of the optimiser.
    pub iterations: u64,
    /// First-order optimality: ∞-norm of the projected gradient of the
    /// Lagrangian of ln(index) \[1/rad\] at the last iterate.
    pub stationarity: Option<f64>,
    /// Smallest margin to a limit of the cell \[m\], `None` without limits.
    pub smallest_margin_m: Option<f64>,
    /// Controller angles of the selected group \[rad\]; not saved, see `postures_deg`.
    #[serde(skip)]
    pub group: Vec<Vec<f64>>,
}

impl Selection {
    /// The selected postures as a named group.
    pub fn to_group(&self, name: &str) -> PostureGroup {
        PostureGroup::from_angles(name, self.group.iter().cloned())
    }
}

/// Selects postures from an initial group under `index`, Section III.B: the
/// index is minimised over all controller angles at once, within the bounds
/// and the limits of the cell, by a local method.
///
/// `initial` holds controller angles \[rad\]; its length is the number of
/// postures. Angles outside the bounds are moved onto them first.
///
/// # Errors
/// An empty group, a cell without what the index needs, postures that cannot
/// determine all joints, or limits that the search could not meet.
pub fn select_from<Q: AsRef<[f64]>>(
    cell: &Cell,
    index: Index,
    initial: &[Q],
    options: Options,
    control: Control<'_>,
) -> Result<Selection> {
    let setup = &cell.setup;
    let n = setup.robot.joint_count();
    let count = initial.len();
    if count == 0 {
        return Err(Error::new(
            Code::TooFewData,
            "The initial group has no postures.",
        ));
    }
    for q in initial {
        check_angles(&setup.robot, q.as_ref())?;
    }
    if let Some(j) = cell
        .bounds
        .iter()
        .position(|b| b[0].is_nan() || b[1].is_nan() || b[0] > b[1])
    {
        return Err(Error::new(
            Code::InvalidValue,
            format!(
                "The bounds of {} are reversed.",
                setup.robot.joints()[j].name
            ),
        ));
    }
    let function = RefCell::new(IndexFunction::new(cell, index, count)?);
    let limits_per_posture = cell.limits.count(setup);
    let components = function.borrow().component_count();
    let epigraph = usize::from(components > 0);
    let variables = n * count + epigraph;

    let mut bounds: Vec<[f64; 2]> = cell
        .bounds
        .iter()
        .copied()
        .cycle()
        .take(n * count)
        .collect();
    let mut start: Vec<f64> = initial
        .iter()
        .flat_map(|q| q.as_ref().iter().copied())
        .collect();
    for (x, b) in start.iter_mut().zip(&bounds) {
        *x = x.clamp(b[0], b[1]);
    }
    let start_groups: Vec<Vec<f64>> = start.chunks_exact(n).map(<[f64]>::to_vec).collect();
    let start_evaluation = evaluate(cell, "start", &start_groups)?;
    leave_singularity(&mut function.borrow_mut(), &bounds, &mut start);
    if epigraph == 1 {
        bounds.push(EPIGRAPH_RANGE);
        start.push(0.0);
    }
    let watched = RefCell::new(Vec::new());
    let mut terms = PostureTerms::new(setup, &start[..n], None)?;
    let mut row = vec![0.0; n];
    let mut limit_values = vec![0.0; limits_per_posture];
    let mut limit_gradients = vec![0.0; limits_per_posture * n];

    let mut evaluate_at = |x: &[f64]| {
        let q = &x[..n * count];
        let watched = watched.borrow();
        let margins = components + watched.len();
        let minimax = function.borrow_mut().evaluate(q);
        let mut out = Evaluation {
            objective: minimax.smooth,
            gradient: minimax.smooth_gradient.clone(),
            margins: vec![0.0; margins],
            margin_gradients: vec![0.0; margins * variables],
            merit: minimax.value(),
            violation: 0.0,
        };
        if epigraph == 1 {
            // Epigraph: minimise smooth + t with t ≥ every component.
            let t = x[n * count];
            out.objective += t;
            out.gradient.push(1.0);
            for c in 0..components {
                out.margins[c] = t - minimax.components[c];
                let target = &mut out.margin_gradients[c * variables..(c + 1) * variables];
                for (g, d) in target
                    .iter_mut()
                    .zip(&minimax.component_gradients[c * n * count..])
                {
                    *g = -d;
                }
                target[n * count] = 1.0;
            }
        }
        // Watched limits are sorted by posture.
        let mut next = watched.iter().enumerate().peekable();
        for p in 0..count {
            if limits_per_posture == 0 || terms.update(setup, &q[n * p..n * (p + 1)]).is_err() {
                continue;
            }
            cell.limits
                .evaluate(setup, &terms, &mut limit_values, Some(&mut limit_gradients));
            for margin in &limit_values {
                out.violation = out.violation.max(-margin);
            }
            while let Some((w, limit)) =
                next.next_if(|(_, limit)| **limit < (p + 1) * limits_per_posture)
            {
                let l = limit - p * limits_per_posture;
                let at = components + w;
                out.margins[at] = limit_values[l] - LIMIT_GUARD;
                setup
                    .robot
                    .gradient_to_controller(&limit_gradients[l * n..(l + 1) * n], &mut row);
                let offset = at * variables + p * n;
                out.margin_gradients[offset..offset + n].copy_from_slice(&row);
            }
        }
        out
    };
    let prepare = |x: &mut [f64], evaluate: &mut dyn FnMut(&[f64]) -> Evaluation| {
        if epigraph == 1 {
            // The smallest feasible t at these postures.
            x[n * count] = 0.0;
            let slack = evaluate(x).margins[..components]
                .iter()
                .copied()
                .fold(f64::INFINITY, f64::min);
            x[n * count] = if slack.is_finite() {
                -slack
            } else {
                EPIGRAPH_RANGE[1]
            };
        }
    };
    // Where singular values coalesce the gradient of cond(Ψ) jumps, as that of
    // max k(J_N) does: the first is smoothed ever more sharply, the second has
    // its epigraph variable.
    let stages: &[Option<f64>] = match function.borrow().has_extreme_singular_values() {
        true => &SHARPNESS,
        false => &[None],
    };
    let mut solution: Option<Solution> = None;
    for sharpness in stages {
        function.borrow_mut().set_sharpness(*sharpness);
        let mut from = solution
            .as_ref()
            .map_or(start.clone(), |s: &Solution| s.x.clone());
        let mut last = from.clone();
        watched.borrow_mut().clear();
        for _ in 0..WATCH_ROUNDS {
            watch_near_limits(cell, &from[..n * count], &mut watched.borrow_mut())?;
            watch_near_limits(cell, &last[..n * count], &mut watched.borrow_mut())?;
            let margins = components + watched.borrow().len();
            let used = solution.as_ref().map_or(0, |s| s.iterations);
            let left = Options {
                max_iterations: options.max_iterations.saturating_sub(used),
                ..options
            };
            let next = minimise(
                &from,
                &bounds,
                margins,
                left,
                control,
                prepare,
                &mut evaluate_at,
            );
            let outside = next.last_violation > options.feasibility;
            let done =
                !outside || next.termination == Termination::Interrupted || next.iterations == 0;
            last.clone_from(&next.last);
            // Go on from the best point inside all limits, if there is one: a
            // search from outside may never come back in.
            from = if next.merit.is_finite() {
                next.x.clone()
            } else {
                next.last.clone()
            };
            solution = Some(match solution {
                Some(previous) => next.after(previous),
                None => next,
            });
            if done {
                break;
            }
        }
    }
    let Some(solution) = solution else {
        return Err(Error::new(Code::Internal, "A selection without a stage."));
    };
    if !solution.merit.is_finite() {
        return Err(no_result(
            cell,
            index,
            &start_evaluation,
            solution.termination,
        ));
    }
    let group: Vec<Vec<f64>> = solution.x[..n * count]
        .chunks_exact(n)
        .map(<[f64]>::to_vec)
        .collect();
    let evaluation = evaluate(cell, index.as_str(), &group)?;
    let value = evaluation
        .indices
        .get(index)
        .ok_or_else(|| no_result(cell, index, &evaluation, solution.termination))?;
    Ok(Selection {
        index,
        value,
        start_value: start_evaluation.indices.get(index),
        indices: evaluation.indices,
        postures_deg: group
            .iter()
            .map(|q| q.iter().map(|a| rad_to_shortest_deg(*a)).collect())
            .collect(),
        termination: solution.termination,
        starts: 1,
        evaluations: solution.evaluations,
        iterations: solution.iterations,
        stationarity: solution.stationarity,
        smallest_margin_m: smallest_margin(cell, &group)?,
        group,
    })
}

/// Moves a start at which the index does not exist (a singular posture, equal
/// postures) a little, always the same way, until it does. A start that stays
/// without an index is left as it was.
fn leave_singularity(function: &mut IndexFunction<'_>, bounds: &[[f64; 2]], start: &mut [f64]) {
    if function.evaluate(start).value().is_finite() {
        return;
    }
    for attempt in 0..NUDGES {
        let size = FIRST_NUDGE * f64::from(1 << attempt);
        let moved: Vec<f64> = start
            .iter()
            .zip(bounds)
            .enumerate()
            .map(|(i, (x, b))| {
                let shift = f64::from(sobol_burley::sample(
                    attempt + 1,
                    (i % 256) as u32,
                    i as u32 / 256,
                ));
                (x + size * (2.0 * shift - 1.0)).clamp(b[0], b[1])
            })
            .collect();
        if function.evaluate(&moved).value().is_finite() {
            start.copy_from_slice(&moved);
            return;
        }
    }
}

/// Smallest margin of a group to the cell's limits \[m\], `None` without limits.
///
/// # Errors
/// As [`PostureTerms::new`].
pub fn smallest_margin<Q: AsRef<[f64]>>(cell: &Cell, postures: &[Q]) -> Result<Option<f64>> {
    let mut smallest: Option<f64> = None;
    for q in postures {
        let terms = PostureTerms::new(&cell.setup, q.as_ref(), None)?;
        if let Some(margin) = cell.limits.smallest(&cell.setup, &terms) {
            smallest = Some(smallest.map_or(margin.margin, |s| s.min(margin.margin)));
        }
    }
    Ok(smallest)
}

/// Adds to `watched` (sorted, posture by posture) the limits that the postures
/// `q` come near to or cross.
fn watch_near_limits(cell: &Cell, q: &[f64], watched: &mut Vec<usize>) -> Result<()> {
    let setup = &cell.setup;
    let per_posture = cell.limits.count(setup);
    if per_posture == 0 {
        return Ok(());
    }
    let mut values = vec![0.0; per_posture];
    for (p, q) in q.chunks_exact(setup.robot.joint_count()).enumerate() {
        let terms = PostureTerms::new(setup, q, None)?;
        cell.limits.evaluate(setup, &terms, &mut values, None);
        let near = values
            .iter()
            .enumerate()
            .filter(|(_, margin)| **margin < WATCH_DISTANCE);
        watched.extend(near.map(|(l, _)| p * per_posture + l));
    }
    watched.sort_unstable();
    watched.dedup();
    Ok(())
}

fn no_result(cell: &Cell, index: Index, at: &GroupEvaluation, termination: Termination) -> Error {
    if termination == Termination::Interrupted {
        return Error::new(
            Code::Interrupted,
            "Stopped before any posture group met the cell's limits.",
        );
    }
    if index.uses_observation() && !at.undetermined_joints.is_empty() {
        return Error::new(
            Code::NotIdentifiable,
            format!(
                "{} with this load cannot determine {}.",
                match at.posture_count {
                    1 => "One posture".to_string(),
                    count => format!("{count} postures"),
                },
                list(&at.undetermined_joints)
            ),
        )
        .hint(
            "add postures that differ, or measuring points, or move the load off the joint's axis",
        );
    }
    if index == Index::DropOne && at.indices.drop_one.is_none() {
        return Error::new(
            Code::NotIdentifiable,
            format!(
                "{} postures less one cannot determine every joint, so drop_one does not exist.",
                at.posture_count
            ),
        )
        .hint("give more postures, or choose expected_error");
    }
    if index.uses_dexterity() && at.k_jn.iter().any(Option::is_none) {
        return Error::new(
            Code::InvalidValue,
            "k(J_N) does not exist at some posture of the initial group: the Jacobian is singular there.",
        )
        .hint("start from other postures, for example with the wrist bent");
    }
    let limits = if cell.limits.is_empty() {
        "the joint bounds"
    } else {
        "the cell's limits"
    };
    Error::new(
        Code::InvalidValue,
        format!(
            "No group of {} postures that meets {limits} was found from this start.",
            at.posture_count
        ),
    )
    .hint("start from postures inside the limits, or relax [limits] and [bounds]")
}
