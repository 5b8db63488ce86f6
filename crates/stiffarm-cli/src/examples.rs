//! The ends of the helps. Run top to bottom, each command finds the files that
//! the ones before it wrote. No line is wider than a terminal of 80 columns,
//! where it would be broken in two.

pub const STUDY: &str = "Examples:
  $ stiffarm study --runs 20 --initial-groups 2 --output-dir quick-study";
pub const INIT: &str = "Examples:
  $ stiffarm init
  $ stiffarm init --robot fanuc-r2000ic165f --output-dir my-cell";
pub const CHECK: &str = "Examples:
  $ stiffarm check
  $ stiffarm check cell.toml

  The cell as a picture; the same at postures of a plan:
  $ stiffarm check cell.toml --figure cell.svg
  $ stiffarm check builtin:comau --postures builtin:comau-group1 --posture 3 \\
      --figure group1.svg";
pub const SELECT: &str = "Examples:
  Six postures and a sheet for the readings; a plan to keep takes no --rounds:
  $ stiffarm select cell.toml --rounds 4 --output plan.csv --sheet readings.csv

  The plan as a picture of the cell at its postures:
  $ stiffarm select cell.toml -n 3 --rounds 1 --no-certificate --figure plan.svg

  The next best posture beside those of a plan, and the one least worth its time:
  $ stiffarm select cell.toml --given plan.csv --add 1 --output next.csv
  $ stiffarm select cell.toml --given plan.csv --drop

  How many postures, and whether wrong assumptions would change the plan:
  $ stiffarm select cell.toml --curve -n 4 --rounds 2 --output curve.csv
  $ stiffarm select cell.toml -n 3 --rounds 1 --sensitivity --no-certificate

  The anchor within 400 x 400 mm on the floor, together with the postures:
  $ stiffarm select cell.toml --rounds 1 --anchor-box-mm 1600,-200,0,2000,200,0

  Postures that cover the joint space evenly, as a baseline:
  $ stiffarm select cell.toml --space-filling -n 15

  As in the paper, from an initial group under the novel index:
  $ stiffarm select builtin:comau --index novel --initial builtin:comau-group1";
pub const ROUTE: &str = "Examples:
  The order to drive in, with the moves between the postures:
  $ stiffarm route cell.toml plan.csv --output driven.csv

  The plan as it stands, each move checked:
  $ stiffarm route builtin:comau builtin:comau-group1 --keep-order";
pub const EVALUATE: &str = "Examples:
  $ stiffarm evaluate builtin:comau builtin:comau-group1 plan.csv
  $ stiffarm evaluate builtin:comau plan.csv --json";
pub const SIMULATE: &str = "Examples:
  $ stiffarm simulate builtin:comau plan.csv --levels 1,2 --runs 500
  $ stiffarm simulate builtin:comau plan.csv --measurements simulated.csv

  Raw tracker readings of a whole experiment, to try identify on:
  $ stiffarm simulate builtin:comau plan.csv --readings tracked.csv

  An arm that gives way beyond its joint axes, and what the mixed model gains:
  $ stiffarm simulate builtin:comau plan.csv --elastic mixed --runs 20";
pub const MEASURE: &str = "Examples:
  What the readings so far are worth, and what to measure next:
  $ stiffarm measure builtin:comau plan.csv tracked.csv --once --until 10%

  Beside the robot, each posture as it arrives (Ctrl-C ends; start again to go on):
  stiffarm measure cell.toml plan.csv readings.csv --until 3%

  A rehearsal, in two terminals:
  stiffarm simulate builtin:comau plan.csv --readings day.csv --slowly 2
  stiffarm measure builtin:comau plan.csv day.csv --until 3%";
pub const COVERAGE: &str = "\
Examples:
  How often do the intervals of six postures hold the truth?
  $ stiffarm coverage builtin:comau builtin:comau-group1 --runs 1000";

pub const REGISTER: &str = "Examples:
  $ stiffarm register builtin:example-pairs --output registration.json
  $ stiffarm register builtin:example-pairs --exclude B --std-mm 0.03";
pub const IDENTIFY: &str = "Examples:
  Raw readings, or displacements:
  $ stiffarm identify builtin:comau tracked.csv
  $ stiffarm identify builtin:comau simulated.csv --estimator weighted

  For validate, without one posture; with a tilting elbow; robust:
  $ stiffarm identify builtin:comau simulated.csv --exclude 6 --output k.json
  $ stiffarm identify builtin:comau tracked.csv --extra tilt3 --bootstrap 300
  $ stiffarm identify builtin:comau tracked.csv --estimator huber --brief

  The paper's model, in which nothing but the joint axes gives way:
  $ stiffarm identify builtin:comau simulated.csv --elastic axes";
