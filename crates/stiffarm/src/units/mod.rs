//! Units of files and of the screen. Inside the library everything is SI: m, rad, N, N·m.

mod digits;
mod sense;

pub use digits::{rounded, sentence_with_minus, significant, significant_text, with_minus};
pub use sense::LARGEST_NUMBER;
pub use sense::Sense;

use nalgebra::UnitQuaternion;

/// Metres per millimetre.
pub const MM: f64 = 1e-3;

/// Standard gravity \[m/s²\].
pub const STANDARD_GRAVITY: f64 = 9.80665;

/// Millimetres to metres.
pub fn mm_to_m(mm: f64) -> f64 {
    // The division rounds once: 773 mm is the number nearest to 0.773 m.
    mm / 1e3
}

/// Metres to millimetres.
pub fn m_to_mm(m: f64) -> f64 {
    m * 1e3
}

/// Square millimetres to square metres.
pub fn mm2_to_m2(mm2: f64) -> f64 {
    mm2 / 1e6
}

/// Micrometres to metres.
pub fn um_to_m(um: f64) -> f64 {
    um / 1e6
}

/// Inches to metres.
pub fn in_to_m(inches: f64) -> f64 {
    inches * 0.0254
}

/// Kilonewtons to newtons.
pub fn kn_to_n(kn: f64) -> f64 {
    kn * 1e3
}

/// Newton millimetres to newton metres.
pub fn nmm_to_nm(nmm: f64) -> f64 {
    nmm / 1e3
}

/// Newtons per square millimetre to pascals.
pub fn n_per_mm2_to_pa(n_per_mm2: f64) -> f64 {
    n_per_mm2 * 1e6
}

/// Newtons per millimetre to newtons per metre.
pub fn n_per_mm_to_n_per_m(n_per_mm: f64) -> f64 {
    n_per_mm * 1e3
}

/// Milliseconds to seconds.
pub fn ms_to_s(ms: f64) -> f64 {
    ms / 1e3
}

/// Minutes to seconds.
pub fn min_to_s(min: f64) -> f64 {
    min * 60.0
}

/// Turns per minute to turns per second.
pub fn rpm_to_hz(rpm: f64) -> f64 {
    rpm / 60.0
}

/// Per cent to a fraction.
pub fn percent_to_fraction(percent: f64) -> f64 {
    percent / 1e2
}

/// Milliradians to radians.
pub fn mrad_to_rad(mrad: f64) -> f64 {
    mrad / 1e3
}

/// Microradians to radians.
pub fn urad_to_rad(urad: f64) -> f64 {
    urad / 1e6
}

/// Minutes of arc to radians.
pub fn arcmin_to_rad(arcmin: f64) -> f64 {
    (arcmin / 60.0).to_radians()
}

/// Degrees to radians.
pub fn deg_to_rad(deg: f64) -> f64 {
    deg.to_radians()
}

/// Radians to degrees.
pub fn rad_to_deg(rad: f64) -> f64 {
    rad.to_degrees()
}

/// The shortest decimal number of degrees that is read back as `rad`: 15,
/// where [`rad_to_deg`] gives 14.999999999999998.
///
/// Some angles lie between those that numbers of degrees reach; they get the
/// nearest one, off by the last bit. Written, read and written again, the text
/// is always the same.
pub fn rad_to_shortest_deg(rad: f64) -> f64 {
    shortest(rad, rad_to_deg, deg_to_rad)
}

/// The same for a sentence: of more than six decimals the first six, 114.591559.
pub fn rad_to_sentence_deg(rad: f64) -> f64 {
    rounded(rad_to_shortest_deg(rad), 6)
}

/// The shortest decimal number of millimetres that is read back as `m`, as
/// [`rad_to_shortest_deg`].
pub fn m_to_shortest_mm(m: f64) -> f64 {
    shortest(m, m_to_mm, mm_to_m)
}

