//! Files are checked before the work, written whole or not at all, and no result is lost with them.

use crate::support;

use insta::assert_snapshot;
use std::collections::BTreeSet;
use std::fs;
use support::{Folder, measurements};

const PLAN: &str = "select builtin:comau --initial builtin:comau-group1";

#[test]
fn two_results_in_one_file_are_refused_in_every_spelling() {
    let folder = Folder::new();
    fs::create_dir(folder.path("a")).unwrap();
    let absolute = folder.path("p.csv").display().to_string();
    let mut messages = Vec::new();
    for other in ["p.csv", "./p.csv", "a/../p.csv", &absolute] {
        let line = format!("{PLAN} --output p.csv --sheet {other}");
        let error = folder.error(&line);
        assert_eq!(error["code"], "usage", "{other}");
        messages.push(error["message"].clone());
        folder.refused(&line);
    }
    messages.dedup();
    assert_snapshot!(serde_json::Value::from(messages), @r#"["Two results would go to the same file."]"#);
    assert_eq!(folder.names(), ["a"]);
}

#[cfg(unix)]
#[test]
fn links_and_second_names_are_the_same_file() {
    let folder = Folder::new();
    folder.write("p.csv", "old");
    std::os::unix::fs::symlink("p.csv", folder.path("link.csv")).unwrap();
    fs::hard_link(folder.path("p.csv"), folder.path("second.csv")).unwrap();
    for other in ["link.csv", "second.csv"] {
        assert_eq!(folder.error(&format!("{PLAN} --output p.csv --sheet {other} --force"))["code"], "usage", "{other}");
    }
    assert_eq!(folder.read("p.csv"), "old");
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_is_not_replaced_unasked() {
    let folder = Folder::new();
    std::os::unix::fs::symlink("real.csv", folder.path("link.csv")).unwrap();
    let line = format!("{PLAN} --output link.csv");
    assert_snapshot!(folder.each_refused(&[(line.as_str(), "file-exists", "link.csv")]), @r"
    $ stiffarm select builtin:comau --initial builtin:comau-group1 --output link.csv
    file-exists

      × link.csv: This is a link to a file that is not there.
      help: add --force to overwrite it, or choose another name
    ");
    assert!(folder.path("link.csv").is_symlink());
    // The second time it is a link to a file.
    for _ in 0..2 {
        folder.ok(&format!("{line} --force"));
        assert!(folder.path("link.csv").is_symlink());
        assert!(folder.read("real.csv").starts_with("posture"));
    }
    // A device is written in place.
    folder.ok(&format!("{PLAN} --output /dev/null"));
    std::os::unix::fs::symlink("circle.csv", folder.path("circle.csv")).unwrap();
    assert_eq!(folder.run(&format!("{PLAN} --output circle.csv --force")).code, Some(2));
}

#[cfg(unix)]
#[test]
fn standard_input_is_not_overwritten() {
    use std::process::Stdio;
    let folder = Folder::with("m.csv", measurements());
    let before = folder.read("m.csv");
    let output = support::command(&folder.path(""))
        .args("identify builtin:comau - --output m.csv --force".split(' '))
        .stdin(Stdio::from(fs::File::open(folder.path("m.csv")).unwrap()))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert_snapshot!(String::from_utf8_lossy(&output.stderr), @r"
    conflict

      × standard input: This file is an input of the same command, and it is not overwritten even with --force.
      help: give the output another name
    ");
    assert_eq!(folder.read("m.csv"), before);
}

#[test]
fn what_cannot_be_written_is_refused_before_the_work() {
    let folder = Folder::new();
    folder.write("plan.csv", stiffarm_files::builtin::postures_text("comau-group1").unwrap());
    let refused = folder.each_refused(&[
        // An input as output.
        (
            "select builtin:comau --given plan.csv --add 2 --rounds 100000 --output ./plan.csv --force",
            "conflict",
            "plan.csv",
        ),
        // A rehearsal needs a file; that is said before anything is read, let alone simulated.
        ("simulate none.toml none.csv --slowly 1 --readings -", "usage", ""),
    ]);
    assert_snapshot!(refused);
}

#[cfg(unix)]
#[test]
fn permissions_stay() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    folder.write("p.csv", "secret");
    for mode in [0o600, 0o640, 0o666, 0o444] {
        fs::set_permissions(folder.path("p.csv"), fs::Permissions::from_mode(mode)).unwrap();
        folder.ok(&format!("{PLAN} --output p.csv --force"));
        let meta = fs::metadata(folder.path("p.csv")).unwrap();
        assert_eq!(meta.permissions().mode() & 0o777, mode);
    }
}

#[test]
fn names_may_be_as_long_as_the_system_lets_them() {
    let folder = Folder::new();
    let name = format!("{}.csv", "p".repeat(246));
    folder.ok(&format!("{PLAN} --output {name}"));
    assert_eq!(folder.names(), [name]);
    let ran = folder.run(&format!("{PLAN} --output {}.csv", "p".repeat(300)));
    assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{}", ran.err);
}

#[test]
fn what_killed_runs_left_goes_with_the_next_run_into_the_same_folder() {
    let folder = Folder::new();
    // Of a run that is killed while it writes, whatever it writes; the second is named as earlier versions did.
    folder.write(".stiffarm-0000000000000001.tmp", "half");
    folder.write(".stiffarm-0000000000000002-0000000000000003.tmp", "half");
    let alive = ".stiffarm-0000000000000004.tmp";
    folder.write(alive, "another run, still at work");
    let lock = fs::OpenOptions::new().write(true).open(folder.path(alive)).unwrap();
    lock.lock().unwrap();
    // Neither a file nor of this program.
    fs::create_dir(folder.path(".stiffarm-folder.tmp")).unwrap();
    folder.write("mine.tmp", "other");
    folder.ok(&format!("{PLAN} --output p.csv"));
    assert_eq!(folder.names(), [alive, ".stiffarm-folder.tmp", "mine.tmp", "p.csv"]);
    drop(lock);
    folder.ok(&format!("{PLAN} --output other.csv"));
    assert_eq!(folder.names(), [".stiffarm-folder.tmp", "mine.tmp", "other.csv", "p.csv"]);
}

#[test]
fn a_file_that_appears_while_the_command_runs_is_kept() {
    use std::io::Write;
    use std::process::Stdio;
    let folder = Folder::with("m.csv", measurements());
    let line = "identify builtin:comau - --brief --output k.json --report r.html";
    for appears in ["k.json", "r.html"] {
        // It has looked at its targets and waits for its input.
        let mut run = support::command(&folder.path(""))
            .args(line.split(' '))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(500));
        folder.write(appears, "mine");
        let mut input = run.stdin.take().unwrap();
        input.write_all(folder.read("m.csv").as_bytes()).unwrap();
        drop(input);
        let output = run.wait_with_output().unwrap();
        let err = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{err}");
        assert!(err.starts_with("file-exists\n") && err.contains(appears), "{err}");
        assert_eq!(folder.read(appears), "mine");
        // The result is not lost with it.
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        let rows = printed.lines().filter_map(|line| line.split("  ").next()).filter(|name| name.starts_with("joint "));
        let rows: Vec<&str> = rows.take(6).collect();
        assert_eq!(rows, ["joint 1", "joint 2", "joint 3", "joint 4", "joint 5", "joint 6"], "{printed}");
        for name in ["k.json", "r.html"] {
            let _ = fs::remove_file(folder.path(name));
        }
        assert_eq!(folder.names(), ["m.csv"]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_files_is_refused_before_the_work() {
    // Nobody makes a file in /proc, the superuser neither.
    let folder = Folder::new();
    folder.ok(&format!("{PLAN} --output p.csv"));
    for line in [
        "select builtin:comau --rounds 1000000 --output /proc/p.csv",
        "study --output-dir /proc/study",
        "simulate builtin:comau p.csv --runs 1000000 --readings /proc/r.csv",
        "map builtin:comau prior --steps 400,400,400 --output-dir /proc/map",
        "zones builtin:comau --steps 2000 --output-dir /proc/zones",
        "compensate builtin:comau prior builtin:contour --output /proc/c.csv",
    ] {
        folder.refused(line);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_is_full_costs_the_file_and_not_the_result() {
    let folder = Folder::new();
    let ran = folder.run(&format!("{PLAN} --output /dev/full"));
    assert_eq!(ran.code, Some(2));
    assert_snapshot!(ran.err, @r"
    file-write

      × /dev/full: The file cannot be written: No space left on device (os error 28).
      help: check the folder's permissions and the free space
    ");
    // The plan that was to be written, and the table.
    for begin in ["posture,q1_deg,", "cell: builtin:comau"] {
        assert_eq!(ran.out.lines().filter(|line| line.starts_with(begin)).count(), 1, "{begin}: {}", ran.out);
    }
    let with_object = folder.run(&format!("{PLAN} --output /dev/full --json"));
    assert_eq!((with_object.code, &with_object.err), (Some(2), &ran.err));
    assert!(serde_json::from_str::<serde_json::Value>(&with_object.out).is_ok(), "{}", with_object.out);
    let line = "compensate builtin:comau prior builtin:contour --output /dev/full";
    let ran = folder.run(line);
    assert_eq!(ran.code, Some(2));
    assert!(!ran.out.contains("wrote") && ran.out.lines().count() > 60, "{}", ran.out);
}

/// Command lines with the options for a file that each has; `*` stands for the option and its value.
const WITH_OUTPUTS: [(&str, &[&str]); 17] = [
    ("check builtin:comau --force *", &["--figure x.svg", "--report x.html"]),
    (
        "select builtin:comau --initial builtin:comau-group1 --force *",
        &["--output x.csv", "--sheet x.csv", "--figure x.svg", "--print x.html", "--report x.html"],
    ),
    ("select builtin:comau --curve -n 2 --rounds 1 --force *", &["--output x.csv", "--report x.html"]),
    ("evaluate builtin:comau builtin:comau-group1 --force *", &["--report x.html"]),
    (
        "simulate builtin:comau builtin:comau-group1 --runs 2 --force *",
        &["--measurements x.csv", "--readings x.csv", "--report x.html"],
    ),
    (
        "simulate builtin:comau builtin:comau-group1 --runs 2 --elastic mixed --force *",
        &["--measurements x.csv", "--report x.html"],
    ),
    ("coverage builtin:comau builtin:comau-group1 --runs 2 --force *", &["--report x.html"]),
    ("register builtin:example-pairs --force *", &["--output x.json"]),
    ("identify builtin:comau m.csv --brief --force *", &["--output x.json", "--report x.html"]),
    ("validate builtin:comau k.json m.csv --force *", &["--report x.html"]),
    ("predict builtin:comau prior builtin:contour --force *", &["--output x.csv", "--figure x.svg", "--report x.html"]),
    (
        "compensate builtin:comau prior builtin:contour --force *",
        &["--output x.csv", "--figure x.svg", "--report x.html"],
    ),
    ("map builtin:comau prior --plane z=800 --steps 7 --force *", &["--report x.html"]),
    ("zones builtin:comau --steps 5 --force *", &["--report x.html"]),
    ("pose builtin:comau builtin:comau-group1 --force *", &["--output x.csv"]),
    ("route builtin:comau builtin:comau-group1 --force *", &["--output x.csv", "--report x.html"]),
    ("report k.json --force *", &["--output x.html"]),
];

/// Standard output takes one result, the bytes of the file that it would be, and nothing else.
#[test]
fn what_goes_to_standard_output_is_the_file_and_nothing_else() {
    let folder = Folder::with("m.csv", measurements());
    folder.ok("identify builtin:comau m.csv --brief --output k.json");
    let mut refused = BTreeSet::new();
    let to_stdout = |option: &str| {
        let (name, _) = option.split_once(' ').unwrap();
        format!("{name} -")
    };
    for (line, options) in WITH_OUTPUTS {
        for option in options {
            let (_, file) = option.split_once(' ').unwrap();
            folder.ok(&line.replace('*', option));
            let wanted = folder.read(file);
            // With a second file beside it, what is said of that one goes to standard error as well.
            let others = options.iter().enumerate();
            let others = others.filter(|(_, other)| *other != option);
            let named = |(i, other): (usize, &&str)| other.replace(" x.", &format!(" other-{i}."));
            let others: Vec<String> = others.map(named).collect();
            let all = format!("{} {}", to_stdout(option), others.join(" "));
            let printed = folder.run(&line.replace('*', &all));
            assert_eq!(printed.code, Some(0), "{line} {all}\n{}", printed.err);
            assert!(printed.out == wanted, "{line} {all}\n{}", printed.err);
        }
        // Two results do not fit there, whatever kinds they are.
        for pair in options.windows(2) {
            let both = format!("{} {}", to_stdout(pair[0]), to_stdout(pair[1]));
            refused.insert(folder.refused(&line.replace('*', &both)));
        }
    }
    let refused: Vec<String> = refused.into_iter().collect();
    assert_snapshot!(refused.join("\n"), @r"
    usage

      × Standard output can take one result only.
      help: write one of them to a file
    ");
}
