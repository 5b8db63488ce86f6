//! What a language needs to know beside the program.

use super::Language;
use crate::error::{Code, Error, Result};

/// Options of writing and reading a program.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ProgramOptions {
    /// For each joint of the cell, in the cell's order, the axis of the controller, counted from 1
    /// in the controller's order; if it is not given the two orders are the same, which only holds
    /// for robots of up to six joints.
    pub axes: Option<Vec<usize>>,
    /// Encoder pulses per degree of each axis of a Yaskawa controller, in the controller's order.
    pub pulses_per_degree: Option<Vec<f64>>,
    /// The controller's tool: a name in RAPID (if none is given `tool0`), a number in KRL, FANUC TP
    /// (if none is given 1) and INFORM (0).
    pub tool: Option<String>,
}

impl ProgramOptions {
    /// Checks that they fit a robot of `joints` joints.
    pub(super) fn check(&self, language: Language, joints: usize) -> Result<()> {
        let [fewest, most] = language.axes();
        let title = language.title();
        if !(fewest..=most).contains(&joints) {
            let wanted = match fewest == most {
                true => format!("exactly {most}"),
                false => format!("{fewest} to {most}"),
            };
            return Err(Error::new(
                Code::Unsupported,
                format!("{title} moves robots of {wanted} joints; this one has {joints}."),
            )
            .hint("--language csv takes any number of joints"));
        }
        self.check_axes(language, joints)?;
        self.check_pulses(language, joints)?;
        self.check_tool(language)
    }

    fn check_axes(&self, language: Language, joints: usize) -> Result<()> {
        let fault = |code, message: String| Err(Error::new(code, message).key("axes"));
        if language == Language::Csv {
            return Ok(());
        }
        let Some(axes) = &self.axes else {
            if joints > 6 {
                let last = language.axis_name(joints - 1);
                return fault(
                    Code::MissingKey,
                    format!(
                        "A robot of {joints} joints needs to be told which of the controller's axes each \
                         joint is, base first: the last in {} is {last}, which on many arms is not the \
                         last joint.",
                        language.title()
                    ),
                )
                .map_err(|e| {
                    e.hint(
                        "give --axes, for example 1,2,7,3,4,5,6 where the third joint is the \
                         controller's axis 7",
                    )
                });
            }
            return Ok(());
        };
        let mut sorted = axes.clone();
        sorted.sort_unstable();
        match sorted.iter().copied().eq(1..=joints) {
            true => Ok(()),
            false => fault(
                Code::InvalidValue,
                format!("The axes must be the numbers 1 to {joints}, each once."),
            ),
        }
    }

    fn check_pulses(&self, language: Language, joints: usize) -> Result<()> {
        let fault = |code, message: String| Err(Error::new(code, message).key("pulses_per_degree"));
        match (&self.pulses_per_degree, language) {
            (None, Language::Inform) => fault(
                Code::MissingKey,
                "A Yaskawa job holds encoder pulses, and nothing says how many one degree has.".to_string(),
            )
            .map_err(|e| {
                e.hint(
                    "give --pulses-per-degree, one per axis (S, L, U, R, B, T): turn one axis at a time \
                     and divide the change of the pendant's pulses by that of its degrees",
                )
            }),
            (Some(_), other) if other != Language::Inform => fault(
                Code::Conflict,
                format!("Pulses per degree are for INFORM; {} has degrees.", other.title()),
            ),
            (Some(pulses), _) if pulses.len() != joints => fault(
                Code::Dimension,
                format!("{} numbers of pulses for {joints} axes.", pulses.len()),
            ),
            // Less would not keep a hundredth of a degree; the sign tells the encoder's sense.
            (Some(pulses), _) if !pulses.iter().all(|p| (50.0..1e6).contains(&p.abs())) => fault(
                Code::InvalidValue,
                "Pulses per degree must lie between 50 and 1 000 000, or below zero for an axis whose \
                 encoder counts the other way."
                    .to_string(),
            ),
            _ => Ok(()),
        }
    }

    fn check_tool(&self, language: Language) -> Result<()> {
        let Some(tool) = &self.tool else {
            return Ok(());
        };
        let fault = |code, message: String| Err(Error::new(code, message).key("tool"));
        let number = |most: u32| match tool.parse::<u32>() {
            Ok(number) if number <= most && *tool == number.to_string() => Ok(()),
            _ => fault(
                Code::InvalidValue,
                format!(
                    "The tool of {} is a number from 0 to {most}.",
                    language.title()
                ),
            ),
        };
        match language {
            Language::Krl => number(128),
            Language::Ls => number(29),
            Language::Inform => number(63),
            Language::Rapid => {
                let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
                let letter = |c: char| c.is_ascii_alphabetic();
                match tool.starts_with(letter) && tool.chars().all(plain) && tool.len() <= 32 {
                    true => Ok(()),
                    false => fault(
                        Code::InvalidValue,
                        "The tool of ABB RAPID is the name of a tooldata: at most 32 letters, digits and _."
                            .to_string(),
                    ),
                }
            }
            _ => fault(
                Code::Conflict,
                format!("In {} the tool is set on the controller.", language.title()),
            ),
        }
    }

    /// Values in the controller's order.
    pub(super) fn to_controller(&self, q: &[f64]) -> Vec<f64> {
        match &self.axes {
            None => q.to_vec(),
            Some(axes) => {
                let mut out = q.to_vec();
                for (value, axis) in q.iter().zip(axes) {
                    out[axis - 1] = *value;
                }
                out
            }
        }
    }

    /// Values in the cell's order.
    pub(super) fn to_cell(&self, values: &[f64]) -> Vec<f64> {
        match &self.axes {
            None => values.to_vec(),
            Some(axes) => axes.iter().map(|axis| values[axis - 1]).collect(),
        }
    }
}
