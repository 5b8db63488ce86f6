//! Common errors and what they do to the joint stiffness, held against
//! experiments in which the error was really made; profile of the likelihood.

use crate::common::prelude::*;
use nalgebra::Rotation3;
use stiffarm::estimate::identify::profile;
use stiffarm::estimate::systematic::SystematicErrors;

const ARC_MINUTE: f64 = PI / 180.0 / 60.0;

/// The default cell without noise.
fn quiet_cell() -> Cell {
    changed(default_cell(), |o| o.noise.reading_variance = 0.0)
}

fn truth(cell: &Cell) -> Vec<f64> {
    cell.prior.clone().unwrap()
}

/// The plan of the expected-error index from Group 1.
fn plan(cell: &Cell) -> Vec<Posture> {
    numbered(local(cell, Index::ExpectedError, &group1()).unwrap().group)
}

fn systematic(cell: &Cell, measured: &[MeasuredPosture], options: &IdentifyOptions) -> SystematicErrors {
    systematic_errors(&Fit::new(cell, measured, options).unwrap()).unwrap()
}

fn measure(cell: &Cell, postures: &[Posture], seed: u64) -> Vec<MeasuredPosture> {
    simulate_measurements(cell, postures, &truth(cell), Model::Linear, seed, 0).unwrap()
}

/// k of `measured` under the nominal cell, over the truth, less 1.
fn bias(cell: &Cell, measured: &[MeasuredPosture], options: &IdentifyOptions) -> Vec<f64> {
    let identification = identify(cell, measured, options).unwrap();
    let stiffness = identification.estimates.stiffness().unwrap();
    let truth = truth(cell);
    stiffness.iter().zip(truth).map(|(k, t)| k / t - 1.0).collect()
}

#[track_caller]
fn assert_same(ours: &[Option<f64>], made: &[f64], what: &str) {
    for (j, (a, b)) in ours.iter().zip(made).enumerate() {
        let a = a.unwrap();
        assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{what}, joint {}: {a} and {b}", j + 1);
    }
}

