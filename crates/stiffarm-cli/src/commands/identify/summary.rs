//! What fits a screen: how well each joint is known, what stands in the way, and
//! what that rests on.

use super::readings::marked;
use super::{messages, tables};
use crate::input::Line;
use crate::numbers::{NONE, significant, stiffness};
use crate::screen::{columns, wrapped};
use crate::table::{Align, Table, yellow};
use stiffarm::estimate::identified::Identified;
use stiffarm::estimate::identify::{Fit, JointEstimate, NO_LONGER, Verdict, implausible_scale};
use stiffarm::estimate::systematic::{JointUncertainty, SystematicErrors, SystematicSource};
use stiffarm::files::source::NamedCell;
use stiffarm::findings::{Finding, Severity, list};
use stiffarm::measure::is_of_table;

/// Cautions that the summary says; the others are counted.
const MOST_CAUTIONS: usize = 4;

/// The verdict, the table, and a handful of sentences.
pub(super) fn summary(
    named: &NamedCell,
    fit: &Fit,
    result: &Identified,
    excluded: &[String],
    details: bool,
) -> String {
    let (measured, found) = (fit.measured(), &result.identification);
    let columns = columns();
    let mut out = String::new();
    let mut say = |text: &str| {
        for line in text.lines() {
            out += &format!("{}\n", wrapped(line, columns));
        }
    };
    // Before any number: what makes numbers meaningless.
    let combined = !found.estimates.combinations.is_empty();
    say(&messages::undetermined(
        &found.estimates.undetermined_joints,
        combined,
    ));
    let is_serious = |f: &&Finding| f.severity == Severity::Serious;
    let scales: Vec<&Finding> = measured.screening.iter().flat_map(|s| s.scales()).collect();
    let named_scale = scales.iter().any(is_serious);
    if scales.is_empty() || details {
        say(&messages::collinear(&found.estimates.collinear));
    }
    say(&messages::stopped(&result.not_computed));
    // What a scale explains is no finding of its own.
    let implausible = implausible_scale(fit.cell(), found).filter(|_| scales.is_empty());
    let diagnosed = result.diagnosis.iter().flat_map(|d| &d.findings);
    let budget = result.budget.iter().flat_map(|b| &b.findings);
    let profiled = result.profile.iter().map(|p| &p.finding);
    let computed: Vec<&Finding> = match named_scale {
        true => Vec::new(),
        false => diagnosed.chain(budget).chain(profiled).collect(),
    };
    let all = measured.findings().chain(computed.iter().copied());
    let serious: Vec<&Finding> = implausible.iter().chain(all.filter(is_serious)).collect();
    serious.iter().for_each(|f| say(marked(f).trim_end()));
    scales
        .iter()
        .filter(|f| !is_serious(f))
        .for_each(|f| say(marked(f).trim_end()));
    if !serious.is_empty() {
        say("Not to be used before this is settled; from the data as they are:");
    }
    say(&verdict(result));
    out += &format!("\n{}", table(result));
    if !details {
        // With details they stand below the intervals.
        out += &tables::further(&found.estimates);
        if let Some(bootstrap) = &result.bootstrap {
            out += &format!("\n{}", tables::bootstrap(bootstrap));
        }
    }
    out.push('\n');
    if let Some(elastic) = &result.elastic {
        out += super::elastic::elastic(elastic, fit.options().confidence).trim_start_matches('\n');
    }
    let mut say = |text: &str| out += &format!("{}\n", wrapped(text, columns));
    say(&messages::residual(found));
    for joint in &found.estimates.joints {
        if joint.verdict == Verdict::SignOrModelFault {
            messages::trouble(joint, found.estimates.confidence)
                .iter()
                .for_each(|text| say(text));
        }
    }
    if !details {
        let of_table = measured.findings().filter(|f| is_of_table(f));
        of_table.for_each(|f| say(marked(f).trim_end()));
        messages::resampled(result)
            .iter()
            .for_each(|text| say(text));
        let is_caution = |f: &&Finding| f.severity == Severity::Caution;
        let cautions: Vec<&Finding> = measured
            .findings()
            .chain(computed)
            .filter(is_caution)
            .filter(|f| !scales.contains(f))
            .collect();
        let shown = cautions.iter().take(MOST_CAUTIONS);
        shown.for_each(|f| say(marked(f).trim_end()));
        let more = cautions.len().saturating_sub(MOST_CAUTIONS);
        if more > 0 {
            say(&format!(
                "{}: {more} more, with --details",
                yellow("caution")
            ));
        }
    }
    if named_scale && result.diagnosis.is_some() {
        say(
            "What the fit says besides mostly follows from the scale: settle that first; --details shows it.",
        );
    }
    for remark in messages::remarks(fit.cell(), &measured.postures, result) {
        say(&format!("{}: {remark}", yellow("note")));
    }
    if let Some(budget) = &result.budget {
        assumed(budget).iter().for_each(|text| say(text));
    }
    let data = named.line() + &messages::data(&measured.postures, found, excluded);
    for line in data.lines() {
        out += &format!("{}\n", wrapped(line, columns));
    }
    if !details {
        let rest = match result.budget {
            Some(_) => {
                "--details shows the rest: intervals, budget of systematic errors, what each joint carries, \
                 further terms, largest residuals, next posture."
            }
            None => "--details shows the rest: intervals and largest residuals.",
        };
        out += &format!("{}\n", wrapped(rest, columns));
    }
    out
}

