//! A rehearsal: the readings of a day come one load state after the other.

use crate::files::place;
use crate::interrupt;
use crate::session::Session;
use crate::target::Target;
use std::time::Duration;
use stiffarm::{Code, Error, Result};

/// Longest time without a look at whether the user stopped.
const NAP: Duration = Duration::from_millis(50);

/// Refuses readings that come one after the other to anything but a file.
///
/// # Errors
/// A pause, and no file.
pub(super) fn check_slowly(pause: Option<Duration>, readings: Option<&Target>) -> Result<()> {
    if pause.is_none() || matches!(readings, Some(Target::File { .. })) {
        return Ok(());
    }
    let message = "Readings that come one after the other need a file.";
    Err(Error::new(Code::Usage, message).key("--slowly").hint("give --readings the name of a file"))
}

/// Writes a table of readings, first its heading alone, then with the rows of one more state of a posture after each
/// pause. Each time the file is there as a whole, so who reads it never sees half a row. What is left to write comes
/// back: the whole table; nothing where the user stops, who keeps what has come so far.
pub(super) fn write_slowly(
    session: &Session,
    mut target: Target,
    table: String,
    pause: Duration,
) -> Option<(Target, String)> {
    interrupt::look_out();
    let mut lines = table.split_inclusive('\n');
    let mut so_far = lines.next().unwrap_or_default().to_string();
    let mut last = None;
    for line in lines {
        // The rows of a state stand together; its name is behind the posture's.
        let state: Vec<&str> = line.splitn(3, ',').take(2).collect();
        if last.as_ref() != Some(&state) {
            // What cannot be written now is told at the end.
            if place(&[(target.clone(), so_far.clone())]).is_err() {
                break;
            }
            if let Target::File { force, .. } = &mut target {
                *force = true;
            }
            wait(session, pause);
            if session.stopped() {
                return None;
            }
            last = Some(state);
        }
        so_far += line;
    }
    Some((target, table))
}

fn wait(session: &Session, pause: Duration) {
    let mut slept = Duration::ZERO;
    while slept < pause && !session.stopped() {
        let nap = NAP.min(pause - slept);
        std::thread::sleep(nap);
        slept += nap;
    }
}
