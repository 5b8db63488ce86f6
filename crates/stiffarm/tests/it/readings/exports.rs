//! Exports of tracker software, made up in its style (tests/exports/README.md), hold what our own table holds.

use super::*;
use crate::common::cases::slip;
use stiffarm_files::table::read_measurements_of;

/// The readings of all exports, as a table of our own.
pub(super) const PLAIN: &str = "\
posture,state,point,x_mm,y_mm,z_mm,time_s
P1,unloaded,left,1500.125,-200.5,900.25,0
P1,unloaded,right,1350.0625,-50.25,900.5,12.5
P1,loaded,left,1500.25,-200.75,899.5,61
P1,loaded,right,1350.1875,-50.5,899.75,75.25
P2,unloaded,left,402.5,1433.125,880.75,1260
P2,unloaded,right,251.25,1290.5,881,1272.5
P2,loaded,left,402.75,1433.375,880.125,1320
P2,loaded,right,251.5,1290.75,880.375,1334.75
";

macro_rules! export {
    ($name:literal) => {
        ($name, &include_bytes!(concat!("../../exports/", $name))[..])
    };
}

pub(super) fn read(files: &[(&str, &[u8])], columns: &str) -> stiffarm::Result<ReadingTable> {
    let cell = cell_with(ROPE, &format!("[columns]\n{columns}"));
    let files: Vec<(&[u8], &str)> = files.iter().map(|(name, bytes)| (*bytes, *name)).collect();
    match read_measurements_of(&files, &cell, Some(&postures()))? {
        Measurements::Readings(table) => Ok(table),
        Measurements::Displacements(_) => panic!("the table has positions"),
    }
}

/// Positions to a nanometre and times to ten microseconds, which days in a double know; the same names.
pub(super) fn assert_same(table: &ReadingTable, wanted: &ReadingTable, times: bool, what: &str) {
    let flat = |table: &ReadingTable| -> Vec<(String, String, Reading)> {
        let postures = table.postures.iter();
        let states = postures.flat_map(|p| p.states.iter().map(|s| (p.posture.name.clone(), s)));
        states
            .flat_map(|(p, s)| {
                let readings = s.readings.iter().cloned();
                readings.map(move |r| (p.clone(), s.state.clone(), r))
            })
            .collect()
    };
    let (rows, wanted) = (flat(table), flat(wanted));
    assert_eq!(rows.len(), wanted.len(), "{what}");
    for ((p, s, r), (wp, ws, wr)) in rows.iter().zip(&wanted) {
        assert_eq!((p, s, &r.target), (wp, ws, &wr.target), "{what}");
        assert!((r.position - wr.position).norm() < 1e-9, "{what}: {r:?}");
        match (times, r.time, wr.time) {
            (true, Some(time), Some(wanted)) => {
                assert!((time - wanted).abs() < 1e-5, "{what}: {time} {wanted}");
            }
            (false, None, _) => {}
            other => panic!("{what}: {other:?}"),
        }
    }
}

