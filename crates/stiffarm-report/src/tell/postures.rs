//! Tables of postures, their room and the moves between them.

use crate::tell::Given;
use crate::tell::{Block, DataTable, Section, Text};
use stiffarm::findings::visible;
use stiffarm::model::cell::LimitKind;
use stiffarm::plan::feasibility::{NearestLimit, PostureLimits};
use stiffarm::plan::route::{Route, RouteMove};

/// Most rows of a table that one reads first.
pub(super) const FEW: usize = 12;

/// Postures with their angles, and what leaves each the least room; `at` is the place of the angles below `/result`.
pub(super) fn posture_table(
    context: &Given<'_>,
    caption: &str,
    names: &[String],
    (at, postures): (&str, &[Vec<f64>]),
    limits: &[PostureLimits],
) -> DataTable {
    let joints = postures.first().map_or(0, Vec::len);
    let has_lengths = limits.iter().any(|l| nearest_length(l).is_some());
    let has_shares = limits.iter().any(|l| nearest_share(l).is_some());
    let mut headings = vec!["posture".to_string()];
    headings.extend((1..=joints).map(|j| format!("q{j} [°]")));
    if has_lengths {
        headings.extend(["room [mm]".to_string(), "least at".to_string()]);
    }
    if has_shares {
        headings.push("torque left [%]".to_string());
    }
    let mut table = DataTable::new(caption, headings);
    for (p, angles) in postures.iter().enumerate() {
        let mut cells: Vec<Text> = (0..angles.len())
            .map(|j| context.number(&format!("{at}/{p}/{j}")).decimals(2).into())
            .collect();
        let own = limits.get(p);
        let below = |i: usize, key: &str| format!("/limits/{p}/nearest/{i}/{key}");
        if has_lengths {
            match own.and_then(nearest_length) {
                Some((i, limit)) => {
                    let room = context.number(&below(i, "margin_m")).mm().bare();
                    cells.extend([room.decimals(1).into(), place(limit).into()]);
                }
                None => cells.extend([Text::from("–"), Text::from("–")]),
            }
        }
        if has_shares {
            cells.push(match own.and_then(nearest_share) {
                Some(i) => {
                    let left = context.number(&below(i, "margin_share")).percent().bare();
                    left.decimals(1).into()
                }
                None => Text::from("–"),
            });
        }
        table.row(name_of(names, p), cells);
    }
    table
}

/// The name of a posture, or its number.
pub(super) fn name_of(names: &[String], p: usize) -> String {
    match names.get(p) {
        Some(name) => visible(name).into_owned(),
        None => (p + 1).to_string(),
    }
}

fn nearest_length(limits: &PostureLimits) -> Option<(usize, &NearestLimit)> {
    let all = limits.nearest.iter().enumerate();
    let lengths = all.filter_map(|(i, limit)| Some((i, limit, limit.margin_m?)));
    // How far a displacement is from its limit is no room.
    let room = lengths.filter(|(_, limit, _)| {
        !matches!(
            limit.kind,
            LimitKind::SmallestDisplacement | LimitKind::LargestDisplacement
        )
    });
    let least = room.min_by(|a, b| a.2.total_cmp(&b.2))?;
    Some((least.0, least.1))
}

fn nearest_share(limits: &PostureLimits) -> Option<usize> {
    let all = limits.nearest.iter().enumerate();
    let shares = all.filter_map(|(i, limit)| Some((i, limit.margin_share?)));
    let least = shares.min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(least.0)
}

/// A place in few words, for a narrow column.
fn place(limit: &NearestLimit) -> String {
    let what = match limit.kind {
        LimitKind::ToolBox => "tool box: ",
        LimitKind::Floor => "floor: ",
        LimitKind::KeepOut => "keep-out cylinder: ",
        LimitKind::WristHeight => "lowest height: ",
        LimitKind::RopeLength => "length of ",
        LimitKind::Sight => "line of sight: ",
        // The two that come near each other say it all.
        _ => "",
    };
    let subject = visible(&limit.subject).replace("measuring point", "point");
    let load = match &limit.load {
        Some(load) => format!(", load {}", visible(load)),
        None => String::new(),
    };
    format!("{what}{subject}{load}")
}

