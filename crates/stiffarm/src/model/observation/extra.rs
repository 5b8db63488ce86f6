//! Further elastic elements beside the joint axes, as more columns of Ψ: tilt
//! of a joint about its two other axes, tilt of the base, lost motion, and the
//! entries of a general spring at a joint or the base.
//!
//! A virtual spring that is equally soft about all axes perpendicular to `a`
//! and sits at the point o turns by h·m⊥ under the moment m about o, where m⊥
//! is the part of m perpendicular to a. So its column at the point p is
//! m⊥ × (p − o), whatever pair of perpendicular axes one has in mind.
//!
//! A general spring has a symmetric 6 × 6 compliance between the wrench at its
//! origin and the small motion there (virtual joint method: Pashkevich, Chablat
//! and Wenger, Stiffness analysis of overconstrained parallel manipulators,
//! Mechanism and Machine Theory 44, 2009, 966–982,
//! doi:10.1016/j.mechmachtheory.2008.05.017). Its axes move with the link behind
//! the joint: z is the joint's axis, x points towards what is next on that link.
//!
//! No posture tells the turn of a spring about the axis of the joint that follows from that
//! joint's own compliance (Klimchik, Caro, Furet and Pashkevich, Complete Stiffness Model for a
//! Serial Robot, ICINCO 2014, reduce their model by such parameters). So h of an axis is
//! h + aᵀ C a with a its direction and C the turns of the spring before it: what turns about
//! the axis under a unit moment about it. The column of a spring is what it does beside that.

use super::PostureTerms;
use crate::error::{Code, Error, Result, did_you_mean};
use crate::model::kinematics::Frames;
use crate::model::robot::Robot;
use nalgebra::{DVector, Matrix3, Vector3, Vector6};
use serde::{Deserialize, Serialize};

/// A direction across an axis is clear from this length on (of a unit vector; m).
const CLEARLY: f64 = 1e-2;

/// Entries of the springs' compliances that share one size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ElasticClass {
    /// Shifts by forces \[m/N\].
    Shift,
    /// Turns by moments, but for the joint's own axis \[rad/(N·m)\].
    Turn,
    /// Shifts by moments and turns by forces \[rad/N\].
    Coupling,
}

impl ElasticClass {
    /// All classes, in the order of results.
    pub const ALL: [ElasticClass; 3] = [
        ElasticClass::Shift,
        ElasticClass::Turn,
        ElasticClass::Coupling,
    ];

    /// The class of an entry: rows and columns 0 to 2 are shifts and forces, 3 to 5 turns
    /// and moments.
    pub fn of(row: usize, column: usize) -> Self {
        match (row < 3, column < 3) {
            (true, true) => ElasticClass::Shift,
            (false, false) => ElasticClass::Turn,
            _ => ElasticClass::Coupling,
        }
    }

    /// Unit of the entries.
    pub fn unit(self) -> &'static str {
        match self {
            ElasticClass::Shift => "m/N",
            ElasticClass::Turn => "rad/(N·m)",
            ElasticClass::Coupling => "rad/N",
        }
    }
}

/// One further unknown of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ExtraTerm {
    /// Tilt of joint `j` (counted from 0) about the axes perpendicular to its
    /// own, equally soft about both, at the origin of its frame; unknown: a
    /// compliance \[rad/(N·m)\].
    JointTilt(usize),
    /// Tilt of the base about the axes perpendicular to axis 1, at the point
    /// of axis 1 nearest the base frame's origin; unknown: a compliance \[rad/(N·m)\].
    BaseTilt,
    /// Lost motion of joint `j` (counted from 0): it gives way by a constant
    /// angle in the direction of its torque; unknown: that angle \[rad\].
    LostMotion(usize),
    /// Entries (row, column) and (column, row) of the symmetric compliance of a
    /// general spring; rows and columns 0 to 2 are shifts along and forces on x, y, z
    /// \[m, N\], 3 to 5 turns and moments \[rad, N·m\]. Unknown: the entry
    /// \[m/N; rad/N or m/(N·m); rad/(N·m)\].
    Spring {
        /// The joint, counted from 0; `None` for the base: axes of the base frame, at
        /// the point of axis 1 nearest its origin.
        joint: Option<usize>,
        /// Row, not above the column.
        row: usize,
        /// Column.
        column: usize,
    },
    /// What the entries on the diagonal of all general springs have in common, shifts or turns; unknown: their mean
    /// \[m/N; rad/(N·m)\].
    MeanSpring(ElasticClass),
}

