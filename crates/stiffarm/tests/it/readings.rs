//! Tables of raw readings: what is read, what is written, and how each slip is
//! reported.

#![cfg(feature = "files")]

#[cfg(feature = "xlsx")]
#[path = "common/workbook.rs"]
mod workbook;

use nalgebra::Vector3;
use proptest::prelude::*;
use stiffarm::files::cell::parse_cell;
use stiffarm::files::table::{
    Measurements, SheetOptions, read_measurements, read_postures, read_readings, reading_sheet,
    write_readings,
};
use stiffarm::model::cell::Cell;
use stiffarm::model::load::Wrench;
use stiffarm::model::measurement::{
    PostureReadings, Reading, ReadingTable, ReadingTarget, Role, StateReadings, WrenchColumns,
};
use stiffarm::model::posture::Posture;

type Check = Result<(), Box<dyn std::error::Error>>;

const ROPE: &str = "kind = 'rope'\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]";
const SENSOR: &str =
    "[sensor]\nmount = 'flange'\nxyz_mm = [0, 0, 60]\nrpy_deg = [0, 0, 30]\nreports = 'by_robot'\n";

/// Two joints, the points `left` and `right`, the given load, and more tables.
fn cell_with(load: &str, more: &str) -> Cell {
    let text = format!(
        "format = 1\nrobot.dh_modified = [[0, 0, 800, 0], [-90, 400, 0, -90]]\n\
         robot.limits_deg = [[-170, 170], [-75, 95]]\n\
         tool.loading_point_mm = [200, 0, 250]\n\
         [[tool.measuring_point]]\nname = 'left'\nposition_mm = [150, 0, 200]\n\
         [[tool.measuring_point]]\nname = 'right'\nposition_mm = [0, 150, 200]\n\
         [load]\n{load}\n{more}"
    );
    parse_cell(&text, "small.toml").unwrap()
}

fn rope_cell() -> Cell {
    cell_with(ROPE, "")
}

fn sensor_cell() -> Cell {
    cell_with("kind = 'measured'", SENSOR)
}

const POSTURES: &str = "posture,q1_deg,q2_deg\nP1,12.5,-30\nP2,-90.25,45\n";

/// Forces, moments, times, angles of each state, a repeat, a base reflector.
const FULL: &str = "\
posture,state,point,x_mm,y_mm,z_mm,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm,time_s,q1_deg,q2_deg
P1,unloaded,left,1500.125,-200.5,900.25,,,,,,,10.5,12.5,-30
P1,unloaded,right,1350,-50.25,900.5,,,,,,,11,12.5,-30
P1,unloaded,Base-2,0.5,0.25,0.125,,,,,,,,12.5,-30
P1,up,left,1500.25,-200.75,899.5,100,0,-500,1,2,3,20,12.51,-30.02
P1,up,right,1350.5,-50.5,899.75,100,0,-500,1,2,3,21,12.51,-30.02
P1,up,left,1500.251,-200.75,899.5,100,0,-500,1,2,3,22,12.51,-30.02
P2,preload,right,1e3,2,3,10,0,-50,0,0,0,30,-90.25,45
P2,up,right,1000.5,2,3,100,0,-500,0,0,0,31,-90.25,45
P1,unloaded-2,left,1500.126,-200.5,900.25,1,2,3,4,5,6,40,12.5,-30
";

/// A rope with a force per state; no forces, no times, no angles.
const ROPE_LOADS: &str = "\
posture,state,point,x_mm,y_mm,z_mm,load_n
P2,unloaded,left,1500.125,-200.5,900.25,
P2,up-250,left,1500.25,-200.75,899.5,250
P2,up-500,left,1500.5,-201,898.75,500
";

fn postures() -> Vec<Posture> {
    read_postures(
        POSTURES.as_bytes(),
        "postures.csv",
        &rope_cell().setup.robot,
    )
    .unwrap()
}

fn readings(text: &str, cell: &Cell) -> stiffarm::Result<ReadingTable> {
    read_readings(text.as_bytes(), "readings.csv", cell, None)
}

fn planned(text: &str, cell: &Cell) -> stiffarm::Result<ReadingTable> {
    read_readings(text.as_bytes(), "readings.csv", cell, Some(&postures()))
}

