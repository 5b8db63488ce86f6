//! The same program with other numbers.

use super::divided::{Divided, Piece, pieces};
use super::numbers::{bends, decimals_of, near};
use super::targets::{SAME_ORIENTATION, SAME_POSITION, TargetOrientation, is_same, placed};
use super::{Form, Kind, Orientation, Slot, TOLERANCE, ToolPath};
use crate::program::fixed;
use nalgebra::Vector3;
use stiffarm::error::{Code, Error, Result};
use stiffarm::findings::{Finding, Severity, length};
use stiffarm::model::path::PathPoint;
use stiffarm::units::rad_to_deg;

/// A smaller tilt is not worth a word \[rad\].
const TILTED: f64 = 1e-5;

/// A program that was written.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenPath {
    /// Names, as they were read, and contents.
    pub files: Vec<(String, Vec<u8>)>,
    /// The largest angle between the tool axis that was asked for and that of the program, which cannot
    /// hold it \[rad\].
    pub tilt_left: f64,
    /// How far the corrections of long moves depart from straight ones where the program can have no more
    /// points \[m\].
    pub bend_left: f64,
}

impl WrittenPath {
    /// What the program cannot hold, where this matters.
    pub fn findings(&self) -> Vec<Finding> {
        let tilt = format!(
            "The program holds no tool axis that could be corrected: positions are, and the tool stays tilted by up \
             to {:.3}°.",
            rad_to_deg(self.tilt_left)
        );
        let bend = format!(
            "Within long moves the corrections depart by up to {} from straight ones, and the program states no \
             points there: divide its long moves, or write a table with `--write poses`.",
            length(self.bend_left)
        );
        let all = [
            (self.tilt_left > TILTED, "tilt-left", Severity::Note, tilt),
            (self.bend_left > TOLERANCE, "bend-left", Severity::Caution, bend),
        ];
        let all = all.into_iter().filter(|(matters, ..)| *matters);
        all.map(|(_, code, severity, sentence)| Finding::new(code, severity, "path", sentence)).collect()
    }
}

/// New text for some bytes of a file.
struct Edit {
    file: u8,
    at: u32,
    length: u32,
    text: String,
}

