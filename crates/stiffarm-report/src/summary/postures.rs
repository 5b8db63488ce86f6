//! Tables of postures, their room and the moves between them.

use crate::summary::{Block, Context, DataTable, Form, Number, Quantity, Section, Text, counted};
use stiffarm::findings::{Finding, codes, list, visible};
use stiffarm::model::cell::LimitKind;
use stiffarm::model::limit::MarginUnit;
use stiffarm::plan::feasibility::{NearestLimit, PostureLimits};
use stiffarm::plan::index::GroupEvaluation;
use stiffarm::plan::route::{Route, RouteMove};
use stiffarm::units::m_to_mm;

/// Most rows of a table that one reads first.
pub(super) const FEW: usize = 12;
/// k(J_N) above which a posture counts as near a singularity.
const NEAR_SINGULAR: f64 = 50.0;

/// Postures with their angles, and what leaves each the least room.
pub(super) fn posture_table(
    caption: &str,
    names: &[String],
    postures: &[Vec<f64>],
    limits: &[PostureLimits],
) -> DataTable {
    let joints = postures.first().map_or(0, Vec::len);
    let rows = (0..postures.len()).map(|p| name_of(names, p));
    let mut table = DataTable::of(caption, "posture", rows);
    for j in 0..joints {
        table = table.numbers(&format!("q{}", j + 1), Quantity::ANGLE, |p| Some(Number::degrees(*postures[p].get(j)?)));
    }
    let length = |p: usize| limits.get(p).and_then(nearest_length);
    let share = |p: usize| limits.get(p).and_then(nearest_share);
    table
        .numbers("room", Quantity::PLACE, |p| Some(Number::new(length(p)?.margin_m)))
        .words("least at", |p| length(p).map_or_else(Text::default, |limit| place(limit).into()))
        .numbers("torque left", Quantity::SHARE, |p| share(p).map(Number::new))
}

/// The name of a posture, or its number.
pub(super) fn name_of(names: &[String], p: usize) -> String {
    match names.get(p) {
        Some(name) => visible(name).into_owned(),
        None => (p + 1).to_string(),
    }
}

fn nearest_length(limits: &PostureLimits) -> Option<&NearestLimit> {
    // How far a displacement is from its limit is no room.
    let lengths = limits.nearest.iter();
    let lengths = lengths.filter(|limit| limit.kind.unit() == MarginUnit::Length);
    let lengths = lengths.filter_map(|limit| Some((limit, limit.margin_m?)));
    let least = lengths.min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(least.0)
}

fn nearest_share(limits: &PostureLimits) -> Option<f64> {
    let shares = limits.nearest.iter().filter_map(|limit| limit.margin_share);
    shares.min_by(f64::total_cmp)
}

/// A place in few words, for a narrow column.
fn place(limit: &NearestLimit) -> String {
    let what = limit.kind.in_column();
    let subject = visible(&limit.subject).replace("measuring point", "point");
    let load = match &limit.load {
        Some(load) => format!(", load {}", visible(load)),
        None => String::new(),
    };
    format!("{what}{subject}{load}")
}

