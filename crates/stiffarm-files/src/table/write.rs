//! Writing of tables.

use super::line::line;
use super::postures::angle_names;
use super::values::Values;
use nalgebra::Vector3;
use stiffarm::model::cell::Cell;
use stiffarm::model::load::Wrench;
use stiffarm::model::measurement::{
    MeasuredPosture, Reading, ReadingTable, ReadingTarget, WrenchColumns,
};
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::posture::Posture;
use stiffarm::units::{m_to_shortest_mm, rad_to_shortest_deg};

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
/// [`read_measurements`](super::read_measurements) reads, controller angles
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
        values: Values::Displacements,
        forces: wrenches.is_some(),
        moments: has_moments,
        stations: false,
        loads: false,
        times: has_times,
        expanded: false,
        temperatures: false,
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
            fields.extend(layout.optional(wrench, None, displacement.time));
            fields.extend(degrees(&group.posture.q));
            text += &line(&fields);
        }
    }
    text
}

/// Simulated displacements, in the digits that mean something: [`digits_of`](stiffarm::model::cell::Noise::digits_of).
pub fn write_simulated(mut measured: Vec<MeasuredPosture>, cell: &Cell) -> String {
    let displacements = measured
        .iter_mut()
        .flat_map(|group| &mut group.displacements);
    displacements.for_each(|d| d.value = d.value.map(|m| cell.noise.digits_of(m)));
    write_displacements(&measured, cell)
}

/// The same of simulated raw readings.
pub fn write_simulated_readings(mut table: ReadingTable, cell: &Cell) -> String {
    let states = table.postures.iter_mut().flat_map(|p| &mut p.states);
    for reading in states.flat_map(|state| &mut state.readings) {
        reading.position = reading.position.map(|m| cell.noise.digits_of(m));
    }
    write_readings(&table, cell)
}

/// Raw readings in the columns that [`read_measurements`](super::read_measurements)
/// reads. Each state is written with its own angles or, where it has none, with
/// the posture's; forces in the columns that the table had. What is not measured
/// yet comes last, as rows without a position.
pub fn write_readings(table: &ReadingTable, cell: &Cell) -> String {
    let postures = || table.postures.iter().chain(&table.incomplete);
    let states = || postures().flat_map(|posture| &posture.states);
    let mut readings = states().flat_map(|state| &state.readings);
    let layout = Layout {
        values: Values::Positions,
        forces: table.wrench_columns != WrenchColumns::None,
        moments: table.wrench_columns == WrenchColumns::ForceAndMoment,
        stations: postures().any(|posture| posture.station.is_some())
            || table.pending.iter().any(|row| row.station.is_some()),
        loads: states().any(|state| state.load.is_some()),
        times: readings.clone().any(|reading| reading.time.is_some()),
        expanded: readings.clone().any(|reading| reading.expanded.is_some()),
        temperatures: readings.any(|reading| reading.temperature.is_some()),
    };
    let mut text = line(&layout.heading(cell));
    for posture in postures() {
        for state in &posture.states {
            let q = state.angles.as_ref().unwrap_or(&posture.posture.q);
            for reading in &state.readings {
                let names = [&posture.posture.name, &state.state, target(reading, cell)];
                let lengths = reading.position.map(m_to_shortest_mm);
                let mut fields: Vec<String> = names.map(String::clone).into();
                fields.extend(lengths.iter().map(f64::to_string));
                if layout.stations {
                    fields.push(posture.station.clone().unwrap_or_default());
                }
                fields.extend(layout.optional(state.wrench, state.load, reading.time));
                if layout.expanded {
                    let expanded = reading.expanded.map(|u| u.map(m_to_shortest_mm));
                    fields.extend(components(expanded));
                }
                if layout.temperatures {
                    fields.push(number(reading.temperature));
                }
                fields.extend(degrees(q));
                text += &line(&fields);
            }
        }
    }
    // In the order of the postures above, then those of which nothing is measured.
    let mut begun = Vec::new();
    for posture in postures() {
        let own = table.pending.iter();
        begun.extend(own.filter(|row| row.posture == posture.posture.name));
    }
    let others = table.pending.iter();
    let others = others.filter(|row| postures().all(|p| p.posture.name != row.posture));
    for row in begun.into_iter().chain(others) {
        let mut fields = vec![row.posture.clone(), row.state.clone(), row.point.clone()];
        if layout.stations {
            fields.extend([""; 3].map(String::from));
            fields.push(row.station.clone().unwrap_or_default());
        }
        fields.resize(layout.heading(cell).len(), String::new());
        text += &line(&fields);
    }
    text
}

/// What a reading is called.
fn target<'n>(reading: &'n Reading, cell: &'n Cell) -> &'n String {
    static NONE: String = String::new();
    match &reading.target {
        ReadingTarget::Base(name) => name,
        ReadingTarget::Point(point) => {
            let point = cell.setup.tool.measuring_points.get(*point);
            point.map_or(&NONE, |point| &point.name)
        }
    }
}

/// The columns of a measurement table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) values: Values,
    pub(super) forces: bool,
    pub(super) moments: bool,
    pub(super) stations: bool,
    pub(super) loads: bool,
    pub(super) times: bool,
    pub(super) expanded: bool,
    pub(super) temperatures: bool,
}

impl Layout {
    pub(super) fn heading(&self, cell: &Cell) -> Vec<String> {
        let mut names = vec!["posture", "state", "point"];
        names.extend(match self.values {
            Values::Positions => ["x_mm", "y_mm", "z_mm"],
            Values::Displacements => ["dx_mm", "dy_mm", "dz_mm"],
        });
        let optional: [(bool, &[&str]); 7] = [
            (self.stations, &["station"]),
            (self.forces, &["fx_n", "fy_n", "fz_n"]),
            (self.moments, &["mx_nm", "my_nm", "mz_nm"]),
            (self.loads, &["load_n"]),
            (self.times, &["time_s"]),
            (self.expanded, &["u95x_mm", "u95y_mm", "u95z_mm"]),
            (self.temperatures, &["temperature_c"]),
        ];
        for (_, columns) in optional.into_iter().filter(|(wanted, _)| *wanted) {
            names.extend(columns);
        }
        let angles = angle_names(cell.setup.robot.joint_count());
        names.into_iter().map(String::from).chain(angles).collect()
    }

    /// The fields between lengths and angles, empty where there is no value.
    pub(super) fn optional(
        &self,
        wrench: Option<Wrench>,
        load: Option<f64>,
        time: Option<f64>,
    ) -> Vec<String> {
        let mut fields = Vec::new();
        if self.forces {
            fields.extend(components(wrench.map(|wrench| wrench.force)));
        }
        if self.moments {
            fields.extend(components(wrench.map(|wrench| wrench.moment)));
        }
        if self.loads {
            fields.push(number(load));
        }
        if self.times {
            fields.push(number(time));
        }
        fields
    }
}

/// The measured wrench, else that of the cell's load.
fn wrench(group: &MeasuredPosture, cell: &Cell) -> Option<Wrench> {
    group.wrench.or_else(|| {
        let terms = PostureTerms::new(&cell.setup, &group.posture.q, None);
        terms.ok().map(|terms| *terms.wrench())
    })
}

fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

fn components(vector: Option<Vector3<f64>>) -> [String; 3] {
    let text = |i: usize| vector.map_or_else(String::new, |v| v[i].to_string());
    [text(0), text(1), text(2)]
}

pub(super) fn degrees(q: &[f64]) -> impl Iterator<Item = String> {
    q.iter()
        .map(|angle| rad_to_shortest_deg(*angle).to_string())
}
