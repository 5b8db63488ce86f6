//! Mistakes that people make with a set-up, one row each, planted on a simulated day.

use super::days::{Kind, add_displacement, each_loaded};
use crate::common::prelude::*;
use crate::screening::each_position;
use crate::screening::single_faults::couple;
use stiffarm::model::measurement::Role;

/// What is planted.
#[derive(Clone, Copy)]
pub enum Plant {
    /// In the cell.
    Cell(fn(&mut Cell)),
    /// In the raw readings, beside the true cell.
    Readings(fn(&Cell, &mut ReadingTable)),
    /// In a table of displacements.
    Table(fn(&mut Vec<MeasuredPosture>)),
    /// In the cell, beside a table of displacements.
    CellOfTable(fn(&mut Cell)),
}

pub struct Mistake {
    pub name: &'static str,
    pub kind: Kind,
    /// Load states of a posture, unloaded among them.
    pub states: usize,
    pub plant: Plant,
    /// Words of the finding that names it; none where no reading can tell.
    pub words: &'static [&'static str],
}

const fn row(name: &'static str, kind: Kind, plant: Plant, words: &'static [&'static str]) -> Mistake {
    let states = match plant {
        Plant::Table(_) | Plant::CellOfTable(_) => 2,
        _ => 3,
    };
    Mistake { name, kind, states, plant, words }
}

const fn two_states(mistake: Mistake) -> Mistake {
    Mistake { states: 2, ..mistake }
}

use Kind::{Forces, Lever, Rope, Sensor as BySensor, Weight};
use Plant::{Cell as C, CellOfTable as D, Readings as R, Table as T};

const ANCHOR: &[&str] = &["ask for the anchor"];
const POINT: &[&str] = &["ask for the loading point"];
const GRAVITY: &[&str] = &["ask for gravity"];
const BESIDE: &[&str] = &["constant force beside the load"];
const SHIFT: &[&str] = &["shift common to all loaded readings"];
const SENSOR: &[&str] = &["ask for the sensor's axes"];
const OPPOSITE: &[&str] = &["move against the stated load"];
const OFFSET: &[&str] = &["along the load in every loaded state"];
const MOVED: &[&str] = &["measuring points moved by"];
const TOOL: &[&str] = &["measuring points are moved by"];
const AXES: &[&str] = &["axes of the displacements"];

fn point(cell: &mut Cell) -> &mut Vector3<f64> {
    &mut cell.setup.tool.loading_point
}

fn down(cell: &mut Cell, to: [f64; 3]) {
    if let Load::Weight { direction, .. } = &mut cell.setup.load {
        *direction = Vector3::from(to).normalize();
    }
}

fn turn_sensor(cell: &mut Cell, degrees: f64) {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), degrees.to_radians());
    let sensor = cell.sensor.as_mut().unwrap();
    sensor.pose.rotation *= turn;
}

fn each_wrench(table: &mut ReadingTable, change: impl Fn(&mut Wrench)) {
    let states = table.postures.iter_mut().flat_map(|p| &mut p.states);
    states.filter_map(|s| s.wrench.as_mut()).for_each(change);
}

fn each_displacement(measured: &mut [MeasuredPosture], change: impl Fn(Vector3<f64>) -> Vector3<f64>) {
    let all = measured.iter_mut().flat_map(|m| &mut m.displacements);
    all.for_each(|d| d.value = change(d.value));
}

fn about_z(v: Vector3<f64>, degrees: f64) -> Vector3<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), degrees.to_radians()) * v
}

fn each_q(measured: &mut [MeasuredPosture], change: impl Fn(&mut Vec<f64>)) {
    measured.iter_mut().for_each(|m| change(&mut m.posture.q));
}

fn each_angle(table: &mut ReadingTable, change: impl Fn(&mut Vec<f64>)) {
    table.postures.iter_mut().for_each(|p| change(&mut p.posture.q));
}

