//! The main job: a plan, readings, joint stiffness, deflection at work.
//!
//! `cargo run --release -p stiffarm --example main_job`

use stiffarm::{Control, Fit, Index, LoadedPosture, Wrench};
use stiffarm::{predict, prepare, select, simulated_readings};
use stiffarm_files::builtin;

fn main() -> stiffarm::Result<()> {
    let (cell, control) = (builtin::cell("comau")?, Control::default());
    let plan = select(&cell, Index::ExpectedError, 6, &Default::default(), control)?;
    println!("six postures: k to {:.2} % (RMS)", 100.0 * plan.value);
    // Stands in for a day with robot and tracker.
    let readings = simulated_readings(&cell, &plan.group, 1)?;
    let measured = prepare(&cell, readings, &Default::default())?;
    let fit = Fit::new(&cell, &measured, &Default::default())?;
    for joint in &fit.identification()?.estimates.joints {
        println!("{joint}");
    }
    let force = Wrench::force([0.0, 300.0, 0.0]);
    let work = [LoadedPosture::new("mill", plan.group[0].clone(), force)];
    let compliance = fit.compliance()?;
    let bend = predict(&cell, &compliance, &work, &Default::default(), control)?;
    println!("300 N bend it by {:.3} mm", 1e3 * bend.deflection_max_m);
    Ok(())
}
