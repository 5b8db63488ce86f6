//! What groups of postures are worth, as sections that several pages share.

use crate::selection::{
    Deviations, IndexUnit, correlation_figure, dexterity_figure, expected_deviation_figure,
    index_name, singular_values_figure,
};
use crate::tell::Given;
use crate::tell::{Block, DataTable, Number, Section, Text};
use stiffarm::findings::visible;
use stiffarm::plan::index::{FIRST_ORDER_LIMIT, GroupEvaluation, Index, expected_deviation};

/// What to know where some joint is beyond what the first order says.
pub(super) const UNSURE: &str = "A joint's relative standard error is above 10 %: its stiffness may come out far from the truth.";

/// A group with the place of its evaluation in the file.
pub(super) struct Worth<'a> {
    /// JSON Pointer below `/result`.
    pub at: String,
    pub evaluation: &'a GroupEvaluation,
    pub posture_names: &'a [String],
}

/// The value of an index in its unit; `below` is its place below `/result`.
pub(super) fn index_number(context: &Given<'_>, index: Index, below: &str) -> Number {
    let unit = IndexUnit::of(index);
    context.number(below).times(unit.factor).unit(unit.unit)
}

/// What an index says of a plan, as the beginning of a sentence that its value ends.
pub(super) fn index_says(index: Index) -> &'static str {
    match index {
        Index::ExpectedError => {
            "The joint stiffness can be expected with a relative standard error (RMS over the joints) of "
        }
        Index::WorstJoint => {
            "The joint that comes out worst can be expected with a relative standard error of "
        }
        Index::DropOne => {
            "With any one posture lost, the joint stiffness can still be expected with a relative standard error (RMS \
             over the joints) of "
        }
        Index::D => {
            "The relative errors of all joints together (geometric mean of their ellipsoid) can be expected as "
        }
        Index::Task => {
            "The deflection at the cell's tasks can be expected to be predicted with an RMS error of "
        }
        Index::Prediction => {
            "Deflections can be expected to be predicted by the mixed elastic model with an RMS error of "
        }
        Index::Classical => "The classical index, max k(J_N), is ",
        Index::Condition => "The condition number of the observation matrix is ",
        Index::Novel => "The paper's novel index, max k(J_N) × cond(Ψ), is ",
        Index::ScaledCondition => "The condition number scaled by the prior stiffness is ",
        Index::Scaled => "The scaled index, max k(J_N) × cond(Ψ·diag(1/k)), is ",
        Index::O1 | Index::O2 | Index::O3 | Index::O4 | Index::O5 => {
            "The observability index (larger is better) is "
        }
    }
}

/// Which joint will be least sure, as sentences: by the ± that `identify` is expected to print, else by the noise alone.
/// `at` is the evaluation's place below `/result`.
pub(super) fn least_sure(
    context: &Given<'_>,
    at: &str,
    evaluation: &GroupEvaluation,
    joints: &[String],
) -> Text {
    let errors = &evaluation.relative_standard_error;
    let forecast = evaluation.forecast.as_ref().map(|forecast| &forecast.total);
    let forecast = forecast.filter(|total| total.iter().all(Option::is_some));
    let known = forecast.unwrap_or(errors).iter().enumerate();
    let known = known.filter_map(|(j, error)| Some((j, (*error)?)));
    let Some((worst, _)) = known.max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Text::default();
    };
    let name = &joint_names(joints, evaluation)[worst];
    let (begin, below, end) = match forecast {
        Some(_) => (
            format!(" Least sure will be {name}: "),
            "forecast/total",
            " in what identify prints, systematic errors included.",
        ),
        None => (
            format!(" By noise alone {name} is least sure, with a standard error of "),
            "relative_standard_error",
            ".",
        ),
    };
    let number = context.number(&format!("{at}/{below}/{worst}")).percent();
    let number = match forecast {
        Some(_) => number.significant(2).plus_minus(),
        None => number.significant(3),
    };
    Text::new(begin).number(number).words(end)
}

/// Whether some joint's error is beyond what the first order says.
pub(super) fn is_beyond_first_order(evaluation: &GroupEvaluation) -> bool {
    let errors = evaluation.relative_standard_error.iter().flatten();
    errors.into_iter().any(|error| *error > FIRST_ORDER_LIMIT)
}

/// Names of joints, numbered where the file has none.
pub(super) fn joint_names(joints: &[String], evaluation: &GroupEvaluation) -> Vec<String> {
    let count = evaluation.expected_deviation.len();
    let name = |j: usize| match joints.get(j) {
        Some(name) => visible(name).into_owned(),
        None => format!("joint {}", j + 1),
    };
    (0..count).map(name).collect()
}

