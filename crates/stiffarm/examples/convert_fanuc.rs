//! Turns the measured data of a FANUC R-2000iC into a measurement table for
//! the built-in cell `fanuc-r2000ic`.
//!
//! ```text
//! cargo run --example convert_fanuc -- FOLDER measurements.csv
//! stiffarm identify builtin:fanuc-r2000ic measurements.csv
//! ```
//!
//! FOLDER holds `joint_angles.csv` (controller angles, rad), `forces.csv`
//! (cable force at the tool centre point, base axes, N) and `deltaX.csv`
//! (loaded minus unloaded position of that point, base axes, m), one row per
//! posture: `data/stiffness_data` of
//! longton2001-pixel/breakthrough-surge-suppression-in-high-speed-robotic-drilling
//! at e5c2f79 (MIT licence).

use nalgebra::Vector3;
use std::error::Error;
use std::fs;
use std::path::Path;
use stiffarm::files::builtin;
use stiffarm::files::table::write_displacements;
use stiffarm::model::load::Wrench;
use stiffarm::model::measurement::{Displacement, MeasuredPosture};
use stiffarm::model::posture::Posture;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, output] = arguments.as_slice() else {
        return Err("usage: convert_fanuc FOLDER measurements.csv".into());
    };
    fs::write(output, convert(Path::new(folder))?)?;
    Ok(())
}

/// The measurement table of the files in `folder`.
pub fn convert(folder: &Path) -> Result<String, Box<dyn Error>> {
    let angles = rows::<6>(&folder.join("joint_angles.csv"))?;
    let forces = rows::<3>(&folder.join("forces.csv"))?;
    let shifts = rows::<3>(&folder.join("deltaX.csv"))?;
    if angles.len() != forces.len() || angles.len() != shifts.len() {
        return Err("the three files have different numbers of rows".into());
    }
    let measured: Vec<MeasuredPosture> = (0..angles.len())
        .map(|i| MeasuredPosture {
            posture: Posture {
                name: (i + 1).to_string(),
                q: angles[i].to_vec(),
            },
            state: "loaded".to_string(),
            wrench: Some(Wrench::force(Vector3::from(forces[i]))),
            common_readings: [0.0; 2],
            servo_deflection: None,
            displacements: vec![Displacement::new(0, Vector3::from(shifts[i]))],
        })
        .collect();
    let cell = builtin::cell("fanuc-r2000ic")?;
    Ok(write_displacements(&measured, &cell))
}

/// The numbers below the heading of a file with N columns.
fn rows<const N: usize>(path: &Path) -> Result<Vec<[f64; N]>, Box<dyn Error>> {
    let text = fs::read_to_string(path)?;
    let mut rows = Vec::new();
    for (number, line) in (1..).zip(text.lines()).skip(1) {
        let place = || format!("{}:{number}", path.display());
        let values: Result<Vec<f64>, _> =
            line.split(',').map(|field| field.trim().parse()).collect();
        let values = values.map_err(|e| format!("{}: {e}", place()))?;
        let row =
            <[f64; N]>::try_from(values).map_err(|_| format!("{}: not {N} numbers", place()))?;
        rows.push(row);
    }
    Ok(rows)
}
