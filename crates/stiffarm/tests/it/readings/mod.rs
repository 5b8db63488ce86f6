//! Tables of raw readings: what is read, what is written, and how each slip is
//! reported.

mod beside;
mod exports;
mod filling;
mod headings;
mod layouts;
mod resolution;
mod round_trip;
mod sheets;
mod slips;
mod stations;
mod xlsx;

#[path = "../common/workbook.rs"]
mod workbook;

use crate::common::small::{POSTURES, ROPE, cell_with, nearly, read_readings, rope_cell};
use nalgebra::Vector3;
use proptest::prelude::*;
use stiffarm::model::cell::Cell;
use stiffarm::model::load::Wrench;
use stiffarm::model::measurement::Measurements;
use stiffarm::model::measurement::{
    PostureReadings, Reading, ReadingTable, ReadingTarget, Role, StateReadings, WrenchColumns,
};
use stiffarm::model::posture::Posture;
use stiffarm_files::cell::parse_cell;
use stiffarm_files::table::{SheetOptions, read_measurements, read_postures, reading_sheet, write_readings};

type Check = Result<(), Box<dyn std::error::Error>>;

const SENSOR: &str = "[sensor]\nmount = 'flange'\nxyz_mm = [0, 0, 60]\nrpy_deg = [0, 0, 30]\nreports = 'by_robot'\n";

fn sensor_cell() -> Cell {
    cell_with("kind = 'measured'", SENSOR)
}

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
    read_postures(POSTURES.as_bytes(), "postures.csv", &rope_cell().setup.robot).unwrap()
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
        .flat_map(|p| p.states.iter().map(|s| (p.posture.name.as_str(), s.state.as_str())))
        .collect();
    let expected = [("P1", "unloaded"), ("P1", "up"), ("P1", "unloaded-2"), ("P2", "preload"), ("P2", "up")];
    assert_eq!(names, expected);

    let [unloaded, up, again] = &table.postures[0].states[..] else {
        panic!("three states");
    };
    let targets: Vec<_> = unloaded.readings.iter().map(|r| &r.target).collect();
    let base = ReadingTarget::Base("base-2".to_string());
    assert_eq!(targets, [&ReadingTarget::Point(0), &ReadingTarget::Point(1), &base]);
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
    let loads: Vec<_> = posture.states.iter().map(|s| (s.load, s.angles.clone())).collect();
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
    assert!(table.postures[0].states.iter().all(|s| s.load.is_none() && s.wrench.is_none()));
    // Angles of the table beside those planned: the measured ones count.
    let both = "posture,state,point,x_mm,y_mm,z_mm,q1_deg,q2_deg\n\
                P1,loaded,left,1,2,3,13,-31\nP1,unloaded,left,1,2,4,12.6,-30.5\n";
    let table = planned(both, &cell)?;
    assert_eq!(table.postures[0].posture.q, [12.6f64, -30.5].map(f64::to_radians));
    // Without an unloaded state, those of the first.
    let preload = both.replace("unloaded", "preload").replace("z_mm,q1", "z_mm,load_n,q1");
    let preload = preload.replace(",3,13", ",3,500,13").replace(",4,12.6", ",4,100,12.6");
    let table = readings(&preload, &cell)?;
    assert_eq!(table.postures[0].posture.q, [13.0f64, -31.0].map(f64::to_radians));
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

/// As a tracker's software may write it: its own headings, more columns.
const FOREIGN: &str = "\
Comment;Pose;Name;State;Center X;center y;CENTER Z;Target type;A1;A2
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
    let Measurements::Displacements(read) = read_measurements(text.as_bytes(), "d.csv", &cell, None)? else {
        panic!("displacements");
    };
    assert_eq!(read[0].displacements[0].value, Vector3::new(1e-3, 2e-3, 3e-3));
    Ok(())
}

#[test]
fn the_heading_says_what_a_table_holds() -> Check {
    let cell = sensor_cell();
    let read = |text: &str| read_measurements(text.as_bytes(), "m.csv", &cell, None);
    assert_eq!(read(FULL)?, Measurements::Readings(readings(FULL, &cell)?));
    let displacements = "posture,point,dx_mm,dy_mm,dz_mm,fx_n,fy_n,fz_n,q1_deg,q2_deg\nP1,left,1,2,3,4,5,6,7,8\n";
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
    insta::assert_snapshot!(report);
    Ok(())
}
