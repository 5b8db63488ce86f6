//! The sizes of one choice of random effects, and where its classes stand.

use super::likelihood::{Likelihood, Sizes};
use super::means::gathered;
use super::sums::Rows;
use super::too_few;
use crate::error::Result;
use crate::estimate::identify::Fit;
use crate::model::elastic::{Effect, ElasticClass};
use crate::numerics::information::scale_columns;
use nalgebra::DMatrix;
use std::ops::Range;

/// A mixed model with its sizes.
pub(super) struct Found {
    pub(super) effects: Vec<Effect>,
    pub(super) rows: Rows,
    pub(super) sizes: Sizes,
    /// −2 ln L_R, and that without random effects.
    pub(super) values: [f64; 2],
}

/// The model of `effects`, whose columns in the terms' units are `columns`; its sizes are looked for near those of another
/// model, where there is one.
///
/// # Errors
/// Nothing left of the displacements, or no degree of freedom.
pub(super) fn found(
    fit: &Fit,
    columns: &DMatrix<f64>,
    effects: Vec<Effect>,
    near: Option<&Sizes>,
) -> Result<Found> {
    let solution = fit.solution();
    let mut random = columns.clone();
    scale_columns(&mut random, effects.iter().map(|effect| effect.scale));
    gathered(&mut random, &means(&effects));
    let whitened = fit.prepared().whitened();
    let shifts = whitened.is_separable() && !solution.independent_rows;
    let classes = classes(&effects);
    let idle = solution.undetermined.as_slice();
    let rows = Rows::new(whitened, random, classes, fit.white(), idle, shifts);
    if rows.rest() <= ROUNDING * fit.white().norm() {
        return Err(too_few("the joint axes leave nothing of the displacements"));
    }
    let likelihood = Likelihood::new(&rows, &[]);
    let none = Sizes {
        gamma: solution.gamma,
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

/// Residuals below this share of the displacements are rounding.
const ROUNDING: f64 = 1e-11;

/// Compliance of each joint as the axes alone have it, for what is sized by it.
pub(super) fn joint_give(fit: &Fit) -> Vec<Option<f64>> {
    let robot = &fit.cell().setup.robot;
    let springs = fit.solution().values.rows(0, robot.spring_count());
    // Springs that are no joints give to each by the squares of their shares.
    let give = match robot.spring_mixing() {
        None => springs.into_owned(),
        Some(mixing) => mixing.map(|share| share * share) * springs,
    };
    give.iter().copied().map(Some).collect()
}

/// Columns of each class that scatter about a mean.
pub(super) fn means(effects: &[Effect]) -> Vec<Range<usize>> {
    let positive = |class: &Range<usize>| effects[class.clone()].iter().filter(|e| e.is_positive());
    let own = |class: Range<usize>| class.start..class.start + positive(&class).count();
    classes(effects).into_iter().map(own).collect()
}

/// Columns of each class.
pub(super) fn classes(effects: &[Effect]) -> Vec<Range<usize>> {
    let of = |class| {
        let start = effects.iter().position(|e| e.class == class).unwrap_or(0);
        start..start + effects.iter().filter(|e| e.class == class).count()
    };
    ElasticClass::ALL.map(of).to_vec()
}

/// Columns behind `fixed` others.
pub(super) fn moved(columns: Vec<Range<usize>>, fixed: usize) -> Vec<Range<usize>> {
    let own = |class: Range<usize>| fixed + class.start..fixed + class.end;
    columns.into_iter().map(own).collect()
}
