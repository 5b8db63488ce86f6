//! Checks of a table's heading: every column known, none twice, none missing,
//! each with one of its units.

use super::beside::RowQuantity;
use super::grid::{Column, Table};
use super::heading_row::own_unit;
use super::naming::{joint_number, normal};
use super::quantity::{Quantity, Unit};
use super::suggest::{counts, suggestion};
use std::collections::BTreeMap;
use stiffarm::error::{Code, Error, Result, did_you_mean};
use stiffarm::units::Sense;

/// A column that a table may have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ColumnDefinition {
    /// Its name without the unit.
    stem: String,
    quantity: Quantity,
    /// Columns of one group are components in one unit.
    group: &'static str,
}

impl ColumnDefinition {
    pub(super) fn name(stem: &'static str) -> Self {
        ColumnDefinition::of(stem, Quantity::Name, stem)
    }

    pub(super) fn of(stem: impl Into<String>, quantity: Quantity, group: &'static str) -> Self {
        ColumnDefinition { stem: stem.into(), quantity, group }
    }

    /// `q1` to `qn`.
    pub(super) fn angles(joints: usize) -> impl Iterator<Item = ColumnDefinition> {
        (1..=joints).map(|j| ColumnDefinition::of(format!("q{j}"), Quantity::Angle, "q"))
    }

    /// The heading in the usual unit.
    pub(super) fn heading(&self) -> String {
        self.headings().next().unwrap_or_default()
    }

    /// The usual unit, if it has one.
    pub(super) fn usual_unit(&self) -> Option<Unit> {
        self.quantity.units().first().copied()
    }

    /// The headings in all units, the usual one first.
    pub(super) fn headings(&self) -> impl Iterator<Item = String> {
        let units = self.quantity.units().iter();
        let bare = self.quantity.units().is_empty().then(|| self.stem.clone());
        bare.into_iter().chain(units.map(|unit| format!("{}_{}", self.stem, unit.suffix)))
    }

    /// True for forces, moments and angles, whose names other programs have as well as ours.
    fn has_common_name(&self) -> bool {
        [Quantity::Force, Quantity::Moment, Quantity::Angle].contains(&self.quantity)
    }

    /// The column that a heading of this name is, at `at`.
    pub(super) fn column(&self, heading: &str, at: usize) -> Option<Column> {
        let rest = heading.strip_prefix(self.stem.as_str())?;
        if self.quantity.units().is_empty() {
            return rest.is_empty().then_some(Column { at, unit: None, sense: Sense::of(heading) });
        }
        let suffix = rest.strip_prefix('_')?;
        let mut units = self.quantity.units().iter();
        let unit = *units.find(|unit| unit.suffix == suffix)?;
        Some(Column { at, unit: Some(unit), sense: Sense::of(heading) })
    }
}

impl RowQuantity {
    /// Its columns.
    pub(super) fn definitions(self) -> Vec<ColumnDefinition> {
        let (stems, quantity, group) = self.columns();
        let stems = stems.iter();
        stems.map(|stem| ColumnDefinition::of(*stem, quantity, group)).collect()
    }
}

/// The columns of a table, by their names without unit.
#[derive(Debug)]
pub(super) struct NamedColumns<'t, 'a> {
    table: &'t Table<'a>,
    columns: BTreeMap<String, Column>,
}

