//! Runs inputs: one, many in one process, or all targets in several processes.

mod parent;
mod worker;

pub use parent::{Plan, run};
pub use worker::{Share, work};

use crate::input::Input;
use crate::random::Random;
use crate::targets::Target;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, Once};
use std::time::Duration;

/// An input that takes longer is a fault.
pub const LONGEST: Duration = Duration::from_secs(20);

/// Where the last panic was.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// Input `index` of a target.
pub fn make(target: &Target, seed: u64, index: u64) -> Input {
    (target.make)(&mut Random::of(target.name, seed, index))
}

/// Runs an input: true where it was accepted.
///
/// # Errors
/// The fault that it shows.
pub fn judge(target: &Target, input: &Input) -> Result<bool, String> {
    keep_panics();
    let place = || PANIC.lock().map(|mut text| std::mem::take(&mut *text)).unwrap_or_default();
    // That of another input, or of its making.
    let _ = place();
    match catch_unwind(AssertUnwindSafe(|| (target.check)(input))) {
        Ok(Ok(accepted)) => Ok(accepted),
        Ok(Err(fault)) => match place() {
            place if place.is_empty() => Err(fault),
            place => Err(format!("{fault} [panic {place}]")),
        },
        Err(_) => Err(format!("panic {}", place())),
    }
}

/// What a panic says is kept and not printed.
fn keep_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        std::panic::set_hook(Box::new(|info| {
            if let Ok(mut text) = PANIC.lock() {
                *text = info.to_string().replace('\n', " ");
            }
        }));
    });
}

/// What two inputs with one fault have in common: its text without numbers and quotes.
pub fn signature(fault: &str) -> String {
    let mut out = String::new();
    let mut in_quotes = false;
    for c in fault.chars() {
        match c {
            '"' => in_quotes = !in_quotes,
            _ if in_quotes || c.is_ascii_digit() || matches!(c, '.' | '-' | '+') => {}
            _ => out.push(c),
        }
        if out.len() > 150 {
            break;
        }
    }
    out
}
