//! The languages, and what each can hold.

use super::characters;
use crate::error::{Code, Error, Result};
use crate::model::robot::{Controller, Robot};

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

/// How names of programs are made in a language.
struct Naming {
    longest: usize,
    upper_case: bool,
    reserved: &'static [&'static str],
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

    /// Its name on the command line.
    pub fn as_str(self) -> &'static str {
        match self {
            Language::Krl => "krl",
            Language::Rapid => "rapid",
            Language::Ls => "ls",
            Language::Inform => "inform",
            Language::Pdl2 => "pdl2",
            Language::Urscript => "urscript",
            Language::Csv => "csv",
        }
    }

    /// Its name for people.
    pub fn title(self) -> &'static str {
        match self {
            Language::Krl => "KUKA KRL",
            Language::Rapid => "ABB RAPID",
            Language::Ls => "FANUC TP",
            Language::Inform => "Yaskawa INFORM",
            Language::Pdl2 => "COMAU PDL2",
            Language::Urscript => "URScript",
            Language::Csv => "CSV",
        }
    }

    /// The maker whose controllers speak it; `None` for a table.
    pub fn controller(self) -> Option<Controller> {
        match self {
            Language::Krl => Some(Controller::Kuka),
            Language::Rapid => Some(Controller::Abb),
            Language::Ls => Some(Controller::Fanuc),
            Language::Inform => Some(Controller::Yaskawa),
            Language::Pdl2 => Some(Controller::Comau),
            Language::Urscript => Some(Controller::Ur),
            Language::Csv => None,
        }
    }

    /// Checks that angles of this robot may stand in a program of the language: that they are those
    /// which its controller shows, and the language its controller's unless `asked` names the other.
    ///
    /// # Errors
    /// Nothing says that the angles are a controller's; the controller is another maker's; `asked`
    /// does not go with the language.
    pub fn check_robot(self, robot: &Robot, asked: Option<Controller>) -> Result<()> {
        let conflict = |message: String| Error::new(Code::Conflict, message).key("controller");
        if let Some(asked) = asked.filter(|asked| Some(*asked) != self.controller()) {
            let message = format!(
                "{} does not go to a controller of {}.",
                self.title(),
                asked.title()
            );
            return Err(conflict(message));
        }
        let Some(wanted) = self.controller() else {
            return Ok(());
        };
        let known = robot.known_controller()?;
        if known == wanted || asked.is_some() {
            return Ok(());
        }
        let own = Language::ALL
            .into_iter()
            .find(|l| l.controller() == Some(known));
        let own = own.unwrap_or(Language::Csv).as_str();
        let message = format!(
            "{} is for controllers of {}; the angles of this cell are those of {}.",
            self.title(),
            wanted.title(),
            known.title()
        );
        Err(conflict(message).hint(format!(
            "use --language {own}; or --controller {} if such a pendant shows these very angles",
            wanted.as_str()
        )))
    }

    /// Most decimals of an angle in degrees. Controllers hold single precision, seven digits; a
    /// FANUC listing has three decimals. INFORM has whole pulses instead, and a table the shortest
    /// decimals that are read back as the same angles.
    pub fn most_decimals(self) -> usize {
        match self {
            Language::Ls => 3,
            _ => 4,
        }
    }

    /// What a speed of 100 per cent is.
    pub fn speed_of(self) -> &'static str {
        match self {
            Language::Krl | Language::Ls | Language::Inform | Language::Pdl2 | Language::Csv => {
                "the largest speed of each axis"
            }
            Language::Rapid => "1000 mm/s and 500 deg/s of the tool",
            Language::Urscript => "60 deg/s of the fastest joint",
        }
    }

    /// Fewest and most joints of a robot that it can move.
    pub fn axes(self) -> [usize; 2] {
        match self {
            Language::Krl | Language::Rapid => [6, 12],
            Language::Ls => [1, 9],
            Language::Inform => [6, 7],
            Language::Pdl2 => [1, 10],
            Language::Urscript => [6, 6],
            Language::Csv => [1, usize::MAX],
        }
    }

    /// What its axes are called, in the controller's order.
    pub(super) fn axis_name(self, axis: usize) -> String {
        match self {
            Language::Krl if axis < 6 => format!("A{}", axis + 1),
            Language::Krl => format!("E{}", axis - 5),
            Language::Ls if axis >= 6 => format!("E{}", axis - 5),
            Language::Rapid if axis < 6 => format!("rax_{}", axis + 1),
            Language::Rapid => format!("eax_{}", (b'a' + (axis - 6) as u8) as char),
            Language::Inform => ["S", "L", "U", "R", "B", "T", "E"][axis.min(6)].to_string(),
            _ => format!("J{}", axis + 1),
        }
    }

    fn naming(self) -> Naming {
        match self {
            // KSS operating manuals: 24 characters for a module.
            Language::Krl => Naming {
                longest: 24,
                upper_case: false,
                reserved: &[
                    "bas", "cell", "continue", "def", "deffct", "end", "for", "halt", "if",
                    "ir_stopm", "loop", "ptp", "repeat", "return", "sps", "switch", "wait",
                    "while",
                ],
            },
            // Four characters are kept for the procedure's `_run`.
            Language::Rapid => Naming {
                longest: 28,
                upper_case: false,
                reserved: &[
                    "base",
                    "case",
                    "const",
                    "default",
                    "else",
                    "endmodule",
                    "endproc",
                    "error",
                    "exit",
                    "for",
                    "func",
                    "goto",
                    "if",
                    "local",
                    "main",
                    "module",
                    "nostepin",
                    "pers",
                    "proc",
                    "raise",
                    "readonly",
                    "record",
                    "retry",
                    "return",
                    "stop",
                    "task",
                    "test",
                    "then",
                    "trap",
                    "user",
                    "var",
                    "while",
                    "with",
                ],
            },
            Language::Ls => Naming {
                longest: 32,
                upper_case: true,
                reserved: &["ALL", "CON", "NUL", "PRN", "AUX"],
            },
            Language::Inform => Naming {
                longest: 32,
                upper_case: true,
                reserved: &["END", "NOP"],
            },
            Language::Pdl2 => Naming {
                longest: 32,
                upper_case: false,
                reserved: &[
                    "abort", "activate", "and", "attach", "begin", "call", "close", "const",
                    "delay", "do", "else", "end", "endif", "exit", "for", "goto", "hold", "if",
                    "move", "not", "open", "or", "pause", "program", "read", "repeat", "return",
                    "routine", "select", "type", "var", "wait", "while", "with", "write",
                ],
            },
            Language::Urscript => Naming {
                longest: 60,
                upper_case: false,
                reserved: &[
                    "and", "break", "continue", "def", "elif", "else", "end", "false", "for",
                    "global", "halt", "if", "join", "kill", "local", "loop", "movej", "not", "or",
                    "pass", "popup", "return", "run", "sec", "sync", "thread", "true", "while",
                    "xor",
                ],
            },
            Language::Csv => Naming {
                longest: 60,
                upper_case: false,
                reserved: &[],
            },
        }
    }

    /// A name for a program that the language allows, close to `wanted`.
    pub fn name_for(self, wanted: &str) -> String {
        let naming = self.naming();
        let plain: String = characters::plain(wanted)
            .chars()
            .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
            .collect();
        let name = format!("measure_{plain}");
        let name = match naming.upper_case {
            true => name.to_ascii_uppercase(),
            false => name,
        };
        let cut: String = name.chars().take(naming.longest).collect();
        cut.trim_end_matches('_').to_string()
    }

    /// Checks the name of a program.
    ///
    /// # Errors
    /// Too long, a character that does not belong in it, a word of the language.
    pub fn check_name(self, name: &str) -> Result<()> {
        let naming = self.naming();
        let letter = |c: char| match naming.upper_case {
            true => c.is_ascii_uppercase(),
            false => c.is_ascii_alphabetic(),
        };
        let letters = match naming.upper_case {
            true => "capital letter",
            false => "letter",
        };
        let is_part = |c: char| letter(c) || c.is_ascii_digit() || c == '_';
        let is_word = |word: &&str| word.eq_ignore_ascii_case(name);
        let wrong = if !name.starts_with(letter) {
            format!("must begin with a {letters}")
        } else if !name.chars().all(is_part) {
            format!("may hold {letters}s, digits and _ only")
        } else if name.len() > naming.longest {
            format!("must have at most {} characters", naming.longest)
        } else if naming.reserved.iter().any(is_word) {
            "must not be a word of the language".to_string()
        } else {
            return Ok(());
        };
        let message = format!(
            "The name \"{name}\" of the program {wrong} in {}.",
            self.title()
        );
        Err(Error::new(Code::InvalidValue, message)
            .hint(format!("for example {}", self.name_for(name))))
    }
}
