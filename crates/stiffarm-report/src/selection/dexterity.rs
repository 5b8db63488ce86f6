//! The parts of the paper's novel index.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::order::places;
use stiffarm::plan::index::GroupEvaluation;

/// k(J_N) of each posture, and max k(J_N), cond(Ψ) and their product, for each group; `None` where no group has a
/// k(J_N).
pub fn dexterity_figure(groups: &[(&GroupEvaluation, &[String])]) -> Option<Figure> {
    let known_count = groups.iter().flat_map(|(g, _)| &g.k_jn).flatten().count();
    let longest = groups.iter().max_by_key(|(g, _)| g.k_jn.len())?;
    if known_count == 0 {
        return None;
    }
    let count = longest.0.k_jn.len();
    // Names say nothing where groups name their postures differently.
    let agree = |names: &[String]| names.iter().zip(longest.1).all(|(a, b)| a == b);
    let same = longest.1.len() == count && groups.iter().all(|(_, names)| agree(names));
    let names: Vec<String> = if same { longest.1.to_vec() } else { (1..=count).map(|i| i.to_string()).collect() };
    let each = groups.iter().map(|(group, _)| {
        let y: Vec<f64> = group.k_jn.iter().map(|k| k.unwrap_or(f64::NAN)).collect();
        Series::new(&group.name, Style::Bars, places(y.len()), y)
    });
    let parts = groups.iter().map(|(group, _)| {
        let of = &group.indices;
        let y = [of.classical, of.condition, of.novel].map(|v| v.unwrap_or(f64::NAN));
        Series::new(&group.name, Style::Bars, places(3), y.to_vec())
    });
    let parts_of = Axis::categorical("", ["max k(J_N)", "cond(Ψ)", "novel"]);
    let mut figure = Figure::one(
        "novel-index",
        "The paper's novel index and its parts",
        "k(J_N) of each posture, the largest of which is the classical index; and that times cond(Ψ), the novel \
         index. The lower, the better; a posture with a large k(J_N) is close to a singularity.",
        Panel::new("each posture", Axis::categorical("posture", names), Axis::log("k(J_N)", ""), each.collect()),
    );
    figure.columns = 2;
    let group = Panel::new("the group", parts_of, Axis::log("index", ""), parts.collect());
    figure.panels.push(group);
    Some(figure)
}
