//! What each word of CL data does to the path.

use super::super::builder::{Builder, Feed};
use crate::program::ProgramFile;
use std::collections::HashMap;
use stiffarm::findings::Severity;

/// What a word does to the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Weight {
    /// Its numbers count, and nothing but numbers may stand behind it.
    Numbers,
    /// The same, with words and brackets between them.
    Nested,
    /// Its words count.
    Words,
    /// The rest of the line is text.
    Text,
    /// The rest of the line goes into the machine's program as it stands.
    Raw,
    /// It leaves the points alone.
    Quiet,
    /// Points lie elsewhere behind it, unless it is switched off or its numbers are zero.
    Refused,
    /// The points are as they stand, and this is to be known.
    Said(Severity, &'static str),
    /// The tool leaves the path, and comes back to it.
    Away,
}

/// The words of ISO 4343, and those that NX, CATIA, Creo, CAMWorks and Mastercam write besides.
const WORDS: &[(Weight, &str)] = &[
    (Weight::Numbers, "GOTO FROM GODLTA GOHOME CIRCLE MSYS CSYS TLAXIS INDIRV INDIRP"),
    (Weight::Nested, "TLON GOFWD"),
    (Weight::Words, "RAPID UNITS UNIT CUTCOM TLCOMP CYCLE TRNTYP FINI"),
    (Weight::Text, "PPRINT REMARK PARTNO TPRINT SPRINT DISPLY LETTER TITLE OPNAME"),
    (Weight::Raw, "INSERT"),
    (
        Weight::Quiet,
        "TOOL END PAINT LOAD LOADTL SELECT SELECTL TLDATA TOOLNO CUTTER COOLNT SPINDL MACHIN MACHINE STOP OPSTOP INTOL \
         OUTTOL OUTOL TOLER MODE DELAY DWELL CLEARP CLRSRF MULTAX AUXFUN SEQNO NOPOST CLPRNT THICK FEDRAT CHECK BREAK \
         LINTOL CUTANG PPFUN CONTOUR SAFETY CLAMP OPSKIP TMARK FEED LEADER TURRET CHANNEL HEAD GOUGCK REWIND OFSTNO \
         AUTOPS PSIS NOPS MAXDP MAXDPM NUMPTS MCHTOL CIRINT SETUP CSI_SET_FLUTE_LENGTH CSI_SET_EXTENSION_LENGTH",
    ),
    (
        Weight::Refused,
        "TRACUT COPY ORIGIN INDEX TRANS REFSYS ROTABL ROTATE ROTHED GO GOLFT GORGT GOBACK GOUP GODOWN TLLFT TLRGT \
         TLOFPS SPLINE NURBS KNOT CNTRL HELICAL ARCSLP ARCDAT ARCMOV GOCLW GOCCLW CW CCW ZSURF SYN CALL MACRO TERMAC \
         LOOPST LOOPND JUMPTO POCKET SCURV RMILL SMILL",
    ),
    (Weight::Away, "RETRCT PLUNGE"),
    (
        Weight::Said(Severity::Caution, "calls a subprogram of the machine: what moves there is not read."),
        "CALSUB CALLSUB",
    ),
    (
        Weight::Said(
            Severity::Caution,
            "changes the point of the tool that the path is given for: the points are read as those of the tip.",
        ),
        "SWITCH",
    ),
    (Weight::Said(Severity::Caution, "sets a function of the machine, and is not followed here."), "PREFUN TRAFO"),
];

/// The table by its words.
pub(super) fn weights() -> HashMap<&'static str, Weight> {
    let each = |(weight, words): &(Weight, &'static str)| {
        let weight = *weight;
        words.split_whitespace().map(move |word| (word, weight)).collect::<Vec<_>>()
    };
    WORDS.iter().flat_map(each).collect()
}

/// Names of units; true for inches.
const UNITS: &[(bool, &str)] =
    &[(true, "INCH INCHES IN IPM IPR"), (false, "MM MMS MILLIMETER MILLIMETERS MILLIMETRE METRIC MMPM MMPR")];

