//! The links and joints of a URDF, as far as kinematics and collisions need them.
//!
//! What says nothing of either, such as `visual`, `inertial` or `transmission`, is not looked at; its faults are none
//! here.

use super::angles::in_degrees;
use super::source::{Element, Source};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use stiffarm::error::{Code, Result, did_you_mean};

/// A robot of a URDF.
pub(super) struct Robot {
    /// Its name; empty where it has none.
    pub(super) name: String,
    pub(super) links: Vec<Link>,
    pub(super) joints: Vec<Joint>,
}

/// A link.
pub(super) struct Link {
    pub(super) name: String,
    pub(super) collisions: Vec<Collision>,
}

/// A collision shape of a link.
pub(super) struct Collision {
    /// Its frame in the link's \[m\].
    pub(super) origin: Isometry3<f64>,
    pub(super) geometry: CollisionGeometry,
}

/// Geometry of a shape in its own frame \[m\].
#[derive(Debug, Clone, PartialEq)]
pub enum CollisionGeometry {
    /// A mesh.
    Mesh {
        /// Its file as the URDF names it; [`MeshFolders::find`](super::MeshFolders::find)
        /// says where that is.
        path: String,
        /// Factors on the mesh's x, y, z, which then are in m.
        scale: [f64; 3],
    },
    /// A box about the frame's origin.
    Box {
        /// Lengths of the whole edges along x, y, z \[m\].
        size: [f64; 3],
    },
    /// A cylinder about z, its middle at the origin.
    Cylinder {
        /// Radius \[m\].
        radius: f64,
        /// Whole length \[m\].
        length: f64,
    },
    /// A cylinder about z with half a ball on each end, its middle at the origin.
    Capsule {
        /// Radius \[m\].
        radius: f64,
        /// Length of the cylinder, without the balls \[m\].
        length: f64,
    },
    /// A ball about the origin.
    Sphere {
        /// Radius \[m\].
        radius: f64,
    },
}

/// A joint.
pub(super) struct Joint {
    pub(super) name: String,
    pub(super) kind: JointKind,
    /// The link above it.
    pub(super) parent: String,
    /// The link below it.
    pub(super) child: String,
    /// Its frame in that of the link above \[m\].
    pub(super) origin: Isometry3<f64>,
    /// Its axis in its own frame, of any length.
    pub(super) axis: Vector3<f64>,
    pub(super) limit: Limit,
    pub(super) mimic: Option<Mimic>,
}

/// Types of joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum JointKind {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
    Floating,
    Planar,
    Spherical,
}

const JOINT_KINDS: [(&str, JointKind); 7] = [
    ("revolute", JointKind::Revolute),
    ("continuous", JointKind::Continuous),
    ("prismatic", JointKind::Prismatic),
    ("fixed", JointKind::Fixed),
    ("floating", JointKind::Floating),
    ("planar", JointKind::Planar),
    ("spherical", JointKind::Spherical),
];

/// Shapes of collision geometry.
const SHAPES: [&str; 5] = ["box", "cylinder", "capsule", "sphere", "mesh"];

/// Limits of a joint.
#[derive(Default)]
pub(super) struct Limit {
    /// Whether the file gives any.
    pub(super) is_given: bool,
    /// Lower limit \[rad, for joints that turn\].
    pub(super) lower: f64,
    /// Upper limit \[rad, for joints that turn\].
    pub(super) upper: f64,
    /// Largest speed \[rad/s, for joints that turn\]; zero where there is none.
    pub(super) velocity: f64,
    /// Largest moment \[N·m, for joints that turn\]; zero where there is none.
    pub(super) effort: f64,
}

/// What a joint follows: its angle is `multiplier` times that of `joint`, plus `offset`.
pub(super) struct Mimic {
    pub(super) joint: String,
    pub(super) multiplier: f64,
    pub(super) offset: f64,
}

impl Robot {
    /// Reads the links and joints.
    ///
    /// # Errors
    /// What an element lacks, has twice, or has of another kind.
    pub(super) fn new(source: &Source<'_>) -> Result<Self> {
        let root = source.root();
        let links = source.children(root, "link").map(|e| link(source, e));
        let links = links.collect::<Result<_>>()?;
        let joints = source.children(root, "joint").map(|e| joint(source, e));
        Ok(Robot {
            name: root.attribute("name").unwrap_or_default().to_string(),
            links,
            joints: joints.collect::<Result<_>>()?,
        })
    }
}

fn link(source: &Source<'_>, element: Element<'_>) -> Result<Link> {
    let name = source.required(element, "name")?.to_string();
    let collisions = source.children(element, "collision");
    let collisions = collisions.map(|e| collision(source, e)).collect::<Result<_>>()?;
    Ok(Link { name, collisions })
}

fn collision(source: &Source<'_>, element: Element<'_>) -> Result<Collision> {
    let origin = origin(source, element)?;
    let geometry = source.child(element, "geometry")?.ok_or_else(|| {
        let error = source.error(element, Code::Urdf, "<collision> has no <geometry>.");
        error.hint("a <collision> has a <geometry> with a shape in it")
    })?;
    let geometry = shape(source, geometry)?;
    Ok(Collision { origin, geometry })
}

