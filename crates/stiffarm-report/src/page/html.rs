//! A page as HTML.

use super::table::{is_wide, table};
use super::words::{prose, text};
use super::{Comparison, Page, Part, Provenance};
use crate::figure::svg::{escape, render_drawing};
use crate::figure::{Axis, Figure, Series};
use crate::page::chart::chart;
use crate::scene::{VIEWER_SCRIPT, VIEWER_STYLE, scene_html};
use crate::summary::{Block, DataTable, Number, Outcome, SEEN_AT_ONCE, Section, Summary, Text};
use askama::Template;
use stiffarm::findings::{Finding, Severity};

/// What the page looks like.
const STYLE: &str = include_str!("../../assets/page.css");
/// Charts that answer, and the switch between light and dark.
const SCRIPT: &str = include_str!("../../assets/page.js");
/// Most points of a chart that the table behind it shows.
const MOST_ROWS: usize = 400;

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
            Outcome::Good => ("good", "✓", "No problem found"),
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
    let parts: Vec<PartTemplate<'_>> = parts.map(|(number, part)| PartTemplate::new(part, number, alone)).collect();
    let has_scene = page.parts.iter().any(|part| {
        let mut blocks = part.sections.iter().flat_map(|section| &section.blocks);
        blocks.any(|block| matches!(block, Block::Scene(..)))
    });
    let (viewer_style, viewer) = if has_scene { (VIEWER_STYLE, VIEWER_SCRIPT) } else { ("", "") };
    let template = PageTemplate {
        page,
        style: format!("{STYLE}\n{viewer_style}"),
        before: page.comparison.as_ref().map_or_else(String::new, comparison),
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
            let warnings = part.warnings.iter().filter(|f| f.severity == severity);
            let warnings = warnings.filter(|f| !part.verdict[1].says(f));
            warnings.cloned().collect::<Vec<Finding>>()
        };
        PartTemplate {
            part,
            number,
            level,
            alone,
            verdict: if alone {
                verdict("verdict", part.outcome.status(), &part.verdict)
            } else {
                verdict(&format!("r{number}-verdict"), part.outcome.status(), &part.verdict)
            },
            serious: findings(&of(Severity::Serious)),
            cautions: cautions(&of(Severity::Caution), part.key.as_ref()),
            key: part.key.as_ref().map_or_else(String::new, table),
            sections: sections(&part.sections, &prefix, level),
            contents: ids.map(|section| (format!("{prefix}-{}", section.id), section.title.as_str())).collect(),
            provenance: &part.provenance,
        }
    }
}

/// What stands before several results.
fn comparison(comparison: &Comparison) -> String {
    let words = match comparison.outcome {
        Outcome::Good => "No problem found",
        Outcome::Caution => "Look at the cautions",
        Outcome::Serious => "Not all of them are usable",
    };
    let status = Status { words, ..comparison.outcome.status() };
    verdict("verdict", status, &comparison.verdict) + "\n" + &sections(&comparison.sections, "all", 2)
}

/// A result at a glance, for a notebook: what came out, what is wrong with it, the table to read first.
pub fn render_summary(summary: &Summary) -> String {
    let [_, conclusion, next] = summary.verdict.each_ref().map(text);
    let warnings = summary.findings.iter();
    let warnings = warnings.filter(|f| f.severity != Severity::Note && !summary.verdict[1].says(f));
    let findings = findings(&warnings.cloned().collect::<Vec<_>>());
    let key = summary.key.as_ref().map(table).unwrap_or_default();
    let sign = match summary.outcome {
        Outcome::Serious => format!("{}. ", summary.outcome.status().words),
        _ => String::new(),
    };
    format!("<p><b>{sign}{conclusion}</b></p>\n{findings}{key}<p>{next}</p>\n")
}

/// The story: how it came out, and its three sentences.
fn verdict(id: &str, status: Status, sentences: &[Text; 3]) -> String {
    let Status { class, sign, words } = status;
    let [done, conclusion, next] = sentences.each_ref().map(text);
    format!(
        "<section class=\"verdict {class}\" id=\"{id}\" aria-label=\"Verdict\">\n\
         <p class=\"status\"><span class=\"sign\" aria-hidden=\"true\">{sign}</span> {words}</p>\n\
         <p>{done}</p>\n<p class=\"result\">{conclusion}</p>\n<p>{next}</p>\n</section>"
    )
}

