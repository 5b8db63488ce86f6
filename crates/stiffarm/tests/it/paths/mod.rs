//! Path tables are read and written without loss, and each slip is reported.

mod round_trip;
mod slips;

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, UnitVector3, Vector3};
use proptest::prelude::*;
use stiffarm::model::cell::Cell;
use stiffarm::model::path::{PathPoint, PathTarget};
use stiffarm::model::process::{ForceAxes, TipLoad};
use stiffarm_files::cell::parse_cell;
use stiffarm_files::table::{PathFormat, PathKind, PathTable, read_path, write_path};

type Check = Result<(), Box<dyn std::error::Error>>;

/// A workpiece frame off every axis.
const WORKPIECE: &str = "[work]\nworkpiece_mm = [1500.5, -200, 612.25]\nworkpiece_rpy_deg = [10, -20, 35]\n";

/// The COMAU arm and what else the cell says.
fn cell_with(more: &str) -> Cell {
    let text = format!(
        "format = 1\nrobot.catalogue = 'comau-nj165-3.0'\n\
         tool = {{ loading_point_mm = [200, 0, 250], measuring_point = [{{ name = '1', position_mm = [0, 0, 300] }}] }}\n\
         load = {{ kind = 'measured' }}\n{more}"
    );
    parse_cell(&text, "cell.toml").unwrap()
}

fn read(text: &str, cell: &Cell) -> stiffarm::Result<PathTable> {
    read_path(text.as_bytes(), "path.csv", cell, None)
}

const ANGLES: &str = "\
point,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm,axes
P1,12.5,-30,-100,0,45.25,0,100,-20.5,0,0,0,-3,base
P2,12.75,-30,-100,0,45.25,0,,,,,,,
P3,13,-30,-100,0,45.25,180,100,0,1e-3,1,2,3,workpiece
";

const POSES: &str = "\
point,x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg,fx_n,fy_n,fz_n,axes
P1,1500,-200.5,600,180,0,0,100,-20.5,0,path
P2,1510,-200.5,600,170,5.5,-30,,,,
P3,1520,-200.5,600,0,90,0,100,0,5,tool
";

const TOOL_AXES: &str = "\
x_mm,y_mm,z_mm,axis_x,axis_y,axis_z
1500,-200.5,600,0,0,-1
1510,-200.5,600,0,0.6,-0.8
1520,-200.5,600,-1,0,0
";

#[test]
fn angles_and_loads_of_the_rows() -> Check {
    let cell = cell_with("");
    let path = read(ANGLES, &cell)?;
    assert_eq!(path.format.kind(), PathKind::Angles);
    assert!(path.format.has_loads());
    let [first, second, third] = &path.points[..] else {
        panic!("three points");
    };
    assert_eq!((first.name.as_ref(), first.line), ("P1", Some(2)));
    let q = [12.5f64, -30.0, -100.0, 0.0, 45.25, 0.0].map(f64::to_radians);
    assert_eq!(first.target, PathTarget::Angles(q.to_vec()));
    let load =
        TipLoad { force: Vector3::new(100.0, -20.5, 0.0), moment: Vector3::new(0.0, 0.0, -3.0), axes: ForceAxes::Base };
    assert_eq!(first.load, Some(load));
    assert_eq!(second.load, None, "empty fields leave the load to the process");
    assert_eq!(third.load.ok_or("no load")?.axes, ForceAxes::Workpiece);
    assert_eq!(write_path(&path.format, &path.points)?, ANGLES.replace("1e-3", "0.001"));

    // Axes for the whole table, and a row that knows better.
    let text = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,fx_n,fy_n,fz_n,axes\n\
                0,0,-90,0,0,0,1,2,3,\n0,0,-90,0,0,0,1,2,3, Base \n";
    let path = read_path(text.as_bytes(), "p.csv", &cell, Some(ForceAxes::Path))?;
    let axes: Vec<_> = path.points.iter().map(|p| p.load.map(|load| load.axes)).collect();
    assert_eq!(axes, [Some(ForceAxes::Path), Some(ForceAxes::Base)]);
    let names: Vec<_> = path.points.iter().map(|point| point.name.as_ref()).collect();
    assert_eq!(names, ["1", "2"]);
    Ok(())
}

