//! Stiffness over a region, and the best place for a workpiece.

use crate::common;

use common::{default_cell, random::Dice};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, UnitVector3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};
use stiffarm::Code;
use stiffarm::Control;
use stiffarm::estimate::compliance::{IdentifiedCompliance, Spread};
use stiffarm::model::cell::Cell;
use stiffarm::model::inverse::InverseKinematics;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::load::Wrench;
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::path::{LoadedPosture, PathPoint, PathTarget, tip_wrenches};
use stiffarm::model::process::{ForceAxes, Process, TipLoad};
use stiffarm::work::map::{
    MapOptions, PlaceOptions, Placement, Status, StiffnessMap, place, stiffness_map,
};
use stiffarm::work::predict::{LoadedArm, PredictOptions, Prediction, predict};

fn down() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(PI, 0.0, 0.0)
}

fn options() -> MapOptions {
    MapOptions {
        lower: [0.7, -1.6, 0.8],
        upper: [3.0, 1.6, 0.8],
        steps: [9, 11, 1],
        rotation: down(),
        free_turn: None,
        direction: UnitVector3::new_normalize(Vector3::new(1.0, 0.3, -0.2)),
        wrench: Wrench {
            force: Vector3::new(200.0, -300.0, 400.0),
            moment: Vector3::new(5.0, 0.0, -12.0),
        },
    }
}

fn prior(cell: &Cell) -> IdentifiedCompliance {
    IdentifiedCompliance::from_stiffness(cell, cell.prior.as_ref().unwrap()).unwrap()
}

/// The prior with a covariance of 2 % per joint.
fn unsure(cell: &Cell) -> IdentifiedCompliance {
    let mut predictor = prior(cell);
    let variances = predictor.values.map(|h| (0.02 * h).powi(2));
    predictor.spread = Some(Spread {
        covariance: nalgebra::DMatrix::from_diagonal(&variances),
        sigma: 1e-5,
        shift: 0.0,
        degrees_of_freedom: None,
        confidence: 0.95,
    });
    predictor
}

fn map(cell: &Cell, predictor: &IdentifiedCompliance, options: &MapOptions) -> StiffnessMap {
    stiffness_map(cell, predictor, options, Control::default()).unwrap()
}

fn radians(degrees: &[f64]) -> Vec<f64> {
    degrees.iter().map(|a| a.to_radians()).collect()
}

/// A prediction at every reachable node's posture.
fn pointwise(
    cell: &Cell,
    predictor: &IdentifiedCompliance,
    map: &StiffnessMap,
    wrench: Wrench,
) -> Prediction {
    let reached = map.nodes.iter().filter_map(|n| n.values.as_ref());
    let postures: Vec<LoadedPosture> = reached
        .map(|values| LoadedPosture {
            name: String::new(),
            line: None,
            q: radians(&values.q_deg),
            wrench,
        })
        .collect();
    let options = PredictOptions {
        stiffness: true,
        ..PredictOptions::default()
    };
    predict(cell, predictor, &postures, &options, Control::default()).unwrap()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-10 * a.abs().max(b.abs())
}

#[test]
fn values_are_those_of_pointwise_predictions() {
    let cell = default_cell();
    let predictor = unsure(&cell);
    for free_turn in [None, Some(5)] {
        let options = MapOptions {
            free_turn,
            ..options()
        };
        let map = map(&cell, &predictor, &options);
        let points = pointwise(&cell, &predictor, &map, options.wrench).points;
        assert!(points.len() > 20, "{}", points.len());
        let nodes = map.nodes.iter().filter(|n| n.values.is_some());
        for (node, point) in nodes.zip(points) {
            let values = node.values.as_ref().unwrap();
            for axis in 0..3 {
                // A posture in degrees is a rounding away.
                assert!((node.position_m[axis] - point.tip_m[axis]).abs() < 1e-12);
                assert!((values.shift_m[axis] - point.shift_m[axis]).abs() < 1e-15);
            }
            assert!(close(values.deflection_m, point.deflection_m));
            assert!(close(
                values.deflection_per_newton_m,
                point.deflection_m / options.wrench.force.norm()
            ));
            assert!(close(
                values.half_width_m.unwrap(),
                point.band.unwrap().size_m[3]
            ));
            let cartesian = point.stiffness.unwrap();
            let softest = &cartesian.principal[0];
            assert!(close(
                values.softest.stiffness_n_per_m.unwrap(),
                softest.stiffness_n_per_m.unwrap()
            ));
            let u = options.direction;
            let along: f64 = (0..3)
                .flat_map(|i| (0..3).map(move |j| (i, j)))
                .map(|(i, j)| u[i] * cartesian.compliance[i][j] * u[j])
                .sum();
            assert!(close(values.stiffness_n_per_m.unwrap(), 1.0 / along));
            assert_eq!(values.turn_deg.is_some(), free_turn.is_some());
            assert!(values.k_jn.unwrap() >= 1.0);
        }
    }
}

