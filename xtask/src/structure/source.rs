//! Rust source as words: enough of the language, as rustfmt lays it out, to see paths and `use` trees, and no more.

/// `text` before its tests, which are its last modules.
pub fn code(text: &str) -> &str {
    let marks = ["\n#[cfg(test)]\nmod ", "\n#[cfg(all(test, "];
    let tests = marks.iter().filter_map(|mark| text.find(mark)).min();
    tests.map_or(text, |end| &text[..=end])
}

/// The names and signs of a code without its comments; `::` is one word.
pub fn words(code: &str) -> Vec<String> {
    let mut words = Vec::new();
    for line in code.lines() {
        let line = line.split("//").next().unwrap_or_default();
        let mut rest = line.trim_start();
        while let Some(sign) = rest.chars().next() {
            let end_of_name = rest.find(|sign| !is_name(sign)).unwrap_or(rest.len());
            let length = if rest.starts_with("::") { 2 } else { end_of_name.max(sign.len_utf8()) };
            words.push(rest[..length].to_string());
            rest = rest[length..].trim_start();
        }
    }
    words
}

pub fn is_name(sign: char) -> bool {
    sign.is_alphanumeric() || sign == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_tests_are_left_out() {
        let text = "//! use a;\nuse crate::b::{C, é}; // d\nfn e() {}\n\n#[cfg(test)]\nmod tests {\n}\n";
        assert_eq!(code(text).lines().count(), 4);
        assert_eq!(words(code(text)).join(" "), "use crate :: b :: { C , é } ; fn e ( ) { }");
        assert_eq!(code("a\nb\n"), "a\nb\n");
    }
}