#[test]
fn eleven_exports_hold_the_same_readings() -> Check {
    let wanted = planned(PLAIN, &rope_cell())?;
    let mut count = 0;
    let mut check = |files: &[(&str, &[u8])], columns: &str, times| -> Check {
        let table = read(files, columns).map_err(|e| format!("{}: {e}", files[0].0))?;
        assert_same(&table, &wanted, times, files[0].0);
        count += 1;
        Ok(())
    };
    let sa = "profile = 'spatialanalyzer'\n";
    check(&[export!("spatialanalyzer-comma.txt")], sa, false)?;
    check(&[export!("spatialanalyzer-space.txt")], sa, false)?;
    check(
        &[export!("spatialanalyzer-times.txt")],
        &format!("{sa}order = ['name', 'x_m', 'y_m', 'z_m', 'time_s']"),
        true,
    )?;
    check(&[export!("polyworks-style.csv")], "time_s = 'Zeit'\nname_pattern = '{posture}_{state}_{point}'", true)?;
    check(
        &[export!("metrolog-style.txt")],
        "name = 'Label'\nname_pattern = '{point} / {posture} / {state}'\nx_mm = 'X'\ny_mm = 'Y'\nz_mm = 'Z'\n\
         date = 'Date'\ntime_s = 'Heure'\nignore = ['DX']",
        true,
    )?;
    check(
        &[export!("leica-style.csv")],
        "point = 'Point ID'\nposture = 'Workpiece'\nstate = 'Group'\ntime_s = 'Timestamp'\nignore = ['RMS']",
        true,
    )?;
    check(
        &[export!("api-style.csv")],
        "name = 'Target'\nname_pattern = '{posture}-{state}-{point}'\nx_mm = 'Coordinate 1'\ny_mm = 'Coordinate 2'\n\
         z_mm = 'Coordinate 3'\ntime_d = 'Time'",
        true,
    )?;
    check(
        &[export!("powerinspect.txt")],
        "profile = 'powerinspect'\nname_pattern = '{posture} {state} {point}'",
        false,
    )?;
    check(
        &[export!("two-files-P1.csv"), export!("two-files-P2.csv")],
        "name = 'Group'\nname_pattern = '{posture}.{state}'\npoint = 'Target'\nx_mm = 'X'\ny_mm = 'Y'\nz_mm = 'Z'",
        false,
    )?;
    check(
        &[export!("faro-style.xlsx")],
        "sheet = 'Points'\nname = 'Feature'\nname_pattern = '{posture}|{state}|{point}'\nx_mm = 'Actual X'\n\
         y_mm = 'Actual Y'\nz_mm = 'Actual Z'\ntime_s = 'Measured at'",
        true,
    )?;
    check(&[export!("leica.csv")], "profile = 'leica'\nname_pattern = '{posture}/{state}/{point}'", true)?;
    assert_eq!(count, 11);
    // A table of our own is still read with a profile, and one whose names stand apart.
    let plain = read(&[("own.csv", PLAIN.as_bytes())], sa)?;
    assert_same(&plain, &wanted, true, "own");
    Ok(())
}

