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
mod moved;
mod posture;
mod rigid;
mod scale;
mod severity;
mod shape;
mod sheet;
mod sizes;
mod slip;
mod states;
mod tool;

use super::reduction::stations;
use super::series::PostureSeries;
use crate::error::Result;
use crate::findings::Finding;
use crate::model::cell::Cell;
use crate::model::kinematics::Frames;
use crate::model::measurement::{MeasuredPosture, ReadingTable};
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
    /// Denavit–Hartenberg rows meant in the other convention.
    DhConvention,
    /// A constant offset of a joint angle.
    JointOffset,
    /// All measuring points, and the tool with them, sit elsewhere on the flange than the cell says.
    ToolPlace,
    /// Joint angles in radians under a heading in degrees.
    Radians,
    /// The transform that is given for the tracker does not fit the readings.
    GivenTransform,
    /// The tracker, or the robot, stands elsewhere from a posture on.
    MovedTracker,
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
    /// Loads or forces of the whole table, or of the cell, in another unit.
    LoadUnits,
    /// The load of single states typed in another unit or with a slipped decimal point.
    LoadEntry,
    /// Moments in another unit than the forces.
    MomentUnits,
    /// Displacements in another unit than stated.
    DisplacementUnits,
    /// The prior stiffness in another unit than stated.
    PriorUnits,
    /// The anchor of rope or cylinder in another unit than stated.
    AnchorUnits,
    /// The loading point in another unit than stated.
    LoadingPointUnits,
    /// The robot's own lengths in another unit than stated.
    RobotUnits,
    /// States filed under another load case than they were taken under.
    ExchangedLoadCases,
    /// Joint angles in degrees under a heading in radians.
    Degrees,
    /// Too few readings for the checks against the kinematic model.
    NotChecked,
}

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
            ratio: None,
            misfits: None,
            axis_slips: Vec::new(),
            confirmed_by: Vec::new(),
            evidence: None,
            angles_deg: Vec::new(),
            tool_shift_mm: Vec::new(),
            divided: Vec::new(),
            station: None,
            likely_station: None,
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

impl Screening {
    /// The findings about scales: numbers off by a factor, load cases exchanged. What a fit says
    /// besides mostly follows from them.
    pub fn scales(&self) -> impl Iterator<Item = &Finding> {
        let both = self.suspicions.iter().zip(&self.findings);
        both.filter(|(s, _)| s.cause.is_scale()).map(|(_, f)| f)
    }
}

/// What the checks work on: cell and readings as corrected so far.
struct Work {
    cell: Cell,
    sheet: Sheet,
    found: Vec<Suspicion>,
    shape: mean_shape::LastShape,
    /// The wrenches point the other way than stated.
    reversed: bool,
    /// The positions are displacements.
    is_displacements: bool,
}

impl Work {
    fn new(cell: &Cell, sheet: Sheet, found: Vec<Suspicion>) -> Self {
        Work {
            cell: cell.clone(),
            sheet,
            found,
            shape: mean_shape::LastShape::default(),
            reversed: false,
            is_displacements: false,
        }
    }

    /// Cell and readings to try a correction on.
    fn to_try(&self) -> Self {
        Work {
            reversed: self.reversed,
            is_displacements: self.is_displacements,
            ..Work::new(&self.cell, self.sheet.clone(), Vec::new())
        }
    }

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
    let mut table = table.clone();
    stations::in_one_frame(cell, &mut table, base_from_tracker)?;
    screen_series(cell, &table, &PostureSeries::all(&table), base_from_tracker)
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
    let as_read = sheet.clone();
    let mut work = Work::new(cell, sheet, found);
    shape::units(&mut work);
    if work.found.iter().any(|s| s.cause == Cause::RobotUnits) {
        // Nothing can be held against such a robot.
        return Ok(Screening {
            findings: work
                .found
                .iter()
                .map(|s| messages::finding(cell, s))
                .collect(),
            suspicions: work.found,
            unloaded_rms_m: None,
            states_checked: 0,
        });
    }
    // Strays first, so that they are not taken for faults of a posture; what
    // the shape alone cannot tell is settled once the frame is known.
    let states_checked = shape::strays(&mut work, false);
    shape::drawing(&mut work, true);
    let before = model::explain(&mut work, given);
    let frame = posture::explain(&mut work, before);
    shape::strays(&mut work, true);
    gross_error::settle(&mut work, frame.as_ref());
    shape::drawing(&mut work, false);
    if let Some(frame) = &frame {
        scale::check(&mut work, &frame.base_from_tracker);
    }
    motion::check(&mut work, frame.as_ref());
    let mut found = work.found;
    let findings = found.iter().map(|s| messages::finding(cell, s)).collect();
    for suspicion in &mut found {
        as_read.add_lines(cell, suspicion);
    }
    Ok(Screening {
        findings,
        suspicions: found,
        unloaded_rms_m: frame.map(|f| f.level),
        states_checked,
    })
}

/// What the scales of a table of displacements say: their unit and that of the
/// loads, of the angles and of the prior, load cases exchanged, an anchor in
/// another unit. The other checks need raw readings.
///
/// # Errors
/// A posture with a wrong number of angles, or a number that is not finite.
pub fn screen_displacements(cell: &Cell, measured: &[MeasuredPosture]) -> Result<Screening> {
    let sheet = Sheet::of_displacements(cell, measured)?;
    let mut work = Work::new(cell, sheet, Vec::new());
    // The wrenches of such a table are in base axes, whoever measured them.
    work.cell.sensor = None;
    work.is_displacements = true;
    scale::check(&mut work, &Isometry3::identity());
    let found = work.found;
    Ok(Screening {
        findings: found.iter().map(|s| messages::finding(cell, s)).collect(),
        suspicions: found,
        unloaded_rms_m: None,
        states_checked: 0,
    })
}
