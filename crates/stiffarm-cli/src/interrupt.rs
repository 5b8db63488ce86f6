//! Ctrl-C and a request to end (SIGTERM, SIGHUP): the first asks work that looks out for it to stop with
//! its best result, the second quits; other work ends at the first.

use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

/// What every interrupted run ends with.
const CODE: i32 = 130;

static STOP: AtomicBool = AtomicBool::new(false);
static LOOKED_OUT_FOR: AtomicBool = AtomicBool::new(false);

/// Takes Ctrl-C, SIGTERM and SIGHUP over for this process.
pub fn listen() {
    // Without a handler a signal ends the program at once, as it always did.
    let _ = ctrlc::set_handler(|| {
        let is_first = !STOP.swap(true, Ordering::SeqCst);
        if is_first && LOOKED_OUT_FOR.load(Ordering::SeqCst) {
            return;
        }
        if is_first {
            // Where standard error is closed there is nobody left to tell.
            let _ = writeln!(std::io::stderr(), "Interrupted: there is no result.");
        }
        std::process::exit(CODE);
    });
}

/// Work asks [`stopped`] now and then, for the rest of this run.
pub fn look_out() {
    LOOKED_OUT_FOR.store(true, Ordering::SeqCst);
}

/// True once the user has asked to stop.
pub fn stopped() -> bool {
    STOP.load(Ordering::SeqCst)
}
