//! G-code: ISO 6983-1, with what FANUC, Siemens and LinuxCNC add for five axes.
//!
//! Grammar: ISO 6983-1:2009; LinuxCNC *G-Code Reference* (G90.1, R and I J K arcs, G93); Siemens *SINUMERIK,
//! Multi-axis machining* (`TRAORI`, `A3= B3= C3=`, `CR=`); FANUC *Series 30i Operator's Manual* (G43.4, G43.5
//! with I J K as the tool axis). Points are those of the tool tip: lengths of tools are the control's.
//! Rotary words A, B, C need the kinematics of the machine, `rotary_axes` in `[work]` of the cell.

mod circle;
mod words;

use super::builder::{Builder, Feed, Place};
use super::{Divided, FAR_AWAY, FARTHEST, Orientation};
use crate::program::{Number, ProgramFile, lines};
use nalgebra::{UnitVector3, Vector3};
use stiffarm::error::Result;
use stiffarm::findings::Severity;
use words::{Word, axis_component, is_target, words_of};

/// G-words, times ten, that change no point: offsets of tools, feed, exact stop, returns of cycles.
const QUIET: &[u16] = &[
    80, 90, 150, 230, 400, 430, 434, 435, 440, 490, 500, 501, 600, 601, 602, 610, 611, 620, 630,
    640, 641, 642, 690, 800, 930, 940, 950, 960, 970, 980, 990, 1500, 1600, 6410, 6420, 6430, 6440,
    6450,
];

/// G-words, times ten, that move or turn the frame of the points, or go on a spline.
const REFUSED: &[u16] = &[
    50, 51, 52, 53, 62, 100, 120, 160, 330, 332, 333, 380, 383, 410, 420, 510, 520, 680, 682, 684,
    920, 921, 922, 923, 5100, 71, 121, 511, 650, 660, 661, 1100, 1110, 1120,
];

#[derive(Clone, Copy, PartialEq)]
enum Mode {
    Rapid,
    Feed,
    /// Counter-clockwise or clockwise.
    Arc(bool),
}

struct State<'b, 'c> {
    builder: &'b mut Builder<'c>,
    mode: Option<Mode>,
    /// The axis across the plane of arcs.
    plane: usize,
    steps: bool,
    centres_absolute: bool,
    /// Whether I, J, K of a straight move are the tool axis (G43.5).
    vectors: bool,
    offset: Option<u16>,
    /// In units of the program, as far as it is known.
    position: [Option<f64>; 3],
    /// Of A, B, C \[deg\].
    rotary: [f64; 3],
    axis: UnitVector3<f64>,
    /// As it was stated last.
    stated: [f64; 3],
    /// What F stands for: 93 the inverse of a time, 94 a feed a minute, 95 a turn.
    feeds: u16,
    /// S is the speed of the cutting edge (G96), and not that of the spindle.
    is_cutting_speed: bool,
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
        feeds: 94,
        is_cutting_speed: false,
    };
    let mut words = Vec::new();
    for mut line in lines(file) {
        words.clear();
        let rest = words_of(&mut line, state.builder, &mut words)?;
        if words.iter().all(|word| matches!(word.letter, b'N' | b'O')) {
            // A comment with a line of its own names what follows, and one behind the program's number.
            let comment = |c: char| c.is_whitespace() || matches!(c, ';' | '(' | ')');
            state.builder.named(rest.trim_matches(comment));
        }
        state.block(&words, &rest, file)?;
    }
    Ok(())
}

