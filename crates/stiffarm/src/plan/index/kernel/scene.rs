//! Margins of the scene in the kernel: distances of shapes, beams and torques, posture by posture.
//!
//! They take their turns one after the other where the rest takes four postures at a time: which
//! shapes are near differs from posture to posture. Only those near enough to matter to the
//! augmented Lagrangian are told exactly, most by one comparison.

use super::batch::Batch;
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::model::observation::{PostureTerms, Setup};
use crate::model::scene::{Scene, Work};
use nalgebra::Vector3;

/// The scene with room for one posture.
#[derive(Debug, Clone)]
pub(super) struct SceneKernel {
    setup: Setup,
    scene: Scene,
    terms: PostureTerms,
    /// Room for each posture.
    work: Vec<Work>,
    q: Vec<f64>,
    gradient: Vec<f64>,
}

impl SceneKernel {
    /// `None` where the cell's scene is empty.
    pub fn new(cell: &Cell, postures: usize) -> Result<Option<Self>> {
        if cell.scene.is_empty() {
            return Ok(None);
        }
        let q: Vec<f64> = cell.bounds.iter().map(|b| 0.5 * (b[0] + b[1])).collect();
        Ok(Some(SceneKernel {
            setup: cell.setup.clone(),
            scene: cell.scene.clone(),
            terms: PostureTerms::new(&cell.setup, &q, None)?,
            work: vec![Work::remembering(&cell.scene, &cell.setup); postures],
            gradient: vec![0.0; q.len()],
            q,
        }))
    }

    /// Number of margins per posture.
    pub fn count(&self) -> usize {
        self.scene.count(&self.setup)
    }

    pub fn set_anchor(&mut self, to: [f64; 3]) {
        if let Load::Rope { anchor, .. } = &mut self.setup.load {
            *anchor = to.into();
        }
        self.work.iter_mut().for_each(Work::forget);
    }

    pub fn set_loading_point(&mut self, to: [f64; 3]) {
        self.setup.tool.loading_point = to.into();
        self.work.iter_mut().for_each(Work::forget);
    }

