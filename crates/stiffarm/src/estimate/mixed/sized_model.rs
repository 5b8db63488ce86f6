//! The sizes of one choice of random effects, and where its classes stand.

use super::doubt::doubt;
use super::likelihood::{Likelihood, Sizes, Solved};
use super::means::gathered;
use super::sums::{PriorRows, Rows};
use super::too_few;
use crate::error::Result;
use crate::estimate::compliance::{IdentifiedCompliance, Spread};
use crate::estimate::freedom::SizeDoubt;
use crate::estimate::identify::{Fit, RESIDUAL_ROUNDING};
use crate::model::elastic::{Effect, ElasticClass, ElasticSizing, KnownElement, fitted, terms};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// A mixed model with its sizes.
pub(super) struct SizedModel {
    pub(super) effects: Vec<Effect>,
    pub(super) likelihood: Likelihood,
    pub(super) sizes: Sizes,
    /// −2 ln L_R, and that without random effects.
    pub(super) values: [f64; 2],
}

/// Which random effects are fitted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Choice {
    pub(super) sizing: ElasticSizing,
    /// With bearings and beams, or the entries of springs alone.
    pub(super) structure: bool,
    /// Standard deviation of a displacement, in which what a drawing knows counts; without it that does not count.
    pub(super) sigma: Option<f64>,
}

/// The likeliest model of all postures but `left_out` (ascending), whose axes alone have the compliances `axes` and the
/// ratio `gamma`; `white` are the columns of all effects in their units. The sizes are looked for near `near`, or from
/// several starts.
///
/// What a drawing knows of bearings and links counts as read once more, with the noise of these readings as its unit:
/// the sizes are looked for without it, then with it twice, as the noise is less then. The likelihoods stay those of
/// the readings.
///
/// # Errors
/// As [`fit_choice`]; interrupted.
pub(super) fn likeliest(
    fit: &Fit,
    white: &Rows,
    axes: &DVector<f64>,
    gamma: f64,
    left_out: &[usize],
    near: Option<&Sizes>,
) -> Result<(ElasticSizing, SizedModel)> {
    let of = |sizing, near: Option<&Sizes>, sigma| {
        fit.control().check()?;
        let choice = Choice { sizing, structure: true, sigma };
        fit_choice(fit, white, axes, gamma, left_out, choice, near)
    };
    let alike = of(ElasticSizing::Alike, near, None)?;
    let by_joint = of(ElasticSizing::ByJoint, Some(&alike.sizes), None)?;
    // As likely with entries that are alike is no reason to take others.
    let (sizing, likelier) = match by_joint.values[0] < alike.values[0] - SAME_LIKELIHOOD {
        true => (ElasticSizing::ByJoint, by_joint),
        false => (ElasticSizing::Alike, alike),
    };
    if fit.cell().known_elements.is_empty() {
        return Ok((sizing, likelier));
    }
    let first = of(sizing, None, likelier.sigma())?;
    let mut with = of(sizing, Some(&first.sizes), first.sigma())?;
    with.values = likelier.values;
    Ok((sizing, with))
}

/// Columns of the random effects, which are `columns` in their own units, as all models of a fit have them.
pub(super) fn white(fit: &Fit, effects: &[Effect], columns: &DMatrix<f64>) -> Rows {
    let (whitened, solution) = (fit.prepared().whitened(), fit.solution());
    let shifts = whitened.is_separable() && !solution.independent_rows;
    let held = (solution.undetermined.as_slice(), shifts);
    Rows::new(whitened, columns, classes(effects), fit.white(), held)
}

