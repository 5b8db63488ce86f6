//! Zones of joints 2 and 3 in which stiffness identification is good, after
//! Dumas et al.
//!
//! C. Dumas, S. Caro, S. Garnier, B. Furet, *Joint stiffness identification of
//! six-revolute industrial serial robots*, Robot. Comput.-Integr. Manuf. 27(4),
//! 2011, 881–888: joints 2 and 3 move the end-effector most, so the others are
//! held (joint 1 at zero, joints 4 to 6 at 45°) and two maps over (q2, q3) are
//! laid on each other, the dexterity 1/k(J_N) of Eqs. (20)–(21), and the
//! influence of K_C: how far translation and rotation of the end-effector
//! computed with and without it differ. K_C is the load's full stiffness here,
//! the turning of a rope included. Good zones combine high dexterity with
//! a small influence.

use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::dexterity::{condition_number, require_six_joints};
use crate::model::observation::{PostureTerms, check_angles};
use crate::model::stiffness::{linear_displacement, rope_correction, stiffness_correction};
use crate::numerics::control::Control;
use crate::units::{deg_to_rad, rad_to_sentence_deg, rad_to_shortest_deg, rounded};
use serde::{Deserialize, Serialize};

/// Joints of the map, counted from 0.
const MAPPED: [usize; 2] = [1, 2];
/// Angles of the joints that are held \[deg\]; joints 2 and 3 are placeholders.
const HELD_DEG: [f64; 6] = [0.0, 0.0, 0.0, 45.0, 45.0, 45.0];
/// Fewest and most steps of an axis of the map.
pub const STEPS: [usize; 2] = [2, 500];
/// A zone's postures are among this share of the map's most dexterous ones.
const DEXTEROUS: f64 = 0.25;
/// Their deviations are among this share of the map's smallest.
const UNTOUCHED: f64 = 0.5;

/// What is mapped.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ZoneOptions {
    /// Angles per axis of the map, from bound to bound.
    pub steps: usize,
    /// Controller angles of all joints \[rad\]; those of joints 2 and 3 are
    /// replaced by the map's. `None` is Dumas' choice, for robots of six joints.
    pub q: Option<Vec<f64>>,
}

impl Default for ZoneOptions {
    fn default() -> Self {
        ZoneOptions { steps: 41, q: None }
    }
}

/// A quantity over the map: rows by q3 ascending, columns by q2 ascending;
/// `None` where the posture violates a limit of the cell or is singular.
pub type ZoneMap = Vec<Vec<Option<f64>>>;

/// Smallest, middle and largest value of a map.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MapRange {
    /// Smallest value.
    pub smallest: f64,
    /// Median.
    pub median: f64,
    /// Largest value.
    pub largest: f64,
}

/// The best zone: a connected part of the map around its most dexterous
/// posture, where 1/k(J_N) is in the map's upper quarter and both deviations
/// are in its lower half.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Zone {
    /// Postures of the map that belong to it.
    pub posture_count: usize,
    /// Smallest and largest q2 \[rad\].
    #[serde(rename = "q2_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 2]"))]
    pub q2: [f64; 2],
    /// Smallest and largest q3 \[rad\].
    #[serde(rename = "q3_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 2]"))]
    pub q3: [f64; 2],
    /// Its most dexterous posture, controller angles of all joints \[rad\].
    #[serde(rename = "best_q_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub best_q: Vec<f64>,
    /// 1/k(J_N) there.
    pub inverse_condition: f64,
    /// Relative deviation of the translation there (fraction).
    pub translation_deviation: f64,
    /// Relative deviation of the rotation there (fraction).
    pub rotation_deviation: f64,
}

