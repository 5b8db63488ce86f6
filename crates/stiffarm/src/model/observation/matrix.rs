//! Ψ of many postures.

use super::{PostureTerms, Setup};
use crate::error::{Code, Error, Result};
use crate::numerics::jobs;
use nalgebra::{DMatrix, Vector3};

/// Which rows a measuring point gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rows {
    /// Translations x, y, z \[m\]: 3 rows (the paper's choice, Section IV).
    Translations,
    /// Translations and rotations: 6 rows; the rotations are multiplied by
    /// `length` \[m\] so that all rows share one unit.
    FullPose {
        /// Length that weighs radians against metres \[m\].
        length: f64,
    },
}

impl Rows {
    fn per_point(self) -> usize {
        match self {
            Rows::Translations => 3,
            Rows::FullPose { .. } => 6,
        }
    }
}

/// Observation matrix of several postures (controller angles, rad), stacked
/// posture by posture: (3m · postures) × n for [`Rows::Translations`],
/// (6m · postures) × n for [`Rows::FullPose`]; where there are load cases, the rows of a
/// posture are as many times more, load by load.
///
/// # Errors
/// As [`PostureTerms::new`]; a length that is not above zero.
#[doc(alias = "regressor")]
#[doc(alias = "identification Jacobian")]
pub fn observation_matrix<Q: AsRef<[f64]>>(setup: &Setup, postures: &[Q], rows: Rows) -> Result<DMatrix<f64>> {
    let (height, width) = observation_shape(setup, postures.len(), rows);
    let postures: Vec<&[f64]> = postures.iter().map(AsRef::as_ref).collect();
    let mut psi = DMatrix::zeros(height, width);
    fill_observation_matrix(setup, &postures, rows, psi.as_mut_slice())?;
    Ok(psi)
}

/// Rows and columns of [`observation_matrix`] of so many postures.
pub fn observation_shape(setup: &Setup, postures: usize, rows: Rows) -> (usize, usize) {
    let states = postures * setup.load.cases().len().max(1);
    (rows.per_point() * setup.tool.point_count() * states, setup.robot.spring_count())
}

/// Postures of one job.
const JOB: usize = 256;

/// [`observation_matrix`] into `psi`, column by column, of [`observation_shape`].
///
/// # Errors
/// As [`observation_matrix`]; another size.
pub fn fill_observation_matrix(setup: &Setup, postures: &[&[f64]], rows: Rows, psi: &mut [f64]) -> Result<()> {
    if let Rows::FullPose { length } = rows
        && !(length.is_finite() && length > 0.0)
    {
        return Err(Error::invalid("The length that weighs rotations against translations must be above zero."));
    }
    let (height, width) = observation_shape(setup, postures.len(), rows);
    if psi.len() != height * width {
        let message = format!("{} numbers for a matrix of {height} × {width}.", psi.len());
        return Err(Error::new(Code::Dimension, message));
    }
    if psi.is_empty() {
        return Ok(());
    }
    let setups = setup.cases();
    let (one, _) = observation_shape(setup, 1, rows);
    let mut parts: Vec<Part> = postures.chunks(JOB).map(|postures| Part { postures, columns: Vec::new() }).collect();
    for column in psi.chunks_exact_mut(height) {
        for (part, rows) in parts.iter_mut().zip(column.chunks_mut(JOB * one)) {
            part.columns.push(rows);
        }
    }
    jobs::each(parts, |part| fill(&setups, rows, part))
}

/// Some of the postures, and their rows of each column of Ψ.
struct Part<'a> {
    postures: &'a [&'a [f64]],
    columns: Vec<&'a mut [f64]>,
}

/// Fills in the rows of a part under each load, in the terms of one place in memory.
fn fill(setups: &[Setup], rows: Rows, part: Part<'_>) -> Result<()> {
    let Part { postures, mut columns } = part;
    let mut terms = PostureTerms::memory(&setups[0]);
    let states = postures.iter().flat_map(|q| setups.iter().map(move |setup| (setup, *q)));
    for (state, (setup, q)) in states.enumerate() {
        terms.move_to(setup, q, None)?;
        let (n, m) = (terms.torque.len(), terms.measuring_points.len());
        if setup.robot.spring_mixing().is_none() {
            // Ψ_ij = J^m_ij Γ_j, Eq. (11).
            let shift = |a: usize, j: usize| terms.columns[a * n + j] * terms.torque[j];
            put(rows, state, &mut columns, m, shift, |j| terms.frames.axes()[j] * terms.torque[j]);
        } else {
            let (shifts, turns) = (terms.block(&setup.robot), terms.rotation_block(&setup.robot));
            let shift = |a: usize, j: usize| shifts.fixed_view::<3, 1>(3 * a, j).into_owned();
            put(rows, state, &mut columns, m, shift, |j| turns.fixed_view::<3, 1>(0, j).into_owned());
        }
    }
    Ok(())
}

/// Puts the shift of each point and the turn by each spring into the rows of one state.
fn put(
    rows: Rows,
    state: usize,
    columns: &mut [&mut [f64]],
    points: usize,
    shift: impl Fn(usize, usize) -> Vector3<f64>,
    turn: impl Fn(usize) -> Vector3<f64>,
) {
    let one = rows.per_point() * points;
    for (j, column) in columns.iter_mut().enumerate() {
        let (places, _) = column[one * state..one * (state + 1)].as_chunks_mut::<3>();
        match rows {
            Rows::Translations => places.iter_mut().enumerate().for_each(|(a, place)| *place = shift(a, j).into()),
            Rows::FullPose { length } => {
                for (a, both) in places.chunks_exact_mut(2).enumerate() {
                    both[0] = shift(a, j).into();
                    both[1] = (turn(j) * length).into();
                }
            }
        }
    }
}
