//! The cell as a plan sees it: with its characteristic length, and with the springs alone that its load
//! can determine.

use super::reason::{drop_rounding, reason};
use super::robot_doubts;
use crate::findings::{Finding, codes};
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::model::observation::PostureTerms;
use crate::numerics::streams::spread;
use crate::plan::characteristic_length::with_length;

/// Postures that are looked at for a spring that moves a measuring point.
const POSTURES: u32 = 64;

/// The cell of a plan, with its characteristic length, and [`determinable`] where it has a `fixed_load`; and what to
/// distrust about it.
pub fn prepared(cell: &Cell, fixed_load: bool) -> (Cell, Vec<Finding>) {
    let (cell, left_out) = if fixed_load { determinable(cell.clone()) } else { (cell.clone(), Vec::new()) };
    let mut findings = robot_doubts(&cell.setup.robot);
    findings.extend(left_out);
    (with_length(cell).0, findings)
}

/// The cell with those springs alone whose loads move a measuring point, and a finding [`codes::JOINT_LEFT_OUT`] for
/// each of the others.
///
/// A weight on an arm that stands on the floor has no torque about joint 1 whatever the posture: its column of the
/// observation matrix is zero, and with it no index would exist. The remaining columns are those of the whole cell.
/// A cell whose load moves all, or none, or is only known by measurement, stays as it is.
pub fn determinable(mut cell: Cell) -> (Cell, Vec<Finding>) {
    let Some((terms, left_out)) = left_out(&cell) else {
        return (cell, Vec::new());
    };
    let robot = &cell.setup.robot;
    let (count, names) = (robot.spring_count(), robot.spring_names());
    let looked_at: Vec<&PostureTerms> = terms.iter().collect();
    let finding = |j: &usize| {
        let name = &names[*j];
        let why = reason(&cell, &looked_at, *j, &[*j]);
        let sentence = format!(
            "No posture within the bounds determines {name} under the load of this cell: {why}. Plans and what they \
             promise leave it out, as if it were rigid."
        );
        Finding::caution(codes::JOINT_LEFT_OUT, name, sentence)
    };
    let findings = left_out.iter().map(finding).collect();
    let determined: Vec<usize> = (0..count).filter(|j| !left_out.contains(j)).collect();
    if let Some(prior) = &mut cell.prior {
        *prior = determined.iter().map(|j| prior[*j]).collect();
    }
    cell.setup.robot = cell.setup.robot.with_springs(&determined);
    (cell, findings)
}

/// Springs of the cell that [`determinable`] leaves out.
pub fn springs_left_out(cell: &Cell) -> Vec<usize> {
    left_out(cell).map_or_else(Vec::new, |(_, springs)| springs)
}

/// Terms at all postures, and the springs whose columns of Ψ are zero there; `None` where there is no such spring, or
/// no other.
fn left_out(cell: &Cell) -> Option<(Vec<PostureTerms>, Vec<usize>)> {
    let robot = &cell.setup.robot;
    let count = robot.spring_count();
    let fits = cell.prior.as_ref().is_none_or(|prior| prior.len() == count);
    if cell.setup.load == Load::Measured || !fits || cell.bounds.len() != robot.joint_count() {
        return None;
    }
    let setups = cell.setup.cases();
    let states = (0..POSTURES).flat_map(|i| setups.iter().map(move |setup| (setup, i)));
    let terms = states.map(|(setup, i)| PostureTerms::new(setup, &spread(&cell.bounds, i), None).ok());
    let terms: Vec<PostureTerms> = terms.collect::<Option<_>>()?;
    let mut largest = vec![0.0_f64; count];
    for terms in &terms {
        for (largest, column) in largest.iter_mut().zip(terms.block(robot).column_iter()) {
            *largest = largest.max(column.amax());
        }
    }
    drop_rounding(&mut largest);
    let still: Vec<usize> = (0..count).filter(|j| largest[*j] == 0.0).collect();
    (1..count).contains(&still.len()).then_some((terms, still))
}
