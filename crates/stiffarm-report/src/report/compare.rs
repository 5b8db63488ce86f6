//! Several results side by side: what they were made from, their key tables, their charts.

use crate::page::{Block, DataTable, Number, Part, Piece, Section, Text};

/// Most results whose charts stand side by side.
const MOST_CHARTS: usize = 4;

/// What a page of several results says before them; nothing for one. Results of one command are compared number
/// by number, row by row of their key tables.
pub(super) fn compare(parts: &[Part]) -> Vec<Section> {
    if parts.len() < 2 {
        return Vec::new();
    }
    let mut sections = vec![Section::new(
        "results",
        "The results",
        vec![Block::Table(results(parts))],
    )];
    let mut commands: Vec<&str> = Vec::new();
    for part in parts {
        if !commands.contains(&part.command.as_str()) {
            commands.push(&part.command);
        }
    }
    for command in commands {
        let same: Vec<(usize, &Part)> = parts
            .iter()
            .enumerate()
            .filter(|(_, part)| part.command == command)
            .collect();
        if same.len() > 1 {
            sections.push(side_by_side(command, &same));
        }
    }
    sections
}

/// One row for each result: its verdict.
fn results(parts: &[Part]) -> DataTable {
    let mut table = DataTable::new("What came out", ["result", "what it is", "what came out"]);
    for (number, part) in parts.iter().enumerate() {
        let cells = [
            Text::from(part.heading.as_str()),
            of_result(&part.verdict[1], number),
        ];
        table.row(part.name.as_str(), cells);
    }
    table
}

/// Results of one command.
fn side_by_side(command: &str, parts: &[(usize, &Part)]) -> Section {
    let mut blocks = Vec::new();
    let made = made_differently(parts);
    blocks.push(match made.rows.is_empty() {
        true => Block::Text("Inputs, seed and options are the same.".into()),
        false => Block::Table(made),
    });
    if let Some(numbers) = numbers(parts) {
        let differ = numbers.rows.iter().filter(|row| {
            let mut pieces = row.iter().flat_map(|cell| &cell.0);
            pieces.any(|piece| matches!(piece, Piece::Different(_)))
        });
        blocks.push(Block::Text(Text::new(match differ.count() {
            0 => format!(
                "All {} numbers of the key tables are the same.",
                numbers.rows.len()
            ),
            differ => format!(
                "{differ} of {} numbers of the key tables differ; they are marked with ≠.",
                numbers.rows.len()
            ),
        })));
        blocks.push(Block::Table(numbers));
    }
    if parts.len() <= MOST_CHARTS {
        blocks.extend(charts(parts));
    }
    Section::new(
        &format!("compare-{command}"),
        format!("{} results of {command} side by side", parts.len()),
        blocks,
    )
}

/// Inputs, seed and options that are not the same in all results.
fn made_differently(parts: &[(usize, &Part)]) -> DataTable {
    let names = parts.iter().map(|(_, part)| part.name.clone());
    let headings = std::iter::once("made with".to_string()).chain(names);
    let mut table = DataTable::new("How they were made differently", headings);
    let mut add = |name: String, values: Vec<String>| {
        if values.iter().any(|value| *value != values[0]) {
            table.row(name, values.into_iter().map(Text::from));
        }
    };
    let seed = |part: &Part| {
        let seed = part.provenance.seed;
        seed.map_or_else(|| "–".to_string(), |seed| seed.to_string())
    };
    add(
        "version".to_string(),
        parts
            .iter()
            .map(|(_, p)| p.provenance.version.clone())
            .collect(),
    );
    add(
        "seed".to_string(),
        parts.iter().map(|(_, p)| seed(p)).collect(),
    );
    let inputs = |part: &Part| part.provenance.inputs.clone();
    let options = |part: &Part| part.provenance.options.clone();
    for (word, list) in [
        ("input", &inputs as &dyn Fn(&Part) -> Vec<(String, String)>),
        ("option", &options),
    ] {
        let lists: Vec<_> = parts.iter().map(|(_, part)| list(part)).collect();
        for name in names_of(&lists) {
            let values = lists.iter().map(|list| {
                let found = list.iter().find(|(own, _)| *own == name);
                let value = found.map_or("–", |(_, value)| value.as_str());
                match word {
                    // Enough of a hash to tell files apart.
                    "input" => value.chars().take(12).collect(),
                    _ => value.to_string(),
                }
            });
            add(format!("{word} {name}"), values.collect());
        }
    }
    table
}

