//! What a posture must not touch and must not hide: the arm's own links, its tool, what
//! stands around, the rope, the tracker's beams, the torque a joint may carry, and how far the load
//! may move the measuring points.
//!
//! Each is a margin with its derivative by the joint angles, as the limits on points are
//! ([`Limits`](crate::model::cell::Limits)), so every search respects it. Shapes are judged as they are drawn:
//! a cylinder has flat ends.

mod build;
mod closest;
mod displacement;
mod margins;
mod pairs;
mod part;
mod placed_parts;
mod rope;
mod sight;
mod slope;
mod torque;
mod work;

pub use build::SceneParts;
pub use closest::ClosestPair;
pub use displacement::DisplacementLimits;
pub use margins::SceneMargin;
pub use part::{Carrier, Part};
pub use rope::RopeRules;
pub use sight::{Facing, SeenFrom, Sight, Station};
pub use torque::TorqueLimits;
pub(crate) use work::Work;

use crate::model::limit::LimitKind;
use crate::model::load::Load;
use crate::model::observation::Setup;
use pairs::Pair;

/// Shapes of arm, tool and surroundings with what is asked of them. Empty: nothing is.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    parts: Vec<Part>,
    /// Distance kept between two parts \[m\].
    clearance: f64,
    pairs: Vec<Pair>,
    dropped: Vec<(usize, usize)>,
    rope: Option<RopeRules>,
    sight: Option<Sight>,
    torque: Option<TorqueLimits>,
    displacement: Option<DisplacementLimits>,
}

impl Scene {
    /// True where nothing is asked.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
            && self.rope.is_none()
            && self.sight.is_none()
            && self.torque.is_none()
            && self.displacement.is_none()
    }

    /// Parts of arm and tool, and what stands around.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Distance kept between two parts \[m\].
    pub fn clearance(&self) -> f64 {
        self.clearance
    }

    /// Names of the two parts of each pair that is kept apart.
    pub fn pairs(&self) -> impl Iterator<Item = (&str, &str)> {
        self.pairs.iter().map(|p| (self.name(p.mover), self.name(p.solid)))
    }

    /// Pairs that are too near in every posture, by how their shapes are drawn, and so are not kept apart.
    pub fn dropped_pairs(&self) -> impl Iterator<Item = (&str, &str)> {
        self.dropped.iter().map(|(a, b)| (self.name(*a), self.name(*b)))
    }

    /// What is asked of the rope.
    pub fn rope(&self) -> Option<&RopeRules> {
        self.rope.as_ref()
    }

    /// What is asked of the tracker's beams.
    pub fn sight(&self) -> Option<&Sight> {
        self.sight.as_ref()
    }

    /// What the joints may carry.
    pub fn torque(&self) -> Option<&TorqueLimits> {
        self.torque.as_ref()
    }

    /// How far the load may move the measuring points.
    pub fn displacement(&self) -> Option<&DisplacementLimits> {
        self.displacement.as_ref()
    }

    /// What is left of it at work: shapes that must not touch. Rope, beams, and the torque and
    /// displacement of the experiment's load belong to the experiment.
    #[must_use]
    pub fn at_work(&self) -> Self {
        Scene { rope: None, sight: None, torque: None, displacement: None, ..self.clone() }
    }

    /// What is left of it on the way from posture to posture, where less room will do: shapes, and the
    /// rope where it stays on, keep half their distance. Beams, torques and displacements are of the reading.
    #[must_use]
    pub fn on_the_way(&self, load_stays_on: bool) -> Self {
        let rope = self.rope.as_ref().filter(|_| load_stays_on);
        let rope = rope.filter(|rope| rope.clearance.is_some());
        Scene {
            clearance: 0.5 * self.clearance,
            rope: rope.map(|rope| RopeRules {
                clearance: rope.clearance.map(|clearance| 0.5 * clearance),
                cone: None,
                ..rope.clone()
            }),
            ..self.at_work()
        }
    }

    /// Most that any point of arm and tool moves by a turn of each serial joint \[m/rad\].
    pub(crate) fn reach(&self, setup: &Setup) -> Vec<f64> {
        work::reach(self, setup)
    }

    /// Whether a limit of this kind is asked for and holds under `load`.
    pub(crate) fn has(&self, kind: LimitKind, load: &Load) -> bool {
        let rope = self.rope.as_ref().filter(|_| load.has_rope());
        let faces = |sight: &Sight| sight.facings.iter().any(Option::is_some);
        match kind {
            LimitKind::Shapes => !self.pairs.is_empty(),
            LimitKind::RopeClearance => rope.is_some_and(|rope| rope.clearance.is_some()),
            LimitKind::RopeCone => rope.is_some_and(|rope| rope.cone.is_some()),
            LimitKind::Incidence => self.sight.as_ref().is_some_and(faces),
            LimitKind::Sight => self.sight.is_some(),
            LimitKind::Torque => self.torque.is_some(),
            _ => {
                let limits = self.displacement.as_ref();
                limits.is_some_and(|limits| limits.kinds().any(|other| other == kind))
            }
        }
    }

    /// The same scene without what `kind` asks: what that costs a plan is the difference.
    #[must_use]
    pub fn without(&self, kind: LimitKind) -> Self {
        let mut scene = self.clone();
        match kind {
            LimitKind::Shapes => scene.pairs.clear(),
            LimitKind::RopeClearance | LimitKind::RopeCone => {
                if let Some(rope) = &mut scene.rope {
                    match kind {
                        LimitKind::RopeCone => rope.cone = None,
                        _ => rope.clearance = None,
                    }
                    if rope.cone.is_none() && rope.clearance.is_none() {
                        scene.rope = None;
                    }
                }
            }
            LimitKind::Sight => scene.sight = None,
            LimitKind::Incidence => {
                if let Some(sight) = &mut scene.sight {
                    sight.facings.fill(None);
                }
            }
            LimitKind::Torque => scene.torque = None,
            LimitKind::SmallestDisplacement | LimitKind::LargestDisplacement => {
                let limits = scene.displacement.take();
                scene.displacement = limits.and_then(|limits| limits.without(kind));
            }
            _ => {}
        }
        scene
    }

    /// The same without several kinds of limit.
    pub(crate) fn without_all(&self, kinds: &[LimitKind]) -> Self {
        let without = |scene: Scene, kind: &_| scene.without(*kind);
        kinds.iter().fold(self.clone(), without)
    }

    fn name(&self, part: usize) -> &str {
        &self.parts[part].name
    }
}
