//! Errors show place, key and hint in what a reader can read, and a hint names what was nearly typed.

use stiffarm::error::{Code, Error, did_you_mean};
use stiffarm::findings::{list, visible};
use stiffarm::model::robot::Robot;
use stiffarm_files::check_name;

#[test]
fn codes_are_unique_and_complete() {
    let mut names: Vec<_> = Code::ALL.iter().map(|c| c.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), Code::ALL.len());
}

#[test]
fn names_that_begin_with_what_was_typed_come_before_near_ones() {
    let hint = |name: &str| Robot::from_catalogue(name).unwrap_err().hint_text().unwrap().to_string();
    // Too long to be a slip of a name, and too short.
    assert_eq!(hint(&"ä".repeat(10_000_000)), hint("x"));
    insta::assert_snapshot!(["KUKA-KR210-R", "kuka-kr24-2", "x"].map(hint).join("\n"), @r#"
    did you mean "kuka-kr210-r2700-2" or "kuka-kr210-r3100-2"?
    did you mean "kuka-kr240-2"?
    `stiffarm robots` lists the robots
    "#);
    // Half of the letters are another name.
    assert_eq!(did_you_mean("foo", ["o1", "novel"]), None);
}

#[test]
fn display_has_place_key_and_hint() {
    let text = "a = 1\nbß = 2\n";
    let error = Error::new(Code::UnknownKey, "unknown key \"bß\".")
        .span(text, 6..9)
        .file("cell.toml")
        .key("bß")
        .hint("did you mean \"b\"?");
    assert_eq!(error.to_string(), "cell.toml:2:1: bß: unknown key \"bß\".\n  hint: did you mean \"b\"?");
}

#[test]
fn a_field_as_long_as_its_file_does_not_make_the_error_as_long() {
    let long = "ä".repeat(10_000_000);
    let error = Error::new(Code::TableRow, format!("\"{long}\" is not a number.")).hint(&long);
    let shown = error.key(&long).to_string();
    assert!(shown.len() < 20_000);
    let mut letters: Vec<char> = shown.chars().collect();
    letters.dedup_by(|a, b| *a == 'ä' && a == b);
    insta::assert_snapshot!(letters.into_iter().collect::<String>(), @r#"
    ä … ä: "ä … ä" is not a number.
      hint: ä … ä
    "#);
}

#[test]
fn span_inside_a_character_does_not_panic() {
    let error = Error::new(Code::TomlSyntax, "x").span("ß", 1..9);
    assert_eq!(error.place().column, Some(1));
}

#[test]
fn hidden_characters_are_shown_in_letters() {
    assert_eq!(visible("Ψ·H ä 漢 é 👍"), "Ψ·H ä 漢 é 👍");
    assert_eq!(visible("a\u{1b}[31m\n\t"), "a\\u{1b}[31m\\n\\t");
    for c in "\0\u{7f}\u{85}\u{9b}\u{200b}\u{2028}\u{202e}\u{2066}\u{feff}\u{e0041}".chars() {
        assert_eq!(visible(&c.to_string()), format!("\\u{{{:x}}}", u32::from(c)));
    }
}

#[test]
fn lists_in_words() {
    assert_eq!(list::<&str>(&[]), "");
    assert_eq!(list(&["a"]), "a");
    assert_eq!(list(&["a", "b", "c"]), "a, b and c");
}

#[test]
fn names_that_a_spreadsheet_would_calculate_are_refused() {
    for name in ["=1", "@a", "+5", "+.5", "-2+3", "-1-1", "-1+a", "-a(1)", "+z*2"] {
        assert!(check_name(name).is_err(), "{name}");
    }
    for name in ["+z", "-250", "-2.5", "+z-2", "-x-250", "up-250", "1-1", "5+3"] {
        assert!(check_name(name).is_ok(), "{name}");
    }
}
