//! The moves of a robot's program as a tool path.
//!
//! Linear moves and arcs are the path; joint moves to a pose lead there without load; joint moves to
//! angles are no part of it. The program's own tool and base are held against those of the cell where
//! the program says them.

use super::arc::Circle;
use super::builder::{Builder, Feed, Place};
use super::{Divided, FAR_AWAY, FARTHEST, Form, Orientation};
use crate::program::{
    Aim, Language, Motion, Number, Pose, PoseForm, ProgramFile, ProgramOptions, Reader, read_legs,
};
use nalgebra::{Isometry3, Vector3};
use stiffarm::error::Result;
use stiffarm::findings::Severity;
use stiffarm::model::pose::Convention;
use stiffarm::units::deg_to_rad;

pub(super) fn read(
    files: &[ProgramFile],
    language: Language,
    builder: &mut Builder<'_>,
) -> Result<()> {
    let Some(poses) = language.poses() else {
        return Ok(());
    };
    let robot = &builder.cell.setup.robot;
    let base = *robot.controller_base();
    builder.form = Form {
        orientation: Orientation::Full {
            convention: poses.convention,
            degrees: poses.degrees,
        },
        unit: poses.unit,
        before: poses.before,
        decimals: poses.decimals,
        frame: if poses.in_base {
            base
        } else {
            builder.cell.work.workpiece
        },
    };
    let options = ProgramOptions::default();
    let mut reader = Reader::new(&options, robot.joint_count(), |axis| {
        format!("axis {}", axis + 1)
    });
    reader.is_path = true;
    let legs = read_legs(files, language, &mut reader)?;
    let mut walk = Walk {
        builder,
        poses,
        numbers: [None; 7],
        last: None,
    };
    for leg in legs {
        let line = leg.place.line_number();
        let (to, via) = match (leg.aim, leg.via.map(|via| *via)) {
            (Aim::Pose(to), None) => (to, None),
            (Aim::Pose(to), Some(Aim::Pose(via))) => (to, Some(via)),
            (Aim::Angles(_), None) if leg.motion == Motion::Joint => {
                walk.builder.remark("joint-moves", "", line, Severity::Note, || {
                    "Moves to joint angles ({}) stay as they are: the path is what lies between them.".to_string()
                });
                continue;
            }
            _ => {
                return Err(leg
                    .place
                    .wrong("This move needs a pose, and the point has joint angles."));
            }
        };
        walk.builder.feature = leg.feature;
        walk.builder.feed = leg.feed.map(Feed::Second);
        let at = |error: stiffarm::Error| error.line(line, None).file(files[0].name.as_str());
        match via {
            Some(via) => walk.arc(line, &via, &to),
            None => walk.go(line, &to, leg.motion == Motion::Joint),
        }
        .map_err(at)?;
    }
    for (line, name) in &reader.assigned {
        if reader.named_points.contains(&name.to_ascii_uppercase()) {
            builder.remark("point-assigned", name, *line, Severity::Serious, || {
                format!("The program sets {name} itself ({{}}), and what it says then is not read: the robot goes elsewhere.")
            });
        }
    }
    for (line, word) in std::mem::take(&mut reader.passed_over) {
        builder.not_followed(word, line, Severity::Caution);
    }
    frames(&reader, &poses, &base, builder)
}

struct Walk<'b, 'c> {
    builder: &'b mut Builder<'c>,
    poses: PoseForm,
    /// What the numbers of the next pose are where it leaves them out.
    numbers: [Option<f64>; 7],
    last: Option<Place>,
}

impl Walk<'_, '_> {
    fn place(&mut self, to: &Pose) -> Result<Place> {
        for (own, number) in self.numbers.iter_mut().zip(to.values()) {
            *own = number.or(*own);
        }
        placed(&self.poses, &self.numbers).map(Place::Pose)
    }

    fn go(&mut self, line: usize, to: &Pose, rapid: bool) -> Result<()> {
        let place = self.place(to)?;
        let first = self.builder.points.len();
        let from = self.last.filter(|_| !rapid);
        if from.is_some_and(|from| self.builder.between(line, &from, &place)) {
            self.builder.divided.push(Divided {
                points: first..self.builder.points.len() + 1,
                ..Divided::default()
            });
        }
        self.builder.point(line, &place, rapid);
        self.slots(to, self.numbers);
        self.last = Some(place);
        Ok(())
    }

    /// The places of the numbers of the point given last, which are `values` where they are left out.
    fn slots(&mut self, to: &Pose, values: [Option<f64>; 7]) {
        let count = self.poses.convention.columns().len() + 3;
        let numbers = to.numbers.iter().zip(values).take(count);
        for (component, (number, value)) in numbers.enumerate() {
            let left_out = Number {
                value: value.unwrap_or_default(),
                at: to.end,
                length: 0,
            };
            self.builder
                .number(to.file, component, number.unwrap_or(left_out));
        }
    }

    /// Of an arc the point on the way and the end are corrected; those between are there for their loads.
    fn arc(&mut self, line: usize, via: &Pose, to: &Pose) -> Result<()> {
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
    Ok(Isometry3::from_parts(
        position.into(),
        poses.convention.rotation(&turns)?,
    ))
}

/// Holds the frames that the program says against those of the cell.
fn frames(
    reader: &Reader<'_>,
    poses: &PoseForm,
    base: &Isometry3<f64>,
    builder: &mut Builder<'_>,
) -> Result<()> {
    let work = &builder.cell.work;
    let (tip, workpiece) = (work.tip(&builder.cell.setup.tool), work.workpiece);
    let kinds = [
        ("The tool frame", "the tip of the cell ([work] tip_mm)", tip),
        (
            "The base",
            "the workpiece frame of the cell ([work] workpiece_mm)",
            workpiece,
        ),
    ];
    for (number, ((what, own, cell), used)) in kinds.into_iter().zip(&reader.used).enumerate() {
        for (name, line) in used {
            let given = match (reader.frames.get(name), name.as_str()) {
                (Some(given), _) => {
                    placed(poses, &given.values()).map_err(|error| error.line(given.line, None))?
                }
                // RAPID's names of the base and of the flange.
                (None, "WOBJ0" | "TOOL0") => Isometry3::identity(),
                _ => {
                    builder.remark("frame-unknown", what, *line, Severity::Note, || {
                        format!("{what} {name} ({{}}) is not in the file, so it could not be held against {own}.")
                    });
                    continue;
                }
            };
            let given = if number == 1 { base * given } else { given };
            builder.frame(&format!("{what} {name} (line {line})"), own, &given, &cell);
        }
        if used.len() > 1 {
            let names: Vec<&str> = used.keys().map(String::as_str).collect();
            let (first, last) = (names[0], names[names.len() - 1]);
            let line = *used.values().max().unwrap_or(&1);
            builder.remark("program-frames", what, line, Severity::Serious, || {
                format!(
                    "{what} changes within the program ({first}, {last}; {{}}): the cell has one."
                )
            });
        }
    }
    Ok(())
}
