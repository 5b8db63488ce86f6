//! Quantities of the set-up that are identified on purpose, together with the stiffness.

use super::freed::{QuantityFit, SETTLED_LIKELIHOOD};
use super::{FreedQuantity, described, value};
use crate::error::{Code, Error, Result, did_you_mean};
use crate::estimate::elastic::ElasticChoice;
use crate::estimate::identify::Fit;
use crate::estimate::quantity::facts::Quantity;
use crate::estimate::quantity::stated::StatedExperiment;
use crate::estimate::quantity::value::{QuantityAtValue, QuantityValue};
use crate::measure::Measured;
use nalgebra::Matrix3;

/// Most searches beside the springs beyond the axes: each is one step of least squares.
const SEARCHES: usize = 8;
/// A number whose standard error reaches this share of what a quantity can be is not told \[m; rad\], of a force \[N\].
const UNTOLD_ERROR: f64 = 0.3;
const UNTOLD_FORCE_ERROR: f64 = 1e3;

/// The fit where the readings want the quantities that its options name in `free`, and these with their errors: found
/// by least squares beside the compliances, and beside springs beyond the axes where `elastic` grants these. The errors
/// that are common to the experiment have then what the readings leave of each. `None` where nothing is to be free.
///
/// # Errors
/// A name that there is not, or twice; a quantity on which these readings do not depend, or that they cannot tell.
pub fn free(fit: &Fit, elastic: ElasticChoice) -> Result<Option<(Fit, Vec<FreedQuantity>)>> {
    let names = &fit.options().free;
    if names.is_empty() {
        return Ok(None);
    }
    let stated = StatedExperiment::of(fit);
    let start = wanted(&stated, names)?;
    let before = QuantityFit::new(start.clone(), fit.clone(), false, None)?;
    let mut at = stated.refined(before);
    let is_mixed = elastic == ElasticChoice::Mixed;
    let mut all = value(fit, None);
    if is_mixed {
        let granted = QuantityFit::new(start, fit.clone(), true, None)?;
        all = granted.value;
        at = QuantityFit::new(at.values, at.fit, true, granted.sizes.as_ref())?;
        for _ in 0..SEARCHES {
            let next = stated.refined(at.clone());
            let fall = at.value - next.value;
            at = next;
            if fall < SETTLED_LIKELIHOOD {
                break;
            }
        }
    }
    let freed = described(&stated, &at, all);
    for ((quantity, _), freed_quantity) in at.values.iter().zip(&freed) {
        let most = match quantity.facts().unit {
            "N" => UNTOLD_FORCE_ERROR,
            _ => UNTOLD_ERROR,
        };
        let is_told = |error: &Option<f64>| error.is_some_and(|error| error < most);
        if !freed_quantity.standard_error.iter().all(is_told) {
            let message = format!("These readings cannot tell the {} beside the stiffness.", quantity.facts().what);
            return Err(Error::new(Code::TooFewData, message).key("free").hint(
                "leave it out; or measure more postures, a second anchor or several load states, which tell it apart",
            ));
        }
    }
    let (cell, measured) = stated.changed(&at.values)?;
    let measured = Measured { postures: measured.postures, ..fit.measured().clone() };
    Ok(Some((fit.at(&cell, measured)?, freed)))
}

/// What the names mean here, as stated.
fn wanted(stated: &StatedExperiment<'_>, names: &[String]) -> Result<Vec<QuantityAtValue>> {
    let cell = stated.cell();
    let here = stated.quantities();
    let joints = cell.setup.robot.joint_count();
    let mut out: Vec<QuantityAtValue> = Vec::new();
    for (i, name) in names.iter().enumerate() {
        let refused = |code, message: String| Error::new(code, message).key("free");
        if names[..i].contains(name) {
            return Err(refused(Code::Duplicate, format!("\"{name}\" is to be free twice.")).hint("name it once"));
        }
        if !Quantity::can_be_free().any(|free_name| free_name == name) {
            let free_names: Vec<&str> = Quantity::can_be_free().collect();
            let message = match Quantity::named(name) {
                Some(quantity) if quantity.terms(0).is_some() => {
                    format!("\"{name}\" is not a quantity of the set-up: it gives way.")
                }
                Some(_) => format!("No reading tells \"{name}\" beside the stiffness."),
                None => format!("There is no quantity \"{name}\" of the set-up."),
            };
            let hint = match Quantity::named(name) {
                Some(Quantity::BaseTilt) => Some("it is an extra term: base".to_string()),
                Some(Quantity::LostMotion) => Some("it is an extra term: lost".to_string()),
                _ => did_you_mean(name, free_names.iter().copied()),
            };
            let hint = hint.unwrap_or_else(|| format!("one of {}", free_names.join(", ")));
            return Err(refused(Code::UnknownName, message).hint(hint));
        }
        let quantities = here.iter().filter(|quantity| quantity.name() == name);
        let from = out.len();
        out.extend(quantities.map(|quantity| {
            let count = quantity.dimension(joints);
            (*quantity, QuantityValue::new(Matrix3::identity(), vec![0.0; count]))
        }));
        if out.len() == from {
            let free_names: Vec<&str> =
                Quantity::can_be_free().filter(|name| here.iter().any(|quantity| quantity.name() == *name)).collect();
            let message = format!("These readings do not depend on \"{name}\" in this cell.");
            return Err(refused(Code::Unsupported, message).hint(format!("they do on {}", free_names.join(", "))));
        }
    }
    Ok(out)
}
