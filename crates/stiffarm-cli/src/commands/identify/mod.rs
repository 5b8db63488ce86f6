//! `stiffarm identify`: joint stiffness from measured displacements or raw readings.

pub mod clamped;
mod elastic;
mod messages;
mod next;
pub mod readings;
mod summary;
mod tables;

pub use messages::confidence;

use crate::args::IdentifyArgs;
use crate::files::only_target;
use crate::output::Exit;
use crate::progress::Progress;
use crate::screen::{columns, wrapped};
use crate::session::Session;
use crate::table::title;
use readings::Reduced;
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::estimate::coverage::{Intervals, MeasuredCoverage, measured as measured_coverage};
use stiffarm::estimate::diagnose::{Diagnosis, diagnose};
use stiffarm::estimate::elastic::{Elastic, ElasticChoice, elastic};
use stiffarm::estimate::identify::{
    Bootstrap, Estimator, Fit, Identification, NoiseSource, Profile, Weights, bootstrap,
    implausible_scale, profile,
};
use stiffarm::estimate::next_posture::{NextPosture, next_posture};
use stiffarm::estimate::systematic::{SystematicErrors, systematic_errors};
use stiffarm::findings::Severity;
use stiffarm::measure::screening::Screening;
use stiffarm::measure::{Measured, prepare};
use stiffarm::model::measurement::MeasuredPosture;
use stiffarm::model::observation::ExtraTerm;
use stiffarm::plan::select::GlobalOptions;
use stiffarm::{Code, Control, Error, Result};

/// Rounds of the search for the next posture: one posture is soon found.
const ADVICE_ROUNDS: u64 = 2;

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// How the stiffness is estimated.
    pub estimator: Estimator,
    /// Where the relative weight of single displacements comes from.
    pub weights: Weights,
    /// Where the size of the noise comes from.
    pub noise: NoiseSource,
    /// Confidence of the intervals.
    pub confidence: f64,
    /// Further terms asked for.
    pub extra: Vec<ExtraTerm>,
    /// What gives way, where that is not the joint axes alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elastic: Option<ElasticChoice>,
    /// Relative standard deviation of the prior stiffness (fraction).
    pub prior_std: f64,
    /// Postures left out.
    pub exclude: Vec<String>,
    /// Resamples of the bootstrap.
    pub bootstrap: Option<u64>,
    /// Whether only estimates and residuals were wanted.
    pub brief: bool,
}

/// The stiffness and all that says how far to trust it.
#[derive(Serialize, JsonSchema)]
pub struct Identified {
    /// The estimates.
    #[serde(flatten)]
    pub identification: Identification,
    /// From raw readings to displacements; `null` for a table of displacements.
    pub readings: Option<Reduced>,
    /// What is suspicious about the scales of a table of displacements; for raw readings
    /// it stands in `readings`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sanity: Option<Screening>,
    /// Interval from the profile of the likelihood; `null` where there is none.
    pub profile: Option<Profile>,
    /// Interval from resampled postures; `null` unless asked for.
    pub bootstrap: Option<Bootstrap>,
    /// Errors common to the whole experiment; `null` with --brief.
    pub budget: Option<SystematicErrors>,
    /// The elastic model that predicts, where --elastic asks for one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elastic: Option<Elastic>,
    /// What the residuals say; `null` with --brief.
    pub diagnosis: Option<Diagnosis>,
    /// The next posture; `null` with --brief, or where none can be given.
    pub next_posture: Option<NextPosture>,
    /// Why there is no next posture; `null` where there is one.
    pub next_posture_missing: Option<String>,
    /// Names of the parts above that were left out because the user stopped the
    /// command: `bootstrap`, `elastic`, `profile`, `budget`, `diagnosis`, `next_posture`.
    pub not_computed: Vec<&'static str>,
    /// How often this estimator's intervals held the truth in simulation, where
    /// they are not exact; `null` for exact ones, and below the tabulated
    /// degrees of freedom, where no coverage is claimed.
    pub measured_coverage: Option<MeasuredCoverage>,
}

/// Identifies the joint stiffness.
pub fn run(session: &Session, args: &IdentifyArgs) -> Result<Exit> {
    if args.clamped {
        return clamped::run(session, args);
    }
    let target = only_target(session, args.output.as_deref(), args.force)?;
    let named = session.read_cell(&args.cell)?;
    let options = args.fit.options(&named.cell.setup.robot)?;
    let measurements =
        session.read_measurements(&args.measurements, args.postures.as_deref(), &named.cell)?;
    let reduce = session.read_registration(args.registration.as_deref())?;
    let mut measured = prepare(&named.cell, measurements, &reduce)?;
    check_names("--exclude", &args.exclude, &measured.postures)?;
    measured.retain(|name| !args.exclude.iter().any(|excluded| excluded == name));
    if measured.postures.is_empty() {
        return Err(Error::new(Code::TooFewData, "All postures are excluded.").key("--exclude"));
    }
    let serious = measured.worst() == Some(Severity::Serious);
    let progress = Progress::new(session, "examining the identification");
    let fit = Fit::watched(&named.cell, measured, &options, progress.shared())?;
    let result = progress.watch(|control| identified(&fit, args, control))?;
    drop(progress);

    let implausible = implausible_scale(fit.cell(), &result.identification).is_some();
    let exit = match result.not_computed.is_empty() {
        true => {
            Exit::finding(!result.identification.estimates.is_complete() || implausible || serious)
        }
        false => Exit::Interrupted,
    };
    let described = Options {
        estimator: options.estimator,
        weights: options.weights,
        noise: options.noise,
        confidence: options.confidence,
        extra: options.extra.clone(),
        elastic: args.fit.elastic.map(Into::into),
        prior_std: options.prior_std,
        exclude: args.exclude.clone(),
        bootstrap: args.bootstrap,
        brief: args.brief,
    };
    let envelope = session.envelope("identify", Some(args.seed), described, &result);
    let table = || {
        let out = summary::summary(&named, &fit, &result, &args.exclude, args.details);
        match args.details {
            true => out + &details(&fit, &result),
            false => out,
        }
    };
    session.deliver(target, &envelope, table)?;
    Ok(exit)
}

