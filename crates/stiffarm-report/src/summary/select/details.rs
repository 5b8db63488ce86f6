//! Certificate, prices, chosen load and sensitivity of a plan.

use super::super::postures::coarse;
use super::super::worth::index_quantity;
use crate::selection::sensitivity_figure;
use crate::summary::{Block, DataTable, Number, Quantity, Section, Text, shown};
use stiffarm::Termination;
use stiffarm::ask::select::{Plan, SelectResultOptions};
use stiffarm::findings::{list, visible};
use stiffarm::plan::select::{LimitPrice, Sensitivity, Spread, WORTH_CHANGING};

/// What the bound rests on; `None` where there is none.
pub(super) fn certificate(plan: &Plan) -> Option<Text> {
    let certificate = plan.certificate.as_ref()?;
    let (searches, agreeing) = (certificate.verification.searches, certificate.verification.agreeing);
    let mut text = Text::new(format!(
        "The bound holds for every plan of as many postures inside the cell's limits, whatever the search. It rests on \
         {searches} searches for a posture that would help more, {agreeing} of which ended at the same best one."
    ));
    if let Some(doubt) = certificate.verification.doubt() {
        text = text.words(format!(" But {doubt}."));
    }
    if certificate.termination != Termination::Converged {
        text = text.words(" It is not tight: the true limit may be somewhat higher.");
    }
    if !certificate.outside.is_empty() {
        text = text.words(" It says nothing of postures outside bounds or limits.");
    }
    Some(text)
}

/// What is measured more than once.
pub(super) fn repeats(plan: &Plan) -> Vec<Block> {
    let times = |count: usize| match count {
        2 => "twice".to_string(),
        count => format!("{count} times"),
    };
    let each = plan.repeats.iter().map(|same| {
        let names = shown(same);
        let rest = list(&names[1..]);
        Text::new(format!(
            "Measure posture {} {} (it is also {rest}): drive away in between.",
            names[0],
            times(names.len())
        ))
    });
    let each: Vec<Text> = each.collect();
    if each.is_empty() {
        return Vec::new();
    }
    let why = Text::new(
        "Against noise alone they are worth more once again than any other posture; what else may be wrong shows \
         better at another one",
    );
    let why = why.words(" (").code("--index prediction").words(").");
    vec![Block::List(each), Block::Text(why)]
}

/// What each kind of limit costs.
pub(super) fn price_table(plan: &Plan, prices: &[LimitPrice]) -> DataTable {
    let index = plan.selection.index;
    let kinds = prices.iter().map(|price| price.kind.describe());
    let rows = std::iter::once("nothing: all limits").chain(kinds);
    DataTable::of("The best plan found without each limit", "without", rows)
        .numbers(&index.in_words(), index_quantity(index), |row| {
            Some(Number::new(match row.checked_sub(1) {
                Some(p) => prices[p].value,
                None => plan.selection.value,
            }))
        })
        .numbers("cost", Quantity::PERCENT, |row| Some(Number::new(prices[row.checked_sub(1)?].price)))
}

/// The load that was chosen together with the postures, as lines of the cell file.
pub(super) fn load_section(options: &SelectResultOptions, plan: &Plan) -> Option<Section> {
    let load = plan.selection.load.as_ref()?;
    let select_options = &options.select;
    // A tenth of a millimetre is finer than anybody rigs a rope.
    let point = |m: [f64; 3]| {
        let digits = m.map(|m| coarse(m).digits());
        digits.join(", ").replace('−', "-")
    };
    let mut lines = Vec::new();
    if select_options.loading_point_box_mm.is_some() {
        lines.push("[tool]".to_string());
        lines.push(format!("loading_point_mm = [{}]", point(load.loading_point_m)));
    }
    let newtons = load.magnitude_n;
    let newtons = newtons.filter(|_| select_options.largest_load_n.is_some());
    let anchor = load.anchor_m;
    let anchor = anchor.filter(|_| select_options.anchor_box_mm.is_some());
    if newtons.is_some() || anchor.is_some() {
        lines.push("[load]".to_string());
    }
    lines.extend(newtons.map(|newtons| format!("magnitude_n = {newtons}")));
    lines.extend(anchor.map(|anchor| format!("anchor_mm = [{}]", point(anchor))));
    let lines = lines.iter().map(|line| Text::default().code(line));
    let blocks = vec![
        Block::Text("The plan holds for this load: put these lines into the cell file before anything else.".into()),
        Block::List(lines.collect()),
    ];
    let title = "The load chosen with the postures";
    Some(Section::new("load", title, blocks).in_summary())
}