/// Roll, pitch, yaw \[rad\] of a rotation Rz(yaw)·Ry(pitch)·Rx(roll): turns about
/// the fixed x, then y, then z axis, as `_rpy_deg` in files has them.
///
/// Near a pitch of ±90°, where roll and yaw are one and the same, they are
/// chosen so that the three still give the rotation to the last digits.
pub fn roll_pitch_yaw(rotation: &UnitQuaternion<f64>) -> [f64; 3] {
    let r = rotation.to_rotation_matrix();
    let roll = r[(2, 1)].atan2(r[(2, 2)]);
    let pitch = (-r[(2, 0)]).atan2(r[(2, 1)].hypot(r[(2, 2)]));
    // Yaw is what is left once this roll is undone.
    let (sine, cosine) = roll.sin_cos();
    let yaw = (sine * r[(0, 2)] - cosine * r[(0, 1)]).atan2(cosine * r[(1, 1)] - sine * r[(1, 2)]);
    [roll, pitch, yaw]
}

/// The number of fewest decimal digits that `back` turns into `value`, or else
/// into what `there` and `back` make of it.
pub fn shortest(value: f64, there: fn(f64) -> f64, back: fn(f64) -> f64) -> f64 {
    let find = |target: f64| {
        let near = there(target);
        // 17 digits are the number itself.
        let others = [near, near.next_up(), near.next_down()];
        // `near` is within rounding of each number that will do. One of fewer than
        // 14 digits is therefore what 14 digits round to: no need to try them.
        (14..17).map(|digits| significant(near, digits)).chain(others).find(|number| back(*number) == target)
    };
    let number = find(value).or_else(|| find(back(there(value))));
    // Adding zero turns −0 into 0.
    number.unwrap_or_else(|| there(value)) + 0.0
}

/// Angles that are radians in memory and degrees in JSON.
///
/// For a field of `f64`, and of options, lists and arrays of it:
/// `#[serde(rename = "angles_deg", with = "stiffarm::units::degrees")]`; with a
/// schema also `#[schemars(with = "Vec<f64>")]`, the type of the field. The
/// numbers written are those of [`rad_to_shortest_deg`], so what was written is
/// read and written again as the same text.
pub mod degrees {
    use super::{deg_to_rad, rad_to_deg, rad_to_shortest_deg};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// An angle, or several.
    pub trait Angles: Sized {
        /// The same with every angle converted.
        #[must_use]
        fn converted(&self, convert: fn(f64) -> f64) -> Self;
    }

    impl Angles for f64 {
        fn converted(&self, convert: fn(f64) -> f64) -> Self {
            convert(*self)
        }
    }

    impl<T: Angles> Angles for Option<T> {
        fn converted(&self, convert: fn(f64) -> f64) -> Self {
            self.as_ref().map(|angles| angles.converted(convert))
        }
    }

    impl<T: Angles> Angles for Vec<T> {
        fn converted(&self, convert: fn(f64) -> f64) -> Self {
            self.iter().map(|a| a.converted(convert)).collect()
        }
    }

    impl<T: Angles, const N: usize> Angles for [T; N] {
        fn converted(&self, convert: fn(f64) -> f64) -> Self {
            self.each_ref().map(|a| a.converted(convert))
        }
    }

    /// Writes radians as degrees.
    ///
    /// # Errors
    /// What the serializer reports.
    pub fn serialize<T: Angles + Serialize, S: Serializer>(angles: &T, serializer: S) -> Result<S::Ok, S::Error> {
        angles.converted(rad_to_shortest_deg).serialize(serializer)
    }

    /// Reads degrees as radians.
    ///
    /// # Errors
    /// What the deserializer reports.
    pub fn deserialize<'de, T: Angles + Deserialize<'de>, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<T, D::Error> {
        Ok(T::deserialize(deserializer)?.converted(deg_to_rad))
    }

    /// The same for angles that were computed rather than read: all their digits
    /// are written, as [`rad_to_deg`] has them.
    pub mod all_digits {
        pub use super::deserialize;
        use super::{Angles, rad_to_deg};
        use serde::{Serialize, Serializer};

        /// Writes radians as degrees.
        ///
        /// # Errors
        /// What the serializer reports.
        pub fn serialize<T: Angles + Serialize, S: Serializer>(angles: &T, serializer: S) -> Result<S::Ok, S::Error> {
            angles.converted(rad_to_deg).serialize(serializer)
        }
    }
}
