//! `stiffarm._stiffarm`: what the Python package calls. Values in, values out: arrays, texts and bytes; results are the
//! JSON that the command prints. Everything that people call, with its documentation, is in `python/stiffarm`.

mod arrays;
mod arrow;
mod cell;
mod cores;
mod error;
mod identify;
mod inputs;
mod kinematics;
mod long;
mod objective;
mod select;
mod simulate;
mod values;
mod work;

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
    use crate::cores::set_threads;
    #[pymodule_export]
    use crate::identify::{identify, identify_with_flange_fixed, validate};
    #[pymodule_export]
    use crate::kinematics::{axes_table, flange_pose, inverse, jacobian, nearest, urdf_table};
    #[pymodule_export]
    use crate::objective::Objective;
    #[pymodule_export]
    use crate::select::{
        certificate, select, select_candidates, select_curve, select_drop, select_space_filling,
    };
    #[pymodule_export]
    use crate::simulate::{coverage, evaluate, register, simulate, simulate_measurements};
    #[pymodule_export]
    use crate::values::{
        check, degrees, json_of_toml, posture_text, radians, read_postures, robots, toml_of_json,
    };
    #[pymodule_export]
    use crate::work::{compensate, map, place_workpiece, predict};

    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::cores::begin();
        module.add("MOST_POSTURES", stiffarm::plan::planned::MOST_POSTURES)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
