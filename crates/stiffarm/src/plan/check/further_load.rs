//! What a weight, hung in the same postures as well, adds to a load that goes through one point or one way.

use crate::findings::{Finding, length};
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::model::observation::{PostureTerms, Setup};
use crate::plan::index::prediction::PredictionModel;
use crate::units::STANDARD_GRAVITY;
use serde::{Deserialize, Serialize};

/// A weight that leaves more than this share of the error is not worth a word.
const WORTH_A_WORD: f64 = 0.9;
/// Code of the finding about it.
pub const ONE_LOAD: &str = "one-load";

/// A weight as heavy as the load pulls, hung at the loading point in every posture beside the cell's load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FurtherLoad {
    /// Its mass \[kg\].
    pub mass_kg: f64,
    /// The index prediction without it \[m\].
    pub without: f64,
    /// The index prediction with it \[m\].
    pub with: f64,
}

impl FurtherLoad {
    /// What it gives at `postures` (controller angles, rad); `None` where the cell's load is a weight, several or measured,
    /// where the cell lacks what the index prediction needs, and where it gains little.
    pub(crate) fn new<Q: AsRef<[f64]>>(cell: &Cell, postures: &[Q]) -> Option<Self> {
        if !matches!(cell.setup.load, Load::Rope { .. } | Load::Constant { .. }) {
            return None;
        }
        let model = PredictionModel::of_cell(cell).ok()?;
        let rope = terms(&cell.setup, postures)?;
        let pull = rope.first()?.wrench().force.norm();
        let hung = cell.setup.under_weight(pull);
        let both = rope.iter().cloned().zip(terms(&hung, postures)?);
        let both: Vec<[PostureTerms; 2]> = both.map(|(a, b)| [a, b]).collect();
        let alone: Vec<[PostureTerms; 1]> = rope.into_iter().map(|terms| [terms]).collect();
        let found = FurtherLoad {
            mass_kg: pull / STANDARD_GRAVITY,
            without: model.value(&alone)?,
            with: model.value(&both)?,
        };
        (found.with < WORTH_A_WORD * found.without).then_some(found)
    }

    /// The same as a finding about random postures.
    pub(super) fn finding(&self, cell: &Cell, postures: usize) -> Finding {
        let what = match cell.setup.load {
            Load::Rope { .. } => "Every pull goes through the anchor",
            _ => "The load always pulls one way",
        };
        Finding::note(
            ONE_LOAD,
            "load",
            format!(
                "{what}, so that some of what gives way is never loaded: after {postures} random postures deflections under \
                 forces in all directions can be predicted to {}, with a weight of {:.0} kg hung in the same postures as \
                 well to {} (a second [[load.case]], docs/selecting.md).",
                length(self.without),
                self.mass_kg,
                length(self.with)
            ),
        )
    }
}

fn terms<Q: AsRef<[f64]>>(setup: &Setup, postures: &[Q]) -> Option<Vec<PostureTerms>> {
    let under = |q: &Q| PostureTerms::new(setup, q.as_ref(), None).ok();
    postures.iter().map(under).collect()
}
