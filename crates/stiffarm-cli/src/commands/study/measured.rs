//! `stiffarm study --measured`: which postures and which model predict a measured robot.

use super::{REPORT, RESULT};
use crate::args::StudyArgs;
use crate::commands::earlier::Earlier;
use crate::files::{check_folder, write_folder};
use crate::input::Line;
use crate::numbers::{mm, optional_percent};
use crate::output::Exit;
use crate::page::page_of;
use crate::progress::Progress;
use crate::screen::{columns, wrapped};
use crate::session::Session;
use crate::table::{Align, Table, title};
use serde::Serialize;
use stiffarm::Result;
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::files::envelope::write_result;
use stiffarm::files::source::Source;
use stiffarm::measure::{is_of_table, prepare};
use stiffarm::plan::index::Index;
use stiffarm::study::{MeasuredStudy, MeasuredStudyOptions, measured_study};
use stiffarm_report::render_svg;
use stiffarm_report::study::{measured_figure, measured_table};

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

/// Runs the study and writes its folder.
pub(super) fn run(session: &Session, args: &StudyArgs, from: &str) -> Result<Exit> {
    let named = session.read_cell(&args.cell)?;
    let mut options = options(args)?;
    if args.splits.indices.is_empty() && named.cell.setup.load.has_cases() {
        // It counts one load per posture.
        options.indices.retain(|index| *index != Index::Prediction);
    }
    let measurements = session.read_measurements(&[from.to_string()], None, &named.cell)?;
    let reduce = session.read_registration(args.splits.registration.as_deref())?;
    let names = || std::iter::once(RESULT).chain(FILES).chain([REPORT]);
    check_folder(session, &args.output_dir, names(), args.force)?;
    let measured = prepare(&named.cell, measurements, &reduce)?;
    let of_table = measured.findings().filter(|f| is_of_table(f));
    of_table.for_each(|f| session.remark(&format!("{}\n", f.sentence)));
    let progress = Progress::new(session, "splitting the experiment");
    let study =
        progress.watch(|control| measured_study(&named.cell, measured, &options, control))?;
    drop(progress);
    let interrupted = study.split_count < options.splits;
    let written = Written {
        files: names().map(String::from).collect(),
        study,
    };
    let study = &written.study;
    let envelope = session.envelope(
        "study",
        Some(args.seed),
        Options { measured: true },
        &written,
    );
    let texts = [
        write_result(&envelope)?,
        render_svg(&measured_figure(study)),
        measured_table(study).csv(),
    ];
    let page = page_of(&envelope, Some(&named.cell))?;
    let files = names()
        .map(String::from)
        .zip(texts.into_iter().chain([page]));
    let files = files.collect();
    let earlier = Earlier::of(&args.output_dir);
    write_folder(session, &args.output_dir, files, args.force)?;
    let removed = match session.has_failed() {
        true => String::new(),
        false => earlier.remove_all_but(&args.output_dir, &written.files),
    };
    session.show(&envelope, || {
        let place = args.output_dir.join(REPORT);
        format!(
            "{}{}{removed}{}",
            named.line(),
            summary(study, interrupted),
            match session.has_failed() {
                true => String::new(),
                false => format!(
                    "\nwrote {} files to {}: start with {}\n",
                    written.files.len(),
                    args.output_dir.display(),
                    place.display()
                ),
            }
        )
    })?;
    Ok(match interrupted {
        true => Exit::Interrupted,
        false => Exit::Done,
    })
}

fn options(args: &StudyArgs) -> Result<MeasuredStudyOptions> {
    let given = &args.splits;
    let count = |n: u64| usize::try_from(n).unwrap_or(usize::MAX);
    let mut options = MeasuredStudyOptions::default();
    options.seed = args.seed;
    options.splits = given.splits.map_or(options.splits, count);
    options.pool = given.pool.map(count);
    options.size_factor = given.size_factor.unwrap_or(options.size_factor);
    if !given.choose.is_empty() {
        options.counts = given.choose.iter().copied().map(count).collect();
        options.counts.sort_unstable();
        options.counts.dedup();
    }
    if !given.indices.is_empty() {
        let indices = given.indices.iter().map(|name| Index::from_name(name));
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

fn summary(study: &MeasuredStudy, interrupted: bool) -> String {
    let mut out = format!(
        "{} measured postures; {} random splits into a pool of {} and {} to be predicted{}\n\n",
        study.posture_count,
        study.split_count,
        study.pool_count,
        study.posture_count - study.pool_count,
        match interrupted {
            true => format!(", of {} asked for: stopped", study.options.splits),
            false => String::new(),
        }
    );
    for finding in &study.findings {
        out += &format!("{}\n", wrapped(&finding.sentence, columns()));
    }
    out += &title("RMS error of a displacement component at the other postures [mm]");
    let mut table = Table::new([
        "postures",
        "chosen by",
        "joint axes",
        "mixed model",
        "better than random [%]",
        "(mixed)",
    ]);
    table.align(1, Align::Left);
    let axes = |c: &&stiffarm::study::MeasuredChoice| c.model == ElasticChoice::Axes;
    for own in study.choices.iter().filter(axes) {
        let mixed = study.get(own.postures, own.choice, ElasticChoice::Mixed);
        let shown = |c: &stiffarm::study::MeasuredChoice| {
            format!("{} ± {}", mm(c.mean_m), mm(c.standard_error_m))
        };
        table.row([
            own.postures.to_string(),
            own.choice.as_str().to_string(),
            shown(own),
            mixed.map_or_else(String::new, shown),
            optional_percent(own.better_than_random),
            optional_percent(mixed.and_then(|c| c.better_than_random)),
        ]);
    }
    out + &table.to_string()
}
