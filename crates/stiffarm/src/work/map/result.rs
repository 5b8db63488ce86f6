//! The whole map and what to say about it.

use super::node::MapNode;
use super::options::{AXES, MapOptions};
use super::reach::first_smallest;
use super::status::Status;
use crate::findings::{Finding, codes, length, percent};
use crate::model::cell::Cell;
use crate::plan::zones::{MapRange, range};
use crate::units::m_to_mm;
use crate::work::predict::PrincipalAxis;
use serde::{Deserialize, Serialize};

/// k(J_N) above which a posture is near a singular one.
const NEAR_SINGULAR: f64 = 100.0;

/// Nodes by status.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StatusCounts {
    /// Nodes that the arm may hold.
    pub reachable: usize,
    /// Nodes that a limit of the cell forbids.
    pub forbidden: usize,
    /// Nodes outside the cell's bounds.
    pub outside_joint_limits: usize,
    /// Nodes without a posture.
    pub unreachable: usize,
    /// Nodes that were not looked at, for the user stopped the work.
    pub not_computed: usize,
}

/// Nodes of the smallest and the largest deflection, counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MapExtremes {
    /// Where the tip bends least.
    pub best: usize,
    /// Where it bends most.
    pub worst: usize,
    /// Principal axes of a force without moment at the one and at the other, softest first.
    pub principal: Option<[[PrincipalAxis; 3]; 2]>,
}

/// Stiffness and deflection of the tip over a grid of positions, base frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StiffnessMap {
    /// Coordinates along x, ascending \[m\].
    pub x_m: Vec<f64>,
    /// Coordinates along y, ascending \[m\].
    pub y_m: Vec<f64>,
    /// Coordinates along z, ascending \[m\].
    pub z_m: Vec<f64>,
    /// Axes of the tip frame in base axes, rows of the rotation matrix; with a
    /// free turn, before it.
    pub rotation: [[f64; 3]; 3],
    /// Turns about the tool axis that were tried at each node, where it is free.
    pub free_turn: Option<usize>,
    /// Direction of `stiffness_n_per_m`, base axes.
    pub direction: [f64; 3],
    /// Force on the robot at the tip, base axes \[N\].
    pub force_n: [f64; 3],
    /// Moment about the tip, base axes \[N·m\].
    pub moment_nm: [f64; 3],
    /// Confidence of the bands.
    pub confidence: Option<f64>,
    /// True when the user stopped the work: some nodes are `not_computed`.
    pub interrupted: bool,
    /// Nodes by status.
    pub counts: StatusCounts,
    /// Deflection per newton \[m/N\]; `None` where nothing is reachable.
    pub deflection_per_newton_m: Option<MapRange>,
    /// Stiffness along the direction \[N/m\].
    pub stiffness_n_per_m: Option<MapRange>,
    /// Stiffness along each node's softest direction \[N/m\].
    pub softest_n_per_m: Option<MapRange>,
    /// k(J_N) of Eq. (21).
    pub k_jn: Option<MapRange>,
    /// Nodes that bend least and most.
    pub extremes: Option<MapExtremes>,
    /// Joint stiffness that the map was made with \[N·m/rad\], one per spring; `null` for one
    /// without a positive stiffness.
    pub stiffness_nm_per_rad: Vec<Option<f64>>,
    /// Name of the measuring point that stands for the tip; `null` where the cell gives the tip.
    pub tip_point: Option<String>,
    /// What to know about the map, in sentences.
    pub findings: Vec<Finding>,
    /// The nodes: x slowest, then y, z fastest.
    pub nodes: Vec<MapNode>,
}

impl StiffnessMap {
    /// Index of the node at these places along x, y and z.
    pub fn index(&self, at: [usize; 3]) -> usize {
        (at[0] * self.y_m.len() + at[1]) * self.z_m.len() + at[2]
    }

    /// Coordinates along x, y, z \[m\].
    pub fn axes(&self) -> [&[f64]; 3] {
        [&self.x_m, &self.y_m, &self.z_m]
    }
}

