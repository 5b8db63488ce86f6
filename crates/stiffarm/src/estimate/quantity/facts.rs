//! The list: one row of facts for each quantity.

use crate::model::cell::Cell;
use crate::model::instruments::Uncertainty;
use crate::model::observation::ExtraTerm;

/// Standard uncertainty of a quantity that is identified on purpose: wide beside all that readings tell \[m; rad\], and
/// of a force \[N\].
const FREE: f64 = 1.0;
const FREE_FORCE: f64 = 1e4;

/// A quantity of the set-up. What has a number belongs to that load case, load group or joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Quantity {
    /// Scale of the force: the readings of it are too large by this fraction.
    ForceScale,
    /// Fixed end of a rope or cylinder, base frame.
    Anchor(usize),
    /// Where the load acts, flange axes; with a number that of this load case alone.
    LoadingPoint(Option<usize>),
    /// Direction of a weight, base axes.
    Gravity,
    /// Axes in which displacements are given against those of the base.
    Registration,
    /// Tilt of the base by its load.
    BaseTilt,
    /// Turn of what lies between flange and reflectors by its load.
    Sensor,
    /// A constant force beside the load, base axes.
    Beside,
    /// A force along the load that every loaded state has more than is stated.
    Offset,
    /// The load, or the displacements, have the opposite sign.
    Sign,
    /// A displacement common to all loaded readings, base axes.
    Shift,
    /// Turn of the force sensor's axes.
    SensorAxes,
    /// Origin of the force sensor.
    SensorOrigin,
    /// The sensor's readings are given in base axes.
    SensorInBase,
    /// The measuring points as a rigid body, flange axes, under a table of displacements: shift and turn.
    Points,
    /// Offset of a joint angle under a table of displacements, and the way in which it counts.
    Angle(usize),
    /// The angle of axis 3 counts that of axis 2, under a table of displacements.
    Coupling,
    /// The robot's rows are meant in the other Denavit–Hartenberg convention, under a table of displacements.
    Rows,
    /// Lost motion of every joint: no error of the set-up, but what else may explain the same.
    LostMotion,
}

/// What its numbers are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Numbers {
    /// None: it is one of several forms.
    None,
    /// One.
    One,
    /// Coordinates, or a turn about them.
    Axes,
    /// Two angles of a direction.
    Direction,
    /// Shift and turn.
    Body,
    /// One of each joint.
    Joints,
}

/// What is known of a quantity.
pub(crate) struct Facts {
    /// Stable name.
    pub name: &'static str,
    /// As a source of error.
    pub what: &'static str,
    /// As another explanation; `{}` is the line of the load, or the joint.
    pub other: &'static str,
    /// Key that states it, of the load `load.…`; else what it is about.
    pub key: &'static str,
    pub numbers: Numbers,
    /// Unit of its numbers; `1` for a fraction.
    pub unit: &'static str,
    /// Standard uncertainty of each of its numbers where the cell says nothing; 0 counts as exact.
    pub assumed: f64,
    /// What the cell says of it.
    pub declared: fn(&Uncertainty) -> Option<f64>,
    /// What to do where the readings reject it.
    pub check: &'static str,
    /// What would make its uncertainty smaller.
    pub better: &'static str,
    /// What would tell it from others that explain the readings as well.
    pub apart: &'static str,
}

const fn row(name: &'static str, numbers: Numbers, unit: &'static str) -> Facts {
    Facts {
        name,
        what: "",
        other: "",
        key: "load",
        numbers,
        unit,
        assumed: 0.0,
        declared: |_| None,
        check: "",
        better: "",
        apart: "",
    }
}

/// What an arm is made of, which no set-up states: half of what is found otherwise where springs alone are expected, so
/// that all of it counts as 95 %.
pub(crate) fn springs() -> Facts {
    Facts {
        what: "kind of springs",
        assumed: 0.5,
        better: "measure more postures or under a further load, or give what a drawing knows in [elastic]",
        ..row("springs", Numbers::One, "1")
    }
}

