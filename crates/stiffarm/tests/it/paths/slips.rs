//! Mistakes in a path table.

use super::*;

/// What is replaced in which text by what.
const SLIPS: &[(&str, &str, &str)] = &[
    // The frame of forces.
    (POSES, "path\nP2", "\nP2"),
    (
        TOOL_AXES,
        "axis_z\n1500,-200.5,600,0,0,-1\n1510,-200.5,600,0,0.6,-0.8\n1520,-200.5,600,-1,0,0",
        "axis_z,fx_n,fy_n,fz_n\n1500,-200.5,600,0,0,-1,,,\n1510,-200.5,600,0,0,-1,5,0,0",
    ),
    (POSES, "path\nP2", "paht\nP2"),
    (POSES, "path\nP2", "world\nP2"),
    (POSES, ",,,,", ",,,,wrokpiece"),
    (POSES, "100,-20.5,0,path", "100,,0,path"),
    (ANGLES, "0,0,-3,base", ",,,base"),
    (POSES, "fx_n,fy_n,fz_n", "fx,fy,fz"),
    (POSES, "fx_n,fy_n,fz_n", "fx_n,fy_n,force"),
    (ANGLES, ",fx_n,fy_n,fz_n", ",remark,speed,feed"),
    // What the rows say of the tip.
    (POSES, "roll_deg,pitch_deg,yaw_deg", "q1_deg,q2_deg,q3_deg"),
    (POSES, "fx_n,fy_n,fz_n", "axis_x,axis_y,axis_z"),
    (
        POSES,
        "x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg,fx_n,fy_n,fz_n",
        "x_mm,y_mm,roll_deg,pitch_deg,yaw_deg",
    ),
    (
        POSES,
        "roll_deg,pitch_deg,yaw_deg,fx_n,fy_n,fz_n",
        "fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm",
    ),
    (
        POSES,
        "roll_deg,pitch_deg,yaw_deg",
        "roll_deg,pitch_deg,yaw_rad",
    ),
    (POSES, "roll_deg,pitch_deg,yaw_deg", "roll,pitch,yaw"),
    (POSES, "roll_deg,pitch_deg,yaw_deg", "a_deg,b_deg,c_deg"),
    (POSES, "roll_deg,pitch_deg,yaw_deg", "W,P,R"),
    (TOOL_AXES, "axis_x,axis_y,axis_z", "axis_x,axis_y,axis_y"),
    (
        TOOL_AXES,
        "axis_x,axis_y,axis_z",
        "axis_x_mm,axis_y_mm,axis_z_mm",
    ),
    (ANGLES, "q6_deg", "q7_deg"),
    (ANGLES, ",q6_deg", ",state"),
    (POSES, "point", "pionts"),
    // Rows.
    (POSES, "P2", "P1"),
    (POSES, "P2", ""),
    (POSES, "1510", "NaN"),
    (POSES, "1510", ""),
    (POSES, "1510", "inf"),
    (POSES, "1510", "1510 mm"),
    (TOOL_AXES, "0,0.6,-0.8", "0,0,0"),
    (TOOL_AXES, "0,0.6,-0.8", "0,nan,1"),
    (ANGLES, "P2,12.75", "P2,212.75"),
    (
        POSES,
        "\nP1,1500,-200.5,600,180,0,0,100,-20.5,0,path\nP2,1510,-200.5,600,170,5.5,-30,,,,\nP3,1520,-200.5,600,0,90,0,100,0,5,tool",
        "",
    ),
    // Units.
    (
        TOOL_AXES,
        "1500,-200.5,600,0,0,-1\n1510,-200.5,600,0,0.6,-0.8\n1520,-200.5,600",
        "1.5,-0.2005,0.6,0,0,-1\n1.51,-0.2005,0.6,0,0.6,-0.8\n1.52,-0.2005,0.6",
    ),
    (TOOL_AXES, "x_mm,y_mm,z_mm", "x_m,y_m,z_m"),
    (TOOL_AXES, "x_mm,y_mm,z_mm", "x_in,y_in,z_in"),
    (
        TOOL_AXES,
        "1500,-200.5,600,0,0,-1\n1510,-200.5,600,0,0.6,-0.8\n1520,-200.5,600",
        "1.5e6,-2e5,6e5,0,0,-1\n1.51e6,-2e5,6e5,0,0.6,-0.8\n1.52e6,-2e5,6e5",
    ),
    // Columns that are missing.
    (
        POSES,
        "x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg,fx_n,fy_n,fz_n,axes",
        "roll_deg,pitch_deg,yaw_deg",
    ),
    (
        POSES,
        "x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg,fx_n,fy_n,fz_n,axes",
        "fx_n,fy_n,fz_n",
    ),
    (
        POSES,
        "roll_deg,pitch_deg,yaw_deg,fx_n",
        "roll_deg,pitch_deg,fx_n",
    ),
    (TOOL_AXES, "axis_x,axis_y,axis_z", "axis_x,axis_y"),
    (POSES, "fx_n,fy_n,fz_n,axes", "fx_n,fy_n,axes"),
    (POSES, "fx_n,fy_n,fz_n,axes", "mx_nm,my_nm,mz_nm,axes"),
    (ANGLES, ",q6_deg", ""),
    // Decimal commas.
    (TOOL_AXES, "1510,-200.5", "1510,5,-200,5"),
    (TOOL_AXES, "1510", "\"1510,5\""),
];

