//! One suspicion: what is likely wrong, where, with its numbers and its weight.

use super::cause::Cause;
use crate::findings::Severity::{self, Caution, Note, Serious};
use crate::model::cell::Cell;
use serde::{Deserialize, Serialize};

/// Misfit that a robot as delivered may have \[m\].
const ROBOT_ACCURACY: f64 = 5e-3;

/// Turn between two frames that costs a third of a percent \[deg\].
const SMALL_TURN_DEG: f64 = 0.06;

/// A stray reading below this costs little more than noise does \[m\].
const SMALL_STRAY: f64 = 1e-4;

/// What a suspicion about a scale rests on, the strongest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    /// Readings against readings.
    Readings,
    /// The file against itself: names of states, nominal load, what can be meant at all.
    File,
    /// The prior stiffness, or that of robots of the class, alone.
    Prior,
}

/// One suspicion with its numbers.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Suspicion {
    /// What is likely wrong.
    pub cause: Cause,
    /// Postures it concerns; none: all of them.
    pub postures: Vec<String>,
    /// Load states it concerns; none: all of them.
    pub states: Vec<String>,
    /// Measuring points; several where one of them it is, or they are exchanged.
    pub points: Vec<String>,
    /// Joints.
    pub joints: Vec<String>,
    /// Lines of the table, where there is one.
    pub lines: Vec<usize>,
    /// Number of the repeat, counted from 1.
    pub repeat: Option<usize>,
    /// Misfit as read: RMS distance from where the points should be \[m\].
    pub before_m: Option<f64>,
    /// Misfit with the likely fault undone \[m\].
    pub after_m: Option<f64>,
    /// How far the reading or point is off \[m\].
    pub off_m: Option<f64>,
    /// Ratio of what is read to what is expected.
    pub factor: Option<f64>,
    /// Identified over prior stiffness, or that of the robot's class, where a scale is suspected.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ratio: Option<f64>,
    /// Misfit of the states under load with and without the fault, over the larger of what is
    /// read and what is expected, where a scale is suspected by readings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub misfits: Option<[f64; 2]>,
    /// Slips of the tracker's axes with which it stands as it is given, or parallel to the base.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub axis_slips: Vec<String>,
    /// What in the file itself says the same of a scale.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub confirmed_by: Vec<String>,
    /// What a suspicion about a scale rests on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub evidence: Option<Evidence>,
    /// Angle as written and as the readings have it, or offset of a joint \[deg\].
    pub angles_deg: Vec<f64>,
    /// Shift of all measuring points, flange axes \[mm\]; `angles_deg` then holds their turn vector.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tool_shift_mm: Vec<f64>,
    /// Postures that were read partly before the tracker was moved and partly after.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub divided: Vec<String>,
    /// The station that the table names for postures before which the tracker was moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub station: Option<String>,
    /// A name for the station that these postures were read from instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub likely_station: Option<String>,
    /// Other explanations that fit as well.
    pub alternatives: Vec<String>,
    /// False where the points named are candidates for one fault.
    pub certain: bool,
}

impl Suspicion {
    pub(super) fn new(cause: Cause) -> Self {
        Suspicion { cause, certain: true, ..Suspicion::default() }
    }

    pub(super) fn posture(mut self, name: &str) -> Self {
        self.postures.push(name.to_string());
        self
    }

    pub(super) fn state(mut self, name: &str) -> Self {
        self.states.push(name.to_string());
        self
    }

    pub(super) fn points<'a>(mut self, names: impl IntoIterator<Item = &'a String>) -> Self {
        self.points.extend(names.into_iter().cloned());
        self
    }

    pub(super) fn joints(mut self, cell: &Cell, joints: &[usize]) -> Self {
        let all = cell.setup.robot.joints();
        self.joints.extend(joints.iter().map(|j| all[*j].name.clone()));
        self
    }

    pub(super) fn off(mut self, off: f64) -> Self {
        self.off_m = Some(off);
        self
    }

    pub(super) fn misfit(mut self, before: f64, after: f64) -> Self {
        self.before_m = Some(before);
        self.after_m = Some(after);
        self
    }

    /// How serious the finding is.
    pub(super) fn severity(&self) -> Severity {
        match self.cause {
            Cause::Drawing if self.certain => Note,
            // Where the prior alone speaks, the prior may be what is wrong.
            Cause::LoadUnits | Cause::DisplacementUnits | Cause::PriorUnits if !self.certain => match self.evidence {
                Some(Evidence::Prior) => Caution,
                _ => Serious,
            },
            // The number alone speaks: the readings fit either.
            Cause::LoadingPointUnits if !self.certain => Caution,
            // A few mm are within what robots miss their positions by.
            Cause::UnexplainedPosture if self.before_m.is_some_and(|b| b < ROBOT_ACCURACY) => Caution,
            // Displacements turn with the frame: by less than 0.3 % they stay what they are.
            Cause::MovedTracker if self.divided.is_empty() && self.angles_deg.iter().all(|a| *a < SMALL_TURN_DEG) => {
                Caution
            }
            Cause::StrayReading if self.off_m.is_some_and(|off| off < SMALL_STRAY) => Caution,
            _ => self.cause.facts().2,
        }
    }
}
