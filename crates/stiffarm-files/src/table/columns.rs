//! The columns that tables of displacements and of readings share.

use super::beside::RowQuantity;
use super::grid::{Column, Row, Table};
use super::heading::ColumnDefinition;
use super::postures::angles;
use super::values::Values;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stiffarm::error::{Code, Error, Result, did_you_mean};
use stiffarm::model::cell::Cell;
use stiffarm::model::load::{Load, Wrench};
use stiffarm::model::measurement::{Reading, Role, WrenchColumns};
use stiffarm::model::posture::Posture;

/// Postures of a posture file, by name.
pub(super) type Plan<'p> = BTreeMap<&'p str, &'p Posture>;

/// Positions and units of the columns.
pub(super) struct MeasurementColumns {
    pub(super) posture: Column,
    pub(super) state: Option<Column>,
    pub(super) point: Column,
    vector: Vec<Column>,
    beside: BTreeMap<RowQuantity, Vec<Column>>,
    pub(super) angles: Option<Vec<Column>>,
}

impl MeasurementColumns {
    pub(super) fn of(table: &Table<'_>, cell: &Cell, values: Values, has_postures: bool) -> Result<Self> {
        let joints = cell.setup.robot.joint_count();
        let heading = table.check_heading(&values.definitions(joints), joints)?;
        let fault = |column: Option<Column>, code: Code, message: &str, hint: &str| {
            let at = column.map(|column| column.at);
            Err(table.heading_error(at, code, message).hint(hint))
        };
        let hint = match values {
            Values::Positions => {
                "a table of readings has the columns posture, state, point, x_mm, y_mm, z_mm; one without names is \
                 read beside the sheet in whose order it was taken: give both"
            }
            Values::Displacements => "a table of displacements has the columns posture, point, dx_mm, dy_mm, dz_mm",
        };
        let hint = hint.to_string() + &unmatched(table, cell, &values.definitions(joints));
        let posture = heading.require(&ColumnDefinition::name("posture"), &hint)?;
        let state = match values {
            Values::Positions => Some(heading.require(&ColumnDefinition::name("state"), &hint)?),
            Values::Displacements => heading.get("state"),
        };
        let point = heading.require(&ColumnDefinition::name("point"), &hint)?;
        let vector = heading.all(&values.components(), &hint)?;
        let mut beside: BTreeMap<RowQuantity, Vec<Column>> = BTreeMap::new();
        for quantity in values.beside() {
            let columns = heading.all_or_none(&quantity.definitions(), &quantity.hint())?;
            beside.extend(columns.map(|columns| (quantity, columns)));
        }
        let first = |quantity| beside.get(&quantity).and_then(|columns| columns.first().copied());
        let force = first(RowQuantity::Force);
        if force.is_none() && cell.setup.load == Load::Measured {
            let message = "The cell's load is measured, but the table has no forces.";
            let hint = match (values, &cell.sensor) {
                (Values::Displacements, _) => {
                    "add fx_n, fy_n, fz_n: the force on the robot in base axes, loaded minus unloaded"
                }
                (Values::Positions, Some(_)) => {
                    "add fx_n, fy_n, fz_n, mx_nm, my_nm, mz_nm as the sensor reports them in each state"
                }
                (Values::Positions, None) => {
                    "add fx_n, fy_n, fz_n: the force on the robot in base axes; or give readings of a sensor, and its \
                     pose in [sensor]"
                }
            };
            return fault(None, Code::TableHeading, message, hint);
        }
        if let (None, Some(moment)) = (force, first(RowQuantity::Moment)) {
            let message = "The table has moments but no forces.";
            let hint = "add fx_n, fy_n, fz_n (zeros where a pure moment acts)";
            return fault(Some(moment), Code::TableHeading, message, hint);
        }
        if let (Some(load), false) = (first(RowQuantity::Load), cell.setup.load.each().any(|l| l.size().is_some())) {
            let message = "Only a rope, a cylinder with anchor_mm or a weight has one force per state, and the cell's \
                load is none.";
            let hint = "give fx_n, fy_n, fz_n, or set load.kind to \"rope\", \"cylinder\" or \"weight\"";
            return fault(Some(load), Code::Conflict, message, hint);
        }
        let angle_columns: Vec<ColumnDefinition> = ColumnDefinition::angles(joints).collect();
        let hint = format!("give the angles of all {joints} joints, or a posture file");
        let angles = heading.all_or_none(&angle_columns, &hint)?;
        if angles.is_none() && !has_postures {
            let message = "The table has no controller angles.";
            let hint = format!("add q1_deg to q{joints}_deg, or give the posture file whose names the table uses");
            return fault(None, Code::TableHeading, message, &hint);
        }
        Ok(MeasurementColumns { posture, state, point, vector, beside, angles })
    }

