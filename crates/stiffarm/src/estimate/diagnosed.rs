//! What the residuals of a fit say for good: after the set-up was asked, and without what follows from something else.

use super::diagnose::{Diagnosis, diagnose_in};
use super::identify::{Fit, implausible_scale};
use super::mixed::MixedFit;
use super::setup;
use crate::error::Result;
use crate::findings::{Finding, codes};
use crate::measure::screening::Screening;

/// What the residuals say. What speaks against the axes alone has its answer in the mixed model, where it predicts;
/// what follows from a set-up that is rejected is no finding of its own.
///
/// # Errors
/// As [`diagnose`].
pub(crate) fn diagnosed(fit: &Fit, mixed: Option<&MixedFit>) -> Result<Diagnosis> {
    let mut out = diagnose_in(fit, mixed)?;
    let of_axes = [codes::RESIDUALS_ABOVE_NOISE, codes::FURTHER_TERM];
    out.findings.retain(|finding| !(mixed.is_some() && of_axes.contains(&&*finding.code)));
    if !setup::is_doubtful(fit.measured()) {
        let outlying: Vec<String> = (out.outliers.found.iter()).filter_map(|outlier| outlier.posture.clone()).collect();
        out.set_up = setup::set_up(fit, mixed, &outlying)?;
    }
    if out.rejected().is_some() {
        out.findings.retain(|finding| !setup::follows(finding));
    }
    let of_set_up = out.set_up.iter().filter_map(|set_up| set_up.finding.clone());
    out.findings.splice(0..0, of_set_up.collect::<Vec<_>>());
    Ok(out)
}

/// What a fit says against its readings: stiffnesses of another scale, residuals. What a wrong scale of the table
/// explains is no finding of its own.
///
/// # Errors
/// As [`Fit::identification`].
pub(crate) fn doubts(fit: &Fit, diagnosis: Option<&Diagnosis>) -> Result<Vec<Finding>> {
    if is_misread(fit) {
        return Ok(Vec::new());
    }
    let implausible = implausible_scale(fit.cell(), fit.identification()?);
    let diagnosed = diagnosis.iter().flat_map(|diagnosis| &diagnosis.findings).cloned();
    Ok(implausible.into_iter().chain(diagnosed).collect())
}

/// Whether the table has a wrong scale.
pub(crate) fn is_misread(fit: &Fit) -> bool {
    let screening = fit.measured().screening.iter();
    let mut scales = screening.flat_map(Screening::scales);
    scales.any(Finding::is_serious)
}
