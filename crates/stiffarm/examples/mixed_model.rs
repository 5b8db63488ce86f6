//! Counts what the mixed elastic model is worth on simulated arms: intervals of joint
//! stiffness, bands at postures that took no part, what it costs or gains, and how often
//! `auto` chooses it. Prints the tables of docs/identifying.md.
//!
//! ```text
//! cargo run --release -p stiffarm --example mixed_model -- 2000 500
//! ```

use rand::SeedableRng;
use rand::distr::{Distribution, Uniform};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use rayon::prelude::*;
use std::error::Error;
use stiffarm::estimate::elastic::{ElasticChoice, elastic};
use stiffarm::estimate::identify::{Fit, IdentifyOptions, JointEstimate};
use stiffarm::estimate::mixed::MixedFit;
use stiffarm::estimate::validate::{Model, simulate_measurements, validate_with};
use stiffarm::model::elastic::ElasticClass;
use stiffarm::model::measurement::MeasuredPosture;
use stiffarm::model::observation::{ExtraTerm, PostureTerms};
use stiffarm::model::posture::PostureGroup;
use stiffarm::{Cell, IdentifiedCompliance, Result};

/// Postures that every experiment keeps out.
const KEPT_OUT: usize = 20;
/// Standard deviations of shifts, turns and coupling as on the measured FANUC
/// R-2000iC \[m/N, rad/(N·m), rad/N\].
const FANUC: [f64; 3] = [9.0e-8, 1.4e-7, 7.6e-8];

/// What springs beyond the axes the truth has, in units of the FANUC's sizes.
const TRUTHS: [(&str, f64); 3] = [
    ("nothing", 0.0),
    ("a tenth of the FANUC's", 0.1),
    ("as the FANUC's", 1.0),
];

/// A simulated arm with its readings.
struct Experiment {
    cell: Cell,
    truth: Vec<f64>,
    fit: Fit,
    kept_out: Vec<MeasuredPosture>,
}

/// What one model made of one experiment.
#[derive(Clone, Copy)]
struct Outcome {
    /// Mean square at the postures kept out \[m²\].
    square: f64,
    /// Share of components inside their bands.
    inside: f64,
    /// Share of intervals that hold the true stiffness.
    covers: f64,
}

fn main() -> std::result::Result<(), Box<dyn Error>> {
    let number = |n: usize, other: u64| {
        let given = std::env::args().nth(n);
        given.map_or(Ok(other), |text| text.parse())
    };
    let (counted, chosen) = (number(1, 100)?, number(2, 20)?);
    println!(
        "| beyond the axes | postures | error, axes | error, mixed | bands hold, axes | mixed | k holds, axes | mixed |"
    );
    println!("|:--|--:|--:|--:|--:|--:|--:|--:|");
    for (name, size) in TRUTHS {
        for postures in [6, 12, 40] {
            let all: Vec<[Outcome; 2]> = (0..counted)
                .into_par_iter()
                .map(|run| both(&experiment(run, postures, size)?))
                .collect::<Result<_>>()?;
            let mean = |of: &dyn Fn(&[Outcome; 2]) -> f64| {
                all.iter().map(of).sum::<f64>() / all.len() as f64
            };
            let mm = |i: usize| 1e3 * mean(&|o| o[i].square).sqrt();
            let percent = |of: &dyn Fn(&[Outcome; 2]) -> f64| 100.0 * mean(of);
            println!(
                "| {name} | {postures} | {:.4} mm | {:.4} mm | {:.1} % | {:.1} % | {:.1} % | {:.1} % |",
                mm(0),
                mm(1),
                percent(&|o| o[0].inside),
                percent(&|o| o[1].inside),
                percent(&|o| o[0].covers),
                percent(&|o| o[1].covers),
            );
        }
    }
    println!("\n{counted} experiments a row.\n");
    println!("| beyond the axes | postures | `auto` takes mixed |");
    println!("|:--|--:|--:|");
    for (name, size) in TRUTHS {
        for postures in [6, 20] {
            let took: Vec<bool> = (0..chosen)
                .into_par_iter()
                .map(|run| {
                    let fit = experiment(run, postures, size)?.fit;
                    let (found, _) = elastic(&fit, ElasticChoice::Auto)?;
                    Ok(found.model == ElasticChoice::Mixed)
                })
                .collect::<Result<_>>()?;
            let share = took.iter().filter(|took| **took).count() as f64 / took.len() as f64;
            println!("| {name} | {postures} | {:.1} % |", 100.0 * share);
        }
    }
    println!("\n{chosen} experiments a row.");
    Ok(())
}

