//! What may be shown with a cell: a path, arrows at places, ellipsoids.

use super::numbers::Triple;
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
    /// How far from each point it is commanded, base axes \[m\]; empty where it is commanded as it is.
    pub correction: Vec<Triple>,
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