/// Names in any of several lists, each once, in order.
fn names_of(lists: &[Vec<(String, String)>]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for (name, _) in lists.iter().flatten() {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}

/// Every number of the key tables, one row each.
fn numbers(parts: &[(usize, &Part)]) -> Option<DataTable> {
    let tables: Vec<(usize, &DataTable)> = parts
        .iter()
        .map(|(number, part)| Some((*number, part.key.as_ref()?)))
        .collect::<Option<_>>()?;
    let names = parts.iter().map(|(_, part)| part.name.clone());
    let headings = std::iter::once("number".to_string())
        .chain(names)
        .chain(["difference".to_string()]);
    let mut out = DataTable::new("The key tables, number by number", headings);
    let mut rows: Vec<String> = Vec::new();
    for row in tables.iter().flat_map(|(_, table)| &table.rows) {
        let name = row.first().map(Text::plain).unwrap_or_default();
        if !rows.contains(&name) {
            rows.push(name);
        }
    }
    let mut columns: Vec<&String> = Vec::new();
    for heading in tables
        .iter()
        .flat_map(|(_, table)| table.headings.iter().skip(1))
    {
        if !columns.contains(&heading) {
            columns.push(heading);
        }
    }
    for row in &rows {
        for column in &columns {
            let cells: Vec<Option<(usize, &Text)>> = tables
                .iter()
                .map(|(number, table)| Some((*number, cell(table, row, column)?)))
                .collect();
            let is_number = |text: &Text| text.0.iter().any(|p| matches!(p, Piece::Number(_)));
            if !cells.iter().flatten().any(|(_, text)| is_number(text)) {
                continue;
            }
            let shown = cells.iter().map(|cell| match cell {
                Some((number, text)) => of_result(text, *number),
                None => Text::from("–"),
            });
            let shown: Vec<Text> = shown.collect();
            let difference = difference(&shown);
            out.row(
                format!("{row} · {column}"),
                shown.into_iter().chain([difference]),
            );
        }
    }
    (!out.rows.is_empty()).then_some(out)
}

/// The cell of a table by the name of its row and its column's heading.
fn cell<'a>(table: &'a DataTable, row: &str, column: &str) -> Option<&'a Text> {
    let place = table
        .headings
        .iter()
        .position(|heading| heading == column)?;
    let mut rows = table.rows.iter();
    let row = rows.find(|cells| cells.first().is_some_and(|name| name.plain() == row))?;
    row.get(place)
}

/// How far the others are from the first, where that shows.
fn difference(cells: &[Text]) -> Text {
    let value = |text: &Text| {
        text.0.iter().find_map(|piece| match piece {
            Piece::Number(number) => number.value.map(|value| value * number.factor),
            _ => None,
        })
    };
    let first = &cells[0];
    if cells.iter().all(|cell| cell.plain() == first.plain()) {
        return Text::from("same");
    }
    let others = cells[1..]
        .iter()
        .map(|cell| match (value(first), value(cell)) {
            (Some(a), Some(b)) if a != 0.0 => {
                let change = Number::new("", Some(100.0 * (b - a) / a.abs())).significant(3);
                let sign = if b > a { "+" } else { "" };
                format!("{sign}{} %", change.digits())
            }
            (Some(_), Some(_)) => "differs".to_string(),
            (Some(_), None) => "missing".to_string(),
            (None, _) => "new".to_string(),
        });
    let others: Vec<String> = others.collect();
    Text(vec![Piece::Different(others.join(", "))])
}

/// A text whose numbers say which result they stand in.
fn of_result(text: &Text, result: usize) -> Text {
    let pieces = text.0.iter().cloned().map(|piece| match piece {
        Piece::Number(number) => Piece::Number(Number {
            result: Some(result),
            ..number
        }),
        other => other,
    });
    Text(pieces.collect())
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
        let same: Option<Vec<_>> = all
            .iter()
            .map(|figures| figures.iter().find(|other| other.id == figure.id).cloned())
            .collect();
        let named = same?.into_iter().zip(&names).map(|(mut figure, name)| {
            figure.title = format!("{name}: {}", figure.title);
            figure
        });
        Some(Block::Figures(named.collect()))
    });
    shared.collect()
}
