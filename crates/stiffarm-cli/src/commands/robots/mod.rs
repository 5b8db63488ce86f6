//! `stiffarm robots`: the catalogue.

mod describe;

use crate::answer::Answer;
use crate::args;
use crate::numbers::{NONE, significant, stiffness};
use crate::output::Exit;
use crate::screen::{columns, wrapped};
use crate::session::Session;
use crate::table::{Align, Table, title, yellow};
use describe::{Robot, describe};
use serde::Serialize;
use stiffarm::Result;
use stiffarm::model::robot::DhConvention;
use stiffarm::model::robot::{CatalogueEntry, catalogue, find_in_catalogue};
use stiffarm::units::rounded;

#[derive(Serialize)]
struct Options {
    name: Option<String>,
}

#[derive(Serialize)]
struct Robots {
    robots: Vec<Robot>,
}

/// Lists the catalogue, or one robot in full.
pub fn run(session: &Session, args: &args::Robots) -> Result<Answer> {
    let entries: Vec<&CatalogueEntry> = match &args.name {
        Some(name) => vec![entry_of(session, name)?],
        None => by_brand(),
    };
    let robots = entries.iter().map(|entry| describe(entry)).collect::<Result<Vec<_>>>()?;
    let text = match (&args.name, robots.first()) {
        (Some(_), Some(robot)) => one(robot),
        _ => all(&robots),
    };
    let options = Options { name: args.name.clone() };
    let envelope = session.envelope("robots", None, options, Robots { robots });
    Ok(Answer::table(Exit::Done, envelope, text))
}

/// The entry of this name; a word where it is not the one that the catalogue lists.
pub(super) fn entry_of(session: &Session, name: &str) -> Result<&'static CatalogueEntry> {
    let entry = find_in_catalogue(name)?;
    if !entry.key.eq_ignore_ascii_case(name) {
        session.remark(&format!("{name} is {} in the catalogue.\n", entry.key));
    }
    Ok(entry)
}

/// The catalogue with the robots of a brand together, brands as they first come.
fn by_brand() -> Vec<&'static CatalogueEntry> {
    let mut brands: Vec<&str> = Vec::new();
    for entry in catalogue() {
        if !brands.contains(&entry.brand) {
            brands.push(entry.brand);
        }
    }
    let mut entries: Vec<&CatalogueEntry> = catalogue().iter().collect();
    entries.sort_by_key(|entry| brands.iter().position(|brand| *brand == entry.brand));
    entries
}

fn all(robots: &[Robot]) -> String {
    let mut table = Table::new(["name for [robot]", "robot", "kg", "reach [mm]", "limits", "k"]);
    table.align(1, Align::Left);
    table.align(4, Align::Left);
    for robot in robots {
        let limits = match &robot.limits_deg {
            Some(_) if robot.doubts.iter().any(|d| d.about == "limits") => "doubtful",
            Some(_) => "known",
            None => NONE,
        };
        table.row([
            robot.key.to_string(),
            // What stands in brackets is in the robot's own text.
            robot.name.split(" (").next().unwrap_or_default().to_string(),
            robot.payload_kg.map_or_else(|| NONE.to_string(), |kg| kg.to_string()),
            robot.reach_mm.map_or_else(|| NONE.to_string(), |mm| format!("{mm:.0}")),
            limits.to_string(),
            match robot.stiffness.len() {
                0 => NONE.to_string(),
                sets => sets.to_string(),
            },
        ]);
    }
    format!(
        "{table}\nkg: payload. limits: - where not known. k: published sets of joint stiffness.\n\
         `stiffarm robots NAME` shows one with its sources and doubts.\n"
    )
}

/// `label: sentence`, in lines of the terminal's width.
fn said(label: &str, sentence: &str) -> String {
    wrapped(&format!("{label}: {sentence}"), columns()) + "\n"
}

fn one(robot: &Robot) -> String {
    let mut out = format!("{} ({})\n", robot.name, robot.key);
    let with_source = |value: Option<String>, source: Option<&str>| match (value, source) {
        (Some(value), Some(source)) => format!("{value} ({source})"),
        _ => "not known".to_string(),
    };
    out += &said("payload", &with_source(robot.payload_kg.map(|kg| format!("{kg} kg")), robot.payload_source));
    out += &said("reach", &with_source(robot.reach_mm.map(|mm| format!("{mm:.0} mm")), robot.reach_source));
    out += &match robot.file {
        "" => wrapped(robot.source, columns()) + "\n",
        file => {
            said("source", &format!("{}, {file}", robot.source))
                + &said("commit", robot.commit)
                + &said("licence", robot.licence)
        }
    };
    for doubt in &robot.doubts {
        out += &wrapped(&format!("{}: {}: {}", yellow("doubt"), doubt.about, doubt.sentence), columns());
        out.push('\n');
    }
    out += &title("Kinematics");
    out += &kinematics(robot);
    out += &title("Shapes of the links");
    out += &shapes(robot);
    out += &title("Joint stiffness [N·m/rad]");
    out += &stiffness_sets(robot);
    out += &title("Limits and speeds of the pendant's angles");
    out + &limits(robot)
}

