//! What the words of a block make of the modes, and which of them do not belong there.

use super::effect::{Effect, Mode};
use super::words::Word;
use super::{Block, State};
use stiffarm::error::Result;
use stiffarm::findings::Severity;

/// Default work offset of every control.
const FIRST_OFFSET: f64 = 54.0;

/// What becomes of a block.
#[derive(Default)]
pub struct BlockOutcome {
    /// The program is over behind it.
    pub ends: bool,
    /// Its axis words are no point.
    pub takes_axes: bool,
    /// It waits.
    pub dwells: bool,
    /// Its axes go where only the machine knows.
    pub leaves: bool,
    /// None of them where none is named.
    pub stays_without_axes: bool,
}

impl State<'_, '_> {
    /// Takes the words that say how a block and those behind it are meant.
    pub(super) fn modes(&mut self, block: &Block<'_, '_>) -> Result<BlockOutcome> {
        let mut fate = BlockOutcome::default();
        let goes = block.words.iter().any(|word| word.axis().is_some());
        let mut motion = None;
        for word in block.words.iter().filter(|word| word.is_own()) {
            let line = word.place.line_number();
            let Some(row) = word.row else {
                match word.letter {
                    // Words of the machine's builder.
                    b'M' => {}
                    _ if goes => {
                        let why = "is not known here, and stands beside a point that it may move.";
                        return Err(block.refused(word, why));
                    }
                    _ => {
                        let name = block.name(word);
                        self.builder.not_followed(&name, line, Severity::Caution);
                    }
                }
                continue;
            };
            let is_refused = match row.effect {
                Effect::Refused => true,
                Effect::Alone => goes,
                Effect::Resets if word.letter == b'G' => self.has_moved(),
                Effect::Resets => goes || word.has_values,
                _ => false,
            };
            if is_refused {
                return Err(block.refused(word, &format!("{}, and is not read here.", row.does)));
            }
            match row.effect {
                Effect::Moves(mode) => {
                    if motion.replace(mode).is_some_and(|other| other != mode) {
                        let why = "is the second word in this block that says how to go.";
                        return Err(block.refused(word, why));
                    }
                    self.mode = Some(mode);
                    if !matches!(mode, Mode::Drill(_)) {
                        self.cycle.end();
                    }
                }
                Effect::EndsCycle => {
                    self.cycle.end();
                    self.mode = self.mode.filter(|mode| !matches!(mode, Mode::Drill(_) | Mode::Unfollowed));
                }
                Effect::Plane(plane) => self.plane = plane,
                Effect::Inches(_) if block.word(b'Q').is_some() => {
                    return Err(block.refused(word, "with Q is a cycle of a lathe, and is not read here."));
                }
                Effect::Inches(inches) => {
                    self.clues.is_stated = true;
                    if !self.builder.measures(inches) {
                        return Err(word.place.wrong("The units change within the path."));
                    }
                }
                Effect::Steps(steps) => self.steps = steps,
                Effect::CentresAbsolute(absolute) => self.centres_absolute = absolute,
                Effect::Feeds(feeds) => {
                    self.feeds = feeds;
                    self.builder.feed = None;
                }
                Effect::CuttingSpeed(is_cutting) => {
                    self.is_cutting_speed = is_cutting;
                    self.builder.spindle = None;
                }
                Effect::Vectors(vectors) => {
                    self.vectors = vectors;
                    if vectors {
                        self.builder.form.before = &[" X", " Y", " Z", " I", " J", " K"];
                    }
                }
                Effect::BackToStart(is_asked) => self.cycle.back_to_start = Some(is_asked),
                Effect::Offset(letter) => self.offset(block, word, letter)?,
                Effect::Machine | Effect::Home => {
                    fate.leaves = true;
                    fate.stays_without_axes = row.effect == Effect::Machine;
                }
                Effect::Dwells => {
                    fate.dwells = true;
                    fate.takes_axes = goes && block.word(b'P').is_none();
                    let more = block.words.iter().find(|word| !matches!(word.axis(), None | Some(0)));
                    if let Some(more) = more.filter(|_| fate.takes_axes) {
                        let why = "stands beside a waiting time: X alone is one, P lets the block move.";
                        return Err(block.refused(more, why));
                    }
                }
                Effect::TakesAxes => fate.takes_axes = true,
                Effect::Ends => fate.ends = true,
                Effect::Quiet
                | Effect::Declares
                | Effect::Alone
                | Effect::Resets
                | Effect::Turns
                | Effect::Stops
                | Effect::Refused => {}
            }
        }
        Ok(fate)
    }