/// The facts of a source of error by its name.
pub(crate) fn named(name: &str) -> Option<Facts> {
    let facts = Quantity::named(name).map(Quantity::facts);
    facts.or_else(|| Some(springs()).filter(|facts| facts.name == name))
}

impl Quantity {
    /// One of each.
    pub const ALL: [Quantity; 19] = [
        Quantity::ForceScale,
        Quantity::Anchor(0),
        Quantity::LoadingPoint(None),
        Quantity::Gravity,
        Quantity::Registration,
        Quantity::BaseTilt,
        Quantity::Sensor,
        Quantity::Beside,
        Quantity::Offset,
        Quantity::Sign,
        Quantity::Shift,
        Quantity::SensorAxes,
        Quantity::SensorOrigin,
        Quantity::SensorInBase,
        Quantity::Points,
        Quantity::Angle(0),
        Quantity::Coupling,
        Quantity::Rows,
        Quantity::LostMotion,
    ];

    /// Its row of the list.
    pub fn facts(self) -> Facts {
        match self {
            Quantity::ForceScale => Facts {
                what: "force scale",
                assumed: 0.01,
                declared: |uncertainty| uncertainty.force_scale,
                better: "check the force with a known weight and declare what it shows",
                ..row("force-scale", Numbers::One, "1")
            },
            // Measured by tape.
            Quantity::Anchor(_) => Facts {
                what: "anchor",
                other: "another anchor of the {}",
                key: "load.anchor_mm",
                assumed: 5e-3,
                declared: |uncertainty| uncertainty.anchor,
                check: "Measure the rope's fixed end with the tracker (where a pulley deflects it: the point where it \
                    leaves the pulley)",
                better: "measure the anchor with the tracker and declare how well",
                apart: "a second anchor, or the tracker on this one",
                ..row("anchor", Numbers::Axes, "m")
            },
            // By its drawing.
            Quantity::LoadingPoint(case) => Facts {
                what: "loading point",
                other: "another loading point",
                key: match case {
                    Some(_) => "load.loading_point_mm",
                    None => "tool.loading_point_mm",
                },
                assumed: 1e-3,
                declared: |uncertainty| uncertainty.loading_point,
                check: "Measure where the load acts on the tool",
                better: "measure the loading point with the tracker and declare how well",
                apart: "a pull about other axes",
                ..row("loading-point", Numbers::Axes, "m")
            },
            Quantity::Gravity => Facts {
                what: "direction of gravity",
                other: "another direction of gravity",
                key: "robot.down",
                check: "Give the direction of gravity as the base stands",
                better: "level the base, or measure how it stands",
                apart: "a spirit level on the base",
                ..row("gravity", Numbers::Direction, "rad")
            },
            Quantity::Registration => Facts {
                what: "registration",
                other: "other axes of the displacements",
                key: "measurements",
                assumed: 0.5e-3,
                declared: |uncertainty| uncertainty.registration,
                check: "Check in which axes the displacements were exported; they must be those of the base",
                better: "register with more points, farther apart, and declare how well",
                apart: "the positions behind the displacements",
                ..row("registration", Numbers::Axes, "rad")
            },
            // A well-anchored base.
            Quantity::BaseTilt => Facts {
                what: "tilt of the base",
                other: "a base that tilts",
                key: "measurements",
                assumed: 1e-8,
                declared: |uncertainty| uncertainty.base_tilt_compliance,
                better: "measure a reflector on the base and subtract its motion",
                apart: "reflectors on the base",
                ..row("base-tilt", Numbers::One, "rad/(N·m)")
            },
            // A force sensor that is there and that nobody models.
            Quantity::Sensor => Facts {
                what: "compliance between flange and reflectors",
                assumed: 1e-6,
                declared: |uncertainty| uncertainty.sensor_compliance,
                better: "give the stiffness of the sensor, or put the reflectors before it",
                ..row("sensor", Numbers::One, "rad/(N·m)")
            },
            Quantity::Beside => Facts {
                what: "force beside the load",
                other: "a constant force beside the load",
                declared: |uncertainty| uncertainty.force_beside,
                check: "Weigh what hangs on the rope (hook, shackle, load cell), or take differences against a preload \
                    that has it too",
                better: "weigh what hangs on the rope and add it to the load",
                apart: "a preload, which has it too",
                ..row("force-beside", Numbers::Axes, "N")
            },
            Quantity::Offset => Facts {
                what: "force along the load",
                other: "a force along the load in every loaded state",
                check: "The rope was not slack in the unloaded readings, or the load cell does not read zero without \
                    load",
                better: "take the load cell to zero without load",
                apart: "a third load state",
                ..row("force-offset", Numbers::One, "N")
            },
            Quantity::Sign => Facts {
                other: "the opposite sign of the load",
                check: "Check the direction of the load; a displacement is the loaded position less the unloaded one",
                ..row("sign", Numbers::None, "1")
            },
            Quantity::Shift => Facts {
                what: "shift common to all loaded readings",
                other: "a shift common to all loaded readings",
                key: "measurements",
                declared: |uncertainty| uncertainty.common_shift,
                check: "The tracker, its stand or the base moved between the unloaded and the loaded readings: read \
                        each posture unloaded, loaded and unloaded again",
                better: "read each posture unloaded, loaded and unloaded again",
                apart: "unloaded readings after the loaded ones",
                ..row("common-shift", Numbers::Axes, "m")
            },
            Quantity::SensorAxes => Facts {
                what: "axes of the sensor",
                other: "other axes of the sensor",
                key: "sensor.rpy_deg",
                check: "Check how the sensor sits on the flange, and which way its axes point",
                better: "measure how the sensor sits",
                ..row("sensor-axes", Numbers::Axes, "rad")
            },
            Quantity::SensorOrigin => Facts {
                what: "origin of the sensor",
                other: "another origin of the sensor",
                key: "sensor.xyz_mm",
                check: "Look up to which point the sensor refers its moments",
                better: "look up to which point the sensor refers its moments",
                apart: "a pull about other axes",
                ..row("sensor-origin", Numbers::Axes, "m")
            },
            Quantity::SensorInBase => Facts {
                other: "forces in base axes",
                key: "sensor",
                check: "Take [sensor] out of the cell, or export the sensor's own axes",
                ..row("sensor-in-base-axes", Numbers::None, "1")
            },
            Quantity::Points => Facts {
                what: "measuring points",
                other: "other places of the measuring points",
                key: "tool.measuring_point",
                check: "Check the origin and the axes in which tool.measuring_point is given: those of the flange",
                better: "measure the points from the flange",
                apart: "the tracker on the flange",
                ..row("measuring-points", Numbers::Body, "m, rad")
            },
            Quantity::Angle(_) => Facts {
                what: "joint angle",
                other: "another count of {}",
                key: "robot.theta_from_q",
                check: "Check robot.theta_from_q and the offsets of robot.dh against the pendant",
                better: "calibrate the robot",
                apart: "the positions behind the displacements",
                ..row("joint-angle", Numbers::One, "rad")
            },
            Quantity::Coupling => Facts {
                other: "axis 3 coupled to axis 2 in another way",
                key: "robot.theta_from_q",
                check: "Check robot.theta_from_q against the pendant",
                ..row("coupling", Numbers::None, "1")
            },
            Quantity::Rows => Facts {
                other: "rows of the other convention",
                key: "robot.dh",
                check: "Name the rows of the robot by their convention",
                ..row("rows", Numbers::None, "1")
            },
            // A joint in order: 0.1 arc-minute.
            Quantity::LostMotion => Facts {
                what: "lost motion",
                other: "lost motion in the joints",
                key: "measurements",
                assumed: 0.1 / 60.0 * std::f64::consts::PI / 180.0,
                declared: |uncertainty| uncertainty.lost_motion,
                check: "Take differences against a light preload",
                better: "measure against a light preload, or in more postures, which bound it",
                apart: "a light preload",
                ..row("lost-motion", Numbers::Joints, "rad")
            },
        }
    }

