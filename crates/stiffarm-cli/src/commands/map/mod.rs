//! `stiffarm map`: stiffness over a region of the workspace, and the best place
//! for a workpiece.

mod common;
pub mod place;
mod region;

use super::{finding_line, with_length};
use crate::args::MapArgs;
use crate::files::check_folder;
use crate::numbers::{NONE, coarse_mm, optional, significant};
use crate::output::Exit;
use crate::progress::{Progress, announce};
use crate::session::Session;
use crate::table::{Table, title};
use common::{MANY, head, sides, write_folder};
use nalgebra::{UnitQuaternion, UnitVector3, Vector3};
use region::Region;
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::files::source::Source;
use stiffarm::findings::{Finding, Severity};
use stiffarm::model::cell::Cell;
use stiffarm::model::load::Wrench;
use stiffarm::model::process::ForceAxes;
use stiffarm::units::{deg_to_rad, rad_to_shortest_deg};
use stiffarm::work::map::{MapNode, MapOptions, MapRange, StiffnessMap, stiffness_map};
use stiffarm::{Code, Error, Result};
use stiffarm_report::{map_figure, map_table, render_svg};

/// Files of the folder.
const FILES: [&str; 2] = ["map.svg", "map.csv"];
/// The tool axis down.
const DOWN_DEG: [f64; 3] = [180.0, 0.0, 0.0];

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// Orientation of the tip frame: turns about the base's x, then y, then z \[deg\].
    pub rpy_deg: [f64; 3],
    /// Turns about the tool axis that were tried, where it is free.
    pub free_turn: Option<usize>,
    /// Nodes along x, y, z.
    pub steps: [usize; 3],
    /// L of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
}

/// Maps, or places.
pub fn run(session: &Session, args: &MapArgs) -> Result<Exit> {
    match &args.place.place {
        Some(path) => place::run(session, args, path),
        None => map(session, args),
    }
}

fn map(session: &Session, args: &MapArgs) -> Result<Exit> {
    let mut named = session.read_cell(&args.cell)?;
    if let Some(folder) = &args.output_dir {
        check_folder(session, folder, FILES, args.force)?;
    }
    let saved = session.read_stiffness(&args.stiffness, &named.cell)?;
    let (cell, _) = with_length(named.cell);
    named.cell = cell;
    let (options, load_words) = options(&named.cell, args)?;
    let nodes: usize = options.steps.iter().fold(1, |n, s| n.saturating_mul(*s));
    // A larger grid is refused at once.
    let nodes = nodes * usize::from(nodes <= MapOptions::MOST);
    let postures = nodes.saturating_mul(options.free_turn.unwrap_or(1));
    announce(
        session,
        postures,
        MANY,
        "positions and turns of the tip to look at",
    );
    let progress = Progress::new(session, "mapping");
    let result =
        progress.watch(|control| stiffness_map(&named.cell, &saved.predictor, &options, control));
    drop(progress);
    let result = result?;
    let said = Options {
        rpy_deg: args.tool.rpy_deg.unwrap_or(DOWN_DEG),
        free_turn: options.free_turn,
        steps: options.steps,
        characteristic_length_m: named.cell.characteristic_length,
    };
    let envelope = session.envelope("map", None, said, &result);
    let pictures = || [render_svg(&map_figure(&result)), map_table(&result).csv()];
    let written = write_folder(session, args, FILES, pictures)?;
    session.show(&envelope, || {
        head(&named, &saved, envelope.inputs.get("cell")) + &table(&result, &load_words) + &written
    })?;
    Ok(match result.interrupted {
        true => Exit::Interrupted,
        false => {
            let serious = |f: &Finding| f.severity == Severity::Serious;
            Exit::finding(result.findings.iter().any(serious))
        }
    })
}

/// What is mapped, and where its load comes from in words.
fn options(cell: &Cell, args: &MapArgs) -> Result<(MapOptions, String)> {
    let tool = &args.tool;
    let region = Region::of_map(cell, &args.region)?;
    let [roll, pitch, yaw] = tool.rpy_deg.unwrap_or(DOWN_DEG).map(deg_to_rad);
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    let direction = match tool.direction {
        Some(direction) => Some(
            UnitVector3::try_new(Vector3::from(direction), f64::MIN_POSITIVE).ok_or_else(|| {
                Error::new(Code::Usage, "The direction must not have length zero.")
                    .key("--direction")
            })?,
        ),
        None => None,
    };
    let process = cell.work.process.as_ref().map(|p| p.load());
    let fixed = |v: Vector3<f64>| (v.norm() > 0.0).then_some(v);
    let (wrench, words) = match (tool.force_n, process) {
        (Some(force), _) => {
            let wrench = Wrench {
                force: Vector3::from(force),
                moment: Vector3::from(tool.moment_nm.unwrap_or_default()),
            };
            (Some(wrench), "--force-n")
        }
        (None, Some(load)) if load.axes != ForceAxes::Path && load.force.norm() > 0.0 => {
            let turn = match load.axes {
                ForceAxes::Tool => rotation,
                ForceAxes::Workpiece => cell.work.workpiece.rotation,
                ForceAxes::Base | ForceAxes::Path => UnitQuaternion::identity(),
            };
            let wrench = Wrench {
                force: turn * load.force,
                moment: turn * load.moment,
            };
            (Some(wrench), "the cell's [work]")
        }
        (None, Some(_)) => (
            None,
            "the cell's [work] gives a load in the axes of a path, which a map has not",
        ),
        (None, None) => (None, "no force is given"),
    };
    // Against the tool axis, as the process pushes the tool back.
    let back = UnitVector3::new_normalize(rotation * -Vector3::z());
    let direction = direction.unwrap_or_else(|| {
        let along = wrench.and_then(|w| fixed(w.force));
        along.map_or(back, UnitVector3::new_normalize)
    });
    let options = {
        let mut options = MapOptions::new(region.lower, region.upper, region.steps);
        options.rotation = rotation;
        options.free_turn = tool.free_turn;
        options.direction = direction;
        options.wrench = wrench.unwrap_or_else(|| Wrench::force(direction.into_inner()));
        options
    };
    let words = match wrench {
        Some(_) => format!("from {words}"),
        None => format!("{words}: 1 N along the direction"),
    };
    Ok((options, words))
}

