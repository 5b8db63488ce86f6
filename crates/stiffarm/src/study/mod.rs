//! The paper's study (Section IV) on any cell: groups of postures under
//! several indices, simulation, identification, validation, and how far the
//! outcome depends on the initial group.

mod elastic;
mod measured;
mod starts;
mod verdict;

pub use measured::{Choice, MeasuredChoice, MeasuredStudy, MeasuredStudyOptions, measured_study};
pub use starts::{IndexOverStarts, Q1Range, StartsOfKind, StartsStudy};

use crate::error::Result;
use crate::estimate::elastic::ElasticChoice;
use crate::estimate::identify::{Estimator, Identification, IdentifyOptions, identify};
use crate::estimate::simulate::{ElasticSimulation, Simulation, SimulationOptions, simulate};
use crate::estimate::validate::{Model, Validation, simulate_measurements, validate};
use crate::findings::{Finding, each_once};
use crate::model::cell::Cell;
use crate::model::observation::{PostureTerms, Rows, observation_matrix};
use crate::model::posture::PostureGroup;
use crate::model::stiffness::second_order;
use crate::numerics::control::Control;
use crate::numerics::jobs::in_order;
use crate::numerics::optimise::Options;
use crate::plan::characteristic_length::with_characteristic_length;
use crate::plan::check::determinable;
use crate::plan::index::{ErrorBound, GroupEvaluation, Index, error_bound, evaluate};
use crate::plan::select::{Selection, select_from};
use nalgebra::DVector;
use serde::{Deserialize, Serialize};

/// The indices of the study with the names of their groups; Group 1 is the start.
pub const STUDY_INDICES: [(Index, &str); 4] = [
    (Index::Classical, "Group 2 (classical)"),
    (Index::Novel, "Group 3 (novel)"),
    (Index::Scaled, "scaled"),
    (Index::ExpectedError, "expected error"),
];

/// The indices of the study that `cell` has: without a characteristic length
/// (fewer than six joints) there is no k(J_N), and only the expected error is left.
pub fn study_indices(cell: &Cell) -> Vec<(Index, &'static str)> {
    let dexterity = cell.characteristic_length.is_some();
    STUDY_INDICES.into_iter().filter(|(index, _)| dexterity || !index.uses_dexterity()).collect()
}

/// Name of the initial group.
pub const INITIAL_GROUP: &str = "Group 1";

/// Runs of the simulation that are soon made.
const SOON_MADE: usize = 2000;

/// Options of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct StudyOptions {
    /// Noise levels and runs of the simulation.
    pub simulation: SimulationOptions,
    /// Other initial groups, half of each kind.
    pub starts: usize,
    /// Draws of q1 for the range of the classical group.
    pub q1_draws: usize,
    /// Iterations of each selection.
    pub max_iterations: u64,
    /// The model beside the joint axes, on arms that give way beyond them too; with `axes`
    /// there are no such arms in the study.
    pub elastic: ElasticChoice,
}

impl Default for StudyOptions {
    fn default() -> Self {
        StudyOptions {
            simulation: SimulationOptions::default(),
            starts: 60,
            q1_draws: 500,
            max_iterations: 1000,
            elastic: ElasticChoice::Axes,
        }
    }
}

/// One group of postures with everything the study found about it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StudyGroup {
    /// Name of the group.
    pub name: String,
    /// How it was selected; `None` for the initial group.
    pub selection: Option<Selection>,
    /// Its indices and expected errors.
    pub evaluation: GroupEvaluation,
    /// Its postures, controller angles \[rad\].
    #[serde(rename = "postures_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub postures: Vec<Vec<f64>>,
    /// Points of the arm per posture, base to TCP, base frame \[m\].
    pub arms_m: Vec<Vec<[f64; 3]>>,
    /// Eq. (19) for tracker noise alone (without a posture-common part), δΩ = 0
    /// and ‖δΛ‖ at its RMS value.
    pub error_bound: Option<ErrorBound>,
    /// Expected RMS of ‖δH‖/‖H‖, which the bound of Eq. (19) bounds.
    pub expected_relative_norm: Option<f64>,
    /// Largest change of a measuring point's displacement by K_C alone \[m\].
    pub correction_share_m: f64,
    /// Largest difference of the linear model to the exact equilibrium \[m\].
    pub linearisation_m: f64,
    /// Identification from one simulated measurement; `None` where the group
    /// cannot determine all joints.
    pub identification: Option<Identification>,
    /// Eq. (22) at the cell's validation postures.
    pub validation: Option<Validation>,
}

