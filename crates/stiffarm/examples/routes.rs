//! Routes through random plans in random cells, looked at densely and held against all orders; prints
//! what came out. Ends with 1 where something is wrong.
//!
//! `cargo run --release -p stiffarm --example routes -- 200 [first]`

#[path = "../tests/it/common/mod.rs"]
#[allow(unused_imports)]
mod common;
#[path = "../tests/it/feasible/mod.rs"]
#[allow(dead_code)]
mod feasible;

use feasible::routes::{Looked, look};
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let mut words = std::env::args().skip(1).map(|word| word.parse::<u64>());
    let (Ok(plans), Ok(first)) = (words.next().unwrap_or(Ok(200)), words.next().unwrap_or(Ok(0))) else {
        eprintln!("give the number of plans, and the first cell");
        return ExitCode::from(2);
    };
    let (mut total, mut seen, mut faults, mut number) = (Looked::default(), 0, 0, first);
    while seen < plans {
        let start = Instant::now();
        let looked = look(number);
        let seconds = start.elapsed().as_secs_f64();
        match looked {
            Ok(None) => {}
            Ok(Some(looked)) => {
                seen += 1;
                total.moves += looked.moves;
                total.over_vias += looked.over_vias;
                total.blocked += looked.blocked;
                total.looks += looked.looks;
                total.excess = total.excess.max(looked.excess);
                if seconds > 5.0 || looked.excess > 1e-9 {
                    println!("cell {number}, {seconds:.1} s: {looked:?}");
                }
            }
            Err(what) => {
                faults += 1;
                println!("cell {number}: {what}");
            }
        }
        number += 1;
    }
    println!(
        "{plans} plans: {} moves, {} over via postures, {} without a way; {} looks; the longest order is {:.2} % \
         beyond the best; {faults} faults",
        total.moves,
        total.over_vias,
        total.blocked,
        total.looks,
        100.0 * total.excess
    );
    ExitCode::from(u8::from(faults > 0))
}
