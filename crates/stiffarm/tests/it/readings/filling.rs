//! Sheets that are being filled in are read as far as they are measured.

use super::*;
use stiffarm::measure::{not_measured_yet, prepare};

/// The sheet of three postures with the readings of `filled` in it: posture, state, point.
fn sheet(filled: impl Fn(&str, &str, &str) -> bool) -> String {
    let mut three = postures();
    three.push(Posture { name: "P3".to_string(), q: vec![0.3, 0.4] });
    let csv = reading_sheet(&three, &SheetOptions::default(), &rope_cell()).to_csv();
    let rows = (0..).zip(csv.lines()).map(|(line, row)| {
        let mut fields: Vec<&str> = row.split(',').collect();
        if line > 0 && filled(fields[0], fields[1], fields[2]) {
            fields.splice(3..6, ["1500.5", "-20", "900"]);
        }
        fields.join(",") + "\n"
    });
    rows.collect()
}

fn sentence(table: &ReadingTable) -> String {
    not_measured_yet(table).map_or_else(String::new, |finding| finding.sentence)
}

#[test]
fn rows_without_a_position_are_not_measured_yet() -> Check {
    let cell = rope_cell();
    let all = readings(&sheet(|p, _, _| p.starts_with('P')), &cell)?;
    assert!(all.pending.is_empty() && all.incomplete.is_empty());
    assert_eq!(sentence(&all), "");

    // Posture by posture, as a day goes on.
    let part = readings(&sheet(|p, s, _| p == "P1" || (p == "P2" && s == "unloaded")), &cell)?;
    assert_eq!(part.postures, all.postures[..1]);
    assert_eq!(part.incomplete.len(), 1);
    assert_eq!(part.incomplete[0].states, all.postures[1].states[..1]);
    assert_eq!(part.filled(), 6);
    let first = &part.pending[0];
    let names = (first.posture.as_str(), first.state.as_str(), first.point.as_str());
    assert_eq!((names, first.line), (("P2", "loaded", "left"), 8));
    assert_eq!(part.pending.len(), 6);
    assert_eq!(
        sentence(&part),
        "Not measured yet: postures P2 (loaded) and P3; 6 of 12 rows are filled in. \
         Left out until measured both unloaded and loaded: P2."
    );

    // Written and read again it is the same.
    let written = write_readings(&part, &cell);
    let again = readings(&written, &cell)?;
    assert_eq!(without_lines(again.clone()).postures, without_lines(part.clone()).postures);
    assert_eq!(sentence(&again), sentence(&part));
    assert_eq!(write_readings(&again, &cell), written);

    // One point of a state is missing: what is there counts.
    let point = readings(&sheet(|p, s, q| p != "P2" || s == "unloaded" || q == "left"), &cell)?;
    assert_eq!((point.postures.len(), point.incomplete.len()), (3, 0));
    assert_eq!(sentence(&point), "Not measured yet: posture P2 (loaded at right); 11 of 12 rows are filled in.");
    Ok(())
}

#[test]
fn a_sheet_that_says_nothing_yet_is_an_error() -> Check {
    let cell = rope_cell();
    let mut report = String::new();
    for text in [sheet(|_, _, _| false), sheet(|_, s, _| s == "unloaded")] {
        let table = readings(&text, &cell)?;
        assert!(table.postures.is_empty());
        let error = prepare(&cell, table, &Default::default()).unwrap_err();
        report += &format!("{error}\n");
    }
    // Half a position is a slip, and a state without its rows no matter of time.
    let full = sheet(|p, _, _| p == "P1");
    let half = full.replacen("1500.5,-20,900", "1500.5,,900", 1);
    report += &format!("{}\n", readings(&half, &cell).unwrap_err());
    let rows: Vec<&str> = full.lines().take(3).collect();
    report += &format!("{}\n", readings(&rows.join("\n"), &cell).unwrap_err());
    // The load of the states that are there is needed once others are to come.
    let two = "posture,state,point,x_mm,y_mm,z_mm,load_n,q1_deg,q2_deg\nP1,unloaded,left,1,2,3,,4,5\n\
               P1,up,left,1,2,3,,4,5\nP1,down,left,,,,,4,5\n";
    report += &format!("{}\n", readings(two, &cell).unwrap_err());
    insta::assert_snapshot!("not_measured_yet", report);
    Ok(())
}

#[test]
fn a_workbook_to_fill_in_holds_what_its_text_holds() -> Check {
    use stiffarm_files::table::write_sheet_workbook;
    let mut options = SheetOptions::default();
    options.states = ["up-250", "up-500, slowly", "007"].map(String::from).to_vec();
    options.drift = true;
    options.base_reflector = true;
    for cell in [rope_cell(), sensor_cell()] {
        let sheet = reading_sheet(&postures(), &options, &cell);
        let bytes = write_sheet_workbook(&sheet, &cell)?;
        assert_eq!(bytes, write_sheet_workbook(&sheet, &cell)?, "the same bytes");
        let read = read_readings(&bytes, "m.xlsx", &cell, None)?;
        assert_eq!(read, readings(&sheet.to_csv(), &cell)?);
        assert_eq!(read.pending.len(), sheet.rows.len());
    }
    Ok(())
}
