//! What a path is written in: by the ending of its name, by what stands in it, or as the caller says.

use crate::program::Language;
use std::path::Path;
use stiffarm::error::{Code, Error, Result};
use stiffarm::findings::Finding;

/// What a tool path is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// CL data: APT, and the CLSF of Siemens NX.
    Apt,
    /// G-code.
    Gcode,
    /// The program of a robot controller.
    Robot(Language),
}

/// All that is said of a language, beside its reader.
struct Facts {
    kind: Kind,
    /// Its name as a caller states it, and what is said of that.
    name: &'static str,
    describe: &'static str,
    /// Endings of file names, in small letters.
    endings: &'static [&'static str],
    /// What only a program in this language has in a line.
    is_mark: fn(&str) -> bool,
}

const KINDS: [Facts; 7] = [
    Facts {
        kind: Kind::Apt,
        name: "cl-data",
        describe: "CL data: APT, CLSF",
        endings: &["cls", "clsf", "apt", "aptsource", "cl", "cldata", "ncl", "as"],
        is_mark: |line| {
            let is_point = starts(line, "GOTO") || starts(line, "FROM");
            is_point && line[4..].trim_start().starts_with('/') || starts(line, "TOOL PATH/")
        },
    },
    Facts {
        kind: Kind::Gcode,
        name: "g-code",
        describe: "G-code",
        endings: &["nc", "ngc", "gcode", "tap", "cnc", "mpf", "eia", "iso"],
        is_mark: is_gcode,
    },
    Facts {
        kind: Kind::Robot(Language::Krl),
        name: "krl",
        describe: "KUKA KRL",
        endings: &["src"],
        is_mark: |line| starts(line, "&ACCESS") || starts(line, "LIN {") || starts(line, "PTP {"),
    },
    Facts {
        kind: Kind::Robot(Language::Rapid),
        name: "rapid",
        describe: "ABB RAPID",
        endings: &["mod", "modx", "prg"],
        is_mark: |line| starts(line, "MODULE ") || starts(line, "MoveL ") && line.ends_with(';'),
    },
    Facts {
        kind: Kind::Robot(Language::Ls),
        name: "ls",
        describe: "FANUC TP",
        endings: &["ls"],
        is_mark: |line| starts(line, "/PROG"),
    },
    Facts {
        kind: Kind::Robot(Language::Inform),
        name: "inform",
        describe: "Yaskawa INFORM",
        endings: &["jbi"],
        is_mark: |line| line.eq_ignore_ascii_case("/JOB"),
    },
    Facts {
        kind: Kind::Robot(Language::Urscript),
        name: "urscript",
        describe: "URScript",
        endings: &["script", "urscript"],
        is_mark: |line| starts(line, "movel(") || starts(line, "movej("),
    },
];

impl Kind {
    /// What the file of this name is, if it is no table.
    pub fn of(name: &str) -> Option<Kind> {
        // Creo numbers its files: `a.ncl.3`.
        let number = name.rfind(|c: char| !c.is_ascii_digit());
        let unnumbered = number.and_then(|at| name[..=at].strip_suffix('.'));
        let unnumbered = unnumbered.filter(|unnumbered| unnumbered.to_ascii_lowercase().ends_with(".ncl"));
        let path = Path::new(unnumbered.unwrap_or(name));
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        let mut kinds = KINDS.iter();
        let matching = kinds.find(|facts| facts.endings.contains(&ending.as_str()));
        matching.map(|facts| facts.kind)
    }

    /// Its name for people.
    pub fn title(self) -> &'static str {
        match self {
            Kind::Apt => "CL data (APT)",
            Kind::Gcode => "G-code",
            Kind::Robot(language) => language.title(),
        }
    }

    /// The ending of the file beside it in which its points may stand.
    pub fn companion(self) -> Option<&'static str> {
        (self == Kind::Robot(Language::Krl)).then_some("dat")
    }
}

/// A path's language as a caller may state it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathLanguage {
    /// A table.
    Table,
    /// A program.
    Program(Kind),
}

