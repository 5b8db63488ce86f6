//! Places of a workpiece as a figure and a table.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::map::{fitted, shortest_mm};
use crate::study::{Cell, Table};
use stiffarm::findings::each_once;
use stiffarm::units::{rad_to_shortest_deg, rounded, with_minus};
use stiffarm::work::map::{Placement, PlacementCandidate, Status};

/// What a place cannot be, in the order of the legend.
const REFUSED: [Status; 4] =
    [Status::Forbidden, Status::Unreachable, Status::OutsideJointLimits, Status::Discontinuous];

/// RMS of the deflections along the path over the places of the first round: one
/// panel per turn of the workpiece, at the height where the best place lies. Given
/// and best place are marked.
pub fn placement_figure(placement: &Placement) -> Figure {
    let first = || placement.candidates.iter().filter(|c| c.round == 0);
    let yaws: Vec<f64> = first().map(|c| c.yaw).collect();
    let yaws = each_once(&yaws);
    let best = first().filter(|c| c.deflection_rms_m.is_some()).min_by(|a, b| {
        let size = |c: &PlacementCandidate| c.deflection_rms_m.unwrap_or(f64::INFINITY);
        size(a).total_cmp(&size(b))
    });
    let height = best.or(first().next()).map_or(0.0, |c| c.position_m[2]);
    let values = || first().filter_map(|c| Some(1e3 * c.deflection_rms_m?));
    let ends = values().fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], v| [v.min(low), v.max(high)]);
    let mut axis = Axis::linear("RMS deflection", "mm");
    if ends[0] < ends[1] {
        axis = axis.with_range(ends[0], ends[1]);
    }
    let panels: Vec<Panel> = yaws.iter().map(|yaw| panel(placement, *yaw, height, &axis)).collect();
    Figure {
        id: "placement".into(),
        title: "Deflection along the path over the place of the workpiece".into(),
        caption: format!(
            "Root mean square of the deflections along the path, over the origin of the workpiece in the base frame \
             at z = {} mm; the brighter, the stiffer. Places that the path forbids say why.",
            shortest_mm(height)
        ),
        columns: panels.len().min(3),
        panels,
    }
}

fn panel(placement: &Placement, yaw: f64, height: f64, axis: &Axis) -> Panel {
    let here = placement.candidates.iter().filter(|c| c.round == 0 && c.yaw == yaw && c.position_m[2] == height);
    let here: Vec<&PlacementCandidate> = here.collect();
    let places = |chosen: &[&PlacementCandidate]| -> [Vec<f64>; 2] {
        [0, 1].map(|axis| chosen.iter().map(|c| 1e3 * c.position_m[axis]).collect())
    };
    let of =
        |status: Status| -> Vec<&PlacementCandidate> { here.iter().copied().filter(|c| c.status == status).collect() };
    let reached = of(Status::Reachable);
    let [x, y] = places(&reached);
    let values = reached.iter().map(|c| c.deflection_rms_m.map_or(f64::NAN, |rms| 1e3 * rms));
    let values = Series::new("", Style::Map, x, y).with_colour(axis.clone(), values.collect()).with_small_bright(true);
    let mut series = vec![values];
    for status in REFUSED {
        let [x, y] = places(&of(status));
        if !x.is_empty() {
            series.push(Series::new(status.describe(), Style::Map, x, y));
        }
    }
    let coordinates = |axis: usize| {
        let mut all: Vec<f64> = here.iter().map(|c| c.position_m[axis]).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    };
    let axes = [0, 1].map(|axis| fitted(["x", "y"][axis], &coordinates(axis)));
    let mut mark = |label: &str, position: [f64; 3], style| {
        let inside = [0, 1].iter().all(|axis| {
            let place = 1e3 * position[*axis];
            axes[*axis].range.is_none_or(|[low, high]| (low..=high).contains(&place))
        });
        if inside {
            let [x, y] = [0, 1].map(|axis| vec![1e3 * position[axis]]);
            series.push(Series::new(label, style, x, y));
        }
    };
    if yaw == 0.0 {
        mark("given place", placement.given.position_m, Style::Points);
    }
    if let Some(best) = placement.best.as_ref().filter(|b| b.yaw == yaw) {
        mark("best place", best.position_m, Style::Hollow);
    }
    let [x, y] = axes;
    Panel {
        title: format!("workpiece turned by {}°", with_minus(rounded(rad_to_shortest_deg(yaw), 6).to_string())),
        equal_aspect: x.range.is_some() && y.range.is_some(),
        x,
        y,
        series,
    }
}

/// One row per place that was tried.
pub fn placement_table(placement: &Placement) -> Table {
    let headings = [
        "round",
        "x_mm",
        "y_mm",
        "z_mm",
        "yaw_deg",
        "status",
        "deflection_rms_um",
        "deflection_max_um",
        "point",
        "reason",
    ];
    let micro = |v: Option<f64>| Cell::Number(v.map(|v| 1e6 * v));
    let rows = placement.candidates.iter().map(|c| {
        let [x, y, z] = c.position_m.map(shortest_mm);
        vec![
            (c.round as f64).into(),
            x.into(),
            y.into(),
            z.into(),
            rad_to_shortest_deg(c.yaw).into(),
            c.status.describe().into(),
            micro(c.deflection_rms_m),
            micro(c.deflection_max_m),
            c.point.clone().unwrap_or_default().into(),
            c.reason.clone().unwrap_or_default().into(),
        ]
    });
    Table {
        id: "placement".into(),
        caption: "Places of the workpiece that were tried.".into(),
        headings: headings.map(String::from).to_vec(),
        rows: rows.collect(),
    }
}
