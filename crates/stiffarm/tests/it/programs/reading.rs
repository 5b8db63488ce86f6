//! Programs that come back: what cannot be read is refused with its place, and what a pendant changed is named.

use super::{CONTROLLERS, options, written};
use stiffarm::Code;
use stiffarm::model::posture::Posture;
use stiffarm_files::program::{
    Difference, Language, Move, Program, ProgramFile, ProgramOptions, Stop, compare_moves, missing_stops,
    program_of_stops, read_program, write_program,
};

fn read(language: Language, files: &[ProgramFile]) -> stiffarm::Result<Program> {
    read_program(files, language, &options(language, 6), 6)
}

/// The files with the first `old` replaced by `new`.
fn edited(files: &[ProgramFile], old: &str, new: &str) -> Vec<ProgramFile> {
    let mut files = files.to_vec();
    let file = files.iter_mut().find(|file| file.text.contains(old)).unwrap_or_else(|| panic!("{old}"));
    file.text = file.text.replacen(old, new, 1);
    files
}

#[test]
fn faults_are_told_with_their_place() {
    let mut report = String::new();
    for (language, old, new) in [
        (Language::Krl, "A4 0.00", "A4 zero"),
        (Language::Krl, ",A6 -180.00", ""),
        (Language::Krl, "PTP XP2", "PTP XP99"),
        (Language::Krl, "PTP XP2", "LIN XP2"),
        (Language::Krl, "PTP XP2", "PTP XP2 C_PTP"),
        (Language::Rapid, "[[10.00,", "[[10,00,"),
        (Language::Rapid, "MoveAbsJ jp2", "MoveAbsJ other"),
        (Language::Rapid, "v1000,fine", "v1000,z50"),
        (Language::Rapid, "MoveAbsJ jp2", "MoveL jp2"),
        (Language::Ls, "J P[2]", "J P[77]"),
        (Language::Ls, "J P[2]", "L P[2]"),
        (Language::Ls, "FINE", "CNT50"),
        (Language::Ls, "J4=", "X ="),
        (Language::Ls, "J6=", "J5="),
        (Language::Inform, "MOVJ C00001", "MOVJ C00077"),
        (Language::Inform, "VJ=5.00", "VJ=500.00"),
        (Language::Inform, "///POSTYPE PULSE", "///POSTYPE BASE"),
        (Language::Inform, "MOVJ C00001", "MOVL C00001"),
        (Language::Pdl2, "MOVE JOINT TO {10.00, ", "MOVE JOINT TO {"),
        (Language::Pdl2, "MOVE JOINT TO {10.00", "MOVE JOINT TO pnt0001j"),
        (Language::Pdl2, "MOVE JOINT", "MOVE LINEAR"),
        (Language::Urscript, "movej([", "movej(["),
        (Language::Urscript, "movej([", "movej(p["),
        (Language::Urscript, ", v=0.0524", ", v=9.0"),
        (Language::Urscript, ", v=0.0524", ", v=0.0524, r=0.1"),
        (Language::Csv, "q1_deg", "q1"),
        (Language::Csv, ",0,45.25,", ",0,north,"),
        (Language::Csv, ",posture,p1", ",place,p1"),
    ] {
        let (_, files) = written(language);
        match read(language, &edited(&files, old, new)) {
            Ok(_) => assert_eq!(old, new, "{language:?} {old} -> {new}"),
            Err(error) => report += &format!("{error}\n"),
        }
    }
    insta::assert_snapshot!("faults_of_programs", report);
}

