//! All targets in several processes: one that dies takes no other with it.

use super::signature;
use super::worker::Tally;
use crate::seeds::Scratch;
use crate::targets::Target;
use std::collections::{BTreeMap, HashMap};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// A process works this long on a target before the next has its turn.
const TURN: Duration = Duration::from_secs(20);

/// A full run.
pub struct Plan {
    /// Targets in turn.
    pub targets: Vec<&'static Target>,
    /// Seed of all inputs.
    pub seed: u64,
    /// The first input of each target.
    pub from: u64,
    /// How many inputs of each target; none is without end.
    pub inputs: Option<u64>,
    /// How long; none is without end.
    pub time: Option<Duration>,
    /// Processes at a time.
    pub threads: usize,
}

/// What is known so far.
#[derive(Default)]
struct Ledger {
    /// Next target of the turn, counted on.
    turn: usize,
    /// Next input and tally by target.
    next: HashMap<&'static str, u64>,
    tallies: BTreeMap<&'static str, Tally>,
    /// Faults by target and signature: how many, the first's index and text.
    faults: BTreeMap<(&'static str, String), (u64, u64, String)>,
    /// Targets at work now: a target is in one process at a time, so that none is done twice.
    busy: Vec<&'static str>,
}

/// Runs the plan; prints what it found and gives the number of different faults.
pub fn run(plan: &Plan) -> usize {
    let ledger = Mutex::new(Ledger::default());
    let scratch = Scratch::new("parent");
    let start = Instant::now();
    std::thread::scope(|scope| {
        for number in 0..plan.threads.max(1) {
            let (ledger, at) = (&ledger, scratch.path(&number.to_string()));
            scope.spawn(move || while turn(plan, ledger, start, &at) {});
        }
    });
    let ledger = ledger.into_inner().unwrap_or_else(|e| e.into_inner());
    report(plan, &ledger, start.elapsed());
    ledger.faults.len()
}

/// One turn of one process; false when there is nothing left to do.
fn turn(plan: &Plan, ledger: &Mutex<Ledger>, start: Instant, at: &Path) -> bool {
    let Ok(mut book) = ledger.lock() else {
        return false;
    };
    let left = plan.time.map(|time| time.saturating_sub(start.elapsed()));
    if left.is_some_and(|left| left.is_zero()) {
        return false;
    }
    let end = plan.inputs.map(|inputs| plan.from.saturating_add(inputs));
    let is_done = |book: &Ledger, target: &Target| {
        end.is_some_and(|end| book.next.get(target.name).is_some_and(|next| *next >= end))
    };
    if plan.targets.iter().all(|target| is_done(&book, target)) {
        return false;
    }
    let free = (0..plan.targets.len())
        .map(|i| plan.targets[(book.turn + i) % plan.targets.len()])
        .find(|target| !book.busy.contains(&target.name) && !is_done(&book, target));
    let Some(target) = free else {
        drop(book);
        std::thread::sleep(Duration::from_millis(100));
        return true;
    };
    let place = plan.targets.iter().position(|other| other.name == target.name);
    book.turn = place.unwrap_or(0) + 1;
    book.busy.push(target.name);
    let from = *book.next.get(target.name).unwrap_or(&plan.from);
    drop(book);
    let shares: u32 = plan.targets.iter().map(|t| t.share).sum();
    let whole = plan.time.map(|time| time * plan.threads as u32 * target.share / shares);
    // Each target has its part of a bounded run, in one turn where it is short.
    let slice = whole.map_or(TURN, |whole| whole.min(TURN * target.share));
    let slice = left.map_or(slice, |left| slice.min(left));
    let inputs = end.map_or(u64::MAX, |end| end - from);
    let done = child(plan, target, (from, inputs, slice), ledger, at);
    if let Ok(mut book) = ledger.lock() {
        book.next.insert(target.name, from + done.max(1));
        book.busy.retain(|name| *name != target.name);
        if plan.time.is_none() && plan.inputs.is_none() {
            summary(target.name, &book);
        }
    }
    true
}

/// Runs one process and takes down what it tells; gives how many inputs it did.
fn child(
    plan: &Plan,
    target: &'static Target,
    (from, inputs, slice): (u64, u64, Duration),
    ledger: &Mutex<Ledger>,
    at: &Path,
) -> u64 {
    let Ok(program) = std::env::current_exe() else {
        return 0;
    };
    let mut command = Command::new(program);
    command
        .args(["--worker", "--target", target.name])
        .args(["--seed", &plan.seed.to_string(), "--from", &from.to_string()])
        .args(["--inputs", &inputs.to_string()])
        .args(["--milliseconds", &slice.as_millis().to_string()])
        .arg("--at")
        .arg(at)
        // Inputs are run side by side, each on one thread.
        .env("RAYON_NUM_THREADS", "1")
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .stdout(Stdio::piped());
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) => {
            eprintln!("a process could not be started: {error}");
            return 0;
        }
    };
    let mut done = None;
    let out = child.stdout.take().map(BufReader::new);
    for line in out.into_iter().flat_map(BufRead::lines).map_while(Result::ok) {
        if let Some(tally) = Tally::of_line(&line) {
            done = Some(tally);
        } else if let Some((index, fault)) = line.strip_prefix("fault ").and_then(|rest| rest.split_once(' ')) {
            note(plan, ledger, target, index.parse().unwrap_or(0), fault);
        }
    }
    let status = child.wait();
    let tally = done.unwrap_or_else(|| {
        // It died: of the input at which it was.
        let text = std::fs::read_to_string(at).unwrap_or_default();
        let index = text.trim().parse().unwrap_or(from);
        let how = status.map_or_else(|e| e.to_string(), |status| status.to_string());
        note(plan, ledger, target, index, &format!("the process ended: {how}"));
        Tally { inputs: index + 1 - from, ..Tally::default() }
    });
    if let Ok(mut book) = ledger.lock() {
        book.tallies.entry(target.name).or_default().add(&tally);
    }
    tally.inputs
}

