//! A tracker that was moved or knocked is named, from the posture on where it was.

use super::*;
use stiffarm::findings::Severity;

/// A turn about z \[rad\] and a shift \[mm\] of the tracker's axes.
fn shifted(turn: f64, mm: [f64; 3]) -> Isometry3<f64> {
    Isometry3::new(Vector3::from(mm.map(mm_to_m)), Vector3::z() * turn)
}

const CARRIED: ([f64; 3], f64) = ([1500.0, 800.0, 20.0], 0.6);

/// Puts the readings from posture `first` (counted from 0) on, and of it those from state `state` on, into other axes.
fn put(table: &mut ReadingTable, first: usize, state: usize, change: &Isometry3<f64>) {
    for (p, posture) in table.postures.iter_mut().enumerate().skip(first) {
        let from = if p == first { state } else { 0 };
        for reading in posture.states.iter_mut().skip(from).flat_map(|s| &mut s.readings) {
            reading.position = change.rotation * reading.position + change.translation.vector;
        }
    }
}

fn carried() -> Isometry3<f64> {
    shifted(CARRIED.1, CARRIED.0)
}

fn moves(screening: &Screening) -> Vec<&Suspicion> {
    let all = screening.suspicions.iter();
    all.filter(|s| s.cause == Cause::MovedTracker).collect()
}

/// So many, and nothing else is suspected.
fn only_moves(screening: &Screening, count: usize) -> Vec<&Suspicion> {
    let moved = moves(screening);
    assert_eq!((moved.len(), screening.suspicions.len()), (count, count), "{}", sentences(screening));
    moved
}

fn ten() -> Vec<Posture> {
    numbered(random_group(&cell(), StartKind::Uniform, 10, 3, 0).unwrap())
}

#[test]
fn from_a_posture_on_the_tracker_stands_elsewhere() {
    let mut table = simulated(&cell(), &ten(), 1);
    put(&mut table, 6, 0, &carried());
    let (screening, suspicion) = alone(&cell(), &table);
    assert_eq!(suspicion.cause, Cause::MovedTracker, "{}", sentences(&screening));
    assert_eq!(suspicion.postures, names(&["7", "8", "9", "10"]));
    assert!(suspicion.divided.is_empty());
    assert!(suspicion.after_m.unwrap() < 5e-5 && suspicion.before_m.unwrap() > 0.1);
    assert!((suspicion.angles_deg[0] - rad_to_deg(0.6)).abs() < 0.01, "{suspicion:?}");
    assert_eq!(screening.findings[0].severity, Severity::Serious);
    insta::assert_snapshot!(screening.findings[0].sentence, @"From posture 7 on the readings fit another tracker frame: one for all leaves the unloaded points 1860 mm from the kinematic model, one of its own for each part 0.016 mm; they lie 3828 mm apart at the points, with a turn of 34.38°. If the tracker was moved or knocked, add a column station with 2 in the rows of postures 7, 8, 9 and 10, and another name in those before. If the robot was moved, for example on a rail, what stands beside it (anchor, obstacles) is elsewhere, too: identify what was read at each of its places with a cell of its own.");
    // What else is wrong is still found.
    let q = &mut table.postures[3].posture.q;
    q[2] = -q[2];
    let screened = screen(&cell(), &table, None).unwrap();
    assert_eq!(moves(&screened).len(), 1, "{}", sentences(&screened));
    assert!(screened.suspicions.iter().any(|s| s.cause == Cause::AngleSign && s.postures == ["4"]));
}