#[test]
fn stiffness_along_a_direction_is_force_per_shift() {
    let cell = default_cell();
    let options = MapOptions {
        wrench: Wrench::force(Vector3::new(1.0, 0.3, -0.2).normalize()),
        ..options()
    };
    let map = map(&cell, &prior(&cell), &options);
    for values in map.nodes.iter().filter_map(|n| n.values.as_ref()) {
        let along = Vector3::from(values.shift_m).dot(&options.direction);
        // One newton bends by micrometres: the second order is below 1e-5 of it.
        let relative = values.stiffness_n_per_m.unwrap() * along - 1.0;
        assert!(relative.abs() < 1e-4, "{relative}");
        assert!(values.softest.stiffness_n_per_m < values.stiffness_n_per_m);
    }
}

/// Postures at a pose that limits of machine and cell allow, by the library's
/// smaller parts.
fn allowed(cell: &Cell, pose: &Isometry3<f64>) -> Result<Vec<Vec<f64>>, Status> {
    let inverse = InverseKinematics::new(&cell.setup.robot);
    let flange = pose * cell.work.tip(&cell.setup.tool).inverse();
    let Ok(branches) = inverse.branches(&flange) else {
        return Err(Status::Unreachable);
    };
    let inside: Vec<_> = branches.into_iter().filter(|b| b.within_limits).collect();
    if inside.is_empty() {
        return Err(Status::OutsideJointLimits);
    }
    let mut limits = cell.limits.clone();
    limits.rope_length = None;
    let holds = |q: &Vec<f64>| {
        let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
        limits
            .smallest(&cell.setup, &terms)
            .is_none_or(|m| m.margin >= 0.0)
    };
    let allowed: Vec<_> = inside.into_iter().map(|b| b.q).filter(holds).collect();
    match allowed.is_empty() {
        true => Err(Status::Forbidden),
        false => Ok(allowed),
    }
}

#[test]
fn each_node_has_the_allowed_posture_that_bends_least() {
    let mut cell = default_cell();
    // The whole turns of the wrist leave no pose to the joint limits alone.
    let mut limits: Vec<[f64; 2]> = cell.setup.robot.joints().iter().map(|j| j.limits).collect();
    limits[1] = [-0.4, 0.6];
    cell.setup.robot = cell.setup.robot.clone().with_limits(&limits).unwrap();
    let predictor = prior(&cell);
    let arm = LoadedArm::new(&cell, &predictor).unwrap();
    let options = MapOptions {
        lower: [0.2, -2.4, -0.4],
        upper: [3.6, 2.4, 2.8],
        steps: [9, 9, 4],
        ..options()
    };
    let map = map(&cell, &predictor, &options);
    let mut seen = [0; 4];
    for (i, node) in map.nodes.iter().enumerate() {
        let (x, y, z) = (i / 36, i / 4 % 9, i % 4);
        assert_eq!(map.index([x, y, z]), i);
        assert_eq!(node.position_m, [map.x_m[x], map.y_m[y], map.z_m[z]]);
        let pose = Isometry3::from_parts(Translation3::from(node.position_m), options.rotation);
        match allowed(&cell, &pose) {
            Ok(postures) => {
                seen[0] += 1;
                let values = node.values.as_ref().unwrap();
                let bent = |q: &[f64]| {
                    let bent = arm.deflect(q, &options.wrench).unwrap();
                    bent.displacement.fixed_rows::<3>(0).norm()
                };
                let least = postures
                    .iter()
                    .map(|q| bent(q))
                    .fold(f64::INFINITY, f64::min);
                // Chosen by the linear model, which may take the second of two equals.
                assert!(values.deflection_m <= 1.001 * least);
                assert!((node.status, &node.reason) == (Status::Reachable, &None));
            }
            Err(status) => {
                seen[status as usize] += 1;
                assert_eq!(node.status, status, "{:?}", node);
                assert!(node.values.is_none() && node.reason.is_some());
                let far = node.distance_m;
                assert_eq!(far.is_none(), status == Status::OutsideJointLimits);
                assert!(far.is_none_or(|d| d > 0.0 && d < 4.0));
            }
        }
    }
    assert!(seen.iter().all(|count| *count > 0), "{seen:?}");
    let counts = map.counts;
    assert_eq!(
        [
            counts.reachable,
            counts.forbidden,
            counts.outside_joint_limits,
            counts.unreachable
        ],
        seen
    );
    let extremes = map.extremes.unwrap();
    let size = |i: usize| map.nodes[i].values.as_ref().unwrap().deflection_m;
    let range = map.deflection_per_newton_m.unwrap();
    let force = options.wrench.force.norm();
    assert!(close(range.smallest * force, size(extremes.best)));
    assert!(close(range.largest * force, size(extremes.worst)));
}

