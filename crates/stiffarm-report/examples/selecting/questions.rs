//! The other questions of the page: how many postures, how sure, a lost
//! posture, the load, the prior, and the ways without an index.

use crate::plans::{Band, Plan};
use serde::Serialize;
use stiffarm::Control;
use stiffarm::Result;
use stiffarm::model::cell::Cell;
use stiffarm::model::load::Load;
use stiffarm::plan::certificate::{Certificate, CertificateOptions, JointEfficiency, certify, joint_efficiencies};
use stiffarm::plan::index::Index;
use stiffarm::plan::select::{DesignedLoad, GlobalOptions, drop_postures, select, space_filling};
use stiffarm::plan::zones::Zone;

/// Numbers of postures of the curve.
const SIZES: [usize; 12] = [1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 30];

/// Expected error against the number of postures.
#[derive(Debug, Serialize)]
pub struct CountPoint {
    pub postures: usize,
    /// The best group found.
    pub expected_error: f64,
    pub mean_expected_deviation: f64,
    /// No group of this size is below.
    pub bound: f64,
    pub efficiency: f64,
    /// Median of 200 random groups; more than two postures.
    pub random_median: Option<f64>,
    pub space_filling: Option<f64>,
}

/// The curve; `bound` is that of one posture, and falls as 1/√n.
pub fn count(cell: &Cell, bound: f64) -> Result<Vec<CountPoint>> {
    let mut points = Vec::new();
    for postures in SIZES {
        let plan = Plan::select(cell, Index::ExpectedError, postures, 1, 4)?;
        let expected_error = plan.index(Index::ExpectedError);
        let bound = bound / (postures as f64).sqrt();
        let wide = postures > 2;
        let even =
            wide.then(|| space_filling(cell, postures, 1, Control::default())).transpose()?.map(|found| found.postures);
        let even = even.map(|group| Plan::new(cell, "space-filling", &group));
        let random = wide.then(|| Band::new(cell, 200, postures)).transpose()?;
        points.push(CountPoint {
            postures,
            expected_error,
            mean_expected_deviation: plan.mean_expected_deviation,
            bound,
            efficiency: bound / expected_error,
            random_median: random.map(|band| band.expected_error[1]),
            space_filling: even.transpose()?.map(|p| p.index(Index::ExpectedError)),
        });
    }
    Ok(points)
}

/// How sure the best plans of one cell are.
#[derive(Debug, Serialize)]
pub struct Certified {
    pub cell: String,
    /// Expected error, D, and the task index where the cell has tasks.
    pub certificates: Vec<Certificate>,
    /// Of the expected-error plan.
    pub joints: Vec<JointEfficiency>,
    /// No six postures have a worst joint below the worst of the joints' own bounds.
    pub worst_joint_bound: f64,
    pub worst_joint: f64,
    /// Without one of six there are five left: their bound.
    pub drop_one_bound: f64,
    pub drop_one: f64,
}

/// Certificates of the plans in `plans` that have one.
pub fn certified(cell: &Cell, plans: &[Plan]) -> Result<Certified> {
    let options = CertificateOptions::default();
    let named = |name: &str| plans.iter().find(|p| p.name == name);
    let mut certificates = Vec::new();
    for (name, index) in [("expected-error", Index::ExpectedError), ("d", Index::D), ("task", Index::Task)] {
        if let Some(plan) = named(name) {
            certificates.push(certify(cell, index, &plan.group, &options, Control::default())?);
        }
    }
    let best = named("expected-error").expect("there is a plan for the expected error");
    let joints = joint_efficiencies(cell, &best.group, &options, Control::default())?;
    let count = best.postures as f64;
    let value = |name: &str, index| named(name).map_or(f64::NAN, |p| p.index(index));
    Ok(Certified {
        cell: cell.name.clone(),
        worst_joint_bound: joints.iter().map(|j| j.bound).fold(0.0, f64::max),
        worst_joint: value("worst-joint", Index::WorstJoint),
        drop_one_bound: certificates[0].bound * (count / (count - 1.0)).sqrt(),
        drop_one: value("drop-one", Index::DropOne),
        certificates,
        joints,
    })
}