#[test]
fn slips_in_a_path_table() -> Check {
    let cell = cell_with("");
    let mut report = String::new();
    let mut note = |slip: &str, result: stiffarm::Result<PathTable>| {
        let error = match result {
            Ok(_) => panic!("accepted: {slip}"),
            Err(error) => error,
        };
        report += &format!("» {slip}\n[{}] {error}\n\n", error.code().as_str());
    };
    for (text, from, to) in SLIPS {
        assert!(text.contains(from), "{from}");
        let shown = match *to {
            "" => format!("without {from}"),
            to => to.to_string(),
        };
        note(
            &shown.replace('\n', "; "),
            read(&text.replacen(from, to, 1), &cell),
        );
    }
    // A path in metres beside the origin of its own frame.
    let metres = "x_mm,y_mm,z_mm,axis_x,axis_y,axis_z\n\
                  0,0,0,0,0,-1\n0.3,0,0,0,0,-1\n0.3,0.2,0,0,0,-1\n";
    note(
        "metres in the workpiece frame",
        read(metres, &cell_with(WORKPIECE)),
    );
    // The base frame need not be the robot's.
    let mut aside = cell_with("");
    let placed = Isometry3::translation(-2.0, 0.0, 0.5);
    aside.setup.robot = aside.setup.robot.with_base(&placed);
    note("metres beside the robot", read(metres, &aside));
    insta::assert_snapshot!("path_slips", report);
    Ok(())
}

#[test]
fn small_paths_and_points_are_no_slips() -> Check {
    let cell = cell_with(WORKPIECE);
    // One hole, the same point under several loads, a small engraving.
    for rows in [
        "0,0,0\n0,0,-5\n0,0,-10\n",
        "0,0,0\n0,0,0\n0,0,0\n0,0,0\n",
        "0,0,0\n0.2,0,0\n",
        "0,0,0\n2,0,0\n2,2,0\n0,2,0\n",
    ] {
        let rows = rows.replace('\n', ",0,0,-1\n");
        let text = format!("x_mm,y_mm,z_mm,axis_x,axis_y,axis_z\n{rows}");
        read(&text, &cell)?;
        // The same in metres is no slip either.
        let text =
            "x_m,y_m,z_m,axis_x,axis_y,axis_z\n0,0,0,0,0,-1\n0.3,0,0,0,0,-1\n0.3,0.2,0,0,0,-1\n";
        read(text, &cell)?;
    }
    Ok(())
}
