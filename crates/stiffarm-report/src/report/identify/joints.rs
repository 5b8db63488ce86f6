//! The joints of an identification: how well each is known, and the table of it.

use crate::identified::StiffnessRow;
use crate::page::{DataTable, Number, Outcome, Text};
use crate::report::context::Context;
use stiffarm::estimate::identify::{Estimates, JointEstimate, Verdict};
use stiffarm::estimate::systematic::{JointUncertainty, SystematicErrors};
use stiffarm::findings::{list, visible};

/// A joint is known well where its total ± is at most this fraction of k.
pub(super) const WELL: f64 = 0.1;
/// From this fraction of k on there is no ±: 1/H is far from linear there.
const NO_LONGER: f64 = 0.5;

/// Heading of the ± by the scatter of the readings.
const READINGS: &str = "± readings [%]";

/// Names of so many letters are not broken.
const SHORT: usize = 16;

/// How well a joint is known.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Grade {
    /// Its ± is small.
    Known,
    /// Its ± is large.
    Weak,
    /// Hardly more than its size.
    Hardly,
    /// Only a lower bound.
    Bound,
    /// Only together with other unknowns.
    Together(Vec<String>),
    /// A negative compliance.
    Fault,
    /// Nothing says how sure it is.
    Unsure,
    /// With all errors not even a bound.
    NoValue,
    /// Not at all.
    Undetermined,
}

