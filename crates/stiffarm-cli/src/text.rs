//! What a result says, in the terminal: order, widths and colours. Nothing here knows what a result is about.

use crate::screen::{columns, paint, wrapped};
use crate::table::{Align, Table, title, weight};
use anstyle::Style;
use stiffarm::findings::{Finding, Severity};
use stiffarm::units::sentence_with_minus;
use stiffarm_report::summary::{Block, DataTable, Depth, Piece, SEEN_AT_ONCE, Section, Summary, Text};

/// Most rows of a table without details: a few dozen can be read.
const MOST_ROWS: usize = 36;

/// What came out, and what is serious.
fn opening(summary: &Summary) -> String {
    let [_, outcome, _] = &summary.verdict;
    // What is serious may be what came out.
    let (first, serious): (Vec<&Finding>, Vec<&Finding>) =
        of(summary, Severity::Serious).partition(|f| outcome.says(f));
    let mut out = if first.is_empty() {
        sentence(outcome)
    } else {
        let word = format!("{}: ", weight(Severity::Serious));
        sentence(&Text::new(word).then(outcome.clone()))
    };
    out.extend(serious.into_iter().map(finding));
    out
}

/// Findings of a weight.
fn of(summary: &Summary, severity: Severity) -> impl Iterator<Item = &Finding> {
    summary.findings.iter().filter(move |f| f.severity == severity)
}

/// The result in a few lines: what came out, what is serious, every caution.
pub fn verdict(summary: &Summary) -> String {
    opening(summary) + &of(summary, Severity::Caution).map(finding).collect::<String>()
}

/// The verdict, the table to read first, what to know and to do, and the rest as far as it is asked for.
pub fn summary(summary: &Summary, details: bool) -> String {
    let [done, _, next] = &summary.verdict;
    let mut out = opening(summary);
    if let Some(key) = &summary.key {
        out += &format!("\n{}\n", table(key, details));
    }
    let cautions: Vec<&Finding> = of(summary, Severity::Caution).collect();
    let seen = if details { cautions.len() } else { SEEN_AT_ONCE };
    out.extend(cautions.iter().copied().take(seen).map(finding));
    if cautions.len() > seen {
        let more = cautions.len() - seen;
        let word = weight(Severity::Caution);
        out += &line(&format!("{word}: {more} more, with --details"));
    }
    if details {
        out.extend(of(summary, Severity::Note).map(finding));
    }
    out += &sentence(&Text::new("Next: ").then(next.clone()));
    let (shown, hidden): (Vec<&Section>, Vec<&Section>) = summary
        .sections
        .iter()
        .filter(|section| has_words(&section.blocks))
        .partition(|section| details || section.depth == Depth::Summary);
    let mut folded = Vec::new();
    for section in shown {
        out += &title(&section.title);
        out += &blocks(&section.blocks, details);
        folded.extend(section.blocks.iter().filter_map(folded_title));
    }
    out += &sentence(done);
    let titles = hidden.iter().map(|section| &*section.title);
    let mut hidden: Vec<&str> = folded.into_iter().chain(titles).collect();
    if of(summary, Severity::Note).next().is_some() {
        hidden.push("Notes");
    }
    if !hidden.is_empty() && !details {
        out += &line(&format!("--details shows the rest: {}.", hidden.join("; ")));
    }
    out
}

/// The title of what is folded away.
fn folded_title(block: &Block) -> Option<&str> {
    match block {
        Block::Details(title, inside) if has_words(inside) => Some(title),
        _ => None,
    }
}

/// Whether something of these blocks can be said in words.
fn has_words(blocks: &[Block]) -> bool {
    blocks.iter().any(|block| match block {
        Block::Figure(_) | Block::Figures(_) | Block::Drawing(_) | Block::Scene(..) => false,
        Block::Details(_, inside) => has_words(inside),
        _ => true,
    })
}

/// Blocks below each other; pictures are left to the page.
fn blocks(all: &[Block], details: bool) -> String {
    let shown = all.iter().map(|block| match block {
        Block::Text(text) => sentence(text),
        Block::List(texts) => texts.iter().map(sentence).collect(),
        Block::Lines(lines) => lines.iter().map(|one| one.line() + "\n").collect(),
        Block::Table(data) => format!("{}{}", line(&data.caption), table(data, details)),
        Block::Findings(findings) => findings.iter().map(finding).collect(),
        Block::Details(_, inside) if details => blocks(inside, details),
        Block::Details(..) => String::new(),
        Block::Figure(_) | Block::Figures(_) | Block::Drawing(_) | Block::Scene(..) => String::new(),
    });
    let shown: Vec<String> = shown.filter(|text| !text.is_empty()).collect();
    shown.join("\n")
}

/// A finding with its weight.
fn finding(finding: &Finding) -> String {
    let word = weight(finding.severity);
    line(&format!("{word}: {}", sentence_with_minus(&finding.sentence)))
}

/// A text in lines of the terminal's width; one that is only to be typed is a line of its own.
fn sentence(text: &Text) -> String {
    // A line of a file is there to be copied.
    if let [Piece::Code(words)] = text.0.as_slice() {
        return format!("{words}\n");
    }
    let pieces = text.0.iter().map(|piece| match piece {
        Piece::Words(words) | Piece::Link(words, _) | Piece::Different(words) => {
            sentence_with_minus(words).into_owned()
        }
        Piece::Strong(words) => paint(Style::new().bold(), &sentence_with_minus(words)),
        Piece::Code(words) => format!("`{words}`"),
        Piece::Number(number) => number.text(),
    });
    line(&pieces.collect::<String>())
}

/// The same of words; a number keeps its unit on its line.
fn line(words: &str) -> String {
    format!("{}\n", wrapped(words, columns())).replace('\u{a0}', " ")
}

/// A table in columns; a long one ends early where no details are wanted.
fn table(data: &DataTable, details: bool) -> String {
    let mut table = Table::new(data.headings.iter().cloned());
    for (column, is_number) in data.of_numbers().into_iter().enumerate() {
        table.align(column, if is_number { Align::Right } else { Align::Left });
    }
    let count = data.rows.len();
    let shown = if details { count } else { count.min(MOST_ROWS) };
    for row in &data.rows[..shown] {
        table.row(row.iter().map(Text::plain));
    }
    let mut out = table.to_string().replace('\u{a0}', " ");
    if shown < count {
        out += &line(&format!("{} more rows, with --details", count - shown));
    }
    out
}
