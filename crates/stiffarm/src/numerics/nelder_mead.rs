//! The smallest value of a function without derivatives.
//!
//! Nelder and Mead, "A simplex method for function minimization", 1965, doi:10.1093/comjnl/7.4.308,
//! with their coefficients.

/// Minimises `value` from `start` with first steps of `step`, in at most `evaluations` of the
/// function; the best point found. A value that is not finite counts as infinite.
pub fn nelder_mead<const N: usize>(
    mut value: impl FnMut(&[f64; N]) -> f64,
    start: [f64; N],
    step: f64,
    evaluations: usize,
) -> ([f64; N], f64) {
    let mut count = 0;
    let mut at = |x: &[f64; N]| {
        count += 1;
        let value = value(x);
        (if value.is_nan() { f64::INFINITY } else { value }, count)
    };
    let mut simplex: Vec<([f64; N], f64)> = Vec::with_capacity(N + 1);
    simplex.push((start, at(&start).0));
    for i in 0..N {
        let mut corner = start;
        corner[i] += step;
        simplex.push((corner, at(&corner).0));
    }
    let mut spent = N + 1;
    loop {
        // A stable sort: the same path for the same function.
        simplex.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, worst) = (simplex[0], simplex[N]);
        if spent >= evaluations || worst.1 - best.1 <= 1e-12 * best.1.abs() {
            return best;
        }
        let mut middle = [0.0; N];
        for (corner, _) in &simplex[..N] {
            for (m, c) in middle.iter_mut().zip(corner) {
                *m += c / N as f64;
            }
        }
        let along = |t: f64| -> [f64; N] { std::array::from_fn(|i| middle[i] + t * (worst.0[i] - middle[i])) };
        let (reflected, count) = at(&along(-1.0));
        spent = count;
        let replacement = if reflected < best.1 {
            let expanded = at(&along(-2.0));
            spent = expanded.1;
            if expanded.0 < reflected { Some((along(-2.0), expanded.0)) } else { Some((along(-1.0), reflected)) }
        } else if reflected < simplex[N - 1].1 {
            Some((along(-1.0), reflected))
        } else {
            let t = if reflected < worst.1 { -0.5 } else { 0.5 };
            let contracted = at(&along(t));
            spent = contracted.1;
            (contracted.0 < worst.1.min(reflected)).then(|| (along(t), contracted.0))
        };
        match replacement {
            Some(corner) => simplex[N] = corner,
            None => {
                for corner in &mut simplex[1..] {
                    let shrunk = std::array::from_fn(|i| 0.5 * (corner.0[i] + best.0[i]));
                    let (value, now) = at(&shrunk);
                    *corner = (shrunk, value);
                    spent = now;
                }
            }
        }
    }
}