#[test]
fn a_free_turn_can_only_help() {
    let cell = default_cell();
    let predictor = prior(&cell);
    let fixed = map(&cell, &predictor, &options());
    let free = map(
        &cell,
        &predictor,
        &MapOptions {
            free_turn: Some(12),
            ..options()
        },
    );
    let mut gained = 0;
    for (fixed, free) in fixed.nodes.iter().zip(&free.nodes) {
        let Some(values) = &fixed.values else {
            gained += usize::from(free.values.is_some());
            continue;
        };
        let better = free.values.as_ref().unwrap();
        assert!(better.deflection_m <= values.deflection_m * 1.001);
        // The turn is about the tool axis.
        let frames = Frames::new(&cell.setup.robot, &radians(&better.q_deg));
        let tip = frames.flange() * cell.work.tip(&cell.setup.tool);
        assert!((tip.rotation * Vector3::z() + Vector3::z()).norm() < 1e-9);
        let x = tip.rotation * Vector3::x();
        let turn = better.turn_deg.unwrap().to_radians();
        assert!((x - down() * Vector3::new(turn.cos(), turn.sin(), 0.0)).norm() < 1e-9);
    }
    assert!(gained > 0);
}

#[test]
fn the_tip_itself_stays_within_the_limits() {
    let mut cell = default_cell();
    // 300 mm below the reflectors' plane.
    cell.work.tip = Some(Isometry3::translation(0.0, 0.0, 0.5));
    let options = MapOptions {
        lower: [1.4, 0.0, 0.2],
        upper: [1.4, 0.0, 0.4],
        steps: [1, 1, 2],
        ..options()
    };
    let nodes = map(&cell, &prior(&cell), &options).nodes;
    assert_eq!(nodes[0].status, Status::Forbidden);
    let reason = nodes[0].reason.as_ref().unwrap();
    assert!(reason.starts_with("its tip violates the box"), "{reason}");
    assert!((nodes[0].distance_m.unwrap() - 0.1).abs() < 1e-12);
    assert_eq!(nodes[1].status, Status::Reachable);
}

#[test]
fn nothing_reachable_is_a_serious_finding_that_says_what_comes_closest() {
    let cell = default_cell();
    let options = MapOptions {
        lower: [5.0, 0.0, 0.8],
        upper: [6.0, 0.0, 0.8],
        steps: [3, 1, 1],
        ..options()
    };
    let map = map(&cell, &prior(&cell), &options);
    assert_eq!(map.counts.unreachable, 3);
    assert!(map.extremes.is_none() && map.deflection_per_newton_m.is_none());
    let finding = &map.findings[0];
    assert_eq!(finding.code, "nothing-reachable");
    assert!(
        finding.sentence.contains("x = 5000, y = 0, z = 800 mm"),
        "{finding:?}"
    );
    let distance: Vec<f64> = map.nodes.iter().map(|n| n.distance_m.unwrap()).collect();
    assert!(distance[0] < distance[1] && distance[1] < distance[2]);
}

