//! What `study` says: the paper's Section IV on a cell.

use super::postures::posture_table;
use super::simulate::elastic_tables;
use super::tables::data_table;
use super::worth::{Worth, indices};
use crate::study::{PAPER, figures, index_name, published_for, tables};
use crate::summary::{
    Block, Context, DataTable, Number, Quantity, Section, Summarise, Summary, Text, WithCell, counted, of_saved,
    with_stopped,
};
use serde::de::IgnoredAny;
use stiffarm::findings::{Severity, visible};
use stiffarm::model::posture::PostureGroup;
use stiffarm::study::MeasuredStudy;
use stiffarm::study::{Study, StudyGroup};
use stiffarm::{Result, Termination};

/// Findings that are the story itself, in its order; the others stand where they belong.
const STORY: [&str; 4] = ["recommended-index", "paper-order", "first-order-means", "other-starts"];

/// What the groups are.
const GROUPS: &str = "Group 1 is the initial group. Each other group is selected from it under one index (Section \
                       III.B), within the bounds of the joints and the limits of the cell.";

/// What a result says of `study`.
pub(super) fn summary(with: &WithCell<'_>) -> Result<Summary> {
    if with.saved.json["options"]["measured"] == true {
        return of_saved::<MeasuredStudy, IgnoredAny>(with);
    }
    of_saved::<Study, IgnoredAny>(with)
}

impl<O> Summarise<O> for Study {
    fn summary(&self, _options: &O, context: &Context<'_>) -> Result<Summary> {
        let study = self;
        let groups = &study.groups;
        let what_was_done = Text::new(format!(
            "On {}, {} of postures were compared: Group 1 and what each index makes of it, in {} simulated \
         measurements per noise level with tracker noise.",
            visible(&study.cell),
            counted(groups.len(), "group"),
            study.simulation.runs,
        ));
        let best = best(study);
        let conclusion = match best {
            None => Text::new("No group determines every joint."),
            Some(best) => {
                let deviation = groups[best].evaluation.mean_expected_deviation();
                let mut text = Text::new("The group ").strong(visible(&groups[best].name).into_owned()).words(format!(
                    " measures the joint stiffness best: {} expected on average over the joints",
                    percent(deviation)
                ));
                if let Some(first) = groups.first().filter(|_| best > 0) {
                    text = text.words(format!(
                        ", against {} for {}",
                        percent(first.evaluation.mean_expected_deviation()),
                        visible(&first.name)
                    ));
                }
                text.words(".")
            }
        };
        let next_step = Text::new("For your own robot: ")
            .code("stiffarm init")
            .words(" writes its cell, and ")
            .code("stiffarm select cell.toml --sheet sheet.xlsx")
            .words(" chooses such a group of postures and writes the sheet for the readings.");
        let mut sections = Vec::new();
        sections.push(cell_section(context, study)?);
        let pictures = figures(study);
        let lists = tables(study);
        let picture = |id: &str| {
            let figure = pictures.iter().find(|figure| figure.id == id);
            figure.map(|figure| Block::Figure(figure.clone()))
        };
        let table = |id: &str| {
            let table = lists.iter().find(|table| table.id == id);
            table.map(|table| Block::Table(data_table(table)))
        };
        let said = |codes: &[&str]| {
            let findings = study.findings.iter();
            let notes = findings.filter(|f| f.severity == Severity::Note && codes.contains(&f.code.as_str()));
            let points: Vec<Text> = notes.map(|f| Text::from(f.sentence.as_str())).collect();
            (!points.is_empty()).then_some(Block::List(points))
        };
        let section = |id: &str, title: &str, blocks: Vec<Option<Block>>| {
            Section::new(id, title, blocks.into_iter().flatten().collect())
        };
        let postures = groups.iter().map(|group| {
            let id = format!("postures-{}", crate::study::slug(&group.name));
            let table = posture_table("Controller angles of the postures", &[], &group.postures, &[]);
            let blocks = picture(&id).into_iter().chain([Block::Table(table)]).collect();
            Block::Details(format!("Postures of {}", visible(&group.name)), blocks)
        });
        let is_papers = published_for(&study.robot).is_some();
        let text = |words: &str| Some(Block::Text(words.into()));
        let of_paper = |words: &str| is_papers.then(|| Block::Text(words.into()));
        let is_validated = groups.iter().any(|group| group.validation.is_some());
        let [elastic_errors, elastic_shares] = match &study.elastic {
            Some(elastic) => elastic_tables(elastic).map(|table| Some(Block::Table(table))),
            None => [None, None],
        };
        let has_starts = !study.starts.kinds.is_empty();
        sections.extend([
        section("story", "What it says about the paper", vec![said(&STORY)]).in_summary(),
        section(
            "set-up",
            "Set-up",
            vec![Some(Block::Text(set_up(study)))],
        ),
        section(
            "expected",
            "What each group is expected to give",
            vec![
                picture("expected-deviation"),
                text(GROUPS),
                Some(Block::Table(indices(&worths(study)))),
                Some(Block::Table(searches(study))),
            ],
        ),
        section(
            "noise",
            "Deviation against noise (the paper's Fig. 8)",
            vec![
                picture("deviation-by-noise"),
                table("illustration-case"),
                text("This table is one run: a single run is luck, the averages above are not."),
                of_paper(
                    "The paper's columns are its own groups, which it shows only as pictures; ours start from another \
                     Group 1, so the columns are beside each other for scale, not for equality.",
                ),
            ],
        ),
        section(
            "bound",
            "The bound of Eq. (19)",
            vec![said(&["error-bound"]), Some(Block::Table(bound(study)))],
        ),
        section(
            "starts",
            "Other initial groups",
            vec![
                picture("other-starts"),
                has_starts.then(|| Block::Table(starts(study))),
                picture("classical-q1"),
                said(&["classical-q1"]),
            ],
        ),
        section(
            "identification",
            "Identification and validation, simulated (Tables 6 and 7, Fig. 10)",
            vec![
                text(
                    "Each group is measured once with tracker noise and identified. The noise is the only error here, \
                     so this shows what the tracker allows, not what an experiment reaches, and each column is one \
                     draw: differences of the size of the intervals are luck.",
                ),
                Some(Block::Table(stiffness(study))),
                of_paper(
                    "The paper's columns are its experiment (Table 6): there the true stiffness is unknown, and its \
                     three groups differ up to fourfold. Its raw readings are not published, so they cannot be \
                     recomputed.",
                ),
                picture("validation"),
                table("validation"),
                is_validated
                    .then_some("The validation postures took no part in the identification.")
                    .and_then(text),
                said(&["validation-limit"]),
                is_validated
                    .then_some(
                        "The paper measured 0.17 to 0.87 mm: model error, not tracker noise, dominated that \
                         experiment.",
                    )
                    .and_then(of_paper),
                elastic_errors,
                elastic_shares,
                said(&["beyond-axes"]),
            ],
        ),
        Section::new("postures", "The postures", postures.collect()),
        section("model", "The model", vec![said(&["model-order"])]),
    ]);
        sections.retain(|section| !section.blocks.is_empty());
        let heading = format!("Posture selection study: {}", visible(&study.cell));
        let verdict = [what_was_done, conclusion, next_step];
        let is_stopped = study.interrupted
            || study.simulation.interrupted
            || study.elastic.as_ref().is_some_and(|elastic| elastic.interrupted)
            || groups.iter().any(|group| {
                let chosen = group.selection.as_ref();
                chosen.is_some_and(|selection| selection.termination == Termination::Interrupted)
            });
        let findings = with_stopped(context, study.every_finding(), is_stopped, &[]);
        let mut summary = context.summary(findings, heading, verdict, Some(key(study)), sections);
        // The notes are all told above.
        summary.findings.retain(|f| f.severity > Severity::Note);
        Ok(summary)
    }
}

