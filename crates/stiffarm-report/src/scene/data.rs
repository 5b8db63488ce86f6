//! The cell in three dimensions as data: what a page needs to draw it, and no pixels.

use super::extras::{ArrowSet, Ellipsoid, ScenePath};
use super::numbers::{Pose, Triple};
use super::solids::solids;
use serde::Serialize;
use stiffarm::model::cell::{LimitKind, LimitMargin};
use stiffarm::model::shape::Solid;
use stiffarm::nalgebra::{Unit, Vector3};
use stiffarm::units::degrees;

/// A cell at groups of postures.
///
/// Lengths are in metres and angles in radians unless a name says otherwise; places are in the base frame, points of
/// the tool in flange axes.
///
/// The joint axis i of a posture is the z axis of link i's frame ([`ScenePosture::links`]), through its origin: a turn
/// about it changes neither. So the arm bent s times as far as by its load has link i at
///
/// ```text
/// E_1(s δθ_1) E_2(s δθ_2) … E_i(s δθ_i) · pose_i
/// ```
///
/// with E_k the turn about the world axis k of the posture (product of exponentials), and δθ the joint turns of
/// [`SceneLoad::turns`]. At s = 1 that is the arm under its load; it stays a rigid chain at any s.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scene {
    /// Name of the cell.
    pub cell: String,
    /// Name of the robot.
    pub robot: String,
    /// Names of the joints.
    pub joints: Vec<String>,
    /// What is known of the arm's shapes.
    pub shapes: ArmShapes,
    /// Links, tool, and what stands in the cell.
    pub bodies: Vec<Body>,
    /// So many of the bodies, the first ones, are the robot's or made up in its proportions; the others are the cell's.
    #[serde(skip)]
    pub robot_bodies: usize,
    /// The flange in the frame of the last link.
    pub flange: Pose,
    /// Measuring points, flange axes.
    pub measuring_points: Vec<NamedPlace>,
    /// The loads, by number of load case; one where there are no cases.
    pub loads: Vec<LoadKind>,
    /// Tracker stations.
    pub stations: Vec<NamedPlace>,
    /// Limits on places.
    pub limits: SceneLimits,
    /// Smallest and largest corner of what must be seen.
    pub extent: [Triple; 2],
    /// From where it is looked at first \[rad\], where the usual perspective has something before the arm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_turn: Option<f64>,
    /// How long a force is drawn.
    pub force_length: f64,
    /// How deflections were calculated: `linear` or `equilibrium`; `None` where no stiffness is known.
    pub model: Option<&'static str>,
    /// What is called the loading point: `tip`; `None` for the loading point itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loaded: Option<&'static str>,
    /// The groups, in the order given.
    pub groups: Vec<Group>,
    /// A path with its deflection.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<ScenePath>,
    /// Arrows at places of postures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arrows: Option<ArrowSet>,
    /// Ellipsoids of stiffness or compliance at postures.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ellipsoids: Vec<Ellipsoid>,
}

impl Scene {
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
                    load.deflection = vec![*shift];
                }
            }
        }
        self
    }

    /// The bodies of the cell with their numbers, without those that only three dimensions show.
    pub(crate) fn parts(&self) -> impl Iterator<Item = (usize, &Body)> + Clone {
        self.bodies.iter().enumerate().skip(self.robot_bodies)
    }

    /// The postures of all groups.
    pub(crate) fn postures(&self) -> impl Iterator<Item = &ScenePosture> {
        self.groups.iter().flat_map(|group| &group.postures)
    }

    /// Where the ropes end.
    pub(crate) fn anchors(&self) -> impl Iterator<Item = Vector3<f64>> {
        self.loads.iter().filter_map(|load| load.anchor.map(Vector3::from))
    }
}

/// Where the arm's shapes come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmShapes {
    /// The cell's or the robot's own.
    Own,
    /// Tubes from joint to joint in the robot's proportions, because no shapes are known.
    Tubes,
}

/// What a body is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyKind {
    /// A link, the base among them.
    Arm,
    /// A shape of the tool.
    Tool,
    /// What stands in the cell.
    Standing,
}

