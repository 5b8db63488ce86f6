//! What the pages of a loaded tool share: the path in 3D, the bands, how the tip gives way.

use crate::cell::Full;
use crate::path::{norm, thinned};
use crate::scene::{Ellipsoid, Scene, SceneGroup, SceneOptions, ScenePath, scene};
use crate::summary::Context;
use crate::summary::{Block, DataTable, Form, Number, Quantity, Section};
use std::collections::BTreeSet;
use stiffarm::Result;
use stiffarm::findings::visible;
use stiffarm::model::cell::Cell;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::load::{Load, Wrench};
use stiffarm::model::posture::Posture;
use stiffarm::model::stiffness::Model;
use stiffarm::nalgebra::{Point3, Vector3};
use stiffarm::work::predict::{PrincipalAxis, TipBand};

/// Stiffness of the tip, from N/m.
pub(super) const TIP_STIFFNESS: Quantity = Quantity::new("N/µm", 1e-6, Form::Significant(3));
/// Force at work \[N\].
pub(super) const FORCE: Quantity = Quantity::new("N", 1.0, Form::Significant(3));
/// A component of a direction.
const DIRECTION: Quantity = Quantity::new("", 1.0, Form::Decimals(3));
/// Most postures of a path that one steps through.
const POSTURES: usize = 60;
/// Least share of an ellipsoid's longest axis that a half axis is drawn with.
const THINNEST: f64 = 0.01;

/// A point of a path under its load.
#[derive(Debug, Clone)]
pub(super) struct WorkPoint {
    /// Its name.
    pub name: String,
    /// Controller angles \[rad\].
    pub q: Vec<f64>,
    /// Position of the unloaded tip, base frame \[m\].
    pub tip_m: [f64; 3],
    /// Load on the robot, base axes.
    pub wrench: Wrench,
    /// Shift of the tip under it, base axes \[m\].
    pub shift_m: [f64; 3],
    /// How far from the tip's place it is commanded, base axes \[m\], where that is another place.
    pub correction_m: Option<[f64; 3]>,
    /// Principal axes of a force at the tip, where they are known.
    pub principal: Option<[PrincipalAxis; 3]>,
}

/// Points under load, as groups; a path or places by themselves.
pub(super) struct AtWork<'a> {
    /// The groups by name, in the order of their points.
    pub groups: Vec<(&'a str, Vec<WorkPoint>)>,
    /// Joint stiffness \[N·m/rad\]; empty where a result does not have it.
    pub stiffness: &'a [Option<f64>],
    /// The model of the deflections.
    pub model: Model,
    /// Whether the wrenches act at the tip, or at the cell's loading point.
    pub at_tip: bool,
    /// Name of the path that the first group is, where it is one.
    pub path: Option<&'a str>,
    /// Points that must be among those shown, numbers within the first group.
    pub always_shown: Vec<usize>,
}

/// The wrench of a force and a moment.
pub(super) fn wrench(force_n: [f64; 3], moment_nm: [f64; 3]) -> Wrench {
    Wrench { force: force_n.into(), moment: moment_nm.into() }
}

