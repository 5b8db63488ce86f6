//! The index `prediction`: how far predicted deflections will be off under the mixed
//! elastic model, when all that is known of what gives way beyond the joint axes is how
//! much it scatters.
//!
//! I-optimality (Studden, Annals of Statistics 5, 1977, 411) of a Bayesian linear model
//! (Chaloner & Verdinelli, Statistical Science 10, 1995, 273–304,
//! doi:10.1214/ss/1177009939): joint compliances h of which nothing is known, entries u
//! of general springs at joints and base that scatter as [`ElasticSizes`] says.

mod function;
mod motion;
mod posterior;

pub(crate) use function::PredictionFunction;
pub(crate) use posterior::{Posterior, Rows};

use crate::error::{Code, Error, Result};
use crate::model::cell::{Cell, Task};
use crate::model::elastic::{Effect, ElasticSizes, ElasticSource, effects};
use crate::model::load::Load;
use crate::model::measurement::Candidate;
use crate::model::observation::{PostureTerms, Setup};
use crate::model::robot::Robot;
use crate::model::tool::Tool;
use crate::numerics::information::{
    Stack, scale_columns, stacked, symmetric_eigen, whiten_posture,
};
use crate::plan::index::kinds::Index;
use crate::plan::random::{StartKind, random_group};
use motion::ArmMotion;
use nalgebra::{DMatrix, Vector3};
use std::borrow::Borrow;

/// Postures that stand for the work of a cell without tasks.
const STATED: usize = 20;
/// Seed and stream of their draw.
const STATED_DRAW: (u64, u64) = (1, 0x5747);
/// Rows of readings that are kept as they are: their covariance is a matrix of as many rows and columns.
const MOST_ROWS: usize = 1 << 10;
/// Directions of the flange in which the points move less than this share of the one in
/// which they move most (squared) are not seen.
const UNSEEN: f64 = 1e-13;

/// What the index `prediction` needs of a cell.
#[derive(Debug, Clone)]
pub(crate) struct PredictionModel {
    robot: Robot,
    loading_point: Vector3<f64>,
    load: Load,
    /// The random effects, with their standard deviations as scale.
    effects: Vec<Effect>,
    /// Prior compliance of the springs, the unit of the fixed effects.
    units: Vec<f64>,
    /// From a motion of the flange to what the readings of a posture tell of it, over σ.
    readings: DMatrix<f64>,
    /// What is to be predicted \[m\].
    targets: Rows,
    /// Where the sizes come from; `None` where the caller gave them.
    source: Option<ElasticSource>,
}

impl PredictionModel {
    /// The model with the sizes that the cell declares, or that an arm like it may be
    /// expected to have.
    ///
    /// # Errors
    /// As [`PredictionModel::new`].
    pub(crate) fn of_cell(cell: &Cell) -> Result<Self> {
        let (sizes, source) = cell.elastic_sizes()?;
        Ok(PredictionModel::new(cell, &sizes)?.with_source(Some(source)))
    }

    /// The same with the place that its sizes come from.
    pub(crate) fn with_source(mut self, source: Option<ElasticSource>) -> Self {
        self.source = source;
        self
    }

    /// The same for those who look at `index` alone: `None` where that is another, or the
    /// cell lacks what it needs.
    pub(crate) fn for_index(cell: &Cell, index: Option<Index>) -> Option<Self> {
        let wanted = index == Some(Index::Prediction);
        wanted
            .then(|| PredictionModel::of_cell(cell).ok())
            .flatten()
    }

    /// The model for deflections at the cell's tasks, or where it has none for those of
    /// the measuring points at random postures inside its limits under its load.
    ///
    /// # Errors
    /// No prior stiffness; no noise; no tasks where the load comes with measurements; no
    /// posture inside the limits.
    pub(crate) fn new(cell: &Cell, sizes: &ElasticSizes) -> Result<Self> {
        let mut model = PredictionModel::without_targets(cell, sizes)?;
        let targets: Vec<DMatrix<f64>> = work_of(cell)?
            .iter()
            .map(|(setup, terms)| at_point(&model.motions_in(setup, terms), &setup.tool.tcp()))
            .collect();
        model.set_targets(&targets);
        Ok(model)
    }

