//! The continuous design is the optimal one where that is known, and bounded from below where it is not reached.

use super::*;
use crate::common::cases::refusals;

/// Regression with 1, x, …, x^degree on [−1, 1].
struct Polynomial {
    degree: usize,
}

impl Polynomial {
    fn starts(&self) -> Vec<Vec<f64>> {
        (0..=2 * self.degree).map(|i| vec![-0.93 + 1.9 * i as f64 / (2 * self.degree) as f64]).collect()
    }
}

impl DesignSpace for Polynomial {
    fn unknowns(&self) -> usize {
        self.degree + 1
    }

    fn information(&self, point: &[f64]) -> DMatrix<f64> {
        let f = DVector::from_fn(self.degree + 1, |i, _| point[0].powi(i as i32));
        &f * f.transpose()
    }

    /// A grid, and ternary search around its local maxima.
    fn maximise(&self, a: &DMatrix<f64>, _: &[Vec<f64>], _: Effort) -> Vec<(Vec<f64>, f64)> {
        let at = |x: f64| slope(a, &self.information(&[x]));
        let grid: Vec<f64> = (0..=400).map(|i| f64::from(i) / 200.0 - 1.0).collect();
        let mut maxima = Vec::new();
        for i in 0..grid.len() {
            let here = at(grid[i]);
            let left = i == 0 || at(grid[i - 1]) <= here;
            let right = i + 1 == grid.len() || at(grid[i + 1]) <= here;
            if left && right {
                let [mut low, mut high] = [grid[i.saturating_sub(1)], grid[(i + 1).min(400)]];
                for _ in 0..200 {
                    let third = (high - low) / 3.0;
                    if at(low + third) < at(high - third) {
                        low += third;
                    } else {
                        high -= third;
                    }
                }
                let x = 0.5 * (low + high);
                maxima.push(if at(x) > here { (vec![x], at(x)) } else { (vec![grid[i]], here) });
            }
        }
        maxima.sort_by(|a, b| b.1.total_cmp(&a.1));
        maxima
    }
}

/// Checks that the weights lie where they should.
fn assert_design(design: &ContinuousDesign, expected: &[(f64, f64)]) {
    let support: Vec<_> = design.points.iter().zip(&design.weights).collect();
    let mut sum = 0.0;
    for (at, weight) in expected {
        let here = support.iter().filter(|(x, _)| (x[0] - at).abs() < 5e-3);
        let here: f64 = here.map(|(_, w)| **w).sum();
        assert!((here - weight).abs() < 2e-3, "{at}: {support:?}");
        sum += here;
    }
    assert!((sum - 1.0).abs() < 1e-4, "{support:?}");
}

/// Pukelsheim, Optimal Design of Experiments (1993), sections 9.5 and 9.6.
#[test]
fn d_optimal_polynomials_are_the_published_ones() {
    let quadratic = Polynomial { degree: 2 };
    let optimum = design(&quadratic, &Criterion::Determinant, &quadratic.starts(), 1e-7);
    let third = 1.0 / 3.0;
    assert_design(&optimum, &[(-1.0, third), (0.0, third), (1.0, third)]);
    let cubic = Polynomial { degree: 3 };
    let optimum = design(&cubic, &Criterion::Determinant, &cubic.starts(), 1e-6);
    let x = 1.0 / 5f64.sqrt();
    assert_design(&optimum, &[(-1.0, 0.25), (-x, 0.25), (x, 0.25), (1.0, 0.25)]);
}

/// With u/2 at ±1 and 1 − u at 0, tr M⁻¹ = (2 − u + u)/(u(1 − u)) = 2/(u(1 − u)),
/// and with the moments of the interval tr(Q M⁻¹) = (8/15)/(u(1 − u)): both are
/// least at u = ½.
#[test]
fn a_and_i_optimal_quadratics_are_the_published_ones() {
    let space = Polynomial { degree: 2 };
    let expected = [(-1.0, 0.25), (0.0, 0.5), (1.0, 0.25)];
    let a = design(&space, &Criterion::Trace(DMatrix::identity(3, 3)), &space.starts(), 1e-5);
    assert_design(&a, &expected);
    assert!((a.bound / 8.0 - 1.0).abs() < 1e-5, "{}", a.bound);
    // ½∫ f fᵀ dx over [−1, 1].
    let moments = DMatrix::from_fn(3, 3, |i, j| match (i + j) % 2 {
        0 => 1.0 / (i + j + 1) as f64,
        _ => 0.0,
    });
    let i = design(&space, &Criterion::Trace(moments), &space.starts(), 1e-5);
    assert_design(&i, &expected);
    assert!((i.bound / (32.0 / 15.0) - 1.0).abs() < 1e-5, "{}", i.bound);
}

