//! All postures of two families of six-joint arms, in closed form.
//!
//! Both have a planar pair, axes 2 and 3 parallel, behind axis 1:
//!
//! - a spherical wrist: axes 4, 5, 6 meet in a point, axis 5 at right angles
//!   to 4 and 6 (most industrial arms);
//! - three parallel axes: axis 4 is parallel to 2 and 3, axes 5 and 6 meet in a
//!   point, axis 5 at right angles to 4 and 6 (Universal Robots and alike).
//!
//! Turns about axes 2, 3 (and 4) leave the component of a point along axis 2 as
//! it is, which gives θ1; a triangle gives θ2 and θ3; the orientation the rest.
//! These are the subproblems of Paden and Kahan (B. Paden, *Kinematics and
//! Control of Robot Manipulators*, PhD thesis, Berkeley 1986), solved by
//! tangents of half angles, because an arc cosine loses half its digits where
//! the arm is stretched.

use crate::model::kinematics::Frames;
use nalgebra::{Isometry3, Point3, Unit, UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// Six serial angles \[rad\].
pub(super) type Theta = [f64; 6];

/// A direction shorter than this (of the arm's size, or of a unit vector)
/// has no direction: the angle that it should give is free.
const FREE: f64 = 1e-12;
/// Sine of the angle between axes 1 and 2 from which on they count as parallel.
const PARALLEL_SINE: f64 = 0.05;
/// Shortest link of the planar pair (of the arm's size).
const SHORTEST_LINK: f64 = 1e-3;

/// Which of the two families an arm belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Family {
    SphericalWrist,
    ThreeParallel,
}

/// The measures that the closed form needs, from the chain at θ = 0 in base
/// axes \[m\].
#[derive(Debug, Clone)]
pub(super) struct ClosedForm {
    family: Family,
    /// Axes z_i.
    axes: [Unit<Vector3<f64>>; 6],
    /// Points on axes 1, 2 and 4.
    origins: [Vector3<f64>; 3],
    /// Where the axes of the wrist meet.
    centre: Vector3<f64>,
    /// Takes the flange's pose to the motion of the last link from θ = 0.
    from_flange: Isometry3<f64>,
    /// The planar pair: from axis 2 to axis 3, from axis 3 to the pair's tip.
    upper: Vector3<f64>,
    fore: Vector3<f64>,
    /// Angle from `upper` to `fore` about axis 2 at θ = 0.
    bend: f64,
    /// Angle from the wrist's first to its last axis about axis 5 at θ = 0.
    wrist_bend: f64,
    /// Sense of axes 3 and 4 against axis 2, ±1.
    senses: [f64; 2],
    /// Size of the arm \[m\].
    size: f64,
    /// How far two branches that meet are kept apart \[rad\]: zero for the arm
    /// itself, more for postures to start iterations from.
    apart: f64,
}

/// Where a position lies that the arm does not reach.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Outside {
    /// Farther than the stretched arm.
    Beyond,
    /// Nearer to axis 1 than the arm's lateral offset.
    AxisOne,
    /// Nearer to axis 2 than the folded arm.
    AxisTwo,
}

