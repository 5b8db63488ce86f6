//! A corrected path is the same program with other numbers, and leads where it was commanded.

use super::{Check, apart, axes, cell_with, commanded, moved, on_workpiece, positions, read, stated};
use nalgebra::Vector3;
use proptest::prelude::*;
use stiffarm::Code;
use stiffarm::model::path::PathPoint;
use stiffarm_files::program::Language;
use stiffarm_files::tool_path::{Kind, ReadPath, WrittenPath, read_tool_path};

/// Programs with modal words, comments, arcs and odd layout.
const PROGRAMS: [(&str, &str); 6] = [
    (
        "a.nc",
        "%\nN10 G21 G90 G54 (set up)\nN20 G0 X0. Y0. Z40.\nN30 G1 Z-1.25 F300\nN40 X   40.5 ; along\nN50 Y20\nN60 G2 X60.5 Y0. R20. F200\n\
         N70 X80.5 Y-20. I20. J0. (on)\nN80 G1 X50 Z-2\nG0 Z50\nN90 M30\n%\n",
    ),
    ("a.mpf", "TRAORI\r\nG1 X1 Y2 Z3 A3=0 B3=0 C3=1 F100\r\nX4\r\nY5 A3=0.1\r\nX9 Z-1 A3=0.2 B3=0.1 C3=0.9\r\nM30\r\n"),
    (
        "a.cls",
        "TOOL PATH/A,TOOL,T1\nRAPID\nGOTO/0.0000,0.0000,40.0000,0.1,0.0,0.9949874\nGOTO/0.0000,0.0000,0.0000\nGOTO/10.0000,0.0000,0.0000\n\
         CIRCLE/20.0,0.0,0.0,0.0,0.0,1.0,10.0,0.06,0.5\nGOTO/20.0,10.0,0.0\nGOTO / 30.0, 10.0, 0.0, 0, 0.2, 0.9797959  $$ end\nEND-OF-PATH\n",
    ),
    (
        "a.src",
        "DEF a ( )\r\n;FOLD LIN P1\r\nLIN {X 10,Y 20.5,Z 30,A 0,B 90,C 180,S 2,T 35} C_DIS\r\nLIN {X 20} C_DIS\r\nLIN {Y 30,Z 31,B 89.5}\r\n\
         CIRC {X 30,Y 40,Z 31,A 10,B 80,C 170},{X 40,Y 30,Z 31,A 10,B 80,C 170}\r\nEND\r\n",
    ),
    (
        "a.mod",
        "MODULE a\n  CONST robtarget p1:=[[1,2,3],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n  PROC main()\n    MoveL p1,v50,z1,t\\WObj:=w;\n\
             MoveL [[4.5,2,3],[0,0.999962,0.008727,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v50,z1,t\\WObj:=w;\n  ENDPROC\nENDMODULE\n",
    ),
    (
        "a.ls",
        "/PROG  A\n/MN\n   1:L P[1] 50mm/sec CNT100 ;\n   2:L P[2] 50mm/sec CNT100 ;\n/POS\n\
         P[1]{\n   GP1:\n\tUF : 1, UT : 1,\t\tCONFIG : 'N U T, 0, 0, 0',\n\tX =    10.000  mm,\tY =   -39.998  mm,\tZ =     0.000  mm,\n\
         \tW =   180.000 deg,\tP =     0.000 deg,\tR =     0.000 deg\n};\n\
         P[2]{\n   GP1:\n\tUF : 1, UT : 1,\t\tCONFIG : 'N U T, 0, 0, 0',\n\tX =    20.000  mm,\tY =     0.000  mm,\tZ =     5.000  mm,\n\
         \tW =  -179.999 deg,\tP =     1.000 deg,\tR =    30.000 deg\n};\n/END\n",
    ),
];

fn write(path: &ReadPath, commanded: &[PathPoint]) -> stiffarm::Result<WrittenPath> {
    path.program.write(&path.points, commanded)
}

