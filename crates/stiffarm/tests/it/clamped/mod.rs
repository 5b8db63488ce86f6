//! A clamped end-effector gives the same stiffness as a free one.

mod errors;
mod noise;
mod tables;

use crate::common::prelude::*;
use proptest::prelude::*;
use statrs::distribution::{Binomial, DiscreteCDF};
use stiffarm::estimate::clamped::{ClampedPosture, ClampedSimulation, MotorMove, identify_clamped, simulate_clamped};
use stiffarm::internals::clamped_system;
use stiffarm::model::stiffness::displacement_between;
use stiffarm_files::table::{read_clamped, write_clamped};

const FALSE_ALARM: f64 = 1e-6;

/// A seven-joint Panda with Franka's rows, loaded at the flange.
fn panda() -> Cell {
    let mut cell = reference_cell();
    cell.setup.robot = common::set_ups::panda();
    cell.prior = Some(vec![1.4e4, 2e4, 1.2e4, 1.1e4, 9e3, 8e3, 7e3]);
    cell
}

/// Postures whose Jacobian at the clamp is far from singular, so that exact
/// data keep their digits.
fn postures(cell: &Cell, dice: &mut Dice, count: usize) -> Vec<Posture> {
    let robot = &cell.setup.robot;
    let n = robot.joint_count();
    let mut out = Vec::new();
    while out.len() < count {
        let q = dice.posture(n);
        let frames = Frames::new(robot, &q);
        let jacobian = frames.jacobian(&frames.point(&cell.setup.tool.loading_point));
        let dense = DMatrix::from_iterator(6, n, jacobian.iter().copied());
        let gram = match n {
            n if n < 6 => dense.transpose() * &dense,
            _ => &dense * dense.transpose(),
        };
        let eigen = gram.symmetric_eigenvalues();
        if eigen.min() > 3e-3 * eigen.max() {
            let name = (out.len() + 1).to_string();
            out.push(Posture { name, q });
        }
    }
    out
}

/// Moves that put about `torque` N·m on each joint.
fn moves(cell: &Cell, dice: &mut Dice, count: usize, torque: f64) -> Vec<MotorMove> {
    let prior = cell.require_prior().unwrap();
    (0..count)
        .map(|i| MotorMove {
            state: format!("loaded-{}", i + 1),
            motor: prior.iter().map(|k| dice.signed(0.5, 1.0) * torque / k).collect(),
        })
        .collect()
}

fn exact(cell: &Cell, seed: u64, count: usize, states: usize) -> Vec<ClampedPosture> {
    let mut dice = Dice::new(seed);
    let postures = postures(cell, &mut dice, count);
    let moves = moves(cell, &mut dice, states, 300.0);
    simulated(cell, &postures, moves, 0.0, 1)
}

/// What the joints hold under `moves`, with this noise of the angles.
fn simulated(
    cell: &Cell,
    postures: &[Posture],
    moves: Vec<MotorMove>,
    angle_std: f64,
    seed: u64,
) -> Vec<ClampedPosture> {
    let simulation = ClampedSimulation { moves, angle_std, ..ClampedSimulation::default() };
    let truth = cell.require_prior().unwrap();
    simulate_clamped(cell, postures, truth, &simulation, seed, 0).unwrap()
}

fn stiffness(cell: &Cell, clamped: &[ClampedPosture]) -> Vec<f64> {
    let result = identify_clamped(cell, clamped, None, &IdentifyOptions::default()).unwrap();
    result.estimates.stiffness().unwrap()
}

fn assert_close(estimate: &[f64], truth: &[f64], tolerance: f64, what: &str) {
    for (k, t) in estimate.iter().zip(truth) {
        assert!((k / t - 1.0).abs() < tolerance, "{what}: {estimate:?}, not {truth:?}");
    }
}

fn free_end(cell: &Cell, seed: u64) -> Vec<f64> {
    let mut cell = cell.clone();
    cell.noise.reading_variance = 0.0;
    cell.noise.posture_common_std = 0.0;
    let postures = postures(&cell, &mut Dice::new(seed), 12);
    let truth = cell.require_prior().unwrap();
    let measured = simulate_measurements(&cell, &postures, truth, Model::Linear, 1, 0).unwrap();
    let result = identify(&cell, &measured, &IdentifyOptions::default()).unwrap();
    result.estimates.stiffness().unwrap()
}