/// Result of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Study {
    /// Name of the cell.
    pub cell: String,
    /// Name of the robot.
    pub robot: String,
    /// Names of the joints.
    pub joints: Vec<String>,
    /// True joint stiffness of the simulation, the cell's prior \[N·m/rad\].
    pub stiffness: Vec<f64>,
    /// Characteristic length of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
    /// σ of a displacement component at variance factor 1 \[m\].
    pub noise_std_m: f64,
    /// Options.
    pub options: StudyOptions,
    /// Group 1 and the selected groups.
    pub groups: Vec<StudyGroup>,
    /// Simulation of Section IV.A over all groups that determine every joint.
    pub simulation: Simulation,
    /// The groups on arms that give way beyond their joint axes, where that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elastic: Option<ElasticSimulation>,
    /// What other initial groups lead to.
    pub starts: StartsStudy,
    /// The classical group as a range over q1, which its index ignores.
    pub classical_q1: Option<Q1Range>,
    /// Index with the smallest mean expected deviation from the initial group.
    pub recommended: Option<Index>,
    /// True when the user stopped the study: selections may not have converged
    /// and fewer initial groups were tried.
    pub interrupted: bool,
    /// The verdict in sentences.
    pub findings: Vec<Finding>,
    /// Outline of the cell's tool box, corners \[m\], where it has one.
    pub tool_box_m: Option<[[f64; 3]; 2]>,
    /// Anchors of ropes and cylinders in the base frame \[m\].
    #[serde(default)]
    pub anchors_m: Vec<[f64; 3]>,
}

impl Study {
    /// Every finding of the result, each once.
    pub fn every_finding(&self) -> Vec<Finding> {
        let elastic = self.elastic.iter().flat_map(|simulation| &simulation.findings);
        let validated = self.groups.iter().filter_map(|group| group.validation.as_ref());
        let validated = validated.flat_map(|validation| &validation.findings);
        let all = elastic.chain(&self.findings).chain(validated);
        each_once(all.chain(&self.simulation.findings))
    }
}

/// Runs the study from `initial` (Group 1).
///
/// ```no_run
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::model::posture::PostureGroup;
/// use stiffarm::study::{StudyOptions, study};
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
///
/// let cell = builtin::cell("comau")?;
/// let postures = builtin::postures("comau-group1", &cell.setup.robot)?;
/// let initial = PostureGroup {
///     name: "Group 1".to_string(),
///     postures,
/// };
/// let result = study(&cell, &initial, &StudyOptions::default(), Control::default())?;
/// println!("{:?}", result.recommended);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// A cell without prior stiffness, a group or load that cannot be used, or an
/// interruption.
pub fn study(cell: &Cell, initial: &PostureGroup, options: &StudyOptions, control: Control<'_>) -> Result<Study> {
    let (cell, mut findings) = determinable(with_characteristic_length(cell.clone())?);
    let cell = &cell;
    let prior = cell.require_prior()?.to_vec();
    let select_options = Options { max_iterations: options.max_iterations, ..Options::default() };

    // Section III.B: Groups 2 and 3 start from Group 1; so do the further indices.
    let indices = study_indices(cell);
    if cell.setup.robot.limits_are_unknown() {
        findings.push(Finding::caution(
            "unknown-limits",
            "robot.limits_deg",
            "The machine's limits are not known and ±360° stand in: compare the postures with the machine before \
             driving them.",
        ));
    }
    let selections: Vec<Result<Selection>> = in_order(&indices, |(_, (index, _))| {
        Ok(select_from(cell, *index, &initial.postures, select_options, control))
    })?;
    control.report("selecting from Group 1", 1, 1);
    let mut named = vec![(None, PostureGroup { name: INITIAL_GROUP.to_string(), ..initial.clone() })];
    for ((index, name), selection) in indices.iter().zip(selections) {
        match selection {
            Ok(selection) => {
                let group = selection.to_group(name);
                named.push((Some(selection), group));
            }
            // One index without a result leaves the others to be compared.
            Err(error) if !error.code().is_internal() => findings.push(Finding::serious(
                "no-selection",
                index.as_str(),
                format!("Under the {} index no group was found: {}", index.as_str().replace('_', "-"), error.message()),
            )),
            Err(error) => return Err(error),
        }
    }
    let mut groups = Vec::with_capacity(named.len());
    for (g, (selection, group)) in named.iter().enumerate() {
        groups.push(study_group(cell, selection.clone(), group, &prior, options.simulation.seed, g)?);
    }
    let simulated: Vec<PostureGroup> = named
        .iter()
        .zip(&groups)
        .filter(|(_, g)| g.evaluation.undetermined_joints.is_empty())
        .map(|((_, group), _)| group.clone())
        .collect();
    // So many runs are a matter of milliseconds: an interruption waits for them.
    let patient = if options.simulation.runs <= SOON_MADE { Control { stop: None, ..control } } else { control };
    let simulation = simulate(cell, &simulated, &options.simulation, patient)?;
    let beyond_axes = match options.elastic {
        ElasticChoice::Axes => None,
        _ => Some(elastic::beyond_axes(cell, &simulated, options, control)?),
    };
    let classical_q1 = match named.iter().find(|(s, _)| s.as_ref().is_some_and(|s| s.index == Index::Classical)) {
        Some((_, group)) => starts::q1_range(cell, group, options.q1_draws, options.simulation.seed, control)?,
        None => None,
    };
    let starts = starts::other_starts(
        cell,
        initial.postures.len(),
        options.starts,
        options.simulation.seed,
        select_options,
        control,
    )?;
    let mut study = Study {
        cell: cell.name.clone(),
        robot: cell.setup.robot.name().to_string(),
        joints: cell.setup.robot.spring_names(),
        stiffness: prior,
        characteristic_length_m: cell.characteristic_length,
        noise_std_m: cell.noise.displacement_std(),
        options: options.clone(),
        groups,
        simulation,
        elastic: beyond_axes,
        starts,
        classical_q1,
        recommended: None,
        interrupted: control.stopped(),
        findings,
        tool_box_m: cell.limits.tool_box.map(|b| b.map(Into::into)),
        anchors_m: cell.setup.load.anchors().map(|a| (*a).into()).collect(),
    };
    verdict::conclude(&mut study);
    Ok(study)
}

