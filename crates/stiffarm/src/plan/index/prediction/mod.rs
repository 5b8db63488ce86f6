//! The index `prediction`: how far predicted deflections will be off under the mixed
//! elastic model, when all that is known of what gives way beyond the joint axes is how
//! much it scatters.
//!
//! I-optimality (Studden, Annals of Statistics 5, 1977, 411) of a Bayesian linear model
//! (Chaloner & Verdinelli, Statistical Science 10, 1995, 273–304,
//! doi:10.1214/ss/1177009939): joint compliances h of which nothing is known, and what
//! gives way besides as [`Prior`] expects it, in the classes that `identify` fits.

mod function;
mod motion;
mod posterior;
mod prior;
mod work;

pub(crate) use function::PredictionFunction;
use posterior::Posterior;
pub(crate) use posterior::{Equations, GroupCovariance, Rows};
pub(crate) use work::work_of;

use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::elastic::{ElasticSizes, ElasticSource};
use crate::model::load::Load;
use crate::model::observation::{PostureTerms, Setup};
use crate::model::tool::Tool;
use crate::numerics::information::{Stack, scale_columns, stacked, symmetric_eigen, whiten_posture};
use crate::numerics::streams::spread;
use crate::plan::index::kinds::Index;
use motion::ArmMotion;
use nalgebra::{DMatrix, DVector, Vector3};
use prior::Prior;
use work::loaded_at;

/// Rows of readings that are kept as they are: their covariance is a matrix of as many rows and columns.
const MOST_ROWS: usize = 1 << 10;
/// Postures, within bounds alone, that show which effects can be told apart.
const SAMPLES: u32 = 64;
/// Directions of the flange in which the points move less than this share of the one in
/// which they move most (squared) are not seen.
const UNSEEN_SHARE: f64 = 1e-13;

/// What the index `prediction` needs of a cell.
#[derive(Debug, Clone)]
pub(crate) struct PredictionModel {
    /// The cell's set-up under each of its loads.
    cases: Vec<Setup>,
    prior: Prior,
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
    /// The model for deflections at the [work](work_of) of the cell.
    ///
    /// # Errors
    /// No prior stiffness; no noise; no tasks where the load comes with measurements; no
    /// posture inside the limits.
    pub(crate) fn of_cell(cell: &Cell) -> Result<Self> {
        let (prior, source) = Prior::of_cell(cell, 1.0)?;
        PredictionModel::at_work(cell, prior, Some(source))
    }

    /// The same for those who look at `index` alone: `None` where that is another, or the
    /// cell lacks what it needs.
    pub(crate) fn for_index(cell: &Cell, index: Option<Index>) -> Option<Self> {
        let wanted = index == Some(Index::Prediction);
        wanted.then(|| PredictionModel::of_cell(cell).ok()).flatten()
    }

    /// The same for the first kind of work alone, where all entries scatter around zero with these sizes.
    ///
    /// # Errors
    /// As [`of_cell`](Self::of_cell).
    pub(crate) fn alike(cell: &Cell, sizes: &ElasticSizes) -> Result<Self> {
        let prior = Prior::alike(&cell.setup.robot, sizes, &[]);
        PredictionModel::at(cell, prior, None, &work_of(cell)?[..1])
    }

    fn at_work(cell: &Cell, prior: Prior, source: Option<ElasticSource>) -> Result<Self> {
        PredictionModel::at(cell, prior, source, &work_of(cell)?)
    }

    fn at(
        cell: &Cell,
        prior: Prior,
        source: Option<ElasticSource>,
        work: &[Vec<(Setup, PostureTerms)>],
    ) -> Result<Self> {
        let mut model = PredictionModel::without_targets(cell, prior, source)?;
        let targets: Vec<Vec<DMatrix<f64>>> = work.iter().map(|states| model.at_tip(states)).collect();
        model.set_targets(&targets);
        Ok(model)
    }

    /// The same, or where the load comes with measurements for deflections at the cell's tasks, if it has any, and of
    /// the measuring points at `candidates`; what gives way beyond the axes is `factor` times as large as expected.
    ///
    /// # Errors
    /// As [`of_cell`](Self::of_cell).
    pub(crate) fn at_candidates(cell: &Cell, factor: f64, candidates: &[Vec<PostureTerms>]) -> Result<Self> {
        let (prior, source) = Prior::of_cell(cell, factor)?;
        if cell.setup.load != Load::Measured {
            return PredictionModel::at_work(cell, prior, Some(source));
        }
        let mut model = PredictionModel::without_targets(cell, prior, Some(source))?;
        let mut of_points = Vec::new();
        for terms in candidates.iter().flatten() {
            let motions = model.motions(&ArmMotion::new(terms, &Load::Measured));
            for point in &cell.setup.tool.measuring_points {
                of_points.push(at_point(&motions, &point.position));
            }
        }
        let mut targets = vec![of_points, model.at_tip(&loaded_at(cell, &cell.tasks)?)];
        targets.retain(|kind| !kind.is_empty());
        model.set_targets(&targets);
        Ok(model)
    }

