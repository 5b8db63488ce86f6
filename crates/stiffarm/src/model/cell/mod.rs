//! A robot cell: what is measured, within which bounds, how exactly.
//!
//! Values only; reading and writing `cell.toml` is in `stiffarm_files::cell`.

mod approach;
mod columns;
mod limits;
mod margins;
mod outside;
mod point_limit;
mod posture_margins;
mod slopes;
mod task;
mod time;

pub use crate::model::limit::{LimitKind, LimitMargin, MarginUnit};
pub use columns::{Columns, DateOrder, NamePart, NamePattern, Separator};
pub use limits::Limits;
pub use margins::Margins;
pub use point_limit::{LimitedPoints, Measure, PointLimit, Side};
pub use posture_margins::PostureMargins;
pub use slopes::Slopes;
pub use task::{Task, task_matrix, task_rows};
pub use time::MeasuringTime;

use crate::error::{Code, Error, Result};
use crate::model::elastic::{ElasticSizes, ElasticSource, KnownElement};
use crate::model::instruments::{Sensor, Tracker, Uncertainty};
use crate::model::load::{Load, Wrench};
use crate::model::observation::{PostureTerms, Setup};
use crate::model::posture::Posture;
use crate::model::robot::Robot;
use crate::model::route::RouteSettings;
use crate::model::scene::Scene;
use crate::model::tool::Tool;
use crate::model::work::Work;
use crate::units::{m_to_mm, mm_to_m};
use nalgebra::Vector3;

/// Variance of a tracker reading per axis in the paper, Table 3 \[m²\].
const PAPER_VARIANCE: f64 = 9.23e-11;

/// Measurement noise of a displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Variance of one tracker reading per axis \[m²\].
    pub reading_variance: f64,
    /// Readings behind one displacement: 1 as the paper counts, 2 for an
    /// honest difference of a loaded and an unloaded reading.
    pub readings_per_displacement: u32,
    /// Standard deviation τ of a shift common to all points of a posture
    /// \[m\]: load, rope, drift. Zero in the paper.
    pub posture_common_std: f64,
}

impl Noise {
    /// The same with `factor` times the variance of a reading.
    #[must_use]
    pub fn with_variance_times(self, factor: f64) -> Self {
        Noise { reading_variance: self.reading_variance * factor, ..self }
    }

    /// A length \[m\] to a thousandth of the noise, which is all that a tracker could tell; whole without noise.
    pub fn digits_of(&self, length: f64) -> f64 {
        let finest = m_to_mm(1e-3 * self.reading_variance.sqrt());
        // In millimetres, as files have it: it is their decimals that are cut.
        let scale = 10f64.powf(-finest.log10().floor());
        let cut = mm_to_m((m_to_mm(length) * scale).round() / scale);
        if cut.is_finite() { cut } else { length }
    }

    /// Variance σ² of one displacement component \[m²\].
    pub fn displacement_variance(&self) -> f64 {
        self.reading_variance * f64::from(self.readings_per_displacement)
    }

    /// Standard deviation σ of one displacement component \[m\].
    pub fn displacement_std(&self) -> f64 {
        self.displacement_variance().sqrt()
    }

    /// τ²/σ²: the variance of the shift that the points of a posture share over that of a displacement component; zero
    /// at σ = 0.
    pub fn common_ratio(&self) -> f64 {
        match self.displacement_variance() {
            variance if variance > 0.0 => self.posture_common_std.powi(2) / variance,
            _ => 0.0,
        }
    }

    /// ρ of a posture's precision (I − ρ 11ᵀ ⊗ I₃)/σ² with `points` measuring
    /// points: ρ = τ²/(σ² + mτ²). Zero without a common part or at σ = 0.
    pub fn common_weight(&self, points: usize) -> f64 {
        let tau2 = self.posture_common_std.powi(2);
        let total = self.displacement_variance() + points as f64 * tau2;
        if tau2 > 0.0 && self.displacement_variance() > 0.0 { tau2 / total } else { 0.0 }
    }
}

