//! What an experiment measured, ready to be identified from.

use crate::error::{Code, Error, Result};
use crate::findings::{Finding, Severity, codes, each_once};
use crate::measure::pending::{not_measured_yet, nothing_measured};
use crate::measure::reduction::stations;
use crate::measure::reduction::{ReduceOptions, Reduction, reduce_series};
use crate::measure::resolution::Resolution;
use crate::measure::screening::{Cause, Evidence, Screening, Suspicion, screen_displacements, screen_series};
use crate::measure::series::PostureSeries;
use crate::model::cell::{Cell, Noise};
use crate::model::measurement::{MeasuredPosture, Measurements, ReadingScatter, ReadingTable, Role};
use crate::model::observation::ExtraTerm;

/// Readings behind a displacement that was reduced from raw readings: a loaded
/// and a reference one.
const READINGS: u32 = 2;

/// Displacements of an experiment, with what is known about the readings behind them.
///
/// Anything that holds displacements alone becomes one with `into()`; then the
/// cell says how many readings stand behind each.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Measured {
    /// The displacements, posture by posture and state by state.
    pub postures: Vec<MeasuredPosture>,
    /// Those against the other reference where postures have a preload: here against no load, the way to the preload
    /// among them, which shows what it took up; where `postures` are these, against the preload. Nothing without one.
    pub against_unloaded: Vec<MeasuredPosture>,
    /// Readings behind one displacement, where the reduction knows it: 2 for a
    /// loaded and a reference reading. `None` leaves it to the cell's noise.
    pub readings_per_displacement: Option<u32>,
    /// Scatter of repeated readings, where some were repeated.
    pub scatter: Option<ReadingScatter>,
    /// Variance of each coordinate of a reading by the step to which the readings were rounded
    /// \[m²\]; zero where none matters.
    pub resolution_variance: f64,
    /// How raw readings became displacements.
    pub reduction: Option<Reduction>,
    /// What is suspicious about raw readings themselves, or about the scales of displacements.
    pub screening: Option<Screening>,
}

impl Measured {
    /// The noise of `cell` with as many readings per displacement as were taken, and that of
    /// the step in which they were written down.
    pub fn noise(&self, cell: &Cell) -> Noise {
        let assumed = cell.noise.readings_per_displacement;
        Noise {
            readings_per_displacement: self.readings_per_displacement.unwrap_or(assumed),
            reading_variance: cell.noise.reading_variance + self.resolution_variance,
            ..cell.noise
        }
    }

    /// Keeps the postures for whose name `keep` holds.
    pub fn retain(&mut self, keep: impl Fn(&str) -> bool) {
        for postures in [&mut self.postures, &mut self.against_unloaded] {
            postures.retain(|m| keep(&m.posture.name));
        }
    }

    /// The displacements from which an experiment with these extra terms is identified, where they are not at hand:
    /// with lost motion among the unknowns those against no load, otherwise those against the preload.
    pub(crate) fn showing(&self, extra: &[ExtraTerm]) -> Option<Measured> {
        let is_wanted = extra.iter().any(|term| !term.is_spring());
        let is_way = |m: &MeasuredPosture| Role::of(&m.state) == Role::Preload;
        let has = |postures: &[MeasuredPosture]| postures.iter().any(is_way);
        let differs = is_wanted != has(&self.postures) && is_wanted == has(&self.against_unloaded);
        (differs && !self.against_unloaded.is_empty()).then(|| Measured {
            postures: self.against_unloaded.clone(),
            against_unloaded: self.postures.clone(),
            ..self.clone()
        })
    }

    /// True where every displacement is against a preload.
    pub fn is_against_preload(&self) -> bool {
        let mut postures = self.postures.iter().filter(|m| !m.displacements.is_empty());
        self.postures.iter().any(|m| m.preload.is_some()) && postures.all(|m| m.preload.is_some())
    }

    /// Keeps the postures with these names.
    ///
    /// # Errors
    /// A name that no posture has.
    pub fn keep_only(&mut self, names: &[String]) -> Result<()> {
        self.check_names(names)?;
        self.retain(|name| names.iter().any(|wanted| wanted == name));
        Ok(())
    }

