//! The joint stiffness that a calculation starts from: what an identification seals in its
//! result, or the cell's prior.

use crate::error::{Code, Error, Result};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::identify::{implausible_stiffness, quantile};
use crate::findings::{Finding, length};
use crate::model::cell::Cell;
use crate::model::kinematics::Frames;
use crate::model::load::Wrench;
use nalgebra::{DMatrix, Vector3};
use serde::{Deserialize, Serialize};

/// Stands for the cell's prior stiffness where a file name could stand.
pub const PRIOR: &str = "prior";

/// Share of the flange's distance from the base by which the flanges of two robots are apart at least: no calibration
/// of one robot moves it as far.
const OTHER_ROBOT: f64 = 0.02;

/// What later commands calculate with: all that they take from the result of an
/// identification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sealed {
    /// Names of the springs: the first of the values.
    pub springs: Vec<String>,
    /// Where the robot's flange is with every joint at half a radian \[m\], base frame: it tells robots apart.
    #[serde(default)]
    pub flange_m: Option<[f64; 3]>,
    /// What predicts.
    #[serde(flatten)]
    pub predictor: IdentifiedCompliance,
    /// Postures it was identified from.
    pub postures: Vec<String>,
    /// Size of the largest displacement of a point that was seen \[m\]; `None` with the
    /// flange fixed.
    pub largest_displacement_m: Option<f64>,
    /// Size of the largest force that was seen \[N\].
    pub largest_force_n: Option<f64>,
    /// Postures with the loads that were measured; none with the flange fixed.
    #[serde(default)]
    pub loads: Vec<SeenLoad>,
}

/// A load that was measured in a posture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SeenLoad {
    /// Controller angles \[rad\].
    #[serde(rename = "q_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub q: Vec<f64>,
    /// Force on the robot, base axes \[N\].
    pub force_n: [f64; 3],
    /// Moment about the point where it acts, base axes \[N·m\].
    pub moment_nm: [f64; 3],
    /// Where it acts, flange axes \[m\].
    pub at_m: [f64; 3],
}

impl SeenLoad {
    /// That of a posture `q` under a wrench that acts at `point` of the flange frame \[m\].
    pub(crate) fn new(q: &[f64], point: &Vector3<f64>, wrench: &Wrench) -> Self {
        SeenLoad { q: q.to_vec(), force_n: wrench.force.into(), moment_nm: wrench.moment.into(), at_m: (*point).into() }
    }
}

impl Sealed {
    /// Holds the values against the robot of `cell` and against each other.
    ///
    /// # Errors
    /// Another robot's springs; numbers that do not fit each other.
    pub fn check(&self, cell: &Cell) -> Result<()> {
        let robot = &cell.setup.robot;
        let names = robot.spring_names();
        if self.springs != names {
            let message = format!(
                "The stiffness is that of {}, and the cell has {}: it belongs to another robot.",
                self.springs.join(", "),
                names.join(", ")
            );
            return Err(Error::new(Code::ResultFile, message).key("springs"));
        }
        if let Some(flange) = self.flange_m {
            let cell_flange = flange_of(cell);
            let apart = (cell_flange - Vector3::from(flange)).norm();
            if apart > OTHER_ROBOT * cell_flange.norm() {
                let message = format!(
                    "The stiffness belongs to another robot than {}: with every joint at half a radian its flange is \
                     {} from this one's.",
                    robot.name(),
                    length(apart)
                );
                return Err(Error::new(Code::ResultFile, message)
                    .key("flange_m")
                    .hint("give the cell that it was identified in, or identify on this robot"));
            }
        }
        let IdentifiedCompliance { values, extra, undetermined, spread, common, doubts: _ } = &self.predictor;
        let count = values.len();
        let square = |m: &DMatrix<f64>, n: usize| m.nrows() == n;
        let fits = count == names.len() + extra.len()
            && extra.iter().all(|term| term.fits(robot.joint_count()))
            && undetermined.iter().all(|j| *j < count)
            && common.parts.iter().all(|part| part.change.len() == count)
            && common.mean.len() == common.parts.len()
            && square(&common.covariance, common.parts.len())
            && self.loads.iter().all(|load| load.q.len() == robot.joint_count());
        let spread_fits = spread.as_ref().is_none_or(|spread| {
            let doubt = spread.doubt.as_ref();
            square(&spread.covariance, count)
                && quantile(spread.degrees_of_freedom, spread.confidence).is_ok()
                && doubt.is_none_or(|doubt| {
                    let mut classes = doubt.classes.iter();
                    classes.all(|class| class.end <= count)
                        && doubt.prior.len() == count
                        && square(&doubt.covariance, 1 + doubt.classes.len())
                })
        });
        if fits && spread_fits {
            Ok(())
        } else {
            let message = "The numbers of the sealed stiffness do not fit each other.";
            Err(Error::new(Code::ResultFile, message))
        }
    }
}

