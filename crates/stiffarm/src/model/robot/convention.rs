//! Denavit–Hartenberg rows that may be meant in the other convention.

use super::dh;
use super::{CatalogueEntry, DhConvention, DhRow, Robot, catalogue};
use nalgebra::Isometry3;

/// An arm that is no farther than this from a robot of the catalogue is one like it, and one farther than that is like
/// none: among the catalogue's own robots the nearest other is at 0.25 or less, and at 1.07 or more where its rows are
/// read in the wrong convention.
const LIKE_DISTANCE: f64 = 0.35;
const UNLIKE_DISTANCE: f64 = 0.7;
/// Sine of a twist below which axes count as parallel: where their common normal lies is then nobody's choice.
const PARALLEL_SINE: f64 = 1e-2;

impl DhConvention {
    /// The one that it is not.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            DhConvention::Modified => DhConvention::Standard,
            DhConvention::Standard => DhConvention::Modified,
        }
    }

    /// As options and messages call it.
    pub fn name(self) -> &'static str {
        match self {
            DhConvention::Modified => "modified",
            DhConvention::Standard => "standard",
        }
    }

    /// The rows whose α and a lie between two neighbouring axes.
    pub fn between_axes(self, rows: &[DhRow]) -> &[DhRow] {
        let between = match self {
            DhConvention::Modified => rows.get(1..),
            DhConvention::Standard => rows.split_last().map(|(_, before)| before),
        };
        between.unwrap_or_default()
    }
}

/// What of an arm does not depend on how its frames are chosen: the lengths between axes and along them \[m\], and the
/// sines of the twists.
struct Form {
    lengths: Vec<f64>,
    twists: Vec<f64>,
}

impl Form {
    fn new(convention: DhConvention, rows: &[DhRow]) -> Self {
        let links = convention.between_axes(rows);
        let twists: Vec<f64> = links.iter().map(|row| row.alpha.sin().abs()).collect();
        let mut along: Vec<f64> = rows.iter().map(|row| row.d).collect();
        for (i, link) in links.iter().enumerate().skip(1) {
            if twists[i] < PARALLEL_SINE {
                along[i + 1] = along[i + 1] * link.alpha.cos().signum() + along[i];
                along[i] = 0.0;
            }
        }
        // Where the first and the last frame lie along their axes says nothing of the arm.
        let inner = along.len().saturating_sub(1);
        let along = along.into_iter().take(inner).skip(1);
        let lengths = links.iter().map(|row| row.a).chain(along);
        Form { lengths: lengths.map(f64::abs).collect(), twists }
    }

    /// Differences of all lengths as shares of the arm's, and of the twists.
    fn distance(&self, other: &Form) -> f64 {
        let total: f64 = other.lengths.iter().sum();
        let squares = |a: &[f64], b: &[f64], unit: f64| -> f64 {
            let both = a.iter().zip(b);
            both.map(|(a, b)| ((a - b) / unit).powi(2)).sum()
        };
        let lengths = squares(&self.lengths, &other.lengths, total);
        (lengths + squares(&self.twists, &other.twists, 1.0)).sqrt()
    }
}

/// The robot of the catalogue that is most like these rows, and how far it is from them.
fn nearest(convention: DhConvention, rows: &[DhRow]) -> Option<(f64, &'static CatalogueEntry)> {
    let form = Form::new(convention, rows);
    let candidates = catalogue().iter().filter_map(|entry| {
        let others = entry.dh_rows();
        let is_alike = others.len() == rows.len();
        is_alike.then(|| (form.distance(&Form::new(entry.convention, &others)), entry))
    });
    candidates.min_by(|a, b| a.0.total_cmp(&b.0))
}

impl Robot {
    /// Convention of the rows that it was built from.
    pub fn convention(&self) -> DhConvention {
        self.convention
    }

    /// The robot of the catalogue that is like this arm if its rows are read in the other convention, where read as
    /// they are it is like none.
    pub fn like_in_other_convention(&self) -> Option<&'static CatalogueEntry> {
        let (current, _) = nearest(self.convention, &self.rows)?;
        let (other, entry) = nearest(self.convention.other(), &self.rows)?;
        (current > UNLIKE_DISTANCE && other < LIKE_DISTANCE).then_some(entry)
    }

    /// The robot of the same rows read in the other convention; base, flange and tilts stay.
    pub(crate) fn in_other_convention(&self) -> Option<Robot> {
        let base = Isometry3::identity();
        let chain = |convention| dh::chain(convention, &self.rows, base).ok();
        let (current, current_end) = chain(self.convention)?;
        let (other, other_end) = chain(self.convention.other())?;
        let mut robot = self.clone();
        robot.convention = self.convention.other();
        for (i, joint) in robot.joints.iter_mut().enumerate() {
            // The base stands before the first row, a tilt behind each.
            joint.placement = match i {
                0 => joint.placement * current[i].inverse() * other[i],
                _ => other[i] * (current[i].inverse() * joint.placement),
            };
        }
        robot.flange = other_end * (current_end.inverse() * robot.flange);
        Some(robot)
    }
}
