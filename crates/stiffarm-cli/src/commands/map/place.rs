//! `stiffarm map --place`: the best place for a workpiece.

use super::{MANY, pictures_of};
use crate::answer::Answer;
use crate::args;
use crate::files::check_folder;
use crate::output::Exit;
use crate::path::read_stiffness;
use crate::progress::{Progress, announce};
use crate::session::Session;
use std::rc::Rc;
use stiffarm::Result;
use stiffarm::work::map::{MapOptions, place};
use stiffarm_files::source::{NamedPath, read_path};
use stiffarm_report::{placement_figure, placement_table, render_svg};

/// Files of the folder.
const FILES: [&str; 2] = ["placement.svg", "placement.csv"];
/// Points of a path that a search looks at.
const SEARCHED: usize = 200;

/// Searches the best place.
pub fn run(session: &Session, args: &args::Map, path: &str) -> Result<Answer> {
    let request = &args.options;
    request.check_places()?;
    let named = session.read_cell(&args.cell)?;
    let cell = &named.cell;
    if let Some(folder) = &args.output_dir {
        check_folder(session, folder, FILES, args.force)?;
    }
    let saved = read_stiffness(session, &args.stiffness, cell)?;
    let axes = args.place.axes;
    let NamedPath { table, name, findings, .. } = read_path(session, path, cell, args.place.language, axes, None)?;
    let options = request.place_options(cell)?;
    let places = options.steps.iter().fold(1_usize, |n, s| n.saturating_mul(*s));
    // A larger grid is refused at once.
    let places = places * usize::from(places <= MapOptions::MOST_NODES);
    let rounds = options.refinements + 1;
    let places = places.saturating_mul(options.yaws.len().saturating_mul(rounds));
    let points = places.saturating_mul(table.points.len().min(SEARCHED));
    announce(session, points, MANY, "points of the path to look at, over all places");
    let result = Progress::new(session, "placing")
        .watch(|control| place(cell, &saved.predictor, &table.points, &options, control));
    let mut result = result.map_err(|e| match e.place().line {
        Some(_) => e.file(&name),
        None => e,
    })?;
    result.findings.extend(findings);
    let said = request.of_places(&options);
    let pictures = || [render_svg(&placement_figure(&result)), placement_table(&result).csv()];
    let pictures = pictures_of(args, FILES, pictures);
    let findings = result.findings.clone();
    let exit = Exit::so_far(result.interrupted, &findings);
    let envelope = Rc::new(session.envelope("map", None, said, result));
    let made_with = (named, &saved);
    let answer = Answer::at_work(exit, envelope, &findings, made_with, args.details);
    Ok(answer.with(pictures))
}
