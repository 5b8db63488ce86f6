//! Pages of results hold the numbers of their result to the last digit, and nothing that is no result becomes a page.

use crate::support;

use insta::assert_snapshot;
use serde_json::Value;
use std::collections::HashSet;
use stiffarm_files::envelope::write_result;
use support::{Folder, brief_stiffness, measurements, paragraphs, readings, redact, scenes};

/// Readings of a simulated experiment and what `identify` makes of them.
fn measured() -> Folder {
    let folder = Folder::with("r.csv", readings());
    folder.write("k.json", brief_stiffness());
    folder
}

#[test]
fn the_command_and_report_make_the_same_page() {
    let folder = measured();
    let line = "predict builtin:comau k.json builtin:contour";
    let value = folder.json(&format!("{line} --report now.html"));
    folder.write("saved.json", folder.ok(&format!("{line} --json")));
    folder.ok("report saved.json --output later.html");
    assert_eq!(folder.read("now.html"), folder.read("later.html"));
    let page = folder.read("now.html");
    // What the page shows is what the result holds, to the last digit.
    let rms = &value["result"]["deflection_rms_m"];
    let wanted = format!("data-value=\"{rms}\"");
    assert!(page.contains(&wanted), "{wanted}");
    assert!(page.contains("default-src 'none'"));
    // Names of formats, and no address that is loaded.
    assert_eq!(page.matches("http://").count(), page.matches("http://www.w3.org/").count());
}

#[test]
fn a_page_is_never_written_over_unasked() {
    let folder = measured();
    folder.write("report.html", "mine");
    folder.write("k.html", folder.read("k.json"));
    let refused = folder.each_refused(&[
        ("predict builtin:comau k.json --report report.html", "file-exists", "report.html"),
        ("predict builtin:comau k.html --report k.html --force", "conflict", "k.html"),
    ]);
    assert_snapshot!(refused);
    assert_eq!(folder.read("report.html"), "mine");
}

#[test]
fn what_is_no_result_is_refused_with_a_reason() {
    let folder = Folder::new();
    folder.write("broken.json", "{\"format\": 1,");
    folder.write("other.json", "{\"a\": 1}");
    folder.write("future.json", "{\"format\": 2, \"stiffarm\": \"9\", \"command\": \"predict\", \"result\": {}}");
    folder.write(
        "poor.json",
        "{\"format\": 1, \"stiffarm\": \"0.1.0\", \"command\": \"predict\", \"result\": {\"model\": \"linear\"}}",
    );
    folder.write("error.json", folder.run("predict builtin:comau nowhere.json --json").out);
    folder.write("robots.json", folder.ok("robots --json"));
    // Edited after it was written.
    let line = "select builtin:comau -n 2 --rounds 1 --no-certificate --json";
    let mut plan: Value = serde_json::from_str(&folder.ok(line)).unwrap();
    folder.write("plan.json", plan.to_string());
    folder.ok("report plan.json --output plan.html");
    let angle = plan.pointer_mut("/result/postures_deg/0/1").unwrap();
    *angle = (angle.as_f64().unwrap() + 1.0).into();
    folder.write("edited.json", plan.to_string());
    // What was to be JSON.
    folder.write("k.json", brief_stiffness());
    folder.write("empty.json", "");
    folder.write("cut.json", &brief_stiffness()[..500]);
    folder.write("text.json", "posture,q1_deg\n");
    let before = folder.names();
    let refused = folder.each_refused(&[
        ("report broken.json", "result-file", "broken.json:1:13"),
        ("report other.json", "result-file", "other.json"),
        ("report future.json", "result-file", "future.json"),
        ("report poor.json", "result-file", "poor.json seal"),
        ("report error.json", "result-file", "error.json"),
        ("report robots.json", "unsupported", "robots.json"),
        ("report nowhere.json", "file-read", "nowhere.json"),
        ("report edited.json --output other.html", "result-file", "edited.json"),
        ("report empty.json", "result-file", "empty.json:1:1"),
        ("report cut.json", "result-file", "cut.json:18:5"),
        ("report text.json", "result-file", "text.json:1:1"),
        // Names of files say what they are.
        ("report k.json --output x.txt", "usage", "--output"),
        ("identify builtin:comau r.csv --report x.json", "usage", "--report"),
        ("predict builtin:comau k.json builtin:contour --output x.json", "usage", "--output"),
        ("check k.json", "toml-syntax", "k.json:1:1"),
    ]);
    assert_snapshot!(refused);
    assert_eq!(folder.names(), before);
}

