//! The command line. Each command's help ends with examples, which run as tests.

mod capsules;
mod coverage;
mod export;
mod groups;
mod init;
mod measure;
mod measured;
mod path;
mod pose;
mod report;
mod route;
mod schema;
mod select;
mod simulate;
mod work;

pub use capsules::{Capsules, MeshUnit};
pub use coverage::Coverage;
pub use export::{ControllerChoice, Export};
pub use groups::grouped;
pub use init::Init;
pub use measure::Measure;
pub use measured::{Identify, Register, Validate};
pub use path::{Compensate, Predict, WriteChoice};
pub use pose::Pose;
pub use report::Page;
pub use report::Report;
pub use route::Route;
pub use schema::SCHEMAS;
pub use select::{Output, Select, SheetChoice};
pub use simulate::Simulate;
pub use work::Map;

use crate::examples;
use clap::{Args, ColorChoice, Parser, Subcommand, ValueEnum, ValueHint};
use schema::schemas;
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;
use stiffarm::ask::values::{ELASTIC, above_zero, choice, count_or_none, seed, within};
use stiffarm::ask::zones::ZonesOptions;
use stiffarm::estimate::elastic::ElasticChoice;

/// Which postures to measure, what joint stiffness the measurements give and
/// how sure that is, and how far an industrial robot bends at work.
#[derive(Debug, Parser)]
#[command(
    name = "stiffarm",
    version,
    propagate_version = true,
    max_term_width = 100,
    after_help = "Where a file is read, `-` is standard input and `builtin:NAME` a built-in file:\n  \
                  cells     builtin:comau (the default cell), builtin:comau-reference,\n            \
                  builtin:comau-shapes (with a table and a tracker), builtin:fanuc-r2000ic\n  postures  \
                  builtin:comau-group1\n  readings  builtin:fanuc-r2000ic-readings (measured, of \
                  builtin:fanuc-r2000ic)\n  pairs     builtin:example-pairs\n  \
                  paths     builtin:contour\n  \
                  meshes    builtin:spindle.obj\n\n\
                  Exit codes: 0 done, 1 a finding (a joint undetermined, a tolerance exceeded; the full result is \
                  still printed), 2 bad input or usage, 3 a fault of the program, 130 interrupted (the best result \
                  so far is written)."
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Options of every command.
    #[command(flatten)]
    pub global: Global,
}

/// Options of every command.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Global options")]
pub struct Global {
    /// Print one JSON object instead of tables (SI units except keys that end in a unit)
    #[arg(long, global = true)]
    pub json: bool,
    /// Threads to use; the results do not depend on it [default: all cores]
    #[arg(long, global = true, value_name = "N", value_parser = within::<u16>(1..=1024))]
    pub threads: Option<u16>,
    /// No progress and no remarks on standard error
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// When to use colours; NO_COLOR is respected
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    pub color: ColorChoice,
}

