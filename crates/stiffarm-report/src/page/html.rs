//! A page as HTML.

use super::{Comparison, Page, Part, Provenance};
use crate::figure::svg::{escape, render_drawing};
use crate::figure::{Axis, Figure, Series};
use crate::page::chart::chart;
use crate::scene::{VIEWER_SCRIPT, VIEWER_STYLE, scene_html};
use crate::tell::{Block, DataTable, Number, Outcome, Piece, SEEN_AT_ONCE, Section, Text};
use askama::Template;
use stiffarm::findings::{Finding, Severity};

/// What the page looks like.
const STYLE: &str = include_str!("../../assets/page.css");
/// Charts that answer, and the switch between light and dark.
const SCRIPT: &str = include_str!("../../assets/page.js");
/// Most points of a chart that the table behind it shows.
const MOST_ROWS: usize = 400;
/// Longest code that stays on one line \[characters\]; narrow screens have room for it.
const UNBROKEN: usize = 26;
/// Most rows of a table that stays on one printed page.
const FEW_ROWS: usize = 14;

#[derive(Template)]
#[template(path = "page.html")]
struct PageTemplate<'a> {
    page: &'a Page,
    style: String,
    before: String,
    parts: Vec<PartTemplate<'a>>,
    script: String,
}

#[derive(Template)]
#[template(path = "part.html")]
struct PartTemplate<'a> {
    part: &'a Part,
    number: usize,
    level: usize,
    alone: bool,
    verdict: String,
    serious: String,
    cautions: String,
    key: String,
    sections: String,
    contents: Vec<(String, &'a str)>,
    provenance: &'a Provenance,
}

/// Words, sign and class of an outcome: no colour says it alone.
#[derive(Clone, Copy)]
pub(crate) struct Status {
    class: &'static str,
    pub(crate) sign: &'static str,
    pub(crate) words: &'static str,
}

impl Outcome {
    pub(crate) fn status(self) -> Status {
        let (class, sign, words) = match self {
            Outcome::Good => ("good", "✓", "Nothing speaks against it"),
            Outcome::Caution => ("caution", "!", "Look at the cautions"),
            Outcome::Serious => ("serious", "✗", "Not usable as it is"),
        };
        Status { class, sign, words }
    }
}

/// A page as one HTML document. Equal pages give equal bytes.
pub fn render_page(page: &Page) -> String {
    let alone = page.parts.len() == 1;
    let parts = page.parts.iter().enumerate();
    let parts: Vec<PartTemplate<'_>> = parts
        .map(|(number, part)| PartTemplate::new(part, number, alone))
        .collect();
    let has_scene = page.parts.iter().any(|part| {
        let mut blocks = part.sections.iter().flat_map(|section| &section.blocks);
        blocks.any(|block| matches!(block, Block::Scene(..)))
    });
    let (viewer_style, viewer) = match has_scene {
        true => (VIEWER_STYLE, VIEWER_SCRIPT),
        false => ("", ""),
    };
    let template = PageTemplate {
        page,
        style: format!("{STYLE}\n{viewer_style}"),
        before: page
            .comparison
            .as_ref()
            .map_or_else(String::new, comparison),
        parts,
        script: format!("{SCRIPT}\n{viewer}"),
    };
    // Writing to a string fails for templates that fail themselves; ours have nothing that can.
    template.render().unwrap_or_default()
}

impl<'a> PartTemplate<'a> {
    fn new(part: &'a Part, number: usize, alone: bool) -> Self {
        let prefix = format!("r{number}");
        let level = if alone { 2 } else { 3 };
        let ids = part.sections.iter();
        let of = |severity: Severity| {
            let own = part.warnings.iter().filter(|f| f.severity == severity);
            own.cloned().collect::<Vec<Finding>>()
        };
        PartTemplate {
            part,
            number,
            level,
            alone,
            verdict: match alone {
                true => verdict("verdict", part.outcome.status(), &part.verdict),
                false => verdict(
                    &format!("r{number}-verdict"),
                    part.outcome.status(),
                    &part.verdict,
                ),
            },
            serious: findings(&of(Severity::Serious)),
            cautions: folded(&of(Severity::Caution)),
            key: part.key.as_ref().map_or_else(String::new, table),
            sections: sections(&part.sections, &prefix, level),
            contents: ids
                .map(|section| (format!("{prefix}-{}", section.id), section.title.as_str()))
                .collect(),
            provenance: &part.provenance,
        }
    }
}

