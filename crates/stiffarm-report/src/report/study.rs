//! The page of `study`: the paper's Section IV on a cell.

use super::context::Context;
use super::tables::data_table;
use crate::page::{Block, DataTable, Part, Section, Text};
use crate::study::{figures, tables};
use stiffarm::Result;
use stiffarm::findings::{Severity, visible};
use stiffarm::model::posture::PostureGroup;
use stiffarm::study::{Study, StudyGroup};

/// Findings that are the story itself, in its order; the others stand where they belong.
const STORY: [&str; 4] = [
    "recommended-index",
    "paper-order",
    "first-order-means",
    "other-starts",
];

/// The part of a page for a result of `study`.
pub(super) fn part(context: &Context<'_>) -> Result<Part> {
    let study: Study = context.saved.result()?;
    let groups = &study.groups;
    let done = Text::new(format!(
        "On {}, {} of postures were compared: Group 1 and what each index makes of it, in {} simulated measurements \
         per noise level with tracker noise.",
        visible(&study.cell),
        counted(groups.len(), "group", "groups"),
        study.simulation.runs,
    ));
    let best = best(&study);
    let came = match best {
        None => Text::new("No group determines every joint."),
        Some(best) => {
            let deviation = groups[best].evaluation.mean_expected_deviation();
            let mut text = Text::new("The group ")
                .strong(visible(&groups[best].name).into_owned())
                .words(format!(
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
    let next = Text::new("Measure its postures: ")
        .code("stiffarm select --postures 6 --sheet sheet.xlsx")
        .words(" chooses such a group for your cell and writes the sheet for the readings.");
    let mut sections = Vec::new();
    sections.push(cell_section(context, &study)?);
    let pictures = figures(&study);
    let lists = tables(&study);
    let picture = |id: &str| {
        let found = pictures.iter().find(|figure| figure.id == id);
        found.map(|figure| Block::Figure(figure.clone()))
    };
    let table = |id: &str| {
        let found = lists.iter().find(|table| table.id == id);
        found.map(|table| Block::Table(data_table(table)))
    };
    let said = |codes: &[&str]| {
        let findings = study.findings.iter();
        let found =
            findings.filter(|f| f.severity == Severity::Note && codes.contains(&f.code.as_str()));
        let points: Vec<Text> = found.map(|f| Text::from(f.sentence.as_str())).collect();
        (!points.is_empty()).then_some(Block::List(points))
    };
    let section = |id: &str, title: &str, blocks: Vec<Option<Block>>| {
        Section::new(id, title, blocks.into_iter().flatten().collect())
    };
    let postures = groups.iter().map(|group| {
        let id = format!("postures-{}", crate::study::slug(&group.name));
        let blocks = [picture(&id), table(&id)].into_iter().flatten().collect();
        Block::Details(format!("Postures of {}", visible(&group.name)), blocks)
    });
    sections.extend([
        section("story", "What it says about the paper", vec![said(&STORY)]),
        section(
            "expected",
            "What each group is expected to give",
            vec![picture("expected-deviation"), table("indices")],
        ),
        section(
            "noise",
            "Deviation against noise (the paper's Fig. 8)",
            vec![picture("deviation-by-noise"), table("illustration-case")],
        ),
        section(
            "starts",
            "Other initial groups",
            vec![
                picture("other-starts"),
                picture("classical-q1"),
                said(&["classical-q1"]),
            ],
        ),
        section(
            "identification",
            "Identification and validation, simulated (Tables 6 and 7, Fig. 10)",
            vec![
                table("stiffness"),
                picture("validation"),
                table("validation"),
                said(&["validation-limit"]),
                table("elastic"),
                said(&["beyond-axes"]),
            ],
        ),
        Section::new("postures", "The postures", postures.collect()),
        section("model", "The model", vec![said(&["model-order"])]),
    ]);
    sections.retain(|section| !section.blocks.is_empty());
    let heading = format!("Posture selection study: {}", visible(&study.cell));
    let verdict = [done, came, next];
    let mut part = context.part(heading, verdict, Some(key(context, &study)), sections);
    // The notes are all told above.
    part.sections.retain(|section| section.id != "notes");
    Ok(part)
}

/// The expected deviation of each joint and group.
fn key(context: &Context<'_>, study: &Study) -> DataTable {
    let names = study.groups.iter().map(|g| visible(&g.name).into_owned());
    let mut table = DataTable::new(
        "Expected deviation of the joint stiffness [%] at the cell's noise, closed form",
        std::iter::once("joint".to_string()).chain(names),
    );
    for (j, joint) in study.joints.iter().enumerate() {
        let cells = (0..study.groups.len()).map(|g| {
            let number = context.number(&format!("/groups/{g}/evaluation/expected_deviation/{j}"));
            number.percent().bare().decimals(2).into()
        });
        table.row(visible(joint).into_owned(), cells);
    }
    let means = study.groups.iter().map(|group| {
        let mean = group.evaluation.mean_expected_deviation();
        Text::from(
            crate::page::Number::new("", mean)
                .percent()
                .bare()
                .decimals(2),
        )
    });
    table.row(Text::default().strong("mean"), means);
    table
}

/// The group with the smallest mean expected deviation.
fn best(study: &Study) -> Option<usize> {
    let means = study.groups.iter().enumerate();
    let means =
        means.filter_map(|(g, group)| Some((g, group.evaluation.mean_expected_deviation()?)));
    let best = means.min_by(|a, b| a.1.total_cmp(&b.1));
    best.map(|(g, _)| g)
}

fn percent(fraction: Option<f64>) -> String {
    let number = crate::page::Number::new("", fraction);
    number.percent().decimals(2).text()
}

fn counted(count: usize, one: &str, many: &str) -> String {
    match count {
        1 => format!("one {one}"),
        count => format!("{count} {many}"),
    }
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
