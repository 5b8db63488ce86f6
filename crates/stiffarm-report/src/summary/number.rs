//! Numbers with their unit and their digits.

use stiffarm::units::{rad_to_shortest_deg, significant_text, with_minus};

/// A number of a result, as it is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Number {
    /// The value; `None` for `null`, and where it is not finite.
    pub value: Option<f64>,
    /// Whether it stands in the result, and is not computed for the telling.
    pub is_of_result: bool,
    /// The shown number is the value times this.
    pub factor: f64,
    /// Unit behind the number; empty where a heading has it.
    pub unit: String,
    /// How many digits are shown.
    pub form: Form,
    /// Written behind a ±.
    pub plus_minus: bool,
}

/// How many digits of a number are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// So many significant digits.
    Significant(usize),
    /// So many digits behind the point.
    Decimals(usize),
}

/// Unit and digits of a kind of number, in sentences and columns alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Unit that is shown; empty for a ratio.
    pub unit: &'static str,
    /// The shown number is the value in SI units and radians times this.
    pub factor: f64,
    /// How many digits are shown.
    pub form: Form,
}

impl Quantity {
    /// Joint stiffness, from N·m/rad.
    pub const STIFFNESS: Quantity = Self::new("10⁶ N·m/rad", 1e-6, Form::Significant(4));
    /// A share, from a fraction.
    pub const PERCENT: Quantity = Self::new("%", 100.0, Form::Significant(2));
    /// Displacements and residuals, from m.
    pub const LENGTH: Quantity = Self::new("mm", 1e3, Form::Decimals(4));
    /// Deflection of an axis with the flange fixed, from rad.
    pub const AXIS: Quantity = Self::new("mdeg", 1e3 * DEGREE, Form::Significant(3));
    /// Lost motion, from rad.
    pub const GAP: Quantity = Self::new("arcmin", 60.0 * DEGREE, Form::Significant(2));
    /// Torque \[N·m\].
    pub const TORQUE: Quantity = Self::new("N·m", 1.0, Form::Significant(3));
    /// A share that is compared to a tenth of a percent, from a fraction.
    pub const SHARE: Quantity = Self::new("%", 100.0, Form::Decimals(1));
    /// Deviation of a stiffness or an index, from a fraction.
    pub const DEVIATION: Quantity = Self::new("%", 100.0, Form::Decimals(2));
    /// Where something is and how far it is from other things, from m.
    pub const PLACE: Quantity = Self::new("mm", 1e3, Form::Decimals(1));
    /// Deflection of a tip under a small load, from m.
    pub const SMALL_LENGTH: Quantity = Self::new("µm", 1e6, Form::Significant(3));
    /// Controller angles, from degrees.
    pub const ANGLE: Quantity = Self::new("°", 1.0, Form::Decimals(2));
    /// A number of things.
    pub const COUNT: Quantity = Self::new("", 1.0, Form::Decimals(0));
    /// A ratio.
    pub const RATIO: Quantity = Self::new("", 1.0, Form::Significant(3));

    /// A kind of number by its unit, the factor to it and its digits.
    pub const fn new(unit: &'static str, factor: f64, form: Form) -> Self {
        Quantity { unit, factor, form }
    }

    /// The same with so many significant digits.
    #[must_use]
    pub const fn digits(self, digits: usize) -> Self {
        Self::new(self.unit, self.factor, Form::Significant(digits))
    }

    /// The same without its unit, for columns whose caption has it.
    #[must_use]
    pub const fn bare(self) -> Self {
        Self::new("", self.factor, self.form)
    }
}

/// Degrees in a radian.
const DEGREE: f64 = 180.0 / std::f64::consts::PI;

impl Number {
    /// A number that was computed for the telling and stands in no file.
    pub fn computed(value: impl Into<Option<f64>>) -> Self {
        Number { is_of_result: false, ..Number::new(value) }
    }

    /// An angle of a result \[rad\] in degrees, as its file has it.
    pub fn degrees(angle: f64) -> Self {
        Number::new(rad_to_shortest_deg(angle))
    }

    /// A count of a result.
    pub fn count(count: usize) -> Self {
        Number::new(count as f64).of(Quantity::COUNT)
    }

    /// The same as one of this kind, with its unit.
    #[must_use]
    pub fn of(self, quantity: Quantity) -> Self {
        Number { form: quantity.form, ..self.times(quantity.factor).unit(quantity.unit) }
    }

    /// A number of a result, with four significant digits and no unit.
    pub fn new(value: impl Into<Option<f64>>) -> Self {
        Number {
            value: value.into().filter(|value| value.is_finite()),
            is_of_result: true,
            factor: 1.0,
            unit: String::new(),
            form: Form::Significant(4),
            plus_minus: false,
        }
    }

    /// The same times a factor.
    #[must_use]
    pub fn times(mut self, factor: f64) -> Self {
        self.factor = factor;
        self
    }

    /// The same with a unit behind it.
    #[must_use]
    pub fn unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = unit.into();
        self
    }

    /// The same with so many digits behind the point.
    #[must_use]
    pub fn decimals(mut self, digits: usize) -> Self {
        self.form = Form::Decimals(digits);
        self
    }

    /// The same with so many significant digits.
    #[must_use]
    pub fn significant(mut self, digits: usize) -> Self {
        self.form = Form::Significant(digits);
        self
    }

    /// The same behind a ±.
    #[must_use]
    pub fn plus_minus(mut self) -> Self {
        self.plus_minus = true;
        self
    }

    /// The same without its unit, for a column whose heading has it.
    #[must_use]
    pub fn bare(self) -> Self {
        self.unit("")
    }

    /// What is shown, without unit and ±; `–` where there is no number.
    pub fn digits(&self) -> String {
        let Some(value) = self.value.map(|value| value * self.factor) else {
            return "–".to_string();
        };
        let text = match self.form {
            Form::Decimals(digits) => format!("{value:.digits$}"),
            Form::Significant(digits) => significant_text(value, digits),
        };
        with_minus(text)
    }

    /// What is shown, with unit and ±.
    pub fn text(&self) -> String {
        let sign = if self.plus_minus { "±\u{a0}" } else { "" };
        let digits = self.digits();
        if self.unit.is_empty() || digits == "–" {
            format!("{sign}{digits}")
        } else if self.unit == "°" {
            format!("{sign}{digits}°")
        } else {
            format!("{sign}{digits}\u{a0}{}", self.unit)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_signs_stand_around() {
        let number = Number::new(1.25e-4).of(Quantity::LENGTH).decimals(3);
        assert_eq!(number.text(), "0.125\u{a0}mm");
        assert_eq!(number.clone().plus_minus().text(), "±\u{a0}0.125\u{a0}mm");
        assert_eq!(number.bare().text(), "0.125");
        assert_eq!(Number::new(None).of(Quantity::LENGTH).text(), "–");
        let tiny = Number::new(-1e-9).of(Quantity::LENGTH).decimals(2);
        assert_eq!(tiny.digits(), "0.00");
    }
}
