//! Mistakes in tables of postures and displacements.

use super::*;

/// Posture tables with a slip.
const POSTURE_SLIPS: &[(&str, &str)] = &[
    ("empty", ""),
    ("only a comment", "# nothing\n\n"),
    ("heading only", "posture,q1_deg,q2_deg\n"),
    ("no heading", "P1,12.5,-30\nP2,-90,45\n"),
    ("no unit", "posture,q1,q2\nP1,12.5,-30\n"),
    ("gradians", "posture,q1_gon,q2_gon\nP1,10,-30\n"),
    ("two units", "posture,q1_deg,q2_rad\nP1,12.5,-0.3\n"),
    (
        "twice in two units",
        "posture,q1_deg,q2_deg,q1_rad\nP1,12.5,-30,0.2\n",
    ),
    (
        "another name of the joint",
        "posture,joint 1 [deg],q2_deg\nP1,0.1,-0.3\n",
    ),
    ("a joint too few", "posture,q1_deg\nP1,12.5\n"),
    (
        "a joint too many",
        "posture,q1_deg,q2_deg,q3_deg\nP1,12.5,-30,5\n",
    ),
    ("no name", "q1_deg,q2_deg\n12.5,-30\n"),
    ("misspelt", "postrue,q1_deg,q2_deg\nP1,12.5,-30\n"),
    ("unknown", "posture,q1_deg,q2_deg,speed\nP1,12.5,-30,5\n"),
    ("twice", "posture,q1_deg,q1_deg\nP1,12.5,-30\n"),
    (
        "column without name",
        "posture,,q1_deg,q2_deg\nP1,,12.5,-30\n",
    ),
    ("spaces", "posture q1_deg q2_deg\nP1 12.5 -30\n"),
    ("text", "posture,q1_deg,q2_deg\nP1,12.5,-30\nP2,left,45\n"),
    ("unit in the field", "posture,q1_deg,q2_deg\nP1,12.5°,-30\n"),
    ("nothing", "posture,q1_deg,q2_deg\nP1,12.5,-30\nP2,,45\n"),
    ("nameless", "posture,q1_deg,q2_deg\n,12.5,-30\n"),
    ("NaN", "posture,q1_deg,q2_deg\nP1,nan,-30\n"),
    ("infinity", "posture,q1_deg,q2_deg\nP1,12.5,-inf\n"),
    ("overflow", "posture,q1_deg,q2_deg\nP1,12.5,1e999\n"),
    ("too short", "posture,q1_deg,q2_deg\n\n# comment\nP1,12.5\n"),
    (
        "too long by a number",
        "posture,q1_deg,q2_deg\nP1,12,30,5\n",
    ),
    ("too long", "posture,q1_deg,q2_deg\nP1,12.5,-30.5,note\n"),
    ("unclosed", "posture,q1_deg,q2_deg\n\"P1,12.5,-30\n"),
    (
        "decimal comma",
        "posture,q1_deg,q2_deg\nP1,12.5,-30\nP2,12,5,-30\n",
    ),
    ("decimal commas", "posture,q1_deg,q2_deg\nP1,12,5,-30,25\n"),
    (
        "quoted decimal comma",
        "posture,q1_deg,q2_deg\nP1,\"12,5\",-30\n",
    ),
    ("thousands", "posture;q1_deg;q2_deg\nP1;1.012,5;-30\n"),
    (
        "twice the same",
        "posture,q1_deg,q2_deg\nP1,12.5,-30\nP2,1,2\nP1,3,4\n",
    ),
    (
        "machine's limits",
        "posture,q1_deg,q2_deg\nP1,12.5,-30\nP2,12.5,95.5\n",
    ),
];

#[test]
fn slips_in_a_posture_table() {
    let mut report = String::new();
    for (slip, text) in POSTURE_SLIPS {
        let error = match postures(text) {
            Ok(_) => panic!("accepted: {slip}"),
            Err(error) => error,
        };
        report += &format!("» {slip}\n[{}] {error}\n\n", error.code().as_str());
    }
    let utf16 = read_postures(
        b"\xff\xfep\0\n\0\x00\xdco\0",
        "postures.csv",
        &rope_cell().setup.robot,
    );
    let latin1 = read_postures(
        b"posture,q1_deg\nT\xfcr,1\n",
        "postures.csv",
        &rope_cell().setup.robot,
    );
    for error in [utf16, latin1].map(Result::unwrap_err) {
        report += &format!("[{}] {error}\n\n", error.code().as_str());
    }
    insta::assert_snapshot!("posture_slips", report);
}

/// What is replaced in [`DISPLACEMENTS`] by what.
const DISPLACEMENT_SLIPS: &[(&str, &str)] = &[
    ("dx_mm,dy_mm,dz_mm", "x_mm,y_mm,z_mm"),
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
    let mut note = |slip: &str, result: stiffarm::Result<Vec<MeasuredPosture>>| {
        let error = match result {
            Ok(_) => panic!("accepted: {slip}"),
            Err(error) => error,
        };
        report += &format!("» {slip}\n[{}] {error}\n\n", error.code().as_str());
    };
    for (from, to) in DISPLACEMENT_SLIPS {
        assert!(DISPLACEMENTS.contains(from), "{from}");
        note(
            to,
            displacements(&DISPLACEMENTS.replacen(from, to, 1), &cell),
        );
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
    note(
        "a posture that was not planned",
        with_plan(&bare.replace("P1", "P11")),
    );
    let both = "posture,point,dx_mm,dy_mm,dz_mm,q1_deg,q2_deg\nP1,left,1,2,3,12.5,-31\n";
    note("other angles than planned", with_plan(both));
    note(
        "heading only",
        with_plan("posture,point,dx_mm,dy_mm,dz_mm\n"),
    );
    insta::assert_snapshot!("displacement_slips", report);
    Ok(())
}