/// Maps over (q2, q3), with the other joints held.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Zones {
    /// Names of the joints of the map: its horizontal, its vertical axis.
    pub joints: [String; 2],
    /// Controller angles of all joints \[rad\]; `null` for the two that are mapped.
    #[serde(rename = "held_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Option<f64>>"))]
    pub held: Vec<Option<f64>>,
    /// Angles q2, ascending \[rad\].
    #[serde(rename = "q2_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub q2: Vec<f64>,
    /// Angles q3, ascending \[rad\].
    #[serde(rename = "q3_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub q3: Vec<f64>,
    /// 1/k(J_N) at the TCP, 0 to 1: rows by q3, columns by q2; `null` where the
    /// posture violates a limit of the cell or is singular.
    pub inverse_condition: ZoneMap,
    /// ‖δ_C − δ‖/‖δ‖ of the TCP's translation δ under the cell's load, computed
    /// with (δ_C) and without K_C, the load's full stiffness (fraction); as `inverse_condition`.
    pub translation_deviation: ZoneMap,
    /// The same of the rotation vector (fraction).
    pub rotation_deviation: ZoneMap,
    /// Postures of the map.
    pub postures: usize,
    /// Those that meet the limits of the cell.
    pub within_limits: usize,
    /// Range of 1/k(J_N), where there is any.
    pub inverse_condition_range: Option<MapRange>,
    /// Range of the translation's deviation (fraction).
    pub translation_range: Option<MapRange>,
    /// Range of the rotation's deviation (fraction).
    pub rotation_range: Option<MapRange>,
    /// The best zone, where dexterity and small influence of K_C meet.
    pub best: Option<Zone>,
}

/// The three values of one posture.
#[derive(Debug, Clone, Copy)]
struct Values {
    dexterity: f64,
    translation: f64,
    rotation: f64,
}

/// Maps dexterity and the influence of K_C over the bounds of joints 2 and 3.
///
/// k(J_N) is taken at the TCP (measuring point 1) with the cell's
/// characteristic length. K_C is all that the cell's load adds to the stiffness
/// in each posture: Chen and Kao's for a constant base-frame wrench
/// ([`stiffness_correction`]) and what a rope adds because it turns with the
/// loading point ([`rope_correction`]), which is mostly larger.
/// Displacements are those of the TCP by the linear model with the prior
/// stiffness.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm_files::builtin;
/// use stiffarm::plan::characteristic_length::with_characteristic_length;
/// use stiffarm::plan::zones::{ZoneOptions, zones};
///
/// let cell = with_characteristic_length(builtin::cell("comau-reference")?)?;
/// let mut options = ZoneOptions::default();
/// options.steps = 5;
/// let maps = zones(&cell, &options, stiffarm::Control::default())?;
/// assert_eq!((maps.postures, maps.q2.len()), (25, 5));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Fewer than six joints; another number than six and no angles given; angles
/// of the wrong number, not finite or outside the machine's limits; a number of
/// steps outside [`STEPS`]; a cell without prior stiffness, characteristic
/// length or a load that is known without a measurement.
pub fn zones(cell: &Cell, options: &ZoneOptions, control: Control<'_>) -> Result<Zones> {
    let robot = &cell.setup.robot;
    let mut q = held(cell, options)?;
    let steps = options.steps;
    if !(STEPS[0]..=STEPS[1]).contains(&steps) {
        return Err(
            Error::invalid(format!("A map has {} to {} steps per axis, not {steps}.", STEPS[0], STEPS[1])).key("steps")
        );
    }
    let [q2, q3] = MAPPED.map(|joint| axis(cell.bounds[joint], steps));
    let inside = |joint: usize, angles: &[f64]| -> Vec<f64> {
        let [low, high] = cell.bounds[joint];
        // An end of the axis may lie a rounding outside.
        angles.iter().map(|a| a.max(low).min(high)).collect()
    };
    let (columns, rows) = (inside(MAPPED[0], &q2), inside(MAPPED[1], &q3));
    let mut within_limits = 0;
    let mut margins = cell.margins();
    let mut grid: Vec<Vec<Option<Values>>> = Vec::with_capacity(steps);
    for (done, q3) in rows.iter().enumerate() {
        control.check()?;
        control.report("mapping zones", done, steps);
        let mut row = Vec::with_capacity(steps);
        for q2 in &columns {
            (q[MAPPED[0]], q[MAPPED[1]]) = (*q2, *q3);
            let terms = PostureTerms::new(&cell.setup, &q, None)?;
            let inside = margins.least(&terms) >= 0.0;
            within_limits += usize::from(inside);
            row.push(if inside { values(cell, &terms)? } else { None });
        }
        grid.push(row);
    }
    let map = |value: fn(&Values) -> f64| -> ZoneMap {
        let row = |row: &Vec<Option<Values>>| row.iter().map(|v| v.as_ref().map(value)).collect();
        grid.iter().map(row).collect()
    };
    let inverse_condition = map(|v| v.dexterity);
    let translation_deviation = map(|v| v.translation);
    let rotation_deviation = map(|v| v.rotation);
    let best = best_zone(&grid).map(|(at_best, places)| {
        let (row, column) = places[0];
        (q[MAPPED[0]], q[MAPPED[1]]) = (columns[column], rows[row]);
        Zone {
            posture_count: places.len(),
            q2: ends(&q2, places.iter().map(|(_, c)| *c)),
            q3: ends(&q3, places.iter().map(|(r, _)| *r)),
            best_q: q.clone(),
            inverse_condition: at_best.dexterity,
            translation_deviation: at_best.translation,
            rotation_deviation: at_best.rotation,
        }
    });
    let names = MAPPED.map(|j| robot.joints()[j].name.clone());
    let held = q.iter().enumerate();
    let held = held.map(|(j, q)| (!MAPPED.contains(&j)).then_some(*q)).collect();
    Ok(Zones {
        joints: names,
        held,
        postures: steps * steps,
        within_limits,
        inverse_condition_range: range(inverse_condition.iter().flatten().flatten().copied()),
        translation_range: range(translation_deviation.iter().flatten().flatten().copied()),
        rotation_range: range(rotation_deviation.iter().flatten().flatten().copied()),
        best,
        q2,
        q3,
        inverse_condition,
        translation_deviation,
        rotation_deviation,
    })
}

