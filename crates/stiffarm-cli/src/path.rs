//! What predict and compensate share: a path, its loads and its postures.

use crate::args::PathArgs;
use crate::files::{Contents, Target, check_targets, ends_in, write_all};
use crate::numbers::significant;
use crate::progress::Progress;
use crate::session::Session;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::estimate::compliance::IdentifiedCompliance;
use stiffarm::files::source::{NamedPath, Source};
use stiffarm::files::table::PathTable;
use stiffarm::model::cell::Cell;
use stiffarm::model::inverse::InverseKinematics;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::path::LoadedPosture;
use stiffarm::model::process::{ForceAxes, TipLoad};
use stiffarm::units::{deg_to_rad, percent_to_fraction, rad_to_deg};
use stiffarm::work::posture_path::{Origin, PosturePathOptions, PosturePathSummary, posture_path};
use stiffarm::work::predict::LoadedArm;
use stiffarm::{Code, Error, Result};
use stiffarm_report::PathCurvePoint;

/// Turns about the tool axis that are tried where a path gives the axis alone.
const TURNS: usize = 72;

/// Options of the result that concern the path.
#[derive(Debug, Serialize, JsonSchema)]
pub struct PathOptions {
    /// Axes of the forces in the path and of the load below.
    pub axes: Option<ForceAxes>,
    /// Force where the path has none \[N\].
    pub force_n: Option<[f64; 3]>,
    /// Moment where the path has none \[N·m\].
    pub moment_nm: Option<[f64; 3]>,
    /// Standard uncertainty of the load \[%\].
    pub load_uncertainty_percent: f64,
    /// Posture to start near \[deg\].
    pub start_deg: Option<Vec<f64>>,
    /// Largest change of a joint from point to point \[deg\].
    pub max_step_deg: f64,
    /// Turns about the tool axis that were tried; `null` where it was not freed.
    pub free_turn: Option<u16>,
}

impl PathArgs {
    /// The options as the result holds them.
    pub fn described(&self) -> PathOptions {
        PathOptions {
            axes: self.axes.map(ForceAxes::from),
            force_n: self.force_n,
            moment_nm: self.moment_nm,
            load_uncertainty_percent: self.load_uncertainty_percent,
            start_deg: (!self.start_deg.is_empty()).then(|| self.start_deg.clone()),
            max_step_deg: self.max_step_deg,
            free_turn: self.free_turn,
        }
    }

    /// Relative standard uncertainty of the load.
    ///
    /// # Errors
    /// A negative number, or one that is not finite.
    pub fn load_uncertainty(&self) -> Result<f64> {
        let percent = self.load_uncertainty_percent;
        match percent.is_finite() && percent >= 0.0 {
            true => Ok(percent_to_fraction(percent)),
            false => Err(usage(
                "--load-uncertainty-percent",
                format!("The uncertainty must be 0 % or more, got {percent} %."),
            )),
        }
    }

    /// The load of the command line, if there is one.
    fn load(&self) -> Result<Option<TipLoad>> {
        let Some(force) = self.force_n else {
            return Ok(None);
        };
        let Some(axes) = self.axes else {
            let error = usage(
                "--force-n",
                "The axes of the force are not given.".to_string(),
            );
            return Err(error.hint("say its axes: --axes base, tool, workpiece or path"));
        };
        Ok(Some(TipLoad {
            force: force.into(),
            moment: self.moment_nm.unwrap_or_default().into(),
            axes: axes.into(),
        }))
    }

    /// Options of the search for postures; the load of the command line comes
    /// before that of the cell.
    ///
    /// # Errors
    /// Anything wrong with the numbers of the command line.
    pub fn posture_options(&self, cell: &Cell) -> Result<PosturePathOptions> {
        let joints = cell.setup.robot.joint_count();
        if !self.start_deg.is_empty()
            && (self.start_deg.len() != joints || self.start_deg.iter().any(|a| !a.is_finite()))
        {
            return Err(usage(
                "--start-deg",
                format!("The start needs {joints} angles in degrees, one per joint."),
            ));
        }
        if !(self.max_step_deg.is_finite() && self.max_step_deg > 0.0) {
            return Err(usage(
                "--max-step-deg",
                format!("The step must be above 0°, got {}°.", self.max_step_deg),
            ));
        }
        let process = match self.load()? {
            Some(load) => Some(load),
            None => cell.work.process.as_ref().map(|p| p.load()),
        };
        let start = self.start_deg.iter().copied().map(deg_to_rad).collect();
        Ok({
            let mut options = PosturePathOptions::default();
            options.start = (!self.start_deg.is_empty()).then_some(start);
            options.largest_step = deg_to_rad(self.max_step_deg);
            options.free_turn = self.free_turn.is_some();
            options.turns = self.free_turn.map_or(TURNS, usize::from);
            options.process = process;
            options.workpiece = cell.work.workpiece;
            options
        })
    }
}