/// What the sensor reads, in base axes.
fn in_base_axes(cell: &Cell, table: &mut ReadingTable) {
    let sensor = cell.sensor.as_ref().unwrap();
    for posture in &mut table.postures {
        let frames = Frames::new(&cell.setup.robot, &posture.posture.q);
        let axes = frames.flange().rotation * sensor.pose.rotation;
        for wrench in posture.states.iter_mut().filter_map(|s| s.wrench.as_mut()) {
            *wrench = wrench.map(|v| axes * v);
        }
    }
}

fn turn_tool(cell: &mut Cell) {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), PI / 2.0);
    let tool = &mut cell.setup.tool;
    tool.loading_point = turn * tool.loading_point;
    tool.measuring_points.iter_mut().for_each(|p| p.position = turn * p.position);
}

/// What hangs on the rope in every loaded state [kg].
fn hook(cell: &Cell, table: &mut ReadingTable, kilograms: f64) {
    let wrench = Wrench::force(Vector3::new(0.0, 0.0, -9.806_65 * kilograms));
    add_displacement(cell, table, Role::Loaded, |_| Some(wrench));
}

fn exchange(table: &mut ReadingTable, p: usize) {
    let states = &mut table.postures[p].states;
    let (a, b) = states.split_at_mut(1);
    std::mem::swap(&mut a[0].readings, &mut b[0].readings);
}

fn relabel(table: &mut ReadingTable, posture: Option<usize>, a: usize, b: usize) {
    for (p, readings) in table.postures.iter_mut().enumerate() {
        if posture.is_some_and(|only| only != p) {
            continue;
        }
        for reading in readings.states.iter_mut().flat_map(|s| &mut s.readings) {
            reading.target = match reading.target {
                ReadingTarget::Point(i) if i == a => ReadingTarget::Point(b),
                ReadingTarget::Point(i) if i == b => ReadingTarget::Point(a),
                ref other => other.clone(),
            };
        }
    }
}

/// The default robot's rows, written as those of the other convention.
fn other_rows(cell: &mut Cell) {
    let entry = find_in_catalogue("comau-nj165-3.0").unwrap();
    let robot = &cell.setup.robot;
    let limits: Vec<[f64; 2]> = robot.joints().iter().map(|j| j.limits).collect();
    let other = entry.convention.other();
    cell.setup.robot = Robot::from_dh(entry.name, other, &entry.dh_rows(), entry.base())
        .unwrap()
        .with_flange(&entry.flange())
        .with_coupling(robot.coupling().clone())
        .unwrap()
        .with_limits(&limits)
        .unwrap();
}

fn each_load(table: &mut ReadingTable, change: impl Fn(f64) -> f64) {
    let states = table.postures.iter_mut().flat_map(|p| &mut p.states);
    states.filter_map(|s| s.load.as_mut()).for_each(|load| *load = change(*load));
}

fn round(table: &mut ReadingTable, step: f64) {
    each_position(table, |p| *p = p.map(|v| (v / step).round() * step));
}

/// The loaded readings of posture `p` as under this share of the load.
fn lighter(table: &mut ReadingTable, p: usize, share: f64) {
    let states = &mut table.postures[p].states;
    let unloaded: Vec<Vector3<f64>> = states[0].readings.iter().map(|r| r.position).collect();
    for state in states.iter_mut().filter(|s| Role::of(&s.state) == Role::Loaded) {
        for (reading, before) in state.readings.iter_mut().zip(&unloaded) {
            reading.position = before + (reading.position - before) * share;
        }
    }
}

