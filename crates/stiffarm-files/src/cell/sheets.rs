//! Tables to fill in beside a cell file: what `stiffarm init` writes.

use crate::table::{SheetOptions, reading_sheet, write_postures};
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::Posture;
use stiffarm::model::robot::Robot;

/// A posture table to fill in: the heading and one commented example.
pub fn postures_template(robot: &Robot) -> String {
    let q: Vec<f64> = robot
        .joints()
        .iter()
        .map(|joint| ((joint.limits[0] + joint.limits[1]) / 2.0).to_degrees().round().to_radians())
        .collect();
    let table = write_postures(&[Posture { name: "P1".to_string(), q }]);
    let (heading, example) = table.split_once('\n').unwrap_or((&table, ""));
    format!("# Controller angles in degrees; one row per posture. For example:\n# {}\n{heading}\n", example.trim_end())
}

/// A table of raw readings to fill in: the heading, what its columns mean, and
/// commented example rows of one posture.
pub fn measurements_template(cell: &Cell) -> String {
    let example = Posture {
        name: "P1".to_string(),
        q: cell.bounds.iter().map(|b| ((b[0] + b[1]) / 2.0).to_degrees().round().to_radians()).collect(),
    };
    let options = SheetOptions::default();
    let sheet = reading_sheet(std::slice::from_ref(&example), &options, cell).to_csv();
    let (heading, rows) = sheet.split_once('\n').unwrap_or((&sheet, ""));
    let forces = heading.contains("fx_n");
    let force = if cell.sensor.is_some() {
        "# fx_n … mz_nm: as the sensor reports them in this state; its pose and sign are in cell.toml\n"
    } else if forces {
        "# fx_n fy_n fz_n: force on the robot in this state, base axes\n"
    } else if heading.contains("load_n") {
        "# load_n: force of the cell's load in this state, where it is another than the cell says\n"
    } else {
        "# The force comes from the cell's load; for several loads add fx_n, fy_n, fz_n\n"
    };
    let rows: String = rows.lines().map(|row| format!("# {row}\n")).collect();
    format!(
        "# One row per posture, load state, point and reading.\n\
         # state: unloaded, then loaded (or up-250, up-500, down-250, …); preload: a light load to\n\
         #   measure from; unloaded-2: unloaded once more, for the drift\n\
         # point: a measuring point of the cell; base, base-2, …: a reflector on the robot's base\n\
         # x_mm y_mm z_mm: position as the tracker gave it, in the tracker's axes\n\
         {force}\
         # time_s: when it was read; may stay empty\n\
         # q1_deg …: angles that the controller shows in this state\n\
         # Repeat a row to record a repeated reading. For example:\n\
         {rows}{heading}\n"
    )
}
