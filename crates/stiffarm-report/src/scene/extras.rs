//! What may be shown with a cell: a path, arrows at places, ellipsoids.

use super::data::{Scene, Triple};
use super::numbers::{digits, length};
use serde::Serialize;

/// A path with its deflection, in colour by a size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScenePath {
    /// What it is: `seam`, `contour`.
    pub name: String,
    /// Its points, base frame \[m\].
    pub points: Vec<Triple>,
    /// Deflection of each point, base axes \[m\]; empty where none is shown.
    pub deflection: Vec<Triple>,
    /// Size of each point that its colour shows.
    pub size: Vec<f64>,
    /// What the size is: `deflection`.
    pub label: String,
    /// Unit of the size: `mm`.
    pub unit: String,
    /// Sizes of the first and the last colour.
    pub range: [f64; 2],
    /// Names of the points; empty where they have none.
    pub names: Vec<String>,
}

/// Arrows of one kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArrowSet {
    /// What they are: `residual`.
    pub label: String,
    /// The arrows.
    pub arrows: Vec<Arrow>,
}

/// An arrow at a place of a posture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Arrow {
    /// Number of the group.
    pub group: usize,
    /// Number of the posture in its group.
    pub posture: usize,
    /// What it is about: a measuring point's name.
    pub name: String,
    /// Where it begins, base frame \[m\].
    pub at: Triple,
    /// What it shows, base axes \[m\]; drawn larger by a factor of its own.
    pub vector: Triple,
}

/// An ellipsoid at a posture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ellipsoid {
    /// Number of the group.
    pub group: usize,
    /// Number of the posture in its group.
    pub posture: usize,
    /// Its centre, base frame \[m\].
    pub centre: Triple,
    /// Directions of its axes, base axes.
    pub axes: [Triple; 3],
    /// Half its size along each axis, in any one unit; drawn in proportion.
    pub half: Triple,
    /// What it shows, with numbers and unit.
    pub text: String,
}

impl Scene {
    /// The same with a path.
    #[must_use]
    pub fn with_path(mut self, path: ScenePath) -> Self {
        self.path = Some(ScenePath {
            points: path.points.iter().map(|p| p.map(length)).collect(),
            deflection: path.deflection.iter().map(|d| d.map(digits)).collect(),
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
        self.arrows = Some(ArrowSet {
            label: label.into(),
            arrows: arrows.collect(),
        });
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
