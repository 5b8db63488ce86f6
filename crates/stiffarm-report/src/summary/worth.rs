//! What groups of postures are worth, as sections that several results share.

use super::postures::name_of;
use crate::level::level;
use crate::selection::{
    Deviations, correlation_figure, dexterity_figure, expected_deviation_figure, singular_values_figure,
};
use crate::summary::{Block, Context, DataTable, Form, Number, Quantity, Section, Text, shown};
use stiffarm::Termination;
use stiffarm::findings::{list, visible};
use stiffarm::model::cell::Cell;
use stiffarm::plan::certificate::JointEfficiency;
use stiffarm::plan::characteristic_length::with_length;
use stiffarm::plan::index::{FIRST_ORDER_LIMIT, Forecast, GroupEvaluation, Index, expected_deviation};

/// What to know where some joint is beyond what the first order says.
pub(super) const UNSURE: &str =
    "A joint's relative standard error is above 10 %: its stiffness may come out far from the truth.";

/// A group with what it tells.
pub(super) struct Worth<'a> {
    pub evaluation: &'a GroupEvaluation,
    pub posture_names: &'a [String],
}

/// Unit and digits of an index.
pub fn index_quantity(index: Index) -> Quantity {
    let (unit, factor) = index.shown_in();
    // No plan is better in practice by what a fourth digit of an error says, nor by a third of what stands on sizes
    // that are expected.
    let digits = match index {
        Index::Prediction => 2,
        _ if unit == "%" => 3,
        _ => 4,
    };
    Quantity::new(unit, factor, Form::Significant(digits))
}

/// The value of an index in its unit.
pub(super) fn index_number(index: Index, value: impl Into<Option<f64>>) -> Number {
    Number::new(value).of(index_quantity(index))
}

