//! How the robot goes through a plan.

use stiffarm::files::program::Stop;
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::Role;
use stiffarm::model::posture::Posture;

/// What is known about the ways between the postures; it stands in every program and on the screen.
pub const WAYS: &str = "The moves between the postures are straight in joint space and were not checked for \
                        collisions.";

/// The stops of the program, with the way to each and what is to be done there. The only place that
/// decides how the robot gets from one posture to the next: by one joint move, in the plan's order.
pub fn moves(_cell: &Cell, plan: &[Posture], states: &[String]) -> Vec<Stop> {
    let mut task = format!("measure {}", states.join(", "));
    // No load travels with the arm.
    if states
        .last()
        .is_some_and(|last| Role::of(last) != Role::Unloaded)
    {
        task += ", then unload";
    }
    plan.iter()
        .map(|posture| Stop::new(posture.clone(), task.clone()))
        .collect()
}
