//! Arcs of CL data.
//!
//! `CIRCLE/x,y,z,i,j,k,r` stands before the `GOTO/` that ends it; Creo may give points on the arc before its
//! end. About its axis it runs counter-clockwise in ISO 4343, Creo (PTC, *CL Output for Circular
//! Interpolation*) and CAMWorks, which leaves out the radius, and clockwise in NX, which adds four numbers.
//! CATIA, and Creo on request, write APT: `INDIRV/` is the direction in which the tool sets out on the circle of
//! `TLON,GOFWD/`, which ends where it meets a line or plane for the first or (`ON,2,INTOF`) second time.

use super::super::arc::{Circle, ROUNDED};
use super::super::builder::{Builder, TipTarget};
use super::statement::Statement;
use super::{State, System};
use nalgebra::{UnitVector3, Vector3};
use std::ops::Range;
use stiffarm::error::Result;
use stiffarm::findings::Severity;

/// Cosine of the angle up to which two moves are tangent.
const TANGENT_COSINE: f64 = 0.999;

/// Shorter moves are rounded too much to have a direction \[m\].
const SHORTEST_MOVE: f64 = 0.1e-3;

/// What is stated before the statement that ends an arc.
pub(super) enum Pending {
    /// `CIRCLE/`, at this byte of the file.
    Circle { centre: Vector3<f64>, axis: UnitVector3<f64>, at: usize },
    /// `INDIRV/` or `INDIRP/`, at this byte of the file.
    Direction(UnitVector3<f64>, usize),
}

/// How the arcs of a file meet the moves beside them.
pub(super) struct Arcs {
    /// Arcs of an unknown system are read clockwise.
    clockwise: bool,
    /// Those of an unknown system, and the line of the first.
    unknown: Option<usize>,
    /// Joins that are tangent, and those that would be the other way round.
    joins: [usize; 2],
    /// The straight move at feed that ended last.
    heading: Option<Vector3<f64>>,
    /// The tangent at the end of the arc that ended last, how it began (1 tangent, −1 the other way round), its line.
    last: Option<(Vector3<f64>, i32, usize)>,
    /// The circle on which the next points may go on, and the angle of its first arc.
    pub open: Option<(Vector3<f64>, UnitVector3<f64>, f64)>,
}

/// 1 where a move goes on in this direction, −1 where it goes back.
fn join(tangent: Vector3<f64>, way: Option<Vector3<f64>>) -> i32 {
    let way = way.filter(|way| way.norm() > SHORTEST_MOVE);
    let along = way.map_or(0.0, |way| tangent.dot(&way) / way.norm());
    i32::from(along > TANGENT_COSINE) - i32::from(along < -TANGENT_COSINE)
}

impl Arcs {
    pub fn new(clockwise: bool) -> Self {
        Arcs { clockwise, unknown: None, joins: [0; 2], heading: None, last: None, open: None }
    }

    /// A straight move; one without a start is rapid.
    pub fn goes_straight(&mut self, from: Option<Vector3<f64>>, to: Vector3<f64>, builder: &mut Builder<'_>) {
        self.heading = from.map(|from| to - from);
        self.closes(self.heading, builder);
    }

    /// Looks back at the last arc, behind which the tool goes this way.
    fn closes(&mut self, way: Option<Vector3<f64>>, builder: &mut Builder<'_>) {
        let Some((tangent, began, line)) = self.last.take() else {
            return;
        };
        let both = [began, join(tangent, way)];
        for join in both.into_iter().filter(|join| *join != 0) {
            self.joins[usize::from(join < 0)] += 1;
        }
        if both.iter().sum::<i32>() < 0 {
            builder.remark("arc-sense", "", line, Severity::Caution, || {
                "An arc ({}) would go on smoothly from and to the straight moves beside it if it ran the other way \
                 round. It is read as the other arcs of the file: look at its points."
                    .to_string()
            });
        }
    }
}

impl State<'_, '_> {
    /// Whether the arcs of an unknown system run the other way; says where nothing tells it.
    pub(super) fn sense_of_arcs(&mut self) -> bool {
        self.arcs.closes(None, self.builder);
        let Arcs { clockwise, unknown, joins: [tangent, contrary], .. } = self.arcs;
        let Some(line) = unknown else {
            return false;
        };
        if tangent == contrary {
            self.builder.remark("arc-sense-assumed", "", line, Severity::Caution, || {
                "Nothing in the file says which way round its arcs run (the first: {}): they are read \
                 counter-clockwise about their axes, as ISO 4343 has them. NX writes them clockwise."
                    .to_string()
            });
        }
        contrary > tangent && !clockwise
    }