/// Puts the nodes together.
pub(super) fn summarise(
    cell: &Cell,
    options: &MapOptions,
    axes: [Vec<f64>; 3],
    nodes: Vec<MapNode>,
    confidence: Option<f64>,
) -> StiffnessMap {
    let count = |status| nodes.iter().filter(|n| n.status == status).count();
    let counts = StatusCounts {
        reachable: count(Status::Reachable),
        forbidden: count(Status::Forbidden),
        outside_joint_limits: count(Status::OutsideJointLimits),
        unreachable: count(Status::Unreachable),
        not_computed: count(Status::NotComputed),
    };
    let reached = || nodes.iter().filter_map(|n| n.values.as_ref());
    let sizes = || {
        let of = |(i, n): (usize, &MapNode)| Some((i, n.values.as_ref()?.deflection_m));
        nodes.iter().enumerate().filter_map(of)
    };
    // The first of mirrored places, which differ by rounding.
    let best = first_smallest(sizes());
    let worst = first_smallest(sizes().map(|(i, size)| (i, -size)));
    let extremes = best.zip(worst).map(|(best, worst)| MapExtremes { best, worst, principal: None });
    let matrix = options.rotation.to_rotation_matrix();
    let [x_m, y_m, z_m] = axes;
    let mut map = StiffnessMap {
        x_m,
        y_m,
        z_m,
        rotation: std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)])),
        free_turn: options.free_turn,
        direction: options.direction.into_inner().into(),
        force_n: options.wrench.force.into(),
        moment_nm: options.wrench.moment.into(),
        confidence,
        interrupted: counts.not_computed > 0,
        counts,
        deflection_per_newton_m: range(reached().map(|v| v.deflection_per_newton_m)),
        stiffness_n_per_m: range(reached().filter_map(|v| v.stiffness_n_per_m)),
        softest_n_per_m: range(reached().filter_map(|v| v.softest.stiffness_n_per_m)),
        k_jn: range(reached().filter_map(|v| v.k_jn)),
        extremes,
        stiffness_nm_per_rad: Vec::new(),
        tip_point: None,
        findings: Vec::new(),
        nodes,
    };
    map.findings = findings(cell, &map);
    map
}

/// A position in words.
pub(super) fn place_words(position: [f64; 3]) -> String {
    let named = AXES.iter().zip(position);
    let words: Vec<String> = named.map(|(name, v)| format!("{name} = {:.0}", m_to_mm(v) + 0.0)).collect();
    format!("{} mm", words.join(", "))
}

fn findings(cell: &Cell, map: &StiffnessMap) -> Vec<Finding> {
    let mut out = Vec::new();
    if map.interrupted {
        let done = map.nodes.len() - map.counts.not_computed;
        out.push(stopped(format!(
            "Stopped: {done} of {} nodes were computed, spread over the region; all that is said of the map holds for \
             these.",
            map.nodes.len()
        )));
    }
    if map.counts.reachable == 0 && map.counts.not_computed < map.nodes.len() {
        out.push(nothing_reachable(map));
    }
    if let Some(MapExtremes { best, worst, .. }) = map.extremes {
        let (best, worst) = (&map.nodes[best], &map.nodes[worst]);
        let size = |node: &MapNode| node.values.as_ref().map_or(0.0, |v| v.deflection_m);
        out.push(Finding::note(
            "spread",
            "deflection",
            format!(
                "The same force bends the tip {:.1} times as far at {} ({}) as at {} ({}).",
                size(worst) / size(best),
                place_words(worst.position_m),
                length(size(worst)),
                place_words(best.position_m),
                length(size(best))
            ),
        ));
    }
    let poor = |node: &&MapNode| {
        let k = node.values.as_ref().and_then(|v| v.k_jn);
        k.is_some_and(|k| k > NEAR_SINGULAR)
    };
    let poor = map.nodes.iter().filter(poor).count();
    if poor > 0 {
        out.push(Finding::note(
            "near-singular",
            "posture",
            format!(
                "At {} of the reachable nodes k(J_N) is above {NEAR_SINGULAR}: a small way of the tip swings joints \
                 far there.",
                percent(poor as f64 / map.counts.reachable as f64)
            ),
        ));
    }
    if map.confidence.is_none() {
        out.push(no_band());
    }
    if cell.setup.robot.limits_are_unknown() {
        out.push(unknown_limits());
    }
    out
}

/// The user did not wait for the end.
pub(super) fn stopped(sentence: String) -> Finding {
    Finding::caution("stopped", "region", sentence)
}

/// Nothing says how sure the deflections are.
pub(super) fn no_band() -> Finding {
    Finding::caution(
        "no-band",
        "stiffness",
        "The joint stiffness comes without covariance: nothing says how sure these deflections are.",
    )
}

/// Reachable is only what the joints' limits allow.
pub(super) fn unknown_limits() -> Finding {
    Finding::caution(
        "unknown-limits",
        "robot",
        "The machine's joint limits are not known, so the real arm may reach less: give robot.limits_deg.",
    )
}

/// Says what comes closest.
fn nothing_reachable(map: &StiffnessMap) -> Finding {
    let rank = |status| match status {
        Status::Forbidden => 0,
        Status::OutsideJointLimits => 1,
        _ => 2,
    };
    let far = |n: &MapNode| n.distance_m.unwrap_or(0.0);
    let computed = map.nodes.iter().filter(|n| n.status != Status::NotComputed);
    let nearest = computed.min_by(|a, b| rank(a.status).cmp(&rank(b.status)).then(far(a).total_cmp(&far(b))));
    let closest = nearest.map_or_else(String::new, |node| {
        format!(
            " Closest comes {}: {}.",
            place_words(node.position_m),
            node.reason.as_deref().unwrap_or(node.status.describe())
        )
    });
    Finding::serious(
        codes::NOTHING_REACHABLE,
        "region",
        format!("No node of the map is reachable with this orientation.{closest}"),
    )
}
