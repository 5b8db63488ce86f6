//! `stiffarm study --measured`: which postures and which model predict a measured robot.

use super::{REPORT, RESULT, answer};
use crate::answer::Answer;
use crate::args;
use crate::files::check_folder;
use crate::numbers::to_usize;
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use serde::Serialize;
use stiffarm::Result;
use stiffarm::measure::{is_of_table, prepare};
use stiffarm::plan::index::Index;
use stiffarm::study::{MeasuredStudy, MeasuredStudyOptions, measured_study};
use stiffarm_files::source::{read_measurements, read_registration};
use stiffarm_report::render_svg;
use stiffarm_report::study::{measured_figure, measured_table};
use stiffarm_report::summary::{Context, Summarise, Summary};

/// Figure and table of the study.
const FILES: [&str; 2] = ["measured-choices.svg", "measured-choices.csv"];

/// Options of the result: those of the study stand in it.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// True: the study is one on measurements.
    pub measured: bool,
}

/// The study with the files that stand beside it.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Written {
    /// The study.
    #[serde(flatten)]
    pub study: MeasuredStudy,
    /// Names of all files of this study, this one included.
    pub files: Vec<String>,
}

impl Summarise<Options> for Written {
    fn summary(&self, options: &Options, context: &Context<'_>) -> Result<Summary> {
        self.study.summary(options, context)
    }
}

/// Runs the study and writes its folder.
pub(super) fn run(session: &Session, args: &args::Study, from: &str) -> Result<Answer> {
    let named = session.read_cell(&args.cell)?;
    let mut options = options(args)?;
    if args.splits.indices.is_empty() && named.cell.setup.load.has_cases() {
        // It counts one load per posture.
        options.indices.retain(|index| *index != Index::Prediction);
    }
    let measurements = read_measurements(session, &[from.to_string()], None, &named.cell)?;
    let reduce = read_registration(session, args.splits.registration.as_deref())?;
    let names = || std::iter::once(RESULT).chain(FILES).chain([REPORT]);
    check_folder(session, &args.output_dir, names(), args.force)?;
    let measured = prepare(&named.cell, measurements, &reduce)?;
    let of_table = measured.findings().filter(|f| is_of_table(f));
    of_table.for_each(|f| session.remark(&format!("{}\n", f.sentence)));
    let study = Progress::new(session, "splitting the experiment")
        .watch(|control| measured_study(&named.cell, measured, &options, control))?;
    let interrupted = study.split_count < options.splits;
    let written = Written { files: names().map(String::from).collect(), study };
    let study = &written.study;
    let texts = [render_svg(&measured_figure(study)), measured_table(study).csv()];
    let files = FILES.map(String::from).into_iter().zip(texts).collect();
    let names = written.files.clone();
    let options = Options { measured: true };
    let envelope = session.envelope("study", Some(args.seed), options, written);
    let exit = Exit::so_far(interrupted, &[]);
    answer(args, exit, (envelope, names), named, files)
}

fn options(args: &args::Study) -> Result<MeasuredStudyOptions> {
    let splits = &args.splits;
    let mut options = MeasuredStudyOptions::default();
    options.seed = args.seed;
    options.splits = splits.splits.map_or(options.splits, to_usize);
    options.pool = splits.pool.map(to_usize);
    options.size_factor = splits.size_factor.unwrap_or(options.size_factor);
    if !splits.choose.is_empty() {
        options.counts = splits.choose.iter().copied().map(to_usize).collect();
        options.counts.sort_unstable();
        options.counts.dedup();
    }
    if !splits.indices.is_empty() {
        let indices = splits.indices.iter().map(|name| Index::from_name(name));
        options.indices = indices.collect::<Result<_>>()?;
        let mut seen = Vec::new();
        options.indices.retain(|index| {
            let new = !seen.contains(index);
            seen.push(*index);
            new
        });
    }
    Ok(options)
}
