//! What readings show where a quantity has another value.
//!
//! Displacements are linear in the wrench. So one matrix of each posture, the displacements under unit wrenches,
//! answers for anchor, loading point, gravity, sensor and every force at once, exactly and for any change of these:
//! what remains of each is how the wrench changes, six closed numbers.

use super::facts::Quantity;
use super::stated::StatedExperiment;
use super::value::{QuantityAtValue, QuantityValue};
use crate::error::Result;
use crate::estimate::identify::known_displacement;
use crate::model::instruments::Mount;
use crate::model::load::Wrench;
use crate::model::observation::{ExtraTerm, PostureTerms};
use crate::model::tool::SeriesCompliance;
use nalgebra::{DMatrix, DVector, Matrix6, Vector3, Vector6};

/// The answers of all postures to what may change, with the unknowns at some values.
pub(crate) struct Answers<'a> {
    stated: &'a StatedExperiment<'a>,
    extra: &'a [ExtraTerm],
    values: DVector<f64>,
    /// One of each measured posture that has terms.
    postures: Vec<Option<Answer>>,
}

struct Answer {
    /// Displacement of all measuring points per unit of the wrench about the loading point, 3m × 6.
    by_wrench: DMatrix<f64>,
    /// Modelled displacement of all measuring points, 3m.
    displacement: DVector<f64>,
    /// The wrench as stated, about the loading point.
    wrench: Wrench,
}

impl<'a> Answers<'a> {
    /// With `values` of springs and terms `extra`.
    ///
    /// # Errors
    /// A state that is under none of the loads.
    pub fn new(stated: &'a StatedExperiment<'a>, extra: &'a [ExtraTerm], values: DVector<f64>) -> Result<Self> {
        let mut out = Answers { stated, extra, values, postures: Vec::new() };
        let springs = out.values.len() - extra.len();
        let mut linear = out.values.clone();
        for (i, term) in extra.iter().enumerate() {
            if !term.is_spring() {
                linear[springs + i] = 0.0;
            }
        }
        let setup = &stated.cell().setup;
        for (m, posture) in stated.experiment.postures().iter().enumerate() {
            stated.fit.control().check()?;
            let terms = stated.experiment.terms(m);
            let Some((terms, (wrench, _))) = terms.zip(stated.wrench(setup, m, &[])?) else {
                out.postures.push(None);
                continue;
            };
            let mut by_wrench = DMatrix::zeros(3 * terms.measuring_points().len(), 6);
            for k in 0..6 {
                let unit = Wrench::from_components(Vector6::ith(k, 1.0).into());
                let terms = terms.under(&unit);
                let moved = terms.block_with(&setup.robot, extra) * &linear;
                by_wrench.set_column(k, &(moved + terms.known_displacement(&setup.tool)));
            }
            let moved = terms.block_with(&setup.robot, extra) * &out.values;
            out.postures.push(Some(Answer {
                by_wrench,
                displacement: moved + known_displacement(setup, terms, posture)?,
                wrench,
            }));
        }
        Ok(out)
    }

    /// Change of what the readings show with quantities at these values, rows as in the system.
    ///
    /// # Errors
    /// As [`StatedExperiment::changed`].
    pub fn shift(&self, values: &[QuantityAtValue]) -> Result<DVector<f64>> {
        let (stated, system) = (self.stated, self.stated.system);
        let setup = stated.setup(values);
        let mut out = DVector::zeros(system.delta.len());
        for labels in system.labels.chunk_by(|a, b| a.measured == b.measured) {
            let m = labels[0].measured;
            let both = self.postures[m].as_ref().zip(stated.experiment.terms(m));
            let Some((answer, terms)) = both else {
                continue;
            };
            let mut shown = answer.displacement.clone();
            if values.iter().any(|(quantity, _)| quantity.moves_frames()) {
                let posture = stated.posture(&setup, m, values)?;
                let state_setup = setup.of_state(&posture.state)?;
                let terms = posture.terms(&state_setup, posture.wrench.as_ref())?;
                shown = terms.block_with(&setup.robot, self.extra) * &self.values;
                shown += known_displacement(&setup, &terms, &posture)?;
            } else if let Some((wrench, at)) = stated.wrench(&setup, m, values)? {
                let wrench = wrench.moved(&at, terms.loading_point());
                let change: Vec<f64> = (wrench.components().iter())
                    .zip(answer.wrench.components())
                    .map(|(now, before)| now - before)
                    .collect();
                shown += &answer.by_wrench * DVector::from_vec(change);
            }
            for (quantity, place) in values {
                self.moved_beside(&mut shown, m, terms, (*quantity, place))?;
            }
            for label in labels {
                let displacement = &stated.experiment.postures()[m].displacements[label.displacement];
                let row = 3 * displacement.point;
                let change = shown.fixed_rows::<3>(row) - answer.displacement.fixed_rows::<3>(row);
                out.fixed_rows_mut::<3>(label.rows.start).copy_from(&change);
            }
        }
        Ok(out)
    }