/// The commands, in the order of a day's work.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run the whole study of the paper on a cell: groups, simulation, identification, validation, report
    #[command(after_help = examples::STUDY)]
    Study(Study),
    /// Write a commented cell.toml, postures.csv and measurements.csv to start from
    #[command(after_help = examples::INIT)]
    Init(Box<Init>),
    /// Check a cell: joints the load cannot excite, suspicious units, limits no posture meets
    #[command(after_help = examples::CHECK)]
    Check(Check),
    /// Choose the postures to measure, the next ones, or those to leave out, under any index
    #[command(after_help = examples::SELECT)]
    Select(Box<Select>),
    /// All indices and expected errors of given postures, side by side for several files
    #[command(after_help = examples::EVALUATE)]
    Evaluate(Evaluate),
    /// Monte Carlo simulation of identifications with tracker noise
    #[command(after_help = examples::SIMULATE)]
    Simulate(Simulate),
    /// Beside the robot: judge each posture as its readings arrive, and say when it is enough
    #[command(after_help = examples::MEASURE)]
    Measure(Measure),
    /// How often the intervals of `identify` hold the truth, counted in simulated experiments
    #[command(after_help = examples::COVERAGE)]
    Coverage(Coverage),
    /// Transform from tracker to base axes from pairs of points, with residuals and uncertainty
    #[command(after_help = examples::REGISTER)]
    Register(Register),
    /// Joint stiffness with intervals and diagnostics from measurements
    #[command(after_help = examples::IDENTIFY)]
    Identify(Identify),
    /// Compare calculated with measured displacements at postures kept out of the identification
    #[command(after_help = examples::VALIDATE)]
    Validate(Validate),
    /// How far the loaded tool bends away at postures or along a path, and how sure that is
    #[command(after_help = examples::PREDICT)]
    Predict(Box<Predict>),
    /// The path to command so that the loaded tool follows the nominal one
    #[command(after_help = examples::COMPENSATE)]
    Compensate(Box<Compensate>),
    /// Stiffness of the loaded tool over the workspace, and the best place for a workpiece
    #[command(after_help = examples::MAP)]
    Map(Box<Map>),
    /// The order of a plan's postures and the joint moves between them, checked for what they might touch
    #[command(after_help = examples::ROUTE)]
    Route(Route),
    /// Maps of dexterity and of K_C's influence over joints 2 and 3, to choose zones for postures
    #[command(after_help = examples::ZONES)]
    Zones(Zones),
    /// One offline page of saved results, with the cell in 3D; several side by side
    #[command(after_help = examples::REPORT)]
    Report(Report),
    /// Poses of postures as the robot's pendant shows them, and all postures of a pose
    #[command(after_help = examples::POSE)]
    Pose(Pose),
    /// A plan as a program for the robot's controller, and such a program compared with the plan
    #[command(after_help = examples::EXPORT)]
    Export(Box<Export>),
    /// Capsules around the meshes of a tool or a link, ready for cell.toml
    #[command(after_help = examples::CAPSULES)]
    Capsules(Capsules),
    /// The catalogue of robots, with sources and doubts
    #[command(after_help = examples::ROBOTS)]
    Robots(Robots),
    /// JSON Schema of the cell file or of a command's JSON output
    #[command(after_help = examples::SCHEMA)]
    Schema(Schema),
    /// Completions for a shell
    #[command(after_help = examples::COMPLETIONS)]
    Completions(Completions),
    /// Manual pages
    #[command(after_help = examples::MAN)]
    Man(Man),
    /// Pages of the documentation that are generated from the program
    #[command(hide = true, after_help = examples::DOCS)]
    Docs(Docs),
}

#[derive(Debug, Args)]
pub struct Study {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath, default_value = "builtin:comau")]
    pub cell: String,
    /// Initial group (Group 1) [default: builtin:comau-group1 where it fits, else drawn]
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "POSTURES.csv")]
    pub initial: Option<String>,
    /// Choose from the postures of these measurements instead, and predict the others: which
    /// postures and which model predict a measured robot
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "MEASUREMENTS.csv", conflicts_with_all = ["initial", "runs", "initial_groups", "elastic"])]
    pub measured: Option<String>,
    /// How to split measurements.
    #[command(flatten)]
    pub splits: Split,
    /// Folder for report, figures and tables
    #[arg(long, value_name = "DIR", default_value = "study")]
    pub output_dir: PathBuf,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 1, value_parser = seed())]
    pub seed: u64,
    /// Runs per group and noise level
    #[arg(long, default_value_t = 200, value_parser = count_or_none())]
    pub runs: usize,
    /// Other initial groups to try, half random, half with small wrist angles
    #[arg(long, default_value_t = 60, value_parser = count_or_none())]
    pub initial_groups: usize,
    /// Also simulate groups on an arm that gives way beyond its joint axes, as simulate --elastic
    /// does, in at most 40 runs each [default: axes]
    #[arg(long, value_name = "MODEL", value_parser = choice(ELASTIC))]
    pub elastic: Option<ElasticChoice>,
    /// Also show every table and all findings
    #[arg(long)]
    pub details: bool,
    /// The page of the result.
    #[command(flatten)]
    pub page: Page,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// How a study on measurements splits and chooses.
#[derive(Debug, Args)]
#[command(next_help_heading = "With --measured")]
pub struct Split {
    /// Random splits into a pool and postures to be predicted [default: 100]
    #[arg(long, value_name = "N", requires = "measured", value_parser = within::<u64>(1..=100_000))]
    pub splits: Option<u64>,
    /// Postures of the pool [default: seven of ten]
    #[arg(long, value_name = "N", requires = "measured", value_parser = within::<u64>(1..=u64::MAX))]
    pub pool: Option<u64>,
    /// Numbers of postures to choose [default: 6,10,15]
    #[arg(long, value_name = "N,…", requires = "measured", value_delimiter = ',',
          value_parser = within::<u64>(1..=1000))]
    pub choose: Vec<u64>,
    /// Indices that choose [default: novel,expected-error,prediction]
    #[arg(long, value_name = "NAME,…", requires = "measured", value_delimiter = ',')]
    pub indices: Vec<String>,
    /// Multiplies the sizes of what the index prediction takes to give way beyond the axes
    #[arg(long, value_name = "X", requires = "measured", value_parser = above_zero("1"))]
    pub size_factor: Option<f64>,
    /// Result of `register`: places raw readings in the base frame
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "registration.json", requires = "measured")]
    pub registration: Option<String>,
}

