//! `stiffarm map --place`: the best place for a workpiece.

use super::common::{MANY, head, sides, write_folder};
use crate::args::MapArgs;
use crate::commands::others_last;
use crate::error::of_usage;
use crate::files::check_folder;
use crate::numbers::{coarse_mm, optional, percent};
use crate::output::Exit;
use crate::progress::{Progress, announce};
use crate::session::Session;
use crate::table::{Align, Table, title};
use stiffarm::files::source::{NamedPath, Source};
use stiffarm::findings::{Finding, Severity};
use stiffarm::units::rad_to_shortest_deg;
use stiffarm::work::map::{MapOptions, Placed, Placement, Status, place};
use stiffarm::work::placed::Request;
use stiffarm::{Error, Result};
use stiffarm_report::{placement_figure, placement_table, render_svg};

/// Files of the folder.
const FILES: [&str; 2] = ["placement.svg", "placement.csv"];
/// Points of a path that a search looks at.
const SEARCHED: usize = 200;
/// Searches the best place.
pub fn run(session: &Session, args: &MapArgs, path: &str) -> Result<Exit> {
    let request = Request {
        region: args.region.request(),
        yaw_deg: args.place.yaw_deg.clone(),
        refine: args.place.refine,
        free_turn: args.tool.free_turn,
    };
    let usage = |e: Error| of_usage(e, &["yaw_deg", "from_mm", "to_mm"]);
    request.check().map_err(usage)?;
    let named = session.read_cell(&args.cell)?;
    let cell = &named.cell;
    if let Some(folder) = &args.output_dir {
        check_folder(session, folder, FILES, args.force)?;
    }
    let saved = session.read_stiffness(&args.stiffness, cell)?;
    let axes = args.place.axes.map(Into::into);
    let NamedPath { table, name } = session.read_path(path, cell, axes)?;
    let options = request.place_options(cell).map_err(usage)?;
    let places = options
        .steps
        .iter()
        .fold(1_usize, |n, s| n.saturating_mul(*s));
    // A larger grid is refused at once.
    let places = places * usize::from(places <= MapOptions::MOST);
    let rounds = options.refinements + 1;
    let places = places.saturating_mul(options.yaws.len().saturating_mul(rounds));
    let points = places.saturating_mul(table.points.len().min(SEARCHED));
    announce(
        session,
        points,
        MANY,
        "points of the path to look at, over all places",
    );
    let progress = Progress::new(session, "placing");
    let result =
        progress.watch(|control| place(cell, &saved.predictor, &table.points, &options, control));
    drop(progress);
    let result = result.map_err(|e| match e.place().line {
        Some(_) => e.file(&name),
        None => e,
    })?;
    let said = request.options(&options);
    let envelope = session.envelope("map", None, said, &result);
    let pictures = || {
        [
            render_svg(&placement_figure(&result)),
            placement_table(&result).csv(),
        ]
    };
    let written = write_folder(session, args, FILES, pictures)?;
    session.show(&envelope, || {
        let places = [0, 1, 2].map(|axis| [options.lower[axis], options.upper[axis]]);
        let shown: [&[f64]; 3] = std::array::from_fn(|axis| match options.steps[axis] {
            1 => &places[axis][..1],
            _ => &places[axis][..],
        });
        head(
            &result.findings,
            &named,
            &saved,
            envelope.inputs.get("cell"),
        ) + &format!("places: {}\n", sides(shown))
            + &words(&result)
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

fn words(result: &Placement) -> String {
    let tried = result.candidates.len();
    let works = |status| {
        result
            .candidates
            .iter()
            .filter(|c| c.status == status)
            .count()
    };
    let mut out = format!(
        "path: {} points, {} of them searched at {tried} places",
        result.point_count, result.searched_points
    );
    let others: Vec<String> = [
        Status::Forbidden,
        Status::OutsideJointLimits,
        Status::Unreachable,
        Status::Discontinuous,
    ]
    .iter()
    .map(|status| (works(*status), status.describe()))
    .filter(|(count, _)| *count > 0)
    .map(|(count, what)| format!("{count} {what}"))
    .collect();
    out += &match others.is_empty() {
        true => ".\n".to_string(),
        false => format!(
            "; {} work, {}.\n",
            works(Status::Reachable),
            others.join(", ")
        ),
    };
    out += &title("Deflection along the whole path");
    let mut table = Table::new([
        "place",
        "x [mm]",
        "y [mm]",
        "z [mm]",
        "yaw [deg]",
        "RMS [µm]",
        "largest [µm]",
        "at point",
    ]);
    table.align(7, Align::Left);
    let mut row = |name: &str, placed: &Placed| {
        let mut fields = vec![name.to_string()];
        fields.extend(placed.position_m.map(coarse_mm));
        fields.push(rad_to_shortest_deg(placed.yaw).to_string());
        fields.push(optional(placed.deflection_rms_m.map(|v| 1e6 * v), 4));
        fields.push(optional(placed.deflection_max_m.map(|v| 1e6 * v), 4));
        let point = placed.deflection_max_point.as_ref();
        fields.push(point.map_or_else(|| placed.status.describe().to_string(), String::clone));
        table.row(fields);
    };
    row("given", &result.given);
    if let Some(best) = &result.best {
        row("best", best);
    }
    out += &table.to_string();
    if let Some(gain) = result.gain.filter(|gain| *gain > 1.0) {
        out += &format!(
            "The best place saves {} % of the deflection.\n",
            percent(1.0 - 1.0 / gain)
        );
    }
    if let Some(best) = &result.best {
        let [x, y, z] = best.position_m.map(coarse_mm);
        let degrees = best.roll_pitch_yaw.map(rad_to_shortest_deg);
        let [roll, pitch, yaw] = degrees.map(|a| (a * 1e6).round() / 1e6 + 0.0);
        out += &format!(
            "\nfor the cell:\n[work]\nworkpiece_mm = [{x}, {y}, {z}]\nworkpiece_rpy_deg = [{roll}, {pitch}, {yaw}]\n"
        );
    }
    out + "\n" + &others_last(result.findings.iter())
}
