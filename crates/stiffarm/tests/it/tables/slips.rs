//! Mistakes in tables of postures and displacements are reported with place and hint.

use super::*;
use crate::common::cases::{cases, slip};

#[test]
fn slips_in_a_posture_table() {
    let mut report = String::new();
    for [what, text] in cases(include_str!("posture_slips.txt")) {
        report += &slip(&what, postures(&text));
    }
    let utf16 = read_postures(b"\xff\xfep\0\n\0\x00\xdco\0", "postures.csv", &rope_cell().setup.robot);
    let latin1 = read_postures(b"posture,q1_deg\nT\xfcr,1\n", "postures.csv", &rope_cell().setup.robot);
    for error in [utf16, latin1].map(Result::unwrap_err) {
        report += &format!("[{}] {error}\n\n", error.code().as_str());
    }
    insta::assert_snapshot!("posture_slips", report);
}

/// What is replaced in [`DISPLACEMENTS`] by what.
const DISPLACEMENT_SLIPS: &[(&str, &str)] = &[
    ("dx_mm,dy_mm,dz_mm", "dx,dy,dz"),
    ("dx_mm,dy_mm,dz_mm", "dx [ell],dy [ell],dz [ell]"),
    ("dx_mm,dy_mm,dz_mm", "dx_cm,dy_cm,dz_cm"),
    ("dx_mm,dy_mm,dz_mm", "dx_mm,dy_mm,dz_m"),
    ("dx_mm,dy_mm,dz_mm", "dx_mm,dx_m,dz_mm"),
    ("dx_mm,dy_mm,dz_mm", "dx_m,dy_m"),
    ("dx_mm,dy_mm,dz_mm", "dx_mm,dy_mm,z_mm"),
    ("dx_mm,dy_mm,dz_mm,", "load_n,remark,operator,"),
    ("time_s", "load_n"),
    ("fx_n,fy_n,fz_n", "fx_lbf,fy_lbf,fz_lbf"),
    ("mx_nm,my_nm,mz_nm", "mx,my,mz"),
    ("time_s", "time"),
    ("q1_deg,q2_deg", "q1,q2"),
    ("point", "pionts"),
    ("state", "remark"),
    ("posture,state,point,dx_mm,", "posture,state,point,"),
    ("fx_n,fy_n,fz_n", "fx_n,fy_n"),
    ("P1,up,right", "P1,up,rihgt"),
    ("P1,up,right", "P1,up,TCP"),
    ("P1,up,right", "P1,up,base"),
    ("P1,up,right", "P1,up,"),
    ("P1,up,right", "P1,,right"),
    ("P1,up,right,0.25,-0.5", "P1,up,right,0.25,"),
    ("P1,up,right,0.25,-0.5", "P1,up,right,0.25,-0.5 mm"),
    ("P1,up,right,0.25,-0.5", "P1,up,right,0.25,NaN"),
    ("P1,up,right,0.25,-0.5", "P1,up,right,0,25,-0,5"),
    ("11,12.5,-30", "11,12.6,-30"),
    ("11,12.5,-30", "11,12.5,-80"),
    ("-500,1,2,3,11", "-501,1,2,3,11"),
    ("-500,1,2,3,11", "-500,1,2.5,3,11"),
    ("-500,1,2,3,11", "-500,1,2,3,soon"),
];

#[test]
fn slips_in_a_measurement_table() -> Check {
    let cell = measured_cell();
    let mut report = String::new();
    let mut note = |what: &str, read: stiffarm::Result<Vec<MeasuredPosture>>| report += &slip(what, read);
    for (from, to) in DISPLACEMENT_SLIPS {
        assert!(DISPLACEMENTS.contains(from), "{from}");
        note(to, displacements(&DISPLACEMENTS.replacen(from, to, 1), &cell));
    }
    let bare = "posture,point,dx_mm,dy_mm,dz_mm\nP1,left,1,2,3\n";
    note("no force for a measured load", displacements(bare, &cell));
    note("no angles", displacements(bare, &rope_cell()));
    let moment = "posture,point,dx_mm,dy_mm,dz_mm,mx_nm,my_nm,mz_nm\nP1,left,1,2,3,4,5,6\n";
    note("moment only", displacements(moment, &rope_cell()));
    let angle = "posture,point,dx_mm,dy_mm,dz_mm,q2_deg\nP1,left,1,2,3,-30\n";
    note("one angle only", displacements(angle, &rope_cell()));
    let planned = postures(POSTURES)?;
    let with_plan = |text: &str| {
        let text = text.as_bytes();
        read_displacements(text, "measurements.csv", &rope_cell(), Some(&planned))
    };
    note("a posture that was not planned", with_plan(&bare.replace("P1", "P11")));
    let both = "posture,point,dx_mm,dy_mm,dz_mm,q1_deg,q2_deg\nP1,left,1,2,3,12.5,-31\n";
    note("other angles than planned", with_plan(both));
    note("heading only", with_plan("posture,point,dx_mm,dy_mm,dz_mm\n"));
    insta::assert_snapshot!("displacement_slips", report);
    Ok(())
}
