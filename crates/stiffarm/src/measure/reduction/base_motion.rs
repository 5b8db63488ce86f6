//! Motion of the robot's base under load, seen by reflectors on it.
//!
//! One or two reflectors, or reflectors on a line, give a shift; three or more
//! give a rigid motion, turn included. Either is taken back from the loaded
//! positions of the same state.
//!
//! A base reflector counts in a whole posture or not at all. Its motion also
//! holds the tracker's drift, so a correction of some states and not of the
//! others would add what it should remove.

use super::messages::{length, postures_first};
use crate::error::{Code, Error, Result};
use crate::findings::{Finding, Severity, list};
use crate::measure::registration::rigid_transform;
use crate::measure::series::{Pair, PostureSeries};
use crate::model::measurement::{ReferencePart, Role};
use crate::numerics::information::{Svd, svd};
use nalgebra::{DMatrix, Isometry3, Matrix3, Point3, Vector3};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Ratio of the second to the first spread of points below which they count as
/// on a line: a turn about that line could hardly be seen.
const ON_A_LINE: f64 = 0.05;
/// Motion above so many times its expected length is named.
const NAMED_MOTION_RATIO: f64 = 3.0;
/// E‖x‖ of 3 and of 6 standard normal numbers.
const MEAN_LENGTH: [f64; 2] = [1.595_769, 2.349_964];
/// Noise by the turn above so many times that of a displacement is named.
const NOISY_TURN: f64 = 2.0;

/// The largest motion of the base in one posture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BaseMotion {
    /// Posture.
    pub posture: String,
    /// Load state in which the base moves most.
    pub state: String,
    /// Reflectors used.
    pub reflectors: usize,
    /// True where a turn was taken back too, false for a shift alone.
    pub turn_removed: bool,
    /// Mean shift of the reflectors against the reference, base axes \[m\].
    pub shift_m: [f64; 3],
    /// Turn of the base \[rad\], base axes; zero where only a shift was seen.
    pub turn_rad: [f64; 3],
    /// Largest length taken off the displacement of a measuring point \[m\].
    pub largest_correction_m: f64,
    /// Standard deviation that the correction adds to each displacement
    /// component, common to the posture's points \[m\]: root mean square.
    pub noise_m: f64,
    /// Shift and turn together, weighted by their noise, over what noise alone
    /// would give on average.
    pub times_noise: f64,
}

/// The reflectors of a posture that every state with measuring points has.
///
/// A reflector that is missing in one state is left out of the whole posture:
/// its motion also holds the tracker's drift, so a correction of some states
/// and not of the others would put into the displacements what it should take out.
pub(super) fn usable(posture: &PostureSeries<'_>) -> Vec<usize> {
    let states: BTreeSet<usize> =
        posture.points.iter().flat_map(|(_, series)| series.states.iter().map(|s| s.state)).collect();
    (0..posture.base.len())
        .filter(|r| {
            let series = &posture.base[*r].1;
            states.iter().all(|state| series.state(*state).is_some())
        })
        .collect()
}

/// Motion of the base in one loaded state against the reference, tracker axes.
#[derive(Debug, Clone)]
pub(in crate::measure) struct Motion {
    /// Takes a loaded position back.
    back: Isometry3<f64>,
    shift: Vector3<f64>,
    turn: Vector3<f64>,
    centre: Vector3<f64>,
    /// Σ(|c|²I − ccᵀ) and its inverse, the covariance of the turn over the
    /// variance of a displacement; `None` where only a shift is seen.
    turn_information: Option<[Matrix3<f64>; 2]>,
    /// Variance of one reflector's position over a reading's: loaded, and the
    /// reference. Their sum is that of its displacement.
    parts: [f64; 2],
    variance: f64,
    reflectors: usize,
}

impl Motion {
    /// Motion of the `usable` reflectors in the loaded state `number`; `None`
    /// without reflectors.
    ///
    /// # Errors
    /// The decomposition of the rigid motion fails.
    pub(super) fn new(posture: &PostureSeries<'_>, usable: &[usize], number: usize) -> Result<Option<Self>> {
        let pairs: Vec<Pair> =
            usable.iter().filter_map(|r| posture.base[*r].1.pair(number, posture.reference)).collect();
        Motion::of(&pairs)
    }

