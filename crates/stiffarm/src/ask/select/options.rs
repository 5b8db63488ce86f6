//! What `select` is asked.

use crate::ask::rules::{NotWith, changed_options, refuse};
#[cfg(feature = "clap")]
use crate::ask::values::{above_zero, angle_step, count, numbers, seed, within};
use crate::error::{Code, Error, Result};
use crate::model::posture::Posture;
use crate::plan::index::Index;
#[cfg(feature = "clap")]
use crate::plan::index::Origin;
use crate::plan::select::{Accept, GlobalOptions, LoadDesign, MOST_POSTURES};
use crate::units::mm_to_m;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Postures of a plan unless their number is given.
const POSTURES: usize = 6;
/// The same of the last group of a curve.
const LAST_OF_CURVE: usize = 12;
/// Seed unless one is given.
const SEED: u64 = 1;
/// Iterations from an initial group unless their number is given.
const MAX_ITERATIONS: u64 = 2000;

/// What is not asked beside what.
pub const NOT_WITH: NotWith = &[
    ("count", &["initial", "given"]),
    ("minutes", &["count", "initial", "given", "curve", "space_filling", "candidates", ANCHOR, LOADING_POINT, LARGEST]),
    ("repeats", &["initial", "space_filling", "candidates", "drop"]),
    ("curve", &["initial", "given", "sensitivity", ANCHOR, LOADING_POINT, LARGEST]),
    ("prices", &["initial", "curve"]),
    (
        "space_filling",
        &[
            "index",
            "curve",
            "sensitivity",
            "no_certificate",
            "initial",
            "given",
            "rounds",
            "time_limit",
            ANCHOR,
            LOADING_POINT,
            LARGEST,
        ],
    ),
    (
        "candidates",
        &[
            "space_filling",
            "curve",
            "sensitivity",
            "initial",
            "given",
            "rounds",
            "time_limit",
            ANCHOR,
            LOADING_POINT,
            LARGEST,
        ],
    ),
    ("initial", &["given", "seed", "rounds", "time_limit", "no_certificate", "accept", ANCHOR, LOADING_POINT, LARGEST]),
    ("given", &["sensitivity", ANCHOR, LOADING_POINT, LARGEST]),
    ("drop", &["add", "seed", "rounds", "time_limit", "no_certificate"]),
];

const ANCHOR: &str = "anchor_box_mm";
const LOADING_POINT: &str = "loading_point_box_mm";
const LARGEST: &str = "largest_load_n";

#[cfg(feature = "clap")]
const EXISTING: &str = "Postures that are there already";
#[cfg(feature = "clap")]
const BUDGET: &str = "How long to search (without these, until nothing improves)";
#[cfg(feature = "clap")]
const LOAD: &str = "Choosing the load together with the postures";

