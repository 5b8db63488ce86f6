//! File names out of the ids of pictures.

/// Most characters of a name without its extension.
const LENGTH: usize = 80;
/// Names that Windows keeps for devices.
const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];

/// A name for each id: small ASCII letters, digits and hyphens, no two the same.
pub(super) fn stems<'a>(ids: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut stems: Vec<String> = Vec::new();
    for id in ids {
        let stem = safe(id);
        let mut name = stem.clone();
        let mut number = 2;
        while stems.contains(&name) {
            name = format!("{stem}-{number}");
            number += 1;
        }
        stems.push(name);
    }
    stems
}

/// A name that every file system takes.
fn safe(id: &str) -> String {
    let mut name = String::new();
    for c in id.chars() {
        if c.is_ascii_alphanumeric() {
            name.push(c.to_ascii_lowercase())
        } else if !name.is_empty() && !name.ends_with('-') {
            name.push('-')
        }
        if name.len() >= LENGTH {
            break;
        }
    }
    let name = name.trim_end_matches('-');
    let is_port = |start: &str| {
        let number = name.strip_prefix(start);
        number.is_some_and(|n| n.len() == 1 && n.chars().all(|c| c.is_ascii_digit()))
    };
    match name {
        "" => "picture".to_owned(),
        name if DEVICES.contains(&name) || is_port("com") || is_port("lpt") => {
            format!("picture-{name}")
        }
        name => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_safe_and_unique() {
        let ids = [
            "expected-deviation",
            "Expected deviation",
            "../../etc/passwd",
            "</script><img onerror=x>",
            "=cmd|' /C calc'!A0",
            "aux",
            "COM1",
            "\u{1b}[31m",
            "测",
            "",
            "expected-deviation",
        ];
        let names = stems(ids.into_iter());
        let expected = [
            "expected-deviation",
            "expected-deviation-2",
            "etc-passwd",
            "script-img-onerror-x",
            "cmd-c-calc-a0",
            "picture-aux",
            "picture-com1",
            "31m",
            "picture",
            "picture-2",
            "expected-deviation-3",
        ];
        assert_eq!(names, expected);
        assert!(stems(["x".repeat(500).as_str()].into_iter())[0].len() <= LENGTH);
    }
}
