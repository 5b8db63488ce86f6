//! `posture,state,fx_n,…,mz_nm[,dq1_deg,…][,q1_deg,…][,dx_mm,…,rz_deg]`:
//! readings with the flange fixed.

use super::beside::RowQuantity;
use super::grid::{Column, Row, Table};
use super::heading::ColumnDefinition;
use super::line::line;
use super::postures::{angle_names, angles};
use super::quantity::Quantity;
use nalgebra::{Vector3, Vector6};
use stiffarm::error::{Code, Error, Result};
use stiffarm::estimate::clamped::ClampedPosture;
use stiffarm::model::cell::Cell;
use stiffarm::model::instruments::Mount;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::load::Wrench;
use stiffarm::model::measurement::Role;
use stiffarm::model::posture::Posture;
use stiffarm::model::robot::Robot;
use stiffarm::units::{m_to_shortest_mm, rad_to_deg, rad_to_shortest_deg};

/// No joint gives way by more \[deg\].
const LARGEST_GIVE_DEG: f64 = 5.0;

fn shift() -> [ColumnDefinition; 3] {
    ["dx", "dy", "dz"].map(|stem| ColumnDefinition::of(stem, Quantity::Length, "shift"))
}

fn turn() -> [ColumnDefinition; 3] {
    ["rx", "ry", "rz"].map(|stem| ColumnDefinition::of(stem, Quantity::Angle, "turn"))
}

/// `dq1` to `dqn`.
fn differences(joints: usize) -> Vec<ColumnDefinition> {
    let stems = (1..=joints).map(|j| format!("dq{j}"));
    stems.map(|stem| ColumnDefinition::of(stem, Quantity::Angle, "dq")).collect()
}

/// Reads clamped postures from a table with one row per posture and load state;
/// `file_name` is for messages. Two forms:
///
/// - **differences**: `dq1_deg, …` are the controller angles loaded minus
///   unloaded, and each row stands for itself; the controller angles come from
///   `q1_deg, …` or, by the posture's name, from `postures`;
/// - **states**: `q1_deg, …` are the angles read in each state, and each posture
///   has rows of a state `unloaded…` or `preload…` (their mean is the
///   reference; a preload goes first) and rows of loaded states.
///
/// Force and moment are those of the cell's sensor, or without one the wrench of
/// the fixture on the robot at the loading point in base axes; in the form of
/// states the reference's are subtracted, or none where its fields are empty.
/// The loading point is the clamp. `dx_mm … rz_deg`, where given, say how the
/// clamp moved nevertheless, base axes.
///
/// # Errors
/// A heading or row that cannot be read, a state without its reference, angles
/// outside the machine's limits, joints that give way by more than 5°: with
/// line, column and the column's name.
pub fn read_clamped(
    bytes: &[u8],
    file_name: &str,
    cell: &Cell,
    postures: Option<&[Posture]>,
) -> Result<Vec<ClampedPosture>> {
    let table = Table::read(bytes, file_name, &cell.columns)?;
    read(&table, cell, postures).map_err(|error| table.with_aside(error))
}

fn read(table: &Table<'_>, cell: &Cell, postures: Option<&[Posture]>) -> Result<Vec<ClampedPosture>> {
    let columns = Columns::of(table, cell, postures.is_some())?;
    let rows = table.rows()?;
    let reader = Reader { table, columns: &columns, cell };
    if columns.differences.is_some() {
        rows.iter().map(|row| reader.difference(row, postures)).collect()
    } else {
        reader.states(&rows)
    }
}

