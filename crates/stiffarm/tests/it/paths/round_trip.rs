//! Any path that is written is read again.

use super::*;
use crate::common::cases;
use crate::common::set_ups::path_point;

/// Numbers of few decimals, as controllers show them, or of many.
fn number(largest: f64) -> impl Strategy<Value = f64> {
    let few = move |n: f64| (n * largest * 1e3).round() / 1e3;
    prop_oneof![(-1.0..1.0f64).prop_map(few), -largest..largest, Just(0.0), Just(largest)]
}

fn vector(largest: f64) -> impl Strategy<Value = Vector3<f64>> {
    [number(largest), number(largest), number(largest)].prop_map(Vector3::from)
}

fn load() -> impl Strategy<Value = Option<TipLoad>> {
    let axes = prop::sample::select(ForceAxes::NAMES.map(|(_, axes)| axes).to_vec());
    let load = (vector(1e3), vector(50.0), axes).prop_map(|(force, moment, axes)| TipLoad { force, moment, axes });
    prop::option::of(load)
}

/// Poses, many of them at or near a pitch of ±90° and half turns.
fn pose() -> impl Strategy<Value = PathTarget> {
    let pitch = prop_oneof![
        number(90.0),
        Just(-90.0),
        Just(90.0 - 1e-6),
        Just(89.9),
        (0.0..12.0f64).prop_map(|d| 90.0 - 10f64.powf(-d)),
    ];
    (vector(3.0), number(180.0), pitch, number(180.0)).prop_map(|(position, roll, pitch, yaw)| {
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::to_radians);
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        PathTarget::Pose(Isometry3::from_parts(Translation3::from(position), rotation))
    })
}

fn tool_axis() -> impl Strategy<Value = PathTarget> {
    let axis = vector(1.0).prop_map(|v| UnitVector3::try_new(v, 1e-3).unwrap_or(Vector3::z_axis()));
    (vector(3.0), axis).prop_map(|(position, axis)| PathTarget::Axis { position, axis })
}

fn angles() -> impl Strategy<Value = PathTarget> {
    // Within the limits of all joints.
    let q = [number(75.0), number(45.0), number(40.0), number(180.0), number(100.0), number(180.0)];
    q.prop_map(|q| {
        let mut q = q.map(f64::to_radians);
        q[2] -= 100f64.to_radians();
        PathTarget::Angles(q.to_vec())
    })
}

fn path(target: impl Strategy<Value = PathTarget>) -> impl Strategy<Value = Vec<PathPoint>> {
    prop::collection::vec((target, load()), 1..6).prop_map(|points| {
        let points = points.into_iter().enumerate();
        let points = points.map(|(i, (target, load))| PathPoint {
            line: Some(i + 2),
            load,
            ..path_point(format!("P{i}"), target)
        });
        // Far from the base, or the size would be doubted.
        let mut points: Vec<PathPoint> = points.collect();
        match &mut points[0].target {
            PathTarget::Pose(pose) => pose.translation.vector.x = 1.5,
            PathTarget::Axis { position, .. } => position.x = 1.5,
            PathTarget::Angles(_) => {}
        }
        points
    })
}

/// Writes, reads, compares, writes again.
fn check(points: &[PathPoint], kind: PathKind, cell: &Cell) -> Result<(), TestCaseError> {
    let format = PathFormat::new(kind, cell).with_loads(cell);
    let text = write_path(&format, points).unwrap();
    let table = read(&text, cell).unwrap();
    prop_assert_eq!(&table.format, &format);
    prop_assert_eq!(table.points.len(), points.len());
    for (read, written) in table.points.iter().zip(points) {
        prop_assert_eq!(&read.name, &written.name);
        prop_assert_eq!(&read.load, &written.load);
        match (&read.target, &written.target) {
            (PathTarget::Angles(read), PathTarget::Angles(written)) => {
                for (a, b) in read.iter().zip(written) {
                    // Degrees do not reach every double; see `rad_to_shortest_deg`.
                    prop_assert!((a - b).abs() <= 2.0 * f64::EPSILON * b.abs());
                }
            }
            (PathTarget::Pose(read), PathTarget::Pose(written)) => {
                let apart = (read.translation.vector - written.translation.vector).norm();
                prop_assert!(apart < 1e-12, "{}", apart);
                let turn = read.rotation.angle_to(&written.rotation);
                prop_assert!(turn < 2e-11, "{}", turn);
            }
            (PathTarget::Axis { position: p, axis: a }, PathTarget::Axis { position, axis }) => {
                prop_assert!((p - position).norm() < 1e-12);
                prop_assert!((a.as_ref() - axis.as_ref()).norm() < 2e-12);
                prop_assert!((a.norm() - 1.0).abs() < 1e-15);
            }
            other => prop_assert!(false, "{:?}", other),
        }
    }
    prop_assert_eq!(write_path(&table.format, &table.points).unwrap(), text);
    Ok(())
}

/// The heading, and a row that every unit allows.
fn few_rows(text: &str) -> String {
    let heading = text.lines().next().unwrap_or_default();
    format!("{heading}\nP0,1,2,3,0.1,0.2,0.3\n")
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn written_angles_are_read_and_written_again(points in path(angles())) {
        check(&points, PathKind::Angles, &cell_with(""))?;
    }

    #[test]
    fn written_poses_are_read_and_written_again(points in path(pose())) {
        check(&points, PathKind::Poses, &cell_with(""))?;
        check(&points, PathKind::Poses, &cell_with(WORKPIECE))?;
        // In radians, metres and inches, too.
        let cell = cell_with(WORKPIECE);
        let text = write_path(&PathFormat::new(PathKind::Poses, &cell), &points).unwrap();
        let text = text.replace("_deg", "_rad").replace("_mm", "_in");
        let table = PathTable { points: points.clone(), ..read(&few_rows(&text), &cell).unwrap() };
        let text = write_path(&table.format, &points).unwrap();
        let again = read(&text, &cell).unwrap();
        prop_assert_eq!(write_path(&again.format, &again.points).unwrap(), text);
    }

    #[test]
    fn written_tool_axes_are_read_and_written_again(points in path(tool_axis())) {
        check(&points, PathKind::ToolAxes, &cell_with(""))?;
        check(&points, PathKind::ToolAxes, &cell_with(WORKPIECE))?;
    }
}