/// Three components with four digits.
fn vector(v: [f64; 3]) -> String {
    let parts = v.map(|c| match c.abs() < 1e-9 {
        true => "0".to_string(),
        false => {
            let text = significant(c, 4);
            match text.contains('.') && !text.contains('e') {
                true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
                false => text,
            }
        }
    });
    format!("({})", parts.join(", "))
}

fn table(map: &StiffnessMap, load: &str) -> String {
    let [nx, ny, nz] = map.axes().map(<[f64]>::len);
    let axis = [0, 1, 2].map(|i| map.rotation[i][2]);
    let turn = match map.free_turn {
        Some(turns) => format!(", the turn about it free (the best of {turns})"),
        None => String::new(),
    };
    let mut out = format!(
        "map: {}: {nx} × {ny} × {nz} nodes; tool axis {}{turn}\n",
        sides(map.axes()),
        vector(axis)
    );
    let moment = match map.moment_nm.iter().any(|m| *m != 0.0) {
        true => format!(" and moment {} N·m", vector(map.moment_nm)),
        false => String::new(),
    };
    out += &format!(
        "load on the robot at the tip: force {} N{moment}, {load}\n",
        vector(map.force_n)
    );
    let counts = map.counts;
    let total = map.nodes.len();
    out += &format!("{} of {total} nodes are reachable", counts.reachable);
    let others: Vec<String> = [
        (counts.forbidden, "forbidden by the cell's limits"),
        (counts.outside_joint_limits, "outside the joint limits"),
        (counts.unreachable, "out of reach"),
        (counts.not_computed, "not computed: stopped"),
    ]
    .iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, what)| format!("{count} {what}"))
    .collect();
    out += &match others.is_empty() {
        true => ".\n".to_string(),
        false => format!("; {}.\n", others.join(", ")),
    };
    if map.extremes.is_some() {
        out += &title("Over the reachable nodes; at each the posture that bends least");
        out += &ranges(map).to_string();
        out += &extremes(map);
    }
    out += "\n";
    for finding in &map.findings {
        out += &finding_line(finding);
    }
    out
}

fn ranges(map: &StiffnessMap) -> Table {
    let mut table = Table::new(["quantity", "smallest", "median", "largest"]);
    let mut row = |name: String, range: Option<MapRange>, factor: f64| {
        let show = |pick: fn(MapRange) -> f64| optional(range.map(|r| factor * pick(r)), 3);
        table.row([
            name,
            show(|r| r.smallest),
            show(|r| r.median),
            show(|r| r.largest),
        ]);
    };
    row(
        "deflection per newton [µm/N]".to_string(),
        map.deflection_per_newton_m,
        1e6,
    );
    row(
        format!("stiffness along {} [N/µm]", vector(map.direction)),
        map.stiffness_n_per_m,
        1e-6,
    );
    row(
        "stiffness along the softest direction [N/µm]".to_string(),
        map.softest_n_per_m,
        1e-6,
    );
    if map.k_jn.is_some() {
        row("k(J_N)".to_string(), map.k_jn, 1.0);
    }
    table
}

/// The nodes that bend least and most, with their postures.
fn extremes(map: &StiffnessMap) -> String {
    let Some(extremes) = map.extremes else {
        return String::new();
    };
    let joints = map.nodes[extremes.best].values.as_ref();
    let joints = 1..=joints.map_or(0, |v| v.q.len());
    let headings = ["node", "x [mm]", "y [mm]", "z [mm]", "deflection [µm]"].map(String::from);
    let confidence = map.confidence.map(|c| format!("± {} %", 100.0 * c));
    let angles = joints.map(|j| format!("q{j} [deg]"));
    let mut table = Table::new(headings.into_iter().chain(confidence).chain(angles));
    let mut row = |name: &str, node: &MapNode| {
        let Some(values) = &node.values else { return };
        let mut fields = vec![name.to_string()];
        fields.extend(node.position_m.map(coarse_mm));
        fields.push(significant(1e6 * values.deflection_m, 3));
        if map.confidence.is_some() {
            let width = values.half_width_m.map(|w| significant(1e6 * w, 2));
            fields.push(width.unwrap_or_else(|| NONE.to_string()));
        }
        // Adding zero turns −0 into 0.
        let angles = values.q.iter().map(|q| rad_to_shortest_deg(*q));
        fields.extend(angles.map(|q| format!("{:.2}", (q * 100.0).round() / 100.0 + 0.0)));
        table.row(fields);
    };
    row("bends least", &map.nodes[extremes.best]);
    row("bends most", &map.nodes[extremes.worst]);
    format!("\n{table}")
}
