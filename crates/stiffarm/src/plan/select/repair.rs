//! Postures moved inside the limits of a cell, each by itself.

use crate::error::Result;
use crate::model::cell::Cell;
use crate::numerics::control::Control;
use crate::numerics::optimise::smooth::{SmoothOptions, minimise_smooth};
use crate::plan::index::kernel::{Kernel, KernelOutputs};

/// The postures of `angles` \[rad\] moved inside the limits; those with which that fails are left out.
///
/// # Errors
/// As [`Kernel::new`].
pub(super) fn repair(cell: &Cell, angles: &[f64]) -> Result<Vec<f64>> {
    let n = cell.setup.robot.joint_count();
    let outputs = KernelOutputs { dexterity: None, information: None, limits: true };
    let mut kernel = Kernel::new(cell, outputs, 1)?;
    // Aim a little inside, or the end is never quite inside.
    kernel.reset_penalty(1.0, 1e-3);
    let lower: Vec<f64> = cell.bounds.iter().map(|b| b[0]).collect();
    let upper: Vec<f64> = cell.bounds.iter().map(|b| b[1]).collect();
    let options = SmoothOptions { max_iterations: 200, optimality: 1e-9, reduction: 1e-12 };
    let mut inside = Vec::new();
    for q in angles.chunks_exact(n) {
        let solution = minimise_smooth(
            &mut |q, gradient| {
                kernel.forward(q);
                kernel.reverse(gradient);
                kernel.penalty()
            },
            &lower,
            &upper,
            q,
            options,
            Control::default(),
        );
        kernel.forward(&solution.x);
        if kernel.violation() <= 0.0 {
            inside.extend_from_slice(&solution.x);
        }
    }
    Ok(inside)
}
