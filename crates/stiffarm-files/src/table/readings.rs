//! `posture,state,point,x_mm,y_mm,z_mm[,station][,fx_n,…][,mx_nm,…][,load_n][,time_s][,u95x_mm,…][,temperature_c][,q1_deg,…]`.

use super::beside::RowQuantity;
use super::columns::{MeasurementColumns, Plan};
use super::grid::{Row, Table};
use super::loads;
use super::unread;
use super::values::Values;
use std::collections::{BTreeMap, HashMap};
use stiffarm::error::{Code, Error, Result, did_you_mean};
use stiffarm::findings::{Finding, codes, list};
use stiffarm::model::cell::Cell;
use stiffarm::model::load::{Load, Wrench};
use stiffarm::model::measurement::{
    PendingReading, PostureReadings, Reading, ReadingTable, ReadingTarget, Role, StateReadings, WrenchColumns,
};
use stiffarm::model::posture::Posture;
use stiffarm::units::rad_to_shortest_deg;

/// Angles of one posture may differ by this between its load states, and from
/// the posture file: what a servo gives way is far less, a slip of the pen more.
const ANGLE_TOLERANCE_DEG: f64 = 2.0;

/// Reads raw readings from a table with one row per posture, load state, point
/// and repeat.
///
/// The state's name says what it is for ([`Role::of`]). A point is a measuring
/// point of the cell or a reflector on the base (`base`, `base-2`, …). Positions
/// are in tracker axes. Forces are as the cell's sensor reports them or, without
/// `[sensor]`, the wrench on the robot in base axes at the loading point; they
/// may be left empty in unloaded rows. `load_n` is the force of the cell's rope
/// or weight in that state; where it is not given, the force in the state's name (`up-250`)
/// counts, as in [`reading_sheet`](super::reading_sheet).
///
/// A row whose position is empty is not measured yet: it is named in
/// [`ReadingTable::pending`], and a posture that such rows leave without an unloaded or
/// a loaded reading in [`ReadingTable::incomplete`].
///
/// Each state keeps the angles that the table has for it. The posture's own
/// angles are those of its first unloaded state (else of its first state) or,
/// where the table has none, those of `postures`.
///
/// Of one that is `growing` the last posture is left aside while it has rows to be filled in, or fewer states or
/// readings than the others.
///
/// # Errors
/// A heading or row that cannot be read, unknown names, angles or forces that
/// differ within one posture and state, angles that differ by more than 2°
/// between the states or from `postures`, angles outside the machine's limits, a
/// posture without a loaded and an unloaded or preloaded reading of one point,
/// loads that nothing tells apart: with line, column and the column's name.
pub(super) fn readings(
    table: &Table<'_>,
    cell: &Cell,
    postures: Option<&[Posture]>,
    growing: bool,
) -> Result<ReadingTable> {
    let columns = MeasurementColumns::of(table, cell, Values::Positions, postures.is_some())?;
    let plan: Option<Plan<'_>> = postures.map(|list| list.iter().map(|p| (p.name.as_str(), p)).collect());
    let reader = Reader { table, cell, columns };
    let mut numbers: HashMap<&str, usize> = HashMap::new();
    let mut groups: Vec<Group<'_>> = Vec::new();
    let rows = table.rows()?;
    for row in &rows {
        let name = table.name(row, reader.columns.posture)?;
        let number = *numbers.entry(name).or_insert(groups.len());
        if number == groups.len() {
            groups.push(Group {
                row,
                planned: reader.columns.planned(table, row, plan.as_ref())?,
                states: Vec::new(),
                pending: Vec::new(),
            });
        }
        let of = [groups[number].row, row];
        reader.columns.same_station(table, of, Some(name))?;
        reader.columns.same_station(table, [groups[0].row, row], None)?;
        reader.add(&mut groups[number], row)?;
    }
    unread::check(table, &reader.columns, &rows)?;
    let mut out = ReadingTable {
        postures: Vec::new(),
        wrench_columns: reader.columns.wrench_columns(),
        pending: Vec::new(),
        incomplete: Vec::new(),
        remarks: table.remarks.clone(),
    };
    let mut named: BTreeMap<String, f64> = BTreeMap::new();
    let at_work = if growing { at_work(&groups) } else { None };
    for (number, mut group) in groups.into_iter().enumerate() {
        let pending = std::mem::take(&mut group.pending);
        let is_at_work = at_work == Some(number);
        let waiting = !pending.is_empty() || is_at_work;
        out.pending.extend(pending.iter().cloned());
        if group.states.is_empty() {
            continue;
        }
        reader.named_loads(&mut group, &mut named);
        let name = group.row.fields[reader.columns.posture.at].text.to_string();
        match reader.check_states(&group, &name) {
            Err(_) if waiting => out.incomplete.push(reader.close(group, name)?),
            Err(error) => return Err(error),
            Ok(()) if is_at_work => out.incomplete.push(reader.close(group, name)?),
            Ok(()) => {
                reader.check_loads(&group, &pending, &name)?;
                out.postures.push(reader.close(group, name)?);
            }
        }
    }
    out.remarks.extend(loads_from_names(&named));
    Ok(out)
}

