//! Optimal continuous designs by column generation: optimal weights on the
//! points at hand, then the points of the whole space that would improve them.

use super::criterion::Criterion;
use super::design::{ContinuousDesign, DesignOptions, DesignSpace};
use super::generation::Generation;
use crate::error::{Code, Error, Result};
use crate::numerics::control::{Control, Termination};
use nalgebra::DMatrix;

/// The continuous design over `space` that minimises `criterion`, and with it
/// the bound that no design of N points goes below (Kiefer & Wolfowitz 1960,
/// doi:10.4153/CJM-1960-030-4; column generation is the exchange of Fedorov,
/// *Theory of Optimal Experiments*, 1972).
///
/// `prior_information` is B, information from elsewhere per point of the design, n × n,
/// symmetric positive semidefinite.
/// `starts` are points of the space that determine all unknowns together.
/// Where the criterion's matrix is singular the optimal M₀ may be singular as
/// well: M₀ then keeps a quarter of the tolerance of the starts' mean
/// information, which loosens the bound by no more than that share.
///
/// A design that does not reach the tolerance in the rounds it has, or is
/// stopped, is returned with its (looser, still valid) bound.
///
/// # Errors
/// Options or a criterion that make no sense, information that is not finite,
/// no starts, starts that leave unknowns undetermined (they are named), or a
/// stop before the first round.
pub fn optimal_design<S: DesignSpace>(
    space: &S,
    criterion: &Criterion,
    prior_information: Option<&DMatrix<f64>>,
    starts: &[Vec<f64>],
    options: DesignOptions,
    control: Control<'_>,
) -> Result<ContinuousDesign> {
    let mut generation = Generation::new(space, criterion, prior_information, starts, options)?;
    let mut active = generation.start();
    let mut latest: Option<ContinuousDesign> = None;
    let mut rounds = 0;
    let termination = loop {
        if control.stopped() {
            break Termination::Interrupted;
        }
        if rounds == options.max_rounds {
            break Termination::IterationLimit;
        }
        rounds += 1;
        control.report("bounding", rounds, options.max_rounds);
        let weights = generation.solve(&mut active)?;
        let (mut design, mut improving) = generation.search(&active, &weights)?;
        if design.residual <= options.tolerance {
            if let Some(tidied) = generation.tidied(&active, &weights, &improving)? {
                (design, active) = tidied;
            }
            improving = generation.verify(&mut design);
        }
        let converged = design.residual <= options.tolerance;
        latest = Some(design);
        if converged {
            break Termination::Converged;
        }
        improving.retain(|point| !active.contains(point));
        if improving.is_empty() {
            break Termination::Stalled;
        }
        active.extend(improving);
    };
    let mut design =
        latest.ok_or_else(|| Error::new(Code::Interrupted, "Stopped before the first bound was found."))?;
    if termination != Termination::Converged {
        // Whatever it is worth, the bound must not rest on a narrow search.
        generation.verify(&mut design);
    }
    design.rounds = rounds;
    design.searches = generation.searches();
    design.termination = termination;
    Ok(design)
}
