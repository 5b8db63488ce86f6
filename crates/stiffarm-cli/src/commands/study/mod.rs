//! `stiffarm study`: the paper's Section IV on a cell, into a folder.

pub mod measured;

use super::earlier::Earlier;
use crate::answer::Answer;
use crate::args;
use crate::files::{Files, Said, check_folder};
use crate::output::Exit;
use crate::page::page_of;
use crate::progress::Progress;
use crate::session::Session;
use serde::Serialize;
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::estimate::simulate::SimulationOptions;
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::PostureGroup;
use stiffarm::plan::select::{StartKind, random_group, smallest_margin};
use stiffarm::study::{Study, StudyOptions, study};
use stiffarm::{Code, Error, Result};
use stiffarm_files::builtin;
use stiffarm_files::envelope::Envelope;
use stiffarm_files::envelope::write_result;
use stiffarm_files::source::{NamedCell, read_postures};
use stiffarm_report::study::{cell_picture, figures, tables};
use stiffarm_report::summary::{Context, Summarise, Summary};
use stiffarm_report::{render_drawing, render_svg};

/// Group 1 of the built-in COMAU cells.
const GROUP_1: &str = "builtin:comau-group1";
/// The result itself.
const RESULT: &str = "study.json";
/// The page with the cell in 3D.
const REPORT: &str = "report.html";
/// Postures of an initial group that nobody gave, as many as in the paper.
const POSTURES: usize = 6;

/// Options of the result.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// Where Group 1 came from: `given`, `builtin:comau-group1` or `drawn`.
    pub initial: &'static str,
    /// Options of the study.
    pub study: StudyOptions,
}

/// The study with the files that stand beside it.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Written {
    /// The study.
    #[serde(flatten)]
    pub study: Study,
    /// Names of all files of this study, this one included.
    pub files: Vec<String>,
}

impl Summarise<Options> for Written {
    fn summary(&self, options: &Options, context: &Context<'_>) -> Result<Summary> {
        self.study.summary(options, context)
    }
}

/// Runs the study and writes its folder.
pub fn run(session: &Session, args: &args::Study) -> Result<Answer> {
    if let Some(from) = &args.measured {
        return measured::run(session, args, from);
    }
    let named = session.read_cell(&args.cell)?;
    let (initial, origin) = initial_group(session, args, &named.cell)?;
    let options = {
        let mut study_options = StudyOptions::default();
        study_options.simulation = {
            let mut options = SimulationOptions::default();
            options.runs = args.runs;
            options.seed = args.seed;
            options
        };
        study_options.starts = args.initial_groups;
        study_options.elastic = args.elastic.unwrap_or(ElasticChoice::Axes);
        study_options
    };
    if args.runs == 0 {
        return Err(Error::new(Code::Usage, "A study needs at least one run.").key("--runs"));
    }
    // The names of all files are known before any work: nobody waits half a
    // minute to be told that a file exists.
    let names = file_names(&named.cell, &options);
    let names = names.iter().map(String::as_str);
    check_folder(session, &args.output_dir, names, args.force)?;
    let result = Progress::new(session, "selecting from Group 1")
        .watch(|control| study(&named.cell, &initial, &options, control))?;

    let mut files = Vec::new();
    if let Some(drawing) = &cell_picture(&result, &named.cell)? {
        files.push((format!("{}.svg", drawing.id), render_drawing(drawing)));
    }
    for figure in figures(&result) {
        files.push((format!("{}.svg", figure.id), render_svg(&figure)));
    }
    for table in tables(&result) {
        files.push((format!("{}.csv", table.id), table.csv()));
    }
    let names = std::iter::once(RESULT).chain(files.iter().map(|(name, _)| name.as_str()));
    let result = Written { files: names.chain([REPORT]).map(String::from).collect(), study: result };
    let exit = Exit::so_far(result.study.interrupted, &result.study.findings);
    let names = result.files.clone();
    let envelope = session.envelope("study", Some(args.seed), Options { initial: origin, study: options }, result);
    answer(args, exit, (envelope, names), named, files)
}

/// The folder of a study, the result first and its page last, and what the study says.
fn answer<O: Serialize + 'static, R: Serialize + Summarise<O> + 'static>(
    args: &args::Study,
    exit: Exit,
    (envelope, names): (Envelope<O, R>, Vec<String>),
    named: NamedCell,
    pictures: Vec<(String, String)>,
) -> Result<Answer> {
    let mut files = vec![(RESULT.to_string(), write_result(&envelope)?)];
    files.extend(pictures);
    files.push((REPORT.to_string(), page_of(&envelope, Some(&named.cell))?));
    let folder = args.output_dir.clone();
    let page = folder.join(REPORT);
    let (count, shown, page) = (files.len(), folder.display(), page.display());
    let said = format!("{count} files to {shown} (start with {page})");
    let earlier = Earlier::of(&folder);
    let files = Files::folder(&folder, files, args.force).said(Said::As(said));
    let files = files.then(move || earlier.remove_all_but(&folder, &names).trim_end().to_string());
    Ok(Answer::summary(exit, envelope, named, args.details).with(files))
}

/// Group 1: given, the shipped one where it fits the cell, or drawn with small
/// wrist angles as an engineer picks postures by hand.
fn initial_group(session: &Session, args: &args::Study, cell: &Cell) -> Result<(PostureGroup, &'static str)> {
    let robot = &cell.setup.robot;
    let named = |postures| PostureGroup { name: "Group 1".to_string(), postures };
    if let Some(from) = &args.initial {
        return Ok((named(read_postures(session, "initial", from, robot)?), "given"));
    }
    if let Ok(postures) = builtin::postures("comau-group1", robot) {
        let inside = postures.iter().all(|p| p.q.iter().zip(&cell.bounds).all(|(q, b)| (b[0]..=b[1]).contains(q)));
        let same_robot = builtin::cell("comau").is_ok_and(|c| c.setup.robot == *robot);
        if same_robot && inside && smallest_margin(cell, &postures)?.is_none_or(|m| m >= 0.0) {
            return Ok((named(read_postures(session, "initial", GROUP_1, robot)?), GROUP_1));
        }
    }
    // Its stream is none of those the study draws its other groups from.
    let angles = random_group(cell, StartKind::SmallWrist, POSTURES, args.seed, u64::MAX)?;
    Ok((PostureGroup::from_angles("Group 1", angles), "drawn"))
}

/// Files that every study of `cell` writes.
fn file_names(cell: &Cell, options: &StudyOptions) -> Vec<String> {
    let mut names = vec![
        RESULT.to_string(),
        "cell.svg".to_string(),
        REPORT.to_string(),
        "expected-deviation.svg".to_string(),
        "indices.csv".to_string(),
        "simulation.csv".to_string(),
    ];
    if options.starts > 0 {
        names.push("other-starts.svg".to_string());
    }
    if options.elastic != ElasticChoice::Axes {
        names.push("elastic.csv".to_string());
    }
    if !cell.validation.is_empty() {
        names.push("validation.svg".to_string());
    }
    names
}
