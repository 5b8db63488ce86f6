//! The simulated world: what displacements an experiment would have read.

use super::{CoverageCase, Estimator};
use crate::error::{Code, Error, Result};
use crate::estimate::identify::MeasuredSystem;
use crate::estimate::noise::normal;
use crate::estimate::simulate::ModelErrors;
use crate::model::cell::Cell;
use crate::model::load::Wrench;
use crate::model::measurement::{Displacement, MeasuredPosture};
use crate::model::observation::{ExtraTerm, PostureTerms};
use crate::model::posture::Posture;
use nalgebra::{DVector, Matrix3, Vector3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Draws of a compliance from its prior before it counts as impossible.
const MAX_DRAWS: usize = 1000;

/// Displacements that are grossly wrong: a share of them has errors of
/// another size (Tukey's contaminated normal distribution).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outliers {
    /// Share of the displacements (fraction).
    pub share: f64,
    /// Standard deviation of their further error, in σ.
    pub size: f64,
}

/// What the true compliances are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Truth {
    /// Those of the cell's prior.
    AsPrior,
    /// Drawn in each experiment from the normal distribution that the prior
    /// estimate assumes; a compliance at or below zero is drawn again.
    Drawn,
    /// So many standard deviations of the prior estimate off it, each joint to
    /// either side by chance.
    Off(f64),
}

/// What happens in an experiment beyond the cell's noise of single readings.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorModel {
    /// Load of each state as a fraction of the cell's load. The differences of
    /// one posture share one unloaded reading where the cell counts two
    /// readings for a displacement.
    pub load_states: Vec<f64>,
    /// τ/σ of a shift that the points of a posture share, in proportion to the load.
    pub common_ratio: f64,
    /// Gross errors.
    pub outliers: Option<Outliers>,
    /// Factor on the prior stiffness of each joint; empty for none.
    pub stiffness_factors: Vec<f64>,
    /// What the true compliances are.
    pub truth: Truth,
    /// Errors of force, angles and geometry; only with one load state.
    pub model_errors: ModelErrors,
    /// Angle by which each joint gives way without a spring \[rad\].
    pub lost_motion_rad: f64,
    /// True where readings have the errors of the cell's tracker (range and
    /// angles) in place of the cell's noise.
    pub tracker_errors: bool,
}

impl Default for ErrorModel {
    fn default() -> Self {
        ErrorModel {
            load_states: vec![1.0],
            common_ratio: 0.0,
            outliers: None,
            stiffness_factors: Vec::new(),
            truth: Truth::AsPrior,
            model_errors: ModelErrors::default(),
            lost_motion_rad: 0.0,
            tracker_errors: false,
        }
    }
}

/// One case made ready: everything that is the same in each experiment.
pub(super) struct Scene<'a> {
    cell: &'a Cell,
    postures: &'a [Posture],
    case: &'a CoverageCase,
    /// Postures and states with displacements of zero, as [`measured_system`]
    /// takes them.
    ///
    /// [`measured_system`]: crate::estimate::identify::measured_system
    measured: Vec<MeasuredPosture>,
    /// Compliances about which the truth lies \[rad/(N·m)\].
    compliance: Vec<f64>,
    /// Load of each state as a fraction of the largest.
    shares: Vec<f64>,
    /// Root of the covariance of a reading, posture by posture, state by
    /// state, point by point \[m\].
    roots: Vec<Matrix3<f64>>,
    /// Displacement by lost motion, rows as in the system \[m\].
    lost_motion: DVector<f64>,
}

