//! What must hold for every robot, tool, load and posture.

use crate::common::model::{Model, cross, inverse_gram_diagonal};
use crate::common::prelude::*;
use num_dual::Dual64;
use proptest::prelude::*;
use stiffarm::estimate::validate::Model as Deflection;
use stiffarm::internals::information::posture_information;
use stiffarm::model::stiffness::{cartesian_compliance, cartesian_stiffness, rope_correction};
use stiffarm::plan::index::error_bound;

/// A random model with as many joints as asked, any load, any springs.
fn models(joints: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = (Model, Dice)> {
    (joints, 0..5_usize, any::<bool>(), any::<bool>(), any::<u64>()).prop_map(|(n, kind, elastic, common, seed)| {
        let mut dice = Dice::new(seed);
        let model = dice.model(n, kind, elastic, common);
        (model, dice)
    })
}

/// Condition number of the column-scaled Ψ; infinite where it loses rank.
fn condition(psi: &DMatrix<f64>) -> f64 {
    Factor::new(psi).unwrap().scaled_condition().unwrap_or(f64::INFINITY)
}

/// K_θ⁻¹ = E⁻¹ diag(1/k) E⁻ᵀ of a model.
fn joint_compliance_of(model: &Model) -> DMatrix<f64> {
    let h = DVector::from_iterator(model.prior.len(), model.prior.iter().map(|k| 1.0 / k));
    let diagonal = DMatrix::from_diagonal(&h);
    match &model.elastic {
        Some(e) => {
            let inverse = e.clone().try_inverse().unwrap();
            &inverse * diagonal * inverse.transpose()
        }
        None => diagonal,
    }
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn exact_displacements_give_the_stiffness_back((model, mut dice) in models(4..=7), count in 3..7_usize) {
        let mut cell = model.cell();
        cell.noise.reading_variance = 0.0;
        cell.noise.posture_common_std = 0.0;
        // What a sensor gives way by is known, and none of the joints' doing.
        if dice.chance(0.5) {
            let origin = dice.vector(0.3);
            let sensor = SeriesCompliance::from_stiffness(origin, [3e7; 3], [5e6, 7e6, 9e6]).unwrap();
            cell.setup.tool.series_compliance = Some(sensor);
        }
        let postures = numbered(dice.postures(model.joint_count(), count));
        let exact = simulate_measurements(&cell, &postures, &model.prior, Deflection::Linear, 1, 0).unwrap();
        let result = identify(&cell, &exact, &IdentifyOptions::default()).unwrap();
        // A joint that the load passes by is a finding, not a property of the solver.
        prop_assume!(result.estimates.undetermined_joints.is_empty());
        let bound = (1000.0 * f64::EPSILON * result.estimates.scaled_condition.unwrap()).max(1e-12);
        let psi = model.stacked(&postures.iter().map(|p| p.q.clone()).collect::<Vec<_>>());
        // What each joint contributes to the displacements; rounding is relative to their sum.
        let share: Vec<f64> = psi.column_iter().zip(&model.prior).map(|(c, k)| c.norm() / k).collect();
        let whole = share.iter().map(|s| s * s).sum::<f64>().sqrt();
        for ((joint, k), share) in result.estimates.joints.iter().zip(&model.prior).zip(&share) {
            let error = (joint.stiffness.unwrap() / k - 1.0).abs();
            let allowed = bound * (0.1 * whole / share).max(1.0);
            prop_assert!(error <= allowed, "{}: off by {error:e}, allowed {allowed:e}", joint.name);
        }
        prop_assert!(result.estimates.is_complete());
    }

    #[test]
    fn observation_matrix_takes_compliance_to_displacement((model, mut dice) in models(4..=7)) {
        let n = model.joint_count();
        let cell = model.cell();
        let q = dice.posture(n);
        let h = DVector::from_iterator(n, model.prior.iter().map(|k| 1.0 / k));
        let psi = observation_matrix(&cell.setup, std::slice::from_ref(&q), Rows::Translations).unwrap();
        let plain = model.psi(&q);
        prop_assert!(relative_error(psi.as_slice(), plain.as_slice()) < 1e-12);
        let by_psi = psi * h;
        let measured = MeasuredPosture::new(numbered([q]).remove(0), Vec::new());
        let direct = calculated_displacements(&cell, &measured, &model.prior, Deflection::Linear).unwrap();
        let direct: Vec<f64> = direct.iter().flat_map(|v| v.iter().copied()).collect();
        prop_assert!(relative_error(by_psi.as_slice(), &direct) < 1e-11);
    }

    #[test]
    fn cartesian_stiffness_is_symmetric_and_inverts_the_compliance((model, mut dice) in models(6..=7)) {
        let n = model.joint_count();
        let robot = model.cell().setup.robot;
        let q = dice.posture(n);
        let frames = Frames::new(&robot, &q);
        let p = frames.point(&dice.vector(0.4));
        let chain = model.chain(&q);
        let jacobian = DMatrix::from_fn(6, n, |i, j| match i {
            0..3 => chain.column(j, p.into())[i],
            _ => chain.axes[j][i - 3],
        });
        let theta_compliance = joint_compliance_of(&model);
        let ours = joint_compliance(&robot, &model.prior).unwrap();
        prop_assert!(relative_error(ours.as_slice(), theta_compliance.as_slice()) < 1e-13);
        let compliance = &jacobian * &theta_compliance * jacobian.transpose();
        let spread = compliance.symmetric_eigenvalues();
        let condition = spread.max() / spread.min();
        prop_assume!(condition < 1e10);
        let tolerance = 1e-14 * condition + 1e-12;
        let by_library = cartesian_compliance(&robot, &frames, &p, &model.prior, None).unwrap();
        prop_assert!(relative_error(by_library.as_slice(), compliance.as_slice()) < 1e-12);
        let stiffness = cartesian_stiffness(&robot, &frames, &p, &model.prior, None).unwrap().unwrap();
        prop_assert!((stiffness - stiffness.transpose()).amax() < tolerance * stiffness.amax());
        let product = &compliance * stiffness;
        prop_assert!((product - Matrix6::identity()).amax() < tolerance * condition.sqrt());

        // For six joints Eq. (2) itself, and Chen and Kao's correction in it.
        if n == 6 {
            let correction = dice.vector(1.0).norm() * 1e3 * DMatrix::<f64>::from_fn(6, 6, |i, j| {
                ((3 * i + 5 * j) as f64).sin()
            });
            let inverse = jacobian.clone().try_inverse().unwrap();
            let theta_stiffness = theta_compliance.try_inverse().unwrap();
            for (correction, k) in [(None, theta_stiffness.clone()), (Some(&correction), theta_stiffness - &correction)] {
                let by_formula = inverse.transpose() * k * &inverse;
                let ours = cartesian_stiffness(&robot, &frames, &p, &model.prior, correction).unwrap().unwrap();
                prop_assert!(relative_error(ours.as_slice(), by_formula.as_slice()) < tolerance * condition.sqrt());
            }
        }
    }

    #[test]
    fn stiffness_corrections_are_derivatives_of_the_torque((model, mut dice) in models(4..=7)) {
        let n = model.joint_count();
        let setup = model.cell().setup;
        let q = dice.posture(n);
        let terms = PostureTerms::new(&setup, &q, None).unwrap();
        let fixed = |v: Vector3<f64>| [Dual64::from(v.x), Dual64::from(v.y), Dual64::from(v.z)];
        let (mut constant, mut turning) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
        for j in 0..n {
            let mut theta: Vec<Dual64> = model.serial(&q).into_iter().map(Dual64::from).collect();
            theta[j].eps = 1.0;
            let chain = model.chain_serial(&theta);
            let wrench = terms.wrench();
            let held = model.torque(&chain, (fixed(wrench.force), fixed(wrench.moment)));
            let led = model.torque(&chain, model.wrench(&chain));
            for i in 0..n {
                constant[(i, j)] = held[i].eps;
                turning[(i, j)] = led[i].eps;
            }
        }
        let ours = stiffness_correction(&terms);
        prop_assert!(relative_error(ours.as_slice(), constant.as_slice()) < 1e-11);
        let rope = rope_correction(&setup.load, &terms);
        match &setup.load {
            Load::Rope { .. } => {
                let both = ours + rope;
                prop_assert!(relative_error(both.as_slice(), turning.as_slice()) < 1e-11);
            }
            _ => prop_assert_eq!(rope.amax(), 0.0),
        }
    }

    #[test]
    fn exact_equilibrium_tends_to_the_linear_model((model, mut dice) in models(4..=7)) {
        let q = dice.posture(model.joint_count());
        let point = dice.vector(0.4);
        // The difference is of second order in the load: half the load, a quarter of it.
        let difference = |share: f64| -> f64 {
            let mut setup = model.cell().setup;
            match &mut setup.load {
                Load::Rope { magnitude, .. } | Load::Weight { magnitude, .. } => *magnitude *= share,
                Load::Constant { wrench, .. } => {
                    wrench.force *= share;
                    wrench.moment *= share;
                }
                Load::Measured | Load::Cases(_) => {}
            }
            let terms = PostureTerms::new(&setup, &q, None).unwrap();
            let p = terms.frames().point(&point);
            let linear = linear_displacement(&setup, &terms, &p, &model.prior, None).unwrap();
            let exact = equilibrium_displacement(&setup, &q, &point, &model.prior, None).unwrap();
            (exact - linear).norm()
        };
        let (whole, half) = (difference(0.02), difference(0.01));
        prop_assume!(whole > 1e-12);
        prop_assert!((whole / half - 4.0).abs() < 0.2, "{whole:e} {half:e}");
    }

    #[test]
    fn equilibrium_balances_torque_and_springs((model, mut dice) in models(4..=7)) {
        let q = dice.posture(model.joint_count());
        let setup = model.cell().setup;
        let rest = equilibrium(&setup, &q, &model.prior, None).unwrap();
        // Γ at the loaded posture, by the plain model.
        let loaded: Vec<f64> = model.serial(&q).iter().zip(rest.deflection.iter()).map(|(a, b)| a + b).collect();
        let chain = model.chain_serial(&loaded);
        let torque = DVector::from_vec(model.torque(&chain, model.wrench(&chain)));
        let balance = joint_compliance_of(&model) * torque;
        prop_assert!((balance - &rest.deflection).amax() < 1e-14);
        // The same wrench given as measured leads to the same place only if it stays as it is.
        let held = equilibrium(&setup, &q, &model.prior, Some(rest.wrench())).unwrap();
        prop_assert!((held.deflection - rest.deflection).amax() < 1e-12);
    }

    #[test]
    fn a_wrench_moved_away_and_back_is_the_same_and_loads_joints_alike((model, mut dice) in models(4..=7)) {
        let mut setup = model.cell().setup;
        let robot = setup.robot.clone();
        let q = dice.posture(model.joint_count());
        let terms = PostureTerms::new(&setup, &q, None).unwrap();
        let frames = terms.frames();
        let (here, in_flange) = (*terms.loading_point(), dice.vector(1.0));
        let there = frames.point(&in_flange);
        let wrench = Wrench { force: dice.vector(800.0), moment: dice.vector(300.0) };
        let moved = wrench.moved(&here, &there);
        let back = moved.moved(&there, &here);
        prop_assert!((back.moment - wrench.moment).amax() < 1e-11 && back.force == wrench.force);
        // M' = M + (from − to) × F, written out.
        let arm: [f64; 3] = (here - there).into();
        let extra = cross(arm, wrench.force.into());
        prop_assert!((moved.moment - wrench.moment - Vector3::from(extra)).amax() < 1e-11);

        let at_first = PostureTerms::new(&setup, &q, Some(&wrench)).unwrap();
        setup.tool.loading_point = in_flange;
        let at_second = PostureTerms::new(&setup, &q, Some(&moved)).unwrap();
        prop_assert!(relative_error(at_second.torque(), at_first.torque()) < 1e-11);
        let (a, b) = (at_first.block(&robot), at_second.block(&robot));
        prop_assert!(relative_error(b.as_slice(), a.as_slice()) < 1e-11);
    }

    #[test]
    fn information_adds_up_over_postures((model, mut dice) in models(4..=7), count in 1..6_usize) {
        let n = model.joint_count();
        let cell = model.cell();
        let points = model.measuring_points.len();
        let postures = dice.postures(n, count);
        let weight = cell.noise.common_weight(points);
        let sum = postures.iter().fold(DMatrix::zeros(n, n), |sum, q| {
            let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
            sum + posture_information(&terms.block(&cell.setup.robot), weight)
        });
        // Σ⁻¹ by inverting the covariance of everything.
        let psi = model.stacked(&postures);
        let covariance = full_covariance(&model, count) / model.sigma.powi(2);
        let whole = psi.transpose() * covariance.cholesky().unwrap().solve(&psi);
        prop_assert!(relative_error(sum.as_slice(), whole.as_slice()) < 1e-11);
    }

    #[test]
    fn indices_ignore_the_order_of_postures_and_the_place_of_the_cell((model, mut dice) in models(4..=7)) {
        let cell = model.cell();
        let n = model.joint_count();
        let mut postures = dice.postures(n, 5);
        let psi = model.stacked(&postures);
        prop_assume!(condition(&psi) < 1e5);
        let before = evaluate(&cell, "", &postures).unwrap();
        postures.rotate_left(1 + dice.below(4));
        let turned = evaluate(&cell, "", &postures).unwrap();
        postures.swap(0, 3);
        let swapped = evaluate(&cell, "", &postures).unwrap();

        // Robot, rope and gravity carried to another place together.
        let pose = dice.pose();
        let mut moved = cell.clone();
        moved.setup.robot = moved.setup.robot.with_base(&pose);
        match &mut moved.setup.load {
            Load::Rope { anchor, .. } => *anchor = (pose * nalgebra::Point3::from(*anchor)).coords,
            Load::Weight { direction, .. } => *direction = pose.rotation * *direction,
            Load::Constant { wrench, axes: Axes::Base } => {
                *wrench = Wrench {
                    force: pose.rotation * wrench.force,
                    moment: pose.rotation * wrench.moment,
                };
            }
            _ => {}
        }
        for task in &mut moved.tasks {
            if task.axes == Axes::Base {
                task.wrench = Wrench {
                    force: pose.rotation * task.wrench.force,
                    moment: pose.rotation * task.wrench.moment,
                };
            }
        }
        let moved = evaluate(&moved, "", &postures).unwrap();
        for (what, after) in [("turned", turned), ("swapped", swapped), ("moved", moved)] {
            for index in Index::ALL {
                // The base's spring stands where the base frame does.
                if what == "moved" && index == Index::Prediction {
                    continue;
                }
                match (before.indices.get(index), after.indices.get(index)) {
                    (Some(a), Some(b)) => prop_assert!((a / b - 1.0).abs() < 1e-9, "{what} {index:?}: {a} {b}"),
                    (a, b) => prop_assert_eq!(a, b),
                }
            }
        }
    }

    #[test]
    fn identification_is_generalised_least_squares_for_any_choice_of_points(
        (model, mut dice) in models(4..=7),
        count in 4..7_usize,
    ) {
        let n = model.joint_count();
        let cell = model.cell();
        let postures = numbered(dice.postures(n, count));
        let mut measured = simulate_measurements(&cell, &postures, &model.prior, Deflection::Linear, 7, 3).unwrap();
        // Points go missing here and are read twice there.
        for posture in &mut measured {
            if dice.chance(0.5) {
                posture.displacements.remove(0);
            } else {
                let again = posture.displacements[0].clone();
                posture.displacements.push(again);
            }
        }
        let system = measured_system(&cell, &measured, &[], Weights::Readings).unwrap();
        prop_assume!(condition(&system.psi) < 1e5);
        let rows = system.psi.nrows();
        let posture_of = |row: usize| system.blocks.iter().position(|b| b.rows.contains(&row));
        let covariance = DMatrix::from_fn(rows, rows, |i, j| {
            let variance = if i == j { model.sigma.powi(2) } else { 0.0 };
            let common = i % 3 == j % 3 && posture_of(i) == posture_of(j);
            variance + if common { model.tau.powi(2) } else { 0.0 }
        });
        let lower = covariance.cholesky().unwrap().unpack();
        let psi = lower.solve_lower_triangular(&system.psi).unwrap();
        let delta = lower.solve_lower_triangular(&system.delta).unwrap();
        let qr = psi.clone().qr();
        let best = qr.r().solve_upper_triangular(&qr.q().tr_mul(&delta)).unwrap();
        let errors = inverse_gram_diagonal(&psi);
        let options = with(|o: &mut IdentifyOptions| o.noise = NoiseSource::Known);
        let ours = identify(&cell, &measured, &options).unwrap();
        for (j, joint) in ours.estimates.joints.iter().enumerate() {
            let error = errors[j].sqrt();
            prop_assert!((joint.compliance.unwrap() - best[j]).abs() < 1e-6 * error + 1e-12 * best.amax());
            prop_assert!((joint.compliance_standard_error.unwrap() / error - 1.0).abs() < 1e-9);
        }
        // s² is the whitened residual's, in units of the cell's σ².
        let residual = (delta - psi * best).norm_squared() / (rows - n) as f64;
        let ours = (ours.residual_std_m.unwrap() / model.sigma).powi(2);
        prop_assert!((ours / residual - 1.0).abs() < 1e-8);
    }

    #[test]
    fn series_compliance_is_six_springs_at_its_origin((model, mut dice) in models(6..=6)) {
        let mut cell = model.cell();
        let translational = [dice.between(1e6, 1e8), dice.between(1e6, 1e8), dice.between(1e6, 1e8)];
        let rotational = [dice.between(1e5, 1e7), dice.between(1e5, 1e7), dice.between(1e5, 1e7)];
        let origin = dice.vector(0.3);
        cell.setup.tool.series_compliance =
            Some(SeriesCompliance::from_stiffness(origin, translational, rotational).unwrap());
        let q = dice.posture(6);
        let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
        let ours = terms.known_displacement(&cell.setup.tool);
        // Each spring bends by (its column at the loading point)ᵀ W / k.
        let (frames, wrench) = (terms.frames(), terms.wrench());
        let at = frames.point(&origin);
        let mut expected = DVector::zeros(ours.len());
        for axis in 0..3 {
            let direction = frames.direction(&Vector3::ith(axis, 1.0));
            let pushed = direction * (direction.dot(&wrench.force) / translational[axis]);
            let column = |p: &Vector3<f64>| direction.cross(&(p - at));
            let torque = column(terms.loading_point()).dot(&wrench.force) + direction.dot(&wrench.moment);
            for (a, p) in terms.measuring_points().iter().enumerate() {
                let mut rows = expected.fixed_rows_mut::<3>(3 * a);
                rows += pushed + column(p) * (torque / rotational[axis]);
            }
        }
        prop_assert!(relative_error(ours.as_slice(), expected.as_slice()) < 1e-11);
    }

    #[test]
    fn error_bound_of_eq_19_holds(seed in any::<u64>(), n in 2..7_usize) {
        let mut dice = Dice::new(seed);
        let psi = DMatrix::from_fn(3 * n, n, |_, j| dice.between(-1.0, 1.0) * 3f64.powi(j as i32));
        let h = DVector::from_fn(n, |_, _| dice.between(0.1, 1.0));
        let omega = psi.tr_mul(&psi);
        let lambda = &omega * &h;
        let spread = omega.symmetric_eigenvalues();
        let psi_condition = (spread.max() / spread.min()).sqrt();
        // Perturbations of sizes around the bound's own limit.
        let size = 10f64.powf(dice.between(-3.0, 0.5)) / psi_condition.powi(2);
        let mut shake = DMatrix::from_fn(n, n, |_, _| dice.between(-1.0, 1.0));
        shake *= size * omega.norm() / shake.norm();
        let push = DVector::from_fn(n, |_, _| dice.between(-1.0, 1.0)) * (size * lambda.norm());
        let norm = |m: &DMatrix<f64>| m.tr_mul(m).symmetric_eigenvalues().max().sqrt();
        let relative_omega = norm(&shake) / norm(&omega);
        let bound = error_bound(psi_condition, relative_omega, push.norm() / lambda.norm()).unwrap();
        prop_assert!((bound.condition_omega / psi_condition.powi(2) - 1.0).abs() < 1e-12);
        prop_assert_eq!(bound.bound.is_some(), bound.validity < 1.0);
        if let Some(limit) = bound.bound {
            let disturbed = (omega + shake).lu().solve(&(lambda + push)).unwrap();
            let error = (disturbed - &h).norm() / h.norm();
            prop_assert!(error <= limit * (1.0 + 1e-9), "{error} above {limit}");
        }
    }
}

/// Covariance of all displacements: postures independent of each other.
fn full_covariance(model: &Model, postures: usize) -> DMatrix<f64> {
    let one = model.posture_covariance();
    let rows = one.nrows();
    DMatrix::from_fn(rows * postures, rows * postures, |i, j| {
        if i / rows == j / rows { one[(i % rows, j % rows)] } else { 0.0 }
    })
}
