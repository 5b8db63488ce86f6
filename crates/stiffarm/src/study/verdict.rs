//! The verdict of a study in sentences.

use super::{INITIAL_GROUP, STUDY_INDICES, StartsOfKind, Study, StudyGroup};
use crate::estimate::simulate::FIRST_ORDER_LIMIT;
use crate::findings::{Finding, Severity, list, percent};
use crate::numerics::control::Termination;
use crate::numerics::sample::mean;
use crate::plan::index::Index;

/// What a stopped study lacks.
fn missing(study: &Study) -> Vec<String> {
    let mut out = Vec::new();
    let unfinished = study.groups.iter().filter(|group| {
        let selection = group.selection.as_ref();
        selection.is_some_and(|s| s.termination == Termination::Interrupted)
    });
    let unfinished: Vec<&str> = unfinished.map(|group| group.name.as_str()).collect();
    if !unfinished.is_empty() {
        out.push(format!("the end of the searches for {}", list(&unfinished)));
    }
    let (runs, groups) = (study.options.simulation.runs, &study.simulation.groups);
    let levels = groups.iter().flat_map(|group| &group.levels);
    let fewest = levels.map(|level| level.runs).min().unwrap_or(runs);
    if fewest < runs {
        let left = runs - fewest;
        out.push(format!("up to {left} of {runs} runs of the simulation"));
    }
    if study.elastic.as_ref().is_some_and(|e| e.interrupted) {
        out.push("runs on arms that give way beyond their joint axes".to_string());
    }
    let draws = study.classical_q1.as_ref().map_or(0, |range| range.draws);
    if draws < study.options.q1_draws {
        let left = study.options.q1_draws - draws;
        out.push(format!("{left} of {} draws of q1", study.options.q1_draws));
    }
    let tried: usize = study.starts.kinds.iter().map(|kind| kind.count).sum();
    if tried < study.options.starts {
        let left = study.options.starts - tried;
        out.push(format!("{left} of {} other initial groups", study.options.starts));
    }
    if out.is_empty() {
        // Stopped in the last moment.
        out.push("nothing that shows".to_string());
    }
    out
}

