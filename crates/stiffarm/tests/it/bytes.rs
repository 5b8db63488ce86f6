//! Whatever bytes come in: no panic, no endless loop, and what is accepted
//! holds finite numbers only.

use crate::common::prelude::*;
use proptest::prelude::*;
use stiffarm::model::measurement::Measurements;
use stiffarm_files::cell::{parse_cell_bytes, template};
use stiffarm_files::table::{read_displacements, read_measurements, read_postures};

fn finite<'a>(values: impl IntoIterator<Item = &'a f64>) -> bool {
    values.into_iter().all(|value| value.is_finite())
}

fn wrench_is_finite(wrench: &Wrench) -> bool {
    finite(&wrench.force) && finite(&wrench.moment)
}

fn load_is_finite(load: &Load) -> bool {
    match load {
        Load::Rope { anchor, magnitude } => finite(anchor) && magnitude.is_finite(),
        Load::Weight {
            magnitude,
            direction,
        } => finite(direction) && magnitude.is_finite(),
        Load::Constant { wrench, .. } => wrench_is_finite(wrench),
        Load::Measured => true,
        // Each of them is looked at.
        Load::Cases(_) => false,
    }
}

fn cell_is_finite(cell: &Cell) -> bool {
    let robot = &cell.setup.robot;
    let tool = &cell.setup.tool;
    let limits = &cell.limits;
    let points = cell.setup.load.cases().iter();
    let load = cell.setup.load.each().all(load_is_finite)
        && points
            .filter_map(|case| case.loading_point)
            .all(|p| finite(&p));
    let lengths = [limits.floor, limits.keep_out_radius, limits.wrist_height];
    load && finite(robot.coupling())
        && robot.spring_mixing().is_none_or(finite)
        && finite(robot.gravity_direction())
        && finite(&robot.serial_angles(&vec![0.0; robot.joint_count()]))
        && finite(&robot.flange().to_homogeneous())
        && robot
            .joints()
            .iter()
            .all(|joint| finite(&joint.placement.to_homogeneous()) && finite(&joint.limits))
        && finite(cell.bounds.iter().flatten())
        && finite(&tool.loading_point)
        && tool
            .measuring_points
            .iter()
            .all(|point| finite(&point.position))
        && tool
            .series_compliance
            .iter()
            .all(|s| finite(&s.origin) && finite(&s.matrix))
        && limits.tool_box.iter().flatten().all(finite)
        && finite(lengths.iter().flatten())
        && finite(limits.rope_length.iter().flatten())
        && cell.noise.displacement_variance().is_finite()
        && cell.noise.posture_common_std.is_finite()
        && finite(cell.prior.iter().flatten())
        && finite(cell.characteristic_length.iter())
        && postures_are_finite(&cell.validation)
        && instruments_are_finite(cell)
}

fn instruments_are_finite(cell: &Cell) -> bool {
    let (tracker, uncertainty) = (&cell.tracker, &cell.uncertainty);
    let poses = cell.sensor.iter().map(|sensor| &sensor.pose);
    let accuracy = tracker.accuracy.iter();
    let mut values = accuracy.flat_map(|a| [a.range, a.range_per_metre, a.angle, a.station.norm()]);
    let common = [
        uncertainty.force_scale,
        uncertainty.anchor,
        uncertainty.loading_point,
        uncertainty.registration,
        uncertainty.base_tilt_compliance,
        uncertainty.sensor_compliance,
        uncertainty.lost_motion,
    ];
    poses
        .chain(&tracker.base_from_tracker)
        .all(|pose| finite(&pose.to_homogeneous()))
        && values.all(f64::is_finite)
        && finite(common.iter().flatten())
}

fn postures_are_finite(postures: &[Posture]) -> bool {
    postures.iter().all(|posture| finite(&posture.q))
}

fn measured_are_finite(measured: &[MeasuredPosture]) -> bool {
    measured.iter().all(|m| {
        finite(&m.posture.q)
            && m.wrench.as_ref().is_none_or(wrench_is_finite)
            && m.displacements
                .iter()
                .all(|d| finite(&d.value) && finite(d.time.iter()))
    })
}

fn readings_are_finite(table: &ReadingTable) -> bool {
    table.postures.iter().all(|posture| {
        finite(&posture.posture.q)
            && posture.states.iter().all(|state| {
                finite(state.angles.iter().flatten())
                    && state.wrench.as_ref().is_none_or(wrench_is_finite)
                    && finite(state.load.iter())
                    && state
                        .readings
                        .iter()
                        .all(|r| finite(&r.position) && finite(r.time.iter()))
            })
    })
}

