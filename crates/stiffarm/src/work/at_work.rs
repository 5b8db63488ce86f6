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
use crate::numerics::jobs::in_order;
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

    /// The limit that the posture `q` violates most, if any.
    pub fn violated(&self, q: &[f64]) -> Result<Option<LimitMargin>> {
        if self.limits.is_empty() && self.scene.is_empty() {
            return Ok(None);
        }
        let unloaded = Wrench::force(Vector3::zeros());
        let terms = PostureTerms::new(&self.setup, q, Some(&unloaded))?;
        let mut margins = Margins::new(&self.setup, &self.limits, &self.scene);
        if margins.least(&terms) >= 0.0 {
            return Ok(None);
        }
        // Names only for those that need words.
        Ok(margins.smallest(&terms).filter(LimitMargin::is_violated))
    }

    /// The robot with the cell's bounds as limits.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// How far limits and shapes are from allowing `q`, whatever the full turns of its joints: whole
    /// micrometres, since rounding must not choose between postures; 0 where they allow it.
    pub fn lacks_room(&self, q: &[f64]) -> Result<f64> {
        let violated = self.violated(q)?.map_or(0.0, |violated| -violated.margin);
        Ok((1e6 * violated).ceil())
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

/// A finding where postures of a path or a task are forbidden, with the first of them and its line:
/// serious where shapes would collide.
///
/// # Errors
/// Angles of the wrong number or not finite.
pub(super) fn forbidden(at_work: &AtWork, postures: &[LoadedPosture]) -> Result<Option<Finding>> {
    let violated = in_order(postures, |(_, posture)| at_work.violated(&posture.q))?;
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
