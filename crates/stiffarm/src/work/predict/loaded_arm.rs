//! The arm at work: what a load at the tool tip does to it, exactly and to
//! first order, and how that depends on the identified compliances.
//!
//! A wrench that keeps its direction. The process pushes on the workpiece's
//! side of the contact; what the tilt of a tool by a milliradian changes in the
//! direction of its force is second order and not known any better.

use crate::error::{Code, Error, Result};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::model::cell::Cell;
use crate::model::kinematics::Frames;
use crate::model::load::{Load, Wrench};
use crate::model::observation::{Elements, ExtraTerm, PostureTerms, Setup};
use crate::model::robot::Robot;
use crate::model::stiffness::{compliance_of_springs, settle};
use crate::model::tool::{NamedPoint, Tool};
use crate::numerics::control::Control;
use crate::numerics::information::ZERO_COLUMN;
use crate::numerics::jobs::in_blocks;
use crate::work::at_work::AtWork;
use nalgebra::{DMatrix, DVector, Isometry3, Matrix6, UnitQuaternion, Vector3, Vector6};

/// An arm with its springs, loaded at the tool tip unless
/// [`loaded_at`](Self::loaded_at) or [`loaded_by`](Self::loaded_by) says otherwise.
///
/// The deflection is the static equilibrium of the springs, in which the wrench
/// keeps its direction in the base frame and acts at the moving tip; the cell's
/// own load follows its loading point ([`loaded_by`](Self::loaded_by)). A series
/// compliance between flange and tip, and extra terms that were identified
/// (tilts, lost motion), are added as small motions under the loads of the
/// equilibrium.
#[derive(Debug, Clone)]
pub struct LoadedArm {
    /// Loaded and measured at the tip.
    setup: Setup,
    tip: Isometry3<f64>,
    /// K_θ⁻¹ in serial coordinates, n × n.
    compliance: DMatrix<f64>,
    /// The extra terms.
    extra: Vec<ExtraTerm>,
    /// The same with their values.
    elements: Elements,
    /// Unknowns that nothing bounds.
    undetermined: Vec<usize>,
    at_work: AtWork,
}

/// What a load does to the tip.
#[derive(Debug, Clone, PartialEq)]
pub struct Deflection {
    /// Tip pose without load, base frame \[m\].
    pub before: Isometry3<f64>,
    /// Tip pose under the load.
    pub after: Isometry3<f64>,
    /// \[shift (m); rotation vector (rad)\], base axes, at equilibrium.
    pub displacement: Vector6<f64>,
    /// The same by the linear model, Eq. (7).
    pub linear: Vector6<f64>,
}

impl LoadedArm {
    /// The arm of `cell` with the values of `predictor`.
    ///
    /// Compliances count as they came out, below zero also.
    ///
    /// # Errors
    /// Values of another number of springs, or one that is not finite.
    pub fn new(cell: &Cell, predictor: &IdentifiedCompliance) -> Result<Self> {
        let robot = &cell.setup.robot;
        let springs = robot.spring_count();
        let values = &predictor.values;
        if values.len() != springs + predictor.extra.len() {
            let message = format!("{} values for the {springs} joints of the cell.", values.len());
            return Err(Error::new(Code::Dimension, message));
        }
        if values.iter().any(|h| !h.is_finite()) {
            let message = "A compliance is not a finite number.";
            return Err(Error::new(Code::NotFinite, message));
        }
        let tip = cell.work.tip(&cell.setup.tool);
        Ok(LoadedArm {
            setup: at_tip(cell, &tip),
            compliance: compliance_of_springs(robot, values.rows(0, springs).as_slice()),
            elements: Elements::new(&predictor.extra, &values.as_slice()[springs..], robot.joint_count()),
            extra: predictor.extra.clone(),
            undetermined: predictor.undetermined.clone(),
            at_work: AtWork::new(cell, &tip),
            tip,
        })
    }

    /// The same loaded at another point, in flange axes \[m\]: wrenches act there
    /// and not at the tip.
    #[must_use]
    pub fn loaded_at(mut self, point: Vector3<f64>) -> Self {
        self.setup.tool.loading_point = point;
        self
    }

    /// The same under the load of `cell` at its loading point: a wrench that is
    /// that load's own at the unloaded arm turns as the load does when the arm
    /// gives way, a rope towards its anchor.
    #[must_use]
    pub fn loaded_by(mut self, cell: &Cell) -> Self {
        self.setup.load = cell.setup.load.clone();
        self.loaded_at(cell.setup.tool.loading_point)
    }

    /// The arm of `cell` with a known joint stiffness \[N·m/rad\].
    ///
    /// # Errors
    /// As [`IdentifiedCompliance::from_stiffness`].
    pub fn from_stiffness(cell: &Cell, stiffness: &[f64]) -> Result<Self> {
        LoadedArm::new(cell, &IdentifiedCompliance::from_stiffness(cell, stiffness)?)
    }

