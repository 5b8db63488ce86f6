//! `stiffarm export`: programs, what is refused, what a comparison finds; docs/programs.md, top to bottom.

use crate::support;

use insta::assert_snapshot;
use serde_json::json;
use std::collections::BTreeSet;
use support::{Folder, blocks, is_narrow, place};

const GROUP: &str = "export builtin:comau builtin:comau-group1";
const PULSES: &str = "--controller yaskawa --pulses-per-degree 1341.4,1341.4,1341.4,1000,1000,622.2";

/// The files of each language, with what it needs beside.
const LANGUAGES: [(&str, &str, &[&str]); 7] = [
    ("krl", "--controller kuka", &["measure_comau_group1.dat", "measure_comau_group1.src"]),
    ("rapid", "--controller abb", &["measure_comau_group1.mod"]),
    ("ls", "--controller fanuc", &["measure_comau_group1.ls"]),
    ("inform", PULSES, &["MEASURE_COMAU_GROUP1.jbi"]),
    ("pdl2", "", &["measure_comau_group1.pdl"]),
    ("urscript", "--controller ur", &["measure_comau_group1.script"]),
    ("csv", "", &["measure_comau_group1.csv"]),
];

/// A posture that violates bounds and limits of the cell, within the robot's own.
const OUTSIDE: &str = "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg
a,0,0,-90,0,0,0
b,80,70,-90,0,45,0
";

