//! `identify --clamped` gives the stiffness of a fixed flange, names a wrench taken the wrong way round, and refuses
//! what it cannot use.

use crate::support;

use insta::assert_snapshot;
use stiffarm::estimate::clamped::{ClampedPosture, ClampedSimulation, MotorMove, simulate_clamped};
use stiffarm::model::cell::Cell;
use stiffarm_files::table::{read_postures, write_clamped};
use support::{Folder, measurements};

fn cell() -> Cell {
    let text = stiffarm_files::builtin::cell_text("comau").unwrap();
    stiffarm_files::cell::parse_cell(text, "comau").unwrap()
}

/// Group 1 pushed up and down against a fixture.
fn clamped(cell: &Cell) -> Vec<ClampedPosture> {
    let text = stiffarm_files::builtin::postures_text("comau-group1").unwrap();
    let postures = read_postures(text.as_bytes(), "group", &cell.setup.robot).unwrap();
    let truth = cell.require_prior().unwrap();
    let torque = [900.0, -1200.0, 700.0, 300.0, -250.0, 200.0];
    let motor: Vec<f64> = torque.iter().zip(truth).map(|(t, k)| t / k).collect();
    let back = motor.iter().map(|q| -q).collect();
    let simulation = ClampedSimulation {
        moves: vec![
            MotorMove { state: "push".to_string(), motor },
            MotorMove { state: "pull".to_string(), motor: back },
        ],
        angle_std: 1e-5,
        force_std: 1.0,
        moment_std: 0.5,
        ..ClampedSimulation::default()
    };
    simulate_clamped(cell, &postures, truth, &simulation, 7, 0).unwrap()
}

fn folder() -> Folder {
    let folder = Folder::new();
    let cell = cell();
    folder.write("clamped.csv", write_clamped(&clamped(&cell), &cell.setup.robot));
    folder
}

#[test]
fn the_stiffness_of_a_clamped_arm() {
    let folder = folder();
    let line = "identify builtin:comau clamped.csv --clamped --angle-noise-deg 0.0006";
    assert_snapshot!(folder.transcript(line));
    let value = folder.json(line);
    let schema: serde_json::Value = serde_json::from_str(&folder.ok("schema result-identify-clamped")).unwrap();
    let described = &schema["$defs"]["ClampedIdentification"]["properties"];
    for key in value["result"].as_object().unwrap().keys() {
        assert!(described.get(key).is_some(), "{key} is not described");
        assert!(!key.ends_with("_m"), "{key}: these residuals are angles");
    }
    // What is saved can be validated with a free end.
    folder.write("simulated.csv", measurements());
    folder.ok("identify builtin:comau clamped.csv --clamped --exclude 6 --output k.json");
    let value = folder.json("validate builtin:comau k.json simulated.csv");
    assert_eq!(value["result"]["band"]["components"], 72);
}

#[test]
fn the_wrench_on_the_fixture_is_named() {
    let folder = Folder::new();
    let cell = cell();
    let mut data = clamped(&cell);
    for c in &mut data {
        c.wrench.force = -c.wrench.force;
        c.wrench.moment = -c.wrench.moment;
    }
    folder.write("wrong.csv", write_clamped(&data, &cell.setup.robot));
    let ran = folder.run("identify builtin:comau wrong.csv --clamped");
    assert_eq!(ran.code, Some(1));
    assert_snapshot!(ran.out.split("\n\n").next().unwrap(), @r"
    No joint has a usable value. The fit leaves 0.521 mdeg of angles of 59.3 mdeg
      (0.88 %) that the flange holds (RMS).
    SERIOUS: joint 1, joint 2, joint 3, joint 4, joint 5 and joint 6: the compliance
      comes out negative, beyond what noise explains, which is a sign or model
      fault. Check the sign of the force (on the robot), the frames and the model.
    SERIOUS: The compliance of 6 of 6 joints comes out negative: a sign or model
      fault. The wrench seems to be that of the robot on the fixture, and the one of
      the fixture on the robot is needed. Check which way the sensor counts
      (sensor.reports of the cell), and that the angles are loaded minus reference.
    ");
    let rows = ran.out.lines().filter(|line| line.starts_with("joint ") && line.ends_with(" negative"));
    assert_eq!(rows.count(), 6, "{}", ran.out);
}

#[test]
fn wrong_requests_are_answered() {
    let folder = folder();
    folder.write("heading.csv", folder.read("clamped.csv").lines().next().unwrap());
    let lines = [
        "identify builtin:comau clamped.csv",
        "identify builtin:comau clamped.csv --angle-noise-deg 0.001",
        "identify builtin:comau clamped.csv --clamped --noise known",
        "identify builtin:comau clamped.csv --clamped --angle-noise-deg 0",
        "identify builtin:comau clamped.csv --clamped --exclude 9",
        "identify builtin:comau clamped.csv --clamped --exclude 1,2,3,4,5,6",
        "identify builtin:comau heading.csv --clamped",
    ];
    assert_snapshot!(folder.refusals(lines));
}
