//! What was done, what came out, what to do next.

use super::basis::left_out;
use super::counted;
use super::joints::{Joints, is_wide, is_within};
use super::readings::shortened;
use crate::level::level;
use crate::order::in_order;
use crate::summary::{Number, Quantity, Text};
use stiffarm::ask::identify::{Identified, IdentifiedOptions};
use stiffarm::estimate::diagnose::{Agreement, Diagnosis, OutlierKind};
use stiffarm::estimate::identify::{NoiseSource, Verdict, WELL_KNOWN_HALF_WIDTH, Weights};
use stiffarm::findings::{Finding, Severity, list, visible};

/// Joints without a ± whose bounds are said, and not left to the table.
const MOST_NAMED: usize = 2;
/// Residuals this many times the expected noise hold more than noise, where no test says it.
pub(in crate::summary) const MORE_THAN_NOISE: f64 = 1.5;

/// What was done.
pub(super) fn what_was_done(options: &IdentifiedOptions, identified: &Identified) -> Text {
    let estimates = &identified.identification.estimates;
    let names = identified.identification.postures.iter().map(|p| p.posture.as_str());
    let postures = in_order(names).len();
    let from = match identified.readings {
        Some(_) => "raw readings of the tracker",
        None => "measured displacements",
    };
    Text::new(format!(
        "The stiffness of {} joints was identified from {from} at {}: {} ({} components).{}",
        estimates.joints.len(),
        counted(postures, "posture"),
        counted(estimates.rows / 3, "displacement"),
        estimates.rows,
        left_out(&options.exclude),
    ))
}

/// What came out where something is so wrong that no number counts; `more` is just as serious.
pub(super) fn unusable(first: &Finding, more: usize) -> Text {
    // The first clause says what it is, the rest how it was found.
    let sentence = visible(&first.sentence).replace('`', "");
    let end = [". ", "; "].iter().filter_map(|end| sentence.find(end));
    let clause = end.min().map_or(sentence.as_str(), |end| &sentence[..end]);
    let others = match more {
        0 => String::new(),
        1 => " One more finding is as serious.".to_string(),
        count => format!(" {count} more findings are as serious."),
    };
    let clause = clause.trim_end_matches('.');
    Text::default().strong("The stiffness cannot be used").words(format!(". {clause}.{others}"))
}

/// What came out.
pub(super) fn conclusion(options: &IdentifiedOptions, joints: &Joints<'_>, identified: &Identified) -> Text {
    let certainty = match identified.systematic_errors {
        Some(_) => certainty(joints),
        None => certainty(joints).words(" ").strong("Systematic errors were not examined."),
    };
    let freed: Vec<&str> = identified.freed.iter().map(|quantity| quantity.words.as_str()).collect();
    let freed = match freed.as_slice() {
        [] => String::new(),
        freed => format!(" With it these readings gave {}.", visible(&list(freed))),
    };
    let text = residual(certainty.words(freed), options, identified);
    let mm = |length: Option<f64>| Number::new(length).of(Quantity::LENGTH);
    match identified.elastic.as_ref().filter(|elastic| elastic.is_better()) {
        Some(elastic) => text
            .words(" A posture that took no part is missed by ")
            .number(mm(elastic.mixed_rms_m))
            .words("; by ")
            .number(mm(elastic.axes_rms_m))
            .words(" if the joint axes alone gave way."),
        None => text,
    }
}

/// How well the joints are known.
pub(super) fn certainty(joints: &Joints<'_>) -> Text {
    let mut within = joints.of(is_within);
    let half = |j: &usize| joints.all()[*j].half_width.unwrap_or(f64::INFINITY);
    within.sort_by(|a, b| half(a).total_cmp(&half(b)));
    let level = level(joints.estimates.confidence);
    let with = match joints.systematic_errors {
        Some(_) => "readings and systematic errors together",
        None => "the scatter of the readings alone",
    };
    // Before any number: joints that have none.
    let missing = joints.of(|verdict| !is_within(verdict) && !is_wide(verdict));
    let text = if missing.is_empty() {
        Text::default()
    } else if missing.len() == joints.all().len() {
        return Text::default().strong("No joint has a usable value.");
    } else {
        Text::new("No usable value: ").strong(joints.names(&missing)).words(". ")
    };
    let mut text = match within.as_slice() {
        [] => text.strong("No joint's stiffness is known to better than half of it."),
        [one] => text
            .words(format!("The stiffness of {} is known to ", joints.name(*one)))
            .number(joints.total(*one).plus_minus())
            .words(format!(" ({level} %, {with}).")),
        [first, .., last] => text
            .words("The stiffness is known to ")
            .number(joints.total(*first).plus_minus())
            .words(format!(" ({}) to ", joints.name(*first)))
            .number(joints.total(*last).plus_minus())
            .words(format!(" ({}) at {level} % confidence, {with}.", joints.name(*last))),
    };
    let weak = joints.of(|verdict| verdict == Verdict::Weak);
    if !weak.is_empty() {
        text = text.words(format!(" Weak, above ± {:.0} %: {}.", 100.0 * WELL_KNOWN_HALF_WIDTH, joints.names(&weak)));
    }
    let wide = joints.of(is_wide);
    if wide.len() > MOST_NAMED {
        return text.words(format!(" No ± for {}: the table has their bounds.", joints.names(&wide)));
    }
    for j in wide {
        let (low, high) = (joints.end(j, 0), joints.end(j, 1));
        text = text.words(format!(" k of {}: ", joints.name(j)));
        text = match high.value {
            Some(_) => text.number(low.bare()).words(" to ").number(high.bare()),
            _ => text.words("only a lower bound, ").number(low.bare()),
        };
        text = text.words(format!(" · {}.", Quantity::STIFFNESS.unit));
    }
    text
}

