//! Screening before statistics: what is wrong with a table of raw readings, by
//! posture, state and point, with the likely cause.
//!
//! A fault is named when correcting it makes everything else fit: for each
//! suspect the checks try what people get wrong (two points exchanged, a sign,
//! a mistyped angle, exchanged rows, a mirrored frame, …) and accept a cause
//! only where the misfit falls to less than a fifth and to what the other
//! postures have. Where several causes explain a fault alike, all are named.
//! Checks go on with the corrected readings; nothing is corrected for the user.
//!
//! What cannot be seen: a fault that a rigid motion of the tracker explains
//! (an offset of joint 1 of a standing robot), and with a flat tool a reading
//! that strays across its plane, unless the motion under load tells.
//!
//! Suspects are tried, not guessed. Screening names a fault when undoing it
//! divides the misfit by five and brings it to what the other postures have; a
//! cause with a fitted number must do three times better than one without. It
//! goes on with the corrected readings, so that one fault does not hide
//! another, and corrects nothing for the user.

mod frame;
mod gross_error;
mod mean_shape;
mod messages;
mod misfit;
mod model;
mod motion;
mod posture;
mod rigid;
mod severity;
mod shape;
mod sheet;
mod states;

use super::series::PostureSeries;
use crate::error::Result;
use crate::findings::Finding;
use crate::model::cell::Cell;
use crate::model::kinematics::Frames;
use crate::model::measurement::ReadingTable;
use crate::model::observation::Setup;
use nalgebra::{Isometry3, Vector3};
use serde::{Deserialize, Serialize};
use sheet::Sheet;

/// A correction is believed when it divides the misfit by at least this.
const BELIEVED: f64 = 5.0;
/// Explanations whose misfit lies within this factor of the best explain alike.
const ALIKE: f64 = 2.0;
/// A number that was fitted to the readings must divide the misfit by this much
/// more than a cause that leaves nothing to fit.
const FITTED: f64 = 3.0;

/// What is likely wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Cause {
    /// Coordinates in another unit than stated.
    Units,
    /// The tool's points in the cell in another unit than stated.
    ToolUnits,
    /// Measuring points exchanged.
    ExchangedPoints,
    /// One repeat far from the others.
    StrayRepeat,
    /// One reading far from where the rigid tool has its point.
    StrayReading,
    /// A reflector that sits elsewhere in several states.
    MovedReflector,
    /// The measuring points do not keep their distances.
    UnsteadyShape,
    /// Measuring points that lie elsewhere than the cell says.
    Drawing,
    /// The tracker's axes are left-handed, or one is flipped.
    MirroredFrame,
    /// Joints that turn the other way than the cell says.
    JointSign,
    /// Axis 3 coupled to axis 2 differently than the cell says.
    Coupling,
    /// A constant offset of a joint angle.
    JointOffset,
    /// Joint angles in radians under a heading in degrees.
    Radians,
    /// The transform that is given for the tracker does not fit the readings.
    GivenTransform,
    /// One joint angle with the wrong sign.
    AngleSign,
    /// One joint angle mistyped.
    MistypedAngle,
    /// Rows of two postures exchanged.
    ExchangedPostures,
    /// Readings that belong to another posture.
    OtherPosture,
    /// A posture that the kinematic model does not explain.
    UnexplainedPosture,
    /// A robot that the kinematic model does not explain.
    UnexplainedModel,
    /// No displacement under load.
    NoDisplacement,
    /// Displacements against the force.
    ReversedForce,
    /// Loaded and unloaded rows exchanged.
    ExchangedStates,
    /// Displacements of another size than the prior stiffness lets expect.
    DisplacementSize,
    /// One state with displacements of another size than the others.
    OtherLoad,
    /// Too few readings for the checks against the kinematic model.
    NotChecked,
}

/// One suspicion with its numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// Angle as written and as the readings have it, or offset of a joint \[deg\].
    pub angles_deg: Vec<f64>,
    /// Other explanations that fit as well.
    pub alternatives: Vec<String>,
    /// False where the points named are candidates for one fault.
    pub certain: bool,
}

impl Suspicion {
    fn new(cause: Cause) -> Self {
        Suspicion {
            cause,
            postures: Vec::new(),
            states: Vec::new(),
            points: Vec::new(),
            joints: Vec::new(),
            lines: Vec::new(),
            repeat: None,
            before_m: None,
            after_m: None,
            off_m: None,
            factor: None,
            angles_deg: Vec::new(),
            alternatives: Vec::new(),
            certain: true,
        }
    }

