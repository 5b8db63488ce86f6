//! Whether the numbers of a program that names no unit look like inches.
//!
//! A control that is set to inches reads programs without G20 as inches, and posts for such shops leave it out. What
//! tells them is not the size alone, since parts may be small: beside a small path the tool is lifted by little, and
//! the feed is too slow for the spindle, a remark speaks of inches, or, where no speed is known, numbers have the
//! decimals of inches or the path is smaller than the cutter.

use super::State;
use crate::tool_path::numbers::decimals_of;
use nalgebra::Vector3;
use stiffarm::findings::Severity;
use stiffarm::model::path::{PathPoint, PathTarget};
use stiffarm::model::process::Process;
use stiffarm::units::m_to_mm;

/// Largest side of a path that may be in inches \[units\].
const LARGEST_SPAN: f64 = 50.0;
/// Most that the tool is lifted above what it cuts there \[units\].
const LARGEST_LIFT: f64 = 2.5;
/// Fastest feed of such a program \[units/min\].
const SLOW: f64 = 150.0;
/// A cutter that moves by less for a turn of the spindle rubs \[mm\]; in inches this is a common feed.
const RUBBING_FEED: f64 = 0.012;
/// Feeds that leave no doubt where the speed of the spindle is not known \[units/min\].
const VERY_SLOW: f64 = 60.0;
/// Decimals that programs in inches have, and those in millimetres mostly have not.
const DECIMALS: usize = 4;

/// What the words of a program say of its unit.
#[derive(Default)]
pub(super) struct Clues {
    /// G20, G21 or another word names it.
    pub is_stated: bool,
    /// Fastest feed in a minute \[units\].
    pub feed: f64,
    /// Fastest spindle \[1/min\].
    pub spindle: f64,
    /// Coordinates with so many decimals as inches have.
    fine: usize,
    /// A remark speaks of inches.
    is_told: bool,
}

/// Words of remarks about inches.
const WORDS: [&str; 5] = ["inch", "inches", "ipm", "in/min", "in."];

impl Clues {
    /// Takes the remarks of a block.
    pub fn remarks(&mut self, text: &str) {
        let is_between = |c: char| c.is_whitespace() || matches!(c, '(' | ')' | ',' | ';' | ':');
        let mut words = text.split(is_between).map(str::to_lowercase);
        self.is_told |= words.any(|word| WORDS.contains(&word.as_str()));
    }

    /// Takes the text of a coordinate.
    pub fn coordinate(&mut self, text: &str) {
        if decimals_of(text).is_some_and(|decimals| decimals >= DECIMALS) {
            self.fine += 1;
        }
    }
}

impl State<'_, '_> {
    /// Says where a program that names no unit looks like one in inches.
    pub(super) fn doubt_unit(&mut self) {
        let clues = &self.clues;
        if clues.is_stated || clues.feed <= 0.0 || clues.feed > SLOW {
            return;
        }
        let frame = self.builder.form.frame.inverse();
        let unit = self.builder.form.unit;
        let place = |point: &PathPoint| match &point.target {
            PathTarget::Axis { position, .. } => (frame.rotation * position + frame.translation.vector) / unit,
            _ => Vector3::zeros(),
        };
        let cutting = self.builder.points.iter().filter(|point| !point.rapid);
        let mut corners: Option<[Vector3<f64>; 2]> = None;
        for at in cutting.map(place) {
            let [low, high] = corners.unwrap_or([at, at]);
            corners = Some([low.inf(&at), high.sup(&at)]);
        }
        let Some([low, high]) = corners else { return };
        let span = high - low;
        let lifted = self.builder.points.iter().map(|p| place(p).z - high.z);
        let across = span.x.max(span.y);
        if span.max() > LARGEST_SPAN || across == 0.0 || lifted.fold(0.0, f64::max) > LARGEST_LIFT {
            return;
        }
        let (cutter, own_spindle) = match &self.builder.cell.work.process {
            Some(Process::Milling(milling)) => (m_to_mm(milling.diameter), 0.0),
            // Its feed per tooth is that at 1 m/s.
            Some(Process::MillingAtFeed(milling)) => {
                let turns = 60.0 / (f64::from(milling.teeth) * milling.feed_per_tooth);
                (m_to_mm(milling.diameter), turns)
            }
            _ => (0.0, 0.0),
        };
        let spindle = match clues.spindle {
            0.0 => own_spindle,
            spindle => spindle,
        };
        let is_slow = if spindle > 0.0 {
            clues.feed / spindle < RUBBING_FEED
        } else {
            clues.feed <= VERY_SLOW && (clues.fine > 1 || across < 0.5 * cutter)
        };
        if !is_slow && !clues.is_told {
            return;
        }
        let for_a_turn = match spindle {
            0.0 => String::new(),
            turns => format!(" ({:.4} mm for a turn of the spindle)", clues.feed / turns),
        };
        let sentence = format!(
            "The program names no unit and is read in millimetres: its cuts span {:.3} × {:.3} × {:.3} mm, with feeds \
             up to {} mm/min{for_a_turn}. If these are inches, write G20 at its head; G21 settles it otherwise ({{}}).",
            span.x, span.y, span.z, clues.feed
        );
        let line = self.builder.points.iter().find_map(|point| point.line);
        self.builder.remark("maybe-inches", "", line.unwrap_or(1), Severity::Caution, || sentence);
    }
}
