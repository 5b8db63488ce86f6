//! JSON Schemas of the types, for the files that `stiffarm schema` prints.

use super::{capsules, check, coverage, export, route, study, zones};
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use std::collections::BTreeMap;
use stiffarm::Result;
use stiffarm::estimate::clamped::{self, ClampedIdentification};
use stiffarm::estimate::coverage::Coverage;
use stiffarm::estimate::simulate::{ElasticSimulation, Simulation};
use stiffarm::estimate::{identified, simulated, validated};
use stiffarm::measure::registered;
use stiffarm::measure::registration::RegistrationRecord;
use stiffarm::plan::check::CellCheck;
use stiffarm::plan::index::{Evaluated, EvaluatedOptions};
use stiffarm::plan::planned;
use stiffarm::plan::poses;
use stiffarm::plan::zones::Zones;
use stiffarm::work::map::{Placement, StiffnessMap};
use stiffarm::work::{compensated, judged, mapped, placed, predicted};
use stiffarm_files::cell::cell_schema;
use stiffarm_files::envelope::{Written, to_json};

/// The texts of all schemas by name.
///
/// # Errors
/// A schema that cannot be written.
pub fn generated() -> Result<BTreeMap<&'static str, String>> {
    let schemas = [
        ("cell", cell_schema()),
        ("result-check", of::<check::Options, CellCheck>("check")),
        (
            "result-evaluate",
            of::<EvaluatedOptions, Evaluated>("evaluate"),
        ),
        (
            "result-select",
            of::<planned::PlanOptions, planned::Plan>("select"),
        ),
        (
            "result-select-drop",
            of::<planned::DropOptions, planned::DropResult>("select --drop"),
        ),
        (
            "result-select-curve",
            of::<planned::CurveOptions, planned::Curve>("select --curve"),
        ),
        (
            "result-select-space-filling",
            of::<planned::SpaceFillingOptions, planned::SpaceFillingPlan>("select --space-filling"),
        ),
        (
            "result-select-candidates",
            of::<planned::ChosenOptions, planned::Chosen>("select --candidates"),
        ),
        (
            "result-simulate",
            of::<simulated::Options, Simulation>("simulate"),
        ),
        (
            "result-simulate-elastic",
            of::<simulated::ElasticOptions, ElasticSimulation>("simulate --elastic"),
        ),
        (
            "result-coverage",
            of::<coverage::Options, Coverage>("coverage"),
        ),
        (
            "result-register",
            of::<registered::Options, RegistrationRecord>("register"),
        ),
        (
            "result-identify",
            of::<identified::Options, identified::Identified>("identify"),
        ),
        (
            "result-identify-clamped",
            of::<clamped::Options, ClampedIdentification>("identify --clamped"),
        ),
        (
            "result-validate",
            of::<validated::Options, validated::Validated>("validate"),
        ),
        (
            "result-predict",
            of::<predicted::Options, predicted::Predicted>("predict"),
        ),
        (
            "result-compensate",
            of::<compensated::Options, compensated::Compensated>("compensate"),
        ),
        ("result-map", of::<mapped::Options, StiffnessMap>("map")),
        (
            "result-map-place",
            of::<placed::Options, Placement>("map --place"),
        ),
        ("result-zones", of::<zones::Options, Zones>("zones")),
        (
            "result-capsules",
            of::<capsules::Options, capsules::Fitted>("capsules"),
        ),
        (
            "result-measure",
            of::<judged::Options, judged::Judgement>("measure"),
        ),
        ("result-pose", of::<poses::Options, poses::Poses>("pose")),
        (
            "result-pose-poses",
            of::<poses::Options, poses::Found>("pose --poses"),
        ),
        (
            "result-report",
            of::<super::report::Options, super::report::Reported>("report"),
        ),
        ("result-route", of::<route::Options, route::Routed>("route")),
        (
            "result-export",
            of::<export::Options, export::Exported>("export"),
        ),
        (
            "result-export-compare",
            of::<export::Options, export::compare::Compared>("export --compare"),
        ),
        (
            "result-study-measured",
            of::<study::measured::Options, study::measured::Written>("study --measured"),
        ),
        (
            "result-study",
            of::<study::Options, study::Written>("study"),
        ),
    ];
    let texts = schemas
        .into_iter()
        .map(|(name, schema)| Ok((name, to_json(&schema)?)));
    texts.collect()
}

/// Schema of what a command prints with `--json`.
fn of<O: JsonSchema, R: JsonSchema>(command: &str) -> Schema {
    // `double` and `uint64` are names of Rust's types, not of JSON Schema's formats.
    let drop_format = RecursiveTransform(|schema: &mut Schema| {
        schema.remove("format");
    });
    let mut schema = SchemaSettings::draft2020_12()
        .for_serialize()
        .with_transform(drop_format)
        .into_generator()
        .into_root_schema_for::<Written<O, R>>();
    let title = format!("Output of stiffarm {command} --json");
    schema.insert("title".to_string(), title.into());
    schema
}
