//! `stiffarm schema`: JSON Schemas.

use super::{capsules, check, export, route, study, zones};
use crate::args::{SchemaArgs, SchemaChoice};
use crate::output::Exit;
use crate::session::Session;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use stiffarm::Result;
use stiffarm::estimate::clamped::{self, ClampedIdentification};
use stiffarm::estimate::simulate::{ElasticSimulation, Simulation};
use stiffarm::estimate::{identified, simulated, validated};
use stiffarm::files::cell::cell_schema;
use stiffarm::files::envelope::{Written, to_json};
use stiffarm::measure::registered;
use stiffarm::measure::registration::RegistrationRecord;
use stiffarm::plan::check::CellCheck;
use stiffarm::plan::index::{Evaluated, EvaluatedOptions};
use stiffarm::plan::planned;
use stiffarm::plan::poses;
use stiffarm::plan::zones::Zones;
use stiffarm::work::map::{Placement, StiffnessMap};
use stiffarm::work::{compensated, judged, mapped, placed, predicted};

/// Prints one schema.
pub fn run(session: &Session, args: &SchemaArgs) -> Result<Exit> {
    let schema: Schema = match args.what {
        SchemaChoice::Cell => cell_schema(),
        SchemaChoice::ResultCheck => of::<check::Options, CellCheck>("check"),
        SchemaChoice::ResultEvaluate => of::<EvaluatedOptions, Evaluated>("evaluate"),
        SchemaChoice::ResultSelect => of::<planned::PlanOptions, planned::Plan>("select"),
        SchemaChoice::ResultSelectDrop => {
            of::<planned::DropOptions, planned::DropResult>("select --drop")
        }
        SchemaChoice::ResultSelectCurve => {
            of::<planned::CurveOptions, planned::Curve>("select --curve")
        }
        SchemaChoice::ResultSelectSpaceFilling => {
            of::<planned::SpaceFillingOptions, planned::SpaceFillingPlan>("select --space-filling")
        }
        SchemaChoice::ResultSelectCandidates => {
            of::<planned::ChosenOptions, planned::Chosen>("select --candidates")
        }
        SchemaChoice::ResultSimulate => of::<simulated::Options, Simulation>("simulate"),
        SchemaChoice::ResultSimulateElastic => {
            of::<simulated::ElasticOptions, ElasticSimulation>("simulate --elastic")
        }
        SchemaChoice::ResultRegister => of::<registered::Options, RegistrationRecord>("register"),
        SchemaChoice::ResultIdentify => {
            of::<identified::Options, identified::Identified>("identify")
        }
        SchemaChoice::ResultIdentifyClamped => {
            of::<clamped::Options, ClampedIdentification>("identify --clamped")
        }
        SchemaChoice::ResultValidate => of::<validated::Options, validated::Validated>("validate"),
        SchemaChoice::ResultPredict => of::<predicted::Options, predicted::Predicted>("predict"),
        SchemaChoice::ResultCompensate => {
            of::<compensated::Options, compensated::Compensated>("compensate")
        }
        SchemaChoice::ResultMap => of::<mapped::Options, StiffnessMap>("map"),
        SchemaChoice::ResultMapPlace => of::<placed::Options, Placement>("map --place"),
        SchemaChoice::ResultZones => of::<zones::Options, Zones>("zones"),
        SchemaChoice::ResultCapsules => of::<capsules::Options, capsules::Fitted>("capsules"),
        SchemaChoice::ResultMeasure => of::<judged::Options, judged::Judgement>("measure"),
        SchemaChoice::ResultPose => of::<poses::Options, poses::Poses>("pose"),
        SchemaChoice::ResultPoseFrom => of::<poses::Options, poses::Found>("pose --from"),
        SchemaChoice::ResultReport => {
            of::<super::report::Options, super::report::Reported>("report")
        }
        SchemaChoice::ResultRoute => of::<route::Options, route::Routed>("route"),
        SchemaChoice::ResultExport => of::<export::Options, export::Exported>("export"),
        SchemaChoice::ResultExportCompare => {
            of::<export::Options, export::compare::Compared>("export --compare")
        }
        SchemaChoice::ResultStudyMeasured => {
            of::<study::measured::Options, study::measured::Written>("study --measured")
        }
        SchemaChoice::ResultStudy => of::<study::Options, study::Written>("study"),
    };
    session.print_exact(&to_json(&schema)?)?;
    Ok(Exit::Done)
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
