//! Measured displacements, grouped by posture and load state.

use crate::load::Wrench;
use crate::posture::Posture;
use nalgebra::Vector3;

/// One displacement of one measuring point, base axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Displacement {
    /// Index of the measuring point in the cell's tool.
    pub point: usize,
    /// Loaded minus unloaded position \[m\].
    pub value: Vector3<f64>,
    /// Time of the loaded reading \[s\], where recorded.
    pub time: Option<f64>,
}

/// All displacements of one posture in one load state.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredPosture {
    /// Name and controller angles \[rad\].
    pub posture: Posture,
    /// Load state, for example `loaded`, `up-250`, `down-250`.
    pub state: String,
    /// Measured wrench on the robot at the loading point, base axes; `None`
    /// lets the cell's load give it.
    pub wrench: Option<Wrench>,
    /// Displacements; repeats of a point are separate entries.
    pub displacements: Vec<Displacement>,
}

/// Number of displacement components (rows of Ψ) in `measured`.
pub fn row_count(measured: &[MeasuredPosture]) -> usize {
    3 * measured
        .iter()
        .map(|p| p.displacements.len())
        .sum::<usize>()
}

/// Splits off the postures whose names are in `names`: (others, named).
pub fn split_by_name(
    measured: Vec<MeasuredPosture>,
    names: &[String],
) -> (Vec<MeasuredPosture>, Vec<MeasuredPosture>) {
    measured
        .into_iter()
        .partition(|m| !names.contains(&m.posture.name))
}