/// All of them, by a name, with what is said of it.
pub const LANGUAGES: &[(&str, &str, PathLanguage)] = &languages();

const fn languages() -> [(&'static str, &'static str, PathLanguage); KINDS.len() + 1] {
    let mut all = [("table", "A table of points", PathLanguage::Table); KINDS.len() + 1];
    let mut i = 0;
    while i < KINDS.len() {
        let language = PathLanguage::Program(KINDS[i].kind);
        all[i + 1] = (KINDS[i].name, KINDS[i].describe, language);
        i += 1;
    }
    all
}

/// Endings of tables, which are looked into by their own readers.
const TABLES: [&str; 6] = ["csv", "tsv", "xlsx", "xlsm", "xlsb", "xls"];

/// Lines that are looked at.
const LOOKED_AT: usize = 1000;

/// What a path is: by `language`, else by the ending of its name, else by what stands in it, which is said. `None` is a
/// table.
///
/// # Errors
/// A language that is not read here, as Heidenhain's.
pub fn recognised(name: &str, bytes: &[u8], language: Option<PathLanguage>) -> Result<(Option<Kind>, Option<Finding>)> {
    match language {
        Some(PathLanguage::Table) => return Ok((None, None)),
        Some(PathLanguage::Program(kind)) => return Ok((Some(kind), None)),
        None => {}
    }
    let ending = Path::new(name).extension().and_then(|ending| ending.to_str());
    let ending = ending.unwrap_or_default().to_ascii_lowercase();
    if TABLES.contains(&ending.as_str()) {
        return Ok((None, None));
    }
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(1 << 16)]);
    let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty()).take(LOOKED_AT);
    if let Some(first) = lines().next().filter(|line| is_heidenhain(line)) {
        let message = format!("`{first}` begins a program of a Heidenhain control, which is not read here.");
        let error = Error::new(Code::Unsupported, message).file(name).line(1, None);
        return Err(error.hint("post-process the path as G-code (DIN/ISO) or CL data"));
    }
    let by_name = Kind::of(name);
    if by_name.is_some() {
        return Ok((by_name, None));
    }
    // A block of G-code has few letters, which a line of another language may have, too.
    let mut all: Vec<&Facts> = KINDS.iter().collect();
    all.sort_by_key(|facts| facts.kind == Kind::Gcode);
    let matching = all.into_iter().find(|facts| lines().any(facts.is_mark));
    let kind = matching.map(|facts| facts.kind);
    let finding = kind.map(|kind| {
        let sentence =
            format!("{name} is read as {}, by what stands in it: `--language` says otherwise.", kind.title());
        Finding::caution("path-language", "path", sentence)
    });
    Ok((kind, finding))
}

/// `0 BEGIN PGM PART MM`.
fn is_heidenhain(line: &str) -> bool {
    let line = line.trim_start_matches(|c: char| c.is_ascii_digit() || c == ' ');
    starts(line, "BEGIN PGM")
}

fn starts(line: &str, word: &str) -> bool {
    line.get(..word.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(word))
}

/// A block that moves: words of one letter with numbers alone, G or N first, an axis among them.
fn is_gcode(line: &str) -> bool {
    let mut rest = line.trim_start_matches('/');
    let mut letters = String::new();
    while let Some(letter) = rest.chars().next() {
        if matches!(letter, '(' | ';') {
            break;
        }
        let number = rest[letter.len_utf8()..].trim_start();
        let is_none = |c: char| !(c.is_ascii_digit() || matches!(c, '.' | '+' | '-'));
        let end = number.find(is_none).unwrap_or(number.len());
        if !letter.is_ascii_alphabetic() || number[..end].parse::<f64>().is_err() {
            return false;
        }
        letters.push(letter.to_ascii_uppercase());
        rest = number[end..].trim_start();
    }
    letters.starts_with(['G', 'N']) && letters.contains(['X', 'Y', 'Z'])
}
