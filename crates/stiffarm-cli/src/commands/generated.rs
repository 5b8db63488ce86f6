//! JSON Schemas of the types, for the files that `stiffarm schema` prints.

use super::{capsules, export, study};
use crate::output::NoOptions;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::Value;
use std::collections::BTreeMap;
use stiffarm::Result;
use stiffarm::ask::coverage::CoverageOptions;
use stiffarm::ask::path::PathOptions;
use stiffarm::ask::register::PairOptions;
use stiffarm::ask::select::{self, SelectResultOptions};
use stiffarm::ask::{compensate, identify, map, measure, place, pose, predict, route, simulate, validate, zones};
use stiffarm::estimate::clamped::ClampedIdentification;
use stiffarm::estimate::coverage::Coverage;
use stiffarm::estimate::simulate::{ElasticSimulation, ElasticSimulationOptions, Simulation};
use stiffarm::measure::registration::RegistrationRecord;
use stiffarm::plan::check::CellCheck;
use stiffarm::plan::evaluated::{Evaluated, EvaluatedOptions};
use stiffarm::plan::zones::Zones;
use stiffarm::work::map::{Placement, StiffnessMap};
use stiffarm_files::cell::cell_schema;
use stiffarm_files::envelope::{Written, to_json};

/// The texts of all schemas by name.
///
/// # Errors
/// A schema that cannot be written.
pub fn generated() -> Result<BTreeMap<String, String>> {
    let schemas = [
        ("cell".to_string(), cell_schema()),
        of::<NoOptions, CellCheck>("check"),
        of::<EvaluatedOptions, Evaluated>("evaluate"),
        of::<SelectResultOptions, select::Plan>("select"),
        of::<SelectResultOptions, select::DropResult>("select --drop"),
        of::<SelectResultOptions, select::Curve>("select --curve"),
        of::<SelectResultOptions, select::SpaceFillingPlan>("select --space-filling"),
        of::<SelectResultOptions, select::Chosen>("select --candidates"),
        of::<simulate::Options, Simulation>("simulate"),
        of::<ElasticSimulationOptions, ElasticSimulation>("simulate --elastic"),
        of::<CoverageOptions, Coverage>("coverage"),
        of::<PairOptions, RegistrationRecord>("register"),
        of::<identify::IdentifiedOptions, identify::Identified>("identify"),
        of::<identify::IdentifiedOptions, ClampedIdentification>("identify --clamped"),
        of::<validate::Options, validate::Validated>("validate"),
        of::<predict::PredictOptions, predict::Predicted>("predict"),
        of::<PathOptions, compensate::Compensated>("compensate"),
        of::<map::Options, StiffnessMap>("map"),
        of::<place::Options, Placement>("map --place"),
        of::<zones::ZonesResultOptions, Zones>("zones"),
        of::<capsules::Options, capsules::Fitted>("capsules"),
        of::<measure::MeasureOptions, measure::Judgement>("measure"),
        of::<pose::Options, pose::Poses>("pose"),
        of::<pose::Options, pose::PoseSolutions>("pose --poses"),
        of::<NoOptions, super::report::Reported>("report"),
        of::<route::DriveOptions, route::Routed>("route"),
        of::<export::Options, export::Exported>("export"),
        of::<export::Options, export::compare::Compared>("export --compare"),
        of::<study::measured::Options, study::measured::Written>("study --measured"),
        of::<study::Options, study::Written>("study"),
    ];
    let texts = schemas.into_iter().map(|(name, schema)| Ok((name, to_json(&schema)?)));
    texts.collect()
}

/// Name and schema of what a command prints with `--json`.
fn of<O: JsonSchema, R: JsonSchema>(command: &str) -> (String, Schema) {
    // `double` and `uint64` are names of Rust's types, not of JSON Schema's formats.
    let drop_format = RecursiveTransform(|schema: &mut Schema| {
        schema.remove("format");
    });
    // Angles are radians in memory, and degrees where a key says so.
    let in_degrees = RecursiveTransform(|schema: &mut Schema| {
        let properties = schema.get_mut("properties").and_then(Value::as_object_mut);
        let angles = properties.into_iter().flatten().filter(|(key, _)| key.ends_with("_deg"));
        for (_, property) in angles {
            if let Some(Value::String(text)) = property.get_mut("description") {
                *text = text.replace("[rad", "[deg");
            }
        }
    });
    let mut schema = SchemaSettings::draft2020_12()
        .for_serialize()
        .with_transform(drop_format)
        .with_transform(in_degrees)
        .into_generator()
        .into_root_schema_for::<Written<O, R>>();
    let title = format!("Output of stiffarm {command} --json");
    schema.insert("title".to_string(), title.into());
    let name = command.replace(" --", "-").replace(' ', "-");
    (format!("result-{name}"), schema)
}