    /// Leaves out the postures with these names.
    ///
    /// # Errors
    /// A name that no posture has; nothing is left.
    pub fn exclude(&mut self, names: &[String]) -> Result<()> {
        self.check_names(names)?;
        self.retain(|name| !names.iter().any(|excluded| excluded == name));
        if self.postures.is_empty() { Err(all_excluded()) } else { Ok(()) }
    }

    fn check_names(&self, names: &[String]) -> Result<()> {
        let posture_names = self.postures.iter().map(|m| m.posture.name.as_str());
        check_names(names, posture_names)
    }

    /// All that was noticed about raw readings, those about the readings
    /// themselves first.
    pub fn findings(&self) -> impl Iterator<Item = &Finding> {
        let screening = self.screening.iter().flat_map(|s| &s.findings);
        screening.chain(self.reduction.iter().flat_map(|r| &r.findings))
    }

    /// The most serious of the findings.
    pub fn worst(&self) -> Option<Severity> {
        self.findings().map(|f| f.severity).max()
    }
}

/// Refuses names that are not among those of measured postures, `posture_names`.
pub(crate) fn check_names<'a>(names: &[String], posture_names: impl Iterator<Item = &'a str>) -> Result<()> {
    let posture_names: Vec<&str> = posture_names.collect();
    let Some(name) = names.iter().find(|name| !posture_names.contains(&name.as_str())) else {
        return Ok(());
    };
    // The states of a posture need not stand together.
    let posture_names = each_once(&posture_names);
    Err(Error::new(Code::UnknownName, format!("The measurements have no posture \"{name}\"."))
        .hint(format!("measured postures: {}", posture_names.join(", "))))
}

/// No posture is left.
pub(crate) fn all_excluded() -> Error {
    Error::new(Code::TooFewData, "All postures are excluded.")
}

impl From<Vec<MeasuredPosture>> for Measured {
    fn from(postures: Vec<MeasuredPosture>) -> Self {
        Measured { postures, ..Measured::default() }
    }
}

impl From<&[MeasuredPosture]> for Measured {
    fn from(postures: &[MeasuredPosture]) -> Self {
        postures.to_vec().into()
    }
}

impl<const N: usize> From<&[MeasuredPosture; N]> for Measured {
    fn from(postures: &[MeasuredPosture; N]) -> Self {
        postures.to_vec().into()
    }
}

impl From<&Vec<MeasuredPosture>> for Measured {
    fn from(postures: &Vec<MeasuredPosture>) -> Self {
        postures.clone().into()
    }
}

impl From<&Measured> for Measured {
    fn from(measured: &Measured) -> Self {
        measured.clone()
    }
}

