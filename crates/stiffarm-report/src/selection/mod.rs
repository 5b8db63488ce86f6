//! Figures about the choice of postures: what a group is worth, how a plan was found, what limits it.

mod bounds;
mod convergence;
mod correlation;
mod costs;
mod deviation;
mod dexterity;
mod noise;
mod singular_values;

pub use bounds::{CountPoint, count_figure};
pub use convergence::convergence_figure;
pub use correlation::correlation_figure;
pub(crate) use correlation::correlation_panel;
pub use costs::{price_figure, sensitivity_figure, worth_figure};
pub use deviation::{Deviations, expected_deviation_figure};
pub use dexterity::dexterity_figure;
pub use noise::deviation_by_noise_figure;
pub use singular_values::singular_values_figure;
