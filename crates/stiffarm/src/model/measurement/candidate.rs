//! Postures to choose from, each under the wrench that it is measured with.

use super::MeasuredPosture;
use crate::error::Result;
use crate::model::load::Wrench;
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
}

impl Candidate {
    /// Everything of this posture that an index needs.
    ///
    /// # Errors
    /// As [`PostureTerms::new`].
    pub fn terms(&self, setup: &Setup) -> Result<PostureTerms> {
        PostureTerms::new(setup, &self.q, self.wrench.as_ref())
    }

    /// The same under each load of the setup, or under the wrench that is its own.
    ///
    /// # Errors
    /// As [`PostureTerms::new`].
    pub fn states(&self, setup: &Setup) -> Result<Vec<PostureTerms>> {
        match self.wrench {
            Some(_) => Ok(vec![self.terms(setup)?]),
            None => {
                let cases = setup.cases();
                cases.iter().map(|case| self.terms(case)).collect()
            }
        }
    }

    /// The postures of an experiment in their order; of several load states of one, that
    /// under the largest force.
    pub fn of_measured(measured: &[MeasuredPosture]) -> Vec<Candidate> {
        let force = |wrench: &Option<Wrench>| wrench.map_or(0.0, |w| w.force.norm());
        let mut out: Vec<Candidate> = Vec::new();
        for own in measured.iter().filter(|own| !own.displacements.is_empty()) {
            let known = out.iter_mut().find(|c| c.name == own.posture.name);
            match known {
                Some(known) if force(&own.wrench) > force(&known.wrench) => {
                    known.wrench = own.wrench;
                }
                Some(_) => {}
                None => out.push(Candidate {
                    name: own.posture.name.clone(),
                    q: own.posture.q.clone(),
                    wrench: own.wrench,
                }),
            }
        }
        out
    }
}
