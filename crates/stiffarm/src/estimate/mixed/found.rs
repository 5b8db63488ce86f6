//! The sizes of one choice of random effects, and where its classes stand.

use super::doubt::doubt;
use super::likelihood::{Likelihood, Sizes};
use super::means::gathered;
use super::sums::Rows;
use super::too_few;
use crate::error::Result;
use crate::estimate::compliance::{IdentifiedCompliance, Spread};
use crate::estimate::freedom::SizeDoubt;
use crate::estimate::identify::Fit;
use crate::model::elastic::{Effect, ElasticClass, ElasticSizing, fitted, terms};
use crate::numerics::information::scale_columns;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// A mixed model with its sizes.
pub(super) struct Found {
    pub(super) effects: Vec<Effect>,
    pub(super) rows: Rows,
    pub(super) sizes: Sizes,
    /// −2 ln L_R, and that without random effects.
    pub(super) values: [f64; 2],
}

/// The likeliest model of all postures but `left_out` (ascending), whose axes alone have the compliances `axes` and the
/// ratio `gamma`; `columns` are those of the terms in their units. The sizes are looked for near `near`, or from several
/// starts.
///
/// # Errors
/// As [`found`]; interrupted.
pub(super) fn likeliest(
    fit: &Fit,
    columns: &DMatrix<f64>,
    axes: &DVector<f64>,
    gamma: f64,
    left_out: &[usize],
    near: Option<&Sizes>,
) -> Result<(ElasticSizing, Found)> {
    let of = |sizing, near| {
        fit.control().check()?;
        found(fit, columns, axes, gamma, left_out, sizing, near)
    };
    let alike = of(ElasticSizing::Alike, near)?;
    let by_joint = of(ElasticSizing::ByJoint, Some(&alike.sizes))?;
    // As likely with entries that are alike is no reason to take others.
    Ok(match by_joint.values[0] < alike.values[0] - SAME {
        true => (ElasticSizing::ByJoint, by_joint),
        false => (ElasticSizing::Alike, alike),
    })
}

/// The model with entries of this sizing; its sizes are looked for near those of another model, where there is one.
///
/// # Errors
/// Nothing left of the displacements, or no degree of freedom.
pub(super) fn found(
    fit: &Fit,
    columns: &DMatrix<f64>,
    axes: &DVector<f64>,
    gamma: f64,
    left_out: &[usize],
    sizing: ElasticSizing,
    near: Option<&Sizes>,
) -> Result<Found> {
    let effects = fitted(
        &fit.cell().setup.robot,
        joint_give(fit, axes).as_slice(),
        sizing,
    );
    let mut random = columns.clone();
    scale_columns(&mut random, effects.iter().map(|effect| effect.scale));
    gathered(&mut random, &means(&effects));
    let (whitened, solution) = (fit.prepared().whitened(), fit.solution());
    let shifts = whitened.is_separable() && !solution.independent_rows;
    let classes = classes(&effects);
    let idle = solution.undetermined.as_slice();
    let rows = Rows::new(whitened, random, classes, fit.white(), idle, shifts);
    if rows.rest() <= ROUNDING * fit.white().norm() {
        return Err(too_few("the joint axes leave nothing of the displacements"));
    }
    let likelihood = Likelihood::new(&rows, left_out);
    let none = Sizes {
        gamma,
        classes: vec![0.0; rows.classes.len()],
    };
    let (Some((sizes, value)), Some(without)) = (
        likelihood.best(near, fit.control()),
        likelihood.solve(&none),
    ) else {
        return Err(too_few("there are hardly more displacements than joints"));
    };
    // The search may end a hair above what no effects at all give.
    let (sizes, value) = if without.value <= value {
        (none, without.value)
    } else {
        (sizes, value)
    };
    Ok(Found {
        effects,
        rows,
        sizes,
        values: [value, without.value],
    })
}

impl Found {
    /// The solution of the mixed-model equations of all postures but `left_out` in the effects' own units.
    pub(super) fn compliance(&self, fit: &Fit, left_out: &[usize]) -> Option<IdentifiedCompliance> {
        let Found {
            effects,
            rows,
            sizes,
            ..
        } = self;
        let likelihood = Likelihood::new(rows, left_out);
        let plain = fit.solution();
        let fixed = rows.fixed;
        let scale = |i: usize| {
            if i < fixed {
                1.0
            } else {
                effects[i - fixed].scale
            }
        };
        let solved = likelihood.solve(sizes)?;
        let means = moved(means(effects), fixed);
        let (mut covariance, of_sizes) = doubt(rows, &likelihood, sizes, &solved);
        // u = L w.
        let mut values = DMatrix::from_columns(&[solved.values(rows)]).transpose();
        gathered(&mut values, &means);
        for _ in 0..2 {
            gathered(&mut covariance, &means);
            covariance = covariance.transpose();
        }
        let mut values = values.transpose().column(0).into_owned();
        for (i, value) in values.iter_mut().enumerate() {
            *value *= scale(i);
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
            values,
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
        classes: moved(classes(effects), fixed),
        means: moved(means(effects), fixed),
        prior: DVector::from_fn(fixed + effects.len(), |i, _| match i.checked_sub(fixed) {
            Some(i) => (std(effects[i].class) * effects[i].scale).powi(2),
            None => 0.0,
        }),
        covariance,
    }
}

/// Differences of −2 ln L_R below this are none.
const SAME: f64 = 1e-6;
/// Residuals below this share of the displacements are rounding.
const ROUNDING: f64 = 1e-11;

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
    let own = |class: Range<usize>| class.start..class.start + positive(&class).count();
    classes(effects).into_iter().map(own).collect()
}

/// Columns of each class.
fn classes(effects: &[Effect]) -> Vec<Range<usize>> {
    let of = |class| {
        let start = effects.iter().position(|e| e.class == class).unwrap_or(0);
        start..start + effects.iter().filter(|e| e.class == class).count()
    };
    ElasticClass::ALL.map(of).to_vec()
}

/// Columns behind `fixed` others.
fn moved(columns: Vec<Range<usize>>, fixed: usize) -> Vec<Range<usize>> {
    let own = |class: Range<usize>| fixed + class.start..fixed + class.end;
    columns.into_iter().map(own).collect()
}
