//! `stiffarm._stiffarm`: what the Python package calls. Values in, values out: arrays, texts and bytes; results are the
//! JSON that the command prints. Everything that people call, with its documentation, is in `python/stiffarm`.

mod arrays;
mod arrow;
mod cell;
mod command;
mod cores;
mod error;
mod kinematics;
mod long;
mod objective;
mod paths;
mod plans;
mod values;

use pyo3::prelude::*;

/// The extension module.
#[pymodule]
mod _stiffarm {
    #[pymodule_export]
    use crate::arrays::{index_names, indices, observation_matrix};
    #[pymodule_export]
    use crate::arrow::{csv_of_stream, stream_of_columns};
    #[pymodule_export]
    use crate::cell::PyCell;
    #[pymodule_export]
    use crate::command::{commands, figures, page, run, summary};
    #[pymodule_export]
    use crate::cores::set_threads;
    #[pymodule_export]
    use crate::kinematics::{axes_table, flange_pose, inverse, jacobian, nearest, urdf_table};
    #[pymodule_export]
    use crate::objective::Objective;
    #[pymodule_export]
    use crate::paths::{path_program, path_text};
    #[pymodule_export]
    use crate::plans::{certificate, drawing, simulate_measurements};
    #[pymodule_export]
    use crate::values::{degrees, json_of_toml, posture_text, radians, read_postures, toml_of_json};

    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::cores::begin();
        module.add("MOST_POSTURES", stiffarm::plan::select::MOST_POSTURES)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
