//! What the rows of one posture share: errors of readings that several
//! displacements use, and shifts of what the model misses.

use super::labels::{RowLabel, Weights};
use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::measurement::{Displacement, MeasuredPosture};
use crate::numerics::information::tall_svd;
use crate::numerics::order::order_by_number;
use nalgebra::{DMatrix, DVector, Matrix3};
use std::collections::BTreeMap;

/// Load states whose joint torques point alike, up to sign, share what the
/// model misses; below this |cosine| they are taken as different loads.
pub(crate) const ALIKE_TORQUE_COSINE: f64 = 0.9;

/// Covariance of the rows of one posture in units of σ²: B + ZZᵀ. B falls into
/// parts that are independent of each other, so that many points cost no more
/// than each by itself; rows in no part are independent, with variance 1. The
/// few columns of Z are what all points have in common.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Covariance {
    /// Rows of each part, ascending, and their covariance.
    parts: Vec<(Vec<usize>, DMatrix<f64>)>,
    /// Z, rows × k; `None` where the points have nothing in common.
    common: Option<DMatrix<f64>>,
}

/// What makes rows independent: the lower Cholesky factor of each part, with its
/// rows, then 1 − 1/√(1 + s²) along the directions that all points share.
#[derive(Debug, Clone)]
pub(super) struct Roots {
    parts: Vec<(Vec<usize>, DMatrix<f64>)>,
    common: Option<(DMatrix<f64>, Vec<f64>)>,
}

impl Roots {
    /// True where rows are independent as they are.
    pub(super) fn is_identity(&self) -> bool {
        self.parts.is_empty() && self.common.is_none()
    }

    /// Whitens rows in place; false for a factor that is singular.
    pub(super) fn whiten(&self, rows: &mut DMatrix<f64>) -> bool {
        let regular = whiten_parts(&self.parts, rows);
        if let Some((directions, shares)) = &self.common {
            let mut along = directions.tr_mul(rows);
            for (k, share) in shares.iter().enumerate() {
                along.row_mut(k).scale_mut(*share);
            }
            *rows -= directions * along;
        }
        regular
    }
}

/// Solves with the factor of each part for its rows; false for a factor that is
/// singular.
fn whiten_parts(parts: &[(Vec<usize>, DMatrix<f64>)], rows: &mut DMatrix<f64>) -> bool {
    parts.iter().all(|(indices, root)| {
        let mut part = rows.select_rows(indices);
        let solved = root.solve_lower_triangular_mut(&mut part);
        for (a, i) in indices.iter().enumerate() {
            rows.row_mut(*i).copy_from(&part.row(a));
        }
        solved
    })
}

impl Covariance {
    /// From a symmetric matrix, split where it falls into parts.
    pub fn from_matrix(matrix: &DMatrix<f64>) -> Self {
        let entries = (0..matrix.nrows()).flat_map(|i| (0..=i).map(move |j| (i, j)));
        let entries = entries.map(|(i, j)| (i, j, matrix[(i, j)])).filter(|e| e.2 != 0.0);
        Covariance::from_entries(matrix.nrows(), &entries.collect::<Vec<_>>())
    }

    /// From the entries on and below the diagonal that are not zero, of `rows`
    /// rows; entries of one place are added.
    fn from_entries(rows: usize, entries: &[(usize, usize, f64)]) -> Self {
        let links = entries.iter().map(|(i, j, _)| (*i, *j));
        let members = classes(rows, links);
        let mut place = vec![(0, 0); rows];
        for (class, indices) in members.iter().enumerate() {
            indices.iter().enumerate().for_each(|(at, i)| place[*i] = (class, at));
        }
        let empty = |indices: &Vec<usize>| DMatrix::zeros(indices.len(), indices.len());
        let mut matrices: Vec<DMatrix<f64>> = members.iter().map(empty).collect();
        for &(i, j, value) in entries {
            let ((class, a), (_, b)) = (place[i], place[j]);
            matrices[class][(a, b)] += value;
            if i != j {
                matrices[class][(b, a)] += value;
            }
        }
        let plain = |m: &DMatrix<f64>| m.len() == 1 && m[0] == 1.0;
        let parts = members.into_iter().zip(matrices);
        Covariance { parts: parts.filter(|(_, matrix)| !plain(matrix)).collect(), common: None }
    }

