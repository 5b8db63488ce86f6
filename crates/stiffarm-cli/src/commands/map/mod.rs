//! `stiffarm map`: stiffness over a region of the workspace, and the best place
//! for a workpiece.

pub mod place;

use crate::answer::Answer;
use crate::args;
use crate::files::{Files, Said, check_folder, shown};
use crate::output::Exit;
use crate::path::read_stiffness;
use crate::progress::{Progress, announce};
use crate::session::Session;
use std::rc::Rc;
use stiffarm::Result;
use stiffarm::plan::characteristic_length::with_length;
use stiffarm::work::map::{MapOptions, stiffness_map};
use stiffarm_report::{map_figure, map_table, render_svg};

/// Files of the folder.
const FILES: [&str; 2] = ["map.svg", "map.csv"];
/// From so many postures to find on, their number is said before.
const MANY: usize = 100_000;

/// Maps, or places.
pub fn run(session: &Session, args: &args::Map) -> Result<Answer> {
    match &args.place.place {
        Some(path) => place::run(session, args, path),
        None => map(session, args),
    }
}

fn map(session: &Session, args: &args::Map) -> Result<Answer> {
    let mut named = session.read_cell(&args.cell)?;
    if let Some(folder) = &args.output_dir {
        check_folder(session, folder, FILES, args.force)?;
    }
    let saved = read_stiffness(session, &args.stiffness, &named.cell)?;
    let (cell, _) = with_length(named.cell);
    named.cell = cell;
    let request = &args.options;
    let options = request.map_options(&named.cell)?;
    let nodes: usize = options.steps.iter().fold(1, |n, s| n.saturating_mul(*s));
    // A larger grid is refused at once.
    let nodes = nodes * usize::from(nodes <= MapOptions::MOST_NODES);
    let postures = nodes.saturating_mul(options.free_turn.unwrap_or(1));
    announce(session, postures, MANY, "positions and turns of the tip to look at");
    let result = Progress::new(session, "mapping")
        .watch(|control| stiffness_map(&named.cell, &saved.predictor, &options, control));
    let result = result?;
    let said = request.options(&options, &named.cell);
    let pictures = || [render_svg(&map_figure(&result)), map_table(&result).csv()];
    let pictures = pictures_of(args, FILES, pictures);
    let findings = result.findings.clone();
    let exit = Exit::so_far(result.interrupted, &findings);
    let envelope = Rc::new(session.envelope("map", None, said, result));
    let made_with = (named, &saved);
    let answer = Answer::at_work(exit, envelope, &findings, made_with, args.details);
    Ok(answer.with(pictures))
}

/// Picture and table in the folder, where one is asked for.
fn pictures_of(args: &args::Map, names: [&str; 2], texts: impl FnOnce() -> [String; 2]) -> Option<Files> {
    let folder = args.output_dir.as_ref()?;
    let files = names.map(String::from).into_iter().zip(texts());
    let said = format!("{} to {}", names.join(" and "), shown(folder));
    Some(Files::folder(folder, files, args.force).said(Said::As(said)))
}