#[test]
fn clamped_and_free_end_data_give_the_same_stiffness() {
    // The coupled COMAU and a redundant arm.
    for (cell, what) in [(reference_cell(), "COMAU"), (panda(), "Panda")] {
        let truth = cell.require_prior().unwrap();
        let clamped = stiffness(&cell, &exact(&cell, 5, 4, 2));
        assert_close(&clamped, truth, 1e-9, what);
        assert_close(&clamped, &free_end(&cell, 6), 1e-9, what);
    }
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn random_arms_give_the_same_stiffness(n in 3..=8usize, elastic in any::<bool>(), seed in any::<u64>()) {
        let cell = Dice::new(seed).model(n, 0, elastic, false).cell();
        let truth = cell.require_prior().unwrap();
        let clamped = exact(&cell, seed, 6, 2);
        assert_close(&stiffness(&cell, &clamped), truth, 1e-7, "clamped");
        let system = clamped_system(&cell, &clamped, &[]).unwrap();
        prop_assert_eq!(system.psi.nrows(), clamped.len() * n.min(6));
    }

    #[test]
    fn for_six_joints_it_decouples(seed in any::<u64>()) {
        // C Δq_m = −K_θ⁻¹ Γ, joint by joint.
        let cell = Dice::new(seed).model(6, 0, false, false).cell();
        let truth = cell.require_prior().unwrap();
        for clamped in exact(&cell, seed, 2, 2) {
            let terms = PostureTerms::new(&cell.setup, &clamped.posture.q, Some(&clamped.wrench)).unwrap();
            let turned = cell.setup.robot.coupling() * DVector::from_column_slice(&clamped.motor);
            for (j, torque) in terms.torque().iter().enumerate() {
                let error = (turned[j] + torque / truth[j]).abs();
                prop_assert!(error < 1e-9 * turned.amax(), "joint {}: {error}", j + 1);
            }
        }
    }
}

#[test]
fn the_simulated_flange_stays_where_it_is() {
    // Forward kinematics of the moved motors, and the free end's deflection under
    // the fixture's wrench, cancel: other code than that of the clamped rows.
    for cell in [reference_cell(), panda()] {
        let truth = cell.require_prior().unwrap();
        let mut dice = Dice::new(8);
        let postures = postures(&cell, &mut dice, 3);
        // Small, so that the second order does not show.
        let moves = moves(&cell, &mut dice, 2, 1e-3);
        for c in simulated(&cell, &postures, moves, 0.0, 1) {
            let robot = &cell.setup.robot;
            let moved: Vec<f64> = c.posture.q.iter().zip(&c.motor).map(|(q, d)| q + d).collect();
            let (before, after) = (Frames::new(robot, &c.posture.q), Frames::new(robot, &moved));
            let point = &cell.setup.tool.loading_point;
            let by_motors = displacement_between(&before, &after, point);
            let terms = PostureTerms::new(&cell.setup, &c.posture.q, Some(&c.wrench)).unwrap();
            let by_springs = linear_displacement(&cell.setup, &terms, terms.loading_point(), truth, None).unwrap();
            let gap = (by_motors + by_springs).norm();
            assert!(gap < 1e-5 * by_motors.norm(), "{gap:e} of {:e}", by_motors.norm());
        }
    }
}

#[test]
fn a_posture_at_a_singularity_gives_what_the_flange_holds() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap().to_vec();
    let mut postures = postures(&cell, &mut Dice::new(31), 3);
    // Axes 4 and 6 in line.
    postures[1].q = [10.0, 5.0, -95.0, 20.0, 0.0, 30.0_f64].map(f64::to_radians).to_vec();
    let moves = moves(&cell, &mut Dice::new(32), 2, 300.0);
    let data = simulated(&cell, &postures, moves, 0.0, 1);
    let result = identify_clamped(&cell, &data, None, &IdentifyOptions::default()).unwrap();
    assert_eq!(result.estimates.rows, 2 * (6 + 5 + 6));
    assert_close(&result.estimates.stiffness().unwrap(), &truth, 1e-9, "singular");
    let finding = the(&result.findings, "near-singular");
    assert_eq!(finding.subject, "2");
    // Alone it separates neither joint 4 nor joint 6 … but tells what it can.
    let alone: Vec<ClampedPosture> = data.into_iter().filter(|c| c.posture.name == "2").collect();
    let result = identify_clamped(&cell, &alone, None, &IdentifyOptions::default()).unwrap();
    assert_eq!(result.estimates.rows, 10);
}

#[test]
fn what_moves_along_the_null_space_says_nothing() {
    let cell = panda();
    let mut data = exact(&cell, 41, 4, 2);
    let before = stiffness(&cell, &data);
    for c in &mut data {
        let frames = Frames::new(&cell.setup.robot, &c.posture.q);
        let jacobian = frames.jacobian(&frames.point(&cell.setup.tool.loading_point));
        // The null vector of J: the eigenvector of JᵀJ with the smallest eigenvalue.
        let gram = jacobian.transpose() * &jacobian;
        let eigen = nalgebra::SymmetricEigen::new(DMatrix::from_iterator(7, 7, gram.iter().copied()));
        let null = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
        for (q, v) in c.motor.iter_mut().zip(null.iter()) {
            *q += 1e-2 * v;
        }
    }
    assert_close(&stiffness(&cell, &data), &before, 1e-6, "null space");
}

