//! `stiffarm route`: the order of a plan's postures, and the moves between them.

use super::{posture_table, wrapped_line};
use crate::args::RouteArgs;
use crate::files::{only_target, write_all};
use crate::input::Line;
use crate::numbers::{NONE, coarse_mm, deg};
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use crate::table::{Align, Table, title};
use serde::Serialize;
use stiffarm::Result;
use stiffarm::files::source::Source;
use stiffarm::files::table::write_postures;
use stiffarm::findings::{Finding, Severity};
use stiffarm::model::cell::{Cell, LimitKind};
use stiffarm::model::posture::Posture;
use stiffarm::plan::check::robot_doubts;
use stiffarm::plan::feasibility::forbidden;
use stiffarm::plan::route::{Route, RouteMove, RouteOptions, blocked_moves, rounded, route};
use stiffarm::units::rad_to_deg;

/// Options of the result.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// Whether the plan's order was kept.
    pub keep_order: bool,
    /// Whether equivalent postures could stand in.
    pub equivalents: bool,
    /// Steps that angles were rounded to \[deg\]; `null` where they were not.
    pub angle_step_deg: Option<f64>,
}

/// The route with the names of its stops.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Routed {
    /// Names of the stops.
    pub posture_names: Vec<String>,
    /// The route.
    #[serde(flatten)]
    pub route: Route,
    /// What to know before driving it.
    pub findings: Vec<Finding>,
}

/// Finds the route of a plan.
pub fn run(session: &Session, args: &RouteArgs) -> Result<Exit> {
    let target = only_target(session, args.output.as_deref(), args.force)?;
    let named = session.read_cell(&args.cell)?;
    let cell = &named.cell;
    if args.equivalents {
        cell.setup.robot.known_controller()?;
    }
    let plan = session.read_postures("plan", &args.plan, &cell.setup.robot)?;
    let step_deg = (args.angle_step_deg > 0.0).then_some(args.angle_step_deg);
    let mut options = RouteOptions::default();
    options.keep_order = args.keep_order;
    options.keep_angles = !args.equivalents;
    options.step_deg = step_deg;
    options.seed = args.seed;
    let progress = Progress::new(session, "finding the route");
    let found = progress.watch(|control| {
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
    drop(progress);
    let stops = stops(&plan, &found);
    if let Some(target) = target {
        write_all(session, &[(target, write_postures(&stops))])?;
    }
    let mut findings = not_allowed(cell, &stops)?;
    if args.equivalents {
        findings.extend(robot_doubts(&cell.setup.robot));
    }
    findings.extend(remarks(cell, &stops, &found));
    let result = Routed {
        posture_names: stops.iter().map(|stop| stop.name.clone()).collect(),
        route: found,
        findings,
    };
    let options = Options {
        keep_order: args.keep_order,
        equivalents: args.equivalents,
        angle_step_deg: step_deg,
    };
    let envelope = session.envelope("route", Some(args.seed), options, &result);
    session.show(&envelope, || {
        let mut out = named.line();
        for finding in &result.findings {
            out += &(wrapped_line(finding) + "\n");
        }
        out += &sentence(cell, &result.route);
        out += &title("Postures in this order");
        out += &posture_table(cell, &stops).to_string();
        out + &moves(&stops, &result.route)
    })?;
    let serious = |f: &Finding| f.severity == Severity::Serious;
    Ok(Exit::finding(result.findings.iter().any(serious)))
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
            findings.push(Finding::new(
                "posture-forbidden",
                Severity::Serious,
                subject,
                sentence,
            ));
        }
    }
    Ok(findings)
}

/// What to know before driving a route.
fn remarks(cell: &Cell, stops: &[Posture], route: &Route) -> Vec<Finding> {
    let mut findings = blocked_moves(stops, route);
    if !route.checked.contains(&LimitKind::Shapes) {
        findings.push(Finding::new(
            "moves-not-checked",
            Severity::Caution,
            "moves",
            "the cell has no shapes, so nothing says whether the arm touches something on the way. Give [[robot.shape]], \
             [[tool.shape]] and [[obstacle]] (docs/shapes.md), or drive each move slowly the first time.",
        ));
    }
    if cell.route.joint_speeds.is_none() {
        findings.push(Finding::new(
            "joint-speeds-unknown",
            Severity::Note,
            "route.joint_speeds_deg_s",
            "joint speeds are not known: all joints count as equally fast, and no time is given.",
        ));
    }
    findings
}

