//! What has changed between two programs.

use super::{Language, Move, MoveKind, Program, Step, text};
use serde::Serialize;
use stiffarm::units::rad_to_deg;

/// One difference between a program as planned and one that was read.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Difference {
    /// The program has no move to a planned posture.
    Missing {
        /// Its name.
        posture: String,
    },
    /// The program has a move that was not planned.
    Added {
        /// Its name.
        posture: String,
    },
    /// The program goes there at another point of its order.
    Order {
        /// Its name.
        posture: String,
    },
    /// The program goes on without waiting there.
    NoStop {
        /// Name of the posture.
        posture: String,
    },
    /// A joint goes to another angle.
    Angle {
        /// Name of the posture.
        posture: String,
        /// The joint, counted from 1.
        joint: usize,
        /// As planned \[deg\].
        planned_deg: f64,
        /// As in the program \[deg\].
        found_deg: f64,
    },
    /// A line that is not one of those that are written for the plan.
    Line {
        /// Name of the file.
        file: String,
        /// Counted from 1.
        line: usize,
        /// The line.
        text: String,
    },
    /// A line that is written for the plan is not there.
    MissingLine {
        /// Name of the file.
        file: String,
        /// The line.
        text: String,
    },
}

impl Difference {
    /// One sentence; joints by their names.
    pub fn sentence(&self, joints: &[String]) -> String {
        match self {
            Difference::Missing { posture } => format!("{posture}: the program does not go there"),
            Difference::Added { posture } => format!("{posture}: not in the plan"),
            Difference::NoStop { posture } => format!("{posture}: the program does not wait there"),
            Difference::Line { file, line, text } => {
                format!("{file}:{line}: not a line that export writes here: {text}")
            }
            Difference::MissingLine { file, text } => {
                format!("{file}: a line that export writes is missing: {text}")
            }
            Difference::Order { posture } => format!("{posture}: at another place of the order"),
            Difference::Angle { posture, joint, planned_deg, found_deg } => {
                let name = joints.get(joint - 1).cloned().unwrap_or_else(|| format!("joint {joint}"));
                format!(
                    "{posture}: {name} at {found_deg:.4}°, planned {planned_deg:.4}°, off by {:.4}°",
                    found_deg - planned_deg
                )
            }
        }
    }
}

/// The postures of a program at which it does not wait for the measurement.
pub fn missing_stops(program: &Program) -> Vec<Difference> {
    let next = program.steps.iter().skip(1).map(Some).chain([None]);
    let pairs = program.steps.iter().zip(next);
    let passed = pairs.filter_map(|(step, next)| match (step, next) {
        (Step::Move(target), Some(Step::Wait(_))) if target.kind == MoveKind::Posture => None,
        (Step::Move(target), _) if target.kind == MoveKind::Posture => Some(target.name.clone()),
        _ => None,
    });
    passed.map(|posture| Difference::NoStop { posture }).collect()
}

/// Compares the moves of a program that was read with those planned. Moves belong together by kind
/// and name, as far as `language` holds names; angles are the same within `tolerance` \[rad\].
pub fn compare_moves(planned: &[&Move], actual: &[&Move], language: Language, tolerance: f64) -> Vec<Difference> {
    let named = |target: &Move| match &language.dialect().syntax {
        Some(syntax) => (target.kind, text::name(&target.name, syntax.name_width)),
        None => (target.kind, target.name.clone()),
    };
    let mut partner: Vec<Option<usize>> = vec![None; actual.len()];
    let mut differences = Vec::new();
    let mut last = 0;
    for (number, target) in planned.iter().enumerate() {
        let target_name = named(target);
        let at = (0..actual.len()).find(|i| partner[*i].is_none() && named(actual[*i]) == target_name);
        let Some(at) = at else {
            differences.push(Difference::Missing { posture: target.name.clone() });
            continue;
        };
        partner[at] = Some(number);
        if at < last {
            differences.push(Difference::Order { posture: target.name.clone() })
        } else {
            last = at
        }
        let pairs = target.q.iter().zip(&actual[at].q).enumerate();
        differences.extend(pairs.filter(|(_, (a, b))| (*a - *b).abs() > tolerance).map(|(j, (a, b))| {
            Difference::Angle {
                posture: target.name.clone(),
                joint: j + 1,
                planned_deg: rad_to_deg(*a),
                found_deg: rad_to_deg(*b),
            }
        }));
    }
    let added = actual.iter().zip(&partner).filter(|(_, partner)| partner.is_none());
    differences.extend(added.map(|(target, _)| Difference::Added { posture: target.name.clone() }));
    differences
}