/// The margins of every posture to every kind of limit; `None` without limits.
pub(super) fn limit_table(
    context: &Given<'_>,
    names: &[String],
    limits: &[PostureLimits],
) -> Option<DataTable> {
    let headings = ["posture", "limit", "nearest to it", "room", "unit"];
    let mut table = DataTable::new(
        "How near each posture comes to each kind of limit",
        headings,
    );
    for (p, own) in limits.iter().enumerate() {
        for (i, limit) in own.nearest.iter().enumerate() {
            let below = |key: &str| context.number(&format!("/limits/{p}/nearest/{i}/{key}"));
            let (room, unit) = if limit.margin_m.is_some() {
                (below("margin_m").mm().bare().decimals(2), "mm")
            } else if limit.margin_rad.is_some() {
                (
                    below("margin_rad")
                        .times(180.0 / std::f64::consts::PI)
                        .decimals(1),
                    "°",
                )
            } else {
                (
                    below("margin_share").percent().bare().decimals(1),
                    "% of the limit",
                )
            };
            let subject = visible(&limit.subject).into_owned();
            let cells = [
                Text::from(limit.kind.describe()),
                subject.into(),
                room.into(),
                unit.into(),
            ];
            table.row(name_of(names, p), cells);
        }
    }
    (!table.rows.is_empty()).then_some(table)
}

/// The moves of a route; `None` where there are none.
pub(super) fn route_section(
    context: &Given<'_>,
    names: &[String],
    route: &Route,
) -> Option<Section> {
    if route.moves.is_empty() {
        return None;
    }
    let mut said = Text::new("The postures are listed in the order in which to drive to them");
    said = match route.shortest {
        Some(true) => said.words("; no order is shorter"),
        Some(false) => said.words("; a shorter order may exist"),
        None => said.words(", which was given"),
    };
    said = said
        .words(". All moves together turn the joint that turns most by ")
        .number(context.number("/route/turn_deg").unit("°").decimals(0));
    if route.travel_s.is_some() {
        said = said
            .words(" and take ")
            .number(context.number("/route/travel_s").unit("s").decimals(1));
        if let Some(cell) = context.cell {
            let share = 100.0 * cell.route.speed_share;
            said = said.words(format!(" at {share} % of the joint speeds"));
        }
        said = said.words(", without speeding up and slowing down");
    }
    said = said.words(".");
    let has_time = route.moves.iter().any(|m| m.time_s.is_some());
    let has_nearest = route.moves.iter().any(|m| m.nearest.is_some());
    let mut headings = vec!["move", "largest turn [°]"];
    headings.extend(has_time.then_some("time [s]"));
    headings.extend(["via postures", "way"]);
    if has_nearest {
        headings.extend(["nearest [mm]", "at"]);
    }
    let mut table = DataTable::new("The moves", headings);
    for (m, one) in route.moves.iter().enumerate() {
        let at = |key: &str| context.number(&format!("/route/moves/{m}/{key}"));
        let mut cells = vec![Text::from(at("turn_deg").decimals(1))];
        if has_time {
            cells.push(at("time_s").decimals(1).into());
        }
        cells.push(match one.via.len() {
            0 => Text::from("–"),
            count => count.to_string().into(),
        });
        cells.push(match one.free {
            true => Text::from("free"),
            false => Text::default().strong("not free"),
        });
        if has_nearest {
            cells.extend(match &one.nearest {
                Some(nearest) => [
                    at("nearest/distance_m").mm().bare().decimals(1).into(),
                    Text::from(visible(&nearest.subject).into_owned()),
                ],
                None => [Text::from("–"), Text::from("–")],
            });
        }
        table.row(between(names, one), cells);
    }
    let blocks = vec![Block::Text(said), Block::Table(table)];
    Some(Section::new("route", "Order and moves", blocks))
}

fn between(names: &[String], one: &RouteMove) -> String {
    let end = |stop: Option<usize>| match stop {
        Some(stop) => name_of(names, stop),
        None => "start".to_string(),
    };
    format!("{} → {}", end(one.from), end(one.to))
}
