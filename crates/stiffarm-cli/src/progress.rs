//! Progress of long work, on a terminal only and after a second only.

use crate::interrupt;
use crate::session::Session;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;
use stiffarm::optimise::Control;

/// Work shorter than this shows nothing.
const PATIENCE: Duration = Duration::from_secs(1);
/// How often a shown bar moves.
const TICK: Duration = Duration::from_millis(120);

/// A progress bar that shows itself when the work takes long.
pub struct Progress {
    bar: ProgressBar,
    /// Dropped with the bar: the thread that waits to show it ends.
    _finished: Option<Sender<()>>,
}

impl Progress {
    /// Starts watching work of one kind.
    pub fn new(session: &Session, what: &str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden())
            .with_message(what.to_string());
        if session.quiet || !std::io::stderr().is_terminal() {
            return Progress {
                bar,
                _finished: None,
            };
        }
        let spinner = ProgressStyle::with_template(
            "{spinner} {msg} ({elapsed}, Ctrl-C stops with the best so far)",
        );
        if let Ok(style) = spinner {
            bar.set_style(style);
        }
        let (sender, receiver) = channel::<()>();
        let shown = bar.clone();
        std::thread::spawn(move || {
            if receiver.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(TICK);
            }
        });
        Progress {
            bar,
            _finished: Some(sender),
        }
    }

    /// Tells how far the work is.
    pub fn report(&self, what: &str, done: usize, of: usize) {
        if self.bar.length() != Some(of as u64) {
            self.bar.set_length(of as u64);
            if let Ok(style) =
                ProgressStyle::with_template("{spinner} {msg} {bar:30} {pos}/{len} ({elapsed})")
            {
                self.bar.set_style(style);
            }
        }
        if self.bar.message() != what {
            // Another kind of work counts from the start.
            self.bar.set_position(0);
            self.bar.set_message(what.to_string());
        }
        // Finished out of order on several threads: never step back.
        self.bar.set_position(self.bar.position().max(done as u64));
    }

    /// Runs `work` with this bar and Ctrl-C.
    pub fn watch<T>(&self, work: impl FnOnce(Control<'_>) -> T) -> T {
        interrupt::listen();
        let stop = interrupt::stopped;
        let progress = |what: &str, done: usize, of: usize| self.report(what, done, of);
        work(Control {
            stop: Some(&stop),
            progress: Some(&progress),
        })
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
