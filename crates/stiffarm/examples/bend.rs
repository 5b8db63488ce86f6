//! Measures this library for `bench/bend.py`: deflections and commands of a long
//! path on the default cell. Prints one JSON object and writes the numbers, so that
//! they can be held against another program's.
//!
//! `cargo run --release -p stiffarm --example bend -- --points 100000 --numbers bend.bin`
//!
//! The file holds rows of 24 little-endian doubles: controller angles \[rad\],
//! force \[N\] and moment \[N·m\] at the tip, its shift \[m\] and turn \[rad\],
//! commanded angles \[rad\].

use nalgebra::Vector3;
use std::fmt::Write as _;
use std::time::Instant;
use stiffarm::Control;
use stiffarm::estimate::compliance::IdentifiedCompliance;
use stiffarm::model::load::Wrench;
use stiffarm::model::path::LoadedPosture;
use stiffarm::work::compensate::{CompensateOptions, compensate};
use stiffarm::work::predict::{PredictOptions, predict};
use stiffarm_files::builtin;

/// Repeats of each measurement; the median counts.
const REPEATS: usize = 5;

/// A path between the cell's tasks with a load that turns with it.
fn path(tasks: &[Vec<f64>], count: usize) -> Vec<LoadedPosture> {
    (0..count)
        .map(|i| {
            let along = (tasks.len() - 1) as f64 * i as f64 / count.max(2) as f64;
            let (from, share) = (along.floor() as usize, along.fract());
            let ends = tasks[from].iter().zip(&tasks[from + 1]);
            let q = ends.map(|(a, b)| a + share * (b - a)).collect();
            let turn = 200.0 * along;
            LoadedPosture {
                name: (i + 1).to_string().into(),
                line: None,
                feature: None,
                q,
                wrench: Wrench {
                    force: Vector3::new(turn.cos(), turn.sin(), -0.5) * 400.0,
                    moment: Vector3::new(0.0, 2.0, 5.0 * turn.sin()),
                },
            }
        })
        .collect()
}

fn median(mut seconds: Vec<f64>) -> f64 {
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut points = 100_000;
    let mut threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut numbers = None;
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or_else(|| format!("{word} needs a value."))?;
        match word.as_str() {
            "--points" => points = value.parse()?,
            "--threads" => threads = value.parse()?,
            "--numbers" => numbers = Some(value),
            _ => return Err(format!("{word} is not an option.").into()),
        }
    }
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let cell = builtin::cell("comau")?;
    let predictor = IdentifiedCompliance::from_stiffness(&cell, cell.require_prior()?)?;
    let tasks: Vec<Vec<f64>> = cell.tasks.iter().map(|task| task.q.clone()).collect();
    let path = path(&tasks, points);
    let (options, quiet) = (PredictOptions::default(), Control::default());
    let mut times = [Vec::new(), Vec::new()];
    let mut results = None;
    for _ in 0..REPEATS {
        let clock = Instant::now();
        let bent = predict(&cell, &predictor, &path, &options, quiet)?;
        times[0].push(clock.elapsed().as_secs_f64());
        let clock = Instant::now();
        let commands = compensate(&cell, &predictor, &path, &CompensateOptions::default(), quiet)?;
        times[1].push(clock.elapsed().as_secs_f64());
        results = Some((bent, commands));
    }
    let (bent, commands) = results.ok_or("nothing was measured")?;
    if let Some(file) = numbers {
        let mut bytes = Vec::with_capacity(points * 24 * 8);
        for ((posture, bent), command) in path.iter().zip(&bent.points).zip(&commands.points) {
            let inputs = posture.q.iter().chain(&posture.wrench.force).chain(&posture.wrench.moment);
            let deflection = bent.shift_m.iter().chain(&bent.turn_rad);
            for value in inputs.chain(deflection) {
                bytes.extend(value.to_le_bytes());
            }
            for angle in &command.command {
                bytes.extend(angle.to_le_bytes());
            }
        }
        std::fs::write(file, bytes)?;
    }
    let [predicted, compensated] = times.map(median);
    let mut out = String::new();
    write!(
        out,
        "{{\"points\": {points}, \"threads\": {threads}, \"predict_s\": {predicted:.4}, \"compensate_s\": {compensated:.4}, \
         \"residual_max_m\": {:e}}}",
        commands.residual_max_m
    )?;
    println!("{out}");
    Ok(())
}
