//! The recommended group of a study in its cell.

use crate::cell::{Full, cell_drawing};
use crate::figure::drawing::Drawing;
use stiffarm::Result;
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::PostureGroup;
use stiffarm::study::{Study, StudyGroup};

/// The cell at the postures of the recommended group, or of the last group where none is
/// recommended; `None` for a study without groups.
///
/// # Errors
/// As [`cell_drawing`], for a cell other than the study's.
pub fn cell_picture(study: &Study, cell: &Cell) -> Result<Option<Drawing>> {
    let is_recommended = |group: &&StudyGroup| {
        let index = group.selection.as_ref().map(|selection| selection.index);
        index.is_some() && index == study.recommended
    };
    let recommended = study.groups.iter().find(is_recommended);
    let Some(group) = recommended.or(study.groups.last()) else {
        return Ok(None);
    };
    let postures = PostureGroup::from_angles(&group.name, group.postures.clone()).postures;
    let mut drawing = cell_drawing(cell, &postures, Full::Tightest)?;
    drawing.title = format!("{}: {}", study.cell, group.name);
    drawing.caption = format!("Postures of {}. {}", group.name, drawing.caption);
    Ok(Some(drawing))
}
