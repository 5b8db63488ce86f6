//! A table: what the program does, row by row, for controllers that have no language here.
//!
//! Comment lines with `#`, then `step,kind,posture,q1_deg,…,speed_percent,message`. A row of kind `wait` has
//! a message and no angles. LF, UTF-8, names and messages as they are.

use super::dialect::Dialect;
use super::{Move, MoveKind, Program, ProgramFile, Step};
use crate::names::fault_of;
use stiffarm::error::{Code, Error, Result};
use stiffarm::units::rad_to_shortest_deg;

pub const CSV: Dialect = Dialect { name: "csv", title: "CSV", longest_name: 60, ..Dialect::USUAL };

/// The table.
pub fn write(program: &Program) -> Result<Vec<ProgramFile>> {
    let joints = program.moves().next().map_or(0, |first| first.q.len());
    let internal = |_| Error::new(Code::Internal, "The table cannot be written.");
    let mut table = ::csv::Writer::from_writer(Vec::new());
    table.write_record(heading(joints)).map_err(internal)?;
    for (number, step) in program.steps.iter().enumerate() {
        let mut row = vec![(number + 1).to_string()];
        match step {
            Step::Move(target) => {
                row.extend([target.kind.as_str().to_string(), target.name.clone()]);
                row.extend(target.q.iter().map(|angle| rad_to_shortest_deg(*angle).to_string()));
                row.extend([target.speed_percent.to_string(), String::new()]);
            }
            Step::Wait(said) => {
                row.push("wait".to_string());
                row.resize(4 + joints, String::new());
                // A line break would be a row to many who read it.
                row.push(said.replace(char::is_control, " "));
            }
        }
        table.write_record(row).map_err(internal)?;
    }
    let bytes = table.into_inner().unwrap_or_default();
    let comments: String =
        program.header.iter().map(|line| format!("# {}\n", line.replace(char::is_control, " "))).collect();
    Ok(vec![ProgramFile { name: format!("{}.csv", program.name), text: comments + &String::from_utf8_lossy(&bytes) }])
}

fn heading(joints: usize) -> Vec<String> {
    let mut names: Vec<String> = ["step", "kind", "posture"].map(String::from).into();
    names.extend((1..=joints).map(|joint| format!("q{joint}_deg")));
    names.extend(["speed_percent", "message"].map(String::from));
    names
}

/// Reads a table.
pub fn read(file: &ProgramFile, joints: usize) -> Result<Program> {
    let text = file.text.trim_start_matches('\u{feff}');
    let mut table = ::csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    let at = |line: u64, message: String| {
        Error::new(Code::Program, message)
            .file(file.name.as_str())
            .line(usize::try_from(line).unwrap_or(usize::MAX), None)
    };
    let of_csv = |error: ::csv::Error| {
        let line = error.position().map_or(1, ::csv::Position::line);
        at(line, "This row cannot be read: it has too many or too few columns.".to_string())
    };
    let headers = table.headers().map_err(of_csv)?.clone();
    let wanted = heading(joints);
    if !headers.iter().eq(wanted.iter().map(String::as_str)) {
        let line = headers.position().map_or(1, ::csv::Position::line);
        return Err(at(line, format!("The columns must be {}.", wanted.join(","))));
    }
    let mut steps = Vec::new();
    for record in table.records() {
        let record = record.map_err(of_csv)?;
        let line = record.position().map_or(1, ::csv::Position::line);
        let kind = &record[1];
        if kind == "wait" {
            steps.push(Step::Wait(record[4 + joints].to_string()));
            continue;
        }
        let Some(kind) = MoveKind::ALL.into_iter().find(|k| k.as_str() == kind) else {
            return Err(at(line, format!("The kind must be start, via, posture or wait, got \"{kind}\".")));
        };
        let mut q = Vec::with_capacity(joints);
        for joint in 0..joints {
            match record[3 + joint].trim().parse::<f64>() {
                Ok(degrees) if degrees.abs() <= 1e5 => q.push(degrees.to_radians()),
                _ => {
                    return Err(at(line, format!("q{}_deg is not an angle in degrees.", joint + 1)));
                }
            }
        }
        let speed = record[3 + joints].trim().parse::<u8>();
        let speed = speed.ok().filter(|speed| (1..=100).contains(speed));
        let speed_percent =
            speed.ok_or_else(|| at(line, "speed_percent must be a whole number from 1 to 100.".to_string()))?;
        if let Some(fault) = fault_of(&record[2]) {
            return Err(at(line, fault.to_string()));
        }
        steps.push(Step::Move(Move { name: record[2].to_string(), kind, q, speed_percent }));
    }
    Ok(Program { name: file.name.trim_end_matches(".csv").to_string(), header: Vec::new(), steps })
}
