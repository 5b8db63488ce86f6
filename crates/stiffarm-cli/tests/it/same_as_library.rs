//! What `select --json` prints is what the library gives, to the last bit.

use crate::support::Folder;
use serde::Serialize;
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::Candidate;
use stiffarm::model::posture::Posture;
use stiffarm::plan::planned::{
    CandidateRequest, CurveRequest, DropRequest, PlanRequest, Planned, SpaceFillingRequest, plan,
    plan_candidates, plan_curve, plan_drop, plan_space_filling,
};
use stiffarm::{Control, Index};
use stiffarm_files::builtin;

fn cell() -> Cell {
    builtin::cell("comau").unwrap()
}

fn group() -> Vec<Posture> {
    builtin::postures("comau-group1", &cell().setup.robot).unwrap()
}

/// Compares the printed seed, options and result with those of the library, digit by digit.
fn same<R: Serialize, O: Serialize>(line: &str, planned: &Planned<R, O>) {
    let printed = Folder::new().ok(&format!("select builtin:comau {line} --json"));
    let seed = planned
        .seed
        .map_or("null".to_string(), |seed| seed.to_string());
    let (options, result) = (json(&planned.options), json(&planned.result));
    let expected = format!("\"seed\":{seed},\"options\":{options},\"result\":{result},\"seal\":");
    assert!(
        without_space(&printed).contains(&without_space(&expected)),
        "{line}\n{printed}\n{expected}"
    );
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap()
}

/// The command indents its JSON.
fn without_space(text: &str) -> String {
    text.split_whitespace().collect()
}

#[test]
fn a_plan() {
    let mut request = PlanRequest::default();
    request.postures = 3;
    request.rounds = Some(1);
    request.seed = 7;
    request.sensitivity = true;
    let planned = plan(&cell(), &request, &mut |_| {}, Control::default()).unwrap();
    let planned = planned.with_forecast();
    same("-n 3 --rounds 1 --seed 7 --sensitivity", &planned);
}

#[test]
fn a_plan_from_an_initial_group() {
    let mut request = PlanRequest::default();
    request.index = Index::Novel;
    request.initial = Some(group());
    request.max_iterations = 5;
    let planned = plan(&cell(), &request, &mut |_| {}, Control::default()).unwrap();
    let planned = planned.with_forecast();
    let line = "--initial builtin:comau-group1 --index novel --max-iterations 5";
    same(line, &planned);
}

#[test]
fn postures_beside_given_ones() {
    let mut request = PlanRequest::default();
    request.given = group();
    request.postures = 2;
    request.rounds = Some(1);
    request.angle_step_deg = None;
    request.certificate = false;
    let planned = plan(&cell(), &request, &mut |_| {}, Control::default()).unwrap();
    let planned = planned.with_forecast();
    let line =
        "--given builtin:comau-group1 --add 2 --rounds 1 --angle-step-deg 0 --no-certificate";
    same(line, &planned);
}

#[test]
fn the_best_of_a_list() {
    let candidates = group().into_iter().map(|p| Candidate::new(p.name, p.q));
    let candidates: Vec<Candidate> = candidates.collect();
    let mut request = CandidateRequest::default();
    request.postures = 4;
    request.index = Index::D;
    let planned = plan_candidates(&cell(), &candidates, &request, Control::default()).unwrap();
    let planned = planned.with_forecast();
    let line = "--candidates builtin:comau-group1 -n 4 --index d";
    same(line, &planned);
}

#[test]
fn evenly_spread_postures() {
    let mut request = SpaceFillingRequest::default();
    request.postures = 5;
    request.seed = 3;
    let planned = plan_space_filling(&cell(), &request, Control::default()).unwrap();
    same("--space-filling -n 5 --seed 3", &planned);
}

#[test]
fn given_postures_with_some_left_out() {
    let mut request = DropRequest::default();
    request.drop = 2;
    let planned = plan_drop(&cell(), &group(), &request, Control::default()).unwrap();
    same("--given builtin:comau-group1 --drop 2", &planned);
}

#[test]
fn a_curve() {
    let mut request = CurveRequest::default();
    request.postures = 3;
    request.rounds = Some(1);
    let planned = plan_curve(&cell(), &request, &mut |_| {}, Control::default()).unwrap();
    same("--curve -n 3 --rounds 1", &planned);
}
