//! G-code: ISO 6983-1, with what FANUC, Siemens and LinuxCNC add for five axes.
//!
//! What each word does stands in `table`. Blocks: ISO 6983-1:2009; LinuxCNC *G-Code Reference* (R and I J K arcs, G93,
//! cycles); Siemens *SINUMERIK, Multi-axis machining* (`TRAORI`, `A3= B3= C3=`, `CR=`); FANUC *Series 30i Operator's
//! Manual* (G43.4, G43.5 with I J K as the tool axis). Points are those of the tool tip: lengths of tools are the
//! control's. Rotary words A, B, C need the kinematics of the machine, `rotary_axes` in `[work]` of the cell.

mod circle;
mod cycle;
mod effect;
mod inches;
mod modes;
mod pieces;
mod rows;
mod table;
mod turn;
mod words;

use super::builder::{Builder, Feed, TipTarget};
use super::{FAR_AWAY, FARTHEST};
use crate::program::{ProgramFile, lines};
use cycle::Cycle;
use effect::{Feeds, Mode};
use inches::Clues;
use nalgebra::{UnitVector3, Vector3};
use stiffarm::error::Result;
use stiffarm::findings::Severity;
pub use table::page;
use words::{BlockMarks, Word, axis_component, words_of};

struct State<'b, 'c> {
    builder: &'b mut Builder<'c>,
    mode: Option<Mode>,
    /// The axis across the plane of arcs.
    plane: usize,
    steps: bool,
    centres_absolute: bool,
    /// Whether I, J, K of a straight move are the tool axis (G43.5).
    vectors: bool,
    /// The work offset, by its word and its number.
    offset: Option<[f64; 2]>,
    /// In units of the program, as far as it is known.
    position: [Option<f64>; 3],
    /// Of A, B, C \[deg\].
    rotary: [f64; 3],
    axis: UnitVector3<f64>,
    /// As it was stated last.
    stated: [f64; 3],
    feeds: Feeds,
    /// S is the speed of the cutting edge (G96), and not that of the spindle.
    is_cutting_speed: bool,
    cycle: Cycle,
    clues: Clues,
}

/// The words of a block and what stands around them.
struct Block<'a, 'w> {
    words: &'w [Word<'a>],
    beside: &'w BlockMarks,
    file: &'a ProgramFile,
}

pub(super) fn read(file: &ProgramFile, builder: &mut Builder<'_>) -> Result<()> {
    builder.form.before = &[" X", " Y", " Z", " A3=", " B3=", " C3="];
    let mut state = State {
        builder,
        mode: None,
        plane: 2,
        steps: false,
        centres_absolute: false,
        vectors: false,
        offset: None,
        position: [None; 3],
        rotary: [0.0; 3],
        axis: Vector3::z_axis(),
        stated: [0.0, 0.0, 1.0],
        feeds: Feeds::Minute,
        is_cutting_speed: false,
        cycle: Cycle::default(),
        clues: Clues::default(),
    };
    let mut words = Vec::new();
    let (mut has_begun, mut has_ended) = (false, false);
    for mut line in lines(file) {
        if line.is_done() {
            continue;
        }
        if has_ended {
            let behind = line.line_number();
            let is_comment = |c: char| matches!(c, '%' | ';' | '(');
            if !line.rest().trim_start().starts_with(is_comment) {
                let remark = "What stands behind the end of the program ({}) is not driven, and not read.";
                let builder = &mut state.builder;
                builder.remark("behind-the-end", "", behind, Severity::Caution, || remark.to_string());
                break;
            }
            continue;
        }
        words.clear();
        let beside = words_of(&mut line, state.builder, &mut words)?;
        state.clues.remarks(&beside.comments);
        if words.iter().all(|word| matches!(word.letter, b'N' | b'O')) {
            // A comment with a line of its own names what follows, and one behind the program's number.
            let comment = |c: char| c.is_whitespace() || matches!(c, ';' | '(' | ')');
            let name = beside.comments.trim_matches(comment);
            state.builder.named(name, line.line_number());
        }
        let block = Block { words: &words, beside: &beside, file };
        has_ended = state.block(&block)? || beside.is_mark && has_begun;
        has_begun = true;
    }
    state.doubt_unit();
    Ok(())
}

impl<'a> Block<'a, '_> {
    /// The word of this letter.
    fn word(&self, letter: u8) -> Option<&Word<'a>> {
        let mut words = self.words.iter();
        words.find(|word| word.letter == letter && word.index == 0)
    }

    fn value(&self, letter: u8) -> Option<f64> {
        self.word(letter).map(|word| word.number.value)
    }

    /// The text of a word in capitals.
    fn name(&self, word: &Word<'_>) -> String {
        word.text(&self.file.text).to_ascii_uppercase()
    }

    /// A word that is not read, and why.
    fn refused(&self, word: &Word<'_>, why: &str) -> stiffarm::Error {
        let error = word.place.wrong(format!("{} {why}", self.name(word)));
        error.hint(
            "post-process the path into one file, with absolute points of the tool tip in the frame of the workpiece",
        )
    }
}

