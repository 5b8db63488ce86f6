//! What a program holds beside the plan's moves is found, whatever it is.

use super::{Language, ProgramFile, options, written};
use stiffarm_files::program::{Difference, Move, compare_moves, compare_statements, missing_stops, read_program};

const LANGUAGES: [Language; 7] = Language::ALL;

/// The files with `old` replaced, which stands there.
fn edited(language: Language, old: &str, new: &str) -> Vec<ProgramFile> {
    let mut files = written(language).1;
    let file = files.iter_mut().find(|file| file.text.contains(old));
    let file = file.unwrap_or_else(|| panic!("{language:?}: {old}"));
    file.text = file.text.replacen(old, new, 1);
    files
}

/// The move to the second posture, where lines are put before.
fn second_move(language: Language) -> &'static str {
    match language {
        Language::Krl => "PTP XP4",
        Language::Rapid => "    MoveAbsJ jp4",
        Language::Ls => "  26:J P[4]",
        Language::Inform => "MOVJ C00003",
        Language::Pdl2 => "  MOVE JOINT TO {-10.00",
        Language::Urscript => "  movej([-0.17453293",
        Language::Csv => "7,posture,p2",
    }
}

/// Lines that make another program of it, put before a move.
const PUT: [(Language, &[&str]); 7] = [
    (
        Language::Krl,
        &[
            "GOTO OVER",
            "IF FALSE THEN",
            "LOOP",
            "SUB ( )",
            "XP2.A1 = 80",
            "$OV_PRO = 100",
            "BAS (#TOOL,2)",
            "$TOOL = TOOL_DATA[2]",
            "BAS (#VEL_PTP,100)",
        ],
    ),
    (
        Language::Rapid,
        &[
            "GOTO over;",
            "IF FALSE THEN",
            "WHILE TRUE DO",
            "other_routine;",
            "jp2.robax.rax_1:=80;",
            "SpeedRefresh 100;",
            "VelSet 100,5000;",
        ],
    ),
    (
        Language::Ls,
        &[
            "  25:  JMP LBL[1] ;",
            "  25:  IF (!DI[1]) THEN ;",
            "  25:  CALL SUB ;",
            "  25:  FOR R[1]=1 TO 3 ;",
            "  25:  OVERRIDE=100% ;",
            "  25:  UTOOL_NUM=2 ;",
            "  25:  UFRAME_NUM=1 ;",
            "  25:  OFFSET CONDITION PR[1] ;",
            "  25:  //PAUSE ;",
        ],
    ),
    (Language::Inform, &["JUMP *OVER", "CALL JOB:SUB", "SFTON P000", "SPEED VJ=100.00", "SET B000 1"]),
    (
        Language::Pdl2,
        &["GOTO over", "IF FALSE THEN", "FOR i := 1 TO 3 DO", "sub", "$TOOL := spindle", "$ARM_SPD_OVR := 100"],
    ),
    (Language::Urscript, &["  if False:", "  while True:", "  sub()", "  set_tcp(p[0,0,0.1,0,0,0])", "  halt"]),
    (Language::Csv, &["6,wait,,,,,,,,,go on"]),
];

/// What is changed within a line.
const CHANGED: [(Language, &str, &str); 17] = [
    (Language::Krl, "BAS (#VEL_PTP,10)", "BAS (#VEL_PTP,100)"),
    (Language::Krl, ",A6 -180.00}", ",A6 -180.00,E1 500.0}"),
    (Language::Krl, "(#INITMOV,0)", "(#INITMOV,1)"),
    (Language::Rapid, "VelSet 10,1000;", "VelSet 100,1000;"),
    (Language::Rapid, "jp2,v1000,fine,tool0;", "jp2,v5000,fine,tool0;"),
    (Language::Rapid, "jp2,v1000,fine,tool0;", "jp2,v1000,fine,tool1;"),
    (Language::Rapid, "[9E9,9E9", "[500,9E9"),
    (Language::Ls, "J P[2] 10% FINE", "J P[2] 100% FINE"),
    (Language::Ls, "UTOOL_NUM=1", "UTOOL_NUM=2"),
    (Language::Ls, "UF : 0, UT : 1,", "UF : 1, UT : 1,"),
    (Language::Ls, "J6=   -180.00 deg", "J6=   -180.00 deg,\tE1=   500.000  mm"),
    (Language::Inform, "VJ=10.00", "VJ=100.00"),
    (Language::Inform, "///TOOL 0", "///TOOL 1"),
    (Language::Pdl2, "$ARM_SPD_OVR := 10", "$ARM_SPD_OVR := 100"),
    (Language::Urscript, "v=0.1047", "v=1.0472"),
    (Language::Urscript, "a=0.5", "a=5"),
    (Language::Csv, "p1,10,-20,95.5,0,45.25,-180,10,", "p1,10,-20,95.5,0,45.25,-180,100,"),
];

