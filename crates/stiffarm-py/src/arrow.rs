//! Tables by the Arrow C interface: frames of any library in, ours out.

use crate::error::Raised;
use arrow_array::{Array, ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, StringArray};
use arrow_cast::cast;
use arrow_cast::display::{ArrayFormatter, FormatOptions};
use arrow_schema::{DataType, Field, Schema};
use pyo3::prelude::*;
use pyo3_arrow::PyTable;
use std::sync::Arc;
use stiffarm::{Code, Error, Result};

/// A column.
#[derive(FromPyObject)]
pub enum Column {
    /// True or false.
    Truths(Vec<bool>),
    /// Whole numbers.
    Wholes(Vec<i64>),
    /// Numbers; NaN is none.
    Numbers(Vec<f64>),
    /// Texts.
    Texts(Vec<Option<String>>),
}

impl Column {
    fn array(self) -> ArrayRef {
        match self {
            Column::Truths(values) => Arc::new(BooleanArray::from(values)),
            Column::Wholes(values) => Arc::new(Int64Array::from(values)),
            Column::Numbers(values) => {
                let unless_nan = |v: f64| (!v.is_nan()).then_some(v);
                Arc::new(values.into_iter().map(unless_nan).collect::<Float64Array>())
            }
            Column::Texts(values) => Arc::new(StringArray::from(values)),
        }
    }
}

/// The capsule of a stream with these columns.
#[pyfunction]
pub fn stream_of_columns<'py>(
    py: Python<'py>,
    names: Vec<String>,
    columns: Vec<Column>,
    requested: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let arrays: Vec<ArrayRef> = columns.into_iter().map(Column::array).collect();
    let fields = names.iter().zip(&arrays).map(|(name, array)| Field::new(name, array.data_type().clone(), true));
    let schema = Arc::new(Schema::new(fields.collect::<Vec<_>>()));
    let batch = RecordBatch::try_new(Arc::clone(&schema), arrays);
    let batch = batch.map_err(|e| fault(&e)).raised(py)?;
    let table = PyTable::try_new(vec![batch], schema)?;
    let table = Bound::new(py, table)?;
    table.call_method1("__arrow_c_stream__", (requested,))
}

/// The text of a CSV file with the columns of anything that has the Arrow C interface.
#[pyfunction]
pub fn csv_of_stream(py: Python<'_>, table: PyTable) -> PyResult<String> {
    let (batches, schema) = table.into_inner();
    py.detach(|| csv(&batches, &schema)).raised(py)
}

fn csv(batches: &[RecordBatch], schema: &Schema) -> Result<String> {
    let names: Vec<String> = schema.fields().iter().map(|f| quoted(f.name())).collect();
    let mut out = names.join(",") + "\n";
    for batch in batches {
        let columns: Result<Vec<Vec<String>>> = batch.columns().iter().map(fields).collect();
        let columns = columns?;
        for row in 0..batch.num_rows() {
            let line: Vec<&str> = columns.iter().map(|column| column[row].as_str()).collect();
            out += &line.join(",");
            out.push('\n');
        }
    }
    Ok(out)
}

/// The fields of a column; numbers in the fewest digits that are read back as the same, missing values empty.
fn fields(array: &ArrayRef) -> Result<Vec<String>> {
    if matches!(array.data_type(), DataType::Float16 | DataType::Float32 | DataType::Float64) {
        let numbers = cast(array, &DataType::Float64).map_err(|e| fault(&e))?;
        if let Some(numbers) = numbers.as_any().downcast_ref::<Float64Array>() {
            let field = |v: Option<f64>| match v.filter(|v| !v.is_nan()) {
                Some(v) => v.to_string(),
                None => String::new(),
            };
            return Ok(numbers.iter().map(field).collect());
        }
    }
    let options = FormatOptions::default();
    let shown = ArrayFormatter::try_new(array, &options).map_err(|e| fault(&e))?;
    Ok((0..array.len())
        .map(|row| if array.is_null(row) { String::new() } else { quoted(&shown.value(row).to_string()) })
        .collect())
}

/// A field as CSV has it.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}

fn fault(error: &dyn std::fmt::Display) -> Error {
    Error::new(Code::WrongType, format!("The table cannot be used: {error}."))
}
