//! Every constraint of a random cell a second time, from the numbers of its tables.
//!
//! Shares with the library the rules that its documentation states, and no arithmetic.

use super::arm::{Frame, Reached};
use super::cases::{Case, Load, Pull};
use super::distance::{Body, Shape};
use crate::common::prelude::*;
use std::collections::BTreeMap;

type V = Vector3<f64>;

/// Step of the finite differences \[rad\].
const STEP: f64 = 1e-5;

/// What moves a part.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Carried {
    Stands,
    Link(usize),
    Tool,
}

#[derive(Debug)]
struct Piece {
    name: String,
    carried: Carried,
    shapes: Vec<Shape>,
}

/// A cell's constraints.
#[derive(Debug)]
pub struct Checker<'a> {
    case: &'a Case,
    mount: Frame,
    pieces: Vec<Piece>,
    /// Pairs that are kept apart.
    pub pairs: Vec<(usize, usize)>,
}

impl<'a> Checker<'a> {
    pub fn new(case: &'a Case) -> Self {
        let (at, turns) = case.mount.unwrap_or_default();
        let mut pieces: Vec<Piece> = Vec::new();
        let links = case.arm.capsules.iter().map(|(link, shape)| {
            let name = match link {
                0 => "base".to_string(),
                i => format!("link {i}"),
            };
            (name, Carried::Link(*link), shape)
        });
        let tool = case.tool.iter();
        let tool = tool.map(|(name, shape)| (name.clone(), Carried::Tool, shape));
        let around = case.obstacles.iter();
        let around = around.map(|(name, shape)| (name.clone(), Carried::Stands, shape));
        for (name, carried, shape) in links.chain(tool).chain(around) {
            match pieces.iter_mut().find(|piece| piece.name == name) {
                Some(piece) => piece.shapes.push(*shape),
                None => pieces.push(Piece { name, carried, shapes: vec![*shape] }),
            }
        }
        let mut checker = Checker {
            case,
            mount: Frame::of_pose(at.map(|v| v * 1e-3), turns.map(f64::to_radians)),
            pieces,
            pairs: Vec::new(),
        };
        for i in 0..checker.pieces.len() {
            for j in i + 1..checker.pieces.len() {
                if checker.are_kept_apart(i, j) {
                    checker.pairs.push((i, j));
                }
            }
        }
        checker
    }

    /// The rules: neighbours, what stands, the tool's own shapes and ignored pairs may touch.
    fn are_kept_apart(&self, i: usize, j: usize) -> bool {
        let (a, b) = (&self.pieces[i], &self.pieces[j]);
        let named =
            |pair: &[String; 2]| (pair[0] == a.name && pair[1] == b.name) || (pair[1] == a.name && pair[0] == b.name);
        let is_pair = |x: usize, y: usize| {
            let (x, y) = (Carried::Link(x), Carried::Link(y));
            (a.carried, b.carried) == (x, y) || (a.carried, b.carried) == (y, x)
        };
        let by_catalogue = !self.case.own_capsules && self.case.arm.ignored.iter().any(|(x, y)| is_pair(*x, *y));
        let last = self.case.arm.joint_count();
        let allowed = match (a.carried, b.carried) {
            (Carried::Link(x), Carried::Link(y)) => x.abs_diff(y) == 1,
            (Carried::Tool, Carried::Link(x)) | (Carried::Link(x), Carried::Tool) => x == last,
            (Carried::Stands, Carried::Stands) | (Carried::Tool, Carried::Tool) => true,
            (Carried::Stands, Carried::Link(0)) | (Carried::Link(0), Carried::Stands) => true,
            _ => false,
        };
        !(allowed || by_catalogue || self.case.clearance.ignore.iter().any(named))
    }

    /// True where a pair may be left out if its shapes always overlap: parts of arm and tool, and the
    /// first link with what stands.
    pub fn may_always_overlap(&self, (i, j): (usize, usize)) -> bool {
        let (a, b) = (self.pieces[i].carried, self.pieces[j].carried);
        match (a, b) {
            (Carried::Stands, other) | (other, Carried::Stands) => other == Carried::Link(1),
            _ => true,
        }
    }

    pub fn names(&self, (i, j): (usize, usize)) -> [&str; 2] {
        let names = [&*self.pieces[i].name, &*self.pieces[j].name];
        changed(names, |names| names.sort_unstable())
    }

    fn reached(&self, serial: &[f64]) -> Reached {
        self.case.arm.at(&self.mount, serial)
    }