/// What is known of one joint: half width relative to k, or the interval.
#[derive(Debug, PartialEq)]
enum Known {
    /// ± this fraction of k.
    Within(f64),
    /// From here to there \[N·m/rad\].
    Between(f64, f64),
    /// Above this \[N·m/rad\].
    Above(f64),
    /// No number means anything.
    Not,
}

fn known(joint: &JointEstimate) -> Known {
    match (joint.half_width, joint.interval) {
        (Some(part), _) if part < NO_LONGER => Known::Within(part),
        (_, [Some(low), Some(high)]) => Known::Between(low, high),
        (_, [Some(low), None]) => Known::Above(low),
        _ => Known::Not,
    }
}

fn uncertainty(result: &Identified, j: usize) -> Option<&JointUncertainty> {
    result.budget.as_ref().and_then(|b| b.uncertainty.get(j))
}

/// How well the joints are known, in a sentence.
fn verdict(result: &Identified) -> String {
    let estimates = &result.identification.estimates;
    let joints = estimates.joints.iter();
    let all: Vec<(&str, Known)> = joints
        .map(|joint| (joint.name.as_str(), known(joint)))
        .collect();
    let mut within: Vec<(&str, f64)> = all
        .iter()
        .filter_map(|(name, known)| match known {
            Known::Within(part) => Some((*name, *part)),
            _ => None,
        })
        .collect();
    within.sort_by(|a, b| a.1.total_cmp(&b.1));
    let from = match result.budget {
        Some(_) => "readings and systematic errors together",
        None => "the scatter of the readings alone",
    };
    let level = messages::confidence(estimates.confidence);
    let mut out = match within.as_slice() {
        [] => "No joint's stiffness is known to better than half of it.".to_string(),
        [(name, part)] => format!("The stiffness of {name} is known to ± {} %", short(*part)),
        [(first, best), .., (last, worst)] => format!(
            "Joint stiffness known to ± {} % ({first}) to ± {} % ({last})",
            short(*best),
            short(*worst)
        ),
    };
    if !within.is_empty() {
        out += &format!(" at {level} % confidence; {from}.");
    }
    let ends: Vec<String> = all
        .iter()
        .filter_map(|(name, known)| match known {
            Known::Between(low, high) => Some(format!(
                "{name}: {} to {} N·m/rad",
                stiffness(*low),
                stiffness(*high)
            )),
            Known::Above(low) => Some(format!(
                "{name}: only a lower bound, {} N·m/rad",
                stiffness(*low)
            )),
            _ => None,
        })
        .collect();
    if !ends.is_empty() {
        out += &format!(" {}.", ends.join("; "));
    }
    let unknown = all.iter().filter(|(_, known)| *known == Known::Not);
    let unknown: Vec<&str> = unknown.map(|(name, _)| *name).collect();
    match unknown.is_empty() {
        true => out,
        false => format!("{out} No usable value for {}.", list(&unknown)),
    }
}

/// A fraction in percent with two digits.
fn short(fraction: f64) -> String {
    significant(100.0 * fraction, 2)
}

/// A row per joint.
fn table(result: &Identified) -> Table {
    let estimates = &result.identification.estimates;
    let level = messages::confidence(estimates.confidence);
    let mut headings = vec![
        "joint".to_string(),
        "k [N·m/rad]".to_string(),
        format!("± {level} % [%]"),
    ];
    let budget = result.budget.as_ref();
    if budget.is_some() {
        headings.extend(["readings [%]", "systematic [%]"].map(String::from));
    }
    headings.push(if budget.is_some() { "most of it" } else { "" }.to_string());
    // Words stand in the last column.
    let words = headings.len() - 1;
    let mut table = Table::new(headings);
    table.align(words, Align::Left);
    for (j, joint) in estimates.joints.iter().enumerate() {
        let own = uncertainty(result, j);
        let total = match known(joint) {
            Known::Within(part) => short(part),
            _ => NONE.to_string(),
        };
        let value = joint.stiffness.map_or_else(|| NONE.to_string(), stiffness);
        let mut row = vec![joint.name.clone(), value, total];
        let fault = match joint.verdict {
            Verdict::Undetermined => "undetermined",
            Verdict::SignOrModelFault => "sign or model fault",
            _ => "",
        };
        if let (Some(own), Some(budget)) = (own, budget) {
            let part = |part: Option<f64>| {
                let part = part.filter(|p| *p < 1.0);
                part.map_or_else(|| NONE.to_string(), short)
            };
            row.push(part(own.statistical));
            row.push(part(own.systematic));
            row.push(largest(own, budget));
        }
        if !fault.is_empty() {
            row.truncate(words);
            row.resize(words, NONE.to_string());
            row.push(fault.to_string());
        }
        table.row(row);
    }
    table
}

/// The source that contributes most, with a star where its size is assumed.
fn largest(own: &JointUncertainty, budget: &SystematicErrors) -> String {
    let name = own.largest_source.as_ref();
    let source = budget.sources.iter().find(|s| Some(&s.name) == name);
    source.map_or_else(String::new, |source| {
        let star = if source.declared { "" } else { " *" };
        format!("{}{star}", source.name.replace('-', " "))
    })
}

/// Sizes that nobody declared.
fn assumed(budget: &SystematicErrors) -> Option<String> {
    let assumed = budget.sources.iter().filter(|s| !s.declared);
    let words = |source: &SystematicSource| {
        let name = source.name.replace('-', " ");
        format!("{name} {}", tables::size_in_words(source))
    };
    let sizes: Vec<String> = assumed.map(words).collect();
    let said = format!(
        "* Assumed, not declared in [uncertainty]: {}.",
        list(&sizes)
    );
    (!sizes.is_empty()).then_some(said)
}