impl AtWork<'_> {
    /// The section with the cell in 3D.
    ///
    /// # Errors
    /// Angles that do not fit the cell's robot.
    pub fn section(&self, context: &Context<'_>, explained: &str) -> Result<Section> {
        let first = self.groups.iter().find_map(|(_, points)| points.first());
        let (Some(cell), Some(first)) = (context.cell, first) else {
            return Ok(context.scene_section(None, explained));
        };
        let cell = self.cell(cell, first);
        let (shown, left_out) = self.shown();
        let scene = self.scene(&cell, &shown)?;
        let drawing = scene.drawing(None, Full::Number(self.drawn_in_full(&shown)));
        let explained = match left_out {
            0 => explained.to_string(),
            _ => format!(
                "{explained} Of the {} points, {} have their posture here, evenly along the path with the smallest and \
                 the largest deflection among them.",
                shown.iter().map(Vec::len).sum::<usize>() + left_out,
                shown.iter().map(Vec::len).sum::<usize>(),
            ),
        };
        let blocks = vec![Block::Text(explained.into()), Block::Scene(Box::new(scene), Some(drawing))];
        Ok(Section::new("cell", "The cell in 3D", blocks))
    }

    /// The posture that bends most, among all shown.
    fn drawn_in_full(&self, shown: &[Vec<&WorkPoint>]) -> usize {
        let sizes = shown.iter().flatten().map(|p| norm(p.shift_m)).enumerate();
        let most = sizes.reduce(|a, b| if b.1 > a.1 { b } else { a });
        most.map_or(0, |(number, _)| number)
    }

    /// The cell under the load of the work: at the tip, without what belongs to the experiment.
    fn cell(&self, cell: &Cell, first: &WorkPoint) -> Cell {
        let mut cell = cell.clone();
        if first.q.len() != cell.setup.robot.joint_count() {
            // The scene says so.
            return cell;
        }
        if self.at_tip {
            let frames = Frames::new(&cell.setup.robot, &first.q);
            let tip = frames.flange().inverse_transform_point(&Point3::from(Vector3::from(first.tip_m)));
            cell.setup.tool.loading_point = tip.coords;
            cell.setup.load = Load::Measured;
            cell.scene = cell.scene.at_work();
            cell.limits.rope_length = None;
        } else if cell.setup.load.has_cases() {
            cell.setup.load = Load::Measured;
        }
        cell
    }

    /// The points of each group that have their posture shown, and how many have not.
    fn shown(&self) -> (Vec<Vec<&WorkPoint>>, usize) {
        let mut left_out = 0;
        let groups = self.groups.iter().enumerate().map(|(g, (_, points))| {
            let count = points.len();
            if count <= POSTURES {
                return points.iter().collect();
            }
            let mut numbers: BTreeSet<usize> = BTreeSet::new();
            if g == 0 {
                numbers.extend(self.always_shown.iter().copied().filter(|i| *i < count));
            }
            let evenly = POSTURES - numbers.len();
            numbers.extend((0..evenly).map(|i| i * (count - 1) / (evenly - 1)));
            left_out += count - numbers.len();
            numbers.into_iter().map(|i| &points[i]).collect()
        });
        let groups = groups.collect();
        (groups, left_out)
    }

    fn scene(&self, cell: &Cell, shown: &[Vec<&WorkPoint>]) -> Result<Scene> {
        let postures: Vec<Vec<Posture>> = each(shown, posture);
        let wrenches: Vec<Vec<Wrench>> = each(shown, |p| p.wrench);
        let groups = self.groups.iter().zip(postures.iter().zip(&wrenches));
        let groups: Vec<SceneGroup<'_>> =
            groups.map(|((name, _), (postures, wrenches))| SceneGroup { name, postures, wrenches }).collect();
        // All of them or none.
        let stiffness: Option<Vec<f64>> = self.stiffness.iter().copied().collect();
        let options = SceneOptions { stiffness: stiffness.as_deref().filter(|all| !all.is_empty()), model: self.model };
        let mut scene = scene(cell, &groups, &options)?;
        if self.at_tip {
            scene = scene.at_work(&each(shown, |p| p.shift_m));
        }
        if let (Some(name), Some((_, points))) = (self.path, self.groups.first()) {
            scene.path = Some(path(name, points));
        }
        let ellipsoids = shown.iter().enumerate().flat_map(|(group, points)| {
            let points = points.iter().enumerate();
            points.filter_map(move |(posture, point)| ellipsoid(group, posture, point))
        });
        scene.ellipsoids = ellipsoids.collect();
        Ok(scene)
    }
}

fn each<T>(shown: &[Vec<&WorkPoint>], of: impl Fn(&WorkPoint) -> T) -> Vec<Vec<T>> {
    let groups = shown.iter().map(|points| points.iter().map(|point| of(point)).collect());
    groups.collect()
}

fn posture(point: &WorkPoint) -> Posture {
    Posture { name: visible(&point.name).into_owned(), q: point.q.clone() }
}

