//! Extents of axes and the mapping of values to fractions of an axis.

use crate::figure::{Axis, Scale};

/// Largest magnitude an axis accepts. Far beyond any measurable quantity, and
/// far enough from the end of the number range that sums, differences and
/// ratios of accepted values stay finite.
const LARGEST: f64 = 1e150;

/// Smallest value a logarithmic axis accepts.
const SMALLEST: f64 = 1e-150;

/// Relative width below which an extent counts as a single value: rounding of
/// the tick positions would show.
const NARROW: f64 = 1e-9;

/// What the positions on an axis mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Linear,
    Log,
    /// This many named places at 0, 1, 2, …
    Category(usize),
}

impl Kind {
    pub(super) fn of(axis: &Axis) -> Self {
        match (axis.categories.len(), axis.scale) {
            (0, Scale::Linear) => Self::Linear,
            (0, Scale::Log) => Self::Log,
            (n, _) => Self::Category(n),
        }
    }

    /// Whether the axis can show this value at all.
    pub(super) fn accepts(self, value: f64) -> bool {
        match self {
            Self::Linear => value.is_finite() && value.abs() <= LARGEST,
            Self::Log => (SMALLEST..=LARGEST).contains(&value),
            Self::Category(n) => value >= -0.5 && value <= n as f64 - 0.5,
        }
    }
}

/// The part of an axis that is shown; never empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    pub kind: Kind,
    pub lo: f64,
    pub hi: f64,
}

impl Extent {
    /// The extent the axis asks for, or one that fits accepted values with a
    /// margin. `from_zero` marks a linear axis that carries bars.
    pub(super) fn choose(axis: &Axis, values: &[f64], from_zero: bool) -> Self {
        let kind = Kind::of(axis);
        if let Kind::Category(n) = kind {
            return Self { kind, lo: -0.5, hi: n as f64 - 0.5 };
        }
        if let Some(fixed) = axis.range.and_then(|ends| Self::fixed(kind, ends)) {
            return fixed;
        }
        let lo = values.iter().copied().fold(f64::INFINITY, f64::min);
        let hi = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        match kind {
            _ if lo > hi => Self { kind, lo: if kind == Kind::Log { 0.1 } else { 0.0 }, hi: 1.0 },
            Kind::Log => Self::around_log(lo, hi),
            _ => Self::around_linear(lo, hi, from_zero || axis.from_zero),
        }
    }

    fn fixed(kind: Kind, [a, b]: [f64; 2]) -> Option<Self> {
        let (lo, hi) = (a.min(b), a.max(b));
        let wide = match kind {
            Kind::Log => hi > lo * (1.0 + NARROW),
            _ => hi - lo > NARROW * lo.abs().max(hi.abs()) && hi - lo > SMALLEST,
        };
        (kind.accepts(a) && kind.accepts(b) && wide).then_some(Self { kind, lo, hi })
    }

    fn around_linear(lo: f64, hi: f64, from_zero: bool) -> Self {
        let (mut lo, mut hi) = (lo, hi);
        if from_zero {
            lo = lo.min(0.0);
            hi = hi.max(0.0);
        }
        let size = lo.abs().max(hi.abs());
        let span = hi - lo;
        let margin = if span > NARROW * size && span > 1e-140 {
            0.05 * span
        } else if size > 1e-140 {
            0.1 * size
        } else {
            1.0
        };
        // A margin must not suggest values on the other side of zero, and a
        // bar stands on its base line.
        let below = lo - margin;
        let above = hi + margin;
        Self {
            kind: Kind::Linear,
            lo: match lo {
                0.0 if from_zero => 0.0,
                _ if lo > 0.0 => below.max(0.0),
                _ => below,
            },
            hi: match hi {
                0.0 if from_zero && lo < 0.0 => 0.0,
                _ if hi < 0.0 => above.min(0.0),
                _ => above,
            },
        }
    }

    /// Logarithmic extents end on 1, 2 or 5 times a power of ten when short,
    /// so that there are always two labels, and just beyond the data when
    /// long.
    fn around_log(lo: f64, hi: f64) -> Self {
        let kind = Kind::Log;
        let decades = (hi / lo).log10();
        if decades >= 2.0 {
            let margin = 10_f64.powf(0.04 * decades);
            return Self { kind, lo: lo / margin, hi: hi * margin };
        }
        Self { kind, lo: round_log(lo / 1.04, false), hi: round_log(hi * 1.04, true) }
    }

