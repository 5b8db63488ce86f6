//! Loads and the wrench they put on the loading point.

use crate::error::{Error, Result};
use crate::model::kinematics::Frames;
use nalgebra::Vector3;

/// A wrench is the load's own up to its size where it is off by at most this
/// share: rounding. What a sensor measures never is.
const SAME_DIRECTION: f64 = 1e-10;

/// Force and moment at the loading point, base axes: W = \[F; M\], the wrench
/// *on* the robot \[N, N·m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench {
    /// Force F \[N\].
    pub force: Vector3<f64>,
    /// Moment M about the loading point \[N·m\].
    pub moment: Vector3<f64>,
}

impl Wrench {
    /// Force and moment changed alike: scaled, or turned into other axes.
    #[must_use]
    pub fn map(&self, change: impl Fn(&Vector3<f64>) -> Vector3<f64>) -> Self {
        Wrench { force: change(&self.force), moment: change(&self.moment) }
    }

    /// A pure force through the loading point.
    pub fn force(force: impl Into<Vector3<f64>>) -> Self {
        Wrench { force: force.into(), moment: Vector3::zeros() }
    }

    /// Whether it loads nothing.
    pub fn is_zero(&self) -> bool {
        self.force == Vector3::zeros() && self.moment == Vector3::zeros()
    }

    /// A wrench from its components \[Fx, Fy, Fz, Mx, My, Mz\] \[N; N·m\].
    pub fn from_components(components: [f64; 6]) -> Self {
        let [fx, fy, fz, mx, my, mz] = components;
        Wrench { force: Vector3::new(fx, fy, fz), moment: Vector3::new(mx, my, mz) }
    }

    /// Its components \[Fx, Fy, Fz, Mx, My, Mz\] \[N; N·m\].
    pub fn components(&self) -> [f64; 6] {
        let (f, m) = (&self.force, &self.moment);
        [f.x, f.y, f.z, m.x, m.y, m.z]
    }

    /// The same wrench about another point: M' = M + (from − to) × F.
    #[must_use]
    pub fn moved(&self, from: &Vector3<f64>, to: &Vector3<f64>) -> Self {
        Wrench { force: self.force, moment: self.moment + (from - to).cross(&self.force) }
    }
}

/// Axes in which a constant wrench is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axes {
    /// Fixed in the robot's base.
    Base,
    /// Turning with the flange.
    Tool,
}

/// How the robot is loaded.
#[derive(Debug, Clone, PartialEq)]
pub enum Load {
    /// A rope from the loading point P1 to a fixed anchor P2 (Section IV.A), or a
    /// cylinder or screw between the two: F = G (P2 − P1)/‖P2 − P1‖, M = 0.
    Rope {
        /// Anchor P2 in the base frame \[m\].
        anchor: Vector3<f64>,
        /// Force G \[N\]: positive where it pulls, negative where a cylinder pushes.
        magnitude: f64,
    },
    /// A hanging weight: constant force along gravity.
    Weight {
        /// Weight force \[N\].
        magnitude: f64,
        /// Direction of gravity, unit vector in base axes.
        direction: Vector3<f64>,
    },
    /// A constant wrench at the loading point.
    Constant {
        /// The wrench, in the axes named by `axes`.
        wrench: Wrench,
        /// Base or tool axes.
        axes: Axes,
    },
    /// The wrench comes with each measurement.
    Measured,
    /// Every posture is measured under each of these, one after the other.
    Cases(Vec<LoadCase>),
}

/// One of several loads under which every posture is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadCase {
    /// Name of the load, and of the state in tables of readings.
    pub name: String,
    /// The load; never [`Load::Cases`] or [`Load::Measured`].
    pub load: Load,
    /// Where it acts, flange axes \[m\]; `None` is the tool's loading point.
    pub loading_point: Option<Vector3<f64>>,
}

impl LoadCase {
    /// True where readings of the state `state` were taken under this load: its name, or
    /// its name with `-` and anything behind it.
    pub fn is_of(&self, state: &str) -> bool {
        let rest = state.strip_prefix(self.name.as_str());
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
    }
}

impl Load {
    /// Wrench at the loading point at one posture, or `None` for [`Load::Measured`] and
    /// [`Load::Cases`], which have none or several.
    ///
    /// `loading_point` is in the base frame \[m\]. A rope whose loading point
    /// lies on its anchor has no direction: the force is zero then.
    pub fn wrench(&self, frames: &Frames, loading_point: &Vector3<f64>) -> Option<Wrench> {
        match self {
            Load::Rope { anchor, magnitude } => {
                // F = G (P2 − P1)/‖P2 − P1‖, Section IV.A.
                let unit = (anchor - loading_point).try_normalize(f64::MIN_POSITIVE);
                Some(Wrench::force(unit.unwrap_or_default() * *magnitude))
            }
            Load::Weight { magnitude, direction } => Some(Wrench::force(direction * *magnitude)),
            Load::Constant { wrench, axes: Axes::Base } => Some(*wrench),
            Load::Constant { wrench, axes: Axes::Tool } => Some(wrench.map(|v| frames.direction(v))),
            Load::Measured | Load::Cases(_) => None,
        }
    }