/// Everything a plan, a simulation or an identification needs to know.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Name of the cell.
    pub name: String,
    /// Robot, tool and load.
    pub setup: Setup,
    /// Bounds of the controller angles for selection \[rad\] (Table 1).
    pub bounds: Vec<[f64; 2]>,
    /// Where tool points, flange and wrist may be, and the rope's length.
    pub limits: Limits,
    /// Shapes that must not touch, beams that must not be hidden, torques that must not be exceeded.
    pub scene: Scene,
    /// Measurement noise.
    pub noise: Noise,
    /// Prior joint stiffness k \[N·m/rad\], one per spring, where one is known.
    pub prior: Option<Vec<f64>>,
    /// How much gives way beyond the joint axes, where that is known: by an experiment
    /// on this arm or on one like it.
    pub elastic: Option<ElasticSizes>,
    /// Bearings, links and base of which a drawing or a catalogue gives the stiffness.
    pub known_elements: Vec<KnownElement>,
    /// Characteristic length L of the normalised Jacobian \[m\], Eq. (20);
    /// `None` asks for the one that minimises k(J_N).
    pub characteristic_length: Option<f64>,
    /// Postures kept for validation; held to the machine's limits, not to `bounds`.
    pub validation: Vec<Posture>,
    /// The user's own machining postures and loads; they may be none.
    pub tasks: Vec<Task>,
    /// The force sensor, where the readings come from one.
    pub sensor: Option<Sensor>,
    /// The tracker: its frame and its accuracy, as far as known.
    pub tracker: Tracker,
    /// Standard uncertainty of what is common to the whole experiment.
    pub uncertainty: Uncertainty,
    /// Headings of measurement tables and paths that another software writes.
    pub columns: Columns,
    /// Tool tip, workpiece and process.
    pub work: Work,
    /// How the robot drives from posture to posture.
    pub route: RouteSettings,
    /// What measuring takes.
    pub time: MeasuringTime,
}

impl Cell {
    /// A cell with the robot's limits as bounds, without limits on tool points,
    /// and with the tracker noise of the paper; everything else is unknown. All
    /// fields are public: change what your cell has otherwise.
    ///
    /// ```
    /// use stiffarm::nalgebra::Vector3;
    /// use stiffarm::{Cell, Load, Robot, Tool};
    ///
    /// # fn main() -> stiffarm::Result<()> {
    /// let robot = Robot::from_catalogue("kuka-kr240-2")?;
    /// let spindle = Vector3::new(0.1, 0.0, 0.3);
    /// let tool = Tool::new(spindle, [("tcp", spindle), ("side", Vector3::new(0.0, 0.2, 0.2))])?;
    /// let load = Load::Rope { anchor: Vector3::new(2.0, 0.0, 0.0), magnitude: 400.0 };
    /// let mut cell = Cell::new("my cell", robot, tool, load);
    /// cell.prior = Some(vec![1e6; 6]);
    /// assert_eq!(cell.bounds.len(), 6);
    /// # Ok(())
    /// # }
    /// ```
    pub fn new(name: impl Into<String>, robot: Robot, tool: Tool, load: Load) -> Self {
        Cell {
            name: name.into(),
            bounds: robot.joints().iter().map(|joint| joint.limits).collect(),
            setup: Setup { robot, tool, load },
            limits: Limits::default(),
            scene: Scene::default(),
            noise: Noise { reading_variance: PAPER_VARIANCE, readings_per_displacement: 1, posture_common_std: 0.0 },
            prior: None,
            elastic: None,
            known_elements: Vec::new(),
            characteristic_length: None,
            validation: Vec::new(),
            tasks: Vec::new(),
            sensor: None,
            tracker: Tracker::default(),
            uncertainty: Uncertainty::default(),
            columns: Columns::default(),
            work: Work::default(),
            route: RouteSettings::default(),
            time: MeasuringTime::default(),
        }
    }

    /// The cell under each of its loads: itself alone where there are no load cases.
    pub fn cases(&self) -> Vec<Cell> {
        let under = |setup| Cell { setup, ..self.clone() };
        self.setup.cases().into_iter().map(under).collect()
    }

    /// The cell under the load case `name` alone.
    ///
    /// # Errors
    /// No such load case.
    pub fn under(&self, name: &str) -> Result<Cell> {
        let cases = self.setup.load.cases();
        if let Some(number) = cases.iter().position(|case| case.name == name) {
            return Ok(self.cases().swap_remove(number));
        }
        let message = format!("The cell has no load case \"{name}\".");
        Err(Error::invalid(message).hint(if self.setup.load.has_cases() {
            format!("its load cases: {}", self.setup.load.case_names())
        } else {
            "it has a single load: leave the name out".to_string()
        }))
    }

