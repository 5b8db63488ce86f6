//! Stiffness maps as figures and a table.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::study::{Cell, Table};
use stiffarm::units::{m_to_mm, rad_to_deg, rad_to_shortest_deg, rounded, with_minus};
use stiffarm::work::map::{MapNode, MapRange, NodeValues, Status, StiffnessMap};

/// Ratio of the largest to the smallest value from which on a colour bar is
/// logarithmic.
const LOGARITHMIC_RATIO: f64 = 10.0;
/// Most planes of a box.
const PLANES: usize = 9;
/// Most strokes along the longer side of a plane.
const STROKES: usize = 16;
/// Length of a stroke in the plane, of the distance to the next one.
const STROKE: f64 = 0.8;
/// Names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];
/// What is not reachable, in the order of the legend.
const REFUSED: [Status; 3] = [Status::Forbidden, Status::Unreachable, Status::OutsideJointLimits];

/// What a map says of each reachable node: figure, table of the nodes and words read it here.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NodeQuantity {
    /// Heading in the table of all nodes.
    key: &'static str,
    /// Unit for people; empty for a ratio.
    pub unit: &'static str,
    /// The shown number is that in SI units times this.
    pub factor: f64,
    at: fn(&NodeValues) -> Option<f64>,
    /// Its range over the map.
    pub range: fn(&StiffnessMap) -> Option<MapRange>,
}

impl NodeQuantity {
    pub(crate) const DEFLECTION: Self = NodeQuantity {
        key: "deflection_um_per_n",
        unit: "µm/N",
        factor: 1e6,
        at: |v| Some(v.deflection_per_newton_m),
        range: |map| map.deflection_per_newton_m,
    };
    pub(crate) const STIFFNESS: Self = NodeQuantity {
        key: "stiffness_n_per_um",
        unit: "N/µm",
        factor: 1e-6,
        at: |v| v.stiffness_n_per_m,
        range: |map| map.stiffness_n_per_m,
    };
    pub(crate) const SOFTEST: Self = NodeQuantity {
        key: "softest_n_per_um",
        at: |v| v.softest.stiffness_n_per_m,
        range: |map| map.softest_n_per_m,
        ..Self::STIFFNESS
    };
    pub(crate) const K_JN: Self =
        NodeQuantity { key: "k_jn", unit: "", factor: 1.0, at: |v| v.k_jn, range: |map| map.k_jn };

    fn shown(&self, values: &NodeValues) -> Option<f64> {
        (self.at)(values).map(|number| self.factor * number)
    }

    fn cell(&self, values: Option<&NodeValues>) -> Cell {
        values.and_then(|values| self.shown(values)).into()
    }
}

/// One quantity of a map in a figure.
struct Quantity {
    /// Heading of its panel.
    title: String,
    /// Colour bar or vertical axis.
    axis: Axis,
    /// What it is.
    of: NodeQuantity,
    /// Whether small values are the good ones, as of a deflection.
    small_is_good: bool,
}

/// A plane of the map: where it lies along the axis across it.
struct Plane {
    across: usize,
    at: usize,
    horizontal: usize,
    vertical: usize,
}

impl Plane {
    /// The map's nodes in it, by rows.
    fn nodes<'m>(&self, map: &'m StiffnessMap) -> Vec<&'m MapNode> {
        let axes = map.axes();
        let mut nodes = Vec::new();
        for row in 0..axes[self.vertical].len() {
            for column in 0..axes[self.horizontal].len() {
                let mut at = [0; 3];
                at[self.across] = self.at;
                at[self.vertical] = row;
                at[self.horizontal] = column;
                nodes.push(&map.nodes[map.index(at)]);
            }
        }
        nodes
    }
}

