//! Certificate, prices, chosen load and sensitivity of a plan.

use super::super::worth::index_number;
use super::planned::Plan;
use crate::selection::{IndexUnit, index_name, sensitivity_figure};
use crate::tell::Given;
use crate::tell::{Block, DataTable, Section, Text};
use stiffarm::Termination;
use stiffarm::findings::{list, visible};
use stiffarm::plan::select::{LimitPrice, Spread, WORTH_CHANGING};

/// What the bound rests on; `None` where nobody wanted one.
pub(super) fn certificate(plan: &Plan) -> Option<Text> {
    if let Some(why) = &plan.certificate_missing {
        return Some(Text::new(format!(
            "What no plan can go below is not known in full: {}.",
            visible(why)
        )));
    }
    let found = plan.certificate.as_ref()?;
    let (searches, agreeing) = (found.verification.searches, found.verification.agreeing);
    let mut text = Text::new(format!(
        "The bound holds for every plan of as many postures inside the cell's limits, whatever the search. It rests on \
         {searches} searches for a posture that would help more, {agreeing} of which ended at the same best one."
    ));
    if let Some(doubt) = found.verification.doubt() {
        text = text.words(format!(" But {doubt}."));
    }
    if found.termination != Termination::Converged {
        text = text.words(" It is not tight: the true limit may be somewhat higher.");
    }
    if !found.outside.is_empty() {
        text = text.words(" It says nothing of postures outside bounds or limits.");
    }
    Some(text)
}

/// What is measured more than once.
pub(super) fn repeats(plan: &Plan) -> Option<Block> {
    let each: Vec<Text> = plan
        .repeats
        .iter()
        .map(|same| {
            let names: Vec<String> = same.iter().map(|n| visible(n).into_owned()).collect();
            Text::new(format!("Postures {} are the same.", list(&names)))
        })
        .collect();
    (!each.is_empty()).then_some(Block::List(each))
}

/// What each kind of limit costs.
pub(super) fn price_table(context: &Given<'_>, plan: &Plan, prices: &[LimitPrice]) -> DataTable {
    let index = plan.selection.index;
    let unit = match IndexUnit::of(index).unit {
        "" => String::new(),
        unit => format!(" [{unit}]"),
    };
    let heading = format!("{}{unit}", index_name(index));
    let mut table = DataTable::new(
        "The best plan found without each limit",
        ["without".to_string(), heading, "cost [%]".to_string()],
    );
    let own = index_number(context, index, "/value").bare();
    table.row("nothing: all limits", [own.into(), Text::default()]);
    for (p, price) in prices.iter().enumerate() {
        let value = index_number(context, index, &format!("/prices/{p}/value")).bare();
        let cost = context
            .number(&format!("/prices/{p}/price"))
            .percent()
            .bare();
        let cells = [value.into(), cost.decimals(2).into()];
        table.row(price.kind.describe(), cells);
    }
    table
}

/// The load that was chosen together with the postures.
pub(super) fn load_section(context: &Given<'_>, plan: &Plan) -> Option<Section> {
    let load = plan.selection.load.as_ref()?;
    let mut table = DataTable::new(
        "The load that the plan holds for: put it into cell.toml",
        ["", "x [mm]", "y [mm]", "z [mm]"],
    );
    let mut point = |name: &str, key: &str| {
        let cells = (0..3).map(|i| {
            let number = context.number(&format!("/load/{key}/{i}"));
            Text::from(number.mm().bare().decimals(1))
        });
        table.row(name, cells);
    };
    if load.anchor_m.is_some() {
        point("anchor, base axes", "anchor_m");
    }
    point("loading point, flange axes", "loading_point_m");
    let mut blocks = vec![Block::Table(table)];
    if load.magnitude_n.is_some() {
        let size = context.number("/load/magnitude_n").unit("N");
        blocks.push(Block::Text(
            Text::new("Size of the force: ").number(size).words("."),
        ));
    }
    Some(Section::new(
        "load",
        "The load chosen with the postures",
        blocks,
    ))
}

/// Whether wrong assumptions would change the plan.
pub(super) fn sensitivity_section(context: &Given<'_>, plan: &Plan) -> Option<Section> {
    let found = plan.sensitivity.as_ref()?;
    let mut blocks = Vec::new();
    let said = match (found.priors.is_empty(), found.would_change) {
        (true, _) => Text::new("The index does not use the prior stiffness."),
        (false, true) => Text::new("With another prior stiffness of one joint ")
            .strong("another plan would be better")
            .words(format!(
                " by more than {} %: identify with this plan, put the result into the cell, and plan again.",
                100.0 * WORTH_CHANGING
            )),
        (false, false) => Text::new("With any one joint's prior stiffness changed, ")
            .strong("the plan stands")
            .words(format!(
                ": no plan found is better by more than {} %.",
                100.0 * WORTH_CHANGING
            )),
    };
    blocks.push(Block::Text(said));
    blocks.extend(sensitivity_figure(found).map(Block::Figure));
    let options = &found.options;
    let angle = options.joint_angle_std.to_degrees();
    let point = 1e3 * options.tool_point_std;
    let spreads = [
        (
            format!("joint angles off by {angle:.3}° (1σ)"),
            "postures",
            &found.postures,
        ),
        (
            format!("loading and measuring points off by {point:.2} mm (1σ)"),
            "tool_points",
            &found.tool_points,
        ),
    ];
    let mut table = DataTable::new(
        format!(
            "The index under random errors, as a multiple of the plan's ({} draws)",
            options.samples
        ),
        ["what is off", "mean", "worst"],
    );
    for (name, key, spread) in spreads {
        let cells = match spread {
            Some(Spread { .. }) => ["mean", "worst"].map(|which| {
                let below = format!("/sensitivity/{key}/{which}");
                Text::from(context.number(&below).decimals(4))
            }),
            None => [Text::from("not always determined"), Text::from("–")],
        };
        table.row(name, cells);
    }
    blocks.push(Block::Table(table));
    Some(Section::new(
        "sensitivity",
        "If assumptions are wrong",
        blocks,
    ))
}