/// Makes measurements ready to be identified from: displacements as they are,
/// raw readings screened and reduced. Rows that are not filled in yet are said in a note
/// ([`not_measured_yet`]).
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::{prepare, simulated_readings};
/// use stiffarm_files::builtin;
///
/// let cell = builtin::cell("comau")?;
/// let postures = builtin::postures("comau-group1", &cell.setup.robot)?;
/// let readings = simulated_readings(&cell, &postures, 1)?;
/// let measured = prepare(&cell, readings, &Default::default())?;
/// assert_eq!(measured.readings_per_displacement, Some(2));
/// assert!(measured.findings().all(|finding| !finding.sentence.is_empty()));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// As [`reduce`](crate::measure::reduction::reduce); where the readings themselves explain the failure, that is said.
pub fn prepare(cell: &Cell, measurements: impl Into<Measurements>, options: &ReduceOptions) -> Result<Measured> {
    let table = match measurements.into() {
        Measurements::Displacements(postures) => {
            // What cannot be screened is refused where it is used.
            let screening = screen_displacements(cell, &postures).ok();
            return Ok(Measured { postures, screening, ..Measured::default() });
        }
        Measurements::Readings(table) => table,
    };
    if let Some(error) = nothing_measured(&table) {
        return Err(error);
    }
    let mut table = table.in_order_of_time();
    let resolution = Resolution::of(cell, &table);
    let cell = resolution.as_ref().map_or(cell, |rounded| &rounded.cell);
    let stated_transform = options.base_from_tracker.as_ref();
    let doubtful = stations::in_one_frame(cell, &mut table, stated_transform)?;
    let series = PostureSeries::all(&table);
    let screening = match doubtful {
        // Frames say nothing where the model fits from no station: one by itself tells why.
        Some(station) => screened_alone(cell, &table, &series, &station)?,
        None => None,
    };
    let screening = match screening {
        Some(screening) => screening,
        None => screen_series(cell, &table, &series, stated_transform)?,
    };
    let mut reduction = reduce_series(cell, &table, &series, options).map_err(|error| {
        let mut findings = screening.findings.iter();
        match findings.find(|f| f.severity == Severity::Serious) {
            Some(cause) => Error::new(error.code(), cause.sentence.clone()).hint(error.message()),
            None => error,
        }
    })?;
    // Rounded coarsely, readings repeat each other without being copied.
    let is_coarse = resolution.as_ref().is_some_and(|rounded| rounded.is_coarse);
    let follows_rounding = |finding: &Finding| is_coarse && finding.code == codes::IDENTICAL_READINGS;
    reduction.findings.retain(|finding| !follows(&screening, finding) && !follows_rounding(finding));
    reduction.findings.extend(not_measured_yet(&table));
    let rounded = resolution.as_ref().map(|rounded| rounded.finding.clone());
    reduction.findings.extend(rounded);
    reduction.findings.extend(table.remarks);
    Ok(Measured {
        postures: std::mem::take(&mut reduction.measured),
        against_unloaded: std::mem::take(&mut reduction.against_unloaded),
        readings_per_displacement: Some(READINGS),
        resolution_variance: resolution.as_ref().map_or(0.0, |rounded| rounded.variance),
        scatter: reduction.repeatability.as_ref().map(|repeats| ReadingScatter {
            reading_std_m: repeats.std_m,
            degrees_of_freedom: repeats.degrees_of_freedom,
        }),
        reduction: Some(reduction),
        screening: Some(screening),
    })
}

/// True where a finding of the reduction only repeats what a scale explains.
fn follows(screening: &Screening, finding: &Finding) -> bool {
    let any = |of: &dyn Fn(&Suspicion) -> bool| screening.suspicions.iter().any(of);
    match finding.code.as_str() {
        codes::FORCE_MAGNITUDE => any(&|s| matches!(s.cause, Cause::LoadUnits | Cause::LoadEntry)),
        codes::REGISTRATION_OUTLIER | codes::REGISTRATION_RESIDUAL | codes::GIVEN_REGISTRATION => {
            any(&|s| s.cause == Cause::MovedTracker)
        }
        codes::LOADING_POINT | codes::UNEXPLAINED_MOMENT => any(&|s| {
            s.cause == Cause::MomentUnits
                || s.cause == Cause::LoadEntry
                || (s.cause == Cause::LoadUnits && s.evidence == Some(Evidence::Readings))
        }),
        _ => false,
    }
}

/// What is wrong with the robot's description by the readings of one station; `None` where they say nothing serious.
///
/// # Errors
/// As [`screen`](crate::measure::screening::screen).
fn screened_alone(
    cell: &Cell,
    table: &ReadingTable,
    series: &[PostureSeries<'_>],
    station: &str,
) -> Result<Option<Screening>> {
    let station_series = series.iter();
    let station_series = station_series.filter(|s| s.readings.station.as_deref() == Some(station));
    let station_series: Vec<PostureSeries<'_>> = station_series.cloned().collect();
    let screening = screen_series(cell, table, &station_series, None)?;
    let is_common = screening.suspicions.iter().zip(&screening.findings);
    let mut is_common = is_common.filter(|(s, f)| s.postures.is_empty() && f.severity == Severity::Serious);
    Ok(is_common.next().is_some().then_some(screening))
}