/// Whether wrong assumptions would change the plan.
pub(super) fn sensitivity_section(plan: &Plan) -> Option<Section> {
    let sensitivity = plan.sensitivity.as_ref()?;
    let mut blocks = vec![Block::Text(stands(sensitivity))];
    blocks.extend(sensitivity_figure(sensitivity).map(Block::Figure));
    if !sensitivity.priors.is_empty() {
        blocks.push(Block::Table(prior_table(sensitivity)));
    }
    let options = &sensitivity.options;
    let angle = options.joint_angle_std.to_degrees();
    let point = 1e3 * options.tool_point_std;
    let spreads = [
        (format!("joint angles by {angle:.3}° (1σ)"), sensitivity.postures),
        (format!("loading and measuring points by {point:.2} mm (1σ)"), sensitivity.tool_points),
    ];
    let caption = format!(
        "How much worse the index is under random errors ({} draws); – where it does not exist in some of them",
        options.samples
    );
    let worse = |of: fn(Spread) -> f64| {
        let spreads = &spreads;
        move |row: usize| Some(Number::computed(of(spreads[row].1?) - 1.0))
    };
    let names = spreads.iter().map(|(name, ..)| name.clone());
    let table = DataTable::of(caption, "what is off", names)
        .numbers("on average", Quantity::PERCENT, worse(|spread| spread.mean))
        .numbers("at worst", Quantity::PERCENT, worse(|spread| spread.worst));
    blocks.push(Block::Table(table));
    let section = Section::new("sensitivity", "If assumptions are wrong", blocks);
    Some(section.in_summary())
}

/// Whether another plan would be better with another prior stiffness.
fn stands(sensitivity: &Sensitivity) -> Text {
    let share = 100.0 * WORTH_CHANGING;
    let unknown = sensitivity.priors.iter().find(|case| case.value.is_none());
    if sensitivity.priors.is_empty() {
        return "The index does not use the prior stiffness.".into();
    }
    if let Some(case) = unknown {
        return Text::new(format!(
            "With {} at {} times its prior stiffness the index of this plan does not exist: ",
            visible(&case.joint),
            case.factor
        ))
        .strong("another plan would be better")
        .words(".");
    }
    if sensitivity.would_change {
        return Text::new("With another prior stiffness of one joint ").strong("another plan would be better").words(
            format!(" by more than {share} %: identify with this plan, put the result into the cell, and plan again."),
        );
    }
    Text::new("With any one joint's prior stiffness changed, ")
        .strong("the plan stands")
        .words(format!(": no plan found is better by more than {share} %."))
}

/// The plan and the best one found with other prior stiffness, joint by joint.
fn prior_table(sensitivity: &Sensitivity) -> DataTable {
    let case = |row: usize| &sensitivity.priors[row];
    let quantity = index_quantity(sensitivity.index);
    let names = sensitivity.priors.iter();
    let names = names.map(|case| visible(&case.joint).into_owned());
    DataTable::of("The plan with other prior stiffness", "joint", names)
        .words("its prior k", |row| format!("× {}", case(row).factor).into())
        .numbers("this plan", quantity, |row| Some(Number::new(case(row).value)))
        .numbers("best found", quantity, |row| Some(Number::new(case(row).best)))
        .numbers("loss", Quantity::PERCENT, |row| Some(Number::new(case(row).loss)))
}
