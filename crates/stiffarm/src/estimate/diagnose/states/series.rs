//! The load states of one posture, projected onto one direction, with lines and
//! curves through them.

use crate::error::Result;
use crate::estimate::identify::{ALIKE_TORQUE_COSINE, Block, Covariance, Fit, RowLabel};
use crate::numerics::information::Factor;
use nalgebra::{DMatrix, DVector};

/// Loads that differ by less, relative to the largest, are equal.
const EQUAL_LOADS: f64 = 0.05;

/// Load states of a posture, projected.
pub(super) struct Series {
    pub(super) posture: String,
    pub(super) states: Vec<String>,
    pub(super) load: DVector<f64>,
    /// Some(true) where the load came down to the state.
    down: Vec<Option<bool>>,
    pub(super) z: DVector<f64>,
    /// Covariance of z in units of σ² of a component.
    pub(super) covariance: DMatrix<f64>,
    /// Components: states × rows and their covariance, state by state.
    components: DVector<f64>,
    spread: Covariance,
    /// Number of different loads.
    levels: usize,
}

/// Linear fit with its covariance in units of σ².
pub(super) struct Line {
    pub(super) values: DVector<f64>,
    pub(super) covariance: DMatrix<f64>,
}

/// The load states of one block whose loads point alike, at the points that
/// all of them have.
pub(super) fn series(fit: &Fit, block: &Block) -> Result<Option<Series>> {
    let (cell, system, measured) = (fit.cell(), fit.system(), fit.postures());
    let labels = &system.labels[block.rows.start / 3..block.rows.end / 3];
    let mut states: Vec<usize> = labels.iter().map(|l| l.measured).collect();
    states.dedup();
    let torques: Vec<DVector<f64>> = states
        .iter()
        .filter_map(|&m| fit.experiment().terms(m))
        .map(|terms| DVector::from_column_slice(terms.torque()))
        .collect();
    let Some((first, leader)) =
        torques.iter().enumerate().max_by(|a, b| a.1.norm().total_cmp(&b.1.norm())).filter(|(_, t)| t.norm() > 0.0)
    else {
        return Ok(None);
    };
    // Of several load cases the states of one: others pull from elsewhere, however alike
    // their torques.
    let case = |s: usize| cell.setup.load.case_of(&measured[states[s]].state).ok();
    let alike = |t: &DVector<f64>| t.dot(leader) > ALIKE_TORQUE_COSINE * t.norm() * leader.norm();
    let of_case: Vec<usize> = (0..states.len()).filter(|&s| alike(&torques[s]) && case(s) == case(first)).collect();
    let point_of = |l: &RowLabel| measured[l.measured].displacements[l.displacement].point;
    let has = |state: usize, point: usize| labels.iter().any(|l| l.measured == state && point_of(l) == point);
    let points: Vec<usize> =
        (0..cell.setup.tool.point_count()).filter(|&p| of_case.iter().all(|&s| has(states[s], p))).collect();
    if of_case.len() < 2 || points.is_empty() {
        return Ok(None);
    }
    // Repeats are averaged.
    let per_state = 3 * points.len();
    let place = |label: &RowLabel| {
        let state = of_case.iter().position(|&s| states[s] == label.measured)?;
        let point = points.iter().position(|&p| p == point_of(label))?;
        Some(per_state * state + 3 * point)
    };
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); per_state * of_case.len()];
    for (i, label) in labels.iter().enumerate() {
        if let Some(at) = place(label) {
            (0..3).for_each(|axis| groups[at + axis].push(3 * i + axis));
        }
    }
    let average = |v: &DVector<f64>| {
        let mean = |group: &Vec<usize>| {
            let values = group.iter().map(|i| v[block.rows.start + i]);
            values.sum::<f64>() / group.len() as f64
        };
        DVector::from_iterator(groups.len(), groups.iter().map(mean))
    };
    // Lost motion that was fitted is in no line.
    let mut delta = system.delta.clone();
    for (i, _) in system.extra.iter().enumerate().filter(|(_, term)| !term.is_spring()) {
        let at = system.springs + i;
        delta.axpy(-fit.solution().values[at], &system.psi.column(at), 1.0);
    }
    let components = average(&delta);
    let spread = block.covariance.averaged(&groups);
    let psi = system.psi.rows(block.rows.start, block.rows.len());
    let mut whole = DVector::zeros(system.delta.len());
    whole.rows_mut(block.rows.start, block.rows.len()).copy_from(&(psi * &fit.solution().values));
    let modelled = average(&whole);
    let load =
        DVector::from_iterator(of_case.len(), of_case.iter().map(|&s| torques[s].dot(leader) / leader.norm_squared()));
    // The state that leads is the largest; its model gives the direction.
    let direction = modelled.rows(per_state * load.imax(), per_state).into_owned();
    let Some(direction) = direction.try_normalize(0.0) else {
        return Ok(None);
    };
    let scale = (points.len() as f64).sqrt();
    let mut project = DMatrix::zeros(of_case.len(), per_state * of_case.len());
    for s in 0..of_case.len() {
        project.view_mut((s, per_state * s), (1, per_state)).copy_from(&(direction.transpose() / scale));
    }
    let states: Vec<String> = of_case.iter().map(|&s| measured[states[s]].state.clone()).collect();
    Ok(Some(Series {
        posture: block.posture.clone(),
        down: directions(&states, &load),
        levels: levels(&load),
        z: &project * &components,
        covariance: &project * spread.times(&project.transpose()),
        states,
        load,
        components,
        spread,
    }))
}