/// Which joint will be least sure, as sentences: by the ± that `identify` is expected to print, else by the noise
/// alone.
pub(super) fn least_sure(evaluation: &GroupEvaluation, joints: &[String]) -> Text {
    let errors = &evaluation.relative_standard_error;
    let forecast = evaluation.forecast.as_ref().map(|forecast| &forecast.total);
    let forecast = forecast.filter(|total| total.iter().all(Option::is_some));
    let by_joint = forecast.unwrap_or(errors).iter().enumerate();
    let by_joint = by_joint.filter_map(|(j, error)| Some((j, (*error)?)));
    let Some((worst, error)) = by_joint.max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Text::default();
    };
    let name = &joint_names(joints, evaluation)[worst];
    let (begin, end) = match forecast {
        Some(_) => (format!(" Least sure will be {name}: "), " in what identify prints, systematic errors included."),
        None => (format!(" By noise alone {name} is least sure, with a standard error of "), "."),
    };
    let number = match forecast {
        Some(_) => Number::new(error).of(Quantity::PERCENT).plus_minus(),
        None => Number::new(error).of(Quantity::PERCENT.digits(3)),
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
/// `characteristic_length_m` is that of the options; `bounds` are relative standard errors that no plan of as many
/// postures goes below.
pub(super) fn worth_sections(
    context: &Context<'_>,
    characteristic_length_m: Option<f64>,
    joints: &[String],
    groups: &[Worth<'_>],
    bounds: &[JointEfficiency],
) -> Vec<Section> {
    let Some(first) = groups.first() else {
        return Vec::new();
    };
    let noise = context.cell.map(|cell| cell.noise.displacement_std());
    let evaluations: Vec<GroupEvaluation> = groups
        .iter()
        .map(|group| GroupEvaluation { name: visible(&group.evaluation.name).into_owned(), ..group.evaluation.clone() })
        .collect();
    let all: Vec<&GroupEvaluation> = evaluations.iter().collect();
    let names = joint_names(joints, first.evaluation);
    let mut sections = Vec::new();
    if let Some(table) = joint_table(joints, groups, bounds) {
        let deviations = all.iter().map(|group| Deviations { name: &group.name, each: &group.expected_deviation });
        let deviations: Vec<Deviations<'_>> = deviations.collect();
        let lowest = bounds.iter().map(|joint| expected_deviation(joint.bound));
        let lowest: Vec<f64> = lowest.collect();
        let figure = expected_deviation_figure(&names, &deviations, &lowest, noise);
        let mut blocks = vec![Block::Figure(figure), Block::Table(table)];
        blocks.extend(loose(bounds).map(Block::Text));
        if all.iter().copied().any(is_beyond_first_order) {
            blocks.push(Block::Text(
                Text::new("Where the relative standard error is above 10 %, this closed form no longer holds: ")
                    .code("stiffarm simulate")
                    .words(" draws the errors."),
            ));
        }
        let parts = groups.iter();
        let parts = parts.filter_map(|group| error_parts(&names, group));
        let parts: Vec<Block> = parts.map(Block::Table).collect();
        if !parts.is_empty() {
            blocks.push(Block::Details("What each ± rests on".to_string(), parts));
        }
        let title = "Expected error of each joint";
        sections.push(Section::new("expected", title, blocks).in_summary());
    }
    let mut blocks = vec![Block::Figure(singular_values_figure(&all, noise))];
    blocks.extend(correlation_figure(&names, &all).map(Block::Figure));
    let tables = groups.iter().filter(|g| !g.evaluation.correlation.is_empty());
    let tables: Vec<Block> = tables.map(|group| Block::Table(correlations(&names, group))).collect();
    if !tables.is_empty() {
        blocks.push(Block::Details("Correlations as numbers".to_string(), tables));
    }
    sections.push(Section::new("apart", "What the readings tell apart", blocks));
    let named: Vec<Vec<String>> = groups.iter().map(|g| shown(g.posture_names)).collect();
    let with_names = all.iter().zip(&named);
    let with_names: Vec<(&GroupEvaluation, &[String])> = with_names.map(|(g, names)| (*g, names.as_slice())).collect();
    let figure = dexterity_figure(&with_names).map(Block::Figure);
    let mut blocks: Vec<Block> = figure.into_iter().collect();
    blocks.push(Block::Table(indices(groups)));
    blocks.extend(length_in_words(context, characteristic_length_m).map(Block::Text));
    let sizes = all.iter().find_map(|group| group.indices.prediction_sizes);
    blocks.extend(sizes.map(|sizes| {
        let taken = format!("The index prediction takes {}.", sizes.in_words());
        Block::Text(taken.into())
    }));
    let dexterity = groups.iter().filter_map(|group| dexterity(group));
    let dexterity: Vec<Block> = dexterity.map(Block::Table).collect();
    if !dexterity.is_empty() {
        blocks.push(Block::Details("k(J_N) of each posture".to_string(), dexterity));
    }
    sections.push(Section::new("indices", "The indices", blocks));
    sections
}

/// What each joint can be expected to have, beside the least that is possible; `None` where nothing is known of it.
pub(super) fn joint_table(joints: &[String], groups: &[Worth<'_>], bounds: &[JointEfficiency]) -> Option<DataTable> {
    let is_known = |group: &Worth<'_>| {
        let errors = &group.evaluation.relative_standard_error;
        errors.iter().any(Option::is_some)
    };
    if !groups.iter().any(is_known) {
        return None;
    }
    let names = joint_names(joints, groups.first()?.evaluation);
    let count = names.len();
    let forecast = groups.iter().find_map(|g| g.evaluation.forecast.as_ref());
    let caption = match forecast {
        Some(forecast) => format!(
            "Relative standard error of the joint stiffness by noise alone, and the ± at {} % that identify will \
             print, systematic errors included",
            level(forecast.confidence)
        ),
        None => "Relative standard error of the joint stiffness by noise alone".to_string(),
    };
    let rows = names.into_iter().map(Text::from);
    let rows = rows.chain([Text::default().strong("RMS")]);
    let mut table = DataTable::of(caption, "joint", rows);
    let heading = |single: &str, before: &str, group: &Worth<'_>| match groups {
        [_] => single.to_string(),
        _ => format!("{before}{}", visible(&group.evaluation.name)),
    };
    let errors = Quantity::PERCENT.digits(3);
    for group in groups {
        let evaluation = group.evaluation;
        table = table.numbers(&heading("by noise", "", group), errors, |j| {
            Some(Number::new(if j < count {
                evaluation.relative_standard_error[j]
            } else {
                evaluation.indices.expected_error
            }))
        });
    }
    let bound = |j: usize| bounds.get(j).filter(|joint| joint.bound > 0.0);
    table = table.numbers("no plan below", errors, |j| Some(Number::new(bound(j)?.bound))).numbers(
        "of what is possible",
        Quantity::SHARE,
        |j| Some(Number::new(bound(j)?.efficiency)),
    );
    for group in groups {
        table = table.numbers(&heading("± identified", "± ", group), Quantity::PERCENT, |j| {
            part(group, |forecast| &forecast.total, j)
        });
    }
    Some(match groups {
        [group] => table.words("largest source", |j| source(group, j)),
        _ => table,
    })
}

/// A part of a forecast, joint by joint.
type Part = fn(&Forecast) -> &[Option<f64>];

/// A part of the ± that `identify` is expected to print; what is as large as the stiffness says nothing.
fn part(group: &Worth<'_>, of: Part, j: usize) -> Option<Number> {
    let forecast = group.evaluation.forecast.as_ref()?;
    let part = of(forecast).get(j).copied().flatten();
    part.filter(|part| *part < 1.0).map(Number::new)
}

/// Where most of a joint's ± comes from.
fn source(group: &Worth<'_>, j: usize) -> Text {
    let forecast = group.evaluation.forecast.as_ref();
    let source = forecast.and_then(|forecast| forecast.largest_source.get(j)?.as_deref());
    let words = source.unwrap_or_default().replace('-', " ");
    visible(&words).into_owned().into()
}

/// The ± that `identify` is expected to print, part by part; nothing where there is none.
fn error_parts(joints: &[String], group: &Worth<'_>) -> Option<DataTable> {
    let forecast = group.evaluation.forecast.as_ref()?;
    let caption = format!(
        "{}: ± of the stiffness at {} % that identify will print, for one reading of each point under the whole load",
        visible(&group.evaluation.name),
        level(forecast.confidence)
    );
    let number = |of: Part| move |j: usize| part(group, of, j);
    let table = DataTable::of(caption, "joint", joints.iter().cloned())
        .numbers("total", Quantity::PERCENT, number(|forecast| &forecast.total))
        .numbers("readings", Quantity::PERCENT, number(|forecast| &forecast.readings))
        .numbers("systematic", Quantity::PERCENT, number(|forecast| &forecast.systematic))
        .words("largest source", |j| source(group, j));
    (table.headings.len() > 1).then_some(table)
}

/// The joints whose bound is looser than the tolerance, with how much higher a tight one could be at most; `None`
/// where there is none.
fn loose(bounds: &[JointEfficiency]) -> Option<Text> {
    let loose = bounds.iter().filter(|joint| joint.termination != Termination::Converged);
    let each = loose.map(|joint| {
        // The bound is a root: 1/(1 + residual) of its square is certain.
        let higher = Number::computed((1.0 + joint.residual).sqrt() - 1.0).of(Quantity::PERCENT);
        format!("{} (up to {} too low)", visible(&joint.joint), higher.text())
    });
    let each: Vec<String> = each.collect();
    (!each.is_empty()).then(|| format!("Bounds that are not tight: {}.", list(&each)).into())
}

/// The length that makes rotations and translations comparable, or why there is none.
pub(super) fn length_in_words(context: &Context<'_>, length_m: Option<f64>) -> Option<Text> {
    if let Some(length) = length_m {
        let number = Number::new(length).of(Quantity::PLACE);
        let stands = |cell: &Cell| cell.characteristic_length.is_some();
        let computed = if context.cell.is_some_and(|cell| !stands(cell)) {
            ", computed: robot.characteristic_length_mm is not set."
        } else {
            "."
        };
        let said = Text::new("The characteristic length of k(J_N) is ");
        return Some(said.number(number).words(computed));
    }
    let (_, missing) = with_length(context.cell?.clone());
    missing.map(|why| format!("No characteristic length: {}", visible(&why)).into())
}

fn correlations(joints: &[String], group: &Worth<'_>) -> DataTable {
    let name = visible(&group.evaluation.name);
    let caption = format!("Correlation of the joints' errors, {name}");
    let mut table = DataTable::of(caption, "", joints.iter().cloned());
    let number = Quantity::new("", 1.0, Form::Decimals(2));
    for (j, joint) in joints.iter().enumerate() {
        table = table.numbers(joint, number, |i| Some(Number::new(group.evaluation.correlation[i][j])));
    }
    table
}

/// Every index that some group has.
pub(super) fn indices(groups: &[Worth<'_>]) -> DataTable {
    let has = |index: Index| {
        let mut values = groups.iter().map(|g| g.evaluation.indices.get(index));
        values.any(|value| value.is_some())
    };
    let all: Vec<Index> = Index::ALL.into_iter().filter(|index| has(*index)).collect();
    let names = all.iter().map(|index| match index.shown_in().0 {
        "" => index.in_words(),
        unit => format!("{} [{unit}]", index.in_words()),
    });
    let caption = "All indices; the lower, the better, unless said otherwise; – where one does not exist";
    let mut table = DataTable::of(caption, "index", names);
    for group in groups {
        let name = visible(&group.evaluation.name);
        table = table.words(name, |i| {
            let value = group.evaluation.indices.get(all[i]);
            index_number(all[i], value).bare().into()
        });
    }
    table.words("what it is", |i| all[i].meaning().into())
}

/// k(J_N) posture by posture; `None` without any.
fn dexterity(group: &Worth<'_>) -> Option<DataTable> {
    let k_jn = &group.evaluation.k_jn;
    k_jn.iter().flatten().next()?;
    let caption = format!("k(J_N), Eq. (21): {}", visible(&group.evaluation.name));
    let names = (0..k_jn.len()).map(|p| name_of(group.posture_names, p));
    let table = DataTable::of(caption, "posture", names);
    let number = |p: usize| Some(Number::new(k_jn[p]));
    Some(table.numbers("k(J_N)", Quantity::RATIO.digits(4), number))
}
