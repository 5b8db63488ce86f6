//! Whole commands in this process, on mutated files or with mutated options.

use super::Verdict;
use super::readers::{self, written_again};
use crate::input::Input;
use crate::mutate::{COUNTS, Grammar, WORDS, edge_number, mutate};
use crate::oracle;
use crate::random::Random;
use crate::seeds::{self, Kind, Scratch};
use serde_json::Value;
use std::cell::RefCell;
use std::collections::HashMap;
use stiffarm_files::cell::parse_cell_bytes;
use stiffarm_files::registration::read_registration;
use stiffarm_files::stiffness::read_stiffness;
use stiffarm_files::table::{read_measurements, read_path, read_postures, write_postures};

/// Command lines that end soon; files by the names of [`FILES`], `out.…` is written.
/// After `|` the schema of their object.
const LINES: [&str; 53] = [
    "check cell.toml | check",
    "check cell.toml --figure out.svg | check",
    "check builtin:comau --postures postures.csv --figure out.svg | check",
    "evaluate cell.toml postures.csv | evaluate",
    "evaluate builtin:comau postures.csv | evaluate",
    "select cell.toml -n 3 --rounds 1 --output out.csv --sheet out-sheet.csv | select",
    "select cell.toml -n 2 --rounds 1 --no-certificate | select",
    "select cell.toml --initial builtin:comau-group1 --max-iterations 1 --output out.csv | select",
    "select builtin:comau --initial postures.csv --max-iterations 1 | select",
    "select builtin:comau --given postures.csv --add 1 --rounds 1 --no-certificate | select",
    "select builtin:comau --given postures.csv --drop | select-drop",
    "simulate cell.toml builtin:comau-group1 --runs 2 --levels 1 --measurements out-m.csv --readings out-r.csv | simulate",
    "simulate builtin:comau postures.csv --runs 2 --levels 1 | simulate",
    "register pairs.csv --output out-reg.json | register",
    "register pairs.csv --std-mm 0.1 | register",
    "identify cell.toml m.csv --brief --output out.json | identify",
    "identify builtin:comau m.csv --output out.json | identify",
    "identify builtin:comau m.csv --brief --output out.json | identify",
    "identify builtin:comau m.csv --estimator huber --brief | identify",
    "identify builtin:comau m.csv --estimator prior --brief --output out.json | identify",
    "identify builtin:comau r.csv --brief --output out.json | identify",
    "identify builtin:comau r.csv | identify",
    "identify builtin:comau r.csv --registration reg.json --brief | identify",
    "identify builtin:comau clamped.csv --clamped --output out.json | identify-clamped",
    "validate builtin:comau s.json m.csv | validate",
    "validate cell.toml s.json m.csv --model equilibrium | validate",
    "validate builtin:comau m.csv --folds all | validate",
    "predict builtin:comau s.json path.csv --axes base --force-n 100,-200,300 --output out.csv | predict",
    "predict builtin:comau s.json --matrix | predict",
    "predict cell.toml prior builtin:contour | predict",
    "predict cell.toml s.json postures.csv --cell-load | predict",
    "compensate builtin:comau s.json path.csv --axes base --force-n 100,-200,300 --output out-path.csv | compensate",
    "compensate cell.toml prior builtin:contour --output out-path.csv | compensate",
    "pose cell.toml postures.csv --output out-poses.csv | pose",
    "pose builtin:comau --poses poses.csv --convention yaskawa --output out.csv | pose-poses",
    "route cell.toml postures.csv --output out.csv | route",
    "route builtin:comau-shapes postures.csv | route",
    "measure builtin:comau postures.csv r.csv --once --until 3% | measure",
    "measure cell.toml builtin:comau-group1 m.csv --once --no-search | measure",
    "export cell.toml postures.csv --language krl --controller kuka --output-dir folder | export",
    "export builtin:comau postures.csv --language rapid --controller abb --output-dir folder --despite-limits | export",
    "map builtin:comau s.json --plane z=800 --steps 3 | map",
    "map cell.toml prior --plane z=800 --steps 3 --output-dir folder | map",
    "map cell.toml prior --place builtin:contour --steps 2 --refine 0 | map-place",
    "zones cell.toml --steps 3 --output-dir folder | zones",
    "capsules builtin:spindle.obj --unit mm --most 1 | capsules",
    "study cell.toml --runs 1 --initial-groups 0 --output-dir folder | study",
    "report s.json --output out.html | report",
    "report result.json --output out.html | report",
    "report result.json s.json --cell cell.toml --output out.html | report",
    "report result.json --figures folder --format csv,svg | report",
    "identify cell.toml m.csv --brief --report out.html | identify",
    "evaluate cell.toml postures.csv --report out.html | evaluate",
];