impl ToolPath {
    /// What it is written in.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The ending of its second file, where it has one.
    pub fn companion(&self) -> Option<&'static str> {
        self.kind.companion().filter(|_| self.files.len() > 1)
    }

    /// Whether the program states the point of this number; those on an arc it does not.
    pub fn holds(&self, point: usize) -> bool {
        let first = point.checked_sub(1).map_or(0, |before| self.ends[before]);
        self.ends.get(point).is_some_and(|end| *end > first)
    }

    /// The program with the targets of `commanded` where it had those of `nominal`, the points that were
    /// read. A number that does not change in its decimals keeps its text, so that equal targets give
    /// the same bytes. Arcs become straight moves where anything changes.
    ///
    /// # Errors
    /// Other points than were read; incremental moves; a point of the program at which two moves need
    /// different numbers.
    pub fn write(&self, nominal: &[PathPoint], commanded: &[PathPoint]) -> Result<WrittenPath> {
        if [nominal.len(), commanded.len()] != [self.ends.len(); 2] {
            let message = "These are other points than those of the program.";
            return Err(Error::new(Code::Dimension, message));
        }
        if let Some((line, why)) = self.fixed {
            let message = format!("The program cannot be written with other numbers: {why}.");
            let error = Error::new(Code::Unsupported, message).line(line, None);
            let error = error.file(self.files[0].name.as_str());
            return Err(error.hint("write a table of the path, in poses or angles"));
        }
        let is_still = |(nominal, commanded)| is_same(&self.form, nominal, commanded);
        if nominal.iter().zip(commanded).all(is_still) {
            return Ok(WrittenPath { files: self.edited(&[])?, tilt_left: 0.0, bend_left: 0.0 });
        }
        let mut writer = Writer {
            path: self,
            last: [f64::NAN; 10],
            numbers: [f64::NAN; 10],
            edits: Vec::new(),
            has_changed: false,
            tilt_left: 0.0,
            bend_left: 0.0,
        };
        let mut divided = self.divided.iter().peekable();
        // Numbers from the point before a divided move on.
        let mut way: Vec<[f64; 10]> = Vec::new();
        // How far along it they are.
        let mut at: Vec<f64> = Vec::new();
        let (mut place, mut start) = (Vector3::zeros(), Vector3::zeros());
        let mut straight: Vec<(&Divided, Vec<Piece>)> = Vec::new();
        for (i, (nominal, commanded)) in nominal.iter().zip(commanded).enumerate() {
            let first = i.checked_sub(1).map_or(0, |before| self.ends[before]);
            let slots = first..self.ends[i];
            let before = writer.numbers;
            let (from, was) = placed(&self.form, nominal)?;
            let last = std::mem::replace(&mut place, from);
            writer.aim(slots.clone(), (from, was), commanded)?;
            while divided.next_if(|one| one.points.end <= i).is_some() {}
            let Some(division) = divided.peek().filter(|division| division.points.contains(&i)) else {
                writer.edit(slots, nominal.rapid);
                continue;
            };
            if division.points.start == i {
                (way, at) = (vec![before], vec![0.0]);
                start = last;
            }
            way.push(writer.numbers);
            at.push((place - start).norm());
            if division.points.end > i + 1 {
                continue;
            }
            let corners = if division.is_whole {
                (1..way.len()).collect()
            } else {
                writer.bends(&way, &at, !division.text.is_empty())
            };
            if corners.is_empty() {
                writer.edit(slots, false);
            } else {
                straight.push((division, pieces(division, &way, &corners)));
                writer.last = writer.numbers;
            }
        }
        let straight = straight.iter().filter(|_| writer.has_changed);
        writer.edits.extend(straight.map(|(division, pieces)| Edit {
            file: 0,
            at: division.text.start as u32,
            length: division.text.len() as u32,
            text: self.lines(division, pieces, nominal),
        }));
        let Writer { mut edits, tilt_left, bend_left, .. } = writer;
        edits.sort_by_key(|edit| (edit.file, edit.at));
        Ok(WrittenPath { files: self.edited(&edits)?, tilt_left, bend_left })
    }

    /// The files with `edits`, which are in order.
    fn edited(&self, edits: &[Edit]) -> Result<Vec<(String, Vec<u8>)>> {
        let files = self.files.iter().enumerate();
        let written = files.map(|(number, file)| {
            let mut text = String::with_capacity(file.text.len() + 2 * edits.len());
            let (mut from, mut last): (usize, Option<&Edit>) = (0, None);
            for edit in edits.iter().filter(|edit| usize::from(edit.file) == number) {
                if let Some(last) = last.filter(|last| last.at == edit.at && edit.length > 0) {
                    if last.text == edit.text {
                        continue;
                    }
                    let line = file.text[..edit.at as usize].matches('\n').count() + 1;
                    let message = "Two moves go to this point, and need different corrections there.";
                    let error = Error::new(Code::Conflict, message).line(line, None);
                    return Err(error
                        .file(file.name.as_str())
                        .hint("give each of them a point of its own, or write a new program (--write)"));
                }
                text += &file.text[from..edit.at as usize];
                text += &edit.text;
                from = (edit.at + edit.length) as usize;
                last = Some(edit);
            }
            text += &file.text[from..];
            let bytes = if self.latin {
                text.chars().map(|c| u8::try_from(c).unwrap_or(b'?')).collect()
            } else {
                text.into_bytes()
            };
            Ok((file.name.clone(), bytes))
        });
        written.collect()
    }
}

/// What goes from point to point.
struct Writer<'a> {
    path: &'a ToolPath,
    /// Numbers that were written last.
    last: [f64; 10],
    /// Numbers of this point.
    numbers: [f64; 10],
    edits: Vec<Edit>,
    has_changed: bool,
    tilt_left: f64,
    bend_left: f64,
}

