//! Where the arm is: poses, Jacobians, and the postures of a pose.

use crate::arrays::array;
use crate::cell::{PyCell, rows};
use crate::error::{Raised, to_python};
use nalgebra::{DMatrix, Isometry3, Matrix3, Matrix4, Rotation3, UnitQuaternion, Vector3};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use stiffarm::model::inverse::InverseKinematics;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::observation::check_angles;
use stiffarm::model::robot::{DhConvention, DhRobot, JointAxis, rows_of_axes};
use stiffarm::{Code, Error, Result};
use stiffarm_files::cell::robot_table;
use stiffarm_files::urdf::{UrdfOptions, read_urdf};

/// How far a rotation matrix may be from one.
const ROTATION: f64 = 1e-6;

/// A pose of a 4 × 4 array \[m\].
fn pose(matrix: &PyReadonlyArray2<'_, f64>) -> Result<Isometry3<f64>> {
    let is_pose = matrix.shape() == [4, 4];
    let values = matrix
        .as_slice()
        .ok()
        .filter(|_| is_pose)
        .ok_or_else(|| Error::new(Code::Dimension, "A pose is an array of 4 rows and 4 columns."))?;
    if values.iter().any(|v| !v.is_finite()) {
        return Err(Error::new(Code::NotFinite, "The pose is not finite."));
    }
    let m = Matrix4::from_row_slice(values);
    let turn: Matrix3<f64> = m.fixed_view::<3, 3>(0, 0).into();
    let is_turn = (turn * turn.transpose() - Matrix3::identity()).amax() < ROTATION
        && turn.determinant() > 0.0
        && (m.row(3) - Matrix4::<f64>::identity().row(3)).amax() < ROTATION;
    if !is_turn {
        let message = "The upper left 3 × 3 part of a pose must be a rotation, its last row 0, 0, 0, 1.";
        return Err(Error::invalid(message));
    }
    let shift = Vector3::new(m[(0, 3)], m[(1, 3)], m[(2, 3)]);
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn));
    Ok(Isometry3::from_parts(shift.into(), turn))
}

fn matrix<'py>(py: Python<'py>, pose: &Isometry3<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let m = pose.to_homogeneous();
    rows(py, 4, m.transpose().iter().copied())
}

/// Frames at the angles `q` \[rad\].
fn frames(cell: &PyCell, q: &PyReadonlyArray1<'_, f64>) -> Result<Frames> {
    let robot = &cell.cell.setup.robot;
    let q = q.as_slice().map_err(|_| Error::new(Code::Dimension, "The angles are not one row of numbers."))?;
    check_angles(robot, q)?;
    Ok(Frames::new(robot, q))
}

/// A point in flange axes \[m\].
fn point(at: Option<[f64; 3]>) -> Vector3<f64> {
    at.map_or_else(Vector3::zeros, Vector3::from)
}

/// Pose of the flange in the base frame.
#[pyfunction]
pub fn flange_pose<'py>(
    py: Python<'py>,
    cell: &PyCell,
    q: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    matrix(py, frames(cell, &q).raised(py)?.flange())
}

/// Jacobian by the controller angles at a point of the flange: three rows of translation, three of rotation,
/// base axes.
#[pyfunction]
#[pyo3(signature = (cell, q, at=None))]
pub fn jacobian<'py>(
    py: Python<'py>,
    cell: &PyCell,
    q: PyReadonlyArray1<'py, f64>,
    at: Option<[f64; 3]>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let frames = frames(cell, &q).raised(py)?;
    let serial = frames.jacobian(&frames.point(&point(at)));
    let jacobian = serial * cell.cell.setup.robot.coupling();
    array(py, DMatrix::from_column_slice(6, jacobian.ncols(), jacobian.as_slice()))
}

/// A posture of a pose: controller angles, whether within the machine's limits, condition number, whether singular.
type Branch<'py> = (Bound<'py, PyArray1<f64>>, bool, f64, bool);