/// Files of the lines.
const FILES: [(&str, Kind, Grammar); 11] = [
    ("cell.toml", Kind::Cell, Grammar::Toml),
    ("postures.csv", Kind::Postures, Grammar::Table),
    ("m.csv", Kind::Displacements, Grammar::Table),
    ("r.csv", Kind::Readings, Grammar::Table),
    ("clamped.csv", Kind::Clamped, Grammar::Table),
    ("pairs.csv", Kind::Pairs, Grammar::Table),
    ("poses.csv", Kind::Poses, Grammar::Table),
    ("path.csv", Kind::Path, Grammar::Table),
    ("s.json", Kind::Stiffness, Grammar::Json),
    ("reg.json", Kind::Registration, Grammar::Json),
    ("result.json", Kind::Saved, Grammar::Json),
];

/// Options with how many numbers they take; `c` is one count.
const OPTIONS: [(&str, &str); 40] = [
    ("identify", "--confidence=1"),
    ("identify", "--prior-std-percent=1"),
    ("identify clamped", "--angle-noise-deg=1"),
    ("identify", "--bootstrap=c"),
    ("identify", "--extra=w"),
    ("identify", "--exclude=w"),
    ("validate", "--tolerance-mm=1"),
    ("validate", "--only=w"),
    ("folds", "--folds=c"),
    ("register", "--std-mm=1"),
    ("register", "--exclude=w"),
    ("simulate", "--levels=1"),
    ("simulate", "--levels=3"),
    ("simulate", "--runs=c"),
    ("simulate", "--force-scale-error-percent=1"),
    ("simulate", "--force-error-percent=1"),
    ("simulate", "--joint-angle-error-deg=1"),
    ("simulate", "--loading-point-error-mm=1"),
    ("simulate", "--anchor-error-mm=1"),
    ("select", "--anchor-box-mm=6"),
    ("select", "--loading-point-box-mm=6"),
    ("select", "--largest-load-n=1"),
    ("select", "--time-limit=1"),
    ("select", "--seed=c"),
    ("predict", "--load-uncertainty-percent=1"),
    ("predict", "--force-n=3"),
    ("predict", "--moment-nm=3"),
    ("predict", "--max-step-deg=1"),
    ("predict", "--near-deg=6"),
    ("predict", "--free-turn=c"),
    ("compensate", "--force-n=3"),
    ("compensate", "--max-step-deg=1"),
    ("compensate", "--near-deg=6"),
    ("compensate", "--load-uncertainty-percent=1"),
    ("map", "--force-n=3"),
    ("map", "--direction=3"),
    ("map", "--rpy-deg=3"),
    ("map", "--plane=p"),
    ("place", "--yaw-deg=1"),
    ("zones", "--q-deg=6"),
];

/// The lines that [`OPTIONS`] name; no files but built-in ones and sound ones.
const BASES: [(&str, &str); 11] = [
    ("identify", "identify builtin:comau m.csv --brief | identify"),
    ("identify clamped", "identify builtin:comau clamped.csv --clamped | identify-clamped"),
    ("validate", "validate builtin:comau s.json m.csv | validate"),
    ("folds", "validate builtin:comau m.csv | validate"),
    ("register", "register builtin:example-pairs | register"),
    (
        "simulate",
        "simulate builtin:comau builtin:comau-group1 --measurements out-m.csv --readings out-r.csv | simulate",
    ),
    ("select", "select builtin:comau -n 3 --rounds 1 | select"),
    ("predict", "predict builtin:comau s.json builtin:contour --axes base | predict"),
    ("compensate", "compensate builtin:comau prior builtin:contour --axes base --output out-path.csv | compensate"),
    ("map", "map builtin:comau prior --steps 2 | map"),
    ("zones", "zones --steps 2 | zones"),
];

/// Another line of [`BASES`]: it is not started without its option.
const PLACE: &str = "map builtin:comau prior --place builtin:contour --steps 2 --refine 0 | map-place";

