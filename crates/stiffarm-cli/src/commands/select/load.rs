//! The load chosen together with the postures.

use crate::args::LoadArgs;
use stiffarm::plan::select::LoadDesign;
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