    /// `CIRCLE/` with six numbers (CAMWorks), seven, or eleven (NX).
    pub(super) fn circle(&mut self, statement: &Statement<'_>) -> Result<()> {
        let (head, count) = (&statement.head, statement.numbers.len());
        if count < 6 {
            let message = "An arc has a centre, an axis and a radius: seven numbers.";
            return Err(statement.wrong(message));
        }
        if statement.has("TIMES") {
            return Err(statement.wrong("Arcs of several turns (TIMES) are not read here."));
        } else if let Some(word) = statement.words.first() {
            return Err(statement.wrong(format!("{word} of an arc is not read here.")));
        }
        let axis = self.turned(statement.direction(3)?);
        self.system = match count {
            6 => Some(System::Camworks),
            11 => Some(System::Nx),
            _ => self.system,
        };
        let is_clockwise = match self.system {
            Some(system) => system == System::Nx,
            None => {
                self.arcs.unknown.get_or_insert(head.line_number());
                self.arcs.clockwise
            }
        };
        self.pending = Some(Pending::Circle {
            centre: self.point(statement, 0)?,
            axis: if is_clockwise { -axis } else { axis },
            at: head.position(),
        });
        Ok(())
    }

    /// A point that ends an arc, or goes on with one; false where it does not.
    pub(super) fn ends_arc(&mut self, statement: &Statement<'_>, before: TipTarget, end: Vector3<f64>) -> Result<bool> {
        let line = statement.head.line_number();
        let open = self.arcs.open.take();
        let (begin, centre, axis, first) = match (self.pending.take(), open) {
            (Some(Pending::Circle { centre, axis, at }), _) => (at, centre, axis, None),
            (Some(Pending::Direction(..)), _) => {
                let message = "The arc that the direction before it begins (TLON) is missing.";
                return Err(statement.wrong(message));
            }
            (None, Some((centre, axis, first))) if !self.rapid => {
                (statement.head.position(), centre, axis, Some(first))
            }
            (None, _) => return Ok(false),
        };
        let Some(start) = self.position else {
            return Err(statement.wrong("The point from which this arc sets out is missing."));
        };
        let Some(circle) = Circle::about(centre, axis, start, end) else {
            if first.is_some() {
                return Ok(false);
            }
            let message =
                "The arc does not lead here: this is not on the circle about its centre through the point before.";
            return Err(statement.wrong(message));
        };
        let is_creo = self.system == Some(System::Creo);
        // Equal steps of less than a third of a turn are no chord that closes the contour.
        let is_even = |first: f64| first < 2.05 && (circle.sweep - first).abs() < 0.02 * first;
        if first.is_some_and(|first| !(is_creo && is_even(first))) && circle.rise() > ROUNDED {
            let how = if is_creo {
                "it is reached along the arc, as Creo writes arcs, and not on a straight line"
            } else {
                "it is reached on a straight line, and not along the arc, as Creo would write it"
            };
            self.builder.remark("arc-goes-on", "", line, Severity::Caution, || {
                format!("A point behind the end of an arc ({{}}) lies on its circle: {how}.")
            });
        }
        if first.is_some() && !is_creo {
            return Ok(false);
        }
        if matches!(self.system, None | Some(System::Creo)) {
            self.arcs.open = Some((centre, axis, first.unwrap_or(circle.sweep)));
        }
        self.arc(line, &circle, before, begin..statement.end);
        Ok(true)
    }

    /// `INDIRV/` and `INDIRP/`: where the tool sets out to.
    pub(super) fn sets_out(&mut self, statement: &Statement<'_>) -> Result<()> {
        let direction = if statement.word == "INDIRV" {
            self.axes() * statement.vector(0)?
        } else {
            self.point(statement, 0)? - self.position.unwrap_or_default()
        };
        let Some(direction) = UnitVector3::try_new(direction, 1e-9) else {
            return Err(statement.wrong("This direction has no length."));
        };
        self.pending = Some(Pending::Direction(direction, statement.head.position()));
        Ok(())
    }