/// What `select` is asked, but for files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
#[non_exhaustive]
pub struct SelectOptions {
    /// Index to improve; `stiffarm evaluate` shows all of them
    /// [default: prediction, or expected-error where load parameters are chosen too]
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME", value_parser = Index::from_name, long_help = index_help()))]
    pub index: Option<Index>,
    /// Number of postures to select; with --curve the largest [default: 6, with --curve 12]
    #[cfg_attr(feature = "clap", arg(long, short = 'n', value_name = "N",
        value_parser = within::<usize>(1..=MOST_POSTURES as u64)))]
    pub count: Option<usize>,
    /// Time beside the robot instead of a number of postures, by [time] of the cell [min]
    ///
    /// Under prediction it also says which of the cell's loads each posture is measured under, and what the others, or
    /// a weight hung as well, give in the same time.
    #[cfg_attr(feature = "clap", arg(long, value_name = "MIN", value_parser = above_zero("min")))]
    pub minutes: Option<f64>,
    /// The index prediction may measure a posture again; without this no two postures of a plan are within 15° of each
    /// other in every joint
    #[cfg_attr(feature = "clap", arg(long))]
    pub repeats: bool,
    /// The best value for every number of postures up to --count, and what one more gains
    #[cfg_attr(feature = "clap", arg(long))]
    pub curve: bool,
    /// Also say whether another prior stiffness, or errors of postures and tool points, would change the plan
    #[cfg_attr(feature = "clap", arg(long))]
    pub sensitivity: bool,
    /// Also say what each kind of limit costs: the index of the best plan without it
    #[cfg_attr(feature = "clap", arg(long))]
    pub prices: bool,
    /// Do not compute how good any plan could be (for prediction, expected-error, d and task)
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_certificate: bool,
    /// Postures that cover the joint space evenly, without any index: a baseline to compare with
    #[cfg_attr(feature = "clap", arg(long))]
    pub space_filling: bool,
    /// Iterations of the optimiser from the initial group [default: 2000]
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", help_heading = EXISTING, requires = "initial",
        value_parser = within::<u64>(1..=u64::MAX)))]
    pub max_iterations: Option<u64>,
    /// Add the M postures that help most; --output and --sheet hold these alone, under new names [default: 1]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M", help_heading = EXISTING, requires = "given",
        value_parser = within::<usize>(1..=MOST_POSTURES as u64)))]
    pub add: Option<usize>,
    /// Leave out the K postures least worth their time; --output and --sheet hold those that stay [default: 1]
    #[cfg_attr(feature = "clap", arg(long, value_name = "K", help_heading = EXISTING, requires = "given",
        num_args = 0..=1, default_missing_value = "1", value_parser = count::<usize>()))]
    pub drop: Option<usize>,
    /// Exactly N rounds; they give the same result on any number of threads
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", help_heading = BUDGET, value_parser = count::<u64>()))]
    pub rounds: Option<u64>,
    /// End after the round in which this time is over (with --curve, for each number of postures)
    #[cfg_attr(feature = "clap", arg(long = "time-limit", id = "time_limit", value_name = "SECONDS",
        help_heading = BUDGET, value_parser = above_zero("s")))]
    pub time_limit_s: Option<f64>,
    /// Seed of the random numbers [default: 1]
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", help_heading = BUDGET, value_parser = seed()))]
    pub seed: Option<u64>,
    /// Box for the anchor of rope or cylinder: lowest, then highest corner, base axes [mm]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X,Y,Z,X,Y,Z", help_heading = LOAD, value_parser = corners(),
        allow_hyphen_values = true))]
    pub anchor_box_mm: Option<[f64; 6]>,
    /// Box for the loading point: lowest, then highest corner, flange axes [mm]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X,Y,Z,X,Y,Z", help_heading = LOAD, value_parser = corners(),
        allow_hyphen_values = true))]
    pub loading_point_box_mm: Option<[f64; 6]>,
    /// Largest force the rope, cylinder or weight may have, instead of the cell's [N]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X", help_heading = LOAD, value_parser = above_zero("n")))]
    pub largest_load_n: Option<f64>,
    /// Steps that the angles of new postures are rounded to [deg]; 0 leaves them as they are
    #[cfg_attr(feature = "clap", arg(long, value_name = "DEG", help_heading = "Output", default_value_t = 0.01,
        value_parser = angle_step()))]
    pub angle_step_deg: f64,
}

impl Default for SelectOptions {
    fn default() -> Self {
        SelectOptions {
            index: None,
            count: None,
            minutes: None,
            repeats: false,
            curve: false,
            sensitivity: false,
            prices: false,
            no_certificate: false,
            space_filling: false,
            max_iterations: None,
            add: None,
            drop: None,
            rounds: None,
            time_limit_s: None,
            seed: None,
            anchor_box_mm: None,
            loading_point_box_mm: None,
            largest_load_n: None,
            angle_step_deg: 0.01,
        }
    }
}

/// Postures that a plan starts from, and what the caller allows.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct SelectInputs {
    /// An initial group to improve locally, as in the paper, instead of a global search.
    pub initial: Option<Vec<Posture>>,
    /// Postures measured or planned already: they stay as they are and count too.
    pub given: Vec<Posture>,
    /// A constraint of the caller's own on the postures that are chosen, beside the cell's limits. The plan then keeps
    /// the angles that it accepted: no equivalents by other turns of the joints.
    pub accept: Option<Accept>,
}

