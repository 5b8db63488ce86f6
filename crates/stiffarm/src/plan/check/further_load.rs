//! What a weight, hung in the same postures as well, or a second anchor adds to a load that goes through one point or
//! one way.

use crate::findings::{Finding, codes, length, minutes};
use crate::model::cell::Cell;
use crate::model::kinematics::Frames;
use crate::model::load::{Load, LoadCase};
use crate::model::observation::{PostureTerms, Setup, on_first_axis};
use crate::plan::index::prediction::PredictionModel;
use crate::units::{STANDARD_GRAVITY, m_to_mm, rounded};
use nalgebra::{Rotation3, UnitVector3, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_3;

/// A weight that leaves more than this share of the error is not worth a word.
const WORTH_A_WORD: f64 = 0.9;
/// Anchors nearer to each other are as good as one \[m\].
const NEAR_ANCHOR: f64 = 0.2;

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
    /// What hanging it takes in all postures \[s\].
    pub time_s: f64,
    /// For where no weight can be hung; absent where the load is no rope, or another anchor gains little.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub anchor: Option<FurtherAnchor>,
}

/// A second anchor, to which the rope is hooked in every posture as well.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FurtherAnchor {
    /// Where, base frame: the first, a sixth of a turn about axis 1 away on the side that gains more \[m\].
    pub position_m: [f64; 3],
    /// The index prediction with it \[m\].
    pub with: f64,
    /// What setting it up and hooking the rope to it in all postures takes \[s\].
    pub time_s: f64,
}

impl FurtherLoad {
    /// What it gives at `postures` (controller angles, rad); `None` where the cell's load is a weight, several or
    /// measured, where the cell lacks what the index prediction needs, and where it gains little.
    pub(crate) fn new<Q: AsRef<[f64]>>(cell: &Cell, postures: &[Q]) -> Option<Self> {
        if !matches!(cell.setup.load, Load::Rope { .. } | Load::Constant { .. }) {
            return None;
        }
        let model = PredictionModel::of_cell(cell).ok()?;
        let rope = terms(&cell.setup, postures)?;
        let pull = rope.first()?.wrench().force.norm();
        let with = |further: &Setup| {
            let both = rope.iter().cloned().zip(terms(further, postures)?);
            let both: Vec<[PostureTerms; 2]> = both.map(|(a, b)| [a, b]).collect();
            model.value(&both)
        };
        let each: Vec<&[PostureTerms]> = rope.iter().map(std::slice::from_ref).collect();
        let without = model.value(&each)?;
        let takes = |second: &Load| {
            let both = both_loads(&cell.setup.load, second);
            let of = |load| cell.time.of(postures.len(), load);
            of(&both) - of(&cell.setup.load)
        };
        let hung = cell.setup.under_weight(pull);
        let further_load = FurtherLoad {
            mass_kg: pull / STANDARD_GRAVITY,
            without,
            with: with(&hung)?,
            time_s: takes(&hung.load),
            anchor: None,
        };
        if further_load.with >= WORTH_A_WORD * further_load.without {
            return None;
        }
        let anchors = other_anchors(&cell.setup).into_iter().filter_map(|setup| {
            let position_m = (*setup.load.anchors().next()?).into();
            let time_s = takes(&setup.load);
            let with = with(&setup).filter(|with| *with < WORTH_A_WORD * without)?;
            Some(FurtherAnchor { position_m, with, time_s })
        });
        let anchor = anchors.min_by(|a, b| a.with.total_cmp(&b.with));
        Some(FurtherLoad { anchor, ..further_load })
    }

    /// The same as a finding about random postures.
    pub(super) fn finding(&self, cell: &Cell, postures: usize) -> Finding {
        let what = match cell.setup.load {
            Load::Rope { .. } => "Every pull goes through the anchor",
            _ => "The load always pulls one way",
        };
        let anchor = self.anchor.map_or_else(String::new, |anchor| {
            let [x, y, z] = anchor.position_m.map(|v| rounded(m_to_mm(v), 0));
            format!(
                " Where none can be hung, hooking the rope to a second anchor as well, say at [{x}, {y}, {z}] mm, \
                 would lead to {} and take {} more.",
                length(anchor.with),
                minutes(anchor.time_s)
            )
        });
        Finding::note(
            codes::ONE_LOAD,
            "load",
            format!(
                "{what}, so that some of what gives way is never loaded: after {postures} random postures deflections \
                 under forces in all directions can be predicted to {}, with a weight of {:.0} kg hung in the same \
                 postures as well, {} more, to {} (a second [[load.case]], docs/selecting.md).{anchor}",
                length(self.without),
                self.mass_kg,
                minutes(self.time_s),
                length(self.with)
            ),
        )
    }
}

/// Both loads in every posture.
pub(crate) fn both_loads(first: &Load, second: &Load) -> Load {
    let case = |(number, load): (usize, &Load)| LoadCase {
        name: (number + 1).to_string(),
        load: load.clone(),
        loading_point: None,
    };
    Load::Cases([first, second].into_iter().enumerate().map(case).collect())
}

/// The rope from anchors a sixth of a turn about axis 1 away; none where there is no rope, or its anchor lies on the
/// axis.
fn other_anchors(setup: &Setup) -> Vec<Setup> {
    let Load::Rope { anchor, magnitude } = setup.load else {
        return Vec::new();
    };
    let frames = Frames::new(&setup.robot, &vec![0.0; setup.robot.joint_count()]);
    let axis = UnitVector3::new_normalize(frames.axes()[0]);
    let origin = on_first_axis(&frames);
    let turned =
        [FRAC_PI_3, -FRAC_PI_3].map(|angle| origin + Rotation3::from_axis_angle(&axis, angle) * (anchor - origin));
    let is_other = |point: &Vector3<f64>| (point - anchor).norm() > NEAR_ANCHOR;
    let others = turned.into_iter().filter(is_other);
    let under = |anchor| Setup { load: Load::Rope { anchor, magnitude }, ..setup.clone() };
    others.map(under).collect()
}

fn terms<Q: AsRef<[f64]>>(setup: &Setup, postures: &[Q]) -> Option<Vec<PostureTerms>> {
    let under = |q: &Q| PostureTerms::new(setup, q.as_ref(), None).ok();
    postures.iter().map(under).collect()
}
