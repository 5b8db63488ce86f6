//! Figures of an identification: stiffness, residuals, errors, what single postures do.

mod errors;
mod residuals;
mod states;
mod stiffness;

pub use errors::{correlation_figure, errors_figure};
pub use residuals::{clamped_residual_figure, residual_figure};
pub use states::{influence_figure, load_states_figure};
pub use stiffness::{StiffnessRow, stiffness_figure};

/// Places of categories: 0, 1, …
pub(crate) fn places(count: usize) -> Vec<f64> {
    (0..count).map(|i| i as f64).collect()
}

/// Names in the order in which they first appear.
pub(crate) fn in_order<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let mut out: Vec<&str> = Vec::new();
    for name in names {
        if !out.contains(&name) {
            out.push(name);
        }
    }
    out
}

/// The number of a name in such a list.
pub(crate) fn place(names: &[&str], name: &str) -> usize {
    names.iter().position(|own| *own == name).unwrap_or(0)
}