impl State<'_, '_> {
    /// Takes a block; true where it ends the program.
    fn block(&mut self, block: &Block<'_, '_>) -> Result<bool> {
        let fate = self.modes(block)?;
        self.check(block)?;
        if !fate.dwells || block.word(b'P').is_some() {
            self.speeds(block);
        }
        if fate.takes_axes {
            return Ok(fate.ends);
        }
        let is_target = |word: &&Word<'_>| {
            word.axis().is_some() || axis_component(word, self.vectors).is_some() || matches!(word.letter, b'I'..=b'K')
        };
        let moving = block.words.iter().filter(is_target);
        let last = moving.max_by_key(|word| word.end);
        if fate.leaves {
            // Where the machine stands then is its own affair.
            let named = |axis: usize| block.words.iter().any(|word| word.axis() == Some(axis));
            let is_alone = (0..6).all(|axis| !named(axis));
            if let Some(word) = block.words.iter().find(|word| word.letter == b'G') {
                let line = word.place.line_number();
                self.builder.remark("machine-place", "", line, Severity::Note, || {
                    "Moves to places of the machine ({}) are no part of the path.".to_string()
                });
            }
            for axis in (0..3).filter(|axis| named(*axis) || is_alone && !fate.stays_without_axes) {
                self.position[axis] = None;
            }
            return Ok(fate.ends);
        }
        if let Some(last) = last {
            self.go(block, last)?;
        }
        Ok(fate.ends)
    }

    /// Takes feed and speed.
    fn speeds(&mut self, block: &Block<'_, '_>) {
        if let Some(value) = block.value(b'F') {
            let feed = value * self.builder.form.unit;
            match self.feeds {
                Feeds::Minute => {
                    self.clues.feed = self.clues.feed.max(value);
                    self.builder.feed = Some(Feed::Second(feed / 60.0));
                }
                Feeds::Turn => self.builder.feed = Some(Feed::Turn(feed)),
                Feeds::Inverse => {}
            }
        }
        let mut words = block.words.iter();
        let speed = words.find(|word| word.letter == b'S' && word.index < 2);
        if let Some(word) = speed.filter(|_| !self.is_cutting_speed) {
            self.clues.spindle = self.clues.spindle.max(word.number.value);
            self.builder.spindle = Some(word.number.value / 60.0);
        }
    }

    /// Goes where a block leads.
    fn go(&mut self, block: &Block<'_, '_>, last: &Word<'_>) -> Result<()> {
        let line = last.place.line_number();
        let mode = self.mode.unwrap_or_else(|| {
            let remark = "No word says how to go to the points of some blocks ({}): they are read as rapid moves.";
            self.builder.remark("no-motion", "", line, Severity::Caution, || remark.to_string());
            Mode::Rapid
        });
        match mode {
            Mode::Unfollowed => {
                self.builder.remark("cycle", "", line, Severity::Caution, || {
                    "Some cycles ({}) are not followed: their points are left out.".to_string()
                });
                self.position = [None; 3];
                return Ok(());
            }
            Mode::Drill(drill) => return self.drill(block, drill, last),
            _ => {}
        }
        let (before, start) = (self.axis, self.position);
        self.turn(block.words, mode)?;
        for word in block.words {
            if let Some(axis @ 0..3) = word.axis() {
                self.clues.coordinate(word.text(&block.file.text));
                self.position[axis] = self.moved(self.position[axis], word.number.value);
            }
        }
        let Some(end) = known_position(&self.position) else {
            if mode != Mode::Rapid {
                self.unknown(line);
            }
            return Ok(());
        };
        let unit = self.builder.form.unit;
        if (end * unit).amax() > FARTHEST {
            return Err(last.place.wrong(FAR_AWAY));
        }
        self.keeps_steps(line);
        let place = TipTarget::Axis(end * unit, self.axis);
        let start = known_position(&start).map(|start| start * unit);
        let first = self.builder.points.len();
        let Mode::Arc { is_left } = mode else {
            self.inverse(block, start.map(|start| (end * unit - start).norm()));
            let from = start.filter(|_| mode == Mode::Feed);
            let from = from.map(|start| TipTarget::Axis(start, before));
            if from.is_some_and(|from| self.builder.between(line, &from, &place)) {
                let points = first..self.builder.points.len() + 1;
                self.pieces(block, points, false, Default::default());
            }
            self.builder.point(line, &place, mode == Mode::Rapid);
            self.slots(block.words, last.end);
            return Ok(());
        };
        let Some(start) = start else {
            return Err(last.place.wrong("An arc needs a point that it begins at."));
        };
        let Some(circle) = self.circle(block, start, end * unit, is_left)? else {
            return Err(last
                .place
                .wrong("This is not an arc: its end is not on the circle about its centre through the point before."));
        };
        self.inverse(block, Some(circle.length()));
        let from = TipTarget::Axis(start, before);
        for (share, point) in circle.points() {
            self.builder.point(line, &from.towards(&place, share, point), false);
        }
        let points = first..self.builder.points.len();
        self.pieces(block, points, true, Default::default());
        Ok(())
    }

    /// What a word makes of a coordinate.
    fn moved(&self, from: Option<f64>, value: f64) -> Option<f64> {
        if self.steps { from.map(|from| from + value) } else { Some(value) }
    }

    fn unknown(&mut self, line: usize) {
        self.builder.remark("position-unknown", "", line, Severity::Caution, || {
            "Moves at feed before x, y and z are all known ({}) are left out.".to_string()
        });
    }

    /// A point that is a step from another cannot be written.
    fn keeps_steps(&mut self, line: usize) {
        if self.steps {
            let why = (line, "it moves by steps here");
            self.builder.fixed.get_or_insert(why);
        }
    }

    /// Takes the feed of a move of this length \[m\], where it is the inverse of the move's time.
    fn inverse(&mut self, block: &Block<'_, '_>, way: Option<f64>) {
        if self.feeds == Feeds::Inverse {
            let pair = block.value(b'F').zip(way);
            self.builder.feed = pair.map(|(feed, way)| Feed::Second(feed * way / 60.0));
        }
    }
}

fn known_position(position: &[Option<f64>; 3]) -> Option<Vector3<f64>> {
    match *position {
        [Some(x), Some(y), Some(z)] => Some(Vector3::new(x, y, z)),
        _ => None,
    }
}
