//! All that `route` says of a plan: the order of its postures, the moves between them, and what to know before driving.

#[cfg(feature = "clap")]
use crate::ask::values::{angle_step, seed};
use crate::error::Result;
use crate::findings::{Finding, codes};
use crate::model::cell::{Cell, LimitKind};
use crate::model::posture::Posture;
use crate::numerics::control::Control;
use crate::plan::check::robot_doubts;
use crate::plan::feasibility::forbidden;
use crate::plan::route::{Route, RouteOptions, rounded, route, route_findings};
use serde::{Deserialize, Serialize};

/// How a plan is driven.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Options"))]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct DriveOptions {
    /// Keep the order of the plan
    #[cfg_attr(feature = "clap", arg(long))]
    pub keep_order: bool,
    /// Take equivalent postures where they are nearer: other turns, the wrist the other way round; a sheet
    /// written before then has other angles
    #[cfg_attr(feature = "clap", arg(long))]
    pub equivalents: bool,
    /// With --equivalents: other turns only. A wrist the other way round has the same joint axes, but an arm that gives
    /// way beyond them bends otherwise
    #[cfg_attr(feature = "clap", arg(long, requires = "equivalents"))]
    pub keep_wrist: bool,
    /// Steps that angles are rounded to [deg]; 0 leaves them as they are
    #[cfg_attr(feature = "clap", arg(long, value_name = "DEG", default_value_t = 0.01, value_parser = angle_step()))]
    pub angle_step_deg: f64,
    /// Seed of the random numbers, for ways around obstacles and for many postures
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", default_value_t = 1, value_parser = seed()))]
    pub seed: u64,
}

impl Default for DriveOptions {
    fn default() -> Self {
        DriveOptions { keep_order: false, equivalents: false, keep_wrist: false, angle_step_deg: 0.01, seed: 1 }
    }
}

/// The route with the names of its stops.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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

impl Routed {
    /// The route of a plan, and its stops under the names that their postures have there.
    ///
    /// # Errors
    /// Equivalents of an arm whose angles may be no controller's; as [`rounded`] and [`route`].
    pub fn new(
        cell: &Cell,
        plan: &[Posture],
        options: &DriveOptions,
        control: Control<'_>,
    ) -> Result<(Self, Vec<Posture>)> {
        let robot = &cell.setup.robot;
        if options.equivalents {
            robot.known_controller()?;
        }
        let step_deg = (options.angle_step_deg != 0.0).then_some(options.angle_step_deg);
        let driving = RouteOptions {
            keep_order: options.keep_order,
            keep_angles: !options.equivalents,
            keep_wrist: options.keep_wrist,
            step_deg,
            seed: options.seed,
        };
        let angles = plan.iter().map(|posture| {
            control.check()?;
            Ok(match step_deg {
                Some(step) => rounded(cell, std::slice::from_ref(posture), step)?.swap_remove(0),
                None => posture.q.clone(),
            })
        });
        let angles = angles.collect::<Result<Vec<Vec<f64>>>>()?;
        let route = route(cell, &angles, &driving, control)?;
        let stops = stops(plan, &route);
        let mut findings = not_allowed(cell, &stops)?;
        if options.equivalents {
            findings.extend(robot_doubts(robot));
        }
        findings.extend(remarks(cell, &stops, &route)?);
        let routed = Routed { posture_names: stops.iter().map(|stop| stop.name.clone()).collect(), route, findings };
        Ok((routed, stops))
    }
}

/// The stops under the names that their postures have in the plan.
fn stops(plan: &[Posture], route: &Route) -> Vec<Posture> {
    let stops = route.order.iter().zip(&route.postures);
    stops.map(|(at, q)| Posture { name: plan[*at].name.clone(), q: q.clone() }).collect()
}

/// Postures that the cell's bounds or limits forbid.
fn not_allowed(cell: &Cell, stops: &[Posture]) -> Result<Vec<Finding>> {
    let mut findings = Vec::new();
    for stop in stops {
        if let Some(why) = forbidden(cell, &stop.q)? {
            let subject = format!("posture {}", stop.name);
            let sentence = format!("posture {} {why}.", stop.name);
            findings.push(Finding::serious(codes::POSTURE_FORBIDDEN, subject, sentence));
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
            "the cell has no shapes, so nothing says whether the arm touches something on the way. Give \
             [[robot.shape]], [[tool.shape]] and [[obstacle]] (docs/shapes.md), or drive each move slowly the first \
             time.",
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
