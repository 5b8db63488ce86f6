//! The moves of a robot's program as a tool path.
//!
//! Linear moves and arcs are the path; joint moves to a pose lead there without load; joint moves to
//! angles are no part of it. The program's own tool and base are held against those of the cell where
//! the program says them.

use super::arc::Circle;
use super::builder::{Builder, Feed, TipTarget};
use super::{Divided, FAR_AWAY, FARTHEST, Form, Orientation};
use crate::program::{
    ActiveFrame, Cursor, External, Frames, Language, Motion, MoveTarget, Number, Pose, PoseForm, ProgramFile,
    ProgramMove, ProgramOptions, Reader, read_legs,
};
use nalgebra::{Isometry3, Vector3};
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;
use stiffarm::error::{Error, Result};
use stiffarm::findings::Severity;
use stiffarm::model::pose::Convention;
use stiffarm::units::deg_to_rad;

pub(super) fn read(files: &[ProgramFile], language: Language, builder: &mut Builder<'_>) -> Result<()> {
    let Some(poses) = language.poses() else {
        return Ok(());
    };
    let robot = &builder.cell.setup.robot;
    let base = *robot.controller_base();
    builder.form = Form {
        orientation: Orientation::Full { convention: poses.convention, degrees: poses.degrees },
        unit: poses.unit,
        before: poses.before,
        decimals: poses.decimals,
        frame: if poses.in_base { base } else { builder.cell.work.workpiece },
    };
    let options = ProgramOptions::default();
    let mut reader = Reader::new(&options, robot.joint_count(), |axis| format!("axis {}", axis + 1));
    reader.is_path = true;
    let legs = read_legs(files, language, &mut reader)?;
    let mut walk = Walk {
        builder,
        poses,
        numbers: [None; 7],
        last: None,
        external: BTreeMap::new(),
        frames: Vec::new(),
        went: HashSet::new(),
    };
    for leg in legs {
        let line = leg.place.line_number();
        let at = |error: Error| match error.place().line {
            Some(_) => error,
            None => error.line(line, None).file(files[0].name.as_str()),
        };
        walk.leg(leg).map_err(at)?;
    }
    let Walk { external, frames, .. } = walk;
    for (name, axis) in external.iter().filter(|(_, axis)| axis.stands.is_some_and(|at| at != 0.0)) {
        let at = axis.stands.unwrap_or_default();
        builder.remark("external-axis", name, axis.line, Severity::Note, || {
            format!(
                "External axis {name} stands at {at} at every point ({{}} on): the cell's base is taken to be where \
                 the robot then stands."
            )
        });
    }
    let names = frames.iter().flat_map(|frame| frame.taken.as_ref());
    let frames_of_moves: HashSet<String> = names.map(|taken| taken.name.to_ascii_uppercase()).collect();
    for (line, name) in &reader.assigned {
        let name = name.to_ascii_uppercase();
        let code = if reader.named_points.contains(&name) {
            "point-assigned"
        } else if frames_of_moves.contains(&name) {
            "frame-assigned"
        } else {
            continue;
        };
        builder.remark(code, &name, *line, Severity::Serious, || {
            format!(
                "The program sets {name} itself ({{}}), and what it says then is not read: the robot goes elsewhere."
            )
        });
    }
    for remark in std::mem::take(&mut reader.remarks) {
        builder.remark(remark.code, &remark.word, remark.line, remark.severity, || remark.sentence);
    }
    hold(&frames, &poses, &base, builder)
}

/// An axis that carries the robot or the workpiece.
struct Axis {
    /// Where it stands at the points of the path, from the first one on.
    stands: Option<f64>,
    /// Where the last move left it.
    now: f64,
    line: usize,
}

/// A point's tool (0) or base (1).
struct Frame<'a> {
    number: usize,
    taken: Option<Arc<ActiveFrame<'a>>>,
}

/// So much may the same place of an external axis differ, in the program's unit: what is rounded.
const SAME_EXTERNAL_AXIS: f64 = 1e-3;

struct Walk<'a, 'b, 'c> {
    builder: &'b mut Builder<'c>,
    poses: PoseForm,
    /// What the numbers of the next pose are where it leaves them out.
    numbers: [Option<f64>; 7],
    last: Option<TipTarget>,
    /// By their names.
    external: BTreeMap<String, Axis>,
    /// Frames of the points, each once.
    frames: Vec<Frame<'a>>,
    /// Poses that leave numbers out: file and end.
    went: HashSet<(u32, u32)>,
}

