//! `stiffarm map`: stiffness over a region of the workspace, and the best place
//! for a workpiece.

mod common;
pub mod place;

use super::{others_last, with_length};
use crate::args::MapArgs;
use crate::error::of_usage;
use crate::files::check_folder;
use crate::numbers::{NONE, coarse_mm, optional, significant};
use crate::output::Exit;
use crate::progress::{Progress, announce};
use crate::session::Session;
use crate::table::{Table, title};
use common::{MANY, head, sides, write_folder};
use stiffarm::Result;
use stiffarm::files::source::Source;
use stiffarm::findings::{Finding, Severity};
use stiffarm::units::rad_to_shortest_deg;
use stiffarm::work::map::{MapNode, MapOptions, MapRange, StiffnessMap, stiffness_map};
use stiffarm::work::mapped::{LoadSource, Request};
use stiffarm_report::{map_figure, map_table, render_svg};

/// Files of the folder.
const FILES: [&str; 2] = ["map.svg", "map.csv"];
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
    let request = Request {
        region: args.region.request(),
        rpy_deg: args.tool.rpy_deg,
        free_turn: args.tool.free_turn,
        force_n: args.tool.force_n,
        moment_nm: args.tool.moment_nm,
        direction: args.tool.direction,
    };
    let (options, source) = request
        .map_options(&named.cell)
        .map_err(|e| of_usage(e, &["direction", "from_mm", "to_mm"]))?;
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
    let said = request.options(&options, &named.cell);
    let envelope = session.envelope("map", None, said, &result);
    let pictures = || [render_svg(&map_figure(&result)), map_table(&result).csv()];
    let written = write_folder(session, args, FILES, pictures)?;
    session.show(&envelope, || {
        head(
            &result.findings,
            &named,
            &saved,
            envelope.inputs.get("cell"),
        ) + &table(&result, words(source))
            + &written
    })?;
    Ok(match result.interrupted {
        true => Exit::Interrupted,
        false => {
            let serious = |f: &Finding| f.severity == Severity::Serious;
            Exit::finding(result.findings.iter().any(serious))
        }
    })
}

/// Where the load of a map comes from, in words.
fn words(source: LoadSource) -> &'static str {
    match source {
        LoadSource::Given => "from --force-n",
        LoadSource::Cell => "from the cell's [work]",
        LoadSource::CellAlongPath => {
            "the cell's [work] gives a load in the axes of a path, which a map has not: \
             1 N along the direction"
        }
        LoadSource::Unit => "no force is given: 1 N along the direction",
    }
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
    out + "\n" + &others_last(map.findings.iter())
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
