//! `stiffarm report`: one offline page of saved results, and their pictures for papers.

use crate::answer::Answer;
use crate::args;
use crate::files::{Files, Said, check_folder, only_target, shown};
use crate::output::Exit;
use crate::page::check_page_name;
use crate::session::Session;
use serde::Serialize;
use std::path::Path;
use stiffarm::{Code, Error, Result};
use stiffarm_files::builtin;
use stiffarm_files::result::{SavedResult, read_result};
use stiffarm_files::source::{NamedCell, Source};
use stiffarm_files::table::sha256_hex;
use stiffarm_report::page::{Page, pictures, render_page};
use stiffarm_report::paper::{paper_files, paper_names};
use stiffarm_report::report::{WithCell, report};

/// The page where nothing else is asked for.
const PAGE: &str = "report.html";

/// Options of the result: none, where files go changes nothing.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {}

/// What the page shows.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reported {
    /// The results, in their order.
    pub results: Vec<Shown>,
}

/// A result on the page.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Shown {
    /// The command that made it.
    pub command: String,
    /// Name of the cell in its pictures; `null` where the cell is not at hand.
    pub cell: Option<String>,
}

/// A result in words.
fn line(one: &WithCell<'_>) -> String {
    let cell = match (one.cell, one.saved.input("cell")) {
        (Some(cell), _) => format!("cell {}", cell.name),
        (None, Some(_)) => "no cell: give it with --cell for the pictures in 3D".to_string(),
        (None, None) => "no cell".to_string(),
    };
    format!("{}: {}, {cell}\n", one.saved.name, one.saved.command)
}

/// A cell that was given, by the hash under which results name it.
struct Known {
    hash: String,
    named: NamedCell,
}

/// Reads the results and writes their page and pictures.
pub fn run(session: &Session, args: &args::Report) -> Result<Answer> {
    let usual = args.figures.is_none().then_some(PAGE);
    let target = only_target(session, args.output.as_deref().or(usual), args.force)?;
    if let Some(path) = &args.output {
        check_page_name(path, "--output")?;
    }
    args.paper.options().check()?;
    let mut results = Vec::with_capacity(args.results.len());
    for (number, from) in (1..).zip(&args.results) {
        let (name, bytes) = session.read(&format!("result_{number}"), from)?;
        results.push(read_result(&bytes, &name)?);
    }
    let cells = cells(session, args, &results)?;
    let with_cells: Vec<WithCell<'_>> = results
        .iter()
        .map(|saved| {
            let hash = saved.input("cell");
            let cell = cells.iter().find(|cell| Some(cell.hash.as_str()) == hash);
            WithCell::new(saved, cell.map(|cell| &cell.named.cell))
        })
        .collect();
    let page = report(&with_cells)?;
    let folder = args.figures.as_deref();
    let pictures = folder.map(|folder| paper(session, args, folder, &page));
    let pictures = pictures.transpose()?;
    let page = target.map(|target| Files::one(target, render_page(&page)));
    let shown = with_cells
        .iter()
        .map(|one| Shown { command: one.saved.command.clone(), cell: one.cell.map(|cell| cell.name.clone()) });
    let result = Reported { results: shown.collect() };
    let envelope = session.envelope("report", None, Options {}, result);
    let table = with_cells.iter().map(line).collect();
    let answer = Answer::table(Exit::Done, envelope, table);
    Ok(answer.with(page).with(pictures))
}

/// The pictures for a paper; the folder can take them.
fn paper(session: &Session, args: &args::Report, folder: &Path, page: &Page) -> Result<Files> {
    let options = args.paper.options();
    let (figures, drawings) = pictures(page);
    let names = paper_names(&figures, &drawings, &options);
    if names.is_empty() {
        let message = "The results have no pictures in these formats.";
        return Err(Error::new(Code::Usage, message)
            .hint("choose other formats, or give the cell with --cell for its drawings"));
    }
    let names = names.iter().map(String::as_str);
    check_folder(session, folder, names, args.force)?;
    let files = paper_files(&figures, &drawings, &options)?;
    let said = format!("{} files in {}", files.len(), shown(folder));
    Ok(Files::folder(folder, files, args.force).said(Said::As(said)))
}

/// The cells of the results: those given, and built-in ones.
fn cells(session: &Session, args: &args::Report, results: &[SavedResult]) -> Result<Vec<Known>> {
    let mut cells: Vec<Known> = Vec::new();
    let wanted: Vec<&str> = results.iter().filter_map(|r| r.input("cell")).collect();
    for from in &args.cell {
        let named = session.read_cell(from)?;
        let text = session.text_of(&named.name).unwrap_or_default();
        let hashes = session.last_hash("cell").into_iter();
        let mut hashes = hashes.chain(WORK.iter().map(|left_out| hash_without(&text, left_out)));
        let Some(hash) = hashes.find(|hash| wanted.contains(&hash.as_str())) else {
            let message = "No result was made with this version of the cell.";
            return Err(Error::new(Code::Conflict, message).file(&named.name).hint(
                "give the cell file as it was when the result was made ([work] and tasks may have been added \
                    since), or leave out --cell: the page then has no pictures of the cell",
            ));
        };
        cells.push(Known { hash, named });
    }
    for name in builtin::names() {
        let Some(text) = builtin::cell_text(name) else {
            continue;
        };
        let hash = sha256_hex(text.as_bytes());
        let is_known = cells.iter().any(|cell| cell.hash == hash);
        if wanted.contains(&hash.as_str()) && !is_known {
            let named = session.read_cell(&format!("{}{name}", builtin::PREFIX))?;
            cells.push(Known { hash, named });
        }
    }
    Ok(cells)
}

/// Tables on which no measurement depends, in the ways in which they may have been added to a cell later.
const WORK: [&[&str]; 3] = [&["[work"], &["[[task"], &["[work", "[[task"]];

/// Hash of a cell file as it was before the tables that begin so were added to it.
fn hash_without(text: &str, left_out: &[&str]) -> String {
    let mut remaining = String::new();
    let mut keep = true;
    for line in text.split_inclusive('\n') {
        if line.starts_with('[') {
            keep = !left_out.iter().any(|prefix| line.starts_with(prefix));
        }
        if keep {
            remaining += line;
        }
    }
    sha256_hex(format!("{}\n", remaining.trim_end()).as_bytes())
}
