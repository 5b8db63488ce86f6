//! Load states of the postures, and what single postures do to the result.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use stiffarm::estimate::diagnose::LoadStates;
use stiffarm::estimate::identify::LeaveOneOut;

/// Postures of which the load states are drawn.
const MOST: usize = 6;
/// Shifts beyond this are named \[standard errors\].
const CLEAR: f64 = 2.0;

/// How far displacements lie from growing in proportion to the load, in the order taken.
pub fn load_states_figure(states: &LoadStates) -> Figure {
    let widest = |i: &usize| states.postures[*i].loop_m.map_or(0.0, |l| l[0].abs());
    let mut order: Vec<usize> = (0..states.postures.len()).collect();
    order.sort_by(|a, b| widest(b).total_cmp(&widest(a)));
    order.truncate(MOST);
    order.sort_unstable();
    let series = order.into_iter().map(|i| {
        let posture = &states.postures[i];
        let pairs = posture.loads.iter().zip(&posture.displacements_m);
        let largest = pairs.clone().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        let slope = largest.map_or(0.0, |(load, moved)| moved / load);
        let (x, y) = pairs.map(|(load, moved)| (100.0 * load, 1e3 * (moved - slope * load))).unzip();
        let label = format!("posture {}", posture.posture);
        Series::new(label, Style::Line, x, y)
    });
    Figure::one(
        "load-states",
        "Displacement beyond proportion to the load",
        format!(
            "Displacement less its share in proportion to the load, in the order the loads were taken: zero at the \
             largest load, and everywhere for an arm that is a spring. A loop is hysteresis, a bow a joint that \
             stiffens or softens, an offset near zero load lost motion. One component scatters by {:.3} mm.{}",
            1e3 * states.scatter_m,
            if states.postures.len() > MOST {
                format!(" The {MOST} widest loops of {} postures.", states.postures.len())
            } else {
                String::new()
            }
        ),
        Panel::new(
            "",
            Axis::linear("load, share of the posture's largest", "%"),
            Axis::linear("displacement beyond proportion", "mm"),
            series.collect(),
        ),
    )
}

/// How far the most moved unknown moves without each posture.
pub fn influence_figure(influence: &LeaveOneOut) -> Figure {
    let names: Vec<&str> = influence.postures.iter().map(|p| p.posture.as_str()).collect();
    let count = names.len();
    let largest = influence.postures.iter().enumerate().filter_map(|(i, posture)| {
        let shifts = posture.shifts.iter().flatten().map(|shift| shift.abs());
        Some((i as f64, shifts.reduce(f64::max)?))
    });
    let (x, largest) = largest.unzip();
    let ends = vec![-0.5, count as f64 - 0.5];
    Figure::one(
        "influence",
        "Change of the compliances without each posture",
        "How far the compliance that moves most would move without each posture, in its standard errors. Beyond 2 the \
         result leans on that posture: look at it, and measure more like it.",
        Panel::new(
            "",
            Axis::categorical("posture left out", names),
            Axis::linear("largest change", "standard errors").from_zero(),
            vec![
                Series::new("change", Style::Bars, x, largest),
                Series::new("worth a look", Style::Dashed, ends, vec![CLEAR; 2]),
            ],
        ),
    )
}