    /// `TLON,GOFWD/(CIRCLE/x,y,z,r),ON,(LINE/x,y,z,x,y,z)`, or with an axis: `CIRCLE/CANON`, `CYLNDR`. What
    /// ends it may be a plane.
    pub(super) fn goes_round(&mut self, statement: &Statement<'_>) -> Result<()> {
        let not_read = || {
            let error = statement.wrong("This arc is not read here.");
            error.hint(
                "an arc is `INDIRV/direction` and `TLON,GOFWD/(CIRCLE/centre,radius),ON,(LINE/centre,end)`, or \
                a `CIRCLE/` before the `GOTO/` that ends it",
            )
        };
        let words: Vec<&str> = statement.words.iter().map(String::as_str).collect();
        let words: Vec<&str> = words.into_iter().filter(|word| !["TLON", "GOFWD", "CANON"].contains(word)).collect();
        let [what @ ("CIRCLE" | "CYLNDR"), "ON", stop @ ..] = &words[..] else {
            return Err(not_read());
        };
        let counts = stop.first() == Some(&"INTOF");
        let stop = &stop[usize::from(counts)..];
        let stops = match stop {
            ["LINE"] => 6,
            ["PLANE"] => 4,
            ["PLANE", "PERPTO", "PLANE", "POINT", "PERPTO", "VECTOR", "POINT", "POINT"] => 12,
            _ => return Err(not_read()),
        };
        let behind = stops + usize::from(counts);
        let circle_count = statement.numbers.len().saturating_sub(behind);
        if circle_count != 7 && (circle_count != 4 || *what == "CYLNDR") {
            return Err(not_read());
        }
        let value = |at: usize| statement.numbers[at].1.value;
        let count = if counts { value(circle_count) } else { 1.0 };
        let (Some(Pending::Direction(way, at)), Some(start)) = (self.pending.take(), self.position) else {
            let message = "The point or the direction (INDIRV) from which this arc sets out is missing.";
            return Err(statement.wrong(message));
        };
        let centre = self.point(statement, 0)?;
        let radius = value(circle_count - 1) * self.builder.form.unit;
        let axis = match circle_count {
            7 => self.turned(statement.direction(3)?),
            _ => self.axis,
        };
        let spoke = start - centre;
        let spoke = spoke - axis.as_ref() * axis.dot(&spoke);
        let rounded = ROUNDED.max(1e-4 * radius);
        let along = axis.cross(&spoke).dot(&way) / spoke.norm();
        if (spoke.norm() - radius).abs() > rounded || along.is_nan() || along.abs() < 0.99 {
            let message = "This arc does not begin where the tool is: the point before is not on its circle, or the \
                           direction (INDIRV) not that of the circle there.";
            return Err(statement.wrong(message));
        }
        let axis = if along < 0.0 { -axis } else { axis };
        let last = statement.numbers.len() - stops;
        let (normal, offset, stated) = if stops == 4 {
            let normal = self.turned(statement.direction(last)?);
            let from = self.frames.map_or(0.0, |(_, frame)| normal.dot(&frame.translation.vector));
            let offset = value(last + 3) * self.builder.form.unit + from;
            (normal.into_inner(), offset, None)
        } else {
            let last = statement.numbers.len() - 6;
            let (on, end) = (self.point(statement, last)?, self.point(statement, last + 3)?);
            let normal = axis.cross(&(end - on));
            (normal, normal.dot(&on), Some(end))
        };
        let circle = Circle::until(centre, axis, start, (normal, offset), count as usize);
        let Some(mut circle) = circle else {
            return Err(statement.wrong("This arc does not meet what ends it."));
        };
        // What CATIA states as the second point of the line is the end.
        if let Some(stated) = stated {
            let out = stated - centre;
            let out = out - axis.as_ref() * axis.dot(&out);
            let off = circle.end - stated;
            let off = off - axis.as_ref() * axis.dot(&off);
            if (out.norm() - radius).abs() <= rounded {
                if off.norm() > rounded {
                    let error = statement.wrong("This arc ends at one point by its line, and at another by its count.");
                    return Err(error.hint("more than half a turn has `ON,2,INTOF` before the line"));
                }
                circle.end -= off;
            }
        }
        let line = statement.head.line_number();
        let before = TipTarget::Axis(Vector3::zeros(), self.axis);
        self.arc(line, &circle, before, at..statement.end);
        Ok(())
    }

    /// Points on an arc; straight moves may take the place of `text`.
    fn arc(&mut self, line: usize, circle: &Circle, before: TipTarget, text: Range<usize>) {
        let [begins, ends] = circle.tangents();
        self.arcs.closes(None, self.builder);
        let began = join(begins, self.arcs.heading.take());
        self.arcs.last = Some((ends, began, line));
        let first = self.builder.points.len();
        let to = TipTarget::Axis(circle.end, self.axis);
        for (share, point) in circle.points() {
            let place = before.towards(&to, share, point);
            self.builder.point(line, &place, false);
        }
        self.divided(first, true, text);
        self.position = Some(circle.end);
        self.rapid = false;
    }
}
