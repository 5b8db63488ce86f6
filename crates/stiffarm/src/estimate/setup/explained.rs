//! Which other findings only follow from a set-up that is stated wrongly.

use crate::findings::{Finding, codes};
use crate::measure::Measured;
use crate::measure::screening::{Cause, Screening};

/// What the checks of the raw readings say where the displacements are not those that the set-up lets expect.
const BY_SCREENING: [Cause; 4] =
    [Cause::ReversedForce, Cause::ExchangedStates, Cause::DisplacementSize, Cause::OtherLoad];
/// What the residuals say.
const BY_RESIDUALS: [&str; 7] = [
    codes::RESIDUALS_ABOVE_NOISE,
    codes::FURTHER_TERM,
    codes::OUTLYING_DISPLACEMENT,
    codes::OUTLYING_POSTURE,
    codes::OUTLYING_POINT,
    codes::MORE_OUTLIERS,
    codes::LOAD_OFFSET,
];

/// Whether the readings have a fault of their own that must be settled before they say anything of the set-up.
pub(crate) fn is_doubtful(measured: &Measured) -> bool {
    let screening = measured.screening.iter();
    let mut all = screening.flat_map(|s| s.suspicions.iter().zip(&s.findings));
    all.any(|(suspicion, finding)| finding.is_serious() && !BY_SCREENING.contains(&suspicion.cause))
}

/// Whether a finding of the screening only follows from the set-up.
pub(crate) fn is_explained(finding: &Finding) -> bool {
    let mut all = BY_SCREENING.iter();
    all.any(|cause| cause.facts().0 == finding.code)
}

/// Whether a finding of the residuals does.
pub(crate) fn follows(finding: &Finding) -> bool {
    BY_RESIDUALS.contains(&finding.code.as_str())
}

/// The screening without what only follows from the set-up.
pub(crate) fn leave_out_explained(screening: &mut Screening) {
    let unexplained: Vec<bool> = screening.findings.iter().map(|f| !is_explained(f)).collect();
    let mut both = unexplained.iter();
    screening.suspicions.retain(|_| both.next() != Some(&false));
    screening.findings.retain(|finding| !is_explained(finding));
}
