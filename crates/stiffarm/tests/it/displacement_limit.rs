//! The load's displacement as a limit of postures: every way to choose postures keeps to it, and
//! says so where nothing can.

use crate::common::cases::refusals;
use crate::common::prelude::*;
use stiffarm::model::observation::Setup;
use stiffarm::model::scene::{DisplacementLimits, SceneParts};
use stiffarm::plan::check::check;
use stiffarm::plan::feasibility::{PostureLimits, obstruction};
use stiffarm::plan::select::{limit_prices, space_filling};

/// The default cell where the load moves the points by so much [m].
fn cell(range: [f64; 2]) -> Cell {
    let mut cell = default_cell();
    let prior = cell.require_prior().unwrap();
    let parts = SceneParts {
        displacement: Some(DisplacementLimits {
            smallest: Some(range[0]),
            largest: Some(range[1]),
            compliance: joint_compliance(&cell.setup.robot, prior).unwrap(),
        }),
        ..SceneParts::default()
    };
    cell.scene = parts.build(&cell.setup.robot, &cell.bounds).unwrap();
    cell
}

/// RMS displacement of the points, by Ψ.
fn displacement(setup: &Setup, prior: &[f64], q: &[f64]) -> f64 {
    let terms = PostureTerms::new(setup, q, None).unwrap();
    let compliance = compliance_of(prior);
    let moved = terms.block(&setup.robot) * compliance;
    (moved.norm_squared() / setup.tool.point_count() as f64).sqrt()
}

fn all(cell: &Cell, group: &[Vec<f64>]) -> Vec<f64> {
    let prior = cell.require_prior().unwrap();
    let of = |q: &Vec<f64>| displacement(&cell.setup, prior, q);
    group.iter().map(of).collect()
}

fn keeps(cell: &Cell, group: &[Vec<f64>], [low, high]: [f64; 2]) {
    for moved in all(cell, group) {
        assert!((low..=high).contains(&moved), "{moved} in {low} to {high}");
    }
}

const RANGE: [f64; 2] = [5e-4, 1e-3];

#[test]
fn a_global_search_keeps_to_it_and_it_costs() {
    let cell = cell(RANGE);
    for index in [Index::ExpectedError, Index::Condition, Index::DropOne] {
        let planned = |cell: &Cell| select(cell, index, 6, &rounds(1), Control::default()).unwrap();
        let plan = planned(&cell);
        keeps(&cell, &plan.group, RANGE);
        // The free plan goes beyond it, so this one is at its edge.
        if index == Index::ExpectedError {
            let free = planned(&default_cell());
            let before = all(&cell, &free.group);
            println!("{before:?}, {} to {}", free.value, plan.value);
            assert!(before.iter().any(|d| *d > RANGE[1]));
            let now = all(&cell, &plan.group);
            let edge = now.iter().fold(0.0_f64, |m, d| m.max(*d));
            assert!(edge > 0.999 * RANGE[1], "{now:?}");
        }
        // What is told of each posture is that displacement.
        for (margins, moved) in plan.limits.iter().zip(all(&cell, &plan.group)) {
            assert!((margins.displacement_m.unwrap() - moved).abs() < 1e-15);
            let most = margins.of(LimitKind::LargestDisplacement).unwrap();
            assert!((most.margin_m.unwrap() - (RANGE[1] - moved)).abs() < 1e-15);
        }
        // It is no distance: the smallest margin of a length is that of the others.
        let lengths = plan.limits.iter().filter_map(PostureLimits::smallest_m);
        assert_eq!(plan.smallest_margin_m, lengths.reduce(f64::min));
    }
}

#[test]
fn every_other_choice_keeps_to_it() {
    let cell = cell(RANGE);
    let random = random_group(&cell, StartKind::Uniform, 6, 5, 0).unwrap();
    keeps(&cell, &random, RANGE);
    let even = space_filling(&cell, 8, 1, Control::default()).unwrap();
    keeps(&cell, &even.postures, RANGE);
    // From groups outside of it: a local search that finds its way in.
    let mut inside = 0;
    for stream in 0..8 {
        let start = random_group(&default_cell(), StartKind::Uniform, 6, 5, stream).unwrap();
        assert!(all(&cell, &start).iter().any(|d| *d > RANGE[1]));
        let options = LocalOptions::default();
        let led = select_from(&cell, Index::ExpectedError, &start, options, Control::default());
        if let Ok(led) = led {
            keeps(&cell, &led.group, RANGE);
            inside += 1;
        }
    }
    println!("{inside} of 8 starts led inside");
    assert!(inside >= 3, "{inside}");
}

#[test]
fn a_load_chosen_with_the_postures_keeps_to_it() {
    let cell = cell(RANGE);
    let mut options = rounds(1);
    options.load.anchor = Some([Vector3::new(1.0, -0.8, 0.0), Vector3::new(2.6, 0.8, 0.0)]);
    options.load.loading_point = Some([Vector3::new(0.1, -0.1, 0.15), Vector3::new(0.3, 0.1, 0.35)]);
    let plan = select(&cell, Index::ExpectedError, 6, &options, Control::default()).unwrap();
    let chosen = plan.load.clone().unwrap();
    let mut moved = cell.clone();
    *rope_anchor(&mut moved) = chosen.anchor_m.unwrap().into();
    moved.setup.tool.loading_point = chosen.loading_point_m.into();
    keeps(&moved, &plan.group, RANGE);
    assert_ne!(options.load, LoadDesign::default());
}

