//! The same path is the same in every language, and each keeps what it has of its own.

use super::{Check, apart, axes, cell_with, codes, positions, read, rounded, stated, unit};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use stiffarm_files::program::Language;
use stiffarm_files::table::{read_path, write_path};
use stiffarm_files::tool_path::{Kind, ReadPath, read_tool_path};

/// A pose as x, y, z \[mm\] and turns about fixed x, y, z \[deg\].
type Row = [f64; 6];

fn rotation([.., w, p, r]: &Row) -> UnitQuaternion<f64> {
    let [w, p, r] = [w, p, r].map(|turn| turn.to_radians());
    UnitQuaternion::from_euler_angles(w, p, r)
}

fn table(rows: &[Row]) -> String {
    let rows = rows.iter().map(|row| row.map(|v| format!("{v:.9}")).join(",") + "\n");
    "x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg\n".to_string() + &rows.collect::<String>()
}

fn each(rows: &[Row], line: impl Fn(usize, &Row) -> String) -> String {
    rows.iter().enumerate().map(|(i, row)| line(i, row)).collect()
}

/// The path in a language, with its file name.
fn written(rows: &[Row]) -> Vec<(&'static str, String)> {
    let krl = each(rows, |_, [x, y, z, w, p, r]| {
        format!("LIN {{X {x:.9}, Y {y:.9}, Z {z:.9}, A {r:.9}, B {p:.9}, C {w:.9}, S 2, T 35}} C_DIS\r\n")
    });
    let rapid = each(rows, |_, row| {
        let q = rotation(row);
        let [x, y, z, ..] = row;
        format!(
            "MoveL [[{x:.9},{y:.9},{z:.9}],[{:.12},{:.12},{:.12},{:.12}],[0,0,0,1],[9E9,9E+09,9E9,9E9,9E9,9E9]],v50,z1,tool1\\WObj:=part;\n",
            q.w, q.i, q.j, q.k
        )
    });
    let moves = each(rows, |i, _| format!("{:4}:L P[{}:\"a\"] 100.0mm/sec CNT100 ACC50 ;\n", i + 1, i + 1));
    let points = each(rows, |i, [x, y, z, w, p, r]| {
        format!(
            "P[{}:\"a\"]{{\n   GP1:\n\tUF : 1, UT : 2,\tCONFIG : 'N U T, 0, 0, 0',\n\tX = {x:.9} mm,\tY = {y:.9} mm,\tZ={z:.9} mm,\n\
             \tW = {w:.9} deg,\tP = {p:.9} deg,\tR = {r:.9} deg\n   GP2:\n\tUF : 0, UT : 1,\n\tJ1= 0.0 deg,\tJ2= 0 deg\n}};\n",
            i + 1
        )
    });
    let ls = format!("/PROG  PART\n/ATTR\n/MN\n{moves}/POS\n{points}/END\n");
    vec![("a.src", krl), ("a.mod", rapid), ("a.ls", ls)]
}

fn rows() -> impl Strategy<Value = Vec<Row>> {
    let length = || -500.0..500.0_f64;
    let turn = || -180.0..180.0_f64;
    let row = (length(), length(), length(), turn(), -90.0..90.0_f64, turn());
    prop::collection::vec(row.prop_map(|(a, b, c, d, e, f)| [a, b, c, d, e, f]), 1..6)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn robots_programs_are_their_table(rows in rows()) {
        let cell = cell_with("");
        let expected = read_path(table(&rows).as_bytes(), "a.csv", &cell, None).unwrap().points;
        for (name, text) in written(&rows) {
            let path = read(name, &text).unwrap();
            let (position, angle) = apart(&stated(&path), &expected);
            prop_assert!(position < 1e-9 && angle < 1e-9, "{name}: {position} m, {angle} rad");
        }
    }

    #[test]
    fn cl_data_and_g_code_are_their_table(rows in rows()) {
        let cell = cell_with("");
        let axis = |row: &Row| -(rotation(row) * Vector3::z());
        let columns = each(&rows, |_, row| {
            let ([x, y, z, ..], a) = (row, -axis(row));
            format!("{x:.9},{y:.9},{z:.9},{:.12},{:.12},{:.12}\n", a.x, a.y, a.z)
        });
        let columns = format!("x_mm,y_mm,z_mm,axis_x,axis_y,axis_z\n{columns}");
        let expected = read_path(columns.as_bytes(), "a.csv", &cell, None).unwrap().points;
        let numbers = |row: &Row, between: &str| {
            let ([x, y, z, ..], a) = (row, axis(row));
            [*x, *y, *z, a.x, a.y, a.z].map(|v| format!("{v:.12}")).join(between)
        };
        let clsf = each(&rows, |_, row| format!("GOTO/{}\n", numbers(row, ",")));
        let apt = each(&rows, |_, row| format!("GOTO  / {}   $$ point\n", numbers(row, ",  $\n   ")));
        let gcode = each(&rows, |i, row| {
            let ([x, y, z, ..], a) = (row, axis(row));
            format!("N{i} G1 X{x:.9}Y{y:.9} Z={z:.9} A3={:.12} B3={:.12} C3={:.12}\n", a.x, a.y, a.z)
        });
        for (name, text) in [("a.cls", clsf), ("a.apt", apt), ("a.mpf", gcode)] {
            let path = read(name, &text).unwrap();
            let (position, angle) = apart(&stated(&path), &expected);
            prop_assert!(position < 1e-9 && angle < 1e-8, "{name}: {position} m, {angle} rad");
        }
    }
}