impl<'a> Walk<'a, '_, '_> {
    fn leg(&mut self, leg: ProgramMove<'a>) -> Result<()> {
        let line = leg.place.line_number();
        let (to, via) = match (leg.target, leg.via.map(|via| *via)) {
            (MoveTarget::Pose(to), None) => (to, None),
            (MoveTarget::Pose(to), Some(MoveTarget::Pose(via))) => (to, Some(via)),
            (MoveTarget::Angles(_, external), None) if leg.motion == Motion::Joint => {
                self.stand(external, line);
                self.builder.remark("joint-moves", "", line, Severity::Note, || {
                    "Moves to joint angles ({}) stay as they are: the path is what lies between them.".to_string()
                });
                return Ok(());
            }
            _ => {
                let message = "This move needs a pose, and the point has joint angles.";
                return Err(leg.place.wrong(message));
            }
        };
        self.builder.feature = leg.feature;
        self.builder.feed = leg.feed.map(Feed::Second);
        for pose in via.iter().chain([&to]) {
            self.carried(&leg.place, pose)?;
            self.takes(&pose.frames, &leg.frames);
            let is_whole = pose.numbers.iter().take(6).all(Option::is_some);
            if !is_whole && !self.went.insert((pose.file, pose.end)) {
                let why = "a position that leaves numbers out is gone to twice";
                self.builder.fixed.get_or_insert((line, why));
            }
        }
        match via {
            Some(via) => self.arc(line, &via, &to),
            None => self.go(line, &to, leg.motion == Motion::Joint),
        }
    }

    /// A move leaves these axes there.
    fn stand(&mut self, external: Vec<External<'_>>, line: usize) {
        // At the points before it nothing is said of where they stood.
        let unsaid = (!self.builder.points.is_empty()).then_some(0.0);
        for External { name, value, .. } in external {
            let axis = self.external.entry(name).or_insert(Axis { stands: unsaid, now: value, line });
            axis.now = value;
        }
    }

    /// Axes that carry the robot or the workpiece have to stay where they are.
    fn carried(&mut self, place: &Cursor<'_>, pose: &Pose<'_>) -> Result<()> {
        let line = place.line_number();
        self.stand(pose.external.clone(), line);
        for (name, axis) in &mut self.external {
            let stands = *axis.stands.get_or_insert(axis.now);
            if (axis.now - stands).abs() > SAME_EXTERNAL_AXIS {
                let moved = pose.external.iter().find(|external| external.name == *name);
                let cursor = moved.map_or(place, |external| &external.place);
                let message = format!(
                    "The external axis {name} goes from {stands} to {} here: the path moves with it.",
                    axis.now
                );
                return Err(cursor.clone().wrong_here(message).hint(
                    "a path is read where external axes stand still: read the parts of the program between their moves \
                     as files of their own",
                ));
            }
        }
        Ok(())
    }

    /// The frames of a point: its own, else those of the move.
    fn takes(&mut self, point_frames: &Frames<'a>, others: &Frames<'a>) {
        for number in 0..2 {
            let taken = point_frames[number].as_ref().or(others[number].as_ref());
            let is_known = self.frames.iter().any(|frame| {
                let same = match (&frame.taken, taken) {
                    (Some(earlier), Some(taken)) => Arc::ptr_eq(earlier, taken) || earlier.is_same(taken),
                    (None, None) => true,
                    _ => false,
                };
                frame.number == number && same
            });
            if !is_known {
                self.frames.push(Frame { number, taken: taken.cloned() });
            }
        }
    }

    fn place(&mut self, to: &Pose<'_>) -> Result<TipTarget> {
        for (current, number) in self.numbers.iter_mut().zip(to.values()) {
            *current = number.or(*current);
        }
        placed(&self.poses, &self.numbers).map(TipTarget::Pose)
    }

    fn go(&mut self, line: usize, to: &Pose<'_>, rapid: bool) -> Result<()> {
        let place = self.place(to)?;
        let first = self.builder.points.len();
        let from = self.last.filter(|_| !rapid);
        if from.is_some_and(|from| self.builder.between(line, &from, &place)) {
            self.builder.divided.push(Divided { points: first..self.builder.points.len() + 1, ..Divided::default() });
        }
        self.builder.point(line, &place, rapid);
        self.slots(to, self.numbers);
        self.last = Some(place);
        Ok(())
    }

    /// The places of the numbers of the point given last, which are `values` where they are left out.
    fn slots(&mut self, to: &Pose<'_>, values: [Option<f64>; 7]) {
        let count = self.poses.convention.columns().len() + 3;
        let numbers = to.numbers.iter().zip(values).take(count);
        for (component, (number, value)) in numbers.enumerate() {
            let left_out = Number { value: value.unwrap_or_default(), at: to.end, length: 0 };
            self.builder.number(to.file, component, number.unwrap_or(left_out));
        }
    }

