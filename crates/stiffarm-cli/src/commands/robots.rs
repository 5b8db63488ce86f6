//! `stiffarm robots`: the catalogue.

use crate::args::RobotsArgs;
use crate::numbers::{NONE, stiffness};
use crate::output::Exit;
use crate::session::Session;
use crate::table::{Align, Table, title, yellow};
use serde::Serialize;
use stiffarm::Result;
use stiffarm::model::robot::{CatalogueEntry, catalogue, find_in_catalogue};
use stiffarm::units::rad_to_shortest_deg;

#[derive(Serialize)]
struct Options<'a> {
    name: Option<&'a str>,
}

#[derive(Serialize)]
struct Robots {
    robots: Vec<Robot>,
}

#[derive(Serialize)]
struct Robot {
    key: &'static str,
    name: &'static str,
    payload_kg: Option<f64>,
    joint_count: usize,
    /// `null` where they are not known.
    limits_deg: Option<Vec<[f64; 2]>>,
    source: &'static str,
    stiffness: Vec<Stiffness>,
}

#[derive(Serialize)]
struct Stiffness {
    values_nm_per_rad: &'static [f64],
    source: &'static str,
    verified: bool,
}

/// Lists the catalogue, or one robot in full.
pub fn run(session: &Session, args: &RobotsArgs) -> Result<Exit> {
    let entries: Vec<&CatalogueEntry> = match &args.name {
        Some(name) => vec![find_in_catalogue(name)?],
        None => catalogue().iter().collect(),
    };
    let robots = entries
        .iter()
        .map(|entry| describe(entry))
        .collect::<Result<Vec<_>>>()?;
    let table = || match (&args.name, robots.first()) {
        (Some(_), Some(robot)) => one(robot),
        _ => all(&robots),
    };
    let text = if session.json { String::new() } else { table() };
    let options = Options {
        name: args.name.as_deref(),
    };
    session.show(
        &session.envelope("robots", None, options, Robots { robots }),
        || text,
    )?;
    Ok(Exit::Done)
}

fn describe(entry: &CatalogueEntry) -> Result<Robot> {
    let robot = entry.robot()?;
    let limits = robot
        .joints()
        .iter()
        .map(|j| j.limits.map(rad_to_shortest_deg))
        .collect();
    let stiffness = entry.stiffness.iter().map(|set| Stiffness {
        values_nm_per_rad: set.values,
        source: set.source,
        verified: set.verified,
    });
    Ok(Robot {
        key: entry.key,
        name: entry.name,
        payload_kg: entry.payload_kg,
        joint_count: robot.joint_count(),
        limits_deg: entry.has_limits().then_some(limits),
        source: entry.source,
        stiffness: stiffness.collect(),
    })
}

fn all(robots: &[Robot]) -> String {
    let mut table = Table::new([
        "name for [robot]",
        "robot",
        "payload [kg]",
        "joints",
        "limits",
        "stiffness sets",
    ]);
    table.align(1, Align::Left);
    table.align(4, Align::Left);
    for robot in robots {
        table.row([
            robot.key.to_string(),
            robot.name.to_string(),
            robot
                .payload_kg
                .map_or_else(|| NONE.to_string(), |kg| kg.to_string()),
            robot.joint_count.to_string(),
            if robot.limits_deg.is_some() {
                "known"
            } else {
                "not known"
            }
            .to_string(),
            robot.stiffness.len().to_string(),
        ]);
    }
    format!("{table}\n`stiffarm robots NAME` shows one with its sources and doubts.\n")
}

fn one(robot: &Robot) -> String {
    let payload = robot
        .payload_kg
        .map_or_else(|| "not known".to_string(), |kg| format!("{kg} kg"));
    let mut out = format!(
        "{} ({})\npayload: {payload}\n{}\n",
        robot.name, robot.key, robot.source
    );
    out += &title("Joint stiffness [N·m/rad]");
    if robot.stiffness.is_empty() {
        out += "none published: identify it\n";
    } else {
        let sets = (1..=robot.stiffness.len()).map(|i| format!("set {i}"));
        let mut table = Table::new(std::iter::once("joint".to_string()).chain(sets));
        for j in 0..robot.joint_count {
            let values = robot.stiffness.iter().map(|s| {
                s.values_nm_per_rad
                    .get(j)
                    .map_or(String::new(), |k| stiffness(*k))
            });
            table.row(std::iter::once((j + 1).to_string()).chain(values));
        }
        out += &table.to_string();
        for (i, set) in robot.stiffness.iter().enumerate() {
            let doubt = if set.verified {
                String::new()
            } else {
                format!(" {}", yellow("(not verified)"))
            };
            out += &format!("set {}: {}{doubt}\n", i + 1, set.source);
        }
    }
    out += &title("Limits of the controller angles [deg]");
    match &robot.limits_deg {
        None => {
            out += "not known; -360 to 360 stand for them: give limits_deg from the data sheet\n"
        }
        Some(limits) => {
            let mut table = Table::new(["joint", "low", "high"]);
            for (j, [low, high]) in limits.iter().enumerate() {
                table.row([(j + 1).to_string(), low.to_string(), high.to_string()]);
            }
            out += &table.to_string();
        }
    }
    out
}