impl<'a> Table<'a> {
    /// Checks that each column is known, stands once, and has the unit of its group.
    pub(super) fn check_heading(
        &self,
        definitions: &[ColumnDefinition],
        joints: usize,
    ) -> Result<NamedColumns<'_, 'a>> {
        let numeric = |text: &str| text.replacen(',', ".", 1).parse::<f64>().is_ok();
        let (first, rest) = (self.headings.first(), self.headings.get(1..).unwrap_or(&[]));
        let all = first.is_some() && !rest.is_empty() && rest.iter().all(|h| numeric(&h.name));
        // Three coordinates, whatever separates them.
        let words = self.headings.iter().flat_map(|h| h.name.split_whitespace());
        if all || words.filter(|word| numeric(word)).count() >= 3 {
            let message = "The first line holds numbers; it must name the columns.";
            let mut hint = format!("columns: {}", list(definitions, ","));
            if is_foreign(definitions) {
                hint += "; or say in [columns] of the cell file what the columns are, for example order = [\"name\", \
                    \"x_mm\", \"y_mm\", \"z_mm\"], or which software wrote them, for example profile = \
                    \"spatialanalyzer\"";
            }
            return Err(self.heading_error(None, Code::TableHeading, message).hint(hint));
        }
        let mut columns = BTreeMap::new();
        let mut groups: BTreeMap<&str, Column> = BTreeMap::new();
        for (at, heading) in self.headings.iter().enumerate() {
            if heading.ignored {
                continue;
            }
            if heading.name.is_empty() {
                let message = "A column has no name.";
                let error = self.heading_error(Some(at), Code::TableHeading, message);
                let hint = "give it a heading; where columns without one do not matter, write ignore = [\"\"] into \
                    [columns] of the cell file";
                let error = error.hint_if(is_foreign(definitions).then(|| hint.to_string()));
                return Err(self.two_rows(definitions).unwrap_or(error));
            }
            let matching = definitions.iter().find_map(|k| k.column(&heading.name, at).map(|column| (k, column)));
            let Some((k, column)) = matching else {
                let two_rows = self.two_rows(definitions);
                return Err(two_rows.unwrap_or_else(|| self.unknown_column(at, definitions, joints)));
            };
            if let Some(first) = columns.insert(k.stem.clone(), column) {
                return Err(self.twice(first, column));
            }
            let first = *groups.entry(k.group).or_insert(column);
            let suffix = |column: Column| column.unit.map(|unit| unit.suffix);
            if suffix(first) != suffix(column) {
                let other = &self.headings[first.at].shown;
                let message = format!("The unit is not that of {other}.");
                let error = self.heading_error(Some(at), Code::Conflict, message);
                return Err(error.hint(format!("give these {} in one unit", k.quantity.plural())));
            }
        }
        Ok(NamedColumns { table: self, columns })
    }

    /// The error of a heading of two rows, `position [mm]` above x, y and z, where it is one.
    fn two_rows(&self, definitions: &[ColumnDefinition]) -> Option<Error> {
        let below = (self.rows.len() > 1).then(|| self.rows.at(1))?;
        let is_known = |name: &String| definitions.iter().any(|k| k.column(name, 0).is_some());
        let (mut names, mut understood) = (Vec::new(), 0);
        let mut group = "";
        for (at, field) in below.fields.iter().enumerate() {
            let above = self.headings.get(at);
            if let Some(heading) = above.filter(|heading| is_known(&heading.name)) {
                names.push(heading.name.clone());
                continue;
            }
            let shown = above.map_or("", |heading| heading.shown.as_str());
            group = if shown.is_empty() { group } else { shown };
            let name = normal(&field.text);
            // Its unit may stand above it, or be all that stands below.
            let unit = group.rsplit_once(['[', '(']).map_or("", |(_, unit)| unit);
            let unit = unit.trim_end_matches([']', ')']);
            let below = field.text.trim_matches(['[', ']', '(', ')']);
            let with_unit = [name.clone(), format!("{name} [{unit}]"), format!("{shown} [{below}]")];
            let headings = with_unit.iter().filter_map(|n| own_unit(&normal(n)));
            let bare = definitions.iter().find(|k| k.stem == name);
            let heading = [name.clone()].into_iter().chain(headings).find(is_known);
            let heading = heading.or_else(|| bare.map(ColumnDefinition::heading));
            understood += usize::from(heading.is_some());
            // What is not understood keeps its place.
            names.push(heading.unwrap_or_else(|| [shown, &field.text].join(" ").trim().to_string()));
        }
        let error = self.heading_error(None, Code::TableHeading, "The heading has two rows; that of a table has one.");
        (understood >= 2).then(|| error.hint(format!("write one row: {}", names.join(","))))
    }

    fn twice(&self, first: Column, second: Column) -> Error {
        let [a, b] = [first.at, second.at].map(|at| &self.headings[at]);
        if a.name == b.name {
            let message = "The column appears twice.";
            let error = self.heading_error(Some(second.at), Code::TableHeading, message);
            return if a.shown == b.shown { error } else { error.hint(format!("{} is the same column", a.shown)) };
        }
        let message = format!("The column appears twice; {} is there already.", a.shown);
        self.heading_error(Some(second.at), Code::Conflict, message).hint("keep one of them")
    }

