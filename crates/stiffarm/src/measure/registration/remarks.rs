//! What else to know about a registration whose pairs are not wrong.

use super::fit::{RigidFit, Sample};
use super::suspects::{Suspicion, chi_squared_tail, f_tail, mm};
use crate::error::{Code, Error, Result};
use crate::findings::Finding;

/// Chance at which residuals contradict a known variance, or tell a scale.
const SIGNIFICANCE: f64 = 1e-3;
/// Standard error of the turn above which it is worth a word: stiffness shifts
/// by up to 0.3 % per mrad \[rad\].
const UNCERTAIN_TURN: f64 = 1e-3;
/// Standard error beyond which the first order no longer holds \[rad\].
const FREE_TURN: f64 = 0.05;
/// Residual RMS, as a share of the set's size, that no measurement leaves.
const NOT_RIGID: f64 = 0.03;

/// Remarks in the order of their weight.
///
/// # Errors
/// A turn that the pairs leave all but free.
pub(super) fn remarks(
    samples: &[Sample],
    fit: &RigidFit,
    suspicion: &Suspicion,
    noise_std: Option<f64>,
) -> Result<Vec<Finding>> {
    let mut findings = Vec::new();
    let degrees_of_freedom = 3 * samples.len() - 6;
    let residual_std = (fit.rss / degrees_of_freedom as f64).sqrt();
    if let Some(finding) = not_rigid(fit) {
        return Ok(vec![finding]);
    }
    findings.extend(scale(samples, fit, degrees_of_freedom));
    if let Some(std) = noise_std {
        let too_large = chi_squared_tail(fit.rss / std.powi(2), degrees_of_freedom) < SIGNIFICANCE;
        findings.extend((too_large && !fit.is_exact()).then(|| {
            Finding::caution(
                "residuals-exceed-noise",
                "std",
                format!(
                    "The residuals are {:.1} times the standard deviation that is given ({} mm per coordinate): the \
                     covariance is too small, or the sets differ by more than noise.",
                    residual_std / std,
                    mm(std)
                ),
            )
        }));
    }
    findings.extend(turn(fit, noise_std.unwrap_or(residual_std))?);
    if samples.len() == 3 {
        findings.push(Finding::note(
            "few-pairs",
            "pairs",
            "Three pairs cannot tell which of them is wrong, nor whether a frame is mirrored: measure five or more.",
        ));
    } else if !suspicion.hand_is_known() {
        findings.push(Finding::note(
            "hand-unknown",
            "pairs",
            format!(
                "The points lie in a plane (to {} mm RMS), so a mirrored frame would fit as well: make sure that both \
                 frames are right-handed, or add a point off the plane.",
                mm(fit.spread[2] / fit.weight.sqrt())
            ),
        ));
    }
    Ok(findings)
}

/// Sets of different shape, where no single pair accounts for it.
fn not_rigid(fit: &RigidFit) -> Option<Finding> {
    let [a, b, c] = fit.spread;
    let size = (a.powi(2) + b.powi(2) + c.powi(2)).sqrt();
    (fit.rss.sqrt() > NOT_RIGID * size).then(|| {
        let root = fit.weight.sqrt();
        Finding::serious(
            "not-rigid",
            "pairs",
            format!(
                "The two sets do not have the same shape: the residual RMS is {} mm in a set of {} mm about its \
                 centroid. Several labels may be in another order, or several points wrong.",
                mm(fit.rss.sqrt() / root),
                mm(size / root)
            ),
        )
    })
}

/// A scale between the frames that the residuals show.
fn scale(samples: &[Sample], fit: &RigidFit, degrees_of_freedom: usize) -> Option<Finding> {
    let freedom = degrees_of_freedom - 1;
    let (mut product, mut square) = (0.0, 0.0);
    for s in samples {
        let turned = fit.pose.rotation * (s.tracker - fit.tracker_centroid);
        product += s.weight * turned.dot(&fit.residual(s));
        square += s.weight * turned.norm_squared();
    }
    let stretch = product / square;
    let explained = product * stretch;
    let rest = (fit.rss - explained).max(fit.rounding);
    if freedom == 0 || fit.is_exact() || f_tail([explained, rest], [1, freedom]) > SIGNIFICANCE {
        return None;
    }
    let error = (rest / freedom as f64 / square).sqrt();
    let more = if stretch > 0.0 { "longer" } else { "shorter" };
    Some(Finding::caution(
        "scale",
        "pairs",
        format!(
            "Distances between the points are {:.4} % {more} in base axes than in tracker axes (standard error {:.4} \
             %): temperature, a scale set in the tracker's software, or the robot's model where it gave the base \
             positions.",
            stretch.abs() * 100.0,
            error * 100.0
        ),
    ))
}

/// A turn that is uncertain, mostly that about a line which the points are near to.
fn turn(fit: &RigidFit, std: f64) -> Result<Option<Finding>> {
    let [a, b, c] = fit.spread;
    let error = std / (b.powi(2) + c.powi(2)).sqrt();
    if error < UNCERTAIN_TURN {
        return Ok(None);
    }
    let root = fit.weight.sqrt();
    let uncertain = format!("{:.1} mrad (standard error)", error * 1e3);
    let extent = format!(
        "the points extend {} mm (RMS) along that line and {} mm off it",
        mm(a / root),
        mm((b.powi(2) + c.powi(2)).sqrt() / root)
    );
    if error > FREE_TURN {
        let message = format!(
            "The points are too near to a line for their residuals: the turn about it is uncertain by {uncertain}."
        );
        return Err(Error::new(Code::Registration, message).hint(format!("{extent}: add a point well off the line")));
    }
    Ok(Some(Finding::caution(
        "uncertain-turn",
        "pairs",
        format!(
            "The turn about the line through the points is uncertain by {uncertain}: {extent}. Spread the points wider."
        ),
    )))
}
