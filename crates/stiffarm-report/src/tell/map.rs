//! The page of `map`: where the tool tip gives way least.

use super::at_work::{AtWork, WorkPoint, norm, principal_table, wrench};
use super::place;
use crate::map_figure;
use crate::tell::Given;
use crate::tell::{Block, DataTable, Number, Section, Text, Told};
use stiffarm::Result;
use stiffarm::model::stiffness::Model;
use stiffarm::work::map::{MapExtremes, StiffnessMap};

/// What a result says of `map`, with a workpiece to place or without.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    if context.saved.json["result"]["candidates"].is_array() {
        return place::told(context);
    }
    let map: StiffnessMap = context.saved.result()?;
    let verdict = [done(context, &map), came(context, &map), next(&map)];
    let mut sections = vec![cell_section(context, &map)?];
    let figure = map_figure(&map);
    sections.push(Section::new(
        "map",
        "The map",
        vec![Block::Figure(figure), Block::Table(ranges(context, &map))],
    ));
    if map.extremes.is_some_and(|e| e.principal.is_some()) {
        let rows = ["stiffest place", "softest place"].into_iter().enumerate();
        let rows = rows.map(|(i, name)| (name.to_string(), format!("/extremes/principal/{i}")));
        let rows: Vec<(String, String)> = rows.collect();
        let table = Block::Table(principal_table(context, &rows));
        sections.push(Section::new(
            "stiffness",
            "Which way the tip gives way",
            vec![table],
        ));
    }
    sections.push(Section::new(
        "nodes",
        "What the arm may reach",
        vec![Block::Table(counts(context, &map))],
    ));
    Ok(context.told(
        "Stiffness of the tool tip over the workspace".to_string(),
        verdict,
        map.extremes.map(|extremes| key(context, &map, extremes)),
        sections,
    ))
}

fn done(context: &Given<'_>, map: &StiffnessMap) -> Text {
    let text = Text::new(format!(
        "The tool tip was held at {} positions under a force of {:.0} N; ",
        map.nodes.len(),
        norm(map.force_n)
    ));
    text.number(context.number("/counts/reachable").decimals(0))
        .words(" of them are reachable within all limits.")
}

/// Position of a node, tied to the file.
fn place_words(context: &Given<'_>, text: Text, pointer: &str) -> Text {
    let names = ["x = ", ", y = ", ", z = "];
    let mut text = text;
    for (axis, name) in names.into_iter().enumerate() {
        let number = context.number(&format!("{pointer}/{axis}"));
        let number = number.mm().decimals(0);
        let number = if axis < 2 { number.bare() } else { number };
        text = text.words(name).number(number);
    }
    text
}

/// A deflection in millimetres, or in micrometres where it is small.
fn deflection(context: &Given<'_>, node: usize, value: f64) -> Number {
    let number = context.number(&format!("/nodes/{node}/values/deflection_m"));
    match value < 1e-4 {
        true => number.times(1e6).unit("µm").significant(3),
        false => number.mm().decimals(3),
    }
}

fn came(context: &Given<'_>, map: &StiffnessMap) -> Text {
    let value = |node: usize| map.nodes[node].values.as_ref().map(|v| v.deflection_m);
    let ends = map
        .extremes
        .and_then(|e| Some((e, value(e.best)?, value(e.worst)?)));
    let Some((extremes, least, most)) = ends else {
        return Text::new("There is no place to compare.");
    };
    let text = Text::new("It gives way least at ");
    let text = place_words(
        context,
        text,
        &format!("/nodes/{}/position_m", extremes.best),
    )
    .words(", by ")
    .number(deflection(context, extremes.best, least));
    let text = half_width(context, map, extremes.best, text);
    let factor = Number::new("", Some(most / least)).significant(2);
    let text = text.words("; ").number(factor).words(" times as far at ");
    let text = place_words(
        context,
        text,
        &format!("/nodes/{}/position_m", extremes.worst),
    );
    text.words(", by ")
        .number(deflection(context, extremes.worst, most))
        .words(".")
}

fn half_width(context: &Given<'_>, map: &StiffnessMap, node: usize, text: Text) -> Text {
    let values = map.nodes[node].values.as_ref();
    match values.and_then(|v| Some((v.half_width_m?, v.deflection_m))) {
        None => text,
        // Errors that do not shrink with the load, such as lost motion, say nothing about stiffness under a small one.
        Some((half, size)) if half > size => text,
        Some((_, size)) => {
            let number = context.number(&format!("/nodes/{node}/values/half_width_m"));
            let number = match size < 1e-4 {
                true => number.times(1e6).unit("µm").significant(2),
                false => number.mm().decimals(3),
            };
            text.words(" ").number(number.plus_minus())
        }
    }
}