    /// True for independent rows of variance 1.
    pub fn is_identity(&self) -> bool {
        self.parts.is_empty() && self.common.is_none()
    }

    /// Z, rows × k: what all points have in common.
    pub(crate) fn common(&self) -> Option<&DMatrix<f64>> {
        self.common.as_ref()
    }

    /// Whitens rows by B alone, in place; false where it is not positive definite.
    pub(crate) fn whiten_without_common(&self, rows: &mut DMatrix<f64>) -> bool {
        self.factors().is_some_and(|parts| whiten_parts(&parts, rows))
    }

    /// The covariance of the rows `chosen`, in that order.
    pub(crate) fn select(&self, chosen: &[usize]) -> Self {
        let groups: Vec<Vec<usize>> = chosen.iter().map(|row| vec![*row]).collect();
        self.averaged(&groups)
    }

    /// The covariance of the means over `groups` of rows, no row in two of them.
    pub(crate) fn averaged(&self, groups: &[Vec<usize>]) -> Self {
        // Group and weight of each row that is in one.
        let mut place: BTreeMap<usize, (usize, f64)> = BTreeMap::new();
        for (g, rows) in groups.iter().enumerate() {
            let weight = 1.0 / rows.len() as f64;
            place.extend(rows.iter().map(|row| (*row, (g, weight))));
        }
        let common = self.common.as_ref().map(|whole| {
            let mut out = DMatrix::zeros(groups.len(), whole.ncols());
            for (i, (g, weight)) in &place {
                let mut row = out.row_mut(*g);
                row += whole.row(*i) * *weight;
            }
            out
        });
        let mut entries = Vec::new();
        for (rows, matrix) in &self.parts {
            let places: Vec<Option<(usize, f64)>> = rows.iter().map(|i| place.remove(i)).collect();
            for (a, i) in places.iter().enumerate() {
                for (b, j) in places.iter().enumerate() {
                    let (Some((i, v)), Some((j, w))) = (i, j) else {
                        continue;
                    };
                    // A pair of rows in one group stands twice on the diagonal.
                    if j <= i && matrix[(a, b)] != 0.0 {
                        entries.push((*i, *j, v * w * matrix[(a, b)]));
                    }
                }
            }
        }
        entries.extend(place.into_values().map(|(g, w)| (g, g, w * w)));
        let parts = Covariance::from_entries(groups.len(), &entries).parts;
        Covariance { parts, common }
    }

    /// Columns 0..`count` of a table with `count` rows for each line, by those
    /// that share something in any line beside what all have in common.
    pub(crate) fn classes(&self, count: usize) -> Vec<Vec<usize>> {
        let links = self.parts.iter().flat_map(|(rows, _)| {
            let first = rows.first().map_or(0, |i| i % count);
            rows.iter().map(move |i| (i % count, first))
        });
        classes(count, links)
    }

    /// The whole matrix of `rows` rows.
    pub fn to_matrix(&self, rows: usize) -> DMatrix<f64> {
        let mut out = DMatrix::identity(rows, rows);
        for (indices, matrix) in &self.parts {
            for (a, i) in indices.iter().enumerate() {
                for (b, j) in indices.iter().enumerate() {
                    out[(*i, *j)] = matrix[(a, b)];
                }
            }
        }
        if let Some(common) = &self.common {
            out += common * common.transpose();
        }
        out
    }

    /// The three rows from `at`.
    pub(crate) fn of_point(&self, at: usize) -> Matrix3<f64> {
        let mut out = Matrix3::identity();
        for (indices, matrix) in &self.parts {
            for (a, i) in indices.iter().enumerate() {
                for (b, j) in indices.iter().enumerate() {
                    if (at..at + 3).contains(i) && (at..at + 3).contains(j) {
                        out[(i - at, j - at)] = matrix[(a, b)];
                    }
                }
            }
        }
        if let Some(common) = &self.common {
            let block = common.rows(at, 3);
            out += (block * block.transpose()).fixed_view::<3, 3>(0, 0);
        }
        out
    }

