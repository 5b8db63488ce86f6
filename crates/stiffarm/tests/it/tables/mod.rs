//! Posture and measurement tables: what is read, what is written, and how each
//! slip is reported.

mod dh_rows;
mod round_trip;
mod slips;

use crate::common::small::{POSTURES, cell_with, nearly, read_displacements, rope_cell};
use proptest::prelude::*;
use stiffarm::model::cell::Cell;
use stiffarm::model::load::Wrench;
use stiffarm::model::measurement::{Displacement, MeasuredPosture};
use stiffarm::model::posture::Posture;
use stiffarm_files::builtin;
use stiffarm_files::table::{displacement_sheet, read_postures, write_displacements, write_postures, write_simulated};

type Check = Result<(), Box<dyn std::error::Error>>;

fn measured_cell() -> Cell {
    cell_with("kind = 'measured'", "")
}

const DISPLACEMENTS: &str = "\
posture,state,point,dx_mm,dy_mm,dz_mm,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm,time_s,q1_deg,q2_deg
P1,up,left,0.125,-0.5,0.25,100,0,-500,1,2,3,10.5,12.5,-30
P1,up,right,0.25,-0.5,0.25,100,0,-500,1,2,3,11,12.5,-30
P1,down,left,0.5,-0.5,0.25,90,0,-480,1,2,3,,12.5,-30
P1,up,left,0.126,-0.5,0.25,100,0,-500,1,2,3,12,12.5,-30
P2,up,right,1e-3,0,0.25,100,0,-500,0,0,0,13,-90.25,45
";

fn postures(text: &str) -> stiffarm::Result<Vec<Posture>> {
    read_postures(text.as_bytes(), "postures.csv", &rope_cell().setup.robot)
}

fn displacements(text: &str, cell: &Cell) -> stiffarm::Result<Vec<MeasuredPosture>> {
    read_displacements(text.as_bytes(), "measurements.csv", cell, None)
}

#[test]
fn postures_are_read_in_radians() -> Check {
    let read = postures(POSTURES)?;
    assert_eq!(read.len(), 2);
    assert_eq!(read[1].name, "P2");
    assert_eq!(read[1].q, [-90.25f64, 45.0].map(f64::to_radians));
    assert_eq!(write_postures(&read), POSTURES);
    Ok(())
}

#[test]
fn spreadsheets_write_the_same_table_in_many_ways() -> Check {
    let plain = postures(POSTURES)?;
    let european = POSTURES.replace(',', ";").replace('.', ",");
    let same = [
        format!("\u{feff}{POSTURES}"),
        POSTURES.replace('\n', "\r\n"),
        POSTURES.replace('\n', "\r"),
        POSTURES.trim_end().to_string(),
        format!("# a comment, with a comma\n\n{POSTURES}\n\n  \n# another; comment\n"),
        POSTURES.replace('\n', ",,\n"),
        format!("{POSTURES},,\n,,\n"),
        POSTURES.replace("P1,12.5", "\"P1\",\"12.5\""),
        POSTURES.replace(',', " , "),
        POSTURES.replace("q1_deg", "Q1_Deg"),
        "q2_deg,posture,q1_deg\n-30,P1,12.5\n45,P2,-90.25\n".to_string(),
        european.clone(),
        format!("sep=;\r\n{}", european.replace('\n', "\r\n")),
        format!("\u{feff}sep=;\n{european}"),
        POSTURES.replace(',', ";"),
        POSTURES.replace(',', "\t"),
        POSTURES.replace(',', "\t").replace('.', ","),
    ];
    for text in same {
        assert_eq!(postures(&text)?, plain, "{text}");
    }
    Ok(())
}

