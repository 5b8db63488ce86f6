//! How near postures come to the limits of a cell, and what leaves none.

mod obstruction;
mod on_limits;

pub use obstruction::{Obstruction, ViolatedKind, obstruction};
pub(crate) use obstruction::{nothing_meets, obstruction_among};
pub use on_limits::{on_limits, on_machine_limits};

use crate::error::Result;
use crate::model::cell::{Cell, LimitKind, LimitMargin, MarginUnit};
use crate::model::observation::{PostureTerms, Setup, check_angles};
use crate::model::posture::Posture;
use crate::units::rad_to_sentence_deg;
use serde::{Deserialize, Serialize};

/// How near one posture comes to the limits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PostureLimits {
    /// Of each kind of limit that the cell has, the smallest margin.
    pub nearest: Vec<NearestLimit>,
    /// The tracker's station that sees most, where stations are given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub station: Option<String>,
    /// Names of the measuring points that it sees.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub visible_points: Vec<String>,
    /// Torques of load and tool weight, serial joints \[N·m\], where they are limited; of several
    /// loads the largest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub torques_nm: Vec<f64>,
    /// Displacement under the load by the prior stiffness, RMS over the measuring points \[m\], where
    /// it is limited; of several loads the largest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement_m: Option<f64>,
}

/// The smallest margin to the limits of one kind: positive inside.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NearestLimit {
    /// Kind of limit.
    pub kind: LimitKind,
    /// What comes nearest: two shapes, a point, a joint.
    pub subject: String,
    /// Of several load cases the one under which it comes nearest, where the limit depends on the load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load: Option<String>,
    /// Margin of a length or a displacement \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin_m: Option<f64>,
    /// Margin of an angle \[rad\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin_rad: Option<f64>,
    /// Margin as a share of the limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin_share: Option<f64>,
}

impl From<&LimitMargin> for NearestLimit {
    fn from(margin: &LimitMargin) -> Self {
        let of = |unit| (margin.kind.unit() == unit).then_some(margin.margin);
        NearestLimit {
            kind: margin.kind,
            subject: margin.point.clone(),
            load: margin.load.clone(),
            margin_m: of(MarginUnit::Length).or(of(MarginUnit::Displacement)),
            margin_rad: of(MarginUnit::Angle),
            margin_share: of(MarginUnit::Share),
        }
    }
}

/// The largest displacement under a load, where it is limited.
fn displacement(cell: &Cell, states: &[PostureTerms]) -> Option<f64> {
    let limits = cell.scene.displacement()?;
    let each = states.iter().map(|terms| limits.displacement(terms));
    each.reduce(f64::max)
}

/// Of the torques under each load, joint by joint, the largest either way.
fn largest_torques(cell: &Cell, setups: &[Setup], states: &[PostureTerms]) -> Vec<f64> {
    let each = setups.iter().zip(states);
    let each = each.filter_map(|(setup, terms)| cell.scene.torques(setup, terms));
    let larger = |a: Vec<f64>, b: Vec<f64>| {
        let pairs = a.iter().zip(&b);
        pairs.map(|(a, b)| if b.abs() > a.abs() { *b } else { *a }).collect()
    };
    each.reduce(larger).unwrap_or_default()
}

/// What forbids the posture `q` (controller angles, rad) in the cell, as the end of a sentence about
/// it: the first bound that it is outside of, else the limit that it violates most.
///
/// # Errors
/// Angles or bounds that do not fit the robot; a rope without a direction.
pub fn forbidden(cell: &Cell, q: &[f64]) -> Result<Option<String>> {
    check_angles(&cell.setup.robot, q)?;
    if let Some(joint) = cell.outside_bounds(q).next() {
        return Ok(Some(beyond_bounds(cell, joint)));
    }
    let smallest = cell.posture_margins()?.smallest(q)?;
    let violated = smallest.filter(LimitMargin::is_violated);
    Ok(violated.map(|margin| margin.violation()))
}

/// One bound or limit of a cell that a posture violates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Violation {
    /// Name of the posture.
    pub posture: String,
    /// What is wrong and by how much, as the end of a sentence about the posture.
    pub sentence: String,
    /// The limit, its margin below zero; none for a joint outside the cell's bounds.
    pub limit: Option<NearestLimit>,
}

/// The bounds that the postures are outside of, and of each kind of limit that they violate the one
/// violated most, posture by posture.
///
/// # Errors
/// Angles or bounds that do not fit the robot; a rope without a direction.
pub fn violations(cell: &Cell, postures: &[Posture]) -> Result<Vec<Violation>> {
    let mut margins = cell.posture_margins()?;
    let mut violations = Vec::new();
    for posture in postures {
        check_angles(&cell.setup.robot, &posture.q)?;
        let violation = |sentence, limit| Violation { posture: posture.name.clone(), sentence, limit };
        let outside = cell.outside_bounds(&posture.q);
        violations.extend(outside.map(|joint| violation(beyond_bounds(cell, joint), None)));
        let named = margins.named(&posture.q)?;
        for kind in LimitKind::ALL {
            let violated = named.iter().filter(|m| m.kind == kind && m.is_violated());
            let worst = violated.min_by(|a, b| a.margin.total_cmp(&b.margin));
            violations.extend(worst.map(|m| violation(m.violation(), Some(NearestLimit::from(m)))));
        }
    }
    Ok(violations)
}

/// That a joint is outside the cell's bounds, as the end of a sentence about a posture.
fn beyond_bounds(cell: &Cell, (j, angle): (usize, f64)) -> String {
    let [low, high] = cell.bounds[j].map(rad_to_sentence_deg);
    let angle = rad_to_sentence_deg(angle);
    let name = &cell.setup.robot.joints()[j].name;
    format!("has {name} at {angle}°, outside the cell's bounds, {low}° to {high}°")
}

impl PostureLimits {
    /// Margins at the posture `q` (controller angles, rad).
    ///
    /// # Errors
    /// As [`PostureTerms::new`].
    pub fn new(cell: &Cell, q: &[f64]) -> Result<Self> {
        let named = cell.posture_margins()?.named(q)?;
        let setups = cell.setup.cases();
        let under = |setup| PostureTerms::new(setup, q, None);
        let states: Vec<PostureTerms> = setups.iter().map(under).collect::<Result<_>>()?;
        let of_kind = |kind: LimitKind| {
            let finite = named.iter().filter(|m| m.kind == kind && m.margin.is_finite());
            finite.min_by(|a, b| a.margin.total_cmp(&b.margin))
        };
        let seen = cell.scene.seen(&states[0]);
        let station = seen.as_ref().zip(cell.scene.sight());
        let points = &cell.setup.tool.measuring_points;
        Ok(PostureLimits {
            nearest: LimitKind::ALL.into_iter().filter_map(of_kind).map(NearestLimit::from).collect(),
            station: station.map(|(seen, sight)| sight.stations[seen.station].name.clone()),
            visible_points: seen
                .map(|seen| seen.points.iter().map(|p| points[*p].name.clone()).collect())
                .unwrap_or_default(),
            torques_nm: largest_torques(cell, &setups, &states),
            displacement_m: displacement(cell, &states),
        })
    }

    /// The nearest limit of a kind.
    pub fn of(&self, kind: LimitKind) -> Option<&NearestLimit> {
        self.nearest.iter().find(|n| n.kind == kind)
    }

    /// The smallest margin of a length \[m\]; displacements do not count.
    pub fn smallest_m(&self) -> Option<f64> {
        let lengths = self.nearest.iter();
        lengths.filter(|n| n.kind.unit() == MarginUnit::Length).filter_map(|n| n.margin_m).reduce(f64::min)
    }
}