    /// Whether a point has been read.
    fn has_moved(&self) -> bool {
        !self.builder.points.is_empty()
    }

    /// Takes another frame of the points.
    fn offset(&mut self, block: &Block<'_, '_>, word: &Word<'_>, letter: Option<u8>) -> Result<()> {
        let code = word.number.value;
        let number = letter.map(|letter| block.value(letter));
        let Some(number) = number.unwrap_or(Some(0.0)) else {
            return Ok(());
        };
        let is_shift = matches!(code, 58.0 | 59.0)
            && !block.words.iter().any(|word| word.letter == b'G' && word.number.value != code);
        if let Some(axis) = block.words.iter().find(|word| word.axis().is_some()).filter(|_| is_shift) {
            let why = "is a shift of the frame on Siemens controls and a point on others: put the offset into a block \
                of its own.";
            return Err(block.refused(axis, why));
        }
        let offset = [code, number];
        let first = self.has_moved().then_some([FIRST_OFFSET, 0.0]);
        let before = self.offset.replace(offset).or(first);
        if before.is_some_and(|before| before != offset) {
            let line = word.place.line_number();
            self.builder.remark("work-offset", "", line, Severity::Serious, || {
                "The work offset changes within the program ({}): the cell has one workpiece frame.".to_string()
            });
        }
        Ok(())
    }

    /// Refuses words that no word of the block takes.
    pub(super) fn check(&mut self, block: &Block<'_, '_>) -> Result<()> {
        let effects = || {
            let code_words = block.words.iter().filter(|word| word.is_own());
            code_words.map(|word| word.row.map(|row| row.effect))
        };
        let goes = block.words.iter().any(|word| word.axis().is_some());
        let takes_numbers = || {
            effects().any(|effect| {
                !matches!(
                    effect,
                    Some(Effect::Moves(_) | Effect::Steps(_) | Effect::Plane(_) | Effect::Feeds(_) | Effect::Inches(_))
                )
            })
        };
        // What a block without a point may say to its other words.
        let is_loose = || effects().any(|effect| effect == Some(Effect::TakesAxes)) || !goes && takes_numbers();
        let is_straight = matches!(self.mode, None | Some(Mode::Rapid | Mode::Feed));
        let is_drilling = matches!(self.mode, Some(Mode::Drill(_) | Mode::Unfollowed));
        // A bit for each letter that is in the block.
        let mut seen = 0_u32;
        for (count, word) in block.words.iter().enumerate() {
            let is_again = match (word.letter, word.index) {
                (0 | b'G' | b'M' | b'N' | b'O', _) => false,
                (letter, 0) => {
                    let bit = 1 << (letter - b'A');
                    let before = seen;
                    seen |= bit;
                    before & bit != 0
                }
                (letter, index) => {
                    let mut before = block.words[..count].iter();
                    before.any(|other| (other.letter, other.index) == (letter, index))
                }
            };
            if is_again {
                return Err(word.place.wrong("This word stands twice in the block."));
            }
            let why = match (word.letter, word.index) {
                (b'U' | b'V' | b'W', _) => "is an axis that is not read here.",
                (b'A'..=b'C', 3) => continue,
                (b'X'..=b'Z' | b'A'..=b'C' | b'I'..=b'K', 1..) => {
                    "is a word of Siemens controls that is not read here."
                }
                (b'L', _) if !(takes_numbers() || is_drilling && goes) => "calls a subprogram, and is not read here.",
                (b'I'..=b'K', _) if is_straight && !self.vectors && !is_loose() => "has no arc to belong to.",
                (b'I'..=b'K', _) if matches!(self.mode, Some(Mode::Arc { .. })) && self.vectors => {
                    "is the tool axis or a centre here (G43.5): state arcs by R, or as straight moves."
                }
                (b'R', _) if is_straight && !is_loose() => "has no arc or cycle to belong to.",
                (b'P' | b'Q', _) if is_straight && goes && !takes_numbers() => "has no word to belong to.",
                (b'R' | b'Q' | b'K', _) if is_drilling && !goes => {
                    "changes a cycle in a block without a point, and is not read here."
                }
                (b'E', _) => {
                    let line = word.place.line_number();
                    self.builder.not_followed("The axis E", line, Severity::Note);
                    continue;
                }
                _ => continue,
            };
            return Err(block.refused(word, why));
        }
        Ok(())
    }
}
