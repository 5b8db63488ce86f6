//! Groups judged by hand: value and limits.

use nalgebra::Vector3;
use stiffarm::internals::evaluate_for;
use stiffarm::model::cell::{Cell, Limits};
use stiffarm::model::load::Load;
use stiffarm::model::observation::PostureTerms;
use stiffarm::plan::index::Index;

/// ln of an index that is to be minimised; infinite where it does not exist.
pub fn ln_index(cell: &Cell, index: Index, group: &[Vec<f64>]) -> f64 {
    match evaluate_for(cell, "", group, Some(index)).unwrap().indices.get(index) {
        Some(value) if index.larger_is_better() => -value.ln(),
        Some(value) => value.ln(),
        None => f64::INFINITY,
    }
}

/// Measuring points, loading point and flange.
fn points_of(terms: &PostureTerms) -> Vec<Vector3<f64>> {
    let mut points = terms.measuring_points().to_vec();
    points.push(*terms.loading_point());
    points.push(terms.frames().flange().translation.vector);
    points
}

/// Largest violation of bounds \[rad\] and limits \[m\], written out by hand.
pub fn violation(cell: &Cell, group: &[Vec<f64>]) -> f64 {
    let mut worst = 0.0_f64;
    let mut need = |margin: f64| worst = worst.max(-margin);
    for q in group {
        for (angle, bound) in q.iter().zip(&cell.bounds) {
            need(angle - bound[0]);
            need(bound[1] - angle);
        }
        let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
        let frames = terms.frames();
        let points = points_of(&terms);
        let wrist = frames.wrist_centre();
        let from_axis_1 = |p: &Vector3<f64>| (p - frames.origins()[0]).cross(&frames.axes()[0]).norm();
        for p in &points {
            if let Some([low, high]) = &cell.limits.tool_box {
                (p - low).iter().chain((high - p).iter()).for_each(|m| need(*m));
            }
            cell.limits.floor.into_iter().for_each(|z| need(p.z - z));
            cell.limits.keep_out_radius.into_iter().for_each(|r| need(from_axis_1(p) - r));
        }
        cell.limits.keep_out_radius.into_iter().for_each(|r| need(from_axis_1(&wrist) - r));
        cell.limits.wrist_height.into_iter().for_each(|z| need(wrist.z - z));
        if let (Some([short, long]), Load::Rope { anchor, .. }) = (cell.limits.rope_length, &cell.setup.load) {
            let length = (anchor - terms.loading_point()).norm();
            need(length - short);
            need(long - length);
        }
    }
    worst
}

/// Limits that the postures of `group` meet by `spare` \[m\].
pub fn limits_around(cell: &Cell, group: &[Vec<f64>], spare: f64) -> Limits {
    let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    let (mut near, mut wrist, mut rope) = (f64::INFINITY, f64::INFINITY, [f64::INFINITY, 0.0_f64]);
    for q in group {
        let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
        let frames = terms.frames();
        let mut points = points_of(&terms);
        for p in &points {
            low = low.inf(p);
            high = high.sup(p);
        }
        points.push(frames.wrist_centre());
        for p in &points {
            near = near.min((p - frames.origins()[0]).cross(&frames.axes()[0]).norm());
        }
        wrist = wrist.min(frames.wrist_centre().z);
        if let Load::Rope { anchor, .. } = &cell.setup.load {
            let length = (anchor - terms.loading_point()).norm();
            rope = [rope[0].min(length), rope[1].max(length)];
        }
    }
    Limits {
        tool_box: Some([low.add_scalar(-spare), high.add_scalar(spare)]),
        floor: Some(low.z - 0.5 * spare),
        keep_out_radius: (near > spare).then_some(near - spare),
        wrist_height: Some(wrist - spare),
        rope_length: (rope[0] > spare && rope[1] > 0.0).then_some([rope[0] - spare, rope[1] + spare]),
    }
}
