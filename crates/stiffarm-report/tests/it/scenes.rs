//! Cells in three dimensions are where the library has them: links, shapes, bent arms and nearest pairs.

use crate::common::spread;
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3};
use stiffarm::model::cell::Cell;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::load::{Load, Wrench};
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::posture::Posture;
use stiffarm::model::robot::Robot;
use stiffarm::model::stiffness::{Model, linear_displacement};
use stiffarm::model::tool::Tool;
use stiffarm_report::scene::{
    ArmShapes, Pose, Scene, SceneGroup, SceneOptions, ScenePosture, VIEWER_SCRIPT, VIEWER_STYLE, scene, scene_html,
};

fn shown(cell: &Cell, postures: &[Posture], model: Model) -> Scene {
    let options = SceneOptions { model, ..SceneOptions::default() };
    scene(cell, &[SceneGroup::new("Group 1", postures)], &options).unwrap()
}

fn isometry(pose: &Pose) -> Isometry3<f64> {
    let [x, y, z, i, j, k, w] = *pose;
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
    Isometry3::from_parts(Translation3::new(x, y, z), turn)
}

/// The flange as the page draws it: E_1 … E_n · pose_n · flange, the joints turned `times` as far.
fn drawn_flange(scene: &Scene, posture: &ScenePosture, times: f64) -> Isometry3<f64> {
    let turns = posture.loads[0].turns.as_ref().unwrap();
    let mut moved = Isometry3::identity();
    for (pose, turn) in posture.links.iter().zip(turns) {
        let link = isometry(pose);
        let axis = Unit::new_normalize(link.rotation * Vector3::z());
        let turn = UnitQuaternion::from_axis_angle(&axis, times * turn);
        moved *= Isometry3::rotation_wrt_point(turn, link.translation.vector.into());
    }
    moved * isometry(posture.links.last().unwrap()) * isometry(&scene.flange)
}

#[test]
fn links_are_where_the_library_has_them() {
    let cell = stiffarm_files::builtin::cell("comau-shapes").unwrap();
    let postures = spread(&cell, 5);
    let scene = shown(&cell, &postures, Model::Linear);
    for (posture, planned) in scene.groups[0].postures.iter().zip(&postures) {
        let frames = Frames::new(&cell.setup.robot, &planned.q);
        for (pose, link) in posture.links.iter().zip(frames.links()) {
            let pose = isometry(pose);
            let apart = (pose.translation.vector - link.translation.vector).norm();
            assert!(apart < 2e-6, "{apart}");
            assert!(pose.rotation.angle_to(&link.rotation) < 1e-6);
        }
        for ((axis, origin), pose) in frames.axes().iter().zip(frames.origins()).zip(&posture.links) {
            let pose = isometry(pose);
            assert!((pose.rotation * Vector3::z() - axis).norm() < 1e-6);
            assert!((pose.translation.vector - origin).norm() < 2e-6);
        }
    }
}

#[test]
fn the_arm_bent_once_as_far_moves_its_points_as_the_linear_model_says() {
    let cell = stiffarm_files::builtin::cell("comau-shapes").unwrap();
    let stiffness = cell.prior.clone().unwrap();
    let postures = spread(&cell, 6);
    let scene = shown(&cell, &postures, Model::Linear);
    let exact = shown(&cell, &postures, Model::Equilibrium);
    for (number, planned) in postures.iter().enumerate() {
        let posture = &scene.groups[0].postures[number];
        let terms = PostureTerms::new(&cell.setup, &planned.q, None).unwrap();
        let rest = drawn_flange(&scene, posture, 0.0);
        let bent = drawn_flange(&scene, posture, 1.0);
        for (i, point) in cell.setup.tool.measuring_points.iter().enumerate() {
            let p = Point3::from(point.position);
            let drawn = bent * p - rest * p;
            let at = terms.measuring_points()[i];
            let said = linear_displacement(&cell.setup, &terms, &at, &stiffness, None).unwrap();
            let said = Vector3::new(said[0], said[1], said[2]);
            // Second order in turns below 1e-3 rad; the links are told to 1e-6 m.
            assert!((drawn - said).norm() < 2e-3 * said.norm() + 2e-8, "{drawn} {said}");
            let in_scene = Vector3::from(posture.loads[0].deflection[i + 1]);
            assert!((in_scene - said).norm() < 1e-5 * said.norm());
            // The equilibrium is the same to second order, but not the same.
            let other = Vector3::from(exact.groups[0].postures[number].loads[0].deflection[i + 1]);
            assert!((other - said).norm() < 0.05 * said.norm() && other != in_scene);
        }
    }
}

