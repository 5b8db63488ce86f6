//! Commented files to start from: what `stiffarm init` writes.

use super::bounds::{margin_comment, middle, narrowed, start_bounds};
use super::convert::PAPER_VARIANCE_MM2;
use super::example::{Example, comment, doubts, pendant};
use super::lists::{degrees, quoted, rows};
use super::robot_keys::{keys, reach, route, shapes};
use crate::check_name;
use stiffarm::error::Result;
use stiffarm::findings::visible;
use stiffarm::model::robot::{CatalogueEntry, DhRobot, JointStiffness, LinkCapsule, Robot, find_in_catalogue};
use stiffarm::units::rad_to_shortest_deg;

/// A commented `cell.toml` for a robot of the catalogue, ready to be read by
/// [`parse_cell`](super::parse_cell) and to be edited: unit, axes and sign
/// stand at every key. Tool, load and limits are those of the built-in COMAU
/// cell, an example for robots of some 3 m reach; for a small robot its lengths
/// are scaled with the reach and its forces with the payload.
///
/// # Errors
/// The catalogue has no robot of this name.
pub fn template(robot_key: &str) -> Result<String> {
    let entry = find_in_catalogue(robot_key)?;
    let robot = entry.robot()?;
    let example = Example::new(entry.reach_m(), entry.payload_kg(), &robot);
    let frames = format!(
        "# Angles are those on the pendant. Base frame: the robot's own, z up along axis 1,\n\
         # x to the front with joint 1 at 0 degrees. Flange axes: those of the last frame of\n\
         # the robot's kinematics, {out} out of the flange. Forces act on the robot.\n\
         {pendant}{made}",
        out = example.outward(),
        pendant = pendant(&robot),
        made = example.sentence(),
    );
    let keys = format!(
        "# `stiffarm robots` lists the catalogue. A robot of your own instead: one row\n\
         # [alpha_deg, a_mm, d_mm, offset_deg] per joint in dh_modified or dh_standard,\n\
         # theta_from_q for signs and couplings of the controller's angles, limits_deg.\n\
         catalogue = \"{}\"\n\
         # The machine's limits of the controller angles, if yours differ:\n\
         {}\n",
        entry.key,
        limits_comment(&robot, entry)
    );
    let bounds = start_bounds(entry, &robot);
    Ok(text(&Start {
        name: entry.name,
        frames,
        doubts: doubts(&robot),
        keys,
        shapes: String::new(),
        margin_comment: margin_comment(&robot, &bounds),
        bounds,
        stiffness: entry.stiffness,
        is_upright: true,
        joints: robot.joint_count(),
        example,
    }))
}

/// A commented `cell.toml` as [`template`] for a robot that is in no catalogue;
/// `origin` says in a sentence or two where it comes from and what its angles are.
/// The rows are written to 1e-11° and 1e-10 mm. Tool, load and limits are scaled with
/// the robot's reach.
///
/// # Errors
/// What [`DhRobot::robot`] refuses.
pub fn template_of(robot: &DhRobot, origin: &str) -> Result<String> {
    template_with_shapes(robot, origin, &[])
}

/// As [`template_of`], with capsules around the links as `[[robot.shape]]`; they grow by
/// less than 0.02 mm where their numbers are rounded.
///
/// # Errors
/// As [`template_of`].
pub fn template_with_shapes(robot: &DhRobot, origin: &str, capsules: &[LinkCapsule]) -> Result<String> {
    let chain = robot.robot()?;
    let example = Example::new(Some(reach(&chain)), None, &chain);
    let axis = chain.joints()[0].placement.rotation * nalgebra::Vector3::z();
    let is_upright = axis.z.abs() > 0.999;
    let out = example.outward();
    let bounds = narrowed(&chain);
    let frames = format!(
        "{}# Flange axes: {out} out of the flange. Forces act on the robot.\n{}",
        comment(&visible(origin)),
        example.sentence()
    );
    Ok(text(&Start {
        name: &robot.name,
        frames,
        doubts: String::new(),
        keys: keys(robot)?,
        shapes: shapes(&chain, capsules) + &route(robot),
        margin_comment: margin_comment(&chain, &bounds),
        bounds,
        stiffness: &[],
        is_upright,
        joints: chain.joint_count(),
        example,
    }))
}