    /// The covariance times a matrix with as many rows.
    pub(crate) fn times(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let mut out = columns.clone();
        for (indices, matrix) in &self.parts {
            let product = matrix * columns.select_rows(indices);
            for (a, i) in indices.iter().enumerate() {
                out.row_mut(*i).copy_from(&product.row(a));
            }
        }
        if let Some(common) = &self.common {
            out += common * common.tr_mul(columns);
        }
        out
    }

    /// What makes rows independent; `None` where the covariance is not positive
    /// definite.
    pub(super) fn roots(&self) -> Option<Roots> {
        let parts = self.factors()?;
        let common = match &self.common {
            None => None,
            Some(common) => {
                let mut white = common.clone();
                whiten_parts(&parts, &mut white);
                let (rows, columns) = white.shape();
                if rows < columns {
                    // Zero rows let the decomposition see all columns.
                    white = white.resize_vertically(columns, 0.0);
                }
                let decomposition = tall_svd(white)?;
                let rank = decomposition.values.iter().filter(|v| **v > 0.0).count();
                let share = |s: &f64| 1.0 - 1.0 / (1.0 + s * s).sqrt();
                let shares = decomposition.values.iter().take(rank).map(share).collect();
                Some((decomposition.u.view((0, 0), (rows, rank)).into_owned(), shares))
            }
        };
        Some(Roots { parts, common })
    }

    /// Lower Cholesky factors of the parts, with their rows.
    fn factors(&self) -> Option<Vec<(Vec<usize>, DMatrix<f64>)>> {
        let root =
            |(rows, matrix): &(Vec<usize>, DMatrix<f64>)| Some((rows.clone(), matrix.clone().cholesky()?.unpack()));
        self.parts.iter().map(root).collect()
    }
}

/// Numbers 0..`count` in classes that `links` join, each ascending, by their
/// first number.
fn classes(count: usize, links: impl Iterator<Item = (usize, usize)>) -> Vec<Vec<usize>> {
    let mut first: Vec<usize> = (0..count).collect();
    fn root(first: &mut [usize], mut i: usize) -> usize {
        while first[i] != i {
            first[i] = first[first[i]];
            i = first[i];
        }
        i
    }
    for (i, j) in links {
        let (a, b) = (root(&mut first, i), root(&mut first, j));
        first[a.max(b)] = a.min(b);
    }
    let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for i in 0..count {
        members.entry(root(&mut first, i)).or_default().push(i);
    }
    members.into_values().collect()
}

/// Covariance of the displacements of one posture in units of the variance of
/// a displacement: fewer readings weigh less, and displacements against one
/// reference reading share its error (two load states correlate by 0.5).
pub(super) fn covariance(
    cell: &Cell,
    measured: &[MeasuredPosture],
    labels: &[RowLabel],
    weights: Weights,
) -> Result<Covariance> {
    let of = |label: &RowLabel| -> &Displacement { &measured[label.measured].displacements[label.displacement] };
    // Shares of the variance of a displacement: a reading of either state, or
    // of the loaded one alone where the paper's count holds.
    let two = cell.noise.readings_per_displacement == 2;
    let (loaded, reference) = if two { (0.5, 0.5) } else { (1.0, 0.0) };
    let unit = cell.noise.reading_variance;
    let reading = |d: &Displacement| -> Result<Matrix3<f64>> {
        match (weights, d.covariance) {
            (Weights::Readings, _) => Ok(Matrix3::identity()),
            (Weights::Tracker, Some(covariance)) if unit > 0.0 => Ok(covariance / unit),
            (Weights::Tracker, _) => Err(Error::new(
                Code::MissingKey,
                "The weights need the tracker's accuracy, and these displacements come without it.",
            )
            .key("tracker")
            .hint(
                "give range_um and angle_urad in [tracker] of the cell, or u95x_mm, u95y_mm, u95z_mm in the table, \
                and the raw readings",
            )),
        }
    };
    let readings: Vec<Matrix3<f64>> = labels.iter().map(|l| reading(of(l))).collect::<Result<_>>()?;
    // Displacements before each that can share anything with it.
    let mut alike: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let mut entries = Vec::new();
    let mut add = |i: usize, j: usize, block: &Matrix3<f64>| {
        for axis in 0..3 {
            let to = if i == j { axis + 1 } else { 3 };
            let values = (0..to).map(|other| (3 * i + axis, 3 * j + other, block[(axis, other)]));
            entries.extend(values.filter(|e| e.2 != 0.0));
        }
    };
    for i in 0..labels.len() {
        let a = of(&labels[i]);
        let group = alike.entry(a.point).or_default();
        if reference != 0.0 {
            for &j in group.iter() {
                let mean = (readings[i] + readings[j]) * 0.5;
                add(i, j, &(mean * (reference * a.shared_reference(of(&labels[j])))));
            }
        }
        group.push(i);
        let of_loaded = loaded / f64::from(a.readings.max(1));
        let variance = readings[i] * (of_loaded + reference * a.shared_reference(a));
        add(i, i, &variance);
    }
    let parts = Covariance::from_entries(3 * labels.len(), &entries).parts;
    let common = common(measured, labels, &readings, loaded);
    Ok(Covariance { parts, common })
}

