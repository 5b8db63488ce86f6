//! Writing of tables.

use super::displacements::DEFAULT_STATE;
use super::postures::angle_names;
use crate::cell::Cell;
use crate::load::{Load, Wrench};
use crate::measurement::MeasuredPosture;
use crate::observation::PostureTerms;
use crate::posture::Posture;
use crate::units::{m_to_shortest_mm, rad_to_shortest_deg};
use nalgebra::Vector3;

/// Postures as `posture,q1_deg,…`, angles in the shortest decimals that are
/// read back as the same angles ([`rad_to_shortest_deg`]).
pub fn write_postures(postures: &[Posture]) -> String {
    let joints = postures.first().map_or(0, |posture| posture.q.len());
    let mut heading = vec!["posture".to_string()];
    heading.extend(angle_names(joints));
    let mut text = line(&heading);
    for posture in postures {
        let mut fields = vec![posture.name.clone()];
        fields.extend(degrees(&posture.q));
        text += &line(&fields);
    }
    text
}

/// Displacements in the columns that
/// [`read_displacements`](super::read_displacements) reads, controller angles
/// included. Where any posture has a measured wrench, all are written with
/// theirs, from the cell's load where not measured.
pub fn write_displacements(measured: &[MeasuredPosture], cell: &Cell) -> String {
    let wrenches: Option<Vec<Option<Wrench>>> = measured
        .iter()
        .any(|group| group.wrench.is_some())
        .then(|| measured.iter().map(|group| wrench(group, cell)).collect());
    let moments = wrenches.iter().flatten().flatten();
    let has_moments = moments
        .clone()
        .any(|wrench| wrench.moment != Vector3::zeros());
    let displacements = measured.iter().flat_map(|group| &group.displacements);
    let has_times = displacements.clone().any(|d| d.time.is_some());
    let layout = Layout {
        forces: wrenches.is_some(),
        moments: has_moments,
        times: has_times,
    };
    let mut text = line(&layout.heading(cell));
    for (g, group) in measured.iter().enumerate() {
        for displacement in &group.displacements {
            let point = cell.setup.tool.measuring_points.get(displacement.point);
            let mut fields = vec![
                group.posture.name.clone(),
                group.state.clone(),
                point.map_or_else(String::new, |point| point.name.clone()),
            ];
            fields.extend(
                displacement
                    .value
                    .iter()
                    .map(|m| m_to_shortest_mm(*m).to_string()),
            );
            let wrench = wrenches.as_ref().and_then(|wrenches| wrenches[g]);
            if layout.forces {
                fields.extend(components(wrench.map(|wrench| wrench.force)));
            }
            if layout.moments {
                fields.extend(components(wrench.map(|wrench| wrench.moment)));
            }
            if layout.times {
                fields.push(
                    displacement
                        .time
                        .map_or_else(String::new, |time| time.to_string()),
                );
            }
            fields.extend(degrees(&group.posture.q));
            text += &line(&fields);
        }
    }
    text
}

/// A reading sheet: the rows of
/// [`read_displacements`](super::read_displacements) for each posture, load
/// state (`loaded` if none is named) and measuring point, with empty fields
/// for what is to be read.
pub fn reading_sheet(postures: &[Posture], states: &[&str], cell: &Cell) -> String {
    let states = if states.is_empty() {
        &[DEFAULT_STATE]
    } else {
        states
    };
    let layout = Layout {
        forces: cell.setup.load == Load::Measured || cell.setup.tool.has_sensor,
        moments: false,
        times: false,
    };
    let mut text = line(&layout.heading(cell));
    for posture in postures {
        for state in states {
            for point in &cell.setup.tool.measuring_points {
                let mut fields = vec![posture.name.clone(), state.to_string(), point.name.clone()];
                let blank = if layout.forces { 6 } else { 3 };
                fields.extend(vec![String::new(); blank]);
                fields.extend(degrees(&posture.q));
                text += &line(&fields);
            }
        }
    }
    text
}

/// The optional columns of a measurement table.
struct Layout {
    forces: bool,
    moments: bool,
    times: bool,
}

impl Layout {
    fn heading(&self, cell: &Cell) -> Vec<String> {
        let mut names = vec!["posture", "state", "point", "dx_mm", "dy_mm", "dz_mm"];
        if self.forces {
            names.extend(["fx_n", "fy_n", "fz_n"]);
        }
        if self.moments {
            names.extend(["mx_nm", "my_nm", "mz_nm"]);
        }
        if self.times {
            names.push("time_s");
        }
        let angles = angle_names(cell.setup.robot.joint_count());
        names.into_iter().map(String::from).chain(angles).collect()
    }
}

/// The measured wrench, else that of the cell's load.
fn wrench(group: &MeasuredPosture, cell: &Cell) -> Option<Wrench> {
    group.wrench.or_else(|| {
        let terms = PostureTerms::new(&cell.setup, &group.posture.q, None);
        terms.ok().map(|terms| *terms.wrench())
    })
}

fn components(vector: Option<Vector3<f64>>) -> [String; 3] {
    let text = |i: usize| vector.map_or_else(String::new, |v| v[i].to_string());
    [text(0), text(1), text(2)]
}

fn degrees(q: &[f64]) -> impl Iterator<Item = String> {
    q.iter()
        .map(|angle| rad_to_shortest_deg(*angle).to_string())
}

/// One line of a table, with quotation marks where a field needs them.
pub(crate) fn line(fields: &[String]) -> String {
    let quoted = |field: &String| {
        // A name that begins with # would make its line a comment.
        if field.contains([',', ';', '"', '\n', '\r']) || field.starts_with('#') {
            format!("\"{}\"", field.replace('"', "\"\""))
        } else {
            field.clone()
        }
    };
    let fields: Vec<String> = fields.iter().map(quoted).collect();
    fields.join(",") + "\n"
}