/// Whether the residual is noise.
fn residual(text: Text, options: &IdentifiedOptions, identified: &Identified) -> Text {
    let identification = &identified.identification;
    let mixed = identified.mixed().and_then(|elastic| elastic.mixed.as_ref());
    // The test is of what the axes alone leave.
    let test = identified.diagnosis.as_ref().and_then(|d| d.noise.as_ref());
    let test = test.filter(|_| mixed.is_none());
    let total_std_m = match mixed {
        Some(mixed) => Some(mixed.total_std_m),
        None => identification.total_std_m,
    };
    let (std, expected) = match test {
        Some(test) => (Some(test.residual_std_m), test.expected_std_m),
        None => (total_std_m, identification.expected_std_m),
    };
    let mm = |length: Option<f64>| Number::new(length).of(Quantity::LENGTH);
    if identification.estimates.degrees_of_freedom == 0 {
        return text.words(" No degree of freedom is left: nothing checks the model, and there are no intervals.");
    }
    if identification.expected_std_m <= 0.0 {
        return text
            .words(" What the fit leaves has a standard deviation of ")
            .number(mm(std))
            .words("; the cell states no noise to compare it with.");
    }
    let ratio = match test {
        Some(test) => Number::new(test.ratio),
        None => Number::computed(total_std_m.map(|s| s / identification.expected_std_m)),
    };
    if options.fit.weights == Weights::Tracker {
        // Sizes are in units of what the tracker states, which differ from reading to reading.
        return text
            .words(" What the fit leaves is ")
            .number(ratio.significant(2))
            .words(" times what the tracker's uncertainty explains.");
    }
    let agreement = match (test, total_std_m) {
        (Some(test), _) => test.agreement,
        (None, Some(std)) if std > MORE_THAN_NOISE * identification.expected_std_m => Agreement::Larger,
        _ => Agreement::Agrees,
    };
    let numbers = |text: Text| {
        text.words("a standard deviation of ")
            .number(mm(std))
            .words(" against ")
            .number(mm(Some(expected)))
            .words(" expected")
    };
    match agreement {
        Agreement::Agrees => numbers(text.words(" What the fit leaves looks like noise: ")).words("."),
        Agreement::Smaller => numbers(text.words(" What the fit leaves is less than the stated noise: ")).words("."),
        Agreement::Larger => {
            let text = text.words(" What the fit leaves is ").strong("not noise alone").words(": ");
            let text = numbers(text).words(", ").number(ratio.significant(2)).words(" times as much.");
            match identification.estimates.noise {
                NoiseSource::Known => text.words(" The intervals rest on the cell's noise and are too narrow."),
                _ => text,
            }
        }
    }
}