#[test]
fn poses_are_turns_about_x_then_y_then_z() -> Check {
    let (roll, pitch, yaw) = (170f64.to_radians(), 5.5f64.to_radians(), -30f64.to_radians());
    // Written out: W, P, R of FANUC; C, B, A of KUKA.
    let about_x = Matrix3::new(
        1.0,
        0.0,
        0.0, //
        0.0,
        roll.cos(),
        -roll.sin(), //
        0.0,
        roll.sin(),
        roll.cos(),
    );
    let about_y = Matrix3::new(
        pitch.cos(),
        0.0,
        pitch.sin(), //
        0.0,
        1.0,
        0.0, //
        -pitch.sin(),
        0.0,
        pitch.cos(),
    );
    let about_z = Matrix3::new(
        yaw.cos(),
        -yaw.sin(),
        0.0, //
        yaw.sin(),
        yaw.cos(),
        0.0, //
        0.0,
        0.0,
        1.0,
    );
    let rotation = Rotation3::from_matrix_unchecked(about_z * about_y * about_x);
    let local =
        Isometry3::from_parts(Translation3::new(1.51, -0.2005, 0.6), UnitQuaternion::from_rotation_matrix(&rotation));
    for more in ["", WORKPIECE] {
        let cell = cell_with(more);
        let path = read(POSES, &cell)?;
        let PathTarget::Pose(pose) = path.points[1].target else {
            panic!("a pose");
        };
        let expected = cell.work.workpiece * local;
        let apart = (pose.translation.vector - expected.translation.vector).norm();
        assert!(apart < 1e-15 && pose.rotation.angle_to(&expected.rotation) < 1e-15);
        // At a pitch of 90° only yaw − roll counts: −0 of it here.
        assert_eq!(write_path(&path.format, &path.points)?, POSES);
    }
    Ok(())
}

#[test]
fn tool_axes_of_any_length() -> Check {
    for more in ["", WORKPIECE] {
        let cell = cell_with(more);
        let path = read(TOOL_AXES, &cell)?;
        let PathTarget::Axis { position, axis } = &path.points[1].target else {
            panic!("an axis");
        };
        let workpiece = &cell.work.workpiece;
        let local = Vector3::new(1.51, -0.2005, 0.6);
        let at = workpiece.rotation * local + workpiece.translation.vector;
        assert!((position - at).norm() < 1e-15);
        let expected = workpiece.rotation * Vector3::new(0.0, 0.6, -0.8);
        assert!((axis.as_ref() - expected).norm() < 1e-15);
        assert_eq!(write_path(&path.format, &path.points)?, TOOL_AXES);
        let longer = TOOL_AXES.replace("0,0.6,-0.8", "0,6e3,-8e3");
        assert_eq!(write_path(&path.format, &read(&longer, &cell)?.points)?, TOOL_AXES);
    }
    Ok(())
}

#[test]
fn the_same_path_in_other_units_headings_and_separators() -> Check {
    let cell = cell_with("");
    let plain = read(POSES, &cell)?;
    let changed = [
        POSES.replace(',', ";").replace('.', ","),
        POSES.replace('\n', "\r\n"),
        POSES.replace("x_mm,y_mm,z_mm", "X_mm, Y_mm ,z_MM"),
        POSES
            .replace("fx_n,fy_n,fz_n", "fx_kN,fy_kN,fz_kN")
            .replace("100,-20.5,0,path", "0.1,-0.0205,0,path")
            .replace("100,0,5,tool", "0.1,0,0.005,tool"),
        POSES
            .replace("x_mm,y_mm,z_mm", "x_m,y_m,z_m")
            .replace("1500,-200.5,600", "1.5,-0.2005,0.6")
            .replace("1510,-200.5,600", "1.51,-0.2005,0.6")
            .replace("1520,-200.5,600", "1.52,-0.2005,0.6"),
    ];
    for text in &changed {
        let path = read(text, &cell)?;
        assert_eq!(path.points, plain.points, "{text}");
    }
    // Written in the units that were read.
    let path = read(&changed[3], &cell)?;
    assert_eq!(write_path(&path.format, &path.points)?, changed[3]);
    let path = read(&changed[4], &cell)?;
    assert_eq!(write_path(&path.format, &path.points)?, changed[4]);

    // What another software calls its columns, and one that does not matter.
    let cell = cell_with(
        "[columns]\nx_mm = 'X'\ny_mm = 'Y'\nz_mm = 'Z'\nroll_deg = 'C'\npitch_deg = 'B'\nyaw_deg = 'A'\n\
         point = 'N'\nignore = ['Speed']\n",
    );
    let text = "N,X,Y,Z,A,B,C,Speed\nP1,1500,-200.5,600,0,0,180,50\n";
    let path = read(text, &cell)?;
    assert_eq!(path.points[0].target, plain.points[0].target);
    let written = write_path(&path.format, &path.points)?;
    assert_eq!(written, "N,X,Y,Z,A,B,C\nP1,1500,-200.5,600,0,0,180\n");
    Ok(())
}

