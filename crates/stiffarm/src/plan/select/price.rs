//! What each kind of limit costs a plan.

use super::{GlobalOptions, select};
use crate::error::Result;
use crate::model::cell::{Cell, LimitKind};
use crate::numerics::control::Control;
use crate::numerics::order::sort_by_number;
use crate::plan::index::Index;
use serde::{Deserialize, Serialize};

/// A plan without one kind of limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LimitPrice {
    /// The kind of limit that is left out.
    pub kind: LimitKind,
    /// The index of the best plan found without it.
    pub value: f64,
    /// What the limit costs: the share by which the index with it is worse.
    pub price: f64,
}

/// The best plan found without each kind of limit that the cell has, by the same search; `value` is
/// that of the plan with all of them. A limit that costs nothing is met by the plan without it, or by one as
/// good.
///
/// # Errors
/// As [`select`].
pub fn limit_prices(
    cell: &Cell,
    index: Index,
    count: usize,
    options: &GlobalOptions,
    value: f64,
    control: Control<'_>,
) -> Result<Vec<LimitPrice>> {
    let mut prices = Vec::new();
    for kind in cell.limit_kinds() {
        if control.stopped() {
            break;
        }
        let free = cell.without_limit(kind);
        let selection = select(&free, index, count, options, control)?;
        // The plan under all limits is one without this one, too.
        let better = if index.larger_is_better() { selection.value.max(value) } else { selection.value.min(value) };
        let price = if index.larger_is_better() { better / value - 1.0 } else { value / better - 1.0 };
        prices.push(LimitPrice { kind, value: better, price });
    }
    sort_by_number(&mut prices, |a| -a.price);
    Ok(prices)
}
