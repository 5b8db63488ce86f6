//! One node of a map.

use super::options::MapOptions;
use super::reach::{Reach, Refusal, is_better};
use super::status::Status;
use crate::error::Result;
use crate::model::dexterity::condition_number;
use crate::numerics::control::Control;
use crate::work::predict::{Bands, PrincipalAxis, principal_axes};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// What a reachable node is like.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NodeValues {
    /// The posture that bends least, controller angles \[rad\].
    #[serde(rename = "q_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub q: Vec<f64>,
    /// Turn about the tool axis where that is free \[rad\].
    #[serde(rename = "turn_deg", with = "crate::units::degrees::all_digits")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub turn: Option<f64>,
    /// Force per shift along the map's direction, the tip being free to turn
    /// \[N/m\]; `None` where it does not give way.
    pub stiffness_n_per_m: Option<f64>,
    /// The softest direction and the stiffness along it.
    pub softest: PrincipalAxis,
    /// Shift of the tip under the map's load, base axes \[m\].
    pub shift_m: [f64; 3],
    /// Its size \[m\].
    pub deflection_m: f64,
    /// Half width of the size's band \[m\]; `None` where the stiffness comes
    /// without covariance.
    pub half_width_m: Option<f64>,
    /// The size over that of the force \[m/N\].
    pub deflection_per_newton_m: f64,
    /// k(J_N) of Eq. (21) at the tip; `None` at singular postures, below six
    /// joints, and where the cell has no characteristic length.
    pub k_jn: Option<f64>,
}

/// One node of a map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MapNode {
    /// Position of the tip, base frame \[m\].
    pub position_m: [f64; 3],
    /// Whether the arm may be there.
    pub status: Status,
    /// Why not.
    pub reason: Option<String>,
    /// How far away the nearest reachable position is, or by how much the cell's
    /// limit is violated \[m\].
    pub distance_m: Option<f64>,
    /// Its values, where it is reachable.
    pub values: Option<NodeValues>,
}

impl MapNode {
    /// A node that nobody waited for.
    pub(super) fn not_computed(position_m: [f64; 3]) -> Self {
        MapNode { position_m, status: Status::NotComputed, reason: None, distance_m: None, values: None }
    }
}

/// The node at `position`; stopped as `control` says.
pub(super) fn evaluate(
    reach: &Reach<'_>,
    bands: Option<&Bands>,
    options: &MapOptions,
    (rotations, control): (&[(f64, UnitQuaternion<f64>)], Control<'_>),
    position: [f64; 3],
) -> Result<MapNode> {
    // The posture whose deflection by the linear model is smallest: deflection and
    // strain, turn, angles.
    let mut best: Option<((f64, f64), f64, Vec<f64>)> = None;
    let mut nearest: Option<Refusal> = None;
    for (turn, rotation) in rotations {
        control.check()?;
        let tip = Isometry3::from_parts(Translation3::from(position), *rotation);
        let postures = match reach.postures(&tip)? {
            Ok(postures) => postures,
            Err(refusal) => {
                nearest = Some(refusal.nearer(nearest));
                continue;
            }
        };
        for q in postures {
            if let Some(refusal) = reach.refusal(&q)? {
                nearest = Some(refusal.nearer(nearest));
                continue;
            }
            let terms = reach.arm.terms(&q, &options.wrench)?;
            let size = reach.arm.linear(&terms).fixed_rows::<3>(0).norm();
            let strain = reach.strain(&q);
            if best.as_ref().is_none_or(|(than, ..)| is_better(size, strain, *than)) {
                best = Some(((size, strain), *turn, q));
            }
        }
    }
    let values = match best {
        Some((_, turn, q)) => Some(values(reach, bands, options, turn, &q)?),
        None => None,
    };
    let refusal = nearest.filter(|_| values.is_none());
    Ok(MapNode {
        position_m: position,
        status: refusal.as_ref().map_or(Status::Reachable, |r| r.status),
        distance_m: refusal.as_ref().and_then(|r| r.distance),
        reason: refusal.map(|r| r.reason),
        values,
    })
}

fn values(reach: &Reach<'_>, bands: Option<&Bands>, options: &MapOptions, turn: f64, q: &[f64]) -> Result<NodeValues> {
    let (arm, wrench) = (reach.arm, &options.wrench);
    let bent = arm.deflect(q, wrench)?;
    let terms = arm.terms(q, wrench)?;
    let shift: Vector3<f64> = bent.displacement.fixed_rows::<3>(0).into_owned();
    let compliance = arm.tip_compliance(&terms);
    let compliance = compliance.fixed_view::<3, 3>(0, 0).into_owned();
    let along = options.direction.dot(&(compliance * *options.direction));
    let [softest, ..] = principal_axes(&compliance);
    let tip = terms.measuring_points()[0];
    let length = reach.characteristic_length;
    let k_jn = length.and_then(|l| condition_number(terms.frames(), &tip, l));
    let half_width_m = bands.map(|b| b.of(arm, &[(shift, terms)])[0].size_m[3]);
    Ok(NodeValues {
        q: q.to_vec(),
        turn: options.free_turn.map(|_| turn),
        // Rounding of the largest entry is no compliance.
        stiffness_n_per_m: (along > f64::EPSILON * compliance.amax()).then(|| 1.0 / along),
        softest,
        shift_m: shift.into(),
        deflection_m: shift.norm(),
        half_width_m,
        deflection_per_newton_m: shift.norm() / wrench.force.norm(),
        k_jn,
    })
}