#[test]
fn uncertainties_and_temperatures_are_those_of_their_rows() -> Check {
    let leica = "profile = 'leica'\nname_pattern = '{posture}/{state}/{point}'";
    let table = read(&[export!("leica.csv")], leica)?;
    let last = &table.postures[1].states[1].readings[1];
    let expanded = last.expanded.ok_or("none")?;
    assert!((expanded - Vector3::new(3e-6, 0.0, 6e-6)).norm() < 1e-15);
    assert_eq!(last.temperature, Some(21.75));
    // What is written is read as the same; °F and µm are read.
    let cell = rope_cell();
    let written = stiffarm_files::table::write_readings(&table, &cell);
    let again = readings(&written, &cell)?;
    assert_same(&again, &table, true, "written");
    let stated = |table: &ReadingTable| -> Vec<(Option<Vector3<f64>>, Option<f64>)> {
        let states = table.postures.iter().flat_map(|posture| &posture.states);
        let all = states.flat_map(|state| &state.readings);
        all.map(|r| (r.expanded, r.temperature)).collect()
    };
    assert_eq!(stated(&again), stated(&table));
    let text = "posture,state,point,x_mm,y_mm,z_mm,u95x_um,u95y_um,u95z_um,Temperature [°F]\n\
               P1,unloaded,left,1,2,3,4,5,6,212\nP1,loaded,left,1,2,3,,,,\n";
    let plain = planned(text, &cell)?;
    let states = &plain.postures[0].states;
    assert_eq!(states[0].readings[0].temperature, Some(100.0));
    let stated = states[0].readings[0].expanded.ok_or("none")?;
    assert!((stated - Vector3::new(4e-6, 5e-6, 6e-6)).norm() < 1e-15);
    assert_eq!(states[1].readings[0].expanded, None);
    let below = text.replace(",4,5,6", ",4,-5,6");
    // Without the profile the encoding has to be said.
    let unsaid = self::read(&[export!("leica.csv")], "");
    insta::assert_snapshot!(slip("below zero", planned(&below, &cell)) + &slip("no encoding", unsaid), @r#"
    » below zero
    [invalid-value] readings.csv:2:26: u95y_um: An uncertainty is not below zero.

    » no encoding
    [encoding] leica.csv:1:124: A character here is not UTF-8.
      hint: save the file as UTF-8 (in Excel: "CSV UTF-8"), or write encoding = "latin-1" into [columns] of the cell file
    "#);
    Ok(())
}

#[test]
fn a_sheet_names_readings_that_have_no_names() -> Check {
    let (name, bytes) = export!("leica.csv");
    // The export without its first column, and a sheet of the same order.
    let nameless: Vec<u8> = bytes
        .split(|byte| *byte == b'\n')
        .flat_map(|line| {
            let from = line.iter().position(|byte| *byte == b',');
            let rest = from.map_or(&line[..0], |at| &line[at + 1..]);
            rest.iter().copied().chain([b'\n'])
        })
        .collect();
    let rows = PLAIN.lines().skip(1).enumerate().map(|(i, row)| {
        let names: Vec<&str> = row.split(',').take(3).collect();
        format!("{},,,,{}\n", names.join(","), if names[1] == "loaded" { 100 + i } else { 0 })
    });
    let rows: Vec<String> = rows.collect();
    let heading = "posture,state,point,x_mm,y_mm,z_mm,load_n\n";
    let sheet = |rows: &[String]| (heading.to_string() + &rows.concat()).into_bytes();
    let whole = sheet(&rows);
    let profile = "profile = 'leica'";
    let wanted = planned(PLAIN, &rope_cell())?;
    // In either order.
    let mut report = String::new();
    for files in
        [[("sheet.csv", &whole[..]), (name, &nameless[..])], [(name, &nameless[..]), ("sheet.csv", &whole[..])]]
    {
        // The loads are those of the sheet, and alike within a posture and state.
        report += &slip(files[0].0, read(&files, profile));
    }
    insta::assert_snapshot!(report, @"
    » sheet.csv
    [conflict] leica.csv:5:20: load_n: 103 differs from 102 on line 4, but the posture and its state are the same.
      hint: angles and wrench belong to the posture and state: average them, or name another state

    » leica.csv
    [conflict] leica.csv:5:20: load_n: 103 differs from 102 on line 4, but the posture and its state are the same.
      hint: angles and wrench belong to the posture and state: average them, or name another state
    ");
    let alike: Vec<String> = rows.iter().map(|row| row.replace(",103", ",102").replace(",107", ",106")).collect();
    let whole = sheet(&alike);
    let table = read(&[("sheet.csv", &whole), (name, &nameless)], profile)?;
    assert_same(&table, &wanted, true, "by a sheet");
    assert_eq!(table.postures[1].states[1].load, Some(106.0));
    assert_eq!(table.postures[0].states[0].readings[1].temperature, Some(20.25));
    let said: Vec<&str> = table.remarks.iter().map(|f| f.sentence.as_str()).collect();
    assert_eq!(said, ["leica.csv has no names: sheet.csv says row by row what its 8 readings are of."]);
    // A row more or less is not guessed at.
    let short = sheet(&alike[..7]);
    let error = read(&[("sheet.csv", &short), (name, &nameless)], profile).unwrap_err();
    assert_eq!(
        error.message(),
        "8 readings without names stand beside 7 rows of sheet.csv, which say in which order they were taken."
    );
    // Alone they say what is missing.
    insta::assert_snapshot!(read(&[(name, &nameless)], profile).unwrap_err(), @"
    leica.csv:1: The column posture is missing.
      hint: a table of readings has the columns posture, state, point, x_mm, y_mm, z_mm; one without names is read beside the sheet in whose order it was taken: give both
    ");
    // A sheet that is filled in is a table like any other.
    let filled = whole.clone();
    let filled = String::from_utf8(filled)?.replace(",,,,", ",1,2,3,").into_bytes();
    let error = read(&[("sheet.csv", &filled), (name, &nameless)], profile).unwrap_err();
    assert_eq!(error.code(), stiffarm::Code::Conflict);
    Ok(())
}

#[test]
fn the_suggested_columns_read_the_export() -> Check {
    // What the message of a refused file says can be pasted.
    let (name, bytes) = export!("two-files-P1.csv");
    let text = std::str::from_utf8(bytes)?.replace("P1.unloaded", "unloaded");
    let text = text.replace("P1.loaded", "loaded").replace('\n', ",P1\n");
    let text = text.replacen(",P1\n", ",Pose no\n", 1);
    let error = read(&[(name, text.as_bytes())], "").unwrap_err();
    let hint = error.hint_text().unwrap_or_default();
    let (_, keys) = hint.split_once("for example: ").ok_or("no example")?;
    let table = read(&[(name, text.as_bytes())], &keys.replace(", ", "\n"))?;
    assert_eq!(table.postures.len(), 1);
    assert_eq!(table.postures[0].states[1].readings.len(), 2);
    Ok(())
}

#[test]
fn each_refused_export_says_the_next_step() {
    let (_, comma) = export!("spatialanalyzer-comma.txt");
    let (_, space) = export!("spatialanalyzer-space.txt");
    let (_, leica) = export!("leica-style.csv");
    let (_, poly) = export!("polyworks-style.csv");
    let (_, metrolog) = export!("metrolog-style.txt");
    let (_, faro) = export!("faro-style.xlsx");
    let (_, two) = export!("two-files-P1.csv");
    let named =
        "name = 'Group'\nname_pattern = '{posture}.{state}'\npoint = 'Target'\nx_mm = 'X'\ny_mm = 'Y'\nz_mm = 'Z'";
    let clocks = |times: [&str; 3]| {
        let rows = [",unloaded,left,1,2,3,", ",unloaded,right,1,2,3,", ",loaded,left,1,2,3,"];
        let rows = rows.iter().zip(times).map(|(row, time)| format!("P1{row}{time}\n"));
        let rows: String = rows.collect();
        format!("posture,state,point,x_mm,y_mm,z_mm,time_s\n{rows}").into_bytes()
    };
    let either = clocks(["5/11/2026 14:05:00", "6/11/2026 14:05:00", "7/11/2026 9:00:00"]);
    let mixed = clocks(["5/11/2026 14:05:00", "", "14:05:00"]);
    let midnight = clocks(["23:59:50", "23:59:58", "0:00:10"]);
    let words = clocks(["0", "a minute later", "2"]);
    let turned = clocks(["13/11/2026 9:00", "11/13/2026 9:01", ""]);
    let mut report = String::new();
    let mut note = |what: &str, files: &[(&str, &[u8])], columns: &str| {
        let error = read(files, columns).unwrap_err();
        report += &format!("» {what}\n{error}\n");
    };
    note("no heading, commas", &[("sa.txt", comma)], "comment = '//'");
    note("no heading, spaces", &[("sa.txt", space)], "comment = '//'");
    note("remarks of another sign", &[("sa.txt", comma)], "");
    note("headings that are not known", &[("two.csv", two)], "");
    note("the same below titles", &[("leica.csv", leica)], "ignore = ['Job']");
    note("names that hold several", &[("poly.csv", poly)], "time_s = 'Zeit'");
    note(
        "a name that does not fit",
        &[("poly.csv", poly)],
        "time_s = 'Zeit'\nname_pattern = '{posture}-{state}-{point}'",
    );
    note(
        "another number of columns",
        &[("sa.txt", comma)],
        "profile = 'spatialanalyzer'\norder = ['name', 'x_mm', 'y_mm', 'z_mm']",
    );
    note(
        "one heading missing",
        &[("metrolog.txt", metrolog)],
        "name = 'Label'\nname_pattern = '{point} / {posture} / {state}'\nx_mm = 'X'\ny_mm = 'Y'\nz_mm = 'Z'\ntime_s = 'Heure'",
    );
    note("day or month", &[("m.csv", &either)], "");
    note("two forms", &[("m.csv", &mixed)], "");
    note("midnight", &[("m.csv", &midnight)], "");
    note("no time", &[("m.csv", &words)], "");
    note("two orders", &[("m.csv", &turned)], "");
    note("the order is another", &[("m.csv", &turned)], "dates = 'day-first'");
    note("files that differ", &[("a.csv", two), ("b.csv", PLAIN.as_bytes())], named);
    note("the wrong sheet", &[("faro.xlsx", faro)], "");
    note("no such sheet", &[("faro.xlsx", faro)], "sheet = 'Point'");
    insta::assert_snapshot!("refused_exports", report);
    // With the order given, the same file is read.
    assert!(read(&[("m.csv", &either)], "dates = 'month-first'").is_ok());
    let one_day = clocks(["5/11/2026 14:05:00", "5/11/2026 14:06:00", "5/11/2026 14:07:00"]);
    assert!(read(&[("m.csv", &one_day)], "").is_ok());
}

#[test]
fn slips_in_the_columns_of_a_cell() {
    let mut report = String::new();
    for columns in [
        "profile = 'spatialanalyser'",
        "profile = 'gom'",
        "name_pattern = '{pose}::{point}'",
        "name_pattern = '{posture}{point}'",
        "dates = 'us'",
        "separator = 'pipe'",
        "order = 'x_mm'",
        "order = ['x_mm', 'q9_deg']",
        "order = ['x_mm', '-', '-', 'x_mm']",
        "sheet = ['a']",
        "name = 'Name'\npoint = 'name'",
    ] {
        let text = format!(
            "format = 1\nrobot.dh_modified = [[0, 0, 800, 0], [-90, 400, 0, -90]]\n\
             robot.limits_deg = [[-170, 170], [-75, 95]]\ntool.loading_point_mm = [200, 0, 250]\n\
             [[tool.measuring_point]]\nname = 'left'\nposition_mm = [150, 0, 200]\n[load]\n{ROPE}\n[columns]\n{columns}\n"
        );
        report += &format!("» {columns}\n{}\n", parse_cell(&text, "cell.toml").unwrap_err());
    }
    insta::assert_snapshot!("slips_in_columns", report);
}

#[test]
fn forces_in_the_names_of_states_are_those_of_the_sheet() -> Check {
    // An export has no column load_n, and nobody can add one.
    let export = "Name,X [mm],Y [mm],Z [mm]\n\
        P1::unloaded::left,1500.125,-200.5,900.25\n\
        P1::up-250::left,1500.25,-200.75,899.5\n\
        P1::up-500::left,1500.5,-201,898.75\n";
    let columns = "name = 'Name'\nname_pattern = '{posture}::{state}::{point}'";
    let table = read(&[("export.csv", export.as_bytes())], columns)?;
    let loads = |table: &ReadingTable| -> Vec<(String, Option<f64>)> {
        let states = table.postures[0].states.iter();
        states.map(|s| (s.state.clone(), s.load)).collect()
    };
    let named = [("unloaded", None), ("up-250", Some(250.0)), ("up-500", Some(500.0))];
    let named = named.map(|(state, load)| (state.to_string(), load));
    assert_eq!(loads(&table), named);
    let said = &table.remarks[0];
    assert_eq!(said.code, stiffarm::findings::codes::LOADS_FROM_NAMES);
    insta::assert_snapshot!(said.sentence, @"The table does not give load_n of up-250 and up-500: the force is the one in the name (up-250: 250 N, up-500: 500 N).");
    // As the sheet for these states has them.
    let mut options = SheetOptions::default();
    options.states = named.iter().map(|(state, _)| state.clone()).collect();
    let sheet = reading_sheet(&postures()[..1], &options, &rope_cell());
    for row in &sheet.rows {
        assert!(named.contains(&(row.state.clone(), row.load)), "{row:?}");
    }
    // What the table gives counts, and where names do not say it the table must.
    let more = format!("{ROPE_LOADS}P2,up-400,left,1500.5,-201,898.75,450\n");
    let table = planned(&more, &rope_cell())?;
    assert_eq!(table.postures[0].states[3].load, Some(450.0));
    assert!(table.remarks.is_empty());
    let unclear = export.replace("up-250", "first").replace("up-500", "second");
    insta::assert_snapshot!(read(&[("export.csv", unclear.as_bytes())], columns).unwrap_err(), @r#"
    export.csv:3:1: Name: Posture "P1" has 2 load states, but the force of "first" is not given.
      hint: add the column load_n: the force of rope, cylinder or weight in each state, or name the states with it (up-250); or the measured forces fx_n, fy_n, fz_n
    "#);
    Ok(())
}

#[test]
fn a_table_in_utf_16_is_read_where_it_says_so() -> Check {
    let wanted = planned(ROPE_LOADS, &rope_cell())?;
    let wide = |order: fn(u16) -> [u8; 2]| -> Vec<u8> {
        let text = format!("\u{feff}{ROPE_LOADS}");
        text.encode_utf16().flat_map(order).collect()
    };
    let mut report = String::new();
    for (bytes, what) in [(wide(u16::to_le_bytes), "little end first"), (wide(u16::to_be_bytes), "big end first")] {
        let read = |bytes: &[u8]| read_readings(bytes, "r.csv", &rope_cell(), Some(&postures()));
        assert_eq!(read(&bytes)?, wanted);
        report += &slip(what, read(&bytes[..bytes.len() - 1]));
        // Without the mark nothing says it.
        assert_eq!(read(&bytes[2..]).unwrap_err().code(), stiffarm::Code::TableHeading);
    }
    insta::assert_snapshot!(report, @r#"
    » little end first
    [encoding] r.csv:4:38: The file is UTF-16 text that ends within a character.
      hint: save the file as UTF-8 (in Excel: "CSV UTF-8"), or write encoding = "latin-1" into [columns] of the cell file

    » big end first
    [encoding] r.csv:4:38: The file is UTF-16 text that ends within a character.
      hint: save the file as UTF-8 (in Excel: "CSV UTF-8"), or write encoding = "latin-1" into [columns] of the cell file
    "#);
    Ok(())
}
