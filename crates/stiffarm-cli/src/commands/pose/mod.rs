//! `stiffarm pose`: poses as pendants show them, and the postures of a pose.

mod table;

use crate::answer::Answer;
use crate::args;
use crate::files::{Files, only_target};
use crate::output::Exit;
use crate::session::Session;
use crate::target::Target;
use serde::Serialize;
use stiffarm::ask::pose::PoseKind;
use stiffarm::model::cell::Cell;
use stiffarm::{Code, Error, Result};
use stiffarm_files::source::{NamedCell, Source, read_postures};
use stiffarm_files::table::{read_poses, write_poses, write_postures};

/// What both ways need.
struct Job<'a> {
    session: &'a Session,
    args: &'a args::Pose,
    named: NamedCell,
    request: PoseKind,
}

/// Poses of postures, or postures of poses.
pub fn run(session: &Session, args: &args::Pose) -> Result<Answer> {
    let named = session.read_cell(&args.cell)?;
    let request = args.options.of(&named.cell)?;
    let job = Job { session, args, named, request };
    match (&args.poses, &args.postures) {
        (Some(from), _) => job.postures_of(from),
        (None, Some(postures)) => job.poses_of(postures),
        (None, None) => Err(Error::new(Code::Usage, "Neither postures nor poses are given.")),
    }
}

impl Job<'_> {
    fn cell(&self) -> &Cell {
        &self.named.cell
    }

    fn poses_of(&self, from: &str) -> Result<Answer> {
        let (session, cell) = (self.session, self.cell());
        let postures = read_postures(session, "postures", from, &cell.setup.robot)?;
        let target = only_target(session, self.args.output.as_deref(), self.args.force)?;
        let result = self.request.poses_of(cell, &postures);
        let text = || {
            let written = self.request.named_poses(cell, &postures);
            write_poses(&written, self.request.convention)
        };
        let table = self.table_of_poses(&result);
        Ok(self.answer(Exit::Done, target, text, result, table))
    }

    fn postures_of(&self, from: &str) -> Result<Answer> {
        let (session, cell) = (self.session, self.cell());
        let (file, bytes) = session.read("poses", from)?;
        let poses = read_poses(&bytes, &file, self.request.convention)?;
        let target = only_target(session, self.args.output.as_deref(), self.args.force)?;
        let (result, all) = self.request.postures_of(cell, &poses)?;
        let exit = Exit::finding(result.poses.iter().any(|pose| pose.postures.is_empty()));
        let text = || write_postures(&all);
        let table = self.table_of_postures(&result);
        Ok(self.answer(exit, target, text, result, table))
    }

    /// The result, with the file that was asked for.
    fn answer<R: Serialize + 'static>(
        &self,
        exit: Exit,
        target: Option<Target>,
        text: impl FnOnce() -> String,
        result: R,
        table: String,
    ) -> Answer {
        let options = self.request.options();
        let envelope = self.session.envelope("pose", None, options, result);
        let file = target.map(|target| Files::one(target, text()));
        Answer::table(exit, envelope, table).with(file)
    }
}
