//! Which other findings only follow from a set-up that is stated wrongly.

use crate::findings::{Finding, Severity};
use crate::measure::Measured;
use crate::measure::screening::{Cause, Screening};

/// What the checks of the raw readings say where the displacements are not those that the set-up lets expect.
const BY_SCREENING: [(Cause, &str); 4] = [
    (Cause::ReversedForce, "reversed-force"),
    (Cause::ExchangedStates, "exchanged-states"),
    (Cause::DisplacementSize, "displacement-size"),
    (Cause::OtherLoad, "other-load"),
];
/// What the residuals say.
const BY_RESIDUALS: [&str; 7] = [
    "residuals-above-noise",
    "further-term",
    "outlying-displacement",
    "outlying-posture",
    "outlying-point",
    "more-outliers",
    "load-offset",
];

/// Whether the readings have a fault of their own that must be settled before they say anything of the set-up.
pub(crate) fn is_doubtful(measured: &Measured) -> bool {
    let screening = measured.screening.iter();
    let mut all = screening.flat_map(|s| s.suspicions.iter().zip(&s.findings));
    all.any(|(suspicion, finding)| {
        let is_own = BY_SCREENING
            .iter()
            .all(|(cause, _)| *cause != suspicion.cause);
        finding.severity == Severity::Serious && is_own
    })
}

/// Whether a finding of the screening only follows from the set-up.
pub(crate) fn is_explained(finding: &Finding) -> bool {
    BY_SCREENING.iter().any(|(_, code)| *code == finding.code)
}

/// Whether a finding of the residuals does.
pub(crate) fn follows(finding: &Finding) -> bool {
    BY_RESIDUALS.contains(&finding.code.as_str())
}

/// The screening without what only follows from the set-up.
pub(crate) fn leave_out_explained(screening: &mut Screening) {
    let kept: Vec<bool> = screening
        .findings
        .iter()
        .map(|f| !is_explained(f))
        .collect();
    let mut both = kept.iter();
    screening.suspicions.retain(|_| both.next() != Some(&false));
    screening.findings.retain(|finding| !is_explained(finding));
}
