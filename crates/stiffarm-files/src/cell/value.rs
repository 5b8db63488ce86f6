//! Values with their places, and numbers whose type is their unit.

use std::marker::PhantomData;
use std::ops::Range;
use stiffarm::units::{
    arcmin_to_rad, deg_to_rad, min_to_s, mm_to_m, mm2_to_m2, mrad_to_rad, n_per_mm_to_n_per_m, n_per_mm2_to_pa,
    percent_to_fraction, rpm_to_hz, um_to_m, urad_to_rad,
};
#[cfg(feature = "schema")]
use {
    schemars::{JsonSchema, Schema, SchemaGenerator, json_schema},
    std::borrow::Cow,
};

/// A value and the bytes it was read from.
#[derive(Debug, Clone)]
pub(in crate::cell) struct Spanned<T> {
    pub(super) span: Range<usize>,
    pub(super) value: T,
}

impl<T> Spanned<T> {
    pub(in crate::cell) fn get(&self) -> &T {
        &self.value
    }
}

/// Something that stands in the file.
pub(in crate::cell) trait HasSpan {
    /// Its bytes.
    fn span(&self) -> Range<usize>;
}

impl<T> HasSpan for Spanned<T> {
    fn span(&self) -> Range<usize> {
        self.span.clone()
    }
}

/// The unit in which the file has a number.
pub(in crate::cell) trait Unit {
    /// The number in SI units.
    fn si(number: f64) -> f64;
}

/// Defines units by their conversions.
macro_rules! units {
    ($($unit:ident: $si:expr;)*) => {
        $(
            #[derive(Debug, Clone)]
            pub(in crate::cell) struct $unit;

            impl Unit for $unit {
                fn si(number: f64) -> f64 {
                    $si(number)
                }
            }
        )*
    };
}

units! {
    Si: std::convert::identity;
    Mm: mm_to_m;
    Mm2: mm2_to_m2;
    Um: um_to_m;
    Deg: deg_to_rad;
    Mrad: mrad_to_rad;
    Urad: urad_to_rad;
    Arcmin: arcmin_to_rad;
    Percent: percent_to_fraction;
    Minutes: min_to_s;
    Rpm: rpm_to_hz;
    NPerMm: n_per_mm_to_n_per_m;
    NPerMm2: n_per_mm2_to_pa;
}

pub(in crate::cell) type Text = Spanned<String>;

/// A number in a unit; checked and converted by `Source::number` and its kin.
#[derive(Debug, Clone)]
pub(in crate::cell) struct Number<U = Si> {
    pub(super) at: Spanned<f64>,
    pub(super) unit: PhantomData<U>,
}

impl<U> Number<U> {
    /// As the file has it, in its unit.
    pub(in crate::cell) fn get(&self) -> f64 {
        *self.at.get()
    }
}

impl<U> HasSpan for Number<U> {
    fn span(&self) -> Range<usize> {
        self.at.span()
    }
}

/// Numbers in a unit.
pub(in crate::cell) type List<U = Si> = Spanned<Vec<Number<U>>>;

/// So many numbers in a unit; how many are there is checked when they are taken.
#[derive(Debug, Clone)]
pub(in crate::cell) struct Fixed<const N: usize, U = Si>(pub(in crate::cell) List<U>);

impl<const N: usize, U> HasSpan for Fixed<N, U> {
    fn span(&self) -> Range<usize> {
        self.0.span()
    }
}

#[cfg(feature = "schema")]
impl<T: JsonSchema> JsonSchema for Spanned<T> {
    fn inline_schema() -> bool {
        T::inline_schema()
    }
    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }
    fn schema_id() -> Cow<'static, str> {
        T::schema_id()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        T::json_schema(generator)
    }
}

#[cfg(feature = "schema")]
impl<U> JsonSchema for Number<U> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Number".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "number" })
    }
}

#[cfg(feature = "schema")]
impl<const N: usize, U> JsonSchema for Fixed<N, U> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        format!("Numbers{N}").into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "array", "items": { "type": "number" }, "minItems": N, "maxItems": N })
    }
}
