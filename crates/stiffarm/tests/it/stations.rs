//! Readings from several stations of the tracker, each in a frame of its own, give one result.

use crate::common::prelude::*;
use crate::common::readings::base_reflectors;
use nalgebra::{Matrix3, Rotation3};
use stiffarm::measure::StationRegistration;
use stiffarm::model::measurement::PostureReadings;
use stiffarm::model::tool::NamedPoint;
use stiffarm::plan::route::{RouteOptions, route};
use stiffarm::units::mm_to_m;
use stiffarm_files::table::{SheetOptions, reading_sheet};

fn frames() -> Vec<Isometry3<f64>> {
    vec![
        Isometry3::new(Vector3::new(4.2, -1.8, 0.9), Vector3::new(0.02, -0.03, 2.4)),
        Isometry3::new(Vector3::new(1.5, 4.0, 1.8), Vector3::new(0.01, 0.02, -1.1)),
    ]
}

fn ten(cell: &Cell) -> Vec<Posture> {
    numbered(random_group(cell, StartKind::Uniform, 10, 3, 0).unwrap())
}

/// Ten postures, the first six read from `front`, the others from `side`.
fn table(cell: &Cell, change: impl Fn(&mut Experiment)) -> ReadingTable {
    let prior = cell.require_prior().unwrap().to_vec();
    let postures = ten(cell);
    let mut all: Vec<PostureReadings> = Vec::new();
    let mut out = None;
    for (frame, (name, range)) in frames().into_iter().zip([("front", 0..6), ("side", 6..10)]) {
        let mut done = Experiment { base_from_tracker: frame, ..Experiment::as_measured(cell) };
        change(&mut done);
        let part = &postures[range];
        let mut table = experiment(cell, part, &prior, &done, 1, part.len() as u64).unwrap();
        for posture in &mut table.postures {
            posture.station = Some(name.to_string());
        }
        all.append(&mut table.postures);
        out = Some(table);
    }
    let mut out = out.unwrap();
    for reading in all.iter_mut().flat_map(|p| &mut p.states).flat_map(|s| &mut s.readings) {
        reading.time = None;
    }
    out.postures = all;
    out
}

fn of_station(table: &ReadingTable, name: &str) -> ReadingTable {
    let mut seen = table.clone();
    seen.postures.retain(|p| p.station.as_deref() == Some(name));
    seen
}

#[test]
fn each_station_gives_what_it_gives_alone() {
    let mut cell = default_cell();
    cell.tracker.accuracy =
        Some(TrackerAccuracy { station: Vector3::new(0.1, 0.0, 0.0), range: 2e-6, range_per_metre: 1e-6, angle: 6e-6 });
    let table = table(&cell, |_| {});
    let both = reduce(&cell, &table, &ReduceOptions::default()).unwrap();
    let names: Vec<&str> = both.stations.iter().map(|s| s.station.as_str()).collect();
    assert_eq!(names, ["front", "side"]);
    for (station, frame) in both.stations.iter().zip(frames()) {
        let offset = Vector3::from(station.translation_m) - frame.translation.vector;
        assert!(offset.norm() < 5e-4, "{offset}");
        assert!(station.rms_m.unwrap() < mm_to_m(0.1) && !station.angles_unchecked);
        let alone = reduce(&cell, &of_station(&table, &station.station), &ReduceOptions::default()).unwrap();
        assert!(alone.stations.is_empty());
        for reading in &alone.measured {
            let mut all = both.measured.iter();
            let same = all.find(|m| (&m.posture.name, &m.state) == (&reading.posture.name, &reading.state)).unwrap();
            for (a, b) in reading.displacements.iter().zip(&same.displacements) {
                // Two registrations of the same readings differ by tens of µrad.
                assert!((a.value - b.value).norm() < 1e-3 * a.value.norm().max(1e-4), "{a:?} {b:?}");
                let [a, b] = [a, b].map(|d| d.covariance.unwrap());
                assert!((a - b).norm() < 1e-3 * a.norm());
            }
        }
    }
    assert!(both.findings.iter().any(|f| f.code == "stations" && f.severity == Severity::Note));
}

#[test]
fn base_reflectors_tie_stations_better_than_an_arm_does() {
    let cell = default_cell();
    let reflectors = base_reflectors();
    let turn = |reflectors: &[NamedPoint]| {
        let mut table = table(&cell, |done| done.base_reflectors = reflectors.to_vec());
        // Joints that stand elsewhere than the controller says.
        for posture in &mut table.postures {
            posture.posture.q[1] += 0.1_f64.to_radians();
            posture.posture.q[2] -= 0.05_f64.to_radians();
        }
        let reduction = reduce(&cell, &table, &ReduceOptions::default()).unwrap();
        let frame = |s: &StationRegistration| {
            let rows = s.rotation.concat();
            Rotation3::from_matrix_unchecked(Matrix3::from_row_slice(&rows))
        };
        let [a, b] = [0, 1].map(|i| frame(&reduction.stations[i]));
        let [c, d] = [0, 1].map(|i| frames()[i].rotation.to_rotation_matrix());
        (a.inverse() * b).angle_to(&(c.inverse() * d))
    };
    let (by_arm, by_base) = (turn(&reflectors[..1]), turn(&reflectors));
    assert!(by_arm > 1e-4, "{by_arm}");
    assert!(by_base < by_arm / 2.0, "{by_base} {by_arm}");
}

