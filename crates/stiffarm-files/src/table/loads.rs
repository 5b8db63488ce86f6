//! The force of each load state, where its name or the cell tells: a sheet is filled in with
//! it, and a table read without `load_n` has what its names say.

use stiffarm::model::load::Load;
use stiffarm::model::measurement::Role;

/// A bare number below this counts states, as in `loaded-2`; it is no force \[N\].
const SMALLEST_BARE: f64 = 10.0;

/// Nor is one below this part of the cell's own force.
const SMALLEST_PART: f64 = 0.05;

/// The forces of `states` \[N\]: the number in a state's name, or the cell's own where the
/// state is the only one under its load. `None` where neither is certain.
pub(super) fn planned(states: &[String], load: &Load) -> Vec<Option<f64>> {
    states.iter().map(|state| planned_load(state, states, load)).collect()
}

fn planned_load(state: &str, states: &[String], load: &Load) -> Option<f64> {
    let (state_load, rest) = load_of(state, load)?;
    let size = state_load.size()?;
    let alone = || {
        let mut others = states.iter().filter(|s| Role::of(s) == Role::Loaded);
        Role::of(state) == Role::Loaded
            && others.all(|s| s == state || !load_of(s, load).is_some_and(|(of, _)| std::ptr::eq(of, state_load)))
    };
    match number(rest, size) {
        Number::None if alone() => Some(size),
        digits => digits.force(size),
    }
}

/// The force that the name of a state says \[N\], where it is one that the cell's load can have.
pub(super) fn named(state: &str, load: &Load) -> Option<f64> {
    let (state_load, rest) = load_of(state, load)?;
    let size = state_load.size()?;
    number(rest, size).force(size)
}

/// The load that a state is under, and what its name says beside the load's own name.
fn load_of<'s, 'l>(state: &'s str, load: &'l Load) -> Option<(&'l Load, &'s str)> {
    if Role::of(state) == Role::Unloaded {
        return None;
    }
    match load.cases() {
        [] => Some((load, state)),
        cases => {
            let case = cases.iter().find(|case| case.is_of(state))?;
            Some((&case.load, state.strip_prefix(case.name.as_str())?))
        }
    }
}

/// What the digits in a name say.
#[derive(Debug, PartialEq)]
enum Number {
    /// There are none, or they count states.
    None,
    /// One force \[N\].
    Force(f64),
    /// Something that may be a force, or not.
    Unclear,
}

impl Number {
    /// The force, where it is not above that of the cell's load, `size`.
    fn force(self, size: f64) -> Option<f64> {
        match self {
            Number::Force(force) if force <= size => Some(force),
            _ => None,
        }
    }
}

fn number(name: &str, size: f64) -> Number {
    let digit = |c: char| c.is_ascii_digit();
    let Some(start) = name.find(digit) else {
        return Number::None;
    };
    let rest = &name[start..];
    let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
    let (digits, behind) = rest.split_at(end);
    let Ok(value) = digits.parse::<f64>() else {
        return Number::Unclear;
    };
    if behind.contains(digit) || name[..start].ends_with(['.', ',']) {
        return Number::Unclear;
    }
    let letters = |c: char| c.is_alphabetic() || c == '%';
    let unit: String = behind.trim_start_matches([' ', '_', '-']).chars().take_while(|c| letters(*c)).collect();
    let parted = behind.starts_with([' ', '_', '-']);
    match unit.to_lowercase().as_str() {
        "n" | "newton" if value > 0.0 => Number::Force(value),
        "kn" if value > 0.0 => Number::Force(1000.0 * value),
        "" => bare(value, size),
        // `250-up`: a word behind the number, not a unit of it.
        "up" | "down" if parted => bare(value, size),
        _ => Number::Unclear,
    }
}

fn bare(value: f64, size: f64) -> Number {
    if value >= SMALLEST_BARE && value >= SMALLEST_PART * size { Number::Force(value) } else { Number::None }
}