/// Each source does what really happens when its error is made in the
/// measurement and the nominal cell identifies.
#[test]
fn every_source_is_the_error_really_made() {
    let mut cell = quiet_cell();
    cell.setup.tool.has_sensor = true;
    cell.uncertainty.force_beside = Some(20.0);
    cell.uncertainty.common_shift = Some(5e-5);
    let cell = cell;
    let postures = numbered(group1());
    let nominal = measure(&cell, &postures, 1);
    let systematic = systematic(&cell, &nominal, &by(Estimator::Ordinary));
    let made = |cell: &Cell| measure(cell, &postures, 1);
    let seen = |measured: &[MeasuredPosture]| bias(&cell, measured, &by(Estimator::Ordinary));

    let mut other = cell.clone();
    *rope_force(&mut other) /= 1.01;
    let force = source(&systematic, "force-scale");
    assert_same(&force.change, &seen(&made(&other)), "force");
    assert_same(&force.change, &[0.01; 6], "force");
    for axis in 0..3 {
        let mut other = cell.clone();
        rope_anchor(&mut other)[axis] += 5e-3;
        let part = &source(&systematic, "anchor").parts[axis];
        assert_same(&part.change, &seen(&made(&other)), "anchor");

        let mut other = cell.clone();
        other.setup.tool.loading_point[axis] += 1e-3;
        let part = &source(&systematic, "loading-point").parts[axis];
        assert_same(&part.change, &seen(&made(&other)), "loading point");

        let turn = Rotation3::new(Vector3::ith(axis, 0.5e-3));
        let mut turned = nominal.clone();
        for displacement in turned.iter_mut().flat_map(|m| &mut m.displacements) {
            displacement.value = turn * displacement.value;
        }
        let part = &source(&systematic, "registration").parts[axis];
        assert_same(&part.change, &seen(&turned), "registration");
    }
    let mut other = cell.clone();
    let mut matrix = Matrix6::zeros();
    (3..6).for_each(|i| matrix[(i, i)] = 1e-6);
    other.setup.tool.series_compliance = Some(SeriesCompliance { origin: Vector3::zeros(), matrix });
    assert_same(&source(&systematic, "sensor").change, &seen(&made(&other)), "sensor");

    let with = |term: ExtraTerm, size: f64| {
        changed(nominal.clone(), |m| move_points(&cell, m, |terms| term.column(terms) * size))
    };
    for axis in 0..3 {
        let force = Wrench::force(Vector3::ith(axis, 20.0));
        let mut hung = nominal.clone();
        for m in &mut hung {
            let terms = PostureTerms::new(&cell.setup, &m.posture.q, Some(&force)).unwrap();
            let moved = terms.block(&cell.setup.robot) * compliance_of(&truth(&cell));
            for d in &mut m.displacements {
                d.value += moved.fixed_rows::<3>(3 * d.point);
            }
        }
        let part = &source(&systematic, "force-beside").parts[axis];
        assert_same(&part.change, &seen(&hung), "force beside the load");
        let moved = changed(nominal.clone(), |m| {
            let all = m.iter_mut().flat_map(|m| &mut m.displacements);
            all.for_each(|d| d.value[axis] += 5e-5);
        });
        let part = &source(&systematic, "common-shift").parts[axis];
        assert_same(&part.change, &seen(&moved), "common shift");
    }
    let tilted = seen(&with(ExtraTerm::BaseTilt, 1e-8));
    assert_same(&source(&systematic, "base-tilt").change, &tilted, "base tilt");
    for j in 0..6 {
        let loose = seen(&with(ExtraTerm::LostMotion(j), 0.1 * ARC_MINUTE));
        let part = &source(&systematic, "lost-motion").parts[j];
        assert_same(&part.change, &loose, "lost motion");
    }
}

/// The systematic errors on the default cell's expected-error plan.
#[test]
fn the_budget_of_the_default_cell() {
    let mut cell = quiet_cell();
    let uncertainty = &mut cell.uncertainty;
    uncertainty.base_tilt_compliance = Some(1.0 / 1e8);
    uncertainty.sensor_compliance = Some(1.0 / 3.3e5);
    uncertainty.lost_motion = Some(0.5 * ARC_MINUTE);
    let postures = plan(&cell);
    let measured = measure(&cell, &postures, 1);
    let of = |cell: &Cell, name: &str| -> Vec<f64> {
        let all = systematic(cell, &measured, &by(Estimator::Ordinary));
        let source = source(&all, name);
        source.change.iter().map(|c| 100.0 * c.unwrap().abs()).collect()
    };
    let range = |values: &[f64]| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        (low, values.iter().copied().fold(0.0, f64::max))
    };
    let (low, high) = range(&of(&cell, "anchor"));
    assert!(low > 0.05 && (0.6..0.7).contains(&high), "{low} {high}");
    assert!((of(&cell, "loading-point")[5] - 0.64).abs() < 0.03);
    // Per axis at most 0.13 %; the three together 0.16 %.
    let (_, high) = range(&of(&cell, "registration"));
    assert!((0.14..0.18).contains(&high), "{high}");
    assert!((of(&cell, "base-tilt")[1] - 4.6).abs() < 0.3);
    let (low, high) = range(&of(&cell, "lost-motion"));
    assert!((12.0..13.0).contains(&low) && (38.0..42.0).contains(&high), "{low} {high}");
    // A spring in series with joint 6 about its own axis: 1/k adds up, so that
    // 3.3e5 N·m/rad takes 30 % of k6, and not 21 %: that would be 5.4e5 N·m/rad.
    let sensor = of(&cell, "sensor");
    let k6 = truth(&cell)[5];
    assert!((sensor[5] - 100.0 * k6 / (k6 + 3.3e5)).abs() < 1.0, "{sensor:?}");
    assert!((10.0..15.0).contains(&sensor[3]) && (10.0..15.0).contains(&sensor[4]));
    cell.uncertainty.base_tilt_compliance = Some(1.0 / 2e7);
    assert!((of(&cell, "base-tilt")[1] - 19.5).abs() < 1.0);

    let postures = numbered(group1());
    let measured = measure(&cell, &postures, 1);
    let all = systematic(&cell, &measured, &by(Estimator::Ordinary));
    let k4 = source(&all, "anchor").change[3].unwrap();
    assert!((k4 - 0.039).abs() < 0.002, "{k4}");
    // Parts combine as root sum of squares; sources as well, as far as the readings
    // leave them. These are without noise, but no residual shows the force.
    for j in 0..6 {
        let sum = |parts: &mut dyn Iterator<Item = f64>| parts.map(|c| c * c).sum::<f64>().sqrt();
        let anchor = source(&all, "anchor");
        let parts = sum(&mut anchor.parts.iter().map(|p| p.change[j].unwrap()));
        assert!((parts - anchor.change[j].unwrap()).abs() < 1e-15);
        let combined = all.combined[j].unwrap();
        let force = all.sources[0].bounded[j].unwrap();
        assert!(combined > 0.5 * force && (force - 0.01 / 1.01).abs() < 1e-4, "{force}");
        assert!((all.sources[0].remaining.unwrap() - 1.0).abs() < 1e-6);
        assert_eq!(all.total[j], all.statistical[j].map(|s| s.hypot(combined)));
        assert!(anchor.worst.as_ref().unwrap()[j].unwrap() >= parts);
    }
}

