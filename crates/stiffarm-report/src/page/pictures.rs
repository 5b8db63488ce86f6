//! The pictures of a page, for papers.

use super::{Block, Page};
use crate::figure::Figure;
use crate::figure::drawing::Drawing;

/// Every chart and every drawing of the results, in the order of the page. Those
/// of the comparison before them are the same ones again and left out. On a page
/// of several results, ids begin with the result's name.
pub fn pictures(page: &Page) -> (Vec<Figure>, Vec<Drawing>) {
    let (mut figures, mut drawings) = (Vec::new(), Vec::new());
    for part in &page.parts {
        let (first_figure, first_drawing) = (figures.len(), drawings.len());
        for section in &part.sections {
            collect(&section.blocks, &mut figures, &mut drawings);
        }
        if page.parts.len() > 1 {
            let stem = part.name.rsplit(['/', '\\']).next().unwrap_or_default();
            let stem = stem.strip_suffix(".json").unwrap_or(stem);
            let ids = figures[first_figure..].iter_mut().map(|f| &mut f.id);
            let others = drawings[first_drawing..].iter_mut().map(|d| &mut d.id);
            ids.chain(others).for_each(|id| *id = format!("{stem}-{id}"));
        }
    }
    (figures, drawings)
}

fn collect(blocks: &[Block], figures: &mut Vec<Figure>, drawings: &mut Vec<Drawing>) {
    for block in blocks {
        match block {
            Block::Figure(figure) => figures.push(figure.clone()),
            Block::Figures(several) => figures.extend_from_slice(several),
            Block::Drawing(drawing) | Block::Scene(_, Some(drawing)) => {
                drawings.push(drawing.clone());
            }
            Block::Details(_, inner) => collect(inner, figures, drawings),
            Block::Scene(_, None)
            | Block::Text(_)
            | Block::List(_)
            | Block::Lines(_)
            | Block::Table(_)
            | Block::Findings(_) => {}
        }
    }
}