impl ExtraTerm {
    /// Name in tables: `tilt of joint 3`, `tilt of the base`, `lost motion of joint 2`.
    pub fn name(self, robot: &Robot) -> String {
        let joint = |j: usize| robot.joints().get(j).map_or("?", |joint| &joint.name);
        match self {
            ExtraTerm::Spring {
                joint: place,
                row,
                column,
            } => {
                let place = place.map_or("the base", joint);
                let axes = ["x", "y", "z", "turn x", "turn y", "turn z"];
                let [row, column] = [row, column].map(|i| axes.get(i).unwrap_or(&"?"));
                format!("spring ({row}, {column}) of {place}")
            }
            ExtraTerm::MeanSpring(class) => format!("mean spring [{}]", class.unit()),
            ExtraTerm::JointTilt(j) => format!("tilt of {}", joint(j)),
            ExtraTerm::BaseTilt => "tilt of the base".to_string(),
            ExtraTerm::LostMotion(j) => format!("lost motion of {}", joint(j)),
        }
    }

    /// True for an elastic element, false for lost motion.
    pub fn is_spring(self) -> bool {
        !matches!(self, ExtraTerm::LostMotion(_))
    }

    /// The joint it belongs to, counted from 0.
    pub fn joint(self) -> Option<usize> {
        match self {
            ExtraTerm::JointTilt(j) | ExtraTerm::LostMotion(j) => Some(j),
            ExtraTerm::Spring { joint, .. } => joint,
            ExtraTerm::BaseTilt | ExtraTerm::MeanSpring(_) => None,
        }
    }

    /// True where an arm of so many joints can have it.
    pub fn fits(self, joints: usize) -> bool {
        let entry = match self {
            ExtraTerm::Spring { row, column, .. } => row <= column && column < 6,
            _ => true,
        };
        entry && self.joint().is_none_or(|j| j < joints)
    }

    /// The terms that `word` names: `tilt` (all joints), `tilt3`, `base`,
    /// `lost` (all joints), `lost2`; joints count from 1.
    ///
    /// # Errors
    /// Another word, or a joint that the robot does not have.
    pub fn parse(word: &str, robot: &Robot) -> Result<Vec<ExtraTerm>> {
        let n = robot.joint_count();
        let unknown = || {
            let known = ["tilt", "tilt1", "base", "lost", "lost1"];
            Error::new(
                Code::UnknownName,
                format!("There is no extra term \"{word}\"."),
            )
            .hint(did_you_mean(word, known).unwrap_or_else(|| {
                "terms: tilt (all joints), tilt1 … of one joint, base, lost (all joints), lost1 …"
                    .to_string()
            }))
        };
        type Make = fn(usize) -> ExtraTerm;
        let families: [(&str, Make); 2] = [
            ("tilt", ExtraTerm::JointTilt),
            ("lost", ExtraTerm::LostMotion),
        ];
        if word == "base" {
            return Ok(vec![ExtraTerm::BaseTilt]);
        }
        for (family, make) in families {
            let Some(rest) = word.strip_prefix(family) else {
                continue;
            };
            if rest.is_empty() {
                return Ok((0..n).map(make).collect());
            }
            let number: usize = rest.parse().map_err(|_| unknown())?;
            if !(1..=n).contains(&number) {
                return Err(Error::new(
                    Code::UnknownName,
                    format!("{} has no joint {number}.", robot.name()),
                )
                .hint(format!("joints are counted from 1 to {n}")));
            }
            return Ok(vec![make(number - 1)]);
        }
        Err(unknown())
    }

    /// Column of this term at the measuring points, 3m: \[m·N·m/rad\] for a
    /// spring, \[m/rad\] for lost motion.
    ///
    /// # Panics
    /// If the term names a joint that the robot does not have.
    pub fn column(self, terms: &PostureTerms) -> DVector<f64> {
        let points = terms.measuring_points();
        let motion = self.motion(terms);
        let rows = points.iter().flat_map(|p| motion.at(p).data.0[0]);
        DVector::from_iterator(3 * points.len(), rows)
    }

    /// What one unit of this term does to the base-frame point `at`:
    /// \[shift (m); turn (rad)\], base axes.
    ///
    /// # Panics
    /// If the term names a joint that the robot does not have.
    pub fn twist(self, terms: &PostureTerms, at: &Vector3<f64>) -> Vector6<f64> {
        let motion = self.motion(terms);
        let (shift, turn) = (motion.at(at), motion.turn);
        Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
    }

