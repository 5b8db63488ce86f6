//! Screening hardly ever finds a fault where there is none.

use super::*;

#[test]
fn no_fault_no_finding() {
    let table = group1_table(1);
    let screening = screen(&cell(), &table, None).unwrap();
    assert!(screening.findings.is_empty(), "{}", sentences(&screening));
    assert_eq!(screening.states_checked, 12);
    // 0.0166 mm is the RMS distance by noise alone: sqrt(3 · 9.23e-5 mm²).
    let rms = screening.unloaded_rms_m.unwrap();
    assert!(rms > 0.6 * mm_to_m(0.0166) && rms < 1.5 * mm_to_m(0.0166), "{rms}");
}

/// Experiments without a planted fault that raise a finding.
fn false_alarms(cell: &Cell, runs: u64, arm: Arm, count: usize) -> Vec<String> {
    (0..runs)
        .into_par_iter()
        .flat_map(|seed| {
            let table = random_table(cell, arm, count, seed);
            let screening = screen(cell, &table, None).unwrap();
            let text = sentences(&screening);
            (!text.is_empty()).then(|| format!("seed {seed}: {text}"))
        })
        .collect()
}

#[test]
fn without_faults_alarms_are_rare() {
    let mut without_prior = cell();
    without_prior.prior = None;
    let mut worst: Vec<String> = Vec::new();
    let mut three_points = cell();
    three_points.setup.tool.measuring_points.pop();
    let mut one_point = cell();
    one_point.setup.tool.measuring_points.truncate(1);
    for (name, cell, whole, arm, count) in [
        ("exact", cell(), 300, Arm::Exact, 6),
        ("uncalibrated", cell(), 300, Arm::Uncalibrated, 6),
        ("rough", cell(), 300, Arm::Rough, 6),
        ("three postures", cell(), 300, Arm::Rough, 3),
        ("four postures", cell(), 300, Arm::Rough, 4),
        ("twelve postures", cell(), 200, Arm::Rough, 12),
        ("no prior", without_prior, 300, Arm::Rough, 6),
        ("three points", three_points, 300, Arm::Rough, 6),
        ("one point", one_point, 300, Arm::Rough, 12),
        ("KUKA KR240", kuka(), 200, Arm::Rough, 6),
        ("KUKA KR500", big_kuka(), 200, Arm::Rough, 6),
        ("FANUC", fanuc(), 200, Arm::Rough, 6),
        ("UR10", ur10(), 200, Arm::Rough, 6),
    ] {
        let runs = runs(whole / 10);
        let alarms = false_alarms(&cell, runs, arm, count);
        println!("{name}: {} alarms in {runs}\n{}", alarms.len(), alarms.join("\n"));
        worst
            .extend((alarms.len() as u64 > most(0.01, runs, whole)).then(|| format!("{name}:\n{}", alarms.join("\n"))));
    }
    assert!(worst.is_empty(), "{}", worst.join("\n\n"));
}
