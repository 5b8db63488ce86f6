//! The program behind `cargo xtask fuzz`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;
use stiffarm_fuzz::input::Input;
use stiffarm_fuzz::minimise::minimised;
use stiffarm_fuzz::run::{Plan, Share, judge, make, run, work};
use stiffarm_fuzz::targets::{ALL, Target, named};

/// Options, as `cargo xtask fuzz` passes them on.
#[derive(Default)]
struct Options {
    targets: Vec<&'static Target>,
    seed: u64,
    from: u64,
    inputs: Option<u64>,
    time: Option<Duration>,
    threads: Option<usize>,
    input: Option<u64>,
    replay: Option<PathBuf>,
    minimise: bool,
    output: Option<PathBuf>,
    is_worker: bool,
    at: Option<PathBuf>,
}

fn main() -> ExitCode {
    let options = match parse(std::env::args().skip(1)) {
        Ok(options) => options,
        Err(message) => {
            eprintln!("error: {message}\n  fix: see `cargo xtask help`");
            return ExitCode::from(2);
        }
    };
    if options.is_worker {
        let share = Share {
            seed: options.seed,
            from: options.from,
            inputs: options.inputs.unwrap_or(u64::MAX),
            time: options.time.unwrap_or(Duration::MAX),
        };
        if let [target] = options.targets[..] {
            work(target, &share, options.at.as_deref());
        }
        return ExitCode::SUCCESS;
    }
    if options.input.is_some() || options.replay.is_some() {
        return one(&options);
    }
    let targets = if options.targets.is_empty() {
        ALL.iter().filter_map(|target| named(target.name)).collect()
    } else {
        options.targets
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let plan = Plan {
        targets,
        seed: options.seed,
        from: options.from,
        inputs: options.inputs,
        time: options.time,
        threads: options.threads.unwrap_or(cores),
    };
    match run(&plan) {
        0 => ExitCode::SUCCESS,
        _ => ExitCode::from(1),
    }
}

/// One input: what it is and what becomes of it.
fn one(options: &Options) -> ExitCode {
    let [target] = options.targets[..] else {
        eprintln!("error: one input has one target\n  fix: name it with --target");
        return ExitCode::from(2);
    };
    let mut input = match (&options.replay, options.input) {
        (Some(path), _) => match std::fs::read(path) {
            Ok(bytes) => Input::from_bytes(&bytes, target.is_command),
            Err(error) => {
                eprintln!("error: {}: {error}\n  fix: check the path", path.display());
                return ExitCode::from(2);
            }
        },
        (None, index) => make(target, options.seed, index.unwrap_or(0)),
    };
    if options.minimise {
        input = minimised(target, input);
    }
    let bytes = input.to_bytes();
    match &options.output {
        Some(path) => {
            if let Err(error) = std::fs::write(path, &bytes) {
                eprintln!("error: {}: {error}\n  fix: check the folder", path.display());
                return ExitCode::from(2);
            }
        }
        None => println!("{}", String::from_utf8_lossy(&bytes)),
    }
    match judge(target, &input) {
        Ok(accepted) => {
            println!("-- {}", if accepted { "accepted" } else { "refused" });
            ExitCode::SUCCESS
        }
        Err(fault) => {
            println!("-- fault: {fault}");
            ExitCode::from(1)
        }
    }
}

fn parse(mut words: impl Iterator<Item = String>) -> Result<Options, String> {
    let mut options = Options { seed: 1, ..Options::default() };
    while let Some(name) = words.next() {
        match name.as_str() {
            "--worker" => options.is_worker = true,
            "--minimise" => options.minimise = true,
            _ => {
                let value = words.next().ok_or_else(|| format!("`{name}` has no value"))?;
                let number = || value.parse::<u64>().map_err(|_| format!("`{name} {value}`: a whole number is needed"));
                match name.as_str() {
                    "--target" => {
                        let target = named(&value).ok_or_else(|| {
                            let names = ALL.map(|target| target.name).join(", ");
                            format!("there is no target `{value}`; there are {names}")
                        })?;
                        options.targets.push(target);
                    }
                    "--seed" => options.seed = number()?,
                    "--from" => options.from = number()?,
                    "--inputs" => options.inputs = Some(number()?),
                    "--seconds" => options.time = Some(Duration::from_secs(number()?)),
                    "--milliseconds" => options.time = Some(Duration::from_millis(number()?)),
                    "--threads" => options.threads = Some(number()? as usize),
                    "--input" => options.input = Some(number()?),
                    "--replay" => options.replay = Some(PathBuf::from(value)),
                    "--output" => options.output = Some(PathBuf::from(value)),
                    "--at" => options.at = Some(PathBuf::from(value)),
                    _ => return Err(format!("there is no option `{name}`")),
                }
            }
        }
    }
    Ok(options)
}
