//! Sheets to fill in hold every row of the plan, and read back when they are filled in.

use super::*;

#[test]
fn sheets_to_fill_in() -> Check {
    let one = &postures()[..1];
    let options = |states: &[&str], drift, base_reflector| {
        let mut options = SheetOptions::default();
        options.states = states.iter().map(|s| s.to_string()).collect();
        options.drift = drift;
        options.base_reflector = base_reflector;
        options
    };
    let mut report = String::new();
    for (what, cell, options) in [
        ("rope", rope_cell(), options(&[], false, false)),
        ("rope, loads, drift, base", rope_cell(), options(&["up-250", "up-500"], true, true)),
        ("preload", rope_cell(), options(&["preload", "loaded"], false, false)),
        ("states in an order of one's own", rope_cell(), options(&["loaded", "unloaded"], true, false)),
        ("sensor", sensor_cell(), options(&["up", "down"], false, false)),
        ("measured", cell_with("kind = 'measured'", ""), options(&[], false, false)),
    ] {
        let sheet = reading_sheet(one, &options, &cell).to_csv();
        report += &format!("» {what}\n{sheet}\n");
        let empty = readings(&sheet, &cell)?;
        assert_eq!(empty.pending.len(), sheet.lines().count() - 1);
        // Filled in, it is read.
        let (heading, rows) = sheet.split_once('\n').ok_or("no heading")?;
        let filled = rows.lines().map(|row| {
            let mut fields: Vec<&str> = row.split(',').collect();
            let loaded = Role::of(fields[1]) == Role::Loaded || fields[1] == "preload";
            let blank = 3..fields.len() - 2;
            let force = if loaded { "7" } else { "" };
            for (i, name) in heading.split(',').enumerate().filter(|(i, _)| blank.contains(i)) {
                fields[i] = if name.ends_with("_mm") { "5" } else { force };
            }
            fields.join(",") + "\n"
        });
        let filled = format!("{heading}\n{}", filled.collect::<String>());
        let table = readings(&filled, &cell)?;
        let rows_read = table.postures[0].states.iter().map(|s| s.readings.len());
        assert_eq!(rows_read.sum::<usize>(), rows.lines().count());
    }
    insta::assert_snapshot!("sheets", report);
    Ok(())
}

#[test]
fn bytes_of_workbooks_are_told_from_text() {
    let cell = rope_cell();
    let old = read_measurements(&[0xd0, 0xcf, 0x11, 0xe0, 0xa1], "old.xls", &cell, None);
    insta::assert_snapshot!(old.unwrap_err(), @r#"
    old.xls: This is a workbook of the old format (.xls) or one with a password.
      hint: save the sheet as .xlsx without a password, or as "CSV UTF-8"
    "#);
    // Detected by content: the name says .csv.
    let broken = read_measurements(b"PK\x03\x04 and no more", "m.csv", &cell, None).unwrap_err();
    assert_eq!(broken.code().as_str(), "file-read");
    // Neither is taken for a text that is not UTF-8.
    insta::assert_snapshot!(broken.hint_text().unwrap(), @r#"save the sheet as .xlsx without a password, or as "CSV UTF-8""#);
}

#[test]
fn sheets_leave_out_points_that_the_tracker_does_not_see() -> Check {
    use stiffarm_files::table::write_sheet_workbook;
    let text = stiffarm_files::builtin::cell_text("comau-shapes").unwrap();
    let three = text.replace("sight_mm = 5", "sight_mm = 5\nvisible_points = 3");
    let cell = parse_cell(&three, "cell.toml")?;
    let plan = stiffarm_files::builtin::postures("comau-group1", &cell.setup.robot)?;
    let hidden: Vec<Vec<usize>> = plan.iter().map(|p| cell.hidden_points(&p.q)).collect();
    assert!(hidden.iter().any(|points| points.len() == 1) && hidden.iter().any(Vec::is_empty), "{hidden:?}");
    let sheet = reading_sheet(&plan, &SheetOptions::default(), &cell);
    for (posture, hidden) in plan.iter().zip(&hidden) {
        for (number, point) in cell.setup.tool.measuring_points.iter().enumerate() {
            let mut rows = sheet.rows.iter();
            let has_row = rows.any(|row| row.posture.name == posture.name && row.point == point.name);
            assert_eq!(has_row, !hidden.contains(&number), "{} {}", posture.name, point.name);
        }
    }
    // The sheet to fill in and the page to tick off go by the same rows.
    let bytes = write_sheet_workbook(&sheet, &cell)?;
    let read = read_readings(&bytes, "m.xlsx", &cell, Some(&plan))?;
    assert_eq!(read.pending.len(), sheet.rows.len());
    // Where all of them are asked for and one is hidden, the plan has to change: nothing is left out.
    let all = parse_cell(text, "cell.toml")?;
    let sheet = reading_sheet(&plan, &SheetOptions::default(), &all);
    assert_eq!(sheet.rows.len(), plan.len() * 4 * 2);
    Ok(())
}
