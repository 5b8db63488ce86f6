//! Mistakes in a table of readings are reported with place and hint.

use super::*;
use crate::common::cases::slip;

/// What is replaced in [`FULL`] by what.
const SLIPS: &[(&str, &str)] = &[
    ("x_mm,y_mm,z_mm", "x_mm,y_mm,z_m"),
    ("x_mm,y_mm,z_mm", "x [ell],y [ell],z [ell]"),
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
    ("1350.5,-50.5,899.75,100,0,-500", "1350.5,-50.5,899.75,100,1,-500"),
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
    let mut note = |what: &str, read: stiffarm::Result<ReadingTable>| report += &slip(what, read);
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
    note("unknown to the plan", planned(&ROPE_LOADS.replace("P2", "P22"), &rope));
    let far = "posture,state,point,x_mm,y_mm,z_mm,q1_deg,q2_deg\n\
               P1,unloaded,left,1,2,3,12.5,-32.5\nP1,loaded,left,1,2,4,12.5,-32.5\n";
    note("angles far from the plan", planned(far, &rope));
    note("load below zero", planned(&ROPE_LOADS.replace(",250", ",-250"), &rope));
    note("load of zero", planned(&ROPE_LOADS.replace(",250", ",0"), &rope));
    note("unloaded with a load", planned(&ROPE_LOADS.replace("900.25,", "900.25,250"), &rope));
    let unknown = ROPE_LOADS.replace("-250", "").replace("up-500", "down");
    let unknown = unknown.replace(",load_n", "").replace(",250\n", "\n");
    let unknown = unknown.replace(",500\n", "\n").replace("900.25,\n", "900.25\n");
    note("loads of a rope untold", planned(&unknown, &rope));
    note("one load of two", planned(&ROPE_LOADS.replace(",500\n", ",\n").replace("up-500", "down"), &rope));
    let wrench = cell_with("kind = 'wrench'\nforce_n = [0, 0, -500]\naxes = 'base'", "");
    note("loads of a wrench untold", planned(&unknown, &wrench));
    note("load_n for a wrench", planned(ROPE_LOADS, &wrench));
    let measured = cell_with("kind = 'measured'", "");
    note("load_n for a measured load", planned(ROPE_LOADS, &measured));
    note("no forces for a measured load", planned(&unknown, &measured));
    note("no forces of a sensor", planned(&unknown, &cell));
    // The columns of another software that are not there.
    let mapping = MAPPING.replace("' Center Z'", "'Centre Z'");
    let cell = cell_with(ROPE, &mapping);
    note("a foreign heading misspelt", readings(FOREIGN, &cell));
    let ignored = mapping.replace("'never there'", "'Center Z'");
    note("a foreign heading not found", readings(FOREIGN, &cell_with(ROPE, &ignored)));
    let twice = FOREIGN.replace("CENTER Z", "X_mm");
    let cell = cell_with(ROPE, &MAPPING.replace("' Center Z'", "'Center Z'"));
    note("ours and theirs", readings(&twice, &cell));
    insta::assert_snapshot!("reading_slips", report);
}

#[test]
fn newtons_below_a_heading_in_kilonewtons_are_told_by_the_heading() {
    let wrong = ROPE_LOADS.replace("load_n", "load_kn").replace(",500\n", ",1000\n");
    insta::assert_snapshot!(planned(&wrong, &rope_cell()).unwrap_err(), @"
    readings.csv:4:35: load_kn: A force of 1000 kN cannot be meant: it must be below 1000 kN.
      hint: the heading load_kn says kn: if the numbers are in another unit, name the column load_n
    ");
}

#[test]
fn two_fields_are_a_decimal_only_where_commas_can_stand_for_points() {
    let heading = "posture,state,point,x_mm,y_mm,z_mm\n";
    // A column too many in front of whole millimetres, a point named by a number, points elsewhere.
    let mut report = String::new();
    for row in [
        "P1,unloaded,1,4136,left,-200,900",
        "P1,unloaded,left,1,4136,-200.5,900.25",
        "P1,1,4136,1500.125,-200.5,900.25,7",
        "P1,unloaded,left,1500,125,-200,5,900,25",
    ] {
        report += &slip(row, planned(&format!("{heading}{row}\n"), &rope_cell()));
    }
    insta::assert_snapshot!("decimal_commas", report);
}

#[test]
fn a_heading_of_two_rows_is_told_with_the_row_to_write() {
    let row = "P1,unloaded,left,1500.125,-200.5,900.25\n";
    for (heading, wanted) in [
        ("posture,state,point,position [mm],,\n,,,x,y,z\n", "posture,state,point,x_mm,y_mm,z_mm"),
        ("posture,state,point,coordinates,,\n,,,X [m],Y [m],Z [m]\n", "posture,state,point,x_m,y_m,z_m"),
        (
            "posture,state,point,position [mm],,,load,time,operator\n,,,x,y,z,[N],[s],\n",
            "posture,state,point,x_mm,y_mm,z_mm,load_n,time_s,operator",
        ),
        ("posture,state,point,x,y,z,load\n,,,mm,mm,mm,N\n", "posture,state,point,x_mm,y_mm,z_mm,load_n"),
    ] {
        let error = planned(&format!("{heading}{row}"), &rope_cell()).unwrap_err();
        assert_eq!(error.message(), "The heading has two rows; that of a table has one.");
        assert_eq!(error.hint_text(), Some(format!("write one row: {wanted}").as_str()));
        if wanted.ends_with("operator") {
            continue;
        }
        let text = format!("{wanted}\n{row}");
        assert!(!planned(&text, &rope_cell()).is_err_and(|e| e.code() == stiffarm::Code::TableHeading));
    }
}

/// A column that is read is on the page about readings; the error about an unknown one lists them all.
#[test]
fn every_column_is_on_the_page() {
    let page = include_str!("../../../../../docs/readings.md");
    let with_unknown = ROPE_LOADS.replacen("posture,state", "posture,nonsense", 1);
    let error = readings(&with_unknown, &rope_cell()).unwrap_err();
    let hint = error.hint_text().unwrap_or_default();
    let listed = hint.split_once("known columns: ").map_or("", |(_, all)| all);
    let listed = listed.split_once(';').map_or("", |(all, _)| all);
    // The page speaks of angles by that of the first joint.
    let columns = listed.split(", ").filter(|name| *name != "q2_deg");
    let columns: Vec<&str> = columns.collect();
    assert!(columns.len() >= 20, "{hint}");
    for name in columns {
        assert!(page.contains(&format!("`{name}`")), "{name}");
    }
}
