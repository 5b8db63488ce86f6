//! What forbids a posture at work: the cell's limits on points, but for the rope, and its shapes.
//! Rope, beams and the torque of the experiment's load belong to the experiment.

use crate::error::Result;
use crate::findings::{Finding, Severity, length};
use crate::model::cell::{Cell, LimitKind, LimitMargin, Limits, Margins};
use crate::model::load::Wrench;
use crate::model::observation::{PostureTerms, Setup};
use crate::model::path::LoadedPosture;
use crate::model::scene::Scene;
use crate::model::tool::NamedPoint;
use crate::numerics::jobs::in_order;
use nalgebra::{Isometry3, Vector3};

/// Limits of a cell at work.
pub(super) struct AtWork {
    /// The cell's tool points with the tip among them.
    setup: Setup,
    limits: Limits,
    scene: Scene,
}

impl AtWork {
    /// The limits of `cell`, whose tool tip is at `tip` in flange axes.
    pub fn new(cell: &Cell, tip: &Isometry3<f64>) -> Self {
        let mut setup = cell.setup.clone();
        if cell.work.tip.is_some() {
            setup.tool.measuring_points.push(NamedPoint {
                name: "tip".to_string(),
                position: tip.translation.vector,
            });
        }
        AtWork {
            setup,
            limits: Limits {
                rope_length: None,
                ..cell.limits.clone()
            },
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
pub(super) fn forbidden<'a>(
    cell: &Cell,
    tip: &Isometry3<f64>,
    postures: impl Iterator<Item = (&'a LoadedPosture, &'a [f64])>,
) -> Result<Option<Finding>> {
    let at_work = AtWork::new(cell, tip);
    let postures: Vec<_> = postures.collect();
    let violated = in_order(&postures, |(_, (_, q))| at_work.violated(q))?;
    let (mut count, of, mut worst) = (0, postures.len(), Severity::Caution);
    let mut first = None;
    for ((posture, _), violated) in postures.iter().zip(violated) {
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
    let line = posture
        .line
        .map_or_else(String::new, |line| format!(" (line {line})"));
    let sentence = format!(
        "{count} of {of} postures {} forbidden by the cell's shapes or limits; the first is point {}{line}: {}.",
        if count == 1 { "is" } else { "are" },
        posture.name,
        AtWork::words(&violated)
    );
    Ok(Some(Finding::new("forbidden", worst, "path", sentence)))
}