/// Reads `bytes` as everything; what is accepted must be finite, what is
/// refused must have words.
fn read_as_everything(bytes: &[u8]) -> Result<(), TestCaseError> {
    let cell = builtin::cell("fanuc-r2000ic").map_err(|e| TestCaseError::fail(e.to_string()))?;
    match parse_cell_bytes(bytes, "cell.toml") {
        Ok(cell) => prop_assert!(cell_is_finite(&cell)),
        Err(error) => prop_assert!(error.to_string().starts_with("cell.toml:")),
    }
    match read_postures(bytes, "postures.csv", &cell.setup.robot) {
        Ok(postures) => prop_assert!(postures_are_finite(&postures)),
        Err(error) => prop_assert!(error.to_string().starts_with("postures.csv:")),
    }
    match read_displacements(bytes, "measurements.csv", &cell, None) {
        Ok(measured) => prop_assert!(measured_are_finite(&measured)),
        Err(error) => prop_assert!(error.to_string().starts_with("measurements.csv:")),
    }
    match read_measurements(bytes, "m.csv", &cell, None) {
        Ok(Measurements::Displacements(measured)) => prop_assert!(measured_are_finite(&measured)),
        Ok(Measurements::Readings(table)) => prop_assert!(readings_are_finite(&table)),
        Err(error) => prop_assert!(error.to_string().starts_with("m.csv:")),
    }
    Ok(())
}

const MEASUREMENTS: &str = "\
posture,state,point,dx_mm,dy_mm,dz_mm,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm,time_s,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg
\"P1\",up,TCP,0.125,-0.5,0.25,100,0,-500,1,2,3,10.5,-60,-30,10,20,-30,140
P1,down,TCP,0.125,-0.5,0.25,90,0,-480,1,2,3,,-60,-30,10,20,-30,140
";

const READINGS: &str = "\
posture,state,point,x_mm,y_mm,z_mm,fx_n,fy_n,fz_n,time_s,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg
P1,unloaded,TCP,1500.125,-200.5,900.25,,,,10.5,-60,-30,10,20,-30,140
P1,unloaded,base,3.5,4.25,5,,,,,-60,-30,10,20,-30,140
P1,up,TCP,1500.25,-200.75,899.25,90,0,-480,12,-60,-30,10,20,-30,140
";

fn valid_files() -> Vec<String> {
    let mut files: Vec<String> = builtin::cell_names()
        .into_iter()
        .filter_map(builtin::cell_text)
        .map(String::from)
        .collect();
    files.push(include_str!("../full-cell.toml").to_string());
    files.extend(template("kuka-kr500-r2800-2"));
    files.extend(builtin::postures_text("comau-group1").map(String::from));
    files.push(MEASUREMENTS.to_string());
    files.push(MEASUREMENTS.replace(',', ";").replace('.', ","));
    files.push(READINGS.to_string());
    files
}

/// Pieces that change the meaning of what they are put into.
const PIECES: [&str; 28] = [
    "nan",
    "inf",
    "-inf",
    "1e308",
    "1e-320",
    "-0",
    "1_000",
    "0x1f",
    "\u{feff}",
    "\r",
    "\n",
    "\"",
    "'",
    "\"\"\"",
    "[",
    "]",
    "[[",
    "{",
    "}",
    ",",
    ";",
    "=",
    "#",
    "\0",
    "µ",
    ".",
    "[robot]\n",
    "sep=;\n",
];

#[derive(Debug, Clone)]
enum Change {
    Remove(usize, usize),
    Insert(usize, usize),
    Overwrite(usize, u8),
    Repeat(usize, usize),
    Truncate(usize),
}

fn change() -> impl Strategy<Value = Change> {
    let at = 0..8192usize;
    prop_oneof![
        (at.clone(), 1..40usize).prop_map(|(at, n)| Change::Remove(at, n)),
        (at.clone(), 0..PIECES.len()).prop_map(|(at, piece)| Change::Insert(at, piece)),
        (at.clone(), any::<u8>()).prop_map(|(at, byte)| Change::Overwrite(at, byte)),
        (at.clone(), 1..200usize).prop_map(|(at, n)| Change::Repeat(at, n)),
        at.prop_map(Change::Truncate),
    ]
}