/// What stands before several results.
fn comparison(comparison: &Comparison) -> String {
    let words = match comparison.outcome {
        Outcome::Good => "Nothing speaks against them",
        Outcome::Caution => "Look at the cautions",
        Outcome::Serious => "Not all of them are usable",
    };
    let status = Status {
        words,
        ..comparison.outcome.status()
    };
    verdict("verdict", status, &comparison.verdict)
        + "\n"
        + &sections(&comparison.sections, "all", 2)
}

/// The story: how it came out, and its three sentences.
fn verdict(id: &str, status: Status, sentences: &[Text; 3]) -> String {
    let Status { class, sign, words } = status;
    let [done, came, next] = sentences.each_ref().map(text);
    format!(
        "<section class=\"verdict {class}\" id=\"{id}\" aria-label=\"Verdict\">\n\
         <p class=\"status\"><span class=\"sign\" aria-hidden=\"true\">{sign}</span> {words}</p>\n\
         <p>{done}</p>\n<p class=\"result\">{came}</p>\n<p>{next}</p>\n</section>"
    )
}

/// Sections under headings of a level.
fn sections(sections: &[Section], prefix: &str, level: usize) -> String {
    let sections = sections.iter().map(|section| {
        let id = escape(&format!("{prefix}-{}", section.id));
        format!(
            "<section class=\"block\" id=\"{id}\" aria-labelledby=\"{id}-h\">\n<h{level} id=\"{id}-h\">{}</h{level}>\n{}</section>\n",
            escape(&section.title),
            blocks(&section.blocks, &id)
        )
    });
    sections.collect()
}

/// Blocks of a section; `prefix` makes ids inside them unique.
fn blocks(blocks: &[Block], prefix: &str) -> String {
    let blocks = blocks.iter().enumerate().map(|(i, one)| {
        let id = format!("{prefix}-{i}");
        block(one, &id) + "\n"
    });
    blocks.collect()
}

fn block(block: &Block, id: &str) -> String {
    match block {
        Block::Text(words) => format!("<p>{}</p>", text(words)),
        Block::List(points) => {
            let points = points.iter().map(|p| format!("<li>{}</li>", text(p)));
            format!("<ul>{}</ul>", points.collect::<String>())
        }
        Block::Lines(lines) => {
            let lines: Vec<String> = lines
                .iter()
                .map(|line| text(line).replace('−', "-"))
                .collect();
            format!("<pre>{}</pre>", lines.join("\n"))
        }
        Block::Table(data) => table(data),
        Block::Figure(figure) => picture(figure),
        Block::Figures(figures) => {
            let figures: String = figures.iter().map(picture).collect();
            format!("<div class=\"beside\">{figures}</div>")
        }
        Block::Drawing(drawing) => format!(
            "<figure class=\"chart\"><div class=\"sheet\">{}</div><figcaption>{}</figcaption></figure>",
            render_drawing(drawing),
            escape(&drawing.caption)
        ),
        Block::Scene(scene, fallback) => {
            let still = fallback.as_ref().map(render_drawing).unwrap_or_default();
            scene_html(scene, &format!("scene-{id}"), &scene.cell, &still)
        }
        Block::Findings(list) => findings(list),
        Block::Details(summary, inside) => format!(
            "<details class=\"more\"><summary>{}</summary>\n{}</details>",
            escape(summary),
            blocks(inside, id)
        ),
    }
}

