//! The column `station` says from where the tracker read, once for each posture.

use super::exports::{PLAIN, read};
use super::*;
use crate::common::cases::slip;

/// The two postures of [`PLAIN`], read from two stations.
fn two() -> String {
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        let station = match fields[0] {
            "posture" => "station",
            "P1" => "front",
            _ => "side",
        };
        format!("{line},{station}\n")
    };
    PLAIN.lines().map(row).collect()
}

#[test]
fn stations_are_read_written_and_left_open_where_there_is_one() -> Check {
    let cell = rope_cell();
    let table = planned(&two(), &cell)?;
    assert_eq!(table.stations(), ["front", "side"]);
    let written = write_readings(&table, &cell);
    assert!(written.starts_with("posture,state,point,x_mm,y_mm,z_mm,station,time_s"));
    let again = readings(&written, &cell)?;
    assert_eq!(again.stations(), ["front", "side"]);
    // Without the column, and with nothing in it, no station is named.
    for text in [PLAIN.to_string(), two().replace(",front", ",").replace(",side", ",")] {
        let table = planned(&text, &cell)?;
        assert!(table.stations().is_empty());
        assert!(write_readings(&table, &cell).starts_with("posture,state,point,x_mm,y_mm,z_mm,time_s"));
    }
    // In the first row of each posture alone.
    let mut last = String::new();
    let whole = two();
    let thin = whole.lines().map(|line| {
        let posture = line.split(',').next().unwrap_or_default().to_string();
        let first = posture != last;
        last = posture;
        let (row, _) = line.rsplit_once(',').unwrap_or_default();
        if first { format!("{line}\n") } else { format!("{row},\n") }
    });
    let table = planned(&thin.collect::<String>(), &cell)?;
    assert_eq!(table.stations(), ["front", "side"]);
    Ok(())
}

#[test]
fn stations_of_other_software_are_mapped() -> Check {
    let theirs = two().replace("station", "Instrument");
    let table = read(&[("export.csv", theirs.as_bytes())], "station = \"Instrument\"")?;
    assert_eq!(table.stations(), ["front", "side"]);
    insta::assert_snapshot!(read(&[("export.csv", theirs.as_bytes())], "").unwrap_err(), @r#"
    export.csv:1:43: Instrument: The table has no column of this name.
      hint: say in [columns] of the cell file what these headings are, a line for each, with the unit that the file has, for example: station = "Instrument"
    "#);
    // In one name with the others.
    let whole = PLAIN.lines().map(|line| {
        let fields: Vec<&str> = line.splitn(4, ',').collect();
        match fields[..] {
            ["posture", _, _, rest] => format!("name,{rest}\n"),
            [posture, state, point, rest] => {
                let station = if posture == "P1" { "A" } else { "B" };
                format!("{station}::{posture}::{state}::{point},{rest}\n")
            }
            _ => String::new(),
        }
    });
    let whole: String = whole.collect();
    let pattern = "name_pattern = \"{station}::{posture}::{state}::{point}\"";
    let table = read(&[("export.csv", whole.as_bytes())], pattern)?;
    assert_eq!(table.stations(), ["A", "B"]);
    Ok(())
}

#[test]
fn a_posture_has_one_station_and_every_posture_has_it() -> Check {
    let cell = rope_cell();
    let mut report = String::new();
    for (from, to) in [
        ("P1,loaded,left,1500.25,-200.75,899.5,61,front", "P1,loaded,left,1500.25,-200.75,899.5,61,side"),
        (",side", ","),
        ("P1,loaded,right,1350.1875,-50.5,899.75,75.25,front", "P1,loaded,right,1350.1875,-50.5,899.75,75.25,"),
    ] {
        assert!(two().contains(from), "{from}");
        report += &slip(to, planned(&two().replace(from, to), &cell));
    }
    insta::assert_snapshot!("stations_of_a_posture", report);
    Ok(())
}
