//! Quantities of the set-up that are identified on purpose come out true, and the list says of each what it is.

use super::days::{Beyond, Day, Kind, day, displacements};
use super::{mistake, planted};
use crate::common::prelude::*;
use stiffarm::Code;
use stiffarm::ask::identify::{Identified, IdentifiedOptions};
use stiffarm::internals::{both_ways, quantities};

fn freeing(names: &[&str]) -> IdentifyOptions {
    changed(IdentifyOptions::default(), |o| {
        o.free = names.iter().map(ToString::to_string).collect();
    })
}

fn identified(
    cell: &Cell,
    measurements: impl Into<stiffarm::model::measurement::Measurements>,
    names: &[&str],
) -> stiffarm::Result<Identified> {
    let measured = prepare(cell, measurements, &Default::default())?;
    let fit = Fit::new(cell, measured, &freeing(names))?;
    Identified::new(&fit, &IdentifiedOptions::default(), Control::default())
}

/// With the quantity free, what is stated wrongly is found, the stiffness is the true one, and its ± has the doubt.
#[test]
fn what_is_free_is_found_and_the_stiffness_with_it() {
    for (name, free, truth) in [
        ("anchor 300 mm too low", "anchor", vec![1.8, 0.0, 0.0]),
        ("lever 50 mm too long", "loading-point", vec![0.2, 0.0, 0.25]),
        ("hook and shackle of 3 kg", "force-beside", vec![0.0, 0.0, -3.0 * 9.806_65]),
    ] {
        let (mut inside, mut all) = (0, 0);
        for seed in 0..2 {
            let (cell, measurements) = planted(mistake(name), Beyond::Nothing, seed);
            let fitted = identified(&cell, measurements.clone(), &[free]).unwrap();
            assert!(fitted.rejected().is_none(), "{name}: {:?}", fitted.rejected());
            let [quantity] = &fitted.freed[..] else { panic!("{:#?}", fitted.freed) };
            assert_eq!(quantity.name, free);
            for (i, truth) in truth.iter().enumerate() {
                let off = (quantity.asked[i] - truth) / quantity.standard_error[i].unwrap();
                assert!(off.abs() < 5.0, "{name} {seed}: {quantity:#?}");
            }
            let truth = cell.require_prior().unwrap();
            for (joint, k) in fitted.identification.estimates.joints.iter().zip(truth) {
                let [low, high] = joint.interval;
                inside += usize::from(low.is_some_and(|low| low <= *k) && high.is_none_or(|high| *k <= high));
                all += 1;
            }
            let systematic = fitted.systematic_errors.as_ref().unwrap();
            let source = source(systematic, free);
            assert!(source.free && source.remaining.unwrap() < 0.1, "{source:#?}");
        }
        assert!(inside + 1 >= all, "{name}: {inside} of {all}");
    }
}

/// The doubt about an anchor that is free is in the ± of the stiffness.
#[test]
fn freeing_widens() {
    let Day { cell, table } = day(Kind::Rope, Beyond::Nothing, 12, 3, 3);
    let [stated, free] = [&[][..], &["anchor"]].map(|names| identified(&cell, table.clone(), names).unwrap());
    let half = |fitted: &Identified| -> f64 {
        let joints = &fitted.systematic_errors.as_ref().unwrap().uncertainty;
        joints.iter().map(|j| j.total.unwrap()).sum()
    };
    assert!(half(&free) > 1.02 * half(&stated), "{} {}", half(&free), half(&stated));
}