fn next(map: &StiffnessMap) -> Text {
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
        None => text.words(
            ", and an identified stiffness instead of the assumed one gives every number its ±.",
        ),
    }
}

/// The two extreme places with their postures.
fn key(context: &Given<'_>, map: &StiffnessMap, extremes: MapExtremes) -> DataTable {
    let headings = [
        "place",
        "x [mm]",
        "y [mm]",
        "z [mm]",
        "deflection [µm]",
        "± total [µm]",
        "along the direction [N/µm]",
        "softest [N/µm]",
    ];
    let values = map.nodes[extremes.best].values.as_ref();
    let is_small = values.is_some_and(|v| v.half_width_m.is_some_and(|half| half > v.deflection_m));
    let caption = format!(
        "Where the tip gives way least and most under {:.0} N{}",
        norm(map.force_n),
        match is_small {
            true =>
                "; under so small a load the ± is of errors that do not shrink with it, such as lost motion",
            false => "",
        }
    );
    let mut table = DataTable::new(caption, headings);
    for (name, node) in [("stiffest", extremes.best), ("softest", extremes.worst)] {
        let number = |below: &str| context.number(&format!("/nodes/{node}/{below}"));
        let mm = |axis: usize| {
            let number = number(&format!("position_m/{axis}"));
            Text::from(number.mm().bare().decimals(0))
        };
        let scaled = |below: &str, factor: f64| {
            let number = number(&format!("values/{below}"));
            Text::from(number.times(factor).significant(3))
        };
        let cells = [
            mm(0),
            mm(1),
            mm(2),
            scaled("deflection_m", 1e6),
            scaled("half_width_m", 1e6),
            scaled("stiffness_n_per_m", 1e-6),
            scaled("softest/stiffness_n_per_m", 1e-6),
        ];
        table.row(name, cells);
    }
    table
}

fn ranges(context: &Given<'_>, map: &StiffnessMap) -> DataTable {
    let mut table = DataTable::new(
        "Over the reachable places, at each the posture that bends least",
        ["quantity", "smallest", "median", "largest"],
    );
    let rows = [
        (
            "deflection per newton [µm/N]",
            "deflection_per_newton_m",
            1e6,
            map.deflection_per_newton_m,
        ),
        (
            "stiffness along the direction [N/µm]",
            "stiffness_n_per_m",
            1e-6,
            map.stiffness_n_per_m,
        ),
        (
            "stiffness along the softest direction [N/µm]",
            "softest_n_per_m",
            1e-6,
            map.softest_n_per_m,
        ),
        ("k(J_N)", "k_jn", 1.0, map.k_jn),
    ];
    for (name, key, factor, range) in rows {
        if range.is_none() {
            continue;
        }
        let cells = ["smallest", "median", "largest"].map(|end| {
            let number = context.number(&format!("/{key}/{end}"));
            Text::from(number.times(factor).significant(3))
        });
        table.row(name, cells);
    }
    table
}

fn counts(context: &Given<'_>, map: &StiffnessMap) -> DataTable {
    let mut table = DataTable::new(
        "Positions by what the arm may do there",
        ["status", "positions", "share [%]"],
    );
    let rows = [
        ("reachable", "reachable", map.counts.reachable),
        (
            "forbidden by the cell's limits",
            "forbidden",
            map.counts.forbidden,
        ),
        (
            "outside the joint limits",
            "outside_joint_limits",
            map.counts.outside_joint_limits,
        ),
        ("out of reach", "unreachable", map.counts.unreachable),
        ("not computed", "not_computed", map.counts.not_computed),
    ];
    for (name, key, count) in rows {
        if count == 0 && key != "reachable" {
            continue;
        }
        let number = context.number(&format!("/counts/{key}"));
        let share = count as f64 / map.nodes.len().max(1) as f64;
        let share = Number::new("", Some(share)).percent().bare().decimals(1);
        table.row(name, [number.decimals(0).into(), share.into()]);
    }
    table
}

fn cell_section(context: &Given<'_>, map: &StiffnessMap) -> Result<Section> {
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
        kept: Vec::new(),
    };
    work.section(
        context,
        "The arm at the places where the tip gives way least and most, with the ellipsoid of its compliance: longest \
         where the tip is softest. The slider exaggerates the deflection.",
    )
}
