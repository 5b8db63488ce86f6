//! All margins of one posture, in a fixed order: pairs of parts, rope against parts, the rope's
//! cone, beams (two per measuring point), torques, smallest and largest displacement.

use super::placed_parts::PlacedParts;
use super::rope::{cone_margin, rope_to_solid};
use super::sight::{SeenFrom, Station};
use super::slope::{Derivative, Slope};
use super::{Carrier, DisplacementLimits, Scene, TorqueLimits, Work};
use crate::model::kinematics::Frames;
use crate::model::limit::{LimitKind, MarginUnit};
use crate::model::load::Load;
use crate::model::observation::{PostureTerms, Setup};
use crate::model::shape::Solid;
use nalgebra::Vector3;

/// A margin by what it is about.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneMargin {
    /// The limit.
    pub kind: LimitKind,
    /// Between which two parts, or of which point or joint.
    pub subject: String,
    /// Margin \[m; rad for angles; share of the limit for torques\], negative when violated.
    pub margin: f64,
}

impl Scene {
    /// Number of margins per posture.
    pub fn count(&self, setup: &Setup) -> usize {
        let mut count = self.pairs.len();
        if let (Some(rope), Load::Rope { .. }) = (&self.rope, &setup.load) {
            count += rope.clearance.map_or(0, |_| self.parts.len());
            count += usize::from(rope.cone.is_some());
        }
        if let Some(sight) = &self.sight {
            count += 2 * sight.facings.len();
        }
        if let Some(torque) = &self.torque {
            count += torque.largest.len();
        }
        count + self.displacement().map_or(0, DisplacementLimits::count)
    }

    /// All margins of one posture with what they are about, in a fixed order.
    pub fn margins(&self, setup: &Setup, terms: &PostureTerms) -> Vec<SceneMargin> {
        let mut values = Vec::with_capacity(self.count(setup));
        self.visit(
            setup,
            terms,
            &mut Work::default(),
            |_| f64::INFINITY,
            |_, margin, _| {
                values.push(margin);
            },
        );
        self.subjects(setup)
            .zip(values)
            .map(|((kind, subject), margin)| SceneMargin {
                kind,
                subject,
                margin: match (kind.unit(), &self.displacement) {
                    (MarginUnit::Displacement, Some(limits)) => margin * limits.unit(),
                    _ => margin,
                },
            })
            .collect()
    }

    /// Which station sees which measuring points at this posture; `None` without stations.
    pub fn seen(&self, terms: &PostureTerms) -> Option<SeenFrom> {
        let sight = self.sight.as_ref()?;
        let mut work = Work::default();
        let placed = PlacedParts::new(&self.parts, terms.frames(), &mut work.shapes);
        Some(sight.seen(terms.measuring_points(), &placed))
    }

    /// The station from which a posture is read, that which sees most; `None` where the cell has no choice of stations.
    pub fn station_at(&self, terms: &PostureTerms) -> Option<&Station> {
        let stations = &self.sight.as_ref().filter(|sight| sight.stations.len() > 1)?.stations;
        stations.get(self.seen(terms)?.station)
    }

    /// What each station sees of the measuring points at this posture, station by station.
    pub fn seen_by_each(&self, terms: &PostureTerms) -> Vec<SeenFrom> {
        let Some(sight) = &self.sight else {
            return Vec::new();
        };
        let mut work = Work::default();
        let placed = PlacedParts::new(&self.parts, terms.frames(), &mut work.shapes);
        (0..sight.stations.len()).map(|station| sight.seen_by(station, terms.measuring_points(), &placed)).collect()
    }

