//! What `map --place` says: where the workpiece should stand.

use super::at_work::{AtWork, WorkPoint, wrench};
use super::points::{position, region};
use crate::placement_figure;
use crate::summary::{
    Block, Context, DataTable, Form, Number, Quantity, Section, Summarise, Summary, Text, with_stopped,
};
use stiffarm::Result;
use stiffarm::ask::place::Options;
use stiffarm::findings::visible;
use stiffarm::model::stiffness::Model;
use stiffarm::units::rounded;
use stiffarm::work::map::{PlaceEvaluation, Placement, PlacementCandidate, Status};

/// A gain from which on moving the workpiece is worth it.
const WORTH: f64 = 1.05;

/// Turn of the workpiece, from degrees.
const TURN: Quantity = Quantity::new("°", 1.0, Form::Significant(4));

impl Summarise<Options> for Placement {
    fn summary(&self, options: &Options, context: &Context<'_>) -> Result<Summary> {
        let placement = self;
        let verdict = [what_was_done(options, placement), conclusion(placement), next_step(placement)];
        let mut sections = Vec::new();
        let mut places = Vec::new();
        if context.pictures {
            sections.push(cell_section(context, placement)?);
            places.push(Block::Figure(placement_figure(placement)));
        }
        sections.extend(placement.best.as_ref().map(lines));
        places.push(Block::Table(counts(placement)));
        sections.push(Section::new("places", "The places", places));
        let key = key(placement);
        let findings = placement.findings.clone();
        Ok(context.summary(
            with_stopped(context, findings, placement.interrupted, &[]),
            "Place of the workpiece",
            verdict,
            Some(key),
            sections,
        ))
    }
}

fn what_was_done(options: &Options, placement: &Placement) -> Text {
    let ends = [0, 1, 2].map(|axis| [options.lower_m[axis], options.upper_m[axis]]);
    let within = format!(" in {}", region(ends));
    let is_works = |c: &&PlacementCandidate| c.status == Status::Reachable;
    let works = placement.candidates.iter().filter(is_works).count();
    let text =
        Text::new(format!("{} places of the workpiece{within} were tried for a path of ", placement.candidates.len()))
            .number(Number::count(placement.point_count))
            .words(" points under its loads");
    let text = if placement.searched_points < placement.point_count {
        text.words(", of which ").number(Number::count(placement.searched_points)).words(" were looked at")
    } else {
        text
    };
    text.words(format!("; at {works} of them the arm can go along."))
}

fn conclusion(placement: &Placement) -> Text {
    let mm = |length: Option<f64>| Number::new(length).of(Quantity::LENGTH);
    let Some(best) = &placement.best else {
        return Text::new("At none of them can the arm go along the whole path.");
    };
    let place = position(best.position_m);
    let mut text = Text::new("At ").then(place);
    if best.yaw != 0.0 {
        let yaw = Number::degrees(best.yaw).of(TURN);
        text = text.words(", turned by ").number(yaw).words(",");
    }
    text = text
        .words(" the path bends the tip by ")
        .number(mm(best.deflection_rms_m))
        .words(" (RMS), at most ")
        .number(mm(best.deflection_max_m));
    match (placement.gain, &placement.given.deflection_rms_m) {
        (Some(gain), Some(_)) if gain > 1.0 => text
            .words(", ")
            .number(Number::new(gain).decimals(2))
            .words(" times less than at the given place (")
            .number(mm(placement.given.deflection_rms_m))
            .words(")."),
        (Some(_), Some(_)) => text
            .words("; no place is better than the given one (")
            .number(mm(placement.given.deflection_rms_m))
            .words(")."),
        _ => text.words("; at the given place the arm cannot go along."),
    }
}

fn next_step(placement: &Placement) -> Text {
    let gain = placement.gain.unwrap_or(f64::INFINITY);
    match &placement.best {
        None => Text::new("Try a larger region or other turns: ")
            .code("--from-mm")
            .words(", ")
            .code("--to-mm")
            .words(" and ")
            .code("--yaw-deg 0,90,180,270")
            .words("."),
        Some(_) if gain >= WORTH => Text::new("Put the best place into ")
            .code("[work]")
            .words(" of the cell, check fixture, cables and collisions there, and predict again."),
        Some(_) => Text::new("Leave the workpiece where it is; ")
            .code("stiffarm compensate")
            .words(" takes away what the tool bends there."),
    }
}

