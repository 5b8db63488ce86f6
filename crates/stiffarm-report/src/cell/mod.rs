//! A cell from the side, from above and in perspective: arm, tool, load, what stands around, limits
//! and beams at one posture, the arm at the others, and in red what violates a limit.

mod camera;
pub(crate) mod cautions;
mod key;
mod outline;
pub(crate) mod stage;
mod things;
mod view;

use crate::figure::drawing::{Drawing, Note};
use camera::Camera;
use cautions::{Cautions, least_room, sentences};
use stage::Stage;
use stiffarm::Result;
use stiffarm::model::cell::{Cell, LimitMargin};
use stiffarm::model::load::{Load, Wrench};
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::posture::Posture;
use stiffarm::nalgebra::Vector3;
use stiffarm::plan::select::repeats;
use things::Things;

/// Names of postures of a cell without postures.
const MIDDLE: &str = "the middle of the bounds";
const NEAR_MIDDLE: &str = "a posture near the middle of the bounds";
/// Postures around the middle of the bounds that are tried.
const TRIED: u32 = 2048;
/// Most postures whose violations are told one by one.
const MOST_TOLD: usize = 4;

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

/// A posture with what its limits say.
struct Looked<'a> {
    posture: &'a Posture,
    terms: PostureTerms,
    margins: Vec<LimitMargin>,
}

impl Looked<'_> {
    fn least(&self) -> f64 {
        let margins = self.margins.iter().map(|m| m.margin);
        margins.fold(f64::INFINITY, f64::min)
    }

    /// True where a limit is violated.
    fn is_outside(&self) -> bool {
        self.margins.iter().any(LimitMargin::is_violated)
    }

    /// What sentences are about.
    fn subject(&self) -> String {
        match self.posture.name.as_str() {
            MIDDLE => "The middle of the bounds".to_string(),
            NEAR_MIDDLE => "The posture".to_string(),
            name => format!("Posture {name}"),
        }
    }
}

/// The posture that shows a cell without a plan: the middle of its bounds; where that violates a
/// limit, the first validation posture that does not, else the first such posture as one looks
/// farther and farther around the middle. Where all violate a limit, the middle after all.
///
/// # Errors
/// Terms that cannot be computed in the middle of the bounds.
pub fn usual_posture(cell: &Cell) -> Result<Posture> {
    let meets = |posture: &Posture| look(cell, posture).is_ok_and(|one| !one.is_outside());
    let named = |name: &str, q: Vec<f64>| Posture { name: name.to_string(), q };
    let bounds = &cell.bounds;
    let middle = named(MIDDLE, bounds.iter().map(|[a, b]| 0.5 * (a + b)).collect());
    if !look(cell, &middle)?.is_outside() {
        return Ok(middle);
    }
    if let Some(fits) = cell.validation.iter().find(|p| meets(p)) {
        return Ok(fits.clone());
    }
    // Powers of the root of x^(n+1) = x + 1: their multiples spread evenly in n dimensions (Roberts).
    let dimensions = bounds.len() as f64 + 1.0;
    let root = (0..40).fold(1.5_f64, |x, _| (1.0 + x).powf(1.0 / dimensions));
    let around = (1..=TRIED).map(|i| {
        let reach = f64::from(i) / f64::from(TRIED);
        let q = bounds.iter().enumerate().map(|(j, [a, b])| {
            let share = (f64::from(i) / root.powf(j as f64 + 1.0)).fract() - 0.5;
            0.5 * (a + b) + (b - a) * share * reach
        });
        named(NEAR_MIDDLE, q.collect())
    });
    let mut around = around.filter(|posture| meets(posture));
    Ok(around.next().unwrap_or(middle))
}

/// Draws a cell at these postures.
///
/// # Errors
/// A posture whose angles do not fit the robot, or whose loading point lies on the rope's anchor.
pub fn cell_drawing(cell: &Cell, postures: &[Posture], full: Full) -> Result<Drawing> {
    let looked = postures.iter().map(|posture| look(cell, posture)).collect::<Result<Vec<_>>>()?;
    let shown = match full {
        Full::None => None,
        Full::Number(number) => (number < looked.len()).then_some(number),
        Full::Tightest => (0..looked.len()).min_by(|a, b| looked[*a].least().total_cmp(&looked[*b].least())),
    };
    let all: Vec<PostureTerms> = looked.iter().map(|l| l.terms.clone()).collect();
    let stage = Stage::of(cell, &all, shown);
    let cautions = shown.map_or_else(|| Cautions::of(cell, &[]), |number| Cautions::of(cell, &looked[number].margins));
    let mut things = Things::default();
    let from = shown.map_or(stage.centre(), |number| *all[number].loading_point());
    things.add_surroundings(cell, &stage, &cautions, from);
    let others = others(postures, shown);
    for same in &others {
        let red = same.iter().any(|number| looked[*number].is_outside());
        things.add_other(same[0], &all[same[0]], red);
    }
    if let Some(number) = shown {
        things.add_shown(cell, &stage, &looked[number].terms, &cautions);
    }
    let perspective = Camera::perspective(stage.centre(), stage.size());
    let views = vec![
        view::view("from the side", Some(["x", "z"]), &Camera::side(), &stage, &things),
        view::view("from above", Some(["x", "y"]), &Camera::above(), &stage, &things),
        view::view("in perspective", None, &perspective, &stage, &things),
    ];
    let notes = notes(&looked, shown, &others, full);
    let told: Vec<&str> = notes.iter().map(|note| note.text.as_str()).collect();
    Ok(Drawing {
        id: "cell".into(),
        title: cell.name.clone(),
        caption: format!("The cell from the side, from above and in perspective. {}", told.join(" ")),
        notes,
        views,
        key: key::key(cell, &looked, &others, &things),
    })
}

