//! Rust source as words: enough of the language to see paths, `use` trees and the end of an item, and no more.

/// The words of `text` without comments, strings, characters and everything behind `#[cfg(test)]`: names, `::`, and
/// every other sign by itself.
pub fn words(text: &str) -> Vec<String> {
    without_test_items(all_words(text))
}

/// Lines of `text` before its tests: those in front of the `#[cfg(test)]` of a `mod`, or all.
pub fn lines_of_code(text: &str) -> usize {
    let lines: Vec<&str> = text.lines().collect();
    let tests = lines
        .windows(2)
        .position(|pair| is_test_mark(pair[0]) && pair[1].starts_with("mod "));
    tests.unwrap_or(lines.len())
}

fn is_test_mark(line: &str) -> bool {
    line.starts_with("#[cfg(test)]") || line.starts_with("#[cfg(all(test,")
}

fn all_words(text: &str) -> Vec<String> {
    let signs: Vec<char> = text.chars().collect();
    let at = |i: usize| signs.get(i).copied().unwrap_or('\0');
    let mut words = Vec::new();
    let mut i = 0;
    while i < signs.len() {
        let sign = signs[i];
        if sign == '/' && at(i + 1) == '/' {
            i = end_of_line(&signs, i);
        } else if sign == '/' && at(i + 1) == '*' {
            i = end_of_comment(&signs, i);
        } else if sign == '"' {
            i = end_of_string(&signs, i);
        } else if sign == '\'' {
            i = end_of_character(&signs, i);
        } else if is_name(sign) {
            let start = i;
            while is_name(at(i)) {
                i += 1;
            }
            let name: String = signs[start..i].iter().collect();
            match raw_string(&signs, i).filter(|_| matches!(name.as_str(), "r" | "br" | "cr")) {
                Some(end) => i = end,
                None => words.push(name),
            }
        } else if sign == ':' && at(i + 1) == ':' {
            words.push("::".to_string());
            i += 2;
        } else {
            if !sign.is_whitespace() {
                words.push(sign.to_string());
            }
            i += 1;
        }
    }
    words
}

fn is_name(sign: char) -> bool {
    sign.is_alphanumeric() || sign == '_'
}

fn end_of_line(signs: &[char], start: usize) -> usize {
    let rest = signs[start..].iter().position(|&sign| sign == '\n');
    rest.map_or(signs.len(), |length| start + length)
}

/// The end of a block comment, which may hold others.
fn end_of_comment(signs: &[char], start: usize) -> usize {
    let (mut depth, mut i) = (0, start);
    while i + 1 < signs.len() {
        match (signs[i], signs[i + 1]) {
            ('/', '*') => depth += 1,
            ('*', '/') => depth -= 1,
            _ => {
                i += 1;
                continue;
            }
        }
        i += 2;
        if depth == 0 {
            return i;
        }
    }
    signs.len()
}

fn end_of_string(signs: &[char], start: usize) -> usize {
    let mut i = start + 1;
    while i < signs.len() && signs[i] != '"' {
        i += if signs[i] == '\\' { 2 } else { 1 };
    }
    i + 1
}

/// The end of `'a'` or `'\n'`; a lifetime ends where its name begins, which is then a word.
fn end_of_character(signs: &[char], start: usize) -> usize {
    match signs.get(start + 1) {
        Some('\\') => {
            let rest = signs[(start + 3).min(signs.len())..].iter();
            rest.take(10)
                .position(|&sign| sign == '\'')
                .map_or(start + 1, |length| start + 4 + length)
        }
        Some(_) if signs.get(start + 2) == Some(&'\'') => start + 3,
        _ => start + 1,
    }
}

/// The end of the raw string whose `#` or `"` stands at `start`, after its `r`.
fn raw_string(signs: &[char], start: usize) -> Option<usize> {
    let hashes = signs[start..].iter().take_while(|&&s| s == '#').count();
    if signs.get(start + hashes) != Some(&'"') {
        return None;
    }
    let mut i = start + hashes + 1;
    while i < signs.len() {
        let closing = signs[i] == '"' && signs[i + 1..].iter().take(hashes).all(|&s| s == '#');
        if closing && i + hashes < signs.len() {
            return Some(i + 1 + hashes);
        }
        i += 1;
    }
    Some(signs.len())
}

/// `words` without the items marked `#[cfg(test)]` or `#[cfg(all(test, …))]`.
fn without_test_items(words: Vec<String>) -> Vec<String> {
    const MARKS: [&[&str]; 2] = [
        &["#", "[", "cfg", "(", "test", ")", "]"],
        &["#", "[", "cfg", "(", "all", "(", "test", ","],
    ];
    let marked = |rest: &[String]| MARKS.iter().any(|mark| begins(rest, mark));
    let mut kept = Vec::with_capacity(words.len());
    let mut i = 0;
    while i < words.len() {
        if marked(&words[i..]) {
            i = end_of_item(&words, end_of_group(&words, i + 1));
        } else {
            kept.push(words[i].clone());
            i += 1;
        }
    }
    kept
}

fn begins(words: &[String], with: &[&str]) -> bool {
    words.len() >= with.len() && words.iter().zip(with).all(|(a, b)| a == b)
}

/// The end of the bracket that opens at `start`.
fn end_of_group(words: &[String], start: usize) -> usize {
    let mut depth = 0_usize;
    for (i, word) in words.iter().enumerate().skip(start) {
        match word.as_str() {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return i + 1;
        }
    }
    words.len()
}

/// The end of the item at `start`: its `;`, or the brace that closes its body.
fn end_of_item(words: &[String], start: usize) -> usize {
    let mut i = start;
    let mut is_use = false;
    while i < words.len() {
        match words[i].as_str() {
            ";" => return i + 1,
            "{" if !is_use => return end_of_group(words, i),
            "{" | "(" | "[" => i = end_of_group(words, i),
            word => {
                is_use |= word == "use";
                i += 1;
            }
        }
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_strings_characters_and_tests_are_left_out() {
        let text = r####"
//! use crate::a;
use crate::b::{C, /* crate::d */ E};
#[cfg(test)]
use crate::f::{G, H};
const A: &str = "use \" crate::i"; // crate::j
const B: &str = r#"crate::k " "#;
fn m<'a>(x: &'a str) -> char { '"' }
#[cfg(test)]
mod tests {
    use crate::n;
    fn o() { if true { "}" } }
}
#[cfg(all(test, feature = "q"))]
#[allow(dead_code)]
mod more {
    use crate::r;
}
fn p() { '\'' ; '\u{1F600}' }
"####;
        let words = words(text).join(" ");
        assert_eq!(
            words,
            "use crate :: b :: { C , E } ; const A : & str = ; const B : & str = ; \
             fn m < a > ( x : & a str ) - > char { } fn p ( ) { ; }"
        );
    }

    #[test]
    fn code_ends_where_the_tests_begin() {
        assert_eq!(
            lines_of_code("a\n#[cfg(test)]\nuse b;\nc\n#[cfg(test)]\nmod tests {\n}\n"),
            4
        );
        assert_eq!(lines_of_code("a\nb\n"), 2);
    }
}