#[test]
fn a_given_transform_is_that_of_the_station_that_it_fits() {
    let cell = default_cell();
    let table = table(&cell, |_| {});
    for frame in frames() {
        let options = with(|o: &mut ReduceOptions| o.base_from_tracker = Some(frame));
        let measured = prepare(&cell, table.clone(), &options).unwrap();
        let wrong: Vec<_> = measured.findings().filter(|f| f.severity > Severity::Note).collect();
        assert!(wrong.is_empty(), "{wrong:?}");
        let stations = measured.reduction.unwrap().stations;
        for (station, frame) in stations.iter().zip(frames()) {
            let off = Vector3::from(station.translation_m) - frame.translation.vector;
            assert!(off.norm() < 5e-4, "{off}");
        }
    }
    // All in one frame already: nothing is moved.
    let mut united = table.clone();
    for posture in &mut united.postures {
        let frame = frames()[usize::from(posture.station.as_deref() == Some("side"))];
        for reading in posture.states.iter_mut().flat_map(|s| &mut s.readings) {
            reading.position = frame.rotation * reading.position + frame.translation.vector;
        }
    }
    let options = with(|o: &mut ReduceOptions| o.base_from_tracker = Some(Isometry3::identity()));
    let reduction = reduce(&cell, &united, &options).unwrap();
    for station in &reduction.stations {
        assert_eq!(station.translation_m, [0.0; 3]);
    }
}

#[test]
fn a_station_that_says_too_little_is_left_out_and_a_single_posture_is_said() {
    let cell = default_cell();
    let mut one = table(&cell, |_| {});
    one.postures.truncate(7);
    let reduction = reduce(&cell, &one, &ReduceOptions::default()).unwrap();
    assert!(reduction.stations[1].angles_unchecked);
    insta::assert_snapshot!(the(&reduction.findings, "stations").sentence, @"The tracker read from 2 stations, each registered by itself: front (6 postures, 7.3 µm RMS) and side (1 posture, 4.0 µm RMS). The RMS is the distance of the unloaded points from the kinematic model. Nothing checks the angles of posture 7, the only one of its station.");
    // Two points alone do not say where the tracker stands.
    for state in &mut one.postures[6].states {
        state.readings.retain(|r| matches!(r.target, ReadingTarget::Point(0 | 1)));
    }
    let measured = prepare(&cell, one, &ReduceOptions::default()).unwrap();
    assert!(measured.postures.iter().all(|m| m.posture.name != "7"));
    let remark = measured.findings().find(|f| f.code == "station-left-out").unwrap();
    insta::assert_snapshot!(remark.sentence, @"Station side: The tracker's place takes at least 3 unloaded points that are not on a line; the table has 2. Left out until more is read from there: 7.");
}

/// A wrong description of the robot is named though no frame ties the stations.
#[test]
fn what_is_wrong_with_the_robot_is_found_from_several_stations() {
    let cell = default_cell();
    let mut table = table(&cell, |_| {});
    for posture in &mut table.postures {
        posture.posture.q[3] *= -1.0;
    }
    let measured = prepare(&cell, table, &ReduceOptions::default()).unwrap();
    let codes: Vec<&str> = measured.screening.iter().flat_map(|s| &s.findings).map(|f| f.code.as_str()).collect();
    assert_eq!(codes, ["joint-sign"]);
}

#[test]
fn simulated_readings_come_from_the_station_that_sees() {
    let cell = parse_cell(include_str!("../cells/comau-shapes.toml"), "cell.toml").unwrap();
    let postures = ten(&cell);
    let angles: Vec<&[f64]> = postures.iter().map(|p| p.q.as_slice()).collect();
    let table = simulated_readings(&cell, &angles, 1).unwrap();
    let sheet = reading_sheet(&postures, &SheetOptions::default(), &cell);
    assert_eq!(table.stations().len(), 2);
    assert_eq!(sheet.headings[6], "station");
    for posture in &table.postures {
        let mut rows = sheet.rows.iter().filter(|row| row.posture.name == posture.posture.name);
        assert!(rows.all(|row| row.station == posture.station));
    }
    let measured = prepare(&cell, table, &ReduceOptions::default()).unwrap();
    assert_eq!(measured.worst(), Some(Severity::Note));
    // The plan's order carries the tracker once.
    let route = route(&cell, &angles, &RouteOptions::default(), Control::default()).unwrap();
    let stations = route.order.iter().map(|i| {
        let mut rows = sheet.rows.iter();
        rows.find(|row| row.posture.name == postures[*i].name).unwrap().station.clone()
    });
    let mut stations: Vec<_> = stations.collect();
    stations.dedup();
    assert_eq!(stations.len(), 2);
}
