//! The same faults are found on robots of other makes.

use super::*;

/// What is planted, at random, in `table`; what must be found.
fn plant(kind: Cause, cell: &mut Cell, table: &mut ReadingTable, dice: &mut Dice) -> Planted {
    let posture = dice.below(table.postures.len());
    let joint = dice.below(6);
    let mut expected = Planted::default();
    match kind {
        Cause::AngleSign => {
            // A sign matters where the angle is not small.
            let q = &mut table.postures[posture].posture.q;
            let joint = (0..6).map(|i| (joint + i) % 6).find(|j| q[*j].abs() > 0.1).unwrap();
            q[joint] = -q[joint];
            expected.postures = vec![(posture + 1).to_string()];
            expected.joints = vec![format!("joint {}", joint + 1)];
        }
        Cause::MistypedAngle => {
            table.postures[posture].posture.q[joint] += dice.signed(4.0, 60.0).to_radians();
            expected.postures = vec![(posture + 1).to_string()];
            expected.joints = vec![format!("joint {}", joint + 1)];
        }
        Cause::ExchangedPoints => {
            let (a, b) = [(0, 1), (0, 2), (1, 3), (2, 3)][dice.below(4)];
            let state = dice.below(2);
            relabel(table, Some((posture, state)), a, b);
            expected.postures = vec![(posture + 1).to_string()];
            expected.points = vec![(a + 1).to_string(), (b + 1).to_string()];
        }
        Cause::ExchangedPostures => {
            let other = (posture + 1 + dice.below(table.postures.len() - 1)) % table.postures.len();
            let (low, high) = (posture.min(other), posture.max(other));
            let first = table.postures[low].states.clone();
            table.postures[low].states = std::mem::replace(&mut table.postures[high].states, first);
            expected.postures = vec![(low + 1).to_string(), (high + 1).to_string()];
        }
        Cause::MirroredFrame => {
            let axis = dice.below(3);
            each_position(table, |p| p[axis] = -p[axis]);
        }
        Cause::JointSign => {
            let mut coupling = cell.setup.robot.coupling().clone();
            coupling.column_mut(joint).neg_mut();
            cell.setup.robot = cell.setup.robot.clone().with_coupling(coupling).unwrap();
            expected.joints = vec![format!("joint {}", joint + 1)];
        }
        Cause::Coupling => {
            let mut coupling = cell.setup.robot.coupling().clone();
            coupling[(2, 1)] = if coupling[(2, 1)] == 0.0 { -1.0 } else { 0.0 };
            cell.setup.robot = cell.setup.robot.clone().with_coupling(coupling).unwrap();
        }
        Cause::ReversedForce => {
            let sensor = cell.sensor.as_mut().unwrap();
            sensor.reports_by_robot = !sensor.reports_by_robot;
        }
        Cause::ExchangedStates => {
            let states = &mut table.postures[posture].states;
            let first = states[0].readings.clone();
            states[0].readings = std::mem::replace(&mut states[1].readings, first);
            expected.postures = vec![(posture + 1).to_string()];
        }
        other => panic!("{other:?} is not planted here"),
    }
    expected
}

/// Where a planted fault is.
#[derive(Debug, Default)]
struct Planted {
    postures: Vec<String>,
    points: Vec<String>,
    joints: Vec<String>,
}

#[test]
fn planted_faults_on_other_robots() {
    let kinds = [
        Cause::AngleSign,
        Cause::MistypedAngle,
        Cause::ExchangedPoints,
        Cause::ExchangedPostures,
        Cause::MirroredFrame,
        Cause::JointSign,
        Cause::Coupling,
        Cause::ReversedForce,
        Cause::ExchangedStates,
    ];
    let robots =
        [("COMAU", cell()), ("KUKA KR240", kuka()), ("KUKA KR500", big_kuka()), ("FANUC", fanuc()), ("UR10", ur10())];
    let mut not_alone = Vec::new();
    let mut experiments = 0;
    for kind in kinds {
        for (name, cell) in &robots {
            let runs = runs(3);
            let outcomes: Vec<(i32, String)> = (0..runs)
                .into_par_iter()
                .map(|seed| {
                    let mut cell = cell.clone();
                    let mut table = random_table(&cell, Arm::Rough, 6, seed);
                    let mut dice = Dice::new(seed + 5);
                    let expected = plant(kind, &mut cell, &mut table, &mut dice);
                    let screening = screen(&cell, &table, None).unwrap();
                    let right = |f: &&Suspicion| {
                        f.cause == kind
                            && (expected.postures.is_empty() || f.postures == expected.postures)
                            && (expected.points.is_empty() || f.points == expected.points)
                            && (expected.joints.is_empty() || f.joints == expected.joints)
                    };
                    let outcome = match (screening.suspicions.iter().find(right), screening.suspicions.len()) {
                        (Some(f), 1) if f.alternatives.is_empty() => 0,
                        (Some(_), 1) => 1,
                        (Some(_), _) => 2,
                        (None, 0) => 3,
                        (None, _) => 4,
                    };
                    (outcome, format!("seed {seed} {expected:?}: {}", sentences(&screening)))
                })
                .collect();
            let others: Vec<&str> = outcomes.iter().filter(|o| o.0 != 0).map(|o| o.1.as_str()).collect();
            println!("{kind:?} on {name}: {} of {runs} not named alone", others.len());
            not_alone.extend(others.iter().map(|o| format!("{kind:?} on {name}, {o}")));
            experiments += runs;
        }
    }
    // Postures near another fault's effect, joints near a singular posture.
    assert!(
        not_alone.len() as u64 <= most(0.01, experiments, 900),
        "{} of {experiments}:\n{}",
        not_alone.len(),
        not_alone.join("\n")
    );
}