/// The table without the lines on which its readings stood.
fn without_lines(mut table: ReadingTable) -> ReadingTable {
    let states = table.postures.iter_mut().flat_map(|p| &mut p.states);
    for reading in states.flat_map(|state| &mut state.readings) {
        reading.line = 0;
    }
    table
}

#[test]
fn rows_are_grouped_by_posture_and_state() -> Check {
    let table = readings(FULL, &sensor_cell())?;
    assert_eq!(table.wrench_columns, WrenchColumns::ForceAndMoment);
    let names: Vec<_> = table
        .postures
        .iter()
        .flat_map(|p| {
            p.states
                .iter()
                .map(|s| (p.posture.name.as_str(), s.state.as_str()))
        })
        .collect();
    let expected = [
        ("P1", "unloaded"),
        ("P1", "up"),
        ("P1", "unloaded-2"),
        ("P2", "preload"),
        ("P2", "up"),
    ];
    assert_eq!(names, expected);

    let [unloaded, up, again] = &table.postures[0].states[..] else {
        panic!("three states");
    };
    let targets: Vec<_> = unloaded.readings.iter().map(|r| &r.target).collect();
    let base = ReadingTarget::Base("base-2".to_string());
    assert_eq!(
        targets,
        [&ReadingTarget::Point(0), &ReadingTarget::Point(1), &base]
    );
    let first = &unloaded.readings[0];
    assert_eq!(first.position.as_slice(), [1.500125, -0.2005, 0.90025]);
    assert_eq!((first.time, first.line), (Some(10.5), 2));
    assert_eq!(unloaded.readings[2].time, None);
    assert_eq!(unloaded.wrench, None, "all fields are empty");
    assert_eq!(up.readings.len(), 3, "a repeat is kept");
    // As the sensor reports it: neither sign nor axes are changed here.
    let wrench = up.wrench.ok_or("no wrench")?;
    assert_eq!(wrench.force.as_slice(), [100.0, 0.0, -500.0]);
    assert_eq!(wrench.moment.as_slice(), [1.0, 2.0, 3.0]);
    assert_eq!(again.wrench.ok_or("no wrench")?.moment.z, 6.0);
    // Each state has its own angles; the posture has those of the first unloaded.
    let radians = |degrees: [f64; 2]| degrees.map(f64::to_radians).to_vec();
    assert_eq!(up.angles, Some(radians([12.51, -30.02])));
    assert_eq!(table.postures[0].posture.q, radians([12.5, -30.0]));
    assert_eq!(table.postures[1].posture.q, radians([-90.25, 45.0]));

    // Written posture by posture and state by state; read again it is the same.
    let cell = sensor_cell();
    let written = write_readings(&table, &cell);
    let again = readings(&written, &cell)?;
    assert_eq!(without_lines(again), without_lines(table));
    Ok(())
}

#[test]
fn where_angles_and_forces_come_from() -> Check {
    let cell = rope_cell();
    let table = planned(ROPE_LOADS, &cell)?;
    assert_eq!(table.wrench_columns, WrenchColumns::None);
    let posture = &table.postures[0];
    assert_eq!(posture.posture, postures()[1]);
    let loads: Vec<_> = posture
        .states
        .iter()
        .map(|s| (s.load, s.angles.clone()))
        .collect();
    let expected = [(None, None), (Some(250.0), None), (Some(500.0), None)];
    assert_eq!(loads, expected);
    // A load in kilonewtons; the unloaded state may say 0.
    let kilo = ROPE_LOADS
        .replace("load_n", "load_kn")
        .replace(",250\n", ",0.25\n")
        .replace(",500\n", ",0.5\n")
        .replace("900.25,\n", "900.25,0\n");
    let kilo = planned(&kilo, &cell)?;
    assert_eq!(kilo.postures[0].states[0].load, Some(0.0));
    assert_eq!(kilo.postures[0].states[2].load, Some(500.0));

    // One loaded state needs no load: the cell's is meant.
    let one = "posture,state,point,x_mm,y_mm,z_mm\nP1,loaded,left,1,2,3\nP1,unloaded,left,1,2,4\n";
    let table = planned(one, &cell)?;
    assert!(
        table.postures[0]
            .states
            .iter()
            .all(|s| s.load.is_none() && s.wrench.is_none())
    );
    // Angles of the table beside those planned: the measured ones count.
    let both = "posture,state,point,x_mm,y_mm,z_mm,q1_deg,q2_deg\n\
                P1,loaded,left,1,2,3,13,-31\nP1,unloaded,left,1,2,4,12.6,-30.5\n";
    let table = planned(both, &cell)?;
    assert_eq!(
        table.postures[0].posture.q,
        [12.6f64, -30.5].map(f64::to_radians)
    );
    // Without an unloaded state, those of the first.
    let preload = both
        .replace("unloaded", "preload")
        .replace("z_mm,q1", "z_mm,load_n,q1");
    let preload = preload
        .replace(",3,13", ",3,500,13")
        .replace(",4,12.6", ",4,100,12.6");
    let table = readings(&preload, &cell)?;
    assert_eq!(
        table.postures[0].posture.q,
        [13.0f64, -31.0].map(f64::to_radians)
    );
    Ok(())
}

