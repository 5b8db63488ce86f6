//! Points of CL data, and the frames that they count from.

use super::super::builder::TipTarget;
use super::super::{Divided, FAR_AWAY, FARTHEST, Orientation};
use super::State;
use super::statement::Statement;
use crate::program::Number;
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, UnitVector3, Vector3};
use std::ops::Range;
use stiffarm::error::Result;
use stiffarm::findings::Severity;

impl State<'_, '_> {
    /// `MSYS/`: points behind it count from another frame.
    pub(super) fn frame(&mut self, statement: &Statement<'_>) -> Result<()> {
        if statement.numbers.len() != 9 {
            return Err(statement.wrong("A frame has nine numbers: origin, x axis, y axis."));
        }
        let origin = statement.vector(0)? * self.builder.form.unit;
        let (x, y) = (statement.direction(3)?, statement.direction(6)?);
        let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[*x, *y, x.cross(&y)]));
        let rotation = UnitQuaternion::from_rotation_matrix(&axes);
        let frame = Isometry3::from_parts(origin.into(), rotation);
        let first = self.frames.map_or(frame, |(first, _)| first);
        self.frames = Some((first, first.inverse() * frame));
        if first != frame {
            let line = statement.head.line_number();
            self.builder.fixed.get_or_insert((line, "its frame changes here"));
        }
        Ok(())
    }

    /// `CSYS/`: rows of a matrix that leads from a set-up to one frame, in which CAMWorks gives all points
    /// behind `TRNTYP/WORLD`. So the tool axis of a tilted one is its third column.
    pub(super) fn set_up(&mut self, statement: &Statement<'_>) -> Result<()> {
        let frame: Vec<f64> = statement.numbers.iter().map(|(_, number)| number.value).collect();
        if frame.len() != 12 {
            return Err(statement.wrong("A set-up has twelve numbers: three rows of a matrix."));
        }
        let is_other = !self.setup.is_empty() && self.setup != frame;
        self.setup = frame;
        if is_other && !self.is_world {
            let error = statement.wrong("The set-up changes, and from which frame its points count is not said.");
            return Err(error.hint(
                "`TRNTYP/WORLD,0,0,0` says that all points count from one frame; or give each set-up a file of its own",
            ));
        }
        if is_other {
            self.builder.remark("set-up", "CSYS", statement.head.line_number(), Severity::Note, || {
                "The set-up changes ({}): the points of all count from one frame, and the workpiece is taken to stay \
                 where it is."
                    .to_string()
            });
        }
        Ok(())
    }

    /// Three numbers as a point in the first frame \[m\].
    pub(super) fn point(&self, statement: &Statement<'_>, from: usize) -> Result<Vector3<f64>> {
        let point = statement.vector(from)? * self.builder.form.unit;
        if point.amax() > FARTHEST {
            return Err(statement.wrong(FAR_AWAY));
        }
        Ok(match &self.frames {
            Some((_, frame)) => frame.rotation * point + frame.translation.vector,
            None => point,
        })
    }

    /// The axes of the points in those of the first frame.
    pub(super) fn axes(&self) -> UnitQuaternion<f64> {
        self.frames.map_or_else(UnitQuaternion::identity, |(_, frame)| frame.rotation)
    }

    pub(super) fn turned(&self, axis: UnitVector3<f64>) -> UnitVector3<f64> {
        self.axes() * axis
    }

    /// A point that numbers stand for.
    pub(super) fn go(&mut self, statement: &Statement<'_>) -> Result<()> {
        let line = statement.head.line_number();
        let count = statement.numbers.len();
        if count != 3 && count != 6 {
            let message = format!("A point has three numbers, or six with the tool axis; here are {count}.");
            return Err(statement.wrong(message));
        }
        let position = self.point(statement, 0)?;
        let before = TipTarget::Axis(Vector3::zeros(), self.axis);
        if count == 6 {
            self.axis = self.turned(statement.direction(3)?);
            self.stated = statement.vector(3)?.into();
            self.builder.form.orientation = Orientation::Axis;
        }
        self.rapid |= statement.word != "GOTO";
        if self.ends_arc(statement, before, position)? {
            return Ok(());
        }
        let to = TipTarget::Axis(position, self.axis);
        let first = self.builder.points.len();
        let from = self.position.filter(|_| !self.rapid);
        let from = from.map(|start| before.at(start));
        if from.is_some_and(|from| self.builder.between(line, &from, &to)) {
            self.divided(first, false, statement.head.position()..statement.end);
        }
        self.to(line, position);
        let end = Number { value: 0.0, at: statement.end as u32, length: 0 };
        for component in 0..6 {
            let number = match statement.numbers.get(component) {
                Some((_, number)) => *number,
                None => Number { value: self.stated[component - 3], ..end },
            };
            self.builder.number(0, component, number);
        }
        Ok(())
    }

    /// The points from `first` on, with the next one for a straight move, are those of one move.
    pub(super) fn divided(&mut self, first: usize, is_whole: bool, text: Range<usize>) {
        self.builder.divided.push(Divided {
            points: first..self.builder.points.len() + usize::from(!is_whole),
            is_whole,
            text,
            begin: "GOTO/".to_string(),
            ..Divided::default()
        });
    }

    pub(super) fn to(&mut self, line: usize, position: Vector3<f64>) {
        let rapid = std::mem::take(&mut self.rapid);
        let from = self.position.filter(|_| !rapid);
        self.arcs.goes_straight(from, position, self.builder);
        self.builder.point(line, &TipTarget::Axis(position, self.axis), rapid);
        self.position = Some(position);
    }
}
