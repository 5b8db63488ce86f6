//! All that an identification says, in one call.

use crate::common::{default_cell, group1};
use stiffarm::estimate::identified::{Identified, Wanted};
use stiffarm::estimate::identify::Fit;
use stiffarm::measure::prepare;
use stiffarm::measure::reduction::ReduceOptions;
use stiffarm::model::posture::PostureGroup;
use stiffarm::{Code, Control, simulated_readings};

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
    let all = Identified::new(&fit, &Wanted::default(), Control::default()).unwrap();
    assert!(all.budget.is_some() && all.diagnosis.is_some() && all.next_posture.is_some());
    assert!(all.bootstrap.is_none() && all.elastic.is_none() && all.not_computed.is_empty());
    let brief = {
        let mut wanted = Wanted::default();
        wanted.brief = true;
        Identified::new(&fit, &wanted, Control::default()).unwrap()
    };
    assert_eq!(brief.identification, all.identification);
    assert!(brief.budget.is_none() && brief.diagnosis.is_none() && brief.next_posture.is_none());
    // What is saved is what is read.
    let text = serde_json::to_string(&all).unwrap();
    let read: Identified = serde_json::from_str(&text).unwrap();
    assert_eq!(serde_json::to_string(&read).unwrap(), text);
}

#[test]
fn what_a_stop_leaves_out_is_named() {
    let control = Control {
        stop: Some(&|| true),
        ..Control::default()
    };
    let stopped = Identified::new(&fit(), &Wanted::default(), control).unwrap();
    assert!(stopped.next_posture.is_none());
    assert_eq!(stopped.not_computed, ["next_posture"]);
    assert_eq!(stopped.next_posture_missing, None);
}

#[test]
fn a_bootstrap_without_resamples_is_refused_with_its_key() {
    let mut wanted = Wanted::default();
    wanted.bootstrap = Some(0);
    let refused = Identified::new(&fit(), &wanted, Control::default()).unwrap_err();
    assert_eq!(refused.place().key.as_deref(), Some("bootstrap"));
    assert_ne!(refused.code(), Code::Interrupted);
}
