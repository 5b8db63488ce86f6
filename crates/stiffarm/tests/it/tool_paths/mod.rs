//! Tool paths as programs: what is read, what is written, and how each slip is reported.

mod cl_data;
mod gcode;
mod interpreter;
mod kinds;
mod languages;
mod loads;
mod moves;
mod robots;
mod slips;
mod writing;

use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, UnitVector3, Vector3};
use stiffarm::model::cell::Cell;
use stiffarm::model::path::{PathPoint, PathTarget};
use stiffarm_files::cell::parse_cell;
use stiffarm_files::tool_path::{Kind, ReadPath, read_tool_path};

type Check = Result<(), Box<dyn std::error::Error>>;

/// A workpiece frame off every axis.
const WORK: &str =
    "[work]\ntip_mm = [0, 0, 300]\nworkpiece_mm = [1500.5, -200, 612.25]\nworkpiece_rpy_deg = [10, -20, 35]\n";

fn cell_with(more: &str) -> Cell {
    let text = format!(
        "format = 1\nrobot.catalogue = 'kuka-kr500-r2800-2'\n\
         tool = {{ loading_point_mm = [200, 0, 250], measuring_point = [{{ name = '1', position_mm = [0, 0, 300] }}] }}\n\
         load = {{ kind = 'measured' }}\n{WORK}{more}"
    );
    parse_cell(&text, "cell.toml").unwrap()
}

fn read_with(name: &str, text: &str, cell: &Cell) -> stiffarm::Result<ReadPath> {
    let kind = Kind::of(name).unwrap();
    read_tool_path(kind, (name, text.as_bytes()), None, cell)
}

fn read(name: &str, text: &str) -> stiffarm::Result<ReadPath> {
    read_with(name, text, &cell_with(""))
}

/// Position \[mm\] and direction from the tip to the spindle, in the workpiece frame.
fn on_workpiece(point: &PathPoint) -> (Vector3<f64>, Vector3<f64>) {
    let workpiece = cell_with("").work.workpiece;
    match &point.target {
        PathTarget::Pose(pose) => {
            let pose = workpiece.inverse() * pose;
            (1e3 * pose.translation.vector, -(pose.rotation * Vector3::z()))
        }
        PathTarget::Axis { position, axis } => {
            let position = workpiece.inverse_transform_point(&(*position).into());
            (1e3 * position.coords, -(workpiece.rotation.inverse() * axis.as_ref()))
        }
        PathTarget::Angles(_) => panic!("a program has no joint angles"),
    }
}

/// Positions of all points in the workpiece frame, to a nanometre \[mm\].
fn positions(read: &ReadPath) -> Vec<[f64; 3]> {
    rounded(&read.points)
}

fn rounded(points: &[PathPoint]) -> Vec<[f64; 3]> {
    let positions = points.iter().map(|point| on_workpiece(point).0);
    positions.map(|p| p.map(|x| (1e6 * x).round() / 1e6 + 0.0).into()).collect()
}

/// The points that the program states, without those on the way to them.
fn stated(read: &ReadPath) -> Vec<PathPoint> {
    let points = read.points.iter().enumerate();
    let stated = points.filter(|(i, _)| read.program.holds(*i));
    stated.map(|(_, point)| point.clone()).collect()
}

/// Directions from the tip to the spindle.
fn axes(points: &[PathPoint]) -> Vec<Vector3<f64>> {
    points.iter().map(|point| on_workpiece(point).1).collect()
}

fn codes(read: &ReadPath) -> Vec<&str> {
    read.findings.iter().map(|finding| finding.code.as_str()).collect()
}

/// Largest distance of positions \[m\] and of orientations \[rad\] between two paths of the same points.
fn apart(a: &[PathPoint], b: &[PathPoint]) -> (f64, f64) {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().zip(b).map(|(a, b)| match (&a.target, &b.target) {
        (PathTarget::Pose(a), PathTarget::Pose(b)) => {
            ((a.translation.vector - b.translation.vector).norm(), a.rotation.angle_to(&b.rotation))
        }
        _ => {
            let ((p, v), (q, w)) = (on_workpiece(a), on_workpiece(b));
            (1e-3 * (p - q).norm(), v.angle(&w))
        }
    });
    pairs.fold((0.0, 0.0), |most: (f64, f64), (p, v)| (most.0.max(p), most.1.max(v)))
}

/// The point moved by `shift` \[mm\] and turned by a rotation vector \[rad\], both in base axes.
fn moved(point: &PathPoint, shift: Vector3<f64>, turn: Vector3<f64>) -> PathPoint {
    let turn = UnitQuaternion::from_scaled_axis(turn);
    let pose = match &point.target {
        PathTarget::Pose(pose) => *pose,
        PathTarget::Axis { position, axis } => {
            let rotation = UnitQuaternion::rotation_between_axis(&Vector3::z_axis(), axis);
            let rotation =
                rotation.unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI).into());
            Isometry3::from_parts((*position).into(), rotation)
        }
        PathTarget::Angles(_) => panic!("a program has no joint angles"),
    };
    let position = pose.translation.vector + 1e-3 * shift;
    PathPoint {
        target: PathTarget::Pose(Isometry3::from_parts(Translation3::from(position), turn * pose.rotation)),
        ..point.clone()
    }
}

/// The path with its stated points moved: point by point `shift` \[mm\] and `turn` \[rad\] by their number; those between
/// are moved in proportion.
fn commanded(
    read: &ReadPath,
    shift: impl Fn(usize, &PathPoint) -> Vector3<f64>,
    turn: impl Fn(usize, &PathPoint) -> Vector3<f64>,
) -> Vec<PathPoint> {
    let points = &read.points;
    let places: Vec<Vector3<f64>> = points.iter().map(|point| on_workpiece(point).0).collect();
    let stated: Vec<usize> = (0..points.len()).filter(|i| read.program.holds(*i)).collect();
    let of = |k: usize| shift(k, &points[stated[k]]);
    let along = |from: usize, to: usize| -> f64 { (from..to).map(|i| (places[i + 1] - places[i]).norm()).sum() };
    let all = points.iter().enumerate().map(|(i, point)| match stated.binary_search(&i) {
        Ok(k) => moved(point, of(k), turn(k, point)),
        Err(k) => {
            let behind = k.min(stated.len() - 1);
            let (from, to) = (stated[k - 1], stated[behind]);
            let whole = along(from, to.max(i));
            let share = if whole > 0.0 { along(from, i) / whole } else { 0.0 };
            moved(point, of(k - 1).lerp(&of(behind), share), Vector3::zeros())
        }
    });
    all.collect()
}

fn unit(x: f64, y: f64, z: f64) -> Vector3<f64> {
    UnitVector3::new_normalize(Vector3::new(x, y, z)).into_inner()
}
