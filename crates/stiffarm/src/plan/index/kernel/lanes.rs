//! Four numbers at a time: one lane per posture. Plain arrays, which the
//! compiler turns into vector instructions; every lane does the same sums in
//! the same order on every machine, so results do not depend on them.

use crate::numerics::information::small::Entry;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Lanes per batch.
pub const WIDTH: usize = 4;

/// Three or six entries by their index, written out: closures of
/// `std::array::from_fn` are not always inlined, and then they lose the
/// instructions of the function they are called from.
macro_rules! entries {
    ([$($at:literal),*], $i:ident, $entry:expr) => {
        [$({
            let $i = $at;
            $entry
        }),*]
    };
}
macro_rules! three {
    (|$i:ident| $entry:expr) => {
        $crate::plan::index::kernel::lanes::entries!([0, 1, 2], $i, $entry)
    };
}
macro_rules! six {
    (|$i:ident| $entry:expr) => {
        $crate::plan::index::kernel::lanes::entries!([0, 1, 2, 3, 4, 5], $i, $entry)
    };
}
pub(crate) use {entries, six, three};

/// Each lane by its number, written out: where a loop over lanes is not unrolled, its single numbers have to reach
/// memory before the vector that they make can be loaded.
macro_rules! four {
    (|$i:ident| $entry:expr) => {
        Lanes(entries!([0, 1, 2, 3], $i, $entry))
    };
}

/// One number per lane.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub struct Lanes(pub [f64; WIDTH]);

/// A vector in base axes, one per lane.
pub(crate) type Vec3 = [Lanes; 3];

/// A column of a 6 × n matrix, one per lane.
pub(crate) type Vec6 = [Lanes; 6];

pub(crate) const ZERO: Lanes = Lanes([0.0; WIDTH]);
pub(crate) const ZERO3: Vec3 = [ZERO; 3];
pub(crate) const ZERO6: Vec6 = [ZERO; 6];

impl Lanes {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Lanes([value; WIDTH])
    }

    /// Square roots.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        four!(|i| self.0[i].sqrt())
    }

    /// The larger of each lane and 0; 0 for a lane that is not a number.
    #[inline(always)]
    pub fn positive_part(self) -> Self {
        self.max(ZERO)
    }

    /// The larger of both, lane by lane; the other where this is not a number.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        four!(|i| if self.0[i] > other.0[i] { self.0[i] } else { other.0[i] })
    }
}

macro_rules! by_lane {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Lanes {
            type Output = Lanes;
            #[inline(always)]
            fn $method(self, other: Lanes) -> Lanes {
                four!(|i| self.0[i] $op other.0[i])
            }
        }
    };
}
by_lane!(Add, add, +);
by_lane!(Sub, sub, -);
by_lane!(Mul, mul, *);
by_lane!(Div, div, /);

impl Mul<f64> for Lanes {
    type Output = Lanes;
    #[inline(always)]
    fn mul(self, factor: f64) -> Lanes {
        self * Lanes::splat(factor)
    }
}

impl Neg for Lanes {
    type Output = Lanes;
    #[inline(always)]
    fn neg(self) -> Lanes {
        four!(|i| -self.0[i])
    }
}

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Lanes) {
        *self = *self + other;
    }
}

impl SubAssign for Lanes {
    #[inline(always)]
    fn sub_assign(&mut self, other: Lanes) {
        *self = *self - other;
    }
}

impl Entry for Lanes {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Lanes::splat(value)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Lanes::sqrt(self)
    }

    #[inline(always)]
    fn is_above(self, limit: Self) -> bool {
        let [a, b, c, d] = entries!([0, 1, 2, 3], i, self.0[i] > limit.0[i]);
        // Without a way out in the middle it is one comparison.
        a & b & c & d
    }
}

#[inline(always)]
pub(crate) fn add(a: Vec3, b: Vec3) -> Vec3 {
    three!(|i| a[i] + b[i])
}

#[inline(always)]
pub(crate) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    three!(|i| a[i] - b[i])
}

#[inline(always)]
pub(crate) fn scale(a: Vec3, factor: Lanes) -> Vec3 {
    three!(|i| a[i] * factor)
}

#[inline(always)]
pub(crate) fn dot(a: &Vec3, b: &Vec3) -> Lanes {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross(a: &Vec3, b: &Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
pub(crate) fn dot6(a: &Vec6, b: &Vec6) -> Lanes {
    (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) + (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])
}

/// Matrix (columns) times constant vector.
#[inline(always)]
pub(crate) fn rotate(columns: &[Vec3; 3], v: &[f64; 3]) -> Vec3 {
    three!(|i| columns[0][i] * v[0] + columns[1][i] * v[1] + columns[2][i] * v[2])
}

/// Largest angle \[rad\] that the reduction below is exact for.
const LARGEST_ANGLE: f64 = 1e5;
/// Adding and subtracting it rounds to the nearest integer, which then stands
/// in the lowest bits.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// π/2 in three parts; the first two have 33 bits, so that small integer
/// multiples of them are exact.
const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
/// Factorials of the Taylor series of sin x = x + x³(S₀ + S₁x² + …) and
/// cos x = 1 − x²/2 + x⁴(C₀ + C₁x² + …), which end below one unit in the last
/// place on |x| ≤ π/4.
const SIN: [f64; 8] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
];
const COS: [f64; 8] = [
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
    -1.0 / 6_402_373_705_728_000.0,
];

/// Sine and cosine of every lane.
#[inline(always)]
pub fn sin_cos(x: Lanes) -> (Lanes, Lanes) {
    if x.0.iter().any(|x| x.is_nan() || x.abs() > LARGEST_ANGLE) {
        let mut both = (x, x);
        for i in 0..WIDTH {
            (both.0.0[i], both.1.0[i]) = x.0[i].sin_cos();
        }
        return both;
    }
    let rounded = x * std::f64::consts::FRAC_2_PI + Lanes::splat(ROUND);
    let quarters = rounded - Lanes::splat(ROUND);
    let r = ((x - quarters * HALF_PI[0]) - quarters * HALF_PI[1]) - quarters * HALF_PI[2];
    let z = r * r;
    // Even and odd coefficients apart: two short chains instead of a long one.
    let zz = z * z;
    let polynomial = |c: &[f64; 8]| {
        let even = ((zz * c[6] + Lanes::splat(c[4])) * zz + Lanes::splat(c[2])) * zz;
        let odd = ((zz * c[7] + Lanes::splat(c[5])) * zz + Lanes::splat(c[3])) * zz;
        (even + Lanes::splat(c[0])) + (odd + Lanes::splat(c[1])) * z
    };
    let sin = r + r * z * polynomial(&SIN);
    let half = z * 0.5;
    let one = Lanes::splat(1.0);
    let head = one - half;
    let cos = head + (((one - head) - half) + z * z * polynomial(&COS));
    // Quarter turns swap sine and cosine and change their signs.
    let mut out = (sin, cos);
    for i in 0..WIDTH {
        let quarter = rounded.0[i].to_bits();
        let (s, c) = (sin.0[i].to_bits(), cos.0[i].to_bits());
        let swap = (s ^ c) & 0u64.wrapping_sub(quarter & 1);
        let sin_sign = (quarter & 2) << 62;
        let cos_sign = (quarter.wrapping_add(1) & 2) << 62;
        out.0.0[i] = f64::from_bits(s ^ swap ^ sin_sign);
        out.1.0[i] = f64::from_bits(c ^ swap ^ cos_sign);
    }
    out
}
