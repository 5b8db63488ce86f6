//! Shapes of links, tool and surroundings, what is asked of them, and the tracker's stations.

use super::{At, Deg, Fixed, Mm, Number, Text};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;

/// A capsule that contains (part of) a link: all points within a radius of a segment.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "LinkShape"))]
#[serde(deny_unknown_fields)]
pub(in crate::files::cell) struct RawLinkShape {
    /// The link: 0 is the base, i moves with joint i.
    #[cfg_attr(feature = "schema", schemars(required, with = "i64", range(min = 0)))]
    pub link: Option<At<i64>>,
    /// One end of the segment, mm: in the base frame for link 0, else in the frame that
    /// Denavit-Hartenberg row i ends in, T_1 ... T_i.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub from_mm: Option<Fixed<3, Mm>>,
    /// Its other end, mm.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub to_mm: Option<Fixed<3, Mm>>,
    /// The radius, mm.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub radius_mm: Option<Number<Mm>>,
}

/// A shape: of the tool, in flange axes, or of something that stands in the cell, in the base frame.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Shape"))]
#[serde(deny_unknown_fields)]
pub(in crate::files::cell) struct RawShape {
    /// Its name; shapes of one name are one thing.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub name: Option<Text>,
    /// "box" (center_mm, size_mm, rpy_deg), "cylinder" or "capsule" (from_mm, to_mm, radius_mm; a
    /// capsule has half spheres at its ends), "mesh" (file, unit, xyz_mm, rpy_deg). What stands may also
    /// be a "floor" or a "ceiling" (z_mm) or a "wall" (point_mm, normal).
    #[cfg_attr(
        feature = "schema",
        schemars(required, extend("enum" = ["box", "cylinder", "capsule", "mesh", "floor", "ceiling", "wall"]))
    )]
    pub kind: Option<Text>,
    /// Centre of a box, mm.
    pub center_mm: Option<Fixed<3, Mm>>,
    /// Size of a box along its own axes, mm.
    pub size_mm: Option<Fixed<3, Mm>>,
    /// Roll, pitch, yaw of a box or mesh, degrees: turns about x, then y, then z of the frame it is
    /// given in (default: none).
    pub rpy_deg: Option<Fixed<3, Deg>>,
    /// One end of the axis of a cylinder or capsule, mm.
    pub from_mm: Option<Fixed<3, Mm>>,
    /// Its other end, mm.
    pub to_mm: Option<Fixed<3, Mm>>,
    /// Radius of a cylinder or capsule, mm.
    pub radius_mm: Option<Number<Mm>>,
    /// Height of a floor or a ceiling, mm.
    pub z_mm: Option<Number<Mm>>,
    /// A point on a wall, mm.
    pub point_mm: Option<Fixed<3, Mm>>,
    /// Direction from a wall into the cell, any length.
    pub normal: Option<Fixed<3>>,
    /// File of a mesh (.stl, .obj, .dae), counted from the folder of the cell file.
    pub file: Option<Text>,
    /// Unit of the mesh's numbers: "m" (default) or "mm". COLLADA files say their own.
    #[cfg_attr(feature = "schema", schemars(extend("enum" = ["m", "mm"])))]
    pub unit: Option<Text>,
    /// Origin of the mesh in flange axes or in the base frame, mm (default: none).
    pub xyz_mm: Option<Fixed<3, Mm>>,
}

/// Distances that shapes, rope and beams keep.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Clearance"))]
#[serde(deny_unknown_fields)]
pub(in crate::files::cell) struct RawClearance {
    /// Distance kept between two shapes, mm (default: 20).
    pub shapes_mm: Option<Number<Mm>>,
    /// Distance kept between the rope, or the cylinder's middle line, and every shape, mm (default: 20):
    /// it includes the cylinder's own radius.
    pub rope_mm: Option<Number<Mm>>,
    /// Lengths of the rope or cylinder at the loading point and at the anchor that may touch what they are
    /// fixed to, mm (default: [100, 100]).
    pub rope_free_mm: Option<Fixed<2, Mm>>,
    /// Axis of the loading device from the anchor outwards, base axes, any length; with rope_cone_deg.
    pub rope_axis: Option<Fixed<3>>,
    /// Largest angle between that axis and the rope, degrees.
    pub rope_cone_deg: Option<Number<Deg>>,
    /// Distance kept between a tracker's beam and every shape, mm (default: 5).
    pub sight_mm: Option<Number<Mm>>,
    /// How many measuring points one station must see (default: all).
    pub visible_points: Option<At<i64>>,
    /// Pairs of shapes, by name, that may come as near as they like.
    #[cfg_attr(feature = "schema", schemars(with = "Option<Vec<[String; 2]>>"))]
    pub ignore: Option<At<Vec<At<Vec<Text>>>>>,
}

/// A place of the tracker.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Station"))]
#[serde(deny_unknown_fields)]
pub(in crate::files::cell) struct RawStation {
    /// Its name.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub name: Option<Text>,
    /// Where its beam goes out, base frame, mm.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub position_mm: Option<Fixed<3, Mm>>,
}