fn usage(key: &str, message: String) -> Error {
    Error::new(Code::Usage, message).key(key)
}

/// A path with its postures.
pub struct Followed {
    /// The path as it was read.
    pub table: PathTable,
    /// Its name.
    pub name: String,
    /// Postures with their loads.
    pub postures: Vec<LoadedPosture>,
    /// How they were found.
    pub summary: PosturePathSummary,
}

impl Followed {
    /// Line about the path below those of cell and stiffness.
    pub fn line(&self) -> String {
        let count = match self.postures.len() {
            1 => "1 point".to_string(),
            count => format!("{count} points"),
        };
        let origin = match self.summary.origin {
            Origin::Given => "joint angles as given",
            Origin::ClosedForm => "postures by inverse kinematics in closed form",
            Origin::Numeric => "postures by inverse kinematics, iterated",
        };
        format!(
            "path: {} ({count}; {origin}, largest step of a joint {}°)\n",
            self.name,
            significant(rad_to_deg(self.summary.largest_step), 3)
        )
    }
}

impl Session {
    /// Reads a path and finds its postures.
    ///
    /// # Errors
    /// A file that cannot be read, anything wrong with its table, and what
    /// [`posture_path`] refuses.
    pub fn follow_path(
        &self,
        from: &str,
        cell: &Cell,
        predictor: &IdentifiedCompliance,
        args: &PathArgs,
        progress: &Progress,
    ) -> Result<Followed> {
        let options = args.posture_options(cell)?;
        let NamedPath { table, name } =
            self.read_path(from, cell, args.axes.map(ForceAxes::from))?;
        let arm = LoadedArm::new(cell, predictor)?;
        let inverse = InverseKinematics::new(&cell.setup.robot);
        let (postures, summary) = progress
            .watch(|control| posture_path(&arm, &inverse, &table.points, &options, control))
            .map_err(|e| match e.place().line {
                Some(_) => e.file(&name),
                None => e,
            })?;
        Ok(Followed {
            table,
            name,
            postures,
            summary,
        })
    }
}

/// The table and the picture of a command about a path.
pub struct Outputs {
    table: Option<Target>,
    figure: Option<Target>,
}

impl Outputs {
    /// Checks both places before any work.
    ///
    /// # Errors
    /// As [`Target::new`] and [`check_targets`].
    pub fn new(
        session: &Session,
        table: Option<&str>,
        figure: Option<&str>,
        force: bool,
    ) -> Result<Self> {
        let target = |path: Option<&str>| path.map(|path| Target::new(path, force)).transpose();
        let not_a_table = table.is_some_and(|path| ends_in(path, "json"));
        let (table, figure) = (target(table)?, target(figure)?);
        check_targets(session, &[table.as_ref(), figure.as_ref()])?;
        if not_a_table {
            let message = "This writes a table of the path (CSV), not JSON.";
            return Err(Error::new(Code::Usage, message)
                .key("--output")
                .hint("name it .csv; `--json > result.json` keeps the whole result"));
        }
        Ok(Outputs { table, figure })
    }

    /// Writes what was asked for; true where it went to standard output.
    ///
    /// # Errors
    /// A text that cannot be made, or a file that cannot be written.
    pub fn write<C: Contents>(
        self,
        session: &Session,
        table: impl FnOnce() -> Result<C>,
        figure: impl FnOnce() -> String,
    ) -> Result<bool> {
        let mut files: Vec<(Target, Box<dyn Contents>)> = Vec::new();
        if let Some(target) = self.table {
            files.push((target, Box::new(table()?)));
        }
        if let Some(target) = self.figure {
            files.push((target, Box::new(figure())));
        }
        write_all(session, &files)?;
        Ok(files.iter().any(|(target, _)| target.is_stdout()))
    }
}

/// The `count` largest, in the order of the path.
pub fn largest_first<P>(points: &[P], size: impl Fn(&P) -> f64, count: usize) -> Vec<&P> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| size(&points[*b]).total_cmp(&size(&points[*a])));
    order.truncate(count);
    order.sort_unstable();
    order.into_iter().map(|i| &points[i]).collect()
}

/// Values along the path for the figure.
pub fn curve(
    values: impl Iterator<Item = (f64, Option<f64>, Option<f64>)>,
    postures: &[LoadedPosture],
    cell: &Cell,
) -> Vec<PathCurvePoint> {
    let tip = cell.work.tip(&cell.setup.tool).translation.vector;
    let at = |posture: &LoadedPosture| Frames::new(&cell.setup.robot, &posture.q).point(&tip);
    let mut along = 0.0;
    let mut last = None;
    postures
        .iter()
        .zip(values)
        .map(|(posture, (deflection_m, half_width_m, left_m))| {
            let position = at(posture);
            along += last.map_or(0.0, |last: Vector3<f64>| (position - last).norm());
            last = Some(position);
            PathCurvePoint {
                along_m: along,
                deflection_m,
                half_width_m,
                left_m,
            }
        })
        .collect()
}
