//! Counts how often the total band of a prediction holds the true deflection on
//! simulated arms whose lost motion, force scale and base tilt are drawn from the
//! sizes that the cell declares, and how wide it is where there are none. Prints the
//! table of docs/predicting.md.
//!
//! ```text
//! cargo run --release -p stiffarm --example total_band -- 2000
//! ```

use rand::SeedableRng;
use rand::distr::{Distribution, Uniform};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use rayon::prelude::*;
use std::error::Error;
use stiffarm::estimate::identify::{Fit, IdentifyOptions};
use stiffarm::estimate::validate::simulate_measurements;
use stiffarm::model::observation::{ExtraTerm, PostureTerms};
use stiffarm::model::stiffness::Model;
use stiffarm::nalgebra::{DVector, Vector3};
use stiffarm::work::predict::{LoadedArm, PredictOptions};
use stiffarm::{
    Cell, Control, GlobalOptions, Index, LoadedPosture, Posture, PostureGroup, Result, Wrench, predict, select,
};

/// Work postures at which the deflection is predicted.
const WORK: usize = 12;
/// Declared: force scale (fraction), tilt of the base \[rad/(N·m)\], lost motion of
/// each joint \[rad\].
const FORCE_SCALE: f64 = 0.01;
const BASE_TILT: f64 = 1e-8;
const LOST_MOTION: f64 = 0.1 / 60.0 * std::f64::consts::PI / 180.0;

/// What an arm has beside its springs, in declared sizes.
struct Truth {
    terms: Vec<(ExtraTerm, f64)>,
    force: f64,
}

/// One experiment.
struct Outcome {
    /// Components inside, x, y, z: statistical and total bands.
    inside: [[usize; 3]; 2],
    /// Total over statistical band, RMS over points and axes: with all sources, and
    /// without the force scale, which no reading sees.
    ratio: [f64; 2],
}

fn main() -> std::result::Result<(), Box<dyn Error>> {
    let runs: u64 = std::env::args().nth(1).map_or(Ok(2000), |text| text.parse())?;
    let mut cell = stiffarm_files::builtin::cell("comau")?;
    let uncertainty = &mut cell.uncertainty;
    uncertainty.force_scale = Some(FORCE_SCALE);
    uncertainty.base_tilt_compliance = Some(BASE_TILT);
    uncertainty.lost_motion = Some(LOST_MOTION);
    // The truth has no others.
    uncertainty.anchor = Some(0.0);
    uncertainty.loading_point = Some(0.0);
    uncertainty.registration = Some(0.0);
    let robot = &cell.setup.robot;
    let group1 = stiffarm_files::builtin::postures("comau-group1", robot)?;
    let mut options = GlobalOptions::default();
    options.rounds = Some(2);
    let plan = select(&cell, Index::ExpectedError, 12, &options, Control::default())?;
    let plan = PostureGroup::from_angles("plan", plan.group).postures;
    let work = work(&cell)?;
    println!(
        "| truth | postures | experiments | statistical band holds x, y, z | total band holds x, y, z | total / statistical | without force scale |"
    );
    println!("|:--|--:|--:|--:|--:|--:|--:|");
    for (name, size) in [("drawn from the declared sizes", 1.0), ("noise only", 0.0)] {
        for (postures, few) in [(&group1, 6), (&plan, 12)] {
            let all: Vec<Outcome> = (0..runs)
                .into_par_iter()
                .map(|run| experiment(&cell, postures, &work, size, run))
                .collect::<Result<_>>()?;
            let share = |band: usize| {
                let axis = |i: usize| all.iter().map(|o| o.inside[band][i]).sum::<usize>();
                let percent = |i: usize| 100.0 * axis(i) as f64 / (all.len() * WORK) as f64;
                let shares = [0, 1, 2].map(|i| format!("{:.1}", percent(i)));
                format!("{} %", shares.join(", "))
            };
            let median = |i: usize| {
                let mut ratios: Vec<f64> = all.iter().map(|o| o.ratio[i]).collect();
                ratios.sort_by(f64::total_cmp);
                ratios[ratios.len() / 2]
            };
            println!("| {name} | {few} | {runs} | {} | {} | {:.1} | {:.1} |", share(0), share(1), median(0), median(1));
        }
    }
    Ok(())
}

