//! `stiffarm export`: programs, what is refused, what a comparison finds; docs/programs.md, top to bottom.

use crate::support;

use insta::assert_snapshot;
use support::{Folder, blocks, is_narrow};

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
    folder.ok(&format!("{GROUP} --output-dir own"));
    assert_eq!(folder.names_in("own"), ["measure_comau_group1.pdl"]);
    folder.ok(&format!("{GROUP} --controller kuka --output-dir asked"));
    let names = folder.names_in("asked");
    assert_eq!(names, ["measure_comau_group1.dat", "measure_comau_group1.src"]);
    let refused = folder.refused(&format!("{GROUP} --controller staubli --output-dir none"));
    assert!(refused.contains("--language csv"), "{refused}");
}

#[test]
fn every_language_is_written_compared_and_not_overwritten() {
    let folder = Folder::new();
    for (language, more, files) in LANGUAGES {
        let line = format!("{GROUP} --language {language} {more} --output-dir {language}");
        is_narrow(&folder.ok(&line));
        assert_eq!(folder.names_in(language), files);
        let paths: Vec<String> = files.iter().map(|file| format!("{language}/{file}")).collect();
        let before = folder.read(&paths[0]);
        let warned = before.replace('\n', " ");
        assert!(warned.contains("WARNING") && warned.contains("sha256"), "{before}");
        let refused = folder.refused(&line);
        assert!(refused.contains("exists already"), "{refused}");
        folder.ok(&format!("{line} --force"));
        assert_eq!(folder.read(&paths[0]), before);
        let compare = format!("{GROUP} --language {language} {more} --compare {}", paths.join(" "));
        let said = folder.ok(&compare);
        assert!(said.contains("the same 6 postures as the plan"), "{said}");
        assert!(said.contains("and no other line"), "{said}");
        // Faster, and otherwise the same.
        let faster = folder.run(&compare.replace("--compare", "--speed-percent 20 --compare"));
        assert_eq!(faster.code, Some(1), "{language}");
        assert!(faster.out.contains("not a line that export"), "{}", faster.out);
        is_narrow(&faster.out);
    }
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
    assert!(src.contains("BAS (#VEL_PTP,5)\r\nPTP XP1\r\n"), "{src}");
    assert!(src.contains("Slow move to start home"), "{src}");
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
    assert!(written.contains("! WARNING: postures of this plan violate limits of its cell"), "{written}");
}

#[test]
fn an_angle_beyond_the_robots_own_limits_is_never_written() {
    let folder = Folder::new();
    folder.write("p.csv", OUTSIDE.replace("80,70", "80,170"));
    let said = folder.refused("export builtin:comau p.csv --language csv --output-dir x --despite-limits");
    assert!(said.contains("outside the machine's limits") && said.contains("p.csv:3"), "{said}");
    assert_eq!(folder.names(), ["p.csv"]);
}

#[test]
fn a_comparison_names_what_was_changed() {
    let folder = Folder::new();
    folder.ok(&format!("{GROUP} --language ls --controller fanuc --output-dir program"));
    let file = "program/measure_comau_group1.ls";
    let compare = format!("{GROUP} --language ls --controller fanuc --compare {file}");
    let written = folder.read(file);
    folder.write(file, written.replacen("J3=   -110.00 deg", "J3=   -109.50 deg", 1));
    let ran = folder.run(&compare);
    assert_eq!(ran.code, Some(1));
    assert!(ran.out.contains("2: joint 3 at -109.5000°, planned -110.0000°, off by 0.5000°"), "{}", ran.out);
    is_narrow(&ran.out);
    let json = folder.json(&compare);
    assert_eq!(json["result"]["same"], false);
    assert_eq!(json["result"]["differences"][0]["joint"], 3);
    // Another speed, and a jump over the posture: no angle has changed.
    folder.write(
        file,
        written.replacen("J P[2] 10% FINE", "J P[2] 100% FINE", 1).replacen(
            "J P[3]",
            "  JMP LBL[1] ;\r\n  99:J P[3]",
            1,
        ),
    );
    let ran = folder.run(&compare);
    assert_eq!(ran.code, Some(1));
    let json = folder.json(&compare);
    assert_eq!(json["result"]["same"], false);
    let lines: Vec<&serde_json::Value> = json["result"]["differences"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|difference| difference["kind"] == "line")
        .collect();
    let text = |at: usize| lines[at]["text"].as_str().unwrap();
    assert!(text(0).ends_with("J P[2] 100% FINE ;") && text(1).ends_with("JMP LBL[1] ;"));
    assert_eq!(lines.len(), 2);
    let own = folder.read(file);
    let at = own.lines().position(|line| line.contains("JMP")).unwrap() + 1;
    assert_eq!(lines[1]["line"], at);
    assert!(ran.out.contains(&format!("{file}:{at}")), "{}", ran.out);
    // Taken out at the pendant: the move, not its point.
    let without: String = written.split_inclusive("\r\n").filter(|line| !line.contains("J P[4]")).collect();
    folder.write(file, without);
    let ran = folder.run(&compare);
    assert!(ran.out.contains("4: the program does not go there"), "{}", ran.out);
    let unstopped = written.replacen("unload] ;\r\n  36:  PAUSE ;", "unload] ;", 1);
    assert_ne!(unstopped, written);
    folder.write(file, unstopped);
    let ran = folder.run(&compare);
    assert_eq!(ran.code, Some(1));
    assert!(ran.out.contains("1: the program does not wait there"), "{}", ran.out);
    // Moved where a limit is violated.
    folder.write(file, written.replacen("J2=     15.00 deg", "J2=     45.00 deg", 1));
    let ran = folder.run(&compare);
    assert!(ran.out.contains("limit: posture 2 has joint 2 at 45"), "{}", ran.out);
    folder.write(file, written.replacen("J1=    -20.00 deg", "X  =    -20.00  mm", 1));
    let said = folder.refused(&compare);
    assert!(said.contains("joint representation") && said.contains(file), "{said}");
}

#[test]
fn wrong_inputs_are_refused_before_anything_is_written() {
    let folder = Folder::new();
    folder.write("two.csv", OUTSIDE);
    folder.write("empty.csv", "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n");
    folder.write("taken", "a file");
    let mut told = String::new();
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
        told += &format!("$ {line}\n{}\n", folder.refused(&format!("{GROUP} {line}")));
    }
    told += &folder.refused("export builtin:comau empty.csv --language csv --output-dir x");
    assert_eq!(folder.names(), ["empty.csv", "taken", "two.csv"]);
    assert_snapshot!("export_refusals", told);
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
            assert!(written.lines().any(|own| own == line), "{language}: {line}\n{written}");
            excerpts += 1;
        }
    }
    assert!(excerpts > 20, "{excerpts}");
}
