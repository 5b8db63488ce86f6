//! Mistakes in a table of readings.

use super::*;

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
