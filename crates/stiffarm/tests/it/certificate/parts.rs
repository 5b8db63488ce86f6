//! Criteria, weights on finitely many points, and the postures of a cell as a space are what their definitions say.

use super::*;
use crate::common::cases::refusals;
use crate::common::differences::assert_gradient;
use stiffarm::internals::design::{WeightProblem, optimal_weights};
use stiffarm::internals::{Kernel, KernelRequest};

fn information(shift: f64) -> DMatrix<f64> {
    let b = DMatrix::from_fn(5, 3, |i, j| (((i + 1) * (j + 2)) as f64 * shift).sin());
    b.tr_mul(&b)
}

#[test]
fn tangent_bounds_the_criterion_everywhere() {
    let q = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, 0.0, 3.0]));
    for criterion in [Criterion::Determinant, Criterion::Trace(q)] {
        let prepared = criterion.prepare(3).unwrap();
        let m0 = information(1.3);
        let at = prepared.at(&m0).unwrap();
        assert!((slope(&at.adjoint, &m0) / at.level - 1.0).abs() < 1e-12);
        for k in 1..40 {
            let m = information(0.37 * f64::from(k));
            if let Some(there) = prepared.at(&m) {
                let bound = at.value * at.level / slope(&at.adjoint, &m);
                assert!(there.value >= bound * (1.0 - 1e-12), "{criterion:?} {k}");
            }
        }
    }
}

#[test]
fn values_are_the_definitions() {
    let m = information(1.3);
    let q = information(0.9);
    let trace = (&q * m.clone().try_inverse().unwrap()).trace();
    let at = Criterion::Trace(q).prepare(3).unwrap().at(&m).unwrap();
    assert!((at.value / trace - 1.0).abs() < 1e-10);
    let determinant = m.determinant().powf(-1.0 / 3.0);
    let at = Criterion::Determinant.prepare(3).unwrap().at(&m).unwrap();
    assert!((at.value / determinant - 1.0).abs() < 1e-10);
}

#[test]
fn a_criterion_that_makes_no_sense_is_refused() {
    let of = |q: DMatrix<f64>| Criterion::Trace(q).prepare(2);
    let rows = [
        ("three unknowns of two", Code::Dimension, of(DMatrix::identity(3, 3))),
        ("nothing weighed", Code::InvalidValue, of(DMatrix::zeros(2, 2))),
        ("negative weights", Code::InvalidValue, of(-DMatrix::identity(2, 2))),
        ("no symmetry", Code::InvalidValue, of(DMatrix::from_row_slice(2, 2, &[1.0, 0.5, 0.0, 1.0]))),
        ("no numbers", Code::NotFinite, of(DMatrix::from_element(2, 2, f64::NAN))),
    ];
    insta::assert_snapshot!("criterion_refusals", refusals(rows));
}

fn polynomial(x: f64, degree: i32) -> DMatrix<f64> {
    let f = DVector::from_fn(degree as usize + 1, |i, _| x.powi(i as i32));
    &f * f.transpose()
}

/// Best weights on 201 points of [−1, 1] and on the known support agree.
#[test]
fn a_fine_grid_finds_the_support() {
    let points: Vec<DMatrix<f64>> = (0..=100).map(|i| polynomial(f64::from(i) / 50.0 - 1.0, 2)).collect();
    let criterion = Criterion::Determinant.prepare(3).unwrap();
    let constant = DMatrix::zeros(3, 3);
    let problem = WeightProblem { criterion: &criterion, constant: &constant, points: &points };
    let weights = optimal_weights(&problem, 1e-10).unwrap();
    for at in [0, 50, 100] {
        assert!((weights[at] - 1.0 / 3.0).abs() < 1e-8, "{}", weights[at]);
    }
    let state = problem.state(&DVector::from_vec(weights)).unwrap();
    assert!(state.slopes.max() <= 3.0 * (1.0 + 1e-9));
}

#[test]
fn hessian_is_the_derivative_of_the_slopes() {
    let points: Vec<DMatrix<f64>> = [-1.0, -0.3, 0.4, 0.9].map(|x| polynomial(x, 2)).to_vec();
    let q = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, 0.0, 2.0]));
    for criterion in [Criterion::Determinant, Criterion::Trace(q)] {
        let criterion = criterion.prepare(3).unwrap();
        let constant = DMatrix::identity(3, 3) * 0.01;
        let problem = WeightProblem { criterion: &criterion, constant: &constant, points: &points };
        let weights = DVector::from_column_slice(&[0.1, 0.2, 0.4, 0.3]);
        let state = problem.state(&weights).unwrap();
        let hessian = problem.hessian(&state.tangent);
        for j in 0..4 {
            let h = 1e-6;
            let mut moved = weights.clone();
            moved[j] += h;
            let up = problem.state(&moved).unwrap().slopes;
            moved[j] -= 2.0 * h;
            let down = problem.state(&moved).unwrap().slopes;
            let numeric = (down - up) / (2.0 * h);
            let error = (numeric - hessian.column(j)).amax();
            assert!(error < 1e-6 * hessian.amax(), "{error}");
        }
    }
}