fn text(written: &WrittenPath) -> String {
    String::from_utf8(written.files[0].1.clone()).unwrap()
}

#[test]
fn where_nothing_moves_the_bytes_are_the_same() -> Check {
    for (name, program) in PROGRAMS {
        let path = read(name, program)?;
        // What an equilibrium leaves of nothing.
        let still = |point: &PathPoint| moved(point, Vector3::repeat(1e-10), Vector3::repeat(1e-13));
        let commanded: Vec<PathPoint> = path.points.iter().map(still).collect();
        assert_eq!(text(&write(&path, &commanded)?), program, "{name}");
        assert_eq!(text(&write(&path, &path.points)?), program, "{name}");
    }
    Ok(())
}

/// Decimals that the languages write: lengths \[m\], orientations \[rad\].
fn precision(name: &str) -> (f64, f64) {
    match name {
        "a.ls" => (2e-6, 3e-5),
        "a.src" => (2e-7, 6e-7),
        _ => (2e-7, 1e-7),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    /// A control that reads the written program goes where it was commanded to, modal words, inserted
    /// numbers and straightened arcs included.
    #[test]
    fn what_is_written_leads_to_what_is_commanded(
        shifts in prop::collection::vec((-0.4..0.4_f64, -0.4..0.4_f64, -0.4..0.4_f64), 8),
        turns in prop::collection::vec((-2e-3..2e-3_f64, -2e-3..2e-3_f64), 8),
        still in prop::collection::vec(any::<bool>(), 8),
    ) {
        for (name, program) in PROGRAMS {
            let path = read(name, program).unwrap();
            let holds_axes = !name.ends_with(".nc");
            let is_still = |k: usize, point: &PathPoint| still[k % 8] || point.rapid;
            let shift = |k: usize, point: &PathPoint| if is_still(k, point) {
                Vector3::zeros()
            } else {
                Vector3::new(shifts[k % 8].0, shifts[k % 8].1, shifts[k % 8].2)
            };
            let turn = |k: usize, point: &PathPoint| if is_still(k, point) || !holds_axes {
                Vector3::zeros()
            } else {
                Vector3::new(turns[k % 8].0, turns[k % 8].1, 0.0)
            };
            let commanded = commanded(&path, shift, turn);
            let text = text(&write(&path, &commanded).unwrap());
            let again = read(name, &text).unwrap();
            if text == program {
                continue;
            }
            // The arcs that straight moves stand for.
            let arcs: &[usize] = match name {
                "a.nc" => &[7, 8],
                "a.cls" => &[7],
                _ => &[],
            };
            let of = |path: &ReadPath, points: &[PathPoint], arcs: &[usize]| -> Vec<PathPoint> {
                let points = points.iter().enumerate();
                let is_on_arc = |point: &PathPoint| point.line.is_some_and(|line| arcs.contains(&line));
                // Rapid moves leave out what they left out.
                let points = points.filter(|(i, point)| !point.rapid && (path.program.holds(*i) || is_on_arc(point)));
                points.map(|(_, point)| point.clone()).collect()
            };
            let (wanted, driven) = (of(&path, &commanded, arcs), of(&again, &again.points, &[]));
            let (position, angle) = apart(&driven, &wanted);
            let (length, turn) = precision(name);
            prop_assert!(position < length && angle < turn, "{name}: {position} m, {angle} rad\n{text}");
        }
    }
}

#[test]
fn lines_comments_and_columns_stay() -> Check {
    let mut shown = String::new();
    for (name, program) in PROGRAMS {
        let path = read(name, program)?;
        let written = text(&write(&path, &corrected(&path, Vector3::x(), |_| 0.25))?);
        let lines = written.lines().zip(1..);
        let long = lines.filter(|(line, number)| *number < 12 || line.len() > 60);
        shown += &format!("== {name}\n");
        shown.extend(long.take(24).map(|(line, _)| format!("{line}\n")));
    }
    insta::assert_snapshot!(shown);
    Ok(())
}

#[test]
fn a_point_of_two_moves_cannot_have_two_corrections() -> Check {
    let text = "CONST robtarget p1:=[[1,2,3],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n\
                CONST robtarget p2:=[[9,2,3],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n\
                MoveL p1,v50,z1,t\\WObj:=w;\nMoveL p2,v50,z1,t\\WObj:=w;\nMoveL p1,v50,z1,t\\WObj:=w;\n";
    let path = read("a.mod", text)?;
    let all = |shifts: [f64; 3]| -> Vec<PathPoint> {
        let shift = |k: usize, _: &PathPoint| Vector3::new(shifts[k], 0.0, 0.0);
        commanded(&path, shift, |_, _| Vector3::zeros())
    };
    assert!(write(&path, &all([0.1, 0.3, 0.1])).is_ok());
    for shifts in [[0.1, 0.3, 0.2], [0.1, 0.3, 0.0], [0.0, 0.3, 0.1]] {
        let error = write(&path, &all(shifts)).unwrap_err();
        assert_eq!((error.code(), error.place().line), (Code::Conflict, Some(1)));
    }
    Ok(())
}

#[test]
fn bytes_that_are_no_utf_8_stay() -> Check {
    let bytes = b"; Fr\xe4sen\r\nLIN {X 10,Y 20,Z 30,A 0,B 0,C 180}\r\n";
    let kind = Kind::Robot(Language::Krl);
    let path = read_tool_path(kind, ("a.src", bytes), None, &cell_with(""))?;
    assert_eq!(write(&path, &path.points)?.files[0].1, bytes);
    Ok(())
}

#[test]
fn points_in_the_second_file_are_written_there() -> Check {
    let src = "LIN XP1 C_DIS\nLIN {X 20,Y 0,Z 50,A 0,B 0,C 180}\n";
    let dat = "DECL E6POS XP1={X 0,Y 0,Z 50,A 0,B 0,C 180,S 2,T 35}\n";
    let kind = Kind::Robot(Language::Krl);
    let companion = Some(("a.dat", dat.as_bytes()));
    let path = read_tool_path(kind, ("a.src", src.as_bytes()), companion, &cell_with(""))?;
    let up = cell_with("").work.workpiece.rotation * Vector3::new(0.0, 0.0, 0.5);
    let commanded: Vec<PathPoint> = path.points.iter().map(|point| moved(point, up, Vector3::zeros())).collect();
    let files = write(&path, &commanded)?.files;
    assert_eq!(String::from_utf8_lossy(&files[0].1), src.replace("Z 50", "Z 50.5000"));
    assert_eq!(String::from_utf8_lossy(&files[1].1), dat.replace("Z 50", "Z 50.5000"));
    Ok(())
}

#[test]
fn what_has_no_tool_axis_says_what_is_left() -> Check {
    let path = read("a.nc", "G90 G0 X0 Y0 Z5\nG1 Z0\nX10\n")?;
    let tilted: Vec<PathPoint> =
        path.points.iter().map(|p| moved(p, Vector3::zeros(), Vector3::new(0.001, 0.0, 0.0))).collect();
    let written = write(&path, &tilted)?;
    assert_eq!(text(&written), "G90 G0 X0 Y0 Z5\nG1 Z0\nX10\n");
    assert!((written.tilt_left - 0.001 * axes(&path.points)[0].cross(&Vector3::x()).norm()).abs() < 2e-4);
    let [finding] = &written.findings()[..] else {
        panic!("{:?}", written.findings());
    };
    assert_eq!(finding.code, "tilt-left");
    insta::assert_snapshot!(finding.sentence, @"The program holds no tool axis that could be corrected: positions are, and the tool stays tilted by up to 0.056°.");
    Ok(())
}

#[test]
fn steps_and_other_paths_are_not_written() -> Check {
    let path = read("a.nc", "G90 G0 X0 Y0 Z5\nG91 G1 X1\n")?;
    let error = write(&path, &path.points).unwrap_err();
    assert_eq!((error.code(), error.place().line), (Code::Unsupported, Some(2)));
    assert_eq!(stated(&path).len(), 2);
    let error = write(&path, &path.points[..1]).unwrap_err();
    assert_eq!(error.code(), Code::Dimension);
    Ok(())
}

/// Corrections \[mm\] along a direction of the workpiece, by x of the point \[mm\].
fn corrected(path: &ReadPath, along: Vector3<f64>, correction: impl Fn(f64) -> f64) -> Vec<PathPoint> {
    let along = cell_with("").work.workpiece.rotation * along;
    let points = path.points.iter().map(|point| {
        if point.rapid {
            point.clone()
        } else {
            moved(point, along * correction(on_workpiece(point).0.x), Vector3::zeros())
        }
    });
    points.collect()
}

#[test]
fn long_moves_get_points_where_their_correction_bends() -> Check {
    let program = "N1 G90 G0 X0 Y0 Z5\nN2 G1 Z0 F100\nN3 X1000 F200 (along)\nN4 G0 Z5\n";
    let path = read("a.nc", program)?;
    // In parts of 50 mm at most, and a millimetre from the ends.
    assert_eq!(path.points.len(), 25);
    let line = corrected(&path, Vector3::z(), |x| 0.1 + 3e-4 * x);
    let expected = "N1 G90 G0 X0 Y0 Z5\nN2 G1 Z0.1000 F100\nN3 X1000 Z0.4000 F200 (along)\nN4 G0 Z5\n";
    assert_eq!(text(&write(&path, &line)?), expected);
    let parabola = |x: f64| 0.4 * (1.0 - (x / 500.0 - 1.0).powi(2));
    let written = text(&write(&path, &corrected(&path, Vector3::z(), parabola))?);
    let again = read("a.nc", &written)?;
    let added = written.lines().count() - program.lines().count();
    assert!((3..10).contains(&added), "{written}");
    // Between its points too it is where it was commanded to be.
    for [x, _, z] in positions(&again).into_iter().filter(|p| p[2] < 4.0) {
        assert!((z - parabola(x)).abs() < 0.0102, "{x} {z}\n{written}");
    }
    insta::assert_snapshot!(written, @"
    N1 G90 G0 X0 Y0 Z5
    N2 G1 Z0 F100
    N3 G1 X150.0000 Y0.0000 Z0.2040 F200
    G1 X250.0000 Y0.0000 Z0.3000
    G1 X350.0000 Y0.0000 Z0.3640
    G1 X500.0000 Y0.0000 Z0.4000
    G1 X600.0000 Y0.0000 Z0.3840
    G1 X750.0000 Y0.0000 Z0.3000
    G1 X900.0000 Y0.0000 Z0.1440
    G1 X1000.0000 Y0.0000 Z0.0000 (along)
    N4 G0 Z5
    ");
    Ok(())
}

#[test]
fn robots_say_where_a_long_move_would_need_points() -> Check {
    let program = "LIN {X 0,Y 0,Z 0,A 0,B 0,C 180}\nLIN {X 1000,Y 0,Z 0,A 0,B 0,C 180}\n";
    let path = read("a.src", program)?;
    assert_eq!(path.points.len(), 23);
    let parabola = |x: f64| 0.4 * (1.0 - (x / 500.0 - 1.0).powi(2));
    let written = write(&path, &corrected(&path, Vector3::z(), parabola))?;
    assert_eq!(text(&written), program);
    assert!((written.bend_left - 0.4e-3).abs() < 1e-9);
    assert_eq!(written.findings()[0].code, "bend-left");
    assert!(write(&path, &corrected(&path, Vector3::z(), |x| 1e-3 * x))?.findings().is_empty());
    Ok(())
}

/// The written program after a correction of 0.1 mm in z of all moves at feed.
fn higher(program: &str) -> String {
    let path = read("a.nc", program).unwrap();
    text(&write(&path, &corrected(&path, Vector3::z(), |_| 0.1)).unwrap())
}

/// F of G93 is the inverse of the whole move's time: the times of the pieces of an arc add up to it.
#[test]
fn the_pieces_of_a_move_have_their_own_inverse_times() -> Check {
    let program = "G90 G0 X10 Y0 Z0\nG93 G1 X10.5 F60\nN3 G3 X-10.5 Y0 I-10.5 J0 F2.5 (round)\nG1 X0 F30\n";
    let written = higher(program);
    let pieces: Vec<&str> = written.lines().filter(|line| line.contains("G1") && line.contains('Y')).collect();
    assert!(pieces.len() > 20, "{written}");
    let feed =
        |line: &str| -> f64 { line.split(" F").nth(1).unwrap().split_whitespace().next().unwrap().parse().unwrap() };
    let time: f64 = pieces.iter().map(|line| 1.0 / feed(line)).sum();
    assert!((time - 1.0 / 2.5).abs() < 1e-4, "{time}\n{written}");
    assert!(pieces[0].starts_with("N3 G1 X") && pieces[1].starts_with("G1 X"), "{written}");
    Ok(())
}

#[test]
fn what_stands_beside_a_divided_move_stays_where_it_counts() {
    let program = "G90 G0 X10 Y0 Z0\nG1 Z-1 F100\n/N3 G9 G3 X-10 Y0 I-10 J0 F200 M8 M0\nG1 X0\n";
    let written = higher(program);
    let pieces: Vec<&str> = written.lines().filter(|line| line.starts_with('/')).collect();
    // Every piece may be left out with the block.
    assert!(pieces.len() > 20, "{written}");
    assert!(pieces[0].starts_with("/N3 G1 X") && pieces[1].starts_with("/G1 X"), "{written}");
    // Feed and coolant count from the first on; the exact stop and the halt belong to the end of the move.
    for (k, piece) in pieces.iter().enumerate() {
        let (is_first, is_last) = (k == 0, k + 1 == pieces.len());
        assert_eq!(piece.contains(" F200 M8"), is_first, "{piece}");
        assert_eq!(piece.ends_with(" G9 M0"), is_last, "{piece}");
    }
}

#[test]
fn cycles_are_written_as_the_moves_that_they_are() {
    let program = "G90 G0 X0 Y0 Z5\nN2 G98 G82 X10 Y0 Z-3 R2 P0.5 F100 (holes)\nX20\nG80\nG0 X0\n";
    let written = higher(program);
    let expected = "G90 G0 X0 Y0 Z5\n\
        N2 G0 X10.0000 Y0.0000 Z5.0000 G98 F100\nG0 X10.0000 Y0.0000 Z2.0000\n\
        G1 X10.0000 Y0.0000 Z2.1000\nG1 X10.0000 Y0.0000 Z-2.9000\nG4 P0.5\n\
        G0 X10.0000 Y0.0000 Z5.0000 (holes)\n\
        G0 X20.0000 Y0.0000 Z5.0000\nG0 X20.0000 Y0.0000 Z2.0000\n\
        G1 X20.0000 Y0.0000 Z2.1000\nG1 X20.0000 Y0.0000 Z-2.9000\nG4 P0.5\nG0 X20.0000 Y0.0000 Z5.0000\n\
        G80\nG0 X0\n";
    assert_eq!(written, expected);
    // The correction is there where the feed begins: a hole that is corrected aside stays straight.
    let path = read("a.nc", program).unwrap();
    let aside = text(&write(&path, &corrected(&path, Vector3::x(), |_| 0.3)).unwrap());
    let feeds: Vec<&str> = aside.lines().filter(|line| line.starts_with("G1 X10")).collect();
    assert_eq!(feeds, ["G1 X10.3000 Y0.0000 Z2.0000", "G1 X10.3000 Y0.0000 Z-3.0000"]);
    let again = read("a.nc", &written).unwrap();
    assert!(positions(&again).contains(&[20.0, 0.0, -2.9]));
}
