//! Many inputs of one target in this process.

use super::{LONGEST, judge, make};
use crate::memory;
use crate::targets::Target;
use std::io::Write;
use std::os::raw::c_int;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// An input that takes longer is counted.
const SLOW: Duration = Duration::from_secs(1);

/// How this process ends after an input that took too long.
pub const STUCK: c_int = 86;

/// The inputs of one process.
pub struct Share {
    /// Seed of all inputs.
    pub seed: u64,
    /// The first input.
    pub from: u64,
    /// How many at most.
    pub inputs: u64,
    /// How long at most.
    pub time: Duration,
}

/// What a share came to.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tally {
    /// Inputs run.
    pub inputs: u64,
    /// Those that were accepted.
    pub accepted: u64,
    /// Those over a second.
    pub slow: u64,
    /// The longest \[s\], and its input.
    pub longest: (f64, u64),
    /// Most memory that one took \[bytes\], and its input.
    pub largest: (usize, u64),
    /// Time of all \[s\].
    pub seconds: f64,
}

impl Tally {
    /// Adds another share.
    pub fn add(&mut self, other: &Tally) {
        self.inputs += other.inputs;
        self.accepted += other.accepted;
        self.slow += other.slow;
        self.seconds += other.seconds;
        if other.longest.0 > self.longest.0 {
            self.longest = other.longest;
        }
        if other.largest.0 > self.largest.0 {
            self.largest = other.largest;
        }
    }

    /// As a worker tells it.
    pub fn line(&self) -> String {
        format!(
            "done {} {} {} {} {} {} {} {}",
            self.inputs,
            self.accepted,
            self.slow,
            self.longest.0,
            self.longest.1,
            self.largest.0,
            self.largest.1,
            self.seconds
        )
    }

    /// What [`Tally::line`] told.
    pub fn of_line(line: &str) -> Option<Self> {
        let mut words = line.strip_prefix("done ")?.split(' ');
        let mut next = || words.next();
        Some(Tally {
            inputs: next()?.parse().ok()?,
            accepted: next()?.parse().ok()?,
            slow: next()?.parse().ok()?,
            longest: (next()?.parse().ok()?, next()?.parse().ok()?),
            largest: (next()?.parse().ok()?, next()?.parse().ok()?),
            seconds: next()?.parse().ok()?,
        })
    }
}

/// The input at work, for the thread that watches the clock.
struct Watched {
    tally: Tally,
    at: u64,
    since: Instant,
}

/// Runs a share; faults and the tally go to standard output, the index of the input at
/// work to the file `at`, so that it is known when the process dies of it.
pub fn work(target: &'static Target, share: &Share, at: Option<&Path>) {
    // The seeds are made before the clock starts.
    make(target, share.seed, share.from);
    let begin = Instant::now();
    let at = at.and_then(|path| std::fs::File::create(path).ok());
    let watched = Arc::new(Mutex::new(Watched { tally: Tally::default(), at: share.from, since: Instant::now() }));
    watch(Arc::clone(&watched), begin);
    for index in share.from..share.from.saturating_add(share.inputs) {
        if begin.elapsed() > share.time {
            break;
        }
        if let Some(file) = &at {
            mark(file, index);
        }
        if let Ok(mut watched) = watched.lock() {
            (watched.at, watched.since) = (index, Instant::now());
        }
        let input = make(target, share.seed, index);
        let held = memory::begin();
        let start = Instant::now();
        let judged = judge(target, &input);
        let (seconds, bytes) = (start.elapsed(), memory::peak_since(held));
        if let Err(fault) = &judged {
            tell(&format!("fault {index} {}", fault.replace('\n', " ")));
        }
        if let Ok(mut watched) = watched.lock() {
            watched.tally.add(&Tally {
                inputs: 1,
                accepted: u64::from(matches!(judged, Ok(true))),
                slow: u64::from(seconds > SLOW),
                longest: (seconds.as_secs_f64(), index),
                largest: (bytes, index),
                seconds: 0.0,
            });
        }
    }
    if let Ok(mut watched) = watched.lock() {
        watched.tally.seconds = begin.elapsed().as_secs_f64();
        tell(&watched.tally.line());
    }
}

/// Ends the process when an input takes too long.
fn watch(watched: Arc<Mutex<Watched>>, begin: Instant) {
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(Duration::from_millis(200));
            let Ok(mut watched) = watched.lock() else {
                return;
            };
            if watched.since.elapsed() > LONGEST {
                tell(&format!("fault {} took longer than {LONGEST:?}", watched.at));
                watched.tally.inputs += 1;
                watched.tally.seconds = begin.elapsed().as_secs_f64();
                tell(&watched.tally.line());
                std::process::exit(STUCK);
            }
        }
    });
}

/// Overwrites the index in the file.
fn mark(file: &std::fs::File, index: u64) {
    use std::io::{Seek, SeekFrom};
    let mut file = file;
    // Without it an input that kills the process is only not known by number.
    let _ = file.seek(SeekFrom::Start(0)).and_then(|_| file.write_all(format!("{index:020}").as_bytes()));
}

fn tell(line: &str) {
    let mut out = std::io::stdout().lock();
    // A parent that has gone needs no more.
    if writeln!(out, "{line}").and_then(|()| out.flush()).is_err() {
        std::process::exit(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tally_is_told_and_read() {
        let tally = Tally { inputs: 3, accepted: 2, slow: 1, longest: (1.5, 7), largest: (1024, 8), seconds: 2.25 };
        assert_eq!(Tally::of_line(&tally.line()), Some(tally));
        assert_eq!(Tally::of_line("fault 3 done"), None);
    }
}
