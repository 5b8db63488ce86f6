//! Shapes of links, tool and surroundings, what is asked of them, and the tracker's stations.

use super::{Deg, Fixed, Mm, Number, Spanned, Text};

tables! {
    /// A capsule that contains (part of) a link: all points within a radius of a segment.
    struct RawLinkShape as "LinkShape" {
        /// The link: 0 is the base, i moves with joint i.
        link: Spanned<i64> [required, with = "i64", range(min = 0)],
        /// One end of the segment, mm: in the base frame for link 0, else in the frame that
        /// Denavit-Hartenberg row i ends in, T_1 ... T_i.
        from_mm: Fixed<3, Mm> [required],
        /// Its other end, mm.
        to_mm: Fixed<3, Mm> [required],
        /// The radius, mm.
        radius_mm: Number<Mm> [required],
    }

    /// A shape: of the tool, in flange axes, or of something that stands in the cell, in the base frame.
    struct RawShape as "Shape" {
        /// Its name; shapes of one name are one thing.
        name: Text [required],
        /// "box" (center_mm, size_mm, rpy_deg), "cylinder" or "capsule" (from_mm, to_mm, radius_mm; a
        /// capsule has half spheres at its ends), "mesh" (file, unit, xyz_mm, rpy_deg). What stands may also
        /// be a "floor" or a "ceiling" (z_mm) or a "wall" (point_mm, normal).
        kind: Text [required, extend("enum" = ["box", "cylinder", "capsule", "mesh", "floor", "ceiling", "wall"])],
        /// Centre of a box, mm.
        center_mm: Fixed<3, Mm>,
        /// Size of a box along its own axes, mm.
        size_mm: Fixed<3, Mm>,
        /// Roll, pitch, yaw of a box or mesh, degrees: turns about x, then y, then z of the frame it is
        /// given in (default: none).
        rpy_deg: Fixed<3, Deg>,
        /// One end of the axis of a cylinder or capsule, mm.
        from_mm: Fixed<3, Mm>,
        /// Its other end, mm.
        to_mm: Fixed<3, Mm>,
        /// Radius of a cylinder or capsule, mm.
        radius_mm: Number<Mm>,
        /// Height of a floor or a ceiling, mm.
        z_mm: Number<Mm>,
        /// A point on a wall, mm.
        point_mm: Fixed<3, Mm>,
        /// Direction from a wall into the cell, any length.
        normal: Fixed<3>,
        /// File of a mesh (.stl, .obj, .dae), counted from the folder of the cell file.
        file: Text,
        /// Unit of the mesh's numbers: "m" (default) or "mm". COLLADA files say their own.
        unit: Text [extend("enum" = ["m", "mm"])],
        /// Origin of the mesh in flange axes or in the base frame, mm (default: none).
        xyz_mm: Fixed<3, Mm>,
    }

    /// Distances that shapes, rope and beams keep.
    struct RawClearance as "Clearance" {
        /// Distance kept between two shapes, mm (default: 20).
        shapes_mm: Number<Mm>,
        /// Distance kept between the rope, or the cylinder's middle line, and every shape, mm (default: 20):
        /// it includes the cylinder's own radius.
        rope_mm: Number<Mm>,
        /// Lengths of the rope or cylinder at the loading point and at the anchor that may touch what they are
        /// fixed to, mm (default: [100, 100]).
        rope_free_mm: Fixed<2, Mm>,
        /// Axis of the loading device from the anchor outwards, base axes, any length; with rope_cone_deg.
        rope_axis: Fixed<3>,
        /// Largest angle between that axis and the rope, degrees.
        rope_cone_deg: Number<Deg>,
        /// Distance kept between a tracker's beam and every shape, mm (default: 5).
        sight_mm: Number<Mm>,
        /// How many measuring points one station must see (default: all).
        visible_points: Spanned<i64>,
        /// Pairs of shapes, by name, that may come as near as they like.
        ignore: Spanned<Vec<Spanned<Vec<Text>>>> [with = "Option<Vec<[String; 2]>>"],
    }

    /// A place of the tracker.
    struct RawStation as "Station" {
        /// Its name.
        name: Text [required],
        /// Where its beam goes out, base frame, mm.
        position_mm: Fixed<3, Mm> [required],
    }
}
