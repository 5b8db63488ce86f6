//! A scene with a path, arrows or ellipsoids.

use super::data::Scene;
use super::extras::{Arrow, ArrowSet, Ellipsoid, ScenePath};
use super::numbers::{Triple, digits, length};

impl Scene {
    /// The same with a path.
    #[must_use]
    pub fn with_path(mut self, path: ScenePath) -> Self {
        self.path = Some(ScenePath {
            points: path.points.iter().map(|p| p.map(length)).collect(),
            deflection: path.deflection.iter().map(|d| d.map(digits)).collect(),
            correction: path.correction.iter().map(|d| d.map(digits)).collect(),
            size: path.size.iter().copied().map(digits).collect(),
            range: path.range.map(digits),
            ..path
        });
        self
    }

    /// The same at work: its loading point is the tool tip, which moves by these shifts \[m\] posture by posture, and
    /// not by the joints alone; group by group. What the measuring points do is left out.
    #[must_use]
    pub fn at_work(mut self, shifts: &[Vec<Triple>]) -> Self {
        self.loaded = Some("tip");
        for load in &mut self.loads {
            load.kind = "at work";
        }
        for (group, shifts) in self.groups.iter_mut().zip(shifts) {
            for (posture, shift) in group.postures.iter_mut().zip(shifts) {
                for load in &mut posture.loads {
                    load.deflection = vec![shift.map(digits)];
                }
            }
        }
        self
    }

    /// The same with arrows, for example the residuals at the measuring points.
    #[must_use]
    pub fn with_arrows(mut self, label: impl Into<String>, arrows: Vec<Arrow>) -> Self {
        let arrows = arrows.into_iter().map(|arrow| Arrow {
            at: arrow.at.map(length),
            vector: arrow.vector.map(digits),
            ..arrow
        });
        self.arrows = Some(ArrowSet { label: label.into(), arrows: arrows.collect() });
        self
    }

    /// The same with ellipsoids.
    #[must_use]
    pub fn with_ellipsoids(mut self, ellipsoids: Vec<Ellipsoid>) -> Self {
        let ellipsoids = ellipsoids.into_iter().map(|one| Ellipsoid {
            centre: one.centre.map(length),
            axes: one.axes.map(|axis| axis.map(digits)),
            half: one.half.map(digits),
            ..one
        });
        self.ellipsoids = ellipsoids.collect();
        self
    }
}