impl Writer<'_> {
    /// Takes the numbers of a point, which was at `from`, turned as `was`.
    fn aim(
        &mut self,
        slots: std::ops::Range<usize>,
        (from, was): (Vector3<f64>, TargetOrientation),
        commanded: &PathPoint,
    ) -> Result<()> {
        let form = &self.path.form;
        let (position, is) = placed(form, commanded)?;
        let moved =
            if (position - from).norm() < SAME_POSITION { Vector3::zeros() } else { (position - from) / form.unit };
        let from = from / form.unit;
        self.numbers[..3].copy_from_slice((from + moved).as_slice());
        let mut is_stated = false;
        for slot in slots {
            let component = usize::from(self.path.slots[slot].component);
            let value = self.path.values[slot];
            // From the number that stands there: what does not move keeps it to the last digit.
            self.numbers[component] = value + moved.as_slice().get(component).unwrap_or(&0.0);
            is_stated |= component >= 3;
        }
        let old = self.numbers;
        let tilt = was.axis().angle(&is.axis());
        self.has_changed |= moved.amax() > 0.5 * 10f64.powi(-(form.decimals[0] as i32));
        self.has_changed |= tilt >= SAME_ORIENTATION && form.orientation != Orientation::Kept;
        match form.orientation {
            Orientation::Kept => self.tilt_left = self.tilt_left.max(tilt),
            Orientation::Axis => {
                if tilt >= SAME_ORIENTATION || !is_stated {
                    self.numbers[3..6].copy_from_slice((-is.axis()).as_slice());
                }
            }
            Orientation::Full { convention, degrees } => {
                let (was, is) = (was.rotation()?, is.rotation()?);
                if was.angle_to(&is) >= SAME_ORIENTATION {
                    let count = convention.columns().len();
                    let near = near(convention, degrees, &old[3..3 + count], &is);
                    self.numbers[3..3 + count].copy_from_slice(&near);
                }
            }
        }
        Ok(())
    }

    /// The points of a straight move that its corrected form has to pass, as [`bends`] has them, the end
    /// included; none where it stays straight, or where the program `can_have` no more points.
    fn bends(&mut self, way: &[[f64; 10]], at: &[f64], can_have: bool) -> Vec<usize> {
        let unit = self.path.form.unit;
        let (corners, most) = bends(way, at, TOLERANCE / unit);
        if !can_have {
            self.bend_left = self.bend_left.max(most * unit);
            return Vec::new();
        }
        corners
    }

    /// The text of a slot's number, and whether it says what is there.
    fn text(&self, slot: usize) -> (String, bool) {
        let Slot { at, length, file, component, modal } = self.path.slots[slot];
        let component = usize::from(component);
        let old_text = &self.path.files[usize::from(file)].text[at as usize..][..usize::from(length)];
        let fewest = self.path.form.decimals_of(component);
        let decimals = decimals_of(old_text).map_or(fewest, |decimals| decimals.max(fewest));
        let text = fixed(self.numbers[component], decimals);
        // What a line leaves out is what was written last.
        let before =
            if modal && !self.last[component].is_nan() { self.last[component] } else { self.path.values[slot] };
        let is_same = text == fixed(before, decimals);
        if is_same && length > 0 { (old_text.to_string(), true) } else { (text, is_same) }
    }

    /// Writes the numbers of a point into `slots`. A `rapid` move keeps what it leaves out: it retracts
    /// straight from where a correction has led.
    fn edit(&mut self, slots: std::ops::Range<usize>, rapid: bool) {
        let path = self.path;
        let is_written = |slot: &usize| path.slots[*slot].component < 3 || path.form.orientation != Orientation::Kept;
        let texts = slots.filter(is_written).map(|slot| (slot, self.text(slot)));
        let texts: Vec<(usize, (String, bool))> = texts.collect();
        let turns = |slot: usize| path.slots[slot].length == 0 && path.slots[slot].component >= 3;
        // Of an orientation that a line leaves out all numbers are written, or none.
        let has_turned = texts.iter().any(|(slot, (_, is_same))| turns(*slot) && !is_same);
        for (slot, (mut text, is_same)) in texts {
            let Slot { at, length, file, component, .. } = path.slots[slot];
            let component = usize::from(component);
            if length == 0 {
                if rapid || is_same && !(turns(slot) && has_turned) {
                    continue;
                }
                text = format!("{}{text}", path.form.before[component]);
            }
            self.last[component] = self.numbers[component];
            // Only a point with a name can be that of two moves, which have to agree on its text.
            let may_be_shared = matches!(path.form.orientation, Orientation::Full { .. });
            if length > 0 && is_same && !may_be_shared {
                continue;
            }
            self.push(file, at, length, text);
        }
    }

    /// Keeps the columns of what is written in columns.
    fn push(&mut self, file: u8, at: u32, length: u16, text: String) {
        let file_text = &self.path.files[usize::from(file)].text;
        let blank = file_text[..at as usize].bytes().rev().take_while(|byte| *byte == b' ');
        // One space stays.
        let spare = blank.count().saturating_sub(1);
        let longer = text.len() as isize - isize::from(length as i16);
        let (mut at, mut length, mut text) = (at, u32::from(length), text);
        if length > 0 && longer > 0 {
            let taken = spare.min(longer as usize) as u32;
            (at, length) = (at - taken, length + taken);
        } else if length > 0 && longer < 0 && spare > 0 {
            text.insert_str(0, &" ".repeat(longer.unsigned_abs()));
        }
        self.edits.push(Edit { file, at, length, text });
    }
}

impl Form {
    pub(super) fn decimals_of(&self, component: usize) -> usize {
        self.decimals[usize::from(component >= 3)]
    }
}