    /// Motion of reflectors from where each was to where it is, one reading of
    /// either; `None` without reflectors.
    ///
    /// # Errors
    /// As [`Motion::new`].
    pub(in crate::measure) fn between(
        positions: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)>,
    ) -> Result<Option<Self>> {
        let pairs: Vec<Pair> = positions
            .map(|(reference, loaded)| Pair {
                reference,
                loaded,
                readings: 1,
                parts: vec![ReferencePart::reading(0)],
                clock: 0.0,
            })
            .collect();
        Motion::of(&pairs)
    }

    fn of(pairs: &[Pair]) -> Result<Option<Self>> {
        if pairs.is_empty() {
            return Ok(None);
        }
        let count = pairs.len() as f64;
        let mean = |of: fn(&Pair) -> Vector3<f64>| pairs.iter().map(of).sum::<Vector3<f64>>() / count;
        let (from, to) = (mean(|p| p.reference), mean(|p| p.loaded));
        let loaded = pairs.iter().map(|p| 1.0 / f64::from(p.readings));
        let reference = pairs.iter().map(Pair::variance_of_reference);
        let parts = [loaded.sum::<f64>() / count, reference.sum::<f64>() / count];
        let mut motion = Motion {
            back: Isometry3::translation(from.x - to.x, from.y - to.y, from.z - to.z),
            shift: to - from,
            turn: Vector3::zeros(),
            centre: from,
            turn_information: None,
            parts,
            variance: parts[0] + parts[1],
            reflectors: pairs.len(),
        };
        let arms: Vec<Vector3<f64>> = pairs.iter().map(|p| p.reference - from).collect();
        if !on_a_line(&arms) {
            // About the reflectors' centre, so that a turn costs no digits.
            let centred = pairs.iter().map(|p| (p.loaded - to, p.reference - from));
            let fit = rigid_transform(centred)
                .ok_or_else(|| Error::new(Code::Numerical, "The motion of the base reflectors cannot be computed."))?;
            let about = |p: Vector3<f64>| Isometry3::translation(p.x, p.y, p.z);
            motion.back = about(from) * fit * about(-to);
            motion.turn = -fit.rotation.scaled_axis();
            let information: Matrix3<f64> =
                arms.iter().map(|c| Matrix3::identity() * c.norm_squared() - c * c.transpose()).sum();
            motion.turn_information = information.try_inverse().map(|inverse| [information, inverse]);
        }
        Ok(Some(motion))
    }

    /// The loaded position `p` as it would be without the base's motion.
    pub(in crate::measure) fn removed(&self, p: &Vector3<f64>) -> Vector3<f64> {
        match self.turn_information {
            None => p - self.shift,
            Some(_) => (self.back * Point3::from(*p)).coords,
        }
    }

    /// Variance that the correction adds along an axis at `p`, over a reading's.
    pub(in crate::measure) fn added_variance(&self, p: &Vector3<f64>) -> f64 {
        let arm = (p - self.centre).cross_matrix();
        let turn = self.turn_information.map_or(0.0, |[_, inverse]| (arm * inverse * arm.transpose()).trace() / 3.0);
        self.variance * (1.0 / self.reflectors as f64 + turn)
    }

    /// Variance that the correction adds to the points at `loaded` alike, along
    /// an axis and over a reading's: in the loaded state, and with the reference.
    pub(super) fn common(&self, loaded: &[Vector3<f64>]) -> [f64; 2] {
        let added: f64 = loaded.iter().map(|p| self.added_variance(p)).sum();
        let mean = added / loaded.len().max(1) as f64;
        self.parts.map(|part| mean * part / self.variance)
    }

    /// How large it is, with the lengths it takes off the points at `loaded`.
    pub(super) fn describe(
        &self,
        posture: &str,
        state: &str,
        loaded: &[Vector3<f64>],
        base_from_tracker: &Isometry3<f64>,
        reading_std: f64,
    ) -> BaseMotion {
        let turn = base_from_tracker.rotation;
        let lengths = loaded.iter().map(|p| (p - self.removed(p)).norm());
        let added: f64 = loaded.iter().map(|p| self.added_variance(p)).sum();
        let (turned, mean_length) = match &self.turn_information {
            Some([information, _]) => (self.turn.dot(&(information * self.turn)), MEAN_LENGTH[1]),
            None => (0.0, MEAN_LENGTH[0]),
        };
        let size = (self.reflectors as f64 * self.shift.norm_squared() + turned).sqrt();
        let noise = reading_std * self.variance.sqrt() * mean_length;
        BaseMotion {
            posture: posture.to_string(),
            state: state.to_string(),
            reflectors: self.reflectors,
            turn_removed: self.turn_information.is_some(),
            shift_m: (turn * self.shift).into(),
            turn_rad: (turn * self.turn).into(),
            largest_correction_m: lengths.fold(0.0, f64::max),
            noise_m: reading_std * (added / loaded.len().max(1) as f64).sqrt(),
            times_noise: if noise > 0.0 { size / noise } else { 0.0 },
        }
    }
}

