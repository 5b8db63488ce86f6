//! A cylinder or screw that pushes is a rope with its force turned round, in readings, identification and design.
//! Statics: the random models of `properties.rs` have one in five.

use crate::common::prelude::*;
use crate::common::readings::{named, states};
use stiffarm::plan::select::DesignedLoad;

/// The reference cell with a cylinder of 700 N between loading point and anchor.
fn cylinder(pushes: bool) -> Cell {
    changed(reference_cell(), |cell| {
        *rope_force(cell) = if pushes { -700.0 } else { 700.0 };
    })
}

#[test]
fn a_push_of_another_size_keeps_acting_along_its_line() {
    let cell = cylinder(true);
    let stiffness = cell.require_prior().unwrap();
    let mut weaker = cell.clone();
    weaker.setup.load = cell.setup.load.with_size(350.0).unwrap();
    for q in group1() {
        let whole = PostureTerms::new(&cell.setup, &q, None).unwrap();
        let half = Wrench::force(whole.wrench().force * 0.5);
        let ours = equilibrium(&cell.setup, &q, stiffness, Some(&half)).unwrap();
        let other = equilibrium(&weaker.setup, &q, stiffness, None).unwrap();
        assert!((ours.deflection - other.deflection).amax() < 1e-14);
    }
}

/// Three load states without noise, by the linear model.
fn silent(force: ForceRecord) -> Experiment {
    Experiment {
        states: states(&[("unloaded", 0.0, 1), ("half", 0.5, 1), ("full", 1.0, 1), ("unloaded-2", 0.0, 1)]),
        force,
        model: DisplacementModel::Linear,
        ..Experiment::default()
    }
}

#[test]
fn a_pushed_experiment_gives_the_stiffness_back() {
    for force in [ForceRecord::Load, ForceRecord::Force] {
        let cell = cylinder(true);
        let postures = numbered(group1());
        let truth = cell.require_prior().unwrap().to_vec();
        let table = experiment(&cell, &postures, &truth, &silent(force), 1, 0).unwrap();
        if force == ForceRecord::Load {
            let mut states = table.postures.iter().flat_map(|p| &p.states);
            assert!(states.all(|s| s.load.unwrap() >= 0.0), "a table holds sizes");
        }
        let reduced = reduce(&cell, &table, &ReduceOptions::default()).unwrap();
        let identification = identify(&cell, &reduced.measured, &IdentifyOptions::default()).unwrap();
        let joints = identification.estimates.joints.iter();
        let stiffness: Vec<f64> = joints.map(|j| j.stiffness.unwrap()).collect();
        let error = relative_error(&stiffness, &truth);
        assert!(error < 1e-9, "{force:?}: {error:e}");
    }
}

#[test]
fn readings_of_a_push_raise_no_alarm_and_a_reversed_one_does() {
    let mut cell = default_cell();
    *rope_force(&mut cell) *= -1.0;
    let postures = numbered(group1());
    let truth = cell.require_prior().unwrap().to_vec();
    let serious = |f: &&Finding| f.severity == Severity::Serious;
    for sensor in [false, true] {
        cell.sensor = sensor.then(|| Sensor {
            mount: Mount::Flange,
            pose: common::readings::pose(0.0, 0.0, 0.05, [0.1, 0.2, 0.3]),
            reports_by_robot: false,
            mirrored: None,
        });
        let done =
            Experiment { base_reflectors: vec![named("base", [0.4, 0.3, 0.1])], ..Experiment::as_measured(&cell) };
        let table = experiment(&cell, &postures, &truth, &done, 3, 0).unwrap();
        let screened = screen(&cell, &table, None).unwrap();
        assert_eq!(screened.findings.iter().find(serious), None);
        let reduced = reduce(&cell, &table, &ReduceOptions::default()).unwrap();
        assert_eq!(reduced.findings.iter().find(serious), None);
        // A cell that says the cylinder pulls is contradicted by either.
        let mut pulls = cell.clone();
        *rope_force(&mut pulls) *= -1.0;
        let said = if sensor {
            reduce(&pulls, &table, &ReduceOptions::default()).unwrap().findings
        } else {
            screen(&pulls, &table, None).unwrap().findings
        };
        assert!(said.iter().any(|f| serious(&f)), "{said:?}");
    }
}

#[test]
fn a_design_chooses_the_size_and_keeps_the_way() {
    let cell = cylinder(true);
    let mut design = LoadDesign::default();
    design.magnitude = Some(900.0);
    let mut chosen = design.prepare(&cell).unwrap();
    assert_eq!(*rope_force(&mut chosen), -900.0);
    let designed = DesignedLoad::from(chosen.setup);
    assert_eq!(designed.magnitude_n, Some(900.0));
}

#[test]
fn limits_call_it_by_its_name() {
    let mut violations = Vec::new();
    for (pushes, name) in [(false, "rope"), (true, "cylinder")] {
        let mut cell = cylinder(pushes);
        cell.limits.rope_length = Some([5.0, 6.0]);
        let terms = PostureTerms::new(&cell.setup, &group1()[0], None).unwrap();
        let least = cell.margins().smallest(&terms).unwrap();
        assert_eq!((least.kind, least.point.as_str()), (LimitKind::RopeLength, name));
        violations.push(least.violation());
    }
    insta::assert_snapshot!(violations.join("\n"), @"
    has its rope 2873 mm beyond the rope's length
    has its cylinder 2873 mm beyond the cylinder's length
    ");
}

#[test]
fn cells_say_how_it_acts() {
    let load = |text: &str| {
        let cell = format!(
            "format = 1\n[robot]\ncatalogue = 'comau-nj165-3.0'\n[tool]\nloading_point_mm = [0, 100, 300]\n\
             [[tool.measuring_point]]\nname = 'a'\nposition_mm = [0, 150, 200]\n[load]\nkind = 'cylinder'\n\
             magnitude_n = 500\n{text}"
        );
        parse_cell(&cell, "cell.toml").unwrap().setup.load
    };
    let anchor = Vector3::new(1.8, 0.0, -0.1);
    for (acts, sign) in [("pulls", 1.0), ("pushes", -1.0)] {
        let line = load(&format!("acts = '{acts}'\nanchor_mm = [1800, 0, -100]"));
        let magnitude = 500.0 * sign;
        assert_eq!(line, Load::Rope { anchor, magnitude });
        for (name, axes) in [("base", Axes::Base), ("tool", Axes::Tool)] {
            let guided = load(&format!("acts = '{acts}'\ndirection = [0, 3, -4]\naxes = '{name}'"));
            let wrench = Wrench::force([0.0, 300.0 * sign, -400.0 * sign]);
            assert_eq!(guided, Load::Constant { wrench, axes });
        }
    }
}
