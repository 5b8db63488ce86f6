//! Lines of sight from tracker stations to measuring points.

use super::pairs::{Line, line_to_solid};
use super::placed_parts::PlacedParts;
use super::slope::{Derivative, Slope, Touch};
use super::work::Memory;
use crate::model::kinematics::Frames;
use crate::model::shape::Capsule;
use nalgebra::{Unit, Vector3};

/// Beams farther than this from every part are as good as clear \[m\].
const CLEAR_DISTANCE: f64 = 0.25;
/// Where margins need not be told: room for the choice of the station \[m, rad\].
const CHOICE: f64 = 0.02;

/// Rounding of a margin that a search has brought to zero.
const MARGIN_ROUNDING: f64 = 1e-8;

/// Where a tracker stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Station {
    /// Its name.
    pub name: String,
    /// Where its beam goes out, base frame \[m\].
    pub position: Vector3<f64>,
}

/// Where a reflector looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facing {
    /// Its axis, flange axes.
    pub axis: Unit<Vector3<f64>>,
    /// Largest angle between axis and beam \[rad\].
    pub acceptance: f64,
}

/// What is asked of the tracker's beams.
#[derive(Debug, Clone, PartialEq)]
pub struct Sight {
    /// The stations; one of them must see enough measuring points of a posture.
    pub stations: Vec<Station>,
    /// Where the reflectors look, one per measuring point; `None`: all round.
    pub facings: Vec<Option<Facing>>,
    /// Distance kept between a beam and every part \[m\].
    pub clearance: f64,
    /// How many measuring points must be seen.
    pub visible_points: usize,
}

/// How well one station sees one measuring point.
#[derive(Debug, Clone, Copy)]
struct Beam {
    incidence: f64,
    clearance: f64,
    /// What it comes near to.
    touch: Option<Touch>,
}

impl Beam {
    fn margin(&self) -> f64 {
        self.incidence.min(self.clearance)
    }
}

/// Which station sees which measuring points of a posture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeenFrom {
    /// Number of the station.
    pub station: usize,
    /// Numbers of the measuring points that it sees, ascending.
    pub points: Vec<usize>,
}

impl Sight {
    /// The station that sees most, and what it sees.
    pub(super) fn seen(&self, points: &[Vector3<f64>], placed: &PlacedParts<'_>) -> SeenFrom {
        let mut best: Option<(SeenFrom, f64)> = None;
        for station in 0..self.stations.len() {
            let beams = self.beams(station, points, placed, &mut Memory::default(), CLEAR_DISTANCE);
            let seen = (0..points.len()).filter(|i| beams[*i].margin() >= -MARGIN_ROUNDING).collect();
            let (_, margin) = self.chosen(&beams);
            let here = SeenFrom { station, points: seen };
            let better =
                best.as_ref().is_none_or(|(before, with)| (here.points.len(), margin) > (before.points.len(), *with));
            if better {
                best = Some((here, margin));
            }
        }
        best.map_or(SeenFrom { station: 0, points: Vec::new() }, |(seen, _)| seen)
    }

    /// What one station sees.
    pub(super) fn seen_by(&self, station: usize, points: &[Vector3<f64>], placed: &PlacedParts<'_>) -> SeenFrom {
        let beams = self.beams(station, points, placed, &mut Memory::default(), CLEAR_DISTANCE);
        let seen = (0..points.len()).filter(|i| beams[*i].margin() >= 0.0);
        SeenFrom { station, points: seen.collect() }
    }

