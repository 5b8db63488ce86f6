//! Any table that is written is read again.

use super::*;
use crate::common::cases;

fn any_postures() -> impl Strategy<Value = Vec<Posture>> {
    let angles = (-170.0..170.0f64, -75.0..95.0f64);
    prop::collection::vec(angles, 1..8).prop_map(|list| {
        let named = (1..).zip(list);
        named.map(|(i, (a, b))| Posture { name: format!("P{i}"), q: vec![a.to_radians(), b.to_radians()] }).collect()
    })
}

fn any_measured() -> impl Strategy<Value = Vec<MeasuredPosture>> {
    let number = || -1e3..1e3f64;
    let vector = move || (number(), number(), number()).prop_map(|(x, y, z)| [x, y, z].into());
    let displacement = (0..2usize, vector(), prop::option::of(number()))
        .prop_map(|(point, value, time)| Displacement { time, ..Displacement::new(point, value) });
    let measured = (prop::collection::vec(displacement, 1..5), prop::option::of((vector(), vector())), any::<bool>());
    (any_postures(), prop::collection::vec(measured, 8), any::<bool>()).prop_map(|(postures, measured, wrenches)| {
        let pairs = postures.into_iter().zip(measured);
        pairs
            .map(|(posture, (displacements, wrench, up))| MeasuredPosture {
                posture,
                state: if up { "up" } else { "down" }.to_string(),
                wrench: wrenches.then(|| {
                    let (force, moment) = wrench.unwrap_or_default();
                    Wrench { force, moment }
                }),
                preload: None,
                common_readings: [0.0; 2],
                servo_deflection: None,
                displacements: numbered(displacements),
            })
            .collect()
    })
}

/// Repeats of a point count their reference readings, as a table's rows do.
fn numbered(mut displacements: Vec<Displacement>) -> Vec<Displacement> {
    for i in 0..displacements.len() {
        let point = displacements[i].point;
        let before = displacements[..i].iter().filter(|d| d.point == point);
        displacements[i].reference = vec![stiffarm::model::measurement::ReferencePart::reading(before.count() as u32)];
    }
    displacements
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn written_postures_are_read_and_written_again(list in any_postures()) {
        let text = write_postures(&list);
        let read = postures(&text).unwrap();
        prop_assert_eq!(write_postures(&read), text);
        prop_assert_eq!(read.len(), list.len());
        for (read, wanted) in read.iter().zip(&list) {
            prop_assert_eq!(&read.name, &wanted.name);
            prop_assert!(nearly(&read.q, &wanted.q));
        }
    }

    #[test]
    fn written_displacements_are_read_and_written_again(list in any_measured()) {
        let cell = rope_cell();
        let text = write_displacements(&list, &cell);
        let read = displacements(&text, &cell).unwrap();
        prop_assert_eq!(write_displacements(&read, &cell), text);
        prop_assert_eq!(read.len(), list.len());
        for (read, wanted) in read.iter().zip(&list) {
            prop_assert_eq!(&read.state, &wanted.state);
            prop_assert_eq!(read.wrench, wanted.wrench);
            prop_assert!(nearly(&read.posture.q, &wanted.posture.q));
            prop_assert_eq!(read.displacements.len(), wanted.displacements.len());
            for (read, wanted) in read.displacements.iter().zip(&wanted.displacements) {
                prop_assert_eq!((read.point, read.time), (wanted.point, wanted.time));
                prop_assert!(nearly(read.value.as_slice(), wanted.value.as_slice()));
            }
        }
    }
}