/// What to do next.
pub(super) fn next_step(options: &IdentifiedOptions, joints: &Joints<'_>, identified: &Identified) -> Text {
    let fault = identified.screening().and_then(|screening| {
        let mut both = screening.suspicions.iter().zip(&screening.findings);
        both.find(|(_, finding)| finding.severity == Severity::Serious)
    });
    if let Some((fault, _)) = fault.filter(|_| joints.unusable) {
        let lines: Vec<String> = fault.lines.iter().map(usize::to_string).collect();
        let lines = match lines.as_slice() {
            [] => String::new(),
            [one] => format!(" (line {one})"),
            several => format!(" (lines {})", shortened(several)),
        };
        return Text::default()
            .strong(format!("Correct the table first{lines}"))
            .words(", then identify again; until then the numbers here are not to be used.");
    }
    if joints.unusable {
        return Text::default()
            .strong("Settle what is marked serious first")
            .words(", then identify again; until then the numbers here are not to be used.");
    }
    let negative = joints.of(|verdict| verdict == Verdict::SignOrModelFault);
    if !negative.is_empty() {
        return Text::default()
            .strong("Check the sign of the force")
            .words(" (on the robot), the frames and the model, then identify again.");
    }
    if identified.systematic_errors.is_none() {
        let text = if options.brief {
            Text::new("Identify again without ").code("--brief")
        } else {
            Text::new("Identify again")
        };
        return text.words(
            ": that adds the systematic errors, the search for readings that do not fit, and the next posture to \
             measure.",
        );
    }
    let missing = joints.of(|verdict| !is_within(verdict));
    // What is left without the outliers is the model's.
    let left = identified.diagnosis.as_ref().and_then(|d| {
        let without = d.outliers.noise_without.as_ref();
        without.or(d.noise.as_ref())
    });
    let larger = left.is_some_and(|test| test.agreement == Agreement::Larger);
    // No posture under this load tells them.
    let next_step = identified.next_posture.as_ref();
    let never = |j: usize| next_step.is_some_and(|next_step| next_step.after.get(j).copied().flatten().is_none());
    // A joint without a value comes before how well the others fit.
    let mut blind = joints.of(|verdict| matches!(verdict, Verdict::Undetermined | Verdict::NotByItself));
    blind.retain(|j| !never(*j));
    if larger && identified.elastic.is_none() && blind.is_empty() {
        return Text::new("Identify again with ")
            .code("--elastic mixed")
            .words(": more than the joint axes may give way. Then ")
            .code("stiffarm validate")
            .words(" on postures that were held out.");
    }
    let outlier = identified.diagnosis.as_ref().and_then(|d| d.outliers.found.first());
    if let Some(outlier) = outlier.filter(|_| blind.is_empty()) {
        let what = match (outlier.kind, &outlier.posture, &outlier.point) {
            (OutlierKind::Point, _, Some(point)) => {
                let text = Text::new("Look at measuring point ").strong(visible(point));
                return text.words(
                    ": it contradicts the others. Check its place on the tool, correct the cell or leave its readings \
                     out, and identify again.",
                );
            }
            (_, Some(posture), _) => posture,
            _ => "",
        };
        return Text::new("Measure posture ")
            .strong(visible(what))
            .words(" again, or leave it out with ")
            .code(format!("--exclude {}", visible(what)))
            .words(" and see what changes: it contradicts the others.");
    }
    let doubted = identified.diagnosis.as_ref().and_then(Diagnosis::doubted);
    if let Some(doubted) = doubted.filter(|_| blind.is_empty()) {
        return Text::new("Settle the doubt about ")
            .code(visible(&doubted.subject))
            .words(": until then every ± holds what the readings ask for.");
    }
    let weak = joints.of(|verdict| verdict == Verdict::Weak);
    // Of those that another posture helps; what the load never turns stays open.
    let error = |all: &[Option<f64>], j: usize| all.get(j).copied().flatten();
    let helped = identified.next_posture.as_ref().and_then(|advice| {
        let fallen = |j: &usize| {
            let before = error(&advice.before, *j);
            Some((*j, error(&advice.after, *j)? / before.unwrap_or(f64::INFINITY)))
        };
        let joints = missing.iter().chain(&weak).filter_map(fallen);
        let most = joints.min_by(|a, b| a.1.total_cmp(&b.1));
        most.map(|(j, _)| (advice, j))
    });
    if let Some((advice, j)) = helped {
        let text = Text::new("Measure one more posture: q = ");
        let text = angles(text, &advice.angles);
        let at = |all: &[Option<f64>]| Number::new(error(all, j)).of(Quantity::PERCENT);
        let before = at(&advice.before);
        let text = text.words(format!("; it takes the standard error of {}", joints.name(j)));
        let text = match before.value {
            Some(_) => text.words(" by the readings from ").number(before),
            None => text.words(" by the readings from unknown"),
        };
        return text.words(" to ").number(at(&advice.after)).words(".");
    }
    if !missing.is_empty() && missing.iter().all(|j| never(*j)) {
        return Text::new("No posture under this load tells ")
            .strong(joints.names(&missing))
            .words(": measure under one from another side as well, or go on with the others: ")
            .code("stiffarm validate")
            .words(" compares what they predict with what is measured.");
    }
    if !missing.is_empty() {
        return Text::default()
            .code("stiffarm check")
            .words(" of the cell looks for the reason why ")
            .strong(joints.names(&missing))
            .words(" cannot be told; other postures or loads may show it.");
    }
    Text::new("Validate on postures that took no part: ")
        .code("stiffarm validate")
        .words(" compares what this stiffness predicts with what is measured there.")
}

/// The angles of the next posture.
pub(super) fn angles(text: Text, angles: &[f64]) -> Text {
    let angles = angles.iter().map(|q| Number::degrees(*q).of(Quantity::ANGLE.bare()));
    text.words("(").numbers(angles).words(")°")
}