impl State<'_, '_> {
    fn block(&mut self, words: &[Word<'_>], beside: &str, file: &ProgramFile) -> Result<()> {
        let mut skips = false;
        let goes = words.iter().any(|word| matches!(word.letter, b'X'..=b'Z'));
        for word in words.iter().filter(|word| word.letter == b'G') {
            skips |= self.prepare(word, goes)?;
        }
        for word in words.iter().filter(|word| word.letter == b'M') {
            if matches!(word.number.value as i64, 97 | 98 | 198) {
                return Err(word
                    .place
                    .wrong("Subprograms are not read here: post-process the path into one file."));
            }
        }
        let feed = words.iter().find(|word| word.letter == b'F');
        if let Some(word) = feed {
            self.feed(word);
        }
        let speed = words
            .iter()
            .find(|word| word.letter == b'S' && word.index < 2);
        if let Some(word) = speed.filter(|_| !self.is_cutting_speed) {
            self.builder.spindle = Some(word.number.value / 60.0);
        }
        if let Some(word) = words
            .iter()
            .find(|word| matches!(word.letter, b'U' | b'V' | b'W'))
        {
            return Err(word.place.wrong("Axes U, V and W are not read here."));
        }
        let moving = words.iter().filter(|word| is_target(word, self.vectors));
        let Some(last) = moving.clone().max_by_key(|word| word.end) else {
            return Ok(());
        };
        for (count, word) in words.iter().enumerate() {
            let same = |other: &Word<'_>| (other.letter, other.index) == (word.letter, word.index);
            if is_target(word, self.vectors) && words[..count].iter().any(same) {
                return Err(word.place.wrong("This word stands twice in the block."));
            }
        }
        if skips {
            // Where the machine stands then is its own affair.
            for word in moving.filter(|word| word.letter >= b'X') {
                self.position[usize::from(word.letter - b'X')] = None;
            }
            return Ok(());
        }
        let Some(mode) = self.mode else {
            return Ok(());
        };
        let (before, start) = (self.axis, self.position);
        self.turn(words)?;
        for word in words
            .iter()
            .filter(|word| (b'X'..=b'Z').contains(&word.letter))
        {
            let own = &mut self.position[usize::from(word.letter - b'X')];
            *own = if self.steps {
                own.map(|own| own + word.number.value)
            } else {
                Some(word.number.value)
            };
        }
        let line = last.place.line_number();
        let Some(end) = known(&self.position) else {
            if mode != Mode::Rapid {
                self.builder
                    .remark("position-unknown", "", line, Severity::Caution, || {
                        "Moves at feed before x, y and z are all known ({}) are left out."
                            .to_string()
                    });
            }
            return Ok(());
        };
        if (end * self.builder.form.unit).amax() > FARTHEST {
            return Err(last.place.wrong(FAR_AWAY));
        }
        if self.steps {
            self.builder
                .fixed
                .get_or_insert((line, "it moves by steps here"));
        }
        let unit = self.builder.form.unit;
        let place = Place::Axis(end * unit, self.axis);
        let start = known(&start).map(|start| start * unit);
        let first = self.builder.points.len();
        let Mode::Arc(is_left) = mode else {
            self.inverse(feed, start.map(|start| (end * unit - start).norm()));
            let from = start.filter(|_| mode == Mode::Feed);
            let from = from.map(|start| Place::Axis(start, before));
            if from.is_some_and(|from| self.builder.between(line, &from, &place)) {
                let points = first..self.builder.points.len() + 1;
                self.divided(words, beside, file, points, false);
            }
            self.builder.point(line, &place, mode == Mode::Rapid);
            self.slots(words, last.end);
            return Ok(());
        };
        let Some(start) = start else {
            return Err(last.place.wrong("An arc needs a point that it begins at."));
        };
        let Some(circle) = self.circle(words, start, end * unit, is_left)? else {
            return Err(last.place.wrong(
                "This is no arc: its end is not on the circle about its centre through the point before.",
            ));
        };
        self.inverse(feed, Some(circle.length()));
        let from = Place::Axis(start, before);
        for (share, point) in circle.points() {
            self.builder
                .point(line, &from.towards(&place, share, point), false);
        }
        let points = first..self.builder.points.len();
        self.divided(words, beside, file, points, true);
        Ok(())
    }

    /// Keeps how a block would be written as several straight moves.
    fn divided(
        &mut self,
        words: &[Word<'_>],
        beside: &str,
        file: &ProgramFile,
        points: std::ops::Range<usize>,
        is_arc: bool,
    ) {
        let begins = words
            .iter()
            .map(|word| word.place.position())
            .min()
            .unwrap_or(0);
        let ends = words.iter().map(|word| word.end).max().unwrap_or(begins);
        let text = |word: &Word<'_>| &file.text[word.place.position()..word.end];
        let number = words.iter().find(|word| word.letter == b'N');
        let others = words.iter().filter(|word| {
            let motion = word.letter == b'G' && (0.0..=3.0).contains(&word.number.value);
            !(motion
                || matches!(word.letter, b'N' | b'X'..=b'Z' | b'I'..=b'K' | b'R' | b'P')
                || word.index == 3)
        });
        let others: String = others.map(|word| format!(" {}", text(word))).collect();
        // Comments between words are behind them then.
        let inside = beside.trim_start().starts_with('(') && file.text[begins..ends].contains('(');
        self.builder.divided.push(Divided {
            points,
            is_arc,
            text: begins..ends,
            first: number.map_or_else(String::new, |word| format!("{} ", text(word))),
            begin: "G1".to_string(),
            end: if inside { others + beside } else { others },
        });
    }

    /// Takes a G-word of a block that `goes` to a point or does not; true where the points of its block are none of
    /// the path.
    fn prepare(&mut self, word: &Word<'_>, goes: bool) -> Result<bool> {
        let code = (word.number.value * 10.0).round() as u16;
        let line = word.place.line_number();
        let mut place = word.place.clone();
        match code {
            0 => self.mode = Some(Mode::Rapid),
            10 => self.mode = Some(Mode::Feed),
            20 | 30 => self.mode = Some(Mode::Arc(code == 30)),
            170 | 180 | 190 => self.plane = [2, 1, 0][usize::from(code / 10 - 17)],
            200 | 700 | 7000 | 210 | 710 | 7100 => {
                if !self.builder.measures(matches!(code, 200 | 700 | 7000)) {
                    return Err(place.wrong_here("The units change within the path."));
                }
            }
            930 | 940 | 950 => {
                self.feeds = code / 10;
                self.builder.feed = None;
            }
            960 | 970 => {
                self.is_cutting_speed = code == 960;
                self.builder.spindle = None;
            }
            900 => self.steps = false,
            910 => self.steps = true,
            901 => self.centres_absolute = true,
            911 => self.centres_absolute = false,
            540..=599 => {
                if self
                    .offset
                    .replace(code)
                    .is_some_and(|offset| offset != code)
                {
                    self.builder.remark("work-offset", "", line, Severity::Serious, || {
                        "The work offset changes within the program ({}): the cell has one workpiece frame.".to_string()
                    });
                }
            }
            40 | 280 | 281 | 300 | 530 | 750 => return Ok(true),
            730 | 740 | 760 | 810..=890 => {
                self.mode = None;
                self.builder
                    .remark("cycle", "", line, Severity::Caution, || {
                        "Drilling cycles ({}) are not followed: their points are left out."
                            .to_string()
                    });
            }
            // FANUC's contour control, unless it goes somewhere: then it is LinuxCNC's spline.
            50 | 51 if !goes => {}
            code if REFUSED.contains(&code) => {
                let message =
                    "This changes where the points lie, or goes on a curve, and is not read here.";
                return Err(place.wrong_here(message).hint(
                    "post-process the path with absolute points of the tool tip in the frame of the workpiece",
                ));
            }
            _ => {
                self.vectors |= code == 435;
                if matches!(code, 490 | 430 | 434) {
                    self.vectors = false;
                }
                if code == 435 {
                    self.builder.form.before = &[" X", " Y", " Z", " I", " J", " K"];
                }
                if !QUIET.contains(&code) {
                    let name = format!("G{}", word.number.value);
                    self.builder.not_followed(&name, line, Severity::Note);
                }
            }
        }
        Ok(false)
    }

    /// Takes the feed of a block, where it is one a minute or a turn.
    fn feed(&mut self, word: &Word<'_>) {
        let own = word.number.value * self.builder.form.unit;
        match self.feeds {
            94 => self.builder.feed = Some(Feed::Second(own / 60.0)),
            95 => self.builder.feed = Some(Feed::Turn(own)),
            _ => {}
        }
    }

    /// Takes the feed of a move of this length \[m\], where it is the inverse of the move's time.
    fn inverse(&mut self, word: Option<&Word<'_>>, way: Option<f64>) {
        if self.feeds == 93 {
            let pair = word.zip(way);
            self.builder.feed =
                pair.map(|(word, way)| Feed::Second(word.number.value * way / 60.0));
        }
    }

    /// Takes the tool axis.
    fn turn(&mut self, words: &[Word<'_>]) -> Result<()> {
        let component = |word: &Word<'_>| {
            axis_component(word, self.vectors && self.mode != Some(Mode::Arc(true)))
        };
        let vector: Vec<(usize, &Word<'_>)> = words
            .iter()
            .filter_map(|word| Some((component(word)?, word)))
            .collect();
        if let Some((_, first)) = vector.first() {
            let mut axis = Vector3::zeros();
            for (component, word) in &vector {
                axis[*component] = word.number.value;
            }
            self.stated = axis.into();
            let Some(axis) = UnitVector3::try_new(axis, 1e-6) else {
                return Err(first.place.wrong("This tool axis has length zero."));
            };
            self.axis = axis;
            self.builder.form.orientation = Orientation::Axis;
        }
        let mut has_turned = false;
        for word in words
            .iter()
            .filter(|word| word.index == 0 && (b'A'..=b'C').contains(&word.letter))
        {
            let own = &mut self.rotary[usize::from(word.letter - b'A')];
            let value = if self.steps {
                *own + word.number.value
            } else {
                word.number.value
            };
            let is_known = self
                .builder
                .cell
                .work
                .rotary
                .iter()
                .any(|axis| axis.letter() == word.letter);
            if !is_known && value != 0.0 {
                let letter = char::from(word.letter);
                let message = format!(
                    "The rotary axis {letter} turns, and nothing says how it carries the tool."
                );
                return Err(word.place.wrong(message).hint(
                    "say so in [work] of the cell, from the workpiece to the tool: rotary_axes = [\"C\", \"A\"] for a \
                     head that turns about C and then A, [\"-A\", \"-C\"] for a table",
                ));
            }
            (*own, has_turned) = (value, true);
        }
        if has_turned {
            let axes = self.builder.cell.work.rotary.iter().rev();
            let turned = axes.fold(Vector3::z(), |axis, rotary| {
                rotary.rotation(self.rotary[usize::from(rotary.letter() - b'A')]) * axis
            });
            self.axis = UnitVector3::new_normalize(turned);
        }
        Ok(())
    }

    /// The places of the numbers of the point given last; what is left out would stand at `end`.
    fn slots(&mut self, words: &[Word<'_>], end: usize) {
        // Of an axis that is stated, components that are left out are zero.
        let has_axis = words
            .iter()
            .any(|word| axis_component(word, self.vectors).is_some());
        for component in 0..6 {
            let word = words.iter().find(|word| match component {
                0..3 => word.letter == b'X' + component as u8,
                _ => axis_component(word, self.vectors) == Some(component - 3),
            });
            let value = match component {
                0..3 => self.position[component].unwrap_or_default(),
                _ => self.stated[component - 3],
            };
            let left_out = Number {
                value,
                at: end as u32,
                length: 0,
            };
            let modal = word.is_none() && !(has_axis && component >= 3);
            let number = word.map_or(left_out, |word| word.number);
            self.builder.numeral(0, component, number, modal);
        }
    }
}

fn known(position: &[Option<f64>; 3]) -> Option<Vector3<f64>> {
    match *position {
        [Some(x), Some(y), Some(z)] => Some(Vector3::new(x, y, z)),
        _ => None,
    }
}