fn kinematics(robot: &Robot) -> String {
    let mut out = wrapped(
        &format!(
            "{} Denavit-Hartenberg rows; theta = offset + C q, q are the pendant's angles.",
            match robot.dh_convention {
                DhConvention::Modified => "Modified (Craig)",
                DhConvention::Standard => "Standard",
            }
        ),
        columns(),
    ) + "\n";
    let mut table = Table::new(["row", "alpha [deg]", "a [mm]", "d [mm]", "offset [deg]", "theta"]);
    table.align(5, Align::Left);
    for (i, row) in robot.dh_deg_mm_mm_deg.iter().enumerate() {
        let shown = |v: f64| rounded(v, 4).to_string();
        table.row([
            (i + 1).to_string(),
            shown(row[0]),
            shown(row[1]),
            shown(row[2]),
            shown(row[3]),
            theta(&robot.theta_from_q[i]),
        ]);
    }
    out += &table.to_string();
    for (pose, what) in [
        (&robot.base_mm_deg, "frame 0 in the base frame"),
        (&robot.flange_mm_deg, "flange in the last frame"),
        (&robot.controller_base_mm_deg, "the controller's base frame in the base frame"),
    ] {
        if *pose != [0.0; 6] {
            let numbers = pose.map(|v| rounded(v, 4).to_string());
            out += &said(
                what,
                &if pose[3..] == [0.0; 3] {
                    format!("{} mm", numbers[..3].join(", "))
                } else {
                    format!("{} mm, turns about x, y, z {} deg", numbers[..3].join(", "), numbers[3..].join(", "))
                },
            );
        }
    }
    if !robot.pendant.is_empty() {
        out += &said("pendant", robot.pendant);
    }
    out
}

fn shapes(robot: &Robot) -> String {
    let sentence = match robot.capsules.len() {
        0 => "none known".to_string(),
        count => {
            let pairs = robot.capsules_ignored_pairs.iter();
            let pairs: Vec<String> = pairs.map(|(i, j)| format!("{i}-{j}")).collect();
            let ignored = if pairs.is_empty() {
                String::new()
            } else {
                format!("; those of links {} may overlap, as those of neighbours", pairs.join(", "))
            };
            format!(
                "{count} capsules around links 0 to {}{ignored}. {} Tool, hoses and cables are in none.",
                robot.joint_count, robot.capsules_remark
            )
            .replace(".  ", ". ")
        }
    };
    wrapped(&sentence, columns()) + "\n"
}

/// One row of C in words: `offset - q2 - q3`.
fn theta(row: &[f64]) -> String {
    let mut out = "offset".to_string();
    for (j, factor) in row.iter().enumerate().filter(|(_, c)| **c != 0.0) {
        let sign = if *factor < 0.0 { '-' } else { '+' };
        let size = match factor.abs() {
            1.0 => String::new(),
            size => format!("{} ", significant(size, 6)),
        };
        out += &format!(" {sign} {size}q{}", j + 1);
    }
    out
}

fn stiffness_sets(robot: &Robot) -> String {
    if robot.stiffness.is_empty() {
        return "none published: identify it\n".to_string();
    }
    let sets = (1..=robot.stiffness.len()).map(|i| format!("set {i}"));
    let mut table = Table::new(std::iter::once("joint".to_string()).chain(sets));
    for j in 0..robot.joint_count {
        let values =
            robot.stiffness.iter().map(|s| s.values_nm_per_rad.get(j).map_or(String::new(), |k| stiffness(*k)));
        table.row(std::iter::once((j + 1).to_string()).chain(values));
    }
    let mut out = table.to_string();
    for (i, set) in robot.stiffness.iter().enumerate() {
        let doubt = if set.verified { String::new() } else { format!(" {}", yellow("(not verified)")) };
        out += &said(&format!("set {}", i + 1), &format!("{}{doubt}", set.source));
    }
    out
}

fn limits(robot: &Robot) -> String {
    let mut out = String::new();
    if robot.limits_deg.is_none() {
        out += "limits not known; -360 to 360 stand for them: give limits_deg from the data sheet\n";
        if robot.speeds_deg_per_s.is_none() {
            return out;
        }
    }
    let mut table = Table::new(["joint", "low [deg]", "high [deg]", "speed [deg/s]"]);
    for j in 0..robot.joint_count {
        let limit = |end: usize| {
            let limits = robot.limits_deg.as_ref();
            limits.map_or_else(|| NONE.to_string(), |l| l[j][end].to_string())
        };
        let speed = robot.speeds_deg_per_s.and_then(|speeds| speeds.get(j));
        table.row([(j + 1).to_string(), limit(0), limit(1), speed.map_or_else(|| NONE.to_string(), f64::to_string)]);
    }
    out + &table.to_string()
}
