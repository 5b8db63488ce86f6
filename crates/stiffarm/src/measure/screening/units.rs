//! Units that people mix up, by the factor that undoes it.

use super::Cause;
use crate::units::STANDARD_GRAVITY;

/// Newtons in a pound-force: 0.453 592 37 kg (international yard and pound
/// agreement, 1959) under standard gravity.
pub(super) const POUND: f64 = 0.453_592_37 * STANDARD_GRAVITY;
/// Millimetres in an inch (the same agreement).
pub(super) const INCH: f64 = 25.4;
/// Degrees in a radian.
pub(super) const RADIAN: f64 = 180.0 / std::f64::consts::PI;

/// One factor, with the slip it undoes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    /// What is typed times this is what is meant.
    pub factor: f64,
    /// What is typed, for a sentence.
    pub typed: &'static str,
    /// Logarithm of how much rarer the slip is than the commonest.
    pub rare: f64,
}

impl Unit {
    /// True for a slipped decimal point.
    pub fn is_decimal(&self) -> bool {
        [10.0, 0.1, 100.0, 0.01].contains(&self.factor)
    }
}

pub(super) const fn unit(factor: f64, typed: &'static str, rare: f64) -> Unit {
    Unit { factor, typed, rare }
}

/// Forces of a whole table, or of a cell.
pub(super) const FORCES: [Unit; 4] = [
    unit(STANDARD_GRAVITY, "kilograms (kgf)", 0.0),
    unit(POUND, "pounds (lbf)", 1.0),
    unit(1e3, "kilonewtons", 1.0),
    unit(1e-3, "newtons read as kilonewtons", 2.0),
];

/// Loads of a single state: a slipped decimal point is likelier there than a unit.
pub(super) const ENTRIES: [Unit; 10] = [
    unit(10.0, "a tenth of it (decimal point)", 0.0),
    unit(0.1, "ten times it (decimal point)", 0.0),
    unit(STANDARD_GRAVITY, "kilograms (kgf)", 1.0),
    unit(POUND, "pounds (lbf)", 1.0),
    unit(1e3, "kilonewtons", 1.0),
    unit(1e-3, "a thousand times it", 2.0),
    unit(100.0, "a hundredth of it (decimal point)", 1.0),
    unit(0.01, "a hundred times it (decimal point)", 1.0),
    unit(1.0 / STANDARD_GRAVITY, "newtons read as kilograms", 3.0),
    unit(1.0 / POUND, "newtons read as pounds", 3.0),
];

/// Lengths of the cell.
pub(super) const LENGTHS: [Unit; 4] =
    [unit(1e3, "", 0.0), unit(1e-3, "", 0.0), unit(INCH, "", 0.0), unit(1.0 / INCH, "", 0.0)];

/// Lengths that a drawing may be off by besides: centimetres, and tenths of them.
pub(super) const CENTIMETRES: [Unit; 4] =
    [unit(10.0, "", 0.0), unit(0.1, "", 0.0), unit(100.0, "", 0.0), unit(0.01, "", 0.0)];

/// Angles all below this may be radians taken for degrees, one above the other may be degrees taken for radians
/// \[rad\].
pub(super) const LIKE_RADIANS: f64 = 0.122;
const LIKE_DEGREES: f64 = 14.0;

/// The unit that angles may be in, by the largest of them \[rad\].
pub(super) fn of_angles(largest: f64) -> Option<(Cause, Unit)> {
    match largest {
        ..LIKE_RADIANS => Some((Cause::Radians, unit(RADIAN, "", 0.0))),
        LIKE_DEGREES.. => Some((Cause::Degrees, unit(1.0 / RADIAN, "", 0.0))),
        _ => None,
    }
}

/// Displacements of a table that holds them.
pub(super) const DISPLACEMENTS: [Unit; 4] = [
    unit(1e3, "metres under a heading in millimetres", 1.0),
    unit(1e-3, "micrometres under a heading in millimetres", 1.0),
    unit(INCH, "inches under a heading in millimetres", 1.0),
    unit(1.0 / INCH, "millimetres under a heading in inches", 4.0),
];

/// The prior stiffness.
pub(super) const PRIORS: [Unit; 4] = [
    unit(RADIAN, "in N·m per degree", 1.0),
    unit(60.0 * RADIAN, "in N·m per minute of arc", 1.5),
    unit(1e-3, "in N·mm/rad", 1.0),
    unit(1e3, "in kN·m/rad", 1.0),
];

/// Moments of a measured wrench.
pub(super) const MOMENTS: [Unit; 6] = [
    unit(1e-3, "in N·mm", 0.0),
    unit(1e3, "in kN·m", 1.0),
    unit(STANDARD_GRAVITY, "in kgf·m", 1.0),
    unit(POUND, "in lbf·m", 2.0),
    unit(1.0 / STANDARD_GRAVITY, "", 1.0),
    unit(1.0 / POUND, "", 2.0),
];