    fn posture(mut self, name: &str) -> Self {
        self.postures.push(name.to_string());
        self
    }

    fn state(mut self, name: &str) -> Self {
        self.states.push(name.to_string());
        self
    }

    fn points<'a>(mut self, names: impl IntoIterator<Item = &'a String>) -> Self {
        self.points.extend(names.into_iter().cloned());
        self
    }

    fn joints(mut self, cell: &Cell, joints: &[usize]) -> Self {
        let all = cell.setup.robot.joints();
        self.joints
            .extend(joints.iter().map(|j| all[*j].name.clone()));
        self
    }

    fn off(mut self, off: f64) -> Self {
        self.off_m = Some(off);
        self
    }

    fn misfit(mut self, before: f64, after: f64) -> Self {
        self.before_m = Some(before);
        self.after_m = Some(after);
        self
    }
}

/// Result of [`screen`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Screening {
    /// The findings, one per suspicion and in the same order.
    pub findings: Vec<Finding>,
    /// What they rest on.
    pub suspicions: Vec<Suspicion>,
    /// RMS distance of the unloaded points from the kinematic model after
    /// registration, postures that disagree left out \[m\]; `None` where too few
    /// points were read.
    pub unloaded_rms_m: Option<f64>,
    /// States whose points were held against the mean shape of the tool.
    pub states_checked: usize,
}

/// What the checks work on: cell and readings as corrected so far.
struct Work {
    cell: Cell,
    sheet: Sheet,
    found: Vec<Suspicion>,
    shape: mean_shape::LastShape,
}

impl Work {
    fn setup(&self) -> &Setup {
        &self.cell.setup
    }

    fn point_name(&self, a: usize) -> &String {
        &self.cell.setup.tool.measuring_points[a].name
    }

    /// Measuring points by the kinematic model, base frame \[m\].
    fn predicted(&self, q: &[f64]) -> Vec<Vector3<f64>> {
        predicted(&self.cell.setup, q)
    }
}

fn predicted(setup: &Setup, q: &[f64]) -> Vec<Vector3<f64>> {
    let frames = Frames::new(&setup.robot, q);
    let points = setup.tool.measuring_points.iter();
    points.map(|p| frames.point(&p.position)).collect()
}

/// Inspects raw readings. `base_from_tracker` is the registration where one is
/// known; the cell's own stands in. The same input gives the same result.
///
/// # Errors
/// A posture with a wrong number of angles, a coordinate or angle that is not
/// finite, or a reading at the tracker's station.
pub fn screen(
    cell: &Cell,
    table: &ReadingTable,
    base_from_tracker: Option<&Isometry3<f64>>,
) -> Result<Screening> {
    screen_series(cell, table, &PostureSeries::all(table), base_from_tracker)
}

/// [`screen`] of readings that are sorted already.
pub(super) fn screen_series(
    cell: &Cell,
    table: &ReadingTable,
    series: &[PostureSeries<'_>],
    base_from_tracker: Option<&Isometry3<f64>>,
) -> Result<Screening> {
    let given = base_from_tracker.or(cell.tracker.base_from_tracker.as_ref());
    let mut found = Vec::new();
    let sheet = Sheet::new(cell, table.wrench_columns, series, &mut found)?;
    let mut work = Work {
        cell: cell.clone(),
        sheet,
        found,
        shape: mean_shape::LastShape::default(),
    };
    shape::units(&mut work);
    // Strays first, so that they are not taken for faults of a posture; what
    // the shape alone cannot tell is settled once the frame is known.
    let states_checked = shape::strays(&mut work, false);
    shape::drawing(&mut work, true);
    let before = model::explain(&mut work, given);
    let frame = posture::explain(&mut work, before);
    shape::strays(&mut work, true);
    gross_error::settle(&mut work, frame.as_ref());
    shape::drawing(&mut work, false);
    motion::check(&mut work, frame.as_ref());
    let found = work.found;
    Ok(Screening {
        findings: found.iter().map(|s| messages::finding(cell, s)).collect(),
        suspicions: found,
        unloaded_rms_m: frame.map(|f| f.level),
        states_checked,
    })
}
