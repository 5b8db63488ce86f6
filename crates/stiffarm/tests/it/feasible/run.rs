//! One short selection in a random cell, and what the checker says of it.

use super::cases::Case;
use super::checker::Checker;
use crate::common::prelude::*;
use stiffarm::plan::select::space_filling;

/// What a margin may lack \[m, rad, share\].
const TOLERANCE: f64 = 1e-6;
/// Most that a posture at its limits may be moved for angles that one can type \[rad\].
const MOST_ROUNDED: f64 = 0.02;
/// Random postures where the library finds none, and how many of them may be feasible.
const POSTURES: u64 = 2_000;
const MOST: u64 = 4;
/// Postures at which a pair that is left out is looked at.
const OVERLAPS: u64 = 100;

/// Random postures at which every margin is compared.
const COMPARED: usize = 5;

/// How postures are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mode {
    Global,
    Local,
    Given,
    Candidates,
    SpaceFilling,
}

impl Mode {
    pub const ALL: [Mode; 5] = [Mode::Global, Mode::Local, Mode::Given, Mode::Candidates, Mode::SpaceFilling];
}

/// How a case ended.
#[derive(Debug, Clone, PartialEq)]
pub enum End {
    /// As many feasible postures as asked for.
    Postures(usize),
    /// The library says that nothing meets the limits, and so does the checker.
    Nothing,
    /// The postures cannot determine every joint, so the index does not exist.
    Undetermined,
    /// A station or point lies inside a shape, and the file is refused for it.
    Refused,
    /// What is wrong.
    Fault(String),
}

/// Cell `number` with the mode and the index that belong to it.
pub fn run(number: u64) -> (Mode, Index, End) {
    let mode = Mode::ALL[number as usize % Mode::ALL.len()];
    let index = Index::ALL[number as usize % Index::ALL.len()];
    let case = Case::new(number);
    let index = match index {
        // It counts one load per posture.
        Index::Prediction if case.loads.len() > 1 => Index::ExpectedError,
        index => index,
    };
    let end = ended(number, &case, mode, index).unwrap_or_else(End::Fault);
    (mode, index, end)
}

fn ended(number: u64, case: &Case, mode: Mode, index: Index) -> Result<End, String> {
    let mut checker = Checker::new(case);
    let cell = match parse_cell(&case.text(), "random.toml") {
        Ok(cell) => cell,
        Err(_) if checker.places() < TOLERANCE => return Ok(End::Refused),
        Err(error) => return Err(format!("not read: {error}")),
    };
    if checker.places() < -TOLERANCE {
        return Err("a place inside a shape is not refused".to_string());
    }
    leave_out(&mut checker, case, &cell, number)?;
    let mut dice = Dice::new(90_000 + number);
    for _ in 0..COMPARED {
        checker.compare(&cell, &uniform(&mut dice, case))?;
    }
    let least = match index {
        Index::DropOne => 4,
        _ => 2,
    };
    let count = least + dice.below(7 - least);
    let group = match chosen(&cell, mode, index, count, number) {
        Ok(group) => group,
        Err(error) => return refused(&checker, case, number, &error),
    };
    if group.len() != count {
        return Err(format!("{} postures instead of {count}", group.len()));
    }
    for q in &group {
        let violated = checker.violated(q, TOLERANCE);
        if !violated.is_empty() {
            return Err(format!("{q:?} violates {}", violated.join(", ")));
        }
    }
    typed(&checker, &cell, &group)?;
    Ok(End::Postures(count))
}

/// Postures at their limits too can be rounded to what one types.
fn typed(checker: &Checker<'_>, cell: &Cell, group: &[Vec<f64>]) -> Result<(), String> {
    let rounded = rounded(cell, group, 0.01).map_err(|error| error.to_string())?;
    for (q, typed) in group.iter().zip(&rounded) {
        let violated = checker.violated(typed, TOLERANCE);
        if !violated.is_empty() {
            return Err(format!("{q:?} rounded violates {}", violated.join(", ")));
        }
        for (q, typed) in q.iter().zip(typed) {
            let steps = typed.to_degrees() * 100.0;
            if (steps - steps.round()).abs() > 1e-6 {
                return Err(format!("{typed} rad is no whole step"));
            }
            if (q - typed).abs() > MOST_ROUNDED {
                return Err(format!("{q} rad is rounded to {typed}"));
            }
        }
    }
    Ok(())
}

