//! The characteristic length: the L that minimises the smallest attainable
//! k(J_N) over the joint bounds (Angeles' definition; the paper gives no L).
//!
//! Sampling from the bounds uses `sobol_burley` where a fixed set is wanted
//! (characteristic length, check) and ChaCha8 where a seed is.

use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::dexterity::{log_condition_gradient, require_six_joints};
use crate::model::kinematics::Frames;
use crate::numerics::control::Control;
use crate::numerics::optimise::{Evaluation, Options, Problem, minimise};
use crate::numerics::streams::spread;

/// Starts of the search; every start of the reference cell ends at the same L.
const STARTS: u32 = 64;

/// Result of the search for the characteristic length.
#[derive(Debug, Clone, PartialEq)]
pub struct CharacteristicLength {
    /// L \[m\].
    pub length: f64,
    /// The smallest k(J_N) over the bounds, attained at this L.
    pub condition_number: f64,
    /// A posture that attains it, controller angles \[rad\].
    pub posture: Vec<f64>,
}

/// ln k(J_N) over the joint angles and ln L.
struct Dexterity<'a> {
    cell: &'a Cell,
    bounds: Vec<[f64; 2]>,
    frames: Frames,
}

impl Problem for Dexterity<'_> {
    fn bounds(&self) -> &[[f64; 2]] {
        &self.bounds
    }

    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        let robot = &self.cell.setup.robot;
        let n = robot.joint_count();
        self.frames.update(robot, &x[..n]);
        let tcp = self.frames.point(&self.cell.setup.tool.tcp());
        let mut theta = vec![0.0; n];
        let (value, by_length) = log_condition_gradient(&self.frames, &tcp, x[n].exp(), &mut theta);
        let mut gradient = vec![0.0; n + 1];
        robot.gradient_to_controller(&theta, &mut gradient[..n]);
        gradient[n] = by_length;
        Evaluation { objective: value, gradient, merit: value, ..Evaluation::default() }
    }
}

/// Minimises k(J_N) over the joint bounds and L, at measuring point 1.
///
/// Local minimisation from a fixed low-discrepancy set of starts: the result
/// is the same each time, and global as far as these starts reach.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm_files::builtin;
/// use stiffarm::plan::characteristic_length::characteristic_length;
///
/// let cell = builtin::cell("comau")?;
/// let found = characteristic_length(&cell)?;
/// assert!(found.length > 0.0 && found.condition_number >= 1.0);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Fewer than six joints, or no posture within the bounds with full-rank J_N.
pub fn characteristic_length(cell: &Cell) -> Result<CharacteristicLength> {
    let robot = &cell.setup.robot;
    let n = robot.joint_count();
    require_six_joints(robot)?;
    let tcp = cell.setup.tool.tcp();
    let reach: f64 = robot.joints().iter().map(|j| j.placement.translation.vector.norm()).sum::<f64>()
        + robot.flange().translation.vector.norm()
        + tcp.norm();
    if reach.is_nan() || reach <= 0.0 {
        return Err(Error::new(Code::Unsupported, "The chain has no length, so there is no characteristic length."));
    }
    // ln L between a thousandth of the reach and the reach.
    let mut bounds = cell.bounds.clone();
    bounds.push([(1e-3 * reach).ln(), reach.ln()]);
    let mut problem = Dexterity { cell, bounds, frames: Frames::new(robot, &vec![0.0; n]) };
    let mut best: Option<(f64, Vec<f64>)> = None;
    for start in 0..STARTS {
        let mut x = spread(&cell.bounds, start);
        x.push((0.3 * reach).ln());
        let options = Options { max_iterations: 300, ..Options::default() };
        let solution = minimise(&mut problem, &x, options, Control::default());
        if best.as_ref().is_none_or(|(merit, _)| solution.merit < *merit) && solution.merit.is_finite() {
            best = Some((solution.merit, solution.x));
        }
    }
    let (merit, mut x) = best.ok_or_else(|| {
        Error::new(
            Code::Unsupported,
            "No posture within the bounds has a full-rank Jacobian, so there is no characteristic length.",
        )
    })?;
    let length = x.pop().unwrap_or(0.0).exp();
    Ok(CharacteristicLength { length, condition_number: merit.exp(), posture: x })
}

/// The cell with its characteristic length, computed where it was left open.
/// Robots that have none (fewer than six joints, or a Jacobian that never has
/// full rank) stay without one.
///
/// # Errors
/// As [`characteristic_length`], except where the robot has none.
pub fn with_characteristic_length(mut cell: Cell) -> Result<Cell> {
    if cell.characteristic_length.is_none() {
        cell.characteristic_length = match characteristic_length(&cell) {
            Ok(minimum) => Some(minimum.length),
            Err(error) if error.code() == Code::Unsupported => None,
            Err(error) => return Err(error),
        };
    }
    Ok(cell)
}

/// The cell with the characteristic length of Eq. (20), computed where it was left open, and why it has none.
/// A robot that has none stays without: the indices that need it do not exist, or say why.
pub fn with_length(cell: Cell) -> (Cell, Option<String>) {
    if cell.characteristic_length.is_some() {
        return (cell, None);
    }
    match with_characteristic_length(cell.clone()) {
        Ok(cell) if cell.characteristic_length.is_some() => (cell, None),
        Ok(cell) => (cell, Some("k(J_N) needs at least six joints".to_string())),
        Err(error) => (cell, Some(error.message().to_string())),
    }
}