/// The postures that hold the flange at a pose.
#[pyfunction]
pub fn inverse<'py>(
    py: Python<'py>,
    cell: &PyCell,
    flange: PyReadonlyArray2<'py, f64>,
) -> PyResult<(&'static str, Vec<Branch<'py>>)> {
    let flange = pose(&flange).raised(py)?;
    let robot = &cell.cell.setup.robot;
    let (method, branches) = py.detach(|| {
        let inverse = InverseKinematics::new(robot);
        (inverse.method().as_str(), inverse.branches(&flange))
    });
    let branches = branches.raised(py)?.into_iter().map(|branch| {
        let q = PyArray1::from_vec(py, branch.q);
        (q, branch.within_limits, branch.condition, branch.singular)
    });
    Ok((method, branches.collect()))
}

/// The posture within the machine's limits nearest to `start` \[rad\].
#[pyfunction]
pub fn nearest<'py>(
    py: Python<'py>,
    cell: &PyCell,
    flange: PyReadonlyArray2<'py, f64>,
    start: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let flange = pose(&flange).raised(py)?;
    let start = start.as_slice()?;
    let inverse = InverseKinematics::new(&cell.cell.setup.robot);
    let q = inverse.nearest(&flange, start).raised(py)?;
    Ok(PyArray1::from_vec(py, q))
}

/// The `[robot]` table of a URDF as JSON, with the link names of base and flange and what to know.
#[pyfunction]
#[pyo3(signature = (text, name, base=None, tip=None))]
pub fn urdf_table(
    py: Python<'_>,
    text: &str,
    name: &str,
    base: Option<String>,
    tip: Option<String>,
) -> PyResult<(String, String, String, Vec<String>)> {
    let read = read_urdf(text, name, &UrdfOptions { base, tip }).raised(py)?;
    let findings = read.findings.iter().map(|f| f.sentence.clone()).collect();
    let table = table(&read.robot).raised(py)?;
    Ok((table, read.base_link, read.tip_link, findings))
}

/// The `[robot]` table of joint axes as JSON: points on them \[m\] and directions at zero angles in the base frame,
/// the flange's pose there.
#[pyfunction]
#[pyo3(signature = (name, joint_names, points, directions, flange, limits=None))]
pub fn axes_table(
    py: Python<'_>,
    name: String,
    joint_names: Vec<String>,
    points: Vec<[f64; 3]>,
    directions: Vec<[f64; 3]>,
    flange: PyReadonlyArray2<'_, f64>,
    limits: Option<Vec<[f64; 2]>>,
) -> PyResult<String> {
    let flange = pose(&flange).raised(py)?;
    let made = || -> Result<String> {
        let n = joint_names.len();
        if points.len() != n || directions.len() != n || limits.as_ref().is_some_and(|l| l.len() != n) {
            let message = "Names, points, directions and limits must be as many as joints.";
            return Err(Error::new(Code::Dimension, message));
        }
        let axes: Result<Vec<JointAxis>> = points
            .iter()
            .zip(&directions)
            .map(|(point, direction)| {
                let direction = Vector3::from(*direction);
                let unit = direction.try_normalize(f64::MIN_POSITIVE);
                let finite = point.iter().chain(direction.iter()).all(|v| v.is_finite());
                unit.filter(|_| finite)
                    .map(|direction| JointAxis { point: Vector3::from(*point), direction })
                    .ok_or_else(|| {
                        let message = "A joint axis needs finite numbers and a direction that is not zero.";
                        Error::invalid(message)
                    })
            })
            .collect();
        let rows = rows_of_axes(&axes?, &flange);
        table(&DhRobot {
            name,
            convention: DhConvention::Modified,
            rows: rows.rows,
            tilts: rows.tilts,
            joint_names,
            limits,
            coupling: DMatrix::identity(n, n),
            base: rows.base,
            flange: rows.flange,
            speeds: None,
            maker: None,
        })
    };
    made().map_err(|error| to_python(py, &error))
}

fn table(robot: &DhRobot) -> Result<String> {
    let table = robot_table(robot)?;
    serde_json::to_string(&table).map_err(|e| Error::new(Code::Internal, format!("A robot cannot be written: {e}.")))
}