/// What a lost posture costs one plan.
#[derive(Debug, Serialize)]
pub struct Lost {
    pub cell: String,
    pub plan: String,
    pub expected_error: f64,
    /// The expected error without each posture, smallest first.
    pub without_one: Vec<f64>,
    pub expected_deviation: Vec<f64>,
    /// Each joint's, without the posture whose loss hurts most.
    pub expected_deviation_after_worst_loss: Vec<f64>,
}

impl Lost {
    pub fn new(cell: &Cell, plan: &Plan) -> Result<Self> {
        let index = Index::ExpectedError;
        let worth = drop_postures(cell, index, &plan.group, 1, Control::default())?.values;
        let worst = worth.last().map_or(0, |w| w.posture);
        let mut rest = plan.group.clone();
        rest.remove(worst);
        Ok(Lost {
            cell: cell.name.clone(),
            plan: plan.name.clone(),
            expected_error: plan.index(index),
            without_one: worth.iter().map(|w| w.value.unwrap_or(f64::NAN)).collect(),
            expected_deviation: plan.expected_deviation.clone(),
            expected_deviation_after_worst_loss: Plan::new(cell, "rest", &rest)?.expected_deviation,
        })
    }
}

/// One way to choose the load together with the postures.
#[derive(Debug, Serialize)]
pub struct LoadCase {
    pub moved: String,
    pub load: DesignedLoad,
    pub plan: Plan,
}

/// Anchor on a strip of floor, loading point on a bracket: the boxes, base and
/// flange axes \[m\].
pub const ANCHOR_BOX: [[f64; 3]; 2] = [[1.0, -0.8, 0.0], [2.6, 0.8, 0.0]];
pub const POINT_BOX: [[f64; 3]; 2] = [[0.1, -0.1, 0.15], [0.3, 0.1, 0.35]];

/// Six postures under the expected error, with the load in its boxes.
pub fn load(cell: &Cell) -> Result<Vec<LoadCase>> {
    let corners = |b: [[f64; 3]; 2]| Some(b.map(Into::into));
    let mut cases = Vec::new();
    for (moved, anchor, loading_point) in [
        ("nothing", None, None),
        ("anchor", corners(ANCHOR_BOX), None),
        ("loading point", None, corners(POINT_BOX)),
        ("both", corners(ANCHOR_BOX), corners(POINT_BOX)),
    ] {
        let mut options = GlobalOptions::default();
        options.rounds = Some(8);
        options.load.anchor = anchor;
        options.load.loading_point = loading_point;
        let index = Index::ExpectedError;
        let found = select(cell, index, 6, &options, Control::default())?;
        let mut changed = cell.clone();
        if let Some(design) = &found.load {
            changed.setup.tool.loading_point = design.loading_point_m.into();
            if let (Load::Rope { anchor, .. }, Some(at)) = (&mut changed.setup.load, design.anchor_m) {
                *anchor = at.into();
            }
        }
        let mut plan = Plan::new(&changed, moved, &found.group)?;
        plan.rounds = found.rounds;
        cases.push(LoadCase { moved: moved.into(), load: changed.setup.into(), plan });
    }
    Ok(cases)
}

/// Groups from Dumas' best zone of joints 2 and 3.
#[derive(Debug, Serialize)]
pub struct ZoneGroups {
    /// Joints 2 and 3 within the zone, the others as they are held in the map.
    pub held: Band,
    /// Joints 2 and 3 within the zone, the others random.
    pub free: Band,
    /// The best six postures with joints 2 and 3 within the zone.
    pub best: Plan,
}

impl ZoneGroups {
    pub fn new(cell: &Cell, zone: &Zone) -> Result<Self> {
        let mut free = cell.clone();
        free.bounds[1] = zone.q2;
        free.bounds[2] = zone.q3;
        let mut held = free.clone();
        for j in [0, 3, 4, 5] {
            held.bounds[j] = [zone.best_q[j]; 2];
        }
        Ok(ZoneGroups {
            held: Band::new(&held, 200, 6)?,
            free: Band::new(&free, 200, 6)?,
            best: Plan::select(&free, Index::ExpectedError, 6, 1, 8)?,
        })
    }
}