/// The one shape of a `geometry`.
fn shape(source: &Source<'_>, element: Element<'_>) -> Result<CollisionGeometry> {
    let mut shapes = SHAPES.iter().flat_map(|name| source.children(element, name));
    let (Some(shape), None) = (shapes.next(), shapes.next()) else {
        let message = "<geometry> must have one shape in it.";
        let error = source.error(element, Code::Urdf, message);
        return Err(error.hint(format!("one of {}", SHAPES.join(", "))));
    };
    let length = |name| source.required_numbers(shape, name, "m").map(|[value]| value);
    Ok(match shape.tag_name().name() {
        "box" => CollisionGeometry::Box { size: source.required_numbers(shape, "size", "m")? },
        "cylinder" => CollisionGeometry::Cylinder { radius: length("radius")?, length: length("length")? },
        "capsule" => CollisionGeometry::Capsule { radius: length("radius")?, length: length("length")? },
        "sphere" => CollisionGeometry::Sphere { radius: length("radius")? },
        _ => CollisionGeometry::Mesh {
            path: source.required(shape, "filename")?.to_string(),
            scale: source.numbers(shape, "scale", "")?.unwrap_or([1.0; 3]),
        },
    })
}

/// The pose that an element's `origin` gives, else none \[m\]: turns about fixed x, then y, then z.
fn origin(source: &Source<'_>, element: Element<'_>) -> Result<Isometry3<f64>> {
    let Some(origin) = source.child(element, "origin")? else {
        return Ok(Isometry3::identity());
    };
    if origin.has_attribute("quat_xyzw") {
        let message = "An origin with quat_xyzw is not supported.";
        let error = source.error(origin, Code::Unsupported, message);
        return Err(error.hint("write its rotation as rpy"));
    }
    let [x, y, z] = source.numbers(origin, "xyz", "m")?.unwrap_or_default();
    let rpy: [f64; 3] = source.numbers(origin, "rpy", "rad")?.unwrap_or_default();
    if let Some((far, hint)) = in_degrees(&rpy) {
        let message = format!("An origin is turned by {far} rad: are these degrees?");
        let error = source.error(origin, Code::InvalidValue, message);
        return Err(error.key("origin rpy").hint(hint));
    }
    let [roll, pitch, yaw] = rpy;
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Ok(Isometry3::from_parts(Translation3::new(x, y, z), rotation))
}

fn joint(source: &Source<'_>, element: Element<'_>) -> Result<Joint> {
    let name = source.required(element, "name")?.to_string();
    let kind = source.required(element, "type")?;
    let joint_kind = JOINT_KINDS.iter().find(|(name, _)| *name == kind);
    let Some((_, kind)) = joint_kind else {
        let names = JOINT_KINDS.map(|(name, _)| name);
        let message = format!("There is no joint type \"{kind}\".");
        let hint = did_you_mean(kind, names).unwrap_or_else(|| names.join(", "));
        return Err(source.error(element, Code::Urdf, message).hint(hint));
    };
    let linked = |end: &str| {
        let Some(end) = source.child(element, end)? else {
            let message = format!("The joint \"{name}\" has no <{end}>.");
            let error = source.error(element, Code::Urdf, message);
            return Err(error.hint("a <joint> has a <parent> and a <child>"));
        };
        source.required(end, "link").map(str::to_string)
    };
    let (parent, child) = (linked("parent")?, linked("child")?);
    let axis = match source.child(element, "axis")? {
        Some(axis) => source.required_numbers(axis, "xyz", "direction")?,
        None => [1.0, 0.0, 0.0],
    };
    let mimic = source.child(element, "mimic")?;
    Ok(Joint {
        kind: *kind,
        parent,
        child,
        origin: origin(source, element)?,
        axis: Vector3::from(axis),
        limit: limit(source, element)?,
        mimic: mimic.map(|e| self::mimic(source, e)).transpose()?,
        name,
    })
}

fn limit(source: &Source<'_>, joint: Element<'_>) -> Result<Limit> {
    let Some(limit) = source.child(joint, "limit")? else {
        return Ok(Limit::default());
    };
    let [lower, upper, velocity] = ["lower", "upper", "velocity"].map(|name| source.number(limit, name, ""));
    let (lower, upper, velocity) = (lower?, upper?, velocity?);
    // From version 1.2 on, what is left out has no limit.
    let is_newer = is_from_1_2_on(source.root());
    if velocity.is_none() && !is_newer {
        let error = source.error(limit, Code::Urdf, "<limit> has no velocity.");
        return Err(error.hint("a <limit> has lower, upper, effort and velocity"));
    }
    let [lowest, highest] = if is_newer { [f64::NEG_INFINITY, f64::INFINITY] } else { [0.0; 2] };
    Ok(Limit {
        is_given: lower.is_some() || upper.is_some(),
        lower: lower.unwrap_or(lowest),
        upper: upper.unwrap_or(highest),
        velocity: velocity.unwrap_or(highest),
        // It only tells a gripper from an arm.
        effort: limit.attribute("effort").and_then(|text| text.trim().parse().ok()).unwrap_or(0.0),
    })
}

/// Whether a robot is written in URDF 1.2 or later; one that does not say is not.
fn is_from_1_2_on(root: Element<'_>) -> bool {
    let version = root.attribute("version").and_then(|text| {
        let (major, minor) = text.trim().split_once('.')?;
        Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?))
    });
    version >= Some((1, 2))
}

fn mimic(source: &Source<'_>, element: Element<'_>) -> Result<Mimic> {
    Ok(Mimic {
        joint: source.required(element, "joint")?.to_string(),
        multiplier: source.number(element, "multiplier", "")?.unwrap_or(1.0),
        offset: source.number(element, "offset", "")?.unwrap_or(0.0),
    })
}
