//! What the kernel needs of a cell, computed once.

use crate::error::Result;
use crate::model::cell::{Cell, Limits, PointLimit};
use crate::model::dexterity;
use crate::model::load::{Axes, Load};
use crate::model::observation::PostureTerms;
use crate::numerics::information::symmetric_eigen;
use nalgebra::{DMatrix, Isometry3, Matrix3, Vector3};

/// A rotation by rows and a shift: where a joint stands in the frame before it.
#[derive(Debug, Clone)]
pub(super) struct Placement {
    pub rotation: [[f64; 3]; 3],
    pub shift: [f64; 3],
}

impl Placement {
    fn new(pose: &Isometry3<f64>) -> Self {
        let r = pose.rotation.to_rotation_matrix();
        let entry = |i: usize, j: usize| r[(i, j)];
        Placement { rotation: [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j))), shift: pose.translation.vector.into() }
    }
}

/// The load, its tool-axes vectors in the frame of the last joint.
#[derive(Debug, Clone)]
pub(super) enum KernelLoad {
    Rope { anchor: [f64; 3], magnitude: f64 },
    Base { force: [f64; 3], moment: [f64; 3] },
    Tool { force: [f64; 3], moment: [f64; 3] },
}

/// What is to be computed.
#[derive(Debug, Clone, Copy)]
pub struct KernelOutputs<'a> {
    /// k(J_N) with this characteristic length \[m\].
    pub dexterity: Option<f64>,
    /// Information, in units of `compliance` (1/k per spring) and whitened
    /// with this weight of the posture-common shift.
    pub information: Option<(&'a [f64], f64)>,
    /// Margins to the cell's limits.
    pub limits: bool,
}

/// Constants of robot, tool, load and limits; points are in the frame of the
/// last joint.
#[derive(Debug, Clone)]
pub(super) struct Model {
    pub joints: usize,
    pub offset: Vec<f64>,
    /// Row by row, only what is not zero: (column, factor).
    pub coupling: Vec<Vec<(usize, f64)>>,
    pub placements: Vec<Placement>,
    pub flange: [f64; 3],
    /// Rotation of the flange in the frame of the last joint, by rows.
    pub flange_rotation: [[f64; 3]; 3],
    pub loading_point: [f64; 3],
    pub measuring_points: Vec<[f64; 3]>,
    pub centroid: [f64; 3],
    /// Root of the effective number of measuring points, m(1 − ρm).
    pub root_count: f64,
    /// Symmetric root of the second moments of the measuring points about
    /// their centroid, Σ (|d|² I − d dᵀ).
    pub root_moments: [[f64; 3]; 3],
    /// Number of springs.
    pub springs: usize,
    /// n × springs where the springs are not the joints.
    pub mixing: Option<DMatrix<f64>>,
    pub compliance: Vec<f64>,
    pub load: KernelLoad,
    /// 1/L of Eq. (20).
    pub inverse_length: Option<f64>,
    pub has_information: bool,
    /// Limits on the points of the tool, and on the wrist centre.
    pub tool_limits: Vec<PointLimit>,
    pub wrist_limits: Vec<PointLimit>,
    pub rope_length: Option<[f64; 2]>,
    pub limit_count: usize,
}

impl Model {
    pub fn new(cell: &Cell, outputs: KernelOutputs<'_>) -> Result<Self> {
        let setup = &cell.setup;
        let robot = &setup.robot;
        let n = robot.joint_count();
        if outputs.dexterity.is_some() {
            dexterity::require_six_joints(robot)?;
        }
        // The module `observation` refuses a load that only a measurement gives.
        let middle: Vec<f64> = cell.bounds.iter().map(|b| 0.5 * (b[0] + b[1])).collect();
        PostureTerms::new(setup, &middle, None)?;
        let flange = robot.flange();
        let place = |p: &Vector3<f64>| -> [f64; 3] { (flange.rotation * p + flange.translation.vector).into() };
        let measuring_points: Vec<[f64; 3]> = setup.tool.measuring_points.iter().map(|p| place(&p.position)).collect();
        let m = measuring_points.len() as f64;
        let mut centroid = Vector3::zeros();
        for p in &measuring_points {
            centroid += Vector3::from(*p) / m;
        }
        let mut moments = Matrix3::zeros();
        for p in &measuring_points {
            let d = Vector3::from(*p) - centroid;
            moments += Matrix3::identity() * d.norm_squared() - d * d.transpose();
        }
        let (compliance, common_weight) = match outputs.information {
            Some((compliance, weight)) => (compliance.to_vec(), weight),
            None => (vec![1.0; robot.spring_count()], 0.0),
        };
        let direction = |v: &Vector3<f64>| -> [f64; 3] { (flange.rotation * v).into() };
        let load = match &setup.load {
            Load::Rope { anchor, magnitude } => KernelLoad::Rope { anchor: (*anchor).into(), magnitude: *magnitude },
            Load::Weight { magnitude, direction } => {
                KernelLoad::Base { force: (direction * *magnitude).into(), moment: [0.0; 3] }
            }
            Load::Constant { wrench, axes } => match axes {
                Axes::Base => KernelLoad::Base { force: wrench.force.into(), moment: wrench.moment.into() },
                Axes::Tool => KernelLoad::Tool { force: direction(&wrench.force), moment: direction(&wrench.moment) },
            },
            // Refused above.
            Load::Measured | Load::Cases(_) => KernelLoad::Base { force: [0.0; 3], moment: [0.0; 3] },
        };
        let coupling = (0..n)
            .map(|i| (0..n).map(|j| (j, robot.coupling()[(i, j)])).filter(|(_, c)| *c != 0.0).collect())
            .collect();
        let limits = if outputs.limits { cell.limits.clone() } else { Limits::default() };
        Ok(Model {
            joints: n,
            offset: robot.serial_angles(&vec![0.0; n]).iter().copied().collect(),
            coupling,
            placements: robot.joints().iter().map(|j| Placement::new(&j.placement)).collect(),
            flange: flange.translation.vector.into(),
            flange_rotation: Placement::new(flange).rotation,
            loading_point: place(&setup.tool.loading_point),
            measuring_points,
            centroid: centroid.into(),
            root_count: (m * (1.0 - common_weight * m)).max(0.0).sqrt(),
            root_moments: symmetric_root(&moments)?,
            springs: robot.spring_count(),
            mixing: robot.spring_mixing().cloned(),
            compliance,
            load,
            inverse_length: outputs.dexterity.map(|length| 1.0 / length),
            has_information: outputs.information.is_some(),
            limit_count: limits.count(setup),
            tool_limits: limits.on_points().filter(|limit| limit.holds_for(true)).collect(),
            wrist_limits: limits.on_points().filter(|limit| limit.holds_for(false)).collect(),
            rope_length: limits.rope_length,
        })
    }
}

/// Symmetric square root of a positive semidefinite matrix.
fn symmetric_root(matrix: &Matrix3<f64>) -> Result<[[f64; 3]; 3]> {
    let dynamic = DMatrix::from_iterator(3, 3, matrix.iter().copied());
    let (values, vectors) = symmetric_eigen(dynamic)
        .ok_or_else(|| crate::error::Error::new(crate::error::Code::NotFinite, "A measuring point is not finite."))?;
    let root = &vectors * DMatrix::from_diagonal(&values.map(|v| v.max(0.0).sqrt())) * vectors.transpose();
    Ok([0, 1, 2].map(|i| [0, 1, 2].map(|j| root[(i, j)])))
}