/// The model of this choice; its sizes are looked for near those of another model, where there is one.
///
/// # Errors
/// Nothing left of the displacements, or no degree of freedom.
pub(super) fn fit_choice(
    fit: &Fit,
    white: &Rows,
    axes: &DVector<f64>,
    gamma: f64,
    left_out: &[usize],
    choice: Choice,
    near: Option<&Sizes>,
) -> Result<SizedModel> {
    let effects =
        fitted(&fit.cell().setup.robot, joint_give(fit, axes).as_slice(), choice.sizing, &fit.cell().known_elements);
    let prior = elements_prior(&fit.cell().known_elements, &effects, choice.sigma);
    let scales = effects.iter().map(|effect| effect.scale);
    let rows = white.of_effects(scales, &means(&effects), prior);
    if rows.rest() <= RESIDUAL_ROUNDING * fit.white().norm() {
        return Err(too_few("the joint axes leave nothing of the displacements"));
    }
    let likelihood = Likelihood::new(rows, left_out);
    let rows = likelihood.rows();
    let is_structure =
        |class: &ElasticClass| matches!(class, ElasticClass::Bearing | ElasticClass::Beam) && !choice.structure;
    let nothing: Vec<bool> =
        (0..rows.estimated_count()).map(|i| ElasticClass::ALL.get(i).is_some_and(is_structure)).collect();
    let zeros = std::iter::repeat_n(0.0, rows.estimated_count());
    let none = Sizes { gamma, classes: zeros.chain(rows.held()).collect() };
    let (Some((sizes, value)), Some(without)) =
        (likelihood.best(near, &nothing, fit.control()), likelihood.solve(&none))
    else {
        return Err(too_few("there are hardly more displacements than joints"));
    };
    // The search may end a hair above what no effects at all give.
    let (sizes, value) = if without.value <= value { (none, without.value) } else { (sizes, value) };
    Ok(SizedModel { effects, likelihood, sizes, values: [value, without.value] })
}

/// Rows of what is known of the effects, in units of their scales, where σ is `sigma`; none without.
fn elements_prior(elements: &[KnownElement], effects: &[Effect], sigma: Option<f64>) -> PriorRows {
    let Some(sigma) = sigma.filter(|_| !elements.is_empty()) else {
        return PriorRows::nothing(effects.len());
    };
    // They are the last, in their order.
    let (count, first) = (elements.len(), effects.len() - elements.len());
    let unit = |i: usize, j: usize| f64::from(u8::from(j == first + i));
    let read = elements.iter().map(|element| sigma * element.compliance / element.std);
    PriorRows {
        rows: DMatrix::from_fn(count, effects.len(), |i, j| sigma * unit(i, j)),
        read: DVector::from_iterator(count, read),
        ratio: Some((UNKNOWN_ELEMENT_STDS / sigma).powi(2)),
    }
}

impl SizedModel {
    /// σ of a displacement.
    fn sigma(&self) -> Option<f64> {
        let solved = self.likelihood.solve(&self.sizes);
        solved.map(|solved| solved.variance.sqrt())
    }

    /// The solution of the equations in the effects' own units.
    pub(super) fn solution(&self) -> Option<DVector<f64>> {
        let solved = self.likelihood.solve(&self.sizes)?;
        Some(self.values(&solved))
    }

    /// What `solved` gives in the effects' own units: u = L w.
    fn values(&self, solved: &Solved) -> DVector<f64> {
        let means = moved(means(&self.effects), self.likelihood.rows().fixed);
        let mut values = DMatrix::from_columns(&[solved.values(self.likelihood.rows())]).transpose();
        gathered(&mut values, &means);
        DVector::from_fn(values.len(), |i, _| values[i] * self.scale(i))
    }

    /// Unit of unknown `i`.
    fn scale(&self, i: usize) -> f64 {
        match i.checked_sub(self.likelihood.rows().fixed) {
            Some(i) => self.effects[i].scale,
            None => 1.0,
        }
    }