/// Sections under headings of a level, in two columns where there is room.
fn sections(sections: &[Section], prefix: &str, level: usize) -> String {
    let sections = sections.iter().map(|section| {
        let id = escape(&format!("{prefix}-{}", section.id));
        let half = if is_short(&section.blocks) { " half" } else { "" };
        format!(
            "<section class=\"block{half}\" id=\"{id}\" aria-labelledby=\"{id}-h\">\n<h{level} \
             id=\"{id}-h\">{}</h{level}>\n{}</section>\n",
            escape(&section.title),
            blocks(&section.blocks, &id)
        )
    });
    let sections: String = sections.collect();
    format!("<div class=\"sections\">\n{sections}</div>\n")
}

/// Whether a section has no more than one thing to look at, which half the page holds.
fn is_short(blocks: &[Block]) -> bool {
    let fills = |block: &Block| match block {
        Block::Figures(_) | Block::Scene(..) | Block::Lines(_) => true,
        Block::Figure(figure) => figure.panels.len() > 1,
        Block::Table(data) => is_wide(data),
        _ => false,
    };
    let seen = |block: &&Block| !matches!(block, Block::Text(_) | Block::Details(..));
    !blocks.iter().any(fills) && blocks.iter().filter(seen).count() < 2
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
            let lines: Vec<String> = lines.iter().map(|line| text(line).replace('−', "-")).collect();
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
        Block::Details(summary, inside) => {
            format!("<details class=\"more\"><summary>{}</summary>\n{}</details>", escape(summary), blocks(inside, id))
        }
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
    let count: usize = figure.panels.iter().flat_map(|p| &p.series).map(|s| s.x.len()).sum();
    let title = escape(&figure.title);
    if count == 0 {
        return String::new();
    }
    let mut out = format!(
        "<details class=\"data\"><summary>Data of this figure</summary><div class=\"table\" tabindex=\"0\" \
         role=\"group\" aria-label=\"Data: {title}\">\n\
         <table><thead><tr><th scope=\"col\">panel</th><th scope=\"col\">series</th><th scope=\"col\">x</th><th \
         scope=\"col\">y</th><th scope=\"col\">± or value</th></tr></thead><tbody>\n"
    );
    let mut left = MOST_ROWS;
    for panel in &figure.panels {
        let heading =
            if panel.title.is_empty() { panel.y.heading() } else { format!("{}: {}", panel.title, panel.y.heading()) };
        for series in &panel.series {
            for i in 0..series.x.len().min(series.y.len()).min(left) {
                out += &format!(
                    "<tr><td>{}</td><td>{}</td><td class=\"r\">{}</td><td class=\"r\">{}</td><td \
                     class=\"r\">{}</td></tr>\n",
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
    let shown = Number::computed(value).significant(5);
    shown.text()
}

fn beside(series: &Series, i: usize) -> String {
    let values = series.colour.as_ref().map(|colour| &colour.values);
    let value = series.error.get(i).or_else(|| values?.get(i));
    value.map_or_else(String::new, |value| {
        let shown = Number::computed(*value).significant(4);
        escape(&shown.text())
    })
}

/// Letters of a caution on a line beside a table.
const LETTERS: usize = 34;

/// The cautions, of which the first ones are seen at once: beside the table, or below it where they are longer.
fn cautions(list: &[Finding], key: Option<&DataTable>) -> String {
    let seen = list.iter().take(SEEN_AT_ONCE);
    let lines = seen.map(|finding| finding.sentence.chars().count() / LETTERS + 2);
    let rows = key.map_or(0, |key| key.rows.len() + 2);
    let out = folded(list);
    if lines.sum::<usize>() > rows + rows / 2 {
        out.replacen("class=\"findings\"", "class=\"findings long\"", 1)
    } else {
        out
    }
}

/// Findings of which the first ones are seen at once.
fn folded(list: &[Finding]) -> String {
    let (first, rest) = list.split_at(list.len().min(SEEN_AT_ONCE));
    let rest = match rest.len() {
        0 => String::new(),
        count => {
            format!("<details class=\"more\"><summary>{count} more to look at</summary>{}</details>", findings(rest))
        }
    };
    findings(first) + &rest
}

fn findings(findings: &[Finding]) -> String {
    let items = findings.iter().map(|finding| {
        let (class, sign, word) = match finding.severity {
            Severity::Serious => ("serious", "✗", "Serious"),
            Severity::Caution => ("caution", "!", "Caution"),
            Severity::Note => ("note", "i", "Note"),
        };
        format!(
            "<li class=\"{class}\"><span class=\"sign\" aria-hidden=\"true\">{sign}</span> <span><b>{word}:</b> \
             {}</span></li>\n",
            prose(&finding.sentence)
        )
    });
    if findings.is_empty() {
        String::new()
    } else {
        format!("<ul class=\"findings\">{}</ul>", items.collect::<String>())
    }
}
