//! What is said about wrong pairs and mirrored frames.

use super::super::fit::{Sample, rigid};
use super::{Cause, Explanation, Suspicion};
use crate::error::{Code, Error, Result};
use crate::findings::{Finding, Severity, list};
use crate::units::{m_to_mm, rad_to_deg};
use nalgebra::{Matrix3, Vector3};

/// Frames whose axes are nearer than this to parallel point to the axis that
/// is reversed \[deg\].
const PARALLEL_DEG: f64 = 10.0;

/// Metres in millimetres with three significant digits.
pub(in super::super) fn mm(m: f64) -> String {
    let mm = m_to_mm(m);
    if mm >= 99.95 {
        return format!("{mm:.0}");
    }
    let digits = match mm {
        v if v >= 9.995 => 1,
        v if v >= 0.9995 => 2,
        v if v >= 0.09995 => 3,
        _ => 4,
    };
    format!("{mm:.digits$}")
}

impl Suspicion {
    /// Refuses a mirrored frame.
    pub(in super::super) fn refuse_mirrored(&self, names: &[&str], samples: &[Sample]) -> Result<()> {
        let Some(mirrored) = self.mirrored() else {
            return Ok(());
        };
        let message = format!(
            "One of the frames seems to be mirrored: the residual RMS is {} mm, and {} mm with one axis reversed.",
            mm(self.plain.rms()),
            mm(mirrored.rms()),
        );
        let mut hint =
            "one frame is left-handed, an axis has the wrong sign, or two columns are exchanged; ".to_string();
        let slips = parallel_frames(samples);
        hint += &match slips.as_slice() {
            [] => "the points cannot tell which axis, for each one cures the residuals alike".to_string(),
            slips => format!(
                "first check {}: without that slip the axes of both frames are nearly parallel",
                slips.join(" or ")
            ),
        };
        let others: Vec<String> = self.likely().into_iter().map(|(cause, _)| cause.alternative(names)).collect();
        if !others.is_empty() {
            hint += &format!("; it may also be that {}", others.join(", or that "));
        }
        Err(Error::new(Code::Registration, message).hint(hint))
    }

    /// The wrong pair or pairs, where there are any.
    pub(in super::super) fn findings(&self, names: &[&str], samples: &[Sample]) -> Vec<Finding> {
        let Some(severity) = self.severity else {
            return Vec::new();
        };
        match self.likely().as_slice() {
            [] => Vec::new(),
            [(Cause::Swapped(i, j), one)] => {
                vec![self.swapped(severity, names[*i], names[*j], one)]
            }
            [(Cause::Outlier(i), one)] => {
                vec![self.outlier(severity, names[*i], &samples[*i], one)]
            }
            several => vec![self.undecided(severity, several, names)],
        }
    }

    fn swapped(&self, severity: Severity, a: &str, b: &str, one: &Explanation) -> Finding {
        let (before, after) = (mm(self.plain.rms()), mm(one.rms()));
        Finding::new(
            "swapped-points",
            severity,
            format!("{a}, {b}"),
            format!(
                "The points {a} and {b} seem to be swapped in one of the frames: exchanging them brings the residual \
                 RMS from {before} mm to {after} mm."
            ),
        )
    }

    fn outlier(&self, severity: Severity, name: &str, sample: &Sample, one: &Explanation) -> Finding {
        let (before, after) = (mm(self.plain.rms()), mm(one.rms()));
        let miss = mm(one.fit.residual(sample).norm());
        let expected =
            one.expected_miss(sample).map_or(String::new(), |miss| format!(" where {} mm are expected", mm(miss)));
        Finding::new(
            "outlier",
            severity,
            name,
            format!(
                "The point {name} does not fit the others: a fit without it misses it by {miss} mm{expected}, and \
                 brings the residual RMS from {before} mm to {after} mm. Measure it again, check its numbers, or leave \
                 it out."
            ),
        )
    }

