//! A cylinder or screw that loads the robot: what pushes is a rope with its force turned round, in
//! statics, readings and identification.

use crate::common::prelude::*;
use crate::common::readings::{named, states};
use stiffarm::model::stiffness::rope_correction;
use stiffarm::plan::select::DesignedLoad;

/// The reference cell with a cylinder of 700 N between loading point and anchor.
fn cylinder(pushes: bool) -> Cell {
    changed(reference_cell(), |cell| {
        *rope_force(cell) = if pushes { -700.0 } else { 700.0 };
    })
}

#[test]
fn force_and_torques_are_those_of_the_line() {
    for pushes in [false, true] {
        let mut cell = cylinder(pushes);
        let anchor = *rope_anchor(&mut cell);
        for q in group1() {
            let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
            let p = *terms.loading_point();
            let pull = (anchor - p).normalize() * 700.0;
            let force = if pushes { -pull } else { pull };
            assert!((terms.wrench().force - force).norm() < 1e-10);
            assert_eq!(terms.wrench().moment, Vector3::zeros());
            let frames = terms.frames();
            for (j, torque) in terms.torque().iter().enumerate() {
                let lever = p - frames.origins()[j];
                let by_hand = frames.axes()[j].dot(&lever.cross(&force));
                assert!((torque - by_hand).abs() < 1e-9, "{torque} {by_hand}");
            }
        }
    }
}

/// Work stored in springs and line: ½ δᵀ K δ + G ℓ, whose slope is zero at the equilibrium.
fn energy(cell: &Cell, start: &DVector<f64>, deflection: &DVector<f64>) -> f64 {
    let Load::Rope { anchor, magnitude } = cell.setup.load else {
        panic!("no line");
    };
    let theta = start + deflection;
    let frames = Frames::at_serial_angles(&cell.setup.robot, theta.as_slice());
    let length = (anchor - frames.point(&cell.setup.tool.loading_point)).norm();
    let springs = cell.require_prior().unwrap().iter().zip(deflection);
    springs.map(|(k, d)| 0.5 * k * d * d).sum::<f64>() + magnitude * length
}

#[test]
fn a_pushed_arm_is_in_balance_and_the_line_stiffens_or_softens_it() {
    for pushes in [false, true] {
        let cell = cylinder(pushes);
        let stiffness = cell.require_prior().unwrap();
        for q in group1() {
            let start = cell.setup.robot.serial_angles(&q);
            let found = equilibrium(&cell.setup, &q, stiffness, None).unwrap();
            let at = |k: usize, step: f64| {
                let mut moved = found.deflection.clone();
                moved[k] += step;
                energy(&cell, &start, &moved)
            };
            for k in 0..6 {
                let slope = (at(k, 1e-4) - at(k, -1e-4)) / 2e-4;
                assert!(slope.abs() < 1e-4, "joint {k}: {slope} N·m");
            }
            // A load state of another size keeps acting along its line.
            let half = PostureTerms::new(&cell.setup, &q, None).unwrap();
            let half = Wrench::force(half.wrench().force * 0.5);
            let ours = equilibrium(&cell.setup, &q, stiffness, Some(&half)).unwrap();
            let mut weaker = cell.clone();
            weaker.setup.load = cell.setup.load.with_size(350.0).unwrap();
            let other = equilibrium(&weaker.setup, &q, stiffness, None).unwrap();
            assert!((ours.deflection - other.deflection).amax() < 1e-14);
        }
    }
    // The geometric term of the line turns round with the force.
    let [pulled, pushed] = [false, true].map(cylinder);
    let terms = PostureTerms::new(&pulled.setup, &group1()[0], None).unwrap();
    let [a, b] = [&pulled, &pushed].map(|cell| rope_correction(&cell.setup.load, &terms));
    assert!(a.amax() > 1.0);
    assert_eq!(a, -b);
}

/// Three load states without noise, by the linear model.
fn silent(force: ForceRecord) -> Experiment {
    Experiment {
        states: states(&[
            ("unloaded", 0.0, 1),
            ("half", 0.5, 1),
            ("full", 1.0, 1),
            ("unloaded-2", 0.0, 1),
        ]),
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
            assert!(
                states.all(|s| s.load.unwrap() >= 0.0),
                "a table holds sizes"
            );
        }
        let reduced = reduce(&cell, &table, &ReduceOptions::default()).unwrap();
        let found = identify(&cell, &reduced.measured, &IdentifyOptions::default()).unwrap();
        let joints = found.estimates.joints.iter();
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
        });
        let done = Experiment {
            base_reflectors: vec![named("base", [0.4, 0.3, 0.1])],
            ..Experiment::as_measured(&cell)
        };
        let table = experiment(&cell, &postures, &truth, &done, 3, 0).unwrap();
        let screened = screen(&cell, &table, None).unwrap();
        assert_eq!(screened.findings.iter().find(serious), None);
        let reduced = reduce(&cell, &table, &ReduceOptions::default()).unwrap();
        assert_eq!(reduced.findings.iter().find(serious), None);
        // A cell that says the cylinder pulls is contradicted by either.
        let mut pulls = cell.clone();
        *rope_force(&mut pulls) *= -1.0;
        let said = if sensor {
            reduce(&pulls, &table, &ReduceOptions::default())
                .unwrap()
                .findings
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
    let told = DesignedLoad::from(chosen.setup);
    assert_eq!(told.magnitude_n, Some(900.0));
}

#[test]
fn limits_call_it_by_its_name() {
    for (pushes, name) in [(false, "rope"), (true, "cylinder")] {
        let mut cell = cylinder(pushes);
        cell.limits.rope_length = Some([5.0, 6.0]);
        let terms = PostureTerms::new(&cell.setup, &group1()[0], None).unwrap();
        let least = cell.margins().smallest(&terms).unwrap();
        assert_eq!(
            (least.kind, least.point.as_str()),
            (LimitKind::RopeLength, name)
        );
        let words = least.violation();
        assert!(words.starts_with(&format!("has its {name} ")), "{words}");
        assert!(
            words.ends_with(&format!("beyond the {name}'s length")),
            "{words}"
        );
    }
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
            let guided = load(&format!(
                "acts = '{acts}'\ndirection = [0, 3, -4]\naxes = '{name}'"
            ));
            let wrench = Wrench::force([0.0, 300.0 * sign, -400.0 * sign]);
            assert_eq!(guided, Load::Constant { wrench, axes });
        }
    }
}
