//! Angles that one can type.

use crate::error::{Error, Result};
use crate::model::cell::{Cell, PostureMargins, Slopes};
use crate::numerics::order::sort_by_number;
use crate::units::{deg_to_rad, rad_to_deg};

/// Room that a posture is given where no neighbour is inside the limits, at first \[m; rad; share\].
const FIRST_ROOM: f64 = 2e-4;
/// Limits that a posture to be rounded may violate: what a search or a file rounds \[m; rad; share\].
const SLACK: f64 = 1e-5;
/// Farthest that a joint is moved to find an allowed posture \[rad\].
const FARTHEST: f64 = 0.02;
/// Times that this room is doubled.
const DOUBLINGS: usize = 8;
/// Steps towards it.
const STEPS: usize = 30;

/// The angle of whole steps next to `q` \[rad\], `up` or down. Steps that divide a degree give
/// decimal numbers of degrees exactly as they are typed.
fn on_step(q: f64, step_deg: f64, up: bool) -> f64 {
    let number = rad_to_deg(q) / step_deg;
    // An angle on a step to rounding stays there.
    let nearest = number.round();
    let number = if (number - nearest).abs() < 1e-6 {
        nearest
    } else if up {
        number.ceil()
    } else {
        number.floor()
    };
    let each = (1.0 / step_deg).round();
    let deg = if (each * step_deg - 1.0).abs() < 1e-9 { number / each } else { number * step_deg };
    // No minus before zero.
    deg_to_rad(deg + 0.0)
}

/// Each angle of `q` rounded to the nearest whole step.
pub(super) fn nearest(q: &[f64], step_deg: f64) -> Vec<f64> {
    let round = |q: &f64| {
        let (low, high) = (on_step(*q, step_deg, false), on_step(*q, step_deg, true));
        if q - low <= high - q { low } else { high }
    };
    q.iter().map(round).collect()
}

/// Postures rounded to whole steps of an angle, for what has them typed in.
pub(super) struct Rounding<'a> {
    cell: &'a Cell,
    margins: PostureMargins<'a>,
    step_deg: f64,
}

impl<'a> Rounding<'a> {
    pub fn new(cell: &'a Cell, step_deg: f64) -> Result<Self> {
        if !(step_deg > 0.0 && step_deg.is_finite()) {
            let message = format!("Angles cannot be rounded to steps of {step_deg}°.");
            return Err(Error::invalid(message).hint("give a step above zero, such as 0.01"));
        }
        Ok(Rounding { cell, margins: cell.posture_margins()?, step_deg })
    }

    fn is_allowed(&mut self, q: &[f64]) -> Result<bool> {
        let inside = self.cell.outside_bounds(q).next().is_none();
        Ok(inside && self.margins.are_met(q)?)
    }

    /// The posture of whole steps that is nearest to `q` and meets bounds and limits of the cell: among
    /// those around `q`, else around a posture that is a little farther inside. `None` where none
    /// was found nearby, or `q` itself violates a limit: what is wrong is not for rounding to mend.
    pub fn inside(&mut self, q: &[f64]) -> Result<Option<Vec<f64>>> {
        if self.cell.outside_bounds(q).next().is_some() || self.margins.least(q)? < -SLACK {
            return Ok(None);
        }
        if let Some(rounded) = self.around(q, q)? {
            return Ok(Some(rounded));
        }
        let mut room = FIRST_ROOM;
        for _ in 0..DOUBLINGS {
            let inner = self.moved_inside(q, room)?;
            let far = |q: &f64, inner: &f64| (q - inner).abs() > FARTHEST;
            if q.iter().zip(&inner).any(|(q, inner)| far(q, inner)) {
                break;
            }
            if let Some(rounded) = self.around(&inner, q)? {
                return Ok(Some(rounded));
            }
            room *= 2.0;
        }
        Ok(None)
    }

    /// Of the postures of whole steps around `centre`, the allowed one nearest to `q`.
    fn around(&mut self, centre: &[f64], q: &[f64]) -> Result<Option<Vec<f64>>> {
        let step = self.step_deg;
        let sides: Vec<[f64; 2]> =
            centre.iter().map(|angle| [on_step(*angle, step, false), on_step(*angle, step, true)]).collect();
        // Only joints between two steps have two sides.
        let free: Vec<usize> = (0..q.len()).filter(|j| sides[*j][0] != sides[*j][1]).collect();
        let mut corners: Vec<(f64, Vec<f64>)> = (0_u32..1 << free.len().min(10))
            .map(|choice| {
                let mut corner: Vec<f64> = nearest(centre, step);
                for (bit, j) in free.iter().enumerate().take(10) {
                    corner[*j] = sides[*j][(choice >> bit & 1) as usize];
                }
                let apart = corner.iter().zip(q).map(|(a, b)| (a - b).powi(2)).sum();
                (apart, corner)
            })
            .collect();
        sort_by_number(&mut corners, |a| a.0);
        for (_, corner) in corners {
            if self.is_allowed(&corner)? {
                return Ok(Some(corner));
            }
        }
        Ok(None)
    }

    /// `q` moved by small steps until every margin has this room, as far as that goes.
    fn moved_inside(&mut self, q: &[f64], room: f64) -> Result<Vec<f64>> {
        let robot = &self.cell.setup.robot;
        let (n, count) = (q.len(), self.margins.count());
        let mut q = q.to_vec();
        let mut values = vec![0.0; count];
        let mut slopes = vec![0.0; count * n];
        let wanted = vec![true; count];
        for _ in 0..STEPS {
            let all = Slopes { rows: &mut slopes, wanted: &wanted };
            self.margins.evaluate(&q, 1.0, &mut values, all)?;
            let worst = (0..count).min_by(|a, b| values[*a].total_cmp(&values[*b]));
            let Some(worst) = worst.filter(|at| values[*at] < room) else {
                break;
            };
            // By θ; the controller's angles are C⁻¹ of it, so their slope is Cᵀ's.
            let by_theta = &slopes[worst * n..(worst + 1) * n];
            let slope: Vec<f64> =
                (0..n).map(|k| (0..n).map(|i| robot.coupling()[(i, k)] * by_theta[i]).sum()).collect();
            let square: f64 = slope.iter().map(|s| s * s).sum();
            if square < 1e-18 {
                break;
            }
            let length = (1.1 * room - values[worst]) / square;
            for ((q, slope), bounds) in q.iter_mut().zip(&slope).zip(&self.cell.bounds) {
                *q = (*q + length * slope).clamp(bounds[0], bounds[1]);
            }
        }
        Ok(q)
    }
}