    fn unknown_column(&self, column: usize, definitions: &[ColumnDefinition], joints: usize) -> Error {
        let name = self.headings[column].name.as_str();
        let error = self.heading_error(Some(column), Code::TableHeading, "The table has no column of this name.");
        if self.headings.len() == 1 {
            let hint = "separate the columns with commas, semicolons or tabs".to_string();
            let shown = &self.headings[0].shown;
            let mut signs = ["//", "%", "!", "*"].into_iter();
            let sign = signs.find(|sign| shown.starts_with(sign));
            return error.hint(match (is_foreign(definitions), sign) {
                (true, Some(sign)) => {
                    format!("where such lines are remarks, write comment = \"{sign}\" into [columns] of the cell file")
                }
                (true, None) if shown.contains(' ') => {
                    hint + "; where spaces do, write separator = \"space\" into [columns] of the cell file"
                }
                _ => hint,
            });
        }
        let is_known = |name: &str| definitions.iter().any(|k| k.column(name, 0).is_some());
        let foreign = is_foreign(definitions);
        if let Some(hint) = counts(&self.headings[column..=column]).filter(|_| foreign) {
            return error.hint(hint);
        }
        let others = self.headings.iter().filter(|heading| !heading.ignored);
        let others = others.filter(|heading| !is_known(&heading.name)).count();
        let keys = suggestion(&self.headings, is_known).filter(|_| foreign);
        let suggested = keys.map(|keys| {
            format!(
                "say in [columns] of the cell file what these headings are, a line for each, with the unit that the \
                 file has, for example: {keys}"
            )
        });
        // A heading of ours with a unit of its own is a matter of that unit.
        let has_unit = |k: &ColumnDefinition| k.stem == stem(name) && !k.quantity.units().is_empty();
        let unit_is_wrong = definitions.iter().any(has_unit) && stem(name) != name;
        // Names of ours without their unit are a matter of that unit, too.
        let bare = |name: &str| definitions.iter().any(|k| k.stem == name && k.has_common_name());
        let mut theirs = self.headings.iter().map(|heading| heading.name.as_str());
        let unit_is_wrong = unit_is_wrong || theirs.all(|name| is_known(name) || bare(name));
        if let Some(hint) = suggested.clone().filter(|_| others > 1 && !unit_is_wrong) {
            return error.hint(hint);
        }
        if let Some((joint, unit)) = joint_number(name).filter(|_| joints > 0) {
            let definition = definitions.iter().find(|k| k.stem == format!("q{joint}"));
            return error.hint(match definition {
                Some(definition) => rename(unit, definition),
                None => format!("the robot has {joints} joints"),
            });
        }
        if let Some(same) = definitions.iter().find(|k| k.stem == stem(name)) {
            return error.hint(rename(&name[stem(name).len()..], same));
        }
        let without_unit = |k: &&ColumnDefinition| {
            let rest = name.strip_prefix(k.stem.as_str());
            k.quantity == Quantity::Number && rest.is_some_and(|rest| rest.starts_with('_'))
        };
        if let Some(same) = definitions.iter().find(without_unit) {
            return error.hint(format!("it has no unit: name the column {}", same.stem));
        }
        let names: Vec<String> = definitions.iter().flat_map(ColumnDefinition::headings).collect();
        let theirs = self.foreign.iter().map(String::as_str);
        let nearest = did_you_mean(name, names.iter().map(String::as_str).chain(theirs));
        error.hint(nearest.or(suggested).unwrap_or_else(|| {
            let mut hint = format!("known columns: {}", list(definitions, ", "));
            if foreign {
                hint += "; [columns] in the cell file maps other headings to these, or ignores them";
            }
            hint
        }))
    }
}

impl NamedColumns<'_, '_> {
    /// The column of this name without unit.
    pub(super) fn get(&self, stem: &str) -> Option<Column> {
        self.columns.get(stem).copied()
    }

    /// The column of `definition`.
    pub(super) fn of(&self, definition: &ColumnDefinition) -> Option<Column> {
        self.get(&definition.stem)
    }

