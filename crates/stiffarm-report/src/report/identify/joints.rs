//! The joints of an identification: how well each is known, and the table of it.

use crate::identified::StiffnessRow;
use crate::page::{DataTable, Number, Outcome, Text};
use crate::report::context::Context;
use crate::report::worth::level;
use stiffarm::estimate::identify::{Estimates, JointEstimate, NO_LONGER, Verdict, WELL_KNOWN};
use stiffarm::estimate::systematic::{JointUncertainty, SystematicErrors};
use stiffarm::findings::{list, visible};

/// Heading of the ± by the scatter of the readings.
const READINGS: &str = "± readings [%]";

/// Names of so many letters are not broken.
const SHORT: usize = 16;

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

    /// The half width as a number in percent.
    pub fn total(&self, j: usize) -> Number {
        let number = match self.errors(j) {
            Some(_) => self.error(j, "total"),
            None => Number::new("", self.all()[j].half_width),
        };
        number.percent().significant(2)
    }

    /// One number of the errors of a joint.
    fn error(&self, j: usize, key: &str) -> Number {
        self.context
            .number(&format!("/budget/uncertainty/{j}/{key}"))
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
        if !self
            .of(|verdict| verdict == Verdict::SignOrModelFault)
            .is_empty()
        {
            return Outcome::Serious;
        }
        match found {
            Outcome::Good if !self.of(|verdict| !is_within(verdict)).is_empty() => Outcome::Caution,
            found => found,
        }
    }

    /// Joints of a verdict.
    pub fn of(&self, is: impl Fn(Verdict) -> bool) -> Vec<usize> {
        let all = 0..self.all().len();
        all.filter(|j| is(self.all()[*j].verdict)).collect()
    }

    /// The unknowns without which a joint is not told.
    fn others(&self, j: usize) -> Vec<String> {
        let own = &self.all()[j].name;
        let mut sets = self.estimates.collinear.iter();
        let set = sets.find(|set| set.unknowns.contains(own));
        let others = set.iter().flat_map(|set| &set.unknowns);
        let others = others.filter(|name| *name != own);
        others.map(|name| visible(name).into_owned()).collect()
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
            (false, true) => format!(
                "known means a total ± of at most {:.0} %",
                100.0 * WELL_KNOWN
            ),
            (false, false) => format!(
                "known means a ± of at most {:.0} %, here by the scatter of the readings alone",
                100.0 * WELL_KNOWN
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
            let half = joint.half_width.filter(|half| usable && *half < NO_LONGER);
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
        let verdict = self.all()[j].verdict;
        let valued = is_within(verdict) || is_wide(verdict);
        match verdict {
            _ if valued && self.serious => Text::new("settle what is wrong first"),
            Verdict::Determined => Text::new("known"),
            Verdict::Weak => Text::default().strong("weak"),
            Verdict::HardlyKnown => Text::default()
                .strong("hardly known")
                .words(": ")
                .number(end(0).bare())
                .words(" to ")
                .number(end(1)),
            Verdict::LowerBoundOnly => Text::default()
                .strong("only a lower bound")
                .words(": above ")
                .number(end(0)),
            Verdict::NotByItself => Text::default()
                .strong("not by itself")
                .words(format!(": only together with {}", list(&self.others(j)))),
            Verdict::SignOrModelFault => Text::default()
                .strong("comes out negative")
                .words(": sign or model fault"),
            Verdict::NoInterval => Text::default()
                .strong("no interval")
                .words(": nothing says how sure it is"),
            Verdict::Undetermined => Text::default().strong("not determined"),
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
                    None => joint.half_width,
                },
                systematic: own.and_then(|own| own.systematic),
                total: joint.half_width,
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
fn source(budget: &SystematicErrors, name: &str) -> String {
    let own = budget.sources.iter().find(|source| source.name == name);
    let star = match own {
        Some(own) if !own.declared => " *",
        _ => "",
    };
    format!("{}{star}", name.replace('-', " ")).replace(' ', "\u{a0}")
}