    /// What moves points beside the wrench.
    fn moved_beside(
        &self,
        shown: &mut DVector<f64>,
        m: usize,
        terms: &PostureTerms,
        (quantity, place): (Quantity, &QuantityValue),
    ) -> Result<()> {
        for (term, size) in self.stated.elements(m, quantity, place)? {
            *shown += term.column(terms) * size;
        }
        let each = |shown: &mut DVector<f64>, change: &dyn Fn(Vector3<f64>) -> Vector3<f64>| {
            for point in 0..shown.len() / 3 {
                let moved = change(shown.fixed_rows::<3>(3 * point).into_owned());
                shown.fixed_rows_mut::<3>(3 * point).copy_from(&moved);
            }
        };
        match quantity {
            Quantity::Shift => each(shown, &|v| v + place.vector()),
            Quantity::Registration => each(shown, &|v| place.rotated() * v),
            Quantity::Sensor => {
                let cell = self.stated.cell();
                let mut tool = cell.setup.tool.clone();
                let at_sensor = cell.sensor.as_ref().filter(|s| s.mount == Mount::Flange);
                let origin = match (at_sensor, &tool.series_compliance) {
                    (Some(sensor), _) => sensor.pose.translation.vector,
                    (None, Some(series)) => series.origin,
                    (None, None) => Vector3::zeros(),
                };
                let mut matrix = Matrix6::zeros();
                for axis in 3..6 {
                    matrix[(axis, axis)] = place.values[0];
                }
                tool.series_compliance = Some(SeriesCompliance { origin, matrix });
                *shown += terms.known_displacement(&tool);
            }
            _ => {}
        }
        Ok(())
    }

    /// How the readings change with number `k` of the quantity `which` of `values`, which are at these; as a fit there
    /// sees it, in the axes of the base.
    ///
    /// # Errors
    /// As [`shift`](Self::shift).
    pub fn slope(&self, values: &[QuantityAtValue], which: usize, k: usize) -> Result<DVector<f64>> {
        let (quantity, place) = &values[which];
        if let Some(simple) = self.simple_slope(values, *quantity, k) {
            return simple;
        }
        let h = quantity.step();
        let beside = |by: f64| {
            let mut values = values.to_vec();
            values[which].1.values[k] += by;
            self.shift(&values)
        };
        let mut slope = (beside(h)? - beside(-h)?) / (2.0 * h);
        if *quantity == Quantity::Registration {
            let back = place.rotated().transpose();
            for row in (0..slope.len()).step_by(3) {
                let turned = back * slope.fixed_rows::<3>(row);
                slope.fixed_rows_mut::<3>(row).copy_from(&turned);
            }
        }
        Ok(slope)
    }

    /// Where the change is in proportion to the number: of an element, or a shift, by itself.
    fn simple_slope(&self, values: &[QuantityAtValue], quantity: Quantity, k: usize) -> Option<Result<DVector<f64>>> {
        let is_alone = values.len() == 1;
        let is_simple = quantity == Quantity::Shift || quantity.terms(k).is_some() || quantity == Quantity::Sensor;
        (is_alone && is_simple).then(|| {
            let count = values[0].1.values.len();
            self.shift(&[(quantity, QuantityValue::off(count, k, 1.0))])
        })
    }
}

/// What tests hold the answers against.
pub(crate) mod internals {
    use super::{Answers, StatedExperiment};
    use crate::error::Result;
    use crate::estimate::identify::{Experiment, Fit};
    use crate::estimate::quantity::facts::Quantity;
    use crate::estimate::quantity::value::QuantityValue;
    use nalgebra::DVector;

    /// Name, default standard uncertainty and its unit of each quantity.
    pub fn quantities() -> [(&'static str, f64, &'static str); 19] {
        Quantity::ALL.map(|quantity| {
            let facts = quantity.facts();
            (facts.name, facts.assumed, facts.unit)
        })
    }

    /// One number of a quantity off: what changes by the answers to unit wrenches, and in a cell that has it there.
    pub struct QuantityResponse {
        /// Name of the quantity and of its number.
        pub name: String,
        /// By the answers.
        pub answer: DVector<f64>,
        /// By the other cell.
        pub cell: DVector<f64>,
        /// Derivative by the answers.
        pub slope: DVector<f64>,
        /// By differences of other cells.
        pub difference: DVector<f64>,
    }

    /// Both of every quantity that changes the cell.
    ///
    /// # Errors
    /// As `Answers::new`.
    pub fn both_ways(fit: &Fit) -> Result<Vec<QuantityResponse>> {
        let stated = StatedExperiment::of(fit);
        let (system, values) = (fit.system(), &fit.solution().values);
        let answers = Answers::new(&stated, &system.extra, values.clone())?;
        let mut out = Vec::new();
        for quantity in stated.quantities() {
            // Axes turn what was read, noise included, and a sensor's give is in no cell.
            if matches!(quantity, Quantity::Registration | Quantity::Sensor) {
                continue;
            }
            let names = quantity.parts(stated.cell());
            for (k, name) in names.iter().enumerate().take(quantity.dimension(names.len())) {
                let at = |size: f64| vec![(quantity, QuantityValue::off(names.len(), k, size))];
                let missed = |size: f64| -> Result<DVector<f64>> {
                    let (cell, measured) = stated.changed(&at(size))?;
                    let other = Experiment::of(cell, measured)?;
                    let other = other.system(&system.extra, fit.options().weights)?;
                    Ok(&other.psi * values - &other.delta)
                };
                let (step, far) = (quantity.step(), 50.0 * quantity.step());
                out.push(QuantityResponse {
                    name: format!("{} {name}", quantity.name()),
                    answer: answers.shift(&at(far))?,
                    cell: missed(far)? - missed(0.0)?,
                    slope: answers.slope(&at(0.0), 0, k)?,
                    difference: (missed(step)? - missed(-step)?) / (2.0 * step),
                });
            }
        }
        Ok(out)
    }
}