    /// Calls `each` with number, value and derivative of every margin; those of displacements as
    /// shares of their [`unit`](DisplacementLimits::unit). A distance between
    /// shapes may be a lower bound, without derivative, where it is not below `enough` of its number.
    pub(crate) fn visit(
        &self,
        setup: &Setup,
        terms: &PostureTerms,
        work: &mut Work,
        enough: impl Fn(usize) -> f64,
        mut each: impl FnMut(usize, f64, Derivative<'_>),
    ) {
        let frames = terms.frames();
        let Work { shapes, torques, torque_slope, displacement: room, memory } = work;
        if memory.remembers() {
            let theta = frames.serial_angles();
            let beams = self.sight.as_ref().map_or(0, |sight| sight.beam_count());
            memory.arrive(theta, self.count(setup), beams);
        }
        let placed = PlacedParts::new(&self.parts, frames, shapes);
        let mut at = 0;
        for pair in &self.pairs {
            let wanted = enough(at) + self.clearance;
            let travel = memory.between(placed.moved_by(pair.mover), placed.moved_by(pair.solid));
            let separation = match memory.still(at, travel, wanted) {
                Some(least) => (least, None),
                None => {
                    let separation = pair.distance(&placed, memory.ahead(wanted));
                    memory.note(at, travel, separation.0);
                    separation
                }
            };
            let derivative = separation.1.as_ref().map_or(Derivative::Zero, Derivative::Touch);
            each(at, separation.0 - self.clearance, derivative);
            at += 1;
        }
        if let (Some(rope), Load::Rope { anchor, .. }) = (&self.rope, &setup.load) {
            let (p, n) = (terms.loading_point(), frames.joint_count());
            if let Some(clearance) = rope.clearance {
                for part in 0..placed.part_count() {
                    let wanted = enough(at) + clearance;
                    let travel = memory.between(0, n) + memory.between(0, placed.moved_by(part));
                    let separation = match memory.still(at, travel, wanted) {
                        Some(least) => (least, None),
                        None => {
                            let enough = memory.ahead(wanted);
                            let moved_by = (n, placed.moved_by(part));
                            let mut best = (f64::INFINITY, None);
                            for solid in placed.solids(part) {
                                let enough = best.0.min(enough);
                                let separation = rope_to_solid(p, anchor, rope.free, solid, moved_by, enough);
                                if separation.0 < best.0 {
                                    best = separation;
                                }
                            }
                            memory.note(at, travel, best.0);
                            best
                        }
                    };
                    let derivative = separation.1.as_ref().map_or(Derivative::Zero, Derivative::Slope);
                    each(at, separation.0 - clearance, derivative);
                    at += 1;
                }
            }
            if let Some(cone) = &rope.cone {
                let (margin, slope) = cone_margin(p, anchor, cone, n);
                each(at, margin, Derivative::Slope(&slope));
                at += 1;
            }
        }
        if let Some(sight) = &self.sight {
            let count = 2 * sight.facings.len();
            let most = (at..at + count).map(&enough).fold(0.0, f64::max);
            sight.visit(terms.measuring_points(), &placed, memory, most, |margin, slope| {
                each(at, margin, slope);
                at += 1;
            });
        }
        if let Some(torque) = &self.torque {
            let n = torque.largest.len();
            torques.resize(n, 0.0);
            torque_slope.resize(n, 0.0);
            torque.torques(setup, terms, torques);
            for (j, largest) in torque.largest.iter().enumerate() {
                let margin = 1.0 - torques[j].abs() / largest;
                let mut slope = Slope::NONE;
                if margin < enough(at) {
                    torque.slope(setup, terms, j, torque_slope);
                    let share = -torques[j].signum() / largest;
                    torque_slope.iter_mut().for_each(|s| *s *= share);
                    slope.by_joint = Some(torque_slope);
                    let by_load = TorqueLimits::by_load(setup, terms, j);
                    slope.by_anchor = by_load.0 * share;
                    slope.by_loading_point = by_load.1 * share;
                }
                each(at, margin, Derivative::Slope(&slope));
                at += 1;
            }
        }
        if let Some(limits) = &self.displacement {
            let most = (at..at + limits.count()).map(&enough).fold(0.0, f64::max);
            limits.visit(setup, terms, room, most, |margin, slope| {
                each(at, margin, Derivative::Slope(slope));
                at += 1;
            });
        }
    }

    /// What each margin is about, in their order.
    fn subjects<'a>(&'a self, setup: &'a Setup) -> impl Iterator<Item = (LimitKind, String)> + 'a {
        let pairs = self.pairs.iter().map(|pair| {
            let (a, b) = (self.name(pair.mover), self.name(pair.solid));
            (LimitKind::Shapes, format!("{a} and {b}"))
        });
        let rope = match &setup.load {
            Load::Rope { .. } => self.rope.as_ref(),
            _ => None,
        };
        let touched = rope.filter(|rope| rope.clearance.is_some());
        let line = setup.load.line();
        let touched = touched.into_iter().flat_map(move |_| {
            let parts = self.parts.iter();
            parts.map(move |part| {
                let subject = format!("{line} and {}", part.name);
                (LimitKind::RopeClearance, subject)
            })
        });
        let cone = rope.and_then(|rope| rope.cone.as_ref());
        let cone = cone.map(|_| (LimitKind::RopeCone, line.to_string()));
        let points = setup.tool.measuring_points.iter();
        let seen = self.sight.iter().flat_map(move |_| points.clone());
        let seen = seen.flat_map(|point| {
            let name = format!("measuring point {}", point.name);
            [(LimitKind::Incidence, name.clone()), (LimitKind::Sight, name)]
        });
        let joints = setup.robot.joints().iter();
        let torque = self.torque.iter().flat_map(move |_| joints.clone());
        let torque = torque.map(|joint| (LimitKind::Torque, joint.name.clone()));
        let moved = self.displacement.iter().flat_map(DisplacementLimits::kinds);
        let moved = moved.map(|kind| (kind, "measuring points".to_string()));
        let all = pairs.chain(touched).chain(cone).chain(seen);
        all.chain(torque).chain(moved)
    }

    /// Torques of load and tool weight at this posture \[N·m\], where they are limited.
    pub fn torques(&self, setup: &Setup, terms: &PostureTerms) -> Option<Vec<f64>> {
        let torque = self.torque.as_ref()?;
        let mut torques = vec![0.0; torque.largest.len()];
        torque.torques(setup, terms, &mut torques);
        Some(torques)
    }

    /// The parts at this posture: name, and the capsules or solids in the base frame \[m\].
    pub fn placed<'a>(&'a self, frames: &Frames) -> Vec<(&'a str, Vec<Solid>)> {
        self.parts
            .iter()
            .map(|part| {
                let pose = part.carrier.pose(frames);
                let solids = part.solids.iter().map(|s| s.placed(&pose)).collect();
                (part.name.as_str(), solids)
            })
            .collect()
    }

    /// Distance of a point of the tool (flange axes) from the tool's own shapes \[m\], negative
    /// inside, with the name of the nearest; `None` without any.
    pub fn depth_in_tool(&self, point: &Vector3<f64>) -> Option<(f64, &str)> {
        let tools = self.parts.iter().filter(|part| part.is_tool());
        tools
            .flat_map(|part| part.solids.iter().map(|s| (s.signed_distance(point).0, part.name.as_str())))
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Distance of a point of the base frame from what stands in the cell \[m\], negative
    /// inside, with the name of the nearest; `None` without any.
    pub fn depth_in_surroundings(&self, point: &Vector3<f64>) -> Option<(f64, &str)> {
        let standing = self.parts.iter().filter(|part| part.carrier == Carrier::World);
        standing
            .flat_map(|part| part.solids.iter().map(|s| (s.signed_distance(point).0, part.name.as_str())))
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }
}