/// The estimates, and what else was asked for, as far as the user lets it come.
fn identified(fit: &Fit, args: &IdentifyArgs, control: Control<'_>) -> Result<Identified> {
    let identification = fit.identification()?.clone();
    let mut out = Identified {
        readings: Reduced::of(fit.measured()),
        sanity: sanity(fit.measured()),
        profile: None,
        bootstrap: None,
        budget: None,
        elastic: None,
        diagnosis: None,
        next_posture: None,
        next_posture_missing: None,
        not_computed: Vec::new(),
        measured_coverage: identification
            .estimates
            .interval_degrees_of_freedom
            .zip(Intervals::of(identification.estimates.estimator))
            .and_then(|(dof, kind)| measured_coverage(kind, dof)),
        identification,
    };
    let mut left_out = Vec::new();
    if let Some(resamples) = args.bootstrap {
        let resamples = usize::try_from(resamples).unwrap_or(usize::MAX);
        let found = bootstrap(fit, resamples, args.seed, fit.options().confidence);
        let found = found.map_err(|e| e.key("--bootstrap"));
        out.bootstrap = unless_stopped("bootstrap", &mut left_out, found)?;
    }
    let asked = args.fit.elastic();
    if asked != ElasticChoice::Axes {
        let found = elastic(fit, asked).map_err(|e| e.key("--elastic"));
        let found = unless_stopped("elastic", &mut left_out, found)?;
        out.elastic = found.map(|(elastic, _)| elastic);
    }
    if args.brief {
        out.not_computed = left_out;
        return Ok(out);
    }
    out.profile = unless_stopped("profile", &mut left_out, profile(fit))?.flatten();
    out.budget = unless_stopped("budget", &mut left_out, systematic_errors(fit))?;
    out.diagnosis = unless_stopped("diagnosis", &mut left_out, diagnose(fit))?;
    let mut search = GlobalOptions::default();
    search.seed = args.seed;
    search.rounds = Some(ADVICE_ROUNDS);
    let advice = match control.check() {
        Ok(()) => next_posture(fit, &search, control),
        Err(stopped) => Err(stopped),
    };
    match advice {
        Err(error) if error.code() != Code::Interrupted => {
            out.next_posture_missing = Some(error.message().to_string());
        }
        found => out.next_posture = unless_stopped("next_posture", &mut left_out, found)?,
    }
    out.not_computed = left_out;
    Ok(out)
}

/// Findings about a table of displacements, where there are any.
fn sanity(measured: &Measured) -> Option<Screening> {
    let screening = measured.screening.clone();
    screening.filter(|s| measured.reduction.is_none() && !s.findings.is_empty())
}

/// What was found; `None`, with its name in `left_out`, where the user stopped it.
fn unless_stopped<T>(
    name: &'static str,
    left_out: &mut Vec<&'static str>,
    found: Result<T>,
) -> Result<Option<T>> {
    match found {
        Err(error) if error.code() == Code::Interrupted => {
            left_out.push(name);
            Ok(None)
        }
        found => found.map(Some),
    }
}

/// Refuses names that no measured posture has.
///
/// # Errors
/// An unknown name.
pub fn check_names(option: &str, names: &[String], measured: &[MeasuredPosture]) -> Result<()> {
    let known = measured.iter().map(|m| m.posture.name.as_str());
    check_among(option, names, known.collect())
}

/// The same among the names `known`, in their order.
fn check_among(option: &str, names: &[String], mut known: Vec<&str>) -> Result<()> {
    let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) else {
        return Ok(());
    };
    known.dedup();
    Err(Error::new(
        Code::UnknownName,
        format!("The measurements have no posture \"{name}\"."),
    )
    .key(option)
    .hint(format!("measured postures: {}", known.join(", "))))
}

/// Everything beside the summary.
fn details(fit: &Fit, result: &Identified) -> String {
    let found = &result.identification;
    let mut out = String::new();
    let columns = columns();
    let sentence = |text: &str| format!("{}\n", wrapped(text, columns));
    if result.readings.is_some() || result.sanity.is_some() {
        out += &title("Readings");
        let lines = readings::summary(fit.measured());
        lines.lines().for_each(|line| out += &sentence(line));
    }
    out += &title("Intervals of the joint stiffness by the scatter of the readings");
    let shared = &found.estimates;
    let (budget, bootstrap) = (result.budget.as_ref(), result.bootstrap.as_ref());
    out += &tables::estimates(shared, budget, bootstrap).to_string();
    out += &tables::further(shared);
    out.push('\n');
    for text in messages::verdicts(result) {
        out += &sentence(&text);
    }
    if let Some(budget) = &result.budget {
        out += &title("Systematic errors: change of k [%]");
        out += &tables::common(budget).to_string();
    }
    if let Some(diagnosis) = &result.diagnosis {
        out += &title("What each joint carries");
        out += &tables::signals(&diagnosis.signals).to_string();
        if let Some(trials) = diagnosis.terms.as_ref().filter(|t| !t.trials.is_empty()) {
            out += &title("Further terms, each tried alone");
            out += &tables::trials(trials).to_string();
        }
    }
    if !found.weights.is_empty() {
        out += &tables::weights(found);
    }
    out += &title("Postures with the largest residuals");
    out += &tables::residuals(result).to_string();
    out + &next::next(fit.cell(), result)
}
