//! All that `identify` says of a measurement: estimates, and how far to trust them.

mod examination;

use crate::ask::fit::FitOptions;
use crate::ask::rules::{NotWith, changed_options, refuse};
#[cfg(feature = "clap")]
use crate::ask::values::{above_zero, count, seed};
use crate::error::{Code, Result};
use crate::estimate::compliance::{IdentifiedCompliance, open_springs};
use crate::estimate::coverage::{Intervals, MeasuredCoverage, measured as measured_coverage};
use crate::estimate::diagnose::Diagnosis;
use crate::estimate::diagnosed::is_misread;
use crate::estimate::elastic::{Elastic, ElasticChoice, elastic};
use crate::estimate::identify::{
    Bootstrap, Fit, Identification, IdentifyOptions, Profile, bootstrap, implausible_scale,
};
use crate::estimate::mixed::MixedFit;
use crate::estimate::next_posture::{NextPosture, next_posture};
use crate::estimate::saved::{Sealed, SeenLoad, flange_of, once};
use crate::estimate::setup::{self, FreedQuantity};
use crate::estimate::systematic::SystematicErrors;
use crate::findings::Finding;
use crate::measure::Measured;
use crate::measure::reduction::Reduction;
use crate::measure::screening::Screening;
use crate::model::robot::Robot;
use crate::numerics::control::Control;
use crate::plan::select::GlobalOptions;
use examination::{Examination, unless_stopped, widened};
use serde::{Deserialize, Serialize};

/// Rounds of the search for the next posture: one posture is soon found.
const ADVICE_ROUNDS: u64 = 2;

/// What is asked of an identification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Options"))]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
#[non_exhaustive]
pub struct IdentifiedOptions {
    /// Postures to leave out, for example those kept for validation
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME,…", value_delimiter = ','))]
    pub exclude: Vec<String>,
    /// The flange was fixed: the table has the controller's angles and the wrench of the fixture
    #[cfg_attr(feature = "clap", arg(long))]
    pub clamped: bool,
    /// Standard deviation of a difference of two angles, for --clamped [deg]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X", requires = "clamped",
        value_parser = above_zero("noise_deg")))]
    pub angle_noise_deg: Option<f64>,
    /// How the stiffness is estimated, and what it rests on.
    #[serde(flatten)]
    #[cfg_attr(feature = "clap", command(flatten))]
    pub fit: FitOptions,
    /// Quantities of the set-up that are identified beside the stiffness, on purpose: anchor,
    /// loading-point, gravity, force-beside, common-shift, … (docs/set-up.md)
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME,…", value_delimiter = ',', help_heading = "Estimator"))]
    pub free: Vec<String>,
    /// Also resample the postures this often for a bootstrap interval
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", value_parser = count::<usize>()))]
    pub bootstrap: Option<usize>,
    /// Seed of the resampling and of the search for the next posture
    #[cfg_attr(feature = "clap", arg(long, default_value_t = 1, value_parser = seed()))]
    pub seed: u64,
    /// Estimates and residuals only: no leave-one-out, systematic errors,
    /// extra terms tried or next posture
    #[cfg_attr(feature = "clap", arg(long))]
    pub brief: bool,
}

impl Default for IdentifiedOptions {
    fn default() -> Self {
        IdentifiedOptions {
            exclude: Vec::new(),
            clamped: false,
            angle_noise_deg: None,
            fit: FitOptions::default(),
            free: Vec::new(),
            bootstrap: None,
            seed: 1,
            brief: false,
        }
    }
}

impl IdentifiedOptions {
    /// The options of the fit for this robot.
    ///
    /// # Errors
    /// Options that exclude each other; as [`FitOptions::options`].
    pub fn options(&self, robot: &Robot) -> Result<IdentifyOptions> {
        refuse(NOT_WITH, &changed_options(self)?)?;
        Ok(IdentifyOptions { free: self.free.clone(), ..self.fit.options(robot)? })
    }
}

