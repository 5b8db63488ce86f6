//! The joints of an identification: how well each is known, and the table of it.

use crate::identified::StiffnessRow;
use crate::level::level;
use crate::summary::{Context, DataTable, Number, Outcome, Quantity, Text};
use stiffarm::estimate::identify::{Estimates, JointEstimate, LARGEST_HALF_WIDTH, Verdict, WELL_KNOWN_HALF_WIDTH};
use stiffarm::estimate::systematic::{JointUncertainty, SystematicErrors};
use stiffarm::findings::{list, visible};

/// Names of so many letters are not broken.
const SHORT: usize = 16;
/// Parts of a ± from this share of k on say nothing.
const NOTHING: f64 = 1.0;

/// The joints of a result, with a free or a fixed flange.
pub(super) struct Joints<'a> {
    pub context: &'a Context<'a>,
    pub estimates: &'a Estimates,
    pub systematic_errors: Option<&'a SystematicErrors>,
    /// Something about the data is so wrong that no value counts.
    pub unusable: bool,
}

impl<'a> Joints<'a> {
    /// All joints.
    pub fn all(&self) -> &'a [JointEstimate] {
        &self.estimates.joints
    }

    /// The name of a joint as it is shown.
    pub fn name(&self, j: usize) -> String {
        visible(&self.all()[j].name).into_owned()
    }

    /// Names of rows, the short ones on a line each.
    pub fn row_names(&self) -> impl Iterator<Item = String> {
        let names = (0..self.all().len()).map(|j| self.name(j));
        names.map(|name| if name.chars().count() <= SHORT { name.replace(' ', "\u{a0}") } else { name })
    }

    /// With all errors, where they are in the result.
    fn errors(&self, j: usize) -> Option<&'a JointUncertainty> {
        self.systematic_errors?.uncertainty.get(j)
    }

    /// The half width as a number in percent.
    pub fn total(&self, j: usize) -> Number {
        let number = match self.errors(j) {
            Some(uncertainty) => Number::new(uncertainty.total),
            None => Number::computed(self.all()[j].half_width),
        };
        number.of(Quantity::PERCENT)
    }

    /// The interval that the table and the figure show \[N·m/rad\].
    fn interval(&self, j: usize) -> [Option<f64>; 2] {
        match self.errors(j) {
            Some(uncertainty) => uncertainty.interval_nm_per_rad,
            None => self.all()[j].interval,
        }
    }

    /// An end of the interval.
    pub fn end(&self, j: usize, i: usize) -> Number {
        Number::new(self.interval(j)[i]).of(Quantity::STIFFNESS.digits(3))
    }

    /// The outcome with what the joints say: findings do not name every joint without a ±.
    pub fn outcome(&self, outcome: Outcome) -> Outcome {
        match outcome {
            Outcome::Good if !self.of(|verdict| !is_within(verdict)).is_empty() => Outcome::Caution,
            outcome => outcome,
        }
    }

    /// Joints of a verdict.
    pub fn of(&self, is: impl Fn(Verdict) -> bool) -> Vec<usize> {
        let all = 0..self.all().len();
        all.filter(|j| is(self.all()[*j].verdict)).collect()
    }

    /// Their names in words.
    pub fn names(&self, joints: &[usize]) -> String {
        let names: Vec<String> = joints.iter().map(|j| self.name(*j)).collect();
        list(&names)
    }

    /// The table to read first.
    pub fn key(&self) -> DataTable {
        let with = self.systematic_errors.is_some();
        let limit = format!("of at most {:.0} %", 100.0 * WELL_KNOWN_HALF_WIDTH);
        let meant = match (self.unusable, with) {
            (true, _) => "from the data as they are".to_string(),
            (false, true) => format!("known means a total ± {limit}"),
            (false, false) => {
                format!("known means a ± {limit}, here by the scatter of the readings alone")
            }
        };
        let caption =
            format!("Joint stiffness with its ± at {} % confidence; {meant}", level(self.estimates.confidence));
        let usable = |j: usize| {
            let verdict = self.all()[j].verdict;
            !matches!(verdict, Verdict::Undetermined | Verdict::SignOrModelFault)
        };
        let part = |j: usize, of: fn(&JointUncertainty) -> Option<f64>| {
            let uncertainty = self.errors(j).filter(|_| usable(j));
            let part = uncertainty.and_then(of).filter(|part| *part < NOTHING);
            part.map(Number::new)
        };
        let total = if with { "± total" } else { "± readings" };
        DataTable::of(caption, "joint", self.row_names())
            .numbers("k", Quantity::STIFFNESS, |j| Some(Number::new(self.all()[j].stiffness)))
            .numbers(total, Quantity::PERCENT, |j| {
                let half = self.all()[j].half_width.filter(|half| *half < LARGEST_HALF_WIDTH);
                half.filter(|_| usable(j)).map(|_| self.total(j))
            })
            .numbers("± readings", Quantity::PERCENT, |j| part(j, |uncertainty| uncertainty.statistical))
            .numbers("± systematic", Quantity::PERCENT, |j| part(j, |uncertainty| uncertainty.systematic))
            .words("largest source", |j| {
                let uncertainty = self.errors(j).filter(|_| usable(j));
                let name = uncertainty.and_then(|uncertainty| uncertainty.largest_source.as_ref());
                let source = self.systematic_errors.zip(name).map(|(systematic, name)| source(systematic, name));
                source.unwrap_or_default().into()
            })
            .words("verdict", |j| self.verdict(j))
    }

    /// The verdict on a joint in a few words, or the ends of its interval where they are too far apart for a ±.
    fn verdict(&self, j: usize) -> Text {
        // In the unit of k, whose column is beside it.
        let end = |i: usize| self.end(j, i).bare();
        let verdict = self.all()[j].verdict;
        let valued = is_within(verdict) || is_wide(verdict);
        let words = match verdict {
            _ if valued && self.unusable => return Text::new("not to be used"),
            Verdict::Determined => return Text::new("known"),
            Verdict::HardlyKnown => {
                return Text::default().number(end(0)).words(" to ").number(end(1));
            }
            Verdict::LowerBoundOnly => return Text::new("above ").number(end(0)),
            Verdict::Weak => "weak",
            Verdict::NotByItself => "not by itself",
            Verdict::SignOrModelFault => "negative",
            Verdict::NoInterval => "no interval",
            Verdict::Undetermined => "not determined",
        };
        Text::default().strong(words)
    }

    /// Rows of the figure.
    pub fn rows(&self) -> Vec<StiffnessRow> {
        let rows = self.all().iter().enumerate().map(|(j, joint)| {
            let uncertainty = self.errors(j);
            StiffnessRow {
                joint: self.name(j),
                stiffness: joint.stiffness,
                statistical: match uncertainty {
                    Some(uncertainty) => uncertainty.statistical,
                    None => joint.half_width,
                },
                systematic: uncertainty.and_then(|uncertainty| uncertainty.systematic),
                total: joint.half_width,
                interval: self.interval(j),
            }
        });
        rows.collect()
    }
}

/// Whether a joint of this verdict has a ±.
pub(super) fn is_within(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Determined | Verdict::Weak)
}

/// Whether it has an interval, too wide for a ±.
pub(super) fn is_wide(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::HardlyKnown | Verdict::LowerBoundOnly)
}

/// A source in words, with a star where its size is assumed.
fn source(systematic: &SystematicErrors, name: &str) -> String {
    let source = systematic.sources.iter().find(|source| source.name == name);
    let star = match source {
        Some(source) if !source.declared => " *",
        _ => "",
    };
    let words = format!("{}{star}", name.replace('-', " "));
    visible(&words).replace(' ', "\u{a0}")
}
