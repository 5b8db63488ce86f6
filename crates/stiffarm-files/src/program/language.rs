//! The languages, and what each can hold.

use super::characters;
use super::csv::CSV;
use super::dialect::{Dialect, PoseForm};
use super::inform::INFORM;
use super::krl::KRL;
use super::ls::LS;
use super::pdl2::PDL2;
use super::rapid::RAPID;
use super::urscript::URSCRIPT;
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::robot::{Controller, Robot};

/// Language of a robot controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Language {
    /// KUKA: `.src` and `.dat`.
    Krl,
    /// ABB: `.mod`.
    Rapid,
    /// FANUC teach pendant program as text: `.ls`.
    Ls,
    /// Yaskawa: `.jbi`.
    Inform,
    /// COMAU: `.pdl`.
    Pdl2,
    /// Universal Robots: `.script`.
    Urscript,
    /// A table for everything else: `.csv`.
    Csv,
}

impl Language {
    /// All of them.
    pub const ALL: [Language; 7] = [
        Language::Krl,
        Language::Rapid,
        Language::Ls,
        Language::Inform,
        Language::Pdl2,
        Language::Urscript,
        Language::Csv,
    ];

    pub(super) fn dialect(self) -> &'static Dialect {
        match self {
            Language::Krl => &KRL,
            Language::Rapid => &RAPID,
            Language::Ls => &LS,
            Language::Inform => &INFORM,
            Language::Pdl2 => &PDL2,
            Language::Urscript => &URSCRIPT,
            Language::Csv => &CSV,
        }
    }

    /// How poses stand in its programs, where they are read.
    pub(crate) fn poses(self) -> Option<PoseForm> {
        let syntax = self.dialect().syntax.as_ref();
        syntax.and_then(|syntax| syntax.poses)
    }

    /// What ends the lines of its programs.
    pub(crate) fn line_end(self) -> &'static str {
        let syntax = self.dialect().syntax.as_ref();
        syntax.map_or("\n", |syntax| syntax.line_end)
    }

    /// That of a maker's controllers.
    pub fn of(controller: Controller) -> Option<Language> {
        let mut all = Language::ALL.into_iter();
        all.find(|language| language.controller() == Some(controller))
    }

    /// Its name on the command line.
    pub fn as_str(self) -> &'static str {
        self.dialect().name
    }

    /// Its name for people.
    pub fn title(self) -> &'static str {
        self.dialect().title
    }

    /// What its programs are in few words: `KUKA KRL: .src and .dat`.
    pub fn files(self) -> String {
        let (dialect, title) = (self.dialect(), self.title());
        let maker = match self.controller().map(Controller::title) {
            Some(maker) if !title.starts_with(maker) => format!("{maker} "),
            _ => String::new(),
        };
        match &dialect.syntax {
            Some(syntax) => {
                let ends = syntax.files.iter().map(|(end, _)| format!(".{end}"));
                let ends: Vec<String> = ends.collect();
                format!("{maker}{title}: {}", ends.join(" and "))
            }
            None => "A table for everything else".to_string(),
        }
    }

    /// The maker whose controllers speak it; `None` for a table.
    pub fn controller(self) -> Option<Controller> {
        self.dialect().controller
    }

    /// What a speed of 100 per cent is.
    pub fn speed_of(self) -> &'static str {
        self.dialect().speed_of
    }

    /// Checks that angles of this robot may stand in a program of the language: that they are those
    /// which its controller shows, and the language its controller's unless `controller` names the other.
    ///
    /// # Errors
    /// Nothing says that the angles are a controller's; the controller is another maker's; `controller`
    /// does not go with the language.
    pub fn check_robot(self, robot: &Robot, controller: Option<Controller>) -> Result<()> {
        let conflict = |message: String| Error::new(Code::Conflict, message).key("controller");
        if let Some(controller) = controller.filter(|controller| Some(*controller) != self.controller()) {
            let message = format!("{} does not go to a controller of {}.", self.title(), controller.title());
            return Err(conflict(message));
        }
        let Some(wanted) = self.controller() else {
            return Ok(());
        };
        let robot_controller = robot.known_controller()?;
        if robot_controller == wanted || controller.is_some() {
            return Ok(());
        }
        let robot_language = Language::of(robot_controller).unwrap_or(Language::Csv).as_str();
        let message = format!(
            "{} is for controllers of {}; the angles of this cell are those of {}.",
            self.title(),
            wanted.title(),
            robot_controller.title()
        );
        Err(conflict(message).hint(format!(
            "use --language {robot_language}; or --controller {} if such a pendant shows these very angles",
            wanted.as_str()
        )))
    }

    /// A name for a program that the language allows, close to `wanted`.
    pub fn name_for(self, wanted: &str) -> String {
        let dialect = self.dialect();
        let plain: String =
            characters::plain(wanted).chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        let name = format!("measure_{plain}");
        let name = if dialect.upper_case { name.to_ascii_uppercase() } else { name };
        let cut: String = name.chars().take(dialect.longest_name).collect();
        cut.trim_end_matches('_').to_string()
    }

    /// Checks the name of a program.
    ///
    /// # Errors
    /// Too long, a character that does not belong in it, a word of the language.
    pub fn check_name(self, name: &str) -> Result<()> {
        let dialect = self.dialect();
        let (letter, letters): (fn(char) -> bool, _) = if dialect.upper_case {
            (|c| c.is_ascii_uppercase(), "capital letter")
        } else {
            (|c| c.is_ascii_alphabetic(), "letter")
        };
        let is_part = |c: char| letter(c) || c.is_ascii_digit() || c == '_';
        let is_word = |word: &str| word.eq_ignore_ascii_case(name);
        let wrong = if !name.starts_with(letter) {
            format!("must begin with a {letters}")
        } else if !name.chars().all(is_part) {
            format!("may hold {letters}s, digits and _ only")
        } else if name.len() > dialect.longest_name {
            format!("must have at most {} characters", dialect.longest_name)
        } else if dialect.reserved.split(' ').any(is_word) {
            "must not be a word of the language".to_string()
        } else {
            return Ok(());
        };
        let message = format!("The name \"{name}\" of the program {wrong} in {}.", self.title());
        Err(Error::invalid(message).hint(format!("for example {}", self.name_for(name))))
    }
}
