//! What `map` says: where the tool tip gives way least.

use super::at_work::{AtWork, GivesWay, TIP_STIFFNESS, WorkPoint, principal_table, wrench};
use super::points::{position, region, vector};
use crate::map::NodeQuantity;
use crate::map_figure;
use crate::path::norm;
use crate::summary::{
    Block, Context, DataTable, Number, Quantity, Section, Summarise, Summary, Text, WithCell, of_saved, with_stopped,
};
use stiffarm::Result;
use stiffarm::ask::map::{LoadSource, Options};
use stiffarm::ask::place;
use stiffarm::model::stiffness::Model;
use stiffarm::work::map::{MapExtremes, MapRange, NodeValues, Placement, StiffnessMap};

/// Deflections below this are small \[m\].
const IS_SMALL: f64 = 1e-4;

/// A part of a range.
type End = fn(&MapRange) -> f64;

/// The columns of a range.
pub(super) const RANGE: [(&str, End); 3] =
    [("smallest", |range| range.smallest), ("median", |range| range.median), ("largest", |range| range.largest)];

/// What a result says of `map`, with a workpiece to place or without.
pub(super) fn summary(with: &WithCell<'_>) -> Result<Summary> {
    if with.saved.json["result"]["candidates"].is_array() {
        return of_saved::<Placement, place::Options>(with);
    }
    of_saved::<StiffnessMap, Options>(with)
}

impl Summarise<Options> for StiffnessMap {
    fn summary(&self, options: &Options, context: &Context<'_>) -> Result<Summary> {
        let map = self;
        let verdict = [what_was_done(options, map), conclusion(map), next_step(map)];
        let mut sections = Vec::new();
        let mut shown = Vec::new();
        if context.pictures {
            sections.push(cell_section(context, map)?);
            shown.push(Block::Figure(map_figure(map)));
        }
        if map.extremes.is_some() {
            shown.push(Block::Table(ranges(map)));
        }
        if !shown.is_empty() {
            sections.push(Section::new("map", "The map", shown).in_summary());
        }
        if let Some(extremes) = map.extremes {
            sections.push(postures(map, extremes));
        }
        if let Some(principal) = map.extremes.and_then(|e| e.principal) {
            let names = ["stiffest place", "softest place"].map(String::from);
            let places: Vec<GivesWay> = names.into_iter().zip(principal).collect();
            let table = Block::Table(principal_table(&places));
            let title = "Which way the tip gives way";
            sections.push(Section::new("stiffness", title, vec![table]));
        }
        let counts = Block::Table(counts(map));
        sections.push(Section::new("nodes", "What the arm may reach", vec![counts]));
        let findings = map.findings.clone();
        Ok(context.summary(
            with_stopped(context, findings, map.interrupted, &[]),
            "Stiffness of the tool tip over the workspace",
            verdict,
            map.extremes.map(|extremes| key(map, extremes)),
            sections,
        ))
    }
}

fn what_was_done(options: &Options, map: &StiffnessMap) -> Text {
    let ends = map.axes().map(|at| match at {
        [first, .., last] => [*first, *last],
        [only] => [*only; 2],
        [] => [0.0; 2],
    });
    let turn = match map.free_turn {
        Some(turns) => format!(" and the turn about it free, the best of {turns}"),
        None => String::new(),
    };
    let axis = [0, 1, 2].map(|i| map.rotation[i][2]);
    let moment = if map.moment_nm.iter().any(|m| *m != 0.0) {
        format!(" and a moment of {} N·m", vector(map.moment_nm))
    } else {
        String::new()
    };
    Text::new(format!(
        "The tool tip was held at {} positions, {}, with its axis along {}{turn}, under a force of {} N{moment}{}; ",
        map.nodes.len(),
        region(ends),
        vector(axis),
        vector(map.force_n),
        load(options.load_from)
    ))
    .number(Number::count(map.counts.reachable))
    .words(" of them are reachable within all limits.")
}

/// Where the load comes from, in words; empty where it was given.
fn load(from: LoadSource) -> &'static str {
    match from {
        LoadSource::Cell => ", from the cell's [work]",
        LoadSource::CellAlongPath => {
            ", 1 N along the direction: the cell's [work] gives a load in the axes of a path, which a map has not"
        }
        LoadSource::Unit => ", 1 N along the direction: no force is given",
        LoadSource::Given => "",
    }
}