impl ClosedForm {
    /// The closed form of an arm whose frames at θ = 0 are these, when its axes
    /// are parallel, at right angles and meet to `tolerance` (radians, and of
    /// `size`).
    pub(super) fn detect(zero: &Frames, size: f64, tolerance: f64, apart: f64) -> Option<Self> {
        if zero.joint_count() != 6 {
            return None;
        }
        let (z, o) = (zero.axes(), zero.origins());
        let parallel = |a: usize, b: usize| z[a].cross(&z[b]).norm() <= tolerance;
        let square = |a: usize, b: usize| z[a].dot(&z[b]).abs() <= tolerance;
        let meets = |p: &Vector3<f64>, i: usize| (p - o[i]).cross(&z[i]).norm() <= tolerance * size;
        if !parallel(1, 2) || z[0].cross(&z[1]).norm() < PARALLEL_SINE || !square(4, 5) {
            return None;
        }
        let centre = meeting_point(&o[4], &z[4], &o[5], &z[5])?;
        if !meets(&centre, 4) || !meets(&centre, 5) {
            return None;
        }
        let family = if square(3, 4) && meets(&centre, 3) {
            Family::SphericalWrist
        } else if parallel(1, 3) && square(1, 4) {
            Family::ThreeParallel
        } else {
            return None;
        };
        let (tip, first) = match family {
            Family::SphericalWrist => (centre, z[3]),
            Family::ThreeParallel => (o[3], z[1]),
        };
        let flat = |v: Vector3<f64>| v - z[1] * z[1].dot(&v);
        let (upper, fore) = (flat(o[2] - o[1]), flat(tip - o[2]));
        let long_enough = |v: &Vector3<f64>| v.norm() >= SHORTEST_LINK * size;
        (long_enough(&upper) && long_enough(&fore)).then(|| ClosedForm {
            family,
            axes: std::array::from_fn(|i| Unit::new_normalize(z[i])),
            origins: [o[0], o[1], o[3]],
            centre,
            from_flange: zero.flange().inverse(),
            bend: angle_about(&z[1], &upper, &fore),
            upper,
            fore,
            wrist_bend: angle_about(&z[4], &first, &z[5]),
            senses: [z[1].dot(&z[2]).signum(), z[1].dot(&z[3]).signum()],
            size,
            apart,
        })
    }

    /// Every θ with the flange at `flange`, in a fixed order: shoulder, elbow,
    /// wrist. Angles that a singular pose leaves free are those of `near`. A
    /// pose out of reach by less than `slack` \[m\] counts as on the border.
    pub(super) fn solve(&self, flange: &Isometry3<f64>, near: &Theta, slack: f64) -> Vec<Theta> {
        let motion = flange * self.from_flange;
        let mut solutions = Vec::with_capacity(8);
        for theta1 in self.shoulder(&motion, near[0], slack).into_iter().flatten() {
            let (rotation, centre) = self.behind_axis_one(&motion, theta1);
            match self.family {
                Family::SphericalWrist => {
                    let pairs = self.elbow(&centre, near, slack);
                    for [theta2, theta3] in pairs.into_iter().flatten() {
                        let rest = self.turn(2, -theta3) * self.turn(1, -theta2) * rotation;
                        let ends = self.wrist(3, &rest, [near[3], near[4], near[5]]);
                        for [theta4, theta5, theta6] in ends.into_iter().flatten() {
                            solutions.push([theta1, theta2, theta3, theta4, theta5, theta6]);
                        }
                    }
                }
                Family::ThreeParallel => {
                    let [third, fourth] = self.senses;
                    let whole = near[1] + third * near[2] + fourth * near[3];
                    let ends = self.wrist(1, &rotation, [whole, near[4], near[5]]);
                    for [whole, theta5, theta6] in ends.into_iter().flatten() {
                        let tip = self.tip(&centre, whole);
                        let pairs = self.elbow(&tip, near, slack);
                        for [theta2, theta3] in pairs.into_iter().flatten() {
                            let theta4 = fourth * (whole - theta2 - third * theta3);
                            solutions.push([theta1, theta2, theta3, theta4, theta5, theta6]);
                        }
                    }
                }
            }
        }
        solutions
    }

    /// Distance \[m\] of the flange's position from the nearest one that the arm
    /// reaches with this orientation, and where the pose lies.
    pub(super) fn distance(&self, flange: &Isometry3<f64>) -> (f64, Outside) {
        const STEPS: usize = 72;
        let motion = flange * self.from_flange;
        let gap = |theta1: f64| self.gap(&motion, theta1);
        let step = 2.0 * PI / STEPS as f64;
        let coarse: Vec<f64> = (0..STEPS).map(|i| gap(i as f64 * step).0).collect();
        let mut best = (f64::INFINITY, Outside::Beyond);
        for i in 0..STEPS {
            let (before, after) = (coarse[(i + STEPS - 1) % STEPS], coarse[(i + 1) % STEPS]);
            // Every local minimum of the scan: shoulder forwards and backwards.
            if coarse[i] <= before && coarse[i] <= after {
                let at = i as f64 * step;
                let refined = gap(golden_section([at - step, at + step], |t| gap(t).0));
                if refined.0 < best.0 {
                    best = refined;
                }
            }
        }
        best
    }

