//! The best place of a path is where its postures bend least, within all limits.

use super::*;

/// A rectangle milled with the tool down, on a workpiece that is turned.
fn rectangle(cell: &mut Cell, axes: ForceAxes) -> Vec<PathPoint> {
    cell.work.workpiece =
        Isometry3::from_parts(Translation3::new(1.7, 0.9, 0.7), UnitQuaternion::from_euler_angles(0.0, 0.0, 0.3));
    cell.work.process = Some(Process::Constant(
        TipLoad { force: Vector3::new(-250.0, 150.0, 80.0), moment: Vector3::zeros(), axes },
        None,
    ));
    let corners = [[0.0, 0.0], [0.3, 0.0], [0.3, 0.2], [0.0, 0.2], [0.0, 0.0]];
    let mut points = Vec::new();
    for pair in corners.windows(2) {
        for i in 0..12 {
            let t = f64::from(i) / 12.0;
            let at = |k: usize| pair[0][k] + t * (pair[1][k] - pair[0][k]);
            let local = Isometry3::from_parts(Translation3::new(at(0), at(1), 0.05), down());
            let target = PathTarget::Pose(cell.work.workpiece * local);
            points.push(path_point(points.len() + 1, target));
        }
    }
    points
}

fn place_options() -> PlaceOptions {
    with(|o: &mut PlaceOptions| {
        o.lower = [1.1, -0.9, 0.7];
        o.upper = [2.3, 0.9, 0.7];
        o.steps = [5, 7, 1];
        o.yaws = vec![0.0, FRAC_PI_2];
    })
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
    for axes in [ForceAxes::Path, ForceAxes::Base, ForceAxes::Workpiece, ForceAxes::Tool] {
        let mut cell = default_cell();
        let points = rectangle(&mut cell, axes);
        let placement = search(&cell, &points, &place_options());
        let best = placement.best.as_ref().unwrap();
        assert_eq!(placement.given.status, Status::Reachable);
        assert_eq!(placement.searched_points, points.len());
        // Whatever the search does inside, its numbers are those of a walk along.
        for placed in [best, &placement.given] {
            let pose = Isometry3::from_parts(
                Translation3::from(placed.position_m),
                UnitQuaternion::from_euler_angles(
                    placed.roll_pitch_yaw[0],
                    placed.roll_pitch_yaw[1],
                    placed.roll_pitch_yaw[2],
                ),
            );
            let by = pose * cell.work.workpiece.inverse();
            let start = placed.start.clone().unwrap();
            let rms = walked(&cell, &points, &by, &start);
            assert!((rms / placed.deflection_rms_m.unwrap() - 1.0).abs() < 1e-9, "{axes:?}");
        }
        let rms = best.deflection_rms_m.unwrap();
        let gain = placement.gain.unwrap();
        assert!(gain > 1.0, "{gain}");
        assert!(close(gain, placement.given.deflection_rms_m.unwrap() / rms));
        let all = placement.candidates.iter().filter_map(|c| c.deflection_rms_m);
        let least = all.fold(f64::INFINITY, f64::min);
        assert!((rms / least - 1.0).abs() < 0.01, "{rms} {least}");
        // Finer rounds only go on from the best.
        let of = |round: usize| {
            let of = placement.candidates.iter().filter(move |c| c.round == round);
            of.filter_map(|c| c.deflection_rms_m).fold(f64::INFINITY, f64::min)
        };
        assert!(of(1) <= of(0) * (1.0 + 1e-12) && of(2) <= of(1) * (1.0 + 1e-12));
        assert_eq!(placement.candidates.iter().filter(|c| c.round == 0).count(), 70);
    }
}

#[test]
fn places_that_fail_say_where_and_why() {
    let mut cell = default_cell();
    let joints = cell.setup.robot.joints().iter();
    cell.bounds = joints.map(|joint| joint.limits).collect();
    let points = rectangle(&mut cell, ForceAxes::Path);
    let options = with(|o: &mut PlaceOptions| {
        o.lower = [0.7, 0.0, 0.7];
        o.upper = [3.5, 0.0, 0.7];
        o.steps = [8, 1, 1];
    });
    let placement = search(&cell, &points, &options);
    let status = |at: usize| placement.candidates[at].status;
    assert_eq!((status(0), status(7)), (Status::Forbidden, Status::Unreachable));
    for candidate in &placement.candidates {
        let works = candidate.status == Status::Reachable;
        assert_eq!(candidate.deflection_rms_m.is_some(), works);
        assert_eq!(candidate.reason.is_some() && candidate.point.is_some(), !works);
    }
    // Nowhere.
    let far = with(|o: &mut PlaceOptions| {
        o.lower = [4.0, 0.0, 0.7];
        o.upper = [5.0, 0.0, 0.7];
        o.steps = [3, 1, 1];
    });
    let placement = search(&cell, &points, &far);
    assert!(placement.best.is_none() && placement.gain.is_none());
    assert_eq!(placement.findings[0].code, "nowhere");
}

