//! The command line of `stiffarm select`.

use super::PageArgs;
use super::values::{above_zero, angle_step, count, numbers, seed, within};
use clap::{ArgGroup, Args, ValueEnum, ValueHint};
use std::time::Duration;
use stiffarm::plan::index::{Index, Origin};
use stiffarm::plan::planned;

/// Most postures of one plan.
const MOST_POSTURES: u64 = planned::MOST_POSTURES as u64;

/// The doc comment of `index`, with the names that there are.
fn index_help() -> String {
    let of = |origin: Origin| {
        let all = Index::ALL.into_iter().filter(|own| own.origin() == origin);
        let names: Vec<String> = all.map(|own| own.as_str().replace('_', "-")).collect();
        names.join(", ")
    };
    format!(
        "Index to improve; `stiffarm evaluate` shows all of them [default: prediction, or expected-error where load parameters \
         are chosen too]\n\n{}; of the paper: {}; of the literature: {}.",
        of(Origin::Here),
        of(Origin::Paper),
        of(Origin::Literature)
    )
}

#[derive(Debug, Args)]
pub struct SelectArgs {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// Index to improve; `stiffarm evaluate` shows all of them [default: prediction, or expected-error where load parameters
    /// are chosen too]
    #[arg(long, value_name = "NAME", long_help = index_help())]
    pub index: Option<String>,
    /// Number of postures to select; with --curve the largest [default: 6, with --curve 12]
    #[arg(long, short = 'n', value_name = "N", value_parser = within::<u64>(1..=MOST_POSTURES),
          conflicts_with_all = ["initial", "given"])]
    pub count: Option<u64>,
    /// Time beside the robot instead of a number of postures, by [time] of the cell [min]
    ///
    /// Under prediction it also says which of the cell's loads each posture is measured under, and what the others, or a
    /// weight hung as well, give in the same time.
    #[arg(long, value_name = "MIN", value_parser = above_zero("min"), conflicts_with_all = ["count", "initial", "given",
          "curve", "space_filling", "candidates", "anchor_box_mm", "loading_point_box_mm", "largest_load_n"])]
    pub minutes: Option<f64>,
    /// The index prediction may measure a posture again; without this no two postures of a plan are within 15° of each
    /// other in every joint
    #[arg(long, conflicts_with_all = ["initial", "space_filling", "candidates", "drop"])]
    pub repeats: bool,
    /// The best value for every number of postures up to --count, and what one more gains
    #[arg(long, conflicts_with_all = ["initial", "given", "sensitivity"])]
    pub curve: bool,
    /// Also say whether another prior stiffness, or errors of postures and tool points, would change the plan
    #[arg(long)]
    pub sensitivity: bool,
    /// Also say what each kind of limit costs: the index of the best plan without it
    #[arg(long, conflicts_with_all = ["initial", "curve"])]
    pub prices: bool,
    /// Do not compute how good any plan could be (for prediction, expected-error, d and task)
    #[arg(long)]
    pub no_certificate: bool,
    /// Postures that cover the joint space evenly, without any index: a baseline to compare with
    #[arg(long, conflicts_with_all = ["index", "curve", "sensitivity", "no_certificate", "initial", "given", "rounds",
          "time_limit", "anchor_box_mm", "loading_point_box_mm", "largest_load_n"])]
    pub space_filling: bool,
    /// Choose the best postures out of this list: a table of postures, or one of measurements,
    /// whose postures count under their measured wrenches
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "TABLE", conflicts_with_all = ["space_filling", "curve", "sensitivity", "initial", "given",
          "rounds", "time_limit", "anchor_box_mm", "loading_point_box_mm", "largest_load_n"])]
    pub candidates: Option<String>,
    /// Also show all indices, correlations, the moves, the room that each limit leaves and what errors rest on
    #[arg(long)]
    pub details: bool,
    /// Postures that are there already.
    #[command(flatten)]
    pub existing: ExistingArgs,
    /// How long to search.
    #[command(flatten)]
    pub budget: BudgetArgs,
    /// Load parameters to choose.
    #[command(flatten)]
    pub load: LoadArgs,
    /// Files to write.
    #[command(flatten)]
    pub output: OutputArgs,
}