/// Equal steps over a range \[rad\], rounded to a billionth of a degree.
fn axis(range: [f64; 2], steps: usize) -> Vec<f64> {
    let [low, high] = range.map(rad_to_shortest_deg);
    let at = |i: usize| low + (high - low) * i as f64 / (steps - 1) as f64;
    (0..steps).map(|i| deg_to_rad(rounded(at(i), 9))).collect()
}

/// Angles of all joints \[rad\], those of the map at their lower bounds.
fn held(cell: &Cell, options: &ZoneOptions) -> Result<Vec<f64>> {
    let robot = &cell.setup.robot;
    let n = robot.joint_count();
    require_six_joints(robot)?;
    let mut q = match &options.q {
        Some(q) => q.clone(),
        None if n == HELD_DEG.len() => HELD_DEG.map(deg_to_rad).to_vec(),
        None => {
            return Err(Error::new(
                Code::MissingKey,
                format!("Dumas' choice of the held angles is for six joints, and {} has {n}.", robot.name()),
            )
            .key("q_deg")
            .hint(format!("give the angles of all {n} joints (those of joints 2 and 3 are replaced by the map's)")));
        }
    };
    check_angles(robot, &q).map_err(|error| error.key("q_deg"))?;
    for j in MAPPED {
        q[j] = cell.bounds[j][0];
    }
    match cell.outside_machine_limits(&q) {
        None => Ok(q),
        Some((j, angle)) => {
            let joint = &robot.joints()[j];
            let [low, high] = joint.limits.map(rad_to_sentence_deg);
            Err(Error::new(
                Code::OutsideLimits,
                format!(
                    "{} is held at {}°, outside the machine's limits, {low}° to {high}°.",
                    joint.name,
                    rad_to_sentence_deg(angle)
                ),
            )
            .key("q_deg")
            .hint("hold the joints at angles the machine can take"))
        }
    }
}