#[test]
fn a_path_is_written_in_other_columns() -> Check {
    let cell = cell_with(WORKPIECE);
    let table = read(POSES, &cell)?;
    let q = vec![0.25f64.to_radians(), 0.0, -1.5, 0.0, 0.0, 1e-3];
    let mut points = table.points.clone();
    for point in &mut points {
        point.target = PathTarget::Angles(q.clone());
    }
    let format = table.format.clone().angles(&cell);
    let text = write_path(&format, &points)?;
    let (heading, rows) = text.split_once('\n').ok_or("no rows")?;
    assert_eq!(heading, "point,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,fx_n,fy_n,fz_n,axes");
    assert!(rows.starts_with("P1,0.25,0,"), "{rows}");
    let again = read(&text, &cell)?;
    assert_eq!(again.points, points, "the same to the last digit");
    assert_eq!(again.format, format);

    // Back to poses; a pose also has a tool axis.
    let back = write_path(&format.poses(&cell), &table.points)?;
    assert_eq!(back, POSES);
    let format = table.format.clone().with_kind(PathKind::ToolAxes, &cell);
    let text = write_path(&format, &table.points)?;
    insta::assert_snapshot!(text, @"
    point,x_mm,y_mm,z_mm,axis_x,axis_y,axis_z,fx_n,fy_n,fz_n,axes
    P1,1500,-200.5,600,0,0,-1,100,-20.5,0,path
    P2,1510,-200.5,600,-0.168567915079,-0.103188913093,-0.980273893470903,,,,
    P3,1520,-200.5,600,1,0,0,100,0,5,tool
    ");

    // From nothing, and with loads.
    let bare = PathFormat::new(PathKind::Poses, &cell);
    assert!(!bare.has_loads());
    let text = write_path(&bare, &table.points)?;
    assert!(text.starts_with("point,x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg\nP1,1500,"), "{text}");
    let text = write_path(&bare.with_loads(&cell), &table.points)?;
    insta::assert_snapshot!(text, @"
    point,x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm,axes
    P1,1500,-200.5,600,180,0,0,100,-20.5,0,0,0,0,path
    P2,1510,-200.5,600,170,5.5,-30,,,,,,,
    P3,1520,-200.5,600,0,90,0,100,0,5,0,0,0,tool
    ");
    Ok(())
}

#[test]
fn european_tables_go_out_as_they_came_in() -> Check {
    let cell = cell_with("");
    let text = "point;x_mm;y_mm;z_mm;roll_deg;pitch_deg;yaw_deg;fx_kn;fy_kn;fz_kn;axes\n\
                \"a;b\";1500,5;0;900;180;0;0;0,125;0;-0,5;base\n\
                c,d;1520;-0,25;900;180;0;10,5;;;;\n";
    let table = read(text, &cell)?;
    assert_eq!(write_path(&table.format, &table.points)?, text);
    let tabs = text.replace(',', ".").replace(';', "\t").replace("a\tb", "a b");
    let table = read(&tabs, &cell)?;
    assert_eq!(write_path(&table.format, &table.points)?, tabs.replace('"', ""));
    Ok(())
}

#[test]
fn what_the_columns_cannot_hold_is_refused() -> Check {
    let cell = cell_with("");
    let (angles, poses, axes) = (read(ANGLES, &cell)?, read(POSES, &cell)?, read(TOOL_AXES, &cell)?);
    let no_axes = TOOL_AXES.replace("axis_z", "axis_z,fx_n,fy_n,fz_n");
    let no_axes = no_axes.replace("00,0,0,-1", "00,0,0,-1,1,2,3").replace("-0.8", "-0.8,1,2,3");
    let no_axes = no_axes.replace("-1,0,0", "-1,0,0,1,2,3");
    let no_axes = read_path(no_axes.as_bytes(), "p.csv", &cell, Some(ForceAxes::Tool))?;
    let mut loaded = axes.points.clone();
    loaded[0].load = angles.points[0].load;
    let mut turned = poses.points.clone();
    turned[0].load = angles.points[0].load;
    let mut short = angles.points.clone();
    short[1].target = PathTarget::Angles(vec![0.0; 5]);
    let mut report = String::new();
    for (format, points) in [
        (&angles.format, &poses.points),
        (&poses.format, &angles.points),
        (&poses.format, &axes.points),
        (&axes.format, &angles.points),
        (&angles.format, &short),
        (&no_axes.format, &loaded),
        (&poses.format, &turned),
    ] {
        let error = write_path(format, points).unwrap_err();
        report += &format!("[{}] {error}\n\n", error.code().as_str());
    }
    insta::assert_snapshot!("path_writing", report);
    Ok(())
}