fn experiment(run: u64, postures: usize, size: f64) -> Result<Experiment> {
    let mut cell = Cell::built_in("comau")?;
    cell.noise.readings_per_displacement = 2;
    let truth = cell.require_prior()?.to_vec();
    let mut rng = ChaCha8Rng::seed_from_u64(run);
    let unit = Uniform::new(0.0, 1.0).expect("0 is below 1");
    let angles: Vec<Vec<f64>> = (0..postures + KEPT_OUT)
        .map(|_| {
            let bounds = cell.bounds.iter();
            bounds
                .map(|[low, high]| low + (high - low) * unit.sample(&mut rng))
                .collect()
        })
        .collect();
    let group = PostureGroup::from_angles("", angles).postures;
    let mut measured = simulate_measurements(&cell, &group, &truth, Model::Linear, run, 0)?;
    bend(&cell, &mut measured, size, &mut rng)?;
    let kept_out = measured.split_off(postures);
    let fit = Fit::new(&cell, measured, &IdentifyOptions::default())?;
    Ok(Experiment {
        cell,
        truth,
        fit,
        kept_out,
    })
}

/// Joint axes alone and the mixed model, whatever the data call for.
fn both(experiment: &Experiment) -> Result<[Outcome; 2]> {
    let Experiment { cell, fit, .. } = experiment;
    let axes = fit.identification()?;
    let by_axes = outcome(
        experiment,
        &IdentifiedCompliance::from_identification(cell, axes)?,
        &axes.estimates.joints,
    )?;
    let mixed = match MixedFit::new(fit) {
        Ok(mixed) => outcome(experiment, mixed.compliance(), &mixed.result()?.joints)?,
        // What cannot be fitted falls back to the axes.
        Err(_) => by_axes,
    };
    Ok([by_axes, mixed])
}

fn outcome(
    experiment: &Experiment,
    predictor: &IdentifiedCompliance,
    joints: &[JointEstimate],
) -> Result<Outcome> {
    let Experiment { cell, truth, .. } = experiment;
    let kept_out = experiment.kept_out.clone();
    let by = validate_with(cell, predictor, kept_out, Model::Linear, None)?;
    let held = joints.iter().zip(truth).filter(|(joint, k)| {
        let [low, high] = joint.interval;
        // Without a positive lower end nothing is said against large k.
        low.is_some_and(|low| low <= **k) && high.is_none_or(|high| **k <= high)
    });
    Ok(Outcome {
        square: by.component_rms_m.powi(2),
        inside: by
            .band
            .map_or(0.0, |b| b.inside as f64 / b.components as f64),
        covers: held.count() as f64 / truth.len() as f64,
    })
}

/// Adds what springs beyond the axes do, drawn at `size` times the FANUC's sizes.
fn bend(
    cell: &Cell,
    measured: &mut [MeasuredPosture],
    size: f64,
    rng: &mut ChaCha8Rng,
) -> Result<()> {
    let mut springs = Vec::new();
    for joint in std::iter::once(None).chain((0..cell.setup.robot.joint_count()).map(Some)) {
        for row in 0..6 {
            for column in row..6 {
                let class = ElasticClass::of(row, column) as usize;
                let beside = if row == column { 1.0 } else { 0.5f64.sqrt() };
                let normal: f64 = StandardNormal.sample(rng);
                if joint.is_none() || (row, column) != (5, 5) {
                    let term = ExtraTerm::Spring { joint, row, column };
                    springs.push((term, size * FANUC[class] * beside * normal));
                }
            }
        }
    }
    for m in measured {
        let terms = PostureTerms::new(&cell.setup, &m.posture.q, None)?;
        for (term, value) in &springs {
            let column = term.column(&terms) * *value;
            for d in &mut m.displacements {
                d.value += column.fixed_rows::<3>(3 * d.point);
            }
        }
    }
    Ok(())
}
