//! A tracker that was moved, or knocked, while nobody said so.

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
    let found = moves(screening);
    assert_eq!((found.len(), screening.suspicions.len()), (count, count), "{}", sentences(screening));
    found
}

fn ten() -> Vec<Posture> {
    numbered(random_group(&cell(), StartKind::Uniform, 10, 3, 0).unwrap())
}

#[test]
fn from_a_posture_on_the_tracker_stands_elsewhere() {
    let mut table = simulated(&cell(), &ten(), 1);
    put(&mut table, 6, 0, &carried());
    let (screening, found) = alone(&cell(), &table);
    assert_eq!(found.cause, Cause::MovedTracker, "{}", sentences(&screening));
    assert_eq!(found.postures, names(&["7", "8", "9", "10"]));
    assert!(found.divided.is_empty());
    assert!(found.after_m.unwrap() < 5e-5 && found.before_m.unwrap() > 0.1);
    assert!((found.angles_deg[0] - rad_to_deg(0.6)).abs() < 0.01, "{found:?}");
    assert_eq!(screening.findings[0].severity, Severity::Serious);
    let sentence = &screening.findings[0].sentence;
    for part in ["From posture 7 on", "add a column station with 2", "on a rail"] {
        assert!(sentence.contains(part), "{sentence}");
    }
    // What else is wrong is still found.
    let q = &mut table.postures[3].posture.q;
    q[2] = -q[2];
    let found = screen(&cell(), &table, None).unwrap();
    assert_eq!(moves(&found).len(), 1, "{}", sentences(&found));
    assert!(found.suspicions.iter().any(|s| s.cause == Cause::AngleSign && s.postures == ["4"]));
}

#[test]
fn several_moves_and_one_within_a_posture_are_told_apart() {
    let mut table = simulated(&cell(), &ten(), 2);
    put(&mut table, 3, 0, &carried());
    put(&mut table, 7, 0, &shifted(-0.4, [-300.0, 700.0, 0.0]));
    let screening = screen(&cell(), &table, None).unwrap();
    let found = only_moves(&screening, 2);
    assert_eq!(found[0].postures, names(&["4", "5", "6", "7"]));
    assert_eq!(found[1].postures, names(&["8", "9", "10"]));
    assert_eq!(found[1].likely_station.as_deref(), Some("3"));

    for change in [carried(), shifted(0.002, [6.0, 20.0, 0.0])] {
        let mut table = simulated(&cell(), &ten(), 2);
        put(&mut table, 4, 1, &change);
        let screening = screen(&cell(), &table, None).unwrap();
        let found = only_moves(&screening, 1);
        assert_eq!(found[0].divided, ["5"]);
        assert_eq!(found[0].postures, names(&["6", "7", "8", "9", "10"]));
        assert!(screening.findings[0].sentence.contains("Posture 5 was read partly before"));
    }
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
    let found = only_moves(&screening, 1);
    assert_eq!(found[0].postures, names(&["8", "9", "10"]));
    let sentence = &screening.findings[0].sentence;
    assert!(sentence.contains("station B-2 in place of B"), "{sentence}");
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
        let (count, whole) = (runs(30), 300);
        let missed: Vec<String> = (0..count)
            .into_par_iter()
            .flat_map(|seed| {
                let postures = 6 + (seed % 15) as usize;
                let first = 3 + (seed as usize * 7) % (postures - 5);
                let mut table = random_table(&cell, Arm::Rough, postures, seed);
                put(&mut table, first, 0, &change);
                let screening = screen(&cell, &table, None).unwrap();
                let found = moves(&screening);
                let right = found.len() == 1 && found[0].postures.first() == Some(&(first + 1).to_string());
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
        let found: Vec<String> = (0..days)
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
        alarms.extend(found);
    }
    assert!(alarms.is_empty(), "{}", alarms.join("\n"));
}
