//! Solids as JSON.

use super::numbers::{Pose, Triple, pose};
use serde::{Serialize, Serializer};
use stiffarm::model::shape::{Capsule, Solid};

/// A solid in the frame of its body's carrier.
#[derive(Serialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
enum SceneSolid {
    /// A cylinder with half spheres at its ends.
    Capsule { a: Triple, b: Triple, radius: f64 },
    /// A box about the origin of its pose.
    Block { pose: Pose, half: Triple },
    /// A cylinder about the z axis of its pose.
    Cylinder { pose: Pose, half_length: f64, radius: f64 },
    /// Everything behind a plane.
    Plane { point: Triple, normal: Triple },
}

pub(super) fn solids<S: Serializer>(solids: &[Solid], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(solids.iter().map(|solid| match *solid {
        Solid::Capsule(Capsule { a, b, radius }) => SceneSolid::Capsule { a: a.into(), b: b.into(), radius },
        Solid::Block { pose: at, half } => SceneSolid::Block { pose: pose(&at), half: half.into() },
        Solid::Cylinder { pose: at, half_length, radius } => {
            SceneSolid::Cylinder { pose: pose(&at), half_length, radius }
        }
        Solid::HalfSpace { point, normal } => {
            SceneSolid::Plane { point: point.into(), normal: normal.into_inner().into() }
        }
    }))
}