#[test]
fn states_say_what_they_are_for() {
    for (state, role) in [
        ("unloaded", Role::Unloaded),
        ("Unloaded", Role::Unloaded),
        ("unloaded-2", Role::Unloaded),
        ("unloaded2", Role::Unloaded),
        ("UNLOADED after", Role::Unloaded),
        ("preload", Role::Preload),
        ("Preloaded_1", Role::Preload),
        ("loaded", Role::Loaded),
        ("up-250", Role::Loaded),
        ("unloading", Role::Loaded),
    ] {
        assert_eq!(Role::of(state), role, "{state}");
    }
    for (name, reserved) in [
        ("base", true),
        ("Base 3", true),
        ("base_left", true),
        ("BASE-2", true),
        ("baseline", false),
        ("bas", false),
        ("bäse", false),
        ("", false),
    ] {
        assert_eq!(ReadingTarget::is_base_name(name), reserved, "{name}");
    }
}

#[test]
fn spreadsheets_write_the_same_table_in_many_ways() -> Check {
    let cell = sensor_cell();
    let plain = readings(FULL, &cell)?;
    let european = FULL.replace(',', ";").replace('.', ",");
    for text in [
        format!("\u{feff}{FULL}"),
        FULL.replace('\n', "\r\n"),
        FULL.replace('\n', ",,\n"),
        format!("{FULL},,\n,,,,\n"),
        european.clone(),
        format!("\u{feff}sep=;\n{european}"),
        FULL.replace(',', "\t"),
        FULL.replace(',', "\t").replace('.', ","),
        FULL.replace("x_mm,y_mm,z_mm", "X_mm , Y_mm, Z_MM"),
        FULL.replace(",up,", ",\"up\","),
    ] {
        assert_eq!(
            without_lines(readings(&text, &cell)?),
            without_lines(plain.clone()),
            "{text}"
        );
    }
    Ok(())
}

/// As a tracker's software may write it: its own headings, more columns.
const FOREIGN: &str = "\
Comment;Pose;Name;State;Center X;center y;CENTER Z;ReadingTarget type;A1;A2
first;P1;left;unloaded;1500,125;-200,5;900,25;SMR 1.5;12,5;-30
;P1;left;loaded;1500,25;-200,75;899,5;SMR 1.5;12,5;-30
";

const MAPPING: &str = "[columns]\nposture = 'Pose'\npoint = 'name'\nX_mm = 'Center X'\ny_mm = 'Center Y'\nz_mm = ' Center Z'\n\
                       q1_deg = 'A1'\nq2_deg = 'A2'\nignore = ['Comment', 'target type', 'never there']\n";

