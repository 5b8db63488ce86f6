//! Progress of long work, on a terminal only and after a second only.

use crate::interrupt;
use crate::session::Session;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;
use stiffarm::{Control, Watch};

/// Work shorter than this shows nothing.
const PATIENCE: Duration = Duration::from_secs(1);
/// How often a shown bar moves.
const TICK: Duration = Duration::from_millis(120);

/// Work whose end is not known, and work that is counted.
const SPINNER: &str = "{spinner} {msg} ({elapsed}, Ctrl-C stops with the best so far)";
const COUNTED: &str = "{spinner} {msg} {bar:30} {pos}/{len} ({elapsed})";

/// Says on standard error what a count of the user makes of the work, where it grows
/// faster than the count (61 steps are 226,981 nodes) and there are `many` pieces.
pub fn announce(session: &Session, pieces: usize, many: usize, what: &str) {
    if pieces >= many {
        session.remark(&format!("note: {pieces} {what}; this takes a while, and Ctrl-C stops it"));
    }
}

/// A progress bar that shows itself when the work takes long.
pub struct Progress {
    bar: ProgressBar,
    /// Who watches instead of a terminal.
    host: Option<Watch>,
    /// Dropped with the bar: the thread that waits to show it ends.
    _finished: Option<Sender<()>>,
}

impl Progress {
    /// Starts watching work of one kind.
    pub fn new(session: &Session, what: &str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden()).with_message(what.to_string());
        let is_hosted = session.host.watch.is_some();
        if session.quiet || is_hosted || !std::io::stderr().is_terminal() {
            return Progress { bar, host: session.host.watch.clone(), _finished: None };
        }
        set_style(&bar, SPINNER);
        let (sender, receiver) = channel::<()>();
        let shown = bar.clone();
        std::thread::spawn(move || {
            if receiver.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(TICK);
            }
        });
        Progress { bar, host: None, _finished: Some(sender) }
    }

    /// Tells how far the work is.
    pub fn report(&self, what: &str, done: usize, of: usize) {
        match &self.host {
            Some(watch) => watch.control().report(what, done, of),
            None => report(&self.bar, what, done, of),
        }
    }

    /// Tells how work stands whose end is not known.
    pub fn show(&self, what: &str) {
        if self.host.is_some() {
            return self.report(what, 0, 0);
        }
        if self.bar.length().is_some() {
            self.bar.unset_length();
            set_style(&self.bar, SPINNER);
        }
        self.bar.set_message(what.to_string());
    }

    /// This bar and Ctrl-C for a value whose later questions can take long.
    pub fn shared(&self) -> Watch {
        if let Some(watch) = &self.host {
            return watch.clone();
        }
        interrupt::look_out();
        let bar = self.bar.clone();
        let report = move |what: &str, done: usize, of: usize| report(&bar, what, done, of);
        Watch::new(interrupt::stopped, report)
    }

    /// Runs `work` with this bar and Ctrl-C.
    pub fn watch<T>(&self, work: impl FnOnce(Control<'_>) -> T) -> T {
        if let Some(watch) = &self.host {
            return work(watch.control());
        }
        interrupt::look_out();
        let stop = interrupt::stopped;
        let progress = |what: &str, done: usize, of: usize| self.report(what, done, of);
        work(Control { stop: Some(&stop), progress: Some(&progress) })
    }
}

fn report(bar: &ProgressBar, what: &str, done: usize, of: usize) {
    if bar.length() != Some(of as u64) {
        bar.set_length(of as u64);
        set_style(bar, COUNTED);
    }
    if bar.message() == what {
        // Finished out of order on several threads: never step back.
        bar.set_position(bar.position().max(done as u64));
    } else {
        // Another kind of work counts from the start.
        bar.set_message(what.to_string());
        bar.set_position(done as u64);
    }
}

fn set_style(bar: &ProgressBar, template: &str) {
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