/// What is not asked beside what: how surely a freed quantity is known is among the systematic errors.
pub const NOT_WITH: NotWith = &[("free", &["brief", "bootstrap", "clamped"])];

/// What became of raw readings on their way to displacements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reduced {
    /// Registration, drift, motion of the base, repeats, wrenches.
    pub reduction: Reduction,
    /// What is suspicious about the readings themselves.
    pub screening: Screening,
}

impl Reduced {
    /// `None` where the measurements were displacements.
    pub fn of(measured: &Measured) -> Option<Self> {
        Some(Reduced { reduction: measured.reduction.clone()?, screening: measured.screening.clone()? })
    }
}

/// The stiffness and all that says how far to trust it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Identified {
    /// The estimates. `joints` are those of the elastic model that predicts (the axes' own stand in `elastic.axes`),
    /// everything else is of the joint axes alone; ±, intervals and verdicts hold all errors where `systematic_errors`
    /// are known, else the scatter of the readings alone.
    #[serde(flatten)]
    pub identification: Identification,
    /// From raw readings to displacements; `null` for a table of displacements.
    pub readings: Option<Reduced>,
    /// What was identified of the set-up beside the stiffness, on purpose.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub freed: Vec<FreedQuantity>,
    /// What is suspicious about the scales of a table of displacements; for raw readings
    /// it stands in `readings`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub screening: Option<Screening>,
    /// That the stiffness as a whole is of a size that no robot has; missing where it is not, or a wrong scale of the
    /// table explains it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub implausible: Option<Finding>,
    /// Interval from the profile of the likelihood; `null` where there is none.
    pub profile: Option<Profile>,
    /// Interval from resampled postures; `null` unless asked for.
    pub bootstrap: Option<Bootstrap>,
    /// Errors common to the whole experiment as they move `joints`; `null` with --brief.
    pub systematic_errors: Option<SystematicErrors>,
    /// What gives way beyond the joint axes; missing where these alone were asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elastic: Option<Elastic>,
    /// What the residuals say; `null` with --brief.
    pub diagnosis: Option<Diagnosis>,
    /// The next posture; `null` with --brief, or where none can be given.
    pub next_posture: Option<NextPosture>,
    /// Why there is no next posture; `null` where there is one.
    pub next_posture_missing: Option<String>,
    /// Names of the parts above that were left out because the user stopped the
    /// command: `bootstrap`, `elastic`, `profile`, `systematic_errors`, `diagnosis`, `next_posture`.
    pub not_computed: Vec<String>,
    /// How often this estimator's intervals held the truth in simulation, where
    /// they are not exact; `null` for exact ones, and below the tabulated
    /// degrees of freedom, where no coverage is claimed.
    pub measured_coverage: Option<MeasuredCoverage>,
    /// What later commands calculate with; `null` where the readings determine nothing.
    pub sealed: Option<Sealed>,
}

impl Identified {
    /// The elastic model, where it is the mixed one that predicts.
    pub fn mixed(&self) -> Option<&Elastic> {
        self.elastic.as_ref().filter(|e| e.mixed.is_some())
    }

    /// True where every joint has a stiffness: a closed interval if the axes alone gave way; in the mixed model a
    /// lower bound will do, with which it predicts.
    pub fn is_complete(&self) -> bool {
        let joints = &self.identification.estimates.joints;
        match self.mixed() {
            Some(_) => joints.iter().all(|j| j.interval[0].is_some()),
            None => self.identification.estimates.is_complete(),
        }
    }

    /// What the readings say against the set-up as the cell states it.
    pub fn rejected(&self) -> Option<&Finding> {
        self.diagnosis.as_ref().and_then(Diagnosis::rejected)
    }

    /// What is wrong with the table and the readings, scales first; some stand there twice.
    pub fn of_readings(&self) -> impl Iterator<Item = &Finding> {
        let screening = self.screening();
        let scales = screening.into_iter().flat_map(Screening::scales);
        let screened = screening.into_iter().flat_map(|screening| &screening.findings);
        let reduced = (self.readings.iter()).flat_map(|reduced| &reduced.reduction.findings);
        self.implausible.iter().chain(scales).chain(screened).chain(reduced)
    }