    /// The robot.
    pub fn robot(&self) -> &Robot {
        &self.setup.robot
    }

    /// Tip frame in flange axes \[m\].
    pub fn tip(&self) -> &Isometry3<f64> {
        &self.tip
    }

    /// What forbids a posture.
    pub(in crate::work) fn at_work(&self) -> &AtWork {
        &self.at_work
    }

    /// K_θ⁻¹ in serial coordinates, n × n \[rad/(N·m)\].
    pub fn compliance(&self) -> &DMatrix<f64> {
        &self.compliance
    }

    /// True where something besides the joints' springs gives way.
    pub fn has_more_than_joints(&self) -> bool {
        !self.extra.is_empty() || self.setup.tool.series_compliance.is_some()
    }

    /// Tip pose at the controller angles `q` \[rad\] without load, base frame.
    ///
    /// # Panics
    /// If `q` does not have one entry per joint.
    pub fn tip_pose(&self, q: &[f64]) -> Isometry3<f64> {
        Frames::new(&self.setup.robot, q).flange() * self.tip
    }

    /// The same at many postures, on all cores.
    pub(crate) fn tip_poses<Q: AsRef<[f64]> + Sync>(
        &self,
        postures: &[Q],
        control: Control<'_>,
    ) -> Result<Vec<Isometry3<f64>>> {
        let robot = &self.setup.robot;
        in_blocks(postures, "tip poses", control, |_, block| {
            let mut frames = Frames::zero(robot.joint_count());
            let pose = |q: &Q| {
                frames.update(robot, q.as_ref());
                frames.flange() * self.tip
            };
            Ok(block.iter().map(pose).collect())
        })
    }

    /// Terms of the arm at `q` under `wrench` (at the loaded point, base axes) as it is
    /// without load: tip, columns, torques.
    ///
    /// # Errors
    /// Angles of the wrong number, or not finite.
    pub fn terms(&self, q: &[f64], wrench: &Wrench) -> Result<PostureTerms> {
        PostureTerms::new(&self.setup, q, Some(wrench))
    }

    /// Memory for the terms of the arm at one posture after another.
    pub(crate) fn memory(&self) -> PostureTerms {
        PostureTerms::memory(&self.setup)
    }

    /// Moves `terms` to the controller angles `q` \[rad\] of the unloaded arm, under `wrench`.
    ///
    /// # Errors
    /// As [`terms`](Self::terms).
    pub(crate) fn stand_at(&self, q: &[f64], wrench: &Wrench, terms: &mut PostureTerms) -> Result<()> {
        terms.move_to(&self.setup, q, Some(wrench))
    }

    /// Loads `terms`, whose frames stand at a posture of the unloaded arm, by `wrench`.
    ///
    /// # Errors
    /// As [`terms`](Self::terms).
    pub(crate) fn load(&self, wrench: &Wrench, terms: &mut PostureTerms) -> Result<()> {
        terms.fill(&self.setup, Some(wrench))
    }

    /// What `wrench` (at the loaded point, base axes) does to the tip at the controller
    /// angles `q` \[rad\].
    ///
    /// # Errors
    /// Angles of the wrong number or not finite; a load that buckles the arm, or that bends
    /// what was not determined.
    pub fn deflect(&self, q: &[f64], wrench: &Wrench) -> Result<Deflection> {
        self.deflect_in(q, wrench, &mut self.memory())
    }

    /// The same in the memory of `terms`, which then are those of the equilibrium.
    ///
    /// # Errors
    /// As [`deflect`](Self::deflect).
    pub(crate) fn deflect_in(&self, q: &[f64], wrench: &Wrench, terms: &mut PostureTerms) -> Result<Deflection> {
        self.stand_at(q, wrench, terms)?;
        self.check_determined(terms)?;
        let before = terms.frames().flange() * self.tip;
        let linear = self.linear(terms);
        settle(&self.setup, &self.compliance, terms, Some(wrench))?;
        let after = self.loaded_tip(terms);
        Ok(Deflection { displacement: motion(&before, &after), before, after, linear })
    }

    /// True where each unknown has a value.
    pub fn is_determined(&self) -> bool {
        self.undetermined.is_empty()
    }

    /// Refuses a load that bends what was not determined.
    fn check_determined(&self, terms: &PostureTerms) -> Result<()> {
        if self.is_determined() {
            return Ok(());
        }
        let moved = self.sensitivity(terms);
        let largest = moved.column_iter().map(|c| c.norm()).fold(0.0, f64::max);
        let bends = |j: &&usize| moved.column(**j).norm() > ZERO_COLUMN * largest;
        match self.undetermined.iter().find(bends) {
            None => Ok(()),
            Some(&j) => Err(not_determined(&self.name(j), "the load bends it here")),
        }
    }

