//! Set-ups and steps of many tests.

use super::prelude::*;
use stiffarm::estimate::systematic::{SystematicErrors, SystematicSource};
use stiffarm::model::path::{PathPoint, PathTarget};

/// The default of a type with changes.
pub fn with<T: Default>(change: impl FnOnce(&mut T)) -> T {
    changed(T::default(), change)
}

/// A value with changes.
pub fn changed<T>(mut value: T, change: impl FnOnce(&mut T)) -> T {
    change(&mut value);
    value
}

/// Identification by this estimator.
pub fn by(estimator: Estimator) -> IdentifyOptions {
    with(|o: &mut IdentifyOptions| o.estimator = estimator)
}

/// Postures named 1, 2, 3, …
pub fn numbered(angles: impl IntoIterator<Item = Vec<f64>>) -> Vec<Posture> {
    PostureGroup::from_angles("", angles).postures
}

/// 1/k of each spring.
pub fn compliance_of(stiffness: &[f64]) -> DVector<f64> {
    DVector::from_iterator(stiffness.len(), stiffness.iter().map(|k| 1.0 / k))
}

/// The prior as what predicts.
pub fn prior(cell: &Cell) -> IdentifiedCompliance {
    IdentifiedCompliance::from_stiffness(cell, cell.require_prior().unwrap()).unwrap()
}

/// The first finding with this code.
#[track_caller]
pub fn the<'a>(findings: &'a [Finding], code: &str) -> &'a Finding {
    let finding = findings.iter().find(|f| f.code == code);
    finding.unwrap_or_else(|| panic!("no {code}: {findings:#?}"))
}

/// A local selection from a start, as it is by default.
pub fn local<Q: AsRef<[f64]>>(cell: &Cell, index: Index, start: &[Q]) -> stiffarm::Result<Selection> {
    select_from(cell, index, start, Options::default(), Control::default())
}

pub fn stopped_by<'a>(stop: stiffarm::Stop<'a>) -> Control<'a> {
    Control { stop: Some(stop), progress: None }
}

/// What `work` gives with so many threads.
pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(work)
}

/// A weight \[N\] that hangs from the tool.
pub fn hanging(magnitude: f64) -> Load {
    Load::Weight { magnitude, direction: -Vector3::z() }
}

/// The force of the cell's rope.
#[track_caller]
pub fn rope_force(cell: &mut Cell) -> &mut f64 {
    match &mut cell.setup.load {
        Load::Rope { magnitude, .. } => magnitude,
        other => panic!("no rope: {other:?}"),
    }
}

/// Where the cell's rope is anchored.
#[track_caller]
pub fn rope_anchor(cell: &mut Cell) -> &mut Vector3<f64> {
    match &mut cell.setup.load {
        Load::Rope { anchor, .. } => anchor,
        other => panic!("no rope: {other:?}"),
    }
}

/// Adds to the displacements of every posture what `motion` gives for all its points, 3m rows.
pub fn move_points(cell: &Cell, measured: &mut [MeasuredPosture], motion: impl Fn(&PostureTerms) -> DVector<f64>) {
    for m in measured {
        let terms = PostureTerms::new(&cell.setup, &m.posture.q, None).unwrap();
        let moved = motion(&terms);
        for d in &mut m.displacements {
            d.value += moved.fixed_rows::<3>(3 * d.point);
        }
    }
}

/// A robot of rows α, a, d, offset.
pub fn chain(name: &str, convention: DhConvention, rows: &[[f64; 4]]) -> Robot {
    let row = |&[alpha, a, d, offset]: &[f64; 4]| DhRow { alpha, a, d, offset };
    let rows: Vec<DhRow> = rows.iter().map(row).collect();
    Robot::from_dh(name, convention, &rows, Isometry3::identity()).unwrap()
}

/// Universal Robots' published lengths, with axis 4 twisted against axis 3 \[rad\].
pub fn ur10(twist: f64) -> Robot {
    let rows = [
        [FRAC_PI_2, 0.0, 0.1273, 0.0],
        [0.0, -0.612, 0.0, 0.0],
        [twist, -0.5723, 0.0, 0.0],
        [FRAC_PI_2, 0.0, 0.163_941, 0.0],
        [-FRAC_PI_2, 0.0, 0.1157, 0.0],
        [0.0, 0.0, 0.0922, 0.0],
    ];
    chain("UR10", DhConvention::Standard, &rows)
}

/// Franka's published lengths.
pub fn panda() -> Robot {
    let rows = [
        [0.0, 0.0, 0.333, 0.0],
        [-FRAC_PI_2, 0.0, 0.0, 0.0],
        [FRAC_PI_2, 0.0, 0.316, 0.0],
        [FRAC_PI_2, 0.0825, 0.0, 0.0],
        [-FRAC_PI_2, -0.0825, 0.384, 0.0],
        [FRAC_PI_2, 0.0, 0.0, 0.0],
        [FRAC_PI_2, 0.088, 0.107, 0.0],
    ];
    chain("Panda", DhConvention::Modified, &rows)
}

/// A point of a path, of which nothing else is known.
pub fn path_point(name: impl ToString, target: PathTarget) -> PathPoint {
    PathPoint { feature: None, feed: None, rapid: false, name: name.to_string().into(), line: None, target, load: None }
}

/// One source of systematic errors.
#[track_caller]
pub fn source<'a>(systematic: &'a SystematicErrors, name: &str) -> &'a SystematicSource {
    let source = systematic.sources.iter().find(|s| s.name == name);
    source.unwrap_or_else(|| panic!("no source {name}"))
}

/// The rows of a table with ` | ` between its columns.
pub fn table<const N: usize>(text: &str) -> Vec<[&str; N]> {
    fn row<const N: usize>(line: &str) -> [&str; N] {
        let columns: Vec<&str> = line.split(" | ").map(str::trim).collect();
        columns.try_into().unwrap_or_else(|_| panic!("{line}"))
    }
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    lines.map(row).collect()
}

/// A global search of so many rounds.
pub fn rounds(rounds: u64) -> GlobalOptions {
    with(|o: &mut GlobalOptions| o.rounds = Some(rounds))
}

/// Gives a joint of the cell's robot other limits.
pub fn limit_joint(cell: &mut Cell, joint: usize, limits: [f64; 2]) {
    let robot = &cell.setup.robot;
    let mut all: Vec<[f64; 2]> = robot.joints().iter().map(|j| j.limits).collect();
    all[joint] = limits;
    cell.setup.robot = robot.clone().with_limits(&all).unwrap();
}

/// Six postures near the tasks of a cell that has three, each under a force of its own at the tip.
pub fn work_near_tasks(cell: &Cell, dice: &mut Dice) -> Vec<LoadedPosture> {
    let one = |i: usize| {
        let base = &cell.tasks[i % 3].q;
        let q: Vec<f64> = base.iter().map(|a| a + dice.between(-0.3, 0.3)).collect();
        let force = Vector3::from_fn(|_, _| dice.between(-350.0, 350.0));
        LoadedPosture::new(format!("{i}"), q, Wrench::force(force))
    };
    (0..6).map(one).collect()
}
