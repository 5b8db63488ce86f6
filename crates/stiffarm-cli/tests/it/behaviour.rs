//! What all commands share stays so: exit codes, files, streams, the same bytes from equal runs.

use crate::support;

use insta::assert_snapshot;
use std::io::Read;
use std::process::Stdio;
use support::{Folder, command, in_lines, measurements, paragraphs, printed_sentence, unbroken, without_numbers};

#[test]
fn equal_runs_are_equal_bytes_on_any_number_of_threads() {
    let folder = Folder::new();
    let lines = [
        "select builtin:comau-reference -n 3 --rounds 2 --seed 3 --index d",
        "select builtin:comau-reference -n 4 --rounds 1 --index novel",
        "select builtin:comau-reference --given builtin:comau-group1 --add 2 --rounds 2",
        "select builtin:comau-reference --curve -n 3 --rounds 1",
        "select builtin:comau-reference -n 2 --rounds 1 --sensitivity --no-certificate",
        "select builtin:comau -n 3 --rounds 1 --no-certificate --anchor-box-mm 1600,-200,0,2000,200,0",
        "simulate builtin:comau builtin:comau-group1 --runs 20 --levels 1,2 --seed 9",
        "simulate builtin:comau builtin:comau-group1 --elastic mixed --runs 4 --seed 9",
    ];
    for line in lines {
        let one = folder.run(&format!("{line} --json --threads 1"));
        assert_eq!(one.code, Some(0), "{}", one.out);
        let more = folder.run(&format!("{line} --json --threads 3"));
        assert_eq!(one.out, more.out, "{line}");
        assert_eq!((one.err.as_str(), more.err.as_str()), ("", ""));
    }
    let seed =
        |seed: u32| folder.ok(&format!("select builtin:comau --rounds 1 -n 5 --seed {seed} --no-certificate --json"));
    assert_ne!(seed(1), seed(2));
}

#[test]
fn results_hold_no_paths() {
    let folder = Folder::new();
    folder.write("cell.toml", stiffarm_files::builtin::cell_text("comau").unwrap());
    let relative = folder.ok("check cell.toml --json");
    let absolute = folder.ok(&format!("check {} --json", folder.path("cell.toml").display()));
    assert_eq!(relative, absolute);
    assert!(!relative.contains("cell.toml"));
}

#[test]
fn existing_files_are_kept_unless_forced() {
    let folder = Folder::new();
    folder.write("plan.csv", "mine");
    let line = "select builtin:comau --initial builtin:comau-group1 --output plan.csv --sheet sheet.csv";
    let ran = folder.run(line);
    assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""));
    assert_eq!(folder.read("plan.csv"), "mine");
    // Neither the other file nor a temporary one is left.
    assert_eq!(folder.names(), ["plan.csv"]);
    folder.ok(&format!("{line} --force"));
    assert_eq!(folder.names(), ["plan.csv", "sheet.csv"]);
    assert!(folder.read("plan.csv").starts_with("posture,q1_deg"));
}

#[test]
fn init_writes_all_or_nothing() {
    let folder = Folder::new();
    folder.write("measurements.csv", "mine");
    assert_eq!(folder.run("init").code, Some(2));
    assert_eq!(folder.names(), ["measurements.csv"]);
    assert_eq!(folder.read("measurements.csv"), "mine");
    folder.ok("init --force");
    assert_eq!(folder.names(), ["cell.toml", "measurements.csv", "postures.csv"]);
}