#[test]
fn headings_of_another_software() -> Check {
    let mapping = MAPPING.replace("' Center Z'", "'Center Z'");
    let cell = cell_with(ROPE, &mapping);
    let plain = "posture,state,point,x_mm,y_mm,z_mm,q1_deg,q2_deg\n\
                 P1,unloaded,left,1500.125,-200.5,900.25,12.5,-30\nP1,loaded,left,1500.25,-200.75,899.5,12.5,-30\n";
    let wanted = readings(plain, &rope_cell())?;
    assert_eq!(readings(FOREIGN, &cell)?, wanted);
    // A table of our own is still read, and one that has some of the headings.
    assert_eq!(readings(plain, &cell)?, wanted);
    let mixed = FOREIGN.replace("Pose", "posture");
    assert_eq!(readings(&mixed, &cell)?, wanted);
    // Lengths in another unit: the mapping says so.
    let inches = cell_with(ROPE, &mapping.replace("_mm = 'Center", "_in = 'Center"));
    let table = readings(FOREIGN, &inches)?;
    let x = table.postures[0].states[0].readings[0].position.x;
    assert!((x - 1500.125 * 0.0254).abs() < 1e-12, "{x}");
    // Displacements are mapped as well.
    let mapping = "[columns]\ndx_mm = 'ΔX'\ndy_mm = 'ΔY'\ndz_mm = 'ΔZ'\nignore = ['x_mm']\n";
    let text = "posture,point,δx,Δy,Δz,x_mm,q1_deg,q2_deg\nP1,left,1,2,3,4,5,6\n";
    let cell = cell_with(ROPE, mapping);
    let Measurements::Displacements(read) =
        read_measurements(text.as_bytes(), "d.csv", &cell, None)?
    else {
        panic!("displacements");
    };
    assert_eq!(
        read[0].displacements[0].value,
        Vector3::new(1e-3, 2e-3, 3e-3)
    );
    Ok(())
}

#[test]
fn the_heading_says_what_a_table_holds() -> Check {
    let cell = sensor_cell();
    let read = |text: &str| read_measurements(text.as_bytes(), "m.csv", &cell, None);
    assert_eq!(read(FULL)?, Measurements::Readings(readings(FULL, &cell)?));
    let displacements =
        "posture,point,dx_mm,dy_mm,dz_mm,fx_n,fy_n,fz_n,q1_deg,q2_deg\nP1,left,1,2,3,4,5,6,7,8\n";
    assert!(matches!(read(displacements)?, Measurements::Displacements(d) if d.len() == 1));
    let mut report = String::new();
    for text in [
        FULL.replace("x_mm,y_mm,z_mm", "x_mm,y_mm,dz_mm"),
        FULL.replace("x_mm,y_mm,z_mm", "time_s,load_n,time_min"),
        "posture,state,point\nP1,unloaded,left\n".to_string(),
        "posture,state,point,X,Y,Z\nP1,unloaded,left,1,2,3\n".to_string(),
        "posture,state,point,Center X,Center Y,Center Z\nP1,unloaded,left,1,2,3\n".to_string(),
        "P1,12,13,14\n".to_string(),
        String::new(),
    ] {
        report += &format!("» {}\n", text.lines().next().unwrap_or_default());
        let error = read(&text).unwrap_err();
        report += &format!("[{}] {error}\n\n", error.code().as_str());
    }
    let wrong = [
        readings(displacements, &cell).unwrap_err(),
        stiffarm::files::table::read_displacements(FULL.as_bytes(), "m.csv", &cell, None)
            .unwrap_err(),
    ];
    for error in wrong {
        report += &format!("[{}] {error}\n\n", error.code().as_str());
    }
    insta::assert_snapshot!(report);
    Ok(())
}

/// What is replaced in [`FULL`] by what.
const SLIPS: &[(&str, &str)] = &[
    ("x_mm,y_mm,z_mm", "x_mm,y_mm,z_m"),
    ("x_mm,y_mm,z_mm", "x [mm],y [mm],z [mm]"),
    ("x_mm,y_mm,z_mm", "x,y,z"),
    ("x_mm,y_mm,z_mm", "x_cm,y_cm,z_cm"),
    ("x_mm,y_mm,z_mm", "x_mm,y_mm,remark"),
    ("x_mm,y_mm,z_mm", "x_mm,y_mm"),
    ("x_mm,y_mm,z_mm", "x_mm,y_mm,y_m"),
    ("state,point", "point,point"),
    ("fx_n,fy_n,fz_n", "fx_n,fy_kn,fz_n"),
    ("fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm,", "mx_nm,my_nm,mz_nm,"),
    ("mz_nm", "load_n"),
    ("P1,up,right", "P1,up,rihgt"),
    ("P1,up,right", "P1,up,bas"),
    ("P1,up,right", "P1,up,TCP"),
    ("P1,up,right", "P1,,right"),
    ("P1,unloaded,right", "P1,unlaoded,right"),
    ("P1,unloaded,right", "P1,no load,right"),
    ("P1,unloaded,right", "P1,unload,right"),
    ("P2,preload,right", "P2,pre-load,right"),
    ("1350.5,-50.5,899.75,100,0,-500", "1350.5,-50.5,899.75,,,"),
    (
        "1350.5,-50.5,899.75,100,0,-500",
        "1350.5,-50.5,899.75,100,1,-500",
    ),
    ("1350.5,-50.5,899.75,100", "1350.5,,899.75,100"),
    ("1350,-50.25,900.5,,,,,,", "1350,-50.25,900.5,1,2,,,,"),
    ("1350,-50.25,900.5,,,,,,", "1350,-50.25,900.5,1,2,3,4,5,6"),
    ("3,21,12.51,-30.02", "3,21,12.52,-30.02"),
    ("40,12.5,-30", "40,12.5,30"),
    ("40,12.5,-30", "40,12.5,-130"),
    ("40,12.5,-30", "4o,12.5,-30"),
    ("P2,preload,right", "P2,down,right"),
    ("P2,up,right", "P2,unloaded,right"),
    ("P2,up,right", "P2,up,left"),
    ("P2,preload,right", "P2,preload,base"),
];

