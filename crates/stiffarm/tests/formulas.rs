//! Tests that work out at length what the library says in a moment: optimised, which those of `it` are not, because
//! compiling takes longer there than running.

#[path = "it/common/mod.rs"]
mod common;

#[path = "it/certificate/mod.rs"]
mod certificate;
#[path = "it/estimators/mod.rs"]
mod estimators;
#[path = "it/feasible/mod.rs"]
mod feasible;
#[path = "it/gradients.rs"]
mod gradients;
#[path = "it/inverse/mod.rs"]
mod inverse;
#[path = "it/milling.rs"]
mod milling;
#[path = "it/mixed.rs"]
mod mixed;
#[path = "it/mixed_doubt.rs"]
mod mixed_doubt;
#[path = "it/prediction_index.rs"]
mod prediction_index;
#[path = "it/systematic.rs"]
mod systematic;
#[path = "it/total_uncertainty.rs"]
mod total_uncertainty;
