//! Random cells as numbers of their tables, mm and degrees: the checker reads these, the library their text.

use super::arm::Arm;
use super::distance::Shape;
use crate::common::prelude::*;

/// The robots.
pub const ROBOTS: [&str; 3] = ["kuka-kr210-r2700-2", "abb-irb4600-60-205", "ur10e"];

#[derive(Debug, Clone)]
pub struct Point {
    pub position: [f64; 3],
    /// Where the reflector looks, and its acceptance angle where it is given.
    pub facing: Option<([f64; 3], Option<f64>)>,
}

/// One of the loads of a cell.
#[derive(Debug, Clone)]
pub struct Load {
    pub pull: Pull,
    /// Where it acts instead of the tool's loading point.
    pub at: Option<[f64; 3]>,
}

#[derive(Debug, Clone)]
pub enum Pull {
    /// A cylinder that pushes where the magnitude is negative.
    Rope {
        anchor: [f64; 3],
        magnitude: f64,
    },
    Weight {
        magnitude: f64,
    },
    Wrench {
        force: [f64; 3],
        moment: [f64; 3],
    },
}

#[derive(Debug, Clone, Default)]
pub struct PointLimits {
    pub corners: Option<[[f64; 3]; 2]>,
    pub floor: Option<f64>,
    pub keep_out: Option<f64>,
    pub wrist: Option<f64>,
    pub rope: Option<[f64; 2]>,
}

#[derive(Debug, Clone, Default)]
pub struct Clearance {
    pub shapes: Option<f64>,
    pub rope: Option<f64>,
    pub free: Option<[f64; 2]>,
    pub cone: Option<([f64; 3], f64)>,
    pub sight: Option<f64>,
    pub visible: Option<usize>,
    pub ignore: Vec<[String; 2]>,
}

/// Largest torques, mass and its centre.
#[derive(Debug, Clone)]
pub struct Torques {
    pub largest: Vec<f64>,
    pub mass: Option<(f64, [f64; 3])>,
}

/// A cell.
#[derive(Debug, Clone)]
pub struct Case {
    pub arm: Arm,
    /// The base's place and turns.
    pub mount: Option<([f64; 3], [f64; 3])>,
    /// The arm's capsules in the cell's own table.
    pub own_capsules: bool,
    pub bounds: Vec<[f64; 2]>,
    pub loading: [f64; 3],
    pub points: Vec<Point>,
    pub tool: Vec<(String, Shape)>,
    pub obstacles: Vec<(String, Shape)>,
    pub stations: Vec<[f64; 3]>,
    pub loads: Vec<Load>,
    pub limits: PointLimits,
    pub clearance: Clearance,
    pub torques: Option<Torques>,
    pub task: Vec<f64>,
}

/// A tenth of a millimetre or of a degree, so that text and number are the same.
fn round(v: f64) -> f64 {
    (v * 10.0).round() / 10.0
}

fn rounded(v: [f64; 3]) -> [f64; 3] {
    v.map(round)
}

/// Around the base: at this radius, any direction, between these heights.
fn around(dice: &mut Dice, radius: [f64; 2], z: [f64; 2]) -> [f64; 3] {
    let (r, turn) = (dice.between(radius[0], radius[1]), dice.between(-3.1, 3.1_f64));
    rounded([r * turn.cos(), r * turn.sin(), dice.between(z[0], z[1])])
}

fn block(dice: &mut Dice, center: [f64; 3], least: f64, most: f64) -> Shape {
    let size = rounded([0; 3].map(|_| dice.between(least, most)));
    let rpy = if dice.chance(0.5) { rounded([0; 3].map(|_| dice.between(-180.0, 180.0))) } else { [0.0; 3] };
    Shape::Box { center, size, rpy }
}

fn rod(dice: &mut Dice, from: [f64; 3], reach: f64, capsule: bool) -> Shape {
    let to = rounded(from.map(|v| v + dice.signed(0.05 * reach, 0.3 * reach)));
    let radius = round(dice.between(0.02, 0.1) * reach);
    if capsule { Shape::Capsule { from, to, radius } } else { Shape::Cylinder { from, to, radius } }
}