/// One coefficient alone: the best variance is 1 for x⁰ (all at 0) and for x¹
/// (half at each end), both with a singular M₀, and 4 for x² (Chebyshev's
/// polynomial 2x² − 1). The bound stays on the safe side and within the tolerance.
#[test]
fn a_singular_optimum_is_bounded_from_below() {
    let space = Polynomial { degree: 2 };
    for tolerance in [1e-2, 1e-4, 1e-5] {
        for (j, best) in [1.0, 1.0, 4.0].into_iter().enumerate() {
            let mut q = DMatrix::zeros(3, 3);
            q[(j, j)] = 1.0;
            let optimum = design(&space, &Criterion::Trace(q), &space.starts(), tolerance);
            assert_eq!(optimum.termination, Termination::Converged);
            assert!(optimum.bound <= best * (1.0 + 1e-9), "{j}: {}", optimum.bound);
            let bound = optimum.bound;
            assert!(bound >= best * (1.0 - tolerance), "{j}: {bound}");
        }
    }
}

#[test]
fn the_equivalence_condition_holds_at_the_design() {
    let space = Polynomial { degree: 3 };
    for criterion in [Criterion::Determinant, Criterion::Trace(DMatrix::identity(4, 4))] {
        let optimum = design(&space, &criterion, &space.starts(), 1e-6);
        let mut mean = 0.0;
        let mut total = DMatrix::zeros(4, 4);
        for (x, w) in optimum.points.iter().zip(&optimum.weights) {
            let g = space.information(x);
            mean += w * slope(&optimum.adjoint, &g);
            total += g * *w;
        }
        assert!((optimum.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((&total - &optimum.information).amax() < 1e-12);
        assert!((mean / optimum.level - 1.0).abs() < 1e-9);
        assert!((optimum.value / value(&criterion, &total) - 1.0).abs() < 1e-9);
        for i in 0..=2000 {
            let x = f64::from(i) / 1000.0 - 1.0;
            let here = slope(&optimum.adjoint, &space.information(&[x]));
            assert!(here <= optimum.level * (1.0 + 1e-6), "{x}: {here}");
            assert!(here <= optimum.largest * (1.0 + 1e-12));
        }
    }
}

/// Finitely many points, named 0, 1, ….
struct Discrete(Vec<DMatrix<f64>>);

impl Discrete {
    /// `count` points of rank 1 or 2 for 3 unknowns.
    fn random(seed: u64, count: usize) -> Self {
        let mut dice = Dice::new(seed);
        let mut point = |i: usize| {
            let rows = 1 + i % 2;
            let block = DMatrix::from_fn(rows, 3, |_, j| dice.signed(0.1, 1.0 + j as f64));
            block.tr_mul(&block)
        };
        Discrete((0..count).map(&mut point).collect())
    }

    fn points(&self) -> Vec<Vec<f64>> {
        (0..self.0.len()).map(|i| vec![i as f64]).collect()
    }
}

impl DesignSpace for Discrete {
    fn unknowns(&self) -> usize {
        self.0[0].nrows()
    }

    fn information(&self, point: &[f64]) -> DMatrix<f64> {
        self.0[point[0] as usize].clone()
    }

    fn maximise(&self, a: &DMatrix<f64>, _: &[Vec<f64>], _: Effort) -> Vec<(Vec<f64>, f64)> {
        let mut all: Vec<(Vec<f64>, f64)> = self
            .points()
            .into_iter()
            .map(|x| {
                let slope = slope(a, &self.information(&x));
                (x, slope)
            })
            .collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        all
    }
}

/// Smallest φ of `left` more points from number `from` on, on top of `sum`.
fn brute_force(space: &Discrete, criterion: &Criterion, sum: &DMatrix<f64>, from: usize, left: usize) -> f64 {
    if left == 0 {
        return value(criterion, sum);
    }
    (from..space.0.len())
        .map(|i| brute_force(space, criterion, &(sum + &space.0[i]), i, left - 1))
        .fold(f64::INFINITY, f64::min)
}

/// φ of the best weights by the multiplicative algorithm (Silvey, Titterington
/// & Torsney 1978), which shares nothing with the library's.
fn multiplicative(space: &Discrete, criterion: &Criterion, beforehand: &DMatrix<f64>) -> f64 {
    let n = beforehand.nrows();
    let mut weights = vec![1.0 / space.0.len() as f64; space.0.len()];
    let total = |weights: &[f64]| {
        let mut total = beforehand.clone();
        for (w, g) in weights.iter().zip(&space.0) {
            total += g * *w;
        }
        total
    };
    for _ in 0..20_000 {
        let inverse = total(&weights).try_inverse().unwrap();
        let adjoint = match criterion {
            Criterion::Determinant => inverse,
            Criterion::Trace(q) => &inverse * q * &inverse,
        };
        for (w, g) in weights.iter_mut().zip(&space.0) {
            *w *= slope(&adjoint, g).sqrt();
        }
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|w| *w /= sum);
    }
    assert_eq!(n, space.unknowns());
    value(criterion, &total(&weights))
}

#[test]
fn no_exact_design_beats_the_bound_and_the_optimum_is_the_multiplicative_one() {
    let weighted = DMatrix::from_row_slice(3, 3, &[2.0, 0.5, 0.0, 0.5, 1.0, 0.2, 0.0, 0.2, 0.7]);
    for seed in 0..12 {
        let space = Discrete::random(seed, 9);
        for criterion in
            [Criterion::Determinant, Criterion::Trace(DMatrix::identity(3, 3)), Criterion::Trace(weighted.clone())]
        {
            let optimum = design(&space, &criterion, &space.points(), 1e-8);
            assert_eq!(optimum.termination, Termination::Converged);
            let other = multiplicative(&space, &criterion, &DMatrix::zeros(3, 3));
            assert!((optimum.value / other - 1.0).abs() < 1e-6, "{seed} {criterion:?}: {} or {other}", optimum.value);
            for count in 3..=5 {
                let zero = DMatrix::zeros(3, 3);
                let best = brute_force(&space, &criterion, &zero, 0, count);
                let bound = optimum.bound / count as f64;
                assert!(best >= bound * (1.0 - 1e-10), "{seed} {count}: {best} {bound}");
                // Nor is the bound idle.
                assert!(bound > 0.3 * best, "{seed} {count}: {best} {bound}");
            }
        }
    }
}

/// A design on top of points measured before: three of the space, once each.
#[test]
fn the_bound_counts_information_given_beforehand() {
    for seed in 20..28 {
        let space = Discrete::random(seed, 8);
        let measured = &space.0[0] + &space.0[1] + &space.0[2];
        for criterion in [Criterion::Determinant, Criterion::Trace(DMatrix::identity(3, 3))] {
            for count in 1..=4 {
                let beforehand = &measured / count as f64;
                let optimum = optimal_design(
                    &space,
                    &criterion,
                    Some(&beforehand),
                    &space.points(),
                    DesignOptions { tolerance: 1e-8, ..DesignOptions::default() },
                    Control::default(),
                )
                .unwrap();
                assert_eq!(optimum.termination, Termination::Converged);
                let other = multiplicative(&space, &criterion, &beforehand);
                assert!((optimum.value / other - 1.0).abs() < 1e-5, "{seed} {count}");
                let best = brute_force(&space, &criterion, &measured, 0, count);
                let bound = optimum.bound / count as f64;
                assert!(best >= bound * (1.0 - 1e-10), "{seed} {count}: {best} {bound}");
                assert!(bound > 0.3 * best, "{seed} {count}: {best} {bound}");
            }
        }
    }
}

#[test]
fn a_design_that_runs_out_of_rounds_is_bounded_all_the_same() {
    let space = Polynomial { degree: 3 };
    let criterion = Criterion::Trace(DMatrix::identity(4, 4));
    let best = design(&space, &criterion, &space.starts(), 1e-8);
    for max_rounds in 1..4 {
        let options = DesignOptions { tolerance: 1e-10, max_rounds };
        let starts = space.starts();
        let stopped = optimal_design(&space, &criterion, None, &starts, options, Control::default()).unwrap();
        assert_eq!(stopped.termination, Termination::IterationLimit);
        assert_eq!(stopped.rounds, max_rounds);
        assert!(stopped.verification.searches > 0);
        assert!(stopped.residual > 1e-10);
        assert!(stopped.bound <= best.value && stopped.bound > 0.1 * best.value);
    }
}

#[test]
fn problems_that_make_no_sense_are_refused() {
    let space = Polynomial { degree: 2 };
    let starts = space.starts();
    let run = |criterion: &Criterion, beforehand: Option<&DMatrix<f64>>, starts: &[Vec<f64>], tolerance| {
        let options = DesignOptions { tolerance, ..DesignOptions::default() };
        optimal_design(&space, criterion, beforehand, starts, options, Control::default())
    };
    let d = Criterion::Determinant;
    let nan = DMatrix::from_element(3, 3, f64::NAN);
    let rows = [
        ("no start", Code::TooFewData, run(&d, None, &[], 1e-4)),
        ("a tolerance of zero", Code::InvalidValue, run(&d, None, &starts, 0.0)),
        ("a tolerance that is no number", Code::InvalidValue, run(&d, None, &starts, f64::NAN)),
        ("information that is no number", Code::NotFinite, run(&d, Some(&nan), &starts, 1e-4)),
        ("information of two unknowns", Code::Dimension, run(&d, Some(&DMatrix::identity(2, 2)), &starts, 1e-4)),
        ("a start that is no number", Code::NotFinite, run(&d, None, &[vec![f64::NAN]], 1e-4)),
        ("weights that are no numbers", Code::NotFinite, run(&Criterion::Trace(nan.clone()), None, &starts, 1e-4)),
        // At ±1 the first and the third coefficient mix.
        ("two points for three", Code::NotIdentifiable, run(&d, None, &[vec![-1.0], vec![1.0]], 1e-4)),
    ];
    insta::assert_snapshot!("design_refusals", refusals(rows));
}
