//! The ends of the helps. Run top to bottom, each command finds the files
//! that the ones before it wrote.

pub const STUDY: &str = "Examples:
  $ stiffarm study --runs 20 --starts 2 --output-dir quick-study";
pub const INIT: &str = "Examples:
  $ stiffarm init
  $ stiffarm init --robot fanuc-r2000ic-165f --output-dir my-cell";
pub const CHECK: &str = "Examples:
  $ stiffarm check
  $ stiffarm check cell.toml";
pub const SELECT: &str = "Examples:
  Six postures, the best of four random starts, and a sheet for the readings:
  $ stiffarm select cell.toml --starts 4 --output plan.csv --sheet readings.csv

  As in the paper, from an initial group under the novel index:
  $ stiffarm select builtin:comau --index novel --from builtin:comau-group1 --output group3.csv";
pub const EVALUATE: &str = "Examples:
  $ stiffarm evaluate builtin:comau builtin:comau-group1 group3.csv plan.csv
  $ stiffarm evaluate builtin:comau plan.csv --json";
pub const SIMULATE: &str = "Examples:
  $ stiffarm simulate builtin:comau builtin:comau-group1 plan.csv --levels 1,2
  $ stiffarm simulate builtin:comau plan.csv --runs 50 --measurements simulated.csv";
pub const IDENTIFY: &str = "Examples:
  $ stiffarm identify builtin:comau simulated.csv
  $ stiffarm identify builtin:comau simulated.csv --exclude 6 --noise known --output stiffness.json";
pub const VALIDATE: &str = "Examples:
  $ stiffarm validate builtin:comau stiffness.json simulated.csv --only 6
  $ stiffarm validate builtin:comau stiffness.json simulated.csv --model equilibrium --tolerance-mm 0.1";
pub const ROBOTS: &str = "Examples:
  $ stiffarm robots
  $ stiffarm robots comau-nj165-3.0";
pub const SCHEMA: &str = "Examples:
  $ stiffarm schema cell
  $ stiffarm schema result-identify";
pub const COMPLETIONS: &str = "Examples:
  $ stiffarm completions bash";
pub const MAN: &str = "Examples:
  $ stiffarm man
  $ stiffarm man --output-dir man";
pub const DOCS: &str = "Examples:
  $ stiffarm docs errors
  $ stiffarm docs commands";