impl Case {
    /// Cell `number`; the same number gives the same cell.
    pub fn new(number: u64) -> Self {
        let mut dice = Dice::new(70_000 + number);
        let dice = &mut dice;
        let arm = Arm::new(ROBOTS[number as usize % ROBOTS.len()]);
        let reach = 1e3 * arm.reach;
        let n = arm.joint_count();
        let bounds = arm.limits.iter().map(|l| {
            let (low, high) = (l[0].max(-180.0) + 0.1, l[1].min(180.0) - 0.1);
            let range = (high - low) * dice.between(0.4, 1.0);
            let start = dice.between(low, high - range);
            [round(start), round(start + range)]
        });
        let bounds: Vec<[f64; 2]> = bounds.collect();
        let mount = dice.chance(0.2).then(|| {
            let up = dice.between(0.0, 0.3 * reach);
            let at = [dice.signed(0.0, 300.0), dice.signed(0.0, 300.0), up];
            let turns = [dice.signed(0.0, 15.0), dice.signed(0.0, 15.0), dice.signed(0.0, 180.0)];
            (rounded(at), rounded(turns))
        });
        let (tool, points, loading) = tool(dice, reach);
        let obstacles = obstacles(dice, reach);
        let stations = if dice.chance(0.6) {
            (0..1 + dice.below(2))
                .map(|_| around(dice, [1.6 * reach, 3.0 * reach], [0.3 * reach, 1.2 * reach]))
                .collect()
        } else {
            Vec::new()
        };
        let magnitude = round(dice.between(30.0, 150.0) * reach * 1e-3);
        let count = if dice.chance(0.3) { 2 + dice.below(2) } else { 1 };
        let loads: Vec<Load> = (0..count)
            .map(|_| Load {
                pull: pull(dice, reach, magnitude),
                at: (count > 1 && dice.chance(0.3))
                    .then(|| rounded((Vector3::from(loading) + dice.vector(0.05 * reach)).into())),
            })
            .collect();
        let limits = point_limits(dice, reach, &loads);
        let clearance = clearance(dice, &loads, &stations, points.len(), &tool, &obstacles);
        let torques = dice.chance(0.35).then(|| {
            let arm = [0.8, 0.8, 0.6, 0.35, 0.35, 0.3].map(|lever| lever * reach * 1e-3);
            let most = dice.between(0.4, 1.5) * magnitude;
            Torques {
                largest: (0..n).map(|j| round(most * arm[j])).collect(),
                mass: dice.chance(0.6).then(|| {
                    let mass = round(dice.between(0.5, 0.02 * magnitude + 1.0));
                    (mass, rounded(dice.vector(0.05 * reach).into()))
                }),
            }
        });
        let task = bounds.iter().map(|b| round(dice.between(b[0], b[1])));
        let task = task.collect();
        let own_capsules = dice.chance(0.15);
        let mut case = Case {
            arm,
            mount,
            own_capsules,
            bounds,
            loading,
            points,
            tool,
            obstacles,
            stations,
            loads,
            limits,
            clearance,
            torques,
            task,
        };
        if dice.chance(0.08) {
            case.contradict(dice, reach);
        }
        case
    }

    /// Asks for what no posture gives.
    fn contradict(&mut self, dice: &mut Dice, reach: f64) {
        let away = round(3.0 * reach);
        match dice.below(4) {
            0 => self.limits.floor = Some(away),
            1 => self.obstacles.push(("deck".to_string(), Shape::Floor(away))),
            2 => {
                let largest = vec![0.1; self.arm.joint_count()];
                self.torques = Some(Torques { largest, mass: None });
            }
            _ => {
                let low = [away, away, away];
                self.limits.corners = Some([low, low.map(|v| v + 500.0)]);
            }
        }
    }
}

type Named = Vec<(String, Shape)>;

fn tool(dice: &mut Dice, reach: f64) -> (Named, Vec<Point>, [f64; 3]) {
    let mut shapes = Vec::new();
    let height = round(dice.between(0.05, 0.12) * reach);
    if dice.chance(0.8) {
        let radius = round(dice.between(0.015, 0.03) * reach);
        let to = [0.0, 0.0, height];
        let from = [0.0; 3];
        shapes.push(match dice.below(3) {
            0 => Shape::Capsule { from, to, radius },
            _ => Shape::Cylinder { from, to, radius },
        });
    }
    let wide = dice.between(0.05, 0.09) * reach;
    if dice.chance(0.6) {
        shapes.push(Shape::Box {
            center: [0.0, 0.0, round(0.6 * height)],
            size: rounded([2.0 * wide, 1.2 * wide, 0.012 * reach]),
            rpy: [0.0, 0.0, round(dice.between(-180.0, 180.0))],
        });
    }
    // Two shapes of one name are one thing.
    let same = dice.chance(0.3);
    let names = ["spindle", if same { "spindle" } else { "plate" }];
    let named = names.iter().map(|n| (*n).to_string()).zip(shapes).collect();
    let above = round(height + 0.02 * reach + 10.0);
    let count = 3 + dice.below(2);
    let facing = dice.chance(0.35).then(|| {
        let axis = if dice.chance(0.6) { [0.0, 0.0, 1.0] } else { rounded((dice.direction() * 10.0).into()) };
        let acceptance = dice.chance(0.6).then(|| round(dice.between(25.0, 80.0)));
        (axis, acceptance)
    });
    let some_look = dice.chance(0.2);
    let points = (0..count).map(|i| {
        let (s, c) = (i as f64 / count as f64 * std::f64::consts::TAU).sin_cos();
        Point { position: rounded([wide * c, wide * s, above]), facing: facing.filter(|_| !some_look || i > 0) }
    });
    let points = points.collect();
    let loading = rounded([dice.signed(0.04, 0.1) * reach, dice.between(-0.05, 0.05) * reach, above]);
    (named, points, loading)
}