/// The expected deviation of each joint and group.
fn key(study: &Study) -> DataTable {
    // The last row holds their means.
    let names = study.joints.iter().map(|j| Text::new(visible(j)));
    let names = names.chain([Text::default().strong("mean")]);
    let caption = "Expected deviation of the joint stiffness at the cell's noise, closed form";
    let mut table = DataTable::of(caption, "joint", names);
    for group in &study.groups {
        table = table.numbers(&visible(&group.name), Quantity::DEVIATION, |row| {
            if row < study.joints.len() {
                return Some(Number::new(group.evaluation.expected_deviation[row]));
            }
            let mean = group.evaluation.mean_expected_deviation()?;
            Some(Number::computed(mean))
        });
    }
    table
}

/// What the groups are worth.
fn worths(study: &Study) -> Vec<Worth<'_>> {
    study.groups.iter().map(|group| Worth { evaluation: &group.evaluation, posture_names: &[] }).collect()
}

/// How the groups were found.
fn searches(study: &Study) -> DataTable {
    let selection = |g: usize| study.groups[g].selection.as_ref();
    let names = study.groups.iter().map(|g| visible(&g.name).into_owned());
    DataTable::of("The searches for the groups", "group", names)
        .words("search ended", |g| selection(g).map_or_else(Text::default, |s| s.termination.describe().into()))
        .numbers("iterations", Quantity::COUNT, |g| {
            Some(Number::new(selection(g)?.iterations as f64).of(Quantity::COUNT))
        })
        .numbers("first-order optimality [1/rad]", Quantity::RATIO, |g| Some(Number::new(selection(g)?.stationarity)))
        .numbers("room", Quantity::PLACE, |g| Some(Number::new(selection(g)?.smallest_margin_m)))
}

