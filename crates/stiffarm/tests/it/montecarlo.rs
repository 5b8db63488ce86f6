//! Simulated identifications meet the closed forms of their errors.
//!
//! Seeds are fixed and thresholds are those of tests at a total level of one
//! in a thousand, so a failure is a change in behaviour and not bad luck.
//! `cargo test --workspace --test it montecarlo -- --nocapture` prints the largest deviations.

use crate::common::cases::refusals;
use crate::common::prelude::*;
use crate::common::random_group;
use statrs::distribution::{ContinuousCDF, Normal};
use stiffarm::estimate::simulate::{GroupSimulation, LevelResult, Simulation};

/// Probability of a false alarm in all comparisons of one test together.
const FALSE_ALARM: f64 = 1e-3;

fn standard_normal() -> Normal {
    Normal::new(0.0, 1.0).unwrap()
}

/// |z| that one of `comparisons` exceeds by chance with [`FALSE_ALARM`] (Bonferroni).
fn threshold(comparisons: usize) -> f64 {
    standard_normal().inverse_cdf(1.0 - 0.5 * FALSE_ALARM / comparisons as f64)
}

/// Hand-picked, random and optimised postures.
fn groups(cell: &Cell) -> Vec<PostureGroup> {
    let plan = local(cell, Index::ExpectedError, &group1()).unwrap();
    vec![
        PostureGroup::from_angles("hand-picked", group1()),
        PostureGroup::from_angles("random", random_group()),
        plan.to_group("optimised"),
    ]
}

fn run(cell: &Cell, groups: &[PostureGroup], runs: usize, seed: u64) -> Simulation {
    let options = with(|o: &mut SimulationOptions| {
        o.runs = runs;
        o.seed = seed;
    });
    simulate(cell, groups, &options, Control::default()).unwrap()
}

/// Every joint at every level of every group.
fn cases(groups: &[GroupSimulation]) -> Vec<(&str, &LevelResult, usize)> {
    let levels = groups.iter().flat_map(|g| g.levels.iter().map(move |l| (g.name.as_str(), l)));
    let joints = levels.flat_map(|(name, l)| (0..l.expected_deviation.len()).map(move |j| (name, l, j)));
    joints.collect()
}

/// z of the mean deviation of the compliance, whose closed form is exact.
fn compliance_z(level: &LevelResult, joint: usize) -> f64 {
    let difference = level.compliance_mean_deviation[joint] - level.expected_deviation[joint];
    difference / level.compliance_standard_error[joint]
}

/// Relative standard error of k behind an expected deviation.
fn relative_error(level: &LevelResult, joint: usize) -> f64 {
    level.expected_deviation[joint] / std::f64::consts::FRAC_2_PI.sqrt()
}

/// z of the median of |1/(1 + x) − 1|, which has an exact form at any noise:
/// half of all x lie between −m/(1 + m) and m/(1 − m).
fn median_z(level: &LevelResult, joint: usize, runs: usize) -> f64 {
    let (m, error) = (level.median_deviation[joint], relative_error(level, joint));
    assert!(m < 1.0, "the form holds below 1");
    let normal = standard_normal();
    let share = normal.cdf(m / (1.0 - m) / error) - normal.cdf(-m / (1.0 + m) / error);
    (share - 0.5) / (0.5 / (runs as f64).sqrt())
}

#[test]
fn many_runs_meet_the_closed_forms() {
    let count = runs(2_000) as usize;
    let cell = reference_cell();
    let groups = groups(&cell);
    let simulation = run(&cell, &groups, count, 2021);
    let all = cases(&simulation.groups);
    assert_eq!(all.len(), 3 * 6 * 6);
    let limit = threshold(all.len());
    let (mut flagged, mut within_5) = (0, 0);
    let (mut on_h, mut on_k, mut on_k_second, mut on_median) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for (group, level, j) in all {
        let what = format!("{group}, factor {}, joint {}", level.variance_factor, j + 1);
        let expected = level.expected_deviation[j];
        let error = relative_error(level, j);

        // On Ĥ the closed form is exact.
        let z = compliance_z(level, j);
        assert!(z.abs() < limit, "{what}: z = {z} on the compliance");
        on_h = on_h.max(z.abs());

        // On k̂ = 1/Ĥ it is of first order; the next term is a factor 1 + 2ε².
        if error < 0.05 {
            within_5 += 1;
            let z = (level.mean_deviation[j] - expected) / level.standard_error[j];
            assert!(z.abs() < limit, "{what}: z = {z} on the stiffness");
            on_k = on_k.max(z.abs());
            let second = expected * (1.0 + 2.0 * error * error);
            let z = (level.mean_deviation[j] - second) / level.standard_error[j];
            assert!(z.abs() < limit, "{what}: z = {z} on the stiffness, second order");
            on_k_second = on_k_second.max(z.abs());
        }

        let z = median_z(level, j, count);
        assert!(z.abs() < limit, "{what}: z = {z} on the median");
        on_median = on_median.max(z.abs());

        assert_eq!(level.beyond_first_order[j], error > 0.1, "{what}");
        flagged += usize::from(level.beyond_first_order[j]);
    }
    println!(
        "largest |z| (limit {limit:.2}): compliance {on_h:.2}, stiffness {on_k:.2} ({within_5} cases), \
         with the second order {on_k_second:.2}, median {on_median:.2}; {flagged} flagged"
    );
    // The flag must have been seen both ways, or it was not tested.
    assert!(flagged >= 2 && within_5 > 60);
    // The simulation's closed form is the evaluation's at level 2.
    for (group, simulated) in groups.iter().zip(&simulation.groups) {
        let evaluated = evaluate(&cell, &group.name, &group.postures).unwrap();
        for (a, b) in evaluated.expected_deviation.iter().zip(&simulated.levels[1].expected_deviation) {
            assert!((a.unwrap() / b - 1.0).abs() < 1e-12);
        }
    }
}

