//! The table of words as reader and documentation ask it.

use super::effect::{Effect, Mode, Row};
use super::rows::ROWS;

use std::collections::HashMap;
use std::sync::LazyLock;

/// The rows of G-words and of M-words by their numbers, and of other words by their names.
type Index = ([Vec<Option<&'static Row>>; 2], HashMap<&'static str, &'static Row>);

static INDEX: LazyLock<Index> = LazyLock::new(|| {
    let (mut numbered, mut named) = ([Vec::new(), Vec::new()], HashMap::new());
    for row in ROWS {
        for word in row.words.split_whitespace() {
            let (first, last) = word.split_once('-').unwrap_or((word, word));
            let (Some((letter, first)), Some((_, last))) = (key_of(first), key_of(last)) else {
                named.insert(word, row);
                continue;
            };
            let rows: &mut Vec<Option<&Row>> = &mut numbered[letter];
            rows.resize(rows.len().max(last + 1), None);
            let whole = (first..=last).step_by(PARTS as usize);
            whole.for_each(|number| rows[number] = Some(row));
        }
    }
    (numbered, named)
});

/// Numbers of words are kept in tenths.
const PARTS: u32 = 10;

fn key_of(word: &str) -> Option<(usize, usize)> {
    let number = word.get(1..)?.parse().ok()?;
    key(word.as_bytes()[0], number)
}

/// Which of the lists of numbers, and where in it.
fn key(letter: u8, number: f64) -> Option<(usize, usize)> {
    let letter = [b'G', b'M'].iter().position(|candidate| *candidate == letter)?;
    let tenths = number * f64::from(PARTS);
    let is_whole = (tenths - tenths.round()).abs() < 1e-6 && (0.0..1e6).contains(&tenths);
    is_whole.then_some((letter, tenths.round() as usize))
}

/// The row of `G43.4` or `M30`.
pub fn numbered(letter: u8, number: f64) -> Option<&'static Row> {
    let (letter, number) = key(letter, number)?;
    INDEX.0[letter].get(number).copied().flatten()
}

/// The row of a word of several letters, in capitals: its own, or that without its digits, as `GOTO10` has it.
pub fn named(name: &str) -> Option<&'static Row> {
    let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let mut names = [name, letters].into_iter();
    names.find_map(|name| INDEX.1.get(name).copied())
}

/// How the documentation groups effects, and what it says of a group.
fn group(effect: Effect) -> &'static str {
    use Effect::*;
    match effect {
        Moves(Mode::Unfollowed) | Machine | Home => "Not followed, and said",
        Refused => "Refused",
        Alone => "Refused beside axis words, else without effect",
        Resets => "Refused behind the first point or with values, else without effect",
        Quiet | Declares | TakesAxes | Dwells | Stops => "Without effect on the points",
        _ => "Followed",
    }
}

/// The table as a page of the documentation.
pub fn page() -> String {
    let mut page = "# Words of G-code\n\n\
        Made from the table that the reader goes by. A word that is not here is refused in a block with axis words, \
        and said as a\n\
        caution in any other. What holds for paths as a whole stands in [paths](paths.md).\n"
        .to_string();
    let mut groups: Vec<&str> = Vec::new();
    for row in ROWS {
        let name = group(row.effect);
        if !groups.contains(&name) {
            groups.push(name);
        }
    }
    for name in groups {
        page += &format!("\n## {name}\n\n| words | what they do |\n|:--|:--|\n");
        for row in ROWS.iter().filter(|row| group(row.effect) == name) {
            let words: Vec<&str> = row.words.split_whitespace().collect();
            page += &format!("| {} | {} |\n", words.join(" ").replace('-', " to "), row.does);
        }
    }
    page
}