#[test]
fn urscript_counts_from_the_base_of_the_controller() -> Check {
    let q = UnitQuaternion::from_euler_angles(3.0, 0.2, -1.0);
    let v = q.scaled_axis();
    let text = format!(
        "def a():\n  global way_p=p[0.4,0.1,0.2,0,3.1,0]\n  movej([0,-1,1,0,1,0], a=1.4)\n  movej(way_p, a=1.4)\n  \
         movel(p[1.4, 0.2, 0.5, {:.12}, {:.12}, {:.12}], a=0.5, v=0.1, r=0.001)\nend\n",
        v.x, v.y, v.z
    );
    let cell = cell_with("");
    let path = read("a.script", &text)?;
    let base = cell.setup.robot.controller_base();
    let expected = base * Isometry3::from_parts(Vector3::new(1.4, 0.2, 0.5).into(), q);
    let mut point = path.points.last().unwrap().clone();
    point.target = stiffarm::model::path::PathTarget::Pose(expected);
    let (position, angle) = apart(&stated(&path)[1..], &[point]);
    assert!(position < 1e-12 && angle < 1e-9);
    assert!(path.points[0].rapid && !path.points.last().unwrap().rapid);
    assert_eq!(codes(&path), ["joint-moves"]);
    Ok(())
}

#[test]
fn cl_data_has_modal_axes_rapid_moves_units_and_frames() -> Check {
    let text = "TOOL PATH/POCKET,TOOL,MILL_D10\nUNITS/INCH\nMSYS/10,0,0,1,0,0,0,1,0\n$$ a comment\nPAINT/PATH\nRAPID\n\
                GOTO/1.0,0.0,2.0,0.0,0.6,0.8\nFEDRAT/MMPM,300\nGOTO/1.0,0.0,0.0\nGOTO/2,0,0,0,0,1\nRAPID\nGOTO/2,0,2\n\
                MSYS/10,0,1,0,1,0,-1,0,0\nGOTO/1,0,0\nCYCLE/DRILL,RAPTO,0.1\nGOTO/1,1,0\nCYCLE/OFF\nHEDGEHOG/1\nEND-OF-PATH\n";
    let path = read("a.clsf", text)?;
    let inch = |x: f64, y: f64, z: f64| [25.4 * x, 25.4 * y, 25.4 * z];
    // The second frame is an inch higher and a quarter turn on.
    let expected = [
        inch(1.0, 0.0, 2.0),
        inch(1.0, 0.0, 0.0),
        inch(2.0, 0.0, 0.0),
        inch(2.0, 0.0, 2.0),
        inch(0.0, 1.0, 1.0),
        inch(-1.0, 1.0, 1.0),
    ];
    assert_eq!(rounded(&stated(&path)), expected);
    let rapid: Vec<bool> = stated(&path).iter().map(|point| point.rapid).collect();
    assert_eq!(rapid, [true, false, false, true, false, false]);
    let tilted = unit(0.0, 0.6, 0.8);
    let expected = [tilted, tilted, Vector3::z(), Vector3::z(), Vector3::z(), Vector3::z()];
    assert!(axes(&stated(&path)).iter().zip(expected).all(|(a, b)| (a - b).norm() < 1e-12));
    assert_eq!(codes(&path), ["cycle", "not-followed"]);
    Ok(())
}

#[test]
fn cl_data_has_steps() -> Check {
    let path = read("a.apt", "UNITS/INCH\nGOTO/1,0,0\nGODLTA/0,0,-.5\nGODLTA/1,0,0\n")?;
    let expected = [[25.4, 0.0, 0.0], [25.4, 0.0, -12.7], [50.8, 0.0, -12.7]];
    assert_eq!(positions(&path), expected);
    Ok(())
}

