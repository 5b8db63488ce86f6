//! Sheets to fill in beside the robot: rows as data first, then text or a workbook.

mod page;
mod workbook;

pub use workbook::write_sheet_workbook;

use super::beside::{RowContents, RowQuantity};
use super::displacements::DEFAULT_STATE;
use super::layout::Layout;
use super::line::line;
use super::loads;
use super::values::Values;
use super::write::degrees;
use stiffarm::model::cell::Cell;
use stiffarm::model::load::Load;
use stiffarm::model::measurement::Role;
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::posture::Posture;

/// What a sheet for raw readings asks for.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SheetOptions {
    /// Load states in the order in which they are taken; if none is named, `loaded`, or
    /// the cell's load cases with an unloaded state before each. An unloaded state comes first where none is among
    /// them.
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

/// A table to fill in: one row per reading, in measuring order.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Sheet {
    /// What stands above the columns, units included.
    pub headings: Vec<String>,
    /// The rows, in the order in which they are taken.
    pub rows: Vec<SheetRow>,
    layout: Layout,
}

/// One reading to take.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SheetRow {
    /// The posture, with the controller angles to drive to \[rad\].
    pub posture: Posture,
    /// Name of the load state.
    pub state: String,
    /// Name of the measuring point, or of the reflector on the base.
    pub point: String,
    /// Name of the tracker's station, where the cell has several.
    pub station: Option<String>,
    /// Force of rope, cylinder or weight in this state \[N\], where the cell or the
    /// state's name gives it.
    pub load: Option<f64>,
}

impl Sheet {
    /// Makes a row for each posture, state and point that the tracker sees.
    fn new(layout: Layout, postures: &[Posture], states: &[String], points: &[&str], cell: &Cell) -> Self {
        let loads = if layout.has(RowQuantity::Load) {
            loads::planned(states, &cell.setup.load)
        } else {
            vec![None; states.len()]
        };
        let mut rows = Vec::with_capacity(postures.len() * states.len() * points.len());
        for (number, posture) in postures.iter().enumerate() {
            let mut state_loads: Vec<(&String, &Option<f64>)> = states.iter().zip(&loads).collect();
            let station = layout.has(RowQuantity::Station);
            let station = station.then(|| station_at(cell, posture)).flatten();
            if is_turned(cell, states, number) {
                state_loads.reverse();
            }
            let hidden = cell.hidden_points(&posture.q);
            for (state, load) in state_loads {
                let seen = points.iter().enumerate();
                let seen = seen.filter(|(number, _)| !hidden.contains(number));
                rows.extend(seen.map(|(_, point)| SheetRow {
                    posture: posture.clone(),
                    state: state.clone(),
                    point: (*point).to_string(),
                    station: station.clone(),
                    load: *load,
                }));
            }
        }
        Sheet { headings: layout.heading(cell), rows, layout }
    }

    /// What stands in the fields of a row; an empty text is to be filled in.
    fn fields(&self, row: &SheetRow) -> Vec<String> {
        let mut fields = vec![row.posture.name.clone(), row.state.clone(), row.point.clone()];
        fields.extend([""; 3].map(String::from));
        fields.extend(self.layout.fields(&RowContents {
            station: row.station.as_deref(),
            load: row.load,
            ..RowContents::default()
        }));
        fields.extend(degrees(&row.posture.q));
        fields
    }

    /// The rows of one posture and state after the other.
    pub(super) fn states(&self) -> impl Iterator<Item = &[SheetRow]> {
        let is_same = |a: &SheetRow, b: &SheetRow| a.posture.name == b.posture.name && a.state == b.state;
        self.rows.chunk_by(is_same)
    }

