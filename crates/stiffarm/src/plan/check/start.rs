//! Where the robot stands before and after a route.

use crate::findings::{Finding, codes};
use crate::model::cell::Cell;
use crate::model::load::{Load, Wrench};
use crate::model::observation::{PostureTerms, check_angles};
use crate::units::m_to_mm;
use nalgebra::Vector3;

/// That the start of the route stands inside something or nearer to it than the clearance, and how deep: nothing can
/// be driven from there, and nothing back.
pub fn start_touches(cell: &Cell) -> Option<Finding> {
    let q = cell.route.start.as_ref()?;
    check_angles(&cell.setup.robot, q).ok()?;
    let mut setup = cell.setup.clone();
    // Shapes alone are looked at: which load acts does not matter.
    setup.load = Load::Measured;
    let wrench = Wrench::force(Vector3::z());
    let terms = PostureTerms::new(&setup, q, Some(&wrench)).ok()?;
    let nearest = cell.scene.closest(&terms)?;
    let [a, b] = &nearest.names;
    let clearance = cell.scene.clearance();
    let how = if nearest.distance < 0.0 {
        format!("overlap by {:.0} mm", m_to_mm(-nearest.distance))
    } else if nearest.distance < clearance {
        format!("are {:.1} mm apart, and the clearance is {:.1} mm", m_to_mm(nearest.distance), m_to_mm(clearance))
    } else {
        return None;
    };
    let sentence = format!(
        "At the start of the route {a} and {b} {how}: no free move begins or ends there. Give a start that is clear of \
         everything, or correct what stands in its way."
    );
    Some(Finding::serious(codes::START_TOUCHES, "route.start_deg", sentence))
}
