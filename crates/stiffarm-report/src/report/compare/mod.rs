//! Several results side by side: what they were made from, their key tables, their charts.

mod agreement;
mod made;
mod numbers;
mod story;

use crate::figure::Figure;
use crate::figure::svg::share_axes;
use crate::order::in_order;
use crate::page::{Block, Comparison, DataTable, Outcome, Part, Section, Text};
use crate::report::WithCell;
use made::made_differently;
use numbers::Numbers;

/// Most results whose charts stand side by side.
const MOST_CHARTS: usize = 4;

/// What a page of several results says before them; nothing for one. Results of one command are compared number
/// by number, row by row of their key tables.
pub(super) fn compare(saved_results: &[WithCell<'_>], parts: &[Part]) -> Option<Comparison> {
    if parts.len() < 2 {
        return None;
    }
    let mut sections = vec![Section::new("results", "The results", vec![Block::Table(results(parts))])];
    let kinds = Kind::all(saved_results, parts);
    sections.extend(kinds.iter().filter(|kind| kind.parts.len() > 1).map(side_by_side));
    let outcomes = parts.iter().map(|part| part.outcome);
    Some(Comparison {
        outcome: outcomes.max().unwrap_or(Outcome::Good),
        verdict: story::verdict(parts, &kinds),
        sections,
    })
}

/// Results of one command.
struct Kind<'a> {
    command: &'a str,
    /// The results with their places in the page.
    parts: Vec<(usize, &'a Part)>,
    /// Their inputs, seeds and options where they differ.
    made: DataTable,
    /// Their key tables, number by number.
    numbers: Option<Numbers>,
}

impl<'a> Kind<'a> {
    /// One for each command, in the order of the results.
    fn all(saved_results: &[WithCell<'_>], parts: &'a [Part]) -> Vec<Self> {
        let commands = in_order(parts.iter().map(|part| part.command.as_str()));
        let kinds = commands.into_iter().map(|command| {
            let of_command = parts.iter().enumerate();
            let of_command: Vec<_> = of_command.filter(|(_, part)| part.command == command).collect();
            Kind {
                command,
                made: made_differently(&of_command),
                numbers: Numbers::of(saved_results, &of_command),
                parts: of_command,
            }
        });
        kinds.collect()
    }
}

/// One row for each result: its verdict.
fn results(parts: &[Part]) -> DataTable {
    // Said once where all are the same.
    let alike = parts.iter().all(|part| part.heading == parts[0].heading);
    let headings = ["result", "status", "what it is", "what came out"];
    let headings = headings.into_iter().filter(|heading| !alike || *heading != "what it is");
    let mut table = DataTable::new("What came out", headings);
    for (number, part) in parts.iter().enumerate() {
        let status = part.outcome.status();
        let mut cells = vec![Text::default().strong(format!("{}\u{a0}{}", status.sign, status.words))];
        cells.extend((!alike).then(|| Text::from(part.heading.as_str())));
        cells.push(part.verdict[1].clone());
        let name = Text::default().link(part.name.as_str(), format!("r{number}"));
        table.row(name, cells);
    }
    table
}

/// The results of one command.
fn side_by_side(kind: &Kind<'_>) -> Section {
    let mut blocks = vec![if kind.made.rows.is_empty() {
        Block::Text("Inputs, seed and options are the same.".into())
    } else {
        Block::Table(kind.made.clone())
    }];
    if let Some(numbers) = &kind.numbers {
        blocks.push(Block::Text(numbers.sentence().into()));
        blocks.push(Block::Table(numbers.table.clone()));
    }
    if kind.parts.len() <= MOST_CHARTS {
        blocks.extend(charts(&kind.parts));
    }
    let (count, command) = (kind.parts.len(), kind.command);
    Section::new(&format!("compare-{command}"), format!("{count} results of {command} side by side"), blocks)
}

/// Charts that all results have, one below the other with the result's name.
fn charts(parts: &[(usize, &Part)]) -> Vec<Block> {
    let of = |part: &Part| {
        let blocks = part.sections.iter().flat_map(|section| &section.blocks);
        let figures = blocks.filter_map(|block| match block {
            Block::Figure(figure) => Some(figure.clone()),
            _ => None,
        });
        figures.collect::<Vec<_>>()
    };
    let all: Vec<_> = parts.iter().map(|(_, part)| of(part)).collect();
    let (Some(first), names) = (all.first(), parts.iter().map(|(_, part)| &part.name)) else {
        return Vec::new();
    };
    let names: Vec<&String> = names.collect();
    let shared = first.iter().filter_map(|figure| {
        let same: Option<Vec<_>> =
            all.iter().map(|figures| figures.iter().find(|other| other.id == figure.id).cloned()).collect();
        let named = same?.into_iter().zip(&names).map(|(mut figure, name)| {
            figure.title = format!("{name}: {}", figure.title);
            figure
        });
        let mut named: Vec<Figure> = named.collect();
        named.iter_mut().for_each(name_empty_panels);
        share_axes(&mut named);
        Some(Block::Figures(named))
    });
    shared.collect()
}

/// Says of a panel without a value that there is none: beside others it would look like a fault.
fn name_empty_panels(figure: &mut Figure) {
    for panel in &mut figure.panels {
        let mut values = panel.series.iter().flat_map(|s| s.x.iter().zip(&s.y));
        if !values.any(|(x, y)| x.is_finite() && y.is_finite()) {
            panel.title =
                if panel.title.is_empty() { "no value".to_string() } else { format!("{}: no value", panel.title) };
        }
    }
}
