//! The bound of the continuous design is that of textbook problems with known optimal designs, and neither brute force
//! on small discrete problems nor any plan of a cell falls below it.
//!
//! `cargo test --workspace --test formulas certificate -- --nocapture` prints what was reached.

mod continuous;
mod parts;
mod plans;

use crate::common::prelude::*;
use proptest::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use stiffarm::internals::design::{
    ContinuousDesign, Criterion, DesignOptions, DesignSpace, Effort, PostureSpace, optimal_design,
};
use stiffarm::plan::certificate::{Certificate, Verification, certify_further, joint_efficiencies};

/// tr(A G).
fn slope(a: &DMatrix<f64>, g: &DMatrix<f64>) -> f64 {
    a.component_mul(g).sum()
}

/// φ(M), written out by the definitions; infinite for a singular M.
fn value(criterion: &Criterion, m: &DMatrix<f64>) -> f64 {
    let values = m.clone().symmetric_eigenvalues();
    if values.min() <= 1e-12 * values.max() {
        return f64::INFINITY;
    }
    match criterion {
        Criterion::Determinant => values.product().powf(-1.0 / m.nrows() as f64),
        Criterion::Trace(q) => (q * m.clone().try_inverse().unwrap()).trace(),
    }
}

fn design(space: &impl DesignSpace, criterion: &Criterion, starts: &[Vec<f64>], tolerance: f64) -> ContinuousDesign {
    let options = DesignOptions { tolerance, ..DesignOptions::default() };
    optimal_design(space, criterion, None, starts, options, Control::default()).unwrap()
}

/// A posture that the bound rests on and no search met: others may be missed as well.
#[test]
fn a_bound_whose_postures_no_search_met_is_doubted() {
    let mut verification = Verification::default();
    (verification.searches, verification.agreeing) = (1000, 12);
    insta::assert_snapshot!(verification.doubt().unwrap(), @"none of them met one of the postures that the bound itself rests on: others may be missed too, and then the bound is too high");
    verification.rarest = 1;
    assert_eq!(verification.doubt(), None);
}