/// The map in pictures. Of a plane: deflection per newton, stiffness along the
/// map's direction, and the stiffness of the softest direction with strokes along
/// it (as long as it lies in the plane). Of a box: up to nine of its planes with
/// the deflection per newton. Of a line: all three along it.
pub fn map_figure(map: &StiffnessMap) -> Figure {
    let axes = map.axes();
    let long: Vec<usize> = (0..3).filter(|axis| axes[*axis].len() > 1).collect();
    let quantities = quantities(map);
    let (columns, panels) = match long[..] {
        [_, _, _] => planes(map, &quantities[0]),
        [horizontal, vertical] => {
            let plane = Plane { across: 3 - horizontal - vertical, at: 0, horizontal, vertical };
            let panels = quantities.iter().enumerate();
            let panels = panels.map(|(i, quantity)| panel(map, &plane, quantity, quantity.title.clone(), i == 2));
            (3, panels.collect())
        }
        _ => {
            let axis = long.first().copied().unwrap_or(0);
            let panels = quantities.iter().map(|quantity| line(map, axis, quantity));
            (3, panels.collect())
        }
    };
    Figure { id: "map".into(), title: title(map), caption: caption(map), columns, panels }
}

/// The colour bar of such a range.
pub(crate) fn ranged_axis(label: &str, unit: &str, range: Option<MapRange>) -> Axis {
    match range {
        Some(r) if r.smallest > 0.0 && r.largest > LOGARITHMIC_RATIO * r.smallest => Axis::log(label, unit),
        _ => Axis::linear(label, unit),
    }
}

fn quantities(map: &StiffnessMap) -> [Quantity; 3] {
    let scaled = |label: &str, of: NodeQuantity| ranged_axis(label, of.unit, (of.range)(map));
    [
        Quantity {
            title: "deflection under the load".into(),
            axis: scaled("deflection per newton", NodeQuantity::DEFLECTION),
            of: NodeQuantity::DEFLECTION,
            small_is_good: true,
        },
        Quantity {
            title: format!("stiffness along {}", direction_words(map)),
            axis: scaled("stiffness", NodeQuantity::STIFFNESS),
            of: NodeQuantity::STIFFNESS,
            small_is_good: false,
        },
        Quantity {
            title: "softest direction".into(),
            axis: scaled("stiffness along it", NodeQuantity::SOFTEST),
            of: NodeQuantity::SOFTEST,
            small_is_good: false,
        },
    ]
}

/// The map's direction: the force, an axis, or its components.
fn direction_words(map: &StiffnessMap) -> String {
    let axis = map.direction.iter().position(|c| c.abs() > 1.0 - 1e-9);
    let size = map.force_n.iter().map(|f| f * f).sum::<f64>().sqrt();
    let dot = |(a, b): (&f64, &f64)| a * b / size;
    let cosine: f64 = map.direction.iter().zip(&map.force_n).map(dot).sum();
    match axis {
        Some(axis) => AXES[axis].to_string(),
        None if cosine.abs() > 1.0 - 1e-9 => "the force".to_string(),
        None => vector(map.direction),
    }
}

/// Components to two digits, without zeros behind the point.
fn vector(v: [f64; 3]) -> String {
    format!("({})", v.map(|c| with_minus(rounded(c, 2).to_string())).join(", "))
}

fn title(map: &StiffnessMap) -> String {
    let axes = map.axes();
    let fixed: Vec<String> = (0..3)
        .filter(|axis| axes[*axis].len() == 1)
        .map(|axis| format!("{} = {} mm", AXES[axis], millimetres(axes[axis][0])))
        .collect();
    if fixed.is_empty() {
        "Deflection of the tool tip under load".to_string()
    } else {
        format!("Stiffness of the tool tip at {}", fixed.join(", "))
    }
}

fn caption(map: &StiffnessMap) -> String {
    let column = [0, 1, 2].map(|i| map.rotation[i][2]);
    let turn = match map.free_turn {
        Some(turns) => format!(", the best of {turns} turns about it"),
        None => String::new(),
    };
    let is_line = map.axes().iter().filter(|axis| axis.len() > 1).count() < 2;
    let colours = if is_line { "" } else { " The brighter, the stiffer." };
    let left = match map.counts.not_computed {
        0 => String::new(),
        count => format!(", {count} were not computed, for the work was stopped"),
    };
    format!(
        "Deflection per newton under a force of {} N on the robot at the tip, stiffness along {}, and stiffness \
         along the softest direction, over the position of the tip in the base frame. Tool axis {}{turn}; at each \
         place the posture that bends least.{colours} {} of {} places are reachable{left}.",
        vector(map.force_n),
        vector(map.direction),
        vector(column),
        map.counts.reachable,
        map.nodes.len()
    )
}