/// A command on files, one of which is mutated most often.
pub fn make(random: &mut Random) -> Input {
    let line = *random.pick(&LINES);
    let named: Vec<&(&str, Kind, Grammar)> =
        FILES.iter().filter(|(name, ..)| line.split(' ').any(|word| word == *name)).collect();
    let chosen = random.below(named.len());
    let all = random.one_in(10);
    let mut files = Vec::new();
    for (i, (name, kind, grammar)) in named.into_iter().enumerate() {
        let text = if i == chosen || all { changed(*kind, *grammar, random) } else { seed(*kind, random).to_string() };
        files.push((name.to_string(), text));
    }
    Input::Command { words: words(line, random), files }
}

/// A mutated file, most often one that its reader takes: what readers refuse they refuse as
/// targets of their own, and a command should get to its work.
fn changed(kind: Kind, grammar: Grammar, random: &mut Random) -> String {
    let mut text = String::new();
    for _ in 0..=random.below(8) {
        let bytes = mutate(seed(kind, random).as_bytes(), grammar, random);
        text = String::from_utf8_lossy(&bytes).into_owned();
        if readers::takes(kind, text.as_bytes()) {
            break;
        }
    }
    text
}

/// A command with options at the edges.
pub fn make_line(random: &mut Random) -> Input {
    let (base, _) = random.pick(&OPTIONS);
    let line = BASES.iter().find(|(name, _)| name == base).map_or(PLACE, |(_, line)| line);
    let mut words = words(line, random);
    let fit: Vec<&str> = OPTIONS.iter().filter(|(b, _)| b == base).map(|(_, o)| *o).collect();
    let count = 1 + random.below(2);
    for _ in 0..count {
        let (name, kind) = random.pick(&fit).split_once('=').unwrap_or_default();
        let value = match kind {
            "c" => random.pick(&COUNTS).to_string(),
            "w" => random.pick(&WORDS).to_string(),
            "p" => format!("{}={}", random.pick(&["x", "y", "z", "w", ""]), edge_number(Some(800.0), random)),
            many => {
                let many = many.parse().unwrap_or(1);
                let numbers: Vec<String> = (0..many).map(|_| edge_number(Some(20.0), random)).collect();
                numbers.join(",")
            }
        };
        words.push(format!("{name}={value}"));
    }
    let files = FILES.iter().filter(|(name, ..)| words.iter().any(|word| word == name));
    let files = files.map(|(name, kind, _)| (name.to_string(), seed(*kind, random).to_string()));
    let files = files.collect();
    Input::Command { words, files }
}

/// The first seeds of a kind are of the cell that the lines name.
fn seed(kind: Kind, random: &mut Random) -> &'static str {
    thread_local! {
        static TEXTS: RefCell<HashMap<u8, Vec<&'static str>>> = RefCell::default();
    }
    TEXTS.with_borrow_mut(|texts| {
        let texts = texts.entry(kind as u8).or_insert_with(|| seeds::of(kind));
        texts[random.below(texts.len())]
    })
}

/// The words of a line, with `--json` in half of all cases.
fn words(line: &str, random: &mut Random) -> Vec<String> {
    let (line, _) = line.split_once(" | ").unwrap_or((line, ""));
    let mut words: Vec<String> = line.split(' ').map(String::from).collect();
    if random.one_in(2) {
        words.push("--json".to_string());
    }
    words
}

/// Runs the command and looks at all that it leaves.
pub fn check(input: &Input) -> Verdict {
    thread_local! {
        static SCRATCH: Scratch = Scratch::new("commands");
    }
    let Input::Command { words, files } = input else {
        return Ok(false);
    };
    SCRATCH.with(|scratch| {
        scratch.clear();
        for (name, text) in files {
            std::fs::write(scratch.path(name), text).map_err(|e| format!("no scratch file: {e}"))?;
        }
        judged(scratch, words, files)
    })
}