/// The room that each kind of limit leaves every posture, and what the tracker sees; `None` without limits.
pub(super) fn limit_table(context: &Context<'_>, names: &[String], limits: &[PostureLimits]) -> Option<DataTable> {
    let rows = (0..limits.len()).map(|p| name_of(names, p));
    let caption = "How near each posture comes to each kind of limit";
    let mut table = DataTable::of(caption, "posture", rows);
    let nearest = |p: usize, kind| limits[p].nearest.iter().find(|near| near.kind == kind);
    for kind in LimitKind::ALL {
        type Margin = fn(&NearestLimit) -> Option<f64>;
        let (margin, quantity): (Margin, Quantity) = match kind.unit() {
            MarginUnit::Length => (|near| near.margin_m, Quantity::PLACE),
            MarginUnit::Displacement => (|near| near.margin_m, Quantity::LENGTH),
            MarginUnit::Angle => (|near| near.margin_rad, DEGREES),
            MarginUnit::Share => (|near| near.margin_share, Quantity::SHARE),
        };
        table = table.numbers(kind.short(), quantity, |p| Some(Number::new(margin(nearest(p, kind)?))));
        if kind == LimitKind::Shapes {
            table =
                table.words("which shapes", |p| nearest(p, kind).map_or_else(Text::default, |near| place(near).into()));
        }
    }
    let all = context.cell.map(|cell| cell.setup.tool.point_count());
    let table = table
        .words("station", |p| {
            let station = limits[p].station.as_ref();
            station.map_or_else(Text::default, |name| visible(name).into_owned().into())
        })
        .words("sees", |p| match &limits[p] {
            posture_limits if posture_limits.station.is_none() => Text::default(),
            posture_limits if posture_limits.visible_points.is_empty() => "nothing".into(),
            posture_limits if Some(posture_limits.visible_points.len()) == all => "all points".into(),
            posture_limits => visible(&posture_limits.visible_points.join(", ")).into_owned().into(),
        })
        .numbers("displacement", Quantity::LENGTH, |p| limits[p].displacement_m.map(Number::new));
    (table.headings.len() > 1).then_some(table)
}

/// Angles that are radians in a file.
pub(super) const DEGREES: Quantity = Quantity::new("°", 180.0 / std::f64::consts::PI, Form::Decimals(1));

/// Whether the tracker does not see every point at every posture.
pub(super) fn hides_points(context: &Context<'_>, limits: &[PostureLimits]) -> bool {
    let Some(cell) = context.cell else {
        return false;
    };
    let all = cell.setup.tool.point_count();
    let mut seen = limits.iter().filter(|posture_limits| posture_limits.station.is_some());
    seen.any(|posture_limits| posture_limits.visible_points.len() < all)
}

/// The moves of a route, without what `findings` say; `None` where there are none.
pub(super) fn route_section(
    context: &Context<'_>,
    names: &[String],
    route: &Route,
    findings: &[Finding],
) -> Option<Section> {
    if route.moves.is_empty() {
        return None;
    }
    let mut blocks = vec![Block::Text(moves_in_words(context, route, findings))];
    let table = Block::Table(move_table(names, route));
    // What stops a drive is seen at once.
    if route.is_blocked() {
        blocks.push(table);
    } else {
        blocks.push(Block::Details("The moves".to_string(), vec![table]));
    }
    blocks.extend(via_table(names, route).map(Block::Table));
    Some(Section::new("route", "Order and moves", blocks).in_summary())
}

/// How far the moves go, how long they take and what they were kept clear of.
fn moves_in_words(context: &Context<'_>, route: &Route, findings: &[Finding]) -> Text {
    let order = match route.shortest {
        // A way around something is one that was found, not the shortest there is.
        Some(true) if route.moves.iter().any(|one| !one.via.is_empty()) => {
            "by the ways found no order of the postures is shorter"
        }
        Some(true) => "no order of the postures is shorter",
        Some(false) => "a shorter order may exist",
        None => "the order was given",
    };
    let turn = Number::degrees(route.turn);
    let mut said = Text::new(format!("{}, {order}: ", counted(route.moves.len(), "move")))
        .number(turn.unit("°").decimals(0))
        .words(" of largest turns in all");
    if let Some(time) = route.travel_s {
        let time = Number::new(time);
        said = said.words(" in ").number(time.unit("s").decimals(1));
        if let Some(cell) = context.cell {
            let share = 100.0 * cell.route.speed_share;
            said = said.words(format!(" at {share} % of the joint speeds"));
        }
        said = said.words(", without speeding up and slowing down");
    }
    said = said.words(".");
    let kinds: Vec<&str> = route.checked.iter().map(|kind| kind.short()).collect();
    if !kinds.is_empty() && !route.is_blocked() {
        said = said.words(format!(" Every move is free, checked against {}.", list(&kinds)));
    }
    if route.is_approached() {
        said =
            said.words(" The last turn of a joint before a posture goes against its load, which takes up lost motion.");
    }
    let is_said = findings.iter().any(|f| f.code == codes::MOVES_NOT_CHECKED);
    if !route.checked.contains(&LimitKind::Shapes) && !is_said {
        said = said.words(
            " The cell has no shapes, so nothing says what the arm may touch on the way: drive each move slowly the \
             first time.",
        );
    }
    said
}