    /// Two margins per measuring point, incidence and clearance \[rad, m\], of the station that sees
    /// best, or of the first that sees well enough; infinite for points that need not be seen.
    pub(super) fn visit(
        &self,
        points: &[Vector3<f64>],
        placed: &PlacedParts<'_>,
        memory: &mut Memory,
        enough: f64,
        mut each: impl FnMut(f64, Derivative<'_>),
    ) {
        let clear = (enough + CHOICE).min(CLEAR_DISTANCE);
        let mut best: Option<(usize, Vec<Beam>, Vec<bool>, f64)> = None;
        for station in 0..self.stations.len() {
            let beams = self.beams(station, points, placed, memory, clear);
            let (needed, margin) = self.chosen(&beams);
            if best.as_ref().is_none_or(|best| margin > best.3) {
                best = Some((station, beams, needed, margin));
            }
            // Another one need not see better.
            if margin >= enough && enough.is_finite() {
                break;
            }
        }
        let Some((station, beams, needed, _)) = best else {
            return;
        };
        let from = self.stations[station].position;
        for (i, beam) in beams.iter().enumerate() {
            if !needed[i] {
                each(f64::INFINITY, Derivative::Zero);
                each(f64::INFINITY, Derivative::Zero);
                continue;
            }
            match &self.facings[i] {
                Some(facing) if beam.incidence < enough => {
                    let slope = incidence(&points[i], &from, facing, placed.frames).1;
                    each(beam.incidence, Derivative::Slope(&slope));
                }
                _ => each(beam.incidence, Derivative::Zero),
            }
            let touch = beam.touch.as_ref();
            each(beam.clearance, touch.map_or(Derivative::Zero, Derivative::Touch));
        }
    }

    /// The points that count, those seen best, and the margin of the worst of them.
    fn chosen(&self, beams: &[Beam]) -> (Vec<bool>, f64) {
        let mut order: Vec<usize> = (0..beams.len()).collect();
        order.sort_by(|a, b| beams[*b].margin().total_cmp(&beams[*a].margin()));
        order.truncate(self.visible_points);
        let worst = order.last().map_or(f64::INFINITY, |i| beams[*i].margin());
        let mut needed = vec![false; beams.len()];
        for i in order {
            needed[i] = true;
        }
        (needed, worst)
    }

    fn beams(
        &self,
        station: usize,
        points: &[Vector3<f64>],
        placed: &PlacedParts<'_>,
        memory: &mut Memory,
        clear: f64,
    ) -> Vec<Beam> {
        let from = self.stations[station].position;
        let mut beams = Vec::with_capacity(points.len());
        for (i, (point, facing)) in points.iter().zip(&self.facings).enumerate() {
            let at = station * points.len() + i;
            // The tool is always near; what else is near changes slowly.
            let (mut clearance, mut touch) = self.beam_clearance(point, &from, placed, true, clear);
            let travel = 2.0 * memory.between(0, placed.frames.joint_count());
            if memory.beam_still(at, travel, clear).is_none() {
                let ahead = memory.ahead(clear);
                let (distance, other) = self.beam_clearance(point, &from, placed, false, ahead);
                memory.note_beam(at, travel, distance);
                if distance < clearance {
                    (clearance, touch) = (distance, other);
                }
            }
            beams.push(Beam {
                incidence: match facing {
                    Some(facing) => incidence(point, &from, facing, placed.frames).0,
                    None => f64::INFINITY,
                },
                clearance,
                touch,
            });
        }
        beams
    }

    /// Number of beams, from each station to each measuring point.
    pub(super) fn beam_count(&self) -> usize {
        self.stations.len() * self.facings.len()
    }

    /// Of the beam to the parts of the tool, or to all others.
    fn beam_clearance(
        &self,
        point: &Vector3<f64>,
        station: &Vector3<f64>,
        placed: &PlacedParts<'_>,
        of_tool: bool,
        clear: f64,
    ) -> (f64, Option<Touch>) {
        let line = Line {
            capsule: Capsule { a: *point, b: *station, radius: self.clearance },
            moved_by: [placed.frames.joint_count(), 0],
        };
        let mut best = (clear, None);
        for part in (0..placed.part_count()).filter(|part| placed.is_tool(*part) == of_tool) {
            for solid in placed.solids(part) {
                let separation = line_to_solid(&line, solid, placed.moved_by(part), best.0);
                if separation.0 < best.0 {
                    best = separation;
                }
            }
        }
        best
    }
}

/// How far the beam is inside the reflector's acceptance angle \[rad\].
fn incidence(point: &Vector3<f64>, station: &Vector3<f64>, facing: &Facing, frames: &Frames) -> (f64, Slope<'static>) {
    let axis = frames.direction(&facing.axis);
    let beam = station - point;
    let length = beam.norm();
    let unit = beam / length;
    let cosine = axis.dot(&unit).clamp(-1.0, 1.0);
    let sine = (1.0 - cosine * cosine).sqrt();
    let mut slope = Slope::NONE;
    if sine > 1e-9 {
        // cos = e·u: e turns with the tool, u with the point.
        slope.turn = axis.cross(&unit) / sine;
        let force = (unit * cosine - axis) / (length * sine);
        slope.push(*point, force, frames.joint_count());
    }
    (facing.acceptance - cosine.acos(), slope)
}
