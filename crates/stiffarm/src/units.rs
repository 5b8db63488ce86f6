//! Units at the doors. Inside the library everything is SI: m, rad, N, N·m.

/// Metres per millimetre.
pub const MM: f64 = 1e-3;

/// Square metres per square millimetre.
pub const MM2: f64 = 1e-6;

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

/// The shortest decimal number of millimetres that is read back as `m`, as
/// [`rad_to_shortest_deg`].
pub fn m_to_shortest_mm(m: f64) -> f64 {
    shortest(m, m_to_mm, mm_to_m)
}

/// The number of fewest decimal digits that `back` turns into `value`, or else
/// into what `there` and `back` make of it.
fn shortest(value: f64, there: fn(f64) -> f64, back: fn(f64) -> f64) -> f64 {
    let find = |target: f64| {
        let near = there(target);
        let rounded = |digits: usize| format!("{near:.digits$e}").parse::<f64>().ok();
        let neighbours = [near.next_up(), near.next_down()];
        (0..17)
            .filter_map(rounded)
            .chain(neighbours)
            .find(|number| back(*number) == target)
    };
    let number = find(value).or_else(|| find(back(there(value))));
    // Adding zero turns −0 into 0.
    number.unwrap_or_else(|| there(value)) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn round_numbers_stay_round() {
        for deg in [15.0, -30.0, 0.1, 72.81, -272.36, 179.999, 0.0, -0.0] {
            assert_eq!(rad_to_shortest_deg(deg_to_rad(deg)), deg);
        }
        for mm in [773.0, 0.2, 1444.0, -0.123456] {
            assert_eq!(m_to_shortest_mm(mm_to_m(mm)), mm);
        }
        assert_eq!(mm_to_m(773.0), 0.773);
        assert!(rad_to_shortest_deg(-0.0).is_sign_positive());
    }

    proptest! {
        #[test]
        fn what_was_written_is_read_and_written_again(rad in -13.0..13.0f64, m in -10.0..10.0f64) {
            let deg = rad_to_shortest_deg(rad);
            let read = deg_to_rad(deg);
            prop_assert!((read - rad).abs() <= 2.0 * f64::EPSILON * rad.abs());
            prop_assert_eq!(rad_to_shortest_deg(read), deg);
            let mm = m_to_shortest_mm(m);
            let read = mm_to_m(mm);
            prop_assert!((read - m).abs() <= 2.0 * f64::EPSILON * m.abs());
            prop_assert_eq!(m_to_shortest_mm(read), mm);
        }

        #[test]
        fn degrees_and_millimetres_of_few_digits_stay(thousandths in -720_000i32..720_000) {
            let number = f64::from(thousandths) / 1e3;
            prop_assert_eq!(rad_to_shortest_deg(deg_to_rad(number)), number);
            prop_assert_eq!(m_to_shortest_mm(mm_to_m(number)), number);
        }
    }
}