    /// The load whose wrench at this posture is `wrench`, where that is the load's
    /// own up to its size, and turns when the arm moves: a rope pulled with
    /// another force, a wrench in tool axes. `None` where `wrench` keeps its
    /// direction: a weight, a measured wrench.
    pub(crate) fn following(&self, frames: &Frames, loading_point: &Vector3<f64>, wrench: &Wrench) -> Option<Load> {
        if let Load::Cases(cases) = self {
            // Under a load at a point of its own the wrench has a moment, and matches none.
            let candidates = cases.iter().filter(|case| case.loading_point.is_none());
            return candidates.filter_map(|case| case.load.following(frames, loading_point, wrench)).next();
        }
        if !matches!(self, Load::Rope { .. } | Load::Constant { axes: Axes::Tool, .. }) {
            return None;
        }
        let nominal = self.wrench(frames, loading_point)?;
        let size = nominal.force.norm_squared() + nominal.moment.norm_squared();
        let factor = (nominal.force.dot(&wrench.force) + nominal.moment.dot(&wrench.moment)) / size;
        let off = (wrench.force - nominal.force * factor).norm_squared()
            + (wrench.moment - nominal.moment * factor).norm_squared();
        let whole = wrench.force.norm_squared() + wrench.moment.norm_squared();
        // Not true for a load of zero either, whose factor is no number.
        if !(off <= SAME_DIRECTION * SAME_DIRECTION * whole && factor.is_finite()) {
            return None;
        }
        Some(match self {
            Load::Rope { anchor, magnitude } => Load::Rope { anchor: *anchor, magnitude: magnitude * factor },
            Load::Constant { wrench, axes } => Load::Constant { wrench: wrench.map(|v| v * factor), axes: *axes },
            other => other.clone(),
        })
    }

    /// Its load cases; empty where it is a single load.
    pub fn cases(&self) -> &[LoadCase] {
        match self {
            Load::Cases(cases) => cases,
            _ => &[],
        }
    }

    /// True where every posture is measured under each of several loads.
    pub fn has_cases(&self) -> bool {
        !self.cases().is_empty()
    }

    /// Names of its load cases, for a sentence.
    pub fn case_names(&self) -> String {
        let names: Vec<&str> = self.cases().iter().map(|case| case.name.as_str()).collect();
        names.join(", ")
    }

    /// Number of the load case that readings of the state `state` were taken under; 0 where
    /// there is a single load.
    ///
    /// # Errors
    /// A state that belongs to none of the load cases.
    pub fn case_of(&self, state: &str) -> Result<usize> {
        let position = self.cases().iter().position(|case| case.is_of(state));
        position.or((!self.has_cases()).then_some(0)).ok_or_else(|| {
            let message = format!("The state \"{state}\" belongs to no load case of the cell.");
            Error::invalid(message).key("state").hint(format!(
                "name states after the load cases, with -2 and so on where one is taken again: {}",
                self.case_names()
            ))
        })
    }

    /// The loads that a posture is measured under: its cases, or itself.
    pub fn each(&self) -> impl Iterator<Item = &Load> {
        let cases = self.cases();
        let alone = cases.is_empty().then_some(self);
        alone.into_iter().chain(cases.iter().map(|case| &case.load))
    }

    /// Anchors of its ropes, base frame \[m\].
    pub fn anchors(&self) -> impl Iterator<Item = &Vector3<f64>> {
        self.each().filter_map(|load| match load {
            Load::Rope { anchor, .. } => Some(anchor),
            _ => None,
        })
    }

    /// True where one of its loads is a rope.
    pub fn has_rope(&self) -> bool {
        self.each().any(|load| matches!(load, Load::Rope { .. }))
    }

    /// True where one of its loads is a wrench with a moment.
    pub fn has_moment(&self) -> bool {
        let is_turned = |load: &Load| matches!(load, Load::Constant { wrench, .. } if wrench.moment.norm() > 0.0);
        self.each().any(is_turned)
    }

    /// Size of the force of a rope, a cylinder between two points or a weight, 0 or more \[N\]:
    /// what a table says in `load_n`. `None` for another load.
    pub fn size(&self) -> Option<f64> {
        match self {
            Load::Rope { magnitude, .. } | Load::Weight { magnitude, .. } => Some(magnitude.abs()),
            Load::Constant { .. } | Load::Measured | Load::Cases(_) => None,
        }
    }

    /// The same load with a force of the size `size` \[N\]: what pushes still pushes. `None` for a load
    /// without [`size`](Load::size).
    #[must_use]
    pub fn with_size(&self, size: f64) -> Option<Load> {
        let mut load = self.clone();
        match &mut load {
            Load::Rope { magnitude, .. } | Load::Weight { magnitude, .. } => {
                *magnitude = size.copysign(*magnitude);
            }
            Load::Constant { .. } | Load::Measured | Load::Cases(_) => return None,
        }
        Some(load)
    }

    /// What lies between loading point and anchor, in a word. What pushes is a cylinder; what pulls
    /// is called a rope, for the load does not know.
    pub fn line(&self) -> &'static str {
        let pushes = |load: &Load| matches!(load, Load::Rope { magnitude, .. } if *magnitude < 0.0);
        let mut ropes = self.each().filter(|load| matches!(load, Load::Rope { .. }));
        match ropes.next() {
            Some(first) if pushes(first) && ropes.all(pushes) => "cylinder",
            _ => "rope",
        }
    }

    /// Length ‖P2 − P1‖ of a rope or cylinder \[m\].
    pub fn rope_length(&self, loading_point: &Vector3<f64>) -> Option<f64> {
        match self {
            Load::Rope { anchor, .. } => Some((anchor - loading_point).norm()),
            _ => None,
        }
    }
}