#[test]
fn regions_and_loads_that_are_none_are_refused() {
    let cell = default_cell();
    let predictor = prior(&cell);
    let refused = |change: &dyn Fn(&mut MapOptions)| {
        let mut options = options();
        change(&mut options);
        let error = stiffness_map(&cell, &predictor, &options, Control::default()).unwrap_err();
        assert_eq!(error.code(), Code::InvalidValue);
        error.message().to_string()
    };
    assert!(refused(&|o| o.lower[0] = 4.0).contains("lower end"));
    assert!(refused(&|o| o.upper[1] = f64::NAN).contains("not finite"));
    assert!(refused(&|o| o.steps[2] = 4).contains("differ"));
    assert!(refused(&|o| o.steps[0] = 0).contains("at least 1"));
    assert!(refused(&|o| o.steps = [2000, 2000, 1]).contains("1000000"));
    assert!(refused(&|o| o.wrench.force = Vector3::zeros()).contains("force"));
    assert!(refused(&|o| o.free_turn = Some(0)).contains("turns"));
}

/// A rectangle milled with the tool down, on a workpiece that is turned.
fn rectangle(cell: &mut Cell, axes: ForceAxes) -> Vec<PathPoint> {
    cell.work.workpiece = Isometry3::from_parts(
        Translation3::new(1.7, 0.9, 0.7),
        UnitQuaternion::from_euler_angles(0.0, 0.0, 0.3),
    );
    cell.work.process = Some(Process::Constant(TipLoad {
        force: Vector3::new(-250.0, 150.0, 80.0),
        moment: Vector3::zeros(),
        axes,
    }));
    let corners = [[0.0, 0.0], [0.3, 0.0], [0.3, 0.2], [0.0, 0.2], [0.0, 0.0]];
    let mut points = Vec::new();
    for pair in corners.windows(2) {
        for i in 0..12 {
            let t = f64::from(i) / 12.0;
            let at = |k: usize| pair[0][k] + t * (pair[1][k] - pair[0][k]);
            let local = Isometry3::from_parts(Translation3::new(at(0), at(1), 0.05), down());
            points.push(PathPoint {
                name: format!("{}", points.len() + 1),
                line: None,
                target: PathTarget::Pose(cell.work.workpiece * local),
                load: None,
            });
        }
    }
    points
}

fn place_options() -> PlaceOptions {
    PlaceOptions {
        lower: [1.1, -0.9, 0.7],
        upper: [2.3, 0.9, 0.7],
        steps: [5, 7, 1],
        yaws: vec![0.0, FRAC_PI_2],
        ..PlaceOptions::default()
    }
}

fn search(cell: &Cell, points: &[PathPoint], options: &PlaceOptions) -> Placement {
    place(cell, &prior(cell), points, options, Control::default()).unwrap()
}

/// RMS of the deflections of the path moved by `by`, from the posture `start` on.
fn walked(cell: &Cell, points: &[PathPoint], by: &Isometry3<f64>, start: &[f64]) -> f64 {
    let inverse = InverseKinematics::new(&cell.setup.robot);
    let predictor = prior(cell);
    let arm = LoadedArm::new(cell, &predictor).unwrap();
    let poses: Vec<_> = points
        .iter()
        .map(|p| match &p.target {
            PathTarget::Pose(pose) => by * pose,
            other => panic!("{other:?}"),
        })
        .collect();
    let workpiece = by * cell.work.workpiece;
    let process = cell.work.process.as_ref().map(|p| p.load());
    let wrenches = tip_wrenches(points, &poses, process.as_ref(), &workpiece).unwrap();
    let mut q = start.to_vec();
    let mut squares = 0.0;
    for (pose, wrench) in poses.iter().zip(&wrenches) {
        q = inverse.nearest(&(pose * arm.tip().inverse()), &q).unwrap();
        let shift = arm.deflect(&q, wrench).unwrap().displacement;
        squares += shift.fixed_rows::<3>(0).norm_squared();
    }
    (squares / points.len() as f64).sqrt()
}

