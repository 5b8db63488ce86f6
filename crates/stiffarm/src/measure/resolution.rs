//! The step in which readings were written down, and the noise that it makes of its own.
//!
//! Rounding to a step q leaves an error that is uniform within ± q/2, of standard deviation q/√12
//! (B. Widrow, I. Kollár, Quantization Noise, 2008, Section 1). It is independent from reading to
//! reading where the positions differ by more than a step, and counts like noise of the tracker.

use crate::findings::{Finding, codes, length};
use crate::model::cell::Cell;
use crate::model::measurement::{Reading, ReadingTable};
use crate::units::{in_to_m, mm_to_m};

/// Steps that programs round to, in millimetres and in inches, the coarse ones first. A tracker's
/// own digits are finer.
const STEPS_MM: [f64; 5] = [100.0, 10.0, 1.0, 0.1, 0.01];
const STEPS_IN: [f64; 4] = [1.0, 0.1, 0.01, 0.001];

/// Coordinates that must all be multiples before it is no chance.
const FEWEST_COORDINATES: usize = 24;

/// A multiple is one to this part of a step: decimals are not exact.
const MULTIPLE_TOLERANCE: f64 = 1e-5;

/// Below this part of the noise a step is the precision of writing, which is meant …
const MEANT_SHARE: f64 = 0.03;

/// … and below this part it adds a twentieth to the noise at most.
const COARSE_SHARE: f64 = 0.32;

/// What the step of a table's readings adds to the noise.
pub(super) struct Resolution {
    /// The cell with the noise of the step beside that of its tracker.
    pub(super) cell: Cell,
    /// The step is so coarse beside the noise that readings repeat each other to the last digit.
    pub(super) is_coarse: bool,
    /// Variance of a coordinate by the step \[m²\].
    pub(super) variance: f64,
    pub(super) finding: Finding,
}

impl Resolution {
    /// `None` where the readings have finer digits than any step, or no step that matters.
    pub(super) fn of(cell: &Cell, table: &ReadingTable) -> Option<Self> {
        let postures = table.postures.iter().chain(&table.incomplete);
        let states = postures.flat_map(|posture| &posture.states);
        let readings: Vec<&Reading> = states.flat_map(|state| &state.readings).collect();
        let (step, shown) = step(&readings)?;
        let std = step / 12f64.sqrt();
        let distance = readings.iter().map(|r| r.position.norm()).sum::<f64>() / readings.len() as f64;
        let mut with = cell.clone();
        let tracker_std = match &mut with.tracker.accuracy {
            Some(accuracy) => {
                let along = accuracy.range + accuracy.range_per_metre * distance;
                let across = accuracy.angle * distance;
                accuracy.range += along.hypot(std) - along;
                accuracy.angle = across.hypot(std) / distance;
                ((along.powi(2) + 2.0 * across.powi(2)) / 3.0).sqrt()
            }
            None => cell.noise.reading_variance.sqrt(),
        };
        with.noise.reading_variance += std.powi(2);
        if std < MEANT_SHARE * tracker_std {
            return None;
        }
        let sentence = format!(
            "All {} readings are multiples of {shown}: they were rounded before they came here. That is a noise of {} \
             in each coordinate (step/√12) beside {} of the tracker, with which it is counted.",
            readings.len(),
            length(std),
            length(tracker_std),
        );
        let advice = " Export the readings with all their digits.";
        let is_coarse = std >= COARSE_SHARE * tracker_std;
        let finding = if !is_coarse {
            Finding::note(codes::READING_RESOLUTION, "readings", sentence)
        } else {
            Finding::caution(codes::READING_RESOLUTION, "readings", sentence + advice)
        };
        Some(Resolution { cell: with, is_coarse, variance: std.powi(2), finding })
    }
}

/// The coarsest step of which all coordinates are multiples \[m\], and its words.
fn step(readings: &[&Reading]) -> Option<(f64, String)> {
    let coordinates = || readings.iter().flat_map(|reading| reading.position.iter());
    if coordinates().filter(|value| **value != 0.0).count() < FEWEST_COORDINATES {
        return None;
    }
    let mm = STEPS_MM.map(|step| (mm_to_m(step), format!("{step} mm")));
    let inches = STEPS_IN.map(|step| (in_to_m(step), format!("{step} in")));
    let mut steps: Vec<(f64, String)> = mm.into_iter().chain(inches).collect();
    steps.sort_by(|a, b| b.0.total_cmp(&a.0));
    let is_multiple = |value: &f64, step: f64| {
        let count = value / step;
        (count - count.round()).abs() < MULTIPLE_TOLERANCE
    };
    let mut steps = steps.into_iter();
    steps.find(|(step, _)| coordinates().all(|value| is_multiple(value, *step)))
}