/// The joints of a result, with a free or a fixed flange.
pub(super) struct Joints<'a> {
    pub context: &'a Context<'a>,
    pub estimates: &'a Estimates,
    pub budget: Option<&'a SystematicErrors>,
    /// Something is so wrong that no value counts.
    pub serious: bool,
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

    /// With all errors, where they are in the result.
    pub fn errors(&self, j: usize) -> Option<&'a JointUncertainty> {
        self.budget?.uncertainty.get(j)
    }

    /// Half width of a joint's stiffness (fraction of k): with all errors where they are known, else by the scatter
    /// of the readings.
    pub fn half_width(&self, j: usize) -> Option<f64> {
        match self.errors(j) {
            Some(own) => own.total,
            None => self.scatter(j),
        }
    }

    /// The same by the scatter of the readings alone.
    fn scatter(&self, j: usize) -> Option<f64> {
        let joint = &self.all()[j];
        // The lower end of k is 1/(H + half width).
        Some(joint.stiffness? / joint.interval[0]? - 1.0)
    }

    /// The half width as a number in percent.
    pub fn total(&self, j: usize) -> Number {
        let number = match self.errors(j) {
            Some(_) => self.error(j, "total"),
            None => Number::new("", self.scatter(j)),
        };
        number.percent().significant(2)
    }

    /// One number of the errors of a joint.
    fn error(&self, j: usize, key: &str) -> Number {
        self.context
            .number(&format!("/budget/uncertainty/{j}/{key}"))
    }

    /// How well a joint is known.
    pub fn grade(&self, j: usize) -> Grade {
        let joint = &self.all()[j];
        let sets = &self.estimates.collinear;
        if let Some(set) = sets.iter().find(|set| set.unknowns.contains(&joint.name)) {
            let others = set.unknowns.iter().filter(|name| **name != joint.name);
            return Grade::Together(others.map(|name| visible(name).into_owned()).collect());
        }
        match (joint.verdict, self.half_width(j)) {
            (Verdict::Undetermined, _) => Grade::Undetermined,
            (Verdict::SignOrModelFault, _) => Grade::Fault,
            (Verdict::LowerBoundOnly, _) if self.has_end(j) => Grade::Bound,
            (Verdict::LowerBoundOnly, _) => Grade::NoValue,
            (Verdict::NoInterval, _) | (_, None) => Grade::Unsure,
            (_, Some(half)) if half <= WELL => Grade::Known,
            (_, Some(half)) if half < NO_LONGER => Grade::Weak,
            _ => Grade::Hardly,
        }
    }

    /// Whether the interval has a lower end: with all errors where they are known.
    fn has_end(&self, j: usize) -> bool {
        let ends = match self.errors(j) {
            Some(own) => own.interval_nm_per_rad,
            None => self.all()[j].interval,
        };
        ends[0].is_some()
    }

    /// An end of the interval.
    pub fn end(&self, j: usize, i: usize) -> Number {
        let below = match self.errors(j) {
            Some(_) => format!("/budget/uncertainty/{j}/interval_nm_per_rad/{i}"),
            None => format!("/joints/{j}/interval/{i}"),
        };
        let number = self.context.number(&below).mega();
        number.unit("MN·m/rad").significant(3)
    }

    /// The outcome with what the joints say: findings do not name a joint without a value.
    pub fn outcome(&self, found: Outcome) -> Outcome {
        let any = |is: &dyn Fn(&Grade) -> bool| !self.of(is).is_empty();
        if any(&|grade| *grade == Grade::Fault) {
            return Outcome::Serious;
        }
        match found {
            Outcome::Good if any(&|grade| !matches!(grade, Grade::Known | Grade::Weak)) => {
                Outcome::Caution
            }
            found => found,
        }
    }

    /// Joints of a grade.
    pub fn of(&self, is: impl Fn(&Grade) -> bool) -> Vec<usize> {
        let all = 0..self.all().len();
        all.filter(|j| is(&self.grade(*j))).collect()
    }

    /// Their names in words.
    pub fn names(&self, joints: &[usize]) -> String {
        let names: Vec<String> = joints.iter().map(|j| self.name(*j)).collect();
        list(&names)
    }

    /// The table to read first.
    pub fn key(&self) -> DataTable {
        let level = level(self.estimates.confidence);
        let with = self.budget.is_some();
        let mut headings = vec![
            "joint".to_string(),
            "k [10⁶ N·m/rad]".to_string(),
            match with {
                true => "± total [%]".to_string(),
                false => READINGS.to_string(),
            },
        ];
        if with {
            let more = [READINGS, "± systematic [%]", "largest source"];
            headings.extend(more.map(String::from));
        }
        headings.push("verdict".to_string());
        let meant = match (self.serious, with) {
            (true, _) => "from the data as they are, not to be used".to_string(),
            (false, true) => format!("known means a total ± of at most {:.0} %", 100.0 * WELL),
            (false, false) => format!(
                "known means a ± of at most {:.0} %, here by the scatter of the readings alone",
                100.0 * WELL
            ),
        };
        let mut table = DataTable::new(
            format!("Joint stiffness with its ± at {level} % confidence; {meant}"),
            headings,
        );
        for (j, joint) in self.all().iter().enumerate() {
            let at = |key: &str| self.context.number(&format!("/joints/{j}/{key}"));
            let shown = |part: Option<f64>, number: Number| -> Text {
                match part {
                    Some(part) if part < 1.0 => number.bare().into(),
                    _ => "–".into(),
                }
            };
            let usable = !matches!(
                joint.verdict,
                Verdict::Undetermined | Verdict::SignOrModelFault
            );
            let mut cells: Vec<Text> = vec![at("stiffness").mega().bare().into()];
            let half = self
                .half_width(j)
                .filter(|half| usable && *half < NO_LONGER);
            cells.push(shown(half, self.total(j)));
            if let (true, Some(budget)) = (with, self.budget) {
                let own = self.errors(j).filter(|_| usable);
                let part = |key: &str| self.error(j, key).percent().significant(2);
                cells.push(shown(own.and_then(|o| o.statistical), part("statistical")));
                cells.push(shown(own.and_then(|o| o.systematic), part("systematic")));
                let largest = own.and_then(|own| own.largest_source.as_ref());
                let source = largest.map_or_else(String::new, |name| source(budget, name));
                cells.push(visible(&source).into_owned().into());
            }
            cells.push(self.verdict(j));
            // A short name stays on its line.
            let name = self.name(j);
            let name = match name.chars().count() <= SHORT {
                true => name.replace(' ', "\u{a0}"),
                false => name,
            };
            table.row(name, cells);
        }
        table
    }

    /// The verdict on a joint, with the ends of its interval where there is no ±.
    fn verdict(&self, j: usize) -> Text {
        let end = |i: usize| self.end(j, i);
        match self.grade(j) {
            Grade::Known | Grade::Weak | Grade::Hardly | Grade::Bound if self.serious => {
                Text::new("settle what is wrong first")
            }
            Grade::Known => Text::new("known"),
            Grade::Weak => Text::default().strong("weak"),
            Grade::Hardly if end(1).value.is_some() => Text::default()
                .strong("hardly known")
                .words(": ")
                .number(end(0).bare())
                .words(" to ")
                .number(end(1)),
            Grade::Hardly | Grade::Bound => Text::default()
                .strong("only a lower bound")
                .words(": above ")
                .number(end(0)),
            Grade::Together(others) => Text::default()
                .strong("not by itself")
                .words(format!(": only together with {}", list(&others))),
            Grade::Fault => Text::default()
                .strong("comes out negative")
                .words(": sign or model fault"),
            Grade::Unsure => Text::default()
                .strong("no interval")
                .words(": nothing says how sure it is"),
            Grade::NoValue => Text::default().strong("no usable value"),
            Grade::Undetermined => Text::default().strong("not determined"),
        }
    }

    /// Rows of the figure.
    pub fn rows(&self) -> Vec<StiffnessRow> {
        let rows = self.all().iter().enumerate().map(|(j, joint)| {
            let own = self.errors(j);
            StiffnessRow {
                joint: self.name(j),
                stiffness: joint.stiffness,
                statistical: match own {
                    Some(own) => own.statistical,
                    None => self.scatter(j),
                },
                systematic: own.and_then(|own| own.systematic),
                total: match own {
                    Some(own) => own.total,
                    None => self.scatter(j),
                },
            }
        });
        rows.collect()
    }
}

/// A confidence in percent.
pub(super) fn level(confidence: f64) -> f64 {
    (1000.0 * confidence).round() / 10.0
}

/// A source in words, with a star where its size is assumed.
fn source(budget: &SystematicErrors, name: &str) -> String {
    let own = budget.sources.iter().find(|source| source.name == name);
    let star = match own {
        Some(own) if !own.declared => " *",
        _ => "",
    };
    format!("{}{star}", name.replace('-', " ")).replace(' ', "\u{a0}")
}
