//! Units of columns: the suffixes that a quantity may have, and what they mean.

use crate::units::{deg_to_rad, in_to_m, kn_to_n, min_to_s, mm_to_m, ms_to_s, nmm_to_nm, um_to_m};

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    /// A name: no unit.
    Name,
    Length,
    Force,
    Moment,
    Angle,
    Time,
}

/// A unit: how it stands at the end of a heading, and its way to SI.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unit {
    pub(super) suffix: &'static str,
    pub(super) to_si: fn(f64) -> f64,
}

const fn unit(suffix: &'static str, to_si: fn(f64) -> f64) -> Unit {
    Unit { suffix, to_si }
}

/// SI already.
fn same(value: f64) -> f64 {
    value
}

#[rustfmt::skip]
mod units {
    use super::*;
    pub(super) static LENGTH: [Unit; 4] = [unit("mm", mm_to_m), unit("m", same), unit("um", um_to_m), unit("in", in_to_m)];
    pub(super) static FORCE: [Unit; 2] = [unit("n", same), unit("kn", kn_to_n)];
    pub(super) static MOMENT: [Unit; 2] = [unit("nm", same), unit("nmm", nmm_to_nm)];
    pub(super) static ANGLE: [Unit; 2] = [unit("deg", deg_to_rad), unit("rad", same)];
    pub(super) static TIME: [Unit; 3] = [unit("s", same), unit("ms", ms_to_s), unit("min", min_to_s)];
}

impl Quantity {
    /// Its units; the first is the usual one.
    pub(super) fn units(self) -> &'static [Unit] {
        match self {
            Quantity::Name => &[],
            Quantity::Length => &units::LENGTH,
            Quantity::Force => &units::FORCE,
            Quantity::Moment => &units::MOMENT,
            Quantity::Angle => &units::ANGLE,
            Quantity::Time => &units::TIME,
        }
    }

    /// The word for it in messages.
    pub(super) fn plural(self) -> &'static str {
        match self {
            Quantity::Name => "names",
            Quantity::Length => "lengths",
            Quantity::Force => "forces",
            Quantity::Moment => "moments",
            Quantity::Angle => "angles",
            Quantity::Time => "times",
        }
    }
}