/// The route in a sentence or two.
pub(super) fn sentence(cell: &Cell, route: &Route) -> String {
    let moves = route.moves.len();
    if moves == 0 {
        return "route: a single posture\n".to_string();
    }
    let mut out = format!("route: {moves} moves");
    if moves == 1 {
        out = "route: 1 move".to_string();
    }
    if let Some(seconds) = route.travel_s {
        let percent = 100.0 * cell.route.speed_share;
        out += &format!(", {} at {percent} % of the joint speeds", duration(seconds));
    }
    out += &format!(", largest turns of {:.0}° in all", rad_to_deg(route.turn));
    out += match route.shortest {
        Some(true) => "; no order is shorter",
        Some(false) => "; the shortest order that was found",
        None => "; in the order given",
    };
    let via = route.moves.iter().filter(|m| !m.via.is_empty()).count();
    let blocked = route.moves.iter().filter(|m| !m.free).count();
    let kinds = kinds_in_words(&route.checked);
    if !kinds.is_empty() && blocked == 0 {
        out += &format!(
            "; every move is free, checked against {}",
            stiffarm::findings::list(&kinds)
        );
    }
    if !route.checked.contains(&LimitKind::Shapes) {
        out += "; the cell has no shapes, so nothing says what the arm may touch on the way";
    }
    match via {
        0 => {}
        1 => out += "; 1 move takes via postures",
        _ => out += &format!("; {via} moves take via postures"),
    }
    crate::screen::wrapped(&out, crate::screen::columns()) + "\n"
}

/// What moves are kept clear of, in words.
pub(super) fn kinds_in_words(checked: &[LimitKind]) -> Vec<&'static str> {
    let word = |kind: &LimitKind| match kind {
        LimitKind::Shapes => "shapes",
        LimitKind::Floor => "floor",
        LimitKind::KeepOut => "keep-out cylinder",
        LimitKind::ToolBox => "tool box",
        LimitKind::WristHeight => "lowest height of the wrist",
        LimitKind::RopeLength => "length of the rope",
        _ => "rope",
    };
    checked.iter().map(word).collect()
}

/// `4 min 10 s`.
fn duration(seconds: f64) -> String {
    let whole = seconds.round().max(1.0) as u64;
    match (whole / 60, whole % 60) {
        (0, s) => format!("{s} s"),
        (min, 0) => format!("{min} min"),
        (min, s) => format!("{min} min {s} s"),
    }
}

/// The moves, one row each.
fn moves(stops: &[Posture], route: &Route) -> String {
    let mut table = Table::new([
        "move",
        "turn [deg]",
        "time [s]",
        "via",
        "room [mm]",
        "between",
    ]);
    table.align(5, Align::Left);
    for each in &route.moves {
        let nearest = each.nearest.as_ref();
        table.row([
            each.name(stops),
            deg(each.turn),
            each.time_s.map_or(NONE.to_string(), |s| format!("{s:.1}")),
            match each.free {
                true => each.via.len().to_string(),
                false => "blocked".to_string(),
            },
            nearest.map_or(NONE.to_string(), |n| coarse_mm(n.distance_m)),
            nearest.map_or(String::new(), |n| n.subject.clone()),
        ]);
    }
    let mut out = title("Moves");
    out += &table.to_string();
    let vias: Vec<&RouteMove> = route.moves.iter().filter(|m| !m.via.is_empty()).collect();
    if vias.is_empty() {
        return out;
    }
    let joints = vias[0].via[0].len();
    let headings = (1..=joints).map(|j| format!("q{j} [deg]"));
    let mut table = Table::new(std::iter::once("move".to_string()).chain(headings));
    for each in vias {
        for via in &each.via {
            table.row(std::iter::once(each.name(stops)).chain(via.iter().map(|q| deg(*q))));
        }
    }
    out + &title("Via postures") + &table.to_string()
}
