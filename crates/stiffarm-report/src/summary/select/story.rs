//! The story of a plan in three sentences.

use super::super::worth::{index_number, is_beyond_first_order, least_sure};
use crate::summary::{Context, Number, Quantity, Text};
use stiffarm::Termination;
use stiffarm::ask::select::{InTime, Mode, Plan, SelectResultOptions};
use stiffarm::findings::{Severity, codes, minutes, visible};
use stiffarm::model::cell::MeasuringTime;
use stiffarm::plan::index::Index;
use stiffarm::plan::select::different;

/// Below this share of what is possible a longer search is worth its time.
const WORTH_SEARCHING: f64 = 0.9;

/// What was done, what came out, what to do next.
pub(super) fn verdict(options: &SelectResultOptions, context: &Context<'_>, plan: &Plan) -> [Text; 3] {
    [what_was_done(options, plan), conclusion(context, plan), next_step(plan)]
}

/// `12 postures (11 different)`.
pub(super) fn counted(plan: &Plan) -> String {
    let count = plan.selection.group.len();
    match (count, different(count, &plan.repeats)) {
        (1, _) => "One posture".to_string(),
        (_, all) if all == count => format!("{count} postures"),
        (_, some) => format!("{count} postures ({some} different)"),
    }
}

/// What of the plan sits on a limit.
fn on_limits(plan: &Plan) -> String {
    let codes = [codes::ON_MACHINE_LIMIT, codes::NO_ROOM_TO_SPARE, codes::HIDDEN_POINTS];
    let findings = plan.findings.iter();
    let findings = findings.filter(|f| codes.contains(&f.code.as_str()));
    findings.map(|f| format!(" {}", visible(&f.sentence))).collect()
}

fn what_was_done(options: &SelectResultOptions, plan: &Plan) -> Text {
    let count = plan.selection.group.len();
    let were = if count == 1 { "was" } else { "were" };
    if options.mode == Mode::From {
        return Text::new(format!(
            "The initial group of {count} {} was improved, as in the paper, by a local search inside the cell's \
             limits.",
            if count == 1 { "posture" } else { "postures" }
        ));
    }
    let beside = match plan.given_names.len() {
        0 => String::new(),
        1 => " beside one given posture".to_string(),
        number => format!(" beside {number} given ones"),
    };
    let searches = match plan.selection.rounds {
        Some(rounds) if rounds != 1 => {
            format!("{} local searches in {rounds} rounds", plan.selection.starts)
        }
        _ => format!("{} local searches", plan.selection.starts),
    };
    let ended = match plan.selection.termination {
        Termination::Converged => ", until nothing improved any more",
        Termination::Interrupted => ", which were interrupted",
        Termination::TimeLimit => ", until the time was over",
        _ => "",
    };
    let text =
        Text::new(format!("{}{beside} {were} chosen inside the cell's limits by {searches}{ended}.", counted(plan)));
    let is_cut = matches!(plan.selection.termination, Termination::Interrupted | Termination::TimeLimit);
    match plan.selection.rounds {
        Some(0) if is_cut => text.words(" It was stopped in the first round, which cannot be repeated."),
        Some(rounds) if is_cut => {
            let again = format!("--rounds {rounds}");
            text.words(" ").code(again).words(" repeats it.")
        }
        Some(_) if plan.selection.index.has_many_local_minima() => {
            text.words(" This index has many local minima: another ").code("--seed").words(" may find a better plan.")
        }
        _ => text,
    }
}

/// What measuring the plan takes.
fn takes(context: &Context<'_>, plan: &Plan) -> String {
    let count = plan.selection.group.len();
    if plan.time_s <= 0.0 || count == 0 {
        return String::new();
    }
    let loads = chosen_in_time(plan).map_or_else(String::new, |(_, way)| under(&way.loads));
    let assumed = context.cell.filter(|cell| cell.time == MeasuringTime::default());
    let how = assumed.map_or_else(String::new, |cell| {
        let each = minutes(cell.time.of_posture(&cell.setup.load));
        format!(", at an assumed {each} a posture ([time])")
    });
    let what = match (count, plan.in_time.is_empty()) {
        (1, _) => "it".to_string(),
        (_, true) => "them".to_string(),
        (count, false) => format!("{count} postures"),
    };
    format!(" Measuring {what}{loads} takes {}{how}.", minutes(plan.time_s))
}

/// The way to load the arm that a plan for a given time takes, with its position.
fn chosen_in_time(plan: &Plan) -> Option<(usize, &InTime)> {
    let mut ways = plan.in_time.iter().enumerate();
    ways.find(|(_, way)| way.further_mass_kg.is_none())
}

/// ` under rope and then weight`.
fn under(loads: &[String]) -> String {
    if loads.is_empty() {
        return String::new();
    }
    let names: Vec<_> = loads.iter().map(|name| visible(name)).collect();
    format!(" under {}", names.join(" and then "))
}