/// Fills in the recommendation and the findings.
pub(super) fn conclude(study: &mut Study) {
    let mut findings = std::mem::take(&mut study.findings);
    if study.interrupted {
        findings.push(Finding::caution(
            "interrupted",
            "study",
            format!("The study was stopped before its end. Missing: {}.", list(&missing(study))),
        ));
    }

    for group in &study.groups {
        let lost = &group.evaluation.undetermined_joints;
        if !lost.is_empty() {
            findings.push(Finding::serious(
                "undetermined-joints",
                &group.name,
                format!("{} cannot determine {}.", group.name, list(lost)),
            ));
        }
    }

    if study.noise_std_m > 0.0 {
        let (recommended, finding) = recommendation(study);
        findings.extend(finding);
        findings.extend(paper_order(study));
        findings.extend(first_order_means(study));
        findings.extend(study.starts.kinds.iter().map(other_starts));
        study.recommended = recommended;
    } else {
        findings.push(Finding::caution(
            "no-noise",
            "noise.variance_mm2",
            "The cell has no measurement noise, so every expected deviation is zero and nothing can be recommended.",
        ));
    }

    if let Some(elastic) = &study.elastic {
        findings.push(Finding::note(
            "beyond-axes",
            "elastic",
            format!(
                "Arms that give way beyond their joint axes were simulated with {}. {}",
                elastic.sizes_from.in_words(),
                elastic.verdict()
            ),
        ));
    }

    if let Some(range) = study.classical_q1.as_ref().filter(|range| range.matters()) {
        let lost = match range.undetermined {
            0 => String::new(),
            k => format!(" {k} of them leave a joint undetermined."),
        };
        let spread = range.quantiles.map_or(" does not exist".to_string(), |q| {
            format!(" runs from {} to {} (median {})", percent(q[0]), percent(q[4]), percent(q[2]))
        });
        findings.push(Finding::caution(
            "classical-q1",
            STUDY_INDICES[0].1,
            format!(
                "k(J_N) ignores q1, so the classical group is a range: with q1 of its postures drawn anew ({} draws \
                 inside the limits) the mean expected deviation{spread}, with the same index.{lost}",
                range.draws
            ),
        ));
    }

    for (g, group) in study.simulation.groups.iter().enumerate() {
        let flagged: Vec<&str> = (0..study.joints.len())
            .filter(|j| group.levels.iter().any(|l| l.beyond_first_order[*j]))
            .map(|j| study.joints[j].as_str())
            .collect();
        if !flagged.is_empty() {
            findings.push(Finding::caution(
                "beyond-first-order",
                &study.simulation.groups[g].name,
                format!(
                    "{}: the relative standard error of {} passes 10 % at some noise level; the mean of |k̂ − k|/k is \
                     not meaningful there, so the median is shown.",
                    group.name,
                    list(&flagged)
                ),
            ));
        }
    }

    let looseness: Vec<f64> = study
        .groups
        .iter()
        .filter_map(|g| Some(g.error_bound?.bound? / g.expected_relative_norm?))
        .filter(|ratio| ratio.is_finite())
        .collect();
    if !looseness.is_empty() {
        let low = looseness.iter().copied().fold(f64::INFINITY, f64::min);
        let high = looseness.iter().copied().fold(0.0, f64::max);
        findings.push(Finding::note(
            "error-bound",
            "Eq. (19)",
            format!(
                "The bound of Eq. (19) is {low:.0} to {high:.0} times the expected relative error of the compliance \
                 vector in these groups; the closed-form expectation is the number to plan with."
            ),
        ));
    }

    let share = study.groups.iter().map(|g| g.correction_share_m).fold(0.0, f64::max);
    let linear = study.groups.iter().map(|g| g.linearisation_m).fold(0.0, f64::max);
    findings.push(Finding::new(
        "model-order",
        if linear > study.noise_std_m { Severity::Caution } else { Severity::Note },
        "K_C",
        format!(
            "K_C changes no measuring point's displacement by more than {:.1} µm in these groups, and the exact \
             equilibrium differs from the linear model by at most {:.1} µm (tracker noise: {:.1} µm).",
            1e6 * share,
            1e6 * linear,
            1e6 * study.noise_std_m
        ),
    ));

    let validated: Vec<(String, f64)> = study
        .groups
        .iter()
        .filter_map(|g| {
            let points = &g.validation.as_ref()?.points;
            let values: Vec<f64> = points.iter().map(|p| p.deviation_m).collect();
            Some((g.name.clone(), mean(&values)))
        })
        .collect();
    if let Some(expected) = study.groups.iter().find_map(|g| g.validation.as_ref()).map(|v| v.noise_expectation_m) {
        let list: Vec<String> = validated.iter().map(|(n, v)| format!("{n} {:.4} mm", 1e3 * v)).collect();
        findings.push(Finding::note(
            "validation-limit",
            "Eq. (22)",
            format!(
                "With tracker noise as the only error, the mean deviation at the validation postures is {}; noise \
                 alone gives {:.4} mm.",
                list.join(", "),
                1e3 * expected
            ),
        ));
    }
    study.findings = findings;
}

fn deviation(group: &StudyGroup) -> Option<f64> {
    group.evaluation.mean_expected_deviation()
}