/// The table, a line each.
#[rustfmt::skip]
pub const MISTAKES: &[Mistake] = &[
    row("anchor 300 mm too low", Rope, C(|c| rope_anchor(c).z -= 0.3), ANCHOR),
    row("anchor 300 mm too high", Rope, C(|c| rope_anchor(c).z += 0.3), ANCHOR),
    row("anchor 80 mm off", Rope, C(|c| rope_anchor(c).y += 0.08), ANCHOR),
    row("plates for the pulley", Rope, C(|c| *rope_anchor(c) += Vector3::new(0.4, 0.0, -0.2)), ANCHOR),
    row("rail 500 mm along y", Rope, C(|c| rope_anchor(c).y -= 0.5), ANCHOR),
    row("rail 500 mm along x", Rope, C(|c| rope_anchor(c).x -= 0.5), ANCHOR),
    row("anchor x with the wrong sign", Rope, C(|c| rope_anchor(c).x *= -1.0), ANCHOR),
    row("anchor x and y exchanged", Rope, C(|c| *rope_anchor(c) = Vector3::new(0.0, 1.8, 0.0)), ANCHOR),
    two_states(row("anchor 300 mm too low, two states", Rope, C(|c| rope_anchor(c).z -= 0.3), ANCHOR)),
    row("anchor 300 mm too low, long lever", Lever, C(|c| rope_anchor(c).z -= 0.3), ANCHOR),
    row("rail 500 mm, long lever", Lever, C(|c| rope_anchor(c).y += 0.5), ANCHOR),
    row("anchor 300 mm too low, displacements", Rope, D(|c| rope_anchor(c).z -= 0.3), ANCHOR),
    row("load on the other eye", Rope, C(|c| point(c).x = -0.2), POINT),
    row("load on the tip", Rope, C(|c| *point(c) = Vector3::new(0.15, 0.0, 0.2)), POINT),
    row("loading point turned by 90°", Rope, C(|c| *point(c) = Vector3::new(0.0, 0.2, 0.25)), POINT),
    row("loading point 100 mm off along z", Rope, C(|c| point(c).z += 0.1), POINT),
    row("loading point 100 mm short along z", Rope, C(|c| point(c).z -= 0.1), POINT),
    row("lever 50 mm too long", Rope, C(|c| point(c).x += 0.05), POINT),
    row("lever 50 mm too short", Rope, C(|c| point(c).x -= 0.05), POINT),
    row("lever 100 mm too long", Rope, C(|c| point(c).x += 0.1), POINT),
    row("loading point 60 mm aside", Rope, C(|c| point(c).y += 0.06), POINT),
    row("sign of one coordinate of the loading point", Rope, C(|c| point(c).z *= -1.0), POINT),
    row("loading point x and z exchanged", Rope, C(|c| *point(c) = Vector3::new(0.25, 0.0, 0.2)), POINT),
    two_states(row("lever 50 mm too long, two states", Rope, C(|c| point(c).x += 0.05), POINT)),
    row("long lever 50 mm too long", Lever, C(|c| point(c).x += 0.05), POINT),
    row("long lever 100 mm off along z", Lever, C(|c| point(c).z += 0.1), POINT),
    row("long lever on the other eye", Lever, C(|c| point(c).x *= -1.0), POINT),
    row("loading point 100 mm off, displacements", Rope, D(|c| point(c).z += 0.1), POINT),
    row("loading point 100 mm off under a weight", Weight, C(|c| point(c).x += 0.1), POINT),
    row("weight on the other eye", Weight, C(|c| point(c).x *= -1.0), POINT),
    row("base tilted by 10° under a weight", Weight, C(|c| down(c, [0.174, 0.0, -0.985])), GRAVITY),
    row("base tilted by 3° under a weight", Weight, C(|c| down(c, [0.0, 0.052, -0.9986])), GRAVITY),
    row("wall robot with gravity of a floor", Weight, C(|c| down(c, [1.0, 0.0, 0.0])), GRAVITY),
    // The sign of the load and the direction of gravity are one thing here.
    row("gravity upside down", Weight, C(|c| down(c, [0.0, 0.0, 1.0])), &["eadings ask for"]),
    row("base tilted by 10°, displacements", Weight, D(|c| down(c, [0.174, 0.0, -0.985])), GRAVITY),
    row("hook and shackle of 3 kg", Rope, R(|c, t| hook(c, t, 3.0)), BESIDE),
    row("load cell of 1 kg", Rope, R(|c, t| hook(c, t, 1.0)), BESIDE),
    two_states(row("hook and shackle of 3 kg, two states", Rope, R(|c, t| hook(c, t, 3.0)), BESIDE)),
    row("all loaded 0.4 mm later", Rope, R(|_, t| each_loaded(t, |p| p.z -= 4e-4)), SHIFT),
    row("all loaded 0.1 mm later", Rope, R(|_, t| each_loaded(t, |p| p.x += 1e-4)), SHIFT),
    row("all loaded 0.05 mm later", Rope, R(|_, t| each_loaded(t, |p| p.y += 5e-5)), SHIFT),
    two_states(row("all loaded 0.4 mm later, two states", Rope, R(|_, t| each_loaded(t, |p| p.z -= 4e-4)), SHIFT)),
    row("all loaded 0.4 mm later under a weight", Weight, R(|_, t| each_loaded(t, |p| p.z -= 4e-4)), SHIFT),
    row("sensor turned by 30°", BySensor, C(|c| turn_sensor(c, 30.0)), SENSOR),
    row("sensor turned by 90°", BySensor, C(|c| turn_sensor(c, 90.0)), SENSOR),
    row("sensor of forces turned by 30°", Forces, C(|c| turn_sensor(c, 30.0)), SENSOR),
    row("sensor of forces turned by 90°", Forces, C(|c| turn_sensor(c, -90.0)), SENSOR),
    row("sensor of forces not turned", Forces, C(|c| c.sensor.as_mut().unwrap().pose.rotation = UnitQuaternion::identity()), SENSOR),
    row("fx and fy exchanged", BySensor, R(|_, t| each_wrench(t, |w| { w.force.swap_rows(0, 1); w.moment.swap_rows(0, 1); })), SENSOR),
    row("fx and fy of forces exchanged", Forces, R(|_, t| each_wrench(t, |w| w.force.swap_rows(0, 1))), SENSOR),
    row("left-handed sensor", BySensor, R(|_, t| each_wrench(t, |w| { w.force.y *= -1.0; w.moment.y *= -1.0; })), SENSOR),
    row("sensor reports the other way", BySensor, C(|c| c.sensor.as_mut().unwrap().reports_by_robot = false), &["sensor.reports"]),
    row("sensor's origin at the other face", BySensor, C(|c| c.sensor.as_mut().unwrap().pose.translation.z += 0.06), &["sensor's origin"]),
    row("forces in base axes", BySensor, R(in_base_axes), &["given in base axes"]),
    row("points counted from the spindle's nose, displacements", Rope, D(|c| c.setup.tool.measuring_points.iter_mut().for_each(|p| p.position -= Vector3::new(0.1, 0.0, 0.2))), MOVED),
    row("points in other axes, displacements", Rope, D(|c| c.setup.tool.measuring_points.iter_mut().for_each(|p| p.position = Vector3::new(p.position.z, p.position.x, p.position.y))), MOVED),
    row("tool turned by 90°", Rope, C(turn_tool), &["tool", "90"]),
    row("table with x and y exchanged", Rope, T(|m| each_displacement(m, |v| Vector3::new(v.y, v.x, v.z))), AXES),
    row("table with z flipped", Rope, T(|m| each_displacement(m, |v| Vector3::new(v.x, v.y, -v.z))), AXES),
    row("table turned by 10°", Rope, T(|m| each_displacement(m, |v| about_z(v, 10.0))), AXES),
    row("table turned by 126°", Rope, T(|m| each_displacement(m, |v| about_z(v, 126.0))), AXES),
    row("table turned by 180°", Rope, T(|m| each_displacement(m, |v| about_z(v, 180.0))), AXES),
    row("table turned by 90°, long lever", Lever, T(|m| each_displacement(m, |v| about_z(v, 90.0))), AXES),
    row("unloaded less loaded in a table", Rope, T(|m| each_displacement(m, |v| -v)), OPPOSITE),
    row("joint 1 counted the other way, displacements", Rope, T(|m| each_q(m, |q| q[0] *= -1.0)), &["joint 1", "other way"]),
    row("joint 4 counted the other way, displacements", Rope, T(|m| each_q(m, |q| q[3] *= -1.0)), &["joint 4", "other way"]),
    row("joint 6 counted the other way, displacements", Rope, T(|m| each_q(m, |q| q[5] *= -1.0)), &["joint 6", "other way"]),
    row("joint 6 off by 180°, displacements", Rope, T(|m| each_q(m, |q| q[5] += PI)), &["joint 6 off by"]),
    row("joint 3 coupled, displacements", Rope, T(|m| each_q(m, |q| q[2] += q[1])), &["axis 3"]),
    row("joint 1 counted the other way", Rope, R(|_, t| each_angle(t, |q| q[0] *= -1.0)), &["joint 1", "other way"]),
    row("joint 4 counted the other way", Rope, R(|_, t| each_angle(t, |q| q[3] *= -1.0)), &["joint 4", "other way"]),
    row("joint 6 off by 180°", Rope, R(|_, t| each_angle(t, |q| q[5] += PI)), &["joint 6", "180"]),
    row("joint 3 coupled", Rope, C(|c| couple(c, |m| m[(2, 1)] = 0.0)), &["coupled"]),
    row("modified rows as standard ones", Rope, C(other_rows), &["dh_modified, not robot.dh_standard"]),
    row("modified rows as standard ones, displacements", Rope, D(other_rows), &["ask for modified rows"]),
    row("rope still tight, 150 N", Rope, R(|c, t| add_displacement(c, t, Role::Unloaded, |w| Some(w.map(|v| v * 0.3)))), OFFSET),
    row("one wrong weight", Rope, R(|_, t| lighter(t, 3, 0.5)), &["osture 4"]),
    row("load cell 50 N too much", Rope, R(|_, t| each_load(t, |n| if n > 0.0 { n + 50.0 } else { n })), OFFSET),
    row("force 20 % too large", Rope, R(|_, t| each_load(t, |n| 1.2 * n)), &[]),
    row("kilograms in load_n", Rope, R(|_, t| each_load(t, |n| n / 9.806_65)), &["kg"]),
    row("kilonewtons in load_n", Rope, R(|_, t| each_load(t, |n| n / 1e3)), &["kilonewtons"]),
    row("two postures exchanged", Rope, R(|_, t| { let q = t.postures[2].posture.q.clone(); t.postures[2].posture.q = t.postures[5].posture.q.clone(); t.postures[5].posture.q = q; }), &["3 and 6", "exchanged"]),
    row("two points exchanged", Rope, R(|_, t| relabel(t, None, 0, 1)), &["exchanged"]),
    row("two points exchanged in one posture", Rope, R(|_, t| relabel(t, Some(4), 0, 2)), &["osture 5", "exchanged"]),
    two_states(row("loaded and unloaded of one posture exchanged", Rope, R(|_, t| exchange(t, 3)), &["osture 4", "exchanged"])),
    two_states(row("loaded and unloaded of all exchanged", Rope, R(|_, t| (0..12).for_each(|p| exchange(t, p))), OPPOSITE)),
    row("posture copied", Rope, R(|_, t| { let q = t.postures[3].posture.q.clone(); t.postures[4].posture.q = q; }), &["osture 5", "copied"]),
    row("sign of an angle", Rope, R(|_, t| t.postures[2].posture.q[1] *= -1.0), &["osture 3", "joint 2"]),
    row("reflector in the wrong nest", Rope, C(|c| c.setup.tool.measuring_points[2].position.x += 0.0127), &["12.7"]),
    row("mirrored tracker", Rope, R(|_, t| each_position(t, |p| p.x = -p.x)), &["mirrored"]),
    row("metres for millimetres", Rope, R(|_, t| each_position(t, |p| *p *= 1e-3)), &["metres"]),
    row("tool in metres", Rope, C(|c| c.setup.tool.measuring_points.iter_mut().for_each(|p| p.position *= 1e-3)), &["tool.measuring_point"]),
    row("points counted from the spindle's nose", Rope, C(|c| c.setup.tool.measuring_points.iter_mut().for_each(|p| p.position -= Vector3::new(0.1, 0.0, 0.35))), TOOL),
    row("points in other axes", Rope, C(|c| c.setup.tool.measuring_points.iter_mut().for_each(|p| p.position = Vector3::new(p.position.z, p.position.x, p.position.y))), TOOL),
    row("readings to a millimetre", Rope, R(|_, t| round(t, 1e-3)), &["1 mm"]),
    row("readings to a tenth of a millimetre", Rope, R(|_, t| round(t, 1e-4)), &["0.1 mm"]),
];