/// The best place as a cell has it.
fn lines(best: &PlaceEvaluation) -> Section {
    let line = |key: &str, values: [f64; 3]| {
        let values = values.map(|v| rounded(v, 6).to_string());
        Text::default().code(format!("{key} = [{}]", values.join(", ")))
    };
    let lines = vec![
        line("workpiece_mm", best.position_m.map(|m| 1e3 * m)),
        line("workpiece_rpy_deg", best.roll_pitch_yaw.map(f64::to_degrees)),
    ];
    let title = "The best place in [work] of the cell";
    Section::new("lines", title, vec![Block::List(lines)]).in_summary()
}

fn key(placement: &Placement) -> DataTable {
    let rows = [Some(("given", &placement.given)), placement.best.as_ref().map(|best| ("best", best))];
    let rows: Vec<(&str, &PlaceEvaluation)> = rows.into_iter().flatten().collect();
    let placed = |row: usize| rows[row].1;
    DataTable::of(
        "Deflection along the whole path at the given place and the best one",
        "place",
        rows.iter().map(|(key, _)| *key),
    )
    .numbers("x", Quantity::PLACE, |row| Some(Number::new(placed(row).position_m[0])))
    .numbers("y", Quantity::PLACE, |row| Some(Number::new(placed(row).position_m[1])))
    .numbers("z", Quantity::PLACE, |row| Some(Number::new(placed(row).position_m[2])))
    .numbers("turned by", TURN, |row| Some(Number::degrees(placed(row).yaw)))
    .numbers("RMS", Quantity::LENGTH, |row| placed(row).deflection_rms_m.map(Number::new))
    .numbers("largest", Quantity::LENGTH, |row| placed(row).deflection_max_m.map(Number::new))
    .words("at point", |row| {
        let placed = placed(row);
        match &placed.deflection_max_point {
            Some(point) => visible(point).into_owned().into(),
            None => placed.status.describe().into(),
        }
    })
}

fn counts(placement: &Placement) -> DataTable {
    let mut table =
        DataTable::new("Places that were tried, by what the arm may do there", ["status", "places", "one reason"]);
    let all =
        [Status::Reachable, Status::Forbidden, Status::OutsideJointLimits, Status::Unreachable, Status::Discontinuous];
    for status in all {
        let of: Vec<&PlacementCandidate> = placement.candidates.iter().filter(|c| c.status == status).collect();
        if of.is_empty() {
            continue;
        }
        let count = Number::computed(of.len() as f64).of(Quantity::COUNT);
        let reason = of.iter().find_map(|c| {
            let point = visible(c.point.as_deref()?);
            Some(format!("at point {point}: {}", visible(c.reason.as_deref()?)))
        });
        let name = match status {
            Status::Reachable => "the arm can go along",
            other => other.describe(),
        };
        table.row(name, [count.into(), reason.unwrap_or_default().into()]);
    }
    table
}

fn cell_section(context: &Context<'_>, placement: &Placement) -> Result<Section> {
    let points = |placed: &PlaceEvaluation| -> Vec<WorkPoint> {
        let points = placed.along.iter().map(|point| WorkPoint {
            name: point.point.clone(),
            q: point.q.clone(),
            tip_m: point.tip_m,
            wrench: wrench(point.force_n, point.moment_nm),
            shift_m: point.shift_m,
            correction_m: None,
            principal: None,
        });
        points.collect()
    };
    let best = placement.best.as_ref().map(|best| ("best place", points(best)));
    let given_place = ("given place", points(&placement.given));
    let groups = best.into_iter().chain([given_place]);
    let groups: Vec<(&str, Vec<WorkPoint>)> = groups.filter(|(_, points)| !points.is_empty()).collect();
    let path = groups.first().map(|(name, _)| *name);
    let work = AtWork {
        groups,
        stiffness: &placement.stiffness_nm_per_rad,
        model: Model::Equilibrium,
        at_tip: true,
        path,
        always_shown: Vec::new(),
    };
    work.section(
        context,
        "Step through the postures along the path at the best place, then at the given one; the path at the best place \
         has its deflection in colour.",
    )
}