/// Whether a word stands for inches, if it is one of a unit.
pub(super) fn is_inch(word: &str) -> Option<bool> {
    let is_one = |words: &str| words.split(' ').any(|unit_name| unit_name.eq_ignore_ascii_case(word));
    let unit = UNITS.iter().find(|(_, words)| is_one(words));
    unit.map(|(inch, _)| *inch)
}

/// Lines of the first feed in inches and in millimetres of a file that names no unit; none where it does.
pub(super) fn unit_of_feeds(file: &ProgramFile) -> Option<[Option<usize>; 2]> {
    let mut first_lines = [None; 2];
    for (i, line) in file.text.lines().enumerate() {
        let line = line.trim_start();
        if !line.starts_with(['U', 'u', 'F', 'f', 'M', 'm']) {
            continue;
        }
        let begins = |word: &str| line.get(..word.len()).is_some_and(|head| head.eq_ignore_ascii_case(word));
        if begins("UNIT") {
            return None;
        } else if begins("FEDRAT") || begins("MODE") {
            for inch in words(line).filter_map(|word| is_inch(&word)) {
                first_lines[usize::from(!inch)].get_or_insert(i + 1);
            }
        } else if begins("FINI") {
            break;
        }
    }
    Some(first_lines)
}

/// The words of the rest of a line, in capitals.
fn words(rest: &str) -> impl Iterator<Item = String> {
    let rest = rest.split('$').next().unwrap_or_default();
    rest.split([',', '/']).map(|word| word.trim().to_ascii_uppercase())
}

/// Whether raw text has G-words.
pub(super) fn has_code(text: &str) -> bool {
    let is_part = |c: char| !c.is_ascii_alphanumeric() && c != '.';
    text.split(is_part).any(|word| {
        let digits = word.strip_prefix(['G', 'g']).unwrap_or_default();
        !digits.is_empty() && digits.len() <= 4 && digits.starts_with(|c: char| c.is_ascii_digit())
    })
}

/// The name of an operation: `TOOL PATH/NAME,TOOL,…` of NX, `OPNAME/NAME`.
pub(super) fn feature<'a>(word: &str, rest: &'a str) -> Option<&'a str> {
    let names = match word {
        "TOOL" => rest.trim_start().split_at_checked(4).filter(|(path, _)| path.eq_ignore_ascii_case("PATH"))?.1,
        "OPNAME" => rest,
        _ => return None,
    };
    names.trim_start().strip_prefix('/')?.split(',').next()
}

/// `FEDRAT/2500,MMPM`, in either order; without a unit it is that of the file, per minute.
pub(super) fn feed(rest: &str, line: usize, builder: &mut Builder<'_>) {
    let (mut unit, mut number) = (builder.form.unit, None);
    let mut is_per_turn = false;
    builder.feed = None;
    for word in words(rest) {
        match word.as_str() {
            "MMPM" | "MMPR" => unit = 1e-3,
            "IPM" | "IPR" => unit = 25.4e-3,
            "INVERS" | "INVERSE" => {
                builder.not_followed(&format!("FEDRAT/{word}"), line, Severity::Note);
                return;
            }
            _ => number = number.or(word.parse::<f64>().ok()),
        }
        is_per_turn |= matches!(word.as_str(), "MMPR" | "IPR" | "PERREV");
    }
    builder.feed =
        number.map(|rate| if is_per_turn { Feed::Turn(rate * unit) } else { Feed::Second(rate * unit / 60.0) });
}

/// `SPINDL/RPM,6000,CLW`, in any order; without a number the speed is as before, that of a cutting edge is none.
pub(super) fn spindle(rest: &str, builder: &mut Builder<'_>) {
    if words(rest).any(|word| matches!(word.as_str(), "SFM" | "SMM" | "SFPM" | "MPM")) {
        builder.spindle = None;
    } else if let Some(turns) = words(rest).find_map(|word| word.parse::<f64>().ok()) {
        builder.spindle = Some(turns / 60.0);
    }
}
