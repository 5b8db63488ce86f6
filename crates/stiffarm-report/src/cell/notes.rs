//! What stands below the picture: which posture it shows, and what its limits say.

use super::Full;
use super::usual::{MIDDLE, NEAR_MIDDLE};
use crate::figure::drawing::Note;
use crate::scene::ScenePosture;
use crate::scene::arm::Arm;
use crate::scene::limits::sentences;

/// Most postures whose violations are named one by one.
const MOST: usize = 4;

/// What sentences are about.
fn subject(posture: &ScenePosture) -> String {
    match posture.name.as_str() {
        MIDDLE => "The middle of the bounds".to_string(),
        NEAR_MIDDLE => "The posture".to_string(),
        name => format!("Posture {name}"),
    }
}

/// The notes; `others` are the postures drawn as lines, the same ones together.
pub(super) fn notes(arms: &[Arm<'_>], full: Option<usize>, others: &[Vec<usize>], choice: Full) -> Vec<Note> {
    let postures: Vec<&ScenePosture> = arms.iter().map(|arm| arm.posture).collect();
    let count = postures.len();
    let Some(number) = full else {
        return if count == 0 { Vec::new() } else { notes_of_all(&postures) };
    };
    let shown = postures[number];
    // Neither in full nor beside it: the same as the one in full.
    let same: Vec<&str> = (0..count)
        .filter(|one| *one != number && !others.iter().any(|same| same.contains(one)))
        .map(|one| postures[one].name.as_str())
        .collect();
    let why = match choice {
        Full::Tightest if shown.is_outside() => ", the one that violates its limits most",
        Full::Tightest if shown.least().is_finite() => ", the one with the least room",
        _ => "",
    };
    let mut notes = vec![Note::plain(match (shown.name.as_str(), count) {
        (MIDDLE | NEAR_MIDDLE, _) => format!("Drawn at {}.", shown.name),
        (name, 1) => format!("Drawn at posture {name}."),
        (name, _) if same.is_empty() => {
            format!("In full: posture {name} of {count}{why}. The others as lines.")
        }
        (name, _) => {
            let others = if others.is_empty() { "" } else { " The others as lines." };
            format!("In full: posture {name} of {count}{why}; the same as {}.{others}", same.join(", "))
        }
    })];
    match &shown.room {
        _ if shown.is_outside() => {
            notes.extend(sentences(&subject(shown), &shown.margins).into_iter().map(Note::caution));
        }
        Some(room) => notes.push(Note::plain(format!("It meets its limits. Least room: {room}."))),
        None => notes.push(Note::plain("The cell has no limits to be met.")),
    }
    let outside = postures.iter().enumerate().filter(|(one, posture)| *one != number && posture.is_outside());
    let outside: Vec<&str> = outside.map(|(_, posture)| posture.name.as_str()).collect();
    if !outside.is_empty() {
        notes.push(Note::caution(format!("Ringed in red, a limit violated too: {}.", outside.join(", "))));
    }
    notes
}

/// What the limits say of postures of which none is in full.
fn notes_of_all(postures: &[&ScenePosture]) -> Vec<Note> {
    let mut notes = vec![Note::plain(format!("The arm at {} postures.", postures.len()))];
    let outside: Vec<&&ScenePosture> = postures.iter().filter(|posture| posture.is_outside()).collect();
    for posture in outside.iter().take(MOST) {
        let sentences = sentences(&subject(posture), &posture.margins);
        notes.extend(sentences.into_iter().take(1).map(Note::caution));
    }
    if outside.len() > MOST {
        notes.push(Note::caution(format!("{} more postures violate a limit.", outside.len() - MOST)));
    }
    let tightest = postures.iter().min_by(|a, b| a.least().total_cmp(&b.least()));
    let room = tightest.and_then(|posture| Some((subject(posture), posture.room.as_ref()?)));
    if let (true, Some((subject, room))) = (outside.is_empty(), room) {
        notes.push(Note::plain(format!("All meet their limits. {subject} has the least room: {room}.")));
    }
    notes
}