    /// Refuses what depends on all that gives way.
    pub(crate) fn check_all_determined(&self, why: &str) -> Result<()> {
        match self.undetermined.first() {
            None => Ok(()),
            Some(&j) => Err(not_determined(&self.name(j), why)),
        }
    }

    /// Name of an unknown.
    fn name(&self, j: usize) -> String {
        let robot = self.robot();
        let mut names = robot.spring_names();
        names.extend(self.extra.iter().map(|term| term.name(robot)));
        names.swap_remove(j)
    }

    /// Displacement of the tip by the linear model, Eq. (7), at the posture and
    /// load of `terms`: \[shift (m); rotation vector (rad)\], base axes.
    pub fn linear(&self, terms: &PostureTerms) -> Vector6<f64> {
        // Δq = K_θ⁻¹ Γ, Eq. (5); Δ = J Δq, Eq. (6).
        let mut twist = self.added(terms, true);
        for (j, row) in self.compliance.row_iter().enumerate() {
            let angle: f64 = row.iter().zip(terms.torque()).map(|(compliance, torque)| compliance * torque).sum();
            let column = terms.columns[j] * angle;
            let axis = terms.frames().axes()[j] * angle;
            twist += Vector6::new(column.x, column.y, column.z, axis.x, axis.y, axis.z);
        }
        twist
    }

    /// Derivative of the tip's shift by the unknowns, springs then further
    /// terms, 3 × (n + terms), to first order: the block of Ψ at the tip.
    pub fn sensitivity(&self, terms: &PostureTerms) -> DMatrix<f64> {
        terms.block_with(&self.setup.robot, &self.extra)
    }

    /// Moves `terms` to the serial angles `theta`.
    pub(crate) fn move_to(&self, theta: &DVector<f64>, terms: &mut PostureTerms, wrench: &Wrench) -> Result<()> {
        terms.frames.move_to_serial_angles(&self.setup.robot, theta.as_slice());
        terms.fill(&self.setup, Some(wrench))
    }

    /// Tip pose of the loaded arm whose joints stand as in `terms`.
    pub(crate) fn loaded_tip(&self, terms: &PostureTerms) -> Isometry3<f64> {
        let tip = terms.frames().flange() * self.tip;
        if self.has_more_than_joints() { moved(&tip, &self.added(terms, true)) } else { tip }
    }

    /// Compliance that the series compliance and the tilts add at the tip, 6 × 6.
    pub(super) fn added_compliance(&self, terms: &PostureTerms) -> Matrix6<f64> {
        let mut unit = terms.clone();
        let tip = terms.measuring_points()[0];
        unit.loading_point = tip;
        let mut sum = Matrix6::zeros();
        for i in 0..6 {
            let mut load = [0.0; 6];
            load[i] = 1.0;
            unit.wrench = Wrench {
                force: Vector3::new(load[0], load[1], load[2]),
                moment: Vector3::new(load[3], load[4], load[5]),
            };
            sum.set_column(i, &self.added(&unit, false));
        }
        sum
    }

    /// What the series compliance and the extra terms do to the tip under the
    /// load of `terms`, with lost motion or without: \[shift (m); turn (rad)\], base axes.
    fn added(&self, terms: &PostureTerms, lost: bool) -> Vector6<f64> {
        let tip = &terms.measuring_points()[0];
        terms.known_twist(&self.setup.tool, tip) + self.elements.twist(terms, tip, lost)
    }
}

fn not_determined(name: &str, why: &str) -> Error {
    let message = format!("Nothing is known of how {name} gives way, and {why}.");
    Error::new(Code::NotIdentifiable, message)
        .hint("measure postures that load it and identify again, or identify with --estimator prior")
}

/// The cell's robot loaded and measured at the tip.
fn at_tip(cell: &Cell, tip: &Isometry3<f64>) -> Setup {
    let position = tip.translation.vector;
    Setup {
        robot: cell.setup.robot.clone(),
        tool: Tool {
            loading_point: position,
            measuring_points: vec![NamedPoint { name: "tip".to_string(), position }],
            has_sensor: cell.setup.tool.has_sensor,
            series_compliance: cell.setup.tool.series_compliance.clone(),
        },
        load: Load::Measured,
    }
}

/// `pose` shifted and turned about its own origin by \[shift; rotation vector\],
/// base axes.
pub(crate) fn moved(pose: &Isometry3<f64>, twist: &Vector6<f64>) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(twist.fixed_rows::<3>(3).into_owned());
    let shift: Vector3<f64> = twist.fixed_rows::<3>(0).into_owned();
    Isometry3::from_parts((pose.translation.vector + shift).into(), turn * pose.rotation)
}

/// Motion from one pose to another: \[shift; rotation vector\], base axes.
pub(crate) fn motion(from: &Isometry3<f64>, to: &Isometry3<f64>) -> Vector6<f64> {
    let shift = to.translation.vector - from.translation.vector;
    let turn = (to.rotation * from.rotation.inverse()).scaled_axis();
    Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}
