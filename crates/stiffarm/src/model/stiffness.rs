//! From joint stiffness to Cartesian stiffness and deflection.
//!
//! Salisbury: K = J⁻ᵀ K_θ J⁻¹, Eq. (2). Chen & Kao (Int. J. Robot.
//! Res. 19(9), 2000, 835–847): K = J⁻ᵀ (K_θ − K_C) J⁻¹ with
//! (K_C)_ij = ∂Γ_i/∂θ_j at a constant base-frame wrench. K_C alone can worsen
//! a prediction, because the second-order kinematic term has the same size:
//! where it matters, [`equilibrium_displacement`] is the reference.

use crate::error::{Code, Error, Result};
use crate::model::kinematics::Frames;
use crate::model::load::{Load, Wrench};
use crate::model::observation::{PostureTerms, Setup};
use crate::model::robot::Robot;
use nalgebra::{DMatrix, DVector, DVectorView, Matrix6, Vector3, Vector6};
use serde::{Deserialize, Serialize};

/// Changes of θ below this, and below the rounding of the deflection, end the
/// equilibrium iteration \[rad\].
const EQUILIBRIUM_TOLERANCE: f64 = 1e-15;
/// Iterations after which the equilibrium counts as not found.
const EQUILIBRIUM_ITERATIONS: usize = 200;

/// How displacements are calculated from the joint stiffness.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// Linear, Eq. (7).
    Linear,
    /// Exact static equilibrium.
    #[default]
    Equilibrium,
}

impl Model {
    /// Name on the command line and in messages.
    pub fn as_str(self) -> &'static str {
        match self {
            Model::Linear => "linear",
            Model::Equilibrium => "equilibrium",
        }
    }
}

/// Joint compliance matrix K_θ⁻¹ in serial coordinates, n × n \[rad/(N·m)\]:
/// diag(1/k), or E⁻¹ diag(1/k) E⁻ᵀ in elastic coordinates.
///
/// # Errors
/// A wrong number of stiffness values, or one that is not positive.
pub fn joint_compliance(robot: &Robot, stiffness: &[f64]) -> Result<DMatrix<f64>> {
    let n = robot.spring_count();
    if stiffness.len() != n {
        return Err(Error::new(
            Code::Dimension,
            format!("{} stiffness values for the {n} joints of {}.", stiffness.len(), robot.name()),
        ));
    }
    if let Some(j) = stiffness.iter().position(|k| !(k.is_finite() && *k > 0.0)) {
        return Err(Error::invalid(format!(
            "The stiffness of {} must be a finite number above zero.",
            robot.spring_names()[j]
        )));
    }
    let springs: Vec<f64> = stiffness.iter().map(|k| 1.0 / k).collect();
    Ok(compliance_of_springs(robot, &springs))
}

/// The same from the compliances H of the springs \[rad/(N·m)\].
pub(crate) fn compliance_of_springs(robot: &Robot, springs: &[f64]) -> DMatrix<f64> {
    let diagonal = DMatrix::from_diagonal(&DVector::from_column_slice(springs));
    match robot.spring_mixing() {
        None => diagonal,
        Some(mixing) => mixing * diagonal * mixing.transpose(),
    }
}

/// K_C, n × n \[N·m/rad\]: (K_C)_ij = ∂Γ_i/∂θ_j for the constant base-frame
/// wrench `terms` carries, at the loading point.
pub fn stiffness_correction(terms: &PostureTerms) -> DMatrix<f64> {
    let n = terms.torque().len();
    let axes = terms.frames().axes();
    let (force, moment) = (terms.wrench().force, terms.wrench().moment);
    DMatrix::from_fn(n, n, |i, j| {
        // ∂c_i/∂θ_j = z_min × c_max; ∂z_i/∂θ_j = z_j × z_i for j < i.
        let linear = axes[i.min(j)].cross(&terms.loading_columns[i.max(j)]).dot(&force);
        let angular = if j < i { axes[j].cross(&axes[i]).dot(&moment) } else { 0.0 };
        linear + angular
    })
}

/// What a rope adds to K_C because its direction turns with the loading
/// point: −(G/ℓ) Jᵀ(I − u uᵀ)J, n × n \[N·m/rad\]; zero for other loads.
pub fn rope_correction(load: &Load, terms: &PostureTerms) -> DMatrix<f64> {
    let n = terms.torque().len();
    let Load::Rope { anchor, magnitude } = load else {
        return DMatrix::zeros(n, n);
    };
    let rope = anchor - terms.loading_point();
    let length = rope.norm();
    if length <= f64::MIN_POSITIVE {
        return DMatrix::zeros(n, n);
    }
    let unit = rope / length;
    DMatrix::from_fn(n, n, |i, j| {
        let (a, b) = (&terms.loading_columns[i], &terms.loading_columns[j]);
        -magnitude / length * (a.dot(b) - a.dot(&unit) * b.dot(&unit))
    })
}