/// What differs from robot to robot.
struct Start<'a> {
    name: &'a str,
    /// Comments on angles and frames.
    frames: String,
    /// Comments on what to distrust.
    doubts: String,
    /// The keys of `[robot]` that say which it is.
    keys: String,
    /// Shapes of the links.
    shapes: String,
    /// Bounds to start from \[deg\], and a comment on what they keep off the machine's limits.
    bounds: Vec<[f64; 2]>,
    margin_comment: String,
    stiffness: &'a [JointStiffness],
    /// Axis 1 stands upright in the base frame, as the example's limits have it.
    is_upright: bool,
    joints: usize,
    example: Example,
}

fn text(start: &Start<'_>) -> String {
    let example = &start.example;
    let (point, length, force) =
        (|xyz: [i32; 3]| example.point(xyz), |mm: i32| example.length(mm), |n: i32| example.force(n));
    format!(
        r#"# Cell of {name} for stiffarm. Every key carries its unit: _mm, _deg, _n, ….
{frames}# Replace what is marked EDIT.
{doubts}format = 1
name = {quoted}  # EDIT

[robot]
{keys}# Gravity in base axes; [0, 0, 1] for a robot hanging from the ceiling with its base frame.
down = [0, 0, -1]
{shapes}
[bounds]
# Controller angles between which postures are chosen: [low, high] per joint.
# Narrow them to what is safe and visible in your cell. EDIT
{margin_comment}q_deg = [
{bounds}]

[tool]
# Where the rope, weight or wrench acts: x, y, z in flange axes. Off the axis
# of the last joint, or that joint carries no torque and stays unknown. EDIT
loading_point_mm = {loading}
# true when a force sensor sits between flange and reflectors.
has_sensor = false

# The reflectors, in flange axes; the first is the tool centre point. The names
# stand in the measurement table. EDIT
[[tool.measuring_point]]
name = "1"
position_mm = {p1}

[[tool.measuring_point]]
name = "2"
position_mm = {p2}

[[tool.measuring_point]]
name = "3"
position_mm = {p3}

[[tool.measuring_point]]
name = "4"
position_mm = {p4}

# Known compliance between flange and reflectors (sensor, adapter): its share of
# each displacement is subtracted. Stiffness along and about the flange axes.
# [tool.series_compliance]
# origin_mm = [0, 0, 60]
# translational_n_per_m = [7.5e7, 7.5e7, 1.2e8]
# rotational_nm_per_rad = [3.3e5, 3.3e5, 3.3e5]

[load]
# The force on the robot.
#   "rope":     pulls from the loading point towards the fixed anchor_mm
#   "cylinder": as a rope, with acts = "pulls" or "pushes"; or, where it is guided,
#               direction = [x, y, z] in axes = "base" or "tool" instead of anchor_mm
#   "weight":   hangs on the loading point, along gravity
#               (on a floor-mounted robot it leaves joint 1 without torque)
#   "wrench":   constant force_n, moment_nm (about the loading point) in axes = "base" or "tool"
#   "measured": fx_n, fy_n, fz_n come with each measurement: as the [sensor] reports
#               them, without one in base axes
#   "cases":    several loads at each posture, each in a table [[load.case]] with a name
kind = "rope"
magnitude_n = {magnitude}  # EDIT
anchor_mm = [{anchor}, 0, 0]  # EDIT: the rope's fixed end, base frame

[limits]
# Where postures may bring the robot, base frame; leave out what does not apply. EDIT
# Box for loading point, measuring points and flange:
{limit}box_min_mm = [{near}, -{side}, {low}]
{limit}box_max_mm = [{far}, {side}, {far}]
# Radius about axis 1 that these points and the wrist centre stay out of:
{limit}keep_out_radius_mm = {near}
# Lowest z of the wrist centre:
{limit}wrist_height_mm = {low}
# Shortest and longest rope or cylinder:
rope_length_mm = [{short}, {long}]
# Smallest and largest displacement under the load (RMS over the measuring points, by the prior stiffness):
# displacement_mm = [0.2, 3]
# Lowest z of loading point, measuring points and flange, where there is no box:
# floor_mm = 0

[noise]
# Variance of one tracker reading per axis. The default is the FARO tracker of
# Zhang et al. 2021; measure yours by reading one fixed reflector many times. EDIT
variance_mm2 = {variance:e}
# 2: a displacement is the difference of a loaded and an unloaded reading.
# 1: the variance is already that of a displacement (as the paper counts).
readings_per_displacement = 2
# Standard deviation of what shifts all reflectors of a posture alike (load, rope, drift).
posture_common_mm = 0

{stiffness}
# How much gives way beyond the joint axes, for the index prediction and simulate --elastic:
# sizes as `stiffarm identify --elastic mixed` prints them, of this arm or one like it
# (default: typical of an arm of this length and stiffness). All three or none; these are
# those of a measured robot of 165 kg payload.
# [elastic]
# shift_std_m_per_n = 9e-8
# turn_std_rad_per_nm = 1.4e-7
# coupling_std_rad_per_n = 7.6e-8
# What a drawing or a catalogue says of bearings, links and base; identify takes it beside the
# readings. Lists: one per joint, 0 where it is not known. These are of that size.
# bearing_tilt_nm_per_rad = [1.7e7, 1.7e7, 1e7, 4e6, 3.2e6, 1.3e6]
# base_tilt_nm_per_rad = 1e8
# link_bending_nm2 = [2e7, 1e7, 0, 3e6, 0, 0]    # E I of the link behind each joint
# stiffness_factor = 1.5   # each may be as many times stiffer or softer

# The force sensor, if forces are read from one. Its axes and its sign are never guessed.
# [sensor]
# mount = "flange"        # "flange": between flange and tool; "base": fixed in the cell
# xyz_mm = [0, 0, 60]     # its origin, in flange axes or the base frame
# rpy_deg = [0, 0, 30]    # its axes: turns about x, then y, then z of these
# reports = "on_robot"    # what acts on the robot; "by_robot": what the robot exerts

# The laser tracker. Without xyz_mm and rpy_deg the readings say where it stands; zeros
# if they are in base axes already. Its accuracy as standard deviations.
# [tracker]
# xyz_mm = [3500, -1200, 900]
# rpy_deg = [0, 0, 150]
# station_mm = [0, 0, 0]
# range_um = 10
# range_um_per_m = 0.4
# angle_urad = 3

# Standard uncertainty of errors that are the same all through.
# [uncertainty]
# force_scale_percent = 0.5
# anchor_mm = 5
# loading_point_mm = 1
# registration_mrad = 0.2
# base_tilt_stiffness_nm_per_rad = 1e8
# sensor_stiffness_nm_per_rad = 3.3e5
# force_beside_n = 5
# common_shift_mm = 0.02
# lost_motion_arcmin = 0.2

# What measuring takes, for the minutes of a plan and select --minutes; these are assumed.
# [time]
# posture_min = 3          # a posture, read without load and under the first one
# further_load_min = 1     # each further load in it: a weight hung, the rope at another anchor
# further_anchor_min = 10  # each further anchor, once

# Headings of the tracker's software, if it has its own: ours, with the unit of the
# table, = theirs. Columns in ignore do not matter.
# [columns]
# point = "Name"
# x_mm = "Center X"
# y_mm = "Center Y"
# z_mm = "Center Z"
# ignore = ["Comment", "Target type"]

# Postures kept out of the identification, to check its result. They are held
# to the machine's limits, not to the bounds.
# [[validation.posture]]
# name = "V1"
# q_deg = {middle}

# Your own machining postures and process forces, once for each: `select --index task`
# chooses postures so that the deflection predicted there is as sure as possible.
# force_n acts on the robot at tip_mm (flange axes; default: the first measuring point),
# in axes = "base" (default) or "tool"; moment_nm about the tip may be added.
# [[task]]
# name = "roughing"
# q_deg = {middle}
# force_n = {roughing}
# axes = "base"
# tip_mm = {p1}

# What the robot works with along a path. The tip frame in flange axes: its origin is the
# contact point, its z the tool axis, out of the tool into the workpiece. The workpiece
# frame in the base frame: the poses of a path are given in it. Turns about x, then y, then z.
# [work]
# tip_mm = {tip}
# tip_rpy_deg = [0, 0, 0]
# workpiece_mm = [{piece}, 0, {piece_height}]
# workpiece_rpy_deg = [0, 0, 0]

# The load on the robot at the tip where the path's rows give none: either one force, in
# axes = "base", "tool", "workpiece" or "path" (x the feed, z the tool axis) …
# [work.force]
# force_n = {roughing}
# moment_nm = [0, 0, 0]
# axes = "path"

# … or the mean load of a milling cut. direction: "up" (conventional: workpiece to the left
# of the feed, seen from the spindle) or "down" (climb). Coefficients of cutter and material:
# k_tc … of the chip's area in N/mm², k_te … of the edge's length in N/mm.
# [work.milling]
# teeth = 2
# diameter_mm = 16
# axial_depth_mm = 3
# radial_depth_mm = 8
# feed_per_tooth_mm = 0.1  # or spindle_rpm: the path then gives the feed
# direction = "down"
# k_tc_n_per_mm2 = 800  # EDIT: of the order of aluminium alloys
# k_rc_n_per_mm2 = 200
# k_ac_n_per_mm2 = 100
# k_te_n_per_mm = 20
# k_re_n_per_mm = 20
# k_ae_n_per_mm = 0

# What differs at a feature of the part that the path names: load (also milling) and tolerance.
# [[work.feature]]
# name = "POCKET 1"
# tolerance_mm = 0.3
# force = {{ force_n = {roughing}, axes = "path" }}
"#,
        name = start.name,
        quoted = quoted(&cell_name(start.name)),
        frames = start.frames,
        doubts = start.doubts,
        keys = start.keys,
        shapes = start.shapes,
        limit = if start.is_upright { "" } else { "# " },
        loading = point([200, 0, 250]),
        p1 = point([150, 0, 200]),
        p2 = point([0, 150, 200]),
        p3 = point([-150, 0, 200]),
        p4 = point([0, -150, 200]),
        tip = point([150, 0, 250]),
        magnitude = force(500),
        roughing = format!("[{}, {}, {}]", force(-200), force(150), force(100)),
        anchor = length(1800),
        near = length(900),
        side = length(1900),
        low = length(300),
        far = length(3000),
        short = length(800),
        long = length(3400),
        piece = length(1500),
        piece_height = length(600),
        bounds = rows(&start.bounds),
        margin_comment = start.margin_comment,
        variance = PAPER_VARIANCE_MM2,
        stiffness = stiffness(start),
        middle = degrees(&middle(&start.bounds)),
    )
}

