//! How near a plan's postures come to shapes, beams and torques, and what each limit costs.

use super::job::{number, with_unit};
use crate::numbers::{coarse_mm, percent, significant};
use crate::table::{Align, Table, title};
use stiffarm::model::cell::{Cell, LimitKind};
use stiffarm::plan::feasibility::PostureLimits;
use stiffarm::plan::index::Index;
use stiffarm::plan::planned::Plan;
use stiffarm::plan::select::LimitPrice;
use stiffarm::units::{m_to_mm, rad_to_deg};

/// Nearest shapes, rope, beams, torque and displacement of each posture; nothing without a scene.
pub(super) fn nearest(cell: &Cell, names: &[String], limits: &[PostureLimits]) -> String {
    if cell.scene.is_empty() || limits.is_empty() {
        return String::new();
    }
    let has = |kind| limits.iter().any(|l| l.of(kind).is_some());
    let mut table = Table::new(["posture"]);
    for name in names {
        table.row([name.clone()]);
    }
    let mut add = |heading: &str, align: Align, of: &dyn Fn(&PostureLimits) -> String| {
        let texts: Vec<String> = limits.iter().map(of).collect();
        table.column(heading, align, texts.iter().map(String::as_str));
    };
    let length = |l: &PostureLimits, kind, kept: f64| match l.of(kind).and_then(|n| n.margin_m) {
        Some(margin) => coarse_mm(margin + kept),
        None => "-".to_string(),
    };
    if has(LimitKind::Shapes) {
        let kept = cell.scene.clearance();
        add("apart [mm]", Align::Right, &|l| {
            length(l, LimitKind::Shapes, kept)
        });
        add("nearest shapes", Align::Left, &|l| {
            l.of(LimitKind::Shapes)
                .map_or_else(String::new, |n| n.subject.clone())
        });
    }
    if has(LimitKind::RopeClearance) {
        let kept = cell
            .scene
            .rope()
            .and_then(|rope| rope.clearance)
            .unwrap_or(0.0);
        add(
            &format!("{} [mm]", cell.setup.load.line()),
            Align::Right,
            &|l| length(l, LimitKind::RopeClearance, kept),
        );
    }
    if limits.iter().any(|l| l.station.is_some()) {
        let all = cell.setup.tool.point_count();
        add("station", Align::Left, &|l| {
            l.station.clone().unwrap_or_default()
        });
        add("sees", Align::Left, &|l| match l.visible_points.len() {
            0 => "nothing".to_string(),
            count if count == all => "all points".to_string(),
            _ => l.visible_points.join(", "),
        });
    }
    if has(LimitKind::Incidence) {
        add("angle left [deg]", Align::Right, &|l| {
            let margin = l.of(LimitKind::Incidence).and_then(|n| n.margin_rad);
            margin.map_or_else(|| "-".to_string(), |m| significant(rad_to_deg(m), 2))
        });
    }
    if has(LimitKind::Torque) {
        add("torque [%]", Align::Right, &|l| {
            let margin = l.of(LimitKind::Torque).and_then(|n| n.margin_share);
            margin.map_or_else(|| "-".to_string(), |m| percent(1.0 - m))
        });
    }
    if limits.iter().any(|l| l.displacement_m.is_some()) {
        add("displacement [mm]", Align::Right, &|l| {
            l.displacement_m
                .map_or_else(|| "-".to_string(), |m| significant(m_to_mm(m), 3))
        });
    }
    let only_displacement = cell.scene.at_work().is_empty()
        && cell.scene.rope().is_none()
        && cell.scene.sight().is_none()
        && cell.scene.torque().is_none();
    let mut out = title(match only_displacement {
        true => "Displacement under the load",
        false => "Clear of shapes, beams and torques",
    });
    out += &table.to_string();
    let hidden = limits
        .iter()
        .any(|l| l.station.is_some() && l.visible_points.len() < cell.setup.tool.point_count());
    if hidden {
        out += "hidden points count in the index as if they were read: the plan is a little worse than it says\n";
    }
    out
}

/// What each kind of limit costs.
pub(super) fn prices(plan: &Plan) -> String {
    let Some(prices) = &plan.prices else {
        return String::new();
    };
    let index = plan.selection.index;
    let mut out = title("What each limit costs");
    out += &lines(index, plan.selection.value, prices);
    out
}

fn lines(index: Index, value: f64, prices: &[LimitPrice]) -> String {
    let heading = with_unit(index, index.as_str());
    let mut table = Table::new(["without".to_string(), heading, "cost [%]".to_string()]);
    let all = "nothing: all limits".to_string();
    table.row([all, number(index, Some(value)), String::new()]);
    for price in prices {
        table.row([
            price.kind.describe().to_string(),
            number(index, Some(price.value)),
            percent(price.price),
        ]);
    }
    let mut out = table.to_string();
    out += "each row is a search of its own; a difference of a few tenths of a per cent may be its luck; where it found nothing better, the plan itself counts\n";
    out
}