#[test]
fn a_tilting_joint_and_lost_motion_are_further_terms() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    let n = truth.len();
    for (term, size) in [(ExtraTerm::JointTilt(2), 3e-7), (ExtraTerm::BaseTilt, 2e-8), (ExtraTerm::LostMotion(1), 2e-5)]
    {
        let mut data = exact(&cell, 51, 6, 2);
        for c in &mut data {
            let terms = PostureTerms::new(&cell.setup, &c.posture.q, Some(&c.wrench)).unwrap();
            let jacobian = terms.frames().jacobian(terms.loading_point()) * cell.setup.robot.coupling();
            let square = DMatrix::from_iterator(6, n, jacobian.iter().copied());
            let twist = term.twist(&terms, terms.loading_point()) * size;
            // The motors have to make up for the term as well.
            let more = square.lu().solve(&DVector::from_iterator(6, twist.iter().copied())).unwrap();
            for (q, m) in c.motor.iter_mut().zip(more.iter()) {
                *q -= m;
            }
        }
        let options = with(|o: &mut IdentifyOptions| o.extra = vec![term]);
        let result = identify_clamped(&cell, &data, None, &options).unwrap();
        assert_close(&result.estimates.stiffness().unwrap(), truth, 1e-8, "with the term");
        let estimate = if term.is_spring() {
            result.estimates.extra_springs[0].compliance
        } else {
            result.estimates.lost_motion[0].angle
        };
        assert!((estimate.unwrap() / size - 1.0).abs() < 1e-6, "{term:?}: {estimate:?}");
        let without = stiffness(&cell, &data);
        assert!(without.iter().zip(truth).any(|(k, t)| (k / t - 1.0).abs() > 1e-3));
    }
}

#[test]
fn a_known_series_compliance_is_not_the_joints() {
    let plain = reference_cell();
    let truth = plain.require_prior().unwrap();
    let mut cell = plain.clone();
    cell.setup.tool.series_compliance =
        Some(SeriesCompliance::from_stiffness(Vector3::new(0.0, 0.0, 0.05), [1e8, 1e8, 2e8], [3e5, 3e5, 4e5]).unwrap());
    let mut data = exact(&plain, 61, 4, 2);
    for c in &mut data {
        let terms = PostureTerms::new(&cell.setup, &c.posture.q, Some(&c.wrench)).unwrap();
        // Beyond the compliance the clamp stays; the flange moves against it.
        c.fixture_motion = Some(terms.known_twist(&cell.setup.tool, terms.loading_point()));
    }
    assert_close(&stiffness(&cell, &data), truth, 1e-9, "series compliance");
}

#[test]
fn the_load_of_the_cell_plays_no_part() {
    // The wrench comes with each state; a measured load needs no other.
    let mut cell = reference_cell();
    let data = exact(&cell, 3, 3, 2);
    let before = stiffness(&cell, &data);
    cell.setup.load = Load::Measured;
    assert_eq!(stiffness(&cell, &data), before);
}

#[test]
fn a_clamped_identification_predicts_free_deflections() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    let mut dice = Dice::new(14);
    let moves = moves(&cell, &mut dice, 2, 300.0);
    let postures = postures(&cell, &mut dice, 6);
    let data = simulated(&cell, &postures, moves, 1e-6, 4);
    let fit = identify_clamped(&cell, &data, None, &IdentifyOptions::default()).unwrap();
    // Bands take the noise of the readings from the cell: the fit saw angles only.
    let predictor = IdentifiedCompliance::from_estimates(&cell, &fit.estimates, Default::default()).unwrap();
    let spread = predictor.spread.as_ref().unwrap();
    assert_eq!(spread.sigma, cell.noise.displacement_std());
    // It is what the result seals.
    let sealed = fit.sealed.as_ref().unwrap();
    assert_eq!(sealed.predictor, predictor);
    assert_eq!(sealed.postures.len(), 6);
    assert!(sealed.largest_force_n > Some(0.0) && sealed.largest_displacement_m.is_none());
    let measured = simulate_measurements(&cell, &postures, truth, Model::Linear, 8, 0).unwrap();
    let result = validate_with(&cell, &predictor, &measured, Model::Linear, None).unwrap();
    let band = result.band.unwrap();
    let share = band.inside as f64 / band.components as f64;
    assert!(share > 0.85, "{band:?}");
}

#[test]
fn every_estimator_takes_clamped_rows() {
    let cell = reference_cell();
    let truth = cell.require_prior().unwrap();
    let mut dice = Dice::new(101);
    let moves = moves(&cell, &mut dice, 2, 300.0);
    let postures = postures(&cell, &mut dice, 6);
    let data = simulated(&cell, &postures, moves, 2e-6, 6);
    for estimator in Estimator::ALL {
        let options = by(estimator);
        let result = identify_clamped(&cell, &data, None, &options).unwrap();
        assert!(result.estimates.independent_rows);
        let estimate = result.estimates.stiffness().unwrap();
        assert_close(&estimate, truth, 0.05, estimator.as_str());
    }
}