/// Says which forces the names of states gave.
fn loads_from_names(named: &BTreeMap<String, f64>) -> Option<Finding> {
    let each = named.iter().map(|(state, force)| format!("{state}: {force} N"));
    let each: Vec<String> = each.collect();
    let sentence = format!(
        "The table does not give load_n of {}: the force is the one in the name ({}).",
        list(&Vec::from_iter(named.keys())),
        each.join(", ")
    );
    let remark = Finding::note(codes::LOADS_FROM_NAMES, "load", sentence);
    (!named.is_empty()).then_some(remark)
}

/// The last posture that has readings, if more of it is to come: rows of it are empty, or the others have more
/// states, or more readings in the state that it has come to.
fn at_work(groups: &[Group<'_>]) -> Option<usize> {
    let last = groups.iter().rposition(|group| !group.states.is_empty())?;
    let last_group = &groups[last];
    let (_, state) = last_group.states.last()?;
    let others = groups[..last].iter();
    let states = others.clone().map(|group| group.states.len()).max();
    let same = others.flat_map(|group| &group.states);
    let same = same.filter(|(_, other)| other.state == state.state);
    let readings = same.map(|(_, other)| other.readings.len()).max();
    let more = !last_group.pending.is_empty()
        || states.is_some_and(|states| last_group.states.len() < states)
        || readings.is_some_and(|readings| state.readings.len() < readings);
    // Alone it cannot be compared; a single state is no displacement either way.
    (more || last_group.states.len() < 2).then_some(last)
}

/// The rows of one posture: the first one, and its states with theirs.
struct Group<'t> {
    row: &'t Row<'t>,
    planned: Option<&'t Posture>,
    states: Vec<(&'t Row<'t>, StateReadings)>,
    /// Its rows without a position.
    pending: Vec<PendingReading>,
}

impl Group<'_> {
    /// The states of some roles, with their first rows.
    fn of(&self, roles: &'static [Role]) -> impl Iterator<Item = &(&Row<'_>, StateReadings)> {
        let states = self.states.iter();
        states.filter(move |(_, state)| roles.contains(&Role::of(&state.state)))
    }
}

/// A table with what its rows are read by.
struct Reader<'t, 'a> {
    table: &'t Table<'a>,
    cell: &'t Cell,
    columns: MeasurementColumns,
}

