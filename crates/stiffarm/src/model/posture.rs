//! Postures and named groups of them.

/// One posture: controller angles q \[rad\] under a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Posture {
    /// Name used in tables and files.
    pub name: String,
    /// Controller angles \[rad\], one per joint.
    pub q: Vec<f64>,
}

impl AsRef<[f64]> for Posture {
    fn as_ref(&self) -> &[f64] {
        &self.q
    }
}

/// Angles nearer to each other are those of one posture \[rad\].
const SAME_ANGLE: f64 = 1e-3;

/// Whether the same posture was driven to, as far as a controller repeats it.
pub(crate) fn is_same_posture(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME_ANGLE)
}

/// A named list of postures that are measured together.
#[derive(Debug, Clone, PartialEq)]
pub struct PostureGroup {
    /// Name, for example `Group 1`.
    pub name: String,
    /// The postures, in the order they are measured.
    pub postures: Vec<Posture>,
}

impl PostureGroup {
    /// A group from controller angles \[rad\], postures named `1`, `2`, ….
    pub fn from_angles(name: impl Into<String>, angles: impl IntoIterator<Item = Vec<f64>>) -> Self {
        let postures = angles.into_iter().enumerate().map(|(i, q)| Posture { name: (i + 1).to_string(), q }).collect();
        PostureGroup { name: name.into(), postures }
    }

    /// A group from controller angles \[rad\] and the names of its postures; one without a name has its number.
    pub fn named(name: impl Into<String>, names: &[String], angles: impl IntoIterator<Item = Vec<f64>>) -> Self {
        let mut group = PostureGroup::from_angles(name, angles);
        for (posture, name) in group.postures.iter_mut().zip(names) {
            posture.name.clone_from(name);
        }
        group
    }
}
