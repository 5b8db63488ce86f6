//! What is left of a group without any one of its postures: ln of the expected error in units of σ, and its derivative
//! by the information, four postures at a time.

use super::lanes::{Lanes, WIDTH, ZERO};
use super::{Kernel, Sweep, run};
use crate::numerics::information::small::{cholesky, inverse_from_lower, invert_lower, packed, symmetric_product};

/// The group without each of its postures, batch by batch.
#[derive(Debug, Clone)]
pub(crate) struct LeftOut {
    /// Number of springs.
    n: usize,
    batches: Vec<Batch>,
}

#[derive(Debug, Clone)]
struct Batch {
    /// Information without each posture M, lower triangle row by row; its Cholesky factor, and the inverse of that.
    information: Vec<Lanes>,
    lower: Vec<Lanes>,
    inverse_lower: Vec<Lanes>,
    /// M⁻¹, n × n.
    inverse: Vec<Lanes>,
    /// ½ ln(tr(M⁻¹)/n).
    log_error: Lanes,
    /// Its derivative −½ M⁻²/tr(M⁻¹), n × n.
    adjoint: Vec<Lanes>,
    is_sound: bool,
}

impl LeftOut {
    /// Room for `count` postures and `n` springs.
    pub fn new(n: usize, count: usize) -> Self {
        let (triangle, square) = (vec![ZERO; packed(n, 0)], vec![ZERO; n * n]);
        let batch = Batch {
            information: triangle.clone(),
            lower: triangle.clone(),
            inverse_lower: triangle,
            inverse: square.clone(),
            log_error: ZERO,
            adjoint: square,
            is_sound: false,
        };
        LeftOut { n, batches: vec![batch; count.div_ceil(WIDTH)] }
    }

    /// ln of the error without one posture.
    pub fn log_error(&self, posture: usize) -> f64 {
        self.batches[posture / WIDTH].log_error.0[posture % WIDTH]
    }

    /// Its derivative by the information without that posture, n × n.
    pub fn adjoint(&self, posture: usize) -> impl Iterator<Item = f64> {
        let batch = &self.batches[posture / WIDTH];
        batch.adjoint.iter().map(move |entry| entry.0[posture % WIDTH])
    }
}

impl Kernel {
    /// Computes what is left of the information `total` (lower triangle, row by row) without each posture; false where
    /// without one a joint is undetermined.
    pub(crate) fn leave_each_out(&self, total: &[f64], left_out: &mut LeftOut) -> bool {
        let n = left_out.n;
        for (b, batch) in left_out.batches.iter_mut().enumerate() {
            for (entry, (rest, total)) in batch.information.iter_mut().zip(total).enumerate() {
                let (first, others) = (&self.cases[0], &self.cases[1..]);
                let mut posture = first.batches[b].information[entry];
                for case in others {
                    posture += case.batches[b].information[entry];
                }
                *rest = Lanes::splat(*total) - posture;
            }
            run(ErrorSweep(batch, n));
            if !batch.is_sound {
                return false;
            }
            for lane in &mut batch.log_error.0 {
                *lane = 0.5 * (*lane / n as f64).ln();
            }
        }
        true
    }

    /// Sets the derivative of the index by the information of each posture, where `sum` (n × n) is that by the errors
    /// without any of the fixed postures, and `weights` those by the errors without each of the others: a posture counts
    /// in all of them but that without itself. Adds the latter to `sum`.
    pub(crate) fn set_left_out_adjoints(&mut self, left_out: &LeftOut, sum: &mut [f64], weights: &[f64]) {
        for (b, batch) in left_out.batches.iter().enumerate() {
            let weights = weights_of(weights, b);
            for (sum, adjoint) in sum.iter_mut().zip(&batch.adjoint) {
                let [first, second, third, fourth] = (weights * *adjoint).0;
                *sum = *sum + first + second + third + fourth;
            }
        }
        for case in &mut self.cases {
            for (b, (to, batch)) in case.batches.iter_mut().zip(&left_out.batches).enumerate() {
                let weights = weights_of(weights, b);
                for ((slope, sum), adjoint) in to.adjoint.iter_mut().zip(&*sum).zip(&batch.adjoint) {
                    *slope = Lanes::splat(*sum) - weights * *adjoint;
                }
            }
        }
    }
}

/// The weights of the postures of batch `b`; 0 for a lane without a posture of its own.
fn weights_of(weights: &[f64], b: usize) -> Lanes {
    let mut lanes = ZERO;
    for (lane, weight) in lanes.0.iter_mut().zip(&weights[b * WIDTH..]) {
        *lane = *weight;
    }
    lanes
}

/// Fills a batch from its information, tr(M⁻¹) in the place of the error; n springs.
struct ErrorSweep<'a>(&'a mut Batch, usize);

impl Sweep for ErrorSweep<'_> {
    #[inline(always)]
    fn run(self) {
        // With a constant number of springs the compiler unrolls.
        match self.1 {
            6 => self.0.fill(6),
            n => self.0.fill(n),
        }
    }
}

impl Batch {
    #[inline(always)]
    fn fill(&mut self, n: usize) {
        self.is_sound = cholesky(n, &self.information, &mut self.lower);
        if !self.is_sound {
            return;
        }
        invert_lower(n, &self.lower, &mut self.inverse_lower);
        inverse_from_lower(n, &self.inverse_lower, &mut self.inverse);
        symmetric_product(n, &self.inverse, &self.inverse, &mut self.adjoint);
        let mut trace = ZERO;
        for i in 0..n {
            trace += self.inverse[i * n + i];
        }
        let factor = Lanes::splat(-0.5) / trace;
        for slope in &mut self.adjoint[..n * n] {
            *slope = *slope * factor;
        }
        self.log_error = trace;
    }
}
