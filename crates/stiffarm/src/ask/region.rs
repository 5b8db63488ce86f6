//! The part of the workspace that a map or a search for a place is about.

#[cfg(feature = "clap")]
use crate::ask::values::{number, triple};
use crate::error::{Error, Result};
use crate::model::cell::Cell;
use crate::model::kinematics::Frames;
use crate::units::mm_to_m;

/// Nodes along the longest side.
const LINE: usize = 61;
const BOX: usize = 31;
const PLACES: usize = 11;
/// Planes of a box across z.
const PLANES: usize = 6;
/// Corners of a region by the arm's reach are multiples of this \[m\].
const ROUND: f64 = 0.1;

/// A plane of the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// 0 to 2 for x, y, z.
    pub axis: usize,
    /// Coordinate along it \[mm\].
    pub mm: f64,
}

/// Nodes of a region.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Steps {
    /// Along the longest side; the others in proportion.
    Longest(usize),
    /// Along x, y, z.
    Each([usize; 3]),
}

/// The part of the workspace that is asked for.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "clap", derive(clap::Args), command(next_help_heading = "Region (base frame)"))]
pub struct RegionOptions {
    /// Map a plane: its coordinate, for example z=800 [mm]
    #[cfg_attr(feature = "clap", arg(long, value_name = "AXIS=MM", value_parser = plane))]
    pub plane: Option<Plane>,
    /// Lower corner [mm] [default: the cell's box, else what the arm may reach]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X,Y,Z", value_parser = triple("mm"),
        allow_hyphen_values = true, requires = "to_mm"))]
    pub from_mm: Option<[f64; 3]>,
    /// Upper corner [mm]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X,Y,Z", value_parser = triple("mm"),
        allow_hyphen_values = true, requires = "from_mm"))]
    pub to_mm: Option<[f64; 3]>,
    /// Nodes along the longest side, or along x, y and z [default: 61; 31 and six planes in z for a
    /// box; 11 with --place]
    #[cfg_attr(feature = "clap", arg(long, value_name = "N|NX,NY,NZ", value_parser = steps))]
    pub steps: Option<Steps>,
}

/// A box with its nodes along x, y, z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Lower corner \[m\].
    pub lower: [f64; 3],
    /// Upper corner \[m\].
    pub upper: [f64; 3],
    /// Nodes.
    pub steps: [usize; 3],
}

impl Region {
    /// The region of a map.
    ///
    /// # Errors
    /// An upside-down box (key `from_mm`), a plane of no axis (key `plane`).
    pub fn of_map(cell: &Cell, options: &RegionOptions) -> Result<Self> {
        let (lower, upper) = corners(cell, options)?;
        let is_box = (0..3).all(|axis| lower[axis] < upper[axis]);
        let steps = match options.steps {
            None if is_box => {
                let [x, y, _] = proportional(lower, upper, BOX);
                [x, y, PLANES]
            }
            None => proportional(lower, upper, LINE),
            Some(steps) => counted(lower, upper, steps),
        };
        Ok(Region { lower, upper, steps })
    }

    /// The region for the origin of a workpiece: the plane through the given place
    /// unless something else is asked for.
    ///
    /// # Errors
    /// An upside-down box (key `from_mm`), a plane of no axis (key `plane`).
    pub fn of_places(cell: &Cell, options: &RegionOptions) -> Result<Self> {
        let (mut lower, mut upper) = corners(cell, options)?;
        if options.plane.is_none() && options.from_mm.is_none() {
            let height = cell.work.workpiece.translation.vector.z;
            (lower[2], upper[2]) = (height, height);
        }
        let steps = options.steps.unwrap_or(Steps::Longest(PLACES));
        Ok(Region { lower, upper, steps: counted(lower, upper, steps) })
    }
}