#[test]
fn cl_data_has_arcs() -> Check {
    let path = read("a.cls", "UNITS/MM\nGOTO/10,0,0\nCIRCLE/0,0,0,0,0,-1,10,0.06,0.5,20,0\nGOTO/0,10,0\n")?;
    let all = positions(&path);
    assert_eq!(all.last(), Some(&[0.0, 10.0, 0.0]));
    assert!(all.len() > 10);
    let off = all.iter().map(|p| (p[0].hypot(p[1]) - 10.0).abs()).fold(0.0, f64::max);
    assert!(off < 1e-6 && all.iter().all(|p| p[0] > -1e-6 && p[1] > -1e-6));
    Ok(())
}

const POINT: &str = "{X 10,Y 20,Z 30,A 0,B 0,C 180}";

#[test]
fn krl_keeps_what_a_line_leaves_out_and_finds_points_in_the_dat() -> Check {
    let text = format!(
        "DEF a ( )\nPTP {{A1 0,A2 -90,A3 90,A4 0,A5 0,A6 0}}\nSPTP XP1\nLIN {POINT}\nLIN {{Z 25}} C_DIS\nSLIN {{X 11,C 170}}\nEND\n"
    );
    let dat = "DEFDAT a\nDECL E6POS XP1={X 0,Y 0,Z 50,A 0,B 0,C 180,S 2,T 35,E1 0.0,E2 0.0}\nENDDAT\n";
    let companion = Some(("a.dat", dat.as_bytes()));
    let kind = Kind::Robot(Language::Krl);
    let path = read_tool_path(kind, ("a.src", text.as_bytes()), companion, &cell_with(""))?;
    let expected = [[0.0, 0.0, 50.0], [10.0, 20.0, 30.0], [10.0, 20.0, 25.0], [11.0, 20.0, 25.0]];
    assert_eq!(rounded(&stated(&path)), expected);
    assert!(path.points[0].rapid && !stated(&path)[1].rapid);
    assert_eq!(codes(&path), ["joint-moves"]);
    Ok(())
}

/// A circle of 10 mm about the origin, in each language that has arcs through a point.
#[test]
fn arcs_of_robots_pass_their_points() -> Check {
    let krl =
        "LIN {X 10,Y 0,Z 0,A 0,B 0,C 180}\nCIRC {X 0,Y 10,Z 0,A 0,B 0,C 180},{X -10,Y 0,Z 0,A 0,B 0,C 180} C_DIS\n";
    let at = |x: i32, y: i32| format!("[[{x},{y},0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]");
    let rapid = format!(
        "CONST robtarget via:={};\nMoveL {},v50,fine,t;\nMoveC via,{},v50,z1,t\\WObj:=part;\n",
        at(0, 10),
        at(10, 0),
        at(-10, 0)
    );
    let position = |number: i32, x: i32, y: i32| {
        format!(
            "P[{number}]{{\n GP1:\n UF : 0, UT : 1, CONFIG : 'N U T, 0, 0, 0',\n X = {x} mm, Y = {y} mm, Z = 0 mm,\n W = 180 deg, P = 0 deg, R = 0 deg\n}};\n"
        )
    };
    let ls = format!(
        "/PROG A\n/MN\n 1:L P[1] 50mm/sec FINE ;\n 2:C P[2]\n  :  P[3] 50mm/sec FINE ;\n/POS\n{}{}{}/END\n",
        position(1, 10, 0),
        position(2, 0, 10),
        position(3, -10, 0)
    );
    for (name, text) in [("a.src", krl.to_string()), ("a.mod", rapid), ("a.ls", ls)] {
        let path = read(name, &text)?;
        let all = positions(&path);
        assert_eq!((all[0], all[all.len() - 1]), ([10.0, 0.0, 0.0], [-10.0, 0.0, 0.0]), "{name}");
        assert!(all.contains(&[0.0, 10.0, 0.0]), "{name} misses its point on the way");
        let off = all.iter().map(|p| (p[0].hypot(p[1]) - 10.0).abs()).fold(0.0, f64::max);
        assert!(off < 1e-6 && all.iter().all(|p| p[1] > -1e-6), "{name}: {off}");
    }
    Ok(())
}