#[test]
fn the_best_place_is_the_one_where_the_moved_path_bends_least() {
    for axes in [
        ForceAxes::Path,
        ForceAxes::Base,
        ForceAxes::Workpiece,
        ForceAxes::Tool,
    ] {
        let mut cell = default_cell();
        let points = rectangle(&mut cell, axes);
        let found = search(&cell, &points, &place_options());
        let best = found.best.as_ref().unwrap();
        assert_eq!(found.given.status, Status::Reachable);
        assert_eq!(found.searched_points, points.len());
        // Whatever the search does inside, its numbers are those of a walk along.
        for placed in [best, &found.given] {
            let pose = Isometry3::from_parts(
                Translation3::from(placed.position_m),
                UnitQuaternion::from_euler_angles(
                    placed.rpy_deg[0].to_radians(),
                    placed.rpy_deg[1].to_radians(),
                    placed.rpy_deg[2].to_radians(),
                ),
            );
            let by = pose * cell.work.workpiece.inverse();
            let start = radians(placed.start_deg.as_ref().unwrap());
            let rms = walked(&cell, &points, &by, &start);
            assert!(
                (rms / placed.deflection_rms_m.unwrap() - 1.0).abs() < 1e-9,
                "{axes:?}"
            );
        }
        let rms = best.deflection_rms_m.unwrap();
        let gain = found.gain.unwrap();
        assert!(gain > 1.0, "{gain}");
        assert!(close(gain, found.given.deflection_rms_m.unwrap() / rms));
        let all = found.candidates.iter().filter_map(|c| c.deflection_rms_m);
        let least = all.fold(f64::INFINITY, f64::min);
        assert!((rms / least - 1.0).abs() < 0.01, "{rms} {least}");
        // Finer rounds only go on from the best.
        let of = |round: usize| {
            let of = found.candidates.iter().filter(move |c| c.round == round);
            of.filter_map(|c| c.deflection_rms_m)
                .fold(f64::INFINITY, f64::min)
        };
        assert!(of(1) <= of(0) * (1.0 + 1e-12) && of(2) <= of(1) * (1.0 + 1e-12));
        assert_eq!(found.candidates.iter().filter(|c| c.round == 0).count(), 70);
    }
}

#[test]
fn places_that_fail_say_where_and_why() {
    let mut cell = default_cell();
    let points = rectangle(&mut cell, ForceAxes::Path);
    let options = PlaceOptions {
        lower: [0.7, 0.0, 0.7],
        upper: [3.5, 0.0, 0.7],
        steps: [8, 1, 1],
        ..PlaceOptions::default()
    };
    let found = search(&cell, &points, &options);
    let status = |at: usize| found.candidates[at].status;
    assert_eq!(
        (status(0), status(7)),
        (Status::Forbidden, Status::Unreachable)
    );
    for candidate in &found.candidates {
        let works = candidate.status == Status::Reachable;
        assert_eq!(candidate.deflection_rms_m.is_some(), works);
        assert_eq!(
            candidate.reason.is_some() && candidate.point.is_some(),
            !works
        );
    }
    // Nowhere.
    let far = PlaceOptions {
        lower: [4.0, 0.0, 0.7],
        upper: [5.0, 0.0, 0.7],
        steps: [3, 1, 1],
        ..PlaceOptions::default()
    };
    let found = search(&cell, &points, &far);
    assert!(found.best.is_none() && found.gain.is_none());
    assert_eq!(found.findings[0].code, "nowhere");
}

#[test]
fn full_turns_are_chosen_for_the_whole_path() {
    // A circle of tool turns: 400° about the tool axis, which joint 6 must do in
    // one go within ±720°.
    let mut cell = default_cell();
    cell.work.workpiece = Isometry3::translation(1.8, 0.0, 0.8);
    let points: Vec<PathPoint> = (0..=100)
        .map(|i| {
            let turn =
                UnitQuaternion::from_euler_angles(0.0, 0.0, f64::from(i) * 4_f64.to_radians());
            let pose = Isometry3::from_parts(Translation3::identity(), down() * turn);
            PathPoint {
                name: i.to_string(),
                line: None,
                target: PathTarget::Pose(cell.work.workpiece * pose),
                load: Some(TipLoad {
                    force: Vector3::new(0.0, 0.0, 300.0),
                    moment: Vector3::zeros(),
                    axes: ForceAxes::Base,
                }),
            }
        })
        .collect();
    let options = PlaceOptions {
        lower: [1.8, 0.0, 0.8],
        upper: [1.8, 0.0, 0.8],
        ..PlaceOptions::default()
    };
    let found = search(&cell, &points, &options);
    assert_eq!(found.given.status, Status::Reachable, "{:?}", found.given);
    assert!((found.gain.unwrap() - 1.0).abs() < 1e-12);
    // Within ±200° there is no way.
    let limits: Vec<[f64; 2]> = cell.setup.robot.joints().iter().map(|j| j.limits).collect();
    let mut narrow = limits.clone();
    narrow[5] = [-190_f64.to_radians(), 190_f64.to_radians()];
    cell.setup.robot = cell.setup.robot.clone().with_limits(&narrow).unwrap();
    let found = search(&cell, &points, &options);
    assert_eq!(
        found.given.status,
        Status::OutsideJointLimits,
        "{:?}",
        found.given
    );
}