/// Without --language it is that of the controller that the cell, or --controller, names.
#[test]
fn the_controller_says_the_language() {
    let folder = Folder::new();
    folder.ok(&format!("{GROUP} --output-dir of-cell"));
    assert_eq!(folder.names_in("of-cell"), ["measure_comau_group1.pdl"]);
    folder.ok(&format!("{GROUP} --controller kuka --output-dir of-option"));
    let names = folder.names_in("of-option");
    assert_eq!(names, ["measure_comau_group1.dat", "measure_comau_group1.src"]);
    let line = format!("{GROUP} --controller staubli --output-dir none");
    assert_snapshot!(folder.each_refused(&[(line.as_str(), "usage", "--language")]), @r"
    $ stiffarm export builtin:comau builtin:comau-group1 --controller staubli --output-dir none
    usage

      × --language: No language of Stäubli is written here.
      help: --language csv writes a table of the moves
    ");
}

#[test]
fn every_language_is_written_compared_and_not_overwritten() {
    let folder = Folder::new();
    let mut said = String::new();
    for (language, more, files) in LANGUAGES {
        let line = format!("{GROUP} --language {language} {more} --output-dir {language}");
        is_narrow(&folder.ok(&line));
        assert_eq!(folder.names_in(language), files);
        let paths: Vec<String> = files.iter().map(|file| format!("{language}/{file}")).collect();
        let before = folder.read(&paths[0]);
        for word in ["WARNING", "sha256"] {
            assert!(before.contains(word), "{word}: {before}");
        }
        let error = folder.error(&line);
        assert_eq!(error["code"], "file-exists", "{line}");
        assert!(paths.contains(&place(&error)), "{line}: {error}");
        folder.ok(&format!("{line} --force"));
        assert_eq!(folder.read(&paths[0]), before);
        let compare = format!("{GROUP} --language {language} {more} --compare {}", paths.join(" "));
        said += &format!("{language}\n{}\n", folder.ok(&compare));
        let same = folder.json(&compare)["result"].clone();
        let answer = ["same", "found_postures", "differences"].map(|key| same[key].clone());
        assert_eq!(answer, [true.into(), 6.into(), json!([])], "{language}");
        // Faster, and otherwise the same.
        let compare = compare.replace("--compare", "--speed-percent 20 --compare");
        let faster = folder.run(&compare);
        assert_eq!(faster.code, Some(1), "{language}");
        is_narrow(&faster.out);
        let differences = folder.json(&compare)["result"]["differences"].clone();
        let kinds = differences.as_array().unwrap().iter().map(|difference| difference["kind"].as_str().unwrap());
        let kinds: BTreeSet<&str> = kinds.collect();
        assert_eq!(kinds, BTreeSet::from(["line", "missing_line"]), "{language}");
    }
    assert_snapshot!("export_the_same", said);
}

#[test]
fn what_is_printed() {
    let folder = Folder::new();
    folder.write("home.csv", "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\nhome,0,0,-90,0,0,0\n");
    let line =
        format!("{GROUP} --language krl --controller kuka --start home.csv --speed-percent 20 --output-dir program");
    let ran = folder.run(&line);
    is_narrow(&ran.out);
    let printed = ran.transcript(&line);
    assert_snapshot!("export_krl", printed.replace('\\', "/"));
    let src = folder.read("program/measure_comau_group1.src");
    assert_eq!(src.matches("PTP XP").count(), 8);
    let lines: Vec<&str> = src.lines().collect();
    let first = lines.iter().position(|line| *line == "PTP XP1").unwrap();
    assert_snapshot!(lines[first - 5..=first].join("\n"), @r#"
    WAIT SEC 0
    MsgNotify ("Cell empty. Slow move to start home. Path free?")
    HALT
    ; start home
    BAS (#VEL_PTP,5)
    PTP XP1
    "#);
}

#[test]
fn a_plan_that_violates_limits_is_named_and_not_written() {
    let folder = Folder::new();
    folder.write("p.csv", OUTSIDE);
    let line = "export builtin:comau p.csv --language rapid --controller abb --output-dir program";
    let ran = folder.run(line);
    assert_eq!(ran.code, Some(1));
    is_narrow(&ran.out);
    assert_snapshot!("export_violates", ran.transcript(line));
    assert_eq!(folder.names(), ["p.csv"]);
    let json = folder.json(line);
    assert_eq!(json["result"]["files"], serde_json::json!([]));
    let violations = json["result"]["violations"].as_array().unwrap();
    assert!(violations.iter().all(|v| v["posture"] == "b"), "{violations:?}");
    assert!(violations.iter().any(|v| v["limit"]["kind"] == "tool_box"));
    assert!(violations.iter().any(|v| v["limit"].is_null()));
    let ran = folder.run(&format!("{line} --despite-limits"));
    assert_eq!(ran.code, Some(1));
    let written = folder.read("program/measure_p.mod");
    let warnings = written.lines().filter(|line| line.contains("WARNING")).map(str::trim);
    assert_snapshot!(warnings.collect::<Vec<_>>().join("\n"), @r"
    ! WARNING: never run on this robot before. Run it first in T1 (manual reduced
    ! WARNING: postures of this plan violate limits of its cell (3 in all).
    ");
}

#[test]
fn an_angle_beyond_the_robots_own_limits_is_never_written() {
    let folder = Folder::new();
    folder.write("p.csv", OUTSIDE.replace("80,70", "80,170"));
    let line = "export builtin:comau p.csv --language csv --output-dir x --despite-limits";
    assert_snapshot!(folder.each_refused(&[(line, "outside-limits", "p.csv:3:6 q2_deg")]), @r"
    $ stiffarm export builtin:comau p.csv --language csv --output-dir x --despite-limits
    outside-limits

      × joint 2 at 170° is outside the machine's limits, -75° to 95°.
       ╭─[p.csv:3:6]
     2 │ a,0,0,-90,0,0,0
     3 │ b,80,170,-90,0,45,0
       ·      ─┬─
       ·       ╰── q2_deg
       ╰────
    ");
    assert_eq!(folder.names(), ["p.csv"]);
}

#[test]
fn a_comparison_names_what_was_changed() {
    let folder = Folder::new();
    folder.ok(&format!("{GROUP} --language ls --controller fanuc --output-dir program"));
    let file = "program/measure_comau_group1.ls";
    let compare = format!("{GROUP} --language ls --controller fanuc --compare {file}");
    let written = folder.read(file);
    let with = |from: &str, to: &str| {
        assert!(written.contains(from), "{from}");
        written.replacen(from, to, 1)
    };
    // No angle has changed.
    let jump = with("J P[2] 10% FINE", "J P[2] 100% FINE").replacen("J P[3]", "  JMP LBL[1] ;\r\n  99:J P[3]", 1);
    let without_move = written.split_inclusive("\r\n").filter(|line| !line.contains("J P[4]")).collect();
    let mut said = String::new();
    let mut kinds = Vec::new();
    for (what, program) in [
        ("an angle", with("J3=   -110.00 deg", "J3=   -109.50 deg")),
        ("another speed, and a jump over the posture", jump),
        ("the move taken out at the pendant, not its point", without_move),
        ("no pause", with("unload] ;\r\n  36:  PAUSE ;", "unload] ;")),
        ("moved where a limit is violated", with("J2=     15.00 deg", "J2=     45.00 deg")),
    ] {
        folder.write(file, program);
        let ran = folder.run(&compare);
        assert_eq!(ran.code, Some(1), "{what}");
        is_narrow(&ran.out);
        said += &format!("{what}\n{}\n", ran.out);
        let result = folder.json(&compare)["result"].clone();
        assert_eq!(result["same"], false, "{what}");
        let differences = result["differences"].as_array().unwrap().iter();
        let differences: Vec<&str> = differences.map(|difference| difference["kind"].as_str().unwrap()).collect();
        kinds.push((what, differences.join(" "), result["violations"].as_array().unwrap().len()));
    }
    let kinds: Vec<(&str, &str, usize)> =
        kinds.iter().map(|(what, kinds, beyond)| (*what, &**kinds, *beyond)).collect();
    let expected = [
        ("an angle", "angle", 0),
        ("another speed, and a jump over the posture", "line line missing_line", 0),
        ("the move taken out at the pendant, not its point", "missing missing_line", 0),
        ("no pause", "no_stop missing_line", 0),
        ("moved where a limit is violated", "angle", 1),
    ];
    assert_eq!(kinds, expected);
    assert_snapshot!("export_differs", said);
    folder.write(file, with("J1=    -20.00 deg", "X  =    -20.00  mm"));
    assert_snapshot!(folder.each_refused(&[(compare.as_str(), "program", "program/measure_comau_group1.ls:98:2")]), @r"
    $ stiffarm export builtin:comau builtin:comau-group1 --language ls --controller fanuc --compare program/measure_comau_group1.ls
    program

      × `X` is not a joint: only positions in joint representation can be read.
        ╭─[program/measure_comau_group1.ls:98:2]
     97 │     UF : 0, UT : 1,
     98 │     X  =    -20.00  mm, J2=     15.00 deg,  J3=   -110.00 deg,
        ·     ──────────────────
     99 │     J4=    -15.00 deg,  J5=    -10.00 deg,  J6=     25.00 deg
        ╰────
    ");
}

#[test]
fn wrong_inputs_are_refused_before_anything_is_written() {
    let folder = Folder::new();
    folder.write("two.csv", OUTSIDE);
    folder.write("empty.csv", "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n");
    folder.write("taken", "a file");
    let mut said = String::new();
    for line in [
        "--language krl".to_string(),
        "--language fortran --output-dir x".to_string(),
        "--language inform --controller yaskawa --output-dir x".to_string(),
        "--language krl --controller kuka --pulses-per-degree 1341.4,1341.4,1341.4,1000,1000,622.2 --output-dir x"
            .to_string(),
        "--language inform --controller yaskawa --pulses-per-degree 1000,1000,nan,1000,1000,1000 --output-dir x"
            .to_string(),
        "--language krl --controller kuka --name move_it_quickly_to_the_left --output-dir x".to_string(),
        "--language ls --controller fanuc --name small --output-dir x".to_string(),
        "--language krl --controller kuka --tool spindle --output-dir x".to_string(),
        "--language krl --controller kuka --controller-axes 1,2,3,4,5,5 --output-dir x".to_string(),
        "--language krl --controller kuka --speed-percent 0 --output-dir x".to_string(),
        "--language krl --controller kuka --start two.csv --output-dir x".to_string(),
        "--language krl --controller kuka --output-dir taken".to_string(),
        "--language krl --controller kuka --compare two.csv".to_string(),
        "--language rapid --controller abb --compare two.csv".to_string(),
        "--language rapid --controller abb --compare two.csv --output-dir x".to_string(),
        // Angles of a COMAU arm do not go to another controller without being asked to.
        "--language ls --output-dir x".to_string(),
        "--language ls --controller kuka --output-dir x".to_string(),
        "--language csv --controller kuka --output-dir x".to_string(),
        "--language ls --compare two.csv".to_string(),
    ] {
        said += &format!("$ {line}\n{}\n", folder.refused(&format!("{GROUP} {line}")));
    }
    said += &folder.refused("export builtin:comau empty.csv --language csv --output-dir x");
    assert_eq!(folder.names(), ["empty.csv", "taken", "two.csv"]);
    assert_snapshot!("export_refusals", said);
}

#[test]
fn the_page_about_programs_holds() {
    let page = include_str!("../../../../docs/programs.md");
    let folder = Folder::new();
    let mut excerpts = 0;
    let blocks = blocks(page);
    for (_, text) in blocks.iter().filter(|(language, _)| *language == "sh") {
        for line in text.lines() {
            folder.ok(line.strip_prefix("stiffarm ").unwrap());
        }
    }
    for (language, text) in blocks.iter().filter(|(language, _)| *language != "sh") {
        let file = match *language {
            "krl" => "measure_comau_group1.src",
            "rapid" => "measure_comau_group1.mod",
            "ls" => "measure_comau_group1.ls",
            "inform" => "MEASURE_COMAU_GROUP1.jbi",
            "pdl" => "measure_comau_group1.pdl",
            "urscript" => "measure_comau_group1.script",
            "csv" => "measure_comau_group1.csv",
            other => panic!("{other}"),
        };
        let written = folder.read(&format!("program/{file}"));
        for line in text.lines() {
            assert!(written.lines().any(|made| made == line), "{language}: {line}\n{written}");
            excerpts += 1;
        }
    }
    assert!(excerpts > 20, "{excerpts}");
}
