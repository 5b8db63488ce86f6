//! The shape of the tool that most states share.

use super::Work;
use super::rigid::{Pair, best_rms, fit, moved};
use super::sheet::State;
use crate::numerics::sample::median;
use nalgebra::Vector3;
use std::cell::RefCell;

/// States held against the others, to find one that has the common shape.
const REFERENCES: usize = 32;
/// Fewest states of which a mean shape resists one that is off.
const STATES: usize = 3;
/// A state belongs to the mean where it differs by at most this many times what
/// the middle one does.
const ALIKE_SHAPES: f64 = 5.0;

/// Pairs of the points of `state` with those of `shape`, `without` left out.
pub(super) fn pairs(state: &State, shape: &[Option<Vector3<f64>>], without: Option<usize>) -> Vec<Pair> {
    let mut out = Vec::new();
    for (a, (mean, point)) in state.points.iter().zip(shape).enumerate() {
        if let (Some(mean), Some(point)) = (mean, point)
            && without != Some(a)
        {
            out.push((*point, mean.position));
        }
    }
    out
}

/// A shape of the tool by point, where it is known.
pub(super) type Shape = Option<Vec<Option<Vector3<f64>>>>;

/// The last shape, with the readings that it comes from.
#[derive(Default)]
pub(super) struct LastShape(RefCell<Option<(Vec<u64>, Shape)>>);

/// Shape that most states share, by point; `None` with fewer than three states.
/// Several checks ask for it; it is computed anew where a reading has changed.
pub(super) fn mean_shape(work: &Work) -> Shape {
    let states = work.sheet.postures.iter().flat_map(|p| &p.states);
    let points = states.flat_map(|s| &s.points);
    let numbers = points.flat_map(|mean| match mean {
        Some(mean) => [mean.position.x, mean.position.y, mean.position.z, mean.std],
        None => [f64::NAN; 4],
    });
    let readings: Vec<u64> = numbers.map(f64::to_bits).collect();
    let last = &work.shape.0;
    if let Some((_, shape)) = last.borrow().as_ref().filter(|(of, _)| *of == readings) {
        return shape.clone();
    }
    let shape = new_mean_shape(work);
    *last.borrow_mut() = Some((readings, shape.clone()));
    shape
}

fn new_mean_shape(work: &Work) -> Shape {
    let count = work.setup().tool.point_count();
    let whole: Vec<&State> =
        work.sheet.states().into_iter().map(|at| work.sheet.at(at)).filter(|s| s.seen().len() == count).collect();
    if count < 3 || whole.len() < STATES {
        return None;
    }
    let positions =
        |s: &State| -> Vec<Option<Vector3<f64>>> { s.points.iter().map(|m| m.map(|m| m.position)).collect() };
    // The state that at least half of the others resemble most.
    let half = whole.len() / 2;
    let step = whole.len().div_ceil(REFERENCES);
    let resemblance = |shape: &[Option<Vector3<f64>>]| {
        let mut all: Vec<f64> = whole.iter().map(|s| best_rms(&pairs(s, shape, None))).collect();
        all.sort_by(f64::total_cmp);
        all[half]
    };
    let (rms, mut shape) = whole
        .iter()
        .step_by(step)
        .map(|s| {
            let shape = positions(s);
            (resemblance(&shape), shape)
        })
        .min_by(|(a, _), (b, _)| a.total_cmp(b))?;
    // States with mixed up names would shift even a median.
    let typical = ALIKE_SHAPES * rms + work.sheet.typical_std();
    let resembles = |s: &&State| best_rms(&pairs(s, &shape, None)) <= typical;
    let whole: Vec<&State> = whole.iter().copied().filter(resembles).collect();
    for _ in 0..3 {
        let mut seen: Vec<Vec<Vector3<f64>>> = vec![Vec::new(); count];
        for state in &whole {
            let Some(pose) = fit(&pairs(state, &shape, None)) else {
                continue;
            };
            for (a, mean) in state.points.iter().enumerate() {
                if let Some(mean) = mean {
                    seen[a].push(moved(&pose.inverse(), &mean.position));
                }
            }
        }
        for (a, all) in seen.iter().enumerate() {
            let middle = |i: usize| median(&all.iter().map(|p| p[i]).collect::<Vec<f64>>());
            shape[a] = (!all.is_empty()).then(|| Vector3::from_fn(|i, _| middle(i)));
        }
    }
    Some(shape)
}
