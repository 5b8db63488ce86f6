//! Whatever a machine does to a run (killed, its disk full, its output closed, run twice), each file is the old or the
//! new one, never half of either.

use crate::support::{self, Folder};

use insta::assert_snapshot;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};
use support::runs;

/// Runs that write, with the files that they read and the files that they leave.
/// All take a fraction of a second.
const WRITERS: [&str; 8] = [
    "select builtin:comau --initial builtin:comau-group1 --max-iterations 1 --output plan.csv --sheet sheet.csv --figure plan.svg --force",
    "simulate builtin:comau builtin:comau-group1 --runs 2 --levels 1 --measurements m.csv --readings r.csv --force",
    "identify builtin:comau in.csv --brief --output stiffness.json --force",
    "compensate builtin:comau prior builtin:contour --output c.csv --figure c.svg --force",
    "map builtin:comau prior --plane z=800 --steps 7 --output-dir map --force",
    "zones --steps 5 --output-dir zones --force",
    "export builtin:comau builtin:comau-group1 --language krl --controller kuka --output-dir program --force",
    "study --runs 1 --initial-groups 0 --output-dir study --force",
];

/// Text of a file that was there before.
const OLD: &str = "old\n";

/// All files below a folder by their names in it.
fn files(folder: &Path) -> BTreeMap<String, String> {
    let mut texts = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(below) = folders.pop() {
        for entry in fs::read_dir(below).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path)
            } else {
                let name = path.strip_prefix(folder).unwrap().display().to_string();
                let bytes = fs::read(&path).unwrap();
                texts.insert(name, String::from_utf8_lossy(&bytes).into_owned());
            }
        }
    }
    texts
}

fn is_temporary(name: &str) -> bool {
    name.ends_with(".tmp")
}

/// A folder with the input of [`WRITERS`].
fn prepared() -> Folder {
    Folder::with("in.csv", support::measurements())
}

fn start(folder: &Folder, line: &str) -> Child {
    support::command(&folder.path(""))
        .args(line.split(' '))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// What [`WRITERS`] leave when nothing happens, and how long that takes.
fn undisturbed(which: usize) -> &'static (BTreeMap<String, String>, Duration) {
    type Whole = OnceLock<(BTreeMap<String, String>, Duration)>;
    static WHOLE: [Whole; WRITERS.len()] = [const { OnceLock::new() }; WRITERS.len()];
    WHOLE[which].get_or_init(|| {
        let (folder, line) = (prepared(), WRITERS[which]);
        let begin = Instant::now();
        let mut run = start(&folder, line);
        assert!(run.wait().unwrap().success(), "{line}");
        let took = begin.elapsed();
        (files(&folder.path("")), took)
    })
}

