//! The words of a block.

use crate::program::{Cursor, Number};
use crate::tool_path::builder::Builder;
use stiffarm::error::Result;
use stiffarm::findings::Severity;

/// Words of Siemens controls that change no point.
const WORDS_QUIET: &str = "TRAORI TRAFOOF MSG STOPRE FFWON FFWOF SOFT BRISK COMPCAD COMPCURV COMPON COMPOF COMPSURF ORIWKS \
    ORIMKS ORIAXES ORIVECT CFTCP CFC CFIN CDON CDOF NORM KONT DIAMOF UPATH SPATH CYCLE832 G M SPOS LEAD TILT OTOL CTOL";

/// Words that lead elsewhere, move the frame, or begin a curve.
const WORDS_REFUSED: &str = "CALL ROT AROT TRANS ATRANS MIRROR AMIRROR SCALE ASCALE CYCLE800 BSPLINE ASPLINE CSPLINE POLY CIP \
    CT TOFRAME SUPA EXTCALL MCALL AP RP RND RNDM CHF CHR";

/// A word of a block.
pub struct Word<'a> {
    /// `X`, or `A3` as `A` and 3.
    pub letter: u8,
    pub index: u8,
    pub number: Number,
    pub place: Cursor<'a>,
    pub end: usize,
}

/// The words of a block; what stands beside them (comments) is returned.
pub fn words_of<'a>(
    line: &mut Cursor<'a>,
    builder: &mut Builder<'_>,
    words: &mut Vec<Word<'a>>,
) -> Result<String> {
    let number = line.line_number();
    let mut beside = String::new();
    if line.passes("/") {
        builder.remark("optional-blocks", "", number, Severity::Note, || {
            "Blocks that may be left out (/, {}) are read as if they are not.".to_string()
        });
    }
    loop {
        line.space();
        let rest = line.rest();
        let Some(first) = rest.chars().next() else {
            return Ok(beside);
        };
        match first {
            ';' | '%' => {
                if first == ';' {
                    beside = format!("{beside} {rest}");
                }
                return Ok(beside);
            }
            '(' => {
                let Some(end) = rest.find(')') else {
                    return Err(line.wrong("The ) that ends this comment is missing."));
                };
                beside = format!("{beside} {}", &rest[..=end]);
                line.skip(end + 1);
            }
            '#' => {
                // It matters where a word takes the value.
                builder.not_followed("An assignment (#)", number, Severity::Note);
                return Ok(beside);
            }
            '[' => return Err(calculated(line)),
            c if c.is_ascii_alphabetic() => {
                let is_name = rest[1..].starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
                if is_name && !rest[..2].eq_ignore_ascii_case("CR") {
                    name(line, builder, number)?;
                    return Ok(beside);
                }
                let read = word(line)?;
                match first.to_ascii_uppercase() {
                    'F' if read.is_none() => builder.feed = None,
                    'S' if read.is_none() => builder.spindle = None,
                    _ => {}
                }
                words.extend(read);
            }
            ':' => line.skip(1),
            _ => return Err(line.wrong("This is not expected here.")),
        }
    }
}

/// A word of several letters, which ends what is read of a block.
fn name(line: &mut Cursor<'_>, builder: &mut Builder<'_>, number: usize) -> Result<()> {
    let mut place = line.clone();
    let name = line.identifier()?.to_ascii_uppercase();
    let is_among = |words: &str| words.split_whitespace().any(|word| word == name);
    if is_among(WORDS_REFUSED) {
        let message = format!(
            "{name} leads elsewhere or changes where the points lie, and is not read here."
        );
        return Err(place.wrong_here(message));
    }
    if !is_among(WORDS_QUIET) {
        builder.not_followed(&name, number, Severity::Caution);
    }
    Ok(())
}

/// A word of one letter, `X1.5`, `X=1.5` or `A3=0.1`; none where its value is a text.
fn word<'a>(line: &mut Cursor<'a>) -> Result<Option<Word<'a>>> {
    let place = line.clone();
    let rest = line.rest().as_bytes();
    let letter = rest[0].to_ascii_uppercase();
    let is_radius = rest.len() > 1 && letter == b'C' && rest[1].eq_ignore_ascii_case(&b'R');
    line.skip(if is_radius { 2 } else { 1 });
    let mut index = 0;
    let digits = line.rest().bytes().take_while(u8::is_ascii_digit).count();
    if digits == 1 && line.rest()[1..].trim_start().starts_with('=') {
        index = line.rest().as_bytes()[0] - b'0';
        line.skip(1);
    }
    line.passes("=");
    let next = line.space().rest();
    if next.starts_with('"') {
        line.quoted('"')?;
        return Ok(None);
    }
    if next.starts_with(|c: char| c == '#' || c == '[' || c.is_ascii_alphabetic()) {
        let changes_nothing = matches!(letter, b'F' | b'S' | b'T' | b'D' | b'H');
        let number = next.strip_prefix('#').unwrap_or_default();
        let end = match number.bytes().take_while(u8::is_ascii_digit).count() {
            0 => next.find(['>', ']']),
            digits => Some(digits),
        };
        let end = end.filter(|_| changes_nothing);
        let Some(end) = end else {
            return Err(calculated(line));
        };
        line.skip(end + 1);
        return Ok(None);
    }
    let number = line.placed()?;
    Ok(Some(Word {
        letter: if is_radius { b'R' } else { letter },
        index,
        number,
        place,
        end: line.position(),
    }))
}

fn calculated(line: &Cursor<'_>) -> stiffarm::Error {
    line.wrong("This is calculated by the control: only stated numbers are read.")
        .hint("post-process the path without parameters")
}

/// Whether the word says where the tool goes.
pub fn is_target(word: &Word<'_>, vectors: bool) -> bool {
    matches!(word.letter, b'A'..=b'C' | b'X'..=b'Z')
        || axis_component(word, vectors).is_some()
        || matches!(word.letter, b'I'..=b'K')
}

/// The component of the tool axis that a word gives.
pub fn axis_component(word: &Word<'_>, vectors: bool) -> Option<usize> {
    match (word.letter, word.index) {
        (letter @ b'A'..=b'C', 3) => Some(usize::from(letter - b'A')),
        (letter @ b'I'..=b'K', 0) if vectors => Some(usize::from(letter - b'I')),
        _ => None,
    }
}
