//! The page of `map --place`: where the workpiece should stand.

use super::at_work::{AtWork, WorkPoint, wrench};
use crate::placement_figure;
use crate::tell::Given;
use crate::tell::{Block, DataTable, Number, Section, Text, Told};
use stiffarm::Result;
use stiffarm::findings::visible;
use stiffarm::model::stiffness::Model;
use stiffarm::work::map::{Placed, Placement, PlacementCandidate, Status};

/// A gain from which on moving the workpiece is worth it.
const WORTH: f64 = 1.05;

/// The part of a page for a search of the best place.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    let placement: Placement = context.saved.result()?;
    let done = Text::new(format!(
        "{} places of the workpiece were tried for a path of ",
        placement.candidates.len()
    ))
    .number(context.number("/point_count").decimals(0))
    .words(" points under its loads.");
    let verdict = [done, came(context, &placement), next(&placement)];
    let sections = vec![
        cell_section(context, &placement)?,
        Section::new(
            "places",
            "The places",
            vec![
                Block::Figure(placement_figure(&placement)),
                Block::Table(counts(&placement)),
            ],
        ),
    ];
    let key = key(context, &placement);
    Ok(context.told(
        "Place of the workpiece".to_string(),
        verdict,
        Some(key),
        sections,
    ))
}

fn came(context: &Given<'_>, placement: &Placement) -> Text {
    let mm = |below: &str| context.number(below).mm().decimals(3);
    let Some(best) = &placement.best else {
        return Text::new("At none of them can the arm go along the whole path.");
    };
    let mut text = Text::new("At ");
    for (axis, name) in ["x = ", ", y = ", ", z = "].into_iter().enumerate() {
        let number = context
            .number(&format!("/best/position_m/{axis}"))
            .mm()
            .decimals(0);
        let number = if axis < 2 { number.bare() } else { number };
        text = text.words(name).number(number);
    }
    if best.yaw != 0.0 {
        let yaw = context.number("/best/yaw_deg").unit("°").significant(4);
        text = text.words(", turned by ").number(yaw).words(",");
    }
    text = text
        .words(" the path bends the tip by ")
        .number(mm("/best/deflection_rms_m"))
        .words(" (RMS), at most ")
        .number(mm("/best/deflection_max_m"));
    match (placement.gain, &placement.given.deflection_rms_m) {
        (Some(gain), Some(_)) if gain > 1.0 => text
            .words(", ")
            .number(context.number("/gain").decimals(2))
            .words(" times less than at the given place (")
            .number(mm("/given/deflection_rms_m"))
            .words(")."),
        (Some(_), Some(_)) => text
            .words("; no place is better than the given one (")
            .number(mm("/given/deflection_rms_m"))
            .words(")."),
        _ => text.words("; at the given place the arm cannot go along."),
    }
}

fn next(placement: &Placement) -> Text {
    let gain = placement.gain.unwrap_or(f64::INFINITY);
    match &placement.best {
        None => Text::new("Try a larger region or other turns: ")
            .code("--from-mm")
            .words(", ")
            .code("--to-mm")
            .words(" and ")
            .code("--yaw-deg 0,90,180,270")
            .words("."),
        Some(best) if gain >= WORTH => Text::new("Put ")
            .code(lines(best))
            .words(" into ")
            .code("[work]")
            .words(" of the cell, check fixture, cables and collisions there, and predict again."),
        Some(_) => Text::new("Leave the workpiece where it is; ")
            .code("stiffarm compensate")
            .words(" takes away what the tool bends there."),
    }
}

/// The place as a cell has it.
fn lines(best: &Placed) -> String {
    let list = |values: [f64; 3]| {
        let values = values.map(|v| ((v * 1e6).round() / 1e6 + 0.0).to_string());
        format!("[{}]", values.join(", "))
    };
    let rpy = best.roll_pitch_yaw.map(f64::to_degrees);
    format!(
        "workpiece_mm = {}, workpiece_rpy_deg = {}",
        list(best.position_m.map(|v| 1e3 * v)),
        list(rpy)
    )
}

fn key(context: &Given<'_>, placement: &Placement) -> DataTable {
    let headings = [
        "place",
        "x [mm]",
        "y [mm]",
        "z [mm]",
        "turned by [°]",
        "RMS [mm]",
        "largest [mm]",
        "at point",
    ];
    let mut table = DataTable::new("Deflection along the whole path", headings);
    let both = [
        ("given", Some(&placement.given)),
        ("best", placement.best.as_ref()),
    ];
    for (key, placed) in both {
        let Some(placed) = placed else { continue };
        let number = |below: &str| context.number(&format!("/{key}/{below}"));
        let mm =
            |below: &str, digits: usize| Text::from(number(below).mm().bare().decimals(digits));
        let point = match (&placed.deflection_max_point, placed.status) {
            (Some(point), _) => visible(point).into_owned(),
            (None, status) => status.describe().to_string(),
        };
        let cells = [
            mm("position_m/0", 1),
            mm("position_m/1", 1),
            mm("position_m/2", 1),
            number("yaw_deg").significant(4).into(),
            mm("deflection_rms_m", 3),
            mm("deflection_max_m", 3),
            point.into(),
        ];
        table.row(key, cells);
    }
    table
}

fn counts(placement: &Placement) -> DataTable {
    let mut table = DataTable::new(
        "Places that were tried, by what the arm may do there",
        ["status", "places", "one reason"],
    );
    let all = [
        Status::Reachable,
        Status::Forbidden,
        Status::OutsideJointLimits,
        Status::Unreachable,
        Status::Discontinuous,
    ];
    for status in all {
        let of: Vec<&PlacementCandidate> = placement
            .candidates
            .iter()
            .filter(|c| c.status == status)
            .collect();
        if of.is_empty() {
            continue;
        }
        let count = Number::new("", Some(of.len() as f64)).decimals(0);
        let reason = of.iter().find_map(|c| {
            let point = visible(c.point.as_deref()?);
            Some(format!(
                "at point {point}: {}",
                visible(c.reason.as_deref()?)
            ))
        });
        let name = match status {
            Status::Reachable => "the arm can go along",
            other => other.describe(),
        };
        table.row(name, [count.into(), reason.unwrap_or_default().into()]);
    }
    table
}

fn cell_section(context: &Given<'_>, placement: &Placement) -> Result<Section> {
    let points = |placed: &Placed| -> Vec<WorkPoint> {
        let points = placed.along.iter().map(|point| WorkPoint {
            name: point.point.clone(),
            q: point.q.clone(),
            tip_m: point.tip_m,
            wrench: wrench(point.force_n, point.moment_nm),
            shift_m: point.shift_m,
            principal: None,
        });
        points.collect()
    };
    let best = placement
        .best
        .as_ref()
        .map(|best| ("best place", points(best)));
    let given = ("given place", points(&placement.given));
    let groups = best.into_iter().chain([given]);
    let groups: Vec<(&str, Vec<WorkPoint>)> =
        groups.filter(|(_, points)| !points.is_empty()).collect();
    let path = groups.first().map(|(name, _)| *name);
    let work = AtWork {
        groups,
        stiffness: &placement.stiffness_nm_per_rad,
        model: Model::Equilibrium,
        at_tip: true,
        path,
        kept: Vec::new(),
    };
    work.section(
        context,
        "Step through the postures along the path at the best place, then at the given one; the path at the best place \
         has its deflection in colour.",
    )
}