/// What was found at a node.
fn values(map: &StiffnessMap, node: usize) -> Option<&NodeValues> {
    map.nodes.get(node)?.values.as_ref()
}

fn conclusion(map: &StiffnessMap) -> Text {
    let value = |node: usize| Some(values(map, node)?.deflection_m);
    let ends = map.extremes.and_then(|e| Some((e, value(e.best)?, value(e.worst)?)));
    let Some((extremes, least, most)) = ends else {
        return Text::new("There is no place to compare.");
    };
    let place = |node: usize| position(map.nodes[node].position_m);
    let [deflection, half_width] = deflections(map);
    let text = Text::new("The tip gives way least at ")
        .then(place(extremes.best))
        .words(", by ")
        .number(Number::new(least).of(deflection));
    with_half_width(map, extremes.best, text, half_width)
        .words("; ")
        .number(Number::computed(most / least).significant(2))
        .words(" times as much at ")
        .then(place(extremes.worst))
        .words(", by ")
        .number(Number::new(most).of(deflection))
        .words(".")
}

/// How deflections and their ± are shown: in millimetres, or in micrometres where all are small.
fn deflections(map: &StiffnessMap) -> [Quantity; 2] {
    let most = map.extremes.and_then(|extremes| Some(values(map, extremes.worst)?.deflection_m));
    match most.is_some_and(|most| most < IS_SMALL) {
        true => [Quantity::SMALL_LENGTH, Quantity::SMALL_LENGTH.digits(2)],
        false => [Quantity::LENGTH; 2],
    }
}

fn with_half_width(map: &StiffnessMap, node: usize, text: Text, quantity: Quantity) -> Text {
    match values(map, node).and_then(|v| Some((v.half_width_m?, v.deflection_m))) {
        None => text,
        // Errors that do not shrink with the load, such as lost motion, say nothing about stiffness under a small one.
        Some((half, size)) if half > size => text,
        Some((half, _)) => text.words(" ").number(Number::new(half).of(quantity).plus_minus()),
    }
}

fn next_step(map: &StiffnessMap) -> Text {
    if map.counts.reachable == 0 {
        return Text::new("Map another region, or turn the tool: ")
            .code("--from-mm")
            .words(", ")
            .code("--to-mm")
            .words(" and ")
            .code("--rpy-deg")
            .words(".");
    }
    let text = Text::new("Put the work where the tip gives way little; ")
        .code("stiffarm map cell.toml k.json --place path.csv")
        .words(" finds the place for a whole path");
    match map.confidence {
        Some(_) => text.words("."),
        None => text.words(", and an identified stiffness instead of the assumed one gives every number its ±."),
    }
}

/// The two extreme places.
fn key(map: &StiffnessMap, extremes: MapExtremes) -> DataTable {
    let is_small = values(map, extremes.best).is_some_and(|v| v.half_width_m.is_some_and(|half| half > v.deflection_m));
    let caption = format!(
        "Where the tip gives way least and most under {:.0} N{}",
        norm(map.force_n),
        if is_small {
            "; under so small a load the ± is of errors that do not shrink with it, such as lost motion"
        } else {
            ""
        }
    );
    let nodes = [extremes.best, extremes.worst];
    let place = |row: usize, axis: usize| Some(Number::new(map.nodes[nodes[row]].position_m[axis]));
    let at_node = |row: usize, of: fn(&NodeValues) -> Option<f64>| of(values(map, nodes[row])?).map(Number::new);
    let [deflection, half_width] = deflections(map);
    DataTable::of(caption, "place", ["stiffest", "softest"])
        .numbers("x", Quantity::PLACE, |row| place(row, 0))
        .numbers("y", Quantity::PLACE, |row| place(row, 1))
        .numbers("z", Quantity::PLACE, |row| place(row, 2))
        .numbers("deflection", deflection, |row| at_node(row, |v| Some(v.deflection_m)))
        .numbers("± total", half_width, |row| at_node(row, |v| v.half_width_m))
        .numbers("along the direction", TIP_STIFFNESS, |row| at_node(row, |v| v.stiffness_n_per_m))
        .numbers("softest", TIP_STIFFNESS, |row| at_node(row, |v| v.softest.stiffness_n_per_m))
}