#[test]
fn several_moves_and_one_within_a_posture_are_told_apart() {
    let mut table = simulated(&cell(), &ten(), 2);
    put(&mut table, 3, 0, &carried());
    put(&mut table, 7, 0, &shifted(-0.4, [-300.0, 700.0, 0.0]));
    let screening = screen(&cell(), &table, None).unwrap();
    let moved = only_moves(&screening, 2);
    assert_eq!(moved[0].postures, names(&["4", "5", "6", "7"]));
    assert_eq!(moved[1].postures, names(&["8", "9", "10"]));
    assert_eq!(moved[1].likely_station.as_deref(), Some("3"));

    let mut report = String::new();
    for change in [carried(), shifted(0.002, [6.0, 20.0, 0.0])] {
        let mut table = simulated(&cell(), &ten(), 2);
        put(&mut table, 4, 1, &change);
        let screening = screen(&cell(), &table, None).unwrap();
        let moved = only_moves(&screening, 1);
        assert_eq!(moved[0].divided, ["5"]);
        assert_eq!(moved[0].postures, names(&["6", "7", "8", "9", "10"]));
        report += &format!("{}\n", screening.findings[0].sentence);
    }
    insta::assert_snapshot!(report, @"
    In posture 5 the tracker's frame changes: one for all leaves the unloaded points 994 mm from the kinematic model, one of its own for each part 0.015 mm; they lie 2131 mm apart at the points, with a turn of 34.38°. If the tracker was moved or knocked, add a column station with 2 in the rows of postures 6, 7, 8, 9 and 10, and another name in those before. Posture 5 was read partly before and partly after: measure it again, or leave it out. If the robot was moved, for example on a rail, what stands beside it (anchor, obstacles) is elsewhere, too: identify what was read at each of its places with a cell of its own.
    In posture 5 the tracker's frame changes: one for all leaves the unloaded points 8.7 mm from the kinematic model, one of its own for each part 0.015 mm; they lie 18.8 mm apart at the points, with a turn of 0.11°. If the tracker was moved or knocked, add a column station with 2 in the rows of postures 6, 7, 8, 9 and 10, and another name in those before. Posture 5 was read partly before and partly after: measure it again, or leave it out. If the robot was moved, for example on a rail, what stands beside it (anchor, obstacles) is elsewhere, too: identify what was read at each of its places with a cell of its own.
    ");
}

#[test]
fn a_station_with_a_name_was_moved() {
    let mut table = simulated(&cell(), &ten(), 4);
    for (p, posture) in table.postures.iter_mut().enumerate() {
        posture.station = Some(if p < 4 { "door" } else { "B" }.to_string());
    }
    put(&mut table, 4, 0, &carried());
    // Named, they are as good as from one station.
    let sound = prepare(&cell(), table.clone(), &ReduceOptions::default()).unwrap();
    let screening = sound.screening.unwrap();
    assert!(screening.suspicions.is_empty(), "{}", sentences(&screening));
    let stations = sound.reduction.unwrap().stations;
    assert_eq!(stations.len(), 2);
    put(&mut table, 7, 0, &shifted(0.02, [40.0, 0.0, 0.0]));
    let moved = prepare(&cell(), table, &ReduceOptions::default()).unwrap();
    let screening = moved.screening.unwrap();
    let tied = only_moves(&screening, 1);
    assert_eq!(tied[0].postures, names(&["8", "9", "10"]));
    insta::assert_snapshot!(screening.findings[0].sentence, @"From posture 8 on the readings fit another tracker frame: one for all leaves the unloaded points 13.5 mm from the kinematic model, one of its own for each part 0.019 mm; they lie 67.7 mm apart at the points, with a turn of 1.15°. If the tracker was moved or knocked, give the rows of postures 8, 9 and 10 station B-2 in place of B. If the robot was moved, for example on a rail, what stands beside it (anchor, obstacles) is elsewhere, too: identify what was read at each of its places with a cell of its own.");
}

/// Arms that nobody calibrated, moved from some posture on: named, and from that posture on.
#[test]
fn moves_are_found_on_real_arms() {
    for (name, cell, change, share) in [
        ("carried", cell(), carried(), 0.97),
        ("pushed", cell(), shifted(0.01, [30.0, -10.0, 0.0]), 0.9),
        ("KUKA", kuka(), carried(), 0.97),
        ("FANUC", fanuc(), carried(), 0.97),
        ("UR10", ur10(), carried(), 0.97),
    ] {
        // As many as there are lengths of a day, so that each is moved once.
        let (count, whole) = (runs(15), 300);
        let missed: Vec<String> = (0..count)
            .into_par_iter()
            .flat_map(|seed| {
                let postures = 6 + (seed % 15) as usize;
                let first = 3 + (seed as usize * 7) % (postures - 5);
                let mut table = random_table(&cell, Arm::Rough, postures, seed);
                put(&mut table, first, 0, &change);
                let screening = screen(&cell, &table, None).unwrap();
                let moved = moves(&screening);
                let right = moved.len() == 1 && moved[0].postures.first() == Some(&(first + 1).to_string());
                (!right).then(|| format!("seed {seed}, {first} of {postures}: {}", sentences(&screening)))
            })
            .collect();
        println!("{name}: {} of {count} missed\n{}", missed.len(), missed.join("\n"));
        assert!(missed.len() as u64 <= most(1.0 - share, count, whole), "{name}:\n{}", missed.join("\n"));
    }
}

/// Days on which nothing was moved, with postures in the order of a route, in two heaps, and at random.
#[test]
fn sound_days_are_not_called_moved() {
    let mut one_point = cell();
    one_point.setup.tool.measuring_points.truncate(1);
    let days = runs(60);
    let mut alarms = Vec::new();
    for (name, cell) in
        [("comau", cell()), ("KUKA", kuka()), ("FANUC", fanuc()), ("UR10", ur10()), ("one point", one_point)]
    {
        let named: Vec<String> = (0..days)
            .into_par_iter()
            .flat_map(|seed| {
                let count = 4 + (seed % 21) as usize;
                let mut table = random_table(&cell, Arm::Rough, count, seed);
                match seed % 3 {
                    0 => {}
                    // Along axis 1, as a route goes.
                    1 => table.postures.sort_by(|a, b| a.posture.q[0].total_cmp(&b.posture.q[0])),
                    // Near on one side, then near on the other.
                    _ => table.postures.sort_by_key(|p| (p.posture.q[0] > 0.0, p.posture.q[1] > p.posture.q[2])),
                }
                let screening = screen(&cell, &table, None).unwrap();
                (!moves(&screening).is_empty()).then(|| format!("{name}, seed {seed}: {}", sentences(&screening)))
            })
            .collect();
        alarms.extend(named);
    }
    assert!(alarms.is_empty(), "{}", alarms.join("\n"));
}
