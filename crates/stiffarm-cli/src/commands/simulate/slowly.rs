//! A rehearsal: the readings of a day come one load state after the other.

use crate::files::write_all;
use crate::interrupt;
use crate::session::Session;
use crate::target::Target;
use std::time::Duration;
use stiffarm::{Code, Error, Result};

/// Longest time without a look at whether the user stopped.
const NAP: Duration = Duration::from_millis(50);

/// Writes a table of readings to `target`, first its heading alone, then with the rows of one more state of a
/// posture after each pause. Each time the file is there as a whole, so who reads it never sees half a row.
/// A stop leaves what has come so far.
///
/// # Errors
/// The file cannot be written, or is none.
pub(super) fn write_slowly(
    session: &Session,
    target: &Target,
    table: &str,
    pause: Duration,
) -> Result<()> {
    if !matches!(target, Target::File { .. }) {
        let message = "Readings that come one after the other need a file.";
        return Err(Error::new(Code::Usage, message)
            .key("--slowly")
            .hint("give --readings the name of a file"));
    }
    interrupt::look_out();
    let mut lines = table.split_inclusive('\n');
    let mut so_far = lines.next().unwrap_or_default().to_string();
    let (mut last, mut target) = (None, target.clone());
    for line in lines {
        // The rows of a state stand together; its name is behind the posture's.
        let state: Vec<&str> = line.splitn(3, ',').take(2).collect();
        if last.as_ref() != Some(&state) {
            let once = session.afresh();
            write_all(&once, &[(target.clone(), so_far.clone())])?;
            if let Some(error) = once.failure() {
                session.fail(error);
                return Ok(());
            }
            if let Target::File { force, .. } = &mut target {
                *force = true;
            }
            wait(session, pause);
            if session.stopped() {
                return Ok(());
            }
            last = Some(state);
        }
        so_far += line;
    }
    write_all(session, &[(target, so_far)])
}

fn wait(session: &Session, pause: Duration) {
    let mut slept = Duration::ZERO;
    while slept < pause && !session.stopped() {
        let nap = NAP.min(pause - slept);
        std::thread::sleep(nap);
        slept += nap;
    }
}
