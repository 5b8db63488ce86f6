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
use super::spring::{LoadedSpring, Motion, link_axes, on_first_axis};
use crate::error::{Code, Error, Result, did_you_mean};
use crate::model::kinematics::Frames;
use crate::model::robot::Robot;
use nalgebra::{DMatrix, DVector, Matrix3, Matrix6, SMatrix, Vector3, Vector6};
use serde::{Deserialize, Serialize};

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
    /// angle in the direction of its torque, from where a preload held it before; unknown: that angle \[rad\].
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
    /// An even beam along a part of the link behind joint `joint` (counted from 0); unknown: its turn per moment and
    /// length \[rad/(N·m) per m\].
    Beam {
        /// The joint.
        joint: usize,
        /// Which part of the link.
        part: RowPart,
        /// Twist about its own line, or the same bending about all directions across.
        twist: bool,
    },
}

/// A part of the way from the origin of a joint, the foot of its row before d, to that of the next, or to the flange.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RowPart {
    /// Along the joint's axis: d of its modified Denavit–Hartenberg row.
    Axis,
    /// From there on: a of the row that follows.
    Link,
}

impl ExtraTerm {
    /// Name in tables: `tilt of joint 3`, `tilt of the base`, `lost motion of joint 2`.
    pub fn name(self, robot: &Robot) -> String {
        let joint = |j: usize| robot.joints().get(j).map_or("?", |joint| &joint.name);
        match self {
            ExtraTerm::Spring { joint: place, row, column } => {
                let place = place.map_or("the base", joint);
                let axes = ["x", "y", "z", "turn x", "turn y", "turn z"];
                let [row, column] = [row, column].map(|i| axes.get(i).unwrap_or(&"?"));
                format!("spring ({row}, {column}) of {place}")
            }
            ExtraTerm::Beam { joint: row, part, twist } => {
                let how = if twist { "twist" } else { "bending" };
                let part = match part {
                    RowPart::Axis => "along",
                    RowPart::Link => "behind",
                };
                format!("{how} {part} {}", joint(row))
            }
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
            ExtraTerm::Beam { joint, .. } => Some(joint),
            ExtraTerm::BaseTilt => None,
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

    /// The spring that one unit of an elastic term is: the joint whose frame it stands in, `None` for the base, and its
    /// compliance there, the same at all postures, of which `frames` are one; zeros for lost motion.
    pub(crate) fn compliance(self, frames: &Frames) -> (Option<usize>, Matrix6<f64>) {
        let mut out = Matrix6::zeros();
        let mut turns = |at: Vector3<f64>, turn: Matrix3<f64>| {
            // A turn at p shifts the origin by p × turn, and a force there has the moment −p × f about p.
            let mut motion = SMatrix::<f64, 6, 3>::zeros();
            motion.fixed_view_mut::<3, 3>(0, 0).copy_from(&at.cross_matrix());
            motion.fixed_view_mut::<3, 3>(3, 0).fill_with_identity();
            out += motion * turn * motion.transpose();
        };
        match self {
            ExtraTerm::Spring { row, column, .. } => {
                out[(row, column)] = 1.0;
                out[(column, row)] = 1.0;
            }
            ExtraTerm::JointTilt(_) => turns(Vector3::zeros(), across(&Vector3::z())),
            ExtraTerm::BaseTilt => turns(Vector3::zeros(), across(&frames.axes()[0])),
            ExtraTerm::Beam { joint, part, twist } => {
                let [start, way] = row_part(frames, joint, part);
                let axes = link_axes(frames, joint).transpose();
                let (start, way) = (axes * (start - frames.origins()[joint]), axes * way);
                let bending = across(&way.normalize());
                let turn = if twist { Matrix3::identity() - bending } else { bending };
                for share in GAUSS {
                    turns(start + way * share, turn * (way.norm() / 2.0));
                }
            }
            ExtraTerm::LostMotion(_) => {}
        }
        (self.joint(), out)
    }

    /// The terms that `word` names: `tilt` (all joints), `tilt3`, `base`,
    /// `lost` (all joints), `lost2`; joints count from 1.
    ///
    /// # Errors
    /// Another word, or a joint that the robot does not have.
    pub fn parse(word: &str, robot: &Robot) -> Result<Vec<ExtraTerm>> {
        let n = robot.joint_count();
        let unknown = || {
            let terms = ["tilt", "tilt1", "base", "lost", "lost1"];
            Error::new(Code::UnknownName, format!("There is no extra term \"{word}\".")).hint(
                did_you_mean(word, terms).unwrap_or_else(|| {
                    "terms: tilt (all joints), tilt1 … of one joint, base, lost (all joints), lost1 …".to_string()
                }),
            )
        };
        type Constructor = fn(usize) -> ExtraTerm;
        let families: [(&str, Constructor); 2] = [("tilt", ExtraTerm::JointTilt), ("lost", ExtraTerm::LostMotion)];
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
                return Err(Error::new(Code::UnknownName, format!("{} has no joint {number}.", robot.name()))
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
        let motion = Motions::new(terms).of(self);
        DVector::from_iterator(3 * points.len(), motion.rows(points))
    }

    /// What one unit of this term does to the base-frame point `at`:
    /// \[shift (m); turn (rad)\], base axes.
    ///
    /// # Panics
    /// If the term names a joint that the robot does not have.
    pub fn twist(self, terms: &PostureTerms, at: &Vector3<f64>) -> Vector6<f64> {
        Motions::new(terms).of(self).twist(at)
    }
}

impl PostureTerms {
    /// [`block`](Self::block) with the columns of `extra` behind it, 3m × (springs + terms).
    ///
    /// # Panics
    /// If a term names a joint that the robot does not have.
    pub fn block_with(&self, robot: &Robot, extra: &[ExtraTerm]) -> DMatrix<f64> {
        let block = self.block(robot);
        let n = block.ncols();
        let mut columns = block.resize_horizontally(n + extra.len(), 0.0);
        let mut motions = Motions::new(self);
        for (i, term) in extra.iter().enumerate() {
            let motion = motions.of(*term);
            let rows = motion.rows(self.measuring_points());
            columns.column_mut(n + i).iter_mut().zip(rows).for_each(|(to, row)| *to = row);
        }
        columns
    }
}

/// What terms do at one posture under one load; what those of one spring share is found once.
struct Motions<'a> {
    terms: &'a PostureTerms,
    /// Base first, then joint by joint; none until it is needed.
    springs: Vec<Option<LoadedSpring>>,
}

impl<'a> Motions<'a> {
    /// At the posture and under the load of `terms`.
    fn new(terms: &'a PostureTerms) -> Self {
        let springs = places(terms.frames().axes().len());
        Motions { terms, springs: springs.map(|_| None).collect() }
    }

    /// Motion per unit of a term.
    fn of(&mut self, term: ExtraTerm) -> Motion {
        let terms = self.terms;
        let frames = terms.frames();
        let tilt = |axis: Vector3<f64>, origin: Vector3<f64>| {
            let moment = terms.wrench().moved(terms.loading_point(), &origin).moment;
            Motion::turn(moment - axis * axis.dot(&moment), origin)
        };
        match term {
            ExtraTerm::Spring { joint, row, column } => {
                let spring = &mut self.springs[place(joint)];
                let spring = spring.get_or_insert_with(|| LoadedSpring::new(terms, joint));
                spring.entry(row, column)
            }
            ExtraTerm::Beam { joint, part, twist } => {
                let [start, way] = row_part(frames, joint, part);
                let line = way.normalize();
                let mut sum = Motion::turn(Vector3::zeros(), start);
                for share in GAUSS {
                    let at = start + way * share;
                    let moment = terms.wrench().moved(terms.loading_point(), &at).moment;
                    let along = line * line.dot(&moment);
                    let turn = if twist { along } else { moment - along };
                    sum.add(&Motion::turn(turn * (way.norm() / 2.0), at));
                }
                sum
            }
            ExtraTerm::JointTilt(j) => tilt(frames.axes()[j], frames.origins()[j]),
            ExtraTerm::BaseTilt => tilt(frames.axes()[0], on_first_axis(frames)),
            ExtraTerm::LostMotion(j) => {
                let halves = terms.halves_of_gap(j);
                Motion::turn(frames.axes()[j] * halves, frames.origins()[j])
            }
        }
    }
}

/// Places of the springs: base first, then joint by joint.
pub(crate) fn places(joints: usize) -> impl Iterator<Item = Option<usize>> {
    std::iter::once(None).chain((0..joints).map(Some))
}

/// Number of a place among them.
fn place(joint: Option<usize>) -> usize {
    joint.map_or(0, |j| j + 1)
}

/// Terms with their values; those of one general spring are one compliance.
#[derive(Debug, Clone)]
pub(crate) struct Elements {
    /// Compliances of the places that give way, symmetric.
    pub(crate) springs: Vec<(Option<usize>, Matrix6<f64>)>,
    rest: Vec<(ExtraTerm, f64)>,
}

impl Elements {
    /// `values` of `terms` of an arm with so many joints.
    pub(crate) fn new(terms: &[ExtraTerm], values: &[f64], joints: usize) -> Self {
        let springs = places(joints).map(|joint| (joint, Matrix6::zeros()));
        let mut springs: Vec<_> = springs.collect();
        let mut rest = Vec::new();
        let mut add = |joint: Option<usize>, row: usize, column: usize, value: f64| {
            let compliance = &mut springs[place(joint)].1;
            compliance[(row, column)] += value;
            if row != column {
                compliance[(column, row)] += value;
            }
        };
        for (term, value) in terms.iter().zip(values) {
            match *term {
                ExtraTerm::Spring { joint, row, column } => add(joint, row, column, *value),
                term => rest.push((term, *value)),
            }
        }
        springs.retain(|(_, compliance)| *compliance != Matrix6::zeros());
        Elements { springs, rest }
    }

    /// What they do to the base-frame point `at` at the posture and under the load of `terms`, those with lost motion
    /// among them or not: \[shift (m); turn (rad)\], base axes.
    pub(crate) fn twist(&self, terms: &PostureTerms, at: &Vector3<f64>, lost: bool) -> Vector6<f64> {
        let springs = self.springs.iter();
        let springs = springs.map(|(joint, c)| LoadedSpring::new(terms, *joint).with(c).twist(at));
        let rest = self.rest.iter().filter(|(term, _)| lost || term.is_spring());
        let rest = rest.map(|(term, value)| term.twist(terms, at) * *value);
        springs.chain(rest).sum()
    }
}

/// What turns about the axes across the unit vector `line` alone.
fn across(line: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::identity() - line * line.transpose()
}

/// Places at which a polynomial of third degree over [0, 1] is sampled for its mean: half the sum (Gauss). The shift by
/// an even beam is of second degree along it.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Start and way of a part of the link behind a joint: from the joint's origin along its axis as far as the next
/// origin, or the flange, lies along it, then across to there.
pub(crate) fn row_part(frames: &Frames, joint: usize, part: RowPart) -> [Vector3<f64>; 2] {
    let (axis, start) = (frames.axes()[joint], frames.origins()[joint]);
    let next = frames.origins().get(joint + 1);
    let end = next.copied().unwrap_or_else(|| frames.flange().translation.vector);
    let along = axis * axis.dot(&(end - start));
    match part {
        RowPart::Axis => [start, along],
        RowPart::Link => [start + along, end - start - along],
    }
}
