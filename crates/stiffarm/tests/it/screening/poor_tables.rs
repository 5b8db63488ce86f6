//! Tables that are poor, mangled or seen from another frame are screened without a false word.

use super::*;

#[test]
fn a_tool_that_differs_from_its_drawing() {
    let mut said = Vec::new();
    let table = group1_table(16);
    for off in [8e-4, 3e-2] {
        let mut wrong = cell();
        wrong.setup.tool.measuring_points[2].position.x += off;
        let (screening, suspicion) = alone(&wrong, &table);
        assert_eq!(suspicion.cause, Cause::Drawing);
        assert_eq!(suspicion.points, ["3"]);
        assert!((suspicion.off_m.unwrap() - off).abs() < 5e-5);
        let expected = if off < 1e-3 { Severity::Note } else { Severity::Caution };
        assert_eq!(screening.findings[0].severity, expected);
        said.push(sentences(&screening));
    }
    insta::assert_snapshot!("drawing", said.join("\n"));
}

#[test]
fn a_transform_that_is_given() {
    let table = group1_table(17);
    let right = tracker_pose(17);
    assert!(screen(&cell(), &table, Some(&right)).unwrap().findings.is_empty());
    let moved = Isometry3::translation(0.02, 0.0, 0.0) * right;
    let screening = screen(&cell(), &table, Some(&moved)).unwrap();
    assert_eq!(only(&screening).cause, Cause::GivenTransform);
    insta::assert_snapshot!("given_transform", sentences(&screening));
}

#[test]
fn too_few_readings_are_said_to_be_too_few() {
    let mut few = cell();
    few.setup.tool.measuring_points.truncate(1);
    let table = simulated(&few, &numbered(group1()[..2].to_vec()), 18);
    let (screening, suspicion) = alone(&few, &table);
    assert_eq!((suspicion.cause, screening.unloaded_rms_m), (Cause::NotChecked, None));
    assert_eq!(screening.findings[0].severity, Severity::Note);
    // With a given transform the model can still be held against them.
    let screening = screen(&few, &table, Some(&tracker_pose(18))).unwrap();
    assert!(screening.findings.is_empty(), "{}", sentences(&screening));
    let none = ReadingTable { postures: Vec::new(), ..table.clone() };
    assert_eq!(only(&screen(&few, &none, None).unwrap()).cause, Cause::NotChecked);
    let mut broken = table;
    broken.postures[1].states[0].readings[0].position.x = f64::NAN;
    let error = screen(&few, &broken, None).unwrap_err();
    insta::assert_snapshot!("not_finite", error.to_string());
}

#[test]
fn the_same_table_gives_the_same_findings_in_any_frame() {
    let mut table = group1_table(19);
    table.postures[4].posture.q[4] += 0.2;
    let first = screen(&cell(), &table, None).unwrap();
    assert_eq!(first, screen(&cell(), &table, None).unwrap());
    let turn = tracker_pose(20);
    each_position(&mut table, |p| *p = turn.rotation * *p + turn.translation.vector);
    let second = screen(&cell(), &table, None).unwrap();
    let causes = |s: &Screening| s.suspicions.iter().map(|f| f.cause).collect::<Vec<_>>();
    assert_eq!(causes(&first), [Cause::MistypedAngle]);
    assert_eq!(causes(&first), causes(&second));
    // Saved and read back.
    let text = serde_json::to_string(&first).unwrap();
    let again: Screening = serde_json::from_str(&text).unwrap();
    assert_eq!(again.findings, first.findings);
}

#[test]
fn mangled_tables_are_survived() {
    let outcomes: Vec<usize> = (0..150_u64)
        .into_par_iter()
        .map(|seed| {
            let mut dice = Dice::new(seed);
            let count = 1 + dice.below(7);
            let mut table = random_table(&cell(), Arm::Rough, count, seed);
            for posture in &mut table.postures {
                for state in &mut posture.states {
                    state.readings.retain(|_| !dice.chance(0.2));
                    for reading in &mut state.readings {
                        if dice.chance(0.1) {
                            reading.position = dice.vector(10.0) * 10f64.powf(dice.between(-6.0, 6.0));
                        }
                    }
                }
                if dice.chance(0.1) {
                    posture.states.remove(0);
                }
                if dice.chance(0.1) {
                    posture.states.clear();
                }
                if dice.chance(0.1) {
                    posture.posture.q[dice.below(6)] = 1e6;
                }
            }
            let screening = screen(&cell(), &table, None).unwrap();
            for finding in &screening.findings {
                let said = &finding.sentence;
                assert!(!said.contains("NaN") && !said.contains("inf "), "{said}");
            }
            screening.findings.len()
        })
        .collect();
    // Nearly all of these say something; some were hardly mangled.
    let said = outcomes.iter().filter(|n| **n > 0).count();
    assert!(said > 120, "{said}");
}
