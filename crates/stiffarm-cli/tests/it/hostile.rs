//! Text that comes from files stays text: in the terminal, in objects, pages and tables.

use crate::support;

use insta::assert_snapshot;
use stiffarm::findings::is_hidden;
use support::{Folder, HEADING, Ran, command};

/// Names that are more than letters, one for each reason to refuse them.
const NAMES: [&str; 3] = ["a\u{1b}[31mred", "a\u{202e}gpj", "=cmd|' /C calc'!A0"];

/// Nothing a terminal obeys, and no line that hides another.
fn assert_shown(ran: &Ran) {
    for text in [&ran.out, &ran.err] {
        let hidden = text.chars().find(|c| is_hidden(*c) && !"\n\t".contains(*c));
        assert_eq!(hidden, None, "{text:?}");
    }
}

/// The words as they are, blanks in them included.
fn run(folder: &Folder, words: &[&str]) -> Ran {
    let output = command(&folder.path("")).args(words).output().unwrap();
    Ran {
        code: output.status.code(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

#[test]
fn names_that_are_more_than_letters_are_refused_with_their_place() {
    let folder = Folder::new();
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    let line = "select builtin:comau --initial builtin:comau-group1 --sheet s.csv --states";
    let mut said = String::new();
    for name in NAMES {
        folder.write("p.csv", format!("{HEADING}ok,0,0,-90,0,20,0\n\"{name}\",0,0,-80,0,20,0\n"));
        said += &folder.each_refused(&[("evaluate builtin:comau p.csv", "table-row", "p.csv:3:1 posture")]);
        assert_shown(&folder.run("evaluate builtin:comau p.csv"));
        assert_shown(&folder.run("evaluate builtin:comau p.csv --json"));

        let escaped: String = name.chars().map(|c| format!("\\U{:08x}", u32::from(c))).collect();
        folder.write("cell.toml", cell.replacen("name = \"", &format!("name = \"{escaped}"), 1));
        let ran = folder.run("check cell.toml");
        assert_eq!(ran.code, Some(2), "{name:?}\n{}", ran.out);
        assert_shown(&ran);

        let ran = run(&folder, &[line.split(' ').collect(), vec![name]].concat());
        assert_eq!(ran.code, Some(2), "{name:?}\n{}", ran.out);
        assert_shown(&ran);
    }
    assert_eq!(folder.names(), ["cell.toml", "p.csv"]);
    let ran = run(&folder, &[line.split(' ').collect(), vec!["a\nb"]].concat());
    assert_eq!(ran.code, Some(2));
    assert_snapshot!(said + &ran.err);
}

#[test]
fn signs_before_letters_and_digits_are_names_and_stay_the_same() {
    let folder = Folder::new();
    let line = "select builtin:comau --initial builtin:comau-group1 --sheet s.csv --states";
    let ran = run(&folder, &[line.split(' ').collect(), vec!["+z 250,down_1"]].concat());
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    let sheet = folder.read("s.csv");
    assert!(sheet.lines().any(|row| row.split(',').nth(1) == Some("+z 250")), "{sheet}");
}

#[test]
fn quoted_lines_keys_and_file_names_are_shown_in_letters() {
    let folder = Folder::new();
    for hidden in ["\u{1b}]0;title\u{7}", "\u{202e}", "\u{9b}1m"] {
        folder.write("p.csv", format!("{HEADING}a,0,0,x{hidden}y,0,20,0\n"));
        folder.write("h.csv", format!("posture,q1{hidden}\n1,2\n"));
        folder.write("c.toml", format!("# {hidden}\n[robot]\n\"na{hidden}me\" = 1\n"));
        folder.write(
            "k.json",
            format!(
                "{{\"stiffness_nm_per_rad\": [1], \"a{}\": 1}}",
                hidden.escape_unicode().to_string().replace("\\u{", "\\u00").replace('}', "")
            ),
        );
        for line in [
            "evaluate builtin:comau p.csv",
            "evaluate builtin:comau h.csv",
            "check c.toml",
            "predict builtin:comau k.json",
        ] {
            let ran = folder.run(line);
            assert_eq!(ran.code, Some(2), "{line}\n{}", ran.out);
            assert_shown(&ran);
            assert_shown(&folder.run(&format!("{line} --json")));
        }
        let name = format!("no{hidden}\nwhere.toml");
        assert_shown(&run(&folder, &["check", &name]));
        let ran = run(&folder, &["check", &name, "--json"]);
        assert_shown(&ran);
        assert_shown(&run(&folder, &["check", "--no", &name, &format!("--{name}")]));
        assert_shown(&run(&folder, &["select", "builtin:comau", "--output", &format!("{name}/x")]));
    }
}

#[cfg(unix)]
#[test]
fn a_file_name_of_two_lines_makes_one() {
    let folder = Folder::new();
    folder.write("a\ncell: b\u{1b}[1m.toml", stiffarm_files::builtin::cell_text("comau").unwrap());
    let ran = run(&folder, &["check", "a\ncell: b\u{1b}[1m.toml"]);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    assert_shown(&ran);
    let cells: Vec<&str> = ran.out.lines().filter(|line| line.starts_with("cell: ")).collect();
    assert_snapshot!(cells.join("\n"), @r"cell: a\ncell: b\u{1b}[1m.toml (COMAU NJ 165-3.0, rope load)");
}

#[test]
fn a_line_as_long_as_its_file_gives_a_short_error() {
    let folder = Folder::new();
    folder.write("p.csv", format!("{HEADING}a,0,0,{},0,20,0\n", "x".repeat(4_000_000)));
    for line in ["evaluate builtin:comau p.csv", "evaluate builtin:comau p.csv --json"] {
        let ran = folder.run(line);
        assert_eq!(ran.code, Some(2));
        assert!(ran.err.len() + ran.out.len() < 20_000);
    }
    folder.write("c.toml", format!("a = {}\n", "1".repeat(1_000_000)));
    let ran = folder.run("check c.toml");
    assert_eq!(ran.code, Some(2));
    assert!(ran.err.len() < 20_000);
}

#[cfg(target_os = "linux")]
#[test]
fn more_threads_than_a_machine_can_start_are_no_fault_of_the_program() {
    let folder = Folder::new();
    let line = format!("ulimit -v 1500000; '{}' check --threads 1024", env!("CARGO_BIN_EXE_stiffarm"));
    let output = std::process::Command::new("sh").current_dir(folder.path("")).args(["-c", &line]).output().unwrap();
    assert!(matches!(output.status.code(), Some(0 | 2)), "{}", String::from_utf8_lossy(&output.stderr));
}