#[test]
fn what_a_language_cannot_hold_is_refused() {
    let mut report = String::new();
    let posture = |joints: usize| Posture { name: "p1".into(), q: vec![0.5; joints] };
    let mut refused = |language: Language, joints: usize, change: &dyn Fn(&mut Program, &mut ProgramOptions)| {
        let mut options = options(language, joints.min(7));
        let stop = Stop::new(posture(joints), "measure");
        let mut program = program_of_stops(language.name_for("plan"), vec![], &[stop], None, 10);
        change(&mut program, &mut options);
        let error = write_program(&program, language, &options).unwrap_err();
        report += &format!("{}: [{}] {error}\n", language.as_str(), error.code().as_str());
        error.code()
    };
    let nothing = |_: &mut Program, _: &mut ProgramOptions| {};
    assert_eq!(refused(Language::Urscript, 7, &nothing), Code::Unsupported);
    assert_eq!(refused(Language::Inform, 8, &nothing), Code::Unsupported);
    assert_eq!(refused(Language::Krl, 4, &nothing), Code::Unsupported);
    for language in [Language::Krl, Language::Rapid, Language::Ls, Language::Inform, Language::Pdl2] {
        assert_eq!(refused(language, 7, &|_, o| o.controller_axes = None), Code::MissingKey);
    }
    refused(Language::Krl, 7, &|_, o| o.controller_axes = Some(vec![1, 2, 3, 4, 5, 6, 6]));
    refused(Language::Inform, 6, &|_, o| o.pulses_per_degree = None);
    refused(Language::Inform, 6, &|_, o| o.pulses_per_degree = Some(vec![1000.0; 5]));
    refused(Language::Inform, 6, &|_, o| o.pulses_per_degree = Some(vec![0.0; 6]));
    refused(Language::Krl, 6, &|_, o| o.pulses_per_degree = Some(vec![1000.0; 6]));
    refused(Language::Krl, 6, &|_, o| o.tool = Some("gripper".into()));
    refused(Language::Rapid, 6, &|_, o| o.tool = Some("tool 1".into()));
    refused(Language::Urscript, 6, &|_, o| o.tool = Some("1".into()));
    refused(Language::Krl, 6, &|p, _| p.name = "a_name_of_25_characters__".into());
    refused(Language::Ls, 6, &|p, _| p.name = "small".into());
    refused(Language::Rapid, 6, &|p, _| p.name = "1st".into());
    refused(Language::Pdl2, 6, &|p, _| p.name = "Move".into());
    let first = |p: &mut Program, change: &dyn Fn(&mut Move)| {
        for step in &mut p.steps {
            if let stiffarm_files::program::Step::Move(target) = step {
                change(target);
            }
        }
    };
    assert_eq!(refused(Language::Krl, 6, &|p, _| first(p, &|m| m.q[2] = f64::NAN)), Code::NotFinite);
    refused(Language::Krl, 6, &|p, _| first(p, &|m| m.speed_percent = 0));
    let long = |p: &mut Program, _: &mut ProgramOptions| {
        let step = p.steps[1].clone();
        p.steps = vec![step; 1000];
    };
    refused(Language::Krl, 6, &long);
    insta::assert_snapshot!("refusals_of_programs", report);
}