/// The closed form holds on cells of any size, load and springs, not only on
/// the reference cell.
#[test]
fn the_closed_form_holds_on_random_cells() {
    let experiments = runs(400) as usize;
    let mut compared = Vec::new();
    for seed in 0..24_u64 {
        let mut dice = Dice::new(1000 + seed);
        let n = 4 + dice.below(4);
        let kind = dice.below(4);
        let (elastic, common) = (dice.chance(0.5), dice.chance(0.5));
        let cell = dice.model(n, kind, elastic, common).cell();
        let count = 4 + dice.below(3);
        let group = PostureGroup::from_angles(format!("cell {seed}"), dice.postures(n, count));
        let determined = evaluate(&cell, &group.name, &group.postures).unwrap().undetermined_joints.is_empty();
        if determined {
            compared.extend(run(&cell, &[group], experiments, seed).groups);
        }
    }
    assert!(compared.len() >= 12, "{} cells", compared.len());
    let cases = cases(&compared);
    let limit = threshold(2 * cases.len());
    let mut largest = 0.0_f64;
    for (name, level, j) in cases {
        let what = format!("{name}, joint {}", j + 1);
        let expected = level.expected_deviation[j];
        let z = compliance_z(level, j);
        assert!(z.abs() < limit, "{what}: z = {z} on the compliance");
        largest = largest.max(z.abs());
        if relative_error(level, j) < 0.05 {
            let z = (level.mean_deviation[j] - expected) / level.standard_error[j];
            assert!(z.abs() < limit, "{what}: z = {z} on the stiffness");
        }
    }
    println!("{} random cells, largest |z| {largest:.2} (limit {limit:.2})", compared.len());
}

#[test]
fn the_median_holds_where_the_mean_does_not_exist() {
    let count = runs(2_000) as usize;
    let cell = reference_cell();
    let groups = [PostureGroup::from_angles("hand-picked", group1())];
    let options = with(|o: &mut SimulationOptions| {
        o.variance_factors = vec![20.0, 40.0];
        o.runs = count;
    });
    let simulation = simulate(&cell, &groups, &options, Control::default()).unwrap();
    let limit = threshold(12);
    for level in &simulation.groups[0].levels {
        for j in 0..6 {
            let z = median_z(level, j, count);
            let factor = level.variance_factor;
            assert!(z.abs() < limit, "factor {factor}, joint {}: {z}", j + 1);
        }
        // Joint 4 has a standard error of a third and more: the mean is far off the closed form.
        assert!(relative_error(level, 3) > 0.3 && level.beyond_first_order[3]);
        assert!(level.mean_deviation[3] > 1.2 * level.expected_deviation[3]);
    }
}

#[test]
fn a_shift_common_to_a_posture_is_simulated_and_weighted() {
    let mut cell = reference_cell();
    cell.noise.posture_common_std = 1.5 * cell.noise.displacement_std();
    let groups = [PostureGroup::from_angles("random", random_group())];
    let simulation = run(&cell, &groups, runs(2_000) as usize, 5);
    let limit = threshold(36);
    for level in &simulation.groups[0].levels {
        for j in 0..6 {
            let z = compliance_z(level, j);
            let factor = level.variance_factor;
            assert!(z.abs() < limit, "factor {factor}, joint {}: {z}", j + 1);
        }
    }
}

