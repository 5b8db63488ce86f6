//! Exports beside a sheet of our own are read row by row, and `[columns]` speaks of the export alone.

use super::exports::{PLAIN, assert_same, read};
use super::*;
use crate::common::cases::slip;
use stiffarm_files::table::read_measurements_of;

/// Four postures with two points, unloaded and loaded: their plan, the sheet to fill in, and readings without names in its
/// order.
fn in_order() -> stiffarm::Result<(Vec<Posture>, String, Vec<String>)> {
    let plan = "posture,q1_deg,q2_deg\nP1,0,0\nP2,0,10\nP3,10,0\nP4,10,10\n";
    let plan = read_postures(plan.as_bytes(), "p.csv", &rope_cell().setup.robot)?;
    let (mut sheet, mut readings) = ("posture,state,point,x_mm,y_mm,z_mm\n".to_string(), Vec::new());
    for posture in 1..=4 {
        for (state, z) in [("unloaded", 900.0), ("loaded", 899.25)] {
            for (point, x) in [("left", 1500.0), ("right", 1350.0)] {
                sheet += &format!("P{posture},{state},{point},,,\n");
                readings.push(format!("{},{},{z}\n", x + 10.5 * f64::from(posture), 100 * posture));
            }
        }
    }
    Ok((plan, sheet, readings))
}

#[test]
fn a_reading_taken_twice_or_left_out_is_named_by_its_line() -> Check {
    let (plan, sheet, readings) = in_order()?;
    let read = |readings: &[String]| {
        let export = "X [mm],Y [mm],Z [mm]\n".to_string() + &readings.concat();
        let files = [(sheet.as_bytes(), "sheet.csv"), (export.as_bytes(), "export.csv")];
        read_measurements_of(&files, &rope_cell(), Some(&plan)).map(|_| ())
    };
    read(&readings)?;
    let mut report = String::new();
    let mut note = |what: &str, twice: Option<usize>, missing: Option<usize>| {
        let mut edited = readings.clone();
        // The later one first, so that numbers are those of the whole.
        let again = |edited: &mut Vec<String>| twice.map(|at| edited.insert(at + 1, edited[at].clone()));
        let left_out = |edited: &mut Vec<String>| missing.map(|at| edited.remove(at));
        if twice > missing {
            again(&mut edited);
            left_out(&mut edited);
        } else {
            left_out(&mut edited);
            again(&mut edited);
        }
        report += &format!("» {what}\n{}\n", read(&edited).unwrap_err());
    };
    note("late", Some(2), Some(12));
    note("early", Some(13), Some(3));
    note("once more", Some(6), None);
    note("one less", None, Some(9));
    insta::assert_snapshot!("order_of_readings", report);
    // One that stands elsewhere is for the screening to say.
    let mut far = readings.clone();
    far[5] = "100,200,300\n".to_string();
    read(&far)?;
    Ok(())
}

