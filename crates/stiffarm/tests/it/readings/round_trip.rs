//! Any table that is written is read again.

use super::*;
use crate::common::cases;

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![(-9_999_999..9_999_999i32).prop_map(|n| f64::from(n) / 1e7), -1e3..1e3f64,]
}

fn vector() -> impl Strategy<Value = Vector3<f64>> {
    (number(), number(), number()).prop_map(|(x, y, z)| Vector3::new(x, y, z))
}

fn wrench() -> impl Strategy<Value = Wrench> {
    (vector(), vector()).prop_map(|(force, moment)| Wrench { force, moment })
}

/// Readings of a state; the first is of the first point, so that every loaded
/// state shares one with the unloaded.
fn any_state(name: &'static str, forces: WrenchColumns, times: bool) -> impl Strategy<Value = StateReadings> {
    let target = prop_oneof![
        Just(ReadingTarget::Point(0)),
        Just(ReadingTarget::Point(1)),
        Just(ReadingTarget::Base("base".to_string())),
        Just(ReadingTarget::Base("base-2".to_string())),
    ];
    let reading = (target, vector(), prop::option::of(number()));
    let state = (prop::collection::vec(reading, 1..6), wrench(), 1.0..900.0f64);
    state.prop_map(move |(mut readings, wrench, load)| {
        readings[0].0 = ReadingTarget::Point(0);
        let loaded = Role::of(name) != Role::Unloaded;
        StateReadings {
            state: name.to_string(),
            angles: None,
            wrench: match forces {
                WrenchColumns::None => None,
                WrenchColumns::Force => loaded.then(|| Wrench::force(wrench.force)),
                WrenchColumns::ForceAndMoment => loaded.then_some(wrench),
            },
            load: loaded.then_some(load),
            readings: readings
                .into_iter()
                .map(|(target, position, time)| Reading {
                    target,
                    position,
                    time: time.filter(|_| times),
                    expanded: time.map(|t| Vector3::new(1e-6, 2e-6, t.abs().min(1.0) * 1e-6)),
                    temperature: time.map(|t| 20.0 + t % 7.0),
                    line: 0,
                })
                .collect(),
        }
    })
}

fn any_table() -> impl Strategy<Value = ReadingTable> {
    let columns =
        prop_oneof![Just(WrenchColumns::None), Just(WrenchColumns::Force), Just(WrenchColumns::ForceAndMoment),];
    (columns, any::<bool>()).prop_flat_map(|(columns, times)| {
        let states = (
            any_state("unloaded", columns, times),
            any_state("preload", columns, times),
            any_state("up, \"slowly\"", columns, times),
            any_state("unloaded-2", columns, times),
        );
        let posture = (states, -150.0..150.0f64, -60.0..80.0f64);
        prop::collection::vec(posture, 1..5).prop_map(move |postures| ReadingTable {
            wrench_columns: columns,
            pending: Vec::new(),
            incomplete: Vec::new(),
            remarks: Vec::new(),
            postures: (1..)
                .zip(postures)
                .map(|(number, ((a, b, c, d), q1, q2))| {
                    let mut states = vec![a, b, c, d];
                    for (i, state) in states.iter_mut().enumerate() {
                        // Up to 0.3° of servo give.
                        let give = 0.1 * i as f64;
                        state.angles = Some(vec![(q1 + give).to_radians(), (q2 - give).to_radians()]);
                    }
                    PostureReadings {
                        posture: Posture {
                            name: format!("#{number}"),
                            q: states[0].angles.clone().unwrap_or_default(),
                        },
                        states,
                        station: times.then(|| ["1", "door, \"left\""][number % 2].to_string()),
                        axes: Default::default(),
                    }
                })
                .collect(),
        })
    })
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn written_readings_are_read_and_written_again(table in any_table()) {
        let cell = rope_cell();
        let text = write_readings(&table, &cell);
        let read = readings(&text, &cell).unwrap();
        prop_assert_eq!(write_readings(&read, &cell), text);
        prop_assert_eq!(read.wrench_columns, table.wrench_columns);
        prop_assert_eq!(read.postures.len(), table.postures.len());
        for (read, wanted) in read.postures.iter().zip(&table.postures) {
            prop_assert_eq!(&read.posture.name, &wanted.posture.name);
            prop_assert!(nearly(&read.posture.q, &wanted.posture.q));
            prop_assert_eq!(read.states.len(), wanted.states.len());
            for (read, wanted) in read.states.iter().zip(&wanted.states) {
                prop_assert_eq!(&read.state, &wanted.state);
                prop_assert_eq!((read.wrench, read.load), (wanted.wrench, wanted.load));
                let [a, b] = [read, wanted].map(|s| s.angles.clone().unwrap_or_default());
                prop_assert!(nearly(&a, &b));
                prop_assert_eq!(read.readings.len(), wanted.readings.len());
                for (read, wanted) in read.readings.iter().zip(&wanted.readings) {
                    prop_assert_eq!((&read.target, read.time), (&wanted.target, wanted.time));
                    prop_assert!(nearly(read.position.as_slice(), wanted.position.as_slice()));
                }
            }
        }
    }
}
