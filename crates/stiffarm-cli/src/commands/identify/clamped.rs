//! `stiffarm identify --clamped`: joint stiffness with the flange fixed.

use crate::answer::Answer;
use crate::args;
use crate::files::only_target;
use crate::output::Exit;
use crate::session::Session;
use stiffarm::estimate::clamped::{ClampedPosture, identify_clamped, without};
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::estimate::identify::NoiseSource;
use stiffarm::findings::Severity;
use stiffarm::units::deg_to_rad;
use stiffarm::{Code, Error, Result};
use stiffarm_files::source::{NamedCell, Source, read_postures};
use stiffarm_files::table::read_clamped;

/// Identifies the joint stiffness from clamped postures.
pub fn run(session: &Session, args: &args::Identify) -> Result<Answer> {
    let target = only_target(session, args.output.as_deref(), args.force)?;
    let named = session.read_cell(&args.cell)?;
    let clamped = read(session, args, &named)?;
    let request = &args.options;
    let options = request.options(&named.cell.setup.robot)?;
    if request.fit.elastic == Some(ElasticChoice::Mixed) {
        let message = "With the flange fixed only the joint axes can be told: angles show nothing else.";
        return Err(Error::new(Code::Unsupported, message)
            .key("--elastic")
            .hint("leave it out, or measure displacements with the flange free"));
    }
    let noise = request.angle_noise_deg.map(deg_to_rad);
    if options.noise == NoiseSource::Known && noise.is_none() {
        let message = "Known noise with --clamped needs the standard deviation of the angles.";
        return Err(Error::new(Code::Usage, message).key("--noise").hint("give it with --angle-noise-deg"));
    }
    let result = identify_clamped(&named.cell, &clamped, noise, &options)?;

    let complete = result.estimates.is_complete();
    let serious = |f: &stiffarm::findings::Finding| f.severity == Severity::Serious;
    let exit = Exit::finding(!complete || result.findings.iter().any(serious));
    let envelope = session.envelope("identify", None, request.clone(), result);
    Answer::summary(exit, envelope, named, args.details).with_object(target)
}

fn read(session: &Session, args: &args::Identify, named: &NamedCell) -> Result<Vec<ClampedPosture>> {
    let robot = &named.cell.setup.robot;
    let postures = args.postures.as_deref().map(|from| read_postures(session, "postures", from, robot)).transpose()?;
    let [measurements] = args.measurements.as_slice() else {
        let error = Error::new(Code::Usage, "--clamped reads one table.").key("--clamped");
        return Err(error.hint("give all postures in one file"));
    };
    let (file, bytes) = session.read("measurements", measurements)?;
    let clamped = read_clamped(&bytes, &file, &named.cell, postures.as_deref())?;
    if clamped.is_empty() {
        let message = "The table has no measurements, only a heading.";
        return Err(Error::new(Code::TooFewData, message).file(file).hint("add one row per posture and load state"));
    }
    without(clamped, &args.options.exclude)
}