#[derive(Debug, Args)]
pub struct Check {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath, default_value = "builtin:comau")]
    pub cell: String,
    /// Draw the cell from the side, from above and in perspective; what violates a limit is red
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "FILE.svg")]
    pub figure: Option<String>,
    /// Postures to draw
    /// [default: the middle of the bounds, or where that violates a limit, a posture within the limits]
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "POSTURES.csv", requires = "figure")]
    pub postures: Option<String>,
    /// The posture to draw in full, among those of --postures or the validation postures; all: each
    /// as a line [default: the one with the least room]
    #[arg(long, value_name = "NAME|all", requires = "figure")]
    pub posture: Option<String>,
    /// Also show every caution
    #[arg(long)]
    pub details: bool,
    /// The page of the result.
    #[command(flatten)]
    pub page: Page,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct Evaluate {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Posture files, one group each
    #[arg(value_hint = ValueHint::FilePath, required = true, value_name = "POSTURES.csv")]
    pub postures: Vec<String>,
    /// Also show correlations, k(J_N) of each posture and what errors rest on
    #[arg(long)]
    pub details: bool,
    /// The page of the result.
    #[command(flatten)]
    pub page: Page,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct Zones {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath, default_value = "builtin:comau")]
    pub cell: String,
    /// Folder for the maps as picture (zones.svg) and table (zones.csv)
    #[arg(long, value_name = "DIR")]
    pub output_dir: Option<PathBuf>,
    /// What is asked.
    #[command(flatten)]
    pub options: ZonesOptions,
    /// The page of the result.
    #[command(flatten)]
    pub page: Page,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct Robots {
    /// One robot, in full
    pub name: Option<String>,
}

#[derive(Debug, Args)]
pub struct Schema {
    /// What to describe
    #[arg(value_parser = schemas())]
    pub what: String,
}

#[derive(Debug, Args)]
pub struct Completions {
    /// The shell
    pub shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub struct Man {
    /// Folder for one page per command; without it the main page goes to standard output
    #[arg(long, value_name = "DIR")]
    pub output_dir: Option<PathBuf>,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct Docs {
    /// Which page
    pub page: DocsPage,
}

/// Generated pages.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum DocsPage {
    /// Error codes with their meaning and exit code
    Errors,
    /// What the commands take, as JSON
    Commands,
}

impl Command {
    /// Where the page of the command's result goes, and whether it may overwrite a file; `None` for commands
    /// whose results have no page.
    pub fn page(&self) -> Option<(&Page, bool)> {
        match self {
            Command::Study(args) => Some((&args.page, args.force)),
            Command::Check(args) => Some((&args.page, args.force)),
            Command::Route(args) => Some((&args.page, args.force)),
            Command::Select(args) => Some((&args.output.page, args.output.force)),
            Command::Evaluate(args) => Some((&args.page, args.force)),
            Command::Simulate(args) => Some((&args.page, args.force)),
            Command::Coverage(args) => Some((&args.page, args.force)),
            Command::Identify(args) => Some((&args.page, args.force)),
            Command::Validate(args) => Some((&args.page, args.force)),
            Command::Predict(args) => Some((&args.page, args.force)),
            Command::Compensate(args) => Some((&args.page, args.force)),
            Command::Map(args) => Some((&args.page, args.force)),
            Command::Zones(args) => Some((&args.page, args.force)),
            _ => None,
        }
    }
}

/// `--color` as far as it can be read before the line is parsed.
pub fn color_of(words: &[OsString]) -> ColorChoice {
    let mut words = options(words);
    let mut color = ColorChoice::Auto;
    while let Some(word) = words.next() {
        let word = word.to_string_lossy();
        let value = match word.strip_prefix("--color") {
            Some("") => words.next().map(|w| w.to_string_lossy().into_owned()),
            Some(rest) => rest.strip_prefix('=').map(String::from),
            None => None,
        };
        if let Some(choice) = value.and_then(|v| ColorChoice::from_str(&v, true).ok()) {
            color = choice;
        }
    }
    color
}

/// Whether the line asks for JSON, which also holds for errors in the line itself.
pub fn wants_json(words: &[OsString]) -> bool {
    options(words).any(|word| word == "--json")
}

fn options(words: &[OsString]) -> impl Iterator<Item = &OsString> {
    words.iter().take_while(|word| word.as_os_str() != OsStr::new("--"))
}