#[test]
fn a_cell_is_known_by_its_hash() {
    let folder = measured();
    let cells = concat!(env!("CARGO_MANIFEST_DIR"), "/../../cells/");
    let cell = std::fs::read_to_string(format!("{cells}comau.toml")).unwrap();
    folder.write("own.toml", format!("{cell}\n# my own\n"));
    let line = "predict own.toml prior builtin:contour --json";
    folder.write("own.json", folder.ok(line));
    assert_snapshot!(folder.ok("report own.json --output without.html"), @r"
    own.json: predict, no cell: give it with --cell for the pictures in 3D

    wrote without.html
    ");
    assert_snapshot!(folder.ok("report own.json --cell own.toml --output with.html"), @r"
    own.json: predict, cell COMAU NJ 165-3.0, rope load

    wrote with.html
    ");
    assert_eq!(["without.html", "with.html"].map(|page| scenes(&folder.read(page))), [0, 1]);
    let line = "report own.json --cell builtin:comau --output other.html";
    assert_snapshot!(folder.each_refused(&[(line, "conflict", "builtin:comau")]), @r"
    $ stiffarm report own.json --cell builtin:comau --output other.html
    conflict

      × builtin:comau: No result was made with this version of the cell.
      help: give the cell file as it was when the result was made ([work] and tasks may have been added since), or leave out --cell: the page then has no pictures of the cell
    ");
}

#[test]
fn work_that_was_added_to_a_cell_changes_no_picture() {
    let folder = measured();
    let cells = concat!(env!("CARGO_MANIFEST_DIR"), "/../../cells/");
    let cell = std::fs::read_to_string(format!("{cells}comau.toml")).unwrap();
    let (before, work) = cell.split_once("[[task]]").unwrap();
    let before = before.trim_end();
    folder.write("own.toml", format!("{before}\n"));
    folder.write("own.json", folder.ok("predict own.toml prior builtin:contour --json"));
    folder.write("own.toml", format!("{before}\n\n[[task]]{work}"));
    folder.ok("report own.json --cell own.toml --output page.html");
    assert_eq!(scenes(&folder.read("page.html")), 1);
    // [work] beside tasks that were there already.
    let (before, _) = cell.split_once("\n[work]").unwrap();
    folder.write("own.toml", format!("{}\n", before.trim_end()));
    folder.write("own.json", folder.ok("predict own.toml prior --json"));
    let added = format!("{}\n\n[work]\ntip_mm = [0, 0, 300]\n", before.trim_end());
    folder.write("own.toml", added);
    folder.ok("report own.json --cell own.toml --output page.html --force");
    assert_eq!(scenes(&folder.read("page.html")), 1);
}

#[test]
fn every_page_of_a_stopped_command_says_so() {
    let folder = measured();
    for (name, line, from, to) in [
        ("i", "identify builtin:comau r.csv --brief", "\"not_computed\": []", "\"not_computed\": [\"next_posture\"]"),
        (
            "s",
            "simulate builtin:comau builtin:comau-group1 --runs 2 --levels 1",
            "\"interrupted\": false",
            "\"interrupted\": true",
        ),
        (
            "p",
            "select builtin:comau --rounds 1 --no-certificate",
            "\"termination\": \"iteration_limit\"",
            "\"termination\": \"interrupted\"",
        ),
        ("c", "select builtin:comau --curve -n 5 --rounds 1 --no-certificate", "\"largest\": 5,", "\"largest\": 6,"),
    ] {
        let json = folder.ok(&format!("{line} --json"));
        assert!(json.contains(from), "{line}: {json}");
        let page = |json: String| {
            // Sealed anew: the change stands for what a stopped command writes.
            let mut changed: Value = serde_json::from_str(&json).unwrap();
            changed.as_object_mut().unwrap().remove("seal");
            folder.write("r.json", write_result(&changed).unwrap());
            folder.ok("report r.json --force");
            folder.read("report.html")
        };
        let said = "The command was stopped before it was done";
        assert!(!page(json.clone()).contains(said), "{name}");
        assert!(page(json.replacen(from, to, 1)).contains(said), "{name}");
    }
}

#[test]
fn results_as_the_powershell_saves_them_are_read() {
    let folder = measured();
    let text = folder.read("k.json");
    let wide = |order: fn(u16) -> [u8; 2]| -> Vec<u8> {
        let text = format!("\u{feff}{text}");
        text.encode_utf16().flat_map(order).collect()
    };
    let files = [format!("\u{feff}{text}").into_bytes(), wide(u16::to_le_bytes), wide(u16::to_be_bytes)];
    let plain = folder.json("predict builtin:comau k.json builtin:contour");
    for bytes in files {
        folder.write("w.json", bytes);
        folder.ok("report w.json --force");
        let wide = folder.json("predict builtin:comau w.json builtin:contour");
        assert_eq!(wide["result"], plain["result"]);
    }
}

#[test]
fn the_words_of_a_result_make_it_again() {
    let folder = measured();
    folder.write("group.csv", folder.ok("select builtin:comau --space-filling -n 6 --quiet --output -"));
    for line in [
        "identify builtin:comau r.csv --exclude 6 --brief --seed 3",
        "predict builtin:comau k.json builtin:contour --load-uncertainty-percent 10 --output p.csv",
        "evaluate builtin:comau group.csv",
        "simulate builtin:comau group.csv --runs 2 --levels=1,2 --measurements m.csv --threads 1",
        "validate builtin:comau k.json r.csv --only 6 --quiet",
        "map builtin:comau prior --plane z=800 --steps 5 --output-dir map",
    ] {
        let first: Value = folder.json(&format!("{line} --force"));
        let words = first["arguments"].as_array().unwrap().iter();
        let words = words.map(|word| match word.as_str().unwrap() {
            "{measurements}" => "r.csv",
            "{stiffness}" => "k.json",
            "{postures_1}" => "group.csv",
            word => word,
        });
        let words: Vec<&str> = words.collect();
        for gone in ["--force", "--output", "--measurements", "--threads", "--output-dir"] {
            assert!(!words.contains(&gone), "{words:?}");
        }
        let again = folder.json(&format!("{} --quiet", words.join(" ")));
        assert_eq!(again["result"], first["result"], "{words:?}");
        assert_eq!(again["arguments"], first["arguments"], "{words:?}");
    }
}

#[test]
fn a_result_from_python_shows_its_call() {
    let folder = Folder::new();
    let mut made: Value = folder.json("evaluate builtin:comau builtin:comau-group1");
    made["arguments"] = serde_json::json!(["stiffarm.evaluate(cell, groups)"]);
    folder.write("saved.json", made.to_string());
    folder.ok("report saved.json --output page.html");
    assert_snapshot!(redact(&paragraphs(&folder.read("page.html"), "r0-made")), @r"
    stiffarm [version]. The same inputs, options and seed give the same bytes. The call in Python, with the inputs by the names of its parameters:
    stiffarm.evaluate(cell, groups)
    Inputs
    ");
}

#[test]
fn results_side_by_side_mark_what_differs() {
    let folder = measured();
    let line = "predict builtin:comau";
    folder.write("one.json", folder.ok(&format!("{line} k.json builtin:contour --json")));
    folder.write("two.json", folder.ok(&format!("{line} prior builtin:contour --json")));
    folder.ok("report one.json one.json --output same.html");
    folder.ok("report one.json two.json --output two.html");
    let (same, two) = (folder.read("same.html"), folder.read("two.html"));
    // The story of the comparison comes first, and says what was different in making them.
    assert_snapshot!([&same, &two].map(|page| paragraphs(page, "verdict")).join("\n"), @r"
    ✓ No problem found
    one.json and one.json are compared: 2 results of predict. They were made in the same way.
    All 72 numbers of the key tables are the same.
    Each has its own part below, with its verdict and the command that makes it again.

    ! Look at the cautions
    one.json and two.json are compared: 2 results of predict. They differ in input stiffness.
    60 of 72 numbers of the key tables differ.
    Each has its own part below, with its verdict and the command that makes it again.
    ");
    let marked = |page: &str| page.matches("class=\"different\"").count();
    assert_eq!((marked(&same), marked(&two)), (0, 60));
    assert_snapshot!([&same, &two].map(|page| paragraphs(page, "all-compare-predict")).join("\n"), @r"
    Inputs, seed and options are the same.
    All 72 numbers of the key tables are the same.
    The key tables, number by number; what is in percent differs by percentage points

    How they were made differently
    60 of 72 numbers of the key tables differ; they are marked with ≠.
    The key tables, number by number; what is in percent differs by percentage points
    ");
}

#[test]
fn a_stiffness_beyond_the_errors_of_both_is_named() {
    let folder = measured();
    folder.write("one.json", folder.ok("identify builtin:comau r.csv --json"));
    // Without one posture the same within ±.
    folder.write("two.json", folder.ok("identify builtin:comau r.csv --exclude 2 --json"));
    // And an arm whose joint 3 is another one.
    let cell = include_str!("../../../../cells/comau.toml");
    let other = cell.replace("3000000, 900000,", "3000000, 1350000,");
    assert_ne!(cell, other);
    folder.write("other.toml", other);
    folder.ok("simulate other.toml builtin:comau-group1 --runs 1 --levels 1 --readings r3.csv");
    folder.write("three.json", folder.ok("identify builtin:comau r3.csv --json"));
    folder.ok("report one.json two.json --output near.html");
    folder.ok("report one.json three.json --output far.html");
    let (near, far) = (folder.read("near.html"), folder.read("far.html"));
    assert_snapshot!([&near, &far].map(|page| paragraphs(page, "verdict")).join("\n"), @r"
    ! Look at the cautions
    one.json and two.json are compared: 2 results of identify. They differ in option exclude.
    The joint stiffness differs by at most 0.91 % (joint 4, two.json against one.json), within the 49 % that the errors of both explain. 22 of 24 numbers of the key tables differ.
    Each has its own part below, with its verdict and the command that makes it again.

    ! Look at the cautions
    one.json and three.json are compared: 2 results of identify. They differ in input measurements.
    The stiffness of joint 3 differs by 50 %, beyond the 11 % that the errors of both explain (three.json against one.json): they contradict each other. 16 of 24 numbers of the key tables differ.
    Hold each against readings that none of them has used: stiffarm validate says which one describes the arm.
    ");
    let counts = |word: &str| [&near, &far].map(|page| page.matches(word).count());
    assert_eq!(counts("beyond ±"), [0, 1]);
    assert_eq!(counts("contradict").map(|count| count > 0), [false, true]);
}

/// Values of an attribute, in order, as they are read.
fn attributes(html: &str, name: &str) -> Vec<String> {
    let begin = format!(" {name}=\"");
    let values = html.match_indices(&begin).map(|(at, _)| {
        let rest = &html[at + begin.len()..];
        rest[..rest.find('"').unwrap()].to_string()
    });
    values.collect()
}

/// How many numbers of its result a page has; each stands there to the last digit.
fn numbers(page: &str, result: &Value) -> usize {
    let mut there = HashSet::new();
    all_numbers(result, &mut there);
    let values = attributes(page, "data-value");
    for value in &values {
        let shown: Value = serde_json::from_str(value).unwrap();
        let bits = shown.as_f64().map(f64::to_bits);
        assert!(there.contains(&bits), "{}: {value}", result["command"]);
    }
    values.len()
}

/// Every number of a result, and `None` for `null`.
fn all_numbers(value: &Value, out: &mut HashSet<Option<u64>>) {
    match value {
        Value::Null => drop(out.insert(None)),
        Value::Number(number) => drop(out.insert(number.as_f64().map(f64::to_bits))),
        Value::Array(items) => items.iter().for_each(|item| all_numbers(item, out)),
        Value::Object(map) => map.values().for_each(|item| all_numbers(item, out)),
        _ => {}
    }
}

#[test]
fn every_number_of_every_page_stands_in_its_result() {
    let folder = measured();
    folder.ok("select builtin:comau-shapes -n 2 --rounds 1 --no-certificate --quiet --output plan.csv");
    folder.write("m.csv", measurements());
    folder.ok("select builtin:comau --space-filling -n 10 --output even.csv");
    folder.ok("simulate builtin:comau even.csv --runs 1 --levels 1 --readings tracked.csv");
    for (line, least, in_space) in [
        ("predict builtin:comau k.json", 10, true),
        ("predict builtin:comau k.json builtin:contour --matrix", 20, true),
        ("predict builtin:comau prior builtin:contour", 10, true),
        ("predict builtin:comau k.json builtin:comau-group1 --cell-load", 10, true),
        ("compensate builtin:comau k.json builtin:contour", 20, true),
        ("compensate builtin:comau prior builtin:contour", 10, true),
        ("map builtin:comau k.json --plane z=800 --steps 5", 10, true),
        ("map builtin:comau prior --steps 6", 10, true),
        ("map builtin:comau prior --place builtin:contour --steps 2 --refine 0", 5, true),
        ("select builtin:comau-shapes -n 2 --rounds 1 --no-certificate", 20, true),
        ("select builtin:comau --curve -n 3 --rounds 1", 3, false),
        ("select builtin:comau --given builtin:comau-group1 --drop", 6, true),
        ("evaluate builtin:comau-shapes plan.csv", 20, true),
        ("simulate builtin:comau builtin:comau-group1 --runs 2", 6, true),
        ("identify builtin:comau r.csv --brief", 12, true),
        ("identify builtin:comau m.csv", 12, true),
        ("validate builtin:comau k.json r.csv", 5, true),
        ("validate builtin:comau m.csv --folds all", 5, true),
        ("zones builtin:comau --steps 5", 3, false),
        ("study builtin:comau --runs 2 --initial-groups 0 --output-dir folder", 20, true),
        (
            "study builtin:comau --measured tracked.csv --splits 3 --pool 7 --choose 4,5 --indices d,prediction \
             --output-dir measured",
            4,
            false,
        ),
    ] {
        let ran = folder.run(&format!("{line} --report page.html --force --json --quiet"));
        assert!(matches!(ran.code, Some(0 | 1)), "{line}\n{}{}", ran.out, ran.err);
        let result: Value = serde_json::from_str(&ran.out).unwrap();
        let page = folder.read("page.html");
        let count = numbers(&page, &result);
        assert!(count >= least, "{line}: {count} numbers");
        assert_eq!(scenes(&page) > 0, in_space, "{line}");
        // The story has its three sentences.
        let verdict = paragraphs(&page, "verdict");
        assert_eq!(verdict.lines().count(), 4, "{line}\n{verdict}");
    }
}

#[test]
fn a_registration_becomes_a_page() {
    let folder = Folder::new();
    folder.write("r.json", folder.ok("register builtin:example-pairs --json"));
    folder.ok("report r.json --output page.html");
    let result: Value = serde_json::from_str(&folder.read("r.json")).unwrap();
    assert!(numbers(&folder.read("page.html"), &result) >= 3);
}