    fn bodies(&self, at: &Reached) -> Vec<Vec<Body>> {
        let home = Frame::of_pose([0.0; 3], [0.0; 3]);
        let of = |piece: &Piece| {
            let frame = match piece.carried {
                Carried::Stands => home,
                // A shape of the cell's own table stands in the cell's base frame.
                Carried::Link(0) if self.case.own_capsules => home,
                Carried::Link(i) => at.links[i],
                Carried::Tool => at.flange,
            };
            piece.shapes.iter().map(|s| Body::new(s, &frame)).collect()
        };
        self.pieces.iter().map(of).collect()
    }

    /// Distance of a pair's shapes \[m\].
    pub fn apart(&self, q: &[f64], (i, j): (usize, usize)) -> f64 {
        let bodies = self.bodies(&self.reached(&self.case.arm.serial(q)));
        least_of(&bodies[i], &bodies[j])
    }

    /// True where every constraint is met.
    pub fn meets(&self, q: &[f64], tolerance: f64) -> bool {
        let mut met = true;
        self.visit(q, &mut |_, margin| {
            met &= margin >= -tolerance;
            met
        });
        met
    }

    /// The constraints that are violated by more than `tolerance` (m, rad, share).
    pub fn violated(&self, q: &[f64], tolerance: f64) -> Vec<String> {
        let mut out = Vec::new();
        self.visit(q, &mut |what, margin| {
            if margin.is_nan() || margin < -tolerance {
                out.push(format!("{what} by {:e}", -margin));
            }
            true
        });
        out
    }

    /// The smallest margin of everything that is asked, by what it is about.
    pub fn margins(&self, q: &[f64]) -> BTreeMap<String, f64> {
        let mut out = BTreeMap::new();
        self.visit(q, &mut |what, margin| {
            let least = out.entry(what.to_string()).or_insert(f64::INFINITY);
            *least = margin.min(*least);
            true
        });
        out
    }

    /// True where a cylinder of one of them stands as a prism inside it: they may be nearer than the checker says.
    pub fn is_drawn_smaller(&self, names: &str) -> bool {
        let named = |carried| {
            let pieces = self.pieces.iter();
            pieces.filter(move |p| p.carried == carried && names.split(" and ").any(|n| n == p.name))
        };
        let is_capsule = |shape: &Shape| matches!(shape, Shape::Capsule { .. });
        let mut tool = named(Carried::Tool).flat_map(|p| &p.shapes);
        tool.any(|shape| !is_capsule(shape)) && named(Carried::Stands).chain(named(Carried::Link(0))).next().is_some()
    }

    /// Calls `each` with what every margin is about, until it says false.
    fn visit(&self, q: &[f64], each: &mut dyn FnMut(&str, f64) -> bool) {
        for (j, (angle, bound)) in q.iter().zip(&self.case.bounds).enumerate() {
            let [low, high] = bound.map(f64::to_radians);
            if !each(&format!("bounds of joint {}", j + 1), (angle - low).min(high - angle)) {
                return;
            }
        }
        let serial = self.case.arm.serial(q);
        let at = self.reached(&serial);
        let mut go_on = true;
        let mut next = |what: &str, margin: f64| {
            go_on = go_on && each(what, margin);
            go_on
        };
        if !self.points(&at, &mut next) || !self.torques(&serial, &mut next) {
            return;
        }
        let bodies = self.bodies(&at);
        let clearance = &self.case.clearance;
        let distance = clearance.shapes.unwrap_or(20.0) * 1e-3;
        for pair in &self.pairs {
            let apart = least_of(&bodies[pair.0], &bodies[pair.1]);
            if !next(&self.names(*pair).join(" and "), apart - distance) {
                return;
            }
        }
        if self.ropes(&at, &bodies, &mut next) {
            self.sight(&at, &bodies, &mut next);
        }
    }

