//! Numbers in sentences.

use nalgebra::Vector3;

/// A length in mm, or in µm below a hundredth of a millimetre.
pub(super) fn length(m: f64) -> String {
    match m.abs() {
        size if size >= 9.995e-4 => format!("{:.2} mm", m * 1e3),
        size if size >= 9.995e-6 => format!("{:.3} mm", m * 1e3),
        _ => format!("{:.2} µm", m * 1e6),
    }
}

/// `0.012 mm per hour (standard error 3.00 µm along an axis)`: a common rate, where there is one.
pub(super) fn rate(rate: Option<[f64; 3]>, error: Option<f64>, per: &str) -> Option<String> {
    let (size, error) = (Vector3::from(rate?).norm(), length(error?));
    Some(format!("{} per {per} (standard error {error} along an axis)", length(size)))
}

/// `posture 3`, or `postures 1, 2 and 3`.
pub(super) fn postures<S: AsRef<str>>(names: &[S]) -> String {
    let word = if names.len() == 1 { "posture" } else { "postures" };
    format!("{word} {}", crate::findings::list(names))
}

/// The same at the head of a sentence.
pub(super) fn postures_first<S: AsRef<str>>(names: &[S]) -> String {
    postures(names).replacen('p', "P", 1)
}

/// Median; the mean of the two middle values for an even count, zero for none.
pub(super) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => 0.0,
        n => (sorted[(n - 1) / 2] + sorted[n / 2]) / 2.0,
    }
}
