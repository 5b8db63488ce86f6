//! Headings are understood with units of their own, names that hold several, times of clocks, forces in names.

use super::*;
use crate::common::cases::slip;
use stiffarm::model::cell::NamePattern;
use stiffarm::model::load::{Load, LoadCase};

#[test]
fn a_pattern_splits_names_at_its_texts() {
    let split = |pattern: &str, name: &str| {
        let pattern = NamePattern::parse(pattern).unwrap();
        let texts = pattern.split(name);
        texts.map(|parts| parts.join("|"))
    };
    let three = "{posture}::{state}::{point}";
    assert_eq!(split(three, "P1::up-250::left").unwrap(), "P1|up-250|left");
    assert_eq!(split(three, "P1:: up-250 ::a::b").unwrap(), "P1|up-250|a::b");
    assert_eq!(split(three, "P1::up-250"), None);
    assert_eq!(split(three, "P1::::left"), None);
    assert_eq!(split("{}::{posture}_{state}::{point}", "A::7_loaded::3").unwrap(), "7|loaded|3");
    assert_eq!(split("<{point}>", "<left>").unwrap(), "left");
    assert_eq!(split("<{point}>", "left"), None);
}

#[test]
fn patterns_that_cannot_split_are_refused() {
    for wrong in ["", "posture", "{posture", "{}", "{pose}", "{posture}{point}", "{point}-{point}"] {
        assert!(NamePattern::parse(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn units_in_brackets_become_ours() -> Check {
    let theirs = "Posture,State,Point,x [mm],Y(mm),z [ mm ],fx [N],Fy [n],fz [N],mx [N·m],my [Nm],mz [N*m],Time [s],q1 [°],q2 (deg)";
    let (heading, rows) = FULL.split_once('\n').ok_or("no heading")?;
    let cell = sensor_cell();
    let wanted = without_lines(readings(FULL, &cell)?);
    let bracketed = format!("{theirs}\n{rows}");
    assert_eq!(without_lines(readings(&bracketed, &cell)?), wanted);
    // Titles above it are no heading, though a column be known.
    let titled = format!("Job,x_mm\n{heading}\n{rows}");
    assert_eq!(without_lines(readings(&titled, &cell)?), wanted);
    Ok(())
}

#[test]
fn the_unit_of_a_heading_is_that_of_its_suggested_key() {
    let names = [
        "center x",
        "actual y (m)",
        "center z [um]",
        "x inch",
        "center x (cm)",
        "dev x",
        "x nominal",
        "point id",
        "point name",
        "measured at",
    ];
    insta::assert_snapshot!("suggested_keys", hints("center y", &names));
}

/// What the error about a table of these two headings proposes, a heading a line.
fn hints(first: &str, names: &[&str]) -> String {
    let hint = |name: &&str| {
        let error = planned(&format!("{first},{name}\n1,2\n"), &rope_cell()).unwrap_err();
        let (_, example) = error.hint_text().and_then(|hint| hint.split_once("for example: ")).expect(name);
        format!("{name}: {example}\n")
    };
    names.iter().map(hint).collect()
}

#[test]
fn forces_and_what_was_not_measured_are_no_positions() {
    // What is one of ours (X in mm) is not in the list.
    let names = [
        "Force X [N]",
        "Fz raw (kN)",
        "Sensor Fy",
        "Torque Z [N·m]",
        "Torque Z [N-mm]",
        "Force [N]",
        "Force X [lbf]",
        "Soll X",
        "X nom.",
        "CAD Y [mm]",
        "X target",
        "Rotation X [deg]",
        "Speed X",
        "Tx [mm]",
        "X in mm",
        "J2 [rad]",
        "Axis 1",
    ];
    insta::assert_snapshot!("suggested_keys_beside_positions", hints("Position Z", &names));
}

#[test]
fn counts_of_a_sensor_are_no_forces() {
    let mut report = String::new();
    for name in ["Fx counts", "Fx_counts", "fx (adc)", "Force X raw", "cnts Fx"] {
        let text = format!("{}\n", FULL.lines().next().unwrap()).replace("fx_n", name);
        report += &slip(name, readings(&text, &sensor_cell()));
    }
    insta::assert_snapshot!("counts_of_a_sensor", report);
}

#[test]
fn torques_are_moments() -> Check {
    let wanted = without_lines(readings(FULL, &sensor_cell())?);
    for [x, y, z] in [["Tx [Nm]", "Ty [Nm]", "Tz [Nm]"], ["Tx (N-m)", "Ty (N-m)", "Tz (N-m)"]] {
        let text = FULL.replace("mx_nm,my_nm,mz_nm", &[x, y, z].join(","));
        assert_eq!(without_lines(readings(&text, &sensor_cell())?), wanted);
    }
    // A translation along x is called so as well.
    let text = FULL.replace("mx_nm", "Tx [mm]");
    assert!(readings(&text, &sensor_cell()).is_err());
    Ok(())
}

#[test]
fn a_binary_file_is_told_by_its_name() {
    // Block of parameters 2, 0x50; then counts, zeros, and numbers that are no text.
    let mut motion = vec![2, 0x50, 41, 0, 0, 0, 1, 0, 200, 3];
    motion.extend([0xff, 0xfe, 0, 0x80].repeat(300));
    let mut report = String::new();
    for (bytes, what) in [
        (motion, "motion capture"),
        (b"%PDF-1.7\n\xe2\xe3\xcf\xd3".to_vec(), "PDF"),
        (b"\x89HDF\r\n\x1a\n\0\0".to_vec(), "HDF5"),
        (b"\x93NUMPY\x01\0v\0{}".to_vec(), "NumPy"),
    ] {
        report += &slip(what, read_readings(&bytes, "trial.c3d", &rope_cell(), None));
    }
    insta::assert_snapshot!("binary_files", report);
}

/// The times of readings with these in their column, since the first of them.
fn times(texts: &[&str]) -> stiffarm::Result<Vec<f64>> {
    let mut text = "posture,state,point,x_mm,y_mm,z_mm,time_s\n".to_string();
    for time in texts {
        text += &format!("P1,unloaded,left,1,2,3,\"{time}\"\n");
    }
    text += &format!("P1,loaded,left,1,2,4,\"{}\"\n", texts[texts.len() - 1]);
    let table = planned(&text, &rope_cell())?;
    let readings = table.postures[0].states[0].readings.iter();
    Ok(readings.map(|r| r.time.unwrap()).collect())
}

#[test]
fn days_are_counted_as_the_calendar_does() -> Check {
    // POSIX: 2000-02-29 is 951782400 s, 2026-11-23 is 1795392000 s.
    let days = ["1969-12-31", "1970-01-01", "2000-02-29", "2026-11-23"];
    let expected = [0, 86400, 86400 + 951_782_400, 86400 + 1_795_392_000].map(f64::from);
    assert_eq!(times(&days)?, expected);
    for wrong in ["2026-02-29", "2026-13-01"] {
        assert!(times(&["2026-01-01", wrong]).is_err(), "{wrong}");
    }
    // Each day is the one after the day before.
    let mut dates = Vec::new();
    for year in 2000..2005 {
        for month in 1..=12 {
            let last = match month {
                2 if year % 4 == 0 => 29,
                2 => 28,
                4 | 6 | 9 | 11 => 30,
                _ => 31,
            };
            dates.extend((1..=last).map(|day| format!("{year}-{month:02}-{day:02}")));
        }
    }
    let dates: Vec<&str> = dates.iter().map(String::as_str).collect();
    for (i, time) in times(&dates)?.iter().enumerate() {
        assert_eq!(*time, 86400.0 * i as f64);
    }
    Ok(())
}

#[test]
fn one_moment_in_many_forms() -> Check {
    let time = 14.0 * 3600.0 + 5.0 * 60.0 + 12.5;
    let utc = "2026-11-23T00:00:00Z";
    for (midnight, text) in [
        ("2026-11-23", "2026-11-23T14:05:12.5"),
        ("2026-11-23T00:00", "2026-11-23 14:05:12.5"),
        ("2026-11-23", "2026/11/23 14:05:12,5"),
        ("2026-11-23", "23.11.2026 14:05:12,5"),
        ("2026-11-23", "23.11.26, 2:05:12.5 PM"),
        (utc, "2026-11-23T14:05:12.5Z"),
        (utc, "2026-11-23T16:05:12.5+02:00"),
        (utc, "2026-11-23T08:35:12.5-0530"),
        ("11/23/2026 12:00 AM", "11/23/2026 2:05:12.5 PM"),
        ("23-11-2026 0:00:00", "23-11-2026 14:05:12.5"),
        ("00:00", "14:05:12.5"),
        ("12:00:00 am", "2:05:12.5 pm"),
    ] {
        assert_eq!(times(&[midnight, text])?, [0.0, time], "{text}");
    }
    for wrong in ["noon", "25:00:00", "14:5x", "31/31/2026 1:00", "2026-02-30 1:00", "1:2:3:4", "13:00 pm"] {
        assert!(times(&[wrong, wrong]).is_err(), "{wrong}");
    }
    Ok(())
}

fn rope(magnitude: f64) -> Load {
    Load::Rope { anchor: Vector3::zeros(), magnitude }
}

/// The forces that a sheet of these states under `load` is filled in with.
fn filled_in(states: &[&str], load: &Load) -> Vec<Option<f64>> {
    let mut cell = rope_cell();
    cell.setup.load = load.clone();
    let mut options = SheetOptions::default();
    options.states = std::iter::once("unloaded-0").chain(states.iter().copied()).map(String::from).collect();
    let sheet = reading_sheet(&postures()[..1], &options, &cell);
    let of = |state: &&str| sheet.rows.iter().find(|row| row.state == *state).unwrap().load;
    states.iter().map(of).collect()
}

#[test]
fn the_only_state_has_the_load_of_the_cell_and_a_number_its_own() {
    let rope = rope(-500.0);
    assert_eq!(filled_in(&["unloaded", "loaded"], &rope), [None, Some(500.0)]);
    assert_eq!(filled_in(&["loaded-2"], &rope), [Some(500.0)]);
    assert_eq!(
        filled_in(&["up-250", "500N", "load-300", "up250", "0.4kN", "250-up"], &rope),
        [250.0, 500.0, 300.0, 250.0, 400.0, 250.0].map(Some)
    );
    // A light preload may be named with its force, and does not make the load one of several.
    let states = ["preload-100", "loaded"];
    assert_eq!(filled_in(&states, &rope), [Some(100.0), Some(500.0)]);
    assert_eq!(filled_in(&["preload", "loaded"], &rope), [None, Some(500.0)]);
}

#[test]
fn what_is_not_certain_stays_empty() {
    let rope = rope(500.0);
    for unclear in ["up-600", "up-250-2", "250kg", "50%", "1.2.3", "2026-11-23", "2nd", "x.5"] {
        assert_eq!(filled_in(&[unclear], &rope), [None], "{unclear}");
    }
    // Several states of one load without a number.
    assert_eq!(filled_in(&["up", "down"], &rope), [None, None]);
    assert_eq!(filled_in(&["loaded", "loaded-2"], &rope), [None, None]);
}

#[test]
fn load_cases_have_their_own() {
    let case = |name: &str, load| LoadCase { name: name.to_string(), load, loading_point: None };
    let weight = Load::Weight { magnitude: 120.0, direction: -Vector3::z() };
    let load = Load::Cases(vec![case("side-300", rope(300.0)), case("weight", weight)]);
    let states = ["unloaded", "side-300", "unloaded-2", "weight"];
    let loads = filled_in(&states, &load);
    assert_eq!(loads, [None, Some(300.0), None, Some(120.0)]);
    let states = ["side-300-150", "side-300-300", "weight-500"];
    assert_eq!(filled_in(&states, &load), [Some(150.0), Some(300.0), None]);
}
