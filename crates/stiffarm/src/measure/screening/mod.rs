//! Screening before statistics: what is wrong with a table of raw readings, by
//! posture, state and point, with the likely cause.
//!
//! Suspects are tried, not guessed: what people get wrong (two points exchanged, a sign, a mistyped angle, exchanged
//! rows, a mirrored frame, a unit, …) are slips, each with what undoes it. One is named when undoing it
//! divides the misfit by five and brings it to what the other postures have; a slip with a fitted number must do
//! three times better than one without. Where several explain a fault alike, all are named. Checks go on with the
//! corrected readings, so that one fault does not hide another; nothing is corrected for the user.
//!
//! What cannot be seen: a fault that a rigid motion of the tracker explains
//! (an offset of joint 1 of a standing robot), and with a flat tool a reading
//! that strays across its plane, unless the motion under load tells.

mod cause;
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
mod shape;
mod sheet;
mod slip;
mod states;
mod suspicion;
mod tool;
mod units;
mod words;

pub use cause::Cause;
pub use suspicion::{Evidence, Suspicion};

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
use slip::Slip;

/// A correction is believed when it divides the misfit by at least this.
const BELIEVED_RATIO: f64 = 5.0;
/// Explanations whose misfit lies within this factor of the best explain alike.
const ALIKE_MISFIT_RATIO: f64 = 2.0;
/// A number that was fitted to the readings must divide the misfit by this much
/// more than a cause that leaves nothing to fit.
const FITTED_RATIO: f64 = 3.0;

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
    suspicions: Vec<Suspicion>,
    shape: mean_shape::LastShape,
    /// The wrenches point the other way than stated.
    reversed: bool,
    /// The positions are displacements.
    is_displacements: bool,
}

impl Work {
    fn new(cell: &Cell, sheet: Sheet, suspicions: Vec<Suspicion>) -> Self {
        Work {
            cell: cell.clone(),
            sheet,
            suspicions,
            shape: mean_shape::LastShape::default(),
            reversed: false,
            is_displacements: false,
        }
    }

    /// Cell and readings with a slip undone, to see what is left.
    fn without(&self, slip: &Slip) -> Self {
        let mut out = Work {
            reversed: self.reversed,
            is_displacements: self.is_displacements,
            ..Work::new(&self.cell, self.sheet.clone(), Vec::new())
        };
        slip.undo(&mut out);
        out
    }

    /// Notes a slip and goes on without it.
    fn undo(&mut self, slip: &Slip, suspicion: Suspicion) {
        self.suspicions.push(suspicion);
        slip.undo(self);
    }

    /// All that was found, by what `cell` and readings say as they stand.
    fn screening(self, cell: &Cell, as_read: &Sheet) -> Screening {
        let mut suspicions = self.suspicions;
        let findings = suspicions.iter().map(|s| messages::finding(cell, s));
        let findings = findings.collect();
        suspicions.iter_mut().for_each(|s| as_read.add_lines(cell, s));
        Screening { findings, suspicions, unloaded_rms_m: None, states_checked: 0 }
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
pub fn screen(cell: &Cell, table: &ReadingTable, base_from_tracker: Option<&Isometry3<f64>>) -> Result<Screening> {
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
    let stated_transform = base_from_tracker.or(cell.tracker.base_from_tracker.as_ref());
    let mut suspicions = Vec::new();
    let sheet = Sheet::new(cell, table.wrench_columns, series, &mut suspicions)?;
    let as_read = sheet.clone();
    let mut work = Work::new(cell, sheet, suspicions);
    shape::units(&mut work);
    if work.suspicions.iter().any(|s| s.cause == Cause::RobotUnits) {
        // Nothing can be held against such a robot.
        return Ok(work.screening(cell, &as_read));
    }
    // Strays first, so that they are not taken for faults of a posture; what
    // the shape alone cannot tell is settled once the frame is known.
    let states_checked = shape::strays(&mut work, false);
    shape::drawing(&mut work, true);
    let before = model::explain(&mut work, stated_transform);
    let frame = posture::explain(&mut work, before);
    shape::strays(&mut work, true);
    gross_error::settle(&mut work, frame.as_ref());
    shape::drawing(&mut work, false);
    if let Some(frame) = &frame {
        scale::check(&mut work, &frame.base_from_tracker);
    }
    motion::check(&mut work, frame.as_ref());
    Ok(Screening { unloaded_rms_m: frame.map(|f| f.level), states_checked, ..work.screening(cell, &as_read) })
}

/// What the scales of a table of displacements say: their unit and that of the
/// loads, of the angles and of the prior, load cases exchanged, an anchor in
/// another unit. The other checks need raw readings.
///
/// # Errors
/// A posture with a wrong number of angles, or a number that is not finite.
pub fn screen_displacements(cell: &Cell, measured: &[MeasuredPosture]) -> Result<Screening> {
    let sheet = Sheet::of_displacements(cell, measured)?;
    let as_read = sheet.clone();
    let mut work = Work::new(cell, sheet, Vec::new());
    // The wrenches of such a table are in base axes, whoever measured them.
    work.cell.sensor = None;
    work.is_displacements = true;
    scale::check(&mut work, &Isometry3::identity());
    Ok(work.screening(cell, &as_read))
}
