//! Every mistake in a cell file is reported with its place.

use super::*;
use crate::common::cases::{cases, shown, slip};
use stiffarm_files::table::{read_measurements, read_postures};

#[test]
fn byte_order_mark_and_carriage_returns_leave_the_places_right() {
    let wrong = FULL.replace("magnitude_n = 500", "magnitude = 500");
    for text in [
        wrong.clone(),
        wrong.replace('\n', "\r\n"),
        format!("\u{feff}{wrong}"),
        format!("\u{feff}{}", wrong.replace('\n', "\r\n")),
    ] {
        let error = parse_cell_bytes(text.as_bytes(), "cell.toml").unwrap_err();
        let place = error.place();
        assert_eq!((place.line, place.column), (Some(28), Some(1)));
        assert_eq!(place.key.as_deref(), Some("load.magnitude"));
        let span = place.span.clone().unwrap_or_default();
        assert_eq!(&text[span], "magnitude");
    }
    let first_line = format!("\u{feff}{}", FULL.replace("format = 1", "format = 1, 2"));
    let error = parse_cell(&first_line, "cell.toml").unwrap_err();
    assert_eq!(error.place().column, Some(11), "{error}");
    let marked = format!("\u{feff}{}", FULL.replace('\n', "\r\n"));
    assert_eq!(parse_cell(&marked, "a").unwrap(), parse_cell(FULL, "b").unwrap());
}

/// What is said of each row of a table of slips in `base`, which `whole` makes a cell.
fn slips(table: &str, base: &str, whole: impl Fn(&str) -> String) -> String {
    let mut report = String::new();
    for [from, to] in cases(table) {
        let text = match from.as_str() {
            "FULL" => to.clone(),
            _ => base.replacen(&from, &to, 1),
        };
        assert_ne!(text, base, "{from}");
        report += &slip(&shown(&from, &to), parse_cell(&whole(&text), "cell.toml"));
    }
    report
}

#[test]
fn every_slip_is_reported_with_its_place() {
    let report = slips(include_str!("slips.txt"), FULL, str::to_string);
    insta::assert_snapshot!("cell_slips", report);
}

#[test]
fn every_slip_in_shapes_stations_and_torques_is_reported_with_its_place() {
    let base = include_str!("../../cells/comau-shapes.toml");
    let report = slips(include_str!("shape_slips.txt"), base, str::to_string);
    insta::assert_snapshot!("shape_slips", report);
}

#[test]
fn every_slip_in_load_cases_is_reported_with_its_place() {
    let cell = builtin::cell_text("comau").unwrap();
    let (before, rest) = cell.split_once("[load]").unwrap();
    let (_, after) = rest.split_once("[limits]").unwrap();
    let base = include_str!("../../cells/load-cases.toml");
    let table = include_str!("load_case_slips.txt");
    let report = slips(table, base, |load| format!("{before}{load}\n[limits]{after}"));
    insta::assert_snapshot!("load_case_slips", report);
}

/// Others are refused, in a row of `slips.txt`.
#[test]
fn a_number_too_small_is_zero_where_zero_is_a_number_as_any_other() {
    let text = FULL.replacen("anchor_mm = [1800, 0, 0]", "anchor_mm = [1800, 1e-320, 0]", 1);
    assert_ne!(text, FULL);
    assert_eq!(parse_cell(&text, "a").unwrap(), parse_cell(FULL, "b").unwrap());
}

