//! Functions of one variable: where they are smallest, where they vanish.
//!
//! Both methods: R. P. Brent, Algorithms for Minimization without Derivatives,
//! Prentice-Hall 1973, chapters 4 and 5.

/// Square of the golden ratio's smaller part.
const GOLDEN: f64 = 0.381_966_011_250_105_1;
/// Steps after which a search ends wherever it is.
const STEPS: usize = 100;

/// Place and value of a minimum of `f` in `low..high`, to `tolerance` (absolute),
/// from a point `start` inside with its value.
pub fn minimum(f: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2], start: (f64, f64), tolerance: f64) -> (f64, f64) {
    // The best point, the second best, and the one before that.
    let [mut x, mut w, mut v] = [start; 3];
    let (mut step, mut before_last) = (0.0_f64, 0.0_f64);
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        let least = 0.5 * tolerance;
        if (x.0 - middle).abs() <= tolerance - 0.5 * (high - low) {
            break;
        }
        let mut golden = true;
        if before_last.abs() > least {
            // The parabola through the three points.
            let r = (x.0 - w.0) * (x.1 - v.1);
            let q = (x.0 - v.0) * (x.1 - w.1);
            let mut p = (x.0 - v.0) * q - (x.0 - w.0) * r;
            let mut q = 2.0 * (q - r);
            if q > 0.0 {
                p = -p;
            }
            q = q.abs();
            let inside = p > q * (low - x.0) && p < q * (high - x.0);
            if inside && p.abs() < (0.5 * q * before_last).abs() {
                before_last = step;
                step = p / q;
                let at = x.0 + step;
                if at - low < tolerance || high - at < tolerance {
                    step = least.copysign(middle - x.0);
                }
                golden = false;
            }
        }
        if golden {
            before_last = if x.0 < middle { high - x.0 } else { low - x.0 };
            step = GOLDEN * before_last;
        }
        let at = x.0 + if step.abs() >= least { step } else { least.copysign(step) };
        let next = (at, f(at));
        if next.1 <= x.1 {
            *if next.0 < x.0 { &mut high } else { &mut low } = x.0;
            (v, w, x) = (w, x, next);
        } else {
            *if next.0 < x.0 { &mut low } else { &mut high } = next.0;
            if next.1 <= w.1 || w.0 == x.0 {
                (v, w) = (w, next);
            } else if next.1 <= v.1 || v.0 == x.0 || v.0 == w.0 {
                v = next;
            }
        }
    }
    x
}

/// Where `f` vanishes between `a` and `b`, places with values of opposite sign,
/// to `tolerance` (absolute).
pub fn zero(f: impl Fn(f64) -> f64, mut a: (f64, f64), mut b: (f64, f64), tolerance: f64) -> f64 {
    let mut c = a;
    let mut step = b.0 - a.0;
    let mut last = step;
    for _ in 0..STEPS {
        if (b.1 > 0.0) == (c.1 > 0.0) {
            c = a;
            step = b.0 - a.0;
            last = step;
        }
        if c.1.abs() < b.1.abs() {
            (a, b, c) = (b, c, b);
        }
        let least = 2.0 * f64::EPSILON * b.0.abs() + 0.5 * tolerance;
        let half = 0.5 * (c.0 - b.0);
        if half.abs() <= least || b.1 == 0.0 {
            break;
        }
        if last.abs() >= least && a.1.abs() > b.1.abs() {
            // The secant, or the parabola through the three points.
            let s = b.1 / a.1;
            let (mut p, mut q) = if a.0 == c.0 {
                (2.0 * half * s, 1.0 - s)
            } else {
                let (q, r) = (a.1 / c.1, b.1 / c.1);
                (s * (2.0 * half * q * (q - r) - (b.0 - a.0) * (r - 1.0)), (q - 1.0) * (r - 1.0) * (s - 1.0))
            };
            if p > 0.0 {
                q = -q;
            }
            p = p.abs();
            if 2.0 * p < (3.0 * half * q - (least * q).abs()).min((last * q).abs()) {
                last = step;
                step = p / q;
            } else {
                step = half;
                last = half;
            }
        } else {
            step = half;
            last = half;
        }
        a = b;
        b.0 += if step.abs() > least { step } else { least.copysign(half) };
        b.1 = f(b.0);
    }
    b.0
}
