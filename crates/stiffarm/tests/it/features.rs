//! The deviations of each feature of a path are told across and along the feed, and judged by its tolerance.

use crate::common::set_ups::the;
use nalgebra::Vector3;
use stiffarm::ask::path::PathOptions;
use stiffarm::ask::predict::{PredictOptions, Predicted};
use stiffarm::estimate::saved::Saved;
use stiffarm::model::cell::Cell;
use stiffarm::model::path::PathPoint;
use stiffarm::model::process::{ForceAxes, Process, TipLoad};
use stiffarm::model::work::FeatureWork;
use stiffarm::work::features::Verdict;
use stiffarm::{Control, Result};
use stiffarm_files::cell::parse_cell;
use stiffarm_files::tool_path::{Kind, read_tool_path};

const PROGRAM: &str = "\
TOOL PATH/SLOT,TOOL,T1\nUNITS/MM\nRAPID\nGOTO/-20,0,50,0,0,1\nRAPID\nGOTO/-20,0,0\nGOTO/0,0,0\nGOTO/20,0,0\nRAPID\nGOTO/20,0,50\n\
TOOL PATH/EDGE,TOOL,T1\nRAPID\nGOTO/0,-20,50\nRAPID\nGOTO/0,-20,0\nGOTO/0,0,0\nGOTO/0,20,0\n";

fn cell() -> Cell {
    let text = "format = 1\nrobot.catalogue = 'kuka-kr500-r2800-2'\n\
        tool = { loading_point_mm = [200, 0, 250], measuring_point = [{ name = '1', position_mm = [0, 0, 300] }] }\n\
        load = { kind = 'measured' }\n[work]\ntip_mm = [0, 0, 300]\nworkpiece_mm = [1700, 100, 800]\n\
        [work.force]\nforce_n = [-200, 150, 100]\naxes = 'base'\n";
    parse_cell(text, "cell.toml").unwrap()
}

fn saved(cell: &Cell) -> Saved {
    let stiffness = [4e6, 4e6, 3e6, 6e5, 5e5, 3e5];
    Saved::bare(cell, &stiffness, "k.json").unwrap()
}

fn predicted(tolerance_mm: Option<f64>) -> Result<Predicted> {
    Ok(predicted_in(cell(), tolerance_mm)?.1)
}

fn predicted_in(cell: Cell, tolerance_mm: Option<f64>) -> Result<(Vec<PathPoint>, Predicted)> {
    let mut read = read_tool_path(Kind::Apt, ("a.cls", PROGRAM.as_bytes()), None, &cell)?;
    assert_eq!(cell.work.put_on(&mut read.points).unwrap(), None);
    let request =
        PredictOptions { path: PathOptions { tolerance_mm, ..PathOptions::default() }, ..PredictOptions::default() };
    let saved = saved(&cell);
    let loaded = request.loaded(cell, &saved.predictor, Some(&read.points), Control::default())?;
    let predicted = request.predict(&loaded, &saved, Control::default())?;
    Ok((read.points, predicted))
}

#[test]
fn what_lies_across_the_feed_is_told_from_what_lies_along_it() -> Result<()> {
    let plain = predicted(None)?;
    let names: Vec<&str> = plain.features.iter().map(|feature| feature.name.as_str()).collect();
    assert_eq!(names, ["SLOT", "EDGE"]);
    // The slot runs along the base's x, the edge along its y; the tool points down.
    let points = &plain.prediction.points;
    let loaded: Vec<usize> = (0..points.len()).filter(|i| points[*i].force_n != [0.0; 3]).collect();
    let second = (1..loaded.len()).find(|k| loaded[*k] > loaded[k - 1] + 1).unwrap();
    let (slot, edge) = loaded.split_at(second);
    for (feature, along, indices) in [(0, 0, slot), (1, 1, edge)] {
        let feature = &plain.features[feature];
        assert_eq!(feature.points, indices.len());
        let shift = |i: usize| Vector3::from(points[i].shift_m);
        let largest = |of: &dyn Fn(Vector3<f64>) -> f64| indices.iter().map(|i| of(shift(*i))).fold(0.0, f64::max);
        let across = largest(&|mut v| {
            v[along] = 0.0;
            v.norm()
        });
        for (actual, expected) in [
            (feature.across_max_m, across),
            (feature.feed_max_m, largest(&|v| v[along].abs())),
            (feature.cross_max_m, largest(&|v| v[1 - along].abs())),
            (feature.axis_max_m, largest(&|v| v.z.abs())),
        ] {
            assert!((actual - expected).abs() < 1e-12, "{feature:?}: {actual} {expected}");
        }
        assert_eq!((feature.half_width_m, feature.verdict), (None, None));
    }
    Ok(())
}