#[test]
fn slips_in_a_table_of_readings() {
    let mut report = String::new();
    let mut note = |slip: &str, result: stiffarm::Result<ReadingTable>| {
        let error = match result {
            Ok(_) => panic!("accepted: {slip}"),
            Err(error) => error,
        };
        report += &format!("» {slip}\n[{}] {error}\n\n", error.code().as_str());
    };
    let cell = sensor_cell();
    for (from, to) in SLIPS {
        assert!(FULL.contains(from), "{from}");
        note(to, readings(&FULL.replacen(from, to, 1), &cell));
    }
    let rope = rope_cell();
    note("no angles", readings(ROPE_LOADS, &rope));
    let without_state = "posture,point,x_mm,y_mm,z_mm\nP1,left,1,2,3\n";
    note("no state", planned(without_state, &rope));
    let moments = "posture,state,point,x_mm,y_mm,z_mm,mx_nm,my_nm,mz_nm\nP1,up,left,1,2,3,4,5,6\n";
    note("moments only", planned(moments, &rope));
    note(
        "unknown to the plan",
        planned(&ROPE_LOADS.replace("P2", "P22"), &rope),
    );
    let far = "posture,state,point,x_mm,y_mm,z_mm,q1_deg,q2_deg\n\
               P1,unloaded,left,1,2,3,12.5,-32.5\nP1,loaded,left,1,2,4,12.5,-32.5\n";
    note("angles far from the plan", planned(far, &rope));
    note(
        "load below zero",
        planned(&ROPE_LOADS.replace(",250", ",-250"), &rope),
    );
    note(
        "load of zero",
        planned(&ROPE_LOADS.replace(",250", ",0"), &rope),
    );
    note(
        "unloaded with a load",
        planned(&ROPE_LOADS.replace("900.25,", "900.25,250"), &rope),
    );
    let unknown = ROPE_LOADS.replace(",load_n", "").replace(",250\n", "\n");
    let unknown = unknown
        .replace(",500\n", "\n")
        .replace("900.25,\n", "900.25\n");
    note("loads of a rope untold", planned(&unknown, &rope));
    note(
        "one load of two",
        planned(&ROPE_LOADS.replace(",500\n", ",\n"), &rope),
    );
    let wrench = cell_with("kind = 'wrench'\nforce_n = [0, 0, -500]\naxes = 'base'", "");
    note("loads of a wrench untold", planned(&unknown, &wrench));
    note("load_n for a wrench", planned(ROPE_LOADS, &wrench));
    let measured = cell_with("kind = 'measured'", "");
    note("load_n for a measured load", planned(ROPE_LOADS, &measured));
    note(
        "no forces for a measured load",
        planned(&unknown, &measured),
    );
    note("no forces of a sensor", planned(&unknown, &cell));
    // The columns of another software that are not there.
    let mapping = MAPPING.replace("' Center Z'", "'Centre Z'");
    let cell = cell_with(ROPE, &mapping);
    note("a foreign heading misspelt", readings(FOREIGN, &cell));
    let ignored = mapping.replace("'never there'", "'Center Z'");
    note(
        "a foreign heading not found",
        readings(FOREIGN, &cell_with(ROPE, &ignored)),
    );
    let twice = FOREIGN.replace("CENTER Z", "X_mm");
    let cell = cell_with(ROPE, &MAPPING.replace("' Center Z'", "'Center Z'"));
    note("ours and theirs", readings(&twice, &cell));
    insta::assert_snapshot!("reading_slips", report);
}