/// Whether the load came up or down to each state: by its name, else by the
/// state before it, the first coming from zero.
fn directions(states: &[String], load: &DVector<f64>) -> Vec<Option<bool>> {
    (0..states.len())
        .map(|s| {
            let before = if s == 0 { 0.0 } else { load[s - 1] };
            if states[s].starts_with("down") {
                Some(true)
            } else if states[s].starts_with("up") || load[s] > before + EQUAL_LOADS {
                Some(false)
            } else if load[s] < before - EQUAL_LOADS {
                Some(true)
            } else {
                None
            }
        })
        .collect()
}

/// Number of different loads.
fn levels(load: &DVector<f64>) -> usize {
    let mut sorted: Vec<f64> = load.iter().copied().collect();
    sorted.sort_by(f64::total_cmp);
    1 + sorted.windows(2).filter(|w| w[1] - w[0] > EQUAL_LOADS).count()
}

impl Series {
    /// True where loads came up and down.
    fn returns(&self) -> bool {
        self.down.contains(&Some(true)) && self.down.contains(&Some(false))
    }

    /// Columns 1, λ, λ² if asked for, and 1 for states reached from above.
    fn design(&self, curved: bool) -> Option<DMatrix<f64>> {
        let count = self.load.len();
        let mut columns = vec![DVector::repeat(count, 1.0), self.load.clone()];
        if self.levels < 2 || (curved && self.levels < 3) {
            return None;
        }
        if curved {
            columns.push(self.load.component_mul(&self.load));
        }
        if self.returns() {
            let down = self.down.iter().map(|d| f64::from(u8::from(*d == Some(true))));
            columns.push(DVector::from_iterator(count, down));
        }
        (columns.len() <= count).then(|| DMatrix::from_columns(&columns))
    }

    /// Line, or curve, through z.
    pub(super) fn fit(&self, curved: bool) -> Option<Line> {
        let design = self.design(curved)?;
        let root = self.covariance.clone().cholesky()?.unpack();
        let x = root.solve_lower_triangular(&design)?;
        let z = root.solve_lower_triangular(&self.z)?;
        let factor = Factor::new(&x).ok()?;
        factor
            .undetermined()
            .is_empty()
            .then(|| Line { values: factor.solve(&z), covariance: factor.inverse_information() })
    }

    /// What the richest curve that leaves degrees of freedom leaves of the
    /// components: sum of squares in units of σ², and degrees of freedom.
    pub(super) fn scatter(&self) -> Option<(f64, usize)> {
        let count = self.load.len();
        // With three loads a line would leave the curvature.
        let design = self.design(self.levels > 2).filter(|d| d.ncols() < count)?;
        let per_state = self.components.len() / count;
        let mut wanted = DMatrix::from_columns(std::slice::from_ref(&self.components));
        if let Some(common) = self.spread.common() {
            let columns = common.ncols();
            wanted = wanted.resize_horizontally(1 + columns, 0.0);
            wanted.columns_mut(1, columns).copy_from(common);
        }
        // Components that share nothing are fitted one by one; what the curve
        // leaves of them, and of what they have in common.
        let mut left = DMatrix::zeros(wanted.ncols(), wanted.ncols());
        let mut rank = 0;
        for together in self.spread.classes(per_state) {
            let wide = design.kronecker(&DMatrix::identity(together.len(), together.len()));
            let states = (0..count).flat_map(|s| together.iter().map(move |c| per_state * s + c));
            let rows: Vec<usize> = states.collect();
            let spread = self.spread.select(&rows);
            let (mut x, mut y) = (wide, wanted.select_rows(&rows));
            if !(spread.whiten_without_common(&mut x) && spread.whiten_without_common(&mut y)) {
                return None;
            }
            let factor = Factor::new(&x).ok()?;
            rank += factor.rank();
            let basis = factor.basis(x.nrows());
            y -= &basis * basis.tr_mul(&y);
            left += y.tr_mul(&y);
        }
        // Least squares with the common part as further unknowns of variance 1.
        let columns = left.ncols() - 1;
        let mut squares = left[(0, 0)];
        if columns > 0 {
            let across = left.view((1, 0), (columns, 1)).into_owned();
            let whole = left.view((1, 1), (columns, columns)) + DMatrix::identity(columns, columns);
            let explained = whole.cholesky()?.solve(&across);
            squares -= across.dot(&explained);
        }
        Some((squares, self.components.len() - rank))
    }

    /// Mean of down minus up over pairs at equal load, its variance in units of
    /// σ², and the mean displacement at these loads.
    pub(super) fn width(&self, line: Option<&Line>) -> Option<(f64, f64, f64)> {
        let of = |down: bool| (0..self.load.len()).filter(move |&s| self.down[s] == Some(down));
        let slope = line.map_or(0.0, |l| l.values[1]);
        let mut contrast = DVector::zeros(self.load.len());
        let (mut pairs, mut size) = (0, 0.0);
        for d in of(true) {
            let gap = |u: &usize| (self.load[*u] - self.load[d]).abs();
            let up = of(false).min_by(|a, b| gap(a).total_cmp(&gap(b)));
            if let Some(u) = up.filter(|u| gap(u) <= EQUAL_LOADS) {
                contrast[d] += 1.0;
                contrast[u] -= 1.0;
                size += 0.5 * (self.z[d] + self.z[u]);
                pairs += 1;
            }
        }
        if pairs == 0 {
            return None;
        }
        contrast /= f64::from(pairs);
        let width = contrast.dot(&self.z) - slope * contrast.dot(&self.load);
        let variance = contrast.dot(&(&self.covariance * &contrast));
        Some((width, variance, size / f64::from(pairs)))
    }
}
