//! Sheets to fill in beside the robot.

use super::columns::Values;
use super::displacements::DEFAULT_STATE;
use super::write::{Layout, degrees, line};
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::model::measurement::Role;
use crate::model::posture::Posture;

/// What a sheet for raw readings asks for.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SheetOptions {
    /// Load states in the order in which they are taken; if none is named, `loaded`, or
    /// the cell's load cases with an unloaded state before each. An unloaded state comes first where none is among them.
    pub states: Vec<String>,
    /// Whether each posture ends with another unloaded state, which shows the drift.
    pub drift: bool,
    /// Whether a reflector on the base is read in each state.
    pub base_reflector: bool,
}

impl SheetOptions {
    /// All states of a posture, in the order in which they are taken.
    pub fn all_states(&self, cell: &Cell) -> Vec<String> {
        let mut states = self.states.clone();
        let is_unloaded = |state: &String| Role::of(state) == Role::Unloaded;
        if states.is_empty() {
            states = default_states(cell);
            // Before each of several loads the arm is read unloaded again: so each
            // displacement has an unloaded reading of its own, and drift shows.
            let loads = states.len();
            for number in (2..=loads).rev() {
                states.insert(number - 1, format!("unloaded-{number}"));
            }
            if loads > 1 {
                states.insert(0, "unloaded".to_string());
            }
        }
        if !states.iter().any(is_unloaded) {
            states.insert(0, "unloaded".to_string());
        }
        if self.drift && !states.last().is_some_and(is_unloaded) {
            let taken = states.iter().filter(|state| is_unloaded(state)).count();
            states.push(format!("unloaded-{}", taken + 1));
        }
        states
    }
}

/// The loads of the cell by name, `loaded` where there is one.
fn default_states(cell: &Cell) -> Vec<String> {
    match cell.setup.load.cases() {
        [] => vec![DEFAULT_STATE.to_string()],
        cases => cases.iter().map(|case| case.name.clone()).collect(),
    }
}

/// A sheet for raw readings: the rows of [`read_readings`](super::read_readings)
/// for each posture, load state and point, with empty fields for what is to be
/// read. It has columns of force where the cell has a sensor or its load is
/// measured, `load_n` where a rope, cylinder or weight has several load states, and the
/// angles of the posture, to be replaced by those that the controller shows.
pub fn reading_sheet(postures: &[Posture], options: &SheetOptions, cell: &Cell) -> String {
    let states = options.all_states(cell);
    let forces = asks_for_forces(cell) || cell.sensor.is_some();
    let loaded: Vec<&str> = states
        .iter()
        .map(String::as_str)
        .filter(|state| Role::of(state) != Role::Unloaded)
        .collect();
    // Several states under one load differ in its size.
    let cases = cell.setup.load.cases();
    let several = match cases {
        [] => loaded.len() > 1 && cell.setup.load.size().is_some(),
        _ => cases.iter().any(|case| {
            let own = loaded.iter().filter(|state| case.is_of(state));
            own.count() > 1 && case.load.size().is_some()
        }),
    };
    let layout = Layout {
        values: Values::Positions,
        forces,
        moments: cell.sensor.is_some(),
        loads: several && !forces,
        times: true,
    };
    let points = cell.setup.tool.measuring_points.iter();
    let mut points: Vec<&str> = points.map(|point| point.name.as_str()).collect();
    if options.base_reflector {
        points.push("base");
    }
    let states: Vec<&str> = states.iter().map(String::as_str).collect();
    rows(&layout, postures, &states, &points, cell)
}

/// A sheet for displacements that were calculated elsewhere: the rows of
/// [`read_displacements`](super::read_displacements) for each posture, load
/// state (if none is named `loaded`, or the cell's load cases) and measuring point.
pub fn displacement_sheet(postures: &[Posture], states: &[&str], cell: &Cell) -> String {
    let own = default_states(cell);
    let own: Vec<&str> = own.iter().map(String::as_str).collect();
    let states = if states.is_empty() { &own } else { states };
    let layout = Layout {
        values: Values::Displacements,
        forces: asks_for_forces(cell),
        moments: false,
        loads: false,
        times: false,
    };
    let points = cell.setup.tool.measuring_points.iter();
    let points: Vec<&str> = points.map(|point| point.name.as_str()).collect();
    rows(&layout, postures, states, &points, cell)
}

fn asks_for_forces(cell: &Cell) -> bool {
    cell.setup.load == Load::Measured || cell.setup.tool.has_sensor
}

/// A heading, and a row to fill in for each posture, state and point.
fn rows(
    layout: &Layout,
    postures: &[Posture],
    states: &[&str],
    points: &[&str],
    cell: &Cell,
) -> String {
    let mut text = line(&layout.heading(cell));
    for posture in postures {
        for state in states {
            for point in points {
                let names = [posture.name.as_str(), state, point];
                let mut fields: Vec<String> = names.map(String::from).into();
                fields.extend([""; 3].map(String::from));
                fields.extend(layout.optional(None, None, None));
                fields.extend(degrees(&posture.q));
                text += &line(&fields);
            }
        }
    }
    text
}