/// A name for the cell that is no longer than names may be.
fn cell_name(robot: &str) -> String {
    let name = format!("{robot} cell");
    match check_name(&name) {
        Ok(()) => name,
        Err(_) => robot.to_string(),
    }
}

fn limits_comment(robot: &Robot, entry: &CatalogueEntry) -> String {
    let rows = robot.joints().iter().map(|joint| degrees(&joint.limits.map(rad_to_shortest_deg)));
    let rows: Vec<String> = rows.collect();
    let doubt = if entry.has_limits() { "" } else { "  # not in the catalogue; see the data sheet" };
    format!("# limits_deg = [{}]{doubt}", rows.join(", "))
}

fn stiffness(start: &Start<'_>) -> String {
    let intro = "[stiffness]\n\
                 # Joint stiffness known beforehand: weighs the joints against each other when\n\
                 # postures are chosen. Orders of magnitude suffice.\n";
    match start.stiffness.first() {
        Some(set) => {
            let doubt = if set.verified { "" } else { " (unverified)" };
            let values: Vec<String> = set.values.iter().map(f64::to_string).collect();
            format!("{intro}# From: {}{doubt}\nprior_nm_per_rad = [{}]\n", set.source, values.join(", "))
        }
        None => {
            let values: Vec<String> = start.example.prior(start.joints).iter().map(f64::to_string).collect();
            format!(
                "{intro}# Nothing is published for this robot; a robot of 165 kg payload as a guess, scaled\n\
                 # with force and reach to a smaller one: EDIT\n\
                 # prior_nm_per_rad = [{}]\n",
                values.join(", ")
            )
        }
    }
}