impl Reader<'_, '_> {
    /// Adds one row to its posture.
    fn add<'t>(&self, group: &mut Group<'t>, row: &'t Row<'t>) -> Result<()> {
        let (table, columns) = (self.table, &self.columns);
        let name = self.state_name(row)?;
        self.columns.load_case(self.table, row, self.cell, name)?;
        let role = Role::of(name);
        if columns.has_no_position(table, row) {
            self.target(row)?;
            group.pending.push(PendingReading {
                posture: row.fields[columns.posture.at].text.to_string(),
                state: name.to_string(),
                point: row.fields[columns.point.at].text.to_string(),
                station: columns.station(table, row)?,
                line: row.line,
            });
            return Ok(());
        }
        let mut reading = Reading::new(self.target(row)?, columns.vector(table, row)?);
        reading.line = row.line;
        columns.complete(table, row, &mut reading)?;
        let state = StateReadings {
            state: name.to_string(),
            angles: columns.row_angles(table, row, self.cell)?,
            wrench: self.wrench(row, role)?,
            load: self.load(row, role)?,
            readings: vec![reading],
        };
        let same = group.states.iter_mut().find(|(_, s)| s.state == name);
        if let Some((first, before)) = same {
            if (&before.angles, before.wrench, before.load) != (&state.angles, state.wrench, state.load) {
                return Err(columns.contradiction(table, first, row));
            }
            before.readings.extend(state.readings);
            return Ok(());
        }
        self.compare_angles(group, row, &state)?;
        group.states.push((row, state));
        Ok(())
    }

    /// The name of the row's state; a slip in `unloaded` would make it a load.
    fn state_name<'t>(&self, row: &'t Row<'t>) -> Result<&'t str> {
        let Some(column) = self.columns.state else {
            return Ok("");
        };
        let name = self.table.name(row, column)?;
        let letters: String = name.chars().filter(|c| c.is_alphabetic()).collect();
        let letters = letters.to_lowercase();
        if Role::of(name) != Role::Loaded || letters.starts_with("load") || letters.starts_with("reload") {
            return Ok(name);
        }
        let nearest = if ["noload", "zeroload", "empty"].contains(&letters.as_str()) {
            Some("name the state \"unloaded\"".to_string())
        } else {
            did_you_mean(&letters, ["unloaded", "preload"])
        };
        let Some(hint) = nearest else {
            return Ok(name);
        };
        let message = format!("The state \"{name}\" would be read as a loaded one.");
        let error = self.table.error(row, column.at, Code::UnknownName, message);
        Err(error.hint(hint))
    }

    /// Takes the forces that the table leaves open from the names of states, where those say them.
    fn named_loads(&self, group: &mut Group<'_>, named: &mut BTreeMap<String, f64>) {
        if self.columns.wrench_columns() != WrenchColumns::None {
            return;
        }
        for (_, state) in group.states.iter_mut().filter(|(_, s)| s.load.is_none()) {
            state.load = loads::named(&state.state, &self.cell.setup.load);
            named.extend(state.load.map(|force| (state.state.clone(), force)));
        }
    }

    fn target(&self, row: &Row) -> Result<ReadingTarget> {
        let name = self.table.name(row, self.columns.point)?;
        if ReadingTarget::is_base_name(name) {
            return Ok(ReadingTarget::Base(name.to_lowercase()));
        }
        let columns = &self.columns;
        let point = columns.measuring_point(self.table, row, self.cell, &["base"])?;
        Ok(ReadingTarget::Point(point))
    }

    /// Force and moment; an unloaded state may leave them empty.
    fn wrench(&self, row: &Row, role: Role) -> Result<Option<Wrench>> {
        if role == Role::Unloaded && self.columns.has_no_wrench(self.table, row) {
            return Ok(None);
        }
        self.columns.wrench(self.table, row)
    }

    /// Force of rope or weight \[N\], where the row has one.
    fn load(&self, row: &Row, role: Role) -> Result<Option<f64>> {
        let Some(column) = self.table.filled(row, self.columns.only(RowQuantity::Load)) else {
            return Ok(None);
        };
        let load = self.table.number(row, column)?;
        let wrong = match role {
            Role::Unloaded if load != 0.0 => "An unloaded state has no load.",
            Role::Preload if load < 0.0 => "A load is not below zero.",
            Role::Loaded if load <= 0.0 => "The load of a loaded state is above zero.",
            _ => return Ok(Some(load)),
        };
        let error = self.table.error(row, column.at, Code::InvalidValue, wrong);
        Err(error.hint("the direction is that of the cell's load; the state's name says its role"))
    }

    /// Refuses angles that are far from those of other states or of the plan.
    fn compare_angles(&self, group: &Group<'_>, row: &Row, state: &StateReadings) -> Result<()> {
        let first = group.states.first();
        let before = first.and_then(|(row, state)| {
            let place = format!("in the state \"{}\" on line {}", state.state, row.line);
            Some((state.angles.as_ref()?, place))
        });
        let planned = group.planned.map(|p| (&p.q, "in the posture file".to_string()));
        for (others, place) in before.into_iter().chain(planned) {
            let angles = state.angles.iter().flatten().zip(others).enumerate();
            for (j, (angle, other)) in angles {
                if (angle - other).abs() <= ANGLE_TOLERANCE_DEG.to_radians() {
                    continue;
                }
                let columns = self.columns.angles.iter().flatten();
                let at = columns.map(|column| column.at).nth(j).unwrap_or_default();
                let message = format!(
                    "{} is at {}° here and at {}° {place}: more than the {ANGLE_TOLERANCE_DEG}° that a servo may give.",
                    self.cell.setup.robot.joints()[j].name,
                    rad_to_shortest_deg(*angle),
                    rad_to_shortest_deg(*other),
                );
                let error = self.table.error(row, at, Code::Conflict, message);
                return Err(error.hint("correct the angle, or name the posture otherwise"));
            }
        }
        Ok(())
    }

    /// The posture, once all its rows are read.
    fn close(&self, group: Group<'_>, name: String) -> Result<PostureReadings> {
        let reference = group.of(&[Role::Unloaded]).chain(&group.states).next();
        let reference_angles = reference.and_then(|(_, state)| state.angles.clone());
        let planned = || Some(group.planned?.q.clone());
        let q = reference_angles.or_else(planned).unwrap_or_default();
        Ok(PostureReadings {
            posture: Posture { name, q },
            station: self.columns.station(self.table, group.row)?,
            states: group.states.into_iter().map(|(_, state)| state).collect(),
            axes: Default::default(),
        })
    }

    /// Some point must have been read both with and without the load.
    fn check_states(&self, group: &Group<'_>, name: &str) -> Result<()> {
        let points = |roles| -> Vec<&ReadingTarget> {
            let readings = group.of(roles).flat_map(|(_, state)| &state.readings);
            let targets = readings.map(|reading| &reading.target);
            targets.filter(|t| matches!(t, ReadingTarget::Point(_))).collect()
        };
        let before = points(&[Role::Unloaded, Role::Preload]);
        let loaded = points(&[Role::Loaded]);
        let (message, hint) = if before.is_empty() {
            (
                format!("Posture \"{name}\" has no unloaded reading of a measuring point."),
                "add rows with the state unloaded (or preload), or remove the posture",
            )
        } else if loaded.is_empty() {
            (
                format!("Posture \"{name}\" has no loaded reading of a measuring point."),
                "add rows with the state loaded, or remove the posture",
            )
        } else if !loaded.iter().any(|target| before.contains(target)) {
            (
                format!("Posture \"{name}\" has no measuring point that was read both unloaded and loaded."),
                "a displacement is the difference of two readings of one point",
            )
        } else {
            return Ok(());
        };
        Err(self.fault(group.row, message).hint(hint))
    }

    /// Without forces, several loads need to be told apart, those of `pending` rows among them.
    fn check_loads(&self, group: &Group<'_>, pending: &[PendingReading], name: &str) -> Result<()> {
        if self.columns.wrench_columns() != WrenchColumns::None {
            return Ok(());
        }
        let mut states = group.of(&[Role::Preload, Role::Loaded]);
        let mut to_come: Vec<&str> = pending.iter().map(|row| row.state.as_str()).collect();
        to_come.retain(|state| Role::of(state) != Role::Unloaded);
        to_come.retain(|state| !group.states.iter().any(|(_, measured)| measured.state == *state));
        to_come.sort_unstable();
        to_come.dedup();
        let count = group.of(&[Role::Preload, Role::Loaded]).count() + to_come.len();
        let cases = self.cell.setup.load.cases();
        if !cases.is_empty() {
            // Each state is under the load case of its name; several under one differ in size.
            for case in cases {
                let case_states = group.of(&[Role::Loaded]);
                let case_states: Vec<_> = case_states.filter(|(_, s)| case.is_of(&s.state)).collect();
                let unknown = case_states.iter().find(|(_, state)| state.load.is_none());
                let count = case_states.len() + to_come.iter().filter(|s| case.is_of(s)).count();
                if let (true, Some((row, state))) = (count > 1, unknown) {
                    let message = format!(
                        "Posture \"{name}\" has {count} states under load case {}, but the force of \"{}\" is not \
                         given.",
                        case.name, state.state
                    );
                    return Err(self.fault(row, message).hint(match case.load.size() {
                        Some(_) => {
                            "add the column load_n: the force in each of them, or name the states with it \
                            (-250); or the measured forces fx_n, fy_n, fz_n"
                        }
                        None => "add the columns fx_n, fy_n, fz_n: the force on the robot in each state",
                    }));
                }
            }
            return Ok(());
        }
        let Some((row, state)) = states.find(|(_, state)| state.load.is_none()) else {
            return Ok(());
        };
        if count < 2 {
            return Ok(());
        }
        let message =
            format!("Posture \"{name}\" has {count} load states, but the force of \"{}\" is not given.", state.state);
        let hint = match &self.cell.setup.load {
            Load::Rope { .. } | Load::Weight { .. } => {
                "add the column load_n: the force of rope, cylinder or weight in each state, or name the states with \
                 it (up-250); or the measured forces fx_n, fy_n, fz_n"
            }
            _ => "add the columns fx_n, fy_n, fz_n: the force on the robot in each state",
        };
        Err(self.fault(row, message).hint(hint))
    }

    /// An error about a posture or state that begins in `row`.
    fn fault(&self, row: &Row, message: String) -> Error {
        let column = self.columns.posture.at;
        self.table.error(row, column, Code::TooFewData, message)
    }
}