    /// What the fit says, but for its joints.
    pub fn of_fit(&self) -> impl Iterator<Item = &Finding> {
        let diagnosed = self.diagnosis.iter().flat_map(|diagnosis| &diagnosis.findings);
        let systematic = (self.systematic_errors.iter()).flat_map(|errors| &errors.findings);
        let profiled = self.profile.iter().map(|profile| &profile.finding);
        diagnosed.chain(systematic).chain(profiled)
    }

    /// Whether some finding says that the stiffness cannot be used as it is.
    pub fn is_serious(&self) -> bool {
        let of_joints = self.identification.estimates.findings();
        let all = self.of_readings().chain(self.of_fit()).chain(&of_joints);
        all.into_iter().any(Finding::is_serious)
    }

    /// What was found wrong with the table.
    pub fn screening(&self) -> Option<&Screening> {
        let readings = self.readings.as_ref().map(|readings| &readings.screening);
        readings.or(self.screening.as_ref())
    }

    /// The estimates, and what else was asked for, as far as the user lets it come.
    ///
    /// # Errors
    /// As [`Fit::identification`], [`bootstrap`] (key `bootstrap`), [`elastic`] (key `elastic`) and
    /// [`free`](setup::free) (key `free`).
    pub fn new(fit: &Fit, options: &IdentifiedOptions, control: Control<'_>) -> Result<Self> {
        let choice = ElasticChoice::or_default(options.fit.elastic, fit.options());
        let mut names = changed_options(options)?;
        names.extend((!fit.options().free.is_empty()).then(|| "free".to_string()));
        refuse(NOT_WITH, &names)?;
        let (freed_fit, freed) = setup::free(fit, choice)?.unzip();
        let (fit, freed) = (freed_fit.as_ref().unwrap_or(fit), freed.unwrap_or_default());
        let axes = fit.identification()?;
        let mut left_out = Vec::new();
        let (elastic, mixed) = match choice {
            ElasticChoice::Axes => (None, None),
            ElasticChoice::Mixed => {
                let model = elastic(fit, !options.brief).map_err(|e| e.key("elastic"));
                unless_stopped("elastic", &mut left_out, model)?.unzip()
            }
        };
        let mixed = mixed.flatten();
        // By the scatter of the readings alone.
        let joints = match &mixed {
            Some(mixed) => mixed.joints()?,
            None => axes.estimates.joints.clone(),
        };
        let implausible = match is_misread(fit) {
            true => None,
            false => implausible_scale(fit.cell(), &axes.with_joints(joints.clone())),
        };
        let bootstrap = match options.bootstrap {
            Some(resamples) => {
                let resampling = bootstrap(fit, resamples, options.seed, fit.options().confidence);
                let resampling = resampling.map_err(|e| e.key("bootstrap"));
                unless_stopped("bootstrap", &mut left_out, resampling)?
            }
            None => None,
        };
        let examined = match options.brief {
            true => Examination::default(),
            false => Examination::new(fit, mixed.as_ref(), freed.is_empty(), &mut left_out)?,
        };
        let of_axes = mixed.is_some().then(|| {
            let axis_joints = axes.estimates.joints.clone();
            widened(axis_joints, examined.of_axes.as_ref())
        });
        let joints = widened(joints, examined.systematic_errors.as_ref());
        let rejected = examined.diagnosis.as_ref().and_then(Diagnosis::rejected);
        let explained = |mut screening: Screening| {
            if rejected.is_some() {
                setup::leave_out_explained(&mut screening);
            }
            screening
        };
        let mut out = Identified {
            readings: Reduced::of(fit.measured())
                .map(|reduced| Reduced { screening: explained(reduced.screening), ..reduced }),
            screening: screening(fit.measured()).map(explained),
            identification: axes.with_joints(joints),
            elastic: elastic.map(|elastic| Elastic { axes: of_axes.unwrap_or_default(), ..elastic }),
            freed,
            implausible,
            bootstrap,
            profile: examined.profile,
            systematic_errors: examined.systematic_errors,
            diagnosis: examined.diagnosis,
            next_posture: None,
            next_posture_missing: None,
            not_computed: left_out,
            measured_coverage: (axes.estimates.interval_degrees_of_freedom)
                .zip(Intervals::of(axes.estimates.estimator))
                .and_then(|(dof, kind)| measured_coverage(kind, dof)),
            sealed: None,
        };
        out.sealed = out.seal(fit, mixed.as_ref());
        if !options.brief {
            out.advise(fit, mixed.is_some(), options.seed, control)?;
        }
        Ok(out)
    }