    /// The model for the deflections of the measuring points at `candidates`.
    ///
    /// # Errors
    /// No prior stiffness; no noise; as [`PostureTerms::new`].
    pub(crate) fn at_candidates(
        cell: &Cell,
        sizes: &ElasticSizes,
        candidates: &[Candidate],
    ) -> Result<Self> {
        let mut model = PredictionModel::without_targets(cell, sizes)?;
        let setup = &cell.setup;
        let mut targets = Vec::new();
        for candidate in candidates {
            let motions = model.motions_in(setup, &candidate.terms(setup)?);
            for point in &setup.tool.measuring_points {
                targets.push(at_point(&motions, &point.position));
            }
        }
        model.set_targets(&targets);
        Ok(model)
    }

    /// What is said where a cell has several load cases.
    pub(crate) fn several_loads() -> Error {
        let message = "The index prediction counts one load per posture, and the cell has several load cases.";
        Error::new(Code::Unsupported, message)
            .key("load.case")
            .hint("choose another index, such as expected_error, or put one of the loads alone into [load]")
    }

    fn without_targets(cell: &Cell, sizes: &ElasticSizes) -> Result<Self> {
        if cell.setup.load.has_cases() {
            return Err(PredictionModel::several_loads());
        }
        let std = cell.noise.displacement_std();
        if std <= 0.0 {
            return Err(Error::invalid(
                "Without noise every posture predicts alike: the index prediction needs [noise].",
            )
            .key("noise.variance_mm2"));
        }
        let prior = cell.require_prior()?;
        let (robot, tool) = (&cell.setup.robot, &cell.setup.tool);
        let mut all = effects(robot.joint_count());
        for effect in &mut all {
            effect.scale *= sizes.of(effect.class);
        }
        let units: Vec<f64> = prior.iter().map(|k| 1.0 / k).collect();
        let unknowns = units.len() + all.len();
        Ok(PredictionModel {
            readings: seen(tool, cell.noise.common_weight(tool.point_count()))? / std,
            robot: robot.clone(),
            loading_point: tool.loading_point,
            load: cell.setup.load.clone(),
            effects: all,
            targets: Rows {
                all: DMatrix::zeros(0, unknowns),
                fixed: units.len(),
            },
            units,
            source: None,
        })
    }

    fn set_targets(&mut self, targets: &[DMatrix<f64>]) {
        let share = 1.0 / (targets.len() as f64).sqrt();
        self.targets = self.stacked(targets);
        self.targets.all *= share;
    }

    /// The motion of the flange by every unknown in its unit, 6 × unknowns.
    fn motions(&self, arm: &ArmMotion) -> DMatrix<f64> {
        let mut out = arm.columns(&self.robot, &self.effects);
        scale_columns(&mut out, self.units.iter().copied());
        out
    }

    /// The same where the arm has another tool or load.
    fn motions_in(&self, setup: &Setup, terms: &PostureTerms) -> DMatrix<f64> {
        let arm = ArmMotion::new(terms, &setup.tool.loading_point, &setup.load);
        self.motions(&arm)
    }

    /// What the readings at a posture tell: rows over σ.
    pub(crate) fn readings(&self, terms: &PostureTerms) -> DMatrix<f64> {
        self.readings_of(&self.arm(terms))
    }

    fn arm(&self, terms: &PostureTerms) -> ArmMotion {
        ArmMotion::new(terms, &self.loading_point, &self.load)
    }

    fn readings_of(&self, arm: &ArmMotion) -> DMatrix<f64> {
        &self.readings * self.motions(arm)
    }

    /// Adds the derivatives by the serial joint angles of a function whose derivative by
    /// the readings' rows at a posture is `adjoint`.
    fn add_gradient(&self, arm: &ArmMotion, adjoint: &DMatrix<f64>, gradient: &mut [f64]) {
        let mut by_motions = self.readings.tr_mul(adjoint);
        scale_columns(&mut by_motions, self.units.iter().copied());
        arm.add_gradient(
            &self.robot,
            &self.load,
            &self.effects,
            &by_motions,
            gradient,
        );
    }

    /// Number of unknowns, fixed and random.
    fn unknowns(&self) -> usize {
        self.targets.all.ncols()
    }

    /// Rows that the readings of one posture give.
    pub(crate) fn rows_per_posture(&self) -> usize {
        self.readings.nrows()
    }

