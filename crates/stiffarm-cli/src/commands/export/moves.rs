//! How the robot goes through a plan.

use stiffarm::findings::{Finding, list};
use stiffarm::model::cell::{Cell, LimitKind};
use stiffarm::model::measurement::Role;
use stiffarm::model::posture::Posture;
use stiffarm::plan::route::{RouteOptions, not_approached, route};
use stiffarm::{Control, Result};
use stiffarm_files::program::{Start, Stop};
use stiffarm_files::table::is_turned;

/// The stops of a program with the ways between them.
pub struct Driven {
    /// The stops, each with the via postures before it.
    pub stops: Vec<Stop>,
    /// Where it begins and ends.
    pub start: Option<Start>,
    /// Moves that lead over via postures.
    pub with_via: usize,
    /// Moves for which no free way was found, as `2 to 3`.
    pub blocked: Vec<String>,
    /// What the moves were checked against.
    pub checked: Vec<LimitKind>,
    /// Whether postures are reached from the side of their load.
    pub is_approached: bool,
    /// Joints that are not.
    pub not_approached: Option<Finding>,
}

impl Driven {
    /// The plan in its order, by the joint moves that the cell allows: the only place that decides how the
    /// robot gets from one posture to the next.
    pub fn new(cell: &Cell, plan: &[Posture], start: Option<&Posture>, states: &[String]) -> Result<Self> {
        let mut cell = cell.clone();
        cell.route.start = start.map(|start| start.q.clone());
        let mut options = RouteOptions::default();
        options.keep_order = true;
        options.keep_angles = true;
        let route = route(&cell, plan, &options, Control::default())?;
        let mut stops: Vec<Stop> = plan
            .iter()
            .enumerate()
            .map(|(number, posture)| {
                let mut states = states.to_vec();
                if is_turned(&cell, &states, number) {
                    states.reverse();
                }
                let last = number + 1 == plan.len();
                Stop::new(posture.clone(), task(&states, cell.route.load_stays_on && !last))
            })
            .collect();
        let mut back = Vec::new();
        let mut blocked = Vec::new();
        for each in &route.moves {
            let name = |stop: Option<usize>| match (stop, start) {
                (Some(stop), _) => plan[stop].name.clone(),
                (None, Some(start)) => start.name.clone(),
                (None, None) => String::new(),
            };
            if !each.free {
                blocked.push(format!("{} to {}", name(each.from), name(each.to)));
            }
            let via = each
                .via
                .iter()
                .enumerate()
                .map(|(number, q)| Posture { name: format!("{}_via_{}", name(each.to), number + 1), q: q.clone() });
            match each.to {
                Some(stop) => stops[stop].via = via.collect(),
                None => back = via.collect(),
            }
        }
        Ok(Driven {
            is_approached: route.is_approached(),
            not_approached: not_approached(&cell, plan, &route)?,
            with_via: route.moves.iter().filter(|m| !m.via.is_empty()).count(),
            start: start.map(|start| Start { posture: start.clone(), back }),
            checked: route.checked,
            blocked,
            stops,
        })
    }

    /// What is known of the ways; it stands in every program and on the screen.
    pub fn sentence(&self) -> String {
        let first = match self.start {
            Some(_) => "",
            None => " The way to the first posture was not checked.",
        };
        let approach =
            if self.is_approached { " The via posture before a posture takes up lost motion: keep it." } else { "" };
        let checked = if !self.blocked.is_empty() {
            format!("WARNING: no way free of collision was found for the move {}.", list(&self.blocked))
        } else if self.checked.contains(&LimitKind::Shapes) {
            let checked: Vec<_> = self.checked.iter().map(|kind| kind.short()).collect();
            let checked = list(&checked);
            format!(
                "The moves between the postures were checked against {checked} as the cell file has them, and nothing \
                 else.{first}"
            )
        } else {
            "The moves between the postures are straight in joint space and were not checked for collisions."
                .to_string()
        };
        checked + approach
    }
}

/// What is to be done at each posture.
fn task(states: &[String], load_stays_on: bool) -> String {
    let mut task = format!("measure {}", states.join(", "));
    let is_loaded = |state: &String| Role::of(state) != Role::Unloaded;
    // Unless the cell says otherwise, no load travels with the arm.
    if !load_stays_on && states.last().is_some_and(is_loaded) {
        task += ", then unload";
    }
    task
}