fn conclusion(context: &Context<'_>, plan: &Plan) -> Text {
    let index = plan.selection.index;
    let mut text = Text::new(index.says()).number(index_number(index, plan.selection.value));
    let range = plan.evaluation.indices.prediction_range;
    if let (Index::Prediction, Some([low, high])) = (index, range) {
        text = text
            .words(" (")
            .number(index_number(index, low))
            .words(" to ")
            .number(index_number(index, high))
            .words(" where what gives way beyond the axes is a third or three times as large as expected)");
    }
    let before = plan.before.as_ref();
    if let Some(before) = before {
        let name = if plan.given_names.is_empty() { "the initial group" } else { "the given postures alone" };
        text = match before.evaluation.indices.get(index) {
            Some(value) => text.words(", against ").number(index_number(index, value)).words(format!(" with {name}")),
            None => text.words(format!("; {name} cannot determine every joint")),
        };
    }
    text = text.words(".");
    if let Some(certificate) = &plan.certificate
        && let Some(efficiency) = certificate.efficiency
    {
        let further = if certificate.measured_count > 0 { " further" } else { "" };
        text = text
            .words(format!(" No plan of as many{further} postures can be below "))
            .number(index_number(index, certificate.bound));
        // That bound is of plans that may measure fractions of a posture, which few postures are far from.
        text = if index == Index::Prediction {
            text.words(".")
        } else {
            text.words(": this one reaches ")
                .number(Number::new(efficiency).of(Quantity::SHARE))
                .words(" of what is possible.")
        };
    }
    if let Some(why) = &plan.certificate_missing {
        text = text.words(format!(" What no plan can go below is not known in full: {}.", visible(why)));
    }
    let least = least_sure(&plan.evaluation, &plan.joints);
    text.then(least).words(takes(context, plan)).then(in_time(plan)).then(further_load(plan)).words(on_limits(plan))
}

/// What the other ways to load the arm would bring in the same time.
fn in_time(plan: &Plan) -> Text {
    let mut text = Text::default();
    let Some((chosen, _)) = chosen_in_time(plan) else {
        return text;
    };
    let others = plan.in_time.iter().enumerate();
    for (_, way) in others.filter(|(i, _)| *i != chosen) {
        let is_first = text == Text::default();
        text = text.words(match (is_first, way.postures) {
            (true, 1) => " In the same time one posture".to_string(),
            (true, count) => format!(" In the same time {count} postures"),
            (false, 1) => "; one".to_string(),
            (false, count) => format!("; {count}"),
        });
        text = match way.further_mass_kg {
            Some(mass) => text
                .words(format!(", a weight of {mass:.0} kg hung in each as well (a second "))
                .code("[[load.case]]")
                .words("), would give "),
            None => text.words(format!("{} would give ", under(&way.loads))),
        };
        text = text.number(index_number(Index::Prediction, way.prediction));
    }
    if text == Text::default() { text } else { text.words(".") }
}

/// What a second load would bring.
fn further_load(plan: &Plan) -> Text {
    // For a given time that is said already, with fewer postures.
    let said = plan.in_time.iter().any(|way| way.further_mass_kg.is_some());
    let Some(further) = plan.further_load.as_ref().filter(|_| !said) else {
        return Text::default();
    };
    let of = |error: f64| index_number(Index::Prediction, error);
    Text::new(format!(" A weight of {:.0} kg hung in the same postures as well (a second ", further.mass_kg))
        .code("[[load.case]]")
        .words(format!(", {} more) would bring the error of the deflection at work from ", minutes(further.time_s)))
        .number(of(further.without))
        .words(" to ")
        .number(of(further.with))
        .words(".")
}

/// What to do depends on what is worst about the plan.
fn next_step(plan: &Plan) -> Text {
    let is_blocked = plan.findings.iter().any(|f| f.code == codes::MOVE_BLOCKED && f.severity == Severity::Serious);
    if is_blocked {
        return Text::new(
            "Teach a way of your own for the moves that are not free, listed below, before driving; then measure.",
        );
    }
    if plan.selection.load.is_some() {
        return Text::new(
            "Rig the load as listed below and put it into the cell file first: the plan holds for it alone. Then \
             measure.",
        );
    }
    if is_beyond_first_order(&plan.evaluation) {
        let index = plan.selection.index;
        if !index.is_relative_error() && !index.is_length() {
            return Text::new("That is too unsure to rely on, for this index does not count errors: choose with ")
                .code("--index expected-error")
                .words(" instead.");
        }
        return Text::new("That is too unsure to rely on: add postures (")
            .code("--count")
            .words(") or measuring points, pull harder or elsewhere, and look at what each limit costs (")
            .code("--prices")
            .words(").");
    }
    let efficiency = plan.certificate.as_ref().and_then(|certificate| certificate.efficiency);
    let is_loose = efficiency.is_some_and(|share| share < WORTH_SEARCHING) && plan.selection.index != Index::Prediction;
    let is_short = !matches!(plan.selection.termination, Termination::Converged);
    if is_loose && is_short && plan.selection.rounds.is_some() {
        return Text::new("A longer search may find a better plan: give more ")
            .code("--rounds")
            .words(", or leave them out; or measure with this one.");
    }
    let mut text = Text::new("Drive to the postures in this order, fill in the sheet for the readings (")
        .code("--sheet measurements.xlsx")
        .words("), and let ");
    text = text.code("stiffarm identify").words(" give the stiffness.");
    if !plan.repeats.is_empty() {
        text = text.words(
            " Some postures are the same on purpose, listed with the moves: measured again, they tell more than \
             another one; drive away in between.",
        );
    }
    text
}