fn apply(bytes: &mut Vec<u8>, change: &Change) {
    let place = |at: usize| at % (bytes.len() + 1);
    match *change {
        Change::Remove(at, n) => {
            let start = place(at);
            let end = (start + n).min(bytes.len());
            bytes.drain(start..end);
        }
        Change::Insert(at, piece) => {
            let at = place(at);
            bytes.splice(at..at, PIECES[piece].bytes());
        }
        Change::Overwrite(at, byte) => {
            let at = place(at);
            if let Some(old) = bytes.get_mut(at) {
                *old = byte;
            }
        }
        Change::Repeat(at, n) => {
            let start = place(at);
            let end = (start + n).min(bytes.len());
            let copy = bytes[start..end].to_vec();
            bytes.splice(start..start, copy);
        }
        Change::Truncate(at) => bytes.truncate(place(at)),
    }
}

/// One number of a valid file by another, so that most results are accepted.
fn with_number(text: &str, which: usize, by: &str) -> String {
    let is_part = |c: char| c.is_ascii_digit() || c == '.';
    let mut numbers = Vec::new();
    let mut start = None;
    let mut before = ' ';
    for (i, c) in text.char_indices() {
        match (start, is_part(c)) {
            // Digits of names such as q1_deg are left alone.
            (None, true) if !before.is_alphanumeric() => start = Some(i),
            (Some(from), false) => {
                numbers.push(from..i);
                start = None;
            }
            _ => {}
        }
        before = c;
    }
    match numbers.get(which % numbers.len().max(1)) {
        Some(range) => format!("{}{by}{}", &text[..range.start], &text[range.end..]),
        None => text.to_string(),
    }
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn arbitrary_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        read_as_everything(&bytes)?;
    }

    #[test]
    fn arbitrary_text(text in "\\PC{0,200}") {
        read_as_everything(text.as_bytes())?;
    }

    #[test]
    fn text_of_pieces(pieces in prop::collection::vec(0..PIECES.len(), 0..200)) {
        let text: String = pieces.into_iter().map(|piece| PIECES[piece]).collect();
        read_as_everything(text.as_bytes())?;
    }

    #[test]
    fn changed_files(which in 0..16usize, changes in prop::collection::vec(change(), 1..6)) {
        let files = valid_files();
        let mut bytes = files[which % files.len()].clone().into_bytes();
        for change in &changes {
            apply(&mut bytes, change);
        }
        read_as_everything(&bytes)?;
    }

    #[test]
    fn changed_workbooks(changes in prop::collection::vec(change(), 1..4)) {
        let mut bytes = include_bytes!("../golden/xlsx/readings.xlsx").to_vec();
        for change in &changes {
            apply(&mut bytes, change);
        }
        read_as_everything(&bytes)?;
    }

    #[test]
    fn any_number_in_any_place(
        which in 0..16usize,
        place in any::<prop::sample::Index>(),
        number in prop_oneof![
            any::<f64>().prop_map(|x| format!("{x:e}")),
            any::<i64>().prop_map(|x| x.to_string()),
            Just("1e-320".to_string()),
            Just("9".repeat(400)),
        ],
    ) {
        let files = valid_files();
        let text = with_number(&files[which % files.len()], place.index(4096), &number);
        read_as_everything(text.as_bytes())?;
    }
}

#[test]
fn valid_files_are_accepted() {
    for name in builtin::cell_names() {
        let text = builtin::cell_text(name).unwrap_or_default();
        assert!(
            parse_cell(text, name).is_ok_and(|cell| cell_is_finite(&cell)),
            "{name}"
        );
    }
    let cell = builtin::cell("fanuc-r2000ic").unwrap();
    assert!(read_displacements(MEASUREMENTS.as_bytes(), "m.csv", &cell, None).is_ok());
    assert!(read_measurements(READINGS.as_bytes(), "m.csv", &cell, None).is_ok());
}

#[test]
fn deep_nesting_and_long_lines_end() {
    let deep = format!("format = 1\nname = {}", "[".repeat(100_000));
    let tables = format!("format = 1\n[{}]", ["a"; 10_000].join("."));
    let inline = format!("format = 1\nx = {}", "{a=".repeat(50_000));
    let columns = format!("posture,{}", "q1_deg,".repeat(100_000));
    let quotes = "\"".repeat(100_001);
    for text in [deep, tables, inline, columns, quotes] {
        read_as_everything(text.as_bytes()).unwrap();
    }
}