    /// The columns of a quantity; none where the table has not got it.
    fn of_beside(&self, quantity: RowQuantity) -> &[Column] {
        self.beside.get(&quantity).map_or(&[], Vec::as_slice)
    }

    /// The column of a quantity that has one.
    pub(super) fn only(&self, quantity: RowQuantity) -> Option<Column> {
        self.of_beside(quantity).first().copied()
    }

    /// Which columns of force there are.
    pub(super) fn wrench_columns(&self) -> WrenchColumns {
        match [RowQuantity::Force, RowQuantity::Moment].map(|quantity| self.only(quantity)) {
            [None, _] => WrenchColumns::None,
            [Some(_), None] => WrenchColumns::Force,
            [Some(_), Some(_)] => WrenchColumns::ForceAndMoment,
        }
    }

    /// Position or displacement \[m\].
    pub(super) fn vector(&self, table: &Table<'_>, row: &Row) -> Result<Vector3<f64>> {
        table.vector(row, &self.vector)
    }

    /// The column of a component of the position or displacement.
    pub(super) fn component(&self, number: usize) -> Column {
        self.vector[number]
    }

    /// True where all three lengths are empty.
    pub(super) fn has_no_position(&self, table: &Table<'_>, row: &Row) -> bool {
        self.vector.iter().all(|c| table.is_blank(row, *c))
    }

    /// Refuses a loaded state that belongs to none of the cell's load cases; the number of the
    /// one it belongs to, 0 where there is a single load.
    pub(super) fn load_case(&self, table: &Table<'_>, row: &Row, cell: &Cell, state: &str) -> Result<usize> {
        if Role::of(state) != Role::Loaded {
            return Ok(0);
        }
        let load = &cell.setup.load;
        if self.state.is_none() && load.has_cases() {
            let message = "The table has no column state, which says under which load case a row was measured.";
            return Err(table
                .heading_error(None, Code::TableHeading, message)
                .hint(format!("add it, with one of: {}", load.case_names())));
        }
        let at = self.state.unwrap_or(self.posture).at;
        load.case_of(state).map_err(|error| {
            let hint = error.hint_text().unwrap_or_default().to_string();
            let named = table.error(row, at, Code::UnknownName, error.message());
            named.hint(hint)
        })
    }

    /// Name of the tracker's station, where the row has one.
    pub(super) fn station(&self, table: &Table<'_>, row: &Row) -> Result<Option<String>> {
        let column = table.filled(row, self.only(RowQuantity::Station));
        let name = column.map(|column| table.name(row, column)).transpose()?;
        Ok(name.map(String::from))
    }

