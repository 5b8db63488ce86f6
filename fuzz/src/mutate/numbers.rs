//! Numbers at the edges of what a double, a count or a quantity can be.

use crate::random::Random;

/// Numbers that break what was not thought of.
pub const NUMBERS: [&str; 64] = [
    "0",
    "-0",
    "0.0",
    "-0.0",
    "1",
    "-1",
    "1e-9",
    "-1e-9",
    "1e-3",
    "1e3",
    "-1e3",
    "1e5",
    "1e6",
    "1e9",
    "-1e9",
    "1e12",
    "1e15",
    "1e16",
    "9007199254740993",
    "1e18",
    "18446744073709551615",
    "18446744073709551616",
    "-9223372036854775808",
    "-9223372036854775809",
    "1e22",
    "1e38",
    "1e77",
    "1e100",
    "-1e100",
    "1e150",
    "1e154",
    "1e155",
    "-1e155",
    "1e160",
    "1e200",
    "1e300",
    "-1e300",
    "1e308",
    "-1e308",
    "1.7976931348623157e308",
    "1e309",
    "5e-324",
    "-5e-324",
    "1e-300",
    "1e-200",
    "1e-160",
    "1e-154",
    "2.2250738585072014e-308",
    "1e-30",
    "1e-16",
    "-1e-16",
    "1e-12",
    "nan",
    "inf",
    "-inf",
    "NaN",
    "180",
    "-180",
    "180.00000000000001",
    "360",
    "90",
    "-90",
    "0.1",
    "0.95",
];

/// Numbers that are meant somewhere: what gets past the door.
pub const PLAUSIBLE: [&str; 24] = [
    "0", "0", "1e-9", "1e-6", "1e-4", "1e-3", "0.01", "0.1", "0.5", "1", "2", "-1", "10", "-30", "45", "60", "90",
    "-90", "100", "-250", "500", "1000", "1e4", "9e4",
];

/// Counts; what costs time in proportion is left to those who ask for it.
pub const COUNTS: [&str; 12] =
    ["0", "1", "2", "3", "7", "-1", "1.5", "1e1", "", "x", "4294967296x", "99999999999999999999999"];

/// Words that are no numbers, or look like one.
pub const WORDS: [&str; 40] = [
    "",
    " ",
    "x",
    "-",
    "+",
    ".",
    "e",
    "1e",
    "1e+",
    "0x10",
    "1_000",
    "1,5",
    "1.5.2",
    "1 000",
    "+1",
    "١٢",
    "½",
    "−1",
    "\u{a0}1",
    "true",
    "null",
    "\"",
    "'",
    "\\",
    "\"a",
    "a\"b",
    "#",
    "=1+1",
    "@x",
    "\u{1b}[2J",
    "\u{202e}x",
    "\u{feff}",
    "\u{0}",
    "ä",
    "名",
    "🦾",
    "a\nb",
    "a\tb",
    "[]",
    "{}",
];

/// A number at an edge, or near `number`.
pub fn edge_number(number: Option<f64>, random: &mut Random) -> String {
    let Some(number) = number.filter(|_| random.one_in(2)) else {
        return if random.one_in(2) { random.pick(&PLAUSIBLE).to_string() } else { random.pick(&NUMBERS).to_string() };
    };
    let near = match random.below(14) {
        0 => number * 1e3,
        1 => number * 1e-3,
        2 => -number,
        3 => number.to_radians(),
        4 => number.to_degrees(),
        5 => number * 10.0,
        6 => number.next_up(),
        7 => number.next_down(),
        8 => number * 1e6,
        9 => number * 1e-6,
        10 => number + 360.0,
        11 => number * number,
        12 => number * (1.0 + 1e-9),
        _ => f64::from_bits(random.next()),
    };
    format!("{near:?}")
}

/// One number of the text replaced.
pub fn change(text: &str, random: &mut Random) -> String {
    let places = places(text);
    let Some(place) = random.place(&places) else {
        return format!("{text}{}", edge_number(None, random));
    };
    let (start, end) = places[place];
    let new = edge_number(text[start..end].parse().ok(), random);
    // All numbers that are the same, now and then: a column of one load.
    if random.one_in(8) {
        return text.replace(&text[start..end], &new);
    }
    format!("{}{new}{}", &text[..start], &text[end..])
}

/// Where the numbers of a text begin and end.
fn places(text: &str) -> Vec<(usize, usize)> {
    let bytes = text.as_bytes();
    let mut spans = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let before = at.checked_sub(1).map(|i| bytes[i]);
        let word = before.is_some_and(|b| b.is_ascii_alphanumeric() || b == b'_');
        if !bytes[at].is_ascii_digit() || word {
            at += 1;
            continue;
        }
        let start = match before {
            Some(b'-' | b'+') => at - 1,
            _ => at,
        };
        let mut end = at;
        while end < bytes.len()
            && (bytes[end].is_ascii_digit()
                || matches!(bytes[end], b'.' | b'e' | b'E')
                || matches!(bytes[end], b'-' | b'+') && matches!(bytes[end - 1], b'e' | b'E'))
        {
            end += 1;
        }
        spans.push((start, end));
        at = end;
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found() {
        let text = "q1_deg = -1.5e-3, [2,x3] 4";
        let numbers: Vec<&str> = places(text).into_iter().map(|(a, b)| &text[a..b]).collect();
        assert_eq!(numbers, ["-1.5e-3", "2", "4"]);
    }
}