/// Clamped postures in the form of differences that [`read_clamped`] reads from
/// a cell without a sensor; the motion of the clamp where any posture has one.
pub fn write_clamped(clamped: &[ClampedPosture], robot: &Robot) -> String {
    let joints = robot.joint_count();
    let moves = clamped.iter().any(|c| c.fixture_motion.is_some());
    let mut heading: Vec<String> = ["posture", "state"].map(String::from).to_vec();
    heading.extend(
        RowQuantity::Force
            .definitions()
            .iter()
            .chain(&RowQuantity::Moment.definitions())
            .map(ColumnDefinition::heading),
    );
    heading.extend(differences(joints).iter().map(ColumnDefinition::heading));
    if moves {
        heading.extend(shift().iter().chain(&turn()).map(ColumnDefinition::heading));
    }
    heading.extend(angle_names(joints));
    let mut text = line(&heading);
    let degrees = |angle: &f64| rad_to_shortest_deg(*angle).to_string();
    for c in clamped {
        let mut fields = vec![c.posture.name.clone(), c.state.clone()];
        let wrench = c.wrench.force.iter().chain(c.wrench.moment.iter());
        fields.extend(wrench.map(|v| v.to_string()));
        fields.extend(c.motor.iter().map(degrees));
        if moves {
            let motion = c.fixture_motion.unwrap_or_default();
            let (shift, turn) = motion.as_slice().split_at(3);
            fields.extend(shift.iter().map(|m| m_to_shortest_mm(*m).to_string()));
            fields.extend(turn.iter().map(degrees));
        }
        fields.extend(c.posture.q.iter().map(degrees));
        text += &line(&fields);
    }
    text
}

/// Positions and units of the columns.
struct Columns {
    posture: Column,
    state: Column,
    force: Vec<Column>,
    moment: Vec<Column>,
    differences: Option<Vec<Column>>,
    shift: Option<Vec<Column>>,
    turn: Option<Vec<Column>>,
    angles: Option<Vec<Column>>,
}

impl Columns {
    fn of(table: &Table<'_>, cell: &Cell, has_postures: bool) -> Result<Self> {
        let joints = cell.setup.robot.joint_count();
        let angle_columns: Vec<ColumnDefinition> = ColumnDefinition::angles(joints).collect();
        let mut definitions = ["posture", "state"].map(ColumnDefinition::name).to_vec();
        definitions.extend(RowQuantity::Force.definitions());
        definitions.extend(RowQuantity::Moment.definitions());
        definitions.extend(differences(joints));
        definitions.extend(shift());
        definitions.extend(turn());
        definitions.extend(angle_columns.iter().cloned());
        let heading = table.check_heading(&definitions, joints)?;
        let hint = "a table of clamped postures has the columns posture, state, fx_n, fy_n, fz_n, mx_nm, my_nm, \
                    mz_nm and dq1_deg … or q1_deg …";
        let both = "a fixture pushes and turns: give force and moment, three components each";
        let give = |what: &str| format!("give {what} of all {joints} joints, or none");
        let differences = heading.all_or_none(&differences(joints), &give("dq"))?;
        let moved = "give shift and turn of the clamp, three components each, or none";
        let moved_columns = [shift(), turn()].concat();
        let motion = heading.all_or_none(&moved_columns, moved)?;
        let angles = heading.all_or_none(&angle_columns, &give("the angles"))?;
        if angles.is_none() && (differences.is_none() || !has_postures) {
            let message = "The table has no controller angles.";
            return Err(table.heading_error(None, Code::TableHeading, message).hint(format!(
                "add q1_deg to q{joints}_deg as read in each state; or dq1_deg … and the posture file whose names the \
                 table uses"
            )));
        }
        Ok(Columns {
            posture: heading.require(&ColumnDefinition::name("posture"), hint)?,
            state: heading.require(&ColumnDefinition::name("state"), hint)?,
            force: heading.all(&RowQuantity::Force.definitions(), both)?,
            moment: heading.all(&RowQuantity::Moment.definitions(), both)?,
            differences,
            shift: motion.as_ref().map(|columns| columns[..3].to_vec()),
            turn: motion.as_ref().map(|columns| columns[3..].to_vec()),
            angles,
        })
    }
}

/// One state as it was read.
struct State<'r> {
    row: &'r Row<'r>,
    posture: &'r str,
    state: &'r str,
    role: Role,
    q: Vec<f64>,
    /// As the table has it; `None` where all its fields are empty.
    wrench: Option<Wrench>,
    motion: Option<Vector6<f64>>,
}

