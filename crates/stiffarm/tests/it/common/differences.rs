//! Derivatives by differences.

/// The derivative of `f` at 0: central differences without their error of order step² (Richardson).
pub fn slope(mut f: impl FnMut(f64) -> f64, step: f64) -> f64 {
    let mut central = |h: f64| (f(h) - f(-h)) / (2.0 * h);
    let (coarse, fine) = (central(step), central(0.5 * step));
    (4.0 * fine - coarse) / 3.0
}

/// Asserts that `gradient` is that of `value` at `at`, each entry to `tolerance` of the largest.
#[track_caller]
pub fn assert_gradient(
    what: &str,
    gradient: &[f64],
    at: &[f64],
    mut value: impl FnMut(&[f64]) -> f64,
    step: f64,
    tolerance: f64,
) {
    assert_eq!(gradient.len(), at.len());
    let largest = gradient.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
    for (k, ours) in gradient.iter().enumerate() {
        let moved = |by: f64| {
            let mut moved = at.to_vec();
            moved[k] += by;
            value(&moved)
        };
        let expected = slope(moved, step);
        assert!((ours - expected).abs() < tolerance * largest, "{what} {k}: {ours} {expected}");
    }
}