/// The postures at the two extreme places.
fn postures(map: &StiffnessMap, extremes: MapExtremes) -> Section {
    let angles = |node: usize| values(map, node).map_or(&[][..], |v| &v.q);
    let rows = [angles(extremes.best), angles(extremes.worst)];
    let caption = "Controller angles there, of the posture that bends least";
    let table = DataTable::of(caption, "place", ["stiffest", "softest"]);
    let table = (0..rows[0].len()).fold(table, |table, joint| {
        table.numbers(&format!("q{}", joint + 1), Quantity::ANGLE, |row| {
            let angle = rows[row].get(joint)?;
            Some(Number::computed(angle.to_degrees()))
        })
    });
    let title = "The postures at these places";
    Section::new("postures", title, vec![Block::Table(table)])
}

fn ranges(map: &StiffnessMap) -> DataTable {
    let along = format!("stiffness along {}", vector(map.direction));
    let rows = [
        ("deflection per newton", NodeQuantity::DEFLECTION),
        (&*along, NodeQuantity::STIFFNESS),
        ("stiffness along the softest direction", NodeQuantity::SOFTEST),
        ("k(J_N)", NodeQuantity::K_JN),
    ];
    let rows = rows.into_iter().filter_map(|(name, quantity)| Some((name, quantity, (quantity.range)(map)?)));
    let rows: Vec<_> = rows.collect();
    let caption = "Over the reachable places, at each the posture that bends least";
    let names = rows.iter().map(|(name, quantity, _)| match quantity.unit {
        "" => (*name).to_string(),
        unit => format!("{name} [{unit}]"),
    });
    let table = DataTable::of(caption, "quantity", names);
    RANGE.into_iter().fold(table, |table, (end, of)| {
        table.words(end, |row| {
            let (_, quantity, range) = &rows[row];
            Number::new(of(range)).times(quantity.factor).significant(3).into()
        })
    })
}

fn counts(map: &StiffnessMap) -> DataTable {
    let rows = [
        ("reachable", map.counts.reachable),
        ("forbidden by the cell's limits", map.counts.forbidden),
        ("outside the joint limits", map.counts.outside_joint_limits),
        ("out of reach", map.counts.unreachable),
        ("not computed", map.counts.not_computed),
    ];
    let rows: Vec<_> = rows.iter().filter(|(status, count)| *count > 0 || *status == "reachable").collect();
    DataTable::of("Positions by what the arm may do there", "status", rows.iter().map(|row| row.0))
        .words("positions", |row| Number::count(rows[row].1).into())
        .numbers("share", Quantity::SHARE, |row| {
            let share = rows[row].1 as f64 / map.nodes.len().max(1) as f64;
            Some(Number::computed(share))
        })
}

fn cell_section(context: &Context<'_>, map: &StiffnessMap) -> Result<Section> {
    let extremes = map.extremes;
    let point = |name: &str, node: usize, number: usize| {
        let node = map.nodes.get(node)?;
        let values = node.values.as_ref()?;
        let principal = extremes.and_then(|e| e.principal);
        Some(WorkPoint {
            name: name.to_string(),
            q: values.q.clone(),
            tip_m: node.position_m,
            wrench: wrench(map.force_n, map.moment_nm),
            shift_m: values.shift_m,
            correction_m: None,
            principal: principal.map(|both| both[number]),
        })
    };
    let groups = extremes.map_or(Vec::new(), |e| {
        let both = [("stiffest place", e.best), ("softest place", e.worst)];
        let both = both.into_iter().enumerate();
        let points = both.filter_map(|(i, (name, node))| point(name, node, i));
        vec![("places", points.collect())]
    });
    let work = AtWork {
        groups,
        stiffness: &map.stiffness_nm_per_rad,
        model: Model::Equilibrium,
        at_tip: true,
        path: None,
        always_shown: Vec::new(),
    };
    work.section(
        context,
        "The arm at the places where the tip gives way least and most, with the ellipsoid of its compliance: longest \
         where the tip is softest. The slider exaggerates the deflection.",
    )
}