#[test]
fn a_free_tool_axis_takes_the_best_turn() {
    let mut cell = default_cell();
    let points = rectangle(&mut cell, ForceAxes::Base);
    let free: Vec<PathPoint> = points
        .iter()
        .map(|p| match &p.target {
            PathTarget::Pose(pose) => PathPoint {
                target: PathTarget::Axis {
                    position: pose.translation.vector,
                    axis: UnitVector3::new_normalize(pose.rotation * Vector3::z()),
                },
                ..p.clone()
            },
            other => panic!("{other:?}"),
        })
        .collect();
    let options = PlaceOptions {
        refinements: 0,
        ..place_options()
    };
    let found = search(&cell, &free, &options);
    let fixed = search(&cell, &points, &options);
    let rms = |p: &Placement| p.best.as_ref().unwrap().deflection_rms_m.unwrap();
    assert!(found.best.as_ref().unwrap().turn_deg.is_some());
    assert!(rms(&found) <= rms(&fixed) * 1.001);
    assert!(found.given.deflection_rms_m <= fixed.given.deflection_rms_m.map(|r| 1.001 * r));
}

#[test]
fn long_paths_are_searched_thinned_and_judged_whole() {
    let mut cell = default_cell();
    let mut points = rectangle(&mut cell, ForceAxes::Base);
    // Each point ten times, the last with a load of its own.
    points = points
        .iter()
        .flat_map(|p| (0..25).map(|_| p.clone()))
        .collect();
    let last = points.len() - 7;
    points[last].name = "hit".to_string();
    points[last].load = Some(TipLoad {
        force: Vector3::new(0.0, 3000.0, 0.0),
        moment: Vector3::zeros(),
        axes: ForceAxes::Base,
    });
    let options = PlaceOptions {
        steps: [3, 3, 1],
        yaws: vec![0.0],
        refinements: 0,
        ..place_options()
    };
    let found = search(&cell, &points, &options);
    assert_eq!(found.point_count, 1200);
    assert!(found.searched_points <= 200, "{}", found.searched_points);
    let best = found.best.unwrap();
    assert_eq!(best.deflection_max_point.as_deref(), Some("hit"));
}

#[test]
fn random_maps_hold_the_tip_where_they_say() {
    let cell = default_cell();
    let predictor = prior(&cell);
    let mut dice = Dice::new(5);
    let mut reached = 0;
    for _ in 0..30 {
        let at = [
            dice.between(1.0, 2.6),
            dice.between(-1.5, 1.5),
            dice.between(0.4, 2.0),
        ];
        let axis = dice.direction();
        let options = MapOptions {
            lower: at,
            upper: at,
            steps: [1; 3],
            rotation: UnitQuaternion::from_scaled_axis(axis * dice.between(0.0, PI)),
            free_turn: Some(4),
            direction: UnitVector3::new_normalize(dice.direction()),
            wrench: Wrench::force(dice.direction() * 500.0),
        };
        let node = &map(&cell, &predictor, &options).nodes[0];
        let Some(values) = &node.values else { continue };
        reached += 1;
        let q = radians(&values.q_deg);
        assert!(cell.outside_machine_limits(&q).is_none());
        let tip = Frames::new(&cell.setup.robot, &q).flange() * cell.work.tip(&cell.setup.tool);
        assert!((tip.translation.vector - Vector3::from(at)).norm() < 1e-9);
        let turned = options.rotation
            * UnitQuaternion::from_euler_angles(0.0, 0.0, values.turn_deg.unwrap().to_radians());
        assert!(tip.rotation.angle_to(&turned) < 1e-9);
    }
    assert!(reached >= 5, "{reached}");
}
