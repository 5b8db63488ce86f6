//! The words of a block.

use super::effect::{Effect, Row};
use super::table;
use crate::program::{Cursor, Number};
use crate::tool_path::builder::Builder;
use stiffarm::error::Result;
use stiffarm::findings::Severity;

/// A word of a block.
pub struct Word<'a> {
    /// `X`, or `A3` as `A` and 3; 0 for a word of several letters.
    pub letter: u8,
    pub index: u8,
    pub number: Number,
    pub place: Cursor<'a>,
    pub end: usize,
    /// What the table says of it, if it is a word of its own: G, M, or several letters.
    pub row: Option<&'static Row>,
    /// Whether values follow a word of several letters.
    pub has_values: bool,
}

impl<'a> Word<'a> {
    /// As it stands in the program.
    pub fn text<'f>(&self, file: &'f str) -> &'f str {
        &file[self.place.position()..self.end]
    }

    /// Whether the table says this of it.
    pub fn is(&self, effect: Effect) -> bool {
        self.row.is_some_and(|row| row.effect == effect)
    }

    /// Whether it says how a block is meant: G, M or a word of several letters.
    pub fn is_own(&self) -> bool {
        matches!(self.letter, 0 | b'G' | b'M')
    }

    /// Where an axis goes, X to Z and A to C.
    pub fn axis(&self) -> Option<usize> {
        match (self.letter, self.index) {
            (letter @ b'X'..=b'Z', 0) => Some(usize::from(letter - b'X')),
            (letter @ b'A'..=b'C', 0) => Some(usize::from(letter - b'A') + 3),
            _ => None,
        }
    }
}

/// What stands beside the words of a block.
#[derive(Default)]
pub struct BlockMarks {
    pub comments: String,
    /// `/`: the block may be left out.
    pub is_optional: bool,
    /// `%`, which ends the program where it is not its first line.
    pub is_mark: bool,
}

/// The words of a block, and what stands beside them.
pub fn words_of<'a>(line: &mut Cursor<'a>, builder: &mut Builder<'_>, words: &mut Vec<Word<'a>>) -> Result<BlockMarks> {
    let number = line.line_number();
    let mut beside = BlockMarks::default();
    if line.passes("/") {
        beside.is_optional = true;
        // The number of the switch.
        line.skip(usize::from(line.rest().starts_with(|c: char| c.is_ascii_digit())));
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
            ';' => {
                beside.comments = format!("{} {rest}", beside.comments);
                return Ok(beside);
            }
            '%' => {
                beside.is_mark = true;
                return Ok(beside);
            }
            '(' => {
                let Some(end) = rest.find(')') else {
                    return Err(line.wrong("The ) that ends this comment is missing."));
                };
                beside.comments = format!("{} {}", beside.comments, &rest[..=end]);
                line.skip(end + 1);
            }
            '#' => assignment(line, builder)?,
            '[' => return Err(calculated(line)),
            ':' => {
                // The number of a program, or the end of a label.
                line.skip(1);
                let digits = line.rest().bytes().take_while(u8::is_ascii_digit);
                line.skip(digits.count());
            }
            c if c.is_ascii_alphabetic() => {
                let second = rest.as_bytes().get(1);
                let is_name = second.is_some_and(|c| c.is_ascii_alphabetic() || *c == b'_');
                if is_name && !is_radius(rest) {
                    let word = named(line)?;
                    if word.is(Effect::Declares) {
                        return Ok(beside);
                    }
                    let is_label = line.rest().starts_with(':');
                    words.extend((!is_label).then_some(word));
                } else if is_parameter(rest) {
                    assignment(line, builder)?;
                } else {
                    let read = word(line)?;
                    match first.to_ascii_uppercase() {
                        'F' if read.is_none() => builder.feed = None,
                        'S' if read.is_none() => builder.spindle = None,
                        _ => {}
                    }
                    words.extend(read);
                }
            }
            _ => return Err(line.wrong("This is not expected here.")),
        }
    }
}

/// A word of several letters, with the digits that belong to it and its values: `CYCLE832(0.01)`, `TURN=2`.
fn named<'a>(line: &mut Cursor<'a>) -> Result<Word<'a>> {
    let place = line.clone();
    let row = table::named(&line.identifier()?.to_ascii_uppercase());
    let end = line.position();
    let mut value = line.clone();
    let value = value.passes("=").then(|| value.number().ok()).flatten();
    let has_values = values(line)?;
    Ok(Word {
        letter: 0,
        index: 0,
        number: Number { value: value.unwrap_or(f64::NAN), at: place.position() as u32, length: 0 },
        place,
        end,
        row,
        has_values,
    })
}

/// Whether the radius of an arc stands here: `CR=`.
fn is_radius(rest: &str) -> bool {
    let name = rest.get(..2);
    name.is_some_and(|name| name.eq_ignore_ascii_case("CR")) && rest[2..].trim_start().starts_with('=')
}