fn move_table(names: &[String], route: &Route) -> DataTable {
    let nearest = |m: usize| route.moves[m].nearest.as_ref();
    let rows = route.moves.iter().map(|one| between(names, one));
    DataTable::of("The moves", "move", rows)
        .numbers("largest turn", Quantity::ANGLE, |m| Some(Number::degrees(route.moves[m].turn)))
        .numbers("time", Quantity::new("s", 1.0, Form::Decimals(1)), |m| Some(Number::new(route.moves[m].time_s)))
        .words("via postures", |m| match route.moves[m].via.len() {
            0 => Text::default(),
            count => count.to_string().into(),
        })
        .words("way", |m| if route.moves[m].free { "free".into() } else { Text::default().strong("not free") })
        .numbers("nearest", Quantity::PLACE, |m| Some(Number::new(nearest(m)?.distance_m)))
        .words("between", |m| nearest(m).map_or_else(Text::default, |near| visible(&near.subject).into_owned().into()))
}

/// The postures between stops; `None` where every move is straight.
fn via_table(names: &[String], route: &Route) -> Option<DataTable> {
    let each = route.moves.iter();
    let each = each.flat_map(|one| one.via.iter().map(move |via| (one, via)));
    let vias: Vec<(&RouteMove, &Vec<f64>)> = each.collect();
    let joints = vias.first()?.1.len();
    let rows = vias.iter().map(|(one, _)| between(names, one));
    let mut table = DataTable::of("Via postures, in their order", "move", rows);
    for j in 0..joints {
        table =
            table.numbers(&format!("q{}", j + 1), Quantity::ANGLE, |row| Some(Number::degrees(*vias[row].1.get(j)?)));
    }
    Some(table)
}

fn between(names: &[String], one: &RouteMove) -> String {
    let end = |stop: Option<usize>| match stop {
        Some(stop) => name_of(names, stop),
        None => "start".to_string(),
    };
    format!("{} → {}", end(one.from), end(one.to))
}

/// To which postures one should move joint by joint; the last ones of the group are those of `names`.
pub(super) fn near_singular(names: &[String], evaluation: &GroupEvaluation) -> Option<Text> {
    let is_computed = evaluation.k_jn.iter().any(Option::is_some);
    let before = evaluation.k_jn.len().saturating_sub(names.len());
    let k_jn = evaluation.k_jn.iter().skip(before).enumerate();
    let near = k_jn.filter(|(_, k)| is_computed && k.is_none_or(|k| k > NEAR_SINGULAR));
    let near: Vec<String> = near.map(|(p, _)| name_of(names, p)).collect();
    let noun = if near.len() == 1 { "posture" } else { "postures" };
    (!near.is_empty()).then(|| {
        Text::new(format!(
            "Close to a singularity, k(J_N) above {NEAR_SINGULAR}: {noun} {}. That is harmless to the identification, \
             but move there joint by joint.",
            list(&near)
        ))
    })
}

/// A length \[m\] to a tenth of a millimetre, without digits nobody set.
pub(super) fn coarse(m: f64) -> Number {
    let number = Number::computed(m).of(Quantity::PLACE);
    if (m_to_mm(m) - m_to_mm(m).round()).abs() < 0.05 { number.decimals(0) } else { number }
}