    /// Place of a value as a fraction of the axis. Values far outside stay
    /// far outside, but bounded.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        let raw = match self.kind {
            Kind::Log => {
                let from = self.lo.log10();
                (value.max(f64::MIN_POSITIVE).log10() - from) / (self.hi.log10() - from)
            }
            _ => (value - self.lo) / (self.hi - self.lo),
        };
        raw.clamp(-1e5, 1e5)
    }

    /// The extent widened about its middle by a factor of at least 1.
    pub(super) fn widened(&self, factor: f64) -> Self {
        let extra = 0.5 * (factor - 1.0).max(0.0) * (self.hi - self.lo);
        Self { kind: self.kind, lo: self.lo - extra, hi: self.hi + extra }
    }
}

/// The next 1, 2 or 5 times a power of ten, upwards or downwards.
fn round_log(value: f64, up: bool) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    let mantissa = value / power;
    let steps = [1.0, 2.0, 5.0, 10.0];
    let step = if up {
        steps.iter().copied().find(|s| *s >= mantissa)
    } else {
        steps.iter().rev().copied().find(|s| *s <= mantissa)
    };
    power * step.unwrap_or(if up { 10.0 } else { 0.5 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extents_are_never_empty() {
        let cases: [&[f64]; 8] =
            [&[], &[0.0], &[5e-324], &[1e150, -1e150], &[7.0, 7.0], &[1.0, 1.0 + 1e-15], &[1e-150], &[1e150]];
        for axis in [Axis::linear("", ""), Axis::log("", "")] {
            for values in cases {
                let accepted: Vec<f64> = values.iter().copied().filter(|v| Kind::of(&axis).accepts(*v)).collect();
                let e = Extent::choose(&axis, &accepted, false);
                assert!(e.lo < e.hi && e.fraction(e.hi) == 1.0, "{values:?}: {e:?}");
                for v in accepted {
                    assert!((0.0..=1.0).contains(&e.fraction(v)), "{v} in {e:?}");
                }
            }
        }
    }

    #[test]
    fn impossible_ranges_are_ignored() {
        let automatic = Extent::choose(&Axis::linear("", ""), &[1.0, 2.0], false);
        for (from, to) in [(1.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            let axis = Axis::linear("", "").with_range(from, to);
            assert_eq!(Extent::choose(&axis, &[1.0, 2.0], false), automatic);
        }
        let axis = Axis::log("", "").with_range(0.0, 1.0);
        assert!(Extent::choose(&axis, &[10.0], false).lo > 1.0);
        let reversed = Axis::linear("", "").with_range(3.0, -1.0);
        assert_eq!(Extent::choose(&reversed, &[], false).lo, -1.0);
    }

    #[test]
    fn bars_stand_on_zero() {
        let e = Extent::choose(&Axis::linear("", ""), &[3.0, 4.0], true);
        assert_eq!(e.lo, 0.0);
        let e = Extent::choose(&Axis::linear("", ""), &[-3.0, -4.0], true);
        assert_eq!(e.hi, 0.0);
    }

    #[test]
    fn an_axis_from_zero_begins_there() {
        let from = |low, high| {
            let e = Extent::choose(&Axis::linear("", "").from_zero(), &[low, high], false);
            [e.lo, e.hi]
        };
        assert_eq!(from(3.0, 4.0)[0], 0.0);
        assert_eq!(from(-4.0, -3.0)[1], 0.0);
        assert!(from(-1.0, 4.0)[0] < -1.0);
        let log = Axis::log("", "").from_zero();
        let plain = Extent::choose(&Axis::log("", ""), &[3.0, 30.0], false);
        assert_eq!(Extent::choose(&log, &[3.0, 30.0], false), plain);
    }

    #[test]
    fn short_log_extents_end_on_round_values() {
        let e = Extent::choose(&Axis::log("", ""), &[3.0, 30.0], false);
        assert!((e.lo - 2.0).abs() < 1e-12 && (e.hi - 50.0).abs() < 1e-12);
    }
}