/// The postures that a mode gives.
fn chosen(cell: &Cell, mode: Mode, index: Index, count: usize, seed: u64) -> Result<Vec<Vec<f64>>, Error> {
    let control = Control::default();
    let mut options = GlobalOptions::default();
    options.seed = seed;
    options.rounds = Some(1);
    let random = |count: usize, stream: u64| random_group(cell, StartKind::Uniform, count, seed, stream);
    match mode {
        Mode::Global => Ok(select(cell, index, count, &options, control)?.group),
        Mode::Given => {
            options.given = random(2, 1)?;
            Ok(select(cell, index, count, &options, control)?.group)
        }
        Mode::Local => {
            let mut local = LocalOptions::default();
            local.max_iterations = 40;
            Ok(select_from(cell, index, &random(count, 2)?, local, control)?.group)
        }
        Mode::Candidates => {
            // Some that the limits forbid among them.
            let mut list = random(10, 3)?;
            let mut dice = Dice::new(70_000 + seed);
            for _ in 0..10 {
                let bounds = cell.bounds.iter();
                list.push(bounds.map(|b| dice.between(b[0], b[1])).collect());
            }
            let list = list.into_iter().enumerate();
            let list = list.map(|(i, q)| Candidate::new(i.to_string(), q));
            let list: Vec<Candidate> = list.collect();
            let mut options = CandidateOptions::default();
            options.starts = 4;
            let selection = select_candidates(cell, index, count, &list, &options, control)?;
            let mut each = selection.chosen.clone();
            each.dedup();
            Ok(each.iter().map(|i| list[*i].q.clone()).collect())
        }
        Mode::SpaceFilling => Ok(space_filling(cell, count, seed, control)?.postures),
    }
}

/// Takes the pairs that the library leaves out from the checker's, where the rules allow that; the
/// rest must be the library's own.
pub fn leave_out(checker: &mut Checker<'_>, case: &Case, cell: &Cell, number: u64) -> Result<(), String> {
    let kept_apart = case.clearance.shapes.unwrap_or(20.0) * 1e-3;
    let sorted = |(a, b): (&str, &str)| changed([a.to_string(), b.to_string()], |o| o.sort_unstable());
    let dropped: Vec<[String; 2]> = cell.scene.dropped_pairs().map(sorted).collect();
    let mut remaining = Vec::new();
    let mut dice = Dice::new(80_000 + number);
    for pair in checker.pairs.clone() {
        let names = checker.names(pair);
        if !dropped.iter().any(|d| d[0] == names[0] && d[1] == names[1]) {
            remaining.push(pair);
            continue;
        }
        if !checker.may_always_overlap(pair) {
            return Err(format!("{names:?} must not be left out"));
        }
        let apart = (0..OVERLAPS).filter(|_| checker.apart(&uniform(&mut dice, case), pair) > kept_apart).count();
        if apart > 1 {
            return Err(format!("{names:?} is left out and far enough apart {apart} times of {OVERLAPS}"));
        }
    }
    let mut ours: Vec<[String; 2]> = remaining.iter().map(|pair| checker.names(*pair).map(String::from)).collect();
    let mut theirs: Vec<[String; 2]> = cell.scene.pairs().map(sorted).collect();
    ours.sort_unstable();
    theirs.sort_unstable();
    if ours != theirs {
        return Err(format!("pairs differ: {ours:?} {theirs:?}"));
    }
    checker.pairs = remaining;
    Ok(())
}

/// A posture within the bounds \[rad\].
fn uniform(dice: &mut Dice, case: &Case) -> Vec<f64> {
    let bounds = case.bounds.iter();
    bounds.map(|b| dice.between(b[0], b[1]).to_radians()).collect()
}

/// An error that says nothing meets the limits must be right.
fn refused(checker: &Checker<'_>, case: &Case, number: u64, error: &Error) -> Result<End, String> {
    if error.code() == Code::NotIdentifiable {
        return Ok(End::Undetermined);
    }
    if error.place().key.as_deref() != Some("limits") {
        return Err(format!("unexpected: {error}"));
    }
    let mut dice = Dice::new(60_000 + number);
    let feasible = (0..POSTURES).filter(|_| checker.meets(&uniform(&mut dice, case), 0.0)).count();
    if feasible as u64 > MOST {
        Err(format!("{feasible} of {POSTURES} random postures do, but: {error}"))
    } else {
        Ok(End::Nothing)
    }
}
