//! What forbids a posture at work: the cell's limits on points, but for the rope, and its shapes;
//! where postures are chosen, the cell's bounds as well. Rope, beams and the torque of the
//! experiment's load belong to the experiment.

use crate::error::Result;
use crate::findings::{Finding, Severity, length};
use crate::model::cell::{Cell, LimitKind, LimitMargin, Limits, Margins};
use crate::model::load::Wrench;
use crate::model::observation::{PostureTerms, Setup};
use crate::model::path::LoadedPosture;
use crate::model::robot::Robot;
use crate::model::scene::Scene;
use crate::model::tool::NamedPoint;
use crate::numerics::control::Control;
use crate::numerics::jobs::in_blocks;
use crate::units::rad_to_deg;
use nalgebra::{Isometry3, Vector3};

/// Limits of a cell at work.
#[derive(Debug, Clone)]
pub(super) struct AtWork {
    /// The cell's tool points with the tip among them.
    setup: Setup,
    /// The robot with the cell's bounds as limits.
    robot: Robot,
    limits: Limits,
    scene: Scene,
}

impl AtWork {
    /// The limits of `cell`, whose tool tip is at `tip` in flange axes.
    pub fn new(cell: &Cell, tip: &Isometry3<f64>) -> Self {
        let mut setup = cell.setup.clone();
        if cell.work.tip.is_some() {
            setup.tool.measuring_points.push(NamedPoint { name: "tip".to_string(), position: tip.translation.vector });
        }
        AtWork {
            setup,
            robot: cell.robot_within_bounds(),
            limits: Limits { rope_length: None, ..cell.limits.clone() },
            scene: cell.scene.at_work(),
        }
    }

    /// The limits, ready to be looked at posture by posture.
    pub fn limits(&self) -> LimitsAtWork<'_> {
        LimitsAtWork {
            margins: Margins::new(&self.setup, &self.limits, &self.scene),
            terms: PostureTerms::memory(&self.setup),
            are_none: self.limits.is_empty() && self.scene.is_empty(),
        }
    }

    /// The robot with the cell's bounds as limits.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// As [`LimitsAtWork::violated`].
    pub fn violated(&self, q: &[f64]) -> Result<Option<LimitMargin>> {
        self.limits().violated(q)
    }

    /// As [`LimitsAtWork::lacks_room`].
    pub fn lacks_room(&self, q: &[f64]) -> Result<f64> {
        self.limits().lacks_room(q)
    }

    /// The same of the bounds, in whole millionths of a radian.
    pub fn beyond_bounds(&self, q: &[f64]) -> f64 {
        let outside = self.outside(q).map_or(0.0, |(_, excess)| excess);
        (1e6 * outside).ceil()
    }

    /// The joint that leaves the bounds most, and by how much \[rad\].
    pub fn outside(&self, q: &[f64]) -> Option<(usize, f64)> {
        self.robot.outside_limits(q)?;
        let joints = self.robot.joints().iter().zip(q).enumerate();
        let excess = joints.map(|(j, (joint, q))| {
            let [low, high] = joint.limits;
            (j, (low - q).max(q - high))
        });
        excess.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// What [`AtWork::outside`] says: `joint 4 would leave the cell's bounds by 3.1°`.
    pub fn outside_words(&self, (joint, excess): (usize, f64)) -> String {
        let (bounded, machine) = (&self.robot.joints()[joint], &self.setup.robot.joints()[joint]);
        let of = if bounded.limits == machine.limits { "its limits" } else { "the cell's bounds" };
        format!("{} would leave {of} by {:.1}°", bounded.name, rad_to_deg(excess))
    }

    /// Why `q` is not allowed, as a clause, if it is not.
    pub fn why_not(&self, q: &[f64]) -> Result<Option<String>> {
        let violated = self.violated(q)?.map(|violated| AtWork::words(&violated));
        let outside = || self.outside(q).map(|outside| self.outside_words(outside));
        Ok(violated.or_else(outside))
    }

    /// What a violated limit says of a posture: `its tip violates the floor by 12 mm`.
    pub fn words(violated: &LimitMargin) -> String {
        match violated.kind {
            LimitKind::Shapes => format!("it {}", violated.violation()),
            _ => {
                let point = violated.point.as_str();
                let point = point.strip_suffix(" tip").map_or(point, |_| "tip");
                let by = length(-violated.margin);
                format!("its {point} violates {} by {by}", violated.kind.describe())
            }
        }
    }
}

/// The limits of a cell at work at one posture after another.
pub(super) struct LimitsAtWork<'a> {
    margins: Margins<'a>,
    terms: PostureTerms,
    are_none: bool,
}

impl LimitsAtWork<'_> {
    /// The limit that the posture `q` violates most, if any.
    pub fn violated(&mut self, q: &[f64]) -> Result<Option<LimitMargin>> {
        if self.are_none {
            return Ok(None);
        }
        let unloaded = Wrench::force(Vector3::zeros());
        self.terms.move_to(self.margins.setup(), q, Some(&unloaded))?;
        if self.margins.least(&self.terms) >= 0.0 {
            return Ok(None);
        }
        // Names only for those that need words.
        Ok(self.margins.smallest(&self.terms).filter(LimitMargin::is_violated))
    }

    /// How far limits and shapes are from allowing `q`, whatever the full turns of its joints: whole
    /// micrometres, since rounding must not choose between postures; 0 where they allow it.
    pub fn lacks_room(&mut self, q: &[f64]) -> Result<f64> {
        let violated = self.violated(q)?.map_or(0.0, |violated| -violated.margin);
        Ok((1e6 * violated).ceil())
    }
}

/// A finding where postures of a path or a task are forbidden, with the first of them and its line:
/// serious where shapes would collide.
///
/// # Errors
/// Angles of the wrong number or not finite; interrupted.
pub(super) fn forbidden(at_work: &AtWork, postures: &[LoadedPosture], control: Control<'_>) -> Result<Option<Finding>> {
    let violated = in_blocks(postures, "limits and shapes", control.quiet(), |_, block| {
        let mut limits = at_work.limits();
        block.iter().map(|posture| limits.violated(&posture.q)).collect()
    })?;
    let (mut count, of, mut worst) = (0, postures.len(), Severity::Caution);
    let mut first = None;
    for (posture, violated) in postures.iter().zip(violated) {
        let Some(violated) = violated else {
            continue;
        };
        count += 1;
        if violated.kind == LimitKind::Shapes {
            worst = Severity::Serious;
        }
        first.get_or_insert((posture, violated));
    }
    let Some((posture, violated)) = first else {
        return Ok(None);
    };
    let line = posture.line.map_or_else(String::new, |line| format!(" (line {line})"));
    let sentence = format!(
        "{count} of {of} postures {} forbidden by the cell's shapes or limits; the first is point {}{line}: {}.",
        if count == 1 { "is" } else { "are" },
        posture.name,
        AtWork::words(&violated)
    );
    Ok(Some(Finding::new("forbidden", worst, "path", sentence)))
}
