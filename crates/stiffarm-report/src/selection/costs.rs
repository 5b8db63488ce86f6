//! What limits, postures and wrong assumptions cost a plan.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::order::{in_order, places};
use stiffarm::plan::select::{LimitPrice, PostureValue, Sensitivity};

/// How much each kind of limit worsens the index, the dearest first.
pub fn price_figure(prices: &[LimitPrice]) -> Figure {
    let y = prices.iter().map(|price| 100.0 * price.price).collect();
    let names = prices.iter().map(|price| price.kind.describe());
    bars(
        "prices",
        "What each limit costs",
        "How much worse the index is with the limit than in the best plan found without it. Each bar is a search of \
         its own: a few tenths of a per cent may be its luck.",
        ("", names.map(String::from).collect()),
        "cost",
        vec![("cost of the limit", y)],
    )
}

/// How much worse the index becomes without each posture, the least first.
pub fn worth_figure(values: &[PostureValue], names: &[String]) -> Figure {
    let name = |value: &PostureValue| names.get(value.posture).cloned().unwrap_or_default();
    let y = values.iter().map(|v| v.loss.map_or(f64::NAN, |l| 100.0 * l));
    bars(
        "worth",
        "What each posture is worth",
        "How much worse the index becomes without one posture. No bar: without it a joint is undetermined.",
        ("posture", values.iter().map(name).collect()),
        "loss",
        vec![("loss without the posture", y.collect())],
    )
}

/// How much better another plan would be if one joint's stiffness were another; `None` where the index has no prior.
pub fn sensitivity_figure(sensitivity: &Sensitivity) -> Option<Figure> {
    let joints = in_order(sensitivity.priors.iter().map(|case| case.joint.clone()));
    let factors = in_order(sensitivity.priors.iter().map(|case| case.factor));
    if joints.is_empty() {
        return None;
    }
    let labels: Vec<String> = factors.iter().map(|f| format!("prior × {f}")).collect();
    let series = factors.iter().zip(&labels).map(|(factor, label)| {
        let loss = |joint: &String| {
            let mut cases = sensitivity.priors.iter();
            let case = cases.find(|c| c.joint == *joint && c.factor == *factor);
            case.and_then(|case| case.loss).map_or(f64::NAN, |l| 100.0 * l)
        };
        (label.as_str(), joints.iter().map(loss).collect())
    });
    let series = series.collect();
    Some(bars(
        "sensitivity",
        "What a wrong prior stiffness costs",
        "How much better a plan made for the changed prior stiffness of one joint would be. Below 5 % the plan stands.",
        ("", joints.clone()),
        "loss",
        series,
    ))
}

/// Bars \[%\] by name.
fn bars(
    id: &str,
    title: &str,
    caption: &str,
    (label, names): (&str, Vec<String>),
    y: &str,
    series: Vec<(&str, Vec<f64>)>,
) -> Figure {
    let series = series.into_iter();
    let series = series.map(|(label, y)| Series::new(label, Style::Bars, places(y.len()), y));
    Figure::one(
        id,
        title,
        caption,
        Panel::new("", Axis::categorical(label, names), Axis::linear(y, "%").from_zero(), series.collect()),
    )
}
