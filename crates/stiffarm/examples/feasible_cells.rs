//! Chooses postures in random cells and holds each against a second reading of the cell's constraints;
//! prints how the cells ended and every fault. Ends with 1 where there is one.
//!
//! `cargo run --release -p stiffarm --example feasible_cells -- 1000 [first]`

#[path = "../tests/it/common/mod.rs"]
#[allow(unused_imports)]
mod common;
#[path = "../tests/it/feasible/mod.rs"]
#[allow(dead_code)]
mod feasible;

use feasible::run::{End, Mode, run};
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let mut words = std::env::args().skip(1).map(|word| word.parse::<u64>());
    let (Ok(count), Ok(first)) = (words.next().unwrap_or(Ok(100)), words.next().unwrap_or(Ok(0))) else {
        eprintln!("give the number of cells, and the first of them");
        return ExitCode::from(2);
    };
    let mut ends = [0_u64; 5];
    let mut slowest = (0.0, first);
    let mut by_mode = Mode::ALL.map(|mode| (mode, 0_u64, 0.0));
    for number in first..first + count {
        let start = Instant::now();
        let (mode, index, end) = run(number);
        let seconds = start.elapsed().as_secs_f64();
        if seconds > slowest.0 {
            slowest = (seconds, number);
        }
        if let Some(tally) = by_mode.iter_mut().find(|tally| tally.0 == mode) {
            tally.1 += 1;
            tally.2 += seconds;
        }
        let kind = match &end {
            End::Postures(_) => 0,
            End::Nothing => 1,
            End::Undetermined => 2,
            End::Refused => 3,
            End::Fault(_) => 4,
        };
        ends[kind] += 1;
        if kind == 4 || seconds > 10.0 || std::env::var_os("ALL_CELLS").is_some() {
            println!("cell {number}, {mode:?}, {}, {seconds:.1} s: {end:?}", index.as_str());
        }
    }
    let [postures, nothing, undetermined, refused, faults] = ends;
    println!(
        "{count} cells: {postures} with postures, {nothing} that allow none, {undetermined} not determined, \
         {refused} refused, {faults} faults; slowest: cell {} in {:.1} s",
        slowest.1, slowest.0
    );
    for (mode, count, seconds) in by_mode {
        println!("{mode:?}: {count} cells in {seconds:.1} s");
    }
    ExitCode::from(u8::from(faults > 0))
}