    /// Shifts of the tip there.
    fn at_tip(&self, work: &[(Setup, PostureTerms)]) -> Vec<DMatrix<f64>> {
        let each = work.iter();
        each.map(|(setup, terms)| {
            let arm = ArmMotion::new(terms, &setup.load);
            at_point(&self.motions(&arm), &setup.tool.tcp())
        })
        .collect()
    }

    fn without_targets(cell: &Cell, prior: Prior, source: Option<ElasticSource>) -> Result<Self> {
        let std = cell.noise.displacement_std();
        if std <= 0.0 {
            return Err(Error::invalid(
                "Without noise every posture predicts alike: the index prediction needs [noise].",
            )
            .key("noise.variance_mm2"));
        }
        let units: Vec<f64> = cell.require_prior()?.iter().map(|k| 1.0 / k).collect();
        let tool = &cell.setup.tool;
        Ok(PredictionModel {
            readings: seen(tool, cell.noise.common_weight(tool.point_count()))? / std,
            cases: cell.setup.cases(),
            targets: Rows { all: DMatrix::zeros(0, units.len() + prior.root.ncols()), fixed: units.len() },
            prior,
            units,
            source,
        })
    }

    /// Each kind of work has the same share in the mean square.
    fn set_targets(&mut self, kinds: &[Vec<DMatrix<f64>>]) {
        let each: Vec<DMatrix<f64>> = kinds
            .iter()
            .flat_map(|kind| {
                let share = 1.0 / ((kinds.len() * kind.len()) as f64).sqrt();
                kind.iter().map(move |rows| rows * share)
            })
            .collect();
        self.targets = self.stacked(&each);
    }

    /// The same for searches: effects that neither readings under the cell's loads nor what is to be predicted can tell
    /// apart are one effect, and so are deflections that go together. All sizes are then as expected.
    ///
    /// # Errors
    /// Eigenvalues that do not converge.
    pub(crate) fn condensed(mut self, cell: &Cell) -> Result<Self> {
        let fixed = self.units.len();
        let random = self.prior.root.ncols();
        let mut gram = DMatrix::zeros(random, random);
        let mut add = |rows: &DMatrix<f64>| {
            let random_columns = rows.columns(fixed, random);
            // One scale for all: what counts is what is seen at all.
            let scale = random_columns.norm_squared();
            if scale > 0.0 {
                gram.gemm_tr(1.0 / scale, &random_columns, &random_columns, 1.0);
            }
        };
        add(&self.targets.all);
        for i in 0..SAMPLES {
            let q = spread(&cell.bounds, i);
            let each = self.cases.iter().map(|s| PostureTerms::new(s, &q, None));
            each.flatten().for_each(|terms| add(&self.readings(&[terms])));
        }
        let (values, vectors) = eigen(gram)?;
        let least = UNSEEN_SHARE * values.max();
        let directions: Vec<usize> = (0..random).filter(|i| values[*i] > least).collect();
        let seen = vectors.select_columns(&directions);
        self.prior.root *= &seen;
        let targets = &self.targets.all;
        let mut rows = DMatrix::zeros(targets.nrows(), fixed + directions.len());
        rows.columns_mut(0, fixed).copy_from(&targets.columns(0, fixed));
        rows.columns_mut(fixed, directions.len()).copy_from(&(targets.columns(fixed, random) * seen));
        if rows.nrows() > rows.ncols() {
            rows = rows.qr().r();
        }
        self.targets.all = rows;
        Ok(self)
    }

    /// The motion of the flange by every unknown in its unit, 6 × unknowns.
    fn motions(&self, arm: &ArmMotion) -> DMatrix<f64> {
        let columns = arm.columns(&self.cases[0].robot, &self.prior.entries);
        let fixed = self.units.len();
        let mut out = DMatrix::zeros(6, self.unknowns());
        out.columns_mut(0, fixed).copy_from(&columns.columns(0, fixed));
        scale_columns(&mut out, self.units.iter().copied());
        let entries = columns.columns(fixed, columns.ncols() - fixed);
        out.columns_mut(fixed, self.prior.root.ncols()).gemm(1.0, &entries, &self.prior.root, 0.0);
        out
    }