    /// The margins of one lane, which holds that posture, behind the `before` ones on points, their penalty and its derivatives.
    pub fn forward(&mut self, batch: &mut Batch, lane: usize, posture: usize, before: usize) {
        for (q, lanes) in self.q.iter_mut().zip(&batch.q) {
            *q = lanes.0[lane];
        }
        self.gradient.fill(0.0);
        let (mut anchor, mut loading) = (Vector3::zeros(), Vector3::zeros());
        if self.terms.update(&self.setup, &self.q).is_err() {
            // A rope without a direction; the index does not exist there either.
            batch.violation.0[lane] = f64::INFINITY;
        } else {
            let (weight, guard) = (batch.penalty_weight, batch.penalty_guard);
            let Batch {
                multipliers,
                margins,
                penalty,
                violation,
                ..
            } = batch;
            let (multipliers, margins) = (&multipliers[before..], &mut margins[before..]);
            let frames = self.terms.frames();
            let gradient = &mut self.gradient;
            self.scene.visit(
                &self.setup,
                &self.terms,
                &mut self.work[posture],
                |at| guard + multipliers[at].0[lane] / weight,
                |at, margin, slope| {
                    margins[at].0[lane] = margin;
                    violation.0[lane] = violation.0[lane].max(-margin);
                    let multiplier = multipliers[at].0[lane];
                    let active = (multiplier - (margin - guard) * weight).max(0.0);
                    penalty.0[lane] += (active * active - multiplier * multiplier) * (0.5 / weight);
                    if active > 0.0 {
                        slope.add_to(frames, -active, gradient);
                        let by_load = slope.by_load();
                        anchor -= by_load.0 * active;
                        loading -= by_load.1 * active;
                    }
                },
            );
        }
        for (lanes, g) in batch.scene_gradient.iter_mut().zip(&self.gradient) {
            lanes.0[lane] = *g;
        }
        for axis in 0..3 {
            batch.scene_anchor[axis].0[lane] = anchor[axis];
            batch.scene_loading[axis].0[lane] = loading[axis];
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::files::cell::parse_cell;
    use crate::model::cell::Cell;
    use crate::model::observation::PostureTerms;
    use crate::plan::index::kernel::{Kernel, Wanted};

    const WANTED: Wanted<'_> = Wanted {
        dexterity: None,
        information: None,
        limits: true,
    };

    const TEXT: &str = include_str!("../../../../tests/cells/comau-shapes.toml");

    /// The default cell with shapes, rope, beams and torques.
    fn cell() -> Cell {
        parse_cell(TEXT, "cell.toml").unwrap()
    }

    /// Postures spread over the bounds.
    fn postures(cell: &Cell, count: usize) -> Vec<Vec<f64>> {
        let angle = |p: usize, j: usize, b: &[f64; 2]| {
            let share = 0.5 + 0.5 * (1.7 * p as f64 + 2.3 * j as f64).sin();
            b[0] + share * (b[1] - b[0])
        };
        (0..count)
            .map(|p| {
                cell.bounds
                    .iter()
                    .enumerate()
                    .map(|(j, b)| angle(p, j, b))
                    .collect()
            })
            .collect()
    }

    #[test]
    fn the_search_sees_the_same_violations() {
        let cell = cell();
        let group = postures(&cell, 9);
        let mut kernel = Kernel::new(&cell, WANTED, group.len()).unwrap();
        kernel.forward(&group.concat());
        let violations: Vec<f64> = kernel.violations().collect();
        for (q, violation) in group.iter().zip(violations) {
            let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
            let smallest = cell.margins().smallest(&terms).unwrap().margin;
            assert!(
                (violation - (-smallest).max(0.0)).abs() < 1e-12,
                "{violation} {smallest}"
            );
            assert!((cell.margins().least(&terms) < 0.0) == (smallest < 0.0));
        }
    }

    #[test]
    fn the_penalty_has_its_derivative() {
        let text = TEXT.replace("[limits]", "[limits]\ndisplacement_mm = [1.2, 1.3]");
        let cell = parse_cell(&text, "cell.toml").unwrap();
        assert!(cell.scene.displacement().is_some());
        let group = postures(&cell, 5);
        let flat: Vec<f64> = group.concat();
        let mut kernel = Kernel::new(&cell, WANTED, group.len()).unwrap();
        kernel.reset_penalty(40.0, 1e-3);
        kernel.forward(&flat);
        // With multipliers limits push before they are crossed.
        kernel.update_multipliers();
        kernel.set_penalty_weight(25.0);
        let mut gradient = vec![0.0; flat.len()];
        kernel.forward(&flat);
        kernel.reverse(&mut gradient);
        let largest = gradient.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
        assert!(largest > 1.0);
        for k in 0..flat.len() {
            let mut value = |step: f64| {
                let mut moved = flat.clone();
                moved[k] += step;
                kernel.forward(&moved);
                kernel.penalty()
            };
            let (coarse, fine) = (value(2e-6) - value(-2e-6), value(1e-6) - value(-1e-6));
            let expected = (8.0 * fine - coarse) / 12e-6;
            assert!(
                (gradient[k] - expected).abs() < 1e-5 * largest,
                "{k}: {} {expected}",
                gradient[k]
            );
        }
    }

    #[test]
    fn what_is_remembered_changes_nothing() {
        let cell = cell();
        let group = postures(&cell, 6);
        let mut flat: Vec<f64> = group.concat();
        let mut kernel = Kernel::new(&cell, WANTED, group.len()).unwrap();
        kernel.reset_penalty(40.0, 1e-3);
        let mut gradients = [vec![0.0; flat.len()], vec![0.0; flat.len()]];
        for step in 0..300 {
            for (i, q) in flat.iter_mut().enumerate() {
                *q += 0.05 * (0.7 * step as f64 + 1.9 * i as f64).sin();
            }
            kernel.forward(&flat);
            kernel.reverse(&mut gradients[0]);
            let mut fresh = Kernel::new(&cell, WANTED, group.len()).unwrap();
            fresh.reset_penalty(40.0, 1e-3);
            fresh.forward(&flat);
            fresh.reverse(&mut gradients[1]);
            assert_eq!(kernel.penalty(), fresh.penalty());
            assert_eq!(kernel.violation(), fresh.violation());
            assert_eq!(gradients[0], gradients[1]);
        }
    }
}
