//! Templates of cells and tables can be used as they are, for every robot of the catalogue.

use super::*;
use crate::common::cases::slip;
use std::collections::BTreeSet;
use stiffarm_files::table::{read_measurements, read_postures};

/// Half-sine sequence of angles in the bounds: the same on every machine.
fn some_postures(cell: &Cell) -> impl Iterator<Item = Vec<f64>> + '_ {
    (1..400).map(|i| {
        let fraction = |j: usize| (f64::from(i) * (0.37 + 0.23 * j as f64)).rem_euclid(1.0);
        let bounds = cell.bounds.iter().enumerate();
        bounds.map(|(j, [low, high])| low + (high - low) * fraction(j)).collect()
    })
}

#[test]
fn templates_can_be_used_as_they_are() -> Check {
    let mut empty = BTreeSet::new();
    for entry in catalogue() {
        let text = template(entry.key)?;
        let cell = parse_cell(&text, "cell.toml")?;
        assert_eq!(cell.setup.robot.name(), entry.name);
        assert_eq!(cell.prior.is_some(), !entry.stiffness.is_empty(), "{}", entry.key);
        // The commented task can be used as it is, too.
        let (above, task) = text.split_once("# [[task]]").ok_or("no task")?;
        let (task, _) = task.split_once("\n\n").ok_or("no end")?;
        let task = task.replace("\n# ", "\n");
        let with_task = parse_cell(&format!("{above}[[task]]{task}"), "cell.toml")?;
        assert_eq!(with_task.tasks[0].name, "roughing");
        assert_eq!(with_task.tasks[0].tip, cell.setup.tool.tcp());
        // So can what is commented out of the instruments and of the columns.
        let tables = ["sensor", "tracker", "uncertainty", "columns", "work", "work.force", "work.milling"];
        for table in tables {
            let (above, rest) = text.split_once(&format!("# [{table}]")).ok_or("no table")?;
            let keys = rest.split_once("\n\n").map_or(rest, |(keys, _)| keys);
            let keys = keys.replace("\n# ", "\n");
            let with_table = parse_cell(&format!("{above}[{table}]{keys}"), "cell.toml")?;
            assert_ne!(with_table, cell, "{table}");
        }
        // The limits leave room for postures of this robot.
        let mut inside = 0;
        for q in some_postures(&cell) {
            let terms = PostureTerms::new(&cell.setup, &q, None)?;
            let margin = cell.margins().smallest(&terms).ok_or("no limits")?;
            inside += usize::from(margin.margin >= 0.0);
        }
        assert!(inside >= 5, "{}: {inside} of 399 postures inside", entry.key);
        // The tables begin with what to fill in, and no rows yet.
        let robot = &cell.setup.robot;
        let postures = read_postures(postures_template(robot).as_bytes(), "postures.csv", robot);
        let measured = read_measurements(measurements_template(&cell).as_bytes(), "measurements.csv", &cell, None);
        empty.insert(slip("postures", postures) + &slip("measurements", measured));
    }
    insta::assert_snapshot!(empty.into_iter().collect::<String>(), @"
    » postures
    [too-few-data] postures.csv:3: The table has no rows below its heading.

    » measurements
    [too-few-data] measurements.csv:18: The table has no rows below its heading.
    ");
    let error = template("comau").unwrap_err();
    assert_eq!(error.code().as_str(), "unknown-name");
    Ok(())
}

#[test]
fn examples_of_the_templates_are_valid_rows() -> Check {
    let cell = builtin::cell("comau")?;
    let robot = &cell.setup.robot;
    let uncommented = |text: String| -> String {
        let (heading, rest): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with("posture,"));
        let rows = rest.into_iter().filter(|line| line.starts_with("# P1,"));
        let rows = rows.map(|line| line.trim_start_matches("# ").replace(",,,,", ",1,2,3,"));
        heading.into_iter().map(String::from).chain(rows).collect::<Vec<_>>().join("\n")
    };
    let postures = uncommented(postures_template(robot));
    let postures = read_postures(postures.as_bytes(), "postures.csv", robot)?;
    assert_eq!(postures.len(), 1);
    let sheet = uncommented(measurements_template(&cell));
    let read = crate::common::small::read_readings(sheet.as_bytes(), "m.csv", &cell, None)?;
    let states: Vec<_> =
        read.postures[0].states.iter().map(|state| (state.state.as_str(), state.readings.len())).collect();
    assert_eq!(states, [("unloaded", 4), ("loaded", 4)]);
    Ok(())
}

#[test]
fn the_template_of_the_default_robot() -> Check {
    insta::assert_snapshot!("template_comau", template("comau-nj165-3.0")?);
    let cell = builtin::cell("comau")?;
    insta::assert_snapshot!("template_postures", postures_template(&cell.setup.robot));
    insta::assert_snapshot!("template_measurements", measurements_template(&cell));
    Ok(())
}
