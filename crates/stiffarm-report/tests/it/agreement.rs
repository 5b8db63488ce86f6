//! Repeats of one experiment contradict each other only where their intervals do.

use crate::common::{group, identified, saved};
use serde_json::{Value, json};
use stiffarm::measure::prepare;
use stiffarm::model::cell::Cell;
use stiffarm::simulated_readings;
use stiffarm_files::builtin;
use stiffarm_files::result::SavedResult;
use stiffarm_report::identified::{StiffnessRow, stiffness_figure};
use stiffarm_report::page::{Block, render_page};
use stiffarm_report::report::{WithCell, report};
use stiffarm_report::{Figure, figure_csv};

/// Honest repeats of the default experiment.
const REPEATS: u64 = 20;

/// What `identify` makes of a repeat where the scatter of the readings is most of the ±.
fn repeat(cell: &Cell, seed: u64) -> SavedResult {
    let readings = simulated_readings(cell, &group(cell), seed).unwrap();
    let measured = prepare(cell, readings, &Default::default()).unwrap();
    let mut result = saved("identify", identified(cell, &measured));
    result.name = format!("{seed}.json");
    result
}

/// Whether the page of two results says that they contradict each other.
fn contradict(a: &SavedResult, b: &SavedResult) -> bool {
    let page = report(&[a, b].map(|saved| WithCell::new(saved, None))).unwrap();
    let verdict = &page.comparison.unwrap().verdict;
    verdict[1].plain().contains("they contradict each other")
}

#[test]
fn honest_repeats_hardly_ever_contradict_each_other() {
    let mut cell = builtin::cell("comau").unwrap();
    cell.noise.reading_variance *= 25.0;
    let all: Vec<SavedResult> = (1..=REPEATS).map(|seed| repeat(&cell, seed)).collect();
    let pairs = (0..all.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let pairs: Vec<(usize, usize)> = pairs.collect();
    let wrong = pairs.iter().filter(|(i, j)| contradict(&all[*i], &all[*j]));
    let wrong = wrong.count();
    assert!(20 * wrong <= pairs.len(), "{wrong} of {}", pairs.len());
    // Another arm is told from them.
    let mut other = cell.clone();
    other.prior.as_mut().unwrap()[0] *= 2.0;
    assert!(contradict(&all[0], &repeat(&other, 1)));
}

/// The rule by hand: 1/k differs by more than the root of the sum of squares of both half widths.
#[test]
fn the_errors_of_both_results_count() {
    let with = |stiffness: f64, half_width: f64| {
        let h = 1.0 / stiffness;
        let mut result = crate::common::good();
        let joint = &mut result["joints"][0];
        joint["stiffness"] = json!(stiffness);
        joint["compliance"] = json!(h);
        joint["interval"] = json!([1.0 / (h + half_width * h), 1.0 / (h - half_width * h)]);
        // One joint alone, so that a single comparison is made.
        let joints: Vec<Value> = result["joints"].as_array().unwrap()[..1].to_vec();
        let others = result["joints"].as_array().unwrap()[1..].iter().cloned();
        let others = others.map(|mut joint| {
            joint["interval"] = json!([null, null]);
            joint
        });
        result["joints"] = json!(joints.into_iter().chain(others).collect::<Vec<_>>());
        saved("identify", result)
    };
    // Of 1/k: 1 against 1/1.2, apart by 0.1667; half widths 0.1 and 0.1/1.2 make 0.1302.
    assert!(contradict(&with(1e6, 0.1), &with(1.2e6, 0.1)));
    // 0.13 and 0.13/1.2 make 0.1692: neither covers the difference alone.
    assert!(!contradict(&with(1e6, 0.13), &with(1.2e6, 0.13)));
}

fn figure_of(saved: &SavedResult, cell: &Cell) -> Figure {
    let page = report(&[WithCell::new(saved, Some(cell))]).unwrap();
    let blocks = page.parts[0].sections.iter().flat_map(|s| &s.blocks);
    let mut figures = blocks.filter_map(|block| match block {
        Block::Figure(figure) if figure.id == "joint-stiffness" => Some(figure.clone()),
        _ => None,
    });
    figures.next().unwrap()
}

#[test]
fn bars_of_the_stiffness_end_where_the_table_says() {
    let cell = builtin::cell("fanuc-r2000ic").unwrap();
    let readings = builtin::measurements("fanuc-r2000ic-readings", &cell).unwrap();
    let measured = prepare(&cell, readings, &Default::default()).unwrap();
    let saved = saved("identify", identified(&cell, &measured));
    let figure = figure_of(&saved, &cell);
    let identified = &figure.panels[0].series[0];
    assert_eq!(identified.y.len(), 6);
    let uncertainty = saved.json["result"]["systematic_errors"]["uncertainty"].as_array();
    let uncertainty = uncertainty.unwrap();
    let mut open = 0;
    for (bar, joint) in identified.interval.iter().zip(uncertainty) {
        for (end, i) in bar.iter().zip(0..) {
            let said = joint["interval_nm_per_rad"][i].as_f64();
            assert_eq!(*end, said.map(|k| 1e-6 * k));
        }
        open += usize::from(bar[1].is_none());
    }
    assert_eq!(open, 0);
    // Joint 6 as the table has it, and not k ± half width.
    let [Some(low), Some(high)] = identified.interval[5] else { panic!("{identified:?}") };
    assert!((low - 0.133).abs() < 0.002 && (high - 0.460).abs() < 0.01);
    let page = report(&[WithCell::new(&saved, Some(&cell))]).unwrap();
    let html = render_page(&page);
    let tips = html.split("data-tip=\"").skip(1).map(|rest| rest.split_once('"').unwrap().0);
    let mut tips: Vec<&str> = tips.filter(|tip| tip.contains("joint 6: 0.206 (")).collect();
    tips.dedup();
    insta::assert_snapshot!(tips.join("\n"), @"identified · joint 6: 0.206 (0.1328 to 0.4597) 10⁶ N·m/rad");
    let csv = figure_csv(&figure);
    assert!(csv.lines().next().unwrap().ends_with(",error,value,from,to"));
}

#[test]
fn a_joint_without_an_estimate_has_its_lower_bound() {
    let row = |stiffness: Option<f64>, interval: [Option<f64>; 2]| StiffnessRow {
        joint: "joint".to_string(),
        stiffness,
        statistical: None,
        systematic: None,
        total: None,
        interval,
    };
    let rows = [row(Some(2e6), [Some(1e6), None]), row(None, [Some(3e6), None]), row(None, [None, None])];
    let figure = stiffness_figure(&rows, &[], &[], 0.95);
    let [identified, bound] = figure.panels[0].series.as_slice() else { panic!("{:?}", figure.panels[0].series) };
    assert_eq!(identified.interval, [[Some(1.0), None]]);
    assert_eq!((&bound.x[..], &bound.y[..]), (&[1.0][..], &[3.0][..]));
    assert_eq!(bound.interval, [[Some(3.0), None]]);
    let text = serde_json::to_string(&figure).unwrap();
    assert_eq!(serde_json::from_str::<Figure>(&text).unwrap(), figure);
}
