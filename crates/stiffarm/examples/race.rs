//! Measures this library for `bench/peers.py`: evaluations of the novel index
//! per second, the best index against time, and cost against the number of
//! postures, on the reference cell. Prints one JSON object.
//!
//! `cargo run --release -p stiffarm --example race -- --seconds 10 --seed 1 --threads 2 [--no-costs]`

use serde_json::{Value, json};
use std::time::{Duration, Instant};
use stiffarm::Control;
use stiffarm::plan::characteristic_length::with_characteristic_length;
use stiffarm::plan::index::{Index, IndexFunction};
use stiffarm::plan::select::{GlobalOptions, select_watched};
use stiffarm::units::rad_to_shortest_deg;
use stiffarm_files::builtin;

/// Time spent on one rate.
const RATE_SECONDS: f64 = 1.0;

struct Arguments {
    seconds: f64,
    seed: u64,
    threads: usize,
    costs: bool,
}

fn arguments() -> Result<Arguments, String> {
    let mut parsed = Arguments {
        seconds: 10.0,
        seed: 1,
        threads: std::thread::available_parallelism().map_or(1, usize::from),
        costs: true,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        if word == "--no-costs" {
            parsed.costs = false;
            continue;
        }
        let value = words.next().ok_or_else(|| format!("{word} needs a value."))?;
        let wrong = |_| format!("{word} {value}: not a number.");
        match word.as_str() {
            "--seconds" => {
                parsed.seconds = value.parse().map_err(|_| wrong(()))?;
                if !(parsed.seconds >= 0.0 && parsed.seconds < 1e6) {
                    return Err(wrong(()));
                }
            }
            "--seed" => parsed.seed = value.parse().map_err(|_| wrong(()))?,
            "--threads" => parsed.threads = value.parse().map_err(|_| wrong(()))?,
            _ => return Err(format!("{word} is not an option.")),
        }
    }
    Ok(parsed)
}

/// Groups to evaluate in turn, so that nothing is learnt about one of them.
fn groups(function: &IndexFunction, bounds: &[[f64; 2]], many: usize) -> Vec<Vec<f64>> {
    let size = function.posture_count() * bounds.len();
    (0..many)
        .map(|g| {
            (0..size)
                .map(|i| {
                    let [low, high] = bounds[i % bounds.len()];
                    let share = ((g * size + i) as f64 * 0.618_033_988_749_895).fract();
                    low + (high - low) * share
                })
                .collect()
        })
        .collect()
}

/// Evaluations per second on `threads` threads.
fn rate(function: &IndexFunction, bounds: &[[f64; 2]], gradient: bool, threads: usize) -> f64 {
    let groups = groups(function, bounds, 64);
    let begin = Instant::now();
    let done: u64 = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|_| {
                let mut function = function.clone();
                let groups = &groups;
                scope.spawn(move || {
                    let mut slope = vec![0.0; groups[0].len()];
                    let mut done = 0;
                    while begin.elapsed().as_secs_f64() < RATE_SECONDS {
                        for q in groups {
                            if gradient {
                                std::hint::black_box(function.smoothed(q, 100.0, &mut slope));
                            } else {
                                std::hint::black_box(function.value(q));
                            }
                        }
                        done += groups.len() as u64;
                    }
                    done
                })
            })
            .collect();
        workers.into_iter().map(|w| w.join().unwrap_or_default()).sum()
    });
    done as f64 / begin.elapsed().as_secs_f64()
}

fn run() -> Result<Value, String> {
    let arguments = arguments()?;
    let text = |error: stiffarm::Error| error.to_string();
    let cell = builtin::cell("comau-reference").and_then(with_characteristic_length).map_err(text)?;
    let function = IndexFunction::new(&cell, Index::Novel, 6).map_err(text)?;
    let rates: Vec<Value> = [
        ("value", false, 1),
        ("value+gradient", true, 1),
        ("value", false, arguments.threads),
        ("value+gradient", true, arguments.threads),
    ]
    .into_iter()
    .map(|(what, gradient, threads)| {
        let rate = rate(&function, &cell.bounds, gradient, threads);
        json!({"what": what, "threads": threads, "per_second": rate})
    })
    .collect();

    let mut options = GlobalOptions::default();
    options.seed = arguments.seed;
    options.time_limit = Some(Duration::from_secs_f64(arguments.seconds));
    rayon::ThreadPoolBuilder::new().num_threads(arguments.threads).build_global().map_err(|e| e.to_string())?;
    let begin = Instant::now();
    let mut trace = Vec::new();
    let selection = select_watched(&cell, Index::Novel, 6, &options, Control::default(), &mut |round| {
        trace.push(json!({
            "seconds": begin.elapsed().as_secs_f64(),
            "evaluations": round.evaluations,
            "value": round.value.unwrap_or(f64::MAX),
        }));
    })
    .map_err(text)?;
    trace.push(json!({
        "seconds": begin.elapsed().as_secs_f64(),
        "evaluations": selection.evaluations,
        "value": selection.value,
    }));
    let mut costs = Vec::new();
    for index in [Index::Novel, Index::ExpectedError] {
        for count in [6, 10, 20, 50] {
            if !arguments.costs {
                continue;
            }
            let function = IndexFunction::new(&cell, index, count).map_err(text)?;
            let mut options = GlobalOptions::default();
            options.seed = arguments.seed;
            let value = 1e6 / rate(&function, &cell.bounds, false, 1);
            let gradient = 1e6 / rate(&function, &cell.bounds, true, 1);
            let begin = Instant::now();
            let selection =
                select_watched(&cell, index, count, &options, Control::default(), &mut |_| {}).map_err(text)?;
            costs.push(json!({
                "index": index.as_str(),
                "postures": count,
                "value_us": value,
                "gradient_us": gradient,
                "selection_seconds": begin.elapsed().as_secs_f64(),
                "evaluations": selection.evaluations,
                "value": selection.value,
            }));
        }
    }
    let degrees = |q: &Vec<f64>| q.iter().map(|a| rad_to_shortest_deg(*a)).collect();
    let best: Vec<Vec<f64>> = selection.group.iter().map(degrees).collect();
    Ok(json!({
        "version": env!("CARGO_PKG_VERSION"),
        "threads": arguments.threads,
        "rates": rates,
        "trace": trace,
        "best_group_deg": best,
        "cost_against_n": costs,
    }))
}

fn main() -> std::process::ExitCode {
    match run() {
        Ok(json) => {
            println!("{json}");
            std::process::ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("error: {message}");
            std::process::ExitCode::from(2)
        }
    }
}
