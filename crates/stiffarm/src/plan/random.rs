//! Random initial groups, reproducible from a seed.

use crate::error::Result;
use crate::model::cell::Cell;
use crate::numerics::streams::{group_rng, uniform};
use crate::plan::feasibility::nothing_meets;

/// Half-width of the wrist angles of a hand-picked-like group: 30°.
pub const SMALL_WRIST_RAD: f64 = std::f64::consts::FRAC_PI_6;
/// Draws per posture before a start counts as impossible.
const MAX_DRAWS: usize = 20_000;

/// How the postures of an initial group are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StartKind {
    /// Uniform within the bounds.
    Uniform,
    /// As an engineer picks them: the last three joints within ±30° (and the
    /// bounds), the others uniform.
    SmallWrist,
}

/// Draws a group of `count` postures (controller angles, rad) within the bounds
/// and the limits of the cell. Group `stream` of `seed` is always the same.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm_files::builtin;
/// use stiffarm::plan::select::{StartKind, random_group};
///
/// let cell = builtin::cell("comau")?;
/// let group = random_group(&cell, StartKind::SmallWrist, 6, 1, 0)?;
/// assert_eq!((group.len(), group[0].len()), (6, 6));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// No posture inside the limits was found.
pub fn random_group(cell: &Cell, kind: StartKind, count: usize, seed: u64, stream: u64) -> Result<Vec<Vec<f64>>> {
    let n = cell.setup.robot.joint_count();
    let mut rng = group_rng(seed, stream);
    let mut margins = cell.posture_margins()?;
    let bounds: Vec<[f64; 2]> = cell
        .bounds
        .iter()
        .enumerate()
        .map(|(j, b)| {
            let narrow = [b[0].max(-SMALL_WRIST_RAD), b[1].min(SMALL_WRIST_RAD)];
            let wrist = kind == StartKind::SmallWrist && j + 3 >= n && narrow[0] < narrow[1];
            if wrist { narrow } else { *b }
        })
        .collect();
    (0..count)
        .map(|_| {
            for _ in 0..MAX_DRAWS {
                let q = uniform(&bounds, &mut rng);
                if margins.least(&q)? >= 0.0 {
                    return Ok(q);
                }
            }
            Err(nothing_meets(cell, MAX_DRAWS))
        })
        .collect()
}
