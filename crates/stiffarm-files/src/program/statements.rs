//! A program line by line: whether it holds nothing but what [`write_program`](super::write_program)
//! writes.
//!
//! The readers of the languages look for moves and waits and pass over the rest; a jump, another
//! frame or speed in that rest makes another program of it. So each line becomes words, signs and
//! numbers, without spaces, comments, and what a controller notes about the file; the angles of postures
//! are left out of it. What is left must be the same, line for line, as in the program of the plan.

use super::dialect::{Angles, Dialect, Syntax};
use super::{Difference, Language, ProgramFile};

/// Edits that are looked for; beyond them every line counts as another.
const MOST_EDITS: usize = 2000;
/// Stands for a diagonal that no edits lead to.
const NOWHERE: i32 = i32::MIN / 2;

/// A line that does something.
struct Statement<'a> {
    /// Name of the file.
    file: &'a str,
    /// Counted from 1.
    line: usize,
    text: &'a str,
    /// Its parts; an angle of a posture is [`Part::Angle`].
    parts: Vec<Part<'a>>,
}

#[derive(Debug, Clone, PartialEq)]
enum Part<'a> {
    /// Name, keyword or text between quotation marks, in small letters.
    Word(String),
    Number(f64),
    Sign(&'a str),
    Angle,
}

impl Part<'_> {
    fn is(&self, text: &str) -> bool {
        match self {
            Part::Word(word) => word == text,
            Part::Sign(sign) => *sign == text,
            Part::Number(_) | Part::Angle => false,
        }
    }
}

/// Where `actual` is not line for line `planned`, but for angles of postures, comments, spaces and
/// numbers of lines: lines that are not those of the plan, and those that are missing.
pub fn compare_statements(
    planned: &[ProgramFile],
    actual: &[ProgramFile],
    language: Language,
    joints: usize,
) -> Vec<Difference> {
    let mut differences = Vec::new();
    for planned_file in planned {
        // Of KRL the two files are told apart by their extensions.
        let extension = |file: &ProgramFile| {
            let (_, extension) = file.name.rsplit_once('.').unwrap_or_default();
            extension.to_ascii_lowercase()
        };
        let other = actual.iter().find(|file| planned.len() == 1 || extension(file) == extension(planned_file));
        let planned = statements(planned_file, language.dialect(), joints);
        // Of a file that is not there all lines are missing.
        let actual = other.map_or_else(Vec::new, |other| statements(other, language.dialect(), joints));
        let (missing, other_lines) = unpaired(&planned, &actual);
        differences.extend(other_lines.into_iter().map(|at| Difference::Line {
            file: actual[at].file.to_string(),
            line: actual[at].line,
            text: actual[at].text.trim().to_string(),
        }));
        differences.extend(missing.into_iter().map(|at| Difference::MissingLine {
            file: other.unwrap_or(planned_file).name.clone(),
            text: planned[at].text.trim().to_string(),
        }));
    }
    differences
}

/// The lines of a file that do something: no empty ones, no comments, and not what the controller
/// notes about the file.
fn statements<'a>(file: &'a ProgramFile, dialect: &Dialect, joints: usize) -> Vec<Statement<'a>> {
    let lines = file.text.trim_start_matches('\u{feff}').lines();
    let statement = |(at, text): (usize, &'a str)| {
        let parts = match &dialect.syntax {
            None => fields(text, joints),
            Some(syntax) if is_note(text, syntax) => return None,
            Some(syntax) => {
                let mut parts = parts(text, syntax);
                leave_out_angles(&mut parts, dialect, syntax, joints);
                parts
            }
        };
        (!parts.is_empty()).then_some(Statement { file: &file.name, line: at + 1, text, parts })
    };
    lines.enumerate().filter_map(statement).collect()
}

fn is_note(text: &str, syntax: &Syntax) -> bool {
    let text = text.to_lowercase().replace(char::is_whitespace, "");
    syntax.notes.iter().any(|note| text.starts_with(note))
}

/// The fields of a row; the number of a step says nothing that its place does not.
fn fields(text: &str, joints: usize) -> Vec<Part<'_>> {
    if text.starts_with('#') || text.trim().is_empty() {
        return Vec::new();
    }
    let mut reader = ::csv::ReaderBuilder::new();
    let reader = reader.has_headers(false).from_reader(text.as_bytes());
    let Some(Ok(record)) = reader.into_records().next() else {
        return vec![Part::Word(text.to_string())];
    };
    let is_step = record.get(0).is_some_and(|step| step.parse::<u64>().is_ok());
    let is_angle = |at: usize| is_step && (3..3 + joints).contains(&at);
    let fields = record.iter().enumerate().skip(usize::from(is_step));
    fields
        .map(|(at, field)| match field.trim().parse::<f64>() {
            Ok(_) if is_angle(at) => Part::Angle,
            Ok(number) => Part::Number(number),
            Err(_) => Part::Word(field.to_string()),
        })
        .collect()
}

/// Words, numbers and signs of a line without its comment.
fn parts<'a>(text: &'a str, syntax: &Syntax) -> Vec<Part<'a>> {
    let (comment, quote) = (syntax.comment, syntax.quote);
    let mut rest = text.trim();
    if syntax.numbered {
        let unnumbered = rest.trim_start_matches(|c: char| c.is_ascii_digit());
        rest = unnumbered.strip_prefix(':').unwrap_or(rest).trim_start();
    }
    let mut parts = Vec::new();
    while let Some(first) = rest.chars().next() {
        if rest.starts_with(comment) && (parts.is_empty() || !syntax.comments_fill_lines) {
            break;
        }
        let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '$';
        let length = if first == quote {
            let end = rest[1..].find(quote);
            end.map_or(rest.len(), |end| end + 2)
        } else if let Some(length) = number_length(rest) {
            length
        } else if is_word(first) {
            rest.find(|c| !is_word(c)).unwrap_or(rest.len())
        } else {
            first.len_utf8()
        };
        let (part, after) = rest.split_at(length);
        parts.push(match part.parse::<f64>() {
            Ok(number) if number_length(part).is_some() => Part::Number(number),
            _ if first == quote || is_word(first) => Part::Word(part.to_lowercase()),
            _ => Part::Sign(part),
        });
        rest = after.trim_start();
    }
    parts
}