    fn points(&self, at: &Reached, next: &mut dyn FnMut(&str, f64) -> bool) -> bool {
        let limits = &self.case.limits;
        let loads = &self.case.loads;
        let mut points: Vec<V> = loads.iter().map(|load| self.loading(at, load)).collect();
        points.push(at.flange.origin());
        points.extend(self.measured(at));
        // The point on the axis of the last joint but one.
        let wrist = at.axes[at.axes.len() - 2].0;
        let (foot, axis) = at.axes[0];
        let far = |p: &V| (p - foot).cross(&axis).norm();
        for p in &points {
            if let Some([low, high]) = limits.corners {
                let sides = (0..3).map(|i| (p[i] - low[i] * 1e-3).min(high[i] * 1e-3 - p[i]));
                if !next("box", sides.fold(f64::INFINITY, f64::min)) {
                    return false;
                }
            }
            if limits.floor.is_some_and(|z| !next("floor", p.z - z * 1e-3)) {
                return false;
            }
        }
        if let Some(radius) = limits.keep_out {
            let nearest = points.iter().chain([&wrist]).map(far);
            if !next("keep-out", nearest.fold(f64::INFINITY, f64::min) - radius * 1e-3) {
                return false;
            }
        }
        if limits.wrist.is_some_and(|z| !next("wrist", wrist.z - z * 1e-3)) {
            return false;
        }
        loads.iter().all(|load| match (limits.rope, &load.pull) {
            (Some([low, high]), Pull::Rope { anchor, .. }) => {
                let length = (V::from(*anchor) * 1e-3 - self.loading(at, load)).norm();
                next("rope length", (length - low * 1e-3).min(high * 1e-3 - length))
            }
            _ => true,
        })
    }

    fn loading(&self, at: &Reached, load: &Load) -> V {
        let point = load.at.unwrap_or(self.case.loading);
        at.flange.point(&point.map(|v| v * 1e-3))
    }

    fn measured(&self, at: &Reached) -> Vec<V> {
        let points = self.case.points.iter();
        points.map(|p| at.flange.point(&p.position.map(|v| v * 1e-3))).collect()
    }

    fn torques(&self, serial: &[f64], next: &mut dyn FnMut(&str, f64) -> bool) -> bool {
        let loads = &self.case.loads;
        loads.iter().all(|load| self.torques_under(load, serial, next))
    }

    /// Torques by virtual work: what load and weight do while one joint turns a little.
    fn torques_under(&self, load: &Load, serial: &[f64], next: &mut dyn FnMut(&str, f64) -> bool) -> bool {
        let Some(torques) = &self.case.torques else {
            return true;
        };
        let (mass, centre) = torques.mass.unwrap_or_default();
        let at = self.reached(serial);
        let (force, moment) = match &load.pull {
            Pull::Rope { anchor, magnitude } => {
                let rope = V::from(*anchor) * 1e-3 - self.loading(&at, load);
                (rope * (magnitude / rope.norm()), V::zeros())
            }
            Pull::Weight { magnitude } => (V::new(0.0, 0.0, -magnitude), V::zeros()),
            Pull::Wrench { force, moment } => (V::from(*force), V::from(*moment)),
        };
        for (j, largest) in torques.largest.iter().enumerate() {
            let turned = |by: f64| {
                let mut serial = serial.to_vec();
                serial[j] += by;
                self.reached(&serial)
            };
            let (after, before) = (turned(STEP), turned(-STEP));
            let point = self.loading(&after, load) - self.loading(&before, load);
            let heavy = |at: &Reached| at.flange.point(&centre.map(|v| v * 1e-3)).z;
            let work = force.dot(&point) - mass * 9.80665 * (heavy(&after) - heavy(&before));
            let torque = work / (2.0 * STEP) + moment.dot(&at.axes[j].1);
            if !next(&format!("torque {}", j + 1), 1.0 - torque.abs() / largest) {
                return false;
            }
        }
        true
    }

    fn ropes(&self, at: &Reached, bodies: &[Vec<Body>], next: &mut dyn FnMut(&str, f64) -> bool) -> bool {
        let mut loads = self.case.loads.iter();
        loads.all(|load| self.rope(load, at, bodies, next))
    }

    fn rope(&self, load: &Load, at: &Reached, bodies: &[Vec<Body>], next: &mut dyn FnMut(&str, f64) -> bool) -> bool {
        let (Pull::Rope { anchor, .. }, clearance) = (&load.pull, &self.case.clearance) else {
            return true;
        };
        let (from, anchor) = (self.loading(at, load), V::from(*anchor) * 1e-3);
        let distance = clearance.rope.unwrap_or(20.0) * 1e-3;
        let [first, last] = clearance.free.unwrap_or([100.0, 100.0]).map(|v| v * 1e-3);
        let length = (anchor - from).norm();
        if length > first + last {
            let along = (anchor - from) / length;
            let ends = (from + along * first, anchor - along * last);
            for (piece, bodies) in self.pieces.iter().zip(bodies) {
                let each = bodies.iter().map(|body| body.to_segment(&ends.0, &ends.1));
                let apart = each.fold(f64::INFINITY, f64::min);
                if !next(&format!("rope and {}", piece.name), apart - distance) {
                    return false;
                }
            }
        }
        let Some((axis, angle)) = &clearance.cone else {
            return true;
        };
        next("cone", angle.to_radians() - between(&V::from(*axis), &(from - anchor)))
    }

