//! `stiffarm init`: files to start from.

mod robot;
mod shapes;
mod xacro;

use crate::answer::Answer;
use crate::args;
use crate::files::{Files, check_folder};
use crate::finding::wrapped_line;
use crate::output::Exit;
use crate::session::Session;
use robot::{Chain, Options, start};
use serde::Serialize;
use stiffarm::Result;
use stiffarm::findings::{Finding, list};
use stiffarm::plan::check::robot_doubts;
use stiffarm::units::rad_to_shortest_deg;
use stiffarm_files::cell::{
    BOUNDS_MARGIN_DEG, joints_kept_inside, measurements_template, parse_cell, postures_template,
};

#[derive(Serialize)]
struct Written {
    robot: String,
    files: Vec<&'static str>,
    /// Which chain of a URDF was taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    chain: Option<Chain>,
    /// What to distrust about the robot.
    findings: Vec<Finding>,
}

/// Writes the three files.
pub fn run(session: &Session, args: &args::Init) -> Result<Answer> {
    let start = start(session, args)?;
    let (text, line) = (start.text, start.line);
    let cell = parse_cell(&text, "cell.toml")?;
    let robot = cell.setup.robot.name().to_string();
    let mut findings = robot_doubts(&cell.setup.robot);
    findings.extend(start.findings);
    let bounds: Vec<[f64; 2]> = cell.bounds.iter().map(|b| b.map(rad_to_shortest_deg)).collect();
    let joints = joints_kept_inside(&cell.setup.robot, &bounds);
    if !joints.is_empty() {
        let sentence =
            format!("bounds.q_deg end {BOUNDS_MARGIN_DEG}° before the machine's limits of {}.", list(&joints));
        findings.push(Finding::note("bounds-margin", "bounds.q_deg", sentence));
    }
    let files = [
        ("cell.toml", text),
        ("postures.csv", postures_template(&cell.setup.robot)),
        ("measurements.csv", measurements_template(&cell)),
    ];
    let names: Vec<&'static str> = files.iter().map(|(name, _)| *name).collect();
    let folder = &args.output_dir;
    check_folder(session, folder, names.iter().copied(), args.force)?;
    let files = files.map(|(name, text)| (name.to_string(), text));
    let files = Files::folder(folder, files, args.force);
    let shown = |name: &str| {
        let path = args.output_dir.join(name);
        path.strip_prefix(".").unwrap_or(&path).display().to_string()
    };
    let lines = names.iter().map(|name| format!("  {}\n", shown(name)));
    let lines: String = lines.collect();
    let doubts: String = findings.iter().map(|f| wrapped_line(f) + "\n").collect();
    let table = format!(
        "cell of {robot} to start from:\n{lines}\
         {line}{doubts}Edit what cell.toml marks EDIT, then run `stiffarm check {}`.\n",
        shown("cell.toml")
    );
    let options = Options::of(args);
    let result = Written { robot, files: names, chain: start.chain, findings };
    let envelope = session.envelope("init", None, options, result);
    Ok(Answer::table(Exit::Done, envelope, table).with(files))
}
