//! `stiffarm route`: the order of a plan's postures, and the moves between them.

use crate::answer::Answer;
use crate::args::RouteArgs;
use crate::files::{Files, only_target};
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use stiffarm::Result;
use stiffarm::findings::{Finding, codes};
use stiffarm::model::cell::{Cell, LimitKind};
use stiffarm::model::posture::Posture;
use stiffarm::plan::check::robot_doubts;
use stiffarm::plan::feasibility::forbidden;
use stiffarm::plan::route::routed::{Options, Routed};
use stiffarm::plan::route::{Route, RouteOptions, rounded, route, route_findings};
use stiffarm_files::source::read_postures;
use stiffarm_files::table::write_postures;

/// Finds the route of a plan.
pub fn run(session: &Session, args: &RouteArgs) -> Result<Answer> {
    let target = only_target(session, args.output.as_deref(), args.force)?;
    let named = session.read_cell(&args.cell)?;
    let cell = &named.cell;
    if args.equivalents {
        cell.setup.robot.known_controller()?;
    }
    let plan = read_postures(session, "plan", &args.plan, &cell.setup.robot)?;
    let step_deg = (args.angle_step_deg > 0.0).then_some(args.angle_step_deg);
    let mut options = RouteOptions::default();
    options.keep_order = args.keep_order;
    options.keep_angles = !args.equivalents;
    options.keep_wrist = args.keep_wrist;
    options.step_deg = step_deg;
    options.seed = args.seed;
    let found = Progress::new(session, "finding the route").watch(|control| {
        let angles: Vec<Vec<f64>> = match step_deg {
            Some(step) => {
                let each = plan.iter().map(|posture| {
                    control.check()?;
                    rounded(cell, std::slice::from_ref(posture), step)
                });
                each.collect::<Result<Vec<_>>>()?.concat()
            }
            None => plan.iter().map(|posture| posture.q.clone()).collect(),
        };
        route(cell, &angles, &options, control)
    })?;
    let stops = stops(&plan, &found);
    let table = target.map(|target| Files::one(target, write_postures(&stops)));
    let mut findings = not_allowed(cell, &stops)?;
    if args.equivalents {
        findings.extend(robot_doubts(&cell.setup.robot));
    }
    findings.extend(remarks(cell, &stops, &found)?);
    let result = Routed {
        posture_names: stops.iter().map(|stop| stop.name.clone()).collect(),
        route: found,
        findings,
    };
    let options = Options {
        keep_order: args.keep_order,
        equivalents: args.equivalents,
        keep_wrist: args.keep_wrist,
        angle_step_deg: step_deg,
    };
    let exit = Exit::of_findings(&result.findings);
    let envelope = session.envelope("route", Some(args.seed), options, result);
    Ok(Answer::told(exit, envelope, named, args.details).with(table))
}

/// The stops under the names that their postures have in the plan.
fn stops(plan: &[Posture], route: &Route) -> Vec<Posture> {
    let stops = route.order.iter().zip(&route.postures);
    stops
        .map(|(at, q)| Posture {
            name: plan[*at].name.clone(),
            q: q.clone(),
        })
        .collect()
}

/// Postures that the cell's bounds or limits forbid.
fn not_allowed(cell: &Cell, stops: &[Posture]) -> Result<Vec<Finding>> {
    let mut findings = Vec::new();
    for stop in stops {
        if let Some(why) = forbidden(cell, &stop.q)? {
            let subject = format!("posture {}", stop.name);
            let sentence = format!("posture {} {why}.", stop.name);
            findings.push(Finding::serious(
                codes::POSTURE_FORBIDDEN,
                subject,
                sentence,
            ));
        }
    }
    Ok(findings)
}

/// What to know before driving a route.
fn remarks(cell: &Cell, stops: &[Posture], route: &Route) -> Result<Vec<Finding>> {
    let mut findings = route_findings(cell, stops, route)?;
    if !route.checked.contains(&LimitKind::Shapes) {
        findings.push(Finding::caution(
            codes::MOVES_NOT_CHECKED,
            "moves",
            "the cell has no shapes, so nothing says whether the arm touches something on the way. Give [[robot.shape]], \
             [[tool.shape]] and [[obstacle]] (docs/shapes.md), or drive each move slowly the first time.",
        ));
    }
    if cell.route.joint_speeds.is_none() {
        findings.push(Finding::note(
            "joint-speeds-unknown",
            "route.joint_speeds_deg_s",
            "joint speeds are not known: all joints count as equally fast, and no time is given.",
        ));
    }
    Ok(findings)
}
