//! Files that inputs start from: those the project ships, and what its commands make of them.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use stiffarm_files::builtin;
use stiffarm_files::program::{Language, ProgramOptions, Stop, program_of_stops, write_program};

/// Tool paths among the inputs.
const TOOL_PATHS: [&str; 7] =
    ["pocket.nc", "freeform.mpf", "pocket.cls", "freeform.apt", "edge.src", "edge.mod", "edge.ls"];

/// Stands for a file: what the command prints is the seed.
const PRINTED: &str = "-";

/// What a file is read as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A cell.
    Cell,
    /// Joint angles.
    Postures,
    /// Measured displacements.
    Displacements,
    /// Raw readings.
    Readings,
    /// Readings with the flange fixed.
    Clamped,
    /// Points in two frames.
    Pairs,
    /// Poses in Yaskawa's convention.
    Poses,
    /// A path.
    Path,
    /// A recorded load along a path.
    Log,
    /// A path as CL data, G-code or a robot's program.
    ToolPath,
    /// A saved stiffness.
    Stiffness,
    /// A saved registration.
    Registration,
    /// Any saved result.
    Saved,
    /// A robot description.
    Urdf,
    /// Denavit–Hartenberg rows.
    Rows,
    /// A controller program; two files stand one after the other.
    Program,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Kind; 16] = [
        Kind::Cell,
        Kind::Postures,
        Kind::Displacements,
        Kind::Readings,
        Kind::Clamped,
        Kind::Pairs,
        Kind::Poses,
        Kind::Path,
        Kind::Log,
        Kind::ToolPath,
        Kind::Stiffness,
        Kind::Registration,
        Kind::Saved,
        Kind::Urdf,
        Kind::Rows,
        Kind::Program,
    ];
}

/// A file to start from.
#[derive(Debug, Clone)]
pub struct Seed {
    /// What it is read as.
    pub kind: Kind,
    /// Its text.
    pub text: String,
}

/// All seeds.
pub fn all() -> &'static [Seed] {
    static SEEDS: OnceLock<Vec<Seed>> = OnceLock::new();
    SEEDS.get_or_init(|| {
        let folder = Scratch::new("seeds");
        gathered(&folder)
    })
}

/// The seeds of a kind.
pub fn of(kind: Kind) -> Vec<&'static str> {
    let fit = all().iter().filter(|seed| seed.kind == kind);
    fit.map(|seed| seed.text.as_str()).collect()
}

/// Group 1 in every language.
fn programs() -> Vec<String> {
    let Ok(cell) = builtin::cell("comau") else {
        return Vec::new();
    };
    let postures = builtin::postures("comau-group1", &cell.setup.robot).unwrap_or_default();
    let stop = |posture| Stop::new(posture, "measure unloaded, loaded");
    let stops: Vec<Stop> = postures.into_iter().map(stop).collect();
    let written = |language: &Language| {
        let program = program_of_stops(language.name_for("plan"), vec![], &stops, None, 10);
        let files = write_program(&program, *language, &program_options(*language));
        let files = files.unwrap_or_default();
        files.into_iter().map(|file| file.text).collect()
    };
    Language::ALL.iter().map(written).collect()
}

/// What a language needs beside the program.
pub fn program_options(language: Language) -> ProgramOptions {
    ProgramOptions {
        pulses_per_degree: (language == Language::Inform).then(|| vec![1000.0; 6]),
        ..ProgramOptions::default()
    }
}