#[test]
fn the_exact_arm_is_drawn_where_its_equilibrium_is() {
    let cell = stiffarm_files::builtin::cell("comau-shapes").unwrap();
    let scene = shown(&cell, &spread(&cell, 4), Model::Equilibrium);
    for posture in &scene.groups[0].postures {
        let (rest, bent) = (0.0, 1.0);
        let [rest, bent] = [rest, bent].map(|times| drawn_flange(&scene, posture, times));
        for (point, drawn) in scene.measuring_points.iter().zip(&posture.loads[0].deflection[1..]) {
            let p = Point3::from(point.at);
            let off = bent * p - rest * p - Vector3::from(*drawn);
            assert!(off.norm() < 2e-8, "{off}");
        }
    }
}

#[test]
fn the_closest_pair_is_the_least_margin_between_shapes() {
    let cell = stiffarm_files::builtin::cell("comau-shapes").unwrap();
    for posture in spread(&cell, 20) {
        let terms = PostureTerms::new(&cell.setup, &posture.q, None).unwrap();
        let closest = cell.scene.closest(&terms).unwrap();
        let least = cell.scene.margins(&cell.setup, &terms).into_iter();
        let least = least.filter(|m| m.kind == stiffarm::model::cell::LimitKind::Shapes);
        let least = least.min_by(|a, b| a.margin.total_cmp(&b.margin)).unwrap();
        assert!((closest.distance - least.margin - cell.scene.clearance()).abs() < 1e-12);
        assert_eq!(closest.names.join(" and "), least.subject);
        let apart = (closest.points[0] - closest.points[1]).norm();
        if closest.distance > 0.0 {
            assert!((apart - closest.distance).abs() < 1e-9, "{apart}");
            let placed = cell.scene.placed(terms.frames());
            let of = |name: &str| placed.iter().find(|(label, _)| *label == name).unwrap();
            let (_, solids) = of(&closest.names[1]);
            let on = solids.iter().map(|s| s.signed_distance(&closest.points[1]).0);
            assert!(on.fold(f64::INFINITY, f64::min).abs() < 1e-9);
        }
    }
}

#[test]
fn hostile_names_stay_text_and_equal_cells_give_equal_bytes() {
    const EVIL: &str = "</script><img src=x onerror=alert(1)>\u{1b}[31m\"'&=cmd|' /C calc'!A0";
    let page = || {
        let mut cell = stiffarm_files::builtin::cell("comau-shapes").unwrap();
        cell.name = EVIL.into();
        cell.setup.tool.measuring_points[0].name = EVIL.into();
        let mut postures = spread(&cell, 3);
        postures[0].name = EVIL.into();
        let groups = [SceneGroup::new(EVIL, &postures)];
        let shown = scene(&cell, &groups, &SceneOptions::default()).unwrap();
        scene_html(&shown, "cell\"><b>", EVIL, "<svg></svg>")
    };
    let html = page();
    assert_eq!(html, page());
    assert_eq!(html.matches("</script").count(), 1);
    assert!(!html.contains("<img") && !html.contains("<b>"));
    let json = html.split_once("application/json\">").unwrap().1;
    let json = json.split_once("</script>").unwrap().0;
    let value: serde_json::Value = serde_json::from_str(json).unwrap();
    assert_eq!(value["groups"][0]["name"], EVIL);
    assert_eq!(value["groups"][0]["postures"][0]["name"], EVIL);
    assert_eq!(value["cell"], EVIL);
}