/// Expected errors joint by joint, singular values, correlations, the parts of the novel index, and all indices.
/// `bounds` are relative standard errors that no plan of as many postures goes below.
pub(super) fn worth_sections(
    context: &Given<'_>,
    joints: &[String],
    groups: &[Worth<'_>],
    bounds: &[f64],
) -> Vec<Section> {
    let Some(first) = groups.first() else {
        return Vec::new();
    };
    let joints = joint_names(joints, first.evaluation);
    let noise = context.cell.map(|cell| cell.noise.displacement_std());
    let evaluations: Vec<GroupEvaluation> = groups
        .iter()
        .map(|group| GroupEvaluation {
            name: visible(&group.evaluation.name).into_owned(),
            ..group.evaluation.clone()
        })
        .collect();
    let all: Vec<&GroupEvaluation> = evaluations.iter().collect();
    let mut sections = Vec::new();
    let has_errors = all
        .iter()
        .any(|g| g.expected_deviation.iter().any(Option::is_some));
    if has_errors {
        let deviations = all.iter().map(|group| Deviations {
            name: &group.name,
            each: &group.expected_deviation,
        });
        let deviations: Vec<Deviations<'_>> = deviations.collect();
        let bounds: Vec<f64> = bounds.iter().copied().map(expected_deviation).collect();
        let mut blocks = vec![
            Block::Figure(expected_deviation_figure(
                &joints,
                &deviations,
                &bounds,
                noise,
            )),
            Block::Table(errors(context, &joints, groups)),
        ];
        blocks.extend(forecast(context, &joints, groups).map(Block::Table));
        if all.iter().copied().any(is_beyond_first_order) {
            blocks.push(Block::Text(
                Text::new("Where the relative standard error is above 10 %, this closed form no longer holds: ")
                    .code("stiffarm simulate")
                    .words(" draws the errors."),
            ));
        }
        sections.push(Section::new(
            "expected",
            "Expected error of each joint",
            blocks,
        ));
    }
    let mut blocks = vec![Block::Figure(singular_values_figure(&all, noise))];
    blocks.extend(correlation_figure(&joints, &all).map(Block::Figure));
    let tables = groups
        .iter()
        .filter(|g| !g.evaluation.correlation.is_empty());
    let tables: Vec<Block> = tables
        .map(|group| Block::Table(correlations(context, &joints, group)))
        .collect();
    if !tables.is_empty() {
        blocks.push(Block::Details(
            "Correlations as numbers".to_string(),
            tables,
        ));
    }
    sections.push(Section::new(
        "apart",
        "What the readings tell apart",
        blocks,
    ));
    let named: Vec<Vec<String>> = groups
        .iter()
        .map(|g| {
            g.posture_names
                .iter()
                .map(|n| visible(n).into_owned())
                .collect()
        })
        .collect();
    let with_names = all.iter().zip(&named);
    let with_names: Vec<(&GroupEvaluation, &[String])> = with_names
        .map(|(g, names)| (*g, names.as_slice()))
        .collect();
    let mut blocks: Vec<Block> = dexterity_figure(&with_names)
        .map(Block::Figure)
        .into_iter()
        .collect();
    blocks.push(Block::Table(indices(context, groups)));
    sections.push(Section::new("indices", "The indices", blocks));
    sections
}

fn headed(first: &str, groups: &[Worth<'_>]) -> Vec<String> {
    let names = groups
        .iter()
        .map(|g| visible(&g.evaluation.name).into_owned());
    std::iter::once(first.to_string()).chain(names).collect()
}

fn errors(context: &Given<'_>, joints: &[String], groups: &[Worth<'_>]) -> DataTable {
    let mut table = DataTable::new(
        "Relative standard error of the joint stiffness [%] at the cell's noise; about two thirds of all \
         identifications lie within ± this",
        headed("joint", groups),
    );
    let cells = |key: &str| {
        let of = |group: &Worth<'_>| {
            let number = context.number(&format!("{}/{key}", group.at));
            Text::from(number.percent().bare().significant(3))
        };
        groups.iter().map(of).collect::<Vec<Text>>()
    };
    for (j, joint) in joints.iter().enumerate() {
        table.row(
            joint.clone(),
            cells(&format!("relative_standard_error/{j}")),
        );
    }
    table.row(
        Text::default().strong("RMS"),
        cells("indices/expected_error"),
    );
    table
}

/// A confidence in percent.
pub(super) fn level(confidence: f64) -> f64 {
    (1000.0 * confidence).round() / 10.0
}

/// The ± that `identify` is expected to print; nothing where no group has one.
fn forecast(context: &Given<'_>, joints: &[String], groups: &[Worth<'_>]) -> Option<DataTable> {
    let found = groups.iter().find_map(|g| g.evaluation.forecast.as_ref())?;
    let title = format!(
        "± of the joint stiffness at {} % that identify will print [%], readings and systematic errors together",
        level(found.confidence)
    );
    let mut table = DataTable::new(title, headed("joint", groups));
    for (j, joint) in joints.iter().enumerate() {
        let of = |group: &Worth<'_>| {
            let number = context.number(&format!("{}/forecast/total/{j}", group.at));
            Text::from(number.percent().bare().significant(2))
        };
        table.row(joint.clone(), groups.iter().map(of).collect::<Vec<Text>>());
    }
    Some(table)
}

fn correlations(context: &Given<'_>, joints: &[String], group: &Worth<'_>) -> DataTable {
    let name = visible(&group.evaluation.name);
    let mut table = DataTable::new(
        format!("Correlation of the joints' errors, {name}"),
        std::iter::once(String::new()).chain(joints.iter().cloned()),
    );
    for (i, joint) in joints.iter().enumerate() {
        let cells = (0..joints.len()).map(|j| {
            let below = format!("{}/correlation/{i}/{j}", group.at);
            context.number(&below).decimals(2).into()
        });
        table.row(joint.clone(), cells);
    }
    table
}

/// Every index that some group has.
pub(super) fn indices(context: &Given<'_>, groups: &[Worth<'_>]) -> DataTable {
    let mut table = DataTable::new(
        "All indices; the lower, the better, unless said otherwise; – where one does not exist",
        [headed("index", groups), vec!["what it is".to_string()]].concat(),
    );
    for index in Index::ALL {
        if groups
            .iter()
            .all(|g| g.evaluation.indices.get(index).is_none())
        {
            continue;
        }
        let cells = groups.iter().map(|group| {
            let below = format!("{}/indices/{}", group.at, index.as_str());
            index_number(context, index, &below).bare().into()
        });
        let cells = cells.chain([Text::from(index.meaning())]);
        let unit = match IndexUnit::of(index).unit {
            "" => String::new(),
            unit => format!(" [{unit}]"),
        };
        table.row(format!("{}{unit}", index_name(index)), cells);
    }
    table
}
