//! Whether the options of a program fit its language and the robot.

use super::ProgramOptions;
use super::dialect::{Dialect, Tool};
use stiffarm::error::{Code, Error, Result};

impl ProgramOptions {
    /// Checks that they fit a robot of `joints` joints.
    pub(super) fn check(&self, dialect: &Dialect, joints: usize) -> Result<()> {
        let [fewest, most] = dialect.axes;
        let title = dialect.title;
        if !(fewest..=most).contains(&joints) {
            let wanted = if fewest == most { format!("exactly {most}") } else { format!("{fewest} to {most}") };
            return Err(Error::new(
                Code::Unsupported,
                format!("{title} moves robots of {wanted} joints; this one has {joints}."),
            )
            .hint("--language csv takes any number of joints"));
        }
        // A table has the cell's order.
        if dialect.syntax.is_some() {
            self.check_axes(dialect, joints)?;
        }
        self.check_pulses(dialect, joints)?;
        self.check_tool(dialect)
    }

    fn check_axes(&self, dialect: &Dialect, joints: usize) -> Result<()> {
        let Some(axes) = &self.controller_axes else {
            if joints <= 6 {
                return Ok(());
            }
            let message = format!(
                "A robot of {joints} joints needs to be told which of the controller's axes each joint is, base \
                 first: the last in {} is {}, which on many arms is not the last joint.",
                dialect.title,
                (dialect.axis_name)(joints - 1)
            );
            return Err(Error::new(Code::MissingKey, message).key("controller_axes").hint(
                "give --controller-axes, for example 1,2,7,3,4,5,6 where the third joint is the controller's axis 7",
            ));
        };
        let mut sorted = axes.clone();
        sorted.sort_unstable();
        if sorted.into_iter().eq(1..=joints) {
            return Ok(());
        }
        let message = format!("The axes must be the numbers 1 to {joints}, each once.");
        Err(Error::invalid(message).key("controller_axes"))
    }

    fn check_pulses(&self, dialect: &Dialect, joints: usize) -> Result<()> {
        let fault = |code, message: &str| Error::new(code, message).key("pulses_per_degree");
        let pulses = match &self.pulses_per_degree {
            None if dialect.in_pulses => {
                let message = "A Yaskawa job holds encoder pulses, and nothing says how many one degree has.";
                return Err(fault(Code::MissingKey, message).hint(
                    "give --pulses-per-degree, one per axis (S, L, U, R, B, T): turn one axis at a time and divide \
                     the change of the pendant's pulses by that of its degrees",
                ));
            }
            None => return Ok(()),
            Some(pulses) => pulses,
        };
        if !dialect.in_pulses {
            let title = dialect.title;
            let message = format!("Pulses per degree are for INFORM; {title} has degrees.");
            return Err(fault(Code::Conflict, &message));
        }
        if pulses.len() != joints {
            let message = format!("{} numbers of pulses for {joints} axes.", pulses.len());
            return Err(fault(Code::Dimension, &message));
        }
        // Less would not keep a hundredth of a degree; the sign tells the encoder's sense.
        if !pulses.iter().all(|p| (50.0..1e6).contains(&p.abs())) {
            let message = "Pulses per degree must lie between 50 and 1 000 000, or below zero for an axis whose \
                           encoder counts the other way.";
            return Err(fault(Code::InvalidValue, message));
        }
        Ok(())
    }

    fn check_tool(&self, dialect: &Dialect) -> Result<()> {
        let Some(tool) = &self.tool else {
            return Ok(());
        };
        let title = dialect.title;
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let (fits, message) = match dialect.tool {
            Tool::OnController => {
                let message = format!("In {title} the tool is set on the controller.");
                return Err(Error::new(Code::Conflict, message).key("tool"));
            }
            Tool::Number(most, _) => {
                let number = tool.parse::<u32>().ok();
                let fits = number.is_some_and(|n| n <= most && *tool == n.to_string());
                (fits, format!("is a number from 0 to {most}"))
            }
            Tool::Name(_) => {
                let begins = tool.starts_with(|c: char| c.is_ascii_alphabetic());
                let fits = begins && tool.chars().all(plain) && tool.len() <= 32;
                let message = "is the name of a tooldata: at most 32 letters, digits and _";
                (fits, message.to_string())
            }
        };
        if fits {
            return Ok(());
        }
        let message = format!("The tool of {title} {message}.");
        Err(Error::invalid(message).key("tool"))
    }
}
