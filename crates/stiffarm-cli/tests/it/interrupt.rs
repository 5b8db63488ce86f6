//! Ctrl-C and SIGTERM: what is finished is printed and written, and what is not is named.
#![cfg(unix)]

use crate::support::{Folder, codes, command, in_lines, listed, printed_sentence, sentence, without_numbers};
use insta::assert_snapshot;
use serde_json::Value;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// Runs `line`, which takes long, and sends it `signal` once there is `enough` on standard output.
fn stopped(folder: &Folder, line: &str, signal: &str, enough: &dyn Fn(&[u8]) -> bool) -> Output {
    let mut wait = Duration::from_millis(700);
    loop {
        let child = command(&folder.path(""))
            .args(line.split(' '))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(wait);
        let id = child.id().to_string();
        let sent = Command::new("kill").args([signal, &id]).status().unwrap();
        assert!(sent.success(), "{line} ended by itself");
        let output = child.wait_with_output().unwrap();
        // A busy machine had not come as far as the work: nothing was there to keep.
        if enough(&output.stdout) || wait > Duration::from_secs(20) {
            return output;
        }
        wait *= 2;
    }
}

/// The result in what `--json` printed.
fn printed(stdout: &[u8]) -> Option<Value> {
    let value: Value = serde_json::from_slice(stdout).ok()?;
    Some(value["result"].clone())
}

/// The same with `--json`: exit code 130 and the result.
fn result(folder: &Folder, line: &str, signal: &str, enough: &dyn Fn(&Value) -> bool) -> Value {
    let line = format!("{line} --json");
    let output = stopped(folder, &line, signal, &|out| printed(out).is_some_and(|result| enough(&result)));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{line}: {errors}");
    printed(&output.stdout).unwrap()
}

/// A plan of six postures with its measurements.
fn measured() -> Folder {
    let folder = Folder::new();
    folder.ok("select builtin:comau --rounds 1 --no-certificate --output plan.csv");
    folder.ok("simulate builtin:comau plan.csv --runs 20 --measurements m.csv");
    folder
}

#[test]
fn a_stopped_search_for_postures_keeps_the_best_so_far() {
    let folder = Folder::new();
    let line =
        "select builtin:comau --index expected-error --rounds 1000000 -n 3 --sensitivity --output plan.csv --force";
    let plan = result(&folder, line, "-INT", &|_| true);
    assert_eq!(plan["termination"], "interrupted");
    assert_eq!(folder.read("plan.csv").lines().count(), 4);
    // What comes after the search is left out, and it says so.
    assert!(plan["certificate"].is_null() && plan["sensitivity"].is_null());
    let missing = &plan["certificate_missing"];
    assert_eq!(missing, "stopped before the bound was found");
}

#[test]
fn a_stopped_identification_keeps_its_estimates() {
    let folder = measured();
    let whole = folder.json("identify builtin:comau m.csv");
    assert_eq!(whole["result"]["not_computed"], Value::Array(Vec::new()));
    let line = "identify builtin:comau m.csv --bootstrap 1000000 --output k.json";
    for signal in ["-INT", "-TERM"] {
        let fit = result(&folder, &format!("{line} --force"), signal, &|fit| fit["not_computed"][0] == "bootstrap");
        let values = |result: &Value| -> Vec<Value> {
            let joints = result["joints"].as_array().unwrap().iter();
            joints.map(|joint| joint["stiffness"].clone()).collect()
        };
        assert_eq!(values(&fit), values(&whole["result"]));
        let named = fit["not_computed"].as_array().unwrap();
        assert_eq!(named[0], "bootstrap");
        assert!(fit["bootstrap"].is_null());
    }
    // What was written serves as any other result.
    folder.ok("predict builtin:comau k.json plan.csv --force-n 0,0,100 --axes base");
    let line = format!("{line} --report k.html --force");
    let said = "The command was stopped before it was done: the bootstrap intervals";
    let table = stopped(&folder, &line, "-INT", &|out| !out.is_empty() && folder.read("k.html").contains(said));
    assert!(folder.read("k.html").contains(said), "the page does not say that it was stopped");
    let text = String::from_utf8(table.stdout).unwrap();
    assert_snapshot!(in_lines(printed_sentence(&text, "caution: The command")), @r"
    caution: The command was stopped before it was done: the bootstrap intervals, the profile of the
    likelihood, the errors common to the whole experiment, the diagnosis (readings that do not fit,
    leave-one-out, extra terms) and the next posture were not computed.
    ");
    assert!(text.lines().any(|line| line.starts_with("joint 6  ")), "{text}");
}

/// A table of random postures.
fn random_postures(count: usize, seed: u64) -> String {
    let mut state = seed;
    let mut next = || {
        // An own generator: the table is the same everywhere.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let bounds = [[-90.0, 90.0], [-60.0, 40.0], [-180.0, -40.0], [-180.0, 180.0], [-90.0, 90.0], [-180.0, 180.0]];
    let mut text = "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n".to_string();
    for row in 0..count {
        let angles = bounds.map(|b: [f64; 2]| format!("{:.2}", b[0] + (b[1] - b[0]) * next()));
        text += &format!("{row},{}\n", angles.join(","));
    }
    text
}

/// Commands that do not look out for a stop end at once, and every one says so.
#[test]
fn every_command_ends_with_130_and_a_word() {
    let folder = Folder::new();
    folder.write("many.csv", random_postures(200_000, 5));
    folder.write("plan.csv", random_postures(3_000, 7));
    let lines = [
        "evaluate builtin:comau many.csv",
        "pose builtin:comau many.csv",
        "export builtin:comau many.csv --language pdl2 --output-dir program",
        "route builtin:comau plan.csv",
    ];
    for line in lines {
        let mut child = command(&folder.path(""))
            .args(line.split(' '))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(300));
        let id = child.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        let sent = std::time::Instant::now();
        while child.try_wait().unwrap().is_none() {
            assert!(sent.elapsed() < Duration::from_secs(60), "{line} goes on");
            std::thread::sleep(Duration::from_millis(20));
        }
        let output = child.wait_with_output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(130), "{line}: {errors}");
        assert!(errors.to_lowercase().starts_with("interrupted"), "{line}: {errors}");
    }
}

