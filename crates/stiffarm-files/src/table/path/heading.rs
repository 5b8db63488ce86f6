//! The heading of a path: which columns it has, and what they say together.

use super::contents::{Content, PathKind, axis, contents, position, turns};
use super::format::FormatColumn;
use crate::table::beside::RowQuantity;
use crate::table::grid::{Column, Table};
use crate::table::heading::{ColumnDefinition, NamedColumns, stem};
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::cell::Cell;

/// Names of the angles of a pose at controllers, and what they are here:
/// turns about x, then y, then z of the frame that stays.
const CONTROLLERS: [(&str, [(&str, &str); 3]); 2] =
    [("KUKA", [("a", "yaw"), ("b", "pitch"), ("c", "roll")]), ("FANUC", [("w", "roll"), ("p", "pitch"), ("r", "yaw")])];

/// Positions and units of the columns.
pub(super) struct PathColumns {
    pub(super) kind: PathKind,
    pub(super) point: Option<Column>,
    pub(super) angles: Vec<Column>,
    pub(super) position: Vec<Column>,
    /// Roll, pitch, yaw or the tool axis.
    pub(super) orientation: Vec<Column>,
    pub(super) force: Option<Vec<Column>>,
    pub(super) moment: Option<Vec<Column>>,
    pub(super) axes: Option<Column>,
    pub(super) feature: Option<Column>,
    pub(super) feed: Option<Column>,
    /// All of them in the order of the table.
    pub(super) format: Vec<FormatColumn>,
}

impl PathColumns {
    pub(super) fn of(table: &Table<'_>, cell: &Cell) -> Result<Self> {
        let joints = cell.setup.robot.joint_count();
        let mut contents = contents(joints);
        // A table of postures is a path, too: its names stand under `posture`.
        contents.push((Content::Name, ColumnDefinition::name("posture")));
        let definitions: Vec<ColumnDefinition> = contents.iter().map(|(_, definition)| definition.clone()).collect();
        let heading = table.check_heading(&definitions, joints).map_err(|error| controller_angles(table, error))?;
        let names = [heading.get("point"), heading.get("posture")];
        if let [Some(_), Some(second)] = names {
            let message = "The table has both points and postures as names.";
            let error = table.heading_error(Some(second.at), Code::Conflict, message);
            return Err(error.hint("keep one of them"));
        }
        let kind = kind(table, &heading, joints)?;
        let all = |group: &[ColumnDefinition], hint: &str| heading.all(group, hint);
        let (angles, position, orientation) = match kind {
            PathKind::Angles => {
                let angle_columns: Vec<ColumnDefinition> = ColumnDefinition::angles(joints).collect();
                let hint = format!("give the angles of all {joints} joints");
                (all(&angle_columns, &hint)?, Vec::new(), Vec::new())
            }
            PathKind::Poses | PathKind::ToolAxes => {
                let orientation = match kind {
                    PathKind::Poses => turns(),
                    _ => axis(),
                };
                let hint = "give all three coordinates of the tip's position";
                let position = all(&position(), hint)?;
                let hint = "give all three: roll_deg, pitch_deg, yaw_deg, or axis_x, axis_y, axis_z";
                (Vec::new(), position, all(&orientation, hint)?)
            }
        };
        let all_or_none = |quantity: RowQuantity| heading.all_or_none(&quantity.definitions(), &quantity.hint());
        let (force, moment) = (all_or_none(RowQuantity::Force)?, all_or_none(RowQuantity::Moment)?);
        if let (None, Some(moment)) = (&force, &moment) {
            let message = "The table has moments but no forces.";
            let error = table.heading_error(Some(moment[0].at), Code::TableHeading, message);
            return Err(error.hint("add fx_n, fy_n, fz_n (zeros where a pure moment acts)"));
        }
        let mut format: Vec<(usize, FormatColumn)> = contents
            .iter()
            .filter_map(|(content, definition)| {
                let column = heading.of(definition)?;
                let shown = table.headings[column.at].shown.clone();
                Some((column.at, FormatColumn::new(shown, *content, column.unit)))
            })
            .collect();
        format.sort_by_key(|(at, _)| *at);
        Ok(PathColumns {
            kind,
            point: names.into_iter().flatten().next(),
            angles,
            position,
            orientation,
            force,
            moment,
            axes: heading.get("axes"),
            feature: heading.get("feature"),
            feed: heading.get("feed"),
            format: format.into_iter().map(|(_, column)| column).collect(),
        })
    }
}

/// What the rows say of the tip.
fn kind(table: &Table<'_>, heading: &NamedColumns<'_, '_>, joints: usize) -> Result<PathKind> {
    let first = |group: &[ColumnDefinition]| {
        let columns = group.iter().filter_map(|definition| heading.of(definition));
        columns.map(|column| column.at).min()
    };
    let angles: Vec<ColumnDefinition> = ColumnDefinition::angles(joints).collect();
    let (angles, position) = (first(&angles), first(&position()));
    let (turns, axis) = (first(&turns()), first(&axis()));
    let pose = [position, turns, axis].into_iter().flatten().min();
    if let (Some(angles), Some(pose)) = (angles, pose) {
        let message = "The table has both joint angles and poses.";
        let error = table.heading_error(Some(angles.max(pose)), Code::Conflict, message);
        return Err(error.hint("keep one of them; `ignore` in [columns] of the cell file leaves columns out"));
    }
    if let (Some(turns), Some(axis)) = (turns, axis) {
        let message = "The table has both roll, pitch, yaw and a tool axis.";
        let error = table.heading_error(Some(turns.max(axis)), Code::Conflict, message);
        return Err(error.hint(
            "keep roll, pitch, yaw for a fixed orientation, or axis_x, axis_y, axis_z where the tool may turn about \
             its axis",
        ));
    }
    match (angles, position, turns, axis) {
        (Some(_), ..) => Ok(PathKind::Angles),
        (None, _, Some(_), _) => Ok(PathKind::Poses),
        (None, _, None, Some(_)) => Ok(PathKind::ToolAxes),
        (None, Some(_), None, None) => {
            let message = "The table gives positions of the tip, but no orientation of the tool.";
            let error = table.heading_error(None, Code::TableHeading, message);
            Err(error.hint(
                "add roll_deg, pitch_deg, yaw_deg, or axis_x, axis_y, axis_z where the tool may turn about its axis",
            ))
        }
        (None, None, None, None) => {
            let message = "The table has neither joint angles nor poses.";
            let error = table.heading_error(None, Code::TableHeading, message);
            Err(error.hint(format!(
                "give q1_deg to q{joints}_deg, or x_mm, y_mm, z_mm with roll_deg, pitch_deg, yaw_deg or axis_x, \
                 axis_y, axis_z"
            )))
        }
    }
}

/// Says what the angles of a pose are called here, where the heading has those
/// of a controller.
fn controller_angles(table: &Table<'_>, error: Error) -> Error {
    let has = |name: &str| {
        let mut headings = table.headings.iter();
        headings.any(|heading| !heading.ignored && stem(&heading.name) == name)
    };
    let theirs = CONTROLLERS.iter().find(|(_, names)| names.iter().all(|(theirs, _)| has(theirs)));
    let Some((maker, [a, b, c])) = theirs else {
        return error;
    };
    let ours = |(theirs, ours): &(&str, &str)| format!("{} {ours}_deg", theirs.to_uppercase());
    error.hint(format!("{maker}'s angles of a pose have other names here: {}, {}, {}", ours(a), ours(b), ours(c)))
}
