//! `stiffarm register`: the transform from tracker to base axes.

use crate::answer::Answer;
use crate::args;
use crate::files::only_target;
use crate::output::Exit;
use crate::session::Session;
use stiffarm::Result;
use stiffarm::measure::registration::RegistrationRecord;
use stiffarm_files::source::Source;
use stiffarm_files::table::read_pairs;

/// Registers tracker to base.
pub fn run(session: &Session, args: &args::Register) -> Result<Answer> {
    let target = only_target(session, args.output.as_deref(), args.force)?;
    let (file, bytes) = session.read("pairs", &args.pairs)?;
    let options = &args.options;
    let pairs = options.kept(read_pairs(&bytes, &file)?)?;
    let registration = options.register(&pairs).map_err(|e| e.file(&file))?;

    let exit = Exit::finding(registration.is_serious());
    let record = RegistrationRecord::from(&registration);
    let envelope = session.envelope("register", None, options.clone(), record);
    Answer::summary(exit, envelope, None, args.details).with_object(target)
}