/// The path with its deflection in colour, a long one by fewer points.
fn path(name: &str, points: &[WorkPoint]) -> ScenePath {
    let sizes: Vec<f64> = points.iter().map(|p| 1e3 * norm(p.shift_m)).collect();
    let some: Vec<Option<f64>> = sizes.iter().copied().map(Some).collect();
    let drawn = thinned(&some);
    let ends = sizes.iter().fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], size| [size.min(low), size.max(high)]);
    ScenePath {
        name: name.to_string(),
        points: drawn.iter().map(|i| points[*i].tip_m).collect(),
        deflection: drawn.iter().map(|i| points[*i].shift_m).collect(),
        correction: drawn.iter().filter_map(|i| points[*i].correction_m).collect(),
        size: drawn.iter().map(|i| sizes[*i]).collect(),
        label: "Deflection".into(),
        unit: "mm".into(),
        range: ends,
        names: drawn.iter().map(|i| visible(&points[*i].name).into_owned()).collect(),
    }
}

/// How the tip gives way at a posture: the longest axis is the softest.
fn ellipsoid(group: usize, posture: usize, point: &WorkPoint) -> Option<Ellipsoid> {
    let principal = point.principal?;
    let gives = principal.map(|axis| axis.stiffness_n_per_m.map_or(0.0, |k| 1.0 / k));
    let most = gives.iter().copied().fold(0.0, f64::max);
    if most == 0.0 {
        return None;
    }
    let micro = principal.map(|axis| match axis.stiffness_n_per_m {
        Some(k) => Number::new(k).of(TIP_STIFFNESS).text(),
        None => "rigid".to_string(),
    });
    Some(Ellipsoid {
        group,
        posture,
        centre: point.tip_m,
        axes: principal.map(|axis| axis.direction),
        half: gives.map(|give| give.max(THINNEST * most)),
        text: format!(
            "compliance of the tip, longest where it is softest: stiffness {} along its axes",
            micro.join(", ")
        ),
    })
}

/// Where the tip gives way: name and principal axes.
pub(super) type GivesWay = (String, [PrincipalAxis; 3]);

/// What gives way how much at some places.
pub(super) fn principal_table(places: &[GivesWay]) -> DataTable {
    let axes = ["softest", "middle", "stiffest"];
    let rows = places.iter().flat_map(|(name, principal)| {
        let name = |i| if i == 0 { name.as_str() } else { "" };
        (0..axes.len()).map(move |i| (name(i), axes[i], principal[i]))
    });
    let rows: Vec<(&str, &str, PrincipalAxis)> = rows.collect();
    let part = |row: usize, k: usize| {
        let (.., axis) = rows[row];
        Some(Number::new(axis.direction[k]))
    };
    DataTable::of(
        "Stiffness of the tip along its principal axes, under a force without moment, softest first",
        "place",
        rows.iter().map(|row| row.0),
    )
    .words("axis", |row| rows[row].1.into())
    .numbers("stiffness", TIP_STIFFNESS, |row| {
        let (.., axis) = rows[row];
        Some(Number::new(axis.stiffness_n_per_m))
    })
    .numbers("x", DIRECTION, |row| part(row, 0))
    .numbers("y", DIRECTION, |row| part(row, 1))
    .numbers("z", DIRECTION, |row| part(row, 2))
}

/// What the ± of a point is made of.
pub(super) fn band_table(caption: String, band: &TipBand) -> DataTable {
    let rows = [
        ("scatter of the readings", band.statistical_m),
        ("errors common to the experiment", band.common_m),
        ("load at work", band.load_m),
        ("total", band.total_m),
    ];
    let axis = |row: usize, axis: usize| Some(Number::new(rows[row].1[axis]));
    DataTable::of(caption, "from", rows.map(|(name, ..)| name))
        .numbers("size", Quantity::LENGTH, |row| Some(Number::new(band.size_m[row])))
        .numbers("x", Quantity::LENGTH, |row| axis(row, 0))
        .numbers("y", Quantity::LENGTH, |row| axis(row, 1))
        .numbers("z", Quantity::LENGTH, |row| axis(row, 2))
}

/// Most of the ± at a point, in words, from its parts: statistical, common, load.
pub(super) fn dominant(size_m: [f64; 4]) -> &'static str {
    let [statistical, common, load, _] = size_m;
    if load >= statistical.max(common) {
        "the uncertainty of the load at work"
    } else if common >= statistical {
        "errors common to the whole experiment"
    } else {
        "the scatter of the readings"
    }
}
