//! A small cell, for tests of tables.

use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::{MeasuredPosture, Measurements, ReadingTable};
use stiffarm::model::posture::Posture;
use stiffarm_files::cell::parse_cell;
use stiffarm_files::table::read_measurements;

pub const ROPE: &str = "kind = 'rope'\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]";

pub const POSTURES: &str = "posture,q1_deg,q2_deg\nP1,12.5,-30\nP2,-90.25,45\n";

/// Two joints, the points `left` and `right`, the given load, and more tables.
pub fn cell_with(load: &str, more: &str) -> Cell {
    let text = format!(
        "format = 1\nrobot.dh_modified = [[0, 0, 800, 0], [-90, 400, 0, -90]]\n\
         robot.limits_deg = [[-170, 170], [-75, 95]]\n\
         tool.loading_point_mm = [200, 0, 250]\n\
         [[tool.measuring_point]]\nname = 'left'\nposition_mm = [150, 0, 200]\n\
         [[tool.measuring_point]]\nname = 'right'\nposition_mm = [0, 150, 200]\n\
         [load]\n{load}\n{more}"
    );
    parse_cell(&text, "small.toml").unwrap()
}

pub fn rope_cell() -> Cell {
    cell_with(ROPE, "")
}

/// The raw readings of a table that holds them.
pub fn read_readings(
    bytes: &[u8],
    name: &str,
    cell: &Cell,
    postures: Option<&[Posture]>,
) -> stiffarm::Result<ReadingTable> {
    read_measurements(bytes, name, cell, postures).map(|read| match read {
        Measurements::Readings(table) => table,
        other => panic!("{name}: {other:?}"),
    })
}

/// The displacements of a table that holds them.
pub fn read_displacements(
    bytes: &[u8],
    name: &str,
    cell: &Cell,
    postures: Option<&[Posture]>,
) -> stiffarm::Result<Vec<MeasuredPosture>> {
    read_measurements(bytes, name, cell, postures).map(|read| match read {
        Measurements::Displacements(measured) => measured,
        other => panic!("{name}: {other:?}"),
    })
}

/// The same up to what numbers of degrees and millimetres can tell apart.
pub fn nearly(a: &[f64], b: &[f64]) -> bool {
    let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 2.0 * f64::EPSILON * a.abs();
    a.len() == b.len() && a.iter().zip(b).all(close)
}
