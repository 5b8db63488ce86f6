//! The study as a whole: what it holds, that it repeats, and what it says in
//! set-ups where parts of it do not exist.

use crate::common::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use stiffarm::study::{Study, StudyOptions, study};

fn cell() -> Cell {
    builtin::cell("comau").unwrap()
}

fn group_1(cell: &Cell) -> PostureGroup {
    PostureGroup {
        name: "Group 1".to_string(),
        postures: builtin::postures("comau-group1", &cell.setup.robot).unwrap(),
    }
}

fn options(starts: usize, max_iterations: u64) -> StudyOptions {
    changed(StudyOptions::default(), |o| {
        o.simulation = with(|o: &mut SimulationOptions| o.runs = 50);
        o.starts = starts;
        o.q1_draws = 40;
        o.max_iterations = max_iterations;
    })
}

fn run(cell: &Cell, options: &StudyOptions) -> Study {
    study(cell, &group_1(cell), options, Control::default()).unwrap()
}

fn has(study: &Study, code: &str) -> bool {
    study.findings.iter().any(|f| f.code == code)
}

#[test]
fn the_default_cell_has_every_part_of_the_paper() {
    let cell = cell();
    let result = run(&cell, &options(4, 1000));
    let names: Vec<&str> = result.groups.iter().map(|g| g.name.as_str()).collect();
    assert_eq!(names, ["Group 1", "Group 2 (classical)", "Group 3 (novel)", "scaled", "expected error"]);
    assert_eq!(result.recommended, Some(Index::ExpectedError));
    for group in &result.groups {
        // Table 7: twelve measuring points; Table 6: six joints.
        assert_eq!(group.validation.as_ref().unwrap().points.len(), 12);
        assert_eq!(group.identification.as_ref().unwrap().estimates.joints.len(), 6);
        if let Some(selection) = &group.selection {
            assert_eq!(selection.termination, Termination::Converged, "{}", group.name);
            assert!(selection.smallest_margin_m.unwrap() >= -1e-9);
        }
        // Eq. (19) bounds what it is shown beside.
        assert!(group.error_bound.unwrap().bound.unwrap() > group.expected_relative_norm.unwrap());
        // 500 N: K_C alone stays below 4 µm.
        assert!(group.correction_share_m < 4e-6);
    }
    assert_eq!(result.starts.kinds.iter().map(|k| k.count).sum::<usize>(), 4);
    for kind in &result.starts.kinds {
        let expected_error = kind.rows.last().unwrap();
        assert_eq!(expected_error.improved, kind.count);
    }
    let range = result.classical_q1.as_ref().unwrap();
    assert_eq!(range.draws, 40);
    assert!(has(&result, "paper-order") && has(&result, "classical-q1"));
}

#[test]
fn a_stopped_study_keeps_what_it_has() {
    let cell = cell();
    let initial = group_1(&cell);
    let stopped = AtomicBool::new(false);
    // Stops at once, and stays stopped.
    let stop = || {
        stopped.store(true, Ordering::Relaxed);
        true
    };
    let control = stopped_by(&stop);
    let result = study(&cell, &initial, &options(6, 1000), control).unwrap();
    assert!(stopped.load(Ordering::Relaxed));
    assert!(result.interrupted && has(&result, "interrupted"));
    assert!(result.starts.kinds.is_empty());
    // The start is the best so far.
    assert!(!result.groups.is_empty());
    assert_eq!(result.simulation.groups.len(), result.groups.len());
}

#[test]
fn a_straight_wrist_is_left_and_the_study_goes_on() {
    let cell = cell();
    let mut initial = group_1(&cell);
    for posture in &mut initial.postures {
        posture.q[4] = 0.0;
    }
    let result = study(&cell, &initial, &options(0, 200), Control::default()).unwrap();
    assert_eq!(result.groups.len(), 5);
    assert!(result.groups[0].evaluation.indices.classical.is_none());
    assert!(result.groups[1].evaluation.indices.classical.is_some());
}

#[test]
fn without_noise_nothing_is_recommended() {
    let mut cell = cell();
    cell.noise.reading_variance = 0.0;
    let result = run(&cell, &options(0, 20));
    assert_eq!(result.recommended, None);
    assert!(has(&result, "no-noise") && !has(&result, "paper-order"));
    let text = serde_json::to_string(&result.findings).unwrap();
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
}

#[test]
fn five_joints_have_no_dexterity_and_no_paper_order() {
    let text = "format = 1\nname = \"five\"\n[robot]\nname = \"five\"\ndh_modified = [[0, 0, 400, 0], [-90, 100, 0, 0], \
                [0, 600, 0, 0], [-90, 100, 500, 0], [90, 0, 100, 0]]\n[bounds]\nq_deg = [[-90, 90], [-90, 90], [-90, 90], \
                [-90, 90], [-90, 90]]\n[tool]\nloading_point_mm = [100, 0, 50]\n[[tool.measuring_point]]\nname = \"a\"\n\
                position_mm = [50, 0, 100]\n[[tool.measuring_point]]\nname = \"b\"\nposition_mm = [0, 50, 100]\n[load]\n\
                kind = \"rope\"\nmagnitude_n = 300\nanchor_mm = [1500, 0, -500]\n[stiffness]\nprior_nm_per_rad = [5e5, \
                1e6, 5e5, 1e5, 1e5]\n";
    let cell = parse_cell(text, "five.toml").unwrap();
    let angles = [[0.2, 0.3, 0.5, 0.7, 0.9], [-0.5, 0.2, 0.9, -0.3, 0.6], [0.9, -0.7, 0.3, 0.2, -1.0]];
    let initial = PostureGroup::from_angles("Group 1", angles.map(|q| q.to_vec()));
    let result = study(&cell, &initial, &options(2, 100), Control::default()).unwrap();
    assert_eq!(result.groups.len(), 2);
    assert_eq!(result.recommended, Some(Index::ExpectedError));
    assert!(result.starts.kinds.iter().all(|k| k.paper_order_held.is_none()));
    assert!(!has(&result, "paper-order") && !has(&result, "classical-q1"));
}
