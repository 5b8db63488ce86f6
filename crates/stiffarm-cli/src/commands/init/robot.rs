//! The robot that `init` writes a cell for.

use super::shapes::link_capsules;
use super::xacro;
use crate::args;
use crate::commands::robots::entry_of;
use crate::session::Session;
use serde::Serialize;
use std::path::PathBuf;
use stiffarm::findings::{Finding, codes, list};
use stiffarm::model::robot::DhConvention;
use stiffarm::{Code, Error, Result};
use stiffarm_files::cell::{template, template_of, template_with_shapes};
use stiffarm_files::check_name;
use stiffarm_files::source::{Source, group_name};
use stiffarm_files::table::read_dh_rows;
use stiffarm_files::urdf::{UrdfOptions, read_urdf};

/// The cell's text and what it is from.
pub struct Start {
    /// Text of cell.toml.
    pub text: String,
    /// What to know about the source.
    pub findings: Vec<Finding>,
    /// A line that says which chain was taken; empty for none.
    pub line: String,
    /// The same for JSON.
    pub chain: Option<Chain>,
}

/// Which chain of a URDF was taken.
#[derive(Serialize)]
pub struct Chain {
    /// Link whose frame is the base frame.
    base_link: String,
    /// Link whose frame is the flange.
    tip_link: String,
    /// Collision shapes on its links; `null` where they were not looked for.
    shapes: Option<usize>,
    /// Capsules around them; `null` where they were not looked for.
    capsules: Option<usize>,
}

/// The options that name the robot.
#[derive(Serialize)]
pub struct Options {
    robot: Option<String>,
    urdf: Option<String>,
    dh: Option<String>,
    dh_convention: Option<DhConvention>,
}

impl Options {
    /// Those of the command.
    pub fn of(args: &args::Init) -> Self {
        let from_file = args.urdf.is_some() || args.dh.is_some();
        Options {
            robot: (!from_file).then(|| args.robot.clone()),
            urdf: args.urdf.clone(),
            dh: args.dh.clone(),
            dh_convention: args.dh.as_ref().map(|_| args.dh_convention),
        }
    }
}

/// The cell to start from, of the robot that is asked for.
///
/// # Errors
/// An unknown robot, or anything wrong with the file that describes it.
pub fn start(session: &Session, args: &args::Init) -> Result<Start> {
    match (&args.urdf, &args.dh) {
        (Some(urdf), _) => of_urdf(session, args, urdf),
        (None, Some(dh)) => of_rows(session, dh, args.dh_convention),
        (None, None) => Ok(Start {
            text: template(entry_of(session, &args.robot)?.key)?,
            findings: Vec::new(),
            line: String::new(),
            chain: None,
        }),
    }
}

fn of_rows(session: &Session, from: &str, convention: DhConvention) -> Result<Start> {
    let (file, bytes) = session.read("dh", from)?;
    let name = group_name(from);
    let name = match check_name(&name) {
        Ok(()) => name,
        Err(_) => "robot".to_string(),
    };
    let robot = read_dh_rows(&bytes, &file, &name, convention)?;
    let origin = format!(
        "The robot is that of the rows in {}; base frame: frame 0 of the rows. Angles count as \
         the table has them. Compare a pose with the pendant (`stiffarm pose`).",
        last_name(from)
    );
    Ok(Start { text: template_of(&robot, &origin)?, findings: Vec::new(), line: String::new(), chain: None })
}

fn of_urdf(session: &Session, args: &args::Init, from: &str) -> Result<Start> {
    if let Some(missing) = args.package_dir.iter().find(|folder| !folder.is_dir()) {
        let message = format!("There is no folder {}.", missing.display());
        return Err(Error::new(Code::FileRead, message).key("--package-dir"));
    }
    let (mut name, bytes) = session.read("urdf", from)?;
    let text = if xacro::is_one(from) {
        let text = xacro::expanded(from, &name, &args.package_dir)?;
        // Places of faults are those in the text that xacro made.
        name += " (expanded)";
        text
    } else {
        String::from_utf8(bytes).map_err(|_| {
            let message = "The file is not UTF-8.";
            Error::new(Code::Encoding, message).file(name.as_str())
        })?
    };
    let options = UrdfOptions { base: args.base.clone(), tip: args.tip.clone() };
    let read = read_urdf(&text, &name, &options)?;
    let mut findings = read.findings.clone();
    let mut capsules = Vec::new();
    if !args.no_shapes {
        capsules = link_capsules(session, args, &read, from, &name)?;
        if !read.left_out.is_empty() {
            let sentence = "These links move beside the chain; their shapes are left out.";
            let links = list(&read.left_out);
            findings.push(Finding::note("urdf-left-out", links, sentence));
        }
    }
    if read.robot.suspected_coupling()?.is_some() {
        let sentence = "The pendant may couple joint 3 to joint 2 where the URDF does not. [robot] in cell.toml says \
                        what to look at; until it names the controller, nothing goes to one.";
        let joint = read.robot.joint_names[2].clone();
        findings.push(Finding::caution("urdf-coupling", joint, sentence));
    }
    let gripper = findings.iter().find(|f| f.code == codes::URDF_GRIPPER);
    let gripper = gripper.map(|f| format!(" CHECK FIRST, {}: {}", f.subject, f.sentence));
    let origin = format!(
        "The robot is from {}: the base frame is the link {}, the flange the link {}. Angles are those of \
         the URDF. Compare a pose with the pendant (`stiffarm pose`): where its angles differ, \
         signs and couplings go into theta_from_q, zeros into the offsets of the rows.{}",
        last_name(from),
        read.base_link,
        read.tip_link,
        gripper.unwrap_or_default()
    );
    let names = &read.robot.joint_names;
    let joints = match names.as_slice() {
        [one] => format!("1 joint, {one},"),
        [first, .., last] => format!("{} joints, {first} to {last},", names.len()),
        [] => "no joints".to_string(),
    };
    let around = match (args.no_shapes, capsules.len()) {
        (true, _) => String::new(),
        (false, 0) => "the URDF has no collision geometry: no shapes of links\n".to_string(),
        (false, 1) => "shapes of links: 1 capsule\n".to_string(),
        (false, n) => format!("shapes of links: {n} capsules\n"),
    };
    let line = format!("chain: {joints} from {} to {}\n{around}", read.base_link, read.tip_link);
    Ok(Start {
        text: template_with_shapes(&read.robot, &origin, &capsules)?,
        findings,
        line,
        chain: Some(Chain {
            shapes: (!args.no_shapes).then_some(read.shapes.len()),
            capsules: (!args.no_shapes).then_some(capsules.len()),
            base_link: read.base_link,
            tip_link: read.tip_link,
        }),
    })
}

/// The last part of a path: folders are nobody's business in a cell file.
fn last_name(from: &str) -> String {
    let path = PathBuf::from(from);
    match path.file_name() {
        Some(name) if from != "-" => name.to_string_lossy().into_owned(),
        _ => "standard input".to_string(),
    }
}
