//! What a comparison says in three sentences.

use super::Kind;
use super::agreement::StiffnessChange;
use crate::page::{Number, Outcome, Part, Text};
use stiffarm::findings::list;

/// Most names and differences in a sentence.
const MOST_NAMES: usize = 4;

/// What is compared, how far it differs, what to do next.
pub(super) fn verdict(parts: &[Part], kinds: &[Kind<'_>]) -> [Text; 3] {
    [what_was_done(parts, kinds), conclusion(kinds), next_step(parts, kinds)]
}

/// What is compared, and what was different in making it.
fn what_was_done(parts: &[Part], kinds: &[Kind<'_>]) -> Text {
    let names: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
    let mut out = if names.len() <= MOST_NAMES {
        format!("{} are compared: ", list(&names))
    } else {
        format!("{} results are compared: ", names.len())
    };
    let counts = kinds.iter().map(|kind| match kind.parts.len() {
        1 => format!("1 result of {}", kind.command),
        many => format!("{many} results of {}", kind.command),
    });
    let counts: Vec<String> = counts.collect();
    out += &list(&counts);
    out.push('.');
    for kind in kinds.iter().filter(|kind| kind.parts.len() > 1) {
        let these = match kinds.len() {
            1 => "They".to_string(),
            _ => format!("Those of {}", kind.command),
        };
        let made = kind.made.rows.iter().filter_map(|row| row.first());
        let made: Vec<String> = made.map(Text::plain).collect();
        out += &match made.len() {
            0 => format!(" {these} were made in the same way."),
            few if few <= MOST_NAMES => {
                format!(" {these} differ in {}.", list(&made))
            }
            many => format!(" {these} differ in {many} inputs and options."),
        };
    }
    Text::from(out)
}

/// How far results of one command differ.
fn conclusion(kinds: &[Kind<'_>]) -> Text {
    let compared = kinds.iter().filter(|kind| kind.parts.len() > 1);
    let numbers: Vec<_> = compared.filter_map(|kind| kind.numbers.as_ref()).collect();
    if numbers.is_empty() {
        return Text::new("They answer different questions: no number stands in two of them.");
    }
    let mut out = Text::default();
    for change in numbers.iter().filter_map(|numbers| numbers.stiffness.as_ref()) {
        out = stiffness(out, change);
    }
    let differ: usize = numbers.iter().map(|numbers| numbers.differ).sum();
    let all: usize = numbers.iter().map(|numbers| numbers.table.rows.len()).sum();
    match differ {
        0 => out.words(format!("All {all} numbers of the key tables are the same.")),
        _ => out.words(format!("{differ} of {all} numbers of the key tables differ.")),
    }
}

fn stiffness(out: Text, most: &StiffnessChange) -> Text {
    let percent = |value: f64| {
        let number = Number::computed(100.0 * value).significant(2);
        format!("{} %", number.digits())
    };
    let (change, allowed) = (percent(most.change), percent(most.allowed));
    let joint = most.joint.replace(' ', "\u{a0}");
    let pair = {
        let [first, other] = &most.names;
        format!("{other} against {first}")
    };
    match (most.change == 0.0, most.is_beyond()) {
        (true, _) => out.words("The joint stiffness is the same. "),
        (false, true) => out.words(format!("The stiffness of {joint} differs by ")).strong(change).words(format!(
            ", beyond the {allowed} that the errors of both explain ({pair}): they contradict each other. "
        )),
        (false, false) => out
            .words("The joint stiffness differs by at most ")
            .strong(change)
            .words(format!(" ({joint}, {pair}), within the {allowed} that the errors of both explain. ")),
    }
}

/// What to do with them.
fn next_step(parts: &[Part], kinds: &[Kind<'_>]) -> Text {
    let serious = parts.iter().filter(|part| part.outcome == Outcome::Serious);
    let serious: Vec<&str> = serious.map(|part| part.name.as_str()).collect();
    match serious.as_slice() {
        [] => {}
        [one] => {
            return Text::default()
                .strong(format!("Do not use {one} as it is"))
                .words(": the verdict of its part says why and what to do.");
        }
        several => {
            let words = format!("Do not use {} as they are", list(several));
            return Text::default().strong(words).words(": the verdicts of their parts say why and what to do.");
        }
    }
    let numbers = kinds.iter().filter_map(|kind| kind.numbers.as_ref());
    let mut changes = numbers.filter_map(|numbers| numbers.stiffness.as_ref());
    if changes.any(StiffnessChange::is_beyond) {
        return Text::new("Hold each against readings that none of them has used: ")
            .code("stiffarm validate")
            .words(" says which one describes the arm.");
    }
    Text::new("Each has its own part below, with its verdict and the command that makes it again.")
}