    /// Refuses a row of a posture, `of`, that is read from another station than the row `first`, or a table that names
    /// the station of one and not of the other.
    pub(super) fn same_station(&self, table: &Table<'_>, [first, row]: [&Row<'_>; 2], of: Option<&str>) -> Result<()> {
        let (Some(column), [before, station]) =
            (self.only(RowQuantity::Station), [self.station(table, first)?, self.station(table, row)?])
        else {
            return Ok(());
        };
        let shown = |name: &Option<String>| match name {
            Some(name) => format!("from station {name}"),
            None => "from no station".to_string(),
        };
        let (message, hint) = match of {
            _ if before == station => return Ok(()),
            Some(posture) if before.is_some() && station.is_some() => (
                format!(
                    "Posture \"{posture}\" is read {} here and {} on line {}.",
                    shown(&station),
                    shown(&before),
                    first.line
                ),
                "a displacement is the difference of two readings from one station: name the posture otherwise where \
                 it is read from another, with unloaded and loaded rows of its own",
            ),
            None if before.is_some() == station.is_some() => return Ok(()),
            _ => (
                format!("This row is read {}, line {} {}.", shown(&station), first.line, shown(&before)),
                "name the station of every posture, or leave the column out where the tracker stood in one place",
            ),
        };
        Err(table.error(row, column.at, Code::Conflict, message).hint(hint))
    }

    /// Time \[s\], where the row has one.
    pub(super) fn time(&self, table: &Table<'_>, row: &Row) -> Result<Option<f64>> {
        let column = table.filled(row, self.only(RowQuantity::Time));
        column.map(|column| table.number(row, column)).transpose()
    }

    /// Takes what the row says beside its position into `reading`.
    pub(super) fn complete(&self, table: &Table<'_>, row: &Row, reading: &mut Reading) -> Result<()> {
        for (quantity, columns) in &self.beside {
            let is_blank = columns.iter().all(|column| table.is_blank(row, *column));
            let Some(set) = quantity.setter().filter(|_| !is_blank) else {
                continue;
            };
            let value = table.vector(row, columns)?;
            let mut components = columns.iter().zip(&value);
            let wrong = components.find(|(_, component)| **component < 0.0);
            if let (Some(size), Some((column, _))) = (quantity.size(), wrong) {
                let message = format!("{size} is not below zero.");
                return Err(table.error(row, column.at, Code::InvalidValue, message));
            }
            set(reading, value);
        }
        Ok(())
    }

    /// Force and moment \[N, N·m\]; a moment without columns is zero.
    pub(super) fn wrench(&self, table: &Table<'_>, row: &Row) -> Result<Option<Wrench>> {
        let [force, moment] = [RowQuantity::Force, RowQuantity::Moment].map(|quantity| self.of_beside(quantity));
        if force.is_empty() {
            return Ok(None);
        }
        Ok(Some(Wrench { force: table.vector(row, force)?, moment: table.vector(row, moment)? }))
    }

    /// True where all fields of force and moment are empty.
    pub(super) fn has_no_wrench(&self, table: &Table<'_>, row: &Row) -> bool {
        let groups = [RowQuantity::Force, RowQuantity::Moment].map(|quantity| self.of_beside(quantity));
        let mut columns = groups.iter().flat_map(|columns| columns.iter());
        columns.all(|column| table.is_blank(row, *column))
    }

    /// The row's own controller angles \[rad\], inside the machine's limits.
    pub(super) fn row_angles(&self, table: &Table<'_>, row: &Row, cell: &Cell) -> Result<Option<Vec<f64>>> {
        let columns = self.angles.as_ref();
        columns.map(|columns| angles(table, row, columns, &cell.setup.robot)).transpose()
    }

    /// The posture of the posture file that the row names.
    pub(super) fn planned<'p>(
        &self,
        table: &Table<'_>,
        row: &Row,
        plan: Option<&Plan<'p>>,
    ) -> Result<Option<&'p Posture>> {
        let Some(plan) = plan else {
            return Ok(None);
        };
        let name = row.fields[self.posture.at].text.as_str();
        if let Some(posture) = plan.get(name) {
            return Ok(Some(posture));
        }
        let message = format!("The posture file has no posture \"{name}\".");
        let error = table.error(row, self.posture.at, Code::UnknownName, message);
        Err(error.hint_if(did_you_mean(name, plan.keys().copied())))
    }

    /// Index of the measuring point that the row names; `also` are names that
    /// the table knows beside.
    pub(super) fn measuring_point(&self, table: &Table<'_>, row: &Row, cell: &Cell, also: &[&str]) -> Result<usize> {
        let name = table.name(row, self.point)?;
        let tool = &cell.setup.tool;
        if let Some(point) = tool.point_index(name) {
            return Ok(point);
        }
        let point_names = tool.measuring_points.iter().map(|p| p.name.as_str());
        let names: Vec<&str> = point_names.chain(also.iter().copied()).collect();
        let message = format!("The cell has no measuring point \"{name}\".");
        let hint = did_you_mean(name, names.iter().copied())
            .unwrap_or_else(|| format!("measuring points: {}", names.join(", ")));
        let error = table.error(row, self.point.at, Code::UnknownName, message);
        Err(error.hint(hint))
    }

    /// The first column in which two rows of one posture and state differ.
    pub(super) fn contradiction(&self, table: &Table<'_>, first: &Row, row: &Row) -> Error {
        let angles = self.angles.iter().flatten();
        let quantities = [RowQuantity::Force, RowQuantity::Moment, RowQuantity::Load];
        let columns = angles.chain(quantities.iter().flat_map(|quantity| self.of_beside(*quantity)));
        let differs = |column: &Column| table.number(first, *column).ok() != table.number(row, *column).ok();
        let column = columns.copied().find(differs).unwrap_or(self.posture);
        let shown = |row: &Row| match row.fields[column.at].text.as_str() {
            "" => "An empty field".to_string(),
            text => text.to_string(),
        };
        let message = format!(
            "{} differs from {} on line {}, but the posture and its state are the same.",
            shown(row),
            shown(first).replace("An empty", "an empty"),
            first.line
        );
        table
            .error(row, column.at, Code::Conflict, message)
            .hint("angles and wrench belong to the posture and state: average them, or name another state")
    }
}

/// Says which of the cell's foreign headings the table has not, for hints.
fn unmatched(table: &Table<'_>, cell: &Cell, definitions: &[ColumnDefinition]) -> String {
    let missing = |ours: &String| {
        // A path has columns that measurements have not.
        definitions.iter().any(|k| k.headings().any(|heading| heading == *ours))
            && table.headings.iter().all(|heading| heading.name != *ours)
    };
    let names = cell.columns.names.iter();
    let names: Vec<String> =
        names.filter(|(ours, _)| missing(ours)).map(|(_, theirs)| format!("\"{theirs}\"")).collect();
    if names.is_empty() {
        return String::new();
    }
    format!("; [columns] in the cell file looks for {}, which the table has not", names.join(", "))
}