/// A measured force along the rope is turned by the anchor's error like the
/// cell's own; a wrench whose moment a sensor measured knows no loading point.
#[test]
fn measured_wrenches_have_the_sources_that_made_them() {
    let cell = quiet_cell();
    let postures = numbered(group1());
    let nominal = measure(&cell, &postures, 1);
    let mut along = nominal.clone();
    for m in &mut along {
        let terms = PostureTerms::new(&cell.setup, &m.posture.q, None).unwrap();
        m.wrench = Some(*terms.wrench());
    }
    let a = systematic(&cell, &nominal, &by(Estimator::Ordinary));
    let b = systematic(&cell, &along, &by(Estimator::Ordinary));
    for name in ["force-scale", "anchor", "loading-point"] {
        let other: Vec<f64> = source(&b, name).change.iter().map(|c| c.unwrap()).collect();
        assert_same(&source(&a, name).change, &other, name);
    }
    let mut sensing = cell.clone();
    sensing.setup.load = Load::Measured;
    sensing.setup.tool.has_sensor = true;
    sensing.sensor =
        Some(Sensor { mount: Mount::Flange, pose: Isometry3::identity(), reports_by_robot: false, mirrored: None });
    let mut moments = along.clone();
    for m in &mut moments {
        m.wrench = Some(Wrench { moment: Vector3::new(3.0, -2.0, 1.0), ..m.wrench.unwrap() });
    }
    let c = systematic(&sensing, &moments, &by(Estimator::Ordinary));
    let names: Vec<&str> = c.sources.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["force-scale", "registration", "base-tilt", "sensor", "lost-motion"]);
    assert!(c.sources.iter().all(|s| !s.declared));
    assert_same(&c.sources[0].change, &[0.01; 6], "force");
}

