//! What the chains of a global selection exchange.

/// A group of postures (and the load's variables where they are free) with ln
/// of its index.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Plan {
    pub x: Vec<f64>,
    pub value: f64,
}