    /// Stable name.
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// The one of this name.
    pub fn named(name: &str) -> Option<Quantity> {
        Quantity::ALL.into_iter().find(|quantity| quantity.name() == name)
    }

    /// Names of those that can be identified on purpose: readings tell their numbers, and no extra term is theirs.
    pub fn can_be_free() -> impl Iterator<Item = &'static str> {
        let all = Quantity::ALL.into_iter();
        all.filter(|quantity| {
            quantity.is_told() && quantity.terms(0).is_none() && quantity.facts().numbers != Numbers::None
        })
        .map(Quantity::name)
    }

    /// Whether residuals show it: the scale of the force is every stiffness's, and what lies behind the flange is a
    /// joint's.
    pub fn is_told(self) -> bool {
        !matches!(self, Quantity::ForceScale | Quantity::Sensor)
    }

    /// How many numbers it has on an arm of so many joints.
    pub fn dimension(self, joints: usize) -> usize {
        match self.facts().numbers {
            Numbers::None => 0,
            Numbers::One => 1,
            Numbers::Direction => 2,
            Numbers::Axes => 3,
            Numbers::Body => 6,
            Numbers::Joints => joints,
        }
    }

    /// Names of its numbers; of several load cases that of the load before them.
    pub fn parts(self, cell: &Cell) -> Vec<String> {
        let load = |i: usize| cell.setup.load.cases().get(i);
        let load = match self {
            Quantity::Anchor(i) | Quantity::LoadingPoint(Some(i)) => load(i),
            _ => None,
        };
        let load = load.map_or_else(String::new, |case| format!("{} ", case.name));
        let axes = ["x", "y", "z", "turn x", "turn y", "turn z"];
        match self.facts().numbers {
            Numbers::None | Numbers::One => vec![load],
            Numbers::Joints => {
                let joints = cell.setup.robot.joints().iter();
                joints.map(|joint| joint.name.clone()).collect()
            }
            numbers => {
                let count = match numbers {
                    Numbers::Direction => 2,
                    Numbers::Body => 6,
                    _ => 3,
                };
                axes[..count].iter().map(|axis| format!("{load}{axis}")).collect()
            }
        }
    }

    /// The element by which number `i` acts again at work, where one does: what stays with the arm.
    pub fn terms(self, i: usize) -> Option<ExtraTerm> {
        match self {
            Quantity::BaseTilt => Some(ExtraTerm::BaseTilt),
            Quantity::LostMotion => Some(ExtraTerm::LostMotion(i)),
            _ => None,
        }
    }

    /// Standard uncertainty of each of its numbers, and whether the cell states it; of what is `free` wide beside the
    /// readings.
    pub fn size(self, uncertainty: &Uncertainty, is_free: bool) -> (f64, bool) {
        let facts = self.facts();
        match (facts.declared)(uncertainty) {
            _ if is_free && facts.unit == "N" => (FREE_FORCE, true),
            _ if is_free => (FREE, true),
            Some(size) => (size, true),
            None => (facts.assumed, false),
        }
    }

    /// Whether its frames are other ones where it is: all is computed anew there.
    pub fn moves_frames(self) -> bool {
        matches!(self, Quantity::Points | Quantity::Angle(_) | Quantity::Coupling | Quantity::Rows)
    }

    /// Step for a derivative by differences: small beside any geometry, large beside rounding, in its unit.
    pub fn step(self) -> f64 {
        match self {
            Quantity::Beside | Quantity::Offset => 1.0,
            Quantity::LostMotion => 1e-5,
            Quantity::BaseTilt | Quantity::Sensor => 1e-9,
            _ => 1e-4,
        }
    }

    /// Longest step of a search for it, in its unit.
    pub fn farthest_step(self) -> f64 {
        match self {
            Quantity::Beside | Quantity::Offset => 200.0,
            _ => 0.5,
        }
    }
}
