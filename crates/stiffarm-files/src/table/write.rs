//! Writing of tables.

use super::beside::{RowContents, RowQuantity};
use super::layout::Layout;
use super::line::line;
use super::postures::angle_names;
use super::values::Values;
use nalgebra::Vector3;
use stiffarm::model::cell::Cell;
use stiffarm::model::load::Wrench;
use stiffarm::model::measurement::{
    MeasuredPosture, PostureReadings, Reading, ReadingTable, ReadingTarget, StateReadings, WrenchColumns,
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
    let has_moments = moments.clone().any(|wrench| wrench.moment != Vector3::zeros());
    let mut displacements = measured.iter().flat_map(|group| &group.displacements);
    let has_times = displacements.any(|d| d.time.is_some());
    let layout = Layout::new(Values::Displacements, |beside| match beside {
        RowQuantity::Force => wrenches.is_some(),
        RowQuantity::Moment => has_moments,
        RowQuantity::Time => has_times,
        _ => false,
    });
    let mut text = line(&layout.heading(cell));
    for (g, group) in measured.iter().enumerate() {
        for displacement in &group.displacements {
            let point = cell.setup.tool.measuring_points.get(displacement.point);
            let mut fields = vec![
                group.posture.name.clone(),
                group.state.clone(),
                point.map_or_else(String::new, |point| point.name.clone()),
            ];
            fields.extend(displacement.value.iter().map(|m| m_to_shortest_mm(*m).to_string()));
            let wrench = wrenches.as_ref().and_then(|wrenches| wrenches[g]);
            let contents = RowContents { wrench, time: displacement.time, ..RowContents::default() };
            fields.extend(layout.fields(&contents));
            fields.extend(degrees(&group.posture.q));
            text += &line(&fields);
        }
    }
    text
}

/// Simulated displacements, in the digits that mean something: [`digits_of`](stiffarm::model::cell::Noise::digits_of).
pub fn write_simulated(mut measured: Vec<MeasuredPosture>, cell: &Cell) -> String {
    let displacements = measured.iter_mut().flat_map(|group| &mut group.displacements);
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
    let rows = || postures().flat_map(rows_of);
    let layout = Layout::new(Values::Positions, |beside| match beside {
        RowQuantity::Force => table.wrench_columns != WrenchColumns::None,
        RowQuantity::Moment => table.wrench_columns == WrenchColumns::ForceAndMoment,
        RowQuantity::Station if table.pending.iter().any(|row| row.station.is_some()) => true,
        _ => rows().any(|(_, _, contents)| beside.is_in(&contents)),
    });
    let mut text = line(&layout.heading(cell));
    for posture in postures() {
        for (state, reading, contents) in rows_of(posture) {
            let q = state.angles.as_ref().unwrap_or(&posture.posture.q);
            let names = [&posture.posture.name, &state.state, target(reading, cell)];
            let lengths = reading.position.map(m_to_shortest_mm);
            let mut fields: Vec<String> = names.map(String::clone).into();
            fields.extend(lengths.iter().map(f64::to_string));
            fields.extend(layout.fields(&contents));
            fields.extend(degrees(q));
            text += &line(&fields);
        }
    }
    // In the order of the postures above, then those of which nothing is measured.
    let mut begun = Vec::new();
    for posture in postures() {
        let pending = table.pending.iter();
        begun.extend(pending.filter(|row| row.posture == posture.posture.name));
    }
    let others = table.pending.iter();
    let others = others.filter(|row| postures().all(|p| p.posture.name != row.posture));
    for row in begun.into_iter().chain(others) {
        let mut fields = vec![row.posture.clone(), row.state.clone(), row.point.clone()];
        fields.extend([""; 3].map(String::from));
        fields.extend(layout.fields(&RowContents { station: row.station.as_deref(), ..RowContents::default() }));
        fields.resize(layout.heading(cell).len(), String::new());
        text += &line(&fields);
    }
    text
}

/// The readings of a posture, each with its state and what its row says beside.
fn rows_of(posture: &PostureReadings) -> impl Iterator<Item = (&StateReadings, &Reading, RowContents<'_>)> {
    posture.states.iter().flat_map(move |state| {
        state.readings.iter().map(move |reading| {
            let contents = RowContents {
                station: posture.station.as_deref(),
                wrench: state.wrench,
                load: state.load,
                time: None,
                reading: Some(reading),
            };
            (state, reading, contents)
        })
    })
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

/// The measured wrench, else that of the cell's load.
fn wrench(group: &MeasuredPosture, cell: &Cell) -> Option<Wrench> {
    group.wrench.or_else(|| {
        let terms = PostureTerms::new(&cell.setup, &group.posture.q, None);
        terms.ok().map(|terms| *terms.wrench())
    })
}

pub(super) fn degrees(q: &[f64]) -> impl Iterator<Item = String> {
    q.iter().map(|angle| rad_to_shortest_deg(*angle).to_string())
}