#[test]
fn places_keep_the_bounds_of_the_cell() {
    let mut cell = default_cell();
    let points = rectangle(&mut cell, ForceAxes::Path);
    let free = search(&cell, &points, &place_options());
    // Beside the best place.
    let best = free.best.unwrap();
    let turn = best.start.unwrap()[0];
    cell.bounds[0] = if turn > 0.0 { [-1.5, turn - 0.2] } else { [turn + 0.2, 1.5] };
    let placement = search(&cell, &points, &place_options());
    let other = placement.best.unwrap();
    let inside = |q: &[f64]| cell.outside_bounds(q).next().is_none();
    assert!(other.along.iter().all(|point| inside(&point.q)));
    assert!(other.deflection_rms_m.unwrap() > best.deflection_rms_m.unwrap());
}

#[test]
fn full_turns_are_chosen_for_the_whole_path() {
    // A circle of tool turns: 400° about the tool axis, which joint 6 must do in
    // one go within ±720°.
    let mut cell = default_cell();
    cell.work.workpiece = Isometry3::translation(1.8, 0.0, 0.8);
    let points: Vec<PathPoint> = (0..=100)
        .map(|i| {
            let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, f64::from(i) * 4_f64.to_radians());
            let pose = Isometry3::from_parts(Translation3::identity(), down() * turn);
            PathPoint {
                load: Some(TipLoad {
                    force: Vector3::new(0.0, 0.0, 300.0),
                    moment: Vector3::zeros(),
                    axes: ForceAxes::Base,
                }),
                ..path_point(i, PathTarget::Pose(cell.work.workpiece * pose))
            }
        })
        .collect();
    let options = with(|o: &mut PlaceOptions| {
        o.lower = [1.8, 0.0, 0.8];
        o.upper = [1.8, 0.0, 0.8];
    });
    // The cell's own bounds stop it.
    let placement = search(&cell, &points, &options);
    assert_eq!(placement.given.status, Status::OutsideJointLimits);
    insta::assert_snapshot!(placement.given.reason.as_deref().unwrap(), @"joint 6 would leave the cell's bounds by 4.4°");
    cell.bounds[5] = cell.setup.robot.joints()[5].limits;
    let placement = search(&cell, &points, &options);
    assert_eq!(placement.given.status, Status::Reachable, "{:?}", placement.given);
    assert!((placement.gain.unwrap() - 1.0).abs() < 1e-12);
    // Within ±200° there is no way.
    limit_joint(&mut cell, 5, [-190_f64.to_radians(), 190_f64.to_radians()]);
    let placement = search(&cell, &points, &options);
    assert_eq!(placement.given.status, Status::OutsideJointLimits, "{:?}", placement.given);
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
    let options = changed(place_options(), |o| o.refinements = 0);
    let placement = search(&cell, &free, &options);
    let fixed = search(&cell, &points, &options);
    let rms = |p: &Placement| p.best.as_ref().unwrap().deflection_rms_m.unwrap();
    assert!(placement.best.as_ref().unwrap().turn.is_some());
    assert!(rms(&placement) <= rms(&fixed) * 1.001);
    assert!(placement.given.deflection_rms_m <= fixed.given.deflection_rms_m.map(|r| 1.001 * r));
}

#[test]
fn long_paths_are_searched_thinned_and_judged_whole() {
    let mut cell = default_cell();
    let mut points = rectangle(&mut cell, ForceAxes::Base);
    // Each point ten times, the last with a load of its own.
    points = points.iter().flat_map(|p| (0..25).map(|_| p.clone())).collect();
    let last = points.len() - 7;
    points[last].name = "hit".into();
    points[last].load =
        Some(TipLoad { force: Vector3::new(0.0, 3000.0, 0.0), moment: Vector3::zeros(), axes: ForceAxes::Base });
    let options = changed(place_options(), |o| {
        o.steps = [3, 3, 1];
        o.yaws = vec![0.0];
        o.refinements = 0;
    });
    let placement = search(&cell, &points, &options);
    assert_eq!(placement.point_count, 1200);
    assert!(placement.searched_points <= 200, "{}", placement.searched_points);
    let best = placement.best.unwrap();
    assert_eq!(best.deflection_max_point.as_deref(), Some("hit"));
}