#[test]
fn rows_of_a_posture_and_state_are_one_measurement() -> Check {
    let cell = measured_cell();
    let read = displacements(DISPLACEMENTS, &cell)?;
    let names: Vec<_> = read.iter().map(|m| (m.posture.name.as_str(), m.state.as_str())).collect();
    assert_eq!(names, [("P1", "up"), ("P1", "down"), ("P2", "up")]);
    let points: Vec<_> = read[0].displacements.iter().map(|d| d.point).collect();
    assert_eq!(points, [0, 1, 0], "a repeat is kept");
    assert_eq!(read[0].displacements[0].value.as_slice(), [0.125e-3, -0.5e-3, 0.25e-3]);
    assert_eq!(read[0].displacements[2].time, Some(12.0));
    assert_eq!(read[1].displacements[0].time, None);
    let wrench = read[0].wrench.ok_or("no wrench")?;
    assert_eq!(wrench.force.as_slice(), [100.0, 0.0, -500.0]);
    assert_eq!(wrench.moment.as_slice(), [1.0, 2.0, 3.0]);
    assert_eq!(read[0].posture.q, [12.5f64, -30.0].map(f64::to_radians));
    // Written group by group; read again it is the same.
    let written = write_displacements(&read, &cell);
    assert_eq!(displacements(&written, &cell)?, read);
    Ok(())
}

#[test]
fn simulated_tables_have_the_digits_that_the_noise_leaves() {
    let digits = |std: f64, mm: f64| {
        let mut cell = rope_cell();
        cell.noise.reading_variance = std * std;
        let measured = MeasuredPosture::new(
            Posture { name: "1".into(), q: vec![0.1, 0.2] },
            vec![Displacement::new(0, [1e-3 * mm, 0.0, -1e-3 * mm].into())],
        );
        let text = write_simulated(vec![measured], &cell);
        let row: Vec<String> = text.lines().nth(1).unwrap().split(',').map(str::to_string).collect();
        row[3].clone()
    };
    let mm = 0.663_176_492_445_283;
    // A thousandth of 9.6 µm is 9.6 nm: to the nanometre.
    assert_eq!(digits(9.6e-6, mm), "0.663176");
    assert_eq!(digits(0.12e-3, mm), "0.6632");
    assert_eq!(digits(9.6e-6, 3_119.129_258_726_848_5), "3119.129259");
    assert_eq!(digits(0.0, mm), mm.to_string(), "without noise all of it");
}

#[test]
fn what_a_measurement_table_may_leave_out() -> Check {
    let cell = rope_cell();
    let text = "posture,point,dx_mm,dy_mm,dz_mm\nP2,left,1,2,3\nP1,left,4,5,6\n";
    let planned = postures(POSTURES)?;
    let read = read_displacements(text.as_bytes(), "m.csv", &cell, Some(&planned))?;
    assert_eq!(read[0].posture, planned[1]);
    assert_eq!(read[0].state, "loaded");
    assert_eq!(read[0].wrench, None, "the cell's load gives it");

    // Both sources of angles, in agreement; a force without a moment.
    let text = "posture,point,dx_mm,dy_mm,dz_mm,fx_n,fy_n,fz_n,q1_deg,q2_deg\n\
                P1,left,1,2,3,10,20,30,12.5000005,-30\n";
    let read = read_displacements(text.as_bytes(), "m.csv", &cell, Some(&planned))?;
    let wrench = read[0].wrench.ok_or("the measured wrench wins")?;
    assert_eq!(wrench.force.as_slice(), [10.0, 20.0, 30.0]);
    assert_eq!(wrench.moment.as_slice(), [0.0; 3]);
    assert_eq!(read[0].posture.q[0], 12.5000005f64.to_radians());
    Ok(())
}

