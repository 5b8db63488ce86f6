//! The load chosen together with the postures.

use crate::args::LoadArgs;
use crate::numbers::coarse_mm;
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::model::cell::Cell;
use stiffarm::plan::select::{DesignedLoad, LoadDesign};
use stiffarm::units::mm_to_m;

/// What of the load might be chosen.
#[derive(Debug, Serialize, JsonSchema)]
pub struct LoadOptions {
    /// Lowest and highest corner for the anchor, base axes \[m\]; `null` where it stays.
    pub anchor_box_m: Option<[[f64; 3]; 2]>,
    /// Lowest and highest corner for the loading point, flange axes \[m\]; `null` where it stays.
    pub loading_point_box_m: Option<[[f64; 3]; 2]>,
    /// Largest force allowed \[N\]; `null` where the cell's stays.
    pub largest_load_n: Option<f64>,
}

/// The design that the command line asks for.
pub fn design(args: &LoadArgs) -> LoadDesign {
    let corners = |all: [f64; 6]| {
        let m = all.map(mm_to_m);
        [[m[0], m[1], m[2]].into(), [m[3], m[4], m[5]].into()]
    };
    let mut design = LoadDesign::default();
    design.anchor = args.anchor_box_mm.map(corners);
    design.loading_point = args.loading_point_box_mm.map(corners);
    design.magnitude = args.largest_load_n;
    design
}

/// The design as options of the result, `None` where nothing may move.
pub fn options(design: &LoadDesign) -> Option<LoadOptions> {
    (!design.is_empty()).then(|| LoadOptions {
        anchor_box_m: design.anchor.map(|corners| corners.map(Into::into)),
        loading_point_box_m: design.loading_point.map(|corners| corners.map(Into::into)),
        largest_load_n: design.magnitude,
    })
}

/// The cell with the load that was chosen.
pub fn applied(cell: &Cell, chosen: Option<&DesignedLoad>) -> Cell {
    chosen.map_or_else(|| cell.clone(), |chosen| chosen.applied(cell))
}

/// The lines of cell.toml that the plan holds for.
pub fn lines(design: &LoadDesign, chosen: &DesignedLoad) -> String {
    // A tenth of a millimetre is finer than anybody rigs a rope.
    let point = |key: &str, m: [f64; 3]| {
        let mm = m.map(coarse_mm);
        format!("  {key} = [{}]\n", mm.join(", "))
    };
    let mut tool = String::new();
    let mut load = String::new();
    if design.loading_point.is_some() {
        tool += &point("loading_point_mm", chosen.loading_point_m);
    }
    if let (Some(_), Some(newtons)) = (design.magnitude, chosen.magnitude_n) {
        load += &format!("  magnitude_n = {newtons}\n");
    }
    if let (Some(_), Some(anchor)) = (design.anchor, chosen.anchor_m) {
        load += &point("anchor_mm", anchor);
    }
    let mut out = String::new();
    for (table, keys) in [("tool", tool), ("load", load)] {
        if !keys.is_empty() {
            out += &format!("  [{table}]\n{keys}");
        }
    }
    out
}