    /// One station must see enough points: its beam clear of every shape and within the acceptance angle.
    fn sight(&self, at: &Reached, bodies: &[Vec<Body>], next: &mut dyn FnMut(&str, f64) -> bool) -> bool {
        if self.case.stations.is_empty() {
            return true;
        }
        let distance = self.case.clearance.sight.unwrap_or(5.0) * 1e-3;
        let wanted = self.case.clearance.visible.unwrap_or(self.case.points.len());
        let measured = self.measured(at);
        let by_station = self.case.stations.iter().map(|station| {
            let station = V::from(*station) * 1e-3;
            let seen = self.case.points.iter().zip(&measured).map(|(point, p)| {
                let all = bodies.iter().flatten();
                let clear = all.map(|body| body.to_segment(p, &station));
                let clear = clear.fold(f64::INFINITY, f64::min) - distance;
                let Some((axis, acceptance)) = &point.facing else {
                    return clear;
                };
                let angle = between(&at.flange.direction(axis), &(station - p));
                clear.min(acceptance.unwrap_or(30.0).to_radians() - angle)
            });
            let mut seen: Vec<f64> = seen.collect();
            seen.sort_by(|a, b| b.total_cmp(a));
            seen[wanted - 1]
        });
        next("sight", by_station.fold(f64::NEG_INFINITY, f64::max))
    }

    /// What is left on the way from posture to posture \[m\]: shapes keep half their distance, floor and
    /// keep-out cylinder are met to a millimetre.
    pub fn room_on_the_way(&self, q: &[f64]) -> f64 {
        let at = self.reached(&self.case.arm.serial(q));
        let bodies = self.bodies(&at);
        let half = self.case.clearance.shapes.unwrap_or(20.0) * 0.5e-3;
        let apart = |pair: &(usize, usize)| least_of(&bodies[pair.0], &bodies[pair.1]) - half;
        let mut least = self.pairs.iter().map(apart).fold(f64::INFINITY, f64::min);
        let mut points = vec![at.flange.point(&self.case.loading.map(|v| v * 1e-3))];
        points.push(at.flange.origin());
        points.extend(self.measured(&at));
        if let Some(floor) = self.case.limits.floor {
            let low = points.iter().map(|p| p.z - floor * 1e-3 + 1e-3);
            least = low.fold(least, f64::min);
        }
        if let Some([low, high]) = self.case.limits.corners {
            let side = |p: &V, i: usize| (p[i] - low[i] * 1e-3).min(high[i] * 1e-3 - p[i]) + 1e-3;
            let sides = points.iter().flat_map(|p| (0..3).map(move |i| side(p, i)));
            least = sides.fold(least, f64::min);
        }
        let wrist = at.axes[at.axes.len() - 2].0;
        if let Some(height) = self.case.limits.wrist {
            least = least.min(wrist.z - height * 1e-3 + 1e-3);
        }
        if let Some(radius) = self.case.limits.keep_out {
            points.push(wrist);
            let (foot, axis) = at.axes[0];
            let far = |p: &V| (p - foot).cross(&axis).norm() - radius * 1e-3 + 1e-3;
            least = points.iter().map(far).fold(least, f64::min);
        }
        least
    }

    /// How far a station is from what stands, base included, and a measuring point from the tool; the
    /// smallest, with the distance that beams keep taken off.
    pub fn places(&self) -> f64 {
        let bodies = self.bodies(&self.reached(&vec![0.0; self.case.arm.joint_count()]));
        let at = self.reached(&vec![0.0; self.case.arm.joint_count()]);
        let distance = self.case.clearance.sight.unwrap_or(5.0) * 1e-3;
        let stands = |piece: &Piece| matches!(piece.carried, Carried::Stands | Carried::Link(0));
        let mut least = f64::INFINITY;
        for (piece, bodies) in self.pieces.iter().zip(&bodies) {
            for body in bodies {
                for station in self.case.stations.iter().filter(|_| stands(piece)) {
                    least = least.min(body.to_point(&(V::from(*station) * 1e-3)) - distance);
                }
                for point in self.measured(&at) {
                    if piece.carried == Carried::Tool {
                        least = least.min(body.to_point(&point) - distance);
                    }
                }
            }
        }
        least
    }
}

fn between(a: &V, b: &V) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

fn least_of(a: &[Body], b: &[Body]) -> f64 {
    let each = a.iter().flat_map(|a| b.iter().map(|b| a.to_body(b)));
    each.fold(f64::INFINITY, f64::min)
}
