//! Why a load or the measuring points tell nothing about a joint.

use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::model::observation::PostureTerms;
use nalgebra::Vector3;

/// Lengths and torques below this, relative to the arm's, are rounding.
pub(super) const ROUNDING: f64 = 1e-9;

/// Sets to zero what is rounding beside the largest.
pub(super) fn drop_rounding(values: &mut [f64]) {
    let largest = values.iter().copied().fold(0.0, f64::max);
    for value in values.iter_mut().filter(|v| **v <= ROUNDING * largest) {
        *value = 0.0;
    }
}

/// Length of the arm, against which rounding is measured \[m\].
pub(super) fn reach(cell: &Cell) -> f64 {
    cell.setup.robot.length() + cell.setup.tool.tcp().norm()
}

/// Why joint j stays unknown, as a clause.
pub(super) fn reason(cell: &Cell, terms: &[&PostureTerms], j: usize, undetermined: &[usize]) -> String {
    if cell.setup.robot.spring_mixing().is_some() {
        return "the load or the measuring points leave its elastic coordinate out".to_string();
    }
    let n = cell.setup.robot.joint_count();
    let near = ROUNDING * reach(cell);
    let always = |test: &dyn Fn(&PostureTerms) -> bool| terms.iter().all(|t| test(t));
    let seen = |t: &PostureTerms| t.columns.chunks_exact(n).any(|c| c[j].norm() > near);
    if always(&|t| t.wrench.force.norm() == 0.0 && t.wrench.moment.norm() == 0.0) {
        return "the load is zero".to_string();
    }
    if always(&|t| t.loading_columns[j].norm() <= near && t.wrench.moment.norm() == 0.0) {
        return "the loading point lies on its axis, so that the load has no lever; move the loading point \
                off the axis"
            .to_string();
    }
    if always(&|t| !seen(t)) {
        return "every measuring point lies on its axis and stays where it is; put a reflector beside the axis"
            .to_string();
    }
    let along = |t: &PostureTerms| t.wrench.force.cross(&t.frames.axes()[j]).norm();
    if always(&|t| along(t) <= ROUNDING * t.wrench.force.norm() && t.wrench.moment.norm() == 0.0) {
        return "the load is parallel to its axis in every posture (a purely vertical load on a floor-mounted \
                robot does that to joint 1); pull sideways"
            .to_string();
    }
    let axis_passes = |anchor: &Vector3<f64>| {
        always(&|t| {
            let offset = anchor - t.frames.origins()[j];
            offset.cross(&t.frames.axes()[j]).norm() <= near
        })
    };
    let anchored = |load: &Load| matches!(load, Load::Rope { anchor, .. } if axis_passes(anchor));
    if cell.setup.load.each().all(anchored) {
        let line = cell.setup.load.line();
        return format!(
            "the {line}'s anchor lies on its axis, so that the force passes through the axis; move the anchor"
        );
    }
    if undetermined.len() > 1 {
        return "its share of the displacements cannot be told from that of other joints; add measuring points"
            .to_string();
    }
    "the load has no moment about its axis".to_string()
}