/// The index to select with, and the sentence that says so.
fn recommendation(study: &Study) -> (Option<Index>, Option<Finding>) {
    let best = study
        .groups
        .iter()
        .filter_map(|g| Some((g.selection.as_ref()?.index, deviation(g)?, g)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let Some((index, value, group)) = best else {
        return (None, None);
    };
    let others: Vec<String> = study
        .groups
        .iter()
        .filter(|g| g.name != group.name)
        .filter_map(|g| {
            let other = deviation(g)?;
            Some(format!("{} {} ({:.1} times)", g.name, percent(other), other / value))
        })
        .collect();
    let against = if others.is_empty() { String::new() } else { format!(", against {}", others.join(", ")) };
    let start_is_better = study.groups.first().and_then(deviation).is_some_and(|start| start < value);
    let advice = match (start_is_better, study.interrupted) {
        (true, _) => "Group 1 is better still: it lies outside the bounds or limits, or the searches were cut short.",
        (false, true) => "The searches were cut short, so this may change.",
        (false, false) => "Select with it.",
    };
    let sentence = format!(
        "Of the indices of this study the {} index gives the smallest expected error in this cell: {} on average over \
         the joints at variance factor 1{against}. {advice}",
        words(index),
        percent(value),
    );
    let severity = if start_is_better { Severity::Caution } else { Severity::Note };
    (Some(index), Some(Finding::new("recommended-index", severity, index.as_str(), sentence)))
}

/// Whether the paper's ordering of its three groups holds.
fn paper_order(study: &Study) -> Option<Finding> {
    let find = |index: Index| study.groups.iter().find(|g| g.selection.as_ref().is_some_and(|s| s.index == index));
    let start = deviation(study.groups.first()?);
    let classical = deviation(find(Index::Classical)?);
    let novel = deviation(find(Index::Novel)?);
    let than = |other: Option<f64>| match (novel, other) {
        (Some(n), Some(o)) if n < o => "better than",
        (Some(n), Some(o)) if n > o => "worse than",
        (Some(_), None) => "better than",
        (None, Some(_)) => "worse than",
        _ => "no better than",
    };
    let held = than(start) == "better than" && than(classical) == "better than";
    let show = |v: Option<f64>| v.map_or("undetermined".to_string(), percent);
    Some(Finding::new(
        "paper-order",
        if held { Severity::Note } else { Severity::Caution },
        INITIAL_GROUP,
        format!(
            "The paper's ordering of the groups {} here: the paper finds Group 3 (novel) better than Group 1 and Group \
             2 (classical); from this Group 1 the mean expected deviations are {} (Group 1), {} (Group 2), {} (Group \
             3), so Group 3 is {} Group 1 and {} Group 2.",
            if held { "holds" } else { "does not hold" },
            show(start),
            show(classical),
            show(novel),
            than(start),
            than(classical),
        ),
    ))
}

/// Names the groups whose mean rests on joints beyond the first order.
fn first_order_means(study: &Study) -> Option<Finding> {
    let beyond = |g: &StudyGroup| -> Vec<&str> {
        let errors = g.evaluation.relative_standard_error.iter().zip(&study.joints);
        errors
            .filter(|(error, _)| error.is_some_and(|e| e > FIRST_ORDER_LIMIT))
            .map(|(_, joint)| joint.as_str())
            .collect()
    };
    let named: Vec<String> = study
        .groups
        .iter()
        .filter_map(|g| {
            let joints = beyond(g);
            (!joints.is_empty()).then(|| format!("{} ({})", g.name, list(&joints)))
        })
        .collect();
    (!named.is_empty()).then(|| {
        Finding::caution(
            "first-order-means",
            "expected deviation",
            format!(
                "The mean expected deviation is a first-order figure; where a relative standard error passes 10 % it \
                 understates what the simulation gives. At variance factor 1 that concerns {}.",
                list(&named)
            ),
        )
    })
}

/// How often each index improves on other initial groups of one kind.
fn other_starts(kind: &StartsOfKind) -> Finding {
    let parts: Vec<String> = kind
        .rows
        .iter()
        .filter_map(|row| {
            let name = words(row.index?);
            let median = row.median.map_or("none determined".to_string(), percent);
            Some(format!("{name} {} of {} (median {median})", row.improved, kind.count))
        })
        .collect();
    let start = kind.rows.first().and_then(|r| r.median).map_or("undetermined".to_string(), percent);
    let order = kind.paper_order_held.map_or(String::new(), |held| {
        format!(
            " The paper's ordering, novel better than both its start and the classical group, held for {held} of {}.",
            kind.count
        )
    });
    Finding::note(
        "other-starts",
        &kind.kind,
        format!(
            "Over {} ({}), median start {start}, each index improves on its start: {}.{order}",
            match kind.count {
                1 => "one initial group".to_string(),
                count => format!("{count} initial groups"),
            },
            kind.kind,
            parts.join(", "),
        ),
    )
}

/// Name of an index in a sentence.
fn words(index: Index) -> String {
    index.as_str().replace('_', "-")
}