impl SelectOptions {
    /// Refuses what would be asked for in vain.
    pub(super) fn check(&self, inputs: &SelectInputs) -> Result<()> {
        let mut names = changed_options(self)?;
        let there = [
            ("initial", inputs.initial.is_some()),
            ("given", !inputs.given.is_empty()),
            ("accept", inputs.accept.is_some()),
        ];
        names.extend(there.iter().filter(|input| input.1).map(|input| input.0.to_string()));
        refuse(NOT_WITH, &names)?;
        let (index, count) = (self.index(), self.postures(inputs));
        if !(1..=MOST_POSTURES).contains(&count) {
            let message = format!("A plan has 1 to {MOST_POSTURES} postures, not {count}.");
            return Err(Error::invalid(message).key("count"));
        }
        if !self.repeats || index == Index::Prediction {
            return Ok(());
        }
        let message = format!(
            "Under the index {} a plan may hold a posture twice in any case; only prediction keeps them apart.",
            index.as_str()
        );
        Err(Error::new(Code::Conflict, message).key("repeats").hint("leave it out"))
    }

    /// The index to improve: prediction counts one load, which is known.
    pub fn index(&self) -> Index {
        self.index.unwrap_or(match self.load().is_empty() {
            true => Index::Prediction,
            false => Index::ExpectedError,
        })
    }

    /// Number of postures to choose; beside given ones that of new ones.
    pub(super) fn postures(&self, inputs: &SelectInputs) -> usize {
        let (count, otherwise) = match (inputs.given.is_empty(), self.curve) {
            (false, _) => (self.add, 1),
            (true, true) => (self.count, LAST_OF_CURVE),
            (true, false) => (self.count, POSTURES),
        };
        count.unwrap_or(otherwise)
    }

    /// Seed of the random numbers.
    pub(super) fn seed(&self) -> u64 {
        self.seed.unwrap_or(SEED)
    }

    /// Iterations of the optimiser from an initial group.
    pub(super) fn max_iterations(&self) -> u64 {
        self.max_iterations.unwrap_or(MAX_ITERATIONS)
    }

    /// Steps that angles are rounded to \[deg\], where they are.
    pub(super) fn angle_step(&self) -> Option<f64> {
        (self.angle_step_deg != 0.0).then_some(self.angle_step_deg)
    }

    /// What of the load is chosen together with the postures.
    pub(super) fn load(&self) -> LoadDesign {
        let corners = |all: [f64; 6]| {
            let m = all.map(mm_to_m);
            [[m[0], m[1], m[2]].into(), [m[3], m[4], m[5]].into()]
        };
        LoadDesign {
            anchor: self.anchor_box_mm.map(corners),
            loading_point: self.loading_point_box_mm.map(corners),
            magnitude: self.largest_load_n,
        }
    }

    /// What the global search may use and how long it may go on.
    pub(super) fn global(&self, inputs: &SelectInputs) -> GlobalOptions {
        GlobalOptions {
            seed: self.seed(),
            rounds: self.rounds,
            // More seconds than a time can have are no limit.
            time_limit: self.time_limit_s.map(|s| Duration::try_from_secs_f64(s).unwrap_or(Duration::MAX)),
            load: self.load(),
            accept: inputs.accept.clone(),
            repeats: self.repeats,
            given: inputs.given.iter().map(|p| p.q.clone()).collect(),
        }
    }
}

/// The comment of `index`, with the names that there are.
#[cfg(feature = "clap")]
fn index_help() -> String {
    let of = |origin: Origin| {
        let all = Index::ALL.into_iter().filter(|index| index.origin() == origin);
        let names: Vec<String> = all.map(|index| index.as_str().replace('_', "-")).collect();
        names.join(", ")
    };
    format!(
        "Index to improve; `stiffarm evaluate` shows all of them [default: prediction, or expected-error where load \
         parameters are chosen too]\n\n{}; of the paper: {}; of the literature: {}.",
        of(Origin::Here),
        of(Origin::Paper),
        of(Origin::Literature)
    )
}

/// Two corners of a box; whether they are in order is for the design to say.
#[cfg(feature = "clap")]
fn corners() -> impl Fn(&str) -> std::result::Result<[f64; 6], String> + Clone {
    let wanted = "six numbers are needed: x,y,z of the lowest corner, then x,y,z of the highest";
    numbers("mm", wanted)
}