#[test]
fn changes_at_the_pendant_are_found_and_nothing_else() {
    let mut report = String::new();
    for (language, old, new) in [
        (Language::Krl, "A3 95.50", "A3 95.75"),
        (Language::Rapid, ",95.50,", ",95.75,"),
        (Language::Ls, "95.50 deg", "95.75 deg"),
        (Language::Inform, ",-128102,", ",-128437,"),
        (Language::Pdl2, ", 95.50,", ", 95.75,"),
        (Language::Urscript, ", 1.66678944,", ", 1.67115276,"),
        (Language::Csv, ",95.5,", ",95.75,"),
    ] {
        let (program, files) = written(language);
        let planned: Vec<&Move> = program.moves().collect();
        let tolerance = 1e-3_f64.to_radians();
        let same = read(language, &files).unwrap();
        let moves: Vec<&Move> = same.moves().collect();
        assert_eq!(compare_moves(&planned, &moves, language, tolerance), []);
        let other = read(language, &edited(&files, old, new)).unwrap();
        let moves: Vec<&Move> = other.moves().collect();
        let differences = compare_moves(&planned, &moves, language, tolerance);
        let [Difference::Angle { posture, joint: 3, planned_deg, found_deg }] = &differences[..] else {
            panic!("{language:?} {differences:?}");
        };
        assert_eq!(posture, "p1");
        assert!((planned_deg - 95.5).abs() < 1e-9 && (found_deg - 95.75).abs() < 1e-3, "{language:?} {found_deg}");
        let sentence = differences[0].sentence(&["a".into(), "b".into(), "joint 3".into()]);
        report += &format!("{}: {sentence}\n", language.as_str());
    }
    insta::assert_snapshot!(report, @"
    krl: p1: joint 3 at 95.7500°, planned 95.5000°, off by 0.2500°
    rapid: p1: joint 3 at 95.7500°, planned 95.5000°, off by 0.2500°
    ls: p1: joint 3 at 95.7500°, planned 95.5000°, off by 0.2500°
    inform: p1: joint 3 at 95.7499°, planned 95.5000°, off by 0.2499°
    pdl2: p1: joint 3 at 95.7500°, planned 95.5000°, off by 0.2500°
    urscript: p1: joint 3 at 95.7500°, planned 95.5000°, off by 0.2500°
    csv: p1: joint 3 at 95.7500°, planned 95.5000°, off by 0.2500°
    ");
}

#[test]
fn moves_that_are_missing_added_or_elsewhere_are_named() {
    let (program, _) = written(Language::Krl);
    let planned: Vec<&Move> = program.moves().collect();
    let compare = |moves: &[&Move]| compare_moves(&planned, moves, Language::Krl, 1e-9);
    let named = |kind: &str, differences: &[Difference]| {
        let text = format!("{differences:?}");
        assert_eq!(differences.len(), 1, "{text}");
        assert!(text.contains(kind), "{text}");
    };
    let mut without = planned.clone();
    without.remove(2);
    named("Missing", &compare(&without));
    let mut more = planned.clone();
    let extra = Move { name: "p3".into(), ..planned[1].clone() };
    more.insert(2, &extra);
    named("Added", &compare(&more));
    let mut exchanged = planned.clone();
    exchanged.swap(1, 3);
    assert!(compare(&exchanged).iter().all(|d| matches!(d, Difference::Order { .. })));
    assert!(!compare(&exchanged).is_empty());
}

#[test]
fn a_stop_that_was_taken_out_is_named() {
    for (language, stop) in [
        (Language::Krl, "HALT\r\n"),
        (Language::Rapid, "    Stop;\r\n"),
        (Language::Ls, "  PAUSE ;"),
        (Language::Inform, "PAUSE\r\n"),
        (Language::Pdl2, "  PAUSE\r\n"),
        (Language::Urscript, ", blocking=True"),
    ] {
        let posture = |name: &str| Posture { name: name.into(), q: vec![0.5; 6] };
        let stops = ["p1", "p2"].map(|name| Stop::new(posture(name), "measure"));
        let program = program_of_stops(language.name_for("plan"), vec![], &stops, None, 10);
        let mut files = write_program(&program, language, &options(language, 6)).unwrap();
        assert_eq!(missing_stops(&read(language, &files).unwrap()), []);
        // The first stop is before the first move, the second at p1.
        let text = files[0].text.clone();
        let first = text.find(stop).unwrap() + stop.len();
        let (head, tail) = text.split_at(first);
        files[0].text = head.to_string() + &tail.replacen(stop, "", 1);
        let differences = missing_stops(&read(language, &files).unwrap());
        assert_eq!(differences, [Difference::NoStop { posture: "p1".into() }], "{language:?}");
    }
}

#[test]
fn listings_as_controllers_write_them_are_read() {
    let point = "P[1]{\n   GP1:\n\tUF : 0, UT : 1,\t\n\tJ1=    10.000 deg,\tJ2=     -.242 deg,\tJ3=      .044 deg,\n\tJ4=     0.000 deg,\tJ5=    45.000 deg,\tJ6=     0.000 deg,\n\tE1= -1290.488  mm\n};\n";
    let text = format!(
        "/PROG  A\n/ATTR\n/MN\n   1:  ! posture p1 ;\n   2:J P[1:over there] 10% FINE    ;\n   3:  PAUSE ;\n/POS\n{point}/END\n"
    );
    let file = ProgramFile { name: "a.ls".into(), text };
    let program = read(Language::Ls, &[file]).unwrap();
    let first = program.moves().next().unwrap();
    assert_eq!(first.name, "p1");
    assert!((first.q[1].to_degrees() + 0.242).abs() < 1e-12);
    let text = "MODULE A\r\n  CONST jointtarget  here := [[1,2,3,4,5,6], [9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];\r\n  PROC A_run()\r\n    MoveAbsJ  here\\NoEOffs, v100, fine, tool0 \\WObj:=wobj0;\r\n    MoveAbsJ [[1,2,3,4,5,7],[9E9,9E9,9E9,9E9,9E9,9E9]]\\NoEOffs,v100,fine,tool0;\r\n  ENDPROC\r\nENDMODULE\r\n";
    let file = ProgramFile { name: "a.mod".into(), text: text.into() };
    let program = read(Language::Rapid, &[file]).unwrap();
    let names: Vec<&str> = program.moves().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["move 1", "move 2"]);
    let src = "DEF a()\nBAS (#VEL_PTP, 12.6)\nptp xp1\nPTP {A1 1, A2 2, A3 3, A4 4, A5 5, A6 6, E1 0.0}\nEND\n";
    let dat = "DEFDAT A PUBLIC\nDECL GLOBAL E6AXIS XP1={E6AXIS: A1 1.0,A2 2.0,A3 3.0,A4 4.0,A5 5.0,A6 6.0,E1 0.0,E2 0.0}\nDECL FDAT FP1={TOOL_NO 1}\nENDDAT\n";
    let files =
        [("a.src", src), ("a.dat", dat)].map(|(name, text)| ProgramFile { name: name.into(), text: text.into() });
    let program = read(Language::Krl, &files).unwrap();
    let moves: Vec<&Move> = program.moves().collect();
    assert_eq!((moves.len(), moves[0].speed_percent), (2, 13));
    assert_eq!(moves[0].q, moves[1].q);
}

#[test]
fn files_of_another_language_or_none_are_refused() {
    for language in CONTROLLERS {
        let nothing = |name: &str| ProgramFile { name: name.into(), text: String::new() };
        let files = match language {
            Language::Krl => vec![nothing("a.src"), nothing("a.dat")],
            _ => vec![nothing("a.txt")],
        };
        let error = read(language, &files).unwrap_err();
        assert_eq!(error.code(), Code::TooFewData, "{error}");
        let error = read(language, &files[..0]).unwrap_err();
        assert_eq!(error.code(), Code::Usage, "{error}");
    }
}