pub const VALIDATE: &str = "Examples:
  $ stiffarm validate builtin:comau k.json simulated.csv --only 6
  $ stiffarm validate builtin:comau k.json simulated.csv --tolerance-mm 0.1

  Each posture predicted by the others, without a saved stiffness:
  $ stiffarm validate builtin:comau tracked.csv --folds all";
pub const PREDICT: &str = "Examples:
  At the tasks of the cell, and round a contour with the cell's milling force:
  $ stiffarm predict builtin:comau k.json --matrix
  $ stiffarm predict builtin:comau k.json builtin:contour --figure bend.svg

  The turn about the tool axis free, for the postures that bend least:
  $ stiffarm predict builtin:comau k.json builtin:contour --free-turn=24

  A load known to 10 %, and all points as a table; a force in the feed:
  $ stiffarm predict builtin:comau k.json builtin:contour --output bend.csv \\
      --load-uncertainty-percent 10
  $ stiffarm predict builtin:comau k.json builtin:contour --axes path \\
      --force-n -300,100,0

  Under the load of the identification, at its postures:
  $ stiffarm predict builtin:comau k.json plan.csv --cell-load";
pub const COMPENSATE: &str = "Examples:
  The path to command, in the columns of the path or as joint angles:
  $ stiffarm compensate builtin:comau k.json builtin:contour --output go.csv
  $ stiffarm compensate builtin:comau k.json builtin:contour --free-turn=24 \\
      --output angles.csv --write angles --figure compensated.svg";
pub const MAP: &str = "Examples:
  A plane, the tool down, with picture and table:
  $ stiffarm map builtin:comau k.json --plane z=800 --output-dir map

  The turn about the tool axis free; a milling force; six planes of a box:
  $ stiffarm map builtin:comau k.json --plane z=800 --steps 15 --free-turn=8
  $ stiffarm map builtin:comau k.json --plane x=1800 --force-n 200,-300,100
  $ stiffarm map builtin:comau prior --steps 9,9,6

  The best place for the workpiece of a path:
  $ stiffarm map builtin:comau k.json --place builtin:contour --steps 9";
pub const ZONES: &str = "Examples:
  $ stiffarm zones
  $ stiffarm zones builtin:comau-reference --steps 61 --output-dir zones";
pub const POSE: &str = "Examples:
  What the pendant should show at each posture; the same as a table:
  $ stiffarm pose builtin:comau builtin:comau-group1
  $ stiffarm pose builtin:comau plan.csv --convention kuka --output poses.csv

  All postures that hold the poses, full turns included:
  $ stiffarm pose builtin:comau --poses poses.csv --convention kuka \\
      --output all.csv";
pub const EXPORT: &str = "Examples:
  The plan for the cell's COMAU arm, as a table:
  $ stiffarm export builtin:comau plan.csv --language pdl2 \\
      --speed-percent 20 --output-dir program
  $ stiffarm export builtin:comau plan.csv --language csv --output-dir program

  Is the program on the controller still the plan?
  $ stiffarm export builtin:comau plan.csv --language pdl2 \\
      --speed-percent 20 --compare program/measure_plan.pdl

  The controller is another maker's and shows these very angles; a Yaskawa job
  holds pulses, which are counted at the robot:
  $ stiffarm export builtin:comau plan.csv --language rapid --controller abb \\
      --tool spindle --output-dir program
  $ stiffarm export builtin:comau plan.csv --language inform \\
      --controller yaskawa \\
      --pulses-per-degree 1341.4,1341.4,1341.4,1000,1000,622.2 \\
      --output-dir program";
pub const CAPSULES: &str = "Examples:
  How many capsules, how large; then as tables of the tool for cell.toml:
  $ stiffarm capsules builtin:spindle.obj --unit mm
  $ stiffarm capsules builtin:spindle.obj --unit mm --most 3 --tool

  Of what is mounted on link 3, in the frame that row 3 ends in:
  $ stiffarm capsules builtin:spindle.obj --unit mm --link 3";
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

pub const REPORT: &str = "Examples:
  A page of one result, and of two side by side:
  $ stiffarm report k.json
  $ stiffarm report k.json k.json --output both.html

  With the cell that it was made with, where that is not a built-in one:
  $ stiffarm report k.json --cell builtin:comau --output again.html --force

  Its pictures for a paper, with their data:
  $ stiffarm report k.json --figures figures --width-mm 88 --format svg";
