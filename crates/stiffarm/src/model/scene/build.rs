//! From parts and rules to the pairs that are kept apart.

use super::pairs::Pair;
use super::placed_parts::{PlacedParts, Shapes};
use super::{Carrier, DisplacementLimits, Part, RopeRules, Scene, Sight, TorqueLimits};
use crate::error::{Code, Error, Result};
use crate::model::kinematics::Frames;
use crate::model::robot::Robot;
use crate::numerics::streams::spread;

/// Postures at which parts are looked at: a pair that overlaps in all of them always does.
const SAMPLES: u32 = 256;

/// Parts of a cell and what is asked of them.
#[derive(Debug, Clone, Default)]
pub struct SceneParts {
    /// The parts, each with a name of its own: links first, then the tool, then what stands around.
    pub parts: Vec<Part>,
    /// Distance kept between two parts \[m\].
    pub clearance: f64,
    /// Pairs, by name, that may come as near as they like.
    pub ignored: Vec<(String, String)>,
    /// What is asked of the rope.
    pub rope: Option<RopeRules>,
    /// What is asked of the tracker's beams.
    pub sight: Option<Sight>,
    /// What the joints may carry.
    pub torque: Option<TorqueLimits>,
    /// How far the load may move the measuring points.
    pub displacement: Option<DisplacementLimits>,
}

impl SceneParts {
    /// Finds the pairs to be kept apart. Links next to each other are not, nor what stands, nor the
    /// shapes of the tool among themselves. Two parts of arm and tool that are too near in every posture
    /// within `bounds` \[rad\] are so because their shapes are drawn large: they are left out, and the scene says so.
    /// So is the first link with what stands around it.
    ///
    /// # Errors
    /// A name that appears twice, or an ignored pair without such parts.
    pub fn build(self, robot: &Robot, bounds: &[[f64; 2]]) -> Result<Scene> {
        for (i, part) in self.parts.iter().enumerate() {
            if self.parts[..i].iter().any(|other| other.name == part.name) {
                let message = format!("Two shapes have the name \"{}\".", part.name);
                return Err(Error::new(Code::Duplicate, message));
            }
        }
        for (a, b) in &self.ignored {
            for name in [a, b] {
                if !self.parts.iter().any(|part| part.name == *name) {
                    let names: Vec<&str> = self.parts.iter().map(|p| p.name.as_str()).collect();
                    let message = format!("There is no shape named \"{name}\".");
                    let hint = format!("the shapes are {}", names.join(", "));
                    return Err(Error::new(Code::UnknownName, message).hint(hint));
                }
            }
        }
        let n = robot.joint_count();
        let wanted = |a: &Part, b: &Part| {
            let ignored =
                self.ignored.iter().any(|(x, y)| (*x == a.name && *y == b.name) || (*x == b.name && *y == a.name));
            let standing = a.carrier == Carrier::World && b.carrier == Carrier::World;
            let link = |part: &Part| match part.carrier {
                Carrier::World if part.name == "base" => Some(0),
                Carrier::World => None,
                other => Some(other.moved_by(n) + usize::from(part.is_tool())),
            };
            let beside = matches!((link(a), link(b)), (Some(i), Some(j)) if i.abs_diff(j) < 2);
            !(ignored || standing || beside)
        };
        let mut pairs = Vec::new();
        for (i, a) in self.parts.iter().enumerate() {
            for (j, b) in self.parts.iter().enumerate().skip(i + 1) {
                if !wanted(a, b) {
                    continue;
                }
                // What stands does not move, and links are lines against the tool's solids.
                let a_moves = b.carrier == Carrier::World || (a.carrier != Carrier::World && b.is_tool());
                pairs.push(if a_moves { Pair { mover: i, solid: j } } else { Pair { mover: j, solid: i } });
            }
        }
        let mut scene = Scene {
            parts: self.parts,
            clearance: self.clearance,
            pairs,
            dropped: Vec::new(),
            rope: self.rope,
            sight: self.sight,
            torque: self.torque,
            displacement: self.displacement,
        };
        scene.drop_overlapping(robot, bounds);
        Ok(scene)
    }
}

impl Scene {
    /// Leaves out pairs that are too near in every posture.
    fn drop_overlapping(&mut self, robot: &Robot, bounds: &[[f64; 2]]) {
        let (parts, n) = (&self.parts, robot.joint_count());
        let clearance = self.clearance;
        let may_drop = |pair: &Pair| {
            let (a, b) = (&parts[pair.mover], &parts[pair.solid]);
            let stands = |part: &Part| part.carrier == Carrier::World && part.name != "base";
            let least = a.carrier.moved_by(n).max(b.carrier.moved_by(n));
            !(stands(a) || stands(b)) || least <= 1
        };
        let mut always: Vec<bool> = self.pairs.iter().map(may_drop).collect();
        let mut frames = Frames::new(robot, &vec![0.0; n]);
        let mut work = Shapes::default();
        for sample in 0..SAMPLES {
            if !always.iter().any(|a| *a) {
                break;
            }
            let q = spread(bounds, sample);
            frames.update(robot, &q);
            let placed = PlacedParts::new(&self.parts, &frames, &mut work);
            for (pair, always) in self.pairs.iter().zip(&mut always) {
                *always = *always && pair.distance(&placed, f64::INFINITY).0 < clearance;
            }
        }
        let mut remaining = Vec::with_capacity(self.pairs.len());
        for (pair, always) in std::mem::take(&mut self.pairs).into_iter().zip(always) {
            if always { self.dropped.push((pair.mover, pair.solid)) } else { remaining.push(pair) }
        }
        self.pairs = remaining;
    }
}