    /// A column that must be there.
    pub(super) fn require(&self, definition: &ColumnDefinition, hint: &str) -> Result<Column> {
        self.get(&definition.stem).ok_or_else(|| {
            let message = format!("The column {} is missing.", definition.heading());
            self.table.heading_error(None, Code::TableHeading, message).hint(hint)
        })
    }

    /// Columns that are there together or not at all.
    pub(super) fn all_or_none(&self, group: &[ColumnDefinition], hint: &str) -> Result<Option<Vec<Column>>> {
        if group.iter().all(|definition| self.get(&definition.stem).is_none()) {
            return Ok(None);
        }
        self.all(group, hint).map(Some)
    }

    /// Columns that must be there together.
    pub(super) fn all(&self, group: &[ColumnDefinition], hint: &str) -> Result<Vec<Column>> {
        let unit = group.iter().find_map(|definition| self.get(&definition.stem)?.unit);
        let columns = group.iter().map(|definition| {
            self.require(definition, hint).map_err(|error| match unit {
                // The one that is missing has the unit of those that are there.
                Some(unit) => {
                    let message = format!("The column {}_{} is missing.", definition.stem, unit.suffix);
                    let error = self.table.heading_error(None, Code::TableHeading, message);
                    error.hint(hint)
                }
                None => error,
            })
        });
        columns.collect()
    }
}

/// True for the columns of measurements and paths, which alone come from another software.
fn is_foreign(definitions: &[ColumnDefinition]) -> bool {
    definitions.iter().any(|k| k.stem == "point")
}

/// The known headings in their usual units.
fn list(definitions: &[ColumnDefinition], separator: &str) -> String {
    let names: Vec<String> = definitions.iter().map(ColumnDefinition::heading).collect();
    names.join(separator)
}

/// The quantity of a column's name, without its unit.
pub(super) fn stem(name: &str) -> &str {
    name.split(|c: char| !c.is_alphanumeric()).next().unwrap_or(name)
}

/// What to do with the column of `definition` whose unit is written as `unit`.
fn rename(unit: &str, definition: &ColumnDefinition) -> String {
    let letters: String = unit.chars().filter(|c| c.is_alphanumeric()).collect();
    let headings: Vec<String> = definition.headings().collect();
    let suffixes: Vec<&str> = definition.quantity.units().iter().map(|u| u.suffix).collect();
    let plural = definition.quantity.plural();
    if let Some(at) = suffixes.iter().position(|suffix| *suffix == letters) {
        format!("name the column {}", headings[at])
    } else if definition.quantity.units().is_empty() {
        format!("name the column {}", definition.heading())
    } else if letters.is_empty() {
        format!("{plural} carry their unit: name the column {}", or(&headings))
    } else {
        format!(
            "units of {plural} are {}: convert the values, and name the column {}",
            or(&suffixes),
            definition.heading()
        )
    }
}

/// A choice in words: `a, b or c`.
fn or<S: AsRef<str>>(names: &[S]) -> String {
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

/// The known heading that `name` is, in one of its units, as it is written here.
///
/// # Errors
/// A name that no known column has, with the nearest, among `also`, too, as a hint.
pub(super) fn find_heading(name: &str, definitions: &[ColumnDefinition], joints: usize, also: &str) -> Result<String> {
    let heading = normal(name);
    if definitions.iter().any(|k| k.column(&heading, 0).is_some()) {
        return Ok(heading);
    }
    let names: Vec<String> = definitions.iter().flat_map(ColumnDefinition::headings).collect();
    let same = definitions.iter().find(|k| k.stem == stem(&heading));
    let hint = match (same, joint_number(&heading)) {
        (Some(same), _) => format!("write {}", or(&same.headings().collect::<Vec<_>>())),
        (None, Some((joint, _))) if !(1..=joints).contains(&joint) => {
            format!("the robot has {joints} joints")
        }
        _ => did_you_mean(&heading, names.iter().map(String::as_str).chain([also]))
            .unwrap_or_else(|| format!("columns: {}", list(definitions, ", "))),
    };
    let message = format!("No table of measurements or of a path has a column \"{name}\".");
    Err(Error::new(Code::UnknownKey, message).hint(hint))
}