#[test]
fn a_tolerance_is_judged_as_it_is_and_compensated() -> Result<()> {
    let plain = predicted(None)?;
    let [slot, edge] = [0, 1].map(|i| 1e3 * plain.features[i].across_max_m);
    let between = 0.5 * (slot + edge);
    let judged = predicted(Some(between))?;
    let verdicts: Vec<Option<Verdict>> = judged.features.iter().map(|feature| feature.verdict).collect();
    let of = |deviation: f64| Some(if deviation <= between { Verdict::Passes } else { Verdict::Fails });
    assert_eq!(verdicts, [of(slot), of(edge)]);
    insta::assert_snapshot!(the(&judged.prediction.findings, "tolerance").sentence, @"1 of 2 features do not surely keep to their tolerance: EDGE: 0.198 mm of 0.177 mm, fails.");
    let cell = cell();
    let read = read_tool_path(Kind::Apt, ("a.cls", PROGRAM.as_bytes()), None, &cell)?;
    let options = PathOptions { tolerance_mm: Some(between), ..PathOptions::default() };
    let saved = saved(&cell);
    let followed = options.follow(&cell, &saved.predictor, &read.points, Control::default())?;
    let compensated = options.compensate(&cell, &saved, &followed, Control::default())?;
    // Without covariance nobody knows what is left.
    assert!(compensated.features.iter().all(|feature| feature.compensated_m.is_none()));
    assert!((compensated.features[0].across_max_m - plain.features[0].across_max_m).abs() < 1e-15);
    Ok(())
}

#[test]
fn features_of_the_cell_have_their_own_load_and_tolerance() -> Result<()> {
    let plain = predicted(None)?;
    let across: Vec<f64> = plain.features.iter().map(|feature| feature.across_max_m).collect();
    // The edge under half the load keeps to a tolerance that it would not keep to under the whole one.
    let of_cell = |name: &str| {
        let mut cell = cell();
        cell.work.features = vec![FeatureWork {
            name: name.to_string(),
            process: Some(Process::Constant(
                TipLoad { force: Vector3::new(-100.0, 75.0, 50.0), moment: Vector3::zeros(), axes: ForceAxes::Base },
                None,
            )),
            tolerance: Some(0.75 * across[1]),
        }];
        cell
    };
    let (mut path, predicted) = predicted_in(of_cell("EDGE"), None)?;
    let [slot, edge] = [0, 1].map(|i| &predicted.features[i]);
    assert_eq!((slot.across_max_m, slot.verdict), (across[0], None));
    assert!((edge.across_max_m / across[1] - 0.5).abs() < 0.01, "{edge:?}");
    assert_eq!(edge.verdict, Some(Verdict::Passes));
    // Rapid moves stay without load.
    let points = predicted.prediction.points.iter();
    let idle = points.filter(|point| point.force_n == [0.0; 3]);
    let rapid = path.iter().filter(|point| point.rapid);
    assert_eq!(idle.count(), rapid.count());

    let other = of_cell("Egde").work.put_on(&mut path).unwrap();
    insta::assert_snapshot!(other.unwrap().sentence, @r#"The feature "Egde" of the cell is not in the path: no point has that load or tolerance."#);
    Ok(())
}
