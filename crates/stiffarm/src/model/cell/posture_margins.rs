//! All limits of a cell at a posture, under each of its loads.

use super::{Cell, LimitKind, LimitMargin, Margins, Slopes};
use crate::error::{Code, Error, Result};
use crate::model::limit::ROUNDING;
use crate::model::load::{Load, Wrench};
use crate::model::observation::PostureTerms;
use nalgebra::Vector3;
use std::borrow::Cow;

/// Limits that no load changes; they are looked at under the first one.
const OF_THE_POSTURE: [LimitKind; 3] = [LimitKind::Shapes, LimitKind::Sight, LimitKind::Incidence];

/// The limits of a cell at postures, given by their controller angles \[rad\], under each of
/// the cell's loads. Where a load is only known by measurement, limits see the arm unloaded.
#[derive(Debug, Clone)]
pub struct PostureMargins<'a> {
    cases: Vec<UnderLoad<'a>>,
    unloaded: Option<Wrench>,
}

#[derive(Debug, Clone)]
struct UnderLoad<'a> {
    /// Of several load cases its name.
    name: Option<String>,
    margins: Margins<'a>,
    terms: PostureTerms,
}

impl Cell {
    /// The cell under each of its loads; what limits the posture whatever the load stays with
    /// the first.
    pub(crate) fn limit_cases(&self) -> Vec<Cell> {
        let mut cases = self.cases();
        for case in cases.iter_mut().skip(1) {
            case.scene = case.scene.without_all(&OF_THE_POSTURE);
        }
        cases
    }

    /// The cell's limits, ready to be looked at posture by posture, under each of its loads.
    ///
    /// # Errors
    /// Bounds that do not fit the robot or are not finite.
    pub fn posture_margins(&self) -> Result<PostureMargins<'_>> {
        let middle: Vec<f64> = self.bounds.iter().map(|b| 0.5 * (b[0] + b[1])).collect();
        let unloaded = (self.setup.load == Load::Measured).then_some(Wrench::force(Vector3::zeros()));
        let each = if self.setup.load.has_cases() {
            let cells = self.limit_cases().into_iter();
            cells.map(|case| (Cow::Owned(case.setup), Cow::Owned(case.scene))).collect()
        } else {
            vec![(Cow::Borrowed(&self.setup), Cow::Borrowed(&self.scene))]
        };
        let cases = each.into_iter().enumerate().map(|(number, (setup, scene))| {
            let zero = Wrench::force(Vector3::zeros());
            let name = self.setup.load.cases().get(number);
            Ok(UnderLoad {
                name: name.map(|case| case.name.clone()),
                terms: PostureTerms::new(&setup, &middle, Some(&zero))?,
                margins: Margins::of(setup, &self.limits, scene),
            })
        });
        Ok(PostureMargins { cases: cases.collect::<Result<_>>()?, unloaded })
    }
}

impl PostureMargins<'_> {
    /// The same for postures that move by small steps: distances that were large are not looked
    /// at again before the arm may have made them small.
    pub(crate) fn remembering(mut self) -> Self {
        for case in &mut self.cases {
            case.margins = case.margins.clone().remembering();
        }
        self
    }

    /// Number of margins per posture.
    pub fn count(&self) -> usize {
        self.cases.iter().map(|case| case.margins.count()).sum()
    }

    /// True where margin `at` is a limit on a point; the others are of shapes, beams and torques.
    pub(crate) fn is_of_point(&self, mut at: usize) -> bool {
        for case in &self.cases {
            if at < case.margins.count() {
                return at < case.margins.point_count();
            }
            at -= case.margins.count();
        }
        false
    }

    /// The terms of the posture looked at last, load by load.
    pub(crate) fn terms(&self) -> impl Iterator<Item = &PostureTerms> {
        self.cases.iter().map(|case| &case.terms)
    }

    fn move_to(&mut self, q: &[f64]) -> Result<()> {
        for case in &mut self.cases {
            let setup = case.margins.setup();
            case.terms.frames.update(&setup.robot, q);
            case.terms.fill(setup, self.unloaded.as_ref())?;
        }
        Ok(())
    }

    /// The smallest margin of the posture `q`, infinite without limits; 0 or more exactly where
    /// every limit is met, and as [`Margins::least`] where one is not.
    ///
    /// # Errors
    /// A rope without a direction: its anchor lies on the loading point.
    pub fn least(&mut self, q: &[f64]) -> Result<f64> {
        self.move_to(q)?;
        let mut least = f64::INFINITY;
        for case in &mut self.cases {
            least = least.min(case.margins.least(&case.terms));
        }
        Ok(least)
    }

    /// Whether the posture `q` meets every limit, to rounding.
    ///
    /// # Errors
    /// As [`least`](Self::least).
    pub fn are_met(&mut self, q: &[f64]) -> Result<bool> {
        Ok(self.least(q)? >= -ROUNDING)
    }

    /// All margins of the posture `q` by name, in a fixed order, load by load.
    ///
    /// # Errors
    /// As [`least`](Self::least).
    pub fn named(&mut self, q: &[f64]) -> Result<Vec<LimitMargin>> {
        self.move_to(q)?;
        let cases = self.cases.iter_mut();
        Ok(cases.flat_map(UnderLoad::named).collect())
    }

    /// The smallest margin of the posture `q` by name, `None` without limits; those of displacements
    /// are compared as shares of the largest one.
    ///
    /// # Errors
    /// As [`least`](Self::least).
    pub fn smallest(&mut self, q: &[f64]) -> Result<Option<LimitMargin>> {
        self.move_to(q)?;
        let mut best: Option<(f64, LimitMargin)> = None;
        for case in &mut self.cases {
            for margin in case.named() {
                let compared = case.margins.compared(&margin);
                if best.as_ref().is_none_or(|(least, _)| compared < *least) {
                    best = Some((compared, margin));
                }
            }
        }
        Ok(best.map(|(_, margin)| margin))
    }

    /// Writes the margins of the posture `q` to `values`, and the derivatives that `slopes` wants.
    /// Distances between shapes of `enough` and more may be lower bounds, with a derivative of zero.
    ///
    /// # Errors
    /// As [`least`](Self::least); lists of another length.
    pub fn evaluate(&mut self, q: &[f64], enough: f64, values: &mut [f64], mut slopes: Slopes<'_>) -> Result<()> {
        let (n, count) = (q.len(), self.count());
        let wanted = slopes.wanted.len();
        if values.len() != count || slopes.rows.len() != wanted * n || ![0, count].contains(&wanted) {
            let message = format!("There are {count} margins, and {n} derivatives of each.");
            return Err(Error::new(Code::Dimension, message));
        }
        self.move_to(q)?;
        let mut first = 0;
        for case in &mut self.cases {
            let end = first + case.margins.count();
            let case_slopes;
            (case_slopes, slopes) = slopes.split_at(case.margins.count(), n);
            case.margins.evaluate(&case.terms, enough, &mut values[first..end], case_slopes);
            first = end;
        }
        Ok(())
    }
}

impl UnderLoad<'_> {
    /// All margins by name, of several loads with that of the load.
    fn named(&mut self) -> Vec<LimitMargin> {
        let mut named = self.margins.named(&self.terms);
        for margin in &mut named {
            if margin.kind.is_of_load() || margin.point == "loading point" {
                margin.load.clone_from(&self.name);
            }
        }
        named
    }
}
