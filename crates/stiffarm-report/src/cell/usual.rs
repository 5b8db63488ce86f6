//! The posture that shows a cell without a plan.

use stiffarm::Result;
use stiffarm::model::cell::{Cell, LimitMargin};
use stiffarm::model::posture::Posture;

/// Names of postures of a cell without postures.
pub(super) const MIDDLE: &str = "the middle of the bounds";
pub(super) const NEAR_MIDDLE: &str = "a posture near the middle of the bounds";
/// Postures around the middle of the bounds that are tried.
const TRIED: u32 = 2048;

/// The posture that shows a cell without a plan: the middle of its bounds; where that violates a
/// limit, the first validation posture that does not, else the first such posture as one looks
/// farther and farther around the middle. Where all violate a limit, the middle after all.
///
/// # Errors
/// Limits that cannot be computed in the middle of the bounds.
pub fn usual_posture(cell: &Cell) -> Result<Posture> {
    let mut margins = cell.posture_margins()?;
    let mut meets = |q: &[f64]| Ok(!margins.named(q)?.iter().any(LimitMargin::is_violated));
    let named = |name: &str, q: Vec<f64>| Posture { name: name.to_string(), q };
    let bounds = &cell.bounds;
    let middle = named(MIDDLE, bounds.iter().map(|[a, b]| 0.5 * (a + b)).collect());
    if meets(&middle.q)? {
        return Ok(middle);
    }
    let mut fits = |posture: &Posture| matches!(meets(&posture.q), Ok(true));
    if let Some(validation) = cell.validation.iter().find(|posture| fits(posture)) {
        return Ok(validation.clone());
    }
    // Powers of the root of x^(n+1) = x + 1: their multiples spread evenly in n dimensions (Roberts).
    let dimensions = bounds.len() as f64 + 1.0;
    let root = (0..40).fold(1.5_f64, |x, _| (1.0 + x).powf(1.0 / dimensions));
    let mut around = (1..=TRIED).map(|i| {
        let reach = f64::from(i) / f64::from(TRIED);
        let q = bounds.iter().enumerate().map(|(j, [a, b])| {
            let share = (f64::from(i) / root.powf(j as f64 + 1.0)).fract() - 0.5;
            0.5 * (a + b) + (b - a) * share * reach
        });
        named(NEAR_MIDDLE, q.collect())
    });
    Ok(around.find(fits).unwrap_or(middle))
}
