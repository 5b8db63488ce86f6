//! The JSON Schemas that `schema` prints, as `cargo xtask generate` has made them of the types.

use clap::builder::{PossibleValue, PossibleValuesParser};

/// A schema: its name, what it describes, its text.
type Row = (&'static str, &'static str, &'static str);

/// One row for each file in `schemas/`.
macro_rules! rows {
    ($($name:literal: $about:literal,)*) => {
        [$(($name, $about, include_str!(concat!("../../schemas/", $name, ".json")))),*]
    };
}

/// All schemas.
pub static SCHEMAS: [Row; 30] = rows! {
    "cell": "The cell file",
    "result-check": "Output of `check --json`",
    "result-evaluate": "Output of `evaluate --json`",
    "result-select": "Output of `select --json`: a plan",
    "result-select-drop": "Output of `select --drop --json`",
    "result-select-curve": "Output of `select --curve --json`",
    "result-select-space-filling": "Output of `select --space-filling --json`",
    "result-select-candidates": "Output of `select --candidates --json`",
    "result-simulate": "Output of `simulate --json`",
    "result-simulate-elastic": "Output of `simulate --elastic mixed --json`",
    "result-coverage": "Output of `coverage --json`",
    "result-register": "Output of `register --json`",
    "result-identify": "Output of `identify --json`",
    "result-identify-clamped": "Output of `identify --clamped --json`",
    "result-validate": "Output of `validate --json`",
    "result-predict": "Output of `predict --json`",
    "result-compensate": "Output of `compensate --json`",
    "result-map": "Output of `map --json`",
    "result-map-place": "Output of `map --place --json`",
    "result-zones": "Output of `zones --json`",
    "result-capsules": "Output of `capsules --json`",
    "result-measure": "Output of `measure --once --json`",
    "result-pose": "Output of `pose --json`",
    "result-pose-poses": "Output of `pose --poses --json`",
    "result-report": "Output of `report --json`",
    "result-route": "Output of `route --json`",
    "result-export": "Output of `export --json`",
    "result-export-compare": "Output of `export --compare --json`",
    "result-study": "Output of `study --json`, and study.json",
    "result-study-measured": "Output of `study --measured --json`",
};

/// The names that may be asked for.
pub fn schemas() -> PossibleValuesParser {
    PossibleValuesParser::new(SCHEMAS.map(|(name, about, _)| PossibleValue::new(name).help(about)))
}