#[test]
fn equal_points_and_a_single_point_do_no_harm() {
    let mut points = vec![polynomial(1.0, 1), polynomial(-1.0, 1)];
    points.extend(points.clone());
    let criterion = Criterion::Trace(DMatrix::identity(2, 2)).prepare(2).unwrap();
    let constant = DMatrix::zeros(2, 2);
    let problem = WeightProblem { criterion: &criterion, constant: &constant, points: &points };
    let weights = optimal_weights(&problem, 1e-10).unwrap();
    assert!((weights[0] + weights[2] - 0.5).abs() < 1e-9);
    let one = [DMatrix::identity(2, 2)];
    let problem = WeightProblem { points: &one, ..problem };
    assert_eq!(optimal_weights(&problem, 1e-10).unwrap(), [1.0]);
}

/// The default cell with a shift common to a posture's points, and springs
/// that do not sit on the joint axes.
fn cell() -> Cell {
    let mut cell = builtin::cell("comau").unwrap();
    cell.noise.posture_common_std = cell.noise.displacement_std();
    let mut elastic = DMatrix::identity(6, 6);
    elastic[(2, 1)] = 1.0;
    elastic[(5, 4)] = -0.3;
    cell.setup.robot = cell.setup.robot.with_elastic_coordinates(elastic).unwrap();
    cell
}

fn adjoint() -> DMatrix<f64> {
    let root = DMatrix::from_fn(6, 6, |i, j| ((3 * i + 5 * j) as f64).cos());
    root.tr_mul(&root)
}

/// tr(A·G(q)) and its gradient, as searches of the space climb it.
#[test]
fn the_gradient_of_a_slope_is_that_of_the_information() {
    let cell = cell();
    let space = PostureSpace::new(&cell, 8, 2).unwrap();
    let adjoint = adjoint();
    let compliance = compliance_of(cell.require_prior().unwrap());
    let weight = cell.noise.common_weight(cell.setup.tool.point_count());
    let wanted = KernelRequest { dexterity: None, information: Some((compliance.as_slice(), weight)), limits: false };
    let mut kernel = Kernel::new(&cell, wanted, 1).unwrap();
    let value = |q: &[f64]| slope(&adjoint, &space.information(q));
    for q in space.samples(8) {
        kernel.forward(&q);
        kernel.set_adjoint(None, adjoint.as_slice());
        let mut gradient = vec![0.0; 6];
        kernel.reverse(&mut gradient);
        assert_gradient("slope", &gradient, &q, value, 1e-4, 1e-6);
    }
}

#[test]
fn searches_end_at_feasible_local_maxima() {
    let cell = cell();
    let space = PostureSpace::new(&cell, 64, 4).unwrap();
    let adjoint = adjoint();
    let maxima = space.maximise(&adjoint, &[], Effort::Verify);
    assert_eq!(maxima.len(), 64);
    assert!(maxima.is_sorted_by(|a, b| a.1 >= b.1));
    for (q, value) in &maxima {
        assert!(space.contains(q).unwrap());
        let gain = slope(&adjoint, &space.information(q));
        assert!((gain / value - 1.0).abs() < 1e-12);
    }
    let starts = space.samples(64);
    let each = starts.iter().map(|q| slope(&adjoint, &space.information(q)));
    assert!(maxima[0].1 > each.fold(0.0, f64::max));
    let few = space.maximise(&adjoint, &starts[..2], Effort::Improve);
    assert_eq!(few.len(), 6);
}

#[test]
fn narrow_limits_are_searched_from_outside() {
    let mut cell = cell();
    let q = vec![0.1, 0.2, -1.7, 0.3, 0.4, -0.2];
    let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
    let at = *terms.loading_point();
    // A box of a metre about one loading point leaves next to nothing.
    cell.limits = Limits { tool_box: Some([at.add_scalar(-0.5), at.add_scalar(0.5)]), ..Limits::default() };
    let space = PostureSpace::new(&cell, 512, 4).unwrap();
    let inside = space.samples(512).len();
    assert!(inside < 512);
    let maxima = space.maximise(&adjoint(), &[], Effort::Verify);
    assert!(maxima.len() > inside);
    for (q, _) in maxima {
        assert!(space.contains(&q).unwrap());
    }
}
