//! In what loads at work are unlike those that were measured.

use crate::error::Result;
use crate::estimate::saved::Saved;
use crate::findings::Finding;
use crate::model::cell::Cell;
use crate::model::kinematics::Frames;
use crate::model::load::Load;
use crate::model::observation::{PostureTerms, Setup, link_axes, on_first_axis};
use crate::units::{m_to_mm, rounded};
use nalgebra::{DMatrix, Matrix3, Rotation3, UnitVector3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// A load was never applied where the work applies so many times what the readings did.
const NEVER_LOADED_RATIO: f64 = 3.0;
/// So many times as much is not at all.
const NOT_LOADED_RATIO: f64 = 10.0;
/// Share of the load at a place from which on its direction matters.
const NOTABLE_SHARE: f64 = 0.2;
/// Along an axis within this cosine.
const ALONG_COSINE: f64 = 0.9;

/// A point of a prediction.
pub(crate) struct WorkRows {
    /// The arm under its load.
    pub(crate) terms: PostureTerms,
    /// Derivative of its shifts by the unknowns, rows × unknowns.
    pub(crate) rows: DMatrix<f64>,
    /// Sum of the squares of its shifts \[m²\].
    pub(crate) squares: f64,
    /// Variance of its shifts by all but the scatter of the unknowns, summed over the rows \[m²\].
    pub(crate) other: f64,
}

/// Loads of this size \[N\] that could be applied besides, in words: a weight, then others.
pub(super) fn further_loads(cell: &Cell, magnitude: f64) -> Vec<(String, Setup)> {
    let weight = cell.setup.under_weight(magnitude);
    let mut out = vec![(format!("A weight of {magnitude:.0} N hung"), weight)];
    let cases = cell.setup.cases();
    let anchors = cases.iter().filter_map(|setup| match setup.load {
        Load::Rope { anchor, .. } => Some(anchor),
        _ => None,
    });
    let frames = Frames::new(&cell.setup.robot, &vec![0.0; cell.setup.robot.joint_count()]);
    let (axis, origin) = (UnitVector3::new_normalize(frames.axes()[0]), on_first_axis(&frames));
    for anchor in anchors {
        for quarters in 1..4 {
            let turn = Rotation3::from_axis_angle(&axis, f64::from(quarters) * FRAC_PI_2);
            let anchor = origin + turn * (anchor - origin);
            let [x, y, z] = anchor.map(|v| rounded(m_to_mm(v), 0)).into();
            let words = format!("The rope from an anchor at [{x}, {y}, {z}] mm");
            let load = Load::Rope { anchor, magnitude };
            let setup = Setup { load, ..cell.setup.clone() };
            out.push((words, setup));
        }
    }
    out
}

/// What a place carries at work and what it carried in the readings, in words; nothing where these do not differ much.
pub(super) fn loaded(place: Option<usize>, by_force: bool, work: &[WorkRows], seen: &[PostureTerms]) -> String {
    let work = work.iter().map(|point| &point.terms);
    let Some(unlike) = LoadDifference::new(place, by_force, work, seen.iter()) else {
        return String::new();
    };
    let LoadDifference { now, then, .. } = unlike;
    if now < NEVER_LOADED_RATIO * then {
        return String::new();
    }
    let (verb, preposition, unit) = match by_force {
        true => ("pushed", "along", "N"),
        false => ("turned", "about", "N·m"),
    };
    let axis = unlike.axis(place);
    let axis = axis.map_or(String::new(), |axis| format!(" {preposition} {axis}"));
    format!(" ({verb}{axis} with {now:.0} {unit} here, {then:.0} {unit} in the readings)")
}

/// That no reading has turned the base about a direction about which the work does, where that is so: the model takes
/// what it gives there from elsewhere, and its bands cannot know better.
pub(super) fn never_turned(cell: &Cell, saved: &Saved, work: &[WorkRows], seen: &[PostureTerms]) -> Option<Finding> {
    let at_work = || work.iter().map(|point| &point.terms);
    let unlike = LoadDifference::new(None, false, at_work(), seen.iter())?;
    let LoadDifference { now, then, all, .. } = unlike;
    if now <= NOT_LOADED_RATIO * then || now < NOTABLE_SHARE * all {
        return None;
    }
    let mut remedy = String::new();
    for (load, setup) in further_loads(cell, saved.largest_force.unwrap_or_default()) {
        let terms = saved.loads.iter();
        let terms = terms.map(|seen_load| PostureTerms::new(&setup, &seen_load.q, None));
        let Ok(terms) = terms.collect::<Result<Vec<_>>>() else {
            continue;
        };
        let turned = unlike.size_of(&terms);
        if NEVER_LOADED_RATIO * turned > now {
            remedy = format!(" {load} in the same postures would turn it with {turned:.0} N·m.");
            break;
        }
    }
    let sentence = format!(
        "No reading has turned the base about {} ({then:.0} N·m, here {now:.0} N·m RMS): what it gives way there is \
         taken from what the rest of the arm does, and a base that is softer that way is not in the bands.{remedy}",
        unlike.axis(None).unwrap_or_default(),
    );
    Some(Finding::note("never-turned", "load", sentence))
}

/// The axis in which loads at a place at work differ most from those of the readings, RMS \[N or N·m\].
struct LoadDifference {
    by_force: bool,
    place: Option<usize>,
    /// In axes of the place.
    direction: Vector3<f64>,
    now: f64,
    then: f64,
    /// At work in all directions.
    all: f64,
}

impl LoadDifference {
    /// `None` without any load.
    fn new<'a>(
        place: Option<usize>,
        by_force: bool,
        work: impl Iterator<Item = &'a PostureTerms>,
        seen: impl Iterator<Item = &'a PostureTerms>,
    ) -> Option<Self> {
        let (at_work, read) = (squares(place, by_force, work), squares(place, by_force, seen));
        // What was not read at all counts as a hundredth of the work.
        let floor = (1e-4 * at_work.trace() / 3.0).max(f64::MIN_POSITIVE);
        let root = (read + Matrix3::identity() * floor).cholesky()?.l();
        let inverse = root.try_inverse()?;
        let eigen = (inverse * at_work * inverse.transpose()).symmetric_eigen();
        let most = eigen.eigenvectors.column(eigen.eigenvalues.imax());
        let direction = (inverse.transpose() * most).try_normalize(0.0)?;
        let along = |m: &Matrix3<f64>| direction.dot(&(m * direction)).max(0.0).sqrt();
        Some(LoadDifference {
            by_force,
            place,
            direction,
            now: along(&at_work),
            then: along(&read),
            all: at_work.trace().sqrt(),
        })
    }

    /// The same size of other loads.
    fn size_of(&self, terms: &[PostureTerms]) -> f64 {
        let squares = squares(self.place, self.by_force, terms.iter());
        self.direction.dot(&(squares * self.direction)).max(0.0).sqrt()
    }

    /// The axis in words; of a joint `None` where it is none of its own.
    fn axis(&self, place: Option<usize>) -> Option<String> {
        let most = self.direction.map(f64::abs).imax();
        let is_along = self.direction[most].abs() > ALONG_COSINE;
        match place {
            None if is_along => Some(["x", "y", "z"][most].to_string()),
            None => {
                let [x, y, z] = (self.direction * self.direction[most].signum()).into();
                Some(format!("the direction [{x:.2}, {y:.2}, {z:.2}]"))
            }
            Some(_) => is_along.then(|| OF_JOINT[most].to_string()),
        }
    }
}