#[test]
fn dashes_are_standard_input_and_output() {
    let folder = Folder::new();
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    let ran = folder.run_with("check -", cell.as_bytes());
    assert_eq!(ran.code, Some(0));
    assert!(ran.out.lines().any(|line| line == "cell: standard input (COMAU NJ 165-3.0, rope load)"), "{}", ran.out);
    // The plan alone is on standard output; the table goes to standard error.
    let ran = folder.run("select builtin:comau --initial builtin:comau-group1 --output -");
    assert!(ran.out.starts_with("posture,q1_deg") && ran.out.lines().count() == 7, "{}", ran.out);
    assert!(ran.err.lines().any(|line| line.starts_with("cell: builtin:comau")), "{}", ran.err);
    let plan = ran.out;
    let ran = folder.run_with("evaluate builtin:comau -", plan.as_bytes());
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    let ran = folder.run("select builtin:comau --initial builtin:comau-group1 --output - --quiet");
    assert_eq!((ran.out, ran.err.as_str()), (plan, ""));
    let ran = folder.run("select builtin:comau --initial builtin:comau-group1 --output - --sheet -");
    assert_eq!(ran.code, Some(2));
    let ran = folder.run_with("evaluate - -", cell.as_bytes());
    assert_eq!(ran.code, Some(2));
    assert_snapshot!(ran.err, @r"
    usage

      × Standard input (`-`) can be used for one file only.
    ");
}

#[test]
fn colours_only_where_they_are_wanted() {
    let folder = Folder::new();
    let escape = '\u{1b}';
    assert!(!folder.ok("check").contains(escape));
    assert!(folder.ok("check --color always").contains(escape));
    assert!(!folder.ok("check --color never").contains(escape));
    let help = folder.ok("check --help --color always");
    assert!(help.contains(escape), "{help}");
    let ran = folder.run("check nothing.toml --color always");
    assert!(ran.err.contains(escape), "{}", ran.err);
    assert!(!folder.ok("check --json --color always").contains(escape));
}

#[test]
fn a_reader_that_has_gone_is_no_error() {
    let folder = Folder::new();
    let mut child = command(&folder.path(""))
        .args(["docs", "commands"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let status = child.wait().unwrap();
    let mut err = String::new();
    child.stderr.take().unwrap().read_to_string(&mut err).unwrap();
    assert_eq!((status.code(), err.as_str()), (Some(0), ""));
}

#[test]
fn a_time_limit_ends_the_search_and_names_the_rounds_that_repeat_it() {
    let folder = Folder::new();
    let line = "select builtin:comau-reference -n 4 --no-certificate";
    let limited = folder.json(&format!("{line} --time-limit 0.5"));
    assert_eq!(limited["result"]["termination"], "time_limit");
    assert_eq!(limited["options"]["time_limit_s"], 0.5);
    let table = folder.ok(&format!("{line} --time-limit 0.01"));
    let rounds = folder.json(&format!("{line} --time-limit 0.01"))["result"]["rounds"].clone();
    assert_eq!(rounds, 1);
    let shown = without_numbers(&printed_sentence(&table, "4 postures were chosen"));
    assert_snapshot!(shown, @"# postures were chosen inside the cell's limits by # local searches, until the time was over.");
    assert_eq!(printed_sentence(&table, "`--rounds"), "`--rounds 1` repeats it.");
}

#[test]
fn manual_pages_and_completions() {
    let folder = Folder::new();
    folder.ok("man --output-dir man");
    for page in ["stiffarm", "stiffarm-select"] {
        let title = format!(".TH {page} 1 ");
        let text = folder.read(&format!("man/{page}.1"));
        assert!(text.lines().any(|line| line.starts_with(&title)), "{page}: {text}");
    }
    // An index of `select`.
    assert!(folder.read("man/stiffarm-select.1").contains("expected"));
    assert!(!folder.path("man/stiffarm-docs.1").exists());
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        assert!(folder.ok(&format!("completions {shell}")).contains("stiffarm"), "{shell}");
    }
}

#[test]
fn displacements_in_metres_are_suspected() {
    let folder = Folder::new();
    let metres: String = measurements()
        .lines()
        .map(|line| {
            let fields: Vec<String> = line
                .split(',')
                .enumerate()
                .map(|(i, field)| match (i, field.parse::<f64>()) {
                    (3..=5, Ok(mm)) => (mm / 1e3).to_string(),
                    _ => field.to_string(),
                })
                .collect();
            fields.join(",") + "\n"
        })
        .collect();
    folder.write("metres.csv", metres);
    let ran = folder.run("identify builtin:comau metres.csv");
    assert_eq!(ran.code, Some(1));
    assert_snapshot!(in_lines(unbroken(ran.out.split("\n\n").next().unwrap())), @r"
    The stiffness cannot be used. The displacements look like metres under a heading in millimetres:
    factor 1000. SERIOUS: The displacements look like metres under a heading in millimetres: factor
    1000. As typed, the joint stiffness comes out 1004 times above the prior, all joints alike. Only
    this comparison speaks for it: look at the numbers before relying on the result. Check dx_mm, dy_mm,
    dz_mm.
    ");
    // One fault is one finding: the stiffness that follows from it is none of its own.
    assert_eq!(ran.out.matches("SERIOUS").count(), 1, "{}", ran.out);
}

#[test]
fn a_serious_finding_of_the_residuals_ends_with_one() {
    let folder = Folder::new();
    folder.ok("select builtin:comau --space-filling -n 24 --output plan.csv");
    folder.ok("simulate builtin:comau plan.csv --runs 2 --measurements sound.csv");
    assert_eq!(folder.run("identify builtin:comau sound.csv").code, Some(0));
    // More slips than single readings explain: every third posture, each of another size.
    let slipped = |(row, line): (usize, &str)| {
        let mut fields: Vec<String> = line.split(',').map(String::from).collect();
        if row % 12 == 1 {
            let count = (row / 12) as f64;
            let dx: f64 = fields[3].parse().unwrap();
            let slip = (0.3 + 0.1 * count) * (-1_f64).powf(count);
            fields[3] = (dx + slip).to_string();
        }
        fields.join(",") + "\n"
    };
    let sound = folder.read("sound.csv");
    let slips: String = sound.lines().enumerate().map(slipped).collect();
    folder.write("slips.csv", slips);
    let ran = folder.run("identify builtin:comau slips.csv --report page.html");
    assert!(ran.out.starts_with("SERIOUS: "), "{}", ran.out);
    let verdict = paragraphs(&folder.read("page.html"), "verdict");
    assert_eq!(verdict.lines().next(), Some("✗ Not usable as it is"));
    assert_eq!(ran.code, Some(1));
}