#[test]
fn noise_grows_with_the_square_root_of_its_variance() {
    let cell = reference_cell();
    let groups = [PostureGroup::from_angles("random", random_group())];
    let simulation = run(&cell, &groups, 2, 1);
    let levels = &simulation.groups[0].levels;
    let factors: Vec<f64> = levels.iter().map(|l| l.variance_factor).collect();
    assert_eq!(factors, [0.5, 1.0, 1.5, 2.0, 2.5, 3.0]);
    for level in levels {
        for j in 0..6 {
            let ratio = level.expected_deviation[j] / levels[1].expected_deviation[j];
            assert!((ratio - level.variance_factor.sqrt()).abs() < 1e-12);
        }
    }
    // Without noise nothing deviates, and two readings double the variance.
    let quiet = with(|o: &mut SimulationOptions| {
        o.variance_factors = vec![0.0];
        o.runs = 3;
    });
    let quiet = simulate(&cell, &groups, &quiet, Control::default()).unwrap();
    assert_eq!(quiet.groups[0].levels[0].mean_deviation, [0.0; 6]);
    let mut honest = cell.clone();
    honest.noise.readings_per_displacement = 2;
    let honest = run(&honest, &groups, 2, 1);
    for j in 0..6 {
        let ratio = honest.groups[0].levels[0].expected_deviation[j] / levels[1].expected_deviation[j];
        assert!((ratio - 1.0).abs() < 1e-12);
    }
}

#[test]
fn longer_simulations_begin_with_the_runs_of_shorter_ones() {
    let cell = reference_cell();
    let groups = groups(&cell);
    let [one, two, three, many] = [1, 2, 3, 50].map(|runs| run(&cell, &groups, runs, 9));
    assert_ne!(one, run(&cell, &groups, 1, 4), "another seed");
    let levels = |s: &Simulation| s.groups.iter().flat_map(|g| g.levels.clone()).collect::<Vec<LevelResult>>();
    let (one, two, three, many) = (levels(&one), levels(&two), levels(&three), levels(&many));
    for (((one, two), three), many) in one.iter().zip(&two).zip(&three).zip(&many) {
        assert_eq!(one.mean_deviation, one.first_run_deviation);
        assert_eq!(one.first_run_deviation, many.first_run_deviation);
        for j in 0..6 {
            let first = one.mean_deviation[j];
            let second = 2.0 * two.mean_deviation[j] - first;
            let third = 3.0 * three.mean_deviation[j] - first - second;
            let mut runs = [first, second, third];
            runs.sort_by(f64::total_cmp);
            // The median is another statistic of the same three numbers.
            assert!((three.median_deviation[j] - runs[1]).abs() < 1e-12);
        }
    }
    // Neither do further groups and levels change what came before.
    let options = with(|o: &mut SimulationOptions| {
        o.variance_factors = vec![0.5];
        o.runs = 50;
        o.seed = 9;
    });
    let part = simulate(&cell, &groups[..1], &options, Control::default()).unwrap();
    assert_eq!(part.groups[0].levels[0], many[0]);
    // Each level and group draws its own numbers.
    let scaled = |l: &LevelResult| l.first_run_deviation[0] / l.variance_factor.sqrt();
    assert!((scaled(&many[0]) / scaled(&many[1]) - 1.0).abs() > 1e-3);
}

#[test]
fn simulation_refuses_what_it_cannot_answer() {
    let cell = reference_cell();
    let groups = [PostureGroup::from_angles("one", group1())];
    let of = |cell: &Cell, options: &SimulationOptions| simulate(cell, &groups, options, Control::default());
    let default = SimulationOptions::default;
    let with = |change: fn(&mut SimulationOptions)| of(&cell, &changed(default(), change));
    let blank = Cell { prior: None, ..cell.clone() };
    let rows = [
        ("no run", Code::InvalidValue, with(|o| o.runs = 0)),
        ("no level", Code::InvalidValue, with(|o| o.variance_factors.clear())),
        ("a negative level", Code::InvalidValue, with(|o| o.variance_factors = vec![-1.0])),
        ("a level that is no number", Code::InvalidValue, with(|o| o.variance_factors = vec![f64::NAN])),
        ("no prior", Code::MissingKey, of(&blank, &default())),
    ];
    insta::assert_snapshot!("simulation_refusals", refusals(rows));
}

#[test]
fn a_stopped_simulation_keeps_its_first_runs() {
    let cell = reference_cell();
    let groups = [PostureGroup::from_angles("one", group1())];
    let default = SimulationOptions::default;
    let stop = || true;
    let control = stopped_by(&stop);
    // Stopped at once it still has runs at every level: the first ones.
    let stopped = simulate(&cell, &groups, &default(), control).unwrap();
    let whole = simulate(&cell, &groups, &default(), Control::default()).unwrap();
    assert!(stopped.interrupted && !whole.interrupted);
    for (some, all) in stopped.groups[0].levels.iter().zip(&whole.groups[0].levels) {
        assert_eq!((some.runs, all.runs), (20, 200));
        assert_eq!(some.first_run_deviation, all.first_run_deviation);
    }
}