    /// Motion per unit of this term.
    fn motion(self, terms: &PostureTerms) -> Motion {
        let frames = terms.frames();
        let tilt = |axis: Vector3<f64>, origin: Vector3<f64>| {
            let moment = terms.wrench().moved(terms.loading_point(), &origin).moment;
            Motion::turn(moment - axis * axis.dot(&moment), origin)
        };
        match self {
            ExtraTerm::Spring { joint, row, column } => {
                let (axes, origin) = spring_frame(frames, joint);
                let wrench = terms.wrench().moved(terms.loading_point(), &origin);
                let load = |i: usize| match i < 3 {
                    true => axes.column(i).dot(&wrench.force),
                    false => axes.column(i - 3).dot(&wrench.moment),
                };
                let mut motion = Motion::turn(Vector3::zeros(), origin);
                let mut add = |i: usize, size: f64| match i < 3 {
                    true => motion.shift += axes.column(i) * size,
                    false => motion.turn += axes.column(i - 3) * size,
                };
                add(row, load(column));
                if row != column {
                    add(column, load(row));
                }
                // The axis that follows counts the turn about it as its own compliance.
                let next = joint.map_or(0, |j| j + 1);
                let is_axis = joint.is_some() && row == 5;
                if row >= 3 && !is_axis && next < frames.axes().len() {
                    let (axis, at) = (frames.axes()[next], frames.origins()[next]);
                    let along = |i: usize| axes.column(i - 3).dot(&axis);
                    let twice = if row == column { 1.0 } else { 2.0 };
                    let part = twice * along(row) * along(column);
                    let moment = terms.wrench().moved(terms.loading_point(), &at).moment;
                    motion.add(&Motion::turn(axis * (axis.dot(&moment) * -part), at));
                }
                motion
            }
            ExtraTerm::MeanSpring(class) => {
                let mut sum = Motion::turn(Vector3::zeros(), Vector3::zeros());
                for (joint, row) in diagonal(class, frames.axes().len()) {
                    let column = row;
                    sum.add(&ExtraTerm::Spring { joint, row, column }.motion(terms));
                }
                sum
            }
            ExtraTerm::JointTilt(j) => tilt(frames.axes()[j], frames.origins()[j]),
            ExtraTerm::BaseTilt => tilt(frames.axes()[0], on_first_axis(frames)),
            ExtraTerm::LostMotion(j) => {
                // Without torque the joint may rest anywhere in its gap.
                let torque = terms.torque()[j];
                let sign = if torque == 0.0 { 0.0 } else { torque.signum() };
                Motion::turn(frames.axes()[j] * sign, frames.origins()[j])
            }
        }
    }
}

/// A small motion: shift of the body's point at the origin, and turn.
struct Motion {
    shift: Vector3<f64>,
    turn: Vector3<f64>,
    origin: Vector3<f64>,
}

impl Motion {
    fn turn(turn: Vector3<f64>, origin: Vector3<f64>) -> Self {
        Motion {
            shift: Vector3::zeros(),
            turn,
            origin,
        }
    }

    /// Goes on with a further small motion of the same body.
    fn add(&mut self, other: &Motion) {
        self.shift += other.at(&self.origin);
        self.turn += other.turn;
    }

    /// Shift of the body's point at `p`.
    fn at(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.shift + self.turn.cross(&(p - self.origin))
    }
}

/// Place and row of the entries that [`ExtraTerm::MeanSpring`] holds: all of the class on the diagonals of the springs,
/// base first, but for the axes of the joints themselves.
pub(crate) fn diagonal(
    class: ElasticClass,
    joints: usize,
) -> impl Iterator<Item = (Option<usize>, usize)> {
    let places = std::iter::once(None).chain((0..joints).map(Some));
    let all = places.flat_map(|joint| (0..6).map(move |row| (joint, row)));
    all.filter(move |(joint, row)| {
        let is_axis = joint.is_some() && *row == 5;
        !is_axis && ElasticClass::of(*row, *row) == class
    })
}

/// Axes (columns) and origin of the general spring of a joint, or of the base.
fn spring_frame(frames: &Frames, joint: Option<usize>) -> (Matrix3<f64>, Vector3<f64>) {
    match joint {
        Some(j) => (link_axes(frames, j), frames.origins()[j]),
        None => (Matrix3::identity(), on_first_axis(frames)),
    }
}

/// The point of axis 1 nearest the base frame's origin.
pub(crate) fn on_first_axis(frames: &Frames) -> Vector3<f64> {
    let (axis, origin) = (frames.axes()[0], frames.origins()[0]);
    origin - axis * axis.dot(&origin)
}

/// Axes fixed to the link behind joint `j`: z its axis, x across it towards the next
/// joint's axis, or its origin, or along the flange's x. Which of them depends on the
/// robot alone, not on its posture.
pub fn link_axes(frames: &Frames, j: usize) -> Matrix3<f64> {
    let z = frames.axes()[j];
    let across = |v: Vector3<f64>| v - z * z.dot(&v);
    let next = frames.axes().get(j + 1).map(|axis| {
        let origin = frames.origins()[j + 1] - frames.origins()[j];
        [across(*axis), across(origin)]
    });
    // The last resort where a joint with the same axis follows; one of both is clear.
    let flange = frames.flange().rotation;
    let last = [flange * Vector3::x(), flange * Vector3::y()].map(across);
    let mut all = next.into_iter().flatten().chain(last);
    let x = all.find_map(|v| v.try_normalize(CLEARLY));
    let x = x.unwrap_or_else(Vector3::x);
    Matrix3::from_columns(&[x, z.cross(&x), z])
}
