//! `[work]`: tool tip, workpiece, and the load of the process.

use super::{Deg, Fixed, Mm, Number, Spanned, Text};
use crate::cell::value::{NPerMm, NPerMm2, Rpm};

tables! {
    /// What the robot works with: tool tip, workpiece, and the load of the process where a path's
    /// rows do not give it (`force` or `milling`).
    struct RawWork as "Work" {
        /// Tool tip, the contact point, in flange axes, mm (default: the first measuring point).
        tip_mm: Fixed<3, Mm>,
        /// Roll, pitch, yaw of the tip frame, degrees: turns about the flange's x, then y, then z
        /// axis (default: none). Its z is the tool axis, out of the tool into the workpiece.
        tip_rpy_deg: Fixed<3, Deg>,
        /// Origin of the workpiece frame, in which the poses of a path are given, in the base frame,
        /// mm (default: zeros).
        workpiece_mm: Fixed<3, Mm>,
        /// Roll, pitch, yaw of the workpiece frame, degrees: turns about the base's x, then y, then
        /// z axis (default: none).
        workpiece_rpy_deg: Fixed<3, Deg>,
        /// Rotary axes of the machine that a path in G-code is for, in order from the workpiece to the
        /// tool: "A" turns about x, "B" about y, "C" about z; with a minus, as "-A", it carries the
        /// workpiece. A head that turns about C and then A is ["C", "A"], a table ["-A", "-C"] (default:
        /// none).
        rotary_axes: Spanned<Vec<Text>>,
        /// The same load all along the path.
        force: Spanned<RawForce>,
        /// The mean load of a milling cut.
        milling: Spanned<RawMilling>,
        /// What differs at features of the part that a path names: operations, layers, tool paths.
        feature: Spanned<Vec<Spanned<RawFeature>>>,
    }

    /// Load and tolerance of a feature of the part, where they are not those of the whole path.
    struct RawFeature as "Feature" {
        /// Its name as the path gives it.
        name: Text [required],
        /// How far it may come out beside where it should be, across the feed, mm (default: that of
        /// --tolerance-mm).
        tolerance_mm: Number<Mm>,
        /// Its load, the same all along.
        force: Spanned<RawForce>,
        /// Its load, the mean of a milling cut.
        milling: Spanned<RawMilling>,
    }

    /// A load that is the same all along the path.
    struct RawForce as "Force" {
        /// Force on the robot at the tip, N, in the axes named by `axes`.
        force_n: Fixed<3> [required],
        /// Moment on the robot about the tip, N·m, in the axes named by `axes` (default: none).
        moment_nm: Fixed<3>,
        /// Axes of force_n and moment_nm: "base", "tool" (the tip frame), "workpiece", or "path" (z
        /// the tool axis, x the feed across it, y = z × x).
        axes: Text [required, extend("enum" = ["base", "tool", "workpiece", "path"])],
        /// Power of the spindle at which this force acts, W: a log of the power then scales it (default:
        /// none).
        power_w: Number,
        /// Power of the spindle that idles, W (default: 0).
        idle_power_w: Number,
    }

    /// A milling cut with a cylindrical cutter, which turns clockwise seen from the spindle; its
    /// mean load acts on the tip.
    struct RawMilling as "Milling" {
        /// Number of teeth.
        teeth: Spanned<i64> [required, with = "i64", range(min = 1)],
        /// Diameter of the cutter, mm.
        diameter_mm: Number<Mm> [required],
        /// Depth of cut along the tool axis, mm.
        axial_depth_mm: Number<Mm> [required],
        /// Width of cut across feed and tool axis, mm; at most the diameter, which is a full slot.
        radial_depth_mm: Number<Mm> [required],
        /// Feed per tooth, mm: feed rate / (spindle speed · teeth). Either this or spindle_rpm.
        feed_per_tooth_mm: Number<Mm>,
        /// Speed of the spindle, turns per minute: the feed per tooth is then that of each point of the
        /// path, from the feed that the path gives there.
        spindle_rpm: Number<Rpm>,
        /// "up" (conventional: the workpiece lies to the left of the feed, seen from the spindle) or
        /// "down" (climb: to the right).
        direction: Text [required, extend("enum" = ["up", "down"])],
        /// Tangential cutting coefficient, N/mm² (the specific cutting force).
        k_tc_n_per_mm2: Number<NPerMm2> [required],
        /// Radial cutting coefficient, N/mm².
        k_rc_n_per_mm2: Number<NPerMm2> [required],
        /// Axial cutting coefficient, N/mm²: above zero where it pulls the tool out of the spindle,
        /// as a right-hand helix does (default: 0).
        k_ac_n_per_mm2: Number<NPerMm2>,
        /// Tangential edge coefficient, N/mm (default: 0).
        k_te_n_per_mm: Number<NPerMm>,
        /// Radial edge coefficient, N/mm (default: 0).
        k_re_n_per_mm: Number<NPerMm>,
        /// Axial edge coefficient, N/mm, signed as k_ac_n_per_mm2 (default: 0).
        k_ae_n_per_mm: Number<NPerMm>,
    }
}