/// Axes of a link in words.
const OF_JOINT: [&str; 3] = ["its link", "the direction across its axis and its link", "its axis"];

/// Mean square of the loads at a place.
fn squares<'a>(place: Option<usize>, by_force: bool, all: impl Iterator<Item = &'a PostureTerms>) -> Matrix3<f64> {
    let (mut sum, mut count) = (Matrix3::zeros(), 0.0);
    for terms in all {
        let load = load_at(terms, place, by_force);
        sum += load * load.transpose();
        count += 1.0;
    }
    sum / f64::max(count, 1.0)
}

/// Force or moment at a place, in its axes; the moment about a joint's own axis is none of it, nor that about
/// axis 1 at the base, which turns the joint.
fn load_at(terms: &PostureTerms, place: Option<usize>, by_force: bool) -> Vector3<f64> {
    let frames = terms.frames();
    let (axes, origin) = match place {
        Some(j) => (link_axes(frames, j), frames.origins()[j]),
        None => (Matrix3::identity(), on_first_axis(frames)),
    };
    let wrench = terms.wrench().moved(terms.loading_point(), &origin);
    let mut load = axes.tr_mul(&if by_force { wrench.force } else { wrench.moment });
    if !by_force {
        let axis = axes.tr_mul(&frames.axes()[place.unwrap_or(0)]);
        load -= axis * axis.dot(&load);
    }
    load
}
