//! The torque that joints may carry under load and tool weight.

use crate::model::load::{Axes, Load};
use crate::model::observation::{PostureTerms, Setup};
use nalgebra::Vector3;

/// Largest torques, and the weight of the tool. The arm's own weight is not known here: give what
/// the datasheet leaves for payload and process.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueLimits {
    /// Largest torque of each serial joint, either way \[N·m\].
    pub largest: Vec<f64>,
    /// Weight of the tool \[N\].
    pub tool_weight: f64,
    /// Its centre of mass, flange axes \[m\].
    pub centre_of_mass: Vector3<f64>,
}

impl TorqueLimits {
    /// Torques of load and tool weight \[N·m\].
    pub(super) fn torques(&self, setup: &Setup, terms: &PostureTerms, torques: &mut [f64]) {
        let frames = terms.frames();
        let weight = setup.robot.gravity_direction() * self.tool_weight;
        let centre = frames.point(&self.centre_of_mass);
        for (j, torque) in torques.iter_mut().enumerate() {
            // Γ = (J^f)ᵀ W, Eq. (4), and the tool's weight at its own point.
            *torque = terms.torque()[j] + frames.column(j, &centre).dot(&weight);
        }
    }

    /// Derivative of joint `j`'s torque with respect to θ \[N·m/rad\].
    pub(super) fn slope(&self, setup: &Setup, terms: &PostureTerms, j: usize, slope: &mut [f64]) {
        let frames = terms.frames();
        let weight = setup.robot.gravity_direction() * self.tool_weight;
        let centre = frames.point(&self.centre_of_mass);
        let (force, moment) = (terms.wrench().force, terms.wrench().moment);
        let p = terms.loading_point();
        let column = frames.column(j, p);
        for (k, slope) in slope.iter_mut().enumerate() {
            // ∂c_j/∂θ_k = z_min × c_max.
            let (low, high) = (j.min(k), j.max(k));
            let turned =
                |point: &Vector3<f64>| frames.axes()[low].cross(&frames.column(high, point));
            *slope = turned(p).dot(&force) + turned(&centre).dot(&weight);
            let axis = frames.axes()[k];
            match &setup.load {
                Load::Rope { anchor, magnitude } => {
                    let rope = anchor - p;
                    let length = rope.norm();
                    let unit = rope / length;
                    let moved = frames.column(k, p);
                    let change = (unit * unit.dot(&moved) - moved) * (magnitude / length);
                    *slope += column.dot(&change);
                }
                Load::Constant {
                    axes: Axes::Tool, ..
                } => {
                    *slope += column.dot(&axis.cross(&force));
                    *slope += frames.axes()[j].dot(&axis.cross(&moment));
                }
                _ => {}
            }
            if k < j {
                *slope += axis.cross(&frames.axes()[j]).dot(&moment);
            }
        }
    }
    /// Derivative of joint `j`'s torque by the rope's anchor and by a loading point that moves in
    /// the tool, base axes \[N·m/m\].
    pub(super) fn by_load(
        setup: &Setup,
        terms: &PostureTerms,
        j: usize,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let (frames, p) = (terms.frames(), terms.loading_point());
        // c_j = z_j × (p − o_j).
        let by_point = terms.wrench().force.cross(&frames.axes()[j]);
        let Load::Rope { anchor, magnitude } = &setup.load else {
            return (Vector3::zeros(), by_point);
        };
        let rope = anchor - p;
        let length = rope.norm();
        let unit = rope / length;
        let column = frames.column(j, p);
        // dF = (G/ℓ)(I − u uᵀ)(dP2 − dP1).
        let by_anchor = (column - unit * unit.dot(&column)) * (magnitude / length);
        (by_anchor, by_point - by_anchor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::cell::parse_cell;
    use crate::model::load::Wrench;

    #[test]
    fn derivatives_by_the_load_are_those_of_differences() {
        let cell = include_str!("../../../tests/cells/comau-shapes.toml");
        let cell = parse_cell(cell, "cell.toml").unwrap();
        let limits = cell.scene.torque().unwrap();
        let n = cell.setup.robot.joint_count();
        let torques = |setup: &Setup, q: &[f64]| {
            let terms = PostureTerms::new(setup, q, None).unwrap();
            let mut torques = vec![0.0; n];
            limits.torques(setup, &terms, &mut torques);
            torques
        };
        let push = match &cell.setup.load {
            Load::Rope { anchor, magnitude } => Load::Rope {
                anchor: *anchor,
                magnitude: -magnitude,
            },
            other => other.clone(),
        };
        let wrench = Wrench {
            force: Vector3::new(200.0, -100.0, 50.0),
            moment: Vector3::new(20.0, 10.0, -30.0),
        };
        let turning = Load::Constant {
            wrench,
            axes: Axes::Tool,
        };
        for load in [cell.setup.load.clone(), push, turning] {
            let setup = Setup {
                load,
                ..cell.setup.clone()
            };
            for p in 0..10 {
                let q: Vec<f64> = (0..n)
                    .map(|j| (1.3 * p as f64 + 2.1 * j as f64).sin())
                    .collect();
                let terms = PostureTerms::new(&setup, &q, None).unwrap();
                for axis in 0..3 {
                    let moved = |step: f64, point: bool| {
                        let mut setup = setup.clone();
                        let shift = Vector3::ith(axis, step);
                        match (point, &mut setup.load) {
                            (true, _) => {
                                let turned = terms.frames().flange().rotation.inverse() * shift;
                                setup.tool.loading_point += turned;
                            }
                            (false, Load::Rope { anchor, .. }) => *anchor += shift,
                            _ => {}
                        }
                        torques(&setup, &q)
                    };
                    for (point, step) in [(false, 1e-4), (true, 1e-4)] {
                        let (after, before) = (moved(step, point), moved(-step, point));
                        for j in 0..n {
                            let by_load = TorqueLimits::by_load(&setup, &terms, j);
                            let ours = if point { by_load.1 } else { by_load.0 };
                            let expected = (after[j] - before[j]) / (2.0 * step);
                            assert!(
                                (ours[axis] - expected).abs() < 1e-4 * (1.0 + expected.abs()),
                                "{point} {j}: {} {expected}",
                                ours[axis]
                            );
                        }
                    }
                }
            }
        }
    }
}