    /// Of an arc the point on the way and the end are corrected; those between are there for their loads.
    fn arc(&mut self, line: usize, via: &Pose<'_>, to: &Pose<'_>) -> Result<()> {
        let start = self.last;
        let middle = self.place(via)?;
        let of_middle = self.numbers;
        let end = self.place(to)?;
        let circle = start.and_then(|start| {
            let circle = Circle::through(start.position(), middle.position(), end.position())?;
            Some((start, circle))
        });
        let mut between = Vec::new();
        let mut before = 0;
        let mut middle = middle;
        if let (Some((start, circle)), false) = (&circle, self.poses.turns_on_the_way) {
            let share = circle.share_at(middle.position());
            middle = start.towards(&end, share, middle.position());
        }
        if let Some((start, circle)) = circle {
            let half = circle.share_at(middle.position());
            let inner = circle.points().filter(|(share, _)| *share < 1.0);
            for (share, point) in inner {
                before += usize::from(share < half);
                between.push(start.towards(&end, share, point));
            }
        }
        let (first, second) = between.split_at(before);
        for place in first {
            self.builder.point(line, place, false);
        }
        self.builder.point(line, &middle, false);
        self.slots(via, of_middle);
        for place in second {
            self.builder.point(line, place, false);
        }
        self.builder.point(line, &end, false);
        self.slots(to, self.numbers);
        self.last = Some(end);
        Ok(())
    }
}

/// Numbers of a program as a pose, SI.
fn placed(poses: &PoseForm, numbers: &[Option<f64>; 7]) -> Result<Isometry3<f64>> {
    let count = poses.convention.columns().len() + 3;
    let numbers: Option<Vec<f64>> = numbers[..count].iter().copied().collect();
    let Some(numbers) = numbers else {
        let message = "Some numbers of this first pose are missing.";
        return Err(stiffarm::Error::new(stiffarm::Code::Program, message));
    };
    let position = Vector3::from_column_slice(&numbers[..3]) * poses.unit;
    if position.amax() > FARTHEST {
        return Err(stiffarm::Error::new(stiffarm::Code::Program, FAR_AWAY));
    }
    let mut turns = numbers[3..].to_vec();
    if poses.degrees {
        turns.iter_mut().for_each(|turn| *turn = deg_to_rad(*turn));
    }
    if poses.convention == Convention::Abb {
        // Rounded to a few digits in many programs.
        let length = turns.iter().map(|q| q * q).sum::<f64>().sqrt();
        if (length - 1.0).abs() < 1e-2 {
            turns.iter_mut().for_each(|q| *q /= length);
        }
    }
    Ok(Isometry3::from_parts(position.into(), poses.convention.rotation(&turns)?))
}

/// Holds the frames of the points against those of the cell.
fn hold(frames: &[Frame<'_>], poses: &PoseForm, base: &Isometry3<f64>, builder: &mut Builder<'_>) -> Result<()> {
    let work = &builder.cell.work;
    let (tip, workpiece) = (work.tip(&builder.cell.setup.tool), work.workpiece);
    let kinds = [
        ("The tool frame", "the tip of the cell ([work] tip_mm)", tip),
        ("The base", "the workpiece frame of the cell ([work] workpiece_mm)", workpiece),
    ];
    for (number, (what, counterpart, cell)) in kinds.into_iter().enumerate() {
        let taken = frames.iter().filter(|frame| frame.number == number);
        let taken: Vec<&ActiveFrame<'_>> = taken.filter_map(|frame| frame.taken.as_deref()).collect();
        for ActiveFrame { name, line, factors } in &taken {
            let is_null = poses.null_frames.contains(&name.to_ascii_uppercase().as_str());
            if factors.is_empty() && !is_null {
                builder.remark("frame-unknown", what, *line, Severity::Note, || {
                    format!("{what} {name} ({{}}) is not in the file, so it could not be held against {counterpart}.")
                });
                continue;
            }
            let mut product = if number == 1 { *base } else { Isometry3::identity() };
            for factor in factors {
                product *= placed(poses, &factor.values()).map_err(|error| error.line(factor.line, None))?;
            }
            builder.frame(&format!("{what} {name} (line {line})"), counterpart, &product, &cell);
        }
        if let [first, .., last] = &taken[..] {
            builder.remark("program-frames", what, last.line, Severity::Serious, || {
                format!("{what} changes within the program ({}, {}; {{}}): the cell has one.", first.name, last.name)
            });
        }
    }
    Ok(())
}
