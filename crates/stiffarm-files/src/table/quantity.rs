//! Units of columns: the suffixes that a quantity may have, and what they mean.

use stiffarm::units::{
    deg_to_rad, in_to_m, kn_to_n, m_to_mm, min_to_s, mm_to_m, ms_to_s, nmm_to_nm, rad_to_deg, rounded, shortest,
    um_to_m,
};

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    /// A name: no unit.
    Name,
    /// A number without unit.
    Number,
    Length,
    Force,
    Moment,
    Angle,
    Time,
    Feed,
    Power,
    Temperature,
}

/// A unit: how it stands at the end of a heading, and its way to SI and back.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unit {
    pub(super) suffix: &'static str,
    pub(super) to_si: fn(f64) -> f64,
    from_si: fn(f64) -> f64,
}

impl Unit {
    /// What to do with the heading `name` in this unit where the numbers below it are in
    /// another one; `None` where there is no other.
    pub(super) fn of_others(&self, name: &str) -> Option<String> {
        let quantities = [
            Quantity::Length,
            Quantity::Force,
            Quantity::Moment,
            Quantity::Angle,
            Quantity::Time,
            Quantity::Feed,
            Quantity::Power,
            Quantity::Temperature,
        ];
        let mut units = quantities.into_iter().map(Quantity::units);
        let quantity_units = units.find(|units| units.iter().any(|unit| unit == self))?;
        let stem = name.strip_suffix(self.suffix)?;
        let others = quantity_units.iter().filter(|unit| *unit != self);
        let others: Vec<String> = others.map(|unit| format!("{stem}{}", unit.suffix)).collect();
        let others = others.join(" or ");
        Some(format!(
            "the heading {name} says {}: if the numbers are in another unit, name the column {others}",
            self.suffix
        ))
    }

    /// The shortest decimal number in this unit that is read back as `value`.
    pub(super) fn shortest(&self, value: f64) -> f64 {
        shortest(value, self.from_si, self.to_si)
    }

    /// `value` in this unit, rounded to `decimals`, which may be below zero.
    pub(super) fn rounded(&self, value: f64, decimals: i32) -> f64 {
        rounded((self.from_si)(value), decimals)
    }
}

/// Two units are the same where their suffixes are.
impl PartialEq for Unit {
    fn eq(&self, other: &Self) -> bool {
        self.suffix == other.suffix
    }
}

const fn unit(suffix: &'static str, to_si: fn(f64) -> f64, from_si: fn(f64) -> f64) -> Unit {
    Unit { suffix, to_si, from_si }
}

/// SI already.
fn same(value: f64) -> f64 {
    value
}

#[rustfmt::skip]
mod units {
    use super::*;
    pub(super) static LENGTH: [Unit; 4] = [
        unit("mm", mm_to_m, m_to_mm),
        unit("m", same, same),
        unit("um", um_to_m, |m| m * 1e6),
        unit("in", in_to_m, |m| m / 0.0254),
    ];
    pub(super) static FORCE: [Unit; 2] = [unit("n", same, same), unit("kn", kn_to_n, |n| n / 1e3)];
    pub(super) static MOMENT: [Unit; 2] = [unit("nm", same, same), unit("nmm", nmm_to_nm, |nm| nm * 1e3)];
    pub(super) static ANGLE: [Unit; 2] = [unit("deg", deg_to_rad, rad_to_deg), unit("rad", same, same)];
    pub(super) static TIME: [Unit; 4] = [
        unit("s", same, same),
        unit("ms", ms_to_s, |s| s * 1e3),
        unit("min", min_to_s, |s| s / 60.0),
        unit("d", |d| d * 86400.0, |s| s / 86400.0),
    ];
    pub(super) static FEED: [Unit; 4] = [
        unit("mm_per_min", |mm| mm / 60e3, |m| m * 60e3),
        unit("m_per_min", |m| m / 60.0, |m| m * 60.0),
        unit("mm_per_s", mm_to_m, m_to_mm),
        unit("in_per_min", |inches| inches * 0.0254 / 60.0, |m| m / 0.0254 * 60.0),
    ];
    /// °C stays °C.
    pub(super) static TEMPERATURE: [Unit; 2] = [
        unit("c", same, same),
        unit("f", |f| (f - 32.0) / 1.8, |c| c * 1.8 + 32.0),
    ];
    pub(super) static POWER: [Unit; 2] = [unit("w", same, same), unit("kw", |kw| kw * 1e3, |w| w / 1e3)];
}

impl Quantity {
    /// Its units; the first is the usual one.
    pub(super) fn units(self) -> &'static [Unit] {
        match self {
            Quantity::Name | Quantity::Number => &[],
            Quantity::Length => &units::LENGTH,
            Quantity::Force => &units::FORCE,
            Quantity::Moment => &units::MOMENT,
            Quantity::Angle => &units::ANGLE,
            Quantity::Time => &units::TIME,
            Quantity::Feed => &units::FEED,
            Quantity::Power => &units::POWER,
            Quantity::Temperature => &units::TEMPERATURE,
        }
    }

    /// The word for it in messages.
    pub(super) fn plural(self) -> &'static str {
        match self {
            Quantity::Name => "names",
            Quantity::Number => "numbers",
            Quantity::Length => "lengths",
            Quantity::Force => "forces",
            Quantity::Moment => "moments",
            Quantity::Angle => "angles",
            Quantity::Time => "times",
            Quantity::Feed => "feeds",
            Quantity::Power => "powers",
            Quantity::Temperature => "temperatures",
        }
    }
}
