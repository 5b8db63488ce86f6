//! How good any plan of as many postures could be.

use super::kinds::Stage;
use crate::error::{Code, Result};
use crate::model::cell::Cell;
use crate::model::posture::Posture;
use crate::numerics::control::Control;
use crate::plan::certificate::{
    Certificate, CertificateOptions, JointEfficiency, certify_until, joint_efficiencies_until,
};
use crate::plan::index::Index;

/// Searches behind the bound of each joint: fewer than behind the one of the
/// index, or the six would take longer than the selection.
const JOINT_SEARCHES: usize = 256;

/// Postures from which on the bound of the index prediction says anything.
pub(super) const FEWEST_PREDICTING: usize = 12;

/// Why there is no bound after a stop.
pub(super) const STOPPED: &str = "stopped before the bound was found";

/// Bounds for a plan, as far as there are any.
#[derive(Default)]
pub(super) struct Bounds {
    /// The bound of the index.
    pub certificate: Option<Certificate>,
    /// Bounds joint by joint.
    pub joints: Option<Vec<JointEfficiency>>,
    /// Why there is no certificate, where the index has one.
    pub missing: Option<String>,
}

impl Bounds {
    /// Bounds for `postures` beside `held` ones. A bound that cannot be had is no
    /// fault of the plan: the reason is kept instead.
    pub fn new(
        cell: &Cell,
        index: Index,
        held: &[Posture],
        postures: &[Posture],
        watch: &mut dyn FnMut(Stage),
        control: Control<'_>,
    ) -> Self {
        let mut bounds = Bounds::default();
        // What one posture adds is never a fraction of it, which is what few of them lack of the bound.
        if index == Index::Prediction && held.len() + postures.len() < FEWEST_PREDICTING {
            return bounds;
        }
        watch(Stage::Bounding { postures: postures.len() });
        let control = control.quiet();
        let options = CertificateOptions::default();
        let certificate = certify_until(cell, index, held, postures, &options, control, control);
        bounds.certificate = unless_failed(certificate, control, &mut bounds.missing);
        // The joints' bounds count neither what is measured already nor what gives way beyond the axes.
        let by_joint = index != Index::Prediction && held.is_empty();
        if bounds.certificate.is_some() && by_joint && cell.prior.is_some() {
            watch(Stage::BoundingJoints);
            let mut options = options;
            options.samples = JOINT_SEARCHES;
            let joints = joint_efficiencies_until(cell, postures, &options, control, control);
            bounds.joints = unless_failed(joints, control, &mut bounds.missing);
        }
        bounds
    }
}

/// The result, unless it failed or was stopped on the way.
pub(super) fn unless_failed<T>(result: Result<T>, control: Control<'_>, missing: &mut Option<String>) -> Option<T> {
    if control.stopped() {
        *missing = Some(STOPPED.to_string());
        return None;
    }
    match result {
        Ok(value) => Some(value),
        // This index has no bound: nothing is missing.
        Err(error) if error.code() == Code::Unsupported => None,
        Err(error) => {
            *missing = Some(error.message().trim_end_matches('.').to_string());
            None
        }
    }
}