fn text(text: &Text) -> String {
    let pieces = text.0.iter().map(|piece| match piece {
        Piece::Words(words) => together(words),
        Piece::Strong(words) => format!("<strong>{}</strong>", together(words)),
        Piece::Code(words) => code(words),
        Piece::Link(words, anchor) => {
            format!("<a href=\"#{}\">{}</a>", escape(anchor), escape(words))
        }
        Piece::Different(words) => format!("<span class=\"different\">{}</span>", escape(words)),
        Piece::Number(number) => number_html(number),
    });
    pieces.collect()
}

/// Words in which no line ends between a number and its % or ±.
fn together(words: &str) -> String {
    let words = words.replace("± ", "±\u{a0}").replace(" %", "\u{a0}%");
    escape(&words)
}

/// What one types; short words of it are not broken at their hyphens.
fn code(words: &str) -> String {
    let class = match words.chars().count() <= UNBROKEN {
        true => " class=\"short\"",
        false => "",
    };
    format!("<code{class}>{}</code>", escape(words))
}

/// A number with its place in the file and its full value.
fn number_html(number: &Number) -> String {
    let shown = escape(&number.text());
    if number.pointer.is_empty() {
        return format!("<span class=\"n\">{shown}</span>");
    }
    // JSON's own writing of the value, `null` where there is none.
    let value = serde_json::to_string(&number.value).unwrap_or_default();
    let factor = match number.factor == 1.0 {
        true => String::new(),
        false => format!(" data-factor=\"{}\"", number.factor),
    };
    let result = number
        .result
        .map_or_else(String::new, |result| format!(" data-result=\"{result}\""));
    format!(
        "<span class=\"n\" data-path=\"{}\" data-value=\"{value}\"{factor}{result}>{shown}</span>",
        escape(&number.pointer)
    )
}

fn table(data: &DataTable) -> String {
    let right = data.of_numbers();
    let class = |c: usize| match right.get(c) {
        Some(true) => " class=\"r\"",
        _ => "",
    };
    let headings = data.headings.iter().enumerate();
    let headings =
        headings.map(|(c, h)| format!("<th scope=\"col\"{}>{}</th>", class(c), escape(h)));
    let headings: String = headings.collect();
    let rows = data.rows.iter().map(|row| {
        let cells = row.iter().enumerate().map(|(c, cell)| {
            let class = class(c);
            match c {
                0 => format!("<th scope=\"row\"{}>{}</th>", short(cell), text(cell)),
                _ => format!("<td{class}>{}</td>", text(cell)),
            }
        });
        format!("<tr>{}</tr>\n", cells.collect::<String>())
    });
    let few = match data.rows.len() <= FEW_ROWS {
        true => " few",
        false => "",
    };
    format!(
        "<p class=\"caption\">{0}</p><div class=\"table{few}\" tabindex=\"0\" role=\"group\" aria-label=\"{0}\">\
         <table aria-label=\"{0}\">\n<thead><tr>{headings}</tr></thead>\n<tbody>\n{1}</tbody></table></div>",
        escape(&data.caption),
        rows.collect::<String>()
    )
}

/// Class of a row's name that is short enough to stay on one line.
fn short(name: &Text) -> &'static str {
    match name.plain().chars().count() <= 24 {
        true => " class=\"short\"",
        false => "",
    }
}

/// A chart, its caption, and its data in a table behind it.
fn picture(figure: &Figure) -> String {
    // On paper, a single panel does not need the whole width.
    let class = match figure.columns {
        0 | 1 => "chart one",
        _ => "chart",
    };
    format!(
        "<figure class=\"{class}\">{}<figcaption>{}</figcaption>\n{}</figure>",
        chart(figure),
        escape(&figure.caption),
        data(figure)
    )
}

