//! All limits of a cell at one posture: those on points and those of the scene.

use super::{Cell, LimitKind, LimitMargin, Limits, MarginUnit, PointLimit, Slopes};
use crate::model::observation::{PostureTerms, Setup};
use crate::model::scene::{Scene, Work};
use std::borrow::Cow;

/// A limit of points that is violated by more says all that [`Margins::least`] is asked \[m\].
const CLEAR_VIOLATION: f64 = 1e-3;

/// The limits of a cell, ready to be looked at posture by posture.
#[derive(Debug, Clone)]
pub struct Margins<'a> {
    setup: Cow<'a, Setup>,
    limits: &'a Limits,
    /// Those of the limits that are on points.
    on_points: Vec<PointLimit>,
    scene: Cow<'a, Scene>,
    work: Work,
    point_count: usize,
    count: usize,
}

impl Cell {
    /// The cell's limits, ready to be looked at posture by posture.
    pub fn margins(&self) -> Margins<'_> {
        Margins::new(&self.setup, &self.limits, &self.scene)
    }

    /// The kinds of limits that the cell has.
    pub fn limit_kinds(&self) -> Vec<LimitKind> {
        let load = &self.setup.load;
        let has = |kind: &LimitKind| self.limits.has(*kind, load) || self.scene.has(*kind, load);
        LimitKind::ALL.into_iter().filter(has).collect()
    }

    /// The same cell without one kind of limit.
    #[must_use]
    pub fn without_limit(&self, kind: LimitKind) -> Self {
        Cell { limits: self.limits.without(kind), scene: self.scene.without(kind), ..self.clone() }
    }

    /// True where nothing limits postures but their bounds.
    pub fn is_unlimited(&self) -> bool {
        self.limits.is_empty() && self.scene.is_empty()
    }
}

impl<'a> Margins<'a> {
    /// Limits on points and of the scene for this setup.
    pub fn new(setup: &'a Setup, limits: &'a Limits, scene: &'a Scene) -> Self {
        Margins::of(Cow::Borrowed(setup), limits, Cow::Borrowed(scene))
    }

    pub(super) fn of(setup: Cow<'a, Setup>, limits: &'a Limits, scene: Cow<'a, Scene>) -> Self {
        let point_count = limits.count(&setup);
        let count = point_count + scene.count(&setup);
        Margins {
            point_count,
            count,
            setup,
            limits,
            on_points: limits.on_points().collect(),
            scene,
            work: Work::default(),
        }
    }

    /// The same for a posture that moves by small steps: distances that were large are not looked at
    /// again before the arm may have made them small.
    pub(crate) fn remembering(mut self) -> Self {
        self.work = Work::remembering(&self.scene, &self.setup);
        self
    }

    /// Robot, tool and load.
    pub(crate) fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Number of margins per posture.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Number of those that are limits on points; they come first.
    pub(crate) fn point_count(&self) -> usize {
        self.point_count
    }

    /// All margins of one posture by name, in a fixed order.
    pub fn named(&mut self, terms: &PostureTerms) -> Vec<LimitMargin> {
        let mut margins = self.limits.margins(&self.setup, terms);
        let scene = self.scene.margins(&self.setup, terms).into_iter();
        margins.extend(scene.map(|m| LimitMargin { kind: m.kind, point: m.subject, load: None, margin: m.margin }));
        margins
    }

    /// The smallest margin of one posture, `None` without limits; those of displacements are compared as
    /// shares of the largest one.
    pub fn smallest(&mut self, terms: &PostureTerms) -> Option<LimitMargin> {
        let named = self.named(terms).into_iter();
        named.min_by(|a, b| self.compared(a).total_cmp(&self.compared(b)))
    }

    /// What margins are compared by.
    pub(super) fn compared(&self, margin: &LimitMargin) -> f64 {
        match margin.kind.unit() {
            MarginUnit::Displacement => margin.margin / self.scene.displacement().map_or(1.0, |limits| limits.unit()),
            _ => margin.margin,
        }
    }

    /// The smallest margin of one posture, infinite without limits, those of displacements as shares of
    /// the largest one; 0 or more exactly where every limit is met. Where a limit of points is violated
    /// by a millimetre or more, it is the smallest of those: shapes are not looked at.
    pub fn least(&mut self, terms: &PostureTerms) -> f64 {
        let mut least = self.limits.least(&self.on_points, &self.setup, terms);
        if least < -CLEAR_VIOLATION {
            return least;
        }
        // Far shapes need not be told exactly.
        let enough = |_| 0.0;
        self.scene.visit(&self.setup, terms, &mut self.work, enough, |_, margin, _| {
            least = least.min(margin);
        });
        least
    }

    /// Writes the margins of one posture to `values`, and their derivatives. Margins of displacements
    /// are shares of the largest one here. Distances between shapes of `enough` and more
    /// may be lower bounds, with a derivative of zero.
    pub(crate) fn evaluate(&mut self, terms: &PostureTerms, enough: f64, values: &mut [f64], slopes: Slopes<'_>) {
        let n = self.setup.robot.joint_count();
        let (points, rest) = values.split_at_mut(self.point_count);
        let (head, mut slopes) = slopes.split_at(self.point_count, n);
        self.limits.evaluate(&self.on_points, &self.setup, terms, points, head);
        if self.scene.is_empty() {
            return;
        }
        self.scene.visit(
            &self.setup,
            terms,
            &mut self.work,
            |_| enough,
            |at, margin, slope| {
                rest[at] = margin;
                if let Some(row) = slopes.row(at, n) {
                    row.fill(0.0);
                    slope.add_to(terms.frames(), 1.0, row);
                }
            },
        );
    }
}