/// Bytes of the number that stands first.
fn number_length(text: &str) -> Option<usize> {
    let digits = |text: &str| text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let mut at = usize::from(text.starts_with(['+', '-']));
    let whole = digits(&text[at..]);
    at += whole;
    let mut decimals = 0;
    if text[at..].starts_with('.') {
        decimals = digits(&text[at + 1..]);
        at += 1 + decimals;
    }
    if whole + decimals == 0 {
        return None;
    }
    if text[at..].starts_with(['e', 'E']) {
        let sign = usize::from(text[at + 1..].starts_with(['+', '-']));
        let power = digits(&text[at + 1 + sign..]);
        at += if power > 0 { 1 + sign + power } else { 0 };
    }
    Some(at)
}

/// Puts [`Part::Angle`] for the angles of a posture: those of the cell's own axes.
fn leave_out_angles(parts: &mut [Part<'_>], dialect: &Dialect, syntax: &Syntax, joints: usize) {
    let is_one_of = |part: &Part<'_>, words: &[&str]| words.iter().any(|word| part.is(word));
    if !parts.iter().any(|part| is_one_of(part, syntax.angle_words)) {
        return;
    }
    // The numbers from here on, as many as there are joints.
    let listed = |from: usize| -> Vec<usize> {
        let numbers = (from..parts.len()).filter(|at| matches!(parts[*at], Part::Number(_)));
        numbers.take(joints).collect()
    };
    let at = match syntax.angles {
        Angles::Named(gap) => {
            let names = (0..joints).map(|axis| (dialect.axis_name)(axis).to_lowercase());
            let names: Vec<String> = names.collect();
            let is_name = |part: &Part<'_>| names.iter().any(|name| part.is(name));
            let at = (gap..parts.len()).filter(|at| is_name(&parts[at - gap]));
            at.collect()
        }
        Angles::After(sign) => {
            let first = parts.iter().position(|part| part.is(sign));
            listed(first.unwrap_or(parts.len()))
        }
        Angles::Second(sign) if parts.get(1).is_some_and(|part| part.is(sign)) => listed(1),
        Angles::Second(_) => Vec::new(),
    };
    for at in at {
        if matches!(parts[at], Part::Number(_)) {
            parts[at] = Part::Angle;
        }
    }
}

/// The statements of both that have no partner in the other, in order: a shortest edit script (Myers
/// 1986, doi:10.1007/BF01840446). All of them where it is longer than [`MOST_EDITS`].
fn unpaired(planned: &[Statement<'_>], actual: &[Statement<'_>]) -> (Vec<usize>, Vec<usize>) {
    let (n, m) = (planned.len() as i32, actual.len() as i32);
    let same = |i: i32, j: i32| i < n && j < m && planned[i as usize].parts == actual[j as usize].parts;
    // For each number of edits: how far into `planned` they lead on each diagonal, place in `planned`
    // less place in `actual`.
    let mut rounds: Vec<Vec<i32>> = Vec::new();
    let far = |rounds: &[Vec<i32>], edits: i32, diagonal: i32| {
        let at = usize::try_from(diagonal + edits).ok();
        let reached = at.and_then(|at| rounds[edits as usize].get(at));
        reached.copied().unwrap_or(NOWHERE)
    };
    // Where the last of some edits leads to on a diagonal: a line of `planned` passed, or one of `actual`.
    let step = |rounds: &[Vec<i32>], edits: i32, diagonal: i32| {
        let planned_passed = far(rounds, edits - 1, diagonal - 1) + 1;
        let actual_passed = far(rounds, edits - 1, diagonal + 1);
        let is_there = planned_passed <= n && planned_passed > actual_passed;
        if is_there || actual_passed - diagonal > m { (planned_passed, true) } else { (actual_passed, false) }
    };
    let mut edits = 0;
    loop {
        let mut round = vec![NOWHERE; 2 * edits as usize + 1];
        for diagonal in (-edits..=edits).step_by(2) {
            let (mut i, _) = match edits {
                0 => (0, true),
                _ => step(&rounds, edits, diagonal),
            };
            if i < 0 || i > n || i - diagonal > m {
                continue;
            }
            while same(i, i - diagonal) {
                i += 1;
            }
            round[(diagonal + edits) as usize] = i;
        }
        rounds.push(round);
        if far(&rounds, edits, n - m) == n {
            break;
        }
        if edits as usize == MOST_EDITS {
            return ((0..planned.len()).collect(), (0..actual.len()).collect());
        }
        edits += 1;
    }
    let (mut of_planned, mut of_actual) = (Vec::new(), Vec::new());
    let mut diagonal = n - m;
    while edits > 0 {
        let (i, is_planned) = step(&rounds, edits, diagonal);
        if is_planned {
            of_planned.push(i as usize - 1)
        } else {
            of_actual.push((i - diagonal) as usize - 1)
        }
        diagonal += if is_planned { -1 } else { 1 };
        edits -= 1;
    }
    of_planned.reverse();
    of_actual.reverse();
    (of_planned, of_actual)
}
