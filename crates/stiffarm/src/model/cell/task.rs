//! The user's own work: machining postures and loads whose deflection is to be
//! predicted, and how identification errors reach that prediction.
//!
//! The task index built on it is I-optimality over the tasks (the "test poses"
//! of A. Klimchik et al.): it weighs each joint's error by what it does to the
//! tool tip where the robot works.

use super::Cell;
use crate::error::{Code, Error, Result};
use crate::model::load::{Axes, Load, Wrench};
use crate::model::observation::{PostureTerms, Setup};
use crate::model::robot::Robot;
use crate::model::tool::{NamedPoint, Tool};
use nalgebra::{DMatrix, Vector3};

/// One machining posture with its load. The load acts at the tool tip, the
/// contact point, and the tip's deflection is what counts.
#[derive(Debug, Clone, PartialEq)]
pub struct Task {
    /// Name used in tables.
    pub name: String,
    /// Controller angles q \[rad\], held to the machine's limits, not to the bounds.
    pub q: Vec<f64>,
    /// Wrench on the robot at the tip \[N, N·m\], in the axes named by `axes`.
    pub wrench: Wrench,
    /// Axes of the wrench.
    pub axes: Axes,
    /// Tool tip in flange axes \[m\].
    pub tip: Vector3<f64>,
}

impl Task {
    /// `robot` loaded and measured at this task's tip: the set-up whose Ψ is
    /// the task's block, and whose deflection the task asks for.
    pub fn setup(&self, robot: &Robot) -> Setup {
        Setup {
            robot: robot.clone(),
            tool: Tool {
                loading_point: self.tip,
                measuring_points: vec![NamedPoint { name: "tip".to_string(), position: self.tip }],
                has_sensor: false,
                series_compliance: None,
            },
            load: Load::Constant { wrench: self.wrench, axes: self.axes },
        }
    }

    /// B = J·diag(Γ), 3 × n \[m·N·m/rad\]: B H is the tip's predicted shift in
    /// base axes, rows x, y, z. J holds the linear columns at the tip and
    /// Γ = Jᵀ W there, both mixed by E⁻¹ where the springs are not the joints.
    ///
    /// # Errors
    /// As [`PostureTerms::new`]; a task that turns a joint which the robot has as rigid.
    pub fn block(&self, robot: &Robot) -> Result<DMatrix<f64>> {
        Ok(self.terms(robot)?.1.block(robot))
    }

    /// The set-up of the task, and its terms.
    ///
    /// # Errors
    /// As [`block`](Self::block).
    pub(crate) fn terms(&self, robot: &Robot) -> Result<(Setup, PostureTerms)> {
        let setup = self.setup(robot);
        let terms = PostureTerms::new(&setup, &self.q, None)?;
        if let Some(joint) = robot.left_out_but_turned(terms.torque()) {
            let message = format!("Task {} turns {joint}, of which the load of the cell tells nothing.", self.name);
            return Err(Error::new(Code::NotIdentifiable, message)
                .key("task")
                .hint("leave the task out, or add a load that turns the joint (load.case)"));
        }
        Ok((setup, terms))
    }
}

/// The blocks B_t of all tasks, one below the other and divided by
/// √(number of tasks), (3 · tasks) × n \[m·N·m/rad\]: their Gram matrix is
/// [`task_matrix`], and ‖rows·δH‖ the RMS over the tasks of the error that δH
/// makes in the predicted shift \[m\].
///
/// # Errors
/// The cell has no tasks; as [`Task::block`].
pub fn task_rows(cell: &Cell) -> Result<DMatrix<f64>> {
    let tasks = cell.require_tasks()?;
    let robot = &cell.setup.robot;
    let mut rows = DMatrix::zeros(3 * tasks.len(), robot.spring_count());
    let share = 1.0 / (tasks.len() as f64).sqrt();
    for (t, task) in tasks.iter().enumerate() {
        let block = task.block(robot)?;
        rows.rows_mut(3 * t, 3).copy_from(&(block * share));
    }
    Ok(rows)
}

/// T = mean over the tasks of B_tᵀ B_t, n × n \[(m·N·m/rad)²\]: with the
/// covariance C of the compliances, tr(T C) is the mean square over the tasks
/// of the error of the predicted shift \[m²\].
///
/// # Errors
/// As [`task_rows`]; loads that put torque on no joint.
pub fn task_matrix(cell: &Cell) -> Result<DMatrix<f64>> {
    let rows = task_rows(cell)?;
    let matrix = rows.tr_mul(&rows);
    if matrix.trace() > 0.0 {
        return Ok(matrix);
    }
    Err(Error::invalid("The loads of the tasks put torque on no joint, so there is no deflection to predict.")
        .key("task")
        .hint("check force_n, moment_nm and axes of each [[task]]"))
}