#[test]
fn sheets_to_fill_in() -> Check {
    let one = &postures()[..1];
    let options = |states: &[&str], drift, base_reflector| SheetOptions {
        states: states.iter().map(|s| s.to_string()).collect(),
        drift,
        base_reflector,
    };
    let mut report = String::new();
    for (what, cell, options) in [
        ("rope", rope_cell(), options(&[], false, false)),
        (
            "rope, loads, drift, base",
            rope_cell(),
            options(&["up-250", "up-500"], true, true),
        ),
        (
            "preload",
            rope_cell(),
            options(&["preload", "loaded"], false, false),
        ),
        (
            "states in an order of one's own",
            rope_cell(),
            options(&["loaded", "unloaded"], true, false),
        ),
        (
            "sensor",
            sensor_cell(),
            options(&["up", "down"], false, false),
        ),
        (
            "measured",
            cell_with("kind = 'measured'", ""),
            options(&[], false, false),
        ),
    ] {
        let sheet = reading_sheet(one, &options, &cell);
        report += &format!("» {what}\n{sheet}\n");
        let error = readings(&sheet, &cell).unwrap_err();
        assert!(error.message().contains("is empty"), "{error}");
        // Filled in, it is read.
        let (heading, rows) = sheet.split_once('\n').ok_or("no heading")?;
        let filled = rows.lines().map(|row| {
            let mut fields: Vec<&str> = row.split(',').collect();
            let loaded = Role::of(fields[1]) == Role::Loaded || fields[1] == "preload";
            let blank = 3..fields.len() - 2;
            let force = if loaded { "7" } else { "" };
            for (i, name) in heading
                .split(',')
                .enumerate()
                .filter(|(i, _)| blank.contains(i))
            {
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
    if cfg!(feature = "xlsx") {
        assert_eq!(broken.code().as_str(), "file-read");
    } else {
        assert_eq!(broken.code().as_str(), "unsupported");
        assert!(broken.message().contains("reads no .xlsx"), "{broken}");
    }
    // Neither is taken for a text that is not UTF-8.
    let hint = broken.hint_text().unwrap_or_default();
    assert!(hint.contains("CSV UTF-8"), "{hint}");
}

#[cfg(feature = "xlsx")]
mod xlsx {
    use super::workbook::{Cell as Held, cells, workbook, workbook_with};
    use super::*;

    const GOLDEN: &[u8] = include_bytes!("../golden/xlsx/readings.xlsx");

    /// The rows of the golden workbook as text.
    const AS_TEXT: &str = "posture,state,point,x_mm,y_mm,z_mm,load_n,q1_deg,q2_deg\n\
        1,unloaded,left,1500.125,-200.5,900.25,,12.5,-30\n1,unloaded,right,1350.0625,-50.25,900.5,,12.5,-30\n\
        1,up-250,left,1500.25,-200.75,899.5,250,12.5,-30\n1,up-250,right,1350.1875,-50.5,899.75,250,12.5,-30\n\
        1,up-500,left,1500.375,-201,898.75,500,12.5,-30\n1,up-500,left,1500.3750001,-201,898.75,500,12.5,-30\n\
        1,up-500,base,0.5,0.25,0.125,500,12.5,-30\n";

    const MAPPING: &str = "[columns]\npoint = 'Name'\nx_mm = 'Center X'\ny_mm = 'Center Y'\nz_mm = 'Center Z'\n\
                           ignore = ['Timestamp']\n";

    fn read(bytes: &[u8], cell: &Cell) -> stiffarm::Result<ReadingTable> {
        read_readings(bytes, "readings.xlsx", cell, None)
    }

    #[test]
    fn a_workbook_holds_what_its_text_holds() -> Check {
        let cell = cell_with(ROPE, MAPPING);
        let table = read(GOLDEN, &cell)?;
        let wanted = readings(AS_TEXT, &cell)?;
        // The heading is in row 3 below a comment: the rows begin in row 4.
        assert_eq!(table.postures[0].states[0].readings[0].line, 4);
        assert_eq!(without_lines(table), without_lines(wanted));
        Ok(())
    }

    #[test]
    fn every_table_of_text_can_be_a_workbook() -> Check {
        let cell = sensor_cell();
        let bytes = workbook(&[("Sheet1", cells(FULL))]);
        assert_eq!(read(&bytes, &cell)?, readings(FULL, &cell)?);
        let robot = &cell.setup.robot;
        let bytes = workbook(&[("Sheet1", cells(POSTURES))]);
        assert_eq!(read_postures(&bytes, "p.xlsx", robot)?, postures());
        // The table may begin anywhere; gaps between rows do not matter.
        let moved: String = FULL.lines().map(|line| format!(",,{line}\n,\n")).collect();
        let bytes = workbook(&[("Sheet1", cells(&format!(",\n,\n{moved}")))]);
        assert_eq!(
            without_lines(read(&bytes, &cell)?),
            without_lines(readings(FULL, &cell)?)
        );
        Ok(())
    }

    #[test]
    fn a_cell_in_the_last_corner_costs_no_memory() {
        // Row 1048576, column XFD: as a rectangle these would be 1.7e10 cells.
        let cell = sensor_cell();
        let far = workbook_with(
            &[("Sheet1", cells(FULL))],
            "<row r=\"1048576\"><c r=\"XFD1048576\"><v>1</v></c></row>",
        );
        let error = read(&far, &cell).unwrap_err();
        insta::assert_snapshot!(error, @r#"
        readings.xlsx:1048576:16384: "1" lies beyond the last column of the heading.
          hint: give its column a heading, or empty the cell
        "#);
    }

    #[test]
    fn slips_in_a_workbook() {
        let cell = sensor_cell();
        let mut report = String::new();
        let mut note = |what: &str, sheets: &[(&str, Vec<Vec<Held<'_>>>)]| {
            let error = read(&workbook(sheets), &cell).unwrap_err();
            report += &format!("» {what}\n[{}] {error}\n\n", error.code().as_str());
        };
        let with = |row: usize, column: usize, held: Held<'static>| {
            let mut sheet = cells(FULL);
            let width = sheet[row].len().max(column + 1);
            sheet[row].resize(width, Held::Empty);
            sheet[row][column] = held;
            vec![("Sheet1", sheet)]
        };
        note("a date for a time", &with(4, 12, Held::Date));
        note("a duration for a time", &with(4, 12, Held::Duration));
        note("a date for a posture", &with(4, 0, Held::Date));
        note("true or false", &with(4, 3, Held::True));
        note("an error of a formula", &with(4, 4, Held::Fault));
        note("a heading that is a date", &with(0, 4, Held::Date));
        note("a number as text", &with(4, 3, Held::Text("1500,25")));
        note("a text", &with(4, 3, Held::Text("1500 mm")));
        note("an empty cell", &with(4, 3, Held::Empty));
        note(
            "a remark beside the table",
            &with(4, 16, Held::Text("door open")),
        );
        note("an unknown column", &with(0, 12, Held::Text("Timestamp")));
        note("empty", &[("Sheet1", Vec::new())]);
        note(
            "empty, and data in another",
            &[("Cover", Vec::new()), ("Data", cells(FULL))],
        );
        let cover = || vec![vec![Held::Text("Stiffness"), Held::Text("2026")]];
        note(
            "a cover sheet",
            &[("Cover", cover()), ("Data", cells(FULL))],
        );
        note("a cover sheet alone", &[("Cover", cover())]);
        insta::assert_snapshot!("workbook_slips", report);
    }
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        (-9_999_999..9_999_999i32).prop_map(|n| f64::from(n) / 1e7),
        -1e3..1e3f64,
    ]
}

fn vector() -> impl Strategy<Value = Vector3<f64>> {
    (number(), number(), number()).prop_map(|(x, y, z)| Vector3::new(x, y, z))
}

fn wrench() -> impl Strategy<Value = Wrench> {
    (vector(), vector()).prop_map(|(force, moment)| Wrench { force, moment })
}

/// Readings of a state; the first is of the first point, so that every loaded
/// state shares one with the unloaded.
fn any_state(
    name: &'static str,
    forces: WrenchColumns,
    times: bool,
) -> impl Strategy<Value = StateReadings> {
    let target = prop_oneof![
        Just(ReadingTarget::Point(0)),
        Just(ReadingTarget::Point(1)),
        Just(ReadingTarget::Base("base".to_string())),
        Just(ReadingTarget::Base("base-2".to_string())),
    ];
    let reading = (target, vector(), prop::option::of(number()));
    let state = (
        prop::collection::vec(reading, 1..6),
        wrench(),
        1.0..900.0f64,
    );
    state.prop_map(move |(mut readings, wrench, load)| {
        readings[0].0 = ReadingTarget::Point(0);
        let loaded = Role::of(name) != Role::Unloaded;
        StateReadings {
            state: name.to_string(),
            angles: None,
            wrench: match forces {
                WrenchColumns::None => None,
                WrenchColumns::Force => loaded.then(|| Wrench::force(wrench.force)),
                WrenchColumns::ForceAndMoment => loaded.then_some(wrench),
            },
            load: loaded.then_some(load),
            readings: readings
                .into_iter()
                .map(|(target, position, time)| Reading {
                    target,
                    position,
                    time: time.filter(|_| times),
                    line: 0,
                })
                .collect(),
        }
    })
}

fn any_table() -> impl Strategy<Value = ReadingTable> {
    let columns = prop_oneof![
        Just(WrenchColumns::None),
        Just(WrenchColumns::Force),
        Just(WrenchColumns::ForceAndMoment),
    ];
    (columns, any::<bool>()).prop_flat_map(|(columns, times)| {
        let states = (
            any_state("unloaded", columns, times),
            any_state("preload", columns, times),
            any_state("up, \"slowly\"", columns, times),
            any_state("unloaded-2", columns, times),
        );
        let posture = (states, -150.0..150.0f64, -60.0..80.0f64);
        prop::collection::vec(posture, 1..5).prop_map(move |postures| ReadingTable {
            wrench_columns: columns,
            postures: (1..)
                .zip(postures)
                .map(|(number, ((a, b, c, d), q1, q2))| {
                    let mut states = vec![a, b, c, d];
                    for (i, state) in states.iter_mut().enumerate() {
                        // Up to 0.3° of servo give.
                        let give = 0.1 * i as f64;
                        state.angles =
                            Some(vec![(q1 + give).to_radians(), (q2 - give).to_radians()]);
                    }
                    PostureReadings {
                        posture: Posture {
                            name: format!("#{number}"),
                            q: states[0].angles.clone().unwrap_or_default(),
                        },
                        states,
                    }
                })
                .collect(),
        })
    })
}

/// The same up to what numbers of degrees and millimetres can tell apart.
fn nearly(a: &[f64], b: &[f64]) -> bool {
    let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 2.0 * f64::EPSILON * a.abs();
    a.len() == b.len() && a.iter().zip(b).all(close)
}

proptest! {
    #[test]
    fn written_readings_are_read_and_written_again(table in any_table()) {
        let cell = rope_cell();
        let text = write_readings(&table, &cell);
        let read = readings(&text, &cell).unwrap();
        prop_assert_eq!(write_readings(&read, &cell), text);
        prop_assert_eq!(read.wrench_columns, table.wrench_columns);
        prop_assert_eq!(read.postures.len(), table.postures.len());
        for (read, wanted) in read.postures.iter().zip(&table.postures) {
            prop_assert_eq!(&read.posture.name, &wanted.posture.name);
            prop_assert!(nearly(&read.posture.q, &wanted.posture.q));
            prop_assert_eq!(read.states.len(), wanted.states.len());
            for (read, wanted) in read.states.iter().zip(&wanted.states) {
                prop_assert_eq!(&read.state, &wanted.state);
                prop_assert_eq!((read.wrench, read.load), (wanted.wrench, wanted.load));
                let [a, b] = [read, wanted].map(|s| s.angles.clone().unwrap_or_default());
                prop_assert!(nearly(&a, &b));
                prop_assert_eq!(read.readings.len(), wanted.readings.len());
                for (read, wanted) in read.readings.iter().zip(&wanted.readings) {
                    prop_assert_eq!((&read.target, read.time), (&wanted.target, wanted.time));
                    prop_assert!(nearly(read.position.as_slice(), wanted.position.as_slice()));
                }
            }
        }
    }
}