/// True where points, given from their mean, are fewer than three or on a line.
pub(super) fn on_a_line(from_mean: &[Vector3<f64>]) -> bool {
    if from_mean.len() < 3 {
        return true;
    }
    let rows = DMatrix::from_fn(from_mean.len(), 3, |i, j| from_mean[i][j]);
    match svd(rows) {
        Some(Svd { values, .. }) => values[1] <= ON_A_LINE * values[0],
        None => true,
    }
}

/// Reflectors that could not be used, and what the base does.
pub(super) fn findings(postures: &[PostureSeries<'_>], motions: &[BaseMotion], reading_std: f64) -> Vec<Finding> {
    let mut out = Vec::new();
    if postures.iter().all(|p| p.base.is_empty()) {
        return out;
    }
    let measured = |p: &&PostureSeries<'_>| p.states(Role::Loaded).next().is_some();
    let mut without: Vec<&str> = Vec::new();
    for posture in postures.iter().filter(measured) {
        let used = usable(posture);
        let missing: Vec<&str> =
            (0..posture.base.len()).filter(|r| !used.contains(r)).map(|r| posture.base[r].0.as_str()).collect();
        if !missing.is_empty() {
            out.push(Finding::caution(
                "base-reflector-incomplete",
                posture.name(),
                format!(
                    "Posture {} has readings of {} in some states only: left out in this posture, because a \
                     correction of some states and not of the others would add what it should remove.",
                    posture.name(),
                    list(&missing)
                ),
            ));
        }
        if used.is_empty() {
            without.push(posture.name());
        }
    }
    if !without.is_empty() {
        out.push(Finding::caution(
            "base-motion-unknown",
            "base",
            format!(
                "{}: no base reflector was read in every state, so the motion of the base stays in the \
                 displacements.",
                postures_first(&without)
            ),
        ));
    }
    let largest = |of: fn(&BaseMotion) -> f64| motions.iter().max_by(|a, b| of(a).total_cmp(&of(b)));
    let clear = largest(|m| m.times_noise).filter(|m| m.times_noise > NAMED_MOTION_RATIO);
    if let Some(most) = clear {
        let turn = if most.turn_removed {
            format!(" and turns by {:.3} mrad", Vector3::from(most.turn_rad).norm() * 1e3)
        } else {
            String::new()
        };
        let how = match (most.turn_removed, most.reflectors) {
            (true, n) => format!("Taken back as a rigid motion of its {n} reflectors."),
            (false, 1) => {
                "Taken back as a shift: one reflector does not show a turn of the base; three would.".to_string()
            }
            (false, n) => format!(
                "Taken back as a shift: these {n} reflectors do not show a turn of the base; three that are not on a \
                 line would."
            ),
        };
        out.push(Finding::new(
            "base-motion",
            if most.turn_removed { Severity::Note } else { Severity::Caution },
            "base",
            format!(
                "The base moves by {}{turn} under load (posture {}, state {}), {:.0} times what noise alone would \
                 show. {how}",
                length(Vector3::from(most.shift_m).norm()),
                most.posture,
                most.state,
                most.times_noise
            ),
        ));
    }
    let limit = NOISY_TURN * std::f64::consts::SQRT_2 * reading_std;
    if let Some(most) = largest(|m| m.noise_m).filter(|m| m.turn_removed && m.noise_m > limit) {
        let beside = match clear {
            Some(_) => "",
            None => " This experiment cannot tell the motion itself from noise.",
        };
        out.push(Finding::caution(
            "base-turn-noise",
            "base",
            format!(
                "Taking back the turn of the base adds noise of {} to each displacement component, common to the \
                 points of a posture (posture {}).{beside} Place the base reflectors further apart, or read them more \
                 often.",
                length(most.noise_m),
                most.posture
            ),
        ));
    }
    out
}