    fn undecided(&self, severity: Severity, several: &[&(Cause, Explanation)], names: &[&str]) -> Finding {
        let mut involved: Vec<usize> = Vec::new();
        for (cause, _) in several {
            match *cause {
                Cause::Outlier(i) => involved.push(i),
                Cause::Swapped(i, j) => involved.extend([i, j]),
            }
        }
        involved.sort_unstable();
        involved.dedup();
        let subject: Vec<&str> = involved.iter().map(|i| names[*i]).collect();
        let outliers: Vec<&str> = (0..names.len())
            .filter(|i| several.iter().any(|(cause, _)| *cause == Cause::Outlier(*i)))
            .map(|i| names[i])
            .collect();
        let mut causes: Vec<String> = several
            .iter()
            .filter(|(cause, _)| matches!(cause, Cause::Swapped(..)))
            .map(|(cause, _)| cause.alternative(names))
            .collect();
        match outliers.as_slice() {
            [] => {}
            [one] => causes.insert(0, format!("{one} is wrong")),
            some => causes.insert(0, format!("one of {} is wrong", list(some))),
        }
        Finding::new(
            "outlier",
            severity,
            subject.join(", "),
            format!(
                "The pairs do not fit each other (residual RMS {} mm): {}. The residuals cannot tell which; one more \
                 pair can.",
                mm(self.plain.rms()),
                causes.join(", or ")
            ),
        )
    }
}

impl Cause {
    /// The cause as a clause.
    fn alternative(self, names: &[&str]) -> String {
        match self {
            Cause::Swapped(i, j) => format!("{} and {} are swapped", names[i], names[j]),
            Cause::Outlier(i) => format!("{} is wrong", names[i]),
        }
    }
}

impl Explanation {
    /// RMS distance \[m\] at which noise alone puts a pair that took no part in
    /// this fit; `None` where the fit leaves a turn free.
    fn expected_miss(&self, sample: &Sample) -> Option<f64> {
        if self.fit.rank() < 6 {
            return None;
        }
        let inverse = self.fit.inertia.cholesky()?.inverse();
        let lever = (self.fit.pose.rotation * (sample.tracker - self.fit.tracker_centroid)).cross_matrix();
        let turn = lever * inverse * lever.transpose();
        let variance = self.fit.rss / self.degrees_of_freedom as f64;
        let translation = 3.0 / sample.weight + 3.0 / self.fit.weight;
        Some((variance * (translation + turn.trace())).sqrt())
    }
}

/// The slips of hand, reversed axes and exchanged columns of the tracker, that
/// leave the frames nearly parallel when they are undone.
fn parallel_frames(samples: &[Sample]) -> Vec<String> {
    let slips = axis_slips(|undo| {
        let undone: Vec<Sample> = samples.iter().map(|s| Sample { tracker: undo * s.tracker, ..*s }).collect();
        rigid(&undone).map_or(f64::INFINITY, |fit| fit.pose.rotation.angle())
    });
    slips.into_iter().map(|(said, _)| said).collect()
}

/// The slips of hand that mirror a frame, a reversed axis or two exchanged columns, with what undoes
/// each: those with which `turn` \[rad\] is small.
pub(crate) fn axis_slips(turn: impl Fn(&Matrix3<f64>) -> f64) -> Vec<(String, Matrix3<f64>)> {
    let axes = ["x", "y", "z"];
    let mut slips: Vec<(String, Matrix3<f64>)> = Vec::new();
    for i in 0..3 {
        let mut sign = Vector3::repeat(1.0);
        sign[i] = -1.0;
        slips.push((format!("the sign of {}", axes[i]), Matrix3::from_diagonal(&sign)));
    }
    for (i, j) in [(0, 1), (1, 2), (0, 2)] {
        let mut exchange = Matrix3::identity();
        exchange.swap_columns(i, j);
        slips.push((format!("whether {} and {} are exchanged", axes[i], axes[j]), exchange));
    }
    slips.retain(|(_, undo)| rad_to_deg(turn(undo)) < PARALLEL_DEG);
    slips
}
