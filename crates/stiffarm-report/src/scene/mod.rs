//! A cell in three dimensions for a page: its data, and the script that shows them.
//!
//! [`scene`] asks the library about every posture once; the page computes nothing but where to draw. The script is
//! three.js and `assets/viewer/`, joined as [`VIEWER_SCRIPT`]; `assets/README.md` says where three.js comes from.

mod bodies;
mod data;
mod extras;
mod first_look;
mod html;
mod numbers;
mod postures;
mod with;

pub use data::{
    ArmShapes, Body, BodyKind, Closest, Group, KeepOut, LoadKind, NamedPlace, Pose, Scene, SceneLimits, SceneLoad,
    ScenePosture, SceneSolid,
};
pub use extras::{Arrow, ArrowSet, Ellipsoid, ScenePath};
pub use html::{VIEWER_SCRIPT, VIEWER_STYLE, scene_html};
pub use numbers::Triple;

use crate::cell::stage::Stage;
use crate::series_colour;
use numbers::{length, place, pose, share, vector};
use postures::Looks;
use stiffarm::Result;
use stiffarm::model::cell::Cell;
use stiffarm::model::load::{Load, Wrench};
use stiffarm::model::observation::Setup;
use stiffarm::model::posture::Posture;
use stiffarm::model::stiffness::Model;

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
#[derive(Debug, Clone, Copy)]
pub struct SceneOptions<'a> {
    /// Joint stiffness k \[N·m/rad\], one per spring; `None` takes the cell's own, where it has one.
    pub stiffness: Option<&'a [f64]>,
    /// The model that gives the deflections.
    pub model: Model,
}

impl Default for SceneOptions<'_> {
    fn default() -> Self {
        SceneOptions { stiffness: None, model: Model::Equilibrium }
    }
}

/// The cell at these groups of postures.
///
/// # Errors
/// Angles that do not fit the robot, a loading point on the rope's anchor, a stiffness that is not one positive number
/// per spring. A posture at which the loaded arm finds no equilibrium is shown without deflection.
pub fn scene(cell: &Cell, groups: &[SceneGroup<'_>], options: &SceneOptions<'_>) -> Result<Scene> {
    let robot = &cell.setup.robot;
    let stiffness = options.stiffness.or(cell.prior.as_deref());
    let (shapes, before, bodies) = bodies::bodies(cell);
    let mut looks = Looks::new(cell, stiffness, options.model, before)?;
    let mut all = Vec::new();
    let mut shown = Vec::with_capacity(groups.len());
    for group in groups {
        let mut postures = Vec::with_capacity(group.postures.len());
        for (number, posture) in group.postures.iter().enumerate() {
            let (one, terms) = looks.look(posture, group.wrenches.get(number))?;
            postures.push(one);
            all.push(terms);
        }
        shown.push(Group { name: group.name.to_string(), colour: series_colour(group.name), postures });
    }
    let stage = Stage::of(cell, &all, (!all.is_empty()).then_some(0));
    let corners = stage.corners();
    let stations = cell.scene.sight().map(|sight| sight.stations.iter());
    Ok(Scene {
        cell: cell.name.clone(),
        robot: robot.name().to_string(),
        joints: robot.joints().iter().map(|j| j.name.clone()).collect(),
        shapes,
        bodies,
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
        limits: limits(cell, &stage),
        extent: [place(&corners[0]), place(&corners[7])],
        first_turn: first_look::first_look(cell, &all).map(share),
        force_length: length(stage.force_length()),
        model: stiffness.map(|_| options.model.as_str()),
        loaded: None,
        groups: shown,
        path: None,
        arrows: None,
        ellipsoids: Vec::new(),
    })
}

fn named(name: &str, at: &stiffarm::nalgebra::Vector3<f64>) -> NamedPlace {
    NamedPlace { name: name.to_string(), at: place(at) }
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
        at: place(&setup.tool.loading_point),
        anchor: match &setup.load {
            Load::Rope { anchor, .. } => Some(place(anchor)),
            _ => None,
        },
    });
    loads.collect()
}

fn limits(cell: &Cell, stage: &Stage) -> SceneLimits {
    let limits = &cell.limits;
    let (origin, axis) = stage.first_axis();
    SceneLimits {
        tool_box: limits.tool_box.map(|ends| ends.map(|p| place(&p))),
        floor: limits.floor,
        wrist_height: limits.wrist_height,
        keep_out: limits.keep_out_radius.map(|radius| KeepOut {
            origin: place(&origin),
            axis: vector(&axis),
            radius: length(radius),
        }),
    }
}
