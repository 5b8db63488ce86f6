//! Random cells for properties, reproducible from a seed.

use super::model::Model;
use nalgebra::{DMatrix, Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::f64::consts::{FRAC_PI_2, PI};
use stiffarm::model::cell::Task;
use stiffarm::model::load::{Axes, Load, Wrench};

/// A seeded source of random choices.
#[derive(Debug)]
pub struct Dice(ChaCha8Rng);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Dice(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.0.random::<f64>() * count as f64) as usize
    }

    pub fn chance(&mut self, share: f64) -> bool {
        self.0.random::<f64>() < share
    }

    /// Standard normal.
    pub fn normal(&mut self) -> f64 {
        self.0.sample(StandardNormal)
    }

    /// Three independent normal components of this standard deviation.
    pub fn noise(&mut self, std: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.normal() * std)
    }

    /// Either sign, magnitude between `low` and `high`.
    pub fn signed(&mut self, low: f64, high: f64) -> f64 {
        let sign = if self.chance(0.5) { 1.0 } else { -1.0 };
        sign * self.between(low, high)
    }

    pub fn vector(&mut self, half: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.between(-half, half))
    }

    pub fn direction(&mut self) -> Vector3<f64> {
        loop {
            let v = self.vector(1.0);
            if v.norm() > 0.2 && v.norm() < 1.0 {
                return v.normalize();
            }
        }
    }

    pub fn posture(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.between(-PI, PI)).collect()
    }

    pub fn postures(&mut self, n: usize, count: usize) -> Vec<Vec<f64>> {
        (0..count).map(|_| self.posture(n)).collect()
    }

    pub fn pose(&mut self) -> Isometry3<f64> {
        let turn = UnitQuaternion::from_scaled_axis(self.direction() * self.between(0.0, PI));
        Isometry3::from_parts(Translation3::from(self.vector(1.0)), turn)
    }

    /// Kind 0: rope, 1: weight, 2: wrench in base axes, 3: wrench in tool axes,
    /// 4: cylinder that pushes.
    pub fn load(&mut self, kind: usize) -> Load {
        let magnitude = self.between(200.0, 800.0);
        let wrench = Wrench { force: self.direction() * magnitude, moment: self.vector(200.0) };
        match kind {
            0 => Load::Rope { anchor: self.vector(2.5), magnitude },
            4 => Load::Rope { anchor: self.vector(2.5), magnitude: -magnitude },
            1 => Load::Weight { magnitude, direction: self.direction() },
            2 => Load::Constant { wrench, axes: Axes::Base },
            _ => Load::Constant { wrench, axes: Axes::Tool },
        }
    }

    /// One to three tasks of a robot with `n` joints.
    pub fn tasks(&mut self, n: usize) -> Vec<Task> {
        (0..1 + self.below(3))
            .map(|i| Task {
                name: format!("task {i}"),
                q: self.posture(n),
                wrench: Wrench { force: self.direction() * self.between(100.0, 500.0), moment: self.vector(30.0) },
                axes: if self.chance(0.5) { Axes::Base } else { Axes::Tool },
                tip: self.vector(0.5),
            })
            .collect()
    }

    /// A cell with `n` joints, a load of `kind`, and where asked springs that
    /// do not sit on the joint axes and a shift common to a posture's points.
    pub fn model(&mut self, n: usize, kind: usize, elastic: bool, common: bool) -> Model {
        let rows = (0..n)
            .map(|_| {
                // Industrial arms have right angles; a general angle hides no factor that is zero there.
                let alpha = if self.chance(0.5) { self.signed(0.3, 1.8) } else { self.signed(1.0, 1.0) * FRAC_PI_2 };
                [alpha, self.signed(0.1, 0.9), self.between(-0.6, 0.6), self.between(-PI, PI)]
            })
            .collect();
        let mut coupling = DMatrix::from_fn(n, n, |i, j| if i == j { self.signed(1.0, 1.0) } else { 0.0 });
        coupling[(2, 1)] = self.signed(0.3, 1.0);
        let elastic = elastic.then(|| {
            let mut e = DMatrix::identity(n, n);
            e[(2, 1)] = self.signed(0.5, 1.0);
            e[(n - 1, n - 2)] = self.signed(0.1, 0.5);
            e[(0, 0)] = self.between(0.5, 2.0);
            e
        });
        let sigma = self.between(5e-6, 2e-5);
        Model {
            modified: self.chance(0.5),
            rows,
            base: self.pose(),
            coupling,
            elastic,
            loading_point: [self.signed(0.1, 0.4), self.signed(0.1, 0.4), self.between(-0.3, 0.3)],
            measuring_points: (0..2 + self.below(3)).map(|_| self.vector(0.4).into()).collect(),
            load: self.load(kind),
            prior: (0..n).map(|_| 10f64.powf(self.between(5.0, 6.7))).collect(),
            length: self.between(0.3, 1.5),
            sigma,
            tau: if common { sigma * self.between(0.3, 3.0) } else { 0.0 },
            // Their own source: the choices above and after stay what they are.
            tasks: Dice::new(sigma.to_bits()).tasks(n),
        }
    }
}
