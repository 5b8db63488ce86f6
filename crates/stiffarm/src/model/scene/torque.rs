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
            let turned = |point: &Vector3<f64>| frames.axes()[low].cross(&frames.column(high, point));
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
                Load::Constant { axes: Axes::Tool, .. } => {
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
    pub(super) fn by_load(setup: &Setup, terms: &PostureTerms, j: usize) -> (Vector3<f64>, Vector3<f64>) {
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