/// Postures about the cell's tasks under forces of a process.
fn work(cell: &Cell) -> Result<Vec<LoadedPosture>> {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let turn = Uniform::new(-0.3, 0.3).expect("finite");
    let force = Uniform::new(-350.0, 350.0).expect("finite");
    let around = (0..WORK).map(|i| {
        let task = &cell.tasks[i % cell.tasks.len()];
        let mut q = task.q.clone();
        let mut wrench = task.wrench;
        if i >= cell.tasks.len() {
            q.iter_mut().for_each(|a| *a += turn.sample(&mut rng));
            wrench = Wrench::force([0; 3].map(|_| force.sample(&mut rng)));
        }
        Ok(LoadedPosture::new(format!("{i}"), q, wrench))
    });
    around.collect()
}

fn experiment(cell: &Cell, postures: &[Posture], work: &[LoadedPosture], size: f64, run: u64) -> Result<Outcome> {
    let stiffness = cell.require_prior()?;
    let compliance = DVector::from_iterator(stiffness.len(), stiffness.iter().map(|k| 1.0 / k));
    let mut rng = ChaCha8Rng::seed_from_u64(run);
    let mut draw = || {
        let normal: f64 = StandardNormal.sample(&mut rng);
        size * normal
    };
    let joints = (0..cell.setup.robot.joint_count()).map(ExtraTerm::LostMotion);
    let truth = Truth {
        terms: joints
            .map(|term| (term, LOST_MOTION * draw()))
            .collect::<Vec<_>>()
            .into_iter()
            .chain([(ExtraTerm::BaseTilt, BASE_TILT * draw())])
            .collect(),
        force: FORCE_SCALE * draw(),
    };
    let mut measured = simulate_measurements(cell, postures, stiffness, Model::Linear, run, 0)?;
    for m in &mut measured {
        let terms = PostureTerms::new(&cell.setup, &m.posture.q, None)?;
        let springs = terms.block(&cell.setup.robot) * &compliance;
        // The force that was read is too large by that much.
        let mut moved = springs * (1.0 / (1.0 + truth.force) - 1.0);
        for (term, value) in &truth.terms {
            moved += term.column(&terms) * *value;
        }
        for d in &mut m.displacements {
            d.value += moved.fixed_rows::<3>(3 * d.point);
        }
    }
    let predictor = Fit::new(cell, measured, &IdentifyOptions::default())?.compliance()?;
    let mut options = PredictOptions::default();
    options.model = Model::Linear;
    let predicted = predict(cell, &predictor, work, &options, Control::default())?;
    let mut without = predictor.clone();
    for (i, part) in predictor.common.parts.iter().enumerate() {
        if part.source == "force-scale" {
            without.common.parts[i].change.fill(0.0);
        }
    }
    let without = predict(cell, &without, work, &options, Control::default())?;

    let arm = LoadedArm::from_stiffness(cell, stiffness)?;
    let mut out = Outcome { inside: [[0; 3]; 2], ratio: [0.0; 2] };
    let mut squares = [0.0; 3];
    for ((point, other), at) in predicted.points.iter().zip(&without.points).zip(work) {
        let terms = arm.terms(&at.q, &at.wrench)?;
        let mut exact: Vector3<f64> = arm.linear(&terms).fixed_rows::<3>(0).into_owned();
        for (term, value) in &truth.terms {
            exact += term.column(&terms) * *value;
        }
        let bands = [point, other].map(|p| p.band.expect("an identification gives bands"));
        for i in 0..3 {
            let off = (point.shift_m[i] - exact[i]).abs();
            out.inside[0][i] += usize::from(off <= bands[0].statistical_m[i]);
            out.inside[1][i] += usize::from(off <= bands[0].total_m[i]);
            squares[0] += bands[0].statistical_m[i].powi(2);
            squares[1] += bands[0].total_m[i].powi(2);
            squares[2] += bands[1].total_m[i].powi(2);
        }
    }
    out.ratio = [squares[1], squares[2]].map(|s| (s / squares[0]).sqrt());
    Ok(out)
}
