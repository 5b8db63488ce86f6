//! A scene from the side, from above and in perspective: arm, tool, load, what stands around, limits
//! and beams at one posture, the arm at the others, and in red what violates a limit.

mod camera;
mod elements;
mod key;
mod notes;
mod outline;
mod usual;
mod view;

pub use usual::usual_posture;

use crate::figure::drawing::Drawing;
use crate::scene::arm::Arm;
use crate::scene::stage::Stage;
use crate::scene::{Scene, SceneGroup, SceneOptions, scene};
use camera::Camera;
use elements::Elements;
use stiffarm::Result;
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::Posture;
use stiffarm::plan::select::repeats;

/// Which posture is drawn in full; the others are lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Full {
    /// The one whose smallest margin is smallest.
    Tightest,
    /// This one, by its number from 0.
    Number(usize),
    /// None: all are lines.
    None,
}

/// Draws a cell at these postures: [`Scene::drawing`] where nothing else is made of the scene.
///
/// # Errors
/// As [`scene`].
pub fn cell_drawing(cell: &Cell, postures: &[Posture], full: Full) -> Result<Drawing> {
    let scene = scene(cell, &[SceneGroup::new("", postures)], &SceneOptions::default())?;
    Ok(scene.drawing(None, full))
}

impl Scene {
    /// The scene as a drawing at the postures of one group, or of all, which are counted through the groups.
    pub fn drawing(&self, group: Option<usize>, full: Full) -> Drawing {
        let groups = self.groups.iter().enumerate().filter(|(number, _)| group.is_none_or(|group| group == *number));
        let arms: Vec<Arm<'_>> =
            groups.flat_map(|(_, group)| &group.postures).map(|posture| Arm::of(self, posture)).collect();
        let number = match full {
            Full::None => None,
            Full::Number(number) => (number < arms.len()).then_some(number),
            Full::Tightest => {
                let least = arms.iter().map(|arm| arm.posture.least()).enumerate();
                least.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(number, _)| number)
            }
        };
        let arm = number.map(|number| &arms[number]);
        let stage = Stage::of(self, &arms, arm);
        let others = others(&arms, number);
        let lines = others.iter().map(|same| {
            let red = same.iter().any(|number| arms[*number].posture.is_outside());
            (same[0], &arms[same[0]], red)
        });
        let all = Elements::of(self, &stage, arm, lines);
        let perspective = Camera::perspective(stage.centre(), stage.size());
        let views = vec![
            view::view("from the side", Some(["x", "z"]), &Camera::side(), &stage, &all),
            view::view("from above", Some(["x", "y"]), &Camera::above(), &stage, &all),
            view::view("in perspective", None, &perspective, &stage, &all),
        ];
        let notes = notes::notes(&arms, number, &others, full);
        let sentences: Vec<&str> = notes.iter().map(|note| note.text.as_str()).collect();
        Drawing {
            id: "cell".into(),
            title: self.cell.clone(),
            caption: format!("The cell from the side, from above and in perspective. {}", sentences.join(" ")),
            notes,
            views,
            key: key::key(self, &arms, &others, &all.elements),
        }
    }
}

/// The postures beside the one in full, those together that are the same.
fn others(arms: &[Arm<'_>], full: Option<usize>) -> Vec<Vec<usize>> {
    let angles: Vec<&[f64]> = arms.iter().map(|arm| arm.posture.q.as_slice()).collect();
    let mut groups = repeats(&angles);
    let repeated: Vec<usize> = groups.iter().flatten().copied().collect();
    groups.extend((0..arms.len()).filter(|number| !repeated.contains(number)).map(|number| vec![number]));
    groups.retain(|same| full.is_none_or(|full| !same.contains(&full)));
    groups.sort_by_key(|same| same[0]);
    groups
}