    /// The same with axis 1 held at `theta1`: what is missing along axis 2 and
    /// in the plane of the planar pair.
    fn gap(&self, motion: &Isometry3<f64>, theta1: f64) -> (f64, Outside) {
        let (rotation, centre) = self.behind_axis_one(motion, theta1);
        let across = self.axes[1].dot(&(centre - self.centre));
        let in_plane = |tip: Vector3<f64>| {
            let reached = self.in_plane(&tip).norm();
            let (long, short) = self.stretched_and_folded();
            if reached > long {
                ((reached - long).hypot(across), Outside::Beyond)
            } else if reached < short {
                ((short - reached).hypot(across), Outside::AxisTwo)
            } else {
                (across.abs(), Outside::AxisOne)
            }
        };
        match self.family {
            Family::SphericalWrist => in_plane(centre),
            Family::ThreeParallel => self
                .wrist(1, &rotation, [0.0; 3])
                .into_iter()
                .flatten()
                .map(|[whole, ..]| in_plane(self.tip(&centre, whole)))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or((f64::INFINITY, Outside::Beyond)),
        }
    }

    fn keep_apart(&self, angle: f64) -> f64 {
        angle.clamp(self.apart, PI - self.apart)
    }

    fn turn(&self, axis: usize, angle: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&self.axes[axis], angle)
    }

    /// Rotation and place of the wrist's centre with the turn about axis 1
    /// taken back.
    fn behind_axis_one(&self, motion: &Isometry3<f64>, theta1: f64) -> (UnitQuaternion<f64>, Vector3<f64>) {
        let back = self.turn(0, -theta1);
        let centre = motion * Point3::from(self.centre);
        let from_axis = centre.coords - self.origins[0];
        (back * motion.rotation, self.origins[0] + back * from_axis)
    }

    /// Tip of the planar pair when axes 2, 3 and 4 together turn by `whole`.
    fn tip(&self, centre: &Vector3<f64>, whole: f64) -> Vector3<f64> {
        centre - self.turn(1, whole) * (self.centre - self.origins[2])
    }

    /// From axis 2 to a point, at right angles to axis 2.
    fn in_plane(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let from_axis = point - self.origins[1];
        from_axis - *self.axes[1] * self.axes[1].dot(&from_axis)
    }

    /// Longest and shortest distance of the pair's tip from axis 2.
    fn stretched_and_folded(&self) -> (f64, f64) {
        let (upper, fore) = (self.upper.norm(), self.fore.norm());
        (upper + fore, (upper - fore).abs())
    }

    /// θ1: turned back by it, the centre has the same component along axis 2 as
    /// at θ = 0.
    fn shoulder(&self, motion: &Isometry3<f64>, near: f64, slack: f64) -> [Option<f64>; 2] {
        let [z1, z2] = [*self.axes[0], *self.axes[1]];
        let point = (motion * Point3::from(self.centre)).coords - self.origins[0];
        let cosine = z1.dot(&z2);
        let ahead = z2 - z1 * cosine;
        let sine = ahead.norm();
        let ahead = ahead / sine;
        let wanted = z2.dot(&(self.centre - self.origins[0])) - cosine * z1.dot(&point);
        let wanted = wanted / sine;
        let (x, y) = (point.dot(&ahead), point.dot(&z1.cross(&ahead)));
        let radius = x.hypot(y);
        if wanted.abs() > radius + slack {
            return [None, None];
        }
        if radius <= FREE * self.size {
            return [Some(near), None];
        }
        let middle = y.atan2(x);
        let half_chord = ((radius - wanted) * (radius + wanted)).max(0.0).sqrt();
        let spread = self.keep_apart(half_chord.atan2(wanted));
        if half_chord == 0.0 && self.apart == 0.0 {
            return [Some(middle + spread), None];
        }
        [Some(middle + spread), Some(middle - spread)]
    }

    /// θ2 and θ3 that bring the tip of the planar pair to `tip`.
    fn elbow(&self, tip: &Vector3<f64>, near: &Theta, slack: f64) -> [Option<[f64; 2]>; 2] {
        let target = self.in_plane(tip);
        let reached = target.norm();
        let (long, short) = self.stretched_and_folded();
        if reached > long + slack || reached < short - slack {
            return [None, None];
        }
        // tan²(E/2) of the exterior angle E of the triangle.
        let opened = ((long - reached) * (long + reached)).max(0.0).sqrt();
        let closed = ((reached - short) * (reached + short)).max(0.0).sqrt();
        let exterior = self.keep_apart(2.0 * opened.atan2(closed));
        let place = |exterior: f64| {
            let about_three = exterior - self.bend;
            let tip = self.upper + self.turn(1, about_three) * self.fore;
            let theta2 = if reached <= FREE * self.size { near[1] } else { angle_about(&self.axes[1], &tip, &target) };
            [theta2, self.senses[0] * about_three]
        };
        if (opened == 0.0 || closed == 0.0) && self.apart == 0.0 {
            return [Some(place(exterior)), None];
        }
        [Some(place(exterior)), Some(place(-exterior))]
    }

    /// Angles about axis `first`, axis 5 and axis 6 whose turns together are
    /// `rotation`. With the outer axes in line only the sum or difference of
    /// their angles is given; what it asks beyond `near` is shared evenly.
    fn wrist(&self, first: usize, rotation: &UnitQuaternion<f64>, near: [f64; 3]) -> [Option<[f64; 3]>; 2] {
        let [a, b, c] = [*self.axes[first], *self.axes[4], *self.axes[5]];
        let last = rotation * c;
        let across = last - a * a.dot(&last);
        let opening = across.norm().atan2(a.dot(&last));
        let sixth = |alpha: f64, beta: f64| {
            let rest = self.turn(4, -beta) * self.turn(first, -alpha) * rotation;
            angle_about(&c, &b, &(rest * b))
        };
        if across.norm() <= FREE {
            let straight = opening < PI / 2.0;
            let beta = if straight { 0.0 } else { PI } - self.wrist_bend;
            let sense = if straight { 1.0 } else { -1.0 };
            let half = wrapped(sixth(near[0], beta) - near[2]) / 2.0;
            return [Some([near[0] + sense * half, beta, near[2] + half]), None];
        }
        let (side, opening) = (b.cross(&a), self.keep_apart(opening));
        let place = |sign: f64| {
            let alpha = angle_about(&a, &(side * sign), &across);
            let beta = sign * opening - self.wrist_bend;
            Some([alpha, beta, sixth(alpha, beta)])
        };
        [place(1.0), place(-1.0)]
    }
}