/// Whatever the estimator, the force scale moves every k alike, and no residual
/// moves with it; the statistical part stands beside.
#[test]
fn the_force_scale_is_in_every_budget() {
    let mut cell = default_cell();
    cell.uncertainty.force_scale = Some(0.02);
    let postures = numbered(group1().into_iter().chain(common::random_group()));
    let measured = measure(&cell, &postures, 3);
    for estimator in Estimator::ALL {
        let options = by(estimator);
        let all = systematic(&cell, &measured, &options);
        let force = &all.sources[0];
        assert!(force.name == "force-scale" && force.declared && force.size == 0.02);
        // The prior pulls a little the other way.
        let room = if estimator == Estimator::Prior { 2e-4 } else { 1e-9 };
        for (j, change) in force.change.iter().enumerate() {
            let change = change.unwrap();
            assert!((change - 0.02).abs() < room, "{} joint {}: {change}", estimator.as_str(), j + 1);
        }
        assert!(all.statistical.iter().all(|s| s.is_some_and(|s| s > 0.0 && s < 0.1)));
        let sentence = "A force that is read 2.00 % too large makes every k 2.00 % too large and shows in no residual.";
        let finding = &all.findings[0];
        assert_eq!((finding.code.as_str(), finding.sentence.as_str()), ("force-scale", sentence), "{estimator:?}");
    }
}

/// For linear least squares the profile is the t interval.
#[test]
fn the_profile_of_least_squares_is_the_t_interval() {
    let mut cell = default_cell();
    cell.noise.posture_common_std = 2.0 * cell.noise.displacement_std();
    for (seed, postures) in [(1, numbered(group1())), (2, plan(&default_cell()))] {
        let measured = measure(&cell, &postures, seed);
        for estimator in [Estimator::Ordinary, Estimator::Weighted] {
            for noise in [NoiseSource::Estimated, NoiseSource::Known] {
                let options = with(|o: &mut IdentifyOptions| {
                    o.estimator = estimator;
                    o.noise = noise;
                });
                let likelihood = profile(&Fit::new(&cell, &measured, &options).unwrap()).unwrap().unwrap();
                let difference = likelihood.difference.unwrap();
                assert!(difference < 1e-8, "{} {noise:?}: {difference}", estimator.as_str());
                assert!(likelihood.joints.iter().all(|j| j.interval[1].is_some()));
                assert_eq!(likelihood.finding.code, "profile-agrees");
            }
        }
    }
}