    /// Adds the next posture, or why there is none.
    fn advise(&mut self, fit: &Fit, scaled: bool, seed: u64, control: Control<'_>) -> Result<()> {
        let search = GlobalOptions { seed, rounds: Some(ADVICE_ROUNDS), ..GlobalOptions::default() };
        let advice = match control.check() {
            Ok(()) => next_posture(fit, &search, control),
            Err(stopped) => Err(stopped),
        };
        match advice {
            Err(error) if error.code() != Code::Interrupted => {
                self.next_posture_missing = Some(error.message().to_string());
            }
            advice => {
                self.next_posture = unless_stopped("next_posture", &mut self.not_computed, advice)?;
            }
        }
        if let Some(advice) = self.next_posture.as_mut().filter(|_| scaled) {
            advice.scale_to(&self.identification.estimates.joints);
        }
        Ok(())
    }

    /// What predicts, by the `mixed` model where there is one, with all that was found wrong.
    fn seal(&self, fit: &Fit, mixed: Option<&MixedFit>) -> Option<Sealed> {
        let cell = fit.cell();
        let predictor = match mixed {
            Some(mixed) => {
                let mut predictor = mixed.compliance().clone();
                predictor.doubts = open_springs(self.identification.estimates.joints.iter());
                predictor
            }
            None => IdentifiedCompliance::from_identification(cell, &self.identification).ok()?,
        };
        let mut predictor = match &self.systematic_errors {
            Some(systematic) => predictor.with_systematic_errors(systematic),
            None => predictor,
        };
        let missing = |part: &&str| self.not_computed.iter().any(|name| name == part);
        if ["elastic", "systematic_errors"].iter().any(missing) {
            let sentence = "The identification was stopped before it had the elastic model and the systematic errors: \
                            bands hold the scatter of the readings alone. Identify again and let it end.";
            let code = "stiffness-unfinished";
            predictor.doubts.push(Finding::caution(code, "stiffness", sentence));
        }
        let measured = fit.measured();
        // What a wrong scale of the table explains is no finding of its own.
        let diagnosed = self.diagnosis.iter().flat_map(|diagnosis| &diagnosis.findings);
        let diagnosed = diagnosed.filter(|_| !is_misread(fit));
        let findings = self.implausible.iter().chain(diagnosed);
        let displacements = measured.postures.iter().flat_map(|m| &m.displacements);
        let seen = fit.experiment().with_terms().map(|(m, terms)| {
            let setup = cell.setup.of_state(&m.state)?;
            let point = &setup.tool.loading_point;
            Ok(SeenLoad::new(&m.posture.q, point, terms.wrench()))
        });
        let seen: Result<Vec<SeenLoad>> = seen.collect();
        Some(Sealed {
            springs: cell.setup.robot.spring_names(),
            flange_m: Some(flange_of(cell).into()),
            predictor: predictor.with_doubts(measured.findings().chain(findings)),
            postures: once(self.identification.postures.iter().map(|p| &p.posture)),
            largest_displacement_m: displacements.map(|d| d.value.norm()).reduce(f64::max),
            largest_force_n: fit.experiment().largest_force(),
            loads: seen.ok()?,
        })
    }
}

/// Findings about a table of displacements, where there are any.
fn screening(measured: &Measured) -> Option<Screening> {
    let screening = measured.screening.clone();
    screening.filter(|s| measured.reduction.is_none() && !s.findings.is_empty())
}
