//! The stiffness at the nodes of a region is that of the allowed posture that bends least, or the reason why there is
//! none.

use super::*;
use crate::common::cases::{refusals, sentences};

fn map(cell: &Cell, predictor: &IdentifiedCompliance, options: &MapOptions) -> StiffnessMap {
    stiffness_map(cell, predictor, options, Control::default()).unwrap()
}

/// A prediction at every reachable node's posture.
fn pointwise(cell: &Cell, predictor: &IdentifiedCompliance, map: &StiffnessMap, wrench: Wrench) -> Prediction {
    let reached = map.nodes.iter().filter_map(|n| n.values.as_ref());
    let postures: Vec<LoadedPosture> = reached.map(|values| LoadedPosture::new("", values.q.clone(), wrench)).collect();
    let options = with(|o: &mut PredictOptions| o.stiffness = true);
    predict(cell, predictor, &postures, &options, Control::default()).unwrap()
}

#[test]
fn values_are_those_of_pointwise_predictions() {
    let cell = default_cell();
    let predictor = unsure(&cell);
    for free_turn in [None, Some(5)] {
        let options = changed(options(), |o| o.free_turn = free_turn);
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
            assert!(close(values.deflection_per_newton_m, point.deflection_m / options.wrench.force.norm()));
            assert!(close(values.half_width_m.unwrap(), point.band.unwrap().size_m[3]));
            let cartesian = point.stiffness.unwrap();
            let softest = &cartesian.principal[0];
            assert!(close(values.softest.stiffness_n_per_m.unwrap(), softest.stiffness_n_per_m.unwrap()));
            let u = options.direction;
            let along: f64 = (0..3)
                .flat_map(|i| (0..3).map(move |j| (i, j)))
                .map(|(i, j)| u[i] * cartesian.compliance[i][j] * u[j])
                .sum();
            assert!(close(values.stiffness_n_per_m.unwrap(), 1.0 / along));
            assert_eq!(values.turn.is_some(), free_turn.is_some());
            assert!(values.k_jn.unwrap() >= 1.0);
        }
    }
}

#[test]
fn stiffness_along_a_direction_is_force_per_shift() {
    let cell = default_cell();
    let options = changed(options(), |o| o.wrench = Wrench::force(Vector3::new(1.0, 0.3, -0.2).normalize()));
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
    let turned = branches.iter().map(|b| inverse.turns_within_limits(&b.q));
    let inside = |q: &Vec<f64>| cell.outside_bounds(q).next().is_none();
    let inside: Vec<_> = turned.flatten().filter(inside).collect();
    if inside.is_empty() {
        return Err(Status::OutsideJointLimits);
    }
    let mut work = cell.clone();
    work.limits.rope_length = None;
    let holds = |q: &Vec<f64>| {
        let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
        let smallest = work.margins().smallest(&terms);
        smallest.is_none_or(|margin| !margin.is_violated())
    };
    let allowed: Vec<_> = inside.into_iter().filter(holds).collect();
    if allowed.is_empty() { Err(Status::Forbidden) } else { Ok(allowed) }
}

#[test]
fn each_node_has_the_allowed_posture_that_bends_least() {
    let cell = default_cell();
    let predictor = prior(&cell);
    let arm = LoadedArm::new(&cell, &predictor).unwrap();
    let options = changed(options(), |o| {
        o.lower = [0.2, -2.4, -0.4];
        o.upper = [3.6, 2.4, 2.8];
        o.steps = [9, 9, 4];
    });
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
                let least = postures.iter().map(|q| bent(q)).fold(f64::INFINITY, f64::min);
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
    assert_eq!([counts.reachable, counts.forbidden, counts.outside_joint_limits, counts.unreachable], seen);
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
    let free = map(&cell, &predictor, &changed(options(), |o| o.free_turn = Some(12)));
    let mut gained = 0;
    for (fixed, free) in fixed.nodes.iter().zip(&free.nodes) {
        let Some(values) = &fixed.values else {
            gained += usize::from(free.values.is_some());
            continue;
        };
        let better = free.values.as_ref().unwrap();
        assert!(better.deflection_m <= values.deflection_m * 1.001);
        // The turn is about the tool axis.
        let frames = Frames::new(&cell.setup.robot, &better.q);
        let tip = frames.flange() * cell.work.tip(&cell.setup.tool);
        assert!((tip.rotation * Vector3::z() + Vector3::z()).norm() < 1e-9);
        let x = tip.rotation * Vector3::x();
        let turn = better.turn.unwrap();
        assert!((x - down() * Vector3::new(turn.cos(), turn.sin(), 0.0)).norm() < 1e-9);
    }
    assert!(gained > 0);
}

