//! `stiffarm zones`: maps of dexterity and of the influence of K_C.

use crate::answer::Answer;
use crate::args;
use crate::files::{Files, Said, check_folder, shown};
use crate::output::Exit;
use crate::progress::{Progress, announce};
use crate::session::Session;
use stiffarm::Result;
use stiffarm::plan::characteristic_length::with_length;
use stiffarm::plan::zones::zones;
use stiffarm_report::{render_svg, zones_figure, zones_table};

/// Files of the folder.
const FILES: [&str; 2] = ["zones.svg", "zones.csv"];

/// From so many postures on, their number is said before.
const MANY: usize = 100_000;

/// Maps the zones.
pub fn run(session: &Session, args: &args::Zones) -> Result<Answer> {
    let named = session.read_cell(&args.cell)?;
    if let Some(folder) = &args.output_dir {
        check_folder(session, folder, FILES, args.force)?;
    }
    let (cell, _) = with_length(named.cell.clone());
    let options = args.options.options();
    announce(session, options.steps.saturating_mul(options.steps), MANY, "postures to look at");
    let result = Progress::new(session, "mapping zones").watch(|control| zones(&cell, &options, control))?;
    let envelope = session.envelope("zones", None, args.options.in_cell(&cell), result);
    let pictures = args.output_dir.as_ref().map(|folder| {
        let result = &envelope.result;
        let texts = [render_svg(&zones_figure(result)), zones_table(result).csv()];
        let files = FILES.map(String::from).into_iter().zip(texts);
        let said = format!("{} to {}", FILES.join(" and "), shown(folder));
        Files::folder(folder, files, args.force).said(Said::As(said))
    });
    Ok(Answer::summary(Exit::Done, envelope, named, false).with(pictures))
}