#[test]
fn a_stopped_map_holds_the_nodes_that_were_done() {
    let folder = Folder::new();
    let line = "map builtin:comau prior --steps 30,30,30 --free-turn=720 --output-dir out --force";
    // Of a few nodes nothing can be said.
    let map = result(&folder, line, "-TERM", &|map| map["counts"]["reachable"].as_u64() > Some(50));
    assert_eq!(map["interrupted"], true);
    let counts = &map["counts"];
    let (left, reached) = (counts["not_computed"].as_u64(), counts["reachable"].as_u64());
    assert!(left > Some(0) && reached > Some(0), "{counts}");
    let nodes = map["nodes"].as_array().unwrap();
    assert_eq!(nodes.len(), 30 * 30 * 30);
    // Spread over the whole region, not its first slice.
    let computed = |part: &[Value]| part.iter().any(|n| n["status"] != "not_computed");
    assert!(nodes.chunks(nodes.len() / 4).all(computed));
    let table = folder.read("out/map.csv");
    let rows = table.lines().filter(|row| row.split(',').nth(3) == Some("not computed")).count();
    assert_eq!(Some(rows as u64), left);
}

#[test]
fn a_stopped_search_for_a_place_gives_the_best_so_far() {
    let folder = Folder::new();
    let line = "map builtin:comau prior --place builtin:contour --steps 90,90,1 --refine 8";
    let place = result(&folder, line, "-INT", &|_| true);
    assert_eq!(place["interrupted"], true);
    assert!(!place["given"].is_null());
    assert!(codes(&place["findings"]).contains(&"stopped"), "{}", place["findings"]);
    assert_snapshot!(in_lines(without_numbers(sentence(&place["findings"], "stopped"))), @r"
    Stopped: # places were tried, spread over the grid; a better one may be among the others.
    Deflections are those of the # searched points of the path.
    ");
}

#[test]
fn a_stopped_simulation_gives_the_runs_that_were_made() {
    let folder = measured();
    let line = "simulate builtin:comau plan.csv --runs 1000000";
    let experiment = result(&folder, line, "-TERM", &|_| true);
    assert_eq!(experiment["interrupted"], true);
    assert_eq!(experiment["runs"], 1_000_000);
    let levels = experiment["groups"][0]["levels"].as_array().unwrap();
    assert_eq!(levels.len(), 6);
    let runs = |level: &Value| level["runs"].as_u64().unwrap();
    assert!(levels.iter().all(|level| runs(level) >= 20));
    assert!(levels.iter().any(|level| runs(level) < 1_000_000));
}

#[test]
fn a_stopped_simulation_of_springs_gives_the_runs_that_were_made() {
    let folder = Folder::new();
    let line = "simulate builtin:comau builtin:comau-group1 --elastic mixed --runs 1000000";
    let experiment = result(&folder, line, "-INT", &|_| true);
    assert_eq!(experiment["interrupted"], true);
    let levels = experiment["groups"][0]["levels"].as_array().unwrap();
    let runs = levels[0]["runs"].as_u64().unwrap();
    assert!((3..1_000_000).contains(&runs), "{runs}");
    assert!(!levels[0]["mixed"].is_null());
}

#[test]
fn a_stopped_study_says_so_and_leaves_nothing_older_beside_its_page() {
    let folder = Folder::new();
    let cell = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../cells/comau.toml"));
    folder.write("my-cell.toml", cell.unwrap());
    let line = "study my-cell.toml --runs 2 --initial-groups 2 --seed 3 --output-dir out";
    folder.ok(line);
    // As an older version of the program would have left it.
    let json = folder.read("out/study.json");
    let older = json.replace("\"indices.csv\"", "\"indices.csv\" \"study.md\" \"old-figure.svg\" \"../mine.csv\"");
    assert_ne!(json, older);
    let older = older.replace("\" \"", "\", \"");
    folder.write("out/study.json", older);
    for name in ["out/study.md", "out/old-figure.svg", "out/postures-mine.csv", "out/notes.txt", "mine.csv"] {
        folder.write(name, "text");
    }
    let line = "study my-cell.toml --initial-groups 1000000 --seed 3 --output-dir out --force";
    let study = result(&folder, line, "-TERM", &|_| true);
    assert_eq!(study["interrupted"], true);
    let cautions = listed(&folder.read("out/report.html"));
    let stopped = cautions.iter().find(|caution| caution.contains("stopped")).unwrap();
    assert!(stopped.ends_with("of 1000000 other initial groups."), "{stopped}");
    let (begin, _) = stopped.split_once("Missing: ").unwrap();
    assert_snapshot!(begin, @"! Caution: The study was stopped before its end.");
    let mut files = folder.names_in("out");
    files.retain(|name| !["postures-mine.csv", "notes.txt"].contains(&name.as_str()));
    let files_listed = study["files"].as_array().unwrap();
    let mut in_study: Vec<&str> = files_listed.iter().map(|name| name.as_str().unwrap()).collect();
    in_study.sort_unstable();
    assert_eq!(files, in_study);
    for name in ["out/postures-mine.csv", "out/notes.txt", "mine.csv"] {
        assert_eq!(folder.read(name), "text", "{name}");
    }
}