#[test]
fn a_measured_load_is_shown_where_it_is_known() {
    let cell = stiffarm_files::builtin::cell("fanuc-r2000ic").unwrap();
    let postures = spread(&cell, 2);
    let unknown = shown(&cell, &postures, Model::Equilibrium);
    assert!(unknown.groups[0].postures.iter().all(|p| p.loads.is_empty()));
    assert_eq!((unknown.shapes, unknown.model), (ArmShapes::Tubes, None));
    assert!(unknown.bodies.len() >= 6);
    let group = SceneGroup { wrenches: &[Wrench::force([0.0, 0.0, -500.0])], ..SceneGroup::new("Group 1", &postures) };
    let options = SceneOptions { stiffness: Some(&[1e6; 6]), ..SceneOptions::default() };
    let loaded = scene(&cell, &[group], &options).unwrap();
    let [first, second] = &loaded.groups[0].postures[..] else { panic!("two postures") };
    assert_eq!(first.loads[0].force, [0.0, 0.0, -500.0]);
    assert!(first.loads[0].deflection[0][2] < 0.0);
    assert!(second.loads.is_empty());
    let few = SceneOptions { stiffness: Some(&[1e6; 5]), ..SceneOptions::default() };
    assert!(scene(&cell, &[], &few).is_err());
}

#[test]
fn an_arm_that_buckles_is_shown_without_deflection() {
    let robot = Robot::from_catalogue("panda").unwrap();
    let tool = Tool::new(Vector3::new(0.0, 0.0, 0.3), [("tip", Vector3::zeros())]).unwrap();
    let load = Load::Weight { magnitude: 500.0, direction: -Vector3::z() };
    let cell = Cell::new("soft", robot, tool, load);
    let options = SceneOptions { stiffness: Some(&[10.0; 7]), ..SceneOptions::default() };
    let postures = spread(&cell, 4);
    let shown = scene(&cell, &[SceneGroup::new("a", &postures)], &options).unwrap();
    let loads = shown.groups[0].postures.iter().map(|p| &p.loads[0]);
    assert!(loads.clone().any(|load| load.turns.is_none()));
    assert!(loads.clone().all(|load| load.force == [0.0, 0.0, -500.0]));
}

#[test]
fn ten_groups_of_fifty_postures_stay_below_a_megabyte() {
    let cell = stiffarm_files::builtin::cell("comau-shapes").unwrap();
    let postures = spread(&cell, 50);
    let groups = [SceneGroup::new("Group 1", &postures); 10];
    let shown = scene(&cell, &groups, &SceneOptions::default()).unwrap();
    let size = scene_html(&shown, "cell", "cell", "").len();
    assert!(size < 1_000_000, "{size}");
}

#[test]
fn script_and_style_can_stand_in_a_page() {
    let script = VIEWER_SCRIPT.to_lowercase();
    assert!(!script.contains("</script") && !script.contains("<!--"));
    // Text of the data is never read as HTML by our own part.
    let our_script = VIEWER_SCRIPT.split_once("// Solids as meshes").unwrap().1;
    for never in ["innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval("] {
        assert!(!our_script.contains(never), "{never}");
    }
    assert!(VIEWER_SCRIPT.contains("Permission is hereby granted"));
    for rule in VIEWER_STYLE.split('{').filter(|rule| !rule.contains('@')) {
        let selector = rule.rsplit('}').next().unwrap().trim();
        let parts = selector.split(',').map(str::trim);
        for part in parts.filter(|part| !part.is_empty()) {
            assert!(part.contains(".scene"), "{part}");
        }
    }
}

#[test]
fn the_first_look_is_past_what_stands_before_the_arm() {
    let open = stiffarm_files::builtin::cell("comau-shapes").unwrap();
    let postures = stiffarm_files::builtin::postures("comau-group1", &open.setup.robot).unwrap();
    assert_eq!(shown(&open, &postures, Model::Linear).first_turn, None);
    // A pillar between the arm and who looks.
    let text = stiffarm_files::builtin::cell_text("comau-shapes").unwrap();
    let pillar = "[[obstacle]]\nname = \"pillar\"\nkind = \"box\"\ncenter_mm = [1700, -1900, 1500]\nsize_mm = [1600, 200, 3000]\n\n[clearance]";
    let text = text.replace("[clearance]", pillar);
    let behind = stiffarm_files::cell::parse_cell(&text, "cell.toml").unwrap();
    let turn = shown(&behind, &postures, Model::Linear).first_turn;
    let turn = turn.expect("another turn").to_degrees();
    assert!((turn - 32.0).abs() > 10.0, "{turn}");
}
