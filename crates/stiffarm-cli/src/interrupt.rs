//! Ctrl-C and a request to end (SIGTERM, SIGHUP): the first asks the work to stop with
//! its best result, the second quits.

use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);

/// Takes Ctrl-C, SIGTERM and SIGHUP over for the rest of this run.
pub fn listen() {
    // Without a handler Ctrl-C ends the program at once, as it always did.
    let _ = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    });
}

/// True once the user has asked to stop.
pub fn stopped() -> bool {
    STOP.load(Ordering::SeqCst)
}
