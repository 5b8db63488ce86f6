//! The load chosen together with the postures.

use crate::args::LoadArgs;
use crate::numbers::coarse_mm;
use stiffarm::plan::select::{DesignedLoad, LoadDesign};
use stiffarm::units::mm_to_m;

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