#[test]
fn what_columns_say_of_an_export_is_not_said_of_our_own_sheet() -> Check {
    let sheet = "posture,state,point,x_mm,y_mm,z_mm\nP1,unloaded,left,,,\nP1,loaded,left,,,\n";
    let wanted = "posture,state,point,x_mm,y_mm,z_mm\nP1,unloaded,left,1500.125,-200.5,900.25\n\
        P1,loaded,left,1500.25,-200.75,899.5\n";
    let wanted = planned(wanted, &rope_cell())?;
    let points = "Point,X [mm],Y [mm],Z [mm]\n1,1500.125,-200.5,900.25\n2,1500.25,-200.75,899.5\n";
    let spaces = "1500.125 -200.5 900.25\n1500.25 -200.75 899.5\n";
    for (columns, export) in [
        ("ignore = ['Point']", points),
        ("ignore = ['Point']\nseparator = 'comma'", points),
        ("ignore = ['POINT', 'State']\nx_mm = 'X [mm]'", points),
        ("separator = 'space'\norder = ['x_mm', 'y_mm', 'z_mm']", spaces),
    ] {
        let table = read(&[("sheet.csv", sheet.as_bytes()), ("export.csv", export.as_bytes())], columns);
        assert_same(&table.map_err(|e| format!("{columns}: {e}"))?, &wanted, false, columns);
    }
    // Workbooks: the sheet of the export is none of ours.
    let sheet_bytes = workbook::workbook(&[("Readings", workbook::cells(sheet))]);
    let export = workbook::workbook(&[("Cover", vec![]), ("Points", workbook::cells(points))]);
    let files = [("sheet.xlsx", &sheet_bytes[..]), ("export.xlsx", &export[..])];
    let columns = "ignore = ['Point']\nsheet = 'Points'";
    assert_same(&read(&files, columns)?, &wanted, false, columns);
    insta::assert_snapshot!(read(&files, "ignore = ['Point']\nsheet = 'Point'").unwrap_err(), @r#"
    export.xlsx: The workbook has no sheet "Point".
      hint: sheet in [columns] of the cell file names one of: Cover, Points
    "#);
    Ok(())
}

#[test]
fn columns_without_a_heading_can_be_left_out() -> Check {
    let wanted = planned(PLAIN, &rope_cell())?;
    // Nothing stands in them: they need no word.
    let empty = PLAIN.replace("x_mm", ",x_mm").replace(",left,", ",left,,").replace(",right,", ",right,,");
    assert_same(&read(&[("r.csv", empty.as_bytes())], "")?, &wanted, true, "empty");
    let filled = empty.replace(",,", ",ok,").replace(",ok,x_mm", ",,x_mm");
    insta::assert_snapshot!(read(&[("r.csv", filled.as_bytes())], "").unwrap_err(), @r#"
    r.csv:1:21: A column has no name.
      hint: give it a heading; where columns without one do not matter, write ignore = [""] into [columns] of the cell file
    "#);
    assert_same(&read(&[("r.csv", filled.as_bytes())], "ignore = ['']")?, &wanted, true, "filled");
    // Behind the last heading, in some rows.
    let behind = PLAIN.replacen("12.5\n", "12.5,door open,again\n", 1);
    assert!(read(&[("r.csv", behind.as_bytes())], "").is_err());
    assert_same(&read(&[("r.csv", behind.as_bytes())], "ignore = ['']")?, &wanted, true, "behind");
    Ok(())
}

#[test]
fn names_of_states_may_hold_what_separates_names() -> Check {
    let export = |rows: [&str; 3]| {
        let rows = rows.iter().zip(["900.25", "899.5", "898.75"]);
        let rows: String = rows.map(|(name, z)| format!("{name},1500.5,-200.5,{z}\n")).collect();
        format!("Name,X [mm],Y [mm],Z [mm]\n{rows}")
    };
    let names = |text: &str, columns: &str| -> stiffarm::Result<Vec<String>> {
        let table = read(&[("export.csv", text.as_bytes())], columns)?;
        let states =
            table.postures.iter().flat_map(|p| p.states.iter().map(|s| format!("{} {}", p.posture.name, s.state)));
        Ok(states.collect())
    };
    let pattern = "name = 'Name'\nname_pattern = '{posture}-{state}-{point}'";
    let text = export(["P1-unloaded-left", "P1-up-250-left", "P1-up-500-left"]);
    assert_eq!(names(&text, pattern)?, ["P1 unloaded", "P1 up-250", "P1 up-500"]);
    let turned = "name = 'Name'\nname_pattern = '{point}_{state}_{posture}'";
    let text = export(["left_unloaded_2_P1", "left_up_250_P1", "left_up_500_P1"]);
    assert_eq!(names(&text, turned)?, ["P1 unloaded_2", "P1 up_250", "P1 up_500"]);
    Ok(())
}

#[test]
fn columns_are_left_out_by_letter_or_number_as_well() -> Check {
    let wanted = planned(PLAIN, &rope_cell())?;
    // A column in between, and one without a heading behind the last.
    let with_more = |heading: &str| -> String {
        let lines = PLAIN.lines().enumerate().map(|(i, line)| {
            let more = if i == 0 { heading } else { "ok" };
            let [posture, state, rest] = line.splitn(3, ',').collect::<Vec<_>>()[..] else { panic!("{line}") };
            let last = if i == 0 { "" } else { ",?" };
            format!("{posture},{state},{more},{rest}{last}\n")
        });
        lines.collect()
    };
    let text = with_more("Status");
    assert!(read(&[("r.csv", text.as_bytes())], "").is_err());
    let mut report = String::new();
    for columns in ["ignore = ['C', 'I']", "ignore = ['3', '9']", "ignore = ['status', 'I']"] {
        let table = read(&[("r.csv", text.as_bytes())], columns)?;
        assert_same(&table, &wanted, true, columns);
        let left_out = table.remarks.iter().filter(|r| r.code == "columns-left-out");
        let said: Vec<&String> = left_out.map(|remark| &remark.sentence).collect();
        let [said] = said[..] else { panic!("{said:?}") };
        report += &format!("{columns}: {said}\n");
    }
    insta::assert_snapshot!(report, @r#"
    ignore = ['C', 'I']: `ignore` in [columns] leaves out by its place: column 3 ("Status") and 9 without a heading of r.csv.
    ignore = ['3', '9']: `ignore` in [columns] leaves out by its place: column 3 ("Status") and 9 without a heading of r.csv.
    ignore = ['status', 'I']: `ignore` in [columns] leaves out by its place: column 9 without a heading of r.csv.
    "#);
    // A heading of this name is meant, whatever its place.
    let named = with_more("C").replace(",?", "");
    let table = read(&[("r.csv", named.as_bytes())], "ignore = ['C']")?;
    assert!(table.remarks.iter().all(|r| r.code != "columns-left-out"));
    // Our own sheet has its columns.
    let plain = read(&[("own.csv", PLAIN.as_bytes())], "ignore = ['C', '4']")?;
    assert_same(&plain, &wanted, true, "own");
    Ok(())
}

#[test]
fn readings_without_names_are_followed_as_they_come() -> Check {
    use stiffarm_files::table::read_growing_measurements;
    let (plan, sheet, readings) = in_order()?;
    let look = |readings: &[String]| -> stiffarm::Result<ReadingTable> {
        let export = "X [mm],Y [mm],Z [mm]\n".to_string() + &readings.concat();
        let files = [(sheet.as_bytes(), "sheet.csv"), (export.as_bytes(), "export.csv")];
        match read_growing_measurements(&files, &rope_cell(), Some(&plan))? {
            Measurements::Readings(table) => Ok(table),
            Measurements::Displacements(_) => panic!("the table has positions"),
        }
    };
    for count in 1..=readings.len() {
        let table = look(&readings[..count])?;
        // Four readings are a posture.
        assert_eq!(table.postures.len(), count / 4, "{count}");
        assert_eq!(table.pending.len(), readings.len() - count);
        assert_eq!(table.incomplete.len(), usize::from(count % 4 != 0));
    }
    let mut twice = readings[..12].to_vec();
    twice.insert(6, twice[5].clone());
    let mut missing = readings[..12].to_vec();
    missing.remove(6);
    insta::assert_snapshot!(slip("twice", look(&twice)) + &slip("missing", look(&missing)), @"
    » twice
    [conflict] export.csv:8: There is one reading too many for the rows of sheet.csv: line 8 is that of line 7 once more.
      hint: delete this line

    » missing
    [conflict] export.csv:8: There is one reading too few for the rows of sheet.csv: P2 loaded left (line 8 of sheet.csv) has none.
      hint: delete that line of the sheet, or add the reading here
    ");
    Ok(())
}