fn obstacles(dice: &mut Dice, reach: f64) -> Named {
    let mut out: Named = Vec::new();
    if dice.chance(0.75) {
        out.push(("floor".to_string(), Shape::Floor(round(dice.between(-0.2, 0.0) * reach))));
    }
    if dice.chance(0.15) {
        out.push(("ceiling".to_string(), Shape::Ceiling(round(dice.between(1.1, 1.8) * reach))));
    }
    if dice.chance(0.25) {
        let out_there = around(dice, [0.7 * reach, 1.1 * reach], [0.0, 0.0]);
        let normal = [-out_there[0], -out_there[1], dice.signed(0.0, 50.0)];
        let wall = Shape::Wall { point: out_there, normal: rounded(normal) };
        out.push(("wall".to_string(), wall));
    }
    for i in 0..dice.below(4) {
        let center = around(dice, [0.55 * reach, 1.1 * reach], [0.0, 0.8 * reach]);
        let shape = block(dice, center, 0.08 * reach, 0.45 * reach);
        let name = if i > 0 && dice.chance(0.2) { "block 1".to_string() } else { format!("block {}", i + 1) };
        out.push((name, shape));
    }
    for i in 0..dice.below(3) {
        let from = around(dice, [0.5 * reach, 1.1 * reach], [0.0, 0.8 * reach]);
        let capsule = dice.chance(0.5);
        out.push((format!("rod {}", i + 1), rod(dice, from, reach, capsule)));
    }
    out
}

fn pull(dice: &mut Dice, reach: f64, magnitude: f64) -> Pull {
    match dice.below(10) {
        0 => Pull::Weight { magnitude },
        1 => Pull::Wrench {
            force: rounded((dice.direction() * magnitude).into()),
            moment: rounded(dice.vector(20.0).into()),
        },
        _ => Pull::Rope {
            anchor: around(dice, [0.6 * reach, 1.3 * reach], [0.0, 0.4 * reach]),
            magnitude: if dice.chance(0.2) { -magnitude } else { magnitude },
        },
    }
}

/// The anchor of the first rope among them.
fn anchor(loads: &[Load]) -> Option<[f64; 3]> {
    loads.iter().find_map(|load| match load.pull {
        Pull::Rope { anchor, .. } => Some(anchor),
        _ => None,
    })
}

fn point_limits(dice: &mut Dice, reach: f64, loads: &[Load]) -> PointLimits {
    let is_rope = anchor(loads).is_some();
    let mut some = |low: f64, high: f64, share: f64| {
        let value = round(dice.between(low, high) * reach);
        dice.chance(share).then_some(value)
    };
    let corner = some(0.3, 0.9, 0.25);
    PointLimits {
        corners: corner.map(|c| [rounded([-c, -1.2 * reach, 0.0]), rounded([1.2 * reach, c, 1.5 * reach])]),
        floor: some(-0.1, 0.2, 0.3),
        keep_out: some(0.1, 0.35, 0.3),
        wrist: some(-0.1, 0.2, 0.3),
        rope: some(0.1, 0.3, 0.4).zip(some(0.9, 1.8, 1.0)).map(|(low, high)| [low, high]).filter(|_| is_rope),
    }
}

fn clearance(
    dice: &mut Dice,
    loads: &[Load],
    stations: &[[f64; 3]],
    points: usize,
    tool: &Named,
    obstacles: &Named,
) -> Clearance {
    let mut out =
        Clearance { shapes: dice.chance(0.5).then(|| round(dice.between(0.0, 50.0))), ..Clearance::default() };
    if let Some(anchor) = anchor(loads) {
        out.rope = dice.chance(0.5).then(|| round(dice.between(0.0, 40.0)));
        out.free = dice.chance(0.4).then(|| [0; 2].map(|_| round(dice.between(0.0, 200.0))));
        out.cone = dice.chance(0.3).then(|| {
            let inwards = [-0.5 * anchor[0], -0.5 * anchor[1], dice.between(0.3, 1.0) * 1e3];
            (rounded(inwards), round(dice.between(25.0, 70.0)))
        });
    }
    if !stations.is_empty() {
        out.sight = dice.chance(0.5).then(|| round(dice.between(0.0, 9.0)));
        out.visible = dice.chance(0.5).then(|| 1 + dice.below(points));
    }
    let names = tool.iter().chain(obstacles).map(|(name, _)| name.clone());
    let names: Vec<String> = names.chain((1..=5).map(|i| format!("link {i}"))).collect();
    if dice.chance(0.25) {
        let pair = [0; 2].map(|_| names[dice.below(names.len())].clone());
        if pair[0] != pair[1] {
            out.ignore.push(pair);
        }
    }
    out
}