    /// The prior stiffness, or an error that says which key gives it.
    ///
    /// # Errors
    /// The cell has no prior.
    pub fn require_prior(&self) -> Result<&[f64]> {
        self.prior.as_deref().ok_or_else(|| {
            Error::new(Code::MissingKey, "This needs a prior joint stiffness, and the cell has none.")
                .key("stiffness.prior_nm_per_rad")
                .hint(
                    "give catalogue values or a guess by payload class, one per joint, in N·m/rad; `stiffarm init` \
                writes a guess, commented out",
                )
        })
    }

    /// How much gives way beyond the joint axes: as the cell declares, else as an arm of
    /// its length and prior stiffness may be expected to have.
    ///
    /// # Errors
    /// The cell declares nothing and has no prior.
    pub fn elastic_sizes(&self) -> Result<(ElasticSizes, ElasticSource)> {
        match self.elastic {
            Some(sizes) => Ok((sizes, ElasticSource::Declared)),
            None => {
                let sizes = ElasticSizes::typical(&self.setup, self.require_prior()?)?;
                Ok((sizes, ElasticSource::Typical))
            }
        }
    }

    /// The tasks, or an error that says how to add one.
    ///
    /// # Errors
    /// The cell has no tasks.
    pub fn require_tasks(&self) -> Result<&[Task]> {
        if self.tasks.is_empty() {
            return Err(Error::new(
                Code::MissingKey,
                "This needs your own machining postures and loads, and the cell has none.",
            )
            .key("task")
            .hint("add [[task]] with q_deg and force_n, once per posture of your work"));
        }
        Ok(&self.tasks)
    }

    /// L of Eq. (20) \[m\], or an error where it is still to be computed.
    ///
    /// # Errors
    /// The cell leaves the length open;
    /// [`with_characteristic_length`](crate::plan::characteristic_length::with_characteristic_length) computes it.
    pub fn require_characteristic_length(&self) -> Result<f64> {
        self.characteristic_length.ok_or_else(|| {
            Error::new(Code::MissingKey, "The characteristic length of Eq. (20) is not set.")
                .key("robot.characteristic_length_mm")
        })
    }

    /// Joints whose angle is outside the cell's bounds, by more than rounding, with the angle \[rad\].
    pub fn outside_bounds(&self, q: &[f64]) -> impl Iterator<Item = (usize, f64)> {
        let outside = |q: f64, b: &[f64; 2]| q < b[0] - 1e-9 || q > b[1] + 1e-9;
        let joints = q.iter().zip(&self.bounds).enumerate();
        joints.filter_map(move |(j, (q, bounds))| outside(*q, bounds).then_some((j, *q)))
    }

    /// Measuring points that are not to be read at the controller angles `q` \[rad\]: hidden from the station that
    /// sees most, where it sees as many as are asked for. None where too few are seen: what is to be done
    /// there is another station's, or another posture's.
    pub fn hidden_points(&self, q: &[f64]) -> Vec<usize> {
        let Some(sight) = self.scene.sight() else {
            return Vec::new();
        };
        let unloaded = Wrench::force(Vector3::zeros());
        let terms = PostureTerms::new(&self.setup, q, Some(&unloaded)).ok();
        let seen = terms.and_then(|terms| self.scene.seen(&terms));
        let seen = seen.map_or_else(Vec::new, |seen| seen.points);
        if seen.len() < sight.visible_points {
            return Vec::new();
        }
        let points = 0..self.setup.tool.point_count();
        points.filter(|point| !seen.contains(point)).collect()
    }

    /// The robot with the bounds as limits, where they are narrower than the machine's.
    pub(crate) fn robot_within_bounds(&self) -> Robot {
        let joints = self.setup.robot.joints().iter();
        let narrower = joints.zip(&self.bounds).map(|(joint, bounds)| {
            let [low, high] = joint.limits;
            [low.max(bounds[0]), high.min(bounds[1])]
        });
        let limits: Vec<[f64; 2]> = narrower.collect();
        // Bounds beside the limits leave nothing: the machine's limits stay.
        let robot = self.setup.robot.clone().with_limits(&limits);
        robot.unwrap_or_else(|_| self.setup.robot.clone())
    }

    /// First joint whose angle leaves the machine's limits, with the angle \[rad\].
    pub fn outside_machine_limits(&self, q: &[f64]) -> Option<(usize, f64)> {
        self.setup.robot.outside_limits(q)
    }
}