#[test]
fn prices_and_certificate_know_it() {
    let cell = cell([1e-4, 6e-4]);
    let options = rounds(1);
    let plan = select(&cell, Index::ExpectedError, 6, &options, Control::default()).unwrap();
    keeps(&cell, &plan.group, [1e-4, 6e-4]);
    let control = Control::default();
    let prices = limit_prices(&cell, Index::ExpectedError, 6, &options, plan.value, control);
    let prices = prices.unwrap();
    let of = |kind| prices.iter().find(|p| p.kind == kind).unwrap().price;
    assert!(of(LimitKind::LargestDisplacement) > 0.1, "{prices:?}");
    assert!(of(LimitKind::SmallestDisplacement) < 0.01, "{prices:?}");
    let bound_of = |cell: &Cell| {
        let options = CertificateOptions::default();
        let index = Index::ExpectedError;
        let certificate = certify(cell, index, &plan.group, &options, Control::default());
        certificate.unwrap().bound
    };
    let bound = bound_of(&cell);
    println!("{} over {bound}", plan.value);
    // Without the limit the bound lies lower: the certificate looks at postures within it only.
    assert!(bound > 1.1 * bound_of(&default_cell()));
    assert!(bound <= plan.value);
}

#[test]
fn where_nothing_can_meet_it_the_error_names_it() {
    let too_far = cell([0.05, 0.06]);
    let error = select(&too_far, Index::ExpectedError, 6, &rounds(1), Control::default());
    let error = error.unwrap_err();
    assert_eq!(error.code(), Code::InvalidValue);
    insta::assert_snapshot!(error, @"
    limits: None of 200000 random postures within the bounds meets the cell's limits. Of 4096 postures spread over the bounds none meet every limit; violated most often: the smallest displacement under the load (100 %), the box for tool points and flange (71 %), the keep-out cylinder about axis 1 (29 %). Without the smallest displacement under the load 1094 postures would do.
      hint: relax what stands in the way: check frames (base, flange) and units (mm) of limits, shapes and stations, or move anchor, station or obstacle
    ");
    let seen = obstruction(&too_far).unwrap();
    assert_eq!(seen.feasible, 0);
    let (kinds, left) = seen.relief.unwrap();
    assert_eq!(kinds, [LimitKind::SmallestDisplacement]);
    assert!(left > 0);
    let findings = check(&too_far).unwrap().findings;
    insta::assert_snapshot!(the(&findings, "unreachable-limits").sentence, @"Of 256 postures spread over the bounds none meet every limit; violated most often: the smallest displacement under the load (100 %), the box for tool points and flange (72 %), the keep-out cylinder about axis 1 (29 %). Without the smallest displacement under the load 67 postures would do. Check the limits' frame (robot base) and unit (mm).");
}

#[test]
fn cells_give_it_with_a_prior_and_a_known_load() {
    let text = |load: &str, rest: &str| {
        format!(
            "format = 1\n[robot]\ndh_modified = [[0, 0, 830, 0], [-90, 400, 0, -90]]\nlimits_deg = [[-180, 180], [-75, 95]]\n\
             [tool]\nloading_point_mm = [0, 100, 300]\n[[tool.measuring_point]]\nname = 'a'\nposition_mm = [0, 150, 200]\n\
             [load]\n{load}\n[limits]\ndisplacement_mm = [0, 3]\n{rest}"
        )
    };
    let parse = |text: &str| parse_cell(text, "cell.toml");
    let rope = "kind = 'rope'\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]";
    let prior = "[stiffness]\nprior_nm_per_rad = [1e6, 2e6]\n";
    let cell = parse(&text(rope, prior)).unwrap();
    let limits = cell.scene.displacement().unwrap();
    // 0 asks for none.
    assert_eq!((limits.smallest, limits.largest), (None, Some(3e-3)));
    assert_eq!(limits.compliance[(1, 1)], 5e-7);
    assert_eq!(cell.limit_kinds(), [LimitKind::LargestDisplacement]);
    assert!(cell.scene.at_work().is_empty());
    let rows = [
        ("no prior", Code::MissingKey, parse(&text(rope, ""))),
        ("a measured load", Code::Conflict, parse(&text("kind = 'measured'", prior))),
    ];
    insta::assert_snapshot!(refusals(rows), @r#"
    » no prior
    [missing-key] cell.toml:15:19: limits.displacement_mm: A limit of the displacement needs a prior joint stiffness, and the cell has none.
      hint: add [stiffness] with prior_nm_per_rad, or remove displacement_mm

    » a measured load
    [conflict] cell.toml:13:19: limits.displacement_mm: A limit of the displacement needs a load that is known before it is measured.
      hint: remove displacement_mm, or set load.kind to "rope", "cylinder", "weight" or "wrench" as the load will be
    "#);
}