#[test]
fn a_tool_in_metres_is_told_where_a_shape_swallows_it() {
    let mut text = stiffarm_files::builtin::cell_text("comau-shapes").unwrap().to_string();
    for (mm, m) in [
        ("[150, 0, 200]", "[0.15, 0, 0.2]"),
        ("[0, 150, 200]", "[0, 0.15, 0.2]"),
        ("[-150, 0, 200]", "[-0.15, 0, 0.2]"),
        ("[0, -150, 200]", "[0, -0.15, 0.2]"),
    ] {
        assert!(text.contains(mm));
        text = text.replacen(mm, m, 1);
    }
    let error = parse_cell(&text, "cell.toml").unwrap_err();
    insta::assert_snapshot!(error, @r#"
    cell.toml:93:1: tool.measuring_point[1].position_mm: Measuring point 1 is 0 mm inside "spindle": no beam reaches it.
      hint: the point lies 0.250 mm from the flange: is it in metres? The unit is mm.
    "#);
}

#[test]
fn bytes_that_are_not_utf8() {
    let mut report = String::new();
    for bytes in [&b"format = 1\nname = \"Pr\xfcfstand\"\n"[..], b"\xff\xfef\0o\0\x00\xdc"] {
        let error = parse_cell_bytes(bytes, "cell.toml").unwrap_err();
        report += &format!("[{}] {error}\n\n", error.code().as_str());
    }
    insta::assert_snapshot!("cell_encoding", report);
}

#[test]
fn deep_nesting_and_long_lines_end() {
    let cell = builtin::cell("fanuc-r2000ic").unwrap();
    let deep = format!("format = 1\nname = {}", "[".repeat(100_000));
    let tables = format!("format = 1\n[{}]", ["a"; 10_000].join("."));
    let inline = format!("format = 1\nx = {}", "{a=".repeat(50_000));
    let columns = format!("posture,{}", "q1_deg,".repeat(100_000));
    let quotes = "\"".repeat(100_001);
    for text in [deep, tables, inline, columns, quotes] {
        let text = text.as_bytes();
        let refused = [
            parse_cell_bytes(text, "a").err(),
            read_postures(text, "a", &cell.setup.robot).err(),
            read_measurements(text, "a", &cell, None).err(),
        ];
        for error in refused.map(Option::unwrap) {
            assert!(error.to_string().starts_with("a:"), "{error}");
        }
    }
}

/// A hint to another kind of load leads to no kind that refuses what is given beside.
#[test]
fn hints_to_kinds_of_loads_do_not_go_round() {
    let (before, rest) = FULL.split_once("[load]").unwrap();
    let (_, after) = rest.split_once("\n[").unwrap();
    let mut hints = String::new();
    for load in [
        "kind = \"rope\"\nanchor_mm = [1, 2, 3]\nmass_kg = 50",
        "kind = \"weight\"\nmass_kg = 50\nanchor_mm = [1, 2, 3]",
        "kind = \"rope\"\nanchor_mm = [1, 2, 3]\nforce_n = [1, 2, 3]",
        "kind = \"wrench\"\naxes = \"base\"\nforce_n = [1, 2, 3]\nmagnitude_n = 5",
        "kind = \"weight\"\nmagnitude_n = 5\nanchor_mm = [1, 2, 3]",
    ] {
        let error = parse_cell(&format!("{before}[load]\n{load}\n[{after}"), "cell.toml").unwrap_err();
        hints += &format!("» {}\n{}\n", shown("", load), error.hint_text().unwrap_or_default());
    }
    insta::assert_snapshot!(hints, @r#"
    » kind = "rope"; anchor_mm = [1, 2, 3]; mass_kg = 50
    a mass on a rope pulls with its weight: magnitude_n = 490.3
    » kind = "weight"; mass_kg = 50; anchor_mm = [1, 2, 3]
    remove it; where a rope or cylinder pulls, kind = "rope" or kind = "cylinder" takes it with magnitude_n
    » kind = "rope"; anchor_mm = [1, 2, 3]; force_n = [1, 2, 3]
    give the size of the force as magnitude_n
    » kind = "wrench"; axes = "base"; force_n = [1, 2, 3]; magnitude_n = 5
    give the force as force_n = [x, y, z] in newtons
    » kind = "weight"; magnitude_n = 5; anchor_mm = [1, 2, 3]
    remove it, or set kind = "rope" or "cylinder"
    "#);
}