impl<'a> Scene<'a> {
    pub(super) fn new(cell: &'a Cell, postures: &'a [Posture], case: &'a CoverageCase) -> Result<Self> {
        let world = &case.world;
        let prior = cell.require_prior()?;
        let factors = &world.stiffness_factors;
        check(world, prior.len())?;
        if world.truth != Truth::AsPrior && case.options.estimator != Estimator::Prior {
            let message = "True values that differ from the prior can be used only with the prior estimator.";
            return Err(Error::new(Code::Conflict, message));
        }
        let compliance =
            prior.iter().enumerate().map(|(j, k)| 1.0 / (k * factors.get(j).copied().unwrap_or(1.0))).collect();
        let largest = world.load_states.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
        let mut scene = Scene {
            cell,
            postures,
            case,
            measured: Vec::new(),
            compliance,
            shares: world.load_states.iter().map(|s| s / largest).collect(),
            roots: Vec::new(),
            lost_motion: DVector::zeros(0),
        };
        let mut lost = Vec::new();
        for posture in postures {
            let nominal = PostureTerms::new(&cell.setup, &posture.q, None)?;
            for (s, load) in world.load_states.iter().enumerate() {
                let wrench = Wrench { force: nominal.wrench().force * *load, moment: nominal.wrench().moment * *load };
                let terms = PostureTerms::new(&cell.setup, &posture.q, Some(&wrench))?;
                lost.extend_from_slice(gap(&terms, world.lost_motion_rad).as_slice());
                let displacements = terms
                    .measuring_points()
                    .iter()
                    .enumerate()
                    .map(|(point, at)| {
                        let (covariance, root) = scene.reading(at)?;
                        scene.roots.push(root);
                        Ok(Displacement { covariance, ..Displacement::new(point, Vector3::zeros()) })
                    })
                    .collect::<Result<Vec<_>>>()?;
                scene.measured.push(MeasuredPosture {
                    posture: posture.clone(),
                    state: format!("loaded-{}", s + 1),
                    wrench: Some(wrench),
                    preload: None,
                    common_readings: [0.0; 2],
                    servo_deflection: None,
                    displacements,
                });
            }
        }
        scene.lost_motion = DVector::from_vec(lost);
        Ok(scene)
    }

    /// Covariance that a displacement at `at` carries, and the root of the
    /// covariance with which readings there are drawn.
    fn reading(&self, at: &Vector3<f64>) -> Result<(Option<Matrix3<f64>>, Matrix3<f64>)> {
        let tracker = &self.cell.tracker;
        let plain = Matrix3::identity() * self.cell.noise.reading_variance.sqrt();
        let Some(accuracy) = &tracker.accuracy else {
            return if self.case.world.tracker_errors {
                Err(Error::new(Code::MissingKey, "Errors of the tracker need its accuracy, and the cell has none.")
                    .key("tracker"))
            } else {
                Ok((None, plain))
            };
        };
        let pose = tracker.base_from_tracker.unwrap_or_default();
        let turn = pose.rotation.to_rotation_matrix();
        let tracker_covariance = accuracy.covariance(&pose.inverse_transform_point(&(*at).into()).coords)?;
        let covariance = turn.matrix() * tracker_covariance * turn.matrix().transpose();
        let root = if self.case.world.tracker_errors {
            covariance
                .cholesky()
                .ok_or_else(|| {
                    let message = "The tracker's accuracy must be above zero along the beam and across.";
                    Error::invalid(message).key("tracker")
                })?
                .unpack()
        } else {
            plain
        };
        Ok((Some(covariance), root))
    }

    pub(super) fn measured(&self) -> &[MeasuredPosture] {
        &self.measured
    }

    /// Displacements without any error.
    pub(super) fn exact(&self, system: &MeasuredSystem) -> DVector<f64> {
        system.psi.columns(0, system.springs) * DVector::from_column_slice(&self.compliance)
    }

    /// True compliances of one experiment.
    pub(super) fn truth(&self, rng: &mut ChaCha8Rng) -> Vec<f64> {
        let spread = self.case.options.prior_std;
        let mut draw = |h: &f64| match self.case.world.truth {
            Truth::AsPrior => *h,
            Truth::Off(count) => {
                let side = if rng.random::<bool>() { 1.0 } else { -1.0 };
                h * (1.0 + side * count * spread)
            }
            Truth::Drawn => {
                (0..MAX_DRAWS).map(|_| h * (1.0 + spread * normal(rng))).find(|drawn| *drawn > 0.0).unwrap_or(*h)
            }
        };
        self.compliance.iter().map(&mut draw).collect()
    }

