//! `stiffarm map`: stiffness over a region of the workspace, and the best place
//! for a workpiece.

pub mod place;

use crate::args::MapArgs;
use crate::files::{check_folder, shown, write_folder};
use crate::output::Exit;
use crate::path::read_stiffness;
use crate::progress::{Progress, announce};
use crate::session::Session;
use stiffarm::Result;
use stiffarm::plan::characteristic_length::with_length;
use stiffarm::work::map::{MapOptions, stiffness_map};
use stiffarm::work::mapped::Request;
use stiffarm_report::{map_figure, map_table, render_svg};

/// Files of the folder.
const FILES: [&str; 2] = ["map.svg", "map.csv"];
/// From so many postures to find on, their number is said before.
const MANY: usize = 100_000;

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
    let saved = read_stiffness(session, &args.stiffness, &named.cell)?;
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
    let options = request.map_options(&named.cell)?;
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
    let result = Progress::new(session, "mapping")
        .watch(|control| stiffness_map(&named.cell, &saved.predictor, &options, control));
    let result = result?;
    let said = request.options(&options, &named.cell);
    let pictures = || [render_svg(&map_figure(&result)), map_table(&result).csv()];
    write_pictures(session, args, FILES, pictures)?;
    let exit = session.deliver_at_work(
        &session.envelope("map", None, said, &result),
        &result.findings,
        (&named, &saved),
        args.details,
    )?;
    Ok(if result.interrupted {
        Exit::Interrupted
    } else {
        exit
    })
}

/// Writes picture and table to the folder, where one is asked for.
fn write_pictures(
    session: &Session,
    args: &MapArgs,
    names: [&str; 2],
    texts: impl FnOnce() -> [String; 2],
) -> Result<()> {
    let Some(folder) = &args.output_dir else {
        return Ok(());
    };
    let files = names.map(String::from).into_iter().zip(texts()).collect();
    write_folder(session, folder, files, args.force)?;
    if !session.has_failed() {
        session.has_written(format!("{} to {}", names.join(" and "), shown(folder)));
    }
    Ok(())
}
