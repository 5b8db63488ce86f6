//! Figures of an identification: stiffness, residuals, errors, what single postures do.

mod errors;
mod residuals;
mod states;
mod stiffness;

pub use errors::{correlation_figure, errors_figure};
pub use residuals::{clamped_residual_figure, residual_figure};
pub use states::{influence_figure, load_states_figure};
pub use stiffness::{StiffnessRow, stiffness_figure};

/// The number of a name in such a list; `None` where it is not in it.
pub(crate) fn place(names: &[&str], name: &str) -> Option<usize> {
    names.iter().position(|other| *other == name)
}