/// With γ held at its estimate the level of the profile gives the main
/// interval, so what differs is what the estimate of γ does. The ends fulfil
/// the equation of the module's head, here from scratch: −2 ln L by dense
/// matrices and a fine search over γ.
#[test]
fn the_profile_of_two_variances_ends_at_its_level() {
    let mut cell = default_cell();
    cell.noise.posture_common_std = 2.0 * cell.noise.displacement_std();
    let options = IdentifyOptions::default();
    let mut largest = 0.0_f64;
    for seed in 0..5 {
        let measured = measure(&cell, &plan(&default_cell()), 100 + seed);
        let likelihood = profile(&Fit::new(&cell, &measured, &options).unwrap()).unwrap().unwrap();
        largest = largest.max(likelihood.difference.unwrap());
        let system = measured_system(&cell, &measured, &[], Weights::Readings).unwrap();
        assert_eq!(options.noise, NoiseSource::Estimated);
        let (rows, n) = system.psi.shape();
        let free = (rows - n) as f64;
        let t = {
            let joint = &identify(&cell, &measured, &options).unwrap().estimates.joints[0];
            let low = 1.0 / joint.interval[0].unwrap();
            (low - joint.compliance.unwrap()) / joint.compliance_standard_error.unwrap()
        };
        let level = (free + 1.0) * (t * t / free).ln_1p();
        let j = 3;
        let others = system.psi.clone().remove_column(j);
        let minus_two_ln = |h: f64, gamma: f64| {
            let y = &system.delta - system.psi.column(j) * h;
            let mut v = DMatrix::<f64>::identity(rows, rows);
            for block in &system.blocks {
                for a in block.rows.clone() {
                    for b in block.rows.clone() {
                        if a % 3 == b % 3 {
                            v[(a, b)] += gamma;
                        }
                    }
                }
            }
            let v = v.cholesky().unwrap();
            let scale = DVector::from_iterator(n - 1, others.column_iter().map(|c| c.norm()));
            let mut x = others.clone();
            for (i, s) in scale.iter().enumerate() {
                x.column_mut(i).scale_mut(1.0 / s);
            }
            let information = x.tr_mul(&v.solve(&x)).cholesky().unwrap();
            let beta = information.solve(&x.tr_mul(&v.solve(&y)));
            let e = &y - &x * beta;
            let rest = e.dot(&v.solve(&e));
            (free + 1.0) * rest.ln() + v.determinant().ln() + information.determinant().ln()
        };
        let best = |h: f64| {
            let mut best = (f64::INFINITY, 0.0);
            let grid = (-60..=60).map(|i| (f64::from(i) * 0.1).exp()).chain([0.0]);
            for gamma in grid {
                let value = minus_two_ln(h, gamma);
                if value < best.0 {
                    best = (value, gamma);
                }
            }
            // A parabola's worth of refinement about the best of the grid.
            for step in [0.03, 0.01, 0.003, 0.001] {
                for k in -5..=5 {
                    let gamma = best.1 * (f64::from(k) * step).exp();
                    let value = minus_two_ln(h, gamma);
                    if value < best.0 {
                        best = (value, gamma);
                    }
                }
            }
            best.0
        };
        let ends = likelihood.joints[j].compliance_interval.map(Option::unwrap);
        let centre = identify(&cell, &measured, &options).unwrap().estimates.joints[j].compliance.unwrap();
        let lowest =
            (-20..=20).map(|i| best(centre + f64::from(i) * 0.01 * (ends[1] - ends[0]))).fold(f64::INFINITY, f64::min);
        for end in ends {
            let reached = best(end) - lowest;
            assert!((reached / level - 1.0).abs() < 2e-3, "{reached} for {level}");
        }
    }
    // 6 postures leave 12 degrees of freedom for γ.
    assert!(largest > 1e-4 && largest < 0.1, "{largest}");
    println!("largest difference of two-variance profiles: {largest}");
    for estimator in [Estimator::Huber, Estimator::NonNegative, Estimator::Prior] {
        let options = by(estimator);
        let measured = measure(&cell, &numbered(group1()), 1);
        assert_eq!(profile(&Fit::new(&cell, &measured, &options).unwrap()).unwrap(), None);
    }
}

/// Open, absent and degenerate cases answer instead of failing.
#[test]
fn budgets_and_profiles_of_poor_data() {
    let cell = default_cell();
    // One posture: three joints' worth of rows at each of four points, but a
    // single load.
    let measured = measure(&cell, &numbered(group1())[..1], 1);
    let options = by(Estimator::Ordinary);
    let result = identify(&cell, &measured, &options).unwrap();
    let all = systematic(&cell, &measured, &options);
    for (j, joint) in result.estimates.joints.iter().enumerate() {
        let has_value = joint.compliance.is_some_and(|h| h > 0.0);
        assert_eq!(all.statistical[j].is_some(), has_value && result.estimates.degrees_of_freedom > 0);
        assert!(has_value || all.sources.iter().all(|s| s.change[j].is_none()));
    }
    profile(&Fit::new(&cell, &measured, &options).unwrap()).unwrap();
    // Without noise the residuals are rounding: no profile to speak of.
    let quiet = quiet_cell();
    let exact = measure(&quiet, &numbered(group1()), 1);
    let likelihood = profile(&Fit::new(&quiet, &exact, &IdentifyOptions::default()).unwrap()).unwrap().unwrap();
    assert!(likelihood.joints.iter().all(|j| j.difference.is_none_or(|d| d < 1e-6)));
    // A large lost motion leaves no stiffness at all.
    let mut loose = cell.clone();
    loose.uncertainty.lost_motion = Some(1.0);
    let all = systematic_errors(&Fit::new(&loose, measure(&cell, &numbered(group1()), 1), &options).unwrap()).unwrap();
    assert!(all.findings.iter().all(|f| !f.sentence.contains("NaN")));
}