    /// Displacements that one experiment reads, rows as in the system \[m\].
    pub(super) fn displacements(
        &self,
        system: &MeasuredSystem,
        truth: &[f64],
        rng: &mut ChaCha8Rng,
    ) -> Result<DVector<f64>> {
        let world = &self.case.world;
        let noise = &self.cell.noise;
        let truth = DVector::from_column_slice(truth);
        let mut delta = system.psi.columns(0, system.springs) * &truth + &self.lost_motion;
        if !world.model_errors.is_exact() {
            delta += world.model_errors.draw(self.cell, self.postures, &truth, rng)?;
        }
        let points = self.cell.setup.tool.point_count();
        let states = self.shares.len();
        let sigma = noise.displacement_std();
        let mut row = 0;
        for p in 0..self.postures.len() {
            let shift = vector(rng) * (world.common_ratio * sigma);
            let root = |s: usize, a: usize| &self.roots[(p * states + s) * points + a];
            // One unloaded reading of each point serves all load states.
            let unloaded: Vec<Vector3<f64>> = (0..points)
                .map(|a| match noise.readings_per_displacement {
                    2 => root(0, a) * vector(rng),
                    _ => Vector3::zeros(),
                })
                .collect();
            for (s, share) in self.shares.iter().enumerate() {
                for (a, unloaded) in unloaded.iter().enumerate() {
                    let mut error = root(s, a) * vector(rng) - unloaded + shift * *share;
                    if let Some(outliers) = world.outliers {
                        // Both are drawn each time, hit or not.
                        let (gross, chance) = (vector(rng), rng.random::<f64>());
                        if chance < outliers.share {
                            error += gross * (outliers.size * sigma);
                        }
                    }
                    let mut rows = delta.fixed_rows_mut::<3>(row);
                    rows += error;
                    row += 3;
                }
            }
        }
        Ok(delta)
    }

    /// σ of a displacement component as repeats with these degrees of freedom
    /// would show it \[m\].
    pub(super) fn scatter(&self, degrees_of_freedom: usize, rng: &mut ChaCha8Rng) -> f64 {
        let squares: f64 = (0..degrees_of_freedom).map(|_| normal(rng).powi(2)).sum();
        self.cell.noise.displacement_std() * (squares / degrees_of_freedom as f64).sqrt()
    }
}

/// Three standard normal numbers.
fn vector(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| normal(rng))
}

/// Displacement of the measuring points when each joint gives way by `angle`
/// in the direction of its torque, 3m \[m\].
fn gap(terms: &PostureTerms, angle: f64) -> DVector<f64> {
    let mut out = DVector::zeros(3 * terms.measuring_points().len());
    if angle != 0.0 {
        for j in 0..terms.torque().len() {
            out += ExtraTerm::LostMotion(j).column(terms) * angle;
        }
    }
    out
}

fn check(world: &ErrorModel, springs: usize) -> Result<()> {
    let invalid = |message: &str| Err(Error::invalid(message));
    let loads = &world.load_states;
    if loads.is_empty() || loads.iter().any(|s| !s.is_finite() || *s == 0.0) {
        return invalid("An experiment needs load states, each a fraction that is not zero.");
    }
    let factors = &world.stiffness_factors;
    if !(factors.is_empty() || factors.len() == springs) {
        return Err(Error::new(Code::Dimension, format!("{} factors for {springs} joints.", factors.len())));
    }
    if factors.iter().any(|f| !(f.is_finite() && *f > 0.0)) {
        return invalid("A factor on the stiffness must be above zero.");
    }
    let sizes = [world.common_ratio, world.lost_motion_rad];
    let gross = world.outliers.map_or([0.0; 2], |o| [o.share, o.size]);
    if sizes.iter().chain(&gross).any(|v| !(v.is_finite() && *v >= 0.0)) {
        return invalid("The size of an error must be 0 or above.");
    }
    if loads.len() > 1 && !world.model_errors.is_exact() {
        let message = "Errors of the model are simulated with one load state only.";
        return Err(Error::new(Code::Conflict, message));
    }
    Ok(())
}
