//! What is mapped.

use crate::error::{Error, Result};
use crate::model::load::Wrench;
use nalgebra::{UnitQuaternion, UnitVector3, Vector3};
use std::f64::consts::{PI, TAU};

/// Names of the axes.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];
/// Most turns about the tool axis that can be tried.
pub const MOST_TURNS: usize = 720;

/// Where the tip is held, how, and under which load.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MapOptions {
    /// Lower corner of the box, base frame \[m\].
    pub lower: [f64; 3],
    /// Upper corner \[m\].
    pub upper: [f64; 3],
    /// Nodes along x, y, z; 1 takes the middle: a plane, a line or a point.
    pub steps: [usize; 3],
    /// Orientation of the tip frame in base axes.
    pub rotation: UnitQuaternion<f64>,
    /// `Some(n)`: the turn about the tool axis (z of the tip) is free; n equal
    /// turns are tried and the best is taken.
    pub free_turn: Option<usize>,
    /// Direction of the stiffness along it, base axes.
    pub direction: UnitVector3<f64>,
    /// Load on the robot at the tip, base axes.
    pub wrench: Wrench,
}

impl MapOptions {
    /// A grid of `steps` nodes between two corners, base frame \[m\]: the tool
    /// axis down, a force of 1 N up against it, and the stiffness along that.
    pub fn new(lower: [f64; 3], upper: [f64; 3], steps: [usize; 3]) -> Self {
        MapOptions {
            lower,
            upper,
            steps,
            rotation: UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI),
            free_turn: None,
            direction: Vector3::z_axis(),
            wrench: Wrench::force([0.0, 0.0, 1.0]),
        }
    }

    /// Most nodes of a map.
    pub const MOST_NODES: usize = 1_000_000;

    /// Coordinates along x, y, z, ascending \[m\].
    pub(super) fn axes(&self) -> Result<[Vec<f64>; 3]> {
        let axes = grid(self.lower, self.upper, self.steps)?;
        let force = self.wrench.force.norm();
        if !(force > 0.0 && force.is_finite() && self.wrench.moment.norm().is_finite()) {
            return Err(Error::invalid("A map needs a force: finite, and not zero.").key("force_n"));
        }
        if let Some(turns) = self.free_turn {
            check_turns(turns)?;
        }
        Ok(axes)
    }

    /// Orientations to try at each node, with the turn about the tool axis \[rad\].
    pub(super) fn rotations(&self) -> Vec<(f64, UnitQuaternion<f64>)> {
        turns(self.free_turn).into_iter().map(|turn| (turn, self.rotation * about_tool_axis(turn))).collect()
    }
}

/// Turns about the tool axis to try \[rad\].
pub(super) fn turns(count: Option<usize>) -> Vec<f64> {
    let count = count.unwrap_or(1);
    (0..count).map(|k| TAU * k as f64 / count as f64).collect()
}

/// A turn of the tip frame about its z.
pub(super) fn about_tool_axis(turn: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn)
}

pub(super) fn check_turns(turns: usize) -> Result<()> {
    if (1..=MOST_TURNS).contains(&turns) {
        Ok(())
    } else {
        Err(Error::invalid(format!("1 to {MOST_TURNS} turns about the tool axis can be tried, not {turns}."))
            .key("free_turn"))
    }
}

/// Coordinates of a grid along x, y, z \[m\].
///
/// # Errors
/// Corners that are not finite or upside down, steps along nothing, no or too
/// many nodes.
pub(super) fn grid(lower: [f64; 3], upper: [f64; 3], steps: [usize; 3]) -> Result<[Vec<f64>; 3]> {
    let fault = |message: String, key: &str| Err(Error::invalid(message).key(key));
    for (axis, name) in AXES.iter().enumerate() {
        let (low, high, count) = (lower[axis], upper[axis], steps[axis]);
        if !(low.is_finite() && high.is_finite()) {
            return fault(format!("The region's {name} is not finite."), "region");
        }
        if low > high {
            return fault(
                format!(
                    "Along {name}, the region's lower end must not be above its upper end, got {} mm and {} mm.",
                    crate::units::m_to_shortest_mm(low),
                    crate::units::m_to_shortest_mm(high)
                ),
                "region",
            );
        }
        if count == 0 {
            return fault(format!("The number of nodes along {name} must be at least 1, got 0."), "steps");
        }
        if count > 1 && low == high {
            return fault(format!("{count} nodes along {name} need a lower and an upper end that differ."), "steps");
        }
    }
    let nodes = steps.iter().try_fold(1_usize, |n, s| n.checked_mul(*s));
    if nodes.is_none_or(|n| n > MapOptions::MOST_NODES) {
        return fault(format!("The grid has more than {} nodes.", MapOptions::MOST_NODES), "steps");
    }
    Ok(std::array::from_fn(|axis| {
        let (low, high, count) = (lower[axis], upper[axis], steps[axis]);
        let share = |i: usize| match count {
            1 => 0.5,
            _ => i as f64 / (count - 1) as f64,
        };
        (0..count).map(|i| low + (high - low) * share(i)).collect()
    }))
}