/// What taking back the motion of the base adds to all points of a posture
/// alike: in each state by itself, and in all of them together.
fn common(
    measured: &[MeasuredPosture],
    labels: &[RowLabel],
    readings: &[Matrix3<f64>],
    loaded: f64,
) -> Option<DMatrix<f64>> {
    let mut states: Vec<usize> = labels.iter().map(|l| l.measured).collect();
    states.dedup();
    if states.iter().all(|m| measured[*m].common_readings == [0.0; 2]) {
        return None;
    }
    let mut out = DMatrix::zeros(3 * labels.len(), 3 * (states.len() + 1));
    for (i, label) in labels.iter().enumerate() {
        let [here, all] = measured[label.measured].common_readings;
        let state = states.iter().position(|m| *m == label.measured).unwrap_or(0);
        let unit = readings[i].trace() / 3.0 * loaded;
        for axis in 0..3 {
            out[(3 * i + axis, axis)] = (all * unit).sqrt();
            out[(3 * i + axis, 3 * (state + 1) + axis)] = (here * unit).sqrt();
        }
    }
    Some(out)
}

/// What shifts common to a posture do to its rows, rows × 3c. What the model
/// misses grows with the load, so a shift counts in proportion to the joint
/// torques; loads in different directions have shifts of their own.
pub(super) fn shared(measured: &[MeasuredPosture], states: &[usize], torques: &[DVector<f64>]) -> DMatrix<f64> {
    let rows: usize = states.iter().map(|m| 3 * measured[*m].displacements.len()).sum();
    // States by falling torque, so that the largest of a direction leads it.
    let order = order_by_number(states.len(), |i| -torques[i].norm());
    let mut leaders: Vec<usize> = Vec::new();
    let mut place = vec![(0, 1.0); states.len()];
    for &s in &order {
        let class = leaders.iter().position(|&l| {
            let product = torques[l].norm() * torques[s].norm();
            product <= 0.0 || (torques[l].dot(&torques[s])).abs() > ALIKE_TORQUE_COSINE * product
        });
        place[s] = match class {
            Some(class) => {
                let leader = &torques[leaders[class]];
                let size = leader.norm_squared();
                let part = if size > 0.0 { torques[s].dot(leader) / size } else { 1.0 };
                (class, part)
            }
            None => {
                leaders.push(s);
                (leaders.len() - 1, 1.0)
            }
        };
    }
    let mut out = DMatrix::zeros(rows, 3 * leaders.len());
    let mut at = 0;
    for (s, m) in states.iter().enumerate() {
        let (class, part) = place[s];
        for _ in &measured[*m].displacements {
            for axis in 0..3 {
                out[(at + axis, 3 * class + axis)] = part;
            }
            at += 3;
        }
    }
    out
}