fn gathered(folder: &Scratch) -> Vec<Seed> {
    let mut seeds = Vec::new();
    let mut add = |kind, text: String| seeds.push(Seed { kind, text });
    for name in builtin::cell_names() {
        add(Kind::Cell, builtin::cell_text(name).unwrap_or_default().to_string());
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../xtask/inputs");
    let input = |name: &str| std::fs::read_to_string(root.join(name)).unwrap_or_default();
    for name in ["five", "full", "measured", "seven", "weight", "dark"] {
        add(Kind::Cell, input(&format!("{name}.toml")));
    }
    let group = builtin::postures_text("comau-group1").unwrap_or_default();
    add(Kind::Postures, group.to_string());
    for text in programs() {
        add(Kind::Program, text);
    }
    add(Kind::Postures, input("given.csv"));
    add(Kind::Pairs, builtin::pairs_text("example-pairs").unwrap_or_default().to_string());
    add(Kind::Pairs, input("pairs-wrong.csv"));
    let poses = "posture,x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\nA,1800,200,1500,180,-60.5,10\nB,1500,0,2000,0,90,0\n";
    add(Kind::Poses, poses.to_string());
    add(Kind::Path, builtin::path_text("contour").unwrap_or_default().to_string());
    for name in ["axes", "forces", "straight", "near-poses", "poses"] {
        add(Kind::Path, input(&format!("{name}.csv")));
    }
    for log in [
        "along_mm,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm\n0,-3,0.5,1,0,0,0\n150,-188,41,63,0.1,-2,0.4\n2000,12,-4,0,0,0,0\n",
        "time_s;power_kW\n0;0,18\n5;0,65\n5;0,7\n2000;0,2\n",
    ] {
        add(Kind::Log, log.to_string());
    }
    for name in TOOL_PATHS {
        add(Kind::ToolPath, input(name));
    }
    add(Kind::Rows, input("rows.csv"));
    add(Kind::Urdf, input("arm.urdf"));
    for name in ["without-angles", "wrong-sign"] {
        add(Kind::Displacements, input(&format!("{name}.csv")));
    }
    add(Kind::Clamped, input("clamped.csv"));
    add(Kind::Stiffness, input("bare.json"));
    std::fs::write(folder.path("clamped.csv"), input("clamped.csv")).unwrap_or_default();
    const MADE: [(&str, &str, Kind); 19] = [
        (
            "simulate builtin:comau builtin:comau-group1 --runs 1 --levels 1 --measurements m.csv",
            "m.csv",
            Kind::Displacements,
        ),
        ("simulate builtin:comau builtin:comau-group1 --runs 1 --levels 1 --readings r.csv", "r.csv", Kind::Readings),
        (
            "select builtin:comau --initial builtin:comau-group1 --max-iterations 1 --sheet s.csv --states up,down --drift --base-reflector",
            "s.csv",
            Kind::Readings,
        ),
        ("identify builtin:comau m.csv --brief --output a.json", "a.json", Kind::Stiffness),
        ("identify builtin:comau m.csv --output b.json", "b.json", Kind::Stiffness),
        ("identify builtin:comau r.csv --output c.json", "c.json", Kind::Stiffness),
        ("identify builtin:comau clamped.csv --clamped --output d.json", "d.json", Kind::Stiffness),
        ("identify builtin:comau m.csv --brief --estimator prior --output e.json", "e.json", Kind::Stiffness),
        ("identify builtin:comau m.csv --brief --elastic mixed --output f.json", "f.json", Kind::Stiffness),
        ("register builtin:example-pairs --output reg.json", "reg.json", Kind::Registration),
        ("select builtin:comau-shapes -n 2 --rounds 1 --no-certificate --json", PRINTED, Kind::Saved),
        ("select builtin:comau --curve -n 3 --rounds 1 --json", PRINTED, Kind::Saved),
        ("evaluate builtin:comau builtin:comau-group1 --json", PRINTED, Kind::Saved),
        ("simulate builtin:comau builtin:comau-group1 --runs 2 --levels 1 --json", PRINTED, Kind::Saved),
        ("validate builtin:comau b.json m.csv --json", PRINTED, Kind::Saved),
        ("predict builtin:comau b.json --json", PRINTED, Kind::Saved),
        ("map builtin:comau prior --plane z=800 --steps 3 --json", PRINTED, Kind::Saved),
        ("study builtin:comau --runs 1 --initial-groups 0 --output-dir folder --json", PRINTED, Kind::Saved),
        ("init --robot kuka-kr240-2 --output-dir .", "cell.toml", Kind::Cell),
    ];
    for (line, file, kind) in MADE {
        let ran = folder.run(line.split(' ').map(String::from));
        if file == PRINTED {
            add(kind, ran.out);
            continue;
        }
        match std::fs::read_to_string(folder.path(file)) {
            Ok(text) => add(kind, text),
            // A seed that cannot be made is a fault of its own, and told by the tests.
            Err(_) => eprintln!("no seed from `{line}`: {}{}", ran.out, ran.err),
        }
    }
    seeds
}

/// A folder for the files of one process; it goes with this value.
pub struct Scratch(PathBuf);

impl Scratch {
    /// A new folder, in memory where the system has such a place.
    pub fn new(name: &str) -> Self {
        use std::sync::atomic::{AtomicUsize, Ordering};
        static NUMBER: AtomicUsize = AtomicUsize::new(0);
        let memory = Path::new("/dev/shm");
        let base = if memory.is_dir() { memory.to_path_buf() } else { std::env::temp_dir() };
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let path = base.join(format!("stiffarm-fuzz-{}-{name}-{number}", std::process::id()));
        // What is wrong with it shows at the first file.
        let _ = std::fs::create_dir_all(&path);
        Scratch(path)
    }

    /// A file in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Runs a command line in which names of files mean those of this folder.
    pub fn run(&self, words: impl IntoIterator<Item = String>) -> stiffarm_cli::Captured {
        let mut line = vec![OsString::from("stiffarm")];
        line.extend(words.into_iter().map(|word| self.placed(&word)));
        stiffarm_cli::run_captured(&line, stiffarm_cli::Host::default())
    }

    /// A word; the name of a file becomes its path.
    fn placed(&self, word: &str) -> OsString {
        let ends = [".csv", ".html", ".json", ".toml", ".svg", ".xlsx"];
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '.' || c == '-';
        let is_file = ends.iter().any(|end| word.ends_with(end)) && word.chars().all(plain);
        if is_file || word == "." || word == "folder" { self.path(word).into_os_string() } else { OsString::from(word) }
    }

    /// Takes all files away.
    pub fn clear(&self) {
        let _ = std::fs::remove_dir_all(&self.0);
        let _ = std::fs::create_dir_all(&self.0);
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_a_seed() {
        for kind in Kind::ALL {
            assert!(!of(kind).is_empty(), "{kind:?}");
        }
        assert!(all().iter().all(|seed| !seed.text.is_empty()));
    }
}
