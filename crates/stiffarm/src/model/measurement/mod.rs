//! What was measured: displacements, grouped by posture and load state, and
//! the raw readings behind them.

mod candidate;
mod readings;

pub use candidate::Candidate;
pub use readings::{
    PendingReading, PostureReadings, Reading, ReadingTable, ReadingTarget, Role, StateReadings, WrenchColumns,
};

use crate::error::Result;
use crate::model::load::Wrench;
use crate::model::observation::{PostureTerms, Setup};
use crate::model::posture::Posture;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// One displacement of one measuring point, base axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Displacement {
    /// Index of the measuring point in the cell's tool.
    pub point: usize,
    /// Loaded minus reference position \[m\]; the reference is the unloaded
    /// reading, or that under a light preload.
    pub value: Vector3<f64>,
    /// Time of the loaded reading \[s\], where recorded.
    pub time: Option<f64>,
    /// Loaded readings that were averaged.
    pub readings: u32,
    /// What the reference was made of.
    pub reference: Vec<ReferencePart>,
    /// Covariance of one reading of this point, base axes \[m²\], where a model
    /// of the tracker gives it.
    pub covariance: Option<Matrix3<f64>>,
}

impl Displacement {
    /// A displacement from one loaded and one reference reading.
    pub fn new(point: usize, value: Vector3<f64>) -> Self {
        Displacement {
            point,
            value,
            time: None,
            readings: 1,
            reference: vec![ReferencePart::reading(0)],
            covariance: None,
        }
    }

    /// Covariance of this reference and that of another displacement of the posture and point, in variances of one
    /// reading: with w and s the weights of states, n their readings, Σ (w wʹ / n + s sʹ) over the states that both
    /// have. For two references on one line through all readings it is 1/N + (t − t̄)(tʹ − t̄)/Σ(t − t̄)².
    pub fn shared_reference(&self, other: &Displacement) -> f64 {
        ReferencePart::shared(&self.reference, &other.reference)
    }
}

/// What the readings of one state count in a reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferencePart {
    /// Number of the state: equal numbers of one posture and point are the same readings.
    pub state: u32,
    /// Of the mean of its readings.
    pub weight: f64,
    /// Of their slope over time: the sum of squares of what the weights of single readings differ from their mean is
    /// its square.
    pub slope: f64,
    /// Readings of the state.
    pub readings: u32,
}

impl ReferencePart {
    /// Covariance of two references of one point, in variances of one reading ([`Displacement::shared_reference`]).
    pub(crate) fn shared(one: &[ReferencePart], other: &[ReferencePart]) -> f64 {
        let mut shared = 0.0;
        for first in one {
            for part in other.iter().filter(|part| part.state == first.state) {
                let readings = f64::from(first.readings.max(1));
                shared += first.weight * part.weight / readings + first.slope * part.slope;
            }
        }
        shared
    }

    /// One reading in a state.
    pub fn reading(state: u32) -> Self {
        ReferencePart { state, weight: 1.0, slope: 0.0, readings: 1 }
    }
}

/// All displacements of one posture in one load state.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredPosture {
    /// Name and controller angles \[rad\].
    pub posture: Posture,
    /// Load state, for example `loaded`, `up-250`, `down-250`.
    pub state: String,
    /// Measured wrench on the robot at the loading point, base axes, loaded
    /// minus reference; `None` lets the cell's load give it.
    pub wrench: Option<Wrench>,
    /// What the arm carried already in the reference, base axes at the loading point: a preload; `None` where it was
    /// unloaded.
    pub preload: Option<Wrench>,
    /// What the controller gave way under the load: its angles loaded minus
    /// reference, Δq_m \[rad\], where recorded.
    pub servo_deflection: Option<Vec<f64>>,
    /// Variance of an error that all points of the posture have alike, over that
    /// of one reading, per axis: what taking back the motion of the base adds in
    /// this state, and with the reference, which all states share.
    pub common_readings: [f64; 2],
    /// Displacements; repeats of a point are separate entries.
    pub displacements: Vec<Displacement>,
}

impl MeasuredPosture {
    /// A posture under the cell's load, in the state `loaded`.
    pub fn new(posture: Posture, displacements: Vec<Displacement>) -> Self {
        MeasuredPosture {
            posture,
            state: "loaded".to_string(),
            wrench: None,
            preload: None,
            servo_deflection: None,
            common_readings: [0.0; 2],
            displacements,
        }
    }

    /// The model's terms of this state in `setup`, under `wrench` instead of the measured one's place, against the
    /// reference that it has.
    ///
    /// # Errors
    /// As [`PostureTerms::new`].
    pub fn terms(&self, setup: &Setup, wrench: Option<&Wrench>) -> Result<PostureTerms> {
        let terms = PostureTerms::new(setup, &self.posture.q, wrench)?;
        Ok(match &self.preload {
            Some(preload) => terms.against(preload),
            None => terms,
        })
    }
}

/// What a table of measurements holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Measurements {
    /// Displacements, loaded minus unloaded, base axes.
    Displacements(Vec<MeasuredPosture>),
    /// Positions as the tracker gave them.
    Readings(ReadingTable),
}

impl From<ReadingTable> for Measurements {
    fn from(table: ReadingTable) -> Self {
        Measurements::Readings(table)
    }
}

impl From<Vec<MeasuredPosture>> for Measurements {
    fn from(measured: Vec<MeasuredPosture>) -> Self {
        Measurements::Displacements(measured)
    }
}

/// Standard deviation of one reading per axis from repeats.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReadingScatter {
    /// Standard deviation of one reading per axis \[m\].
    pub reading_std_m: f64,
    /// Degrees of freedom behind it.
    pub degrees_of_freedom: usize,
}

/// Number of displacement components (rows of Ψ) in `measured`.
pub fn row_count(measured: &[MeasuredPosture]) -> usize {
    3 * measured.iter().map(|p| p.displacements.len()).sum::<usize>()
}
