//! Stiffness over a region of the workspace, and the best place for a workpiece.
//!
//! A map holds the tip at the nodes of a grid, with one orientation, under one
//! load. Each node has the posture that bends least among those that the arm,
//! its limits and the cell's limits allow.

mod follow;
mod node;
mod options;
mod place_evaluation;
mod placement;
mod prepared;
mod reach;
mod result;
mod search;
mod status;

pub use crate::plan::zones::MapRange;
pub use node::{MapNode, NodeValues};
pub use options::{MOST_TURNS, MapOptions};
pub use place_evaluation::{PlaceEvaluation, PlaceOptions, PlacedPoint, PlacementCandidate};
pub use placement::{Placement, place};
pub use result::{MapExtremes, StatusCounts, StiffnessMap};
pub use status::Status;

use crate::error::Result;
use crate::estimate::compliance::IdentifiedCompliance;
use crate::model::cell::Cell;
use crate::model::implausible;
use crate::numerics::control::Control;
use crate::numerics::jobs::as_far_as;
use crate::work::predict::{Bands, LoadedArm};
use node::evaluate;
use reach::Reach;

/// Maps what the tip does over the grid of `options`.
///
/// Stiffness is that of the loaded springs without K_C, the tip being free to
/// turn; deflections are those of the exact equilibrium under the map's load. The
/// values of a node are those that [`predict`](crate::work::predict::predict()) gives for
/// its posture.
///
/// A node is allowed to the arm where a posture lies within the cell's bounds
/// and limits, which hold for the tip, the cell's tool points, the flange and
/// the wrist; the rope's length is left out, for there is no rope at work.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::estimate::compliance::IdentifiedCompliance;
/// use stiffarm::work::map::{MapOptions, stiffness_map};
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
///
/// let cell = builtin::cell("comau")?;
/// let catalogue = IdentifiedCompliance::from_stiffness(&cell, cell.require_prior()?)?;
/// let plane = MapOptions::new([1.2, -0.6, 0.8], [2.0, 0.6, 0.8], [5, 7, 1]);
/// let map = stiffness_map(&cell, &catalogue, &plane, Control::default())?;
/// let stiffest = map.nodes.iter().filter_map(|node| node.values.as_ref());
/// assert!(stiffest.count() > 10);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// A grid that is no grid, or larger than [`MapOptions::MOST_NODES`]; a load without
/// force; an unknown without positive value; a load that buckles the arm. Stopped,
/// it gives the nodes that were computed.
pub fn stiffness_map(
    cell: &Cell,
    predictor: &IdentifiedCompliance,
    options: &MapOptions,
    control: Control<'_>,
) -> Result<StiffnessMap> {
    let axes = options.axes()?;
    let arm = LoadedArm::new(cell, predictor)?;
    arm.check_all_determined("a map shows all that gives way")?;
    let bands = Bands::new(predictor, 0.0)?;
    let reach = Reach::new(cell, &arm);
    let mut positions = Vec::with_capacity(axes.iter().map(Vec::len).product());
    for x in &axes[0] {
        for y in &axes[1] {
            positions.extend(axes[2].iter().map(|z| [*x, *y, *z]));
        }
    }
    let rotations = options.rotations();
    let nodes = as_far_as(&positions, "mapping", control, |(_, position)| {
        let turns = (rotations.as_slice(), control);
        evaluate(&reach, bands.as_ref(), options, turns, *position)
    })?;
    let nodes = nodes.into_iter().zip(&positions);
    let nodes = nodes.map(|(node, at)| node.unwrap_or_else(|| MapNode::not_computed(*at)));
    let nodes = nodes.collect();
    let confidence = bands.map(|b| b.confidence);
    let mut map = result::summarise(cell, options, axes, nodes, confidence);
    map.stiffness_nm_per_rad = predictor.spring_stiffness(cell);
    if let Some(extremes) = &mut map.extremes {
        let of = |node: usize| {
            let values = map.nodes[node].values.as_ref();
            let q = values.map_or(&[][..], |v| &v.q);
            Ok(arm.principal(&arm.terms(q, &options.wrench)?))
        };
        extremes.principal = Some([of(extremes.best)?, of(extremes.worst)?]);
    }
    map.findings.splice(0..0, predictor.doubts.iter().cloned());
    map.findings.extend(implausible::process(cell));
    map.tip_point = cell.work.tip_point(&cell.setup.tool);
    map.findings.extend(cell.work.tip_assumed(&cell.setup.tool));
    let load = implausible::load(arm.robot(), [("force", &options.wrench)]);
    map.findings.extend(load);
    Ok(map)
}