#[test]
fn a_killed_run_leaves_old_or_new_files_and_the_next_run_cleans_up() {
    // Each takes about the time of two runs; the last line, the longest, has its turn where
    // more are asked for.
    let kills = runs(WRITERS.len() as u64 - 1);
    // Two numbers that share no factor: the moments cover the run evenly.
    let mut moment = 0.37_f64;
    let folder = prepared();
    for kill in 0..kills {
        let which = (kill % WRITERS.len() as u64) as usize;
        let line = WRITERS[which];
        let (new, took) = undisturbed(which);
        for name in new.keys().filter(|name| *name != "in.csv") {
            let path = folder.path(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, OLD).unwrap();
        }
        moment = (moment + 0.618_033_988_75) % 1.0;
        let mut run = start(&folder, line);
        // The end of a run, where it writes, is tried more often.
        std::thread::sleep(took.mul_f64(1.05 * moment.sqrt()));
        run.kill().unwrap();
        run.wait().unwrap();
        let left = files(&folder.path(""));
        for (name, text) in new.iter() {
            let left = left.get(name).unwrap_or_else(|| panic!("{name} is gone: {line}"));
            assert!(left == text || left == OLD, "{name} is half: {line}\n{left}");
        }
        folder.ok(line);
        let left = files(&folder.path(""));
        let here = left.keys().filter(|name| new.contains_key(*name)).count();
        assert_eq!(here, new.len(), "{line}");
        for (name, text) in new.iter() {
            assert_eq!(left[name], *text, "{name}: {line}");
        }
        let stray: Vec<&String> = left.keys().filter(|name| is_temporary(name)).collect();
        assert!(stray.is_empty(), "{line}: {stray:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_up_in_the_middle_keeps_the_old_file() {
    // A limit on the size of files is a disk that ends in the middle of one.
    let folder = prepared();
    for (line, name, kilobytes) in [
        (WRITERS[1], "r.csv", 1),
        (WRITERS[2], "stiffness.json", 1),
        (WRITERS[3], "c.svg", 1),
        (WRITERS[4], "map/map.svg", 1),
    ] {
        let path = folder.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, OLD).unwrap();
        // SIGXFSZ is ignored, so that the write itself fails.
        let script = format!("trap '' XFSZ; ulimit -f {kilobytes}; exec {} {line}", env!("CARGO_BIN_EXE_stiffarm"));
        let output = support::shell(&folder.path(""), &script).output().unwrap();
        let err = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{line}\n{err}");
        assert!(err.starts_with("file-write\n"), "{line}\n{err}");
        // The result is printed instead.
        assert!(output.stdout.len() > 200, "{line}");
        assert_eq!(folder.read(name), OLD, "{line}");
        let left = files(&folder.path(""));
        assert!(!left.keys().any(|name| is_temporary(name)), "{left:?}");
        folder.ok(line);
        assert_ne!(folder.read(name), OLD);
    }
}

#[cfg(unix)]
#[test]
fn a_closed_standard_output_costs_no_file() {
    let folder = prepared();
    for which in [0, 3, 4] {
        let (line, program) = (WRITERS[which], env!("CARGO_BIN_EXE_stiffarm"));
        // The reader is gone before the first byte; then there never was one.
        for script in [format!("{program} {line} | true"), format!("{program} {line} >&-")] {
            let output = support::shell(&folder.path(""), &script).output().unwrap();
            let err = String::from_utf8_lossy(&output.stderr);
            assert!(!err.contains("failed"), "{script}\n{err}");
        }
        let (new, _) = undisturbed(which);
        let left = files(&folder.path(""));
        for (name, text) in new {
            assert_eq!(left.get(name), Some(text), "{name}: {line}");
        }
    }
}

#[test]
fn two_runs_into_one_folder_leave_whole_files() {
    let folder = prepared();
    for _ in 0..runs(1) {
        for which in [0, 1, 3, 4] {
            let (line, (new, _)) = (WRITERS[which], undisturbed(which));
            let mut both = [start(&folder, line), start(&folder, line)];
            for run in &mut both {
                assert!(run.wait().unwrap().success(), "{line}");
            }
            let left = files(&folder.path(""));
            for (name, text) in new {
                assert_eq!(left.get(name), Some(text), "{name}: {line}");
            }
            assert!(!left.keys().any(|name| is_temporary(name)), "{left:?}");
        }
    }
}

#[test]
fn without_force_one_of_two_runs_wins_and_no_file_is_half() {
    // Several files and one: whoever places the first is the one that ends well.
    for (which, times) in [(5, 5), (2, 5)] {
        let line = WRITERS[which].trim_end_matches(" --force");
        let (new, _) = undisturbed(which);
        for _ in 0..runs(times) {
            let folder = prepared();
            let mut both = [start(&folder, line), start(&folder, line)];
            let codes = both.each_mut().map(|run| run.wait().unwrap().code());
            assert!([[Some(0), Some(2)], [Some(2), Some(0)]].contains(&codes), "{line}: {codes:?}");
            assert_eq!(files(&folder.path("")), *new);
        }
    }
}

#[test]
fn a_target_of_another_kind_is_refused_before_the_work() {
    let folder = prepared();
    fs::create_dir(folder.path("taken")).unwrap();
    folder.write("file", OLD);
    let refused = folder.each_refused(&[
        ("identify builtin:comau in.csv --output taken --force", "file-write", "taken"),
        ("compensate builtin:comau prior builtin:contour --output taken --force", "file-write", "taken"),
        ("study --output-dir file --force", "file-write", "file"),
        ("map builtin:comau prior --plane z=800 --output-dir file --force", "file-write", "file"),
        ("zones --output-dir file/below --force", "file-write", "file/below"),
        ("select builtin:comau --rounds 100000 --output nowhere/plan.csv", "file-write", "nowhere/plan.csv"),
        ("identify builtin:comau in.csv --output file/k.json --force", "file-write", "file/k.json"),
    ]);
    assert_snapshot!(refused.replace('\\', "/"));
    assert_eq!(folder.read("file"), OLD);
    assert_eq!(folder.names(), ["file", "in.csv", "taken"]);
}

#[cfg(unix)]
#[test]
fn a_study_into_a_linked_folder_fills_the_folder() {
    let folder = prepared();
    fs::create_dir(folder.path("real")).unwrap();
    std::os::unix::fs::symlink("real", folder.path("link")).unwrap();
    folder.ok("zones --steps 3 --output-dir link");
    assert!(folder.path("link").is_symlink());
    assert!(folder.path("real/zones.csv").is_file());
}