/// Mean of the wrenches of states; zero without any.
fn mean_wrench(states: &[&State<'_>]) -> Wrench {
    let mut mean = Wrench::force(Vector3::zeros());
    let count = states.len() as f64;
    for wrench in states.iter().filter_map(|state| state.wrench) {
        mean.force += wrench.force / count;
        mean.moment += wrench.moment / count;
    }
    mean
}

struct Reader<'a> {
    table: &'a Table<'a>,
    columns: &'a Columns,
    cell: &'a Cell,
}

impl Reader<'_> {
    /// A row that stands for itself.
    fn difference(&self, row: &Row, postures: Option<&[Posture]>) -> Result<ClampedPosture> {
        let (table, columns) = (self.table, self.columns);
        let name = table.name(row, columns.posture)?;
        let state = table.name(row, columns.state)?;
        if Role::of(state) != Role::Loaded {
            let message = "A row of differences is loaded minus unloaded; it has no unloaded state.";
            return Err(table
                .error(row, columns.state.at, Code::TableRow, message)
                .hint("leave the row out, or give the angles of each state as q1_deg … without dq1_deg …"));
        }
        let planned = postures.and_then(|list| list.iter().find(|p| p.name == name));
        let q = match (&columns.angles, planned) {
            (Some(positions), _) => angles(table, row, positions, &self.cell.setup.robot)?,
            (None, Some(planned)) => planned.q.clone(),
            (None, None) => {
                let message = format!("The posture file has no posture \"{name}\".");
                return Err(table.error(row, columns.posture.at, Code::UnknownName, message));
            }
        };
        let motor = columns
            .differences
            .iter()
            .flatten()
            .map(|column| self.give(row, *column, table.number(row, *column)?))
            .collect::<Result<Vec<f64>>>()?;
        let read = self.wrench(row)?.ok_or_else(|| self.no_wrench(row))?;
        Ok(ClampedPosture {
            wrench: self.on_robot(&q, &read),
            preload: None,
            posture: Posture { name: name.to_string(), q },
            state: state.to_string(),
            motor,
            reference: None,
            fixture_motion: self.motion(row)?,
        })
    }

    /// Rows of states, taken against the reference of their posture.
    fn states(&self, rows: &[Row<'_>]) -> Result<Vec<ClampedPosture>> {
        let read = rows.iter().map(|row| self.state(row)).collect::<Result<Vec<State<'_>>>>()?;
        let mut out = Vec::new();
        for loaded in read.iter().filter(|s| s.role == Role::Loaded) {
            let of = |role: Role| -> Vec<&State<'_>> {
                let same = |s: &&State<'_>| s.posture == loaded.posture && s.role == role;
                read.iter().filter(same).collect()
            };
            let (unloaded, preload) = (of(Role::Unloaded), of(Role::Preload));
            out.push(if preload.is_empty() {
                self.against(loaded, &unloaded)?
            } else {
                let mut clamped = self.against(loaded, &preload)?;
                let [light, none] = [&preload, &unloaded].map(|states| mean_wrench(states));
                let read = Wrench { force: light.force - none.force, moment: light.moment - none.moment };
                // On the flange the weight of the tool is in it, unless it was read unloaded.
                let on_flange = self.cell.sensor.as_ref().map(|s| s.mount) == Some(Mount::Flange);
                let is_known = !on_flange || unloaded.iter().any(|state| state.wrench.is_some());
                clamped.preload = Some(match is_known {
                    true => self.on_robot(&clamped.posture.q, &read),
                    false => clamped.wrench,
                });
                clamped
            });
        }
        if let (true, Some(first)) = (out.is_empty(), read.first()) {
            let message = "The table has no loaded state.";
            let error = self.table.error(first.row, self.columns.state.at, Code::TableRow, message);
            return Err(error.hint("states named unloaded… and preload… are references"));
        }
        Ok(out)
    }

    fn state<'r>(&self, row: &'r Row<'r>) -> Result<State<'r>> {
        let (table, columns) = (self.table, self.columns);
        let state = table.name(row, columns.state)?;
        let role = Role::of(state);
        let wrench = self.wrench(row)?;
        if wrench.is_none() && role == Role::Loaded {
            return Err(self.no_wrench(row));
        }
        let positions = columns.angles.as_deref().unwrap_or_default();
        Ok(State {
            row,
            posture: table.name(row, columns.posture)?,
            state,
            role,
            q: angles(table, row, positions, &self.cell.setup.robot)?,
            wrench,
            motion: self.motion(row)?,
        })
    }

    fn against(&self, loaded: &State<'_>, reference: &[&State<'_>]) -> Result<ClampedPosture> {
        if reference.is_empty() {
            let message = format!("Posture \"{}\" has no unloaded state.", loaded.posture);
            return Err(self
                .table
                .error(loaded.row, self.columns.posture.at, Code::TableRow, message)
                .hint("add a row with the state unloaded: its angles are what the loaded ones are compared with"));
        }
        let count = reference.len() as f64;
        let joints = loaded.q.len();
        let q: Vec<f64> = (0..joints).map(|j| reference.iter().map(|r| r.q[j]).sum::<f64>() / count).collect();
        let positions = self.columns.angles.as_deref().unwrap_or_default();
        let motor = (0..joints)
            .map(|j| self.give(loaded.row, positions[j], loaded.q[j] - q[j]))
            .collect::<Result<Vec<f64>>>()?;
        let none = Wrench::force(Vector3::zeros());
        let mut read = loaded.wrench.unwrap_or(none);
        for r in reference {
            let before = r.wrench.unwrap_or(none);
            read.force -= before.force / count;
            read.moment -= before.moment / count;
        }
        let before = reference.iter().filter_map(|r| r.motion).sum::<Vector6<f64>>() / count;
        Ok(ClampedPosture {
            wrench: self.on_robot(&q, &read),
            preload: None,
            posture: Posture { name: loaded.posture.to_string(), q },
            state: loaded.state.to_string(),
            motor,
            // All states of a posture are taken against the same mean.
            reference: Some(0),
            fixture_motion: loaded.motion.map(|motion| motion - before),
        })
    }

    /// What a joint gave way by \[rad\].
    fn give(&self, row: &Row, column: Column, angle: f64) -> Result<f64> {
        let degrees = rad_to_deg(angle);
        if degrees.abs() > LARGEST_GIVE_DEG {
            let message = format!("The joint gives way by {degrees:.3}°: no spring of a robot does that.");
            return Err(self
                .table
                .error(row, column.at, Code::TableRow, message)
                .hint("check the angle and the posture's name"));
        }
        Ok(angle)
    }

    /// Force and moment as they stand; `None` where all fields are empty.
    fn wrench(&self, row: &Row) -> Result<Option<Wrench>> {
        let (force, moment) = (&self.columns.force, &self.columns.moment);
        let blank = |column: &Column| self.table.is_blank(row, *column);
        if force.iter().chain(moment).all(blank) {
            return Ok(None);
        }
        Ok(Some(Wrench { force: self.table.vector(row, force)?, moment: self.table.vector(row, moment)? }))
    }

    fn no_wrench(&self, row: &Row) -> Error {
        let message = "A loaded state needs force and moment.";
        self.table.error(row, self.columns.force[0].at, Code::TableRow, message)
    }

    /// How the clamp moved: \[shift (m); turn (rad)\].
    fn motion(&self, row: &Row) -> Result<Option<Vector6<f64>>> {
        let (Some(shift), Some(turn)) = (&self.columns.shift, &self.columns.turn) else {
            return Ok(None);
        };
        let shift = self.table.vector(row, shift)?;
        let turn = self.table.vector(row, turn)?;
        Ok(Some(Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)))
    }

    /// The wrench on the robot at the loading point, base axes.
    fn on_robot(&self, q: &[f64], read: &Wrench) -> Wrench {
        match &self.cell.sensor {
            None => *read,
            Some(sensor) => {
                let frames = Frames::new(&self.cell.setup.robot, q);
                let clamp = frames.point(&self.cell.setup.tool.loading_point);
                sensor.wrench_on_robot(&frames, read, &clamp)
            }
        }
    }
}