    /// Rows of several postures, one below the other.
    pub(crate) fn stacked(&self, postures: &[DMatrix<f64>]) -> Rows {
        Rows {
            all: stacked(postures, self.unknowns()),
            fixed: self.units.len(),
        }
    }

    /// Where the sizes come from; `None` where the caller gave them.
    pub(crate) fn source(&self) -> Option<ElasticSource> {
        self.source
    }

    /// What is to be predicted.
    pub(crate) fn targets(&self) -> &Rows {
        &self.targets
    }

    /// RMS error of the predicted deflections after `postures` were measured \[m\];
    /// `None` where they do not determine every joint.
    pub(crate) fn value<T: Borrow<PostureTerms>>(&self, postures: &[T]) -> Option<f64> {
        let mut stack = self.stack();
        for terms in postures {
            stack.push(self.readings(terms.borrow()));
        }
        self.value_of(stack)
    }

    /// Room for the readings of postures.
    pub(crate) fn stack(&self) -> Stack {
        Stack::new(self.unknowns(), MOST_ROWS)
    }

    /// [`value`](Self::value) of postures whose readings these are.
    pub(crate) fn value_of(&self, readings: Stack) -> Option<f64> {
        let rows = Rows {
            all: readings.into_matrix(),
            fixed: self.units.len(),
        };
        let error = Posterior::new(&rows)?.error(&self.targets)?;
        Some(error.sqrt()).filter(|e| e.is_finite())
    }
}

/// Where deflections of the first measuring point are to be predicted, and under which
/// load: at the cell's tasks, or where it has none at random postures inside its limits,
/// always the same, under its load.
///
/// # Errors
/// No tasks where the load comes with measurements; no posture inside the limits.
pub(crate) fn work_of(cell: &Cell) -> Result<Vec<(Setup, PostureTerms)>> {
    if !cell.tasks.is_empty() {
        let at_task = |task: &Task| task.terms(&cell.setup.robot);
        return cell.tasks.iter().map(at_task).collect();
    }
    if cell.setup.load == Load::Measured {
        return Err(Error::new(
            Code::MissingKey,
            "The load comes with the measurements, and the cell has no tasks: there is no deflection to predict.",
        )
        .key("task")
        .hint("add [[task]] with q_deg and force_n, once per posture of your work, or choose from --candidates"));
    }
    let (seed, stream) = STATED_DRAW;
    let stated = random_group(cell, StartKind::Uniform, STATED, seed, stream)?;
    let under_load = |q: Vec<f64>| {
        let terms = PostureTerms::new(&cell.setup, &q, None)?;
        Ok((cell.setup.clone(), terms))
    };
    stated.into_iter().map(under_load).collect()
}

/// The shift of a point of the flange \[m\] in flange axes, 3 × unknowns.
fn at_point(motions: &DMatrix<f64>, point: &Vector3<f64>) -> DMatrix<f64> {
    point_rows(&[*point]) * motions
}

/// From a motion \[shift; turn\] of the flange to the shifts of these points of it, 3m × 6.
fn point_rows(points: &[Vector3<f64>]) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(3 * points.len(), 6);
    for (i, point) in points.iter().enumerate() {
        let mut rows = out.rows_mut(3 * i, 3);
        rows.fixed_view_mut::<3, 3>(0, 0).fill_with_identity();
        rows.fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&-point.cross_matrix());
    }
    out
}

/// From a motion of the flange to rows with noise of one: as many as directions in which
/// the measuring points, whitened against their common shift, move at all.
fn seen(tool: &Tool, common_weight: f64) -> Result<DMatrix<f64>> {
    let points: Vec<_> = tool.measuring_points.iter().map(|p| p.position).collect();
    let mut rows = point_rows(&points);
    whiten_posture(&mut rows, common_weight);
    let (values, vectors) = symmetric_eigen(rows.tr_mul(&rows)).ok_or_else(|| {
        Error::new(
            Code::Numerical,
            "The eigenvalues of the measuring points did not converge.",
        )
    })?;
    let most = values.max();
    let kept: Vec<usize> = (0..6).filter(|i| values[*i] > UNSEEN * most).collect();
    Ok(DMatrix::from_fn(kept.len(), 6, |i, j| {
        vectors[(j, kept[i])] * values[kept[i]].sqrt()
    }))
}