/// Where the flange is with every joint at half a radian \[m\].
pub(crate) fn flange_of(cell: &Cell) -> Vector3<f64> {
    let robot = &cell.setup.robot;
    Frames::new(robot, &vec![0.5; robot.joint_count()]).flange().translation.vector
}

/// Names, each once.
pub(crate) fn once<'a>(names: impl Iterator<Item = &'a String>) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for name in names {
        if !out.contains(name) {
            out.push(name.clone());
        }
    }
    out
}

/// A stiffness as `identify` saved it.
#[derive(Debug, Clone, PartialEq)]
pub struct Saved {
    /// What calculates displacements.
    pub predictor: IdentifiedCompliance,
    /// Postures it was identified from.
    pub postures: Vec<String>,
    /// Their controller angles \[rad\]; empty where they are not known.
    pub angles: Vec<Vec<f64>>,
    /// SHA-256 of the cell it was identified in.
    pub cell: Option<String>,
    /// Size of the largest displacement of a point in the identification \[m\].
    pub largest_displacement: Option<f64>,
    /// Size of the largest force in the identification \[N\].
    pub largest_force: Option<f64>,
    /// Postures with the loads that were measured, where they are known.
    pub loads: Vec<SeenLoad>,
    /// Name of the file, or `prior`.
    pub name: String,
}

impl Saved {
    /// What was sealed in the file `name`, in a cell with this SHA-256.
    pub fn new(sealed: Sealed, cell: Option<String>, name: &str) -> Self {
        Saved {
            predictor: sealed.predictor,
            postures: sealed.postures,
            angles: Vec::new(),
            cell,
            largest_displacement: sealed.largest_displacement_m,
            largest_force: sealed.largest_force_n,
            loads: sealed.loads,
            name: name.to_string(),
        }
    }

    /// Joint stiffness without anything else \[N·m/rad\], with a doubt where it is far from that of any such robot.
    ///
    /// # Errors
    /// As [`IdentifiedCompliance::from_stiffness`].
    pub fn bare(cell: &Cell, stiffness: &[f64], name: &str) -> Result<Self> {
        let mut predictor = IdentifiedCompliance::from_stiffness(cell, stiffness)?;
        let doubt = implausible_stiffness(cell, stiffness);
        predictor.doubts.extend(doubt);
        Ok(Saved {
            predictor,
            postures: Vec::new(),
            angles: Vec::new(),
            cell: None,
            largest_displacement: None,
            largest_force: None,
            loads: Vec::new(),
            name: name.to_string(),
        })
    }

    /// The cell's prior stiffness, without covariance.
    ///
    /// # Errors
    /// A cell without prior.
    pub fn prior(cell: &Cell) -> Result<Self> {
        Saved::bare(cell, cell.require_prior()?, PRIOR)
    }

    /// A caution where the stiffness was identified in another version of the cell than the one with this SHA-256.
    pub fn of_another_cell(&self, cell: Option<&str>) -> Option<Finding> {
        let is_other = self.cell.is_some() && self.cell.as_deref() != cell;
        let sentence = "The stiffness was identified with another version of this cell.";
        is_other.then(|| Finding::caution("other-cell", "stiffness", sentence))
    }
}