    /// The names of postures (0), states (1), points (2) or stations (3), each once, in their order.
    fn names(&self, column: u16) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for row in &self.rows {
            let name = match column {
                0 => &row.posture.name,
                1 => &row.state,
                2 => &row.point,
                _ => match &row.station {
                    Some(station) => station,
                    None => continue,
                },
            };
            // Postures come in blocks; there are few states and points.
            let is_listed = match column {
                0 => names.last() == Some(&name.as_str()),
                _ => names.contains(&name.as_str()),
            };
            if !is_listed {
                names.push(name);
            }
        }
        names
    }

    /// The sheet as CSV text.
    pub fn to_csv(&self) -> String {
        let rows = self.rows.iter().map(|row| line(&self.fields(row)));
        line(&self.headings) + &rows.collect::<String>()
    }
}

/// A sheet for raw readings: the rows of [`read_measurements`](super::read_measurements)
/// for each posture, load state and point (but those that the tracker does not see,
/// [`Cell::hidden_points`]), with empty fields for what is to be
/// read. It has columns of force where the cell has a sensor or its load is
/// measured, else `load_n` where the load is a rope, cylinder or weight, and the
/// angles of the posture, to be replaced by those that the controller shows.
///
/// `load_n` is filled in where it is certain: with the cell's own force where a load has
/// one state, or with the one number in the state's name (`up-250`, `500N`) where it is a
/// force that the cell's load can have.
///
/// Where the cell has several stations of the tracker, the column `station` says from which the posture is read: the
/// one that sees most of its points.
///
/// Rows stand in measuring order; where the load stays on between postures, every second posture
/// is measured from the last state to the first.
pub fn reading_sheet(postures: &[Posture], options: &SheetOptions, cell: &Cell) -> Sheet {
    let states = options.all_states(cell);
    let forces = asks_for_forces(cell) || cell.sensor.is_some();
    let sight = cell.scene.sight();
    let layout = Layout::new(Values::Positions, |beside| match beside {
        RowQuantity::Station => sight.is_some_and(|sight| sight.stations.len() > 1),
        RowQuantity::Force => forces,
        RowQuantity::Moment => cell.sensor.is_some(),
        RowQuantity::Load => !forces && cell.setup.load.each().any(|load| load.size().is_some()),
        RowQuantity::Time => true,
        _ => false,
    });
    let points = cell.setup.tool.measuring_points.iter();
    let mut points: Vec<&str> = points.map(|point| point.name.as_str()).collect();
    if options.base_reflector {
        points.push("base");
    }
    Sheet::new(layout, postures, &states, &points, cell)
}

/// A sheet for displacements that were calculated elsewhere: the rows of
/// [`read_measurements`](super::read_measurements) for each posture, load
/// state (if none is named `loaded`, or the cell's load cases) and measuring point.
pub fn displacement_sheet(postures: &[Posture], states: &[&str], cell: &Cell) -> Sheet {
    let states = match states {
        [] => default_states(cell),
        _ => states.iter().map(|state| (*state).to_string()).collect(),
    };
    let forces = asks_for_forces(cell);
    let is_asked = |beside| beside == RowQuantity::Force && forces;
    let layout = Layout::new(Values::Displacements, is_asked);
    let points = cell.setup.tool.measuring_points.iter();
    let points: Vec<&str> = points.map(|point| point.name.as_str()).collect();
    Sheet::new(layout, postures, &states, &points, cell)
}

/// The station from which a posture is read, where the cell has several.
fn station_at(cell: &Cell, posture: &Posture) -> Option<String> {
    let terms = PostureTerms::new(&cell.setup.cases()[0], &posture.q, None).ok()?;
    cell.scene.station_at(&terms).map(|station| station.name.clone())
}

/// Whether the states of posture `number`, counted from 0, are taken in the reverse order: where the load
/// stays on between postures, every second one begins as the one before has ended. Not where names say
/// that the load goes up or down: they would say the opposite.
pub fn is_turned(cell: &Cell, states: &[String], number: usize) -> bool {
    let says_way = |state: &String| state.starts_with("up") || state.starts_with("down");
    cell.route.load_stays_on && number % 2 == 1 && !states.iter().any(says_way)
}

fn asks_for_forces(cell: &Cell) -> bool {
    cell.setup.load == Load::Measured || cell.setup.tool.has_sensor
}
