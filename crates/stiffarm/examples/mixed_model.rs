//! Counts what the mixed elastic model is worth on simulated arms: intervals of joint
//! stiffness, bands at postures that took no part, how often `auto` chooses it, and what
//! it costs or gains. Prints the table of docs/identifying.md.
//!
//! ```text
//! cargo run --release -p stiffarm --example mixed_model -- 500
//! ```

use rand::SeedableRng;
use rand::distr::{Distribution, Uniform};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use rayon::prelude::*;
use std::error::Error;
use stiffarm::estimate::elastic::{ElasticChoice, elastic};
use stiffarm::estimate::identify::{Fit, IdentifyOptions, JointEstimate};
use stiffarm::estimate::validate::{Model, Validation, simulate_measurements, validate_with};
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

/// One experiment.
struct Outcome {
    chosen: bool,
    /// Mean squares at the postures kept out, axes and mixed \[m²\].
    squares: [f64; 2],
    /// Share of components inside their bands.
    inside: [f64; 2],
    /// Share of intervals that hold the true stiffness.
    covers: [f64; 2],
}

fn main() -> std::result::Result<(), Box<dyn Error>> {
    let runs: u64 = std::env::args()
        .nth(1)
        .map_or(Ok(100), |text| text.parse())?;
    println!(
        "| beyond the axes | postures | experiments | `auto` takes mixed | error, axes | error, mixed | bands hold, axes | mixed | k holds, axes | mixed |"
    );
    println!("|:--|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
    for (name, size) in [
        ("nothing", 0.0),
        ("a tenth of the FANUC's", 0.1),
        ("as the FANUC's", 1.0),
    ] {
        for postures in [6, 12, 40] {
            let all: Vec<Outcome> = (0..runs)
                .into_par_iter()
                .map(|run| experiment(run, postures, size))
                .collect::<Result<_>>()?;
            let mean =
                |of: &dyn Fn(&Outcome) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
            let mm = |i: usize| 1e3 * mean(&|o| o.squares[i]).sqrt();
            let percent = |of: &dyn Fn(&Outcome) -> f64| 100.0 * mean(of);
            println!(
                "| {name} | {postures} | {runs} | {:.1} % | {:.4} mm | {:.4} mm | {:.1} % | {:.1} % | {:.1} % | {:.1} % |",
                percent(&|o| f64::from(u8::from(o.chosen))),
                mm(0),
                mm(1),
                percent(&|o| o.inside[0]),
                percent(&|o| o.inside[1]),
                percent(&|o| o.covers[0]),
                percent(&|o| o.covers[1]),
            );
        }
    }
    Ok(())
}

fn experiment(run: u64, postures: usize, size: f64) -> Result<Outcome> {
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
    let (found, mixed) = elastic(&fit, ElasticChoice::Auto)?;
    let axes = fit.identification()?;
    let at = |predictor: &IdentifiedCompliance| {
        validate_with(&cell, predictor, kept_out.clone(), Model::Linear, None)
    };
    let by_axes = at(&IdentifiedCompliance::from_identification(&cell, axes)?)?;
    let holds = |joints: &[JointEstimate]| {
        let held = joints.iter().zip(&truth).filter(|(joint, k)| {
            let [low, high] = joint.interval;
            low.is_some_and(|low| low <= **k) && high.is_none_or(|high| **k <= high)
        });
        held.count() as f64 / truth.len() as f64
    };
    let (by_mixed, mixed_holds) = match &mixed {
        Some(mixed) => (at(mixed.compliance())?, holds(&mixed.result()?.joints)),
        None => (by_axes.clone(), holds(&axes.estimates.joints)),
    };
    let inside = |by: &Validation| {
        by.band
            .as_ref()
            .map_or(0.0, |b| b.inside as f64 / b.components as f64)
    };
    Ok(Outcome {
        chosen: found.model == ElasticChoice::Mixed,
        squares: [&by_axes, &by_mixed].map(|by| by.component_rms_m.powi(2)),
        inside: [inside(&by_axes), inside(&by_mixed)],
        covers: [holds(&axes.estimates.joints), mixed_holds],
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