fn millimetres(m: f64) -> String {
    with_minus(rounded(m_to_mm(m), 1).to_string())
}

/// Planes of a box across its axis of fewest nodes, with one colour bar for all.
fn planes(map: &StiffnessMap, quantity: &Quantity) -> (usize, Vec<Panel>) {
    let axes = map.axes();
    // Of equals the last: planes of z lie as the floor does.
    let across = (0..3).rev().min_by_key(|axis| axes[*axis].len());
    let across = across.unwrap_or(2);
    let [horizontal, vertical] = match across {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    };
    let all = axes[across].len();
    let count = all.min(PLANES);
    let places = (0..count).map(|i| match count {
        1 => 0,
        _ => i * (all - 1) / (count - 1),
    });
    let mut axis = quantity.axis.clone();
    let values = map.nodes.iter().filter_map(|n| n.values.as_ref());
    let values: Vec<f64> = values.filter_map(|v| quantity.of.shown(v)).collect();
    let ends = values.iter().fold([f64::INFINITY, 0.0], |[low, high], v| [v.min(low), v.max(high)]);
    if ends[0] < ends[1] {
        axis = axis.with_range(ends[0], ends[1]);
    }
    let quantity =
        Quantity { title: quantity.title.clone(), axis, of: quantity.of, small_is_good: quantity.small_is_good };
    let panels = places.map(|at| {
        let plane = Plane { across, at, horizontal, vertical };
        let title = format!("{} = {} mm", AXES[across], millimetres(axes[across][at]));
        panel(map, &plane, &quantity, title, false)
    });
    let panels: Vec<Panel> = panels.collect();
    let columns = match panels.len() {
        4 => 2,
        n => n.min(3),
    };
    (columns, panels)
}

/// One plane with one quantity.
fn panel(map: &StiffnessMap, plane: &Plane, quantity: &Quantity, title: String, strokes: bool) -> Panel {
    let nodes = plane.nodes(map);
    let place = |node: &MapNode, axis: usize| 1e3 * node.position_m[axis];
    let places = |nodes: &[&MapNode]| -> [Vec<f64>; 2] {
        [plane.horizontal, plane.vertical].map(|axis| nodes.iter().map(|n| place(n, axis)).collect())
    };
    let is_reached = |node: &&MapNode| node.status == Status::Reachable;
    let reached: Vec<&MapNode> = nodes.iter().copied().filter(is_reached).collect();
    let [x, y] = places(&reached);
    let values = reached.iter().filter_map(|n| n.values.as_ref());
    let values = values.map(|v| quantity.of.shown(v).unwrap_or(f64::NAN));
    let values = Series::new("", Style::Map, x, y)
        .with_colour(quantity.axis.clone(), values.collect())
        .with_small_bright(quantity.small_is_good);
    let mut series = vec![values];
    for status in REFUSED {
        let refused = nodes.iter().copied().filter(|n| n.status == status);
        let [x, y] = places(&refused.collect::<Vec<_>>());
        if !x.is_empty() {
            series.push(Series::new(status.describe(), Style::Map, x, y));
        }
    }
    if strokes {
        series.push(directions(map, plane));
    }
    let best = map.extremes.map(|e| &map.nodes[e.best]);
    if let Some(best) = best.filter(|best| nodes.iter().any(|n| std::ptr::eq(*n, *best))) {
        let [x, y] = places(&[best]);
        series.push(Series::new("bends least", Style::Hollow, x, y));
    }
    let axis = |axis: usize| fitted(AXES[axis], map.axes()[axis]);
    Panel { title, x: axis(plane.horizontal), y: axis(plane.vertical), series, equal_aspect: true }
}

/// Strokes along the softest direction, on a grid of their own.
fn directions(map: &StiffnessMap, plane: &Plane) -> Series {
    let axes = map.axes();
    let [columns, rows] = [plane.horizontal, plane.vertical].map(|axis| axes[axis].len());
    let every = columns.max(rows).div_ceil(STROKES).max(1);
    let spacing = |axis: usize| {
        let steps = axes[axis];
        1e3 * (steps[steps.len() - 1] - steps[0]) / (steps.len() - 1) as f64
    };
    let distance = spacing(plane.horizontal).min(spacing(plane.vertical)) * every as f64;
    let half = 0.5 * STROKE * distance;
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for (i, node) in plane.nodes(map).into_iter().enumerate() {
        let (row, column) = (i / columns, i % columns);
        let Some(values) = &node.values else { continue };
        if row % every != every / 2 || column % every != every / 2 {
            continue;
        }
        for side in [-half, half] {
            let end = |axis: usize| 1e3 * node.position_m[axis] + side * values.softest.direction[axis];
            x.push(end(plane.horizontal));
            y.push(end(plane.vertical));
        }
    }
    Series::new("softest direction, its part in the plane", Style::Strokes, x, y)
}

