//! Tables of a page.

use super::words;
use crate::figure::svg::escape;
use crate::summary::{DataTable, Text};

/// Characters of a table that half the page holds.
const HALF: usize = 76;
/// Characters between two columns.
const BETWEEN: usize = 3;
/// Characters of a line in a column of words.
const WORDS: usize = 16;
/// Most rows of a table that stays on one printed page.
const FEW_ROWS: usize = 14;

/// A table under its caption.
pub(super) fn table(data: &DataTable) -> String {
    let right = data.of_numbers();
    let class = |c: usize| match right.get(c) {
        Some(true) => " class=\"r\"",
        _ => "",
    };
    let headings = data.headings.iter().enumerate();
    let headings = headings.map(|(c, h)| format!("<th scope=\"col\"{}>{}</th>", class(c), escape(h)));
    let headings: String = headings.collect();
    let rows = data.rows.iter().map(|row| {
        let cells = row.iter().enumerate().map(|(c, cell)| {
            let class = class(c);
            match c {
                0 => format!("<th scope=\"row\"{}>{}</th>", short(cell), words::cell(cell)),
                _ => format!("<td{class}>{}</td>", words::cell(cell)),
            }
        });
        format!("<tr>{}</tr>\n", cells.collect::<String>())
    });
    let few = if data.rows.len() <= FEW_ROWS { " few" } else { "" };
    let wide = if is_wide(data) { " wide" } else { "" };
    format!(
        "<p class=\"caption{wide}\">{0}</p><div class=\"table{few}{wide}\" tabindex=\"0\" role=\"group\" \
         aria-label=\"{0}\"><table aria-label=\"{0}\">\n<thead><tr>{headings}</tr></thead>\n<tbody>\n{1}</tbody></table></div>",
        escape(&data.caption),
        rows.collect::<String>()
    )
}

/// Whether a table needs more than half the page.
pub(super) fn is_wide(data: &DataTable) -> bool {
    let of_numbers = data.of_numbers();
    let columns = (0..data.headings.len()).map(|c| {
        let cells = data.rows.iter().filter_map(|row| row.get(c));
        let cells = cells.map(|cell| cell.plain().chars().count());
        let most = if of_numbers[c] { usize::MAX } else { WORDS };
        let words = data.headings[c].split(' ').map(|word| word.chars().count());
        cells.map(|cell| cell.min(most)).chain(words).max().unwrap_or(0) + BETWEEN
    });
    columns.sum::<usize>() > HALF
}

/// Class of a row's name that is short enough to stay on one line.
fn short(name: &Text) -> &'static str {
    if name.plain().chars().count() <= 24 { " class=\"short\"" } else { "" }
}