/// Cartesian compliance J (K_θ − K_C)⁻¹ Jᵀ at the base-frame point `p`, 6 × 6:
/// rows and columns \[linear; angular\], base axes. `correction` is K_C (n × n)
/// or `None` for Salisbury's model, Eq. (3).
///
/// # Errors
/// As [`joint_compliance`]; K_θ − K_C singular.
pub fn cartesian_compliance(
    robot: &Robot,
    frames: &Frames,
    p: &Vector3<f64>,
    stiffness: &[f64],
    correction: Option<&DMatrix<f64>>,
) -> Result<Matrix6<f64>> {
    let compliance = corrected_compliance(robot, stiffness, correction)?;
    let jacobian = frames.jacobian(p);
    Ok(&jacobian * compliance * jacobian.transpose())
}

/// Cartesian stiffness K = J⁻ᵀ (K_θ − K_C) J⁻¹ at `p`, 6 × 6, base axes:
/// blocks \[N/m\], \[N/rad\], \[N·m/m\], \[N·m/rad\]. `None` where J has no
/// full row rank (a singular posture, or fewer than six joints).
///
/// # Errors
/// As [`cartesian_compliance`].
pub fn cartesian_stiffness(
    robot: &Robot,
    frames: &Frames,
    p: &Vector3<f64>,
    stiffness: &[f64],
    correction: Option<&DMatrix<f64>>,
) -> Result<Option<Matrix6<f64>>> {
    if crate::model::dexterity::condition_number(frames, p, 1.0).is_none() {
        return Ok(None);
    }
    Ok(cartesian_compliance(robot, frames, p, stiffness, correction)?.try_inverse())
}

fn corrected_compliance(robot: &Robot, stiffness: &[f64], correction: Option<&DMatrix<f64>>) -> Result<DMatrix<f64>> {
    corrected(&joint_compliance(robot, stiffness)?, correction)
}

/// (K_θ − K_C)⁻¹ from K_θ⁻¹.
///
/// # Errors
/// K_θ − K_C is singular.
pub(crate) fn corrected(compliance: &DMatrix<f64>, correction: Option<&DMatrix<f64>>) -> Result<DMatrix<f64>> {
    let Some(correction) = correction else {
        return Ok(compliance.clone());
    };
    // (K − K_C)⁻¹ = (I − K⁻¹ K_C)⁻¹ K⁻¹, which needs no inverse of K⁻¹.
    let n = compliance.nrows();
    (DMatrix::identity(n, n) - compliance * correction)
        .lu()
        .solve(compliance)
        .ok_or_else(|| Error::invalid("K_θ − K_C is singular: the load would buckle the arm."))
}

/// Displacement of a point fixed to the flange by the linear model, Eq. (7),
/// Δ = J^m (K_θ − K_C)⁻¹ (J^f)ᵀ W: \[shift (m); rotation vector (rad)\], base
/// axes. `p` is in the base frame \[m\].
///
/// # Errors
/// As [`cartesian_compliance`].
pub fn linear_displacement(
    setup: &Setup,
    terms: &PostureTerms,
    p: &Vector3<f64>,
    stiffness: &[f64],
    correction: Option<&DMatrix<f64>>,
) -> Result<Vector6<f64>> {
    let compliance = corrected_compliance(&setup.robot, stiffness, correction)?;
    // Δq = K_θ⁻¹ Γ, Eq. (5); Δ = J^m Δq, Eq. (6).
    let deflection = compliance * DVector::from_column_slice(terms.torque());
    let moved = terms.frames().jacobian(p) * deflection;
    Ok(Vector6::from_iterator(moved.iter().copied()))
}

/// Static equilibrium of the loaded arm: θ = θ₀ + K_θ⁻¹ J(θ)ᵀ W(θ).
#[derive(Debug, Clone)]
pub struct Equilibrium {
    /// The arm at equilibrium: joint frames, points, torques.
    pub terms: PostureTerms,
    /// Joint deflections θ − θ₀ \[rad\].
    pub deflection: DVector<f64>,
    /// Iterations used.
    pub iterations: usize,
}

impl Equilibrium {
    /// Joint frames at equilibrium.
    pub fn frames(&self) -> &Frames {
        self.terms.frames()
    }

    /// Wrench at the loading point at equilibrium.
    pub fn wrench(&self) -> &Wrench {
        self.terms.wrench()
    }
}

/// Finds the equilibrium at controller angles `q` \[rad\] by iterating
/// θ ← θ₀ + K_θ⁻¹ J(θ)ᵀ W(θ). The load's direction follows the loading point, also
/// where `wrench` is the load's own at `q` with another size (a load state of a
/// rope); any other `wrench`, as a measured one, keeps its direction.
///
/// # Errors
/// As [`joint_compliance`] and [`PostureTerms::new`]; no convergence, which
/// happens only where the load is of the order that buckles the arm.
pub fn equilibrium(setup: &Setup, q: &[f64], stiffness: &[f64], wrench: Option<&Wrench>) -> Result<Equilibrium> {
    let compliance = joint_compliance(&setup.robot, stiffness)?;
    let mut terms = PostureTerms::new(setup, q, wrench)?;
    let (deflection, iterations) = settle(setup, &compliance, &mut terms, wrench)?;
    Ok(Equilibrium { terms, deflection, iterations })
}