fn study_group(
    cell: &Cell,
    selection: Option<Selection>,
    group: &PostureGroup,
    truth: &[f64],
    seed: u64,
    stream: usize,
) -> Result<StudyGroup> {
    let evaluation = match &selection {
        Some(selection) => GroupEvaluation { name: group.name.clone(), ..selection.evaluation.clone() },
        None => evaluate(cell, &group.name, &group.postures)?,
    };
    let determined = evaluation.undetermined_joints.is_empty();
    let (bound, expected_norm) = match evaluation.indices.condition {
        Some(condition) => {
            let (bound, norm) = bound_beside_expectation(cell, group, truth, condition)?;
            (Some(bound), Some(norm))
        }
        None => (None, None),
    };
    // Section IV.B in simulation: one measurement of the group identifies, the
    // validation postures judge. The truth is the paper's linear model.
    let mut identification = None;
    let mut validation = None;
    if determined {
        let measured = simulate_measurements(cell, &group.postures, truth, Model::Linear, seed, 2 * stream)?;
        let options = IdentifyOptions {
            // The simulated noise is what the cell says, as in the paper.
            estimator: Estimator::Weighted,
            ..IdentifyOptions::default()
        };
        let result = identify(cell, &measured, &options)?;
        if let (Some(stiffness), false) = (result.estimates.stiffness(), cell.validation.is_empty()) {
            // One set of validation readings judges every group.
            let held_out = simulate_measurements(cell, &cell.validation, truth, Model::Linear, seed, 1)?;
            validation = Some(validate(cell, &stiffness, &held_out, Model::Linear, None)?);
        }
        identification = Some(result);
    }
    let (mut correction_share_m, mut linearisation_m) = (0.0_f64, 0.0_f64);
    let mut arms_m = Vec::new();
    let setups = cell.setup.cases();
    for posture in &group.postures {
        for setup in &setups {
            let share = second_order(setup, &posture.q, truth, None)?;
            let largest = |of: Vec<f64>, so_far: f64| of.into_iter().fold(so_far, f64::max);
            correction_share_m = largest(share.correction, correction_share_m);
            linearisation_m = largest(share.linearisation, linearisation_m);
        }
        let terms = PostureTerms::new(&setups[0], &posture.q, None)?;
        let mut arm = vec![[0.0; 3]];
        arm.extend(terms.frames().origins().iter().map(|o| [o.x, o.y, o.z]));
        arm.push(terms.frames().flange().translation.vector.into());
        arm.push(terms.measuring_points()[0].into());
        arms_m.push(arm);
    }
    Ok(StudyGroup {
        name: group.name.clone(),
        selection,
        evaluation,
        postures: group.postures.iter().map(|p| p.q.clone()).collect(),
        arms_m,
        error_bound: bound,
        expected_relative_norm: expected_norm,
        correction_share_m,
        linearisation_m,
        identification,
        validation,
    })
}

/// Eq. (19) with ‖δΛ‖ at its RMS value σ‖Ψ‖_F and δΩ = 0, beside the expected
/// RMS of ‖δH‖/‖H‖, σ·sqrt(tr (ΨᵀΨ)⁻¹)/‖H‖.
fn bound_beside_expectation(
    cell: &Cell,
    group: &PostureGroup,
    truth: &[f64],
    condition: f64,
) -> Result<(ErrorBound, f64)> {
    let psi = observation_matrix(&cell.setup, &group.postures, Rows::Translations)?;
    let h = DVector::from_iterator(truth.len(), truth.iter().map(|k| 1.0 / k));
    let sigma = cell.noise.displacement_std();
    let lambda = psi.tr_mul(&(&psi * &h)).norm();
    let bound = error_bound(condition, 0.0, sigma * psi.norm() / lambda)?;
    let trace = crate::numerics::information::Factor::new(&psi)?.inverse_information().trace();
    Ok((bound, sigma * trace.sqrt() / h.norm()))
}