/// What is found in files beside moves and waits, which are those of the plan.
fn compared(language: Language, files: &[ProgramFile]) -> Vec<Difference> {
    let options = options(language, 6);
    let planned = written(language).1;
    let read = |files: &[ProgramFile]| read_program(files, language, &options, 6).unwrap();
    let (unchanged, other) = (read(&planned), read(files));
    let moves = |program: &stiffarm_files::program::Program| -> Vec<Move> { program.moves().cloned().collect() };
    let (unchanged, moved) = (moves(&unchanged), moves(&other));
    let (unchanged, moved): (Vec<&Move>, Vec<&Move>) = (unchanged.iter().collect(), moved.iter().collect());
    // Whoever looks at these alone calls it the same program.
    let differences = compare_moves(&unchanged, &moved, language, 1e-5);
    assert!(differences.iter().all(|d| matches!(d, Difference::Angle { .. })), "{language:?} {differences:?}");
    if language != Language::Csv {
        assert_eq!(missing_stops(&other), [], "{language:?}");
    }
    compare_statements(&planned, files, language, 6)
}

#[test]
fn a_line_that_is_put_in_is_named_with_its_number() {
    for (language, lines) in PUT {
        for put in lines {
            let place = second_move(language);
            let files = edited(language, place, &format!("{put}\n{place}"));
            let file = files.iter().find(|file| file.text.contains(put)).unwrap();
            let at = file.text.lines().position(|line| line == *put).unwrap() + 1;
            let differences = compared(language, &files);
            let expected = Difference::Line { file: file.name.clone(), line: at, text: put.trim().to_string() };
            assert_eq!(differences, [expected], "{language:?}");
            let sentence = differences[0].sentence(&[]);
            assert!(sentence.contains(&format!(":{at}: ")) && sentence.ends_with(put.trim()));
        }
    }
}

#[test]
fn a_line_that_is_changed_is_named_with_what_stood_there() {
    for (language, old, new) in CHANGED {
        let differences = compared(language, &edited(language, old, new));
        let [Difference::Line { text, .. }, Difference::MissingLine { text: before, .. }] = &differences[..] else {
            panic!("{language:?} {new}: {differences:?}");
        };
        assert!(text.contains(new.trim()) && before.contains(old.trim()), "{differences:?}");
    }
}

#[test]
fn a_line_that_is_taken_out_or_moved_is_named() {
    for (language, line) in [
        (Language::Krl, "BAS (#INITMOV,0)\r\n"),
        (Language::Krl, "WAIT SEC 0\r\n"),
        (Language::Ls, "   8:  UTOOL_NUM=1 ;\r\n"),
        (Language::Inform, "///TOOL 0\r\n"),
        (Language::Pdl2, "  $ARM_SPD_OVR := speed_before\r\n"),
        (Language::Rapid, "    VelSet 100,5000;\r\n"),
    ] {
        let differences = compared(language, &edited(language, line, ""));
        assert!(
            matches!(&differences[..], [Difference::MissingLine { text, .. }] if line.contains(text.as_str())),
            "{language:?}: {differences:?}"
        );
    }
    // Of a file that is not there all lines are missing, comments aside.
    let (_, planned) = written(Language::Krl);
    let (points, others) = planned.split_last().unwrap();
    let missing = compare_statements(&planned, others, Language::Krl, 6);
    let lines = points.text.lines().filter(|line| !line.starts_with([';', '&']));
    let lines: Vec<Difference> = lines
        .map(|line| Difference::MissingLine { file: points.name.clone(), text: line.trim().to_string() })
        .collect();
    assert!(points.name.ends_with(".dat") && lines.len() > 3);
    assert_eq!(missing, lines);
    // The same lines, and the job ends before the last posture.
    let mut files = edited(Language::Inform, "\r\nEND\r\n", "\r\n");
    files[0].text = files[0].text.replacen("MOVJ C00003", "END\r\nMOVJ C00003", 1);
    let differences = compared(Language::Inform, &files);
    assert!(
        matches!(&differences[..], [Difference::Line { text, .. }, Difference::MissingLine { .. }] if text == "END"),
        "{differences:?}"
    );
}

#[test]
fn angles_comments_spaces_and_notes_may_differ() {
    for language in LANGUAGES {
        assert_eq!(compared(language, &written(language).1), [], "{language:?}");
        let mut files = written(language).1;
        for file in &mut files {
            file.text += "\n\n";
            file.text = file.text.replace(" = ", "  =  ").replace('\r', "");
        }
        assert_eq!(compared(language, &files), [], "{language:?}");
    }
    for (language, old, new) in [
        (Language::Krl, "A3 95.50", "A3 95.75"),
        (Language::Krl, "&REL 1", "&REL 12\r\n&PARAM EDITMASK = *"),
        (Language::Krl, "PTP XP2", "; touched up\r\nPTP XP2"),
        (Language::Rapid, ",95.50,", ", 95.750,"),
        (Language::Rapid, "[9E9,9E9", "[9E+09, 9E+09"),
        (Language::Ls, "95.50 deg", "95.750  deg"),
        (Language::Ls, "DATE 00-01-01  TIME 00:00:00", "DATE 26-11-24  TIME 13:05:00"),
        (Language::Ls, "  15:J P[2] 10% FINE ;", "  16:J P[2] 10% FINE    ;"),
        (Language::Inform, ",-128102,", ",-128437,"),
        (Language::Inform, "///DATE 2000/01/01 00:00", "///DATE 2026/11/24 13:05"),
        (Language::Pdl2, ", 95.50,", ", 95.75,"),
        (Language::Urscript, ", 1.66678944,", ", 1.67115276,"),
        (Language::Csv, ",95.5,", ",95.75,"),
    ] {
        assert_eq!(compared(language, &edited(language, old, new)), [], "{language:?} {new}");
    }
}
