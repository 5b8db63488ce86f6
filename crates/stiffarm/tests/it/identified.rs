//! One call says all of an identification, or names what a stop left out.

use crate::common::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use stiffarm::Watch;
use stiffarm::ask::identify::{Identified, IdentifiedOptions};
use stiffarm::estimate::identify::IntervalHolds;
use stiffarm::model::measurement::WrenchColumns;

fn fit() -> Fit {
    let cell = default_cell();
    let group = PostureGroup::from_angles("", group1());
    let readings = simulated_readings(&cell, &group.postures, 1).unwrap();
    let measured = prepare(&cell, readings, &ReduceOptions::default()).unwrap();
    Fit::new(&cell, &measured, &Default::default()).unwrap()
}

#[test]
fn everything_or_estimates_alone() {
    let fit = fit();
    let all = Identified::new(&fit, &IdentifiedOptions::default(), Control::default()).unwrap();
    assert!(all.systematic_errors.is_some() && all.diagnosis.is_some() && all.next_posture.is_some());
    assert!(all.bootstrap.is_none() && all.elastic.is_some() && all.not_computed.is_empty());
    let brief = {
        let mut wanted = IdentifiedOptions::default();
        wanted.brief = true;
        wanted.fit.elastic = Some(ElasticChoice::Axes);
        Identified::new(&fit, &wanted, Control::default()).unwrap()
    };
    assert_eq!(brief.identification, *fit.identification().unwrap());
    assert!(brief.systematic_errors.is_none() && brief.diagnosis.is_none() && brief.next_posture.is_none());
    // What is saved is what is read.
    let text = serde_json::to_string(&all).unwrap();
    let read: Identified = serde_json::from_str(&text).unwrap();
    assert_eq!(serde_json::to_string(&read).unwrap(), text);
}

#[test]
fn what_a_stop_leaves_out_is_named() {
    let control = Control { stop: Some(&|| true), ..Control::default() };
    let stopped = Identified::new(&fit(), &IdentifiedOptions::default(), control).unwrap();
    assert!(stopped.next_posture.is_none());
    assert_eq!(stopped.not_computed, ["next_posture"]);
    assert_eq!(stopped.next_posture_missing, None);
}

/// Whatever predicts with a stopped identification says that its bands lack the systematic errors.
#[test]
fn a_stop_before_the_systematic_errors_goes_along_with_the_stiffness() {
    let cell = default_cell();
    let group = PostureGroup::from_angles("", group1());
    let readings = simulated_readings(&cell, &group.postures, 1).unwrap();
    let measured = prepare(&cell, readings, &ReduceOptions::default()).unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let watch = Watch::new(move || flag.load(Ordering::Relaxed), |_, _, _| ());
    let fit = Fit::watched(&cell, &measured, &Default::default(), watch).unwrap();
    fit.identification().unwrap();
    stop.store(true, Ordering::Relaxed);
    let stopped = Identified::new(&fit, &IdentifiedOptions::default(), Control::default()).unwrap();
    assert!(stopped.systematic_errors.is_none(), "{:?}", stopped.not_computed);
    let doubts = stopped.sealed.unwrap().predictor.doubts;
    assert!(doubts.iter().any(|doubt| doubt.code == "stiffness-unfinished"), "{doubts:?}");
}

#[test]
fn a_bootstrap_without_resamples_is_refused_with_its_key() {
    let mut wanted = IdentifiedOptions::default();
    wanted.bootstrap = Some(0);
    let refused = Identified::new(&fit(), &wanted, Control::default()).unwrap_err();
    assert_eq!(refused.place().key.as_deref(), Some("bootstrap"));
    assert_ne!(refused.code(), Code::Interrupted);
}

#[test]
fn the_first_interval_holds_all_errors_and_the_parts_have_names() {
    let fit = fit();
    let mut wanted = IdentifiedOptions::default();
    wanted.fit.elastic = Some(ElasticChoice::Axes);
    let all = Identified::new(&fit, &wanted, Control::default()).unwrap();
    let alone = &fit.identification().unwrap().estimates.joints;
    let systematic = all.systematic_errors.as_ref().unwrap();
    for (j, joint) in all.identification.estimates.joints.iter().enumerate() {
        let (uncertainty, total) = (&systematic.uncertainty[j], systematic.total[j].unwrap());
        assert_eq!(joint.interval_holds, IntervalHolds::AllErrors);
        assert_eq!((joint.interval, joint.half_width), (uncertainty.interval_nm_per_rad, uncertainty.total));
        assert_eq!(joint.standard_error, Some(joint.stiffness.unwrap() * total));
        assert_eq!(joint.readings_interval, alone[j].interval);
        assert_eq!(joint.readings_standard_error, alone[j].standard_error);
        // A fit knows no more than its readings, and says so.
        assert_eq!(alone[j].interval_holds, IntervalHolds::Readings);
        assert_eq!(alone[j].interval, alone[j].readings_interval);
        let half = joint.half_width.unwrap();
        assert!(half > alone[j].half_width.unwrap() && half > 0.0196);
        let verdict = match half {
            half if half <= 0.1 => Verdict::Determined,
            half if half < 0.5 => Verdict::Weak,
            _ => Verdict::HardlyKnown,
        };
        assert_eq!(joint.verdict, verdict, "{joint:?}");
    }
    let saved = serde_json::to_value(&all).unwrap();
    let first = &saved["joints"][0];
    assert_eq!(first["interval"], saved["systematic_errors"]["uncertainty"][0]["interval_nm_per_rad"]);
    assert_eq!(first["interval_holds"], "all_errors");
    // Read again nothing moves.
    let again: Identified = serde_json::from_value(saved).unwrap();
    assert_eq!(again.identification, all.identification);
    wanted.brief = true;
    let brief = Identified::new(&fit, &wanted, Control::default()).unwrap();
    assert_eq!(brief.identification.estimates.joints, *alone);
}

/// A wrench is more than its force: what is simulated of it has the moment, and without it a table is refused.
#[test]
fn the_moment_of_a_wrench_is_in_its_readings() {
    let mut cell = default_cell();
    cell.setup.load = Load::Constant {
        wrench: Wrench { force: Vector3::new(0.0, 300.0, -200.0), moment: Vector3::new(0.0, 0.0, 60.0) },
        axes: Axes::Base,
    };
    let group = PostureGroup::from_angles("", group1());
    let mut readings = simulated_readings(&cell, &group.postures, 1).unwrap();
    let worst = |readings: &ReadingTable| {
        let measured = prepare(&cell, readings.clone(), &ReduceOptions::default()).unwrap();
        let named = measured.findings().any(|f| f.code == "moment-not-read" && f.severity == Severity::Serious);
        let fit = Fit::new(&cell, &measured, &Default::default()).unwrap();
        let joints = fit.identification().unwrap().estimates.joints.clone();
        let off = joints.iter().zip(cell.prior.as_ref().unwrap());
        let off = off.map(|(joint, k)| (joint.stiffness.unwrap() / k - 1.0).abs());
        (named, off.fold(0.0, f64::max))
    };
    let (named, off) = worst(&readings);
    assert!(!named && off < 0.05, "{off}");
    // The same without its moments.
    readings.wrench_columns = WrenchColumns::Force;
    for posture in &mut readings.postures {
        for wrench in posture.states.iter_mut().filter_map(|s| s.wrench.as_mut()) {
            wrench.moment = Vector3::zeros();
        }
    }
    let (named, off) = worst(&readings);
    assert!(named && off > 0.1, "{off}");
}