/// Angle from `from` to `to` about the unit vector `axis` \[rad\], of the parts
/// at right angles to it.
fn angle_about(axis: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
    let across = axis.cross(from);
    let along = across.cross(axis);
    to.dot(&across).atan2(to.dot(&along))
}

/// Middle of the shortest line between two lines; `None` when they are parallel.
fn meeting_point(o1: &Vector3<f64>, z1: &Vector3<f64>, o2: &Vector3<f64>, z2: &Vector3<f64>) -> Option<Vector3<f64>> {
    let normal = z1.cross(z2);
    let square = normal.norm_squared();
    if square.is_nan() || square < PARALLEL_SINE * PARALLEL_SINE {
        return None;
    }
    let between = o2 - o1;
    let first = o1 + z1 * (between.cross(z2).dot(&normal) / square);
    let second = o2 + z2 * (between.cross(z1).dot(&normal) / square);
    Some((first + second) / 2.0)
}

/// The angle in (−π, π] that differs by full turns.
pub(super) fn wrapped(angle: f64) -> f64 {
    let turns = (angle / (2.0 * PI)).round();
    angle - turns * 2.0 * PI
}

/// Where a function with one minimum between `ends` is smallest.
fn golden_section(ends: [f64; 2], value: impl Fn(f64) -> f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let [mut low, mut high] = ends;
    let mut inner = [high - RATIO * (high - low), low + RATIO * (high - low)];
    let mut values = inner.map(&value);
    // A distance is flat at its minimum: half the digits of the angle do.
    while high - low > 1e-9 {
        if values[0] <= values[1] {
            high = inner[1];
            inner = [high - RATIO * (high - low), inner[0]];
            values = [value(inner[0]), values[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + RATIO * (high - low)];
            values = [values[1], value(inner[1])];
        }
    }
    (low + high) / 2.0
}