#[test]
fn the_frames_of_a_program_are_held_against_the_cell() -> Check {
    let krl = |base: &str, tool: &str| format!("$BASE={base}\n$TOOL={tool}\nLIN {POINT}\n");
    let (base, tool) = ("{X 1500.5,Y -200,Z 612.25,A 35,B -20,C 10}", "{X 0,Y 0,Z 300,A 0,B 0,C 0}");
    assert!(read("a.src", &krl(base, tool))?.findings.is_empty());
    let high = read("a.src", &krl("{X 1500.5,Y -200,Z 1112.25,A 35,B -20,C 10}", tool))?;
    assert_eq!(codes(&high), ["program-frame"]);
    insta::assert_snapshot!(high.findings[0].sentence, @"The base $BASE (line 1) of the program lies 500.0 mm and 0.00° from the workpiece frame of the cell ([work] workpiece_mm): the robot goes elsewhere than the cell says.");
    let point = "[[0,0,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]";
    let rapid = |tool: &str, objects: &str| {
        format!("PERS tooldata t:=[TRUE,[{tool},[1,0,0,0]],[5,[0,0,50],[1,0,0,0],0,0,0]];\n{objects}")
    };
    let world = format!("MoveL {point},v50,z1,t;\n");
    let world = read("a.mod", &rapid("[0,0,310]", &world))?;
    // Without a work object the path lies in the base frame, and the cell's does not.
    assert_eq!(codes(&world), ["program-frame", "program-frame"]);
    let two = format!("MoveL {point},v50,z1,t\\WObj:=a;\nMoveL {point},v50,z1,t\\WObj:=b;\n");
    assert_eq!(codes(&read("a.mod", &rapid("[0,0,300]", &two))?), ["program-frames", "frame-unknown"]);
    Ok(())
}

#[test]
fn points_belong_to_the_feature_that_is_named_before_them() -> Check {
    let names = |read: &ReadPath| -> Vec<String> {
        let names = stated(read).into_iter().map(|point| point.feature.unwrap_or_default().to_string());
        names.collect()
    };
    let clsf = "GOTO/0,0,0\nTOOL PATH/POCKET_1,TOOL,T1\nGOTO/1,0,0\nEND-OF-PATH\nTOOL PATH/SLOT\nGOTO/2,0,0\n";
    assert_eq!(names(&read("a.cls", clsf)?), ["", "POCKET_1", "SLOT"]);
    let gcode = "O1 (ALL)\nG1 X0 Y0 Z0\n( 2D Pocket1 )\nX1 (along)\n; slot\nX2\n";
    assert_eq!(names(&read("a.nc", gcode)?), ["ALL", "2D Pocket1", "slot"]);
    let point = "[[0,0,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]";
    let rapid = format!("PROC one()\nMoveL {point},v50,z1,t;\nENDPROC\nPROC two()\nMoveL {point},v50,z1,t;\nENDPROC\n");
    assert_eq!(names(&read("a.mod", &rapid)?), ["one", "two"]);
    let cell = cell_with("");
    let table = "x_mm,y_mm,z_mm,axis_x,axis_y,axis_z,feature\n0,0,0,0,0,-1,slot\n1,0,0,0,0,-1,\n";
    let table = read_path(table.as_bytes(), "a.csv", &cell, None)?;
    let features: Vec<Option<&str>> = table.points.iter().map(|point| point.feature.as_deref()).collect();
    assert_eq!(features, [Some("slot"), None]);
    let text = write_path(&table.format, &table.points)?;
    assert_eq!(read_path(text.as_bytes(), "a.csv", &cell, None)?, table);
    Ok(())
}

#[test]
fn points_that_a_program_sets_itself_are_said() -> Check {
    let dat = "DECL E6POS XP1={X 0,Y 0,Z 50,A 0,B 0,C 180}\n";
    let kind = Kind::Robot(Language::Krl);
    let with = |line: &str| {
        let text = format!("LDAT_ACT=LCPDAT1\n$BWDSTART=FALSE\n{line}\nLIN XP1 C_DIS\n");
        let companion = Some(("a.dat", dat.as_bytes()));
        read_tool_path(kind, ("a.src", text.as_bytes()), companion, &cell_with(""))
    };
    // What KUKA's own forms set moves no point.
    assert!(with("XP2.X = 60")?.findings.is_empty());
    for line in ["XP1.X = 60", "XP1={X 1,Y 2,Z 3,A 90,B 0,C 180}"] {
        assert_eq!(codes(&with(line)?), ["point-assigned"], "{line}");
    }
    let point = "[[0,0,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]";
    let rapid = format!("CONST robtarget p1:={point};\np1.trans.x:=60;\nMoveL p1,v50,z1,t;\n");
    assert!(codes(&read("a.mod", &rapid)?).contains(&"point-assigned"));
    Ok(())
}

#[test]
fn ways_through_a_program_are_not_followed() -> Check {
    let path = read("a.src", &format!("FOR i=1 TO 3\nLIN {POINT}\nENDFOR\n"))?;
    assert_eq!(codes(&path), ["not-followed"]);
    Ok(())
}