/// How often each index improves on its start, and the median outcome.
fn starts(study: &Study) -> DataTable {
    let rows: Vec<_> =
        study.starts.kinds.iter().flat_map(|kind| kind.rows.iter().map(move |row| (kind, row))).collect();
    let caption = "How often each index improves on its start, and the median of the mean expected deviation";
    DataTable::of(caption, "initial groups", rows.iter().map(|(kind, _)| kind.kind.as_str()))
        .words("index", |row| index_name(rows[row].1.index).into())
        .words("improved on the start", |row| {
            let (kind, start) = rows[row];
            start.index.map_or_else(Text::default, |_| format!("{} of {}", start.improved, kind.count).into())
        })
        .numbers("median", Quantity::DEVIATION, |row| rows[row].1.median.map(Number::new))
}

/// Identified stiffness of the groups side by side, beside the paper's Table 6.
fn stiffness(study: &Study) -> DataTable {
    let number = |k: f64| Number::new(k).of(Quantity::STIFFNESS.bare());
    let caption = format!(
        "Joint stiffness identified from one simulated measurement [{}] (Table 6), with the 95 % interval by the \
         scatter of the readings",
        Quantity::STIFFNESS.unit
    );
    let mut table = DataTable::of(caption, "joint", study.joints.iter().map(|j| Text::new(visible(j))))
        .words("truth", |j| number(study.stiffness[j]).into());
    for group in &study.groups {
        table = table.words(visible(&group.name), |j| {
            let estimate = group.identification.as_ref().map(|i| &i.estimates.joints[j]);
            let Some((k, interval)) = estimate.and_then(|e| Some((e.stiffness?, e.interval))) else {
                return "–".into();
            };
            let text = Text::from(number(k));
            match interval {
                [Some(low), Some(high)] => {
                    text.words(" (").number(number(low)).words("–").number(number(high)).words(")")
                }
                [Some(low), None] => text.words(" (above ").number(number(low)).words(")"),
                _ => text.words(" (no interval)"),
            }
        });
    }
    // The paper's rows are those of all six joints.
    let Some(published) = published_for(&study.robot).filter(|_| study.joints.len() == 6) else {
        return table;
    };
    (0..3).fold(table, |table, g| {
        table.words(format!("paper, Group {}", g + 1), |j| {
            let k = Number::computed(published.stiffness[j][g]).of(Quantity::STIFFNESS.bare());
            k.into()
        })
    })
}

/// What was simulated.
fn set_up(study: &Study) -> Text {
    let noise = Number::new(study.noise_std_m).times(1e6).unit("µm");
    let length = match study.characteristic_length_m {
        Some(length) => Text::default().number(Number::new(length).of(Quantity::PLACE)),
        None => Text::new("none"),
    };
    Text::new(format!(
        "Section IV of the paper ({PAPER}) on this cell. Robot: {}. Every number is simulated unless it is marked as \
         the paper's; the true joint stiffness stands beside the identified one below. Displacement noise at variance \
         factor 1: ",
        visible(&study.robot)
    ))
    .number(noise)
    .words(" per axis. Characteristic length of Eq. (20): ")
    .then(length)
    .words(".")
}

/// Eq. (19) beside what it bounds.
fn bound(study: &Study) -> DataTable {
    let group = |g: usize| &study.groups[g];
    let names = study.groups.iter().map(|g| visible(&g.name).into_owned());
    DataTable::of(
        "Relative error of the vector H of joint compliances: the bound of Eq. (19) and what is to be expected",
        "group",
        names,
    )
    .numbers("cond(Ψ)", Quantity::RATIO.digits(4), |g| Some(Number::new(group(g).evaluation.indices.condition)))
    .numbers("bound", Quantity::PERCENT.digits(4), |g| Some(Number::new(group(g).error_bound.as_ref()?.bound)))
    .numbers("expected", Quantity::PERCENT.digits(4), |g| Some(Number::new(group(g).expected_relative_norm)))
}

/// The group with the smallest mean expected deviation.
fn best(study: &Study) -> Option<usize> {
    let means = study.groups.iter().enumerate();
    let means = means.filter_map(|(g, group)| Some((g, group.evaluation.mean_expected_deviation()?)));
    let best = means.min_by(|a, b| a.1.total_cmp(&b.1));
    best.map(|(g, _)| g)
}

fn percent(fraction: Option<f64>) -> String {
    Number::computed(fraction).of(Quantity::DEVIATION).text()
}

/// The cell with all groups, the recommended one first.
fn cell_section(context: &Context<'_>, study: &Study) -> Result<Section> {
    let first = best(study).unwrap_or(0);
    let order = std::iter::once(first).chain((0..study.groups.len()).filter(|g| *g != first));
    let groups: Vec<PostureGroup> = order
        .filter_map(|g| study.groups.get(g))
        .map(|group: &StudyGroup| PostureGroup::from_angles(&group.name, group.postures.clone()))
        .collect();
    context.cell_section(
        &groups,
        "Step through the postures of a group in measuring order, lay other groups over them, and let the arm bend.",
    )
}