/// Solids that move together under one name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: BodyKind,
    /// Number of the link whose frame its solids are in: 0 is the base frame, one more than the joints the flange.
    pub carrier: usize,
    /// Its solids in that frame \[m\].
    #[serde(serialize_with = "solids")]
    pub solids: Vec<Solid>,
}

/// A place and its name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NamedPlace {
    /// The name.
    pub name: String,
    /// The place.
    pub at: Triple,
}

/// A load, whatever the posture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoadKind {
    /// Name of the load case; empty for a single load.
    pub name: String,
    /// `rope`, `weight`, `wrench` or `measured`; `at work` for the wrenches of a path.
    pub kind: &'static str,
    /// Loading point, flange axes.
    pub at: Triple,
    /// Where a rope ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anchor: Option<Triple>,
}

/// Limits on places; `None` leaves a limit out.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct SceneLimits {
    /// Box for the points of the tool.
    pub tool_box: Option<[Triple; 2]>,
    /// Lowest z of the points of the tool.
    pub floor: Option<f64>,
    /// Lowest z of the wrist centre.
    pub wrist_height: Option<f64>,
    /// The cylinder about axis 1 that they stay out of.
    pub keep_out: Option<KeepOut>,
    /// The cone about an axis from each anchor in which the loading device may act, and its half angle.
    #[serde(skip)]
    pub rope_cone: Option<(Unit<Vector3<f64>>, f64)>,
}

impl SceneLimits {
    /// The limits that are heights.
    pub(crate) fn levels(&self) -> impl Iterator<Item = (LimitKind, f64)> + use<> {
        let levels = [(LimitKind::Floor, self.floor), (LimitKind::WristHeight, self.wrist_height)];
        levels.into_iter().filter_map(|(kind, height)| Some((kind, height?)))
    }
}

/// A cylinder without end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KeepOut {
    /// A point on its axis.
    pub origin: Triple,
    /// Direction of its axis.
    pub axis: Triple,
    /// Its radius.
    pub radius: f64,
}

/// Postures that are shown together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    /// Its name.
    pub name: String,
    /// Its colour as `#rrggbb`, the same as in figures.
    pub colour: &'static str,
    /// Its postures, in the order they are measured.
    pub postures: Vec<ScenePosture>,
}

/// The cell at one posture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScenePosture {
    /// Its name.
    pub name: String,
    /// Controller angles \[rad\].
    #[serde(rename = "angles_deg", with = "degrees")]
    pub q: Vec<f64>,
    /// Frame of each link, unloaded.
    pub links: Vec<Pose>,
    /// What each load does, by number of load case; empty where the load is not known.
    pub loads: Vec<SceneLoad>,
    /// Numbers of the measuring points that each station sees.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub seen: Vec<Vec<usize>>,
    /// Number of the station that sees most.
    #[serde(skip)]
    pub best_station: Option<usize>,
    /// The two bodies that come nearest to each other.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closest: Option<Closest>,
    /// How near each limit is.
    #[serde(skip)]
    pub margins: Vec<LimitMargin>,
    /// How much room the limits leave, in words, each unit's smallest; `None` without limits.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub room: Option<String>,
    /// A sentence for each violated limit, the first few of them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub violated: Vec<String>,
    /// Numbers of the bodies that a limit is violated at.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub caution: Vec<usize>,
}

/// A load at a posture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneLoad {
    /// Force on the robot \[N\].
    pub force: Triple,
    /// Moment about the loading point \[N·m\].
    pub moment: Triple,
    /// Turns of the joints under it \[rad\]; `None` where no stiffness is known or the arm finds no equilibrium.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turns: Option<Vec<f64>>,
    /// Deflection of the loading point, then of the measuring points \[m\], from the joints alone.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub deflection: Vec<Triple>,
}

/// The two bodies that come nearest to each other at a posture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Closest {
    /// Their names.
    pub names: [String; 2],
    /// Distance between their surfaces, negative where they overlap.
    pub distance: f64,
    /// The nearest point of each surface.
    pub points: [Triple; 2],
}
