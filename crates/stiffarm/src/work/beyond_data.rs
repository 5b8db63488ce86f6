//! What goes beyond the displacements and forces that an identification has seen.

use crate::findings::{Finding, length, percent};

/// Codes of the findings about it.
pub(crate) const BEYOND: [&str; 2] = ["beyond-measured", "beyond-load"];

/// Larger by this part is as large.
const ROUNDING: f64 = 1e-6;

/// The largest that an identification has seen, where it is known.
#[derive(Debug, Clone, Copy)]
pub(crate) struct IdentifiedRange {
    /// Size of a displacement of a point \[m\].
    pub(crate) displacement: Option<f64>,
    /// Size of a force \[N\].
    pub(crate) force: Option<f64>,
}

/// Which part of the points, each with the sizes of its deflection \[m\] and its force \[N\], lies beyond `seen`.
pub(crate) fn beyond_data(subject: &str, points: &[(f64, f64)], seen: IdentifiedRange) -> Vec<Finding> {
    let mut out = Vec::new();
    let mut tell = |code: &str, beyond: usize, what: String| {
        if beyond == 0 {
            return;
        }
        let share = percent(beyond as f64 / points.len() as f64);
        let sentence = format!("{share} of the points {what}: the model is trusted beyond its data there.");
        out.push(Finding::caution(code, subject, sentence));
    };
    let slack = |seen: f64| seen * (1.0 + ROUNDING);
    if let Some(seen) = seen.displacement.map(slack) {
        tell(
            BEYOND[0],
            points.iter().filter(|(size, _)| *size > seen).count(),
            format!("bend by more than any displacement that the identification has seen ({})", length(seen)),
        );
    }
    if let Some(seen) = seen.force.map(slack) {
        tell(
            BEYOND[1],
            points.iter().filter(|(_, force)| *force > seen).count(),
            format!("are under a larger force than any that the identification has seen ({seen:.0} N)"),
        );
    }
    out
}