#[test]
fn the_tip_itself_stays_within_the_limits() {
    let mut cell = default_cell();
    // 300 mm below the reflectors' plane.
    cell.work.tip = Some(Isometry3::translation(0.0, 0.0, 0.5));
    let options = changed(options(), |o| {
        o.lower = [1.4, 0.0, 0.2];
        o.upper = [1.4, 0.0, 0.4];
        o.steps = [1, 1, 2];
    });
    let nodes = map(&cell, &prior(&cell), &options).nodes;
    assert_eq!(nodes[0].status, Status::Forbidden);
    insta::assert_snapshot!(nodes[0].reason.as_ref().unwrap(), @"its tip violates the box for tool points and flange by 100.0 mm");
    assert!((nodes[0].distance_m.unwrap() - 0.1).abs() < 1e-12);
    assert_eq!(nodes[1].status, Status::Reachable);
}

#[test]
fn nothing_reachable_is_a_serious_finding_that_says_what_comes_closest() {
    let cell = default_cell();
    let options = changed(options(), |o| {
        o.lower = [5.0, 0.0, 0.8];
        o.upper = [6.0, 0.0, 0.8];
        o.steps = [3, 1, 1];
    });
    let map = map(&cell, &prior(&cell), &options);
    assert_eq!(map.counts.unreachable, 3);
    assert!(map.extremes.is_none() && map.deflection_per_newton_m.is_none());
    insta::assert_snapshot!(sentences(&map.findings), @"
    [nothing-reachable] region: No node of the map is reachable with this orientation. Closest comes x = 5000, y = 0, z = 800 mm: 1827.5 mm out of the arm's reach.
    [no-band] stiffness: The joint stiffness comes without covariance: nothing says how sure these deflections are.
    [unknown-limits] robot: The machine's joint limits are not known, so the real arm may reach less: give robot.limits_deg.
    [tip-assumed] work: The tip is measuring point 1, with the flange's axes: the cell says no other. Where the tool works elsewhere, say so with tip_mm in [work].
    ");
    let distance: Vec<f64> = map.nodes.iter().map(|n| n.distance_m.unwrap()).collect();
    assert!(distance[0] < distance[1] && distance[1] < distance[2]);
}

#[test]
fn regions_and_loads_that_are_none_are_refused() {
    let cell = default_cell();
    let predictor = prior(&cell);
    let of =
        |change: fn(&mut MapOptions)| stiffness_map(&cell, &predictor, &changed(options(), change), Control::default());
    let rows = [
        ("a lower end above the upper one", of(|o| o.lower[0] = 4.0)),
        ("an end that is no number", of(|o| o.upper[1] = f64::NAN)),
        ("steps where the ends are one", of(|o| o.steps[2] = 4)),
        ("no node", of(|o| o.steps[0] = 0)),
        ("too many nodes", of(|o| o.steps = [2000, 2000, 1])),
        ("no force", of(|o| o.wrench.force = Vector3::zeros())),
        ("no turn", of(|o| o.free_turn = Some(0))),
    ]
    .map(|(what, map)| (what, Code::InvalidValue, map));
    insta::assert_snapshot!("map_refusals", refusals(rows));
}

#[test]
fn random_maps_hold_the_tip_where_they_say() {
    let cell = default_cell();
    let predictor = prior(&cell);
    let mut dice = Dice::new(5);
    let mut reached = 0;
    for _ in 0..30 {
        let at = [dice.between(1.0, 2.6), dice.between(-1.5, 1.5), dice.between(0.4, 2.0)];
        let axis = dice.direction();
        let options = {
            let mut options = MapOptions::new(at, at, [1; 3]);
            options.rotation = UnitQuaternion::from_scaled_axis(axis * dice.between(0.0, PI));
            options.free_turn = Some(4);
            options.direction = UnitVector3::new_normalize(dice.direction());
            options.wrench = Wrench::force(dice.direction() * 500.0);
            options
        };
        let node = &map(&cell, &predictor, &options).nodes[0];
        let Some(values) = &node.values else { continue };
        reached += 1;
        let q = values.q.clone();
        assert!(cell.outside_machine_limits(&q).is_none());
        let tip = Frames::new(&cell.setup.robot, &q).flange() * cell.work.tip(&cell.setup.tool);
        assert!((tip.translation.vector - Vector3::from(at)).norm() < 1e-9);
        let turned = options.rotation * UnitQuaternion::from_euler_angles(0.0, 0.0, values.turn.unwrap());
        assert!(tip.rotation.angle_to(&turned) < 1e-9);
    }
    assert!(reached >= 5, "{reached}");
}