/// Moves the unloaded arm's `terms` to the same for a compliance matrix K_θ⁻¹ (n × n); the joint deflections \[rad\]
/// and the iterations used.
///
/// # Errors
/// No convergence.
pub(crate) fn settle(
    setup: &Setup,
    compliance: &DMatrix<f64>,
    terms: &mut PostureTerms,
    wrench: Option<&Wrench>,
) -> Result<(DVector<f64>, usize)> {
    let (frames, at) = (terms.frames(), terms.loading_point());
    let following = wrench.and_then(|wrench| setup.load.following(frames, at, wrench));
    match following {
        Some(load) => {
            let setup = Setup { load, ..setup.clone() };
            iterate(&setup, compliance, terms, None)
        }
        None => iterate(setup, compliance, terms, wrench),
    }
}

/// The fixed point, with the load of `setup` or a `wrench` that keeps its direction.
fn iterate(
    setup: &Setup,
    compliance: &DMatrix<f64>,
    terms: &mut PostureTerms,
    wrench: Option<&Wrench>,
) -> Result<(DVector<f64>, usize)> {
    let start = DVector::from_column_slice(terms.frames().serial_angles());
    let mut deflection = DVector::zeros(start.len());
    let (mut next, mut theta) = (deflection.clone(), start.clone());
    for iterations in 1..=EQUILIBRIUM_ITERATIONS {
        next.gemv(1.0, compliance, &DVectorView::from_slice(terms.torque(), start.len()), 0.0);
        deflection -= &next;
        let change = deflection.amax();
        deflection.copy_from(&next);
        theta.copy_from(&start);
        theta += &deflection;
        terms.frames.move_to_serial_angles(&setup.robot, theta.as_slice());
        terms.fill(setup, wrench)?;
        if !change.is_finite() {
            break;
        }
        if change <= EQUILIBRIUM_TOLERANCE + 4.0 * f64::EPSILON * deflection.amax() {
            return Ok((deflection, iterations));
        }
    }
    Err(Error::invalid("The loaded arm has no stable equilibrium near this posture.")
        .hint("check the load's magnitude and the unit of the joint stiffness (N·m/rad)"))
}

/// Displacement of a flange-fixed point by the exact equilibrium: difference
/// of forward kinematics \[shift (m); rotation vector (rad)\], base axes.
/// `in_flange` is in flange axes \[m\].
///
/// # Errors
/// As [`equilibrium`].
pub fn equilibrium_displacement(
    setup: &Setup,
    q: &[f64],
    in_flange: &Vector3<f64>,
    stiffness: &[f64],
    wrench: Option<&Wrench>,
) -> Result<Vector6<f64>> {
    let before = Frames::new(&setup.robot, q);
    let after = equilibrium(setup, q, stiffness, wrench)?;
    Ok(displacement_between(&before, after.frames(), in_flange))
}

/// Displacement of a flange-fixed point from one set of frames to another:
/// \[shift (m); rotation vector (rad)\], base axes. `in_flange` is in flange
/// axes \[m\].
pub fn displacement_between(before: &Frames, after: &Frames, in_flange: &Vector3<f64>) -> Vector6<f64> {
    let shift = after.point(in_flange) - before.point(in_flange);
    let turn = (after.flange().rotation * before.flange().rotation.inverse()).scaled_axis();
    Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}

/// What the linear model leaves out at one posture, point by point \[m\].
#[derive(Debug, Clone, PartialEq)]
pub struct SecondOrder {
    /// Norm of the displacement by the linear model, Eq. (7).
    pub displacement: Vec<f64>,
    /// Norm of the change that K_C alone makes to it.
    pub correction: Vec<f64>,
    /// Norm of the difference of the exact equilibrium to the linear model.
    pub linearisation: Vec<f64>,
}

/// Share of K_C and of the equilibrium in the displacements of the measuring
/// points at the controller angles `q` \[rad\].
///
/// # Errors
/// As [`equilibrium`] and [`cartesian_compliance`].
pub fn second_order(setup: &Setup, q: &[f64], stiffness: &[f64], wrench: Option<&Wrench>) -> Result<SecondOrder> {
    let terms = PostureTerms::new(setup, q, wrench)?;
    let k_c = stiffness_correction(&terms);
    let after = equilibrium(setup, q, stiffness, wrench)?;
    let mut out = SecondOrder { displacement: Vec::new(), correction: Vec::new(), linearisation: Vec::new() };
    let norm = |d: Vector6<f64>| d.fixed_rows::<3>(0).norm();
    for (point, p) in setup.tool.measuring_points.iter().zip(terms.measuring_points()) {
        let linear = linear_displacement(setup, &terms, p, stiffness, None)?;
        let corrected = linear_displacement(setup, &terms, p, stiffness, Some(&k_c))?;
        let exact = displacement_between(terms.frames(), after.frames(), &point.position);
        out.displacement.push(norm(linear));
        out.correction.push(norm(corrected - linear));
        out.linearisation.push(norm(exact - linear));
    }
    Ok(out)
}
