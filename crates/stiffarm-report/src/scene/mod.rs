//! A cell at postures as data, and the script that shows it in three dimensions on a page.
//!
//! [`scene`] asks the library about every posture once; page and [`Scene::drawing`] compute nothing but where to draw.
//! The script is three.js and `assets/viewer/`, joined as [`VIEWER_SCRIPT`]; `assets/README.md` says where three.js
//! comes from.

pub(crate) mod arm;
mod bodies;
pub(crate) mod corners;
mod data;
mod extras;
pub(crate) mod first_look;
mod html;
pub(crate) mod limits;
mod numbers;
mod postures;
mod solids;
pub(crate) mod stage;

pub use data::{
    ArmShapes, Body, BodyKind, Closest, Group, KeepOut, LoadKind, NamedPlace, Scene, SceneLimits, SceneLoad,
    ScenePosture,
};
pub use extras::{Arrow, ArrowSet, Ellipsoid, ScenePath};
pub use html::{VIEWER_SCRIPT, VIEWER_STYLE, scene_html};
pub use numbers::{Pose, Triple};

use crate::series_colour;
use arm::Arm;
use numbers::pose;
use postures::AtPostures;
use stage::Stage;
use stiffarm::Result;
use stiffarm::model::cell::Cell;
use stiffarm::model::load::{Load, Wrench};
use stiffarm::model::observation::Setup;
use stiffarm::model::posture::Posture;
use stiffarm::model::stiffness::Model;
use stiffarm::nalgebra::Vector3;

/// Postures that are shown together.
#[derive(Debug, Clone, Copy)]
pub struct SceneGroup<'a> {
    /// Its name; groups of one name have one colour, in figures too.
    pub name: &'a str,
    /// Its postures, in the order they are measured.
    pub postures: &'a [Posture],
    /// Measured wrenches at the loading point, base axes, posture by posture; empty for the cell's own load.
    pub wrenches: &'a [Wrench],
}

impl<'a> SceneGroup<'a> {
    /// A group under the cell's own load.
    pub fn new(name: &'a str, postures: &'a [Posture]) -> Self {
        SceneGroup { name, postures, wrenches: &[] }
    }
}

/// How the arm bends.
#[derive(Debug, Clone, Copy, Default)]
pub struct SceneOptions<'a> {
    /// Joint stiffness k \[N·m/rad\], one per spring; `None` takes the cell's own, where it has one.
    pub stiffness: Option<&'a [f64]>,
    /// The model that gives the deflections.
    pub model: Model,
}

/// The cell at these groups of postures.
///
/// # Errors
/// Angles that do not fit the robot, a loading point on the rope's anchor, a stiffness that is not one positive number
/// per spring. A posture at which the loaded arm finds no equilibrium is shown without deflection.
pub fn scene(cell: &Cell, groups: &[SceneGroup<'_>], options: &SceneOptions<'_>) -> Result<Scene> {
    let robot = &cell.setup.robot;
    let stiffness = options.stiffness.or(cell.prior.as_deref());
    let (shapes, robot_bodies, bodies) = bodies::bodies(cell);
    let mut at_postures = AtPostures::new(cell, stiffness, options.model, robot_bodies)?;
    let groups = groups.iter().map(|group| {
        let postures = group.postures.iter().enumerate();
        let postures = postures.map(|(number, posture)| at_postures.at(posture, group.wrenches.get(number)));
        let postures = postures.collect::<Result<_>>()?;
        Ok(Group { name: group.name.to_string(), colour: series_colour(group.name), postures })
    });
    let groups = groups.collect::<Result<_>>()?;
    let stations = cell.scene.sight().map(|sight| sight.stations.iter());
    let mut scene = Scene {
        cell: cell.name.clone(),
        robot: robot.name().to_string(),
        joints: robot.joints().iter().map(|j| j.name.clone()).collect(),
        shapes,
        bodies,
        robot_bodies,
        flange: pose(robot.flange()),
        measuring_points: cell
            .setup
            .tool
            .measuring_points
            .iter()
            .map(|point| named(&point.name, &point.position))
            .collect(),
        loads: loads(&cell.setup),
        stations: stations.into_iter().flatten().map(|station| named(&station.name, &station.position)).collect(),
        limits: limits(cell),
        extent: Default::default(),
        first_turn: None,
        force_length: 0.0,
        model: stiffness.map(|_| options.model.as_str()),
        loaded: None,
        groups,
        path: None,
        arrows: None,
        ellipsoids: Vec::new(),
    };
    let arms: Vec<Arm<'_>> = scene.postures().map(|posture| Arm::of(&scene, posture)).collect();
    let stage = Stage::of(&scene, &arms, arms.first());
    let first_turn = first_look::first_look(&scene, robot.length(), &arms);
    let corners = stage.corners();
    scene.extent = [corners[0].into(), corners[7].into()];
    scene.force_length = stage.force_length;
    scene.first_turn = first_turn;
    Ok(scene)
}

fn named(name: &str, at: &Vector3<f64>) -> NamedPlace {
    NamedPlace { name: name.to_string(), at: (*at).into() }
}

fn loads(setup: &Setup) -> Vec<LoadKind> {
    let cases = setup.load.cases();
    let setups = setup.cases();
    let loads = setups.iter().enumerate().map(|(number, setup)| LoadKind {
        name: cases.get(number).map_or(String::new(), |case| case.name.clone()),
        kind: match setup.load {
            Load::Rope { .. } => setup.load.line(),
            Load::Weight { .. } => "weight",
            Load::Constant { .. } => "wrench",
            Load::Measured | Load::Cases(_) => "measured",
        },
        at: setup.tool.loading_point.into(),
        anchor: match &setup.load {
            Load::Rope { anchor, .. } => Some((*anchor).into()),
            _ => None,
        },
    });
    loads.collect()
}

fn limits(cell: &Cell) -> SceneLimits {
    let limits = &cell.limits;
    let first = cell.setup.robot.joints().first().map(|joint| joint.placement).unwrap_or_default();
    SceneLimits {
        tool_box: limits.tool_box.map(|ends| ends.map(Triple::from)),
        floor: limits.floor,
        wrist_height: limits.wrist_height,
        keep_out: limits.keep_out_radius.map(|radius| KeepOut {
            origin: first.translation.vector.into(),
            axis: (first.rotation * Vector3::z()).into(),
            radius,
        }),
        rope_cone: cell.scene.rope().and_then(|rope| rope.cone),
    }
}