fn judged(scratch: &Scratch, words: &[String], files: &[(String, String)]) -> Verdict {
    let ran = scratch.run(words.iter().cloned());
    let json = words.iter().any(|word| word == "--json");
    match ran.code {
        0 | 1 => {}
        2 => {
            if json {
                serde_json::from_str::<Value>(&ran.out).map_err(|e| format!("no object: {e}"))?;
            } else if ran.err.trim().is_empty() {
                return Err("exit code 2 without a message".to_string());
            }
            oracle::text_is_plain(&ran.err)?;
            return Ok(false);
        }
        // Ctrl-C at the terminal, which the command has taken over.
        130 => std::process::exit(130),
        code => return Err(format!("exit code {code}: {}{}", ran.err, ran.out)),
    }
    oracle::text_is_plain(&ran.out)?;
    let input: String = words.join(" ") + &files.iter().map(|(_, text)| text.as_str()).collect::<String>();
    if json {
        let value: Value = serde_json::from_str(&ran.out).map_err(|e| format!("no object: {e}"))?;
        if let Some(schema) = schema(words) {
            oracle::no_null_number(&value, &schema)?;
        }
        if oracle::holds_serious(&value["result"]) && ran.code == 0 {
            return Err("a serious finding, and the exit code says that all is well".to_string());
        }
    } else {
        oracle::text_is_finite(&ran.out, &input)?;
    }
    // A finding may be that the result is not one to go on with.
    if ran.code == 0 {
        outputs_are_read(scratch, words, &input)?;
    }
    Ok(true)
}

/// The schema of a line's object.
fn schema(words: &[String]) -> Option<Value> {
    thread_local! {
        static SCHEMAS: RefCell<HashMap<String, Option<Value>>> = RefCell::default();
    }
    let has = |word: &str| words.iter().any(|w| w.starts_with(word));
    let name = match words.first()?.as_str() {
        "identify" if has("--clamped") => "identify-clamped",
        "select" if has("--drop") => "select-drop",
        "map" if has("--place") => "map-place",
        other => other,
    };
    SCHEMAS.with_borrow_mut(|schemas| {
        let made = schemas.entry(name.to_string()).or_insert_with(|| {
            let line = ["stiffarm", "schema", &format!("result-{name}")].map(std::ffi::OsString::from);
            serde_json::from_str(&stiffarm_cli::run_captured(&line, stiffarm_cli::Host::default()).out).ok()
        });
        made.clone()
    })
}

/// What the command wrote is finite, and what stiffarm reads it reads.
fn outputs_are_read(scratch: &Scratch, words: &[String], input: &str) -> Result<(), String> {
    let text = |name: &str| std::fs::read_to_string(scratch.path(name)).ok();
    for name in [
        "out.csv",
        "out-path.csv",
        "out-m.csv",
        "out-r.csv",
        "folder/map.csv",
        "folder/zones.csv",
        "folder/indices.csv",
        "folder/map.svg",
        "folder/zones.svg",
        "folder/cell.svg",
        "out.svg",
    ] {
        if let Some(text) = text(name) {
            oracle::text_is_finite(&text, input).map_err(|fault| format!("{name}: {fault}"))?;
        }
    }
    let cell = match words.get(1).map(String::as_str) {
        Some("cell.toml") => text("cell.toml").unwrap_or_default(),
        Some(name) => {
            let name = name.trim_start_matches("builtin:");
            stiffarm_files::builtin::cell_text(name).unwrap_or_default().to_string()
        }
        None => return Ok(()),
    };
    let fault = |name: &str, e: stiffarm::Error| {
        let place = e.place();
        format!("{name} was written and is refused: {} ({:?} {:?})", e.message(), place.line, place.key)
    };
    if let Some(text) = text("out-reg.json") {
        read_registration(text.as_bytes(), "r").map_err(|e| fault("out-reg.json", e))?;
    }
    let Ok(cell) = parse_cell_bytes(cell.as_bytes(), "cell") else {
        return Ok(());
    };
    if let Some(text) = text("out.json") {
        read_stiffness(text.as_bytes(), "s", &cell).map_err(|e| fault("out.json", e))?;
    }
    if words.first().is_some_and(|word| word == "select")
        && let Some(text) = text("out.csv")
    {
        let read = |bytes: &[u8]| read_postures(bytes, "p", &cell.setup.robot);
        let postures = read(text.as_bytes()).map_err(|e| fault("out.csv", e))?;
        written_again(&postures, |p| Ok(write_postures(p)), read)?;
    }
    if let Some(text) = text("out-path.csv") {
        let axes = Some(stiffarm::model::process::ForceAxes::Base);
        read_path(text.as_bytes(), "p", &cell, axes).map_err(|e| fault("out-path.csv", e))?;
    }
    for name in ["out-m.csv", "out-r.csv"] {
        if let Some(text) = text(name) {
            read_measurements(text.as_bytes(), "m", &cell, None).map_err(|e| fault(name, e))?;
        }
    }
    Ok(())
}
