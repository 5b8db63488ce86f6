//! CL data is read as each CAM system means it: senses of arcs, units, frames, and words that move the tool.

use super::{Check, axes, cell_with, codes, commanded, moved, positions, read, rounded, stated};
use crate::common::cases::slip;
use nalgebra::Vector3;
use stiffarm::findings::Severity;
use stiffarm::model::path::PathTarget;
use stiffarm_files::tool_path::ReadPath;

/// Quarter turns about the origin that a sense has to be chosen for, with what stands before and behind.
fn quarter(head: &str, circle: &str, z: &str) -> String {
    format!("{head}GOTO/15,-20,{z}\nGOTO/15,0,{z}\nCIRCLE/{circle}\nGOTO/0,15,{z}\nGOTO/-20,15,{z}\n")
}

/// The angle that the points go round the z axis \[deg\].
fn swept(path: &ReadPath) -> f64 {
    let angles: Vec<f64> = positions(path).iter().map(|p| p[1].atan2(p[0])).collect();
    let turn = |pair: &[f64]| {
        (pair[1] - pair[0] + 9.0 * std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
    };
    angles.windows(2).map(turn).sum::<f64>().to_degrees()
}

fn farthest(path: &ReadPath) -> f64 {
    let lengths = positions(path).into_iter().map(|p| p[0].hypot(p[1]));
    lengths.fold(0.0, f64::max)
}

/// The severity of a finding, if there is one.
fn severity(path: &ReadPath, code: &str) -> Option<Severity> {
    let first = path.findings.iter().find(|finding| finding.code.as_str() == code);
    first.map(|finding| finding.severity)
}

fn sentence(path: &ReadPath, code: &str) -> String {
    let first = path.findings.iter().find(|finding| finding.code.as_str() == code);
    first.map_or_else(String::new, |finding| finding.sentence.to_string())
}

#[test]
fn arcs_run_as_the_system_that_wrote_them_has_them() -> Check {
    let creo = "$$*         Pro/CLfile  Version 11.0\n$$-> MFGNO / A\nUNITS / MM\n";
    let nx = "UNITS/MM\nTOOL PATH/A,TOOL,B\nTLDATA/MILL,10,0,75,0,0\n";
    // With the straight moves beside it each is the short way round.
    for (name, head, circle) in [
        ("a.ncl", "UNITS / MM\n", "0,0,-2, $\n 0,0,1, 15"),
        ("OP010.NCL.12", "UNITS / MM\n", "0,0,-2,0,0,1,15"),
        ("a.cl", creo, "0,0,-2,0,0,1,15"),
        ("a.apt", "UNIT/MM\n", "0,0,-2,0,0,1."),
        ("a.cls", nx, "0,0,-2,0,0,-1,15,0.06,0.5,10,0"),
        ("a.cls", nx, "0,0,-2,0,0,-1,15"),
        ("a.apt", "UNITS/MM\n", "0,0,-2,0,0,-1,15,0.06,0.5,10,0"),
        // An unknown system: the straight moves beside it tell.
        ("a.apt", "UNITS/MM\n", "0,0,-2,0,0,1,15"),
        ("a.apt", "UNITS/MM\n", "0,0,-2,0,0,-1,15"),
    ] {
        let path = read(name, &quarter(head, circle, "-2"))?;
        let turn = swept(&path);
        // From -53.13° to 143.13°.
        assert!((turn - 196.26).abs() < 0.01, "{name} {head} {circle}: {turn}");
        assert!(farthest(&path) < 25.1);
        assert!(codes(&path).is_empty(), "{name} {circle}: {:?}", codes(&path));
        assert!(positions(&path).iter().all(|p| p[0] < 15.001 && p[1] < 15.001));
    }
    Ok(())
}

#[test]
fn an_arc_that_runs_against_the_moves_beside_it_is_said() -> Check {
    let mut said = String::new();
    for (name, circle) in
        [("a.ncl", "0,0,0,0,0,-1,15"), ("a.cls", "0,0,0,0,0,1,15,0.06,0.5,10,0"), ("a.apt", "0,0,0,0,0,-1")]
    {
        let path = read(name, &quarter("UNITS/MM\n", circle, "0"))?;
        assert_eq!(codes(&path), ["arc-sense"], "{name}");
        said += &format!("{name} {circle}: {}\n", sentence(&path, "arc-sense"));
        // As the system has it, and not as the moves beside it.
        assert!(positions(&path).iter().any(|p| p[1] < -14.9 && p[0].abs() < 1.0));
    }
    insta::assert_snapshot!(said, @"
    a.ncl 0,0,0,0,0,-1,15: An arc (line 5) would go on smoothly from and to the straight moves beside it if it ran the other way round. It is read as the other arcs of the file: look at its points.
    a.cls 0,0,0,0,0,1,15,0.06,0.5,10,0: An arc (line 5) would go on smoothly from and to the straight moves beside it if it ran the other way round. It is read as the other arcs of the file: look at its points.
    a.apt 0,0,0,0,0,-1: An arc (line 5) would go on smoothly from and to the straight moves beside it if it ran the other way round. It is read as the other arcs of the file: look at its points.
    ");
    let alone = "UNITS/MM\nGOTO/15,0,9\nGOTO/15,0,0\nCIRCLE/0,0,0,0,0,1,15\nGOTO/0,15,0\nRAPID\nGOTO/0,15,9\n";
    let path = read("a.apt", alone)?;
    assert_eq!(severity(&path, "arc-sense-assumed"), Some(Severity::Caution));
    assert!((swept(&path) - 90.0).abs() < 1e-6);
    assert!(codes(&read("a.ncl", alone)?).is_empty());
    Ok(())
}

#[test]
fn points_on_the_way_of_an_arc_are_passed_on_it() -> Check {
    let body = "GOTO/15,0,0\nCIRCLE/0,0,0,0,0,1,15\nGOTO/7.5,12.990381057,0\nGOTO/-7.5,12.990381057,0\nGOTO/-15,0,0\nFEDRAT/100,MMPM\nGOTO/15,0,0\n";
    let creo = read("a.ncl", &format!("UNITS/MM\n{body}"))?;
    let off = |path: &ReadPath| {
        let all = positions(path);
        let behind = all.iter().take_while(|p| p[0] > -14.999);
        behind.map(|p| (p[0].hypot(p[1]) - 15.0).abs()).fold(0.0, f64::max)
    };
    assert!(off(&creo) < 1e-6);
    assert!(codes(&creo).is_empty());
    // The last move is behind another statement: it is straight.
    assert!(positions(&creo).iter().any(|p| p[1].abs() < 1e-9 && p[0].abs() < 14.5));
    // Of an unknown system they are straight moves, which is said.
    let other = read("a.apt", &format!("UNITS/MM\n{body}"))?;
    assert!(off(&other) > 0.4);
    assert_eq!(severity(&other, "arc-goes-on"), Some(Severity::Caution));
    // A chord that closes a half circle looks the same.
    let half = "UNITS/MM\nGOTO/15,0,0\nCIRCLE/0,0,0,0,0,1,15\nGOTO/-15,0,0\nGOTO/15,0,0\n";
    assert_eq!(codes(&read("a.ncl", half)?), ["arc-goes-on"]);
    Ok(())
}

/// From (15, 0, -2) to what ends the circle of 15 mm about the origin.
fn apt(direction: &str, circle: &str, stop: &str) -> String {
    format!(
        "UNITS/MM\nTLAXIS/ 0.000000, 0.000000, 1.000000\nAUTOPS\nGOTO  /   15.00000,    0.00000,   -2.00000\nINDIRV/ {direction}\nTLON,GOFWD/ ({circle}),ON,{stop}\nGOTO  /   20.0, 20.0,  -2.0\n"
    )
}

#[test]
fn arcs_of_apt_set_out_as_their_direction_says() -> Check {
    let circle = "CIRCLE/      0.00000,      0.00000,     -2.00000,$\n     15.00000";
    let line = |end: &str| format!("(LINE/ 0.0, 0.0, -2.0,$\n    {end}, -2.0)");
    let cylinder =
        "PLANE/PERPTO,$\n(PLANE/(POINT/0,0,-2),PERPTO,$\n(VECTOR/0,0,1)),$\n(POINT/0,0,-2),$\n(POINT/0,15,-2)";
    for (direction, circle, stop, turn) in [
        ("0,1,0", circle, line("0.0, 15.0"), 90.0),
        ("0,-1,0", circle, format!("2,INTOF,$\n{}", line("0.0, 15.0")), -270.0),
        ("0,-1,0", circle, line("-15.0, 0.0"), -180.0),
        ("0,1,0", circle, format!("2,INTOF,{}", line("15.0, 0.0")), 360.0),
        ("0,1,0", "CIRCLE/CANON,0,0,-2,0,0,1,15", line("0.0, 15.0"), 90.0),
        ("0,-1,0", "CYLNDR/0,0,-2,0,0,1,15", format!("2,INTOF,({cylinder})"), -270.0),
        ("0,1,0", "CYLNDR/0,0,-2,0,0,-1,15", format!("({cylinder})"), 90.0),
        ("0,1,0", "CIRCLE/0,0,-2,15", "(PLANE/0,1,0,15)".to_string(), 90.0),
        ("0,1,0", "CIRCLE/0,0,-2,15", "2,INTOF,(PLANE/1,0,0,-7.5)".to_string(), 240.0),
    ] {
        let text = apt(direction, circle, &stop);
        let path = read("a.aptsource", &text).map_err(|error| format!("{text}\n{error}"))?;
        let arc: Vec<[f64; 3]> = positions(&path);
        let arc: Vec<&[f64; 3]> = arc.iter().filter(|p| (p[0].hypot(p[1]) - 15.0).abs() < 1e-6).collect();
        let angle = |p: &[f64; 3]| p[1].atan2(p[0]);
        let turned = arc.windows(2).map(|pair| {
            let by = angle(pair[1]) - angle(pair[0]);
            (by + 3.0 * std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
        });
        let turned = turned.sum::<f64>().to_degrees();
        assert!((turned - turn).abs() < 1e-3, "{text}: {turned}");
        assert!(arc.len() > 20 && arc.iter().all(|p| (p[2] + 2.0).abs() < 1e-9));
        assert!(codes(&path).is_empty(), "{:?}", codes(&path));
        let last = *axes(&stated(&path)).last().unwrap();
        assert!((last - Vector3::z()).norm() < 1e-12);
    }
    // Creo writes it in three lines, INDIRP names a point.
    let creo = "UNITS/MM\nGOTO / 15, 0, 0\nINDIRP / 15, 7, 0\nTLON\nGOFWD / (CIRCLE / 0, 0, 0, $\n 15), ON, (LINE / 0, 0, 0, 0, 15, 0)\n";
    assert_eq!(positions(&read("a.ncl", creo)?).last(), Some(&[0.0, 15.0, 0.0]));
    Ok(())
}

#[test]
fn what_an_arc_leaves_open_is_refused() {
    let circle = "CIRCLE/0,0,-2,15";
    let line = "(LINE/0,0,-2,0,15,-2)";
    let mut report = String::new();
    for text in [
        apt("1,0,0", circle, line),
        apt("0,1,0", "CIRCLE/0,0,-2,14", line),
        apt("0,-1,0", circle, line),
        apt("0,1,0", circle, "(PLANE/0,1,0,40)"),
        apt("0,1,0", circle, "3,INTOF,(PLANE/0,1,0,5)"),
        apt("0,1,0", "CONE/0,0,-2,15", line),
        apt("0,1,0", circle, "TO,(LINE/0,0,-2,0,15,-2)"),
        "CIRCLE/0,0,0,0,0,1,15\nGOTO/15,0,0\n".to_string(),
        "GOTO/15,0,0\nGOHOME\nCIRCLE/0,0,0,0,0,1,15\nGOTO/15,0,0\n".to_string(),
        "GOTO/15,0,0\nTLON,GOFWD/(CIRCLE/0,0,0,15),ON,(LINE/0,0,0,0,15,0)\n".to_string(),
        "GOTO/15,0,0\nINDIRV/0,1,0\nGOTO/1,2,3\n".to_string(),
        "GOTO/15,0,0\nINDIRV/0,1,0\nTLLFT,GOFWD/(CIRCLE/0,0,0,15),ON,(LINE/0,0,0,0,15,0)\n".to_string(),
    ] {
        let error = read("a.apt", &text).unwrap_err();
        assert!(error.place().line.is_some() && error.hint_text().is_some(), "{text}");
        report += &slip::<()>(text.trim_end(), Err(error));
    }
    insta::assert_snapshot!("arcs_that_are_left_open", report);
}

#[test]
fn arcs_of_apt_are_written_as_straight_moves() -> Check {
    let text = apt("0,1,0", "CIRCLE/0,0,-2,$\n15", "(LINE/0,0,-2, 0,15,-2)");
    let path = read("a.apt", &text)?;
    let same = path.program.write(&path.points, &path.points)?;
    assert_eq!(String::from_utf8(same.files[0].1.clone())?, text);
    let up: Vec<_> = path
        .points
        .iter()
        .map(|point| moved(point, cell_with("").work.workpiece.rotation * Vector3::z(), Vector3::zeros()))
        .collect();
    let written = path.program.write(&path.points, &up)?;
    let written = String::from_utf8(written.files[0].1.clone())?;
    // The lines that are no points: neither TLON nor INDIRV.
    let words: Vec<&str> = written.lines().filter(|line| !line.starts_with("GOTO/")).collect();
    insta::assert_snapshot!(words.join("\n"), @"
    UNITS/MM
    TLAXIS/ 0.000000, 0.000000, 1.000000
    AUTOPS
    GOTO  /   15.00000,    0.00000,   -1.00000
    GOTO  /   20.0, 20.0, -1.0000
    ");
    let again = read("a.apt", &written)?;
    let end = |path: &ReadPath| positions(path).into_iter().find(|p| p[1] == 15.0).unwrap();
    assert_eq!(end(&again), [0.0, 15.0, -1.0]);
    Ok(())
}

#[test]
fn units_are_those_that_the_file_names() -> Check {
    for (head, millimetres) in [
        ("UNITS/MM\n", 1.0),
        ("UNIT/MM\n", 1.0),
        ("UNITS / MM\n", 1.0),
        ("UNITS/INCH\n", 25.4),
        ("UNIT/INCH\n", 25.4),
        ("UNITS / INCHES\n", 25.4),
        ("UNITS/INCHES\nFEDRAT/10,MMPM\n", 25.4),
        ("UNITS/MM\nFEDRAT/10,IPM\n", 1.0),
    ] {
        let path = read("a.apt", &format!("{head}GOTO/1,0,2\nGOTO/2,0,2\n"))?;
        assert_eq!(positions(&path)[0], [millimetres, 0.0, 2.0 * millimetres], "{head}");
        assert!(codes(&path).is_empty(), "{head}: {:?}", codes(&path));
    }
    let mut report = String::new();
    for head in ["UNITS/CM", "UNITS/METER", "UNIT/FEET", "UNITS/MM,INCH", "UNITS"] {
        report += &slip(head, read("a.apt", &format!("{head}\nGOTO/1,0,2\n")));
    }
    insta::assert_snapshot!("units_of_cl_data", report);
    Ok(())
}

#[test]
fn feeds_in_inches_say_the_unit_that_a_file_leaves_out() -> Check {
    let of = |feeds: &str| read("a.cls", &format!("TOOL PATH/A,TOOL,B\nRAPID\nGOTO/1,0,2\n{feeds}GOTO/2,0,2\n"));
    let mut said = String::new();
    for feeds in ["FEDRAT/IPM,10.0\n", "FEDRAT/ 0.01, IPR\n", "fedrat/10,ipm\n"] {
        let path = of(feeds)?;
        assert_eq!(positions(&path)[0], [25.4, 0.0, 50.8], "{feeds}");
        assert_eq!(severity(&path, "units-assumed"), Some(Severity::Caution));
        said += &format!("{feeds}{}\n", sentence(&path, "units-assumed"));
    }
    insta::assert_snapshot!(said, @"
    FEDRAT/IPM,10.0
    The file names no unit, and its feeds are in inches (line 4): its numbers are read as inches. `UNITS/MM` or `UNITS/INCH` at its head settles it.
    FEDRAT/ 0.01, IPR
    The file names no unit, and its feeds are in inches (line 4): its numbers are read as inches. `UNITS/MM` or `UNITS/INCH` at its head settles it.
    fedrat/10,ipm
    The file names no unit, and its feeds are in inches (line 4): its numbers are read as inches. `UNITS/MM` or `UNITS/INCH` at its head settles it.
    ");
    let metric = of("FEDRAT/MMPM,10.0\n")?;
    assert_eq!(positions(&metric)[0], [1.0, 0.0, 2.0]);
    assert_eq!(severity(&metric, "units-assumed"), Some(Severity::Note));
    let both = of("FEDRAT/MMPM,10.0\nFEDRAT/IPM,10.0\n")?;
    assert_eq!(positions(&both)[0], [1.0, 0.0, 2.0]);
    assert_eq!(severity(&both, "units-assumed"), Some(Severity::Caution));
    Ok(())
}

#[test]
fn a_correction_is_written_in_the_unit_of_the_file() -> Check {
    for text in
        ["UNIT/INCH\nGOTO/1.0,0.0,2.0\nGOTO/2.0,0.0,2.0\n", "GOTO/1.0,0.0,2.0\nFEDRAT/10.0,IPM\nGOTO/2.0,0.0,2.0\n"]
    {
        let path = read("a.cls", text)?;
        let up = cell_with("").work.workpiece.rotation * Vector3::new(0.0, 0.0, 0.43);
        let commanded = commanded(&path, |_, _| up, |_, _| Vector3::zeros());
        let written = path.program.write(&path.points, &commanded)?;
        let written = String::from_utf8(written.files[0].1.clone())?;
        // 0.43 mm are 0.0169 in.
        assert_eq!(written.lines().find(|line| line.starts_with("GOTO/")), Some("GOTO/1.0,0.0,2.016929"), "{written}");
    }
    Ok(())
}

#[test]
fn set_ups_of_camworks_count_from_one_frame() -> Check {
    // The axis of a tilted set-up is the third column of its matrix: points and axes stand in one frame.
    let text = |world: &str| {
        format!(
            "UNIT/MM\n{world}CSYS/1.,0,0,0,0,1.,0,0,0,0,1.,0\nGOTO/0,0,25.\nGOTO/0,0,0\n{world}CSYS/0,0,1.,0,1.,0,0,0,0,1.,0,0\nGOTO/120.,5,-30.,1.,0,0\nGOTO/97.5,5,-30.,1.,0,0\nCSI_SET_FLUTE_LENGTH/16.\nSETUP/START,2\nINSERT/5MM CRB 4FL 16 LOC\nINSERT/Stock Size X350. Y150. Z10.5\n"
        )
    };
    let path = read("a.apt", &text("TRNTYP/WORLD,0,0,0\n"))?;
    assert_eq!(rounded(&stated(&path)).last(), Some(&[97.5, 5.0, -30.0]));
    assert!((axes(&stated(&path)).last().unwrap() - Vector3::x()).norm() < 1e-12);
    assert_eq!(codes(&path), ["set-up"]);
    assert_eq!(severity(&path, "set-up"), Some(Severity::Note));
    let error = read("a.apt", &text("")).unwrap_err();
    assert_eq!(error.place().line, Some(5), "{error}");
    insta::assert_snapshot!(error, @"
    a.apt:5:1: The set-up changes, and from which frame its points count is not said.
      hint: `TRNTYP/WORLD,0,0,0` says that all points count from one frame; or give each set-up a file of its own
    ");
    // One set-up says nothing.
    assert!(
        codes(&read(
            "a.apt",
            "UNIT/MM\nCSYS/1.,0,0,-9.,0,1.,0,0,0,0,1.,0\nGOTO/1,0,0\nCSYS/1.,0,0,-9.,0,1.,0,0,0,0,1.,0\nGOTO/2,0,0\n"
        )?)
        .is_empty()
    );
    Ok(())
}

#[test]
fn comments_of_creo_go_on_and_their_frame_is_held() -> Check {
    let csys = |z: &str| {
        format!(
            "$$-> CSYS / 1.0, 0.0, 0.0, 0.0,  $\n            0.0, 1.0, 0.0, 0.0,  $\n            0.0, 0.0, 1.0, {z}\n"
        )
    };
    let text = |second: &str| {
        format!(
            "$$* Pro/CLfile\n$$-> MFGNO / A\nUNITS / MM\n$$-> CUTTER / 10.0\n{}GOTO / 1, 2, 3\nGOTO / 4, 2, 3\n{}GOTO / 5, 2, 3\n$$-> END /\nFINI\n",
            csys("0.0"),
            csys(second)
        )
    };
    let one = read("a.ncl", &text("0.0"))?;
    assert!(codes(&one).is_empty(), "{:?}", one.findings);
    assert_eq!(rounded(&stated(&one)).len(), 3);
    let two = read("a.ncl", &text("50.0"))?;
    assert_eq!(severity(&two, "set-up"), Some(Severity::Caution));
    insta::assert_snapshot!(sentence(&two, "set-up"), @"The frame that the file names in comments (`CSYS`) is another one (line 10): all points are read in one frame.");
    Ok(())
}

#[test]
fn steps_count_in_their_frame_and_home_is_a_rapid_move() -> Check {
    let text = "UNITS/MM\nMSYS/0,0,0,1,0,0,0,1,0\nGOTO/1,0,0\nMSYS/0,0,0,0,1,0,-1,0,0\nGOTO/1,0,0\nGODLTA/1,0,0\nGOHOME/9,0,0\nRETRCT\nGOTO/0,0,0\nGOHOME\nGOTO/0,0,0\n";
    let path = read("a.cls", text)?;
    let expected = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0], [0.0, 9.0, 0.0], [0.0; 3], [0.0; 3]];
    assert_eq!(rounded(&path.points), expected);
    let rapid: Vec<bool> = path.points.iter().map(|point| point.rapid).collect();
    assert_eq!(rapid, [false, false, false, true, false, true]);
    assert_eq!(codes(&path), ["not-followed"]);
    Ok(())
}

/// Lines that move the tool, or the points, and are not followed.
#[test]
fn words_that_move_the_tool_are_refused() {
    for line in [
        "TRANS/0,0,5",
        "ORIGIN/1,2,3",
        "ROTABL/90,CLW",
        "ROTATE/TABLE,45",
        "TRACUT/1,0,0,5,0,1,0,0,0,0,1,0",
        "TRACUT/M1",
        "COPY/1,SAME,1",
        "REFSYS/M1",
        "CALL/MAC1",
        "MAC1=MACRO/A",
        "LOOPST",
        "JUMPTO/A1",
        "SYN/G,GOTO",
        "CUTCOM/ON",
        "TLCOMP/ON,LEFT",
        "HELICAL/1,2,3,4,5,6,7,8,9,10,11,12,13,14",
        "GOLFT/L1",
        "GO/TO,L1",
        "GOTO/P1",
        "GOTO/1,2,3,P1",
        "FROM/P1",
        "GOTO/(POINT/1,2,3)",
        "1.0, 2.0, 3.0",
        "ZSURF/5",
        "TLAXIS/NORMPS",
        "TRNTYP/LOCAL,0,0,0\nCSYS/1,0,0,0,0,1,0,0,0,0,1,0\nCSYS/1,0,0,5,0,1,0,0,0,0,1,0",
    ] {
        let read = read("a.apt", &format!("UNITS/MM\nGOTO/1,0,0\n{line}\nGOTO/2,0,0\n"));
        let error = match read {
            Ok(path) => panic!("{line} is read: {:?}", path.findings),
            Err(error) => error,
        };
        assert!(error.place().line.is_some(), "{line}: {error}");
    }
}

#[test]
fn words_weigh_what_they_do_to_the_path() -> Check {
    use Severity::{Caution, Note};
    for (line, expected) in [
        ("TRANS/0,0,0", None),
        ("TRACUT/NOMORE", None),
        ("REFSYS/NOMORE", None),
        ("ROTABL/0", None),
        ("CYCLE/INIT", None),
        ("CYCLE/DRILL,FEDTO,10", Some(Caution)),
        ("CALSUB/START_PROG", Some(Caution)),
        ("PREFUN/54", Some(Caution)),
        ("SWITCH/2", Some(Caution)),
        ("INSERT/G0 G53 Z0", Some(Caution)),
        ("INSERT/[HOLDER=CN] 5.0mm JOBBER DRILL $", None),
        ("PPRINT/ GOTO $", None),
        ("PPRINT 10 $$ 20", None),
        ("PARTNO/1.5", None),
        ("CUTTER/ 10.000000,  0.000000,  5.000000,$\n         0.000000, 50.000000", None),
        ("TOOLNO/1,MILL,1,0,   14.1,$\n  100.0,100.0,,   40.0,$\n ON,,NOTE", None),
        ("MULTAX", None),
        ("RAPID$$ fast", None),
        ("P1=POINT/1,2,3", Some(Note)),
        ("HEDGEHOG/ON", Some(Note)),
        ("HEDGEHOG/1", Some(Caution)),
        ("FINI\nGOTO/9,9,9", Some(Caution)),
        ("FINI\n\n$$ the end", None),
    ] {
        let path = read("a.apt", &format!("UNITS/MM\nGOTO/1,0,0\nGOTO/1,0,1\n{line}\n"))?;
        let weight = path.findings.first().map(|finding| finding.severity);
        assert_eq!(weight, expected, "{line}: {:?}", path.findings);
        assert!(path.findings.len() < 2, "{line}");
        assert_eq!(stated(&path).len(), 2, "{line}");
    }
    // A label is no word.
    assert_eq!(stated(&read("a.apt", "UNITS/MM\nA1) GOTO/1,0,0\n")?).len(), 1);
    Ok(())
}

#[test]
fn the_axis_that_is_stated_alone_holds_for_the_points_behind_it() -> Check {
    let path = read(
        "a.aptsource",
        "UNITS/MM\nTLAXIS/ 0.0, 0.6, 0.8\nGOTO/1,0,0\nGOTO/1,0,1,0,0,1\nTLAXIS/1,0,0\nGOTO/1,0,2\n",
    )?;
    let all = axes(&stated(&path));
    let expected = [Vector3::new(0.0, 0.6, 0.8), Vector3::z(), Vector3::x()];
    assert!(all.iter().zip(expected).all(|(a, b)| (a - b).norm() < 1e-12));
    assert!(matches!(path.points[0].target, PathTarget::Axis { .. }));
    Ok(())
}