    /// What the readings at a posture tell, under the load of each of `terms`: rows over σ.
    pub(crate) fn readings<'a>(&self, terms: impl IntoIterator<Item = &'a PostureTerms>) -> DMatrix<f64> {
        let each: Vec<DMatrix<f64>> =
            terms.into_iter().map(|state| self.readings_of(&ArmMotion::new(state, &Load::Measured))).collect();
        stacked(&each, self.unknowns())
    }

    fn readings_of(&self, arm: &ArmMotion) -> DMatrix<f64> {
        &self.readings * self.motions(arm)
    }

    /// Adds the derivatives by the serial joint angles of a function whose derivative by
    /// the readings' rows at a posture under one load is `adjoint`.
    fn add_gradient(&self, arm: &ArmMotion, load: &Load, adjoint: &DMatrix<f64>, gradient: &mut [f64]) {
        let by_motions = self.readings.tr_mul(adjoint);
        let fixed = self.units.len();
        let entries = self.prior.entries.len();
        let mut by_columns = DMatrix::zeros(6, fixed + entries);
        by_columns.columns_mut(0, fixed).copy_from(&by_motions.columns(0, fixed));
        scale_columns(&mut by_columns, self.units.iter().copied());
        let by_effects = by_motions.columns(fixed, by_motions.ncols() - fixed);
        by_columns.columns_mut(fixed, entries).copy_from(&(by_effects * self.prior.root.transpose()));
        let robot = &self.cases[0].robot;
        arm.add_gradient(robot, load, &self.prior.entries, &by_columns, gradient);
    }

    /// Number of unknowns, fixed and random.
    pub(crate) fn unknowns(&self) -> usize {
        self.targets.all.ncols()
    }

    /// Rows that the readings of one posture under one load give.
    pub(crate) fn rows_per_load(&self) -> usize {
        self.readings.nrows()
    }

    /// Rows that the readings of one posture under all loads of the cell give.
    pub(crate) fn rows_per_posture(&self) -> usize {
        self.rows_per_load() * self.cases.len()
    }

    /// The arm at one posture under each load of the cell.
    fn arms(&self, terms: &[PostureTerms]) -> Vec<ArmMotion> {
        let each = terms.iter().zip(&self.cases);
        each.map(|(terms, setup)| ArmMotion::new(terms, &setup.load)).collect()
    }

    /// Rows of several postures, one below the other.
    pub(crate) fn stacked(&self, postures: &[DMatrix<f64>]) -> Rows {
        Rows { all: stacked(postures, self.unknowns()), fixed: self.units.len() }
    }

    /// Where the sizes come from; `None` where the caller gave them.
    pub(crate) fn source(&self) -> Option<ElasticSource> {
        self.source
    }

    /// What is to be predicted.
    pub(crate) fn targets(&self) -> &Rows {
        &self.targets
    }

    /// RMS error of the predicted deflections after `postures` were measured \[m\], each under the load of each of its
    /// terms; `None` where they do not determine every joint.
    pub(crate) fn value<T: AsRef<[PostureTerms]>>(&self, postures: &[T]) -> Option<f64> {
        let mut stack = self.stack();
        for terms in postures {
            stack.push(self.readings(terms.as_ref()));
        }
        self.value_where(&self.rows(stack), 1.0)
    }

    /// Room for the readings of postures.
    pub(crate) fn stack(&self) -> Stack {
        Stack::new(self.unknowns(), MOST_ROWS)
    }

    /// Such readings.
    pub(crate) fn rows(&self, readings: Stack) -> Rows {
        Rows { all: readings.into_matrix(), fixed: self.units.len() }
    }

    /// [`value`](Self::value) of these readings where what is expected to give way beyond the axes, and not drawn, is
    /// `factor` times as large.
    pub(crate) fn value_where(&self, readings: &Rows, factor: f64) -> Option<f64> {
        let times = |rows: &Rows| rows.times(factor, self.prior.drawn);
        let (readings, targets) = (times(readings), times(&self.targets));
        let error = Posterior::new(&readings)?.error(&targets)?;
        Some(error.sqrt()).filter(|e| e.is_finite())
    }
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
        rows.fixed_view_mut::<3, 3>(0, 3).copy_from(&-point.cross_matrix());
    }
    out
}

/// From a motion of the flange to rows with noise of one: as many as directions in which
/// the measuring points, whitened against their common shift, move at all.
fn seen(tool: &Tool, common_weight: f64) -> Result<DMatrix<f64>> {
    let points: Vec<_> = tool.measuring_points.iter().map(|p| p.position).collect();
    let mut rows = point_rows(&points);
    whiten_posture(&mut rows, common_weight);
    let (values, vectors) = eigen(rows.tr_mul(&rows))?;
    let most = values.max();
    let directions: Vec<usize> = (0..6).filter(|i| values[*i] > UNSEEN_SHARE * most).collect();
    Ok(DMatrix::from_fn(directions.len(), 6, |i, j| vectors[(j, directions[i])] * values[directions[i]].sqrt()))
}

fn eigen(matrix: DMatrix<f64>) -> Result<(DVector<f64>, DMatrix<f64>)> {
    symmetric_eigen(matrix).ok_or_else(|| {
        let message = "The eigenvalues of the model behind the index prediction did not converge.";
        Error::new(Code::Numerical, message)
    })
}