/// The numbers of a chart: what a picture says to those who cannot see it.
fn data(figure: &Figure) -> String {
    let count: usize = figure
        .panels
        .iter()
        .flat_map(|p| &p.series)
        .map(|s| s.x.len())
        .sum();
    let title = escape(&figure.title);
    if count == 0 {
        return String::new();
    }
    let mut out = format!(
        "<details class=\"data\"><summary>Data of this figure</summary><div class=\"table\" tabindex=\"0\" role=\"group\" aria-label=\"Data: {title}\">\n\
         <table><thead><tr><th scope=\"col\">panel</th><th scope=\"col\">series</th><th scope=\"col\">x</th><th scope=\"col\">y</th><th scope=\"col\">± or value</th></tr></thead><tbody>\n"
    );
    let mut left = MOST_ROWS;
    for panel in &figure.panels {
        let heading = match panel.title.is_empty() {
            true => panel.y.heading(),
            false => format!("{}: {}", panel.title, panel.y.heading()),
        };
        for series in &panel.series {
            for i in 0..series.x.len().min(series.y.len()).min(left) {
                out += &format!(
                    "<tr><td>{}</td><td>{}</td><td class=\"r\">{}</td><td class=\"r\">{}</td><td class=\"r\">{}</td></tr>\n",
                    escape(&heading),
                    escape(&series.label),
                    escape(&place(&panel.x, series.x[i])),
                    escape(&place(&panel.y, series.y[i])),
                    beside(series, i)
                );
            }
            left = left.saturating_sub(series.x.len());
        }
    }
    out += "</tbody></table></div>";
    if count > MOST_ROWS {
        out += &format!(
            "<p>The first {MOST_ROWS} of {count} points; <code>stiffarm report --figures</code> writes all as CSV.</p>"
        );
    }
    out + "</details>"
}

/// A coordinate as the table shows it: the category's name, or the number.
fn place(axis: &Axis, value: f64) -> String {
    if !axis.categories.is_empty() {
        let name = axis.categories.get(value.round().max(0.0) as usize);
        return name.cloned().unwrap_or_default();
    }
    let shown = Number::new("", Some(value)).significant(5);
    shown.text()
}

fn beside(series: &Series, i: usize) -> String {
    let values = series.colour.as_ref().map(|colour| &colour.values);
    let value = series.error.get(i).or_else(|| values?.get(i));
    value.map_or_else(String::new, |value| {
        let shown = Number::new("", Some(*value)).significant(4);
        escape(&shown.text())
    })
}

/// Findings of which the first ones are seen at once.
fn folded(list: &[Finding]) -> String {
    let (first, rest) = list.split_at(list.len().min(SEEN_AT_ONCE));
    let rest = match rest.len() {
        0 => String::new(),
        count => format!(
            "<details class=\"more\"><summary>{count} more to look at</summary>{}</details>",
            findings(rest)
        ),
    };
    findings(first) + &rest
}

/// A sentence in which what one types stands in backticks.
fn prose(sentence: &str) -> String {
    let pieces: Vec<&str> = sentence.split('`').collect();
    // A backtick without its partner is a character like any other.
    if pieces.len().is_multiple_of(2) {
        return together(sentence);
    }
    let pieces = pieces.iter().enumerate().map(|(i, piece)| match i % 2 {
        0 => together(piece),
        _ => code(piece),
    });
    pieces.collect()
}

fn findings(findings: &[Finding]) -> String {
    let items = findings.iter().map(|finding| {
        let (class, sign, word) = match finding.severity {
            Severity::Serious => ("serious", "✗", "Serious"),
            Severity::Caution => ("caution", "!", "Caution"),
            Severity::Note => ("note", "i", "Note"),
        };
        format!(
            "<li class=\"{class}\"><span class=\"sign\" aria-hidden=\"true\">{sign}</span><span><b>{word}:</b> {}</span></li>\n",
            prose(&finding.sentence)
        )
    });
    match findings.is_empty() {
        true => String::new(),
        false => format!("<ul class=\"findings\">{}</ul>", items.collect::<String>()),
    }
}