/// Takes down a fault; the first of its kind is told at once.
fn note(plan: &Plan, ledger: &Mutex<Ledger>, target: &'static Target, index: u64, fault: &str) {
    let fault: String = fault.chars().take(500).collect();
    let Ok(mut book) = ledger.lock() else { return };
    let entry = book.faults.entry((target.name, signature(&fault)));
    let (count, first, _) = entry.or_insert((0, index, fault.clone()));
    *count += 1;
    if *count == 1 {
        println!("fault: {fault}\n  cargo xtask fuzz --target {} --seed {} --input {first}", target.name, plan.seed);
    }
}

fn summary(name: &str, book: &Ledger) {
    let Some(tally) = book.tallies.get(name) else {
        return;
    };
    println!(
        "{name:15} {:>10} inputs, {:>8.0} a second, {:>5.1} % accepted, {} over 1 s, longest {:.2} s (input {}), most memory {:.1} MB (input {})",
        tally.inputs,
        tally.inputs as f64 / tally.seconds.max(1e-9),
        100.0 * tally.accepted as f64 / tally.inputs.max(1) as f64,
        tally.slow,
        tally.longest.0,
        tally.longest.1,
        tally.largest.0 as f64 / 1e6,
        tally.largest.1,
    );
}

fn report(plan: &Plan, book: &Ledger, took: Duration) {
    println!();
    for target in &plan.targets {
        summary(target.name, book);
    }
    let inputs: u64 = book.tallies.values().map(|tally| tally.inputs).sum();
    println!("\n{inputs} inputs in {:.1} s, {} different faults", took.as_secs_f64(), book.faults.len());
    for ((name, _), (count, first, fault)) in &book.faults {
        let short: String = fault.chars().take(300).collect();
        println!("{count:6} x {name} (input {first}): {short}");
    }
}