/// The postures beside the one in full, those together that are the same.
fn others(postures: &[Posture], shown: Option<usize>) -> Vec<Vec<usize>> {
    let repeated = repeats(postures);
    let group = |number: usize| {
        let mut groups = repeated.iter();
        let found = groups.find(|same| same.contains(&number));
        found.cloned().unwrap_or_else(|| vec![number])
    };
    let groups = (0..postures.len()).map(|number| (number, group(number)));
    let first = groups.filter(|(number, same)| same.first() == Some(number));
    let groups = first.map(|(_, same)| same);
    groups.filter(|same| shown.is_none_or(|shown| !same.contains(&shown))).collect()
}

fn look<'a>(cell: &Cell, posture: &'a Posture) -> Result<Looked<'a>> {
    // A measured load needs some force here; limits on places do not depend on it.
    let unit = Wrench::force(Vector3::x());
    let wrench = (cell.setup.load == Load::Measured).then_some(&unit);
    let setups = cell.setup.cases();
    let terms = PostureTerms::new(&setups[0], &posture.q, wrench)?;
    let margins = cell.posture_margins()?.named(&posture.q)?;
    Ok(Looked { posture, terms, margins })
}

/// What stands below the picture: which posture it shows, and what its limits say.
fn notes(looked: &[Looked<'_>], shown: Option<usize>, others: &[Vec<usize>], full: Full) -> Vec<Note> {
    let mut notes = Vec::new();
    let count = looked.len();
    let Some(one) = shown.and_then(|number| looked.get(number)) else {
        if count == 0 {
            return notes;
        }
        notes.push(Note::plain(format!("The arm at {count} postures.")));
        notes.extend(notes_of_all(looked));
        return notes;
    };
    // Neither in full nor beside it: the same as the one in full.
    let drawn_apart = |number: &usize| others.iter().any(|same| same.contains(number));
    let same: Vec<&str> = (0..count)
        .filter(|number| Some(*number) != shown && !drawn_apart(number))
        .map(|number| looked[number].posture.name.as_str())
        .collect();
    let why = match full {
        Full::Tightest if one.is_outside() => ", the one that violates its limits most",
        Full::Tightest if one.least().is_finite() => ", the one with the least room",
        _ => "",
    };
    notes.push(Note::plain(match (one.posture.name.as_str(), count) {
        (MIDDLE | NEAR_MIDDLE, _) => format!("Drawn at {}.", one.posture.name),
        (name, 1) => format!("Drawn at posture {name}."),
        (name, _) if same.is_empty() => {
            format!("In full: posture {name} of {count}{why}. The others as lines.")
        }
        (name, _) => {
            let others = if others.is_empty() { "" } else { " The others as lines." };
            format!("In full: posture {name} of {count}{why}; the same as {}.{others}", same.join(", "))
        }
    }));
    let violated = sentences(&one.subject(), &one.margins);
    match (violated.is_empty(), least_room(&one.margins)) {
        (false, _) => notes.extend(violated.into_iter().map(Note::caution)),
        (true, Some(room)) => notes.push(Note::plain(format!("It meets its limits. Least room: {room}."))),
        (true, None) => notes.push(Note::plain("The cell has no limits to be met.")),
    }
    let mut outside: Vec<&str> = Vec::new();
    for (number, other) in looked.iter().enumerate() {
        if Some(number) != shown && other.is_outside() {
            outside.push(&other.posture.name);
        }
    }
    if !outside.is_empty() {
        notes.push(Note::caution(format!("Ringed in red, a limit violated too: {}.", outside.join(", "))));
    }
    notes
}

/// What the limits say of postures of which none is in full.
fn notes_of_all(looked: &[Looked<'_>]) -> Vec<Note> {
    let mut notes = Vec::new();
    let outside: Vec<&Looked<'_>> = looked.iter().filter(|one| one.is_outside()).collect();
    for one in outside.iter().take(MOST_TOLD) {
        let sentences = sentences(&one.subject(), &one.margins);
        notes.extend(sentences.into_iter().take(1).map(Note::caution));
    }
    if outside.len() > MOST_TOLD {
        let rest = outside.len() - MOST_TOLD;
        notes.push(Note::caution(format!("{rest} more postures violate a limit.")));
    }
    let tightest = looked.iter().min_by(|a, b| a.least().total_cmp(&b.least()));
    let room = tightest.and_then(|one| Some((one.subject(), least_room(&one.margins)?)));
    if let (true, Some((subject, room))) = (outside.is_empty(), room) {
        notes.push(Note::plain(format!("All meet their limits. {subject} has the least room: {room}.")));
    }
    notes
}
