//! What `select --json` prints is what the library gives, to the last bit.

use crate::support::Folder;
use serde::Serialize;
use stiffarm::ask::select::{
    Plan, Planned, SelectInputs, SelectOptions, plan, plan_candidates, plan_curve, plan_drop, plan_space_filling,
};
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::Candidate;
use stiffarm::model::posture::Posture;
use stiffarm::{Control, Index};
use stiffarm_files::builtin;

fn cell() -> Cell {
    builtin::cell("comau").unwrap()
}

fn group() -> Vec<Posture> {
    builtin::postures("comau-group1", &cell().setup.robot).unwrap()
}

/// Compares the printed seed, options and result with those of the library, digit by digit.
fn same<R: Serialize>(line: &str, planned: &Planned<R>) {
    let printed = Folder::new().ok(&format!("select builtin:comau {line} --json"));
    let seed = planned.seed.map_or("null".to_string(), |seed| seed.to_string());
    let (options, result) = (json(&planned.options), json(&planned.result));
    let expected = format!("\"seed\":{seed},\"options\":{options},\"result\":{result},\"seal\":");
    assert!(without_space(&printed).contains(&without_space(&expected)), "{line}\n{printed}\n{expected}");
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap()
}

/// The command indents its JSON.
fn without_space(text: &str) -> String {
    text.split_whitespace().collect()
}

fn options(change: impl FnOnce(&mut SelectOptions)) -> SelectOptions {
    let mut options = SelectOptions::default();
    change(&mut options);
    options
}

fn planned(inputs: &SelectInputs, options: &SelectOptions) -> Planned<Plan> {
    plan(&cell(), inputs, options, &mut |_| {}, Control::default()).unwrap()
}

#[test]
fn a_plan() {
    let options = options(|o| {
        (o.count, o.rounds, o.seed) = (Some(3), Some(1), Some(7));
        o.sensitivity = true;
    });
    let planned = planned(&SelectInputs::default(), &options);
    same("-n 3 --rounds 1 --seed 7 --sensitivity", &planned);
}

#[test]
fn a_plan_from_an_initial_group() {
    let options = options(|o| (o.index, o.max_iterations) = (Some(Index::Novel), Some(5)));
    let mut inputs = SelectInputs::default();
    inputs.initial = Some(group());
    let line = "--initial builtin:comau-group1 --index novel --max-iterations 5";
    same(line, &planned(&inputs, &options));
}

#[test]
fn postures_beside_given_ones() {
    let options = options(|o| {
        (o.add, o.rounds) = (Some(2), Some(1));
        (o.angle_step_deg, o.no_certificate) = (0.0, true);
    });
    let mut inputs = SelectInputs::default();
    inputs.given = group();
    let line = "--given builtin:comau-group1 --add 2 --rounds 1 --angle-step-deg 0 --no-certificate";
    same(line, &planned(&inputs, &options));
}

#[test]
fn the_best_of_a_list() {
    let candidates = group().into_iter().map(|p| Candidate::new(p.name, p.q));
    let candidates: Vec<Candidate> = candidates.collect();
    let options = options(|o| (o.count, o.index) = (Some(4), Some(Index::D)));
    let planned = plan_candidates(&cell(), &candidates, true, &options, Control::default());
    let line = "--candidates builtin:comau-group1 -n 4 --index d";
    same(line, &planned.unwrap());
}

#[test]
fn evenly_spread_postures() {
    let options = options(|o| (o.count, o.seed) = (Some(5), Some(3)));
    let planned = plan_space_filling(&cell(), &options, Control::default()).unwrap();
    same("--space-filling -n 5 --seed 3", &planned);
}

#[test]
fn given_postures_with_some_left_out() {
    let options = options(|o| o.drop = Some(2));
    let planned = plan_drop(&cell(), &group(), &options, Control::default()).unwrap();
    same("--given builtin:comau-group1 --drop 2", &planned);
}

#[test]
fn a_curve() {
    let options = options(|o| (o.count, o.rounds) = (Some(3), Some(1)));
    let planned = plan_curve(&cell(), &options, &mut |_| {}, Control::default()).unwrap();
    same("--curve -n 3 --rounds 1", &planned);
}