fn corners(cell: &Cell, options: &RegionOptions) -> Result<([f64; 3], [f64; 3])> {
    let (mut lower, mut upper) = match (options.from_mm, options.to_mm) {
        (Some(from), Some(to)) => (from.map(mm_to_m), to.map(mm_to_m)),
        _ => within_reach(cell),
    };
    if let Some(plane) = options.plane {
        if plane.axis > 2 {
            let message = format!("A plane's axis is 0, 1 or 2 for x, y, z; got {}.", plane.axis);
            return Err(Error::invalid(message).key("plane"));
        }
        (lower[plane.axis], upper[plane.axis]) = (mm_to_m(plane.mm), mm_to_m(plane.mm));
    }
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        if lower[axis] > upper[axis] {
            return Err(Error::invalid(format!("Along {name}, `from_mm` must not be above `to_mm`."))
                .key("from_mm")
                .hint("give the lower corner with `from_mm` and the upper one with `to_mm`"));
        }
    }
    Ok((lower, upper))
}

/// The cell's box for tool points, else the cube about the shoulder that the
/// stretched arm reaches, above the floor where there is one.
fn within_reach(cell: &Cell) -> ([f64; 3], [f64; 3]) {
    if let Some([lower, upper]) = cell.limits.tool_box {
        return (lower.into(), upper.into());
    }
    let robot = &cell.setup.robot;
    let frames = Frames::at_serial_angles(robot, &vec![0.0; robot.joint_count()]);
    let origins = frames.origins();
    let tip = frames.point(&cell.work.tip(&cell.setup.tool).translation.vector);
    let ends = origins.iter().skip(1).chain([&tip]);
    let reach: f64 = origins.iter().zip(ends).map(|(a, b)| (b - a).norm()).sum();
    let centre = origins.first().copied().unwrap_or_default();
    let [x, y, z]: [f64; 3] = centre.into();
    let low = |v: f64| ((v - reach) / ROUND).floor() * ROUND;
    let high = |v: f64| ((v + reach) / ROUND).ceil() * ROUND;
    let floor = cell.limits.floor.unwrap_or(f64::NEG_INFINITY);
    ([low(x), low(y), low(z).max(floor)], [high(x), high(y), high(z).max(floor)])
}

fn counted(lower: [f64; 3], upper: [f64; 3], steps: Steps) -> [usize; 3] {
    match steps {
        Steps::Longest(longest) => proportional(lower, upper, longest),
        Steps::Each(each) => each,
    }
}

/// Nodes about equally far from each other, `longest` along the longest side.
fn proportional(lower: [f64; 3], upper: [f64; 3], longest: usize) -> [usize; 3] {
    let sides: [f64; 3] = std::array::from_fn(|axis| upper[axis] - lower[axis]);
    let most = sides.iter().copied().fold(0.0, f64::max);
    sides.map(|side| {
        if side > 0.0 && longest > 1 { ((longest - 1) as f64 * side / most).round().max(1.0) as usize + 1 } else { 1 }
    })
}

#[cfg(feature = "clap")]
fn plane(text: &str) -> std::result::Result<Plane, String> {
    let wanted = "x, y or z with a coordinate in mm is needed, as in z=800";
    let parts = text.split_once('=').and_then(|(axis, mm)| {
        let axis = ["x", "y", "z"].iter().position(|name| *name == axis.trim());
        Some((axis?, mm.trim().parse::<f64>().is_ok().then_some(mm)?))
    });
    let (axis, mm) = parts.ok_or(wanted)?;
    Ok(Plane { axis, mm: number("mm")(mm)? })
}

#[cfg(feature = "clap")]
fn steps(text: &str) -> std::result::Result<Steps, String> {
    let counts: Option<Vec<usize>> =
        text.split(',').map(|v| v.trim().parse().ok().filter(|n| (1..=1_000_000).contains(n))).collect();
    match counts.as_deref() {
        Some([longest]) => Ok(Steps::Longest(*longest)),
        Some([x, y, z]) => Ok(Steps::Each([*x, *y, *z])),
        _ => Err("a number from 1, or three with commas between them, is needed".to_string()),
    }
}