#[test]
fn what_cannot_be_free_is_refused() {
    let Day { cell, table } = day(Kind::Rope, Beyond::Nothing, 8, 2, 1);
    let weight = day(Kind::Weight, Beyond::Nothing, 8, 2, 1);
    let table_of = displacements(&cell, &table);
    let mut said = String::new();
    for (names, code) in [
        (&["anchr"][..], Code::UnknownName),
        (&["posture"], Code::UnknownName),
        (&["base-tilt"], Code::UnknownName),
        (&["lost-motion"], Code::UnknownName),
        (&["force-scale"], Code::UnknownName),
        (&["anchor", "anchor"], Code::Duplicate),
        (&["sensor-axes"], Code::Unsupported),
        (&["force-offset"], Code::TooFewData),
    ] {
        let error = identified(&cell, table_of.clone(), names).unwrap_err();
        assert_eq!(error.code(), code, "{error}");
        said += &format!("{error}\n");
    }
    let error = identified(&weight.cell, weight.table, &["anchor"]).unwrap_err();
    assert_eq!(error.code(), Code::Unsupported);
    said += &format!("{error}\n");
    let measured = prepare(&cell, table, &Default::default()).unwrap();
    let fit = Fit::new(&cell, measured, &freeing(&["anchor"])).unwrap();
    let brief = changed(IdentifiedOptions::default(), |wanted| wanted.brief = true);
    let error = Identified::new(&fit, &brief, Control::default()).unwrap_err();
    assert_eq!(error.code(), Code::Conflict);
    said += &format!("{error}\n");
    insta::assert_snapshot!("refused", said);
}

/// Displacements with a quantity elsewhere, by the answers to unit wrenches and by a cell that has it there.
#[test]
fn answers_are_what_another_cell_gives() {
    for (kind, is_table) in
        [(Kind::Rope, false), (Kind::Rope, true), (Kind::Weight, false), (Kind::Sensor, false), (Kind::Forces, false)]
    {
        let Day { cell, table } = day(kind, Beyond::Nothing, 4, 3, 2);
        let measured: Measured = match is_table {
            true => displacements(&cell, &table).into(),
            false => prepare(&cell, table, &Default::default()).unwrap(),
        };
        let fit = Fit::new(&cell, measured, &Default::default()).unwrap();
        let ways = both_ways(&fit).unwrap();
        assert!(ways.len() > 15, "{kind:?} {}", ways.len());
        for way in ways {
            let off = (&way.answer - &way.cell).norm();
            let most = 1e-9 * way.cell.norm() + 1e-16;
            assert!(off <= most, "{kind:?} {} {off} of {}", way.name, way.cell.norm());
            let off = (&way.slope - &way.difference).norm();
            assert!(off <= 1e-4 * way.slope.norm() + 1e-12, "{kind:?} {} {off} of {}", way.name, way.slope.norm());
        }
    }
}

/// The table of docs/set-up.md has each quantity of the list once, with its default.
#[test]
fn the_page_has_the_list() {
    let page = include_str!("../../../../../docs/set-up.md");
    let rows: Vec<Vec<&str>> = page
        .lines()
        .skip_while(|line| !line.starts_with("| quantity (name)"))
        .take_while(|line| line.starts_with('|'))
        .map(|line| line.split('|').map(str::trim).collect())
        .collect();
    let names = |row: &[&str]| -> Vec<String> {
        let named = row[1].split('`').skip(1).step_by(2);
        named.map(str::to_string).collect()
    };
    let on_page: usize = rows.iter().map(|row| names(row).len()).sum();
    assert_eq!(on_page, quantities().len());
    for (name, assumed, unit) in quantities() {
        let row = rows.iter().find(|row| names(row).iter().any(|other| other == name));
        let said = row.unwrap_or_else(|| panic!("{name} is not on the page"))[4];
        let expected = match unit {
            _ if assumed == 0.0 => {
                assert!(["", "exact", "as the scale"].contains(&said), "{name}: {said}");
                continue;
            }
            "1" => format!("{} %", 100.0 * assumed),
            "m" => format!("{} mm", 1e3 * assumed),
            "rad" if name == "lost-motion" => {
                format!("{}′", (60.0 * assumed.to_degrees() * 1e6).round() / 1e6)
            }
            "rad" => format!("{} mrad", 1e3 * assumed),
            _ => format!("10{} N·m/rad", ["⁶", "⁷", "⁸"][(-assumed.log10()).round() as usize - 6]),
        };
        assert!(said.starts_with(&expected), "{name}: {said}, not {expected}");
    }
}
