//! The groups of a study on arms that give way beyond their joint axes.

use super::{INITIAL_GROUP, STUDY_INDICES, StudyOptions};
use crate::error::Result;
use crate::estimate::simulate::{ElasticSimulation, ElasticSimulationOptions, simulate_elastic};
use crate::model::cell::Cell;
use crate::model::posture::PostureGroup;
use crate::numerics::control::Control;
use crate::numerics::optimise::Options;
use crate::plan::index::{Index, evaluate_for};
use crate::plan::select::{StartKind, random_group, select_from};

/// Most runs of each group: one takes as long as a thousand of the paper's simulation.
const MOST_RUNS: usize = 40;
/// Stream of the random group, which no other group of a study has.
const RANDOM_STREAM: u64 = u64::MAX - 1;

/// Group 1, the paper's index and the expected error among the `groups` of the study, with
/// a group under the index `prediction` from Group 1 and a random one beside them.
///
/// # Errors
/// As [`simulate_elastic`].
pub(super) fn beyond_axes(
    cell: &Cell,
    groups: &[PostureGroup],
    options: &StudyOptions,
    control: Control<'_>,
) -> Result<ElasticSimulation> {
    let of = |wanted: Index| STUDY_INDICES.iter().find(|(index, _)| *index == wanted);
    let wanted = [of(Index::Novel), of(Index::ExpectedError)];
    let names: Vec<&str> =
        std::iter::once(INITIAL_GROUP).chain(wanted.into_iter().flatten().map(|(_, name)| *name)).collect();
    let named = groups.iter().filter(|g| names.contains(&g.name.as_str()));
    let mut all: Vec<PostureGroup> = named.cloned().collect();
    if let Some(initial) = groups.iter().find(|g| g.name == INITIAL_GROUP) {
        let search = Options { max_iterations: options.max_iterations, ..Options::default() };
        let start = &initial.postures;
        // Without noise the index does not exist.
        match select_from(cell, Index::Prediction, start, search, control) {
            Ok(selection) => all.push(selection.to_group("prediction")),
            Err(error) if error.code().is_internal() => return Err(error),
            Err(_) => {}
        }
        let seed = options.simulation.seed;
        let angles = random_group(cell, StartKind::Uniform, start.len(), seed, RANDOM_STREAM)?;
        let random = PostureGroup::from_angles("random", angles);
        let evaluation = evaluate_for(cell, &random.name, &random.postures, None)?;
        if evaluation.undetermined_joints.is_empty() {
            all.push(random);
        }
    }
    let elastic_options = ElasticSimulationOptions {
        runs: options.simulation.runs.min(MOST_RUNS),
        seed: options.simulation.seed,
        elastic: options.elastic,
        ..ElasticSimulationOptions::default()
    };
    simulate_elastic(cell, &all, &elastic_options, control)
}
