//! What a language needs to know beside the program.

/// Options of writing and reading a program.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ProgramOptions {
    /// For each joint of the cell, in the cell's order, the axis of the controller, counted from 1
    /// in the controller's order; if it is not given the two orders are the same, which only holds
    /// for robots of up to six joints.
    pub controller_axes: Option<Vec<usize>>,
    /// Encoder pulses per degree of each axis of a Yaskawa controller, in the controller's order.
    pub pulses_per_degree: Option<Vec<f64>>,
    /// The controller's tool: a name in RAPID (if none is given `tool0`), a number in KRL, FANUC TP
    /// (if none is given 1) and INFORM (0).
    pub tool: Option<String>,
}

impl ProgramOptions {
    /// Values in the controller's order.
    pub(super) fn to_controller(&self, q: &[f64]) -> Vec<f64> {
        match &self.controller_axes {
            None => q.to_vec(),
            Some(axes) => {
                let mut out = q.to_vec();
                for (value, axis) in q.iter().zip(axes) {
                    out[axis - 1] = *value;
                }
                out
            }
        }
    }

    /// Values in the cell's order.
    pub(super) fn to_cell(&self, values: &[f64]) -> Vec<f64> {
        match &self.controller_axes {
            None => values.to_vec(),
            Some(axes) => axes.iter().map(|axis| values[axis - 1]).collect(),
        }
    }
}