/// Values at one posture, `None` where it is singular, where nothing bends, or
/// where the load would buckle the arm.
fn values(cell: &Cell, terms: &PostureTerms) -> Result<Option<Values>> {
    let (prior, length) = (cell.require_prior()?, cell.require_characteristic_length()?);
    let tcp = terms.measuring_points()[0];
    let Some(condition) = condition_number(terms.frames(), &tcp, length) else {
        return Ok(None);
    };
    let without = linear_displacement(&cell.setup, terms, &tcp, prior, None)?;
    let correction = stiffness_correction(terms) + rope_correction(&cell.setup.load, terms);
    let Ok(with) = linear_displacement(&cell.setup, terms, &tcp, prior, Some(&correction)) else {
        return Ok(None);
    };
    let deviation = |from: usize| {
        let change = (with - without).fixed_rows::<3>(from).norm();
        change / without.fixed_rows::<3>(from).norm()
    };
    let values = Values { dexterity: 1.0 / condition, translation: deviation(0), rotation: deviation(3) };
    let all = [values.dexterity, values.translation, values.rotation];
    Ok(all.iter().all(|v| v.is_finite()).then_some(values))
}

/// Smallest, middle and largest of values, where there are any.
pub(crate) fn range(values: impl IntoIterator<Item = f64>) -> Option<MapRange> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    Some(MapRange { smallest: *values.first()?, median: at_share(&values, 0.5)?, largest: *values.last()? })
}

/// The value that this share of ascending `values` does not exceed.
fn at_share(values: &[f64], share: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    values.get((share * last as f64).round() as usize).copied()
}

/// Values at the best posture of the best zone, and row and column of each of
/// its postures, the best first.
fn best_zone(grid: &[Vec<Option<Values>>]) -> Option<(Values, Vec<(usize, usize)>)> {
    let sorted = |value: fn(&Values) -> f64| {
        let mut values: Vec<f64> = grid.iter().flatten().flatten().map(value).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let dexterous = at_share(&sorted(|v| v.dexterity), 1.0 - DEXTEROUS)?;
    let translation = at_share(&sorted(|v| v.translation), UNTOUCHED)?;
    let rotation = at_share(&sorted(|v| v.rotation), UNTOUCHED)?;
    let good = |(r, c): (usize, usize)| {
        grid[r][c].filter(|v| v.dexterity >= dexterous && v.translation <= translation && v.rotation <= rotation)
    };
    let places = (0..grid.len()).flat_map(|r| (0..grid[r].len()).map(move |c| (r, c)));
    let candidates = places.filter_map(|place| Some((place, good(place)?)));
    let more_dexterous = |(_, a): &(_, Values), (_, b): &(_, Values)| b.dexterity > a.dexterity;
    let (start, best) = candidates.reduce(|a, b| if more_dexterous(&a, &b) { b } else { a })?;
    // What is connected to the best posture, side by side.
    let mut seen: Vec<Vec<bool>> = grid.iter().map(|row| vec![false; row.len()]).collect();
    seen[start.0][start.1] = true;
    let mut places = vec![start];
    let mut next = 0;
    while let Some(&(r, c)) = places.get(next) {
        next += 1;
        let beside = [(r.wrapping_sub(1), c), (r + 1, c), (r, c.wrapping_sub(1)), (r, c + 1)];
        for (r, c) in beside {
            let inside = r < grid.len() && c < grid[r].len();
            if inside && !seen[r][c] && good((r, c)).is_some() {
                seen[r][c] = true;
                places.push((r, c));
            }
        }
    }
    Some((best, places))
}

/// Smallest and largest of `angles` at the places that are asked for.
fn ends(angles: &[f64], places: impl Iterator<Item = usize>) -> [f64; 2] {
    places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], i| [low.min(angles[i]), high.max(angles[i])])
}