#[test]
fn units_stand_at_the_end_of_a_heading() -> Check {
    let cell = rope_cell();
    let plain = "posture,point,dx_mm,dy_mm,dz_mm,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm,time_s,q1_deg,q2_deg\n\
                 P1,left,25.4,-50.8,0,100,0,-500,1,2,3,90,180,-90\n";
    let limits = cell.setup.robot.clone().with_limits(&[[-4.0, 4.0], [-4.0, 4.0]])?;
    let mut cell = cell;
    cell.setup.robot = limits;
    let wanted = displacements(plain, &cell)?;
    let changed = [
        ("dx_mm,dy_mm,dz_mm", "dx_m,dy_m,dz_m", "25.4,-50.8,0", "0.0254,-0.0508,0"),
        ("dx_mm,dy_mm,dz_mm", "dx_um,dy_um,dz_um", "25.4,-50.8,0", "25400,-50800,0"),
        ("dx_mm,dy_mm,dz_mm", "dx_µm,dy_μm,dz_um", "25.4,-50.8,0", "25400,-50800,0"),
        ("dx_mm,dy_mm,dz_mm", "DX_in,DY_IN,dz_in", "25.4,-50.8,0", "1,-2,0"),
        ("fx_n,fy_n,fz_n", "fx_kN,fy_kN,fz_kN", "100,0,-500", "0.1,0,-0.5"),
        ("mx_nm,my_nm,mz_nm", "mx_Nmm,my_Nmm,mz_Nmm", "1,2,3", "1000,2000,3000"),
        ("time_s", "time_min", ",90,", ",1.5,"),
        ("time_s", "time_ms", ",90,", ",90000,"),
        ("q1_deg,q2_deg", "q1_rad,q2_rad", "180,-90", "3.141592653589793,-1.5707963267948966"),
    ];
    for (from, to, values, converted) in changed {
        assert!(plain.contains(from) && plain.contains(values), "{to}");
        let text = plain.replace(from, to).replace(values, converted);
        assert_eq!(displacements(&text, &cell)?, wanted, "{to}");
    }
    let radians = "posture,q1_rad,q2_rad\nP1,0.25,-0.5\n";
    assert_eq!(postures(radians)?[0].q, [0.25, -0.5]);
    Ok(())
}

#[test]
fn a_mixed_list_is_written_with_the_load_of_the_cell() -> Check {
    let cell = rope_cell();
    let mut read = displacements(DISPLACEMENTS, &cell)?;
    read[2].wrench = None;
    let written = write_displacements(&read, &cell);
    let again = displacements(&written, &cell)?;
    let force = again[2].wrench.ok_or("no wrench")?.force;
    assert!((force.norm() - 500.0).abs() < 1e-9, "the rope's 500 N: {force}");
    Ok(())
}

#[test]
fn a_displacement_sheet_is_a_table_to_fill_in() -> Check {
    let cell = measured_cell();
    let planned = postures(POSTURES)?;
    let sheet = displacement_sheet(&planned, &["up", "down"], &cell).to_csv();
    insta::assert_snapshot!("displacement_sheet", sheet);
    insta::assert_snapshot!(displacements(&sheet, &cell).unwrap_err(), @"
    measurements.csv:2:12: dx_mm: The field is empty; it must be a number.
      hint: fill it in, or remove the row if it was not measured
    ");
    let filled = sheet.replace(",,,,,,,", ",1,2,3,4,5,6,");
    assert_eq!(displacements(&filled, &cell)?.len(), 4);
    Ok(())
}

#[test]
fn names_that_need_quotation_marks() -> Check {
    let name = "#1, \"home\"; left";
    let list = vec![Posture { name: name.to_string(), q: vec![0.25f64.to_radians(), 0.0] }];
    assert_eq!(postures(&write_postures(&list))?, list);
    Ok(())
}

#[test]
fn the_built_in_group_comes_back_as_it_was_written() -> Check {
    let robot = builtin::cell("comau")?.setup.robot;
    let group = builtin::postures("comau-group1", &robot)?;
    let text = builtin::postures_text("comau-group1").ok_or("no text")?;
    let rows: String = text.lines().filter(|line| !line.starts_with('#')).map(|line| format!("{line}\n")).collect();
    assert_eq!(write_postures(&group), rows);
    Ok(())
}