    /// The solution of the mixed-model equations in the effects' own units, with its covariance.
    pub(super) fn compliance(&self, fit: &Fit) -> Option<IdentifiedCompliance> {
        let SizedModel { effects, likelihood, sizes, .. } = self;
        let rows = likelihood.rows();
        let plain = fit.solution();
        let fixed = rows.fixed;
        let scale = |i: usize| self.scale(i);
        let solved = likelihood.solve(sizes)?;
        let means = moved(means(effects), fixed);
        let (mut covariance, of_sizes) = doubt(likelihood, sizes, &solved);
        for _ in 0..2 {
            gathered(&mut covariance, &means);
            covariance = covariance.transpose();
        }
        for j in &rows.idle {
            covariance.row_mut(*j).fill(0.0);
            covariance.column_mut(*j).fill(0.0);
        }
        // Rounding makes the two sides differ in the last digit.
        let covariance = DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| {
            covariance[(i.max(j), i.min(j))] * (scale(i) * scale(j))
        });
        let sigma = solved.variance.sqrt();
        let std = |class| sizes.std(class, sigma);
        Some(IdentifiedCompliance {
            values: self.values(&solved),
            extra: terms(effects),
            spread: Some(Spread {
                covariance,
                sigma,
                shift: sigma * sizes.gamma.sqrt(),
                degrees_of_freedom: plain.t_degrees_of_freedom.map(|dof| dof.min(solved.free)),
                doubt: Some(size_doubt(effects, fixed, std, of_sizes)),
                confidence: fit.options().confidence,
            }),
            undetermined: rows.idle.clone(),
            common: Default::default(),
            doubts: Vec::new(),
        })
    }
}

/// What is known of the sizes `std` of the classes, with the covariance of their
/// logarithms.
fn size_doubt(
    effects: &[Effect],
    fixed: usize,
    std: impl Fn(ElasticClass) -> f64,
    covariance: DMatrix<f64>,
) -> SizeDoubt {
    SizeDoubt {
        classes: moved(estimated_classes(effects), fixed),
        means: moved(means(effects), fixed),
        prior: DVector::from_fn(fixed + effects.len(), |i, _| match i.checked_sub(fixed) {
            Some(i) => (std(effects[i].class) * effects[i].scale).powi(2),
            None => 0.0,
        }),
        covariance,
    }
}

/// Standard deviation of what a drawing knows before it says so, in its standard uncertainties: any.
const UNKNOWN_ELEMENT_STDS: f64 = 1e3;
/// Differences of −2 ln L_R below this are none.
const SAME_LIKELIHOOD: f64 = 1e-6;

/// Compliance of each joint as the axes alone have it, for what is sized by it.
fn joint_give(fit: &Fit, axes: &DVector<f64>) -> DVector<f64> {
    let robot = &fit.cell().setup.robot;
    let springs = axes.rows(0, robot.spring_count());
    // Springs that are no joints give to each by the squares of their shares.
    match robot.spring_mixing() {
        None => springs.into_owned(),
        Some(mixing) => mixing.map(|share| share * share) * springs,
    }
}

/// Columns of each class that scatter about a mean.
pub(super) fn means(effects: &[Effect]) -> Vec<Range<usize>> {
    let positive = |class: &Range<usize>| effects[class.clone()].iter().filter(|e| e.is_positive());
    let about_mean = |class: Range<usize>| class.start..class.start + positive(&class).count();
    estimated_classes(effects).into_iter().map(about_mean).collect()
}

/// Columns of each class.
fn classes(effects: &[Effect]) -> Vec<Range<usize>> {
    let of = |class| {
        let start = effects.iter().position(|e| e.class == class).unwrap_or(0);
        start..start + effects.iter().filter(|e| e.class == class).count()
    };
    let drawing = Some(of(ElasticClass::Drawing)).filter(|class| !class.is_empty());
    let all = ElasticClass::ALL.map(of).into_iter();
    all.chain(drawing).collect()
}

/// Those of the classes whose sizes are told by readings.
fn estimated_classes(effects: &[Effect]) -> Vec<Range<usize>> {
    let mut all = classes(effects);
    all.truncate(ElasticClass::ALL.len());
    all
}

/// Columns behind `fixed` others.
fn moved(columns: Vec<Range<usize>>, fixed: usize) -> Vec<Range<usize>> {
    let shifted = |class: Range<usize>| fixed + class.start..fixed + class.end;
    columns.into_iter().map(shifted).collect()
}
