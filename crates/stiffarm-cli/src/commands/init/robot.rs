//! The robot that `init` writes a cell for.

use super::xacro;
use crate::args::{DhChoice, InitArgs};
use crate::input::group_name;
use crate::session::Session;
use serde::Serialize;
use std::path::{Path, PathBuf};
use stiffarm::files::cell::{template, template_of};
use stiffarm::files::check_name;
use stiffarm::files::table::read_dh_rows;
use stiffarm::files::urdf::{CollisionGeometry, MeshFolders, UrdfOptions, UrdfRobot, read_urdf};
use stiffarm::findings::{Finding, Severity, list};
use stiffarm::{Code, Error, Result};

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
}

/// The options that name the robot.
#[derive(Serialize)]
pub struct Options<'a> {
    robot: Option<&'a str>,
    urdf: Option<&'a str>,
    dh: Option<&'a str>,
    dh_convention: Option<DhChoice>,
}

impl<'a> Options<'a> {
    /// Those of the command.
    pub fn of(args: &'a InitArgs) -> Self {
        let own = args.urdf.is_some() || args.dh.is_some();
        Options {
            robot: (!own).then_some(args.robot.as_str()),
            urdf: args.urdf.as_deref(),
            dh: args.dh.as_deref(),
            dh_convention: args.dh.as_ref().map(|_| args.dh_convention),
        }
    }
}

/// The cell to start from, of the robot that is asked for.
///
/// # Errors
/// An unknown robot, or anything wrong with the file that describes it.
pub fn start(session: &Session, args: &InitArgs) -> Result<Start> {
    match (&args.urdf, &args.dh) {
        (Some(urdf), _) => of_urdf(session, args, urdf),
        (None, Some(dh)) => of_rows(session, dh, args.dh_convention),
        (None, None) => Ok(Start {
            text: template(&args.robot)?,
            findings: Vec::new(),
            line: String::new(),
            chain: None,
        }),
    }
}

fn of_rows(session: &Session, from: &str, convention: DhChoice) -> Result<Start> {
    let (file, bytes) = session.read("dh", from)?;
    let name = group_name(from);
    let name = match check_name(&name) {
        Ok(()) => name,
        Err(_) => "robot".to_string(),
    };
    let robot = read_dh_rows(&bytes, &file, &name, convention.into())?;
    let origin = format!(
        "The robot is that of the rows in {}; base frame: frame 0 of the rows. Angles count as \
         the table has them. Compare a pose with the pendant (`stiffarm pose`).",
        last_name(from)
    );
    Ok(Start {
        text: template_of(&robot, &origin)?,
        findings: Vec::new(),
        line: String::new(),
        chain: None,
    })
}

fn of_urdf(session: &Session, args: &InitArgs, from: &str) -> Result<Start> {
    let (mut name, bytes) = session.read("urdf", from)?;
    let text = match xacro::is_one(from) {
        true => {
            let text = xacro::expanded(from, &name)?;
            // Places of faults are those in the text that xacro made.
            name += " (expanded)";
            text
        }
        false => String::from_utf8(bytes).map_err(|_| {
            let message = "The file is not UTF-8.";
            Error::new(Code::Encoding, message).file(name.as_str())
        })?,
    };
    let options = UrdfOptions {
        base: args.base.clone(),
        tip: args.tip.clone(),
    };
    let read = read_urdf(&text, &name, &options)?;
    let mut findings = read.findings.clone();
    if !args.no_shapes {
        find_meshes(&read, args, from, &name)?;
        if !read.left_out.is_empty() {
            let sentence = "These links move beside the chain; their shapes are left out.";
            let links = list(&read.left_out);
            findings.push(Finding::new(
                "urdf-left-out",
                Severity::Note,
                links,
                sentence,
            ));
        }
    }
    let origin = format!(
        "The robot is from {}: the base frame is the link {}, the flange the link {}. Angles are those of \
         the URDF. Compare a pose with the pendant (`stiffarm pose`): where its angles differ, \
         signs and couplings go into theta_from_q, zeros into the offsets of the rows.",
        last_name(from),
        read.base_link,
        read.tip_link
    );
    let joints = match read.robot.rows.len() {
        1 => "1 joint".to_string(),
        n => format!("{n} joints"),
    };
    let line = format!(
        "chain: {joints} from {} to {}\n",
        read.base_link, read.tip_link
    );
    Ok(Start {
        text: template_of(&read.robot, &origin)?,
        findings,
        line,
        chain: Some(Chain {
            shapes: (!args.no_shapes).then_some(read.shapes.len()),
            base_link: read.base_link,
            tip_link: read.tip_link,
        }),
    })
}

/// Checks that the meshes of all shapes are there.
fn find_meshes(read: &UrdfRobot, args: &InitArgs, from: &str, name: &str) -> Result<()> {
    let folder = Path::new(from).parent().map(Path::to_path_buf);
    let folders = MeshFolders {
        urdf: folder.filter(|_| from != "-").unwrap_or_default(),
        packages: args.package_dir.clone(),
    };
    if let Some(missing) = folders.packages.iter().find(|folder| !folder.is_dir()) {
        let message = format!("There is no folder {}.", missing.display());
        return Err(Error::new(Code::FileRead, message).key("--package-dir"));
    }
    for shape in &read.shapes {
        if let CollisionGeometry::Mesh { path, .. } = &shape.geometry {
            folders.find(path).map_err(|error| {
                error.file(name).hint(
                    "name the package, or the folder that holds it, with --package-dir DIR; or go without \
                     shapes: --no-shapes",
                )
            })?;
        }
    }
    Ok(())
}

/// The last part of a path: folders are nobody's business in a cell file.
fn last_name(from: &str) -> String {
    let path = PathBuf::from(from);
    match path.file_name() {
        Some(name) if from != "-" => name.to_string_lossy().into_owned(),
        _ => "standard input".to_string(),
    }
}