/// Passes `[…]`, `(…)` or `= …` behind a name; true where there is anything in it.
fn values(line: &mut Cursor<'_>) -> Result<bool> {
    let before = line.position();
    group(line, '[', ']')?;
    if line.clone().passes("(") {
        let opens = line.space().position();
        group(line, '(', ')')?;
        return Ok(line.position() > opens + "()".len());
    }
    if line.passes("=") {
        expression(line)?;
    }
    Ok(line.position() > before)
}

/// Passes a group in brackets, if one stands here.
fn group(line: &mut Cursor<'_>, open: char, close: char) -> Result<()> {
    let rest = line.space().rest();
    if !rest.starts_with(open) {
        return Ok(());
    }
    let (mut depth, mut is_quoted) = (0, false);
    for (at, c) in rest.char_indices() {
        is_quoted ^= c == '"';
        if is_quoted {
            continue;
        }
        depth += i32::from(c == open) - i32::from(c == close);
        if depth == 0 {
            line.skip(at + close.len_utf8());
            return Ok(());
        }
    }
    Err(line.wrong(format!("The {close} that ends this is missing.")))
}

/// Whether a parameter of Siemens controls is set here: `R1=`.
fn is_parameter(rest: &str) -> bool {
    if !rest.starts_with(['R', 'r']) {
        return false;
    }
    let digits = rest[1..].trim_start_matches(|c: char| c.is_ascii_digit());
    digits.len() < rest.len() - 1 && digits.trim_start().starts_with('=')
}

/// Passes `#1=…`, `#<name>=…`, `R1=…`: it matters where a word takes the value, which is refused.
fn assignment(line: &mut Cursor<'_>, builder: &mut Builder<'_>) -> Result<()> {
    let number = line.line_number();
    operand(line)?;
    line.expect("=")?;
    expression(line)?;
    builder.not_followed("An assignment (#, R)", number, Severity::Note);
    Ok(())
}

/// Passes operands with signs between them.
fn expression(line: &mut Cursor<'_>) -> Result<()> {
    loop {
        operand(line)?;
        let sign = ["**", "+", "-", "*", "/"];
        let word = ["MOD", "AND", "XOR", "OR", "DIV"];
        if !sign.iter().any(|sign| line.passes(sign)) && !word.iter().any(|word| line.word(word)) {
            return Ok(());
        }
    }
}

/// Passes a number, a text, a parameter, a name with its values, or a group in brackets.
fn operand(line: &mut Cursor<'_>) -> Result<()> {
    line.space();
    while line.passes("-") || line.passes("+") || line.passes("#") {}
    let rest = line.space().rest();
    match rest.chars().next() {
        Some('"') => line.quoted('"').map(|_| ()),
        Some('[') => group(line, '[', ']'),
        Some('(') => group(line, '(', ')'),
        Some('<') => group(line, '<', '>'),
        Some(c) if c.is_ascii_digit() || c == '.' => {
            let is_none = |c: char| !(c.is_ascii_digit() || c == '.');
            line.skip(rest.find(is_none).unwrap_or(rest.len()));
            Ok(())
        }
        _ => {
            line.identifier()?;
            group(line, '[', ']')?;
            group(line, '(', ')')
        }
    }
}

/// A word of one letter, `X1.5`, `X=1.5` or `A3=0.1`; none where its value is a text.
fn word<'a>(line: &mut Cursor<'a>) -> Result<Option<Word<'a>>> {
    let place = line.clone();
    let letter = line.rest().as_bytes()[0].to_ascii_uppercase();
    let is_radius = is_radius(line.rest());
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
        if !changes_nothing {
            return Err(calculated(line));
        }
        operand(line)?;
        return Ok(None);
    }
    let number = number(line)?;
    let has_row = index == 0 && matches!(letter, b'G' | b'M');
    let row = has_row.then(|| table::numbered(letter, number.value));
    Ok(Some(Word {
        letter: if is_radius { b'R' } else { letter },
        index,
        number,
        place,
        end: line.position(),
        row: row.flatten(),
        has_values: false,
    }))
}

/// A number: no exponent, since `E` is a word.
fn number(line: &mut Cursor<'_>) -> Result<Number> {
    let at = line.position();
    let rest = line.rest();
    let is_none = |(i, c): (usize, char)| !(c.is_ascii_digit() || c == '.' || i == 0 && matches!(c, '+' | '-'));
    let end = rest.char_indices().find(|next| is_none(*next));
    let length = end.map_or(rest.len(), |(at, _)| at);
    let Ok(value) = rest[..length].parse::<f64>() else {
        return Err(line.wrong("A number is missing here."));
    };
    line.skip(length);
    Ok(Number { value, at: at as u32, length: length as u32 })
}

fn calculated(line: &Cursor<'_>) -> stiffarm::Error {
    line.wrong("This is calculated by the control: only stated numbers are read.")
        .hint("post-process the path without parameters")
}

/// The component of the tool axis that a word gives.
pub fn axis_component(word: &Word<'_>, vectors: bool) -> Option<usize> {
    match (word.letter, word.index) {
        (letter @ b'A'..=b'C', 3) => Some(usize::from(letter - b'A')),
        (letter @ b'I'..=b'K', 0) if vectors => Some(usize::from(letter - b'I')),
        _ => None,
    }
}
