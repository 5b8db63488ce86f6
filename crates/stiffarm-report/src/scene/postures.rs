//! A cell at one posture after the other.

use super::data::{Closest, SceneLoad, ScenePosture};
use super::limits::{least_room, sentences, violated_parts};
use super::numbers::{Triple, pose};
use stiffarm::Result;
use stiffarm::model::cell::{Cell, PostureMargins};
use stiffarm::model::load::{Load, Wrench};
use stiffarm::model::observation::{PostureTerms, Setup};
use stiffarm::model::posture::Posture;
use stiffarm::model::stiffness::{Model, displacement_between, equilibrium, joint_compliance, linear_displacement};
use stiffarm::nalgebra::{DVector, Vector3, Vector6};

/// What is asked of every posture, made ready once.
pub(super) struct AtPostures<'a> {
    cell: &'a Cell,
    setups: Vec<Setup>,
    margins: PostureMargins<'a>,
    stiffness: Option<&'a [f64]>,
    model: Model,
    /// Number of bodies before those of the cell's scene.
    robot_bodies: usize,
}

impl<'a> AtPostures<'a> {
    pub(super) fn new(cell: &'a Cell, stiffness: Option<&'a [f64]>, model: Model, robot_bodies: usize) -> Result<Self> {
        if let Some(stiffness) = stiffness {
            joint_compliance(&cell.setup.robot, stiffness)?;
        }
        let (setups, margins) = (cell.setup.cases(), cell.posture_margins()?);
        Ok(AtPostures { cell, setups, margins, stiffness, model, robot_bodies })
    }

    /// A posture as data, under `wrench` where the load is measured and that is known.
    pub(super) fn at(&mut self, posture: &Posture, wrench: Option<&Wrench>) -> Result<ScenePosture> {
        let is_measured = self.cell.setup.load == Load::Measured;
        let none = Wrench::force(Vector3::zeros());
        let any = wrench.or(is_measured.then_some(&none));
        let terms = PostureTerms::new(&self.setups[0], &posture.q, any)?;
        let mut loads = Vec::new();
        if wrench.is_some() || !is_measured {
            for setup in &self.setups {
                loads.push(self.load(setup, posture, wrench)?);
            }
        }
        let margins = self.margins.named(&posture.q)?;
        let violated = violated_parts(self.cell, &margins);
        let scene = &self.cell.scene;
        Ok(ScenePosture {
            name: posture.name.clone(),
            q: posture.q.clone(),
            links: terms.frames().links().iter().map(pose).collect(),
            loads,
            seen: scene.seen_by_each(&terms).into_iter().map(|s| s.points).collect(),
            best_station: scene.seen(&terms).map(|s| s.station),
            closest: scene.closest(&terms).map(|pair| Closest {
                names: pair.names,
                distance: pair.distance,
                points: pair.points.map(Triple::from),
            }),
            room: least_room(&margins),
            violated: sentences("It", &margins),
            caution: violated.iter().map(|number| self.robot_bodies + number).collect(),
            margins,
        })
    }

    fn load(&self, setup: &Setup, posture: &Posture, wrench: Option<&Wrench>) -> Result<SceneLoad> {
        let terms = PostureTerms::new(setup, &posture.q, wrench)?;
        // The stiffness is a good one: what fails now is the equilibrium of this posture.
        let bent = self.stiffness.and_then(|k| self.bent(setup, posture, &terms, k, wrench).ok());
        let (turns, deflection) = bent.unzip();
        Ok(SceneLoad {
            force: terms.wrench().force.into(),
            moment: terms.wrench().moment.into(),
            turns,
            deflection: deflection.unwrap_or_default(),
        })
    }

    /// Turns of the joints, and the deflections of loading point and measuring points.
    fn bent(
        &self,
        setup: &Setup,
        posture: &Posture,
        terms: &PostureTerms,
        stiffness: &[f64],
        wrench: Option<&Wrench>,
    ) -> Result<(Vec<f64>, Vec<Triple>)> {
        let points = setup.tool.measuring_points.iter().map(|p| p.position);
        let in_flange = [setup.tool.loading_point].into_iter().chain(points);
        let shift = |moved: Vector6<f64>| [moved[0], moved[1], moved[2]];
        match self.model {
            Model::Equilibrium => {
                let after = equilibrium(setup, &posture.q, stiffness, wrench)?;
                let (from, to) = (terms.frames(), after.frames());
                let shifts = in_flange.map(|point| shift(displacement_between(from, to, &point)));
                Ok((after.deflection.as_slice().to_vec(), shifts.collect()))
            }
            Model::Linear => {
                let torque = DVector::from_column_slice(terms.torque());
                let turns = joint_compliance(&setup.robot, stiffness)? * torque;
                let at = in_flange.map(|point| terms.frames().point(&point));
                let shifts = at.map(|p| Ok(shift(linear_displacement(setup, terms, &p, stiffness, None)?)));
                Ok((turns.as_slice().to_vec(), shifts.collect::<Result<_>>()?))
            }
        }
    }
}