/// A quantity along a line.
fn line(map: &StiffnessMap, axis: usize, quantity: &Quantity) -> Panel {
    let values = map.nodes.iter().map(|node| {
        let value = node.values.as_ref().and_then(|v| quantity.of.shown(v));
        value.unwrap_or(f64::NAN)
    });
    // A gap is said by the legend, not by a count of lost values.
    let pairs = map.axes()[axis].iter().zip(values);
    let points: Vec<(f64, f64)> =
        pairs.filter(|(_, value)| value.is_finite()).map(|(at, value)| (1e3 * at, value)).collect();
    let (x, y) = points.into_iter().unzip();
    Panel::new(
        quantity.title.clone(),
        Axis::linear(AXES[axis], "mm"),
        quantity.axis.clone().from_zero(),
        vec![Series::new("", Style::Points, x, y)],
    )
}

/// An axis in millimetres that ends where the outermost cells end.
pub(crate) fn fitted(name: &str, metres: &[f64]) -> Axis {
    let axis = Axis::linear(name, "mm");
    let last = metres.len().saturating_sub(1);
    if last == 0 {
        return axis;
    }
    let half = 0.5 * (metres[last] - metres[0]) / last as f64;
    axis.with_range(1e3 * (metres[0] - half), 1e3 * (metres[last] + half))
}

/// One row per node: x slowest, z fastest.
pub fn map_table(map: &StiffnessMap) -> Table {
    let mut headings: Vec<String> = [
        "x_mm",
        "y_mm",
        "z_mm",
        "status",
        "reason",
        "distance_mm",
        NodeQuantity::DEFLECTION.key,
        "deflection_um",
        "half_width_um",
        NodeQuantity::STIFFNESS.key,
        NodeQuantity::SOFTEST.key,
        "softest_x",
        "softest_y",
        "softest_z",
        NodeQuantity::K_JN.key,
        "turn_deg",
    ]
    .map(String::from)
    .to_vec();
    let joints = map.nodes.iter().find_map(|n| n.values.as_ref());
    let joints = joints.map_or(0, |v| v.q.len());
    headings.extend((1..=joints).map(|j| format!("q{j}_deg")));
    let micro = |v: Option<f64>| Cell::Number(v.map(|v| 1e6 * v));
    let rows = map.nodes.iter().map(|node| {
        let values = node.values.as_ref();
        let softest = values.map(|v| v.softest);
        let mut row: Vec<Cell> = node.position_m.map(|p| shortest_mm(p).into()).to_vec();
        row.extend([
            node.status.describe().into(),
            node.reason.clone().unwrap_or_default().into(),
            Cell::Number(node.distance_m.map(|d| 1e3 * d)),
            NodeQuantity::DEFLECTION.cell(values),
            micro(values.map(|v| v.deflection_m)),
            micro(values.and_then(|v| v.half_width_m)),
            NodeQuantity::STIFFNESS.cell(values),
            NodeQuantity::SOFTEST.cell(values),
        ]);
        row.extend([0, 1, 2].map(|i| Cell::Number(softest.map(|s| s.direction[i]))));
        row.push(NodeQuantity::K_JN.cell(values));
        row.push(values.and_then(|v| v.turn.map(rad_to_deg)).into());
        row.extend((0..joints).map(|j| Cell::Number(values.map(|v| rad_to_shortest_deg(v.q[j])))));
        row
    });
    Table {
        id: "map".into(),
        caption: "Stiffness and deflection of the tip over the workspace.".into(),
        headings,
        rows: rows.collect(),
    }
}

/// Metres in millimetres, to a nanometre.
pub(crate) fn shortest_mm(m: f64) -> f64 {
    rounded(m_to_mm(m), 6)
}
