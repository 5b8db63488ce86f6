//! Postures to choose from, each under the wrench that it is measured with.

use super::MeasuredPosture;
use crate::error::Result;
use crate::model::load::{Load, Wrench};
use crate::model::observation::{PostureTerms, Setup};

/// A posture that may be measured, or was.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Name used in tables.
    pub name: String,
    /// Controller angles \[rad\].
    pub q: Vec<f64>,
    /// Wrench on the robot at the loading point, base axes; `None` where the cell's load
    /// gives it.
    pub wrench: Option<Wrench>,
    /// Where the cell has load cases and the posture was measured: the states that it was measured
    /// in, one per case, with their wrenches. Empty where it is measured under all of them.
    pub states: Vec<(String, Option<Wrench>)>,
}

impl Candidate {
    /// Everything of this posture that an index needs.
    ///
    /// # Errors
    /// As [`PostureTerms::new`].
    pub fn terms(&self, setup: &Setup) -> Result<PostureTerms> {
        PostureTerms::new(setup, &self.q, self.wrench.as_ref())
    }

    /// A posture that may be measured under the cell's load.
    pub fn new(name: impl Into<String>, q: Vec<f64>) -> Self {
        Candidate { name: name.into(), q, wrench: None, states: Vec::new() }
    }

    /// The same under each load of the setup, or under what it was measured with.
    ///
    /// # Errors
    /// As [`PostureTerms::new`].
    pub fn states(&self, setup: &Setup) -> Result<Vec<PostureTerms>> {
        if !self.states.is_empty() {
            let terms = |(state, wrench): &(String, Option<Wrench>)| {
                PostureTerms::new(&*setup.of_state(state)?, &self.q, wrench.as_ref())
            };
            return self.states.iter().map(terms).collect();
        }
        match self.wrench {
            Some(_) => Ok(vec![self.terms(setup)?]),
            None => {
                let cases = setup.cases();
                cases.iter().map(|case| self.terms(case)).collect()
            }
        }
    }

    /// The postures of an experiment with this setup in their order; of several states of one
    /// under one load, that under the largest force.
    pub fn of_measured(setup: &Setup, measured: &[MeasuredPosture]) -> Vec<Candidate> {
        let force = |wrench: &Option<Wrench>| wrench.map_or(0.0, |w| w.force.norm());
        if setup.load.has_cases() {
            return Candidate::under_cases(&setup.load, measured);
        }
        let mut out: Vec<Candidate> = Vec::new();
        for posture in measured.iter().filter(|posture| !posture.displacements.is_empty()) {
            let candidate = out.iter_mut().find(|c| c.name == posture.posture.name);
            match candidate {
                Some(candidate) if force(&posture.wrench) > force(&candidate.wrench) => {
                    candidate.wrench = posture.wrench;
                }
                Some(_) => {}
                None => out.push(Candidate {
                    wrench: posture.wrench,
                    ..Candidate::new(posture.posture.name.clone(), posture.posture.q.clone())
                }),
            }
        }
        out
    }

    /// Each posture with the load cases that it was measured under.
    fn under_cases(load: &Load, measured: &[MeasuredPosture]) -> Vec<Candidate> {
        // A state without a wrench is under the whole load of the cell.
        let force = |wrench: &Option<Wrench>| wrench.map_or(f64::INFINITY, |w| w.force.norm());
        let mut out: Vec<Candidate> = Vec::new();
        for posture in measured.iter().filter(|posture| !posture.displacements.is_empty()) {
            let at = match out.iter().position(|c| c.name == posture.posture.name) {
                Some(at) => at,
                None => {
                    let (name, q) = (posture.posture.name.clone(), posture.posture.q.clone());
                    out.push(Candidate::new(name, q));
                    out.len() - 1
                }
            };
            let case = |state: &str| load.case_of(state).ok();
            let states = &mut out[at].states;
            let state = states.iter_mut().find(|(s, _)| case(s) == case(&posture.state));
            match state {
                Some(state) if force(&posture.wrench) > force(&state.1) => {
                    *state = (posture.state.clone(), posture.wrench);
                }
                Some(_) => {}
                None => states.push((posture.state.clone(), posture.wrench)),
            }
        }
        out
    }
}