/// Postures that are there already.
#[derive(Debug, Args)]
#[command(next_help_heading = "Postures that are there already")]
pub struct ExistingArgs {
    /// Initial group to improve locally, as in the paper, instead of a global search
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "POSTURES.csv",
          conflicts_with_all = ["given", "seed", "rounds", "time_limit", "no_certificate", "anchor_box_mm",
                                "loading_point_box_mm", "largest_load_n"])]
    pub initial: Option<String>,
    /// Iterations of the optimiser from the initial group [default: 2000]
    #[arg(long, value_name = "N", requires = "initial", value_parser = within::<u64>(1..=u64::MAX))]
    pub max_iterations: Option<u64>,
    /// Postures measured or planned already: they stay as they are, and --add or --drop says what to do
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "POSTURES.csv", conflicts_with_all = ["sensitivity", "anchor_box_mm",
          "loading_point_box_mm", "largest_load_n"])]
    pub given: Option<String>,
    /// Add the M postures that help most; --output and --sheet hold these alone, under new names [default: 1]
    #[arg(long, value_name = "M", requires = "given", conflicts_with = "drop",
          value_parser = within::<u64>(1..=MOST_POSTURES))]
    pub add: Option<u64>,
    /// Leave out the K postures least worth their time; --output and --sheet hold those that stay [default: 1]
    #[arg(long, value_name = "K", requires = "given", num_args = 0..=1, default_missing_value = "1",
          conflicts_with_all = ["seed", "rounds", "time_limit", "no_certificate"], value_parser = count())]
    pub drop: Option<u64>,
}

/// How long to search.
#[derive(Debug, Args)]
#[command(next_help_heading = "How long to search (without these, until nothing improves)")]
pub struct BudgetArgs {
    /// Exactly N rounds; they give the same result on any number of threads
    #[arg(long, value_name = "N", value_parser = count())]
    pub rounds: Option<u64>,
    /// End after the round in which this time is over (with --curve, for each number of postures)
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time_limit: Option<Duration>,
    /// Seed of the random numbers [default: 1]
    #[arg(long, value_name = "N", value_parser = seed())]
    pub seed: Option<u64>,
}

/// Load parameters to choose together with the postures.
#[derive(Debug, Args)]
#[command(next_help_heading = "Choosing the load together with the postures")]
pub struct LoadArgs {
    /// Box for the anchor of rope or cylinder: lowest, then highest corner, base axes [mm]
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = corners(), allow_hyphen_values = true,
          conflicts_with = "curve")]
    pub anchor_box_mm: Option<[f64; 6]>,
    /// Box for the loading point: lowest, then highest corner, flange axes [mm]
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = corners(), allow_hyphen_values = true,
          conflicts_with = "curve")]
    pub loading_point_box_mm: Option<[f64; 6]>,
    /// Largest force the rope, cylinder or weight may have, instead of the cell's [N]
    #[arg(long, value_name = "X", value_parser = above_zero("n"), conflicts_with = "curve")]
    pub largest_load_n: Option<f64>,
}

/// Files to write.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output",
          group = ArgGroup::new("readings").args(["sheet", "print"]).multiple(true))]
pub struct OutputArgs {
    /// Steps that the angles of new postures are rounded to [deg]; 0 leaves them as they are
    #[arg(long, value_name = "DEG", default_value_t = 0.01, value_parser = angle_step())]
    pub angle_step_deg: f64,
    /// Write the postures to this file; with --curve the curve as CSV
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "plan.csv")]
    pub output: Option<String>,
    /// Write a sheet for the readings, pre-filled per posture, load state and point: CSV, or
    /// a workbook with a page to print where the name ends in .xlsx
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "measurements.xlsx", conflicts_with = "curve")]
    pub sheet: Option<String>,
    /// Write a page to print on A4: each posture with its angles, its picture and boxes to tick
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "plan.html", conflicts_with = "curve")]
    pub print: Option<String>,
    /// Draw the cell at the postures, the one with the least room in full
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "FILE.svg", conflicts_with = "curve")]
    pub figure: Option<String>,
    /// Load states of the sheet, in the order in which they are taken, for example
    /// preload,up-250,up-500,down-250; an unloaded state comes first [default: loaded]
    #[arg(
        long,
        value_name = "NAME,…",
        value_delimiter = ',',
        requires = "readings"
    )]
    pub states: Vec<String>,
    /// In the sheet, each posture ends unloaded once more, which shows the drift
    #[arg(long, requires = "readings")]
    pub drift: bool,
    /// In the sheet, a reflector on the robot's base is read in each state
    #[arg(long, requires = "readings")]
    pub base_reflector: bool,
    /// What the sheet is for [default: readings]
    #[arg(long, value_name = "KIND", requires = "readings")]
    pub sheet_of: Option<SheetChoice>,
    /// The page of the result.
    #[command(flatten)]
    pub page: PageArgs,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// What a sheet is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SheetChoice {
    /// Positions as the tracker gives them
    Readings,
    /// Differences that are calculated elsewhere
    Displacements,
}

/// A time above zero.
fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = above_zero("s")(text)?;
    Duration::try_from_secs_f64(seconds).map_err(|_| "the number is too large".to_string())
}

/// Two corners of a box; whether they are in order is for the library to say.
fn corners() -> impl Fn(&str) -> Result<[f64; 6], String> + Clone {
    let wanted = "six numbers are needed: x,y,z of the lowest corner, then x,y,z of the highest";
    numbers("mm", wanted)
}
