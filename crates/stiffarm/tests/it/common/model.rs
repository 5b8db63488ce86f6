//! The model a second time, as plain as it can be: products of 4 × 4 matrices,
//! over any number type, so that dual numbers give exact derivatives.
//!
//! Shares only data types with the library (its `Load` and `Task`), no arithmetic.

use super::set_ups::chain;
use super::{plain_cell, tool};
use nalgebra::{DMatrix, Isometry3, SVD, Vector3};
use num_dual::{Dual64, DualNum};
use stiffarm::model::cell::{Cell, Noise, Task};
use stiffarm::model::load::{Axes, Load};
use stiffarm::model::observation::Setup;
use stiffarm::model::robot::DhConvention;

/// A real or dual number.
pub trait Scalar: DualNum<Primitive = f64> + Copy {}
impl<T: DualNum<Primitive = f64> + Copy> Scalar for T {}

pub type V3<T> = [T; 3];
pub type M4<T> = [[T; 4]; 4];

pub fn cross<T: Scalar>(a: V3<T>, b: V3<T>) -> V3<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn dot<T: Scalar>(a: V3<T>, b: V3<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn minus<T: Scalar>(a: V3<T>, b: V3<T>) -> V3<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub fn times<T: Scalar>(a: &M4<T>, b: &M4<T>) -> M4<T> {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).fold(T::from(0.0), |sum, k| sum + a[i][k] * b[k][j])))
}

fn constant<T: Scalar>(m: [[f64; 4]; 4]) -> M4<T> {
    m.map(|row| row.map(T::from))
}

pub fn rot_x<T: Scalar>(a: f64) -> M4<T> {
    let (s, c) = a.sin_cos();
    constant([[1.0, 0.0, 0.0, 0.0], [0.0, c, -s, 0.0], [0.0, s, c, 0.0], [0.0, 0.0, 0.0, 1.0]])
}

pub fn rot_z<T: Scalar>(angle: T) -> M4<T> {
    let (s, c, o, l) = (angle.sin(), angle.cos(), T::from(0.0), T::from(1.0));
    [[c, -s, o, o], [s, c, o, o], [o, o, l, o], [o, o, o, l]]
}

pub fn shift<T: Scalar>(x: f64, y: f64, z: f64) -> M4<T> {
    constant([[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]])
}

/// A cell in raw numbers.
#[derive(Debug, Clone)]
pub struct Model {
    /// Modified (Craig) or standard Denavit–Hartenberg rows.
    pub modified: bool,
    /// α, a, d, offset of each joint.
    pub rows: Vec<[f64; 4]>,
    pub base: Isometry3<f64>,
    /// C of θ = offset + C q.
    pub coupling: DMatrix<f64>,
    /// E of e = E θ.
    pub elastic: Option<DMatrix<f64>>,
    pub loading_point: [f64; 3],
    pub measuring_points: Vec<[f64; 3]>,
    pub load: Load,
    pub prior: Vec<f64>,
    /// Characteristic length.
    pub length: f64,
    /// Standard deviation of a displacement component.
    pub sigma: f64,
    /// Standard deviation of a shift common to the points of a posture.
    pub tau: f64,
    pub tasks: Vec<Task>,
}

/// Axes, origins and flange of a model at one posture.
pub struct Chain<T> {
    pub axes: Vec<V3<T>>,
    pub origins: Vec<V3<T>>,
    pub flange: M4<T>,
}

impl<T: Scalar> Chain<T> {
    pub fn direction(&self, v: [f64; 3]) -> V3<T> {
        let f = &self.flange;
        std::array::from_fn(|i| f[i][0] * v[0] + f[i][1] * v[1] + f[i][2] * v[2])
    }

    pub fn point(&self, v: [f64; 3]) -> V3<T> {
        let d = self.direction(v);
        std::array::from_fn(|i| d[i] + self.flange[i][3])
    }

    /// Linear part of the Jacobian's column `j` at `p`.
    pub fn column(&self, j: usize, p: V3<T>) -> V3<T> {
        cross(self.axes[j], minus(p, self.origins[j]))
    }
}

impl Model {
    pub fn joint_count(&self) -> usize {
        self.rows.len()
    }

    /// The library's cell with the same numbers, bounds ±π and no limits.
    pub fn cell(&self) -> Cell {
        let convention = if self.modified { DhConvention::Modified } else { DhConvention::Standard };
        let mut robot =
            chain("random", convention, &self.rows).with_base(&self.base).with_coupling(self.coupling.clone()).unwrap();
        if let Some(e) = &self.elastic {
            robot = robot.with_elastic_coordinates(e.clone()).unwrap();
        }
        let points = self.measuring_points.iter().copied().map(Vector3::from);
        let setup = Setup { robot, tool: tool(self.loading_point.into(), points), load: self.load.clone() };
        let noise = Noise {
            reading_variance: self.sigma * self.sigma,
            readings_per_displacement: 1,
            posture_common_std: self.tau,
        };
        Cell {
            name: "random".to_string(),
            prior: Some(self.prior.clone()),
            characteristic_length: Some(self.length),
            tasks: self.tasks.clone(),
            ..plain_cell(setup, noise)
        }
    }

    /// θ = offset + C q, without the offset (the rows hold it).
    pub fn serial<T: Scalar>(&self, q: &[T]) -> Vec<T> {
        (0..q.len()).map(|i| (0..q.len()).fold(T::from(0.0), |sum, j| sum + q[j] * self.coupling[(i, j)])).collect()
    }

    /// The chain at serial angles without their offsets.
    pub fn chain_serial<T: Scalar>(&self, serial: &[T]) -> Chain<T> {
        let base = self.base.to_homogeneous();
        let mut frame: M4<T> = std::array::from_fn(|i| std::array::from_fn(|j| T::from(base[(i, j)])));
        let (mut axes, mut origins) = (Vec::new(), Vec::new());
        let mut keep = |frame: &M4<T>| {
            axes.push([frame[0][2], frame[1][2], frame[2][2]]);
            origins.push([frame[0][3], frame[1][3], frame[2][3]]);
        };
        for (&[alpha, a, d, offset], &angle) in self.rows.iter().zip(serial) {
            let turn = rot_z(angle + offset);
            if self.modified {
                frame = times(&times(&frame, &rot_x(alpha)), &shift(a, 0.0, 0.0));
                frame = times(&times(&frame, &turn), &shift(0.0, 0.0, d));
                keep(&frame);
            } else {
                keep(&frame);
                frame = times(&times(&frame, &turn), &shift(0.0, 0.0, d));
                frame = times(&times(&frame, &shift(a, 0.0, 0.0)), &rot_x(alpha));
            }
        }
        Chain { axes, origins, flange: frame }
    }

    pub fn chain<T: Scalar>(&self, q: &[T]) -> Chain<T> {
        self.chain_serial(&self.serial(q))
    }

    /// Force and moment at the loading point.
    pub fn wrench<T: Scalar>(&self, chain: &Chain<T>) -> (V3<T>, V3<T>) {
        let fixed = |v: &Vector3<f64>| [T::from(v.x), T::from(v.y), T::from(v.z)];
        let zero = [T::from(0.0); 3];
        match &self.load {
            Load::Rope { anchor, magnitude } => {
                let rope = minus(fixed(anchor), chain.point(self.loading_point));
                let scale = dot(rope, rope).sqrt().recip() * *magnitude;
                (rope.map(|c| c * scale), zero)
            }
            Load::Weight { magnitude, direction } => (fixed(&(direction * *magnitude)), zero),
            Load::Constant { wrench, axes: Axes::Base } => (fixed(&wrench.force), fixed(&wrench.moment)),
            Load::Constant { wrench, axes: Axes::Tool } => {
                (chain.direction(wrench.force.into()), chain.direction(wrench.moment.into()))
            }
            Load::Measured | Load::Cases(_) => panic!("a model has a load"),
        }
    }

    /// Γ = (J^f)ᵀ W.
    pub fn torque<T: Scalar>(&self, chain: &Chain<T>, (force, moment): (V3<T>, V3<T>)) -> Vec<T> {
        let p = chain.point(self.loading_point);
        (0..self.rows.len()).map(|j| dot(chain.column(j, p), force) + dot(chain.axes[j], moment)).collect()
    }

    /// Ψ of one posture, rows for point, x, y, z: Δ = J E⁻¹ diag(H) E⁻ᵀ Γ.
    pub fn psi<T: Scalar>(&self, q: &[T]) -> DMatrix<T> {
        let n = self.rows.len();
        let chain = self.chain(q);
        let torque = self.torque(&chain, self.wrench(&chain));
        let mixing = match &self.elastic {
            Some(e) => e.clone().try_inverse().unwrap(),
            None => DMatrix::identity(n, n),
        };
        let sum = |term: &dyn Fn(usize) -> T| (0..n).fold(T::from(0.0), |s, i| s + term(i));
        DMatrix::from_fn(3 * self.measuring_points.len(), n, |row, j| {
            let p = chain.point(self.measuring_points[row / 3]);
            let motion = sum(&|i| chain.column(i, p)[row % 3] * mixing[(i, j)]);
            let load = sum(&|i| torque[i] * mixing[(i, j)]);
            motion * load
        })
    }

    /// Columns of a posture's random effects, standard deviation one each, 3m × effects:
    /// all entries of symmetric compliances at base and joints but the joints' own axes;
    /// `sizes` of shifts, turns and their coupling.
    pub fn spring_columns<T: Scalar>(&self, q: &[T], sizes: [f64; 3]) -> DMatrix<T> {
        let chain = self.chain(q);
        let (force, moment) = self.wrench(&chain);
        let loading = chain.point(self.loading_point);
        let unit = |i: usize| std::array::from_fn(|k| T::from(if i == k { 1.0 } else { 0.0 }));
        let scaled = |v: V3<T>, s: T| v.map(|c| c * s);
        let plus = |a: V3<T>, b: V3<T>| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        let across = |v: V3<T>, z: V3<T>| minus(v, scaled(z, dot(v, z)));
        let on_axis = scaled(chain.axes[0], dot(chain.axes[0], chain.origins[0]));
        let base = minus(chain.origins[0], on_axis);
        let mut places = vec![([unit(0), unit(1), unit(2)], base, None)];
        for j in 0..self.rows.len() {
            // Any axes will do that turn with the link behind the joint.
            let z = chain.axes[j];
            let next = chain.axes.get(j + 1).map(|axis| {
                let origin = minus(chain.origins[j + 1], chain.origins[j]);
                [across(*axis, z), across(origin, z)]
            });
            let last = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|v| across(chain.direction(v), z));
            let x = next.into_iter().flatten().chain(last).find(|v| dot(*v, *v).re() > 1e-2).unwrap();
            let x = scaled(x, dot(x, x).sqrt().recip());
            // The library's frame of a modified (Craig) row stands before its shift d.
            let d = if self.modified { self.rows[j][2] } else { 0.0 };
            let origin = minus(chain.origins[j], scaled(z, T::from(d)));
            places.push(([x, cross(z, x), z], origin, Some(j)));
        }
        let points: Vec<V3<T>> = self.measuring_points.iter().map(|p| chain.point(*p)).collect();
        let mut columns = Vec::new();
        for (axes, origin, joint) in places {
            let about = plus(moment, cross(minus(loading, origin), force));
            let felt = |i: usize| {
                if i < 3 { dot(axes[i], force) } else { dot(axes[i - 3], about) }
            };
            let moved = |i: usize, p: V3<T>| {
                if i < 3 { axes[i] } else { cross(axes[i - 3], minus(p, origin)) }
            };
            for row in 0..6 {
                for column in row..6 {
                    if joint.is_some() && (row, column) == (5, 5) {
                        continue;
                    }
                    let size = match (row < 3, column < 3) {
                        (true, true) => sizes[0],
                        (false, false) => sizes[1],
                        _ => sizes[2],
                    };
                    let size = if row == column { size } else { size * 0.5f64.sqrt() };
                    let mut entries = Vec::new();
                    for p in &points {
                        let mut shift = scaled(moved(row, *p), felt(column));
                        if row != column {
                            shift = plus(shift, scaled(moved(column, *p), felt(row)));
                        }
                        entries.extend(shift.map(|c| c * size));
                    }
                    columns.push(entries);
                }
            }
        }
        DMatrix::from_fn(3 * points.len(), columns.len(), |i, j| columns[j][i])
    }

    /// Ψ of several postures.
    pub fn stacked<T: Scalar>(&self, postures: &[Vec<T>]) -> DMatrix<T> {
        let blocks: Vec<DMatrix<T>> = postures.iter().map(|q| self.psi(q)).collect();
        let height = blocks[0].nrows();
        DMatrix::from_fn(height * blocks.len(), self.rows.len(), |i, j| blocks[i / height][(i % height, j)])
    }

    /// Ψ of each task, loaded and measured at its tip, stacked, so that the mean
    /// square of a predicted shift is the squared norm.
    pub fn task_rows(&self) -> DMatrix<f64> {
        let tasks = self.tasks.iter();
        let blocks: Vec<DMatrix<f64>> = tasks.map(|task| self.at_work(task).psi::<f64>(&task.q)).collect();
        let count = blocks.len();
        DMatrix::from_fn(3 * count, self.rows.len(), |i, j| blocks[i / 3][(i % 3, j)] / (count as f64).sqrt())
    }

    /// The model loaded and measured at the tip of a task.
    pub fn at_work(&self, task: &Task) -> Model {
        Model {
            loading_point: task.tip.into(),
            measuring_points: vec![task.tip.into()],
            load: Load::Constant { wrench: task.wrench, axes: task.axes },
            ..self.clone()
        }
    }

    /// J_N at measuring point 1, Eq. (20).
    pub fn normalised_jacobian<T: Scalar>(&self, q: &[T]) -> DMatrix<T> {
        let chain = self.chain(q);
        let p = chain.point(self.measuring_points[0]);
        DMatrix::from_fn(6, self.rows.len(), |i, j| match i {
            0..3 => chain.column(j, p)[i] / self.length,
            _ => chain.axes[j][i - 3],
        })
    }

    /// Covariance of a posture's displacements: σ²I + τ²(1 1ᵀ ⊗ I₃).
    pub fn posture_covariance(&self) -> DMatrix<f64> {
        let rows = 3 * self.measuring_points.len();
        DMatrix::from_fn(rows, rows, |i, j| {
            let variance = if i == j { self.sigma * self.sigma } else { 0.0 };
            let common = if i % 3 == j % 3 { self.tau * self.tau } else { 0.0 };
            variance + common
        })
    }
}

/// R⁻¹ of the QR factors of a full-rank matrix, by modified Gram–Schmidt (twice,
/// for orthogonality to working precision).
pub fn inverse_r<T: Scalar>(matrix: &DMatrix<T>) -> DMatrix<T> {
    let (rows, n) = matrix.shape();
    let mut q = matrix.clone();
    let mut r = DMatrix::from_element(n, n, T::from(0.0));
    let inner = |q: &DMatrix<T>, a: usize, b: usize| (0..rows).fold(T::from(0.0), |sum, i| sum + q[(i, a)] * q[(i, b)]);
    for j in 0..n {
        for _ in 0..2 {
            for k in 0..j {
                let along = inner(&q, k, j);
                r[(k, j)] += along;
                for i in 0..rows {
                    let step = q[(i, k)] * along;
                    q[(i, j)] -= step;
                }
            }
        }
        let norm = inner(&q, j, j).sqrt();
        r[(j, j)] = norm;
        for i in 0..rows {
            q[(i, j)] /= norm;
        }
    }
    let mut inverse = DMatrix::from_element(n, n, T::from(0.0));
    for j in 0..n {
        inverse[(j, j)] = r[(j, j)].recip();
        for i in (0..j).rev() {
            let sum = (i + 1..=j).fold(T::from(0.0), |s, k| s + r[(i, k)] * inverse[(k, j)]);
            inverse[(i, j)] = -sum / r[(i, i)];
        }
    }
    inverse
}

/// Diagonal of (AᵀA)⁻¹.
pub fn inverse_gram_diagonal<T: Scalar>(matrix: &DMatrix<T>) -> Vec<T> {
    let inverse = inverse_r(matrix);
    (0..inverse.nrows())
        .map(|i| (i..inverse.ncols()).fold(T::from(0.0), |s, j| s + inverse[(i, j)] * inverse[(i, j)]))
        .collect()
}

/// Whether nalgebra's decomposition of a matrix is one: it loses digits in
/// about one of a thousand (<https://github.com/dimforge/nalgebra/issues/1172>).
pub fn has_sound_svd(matrix: &DMatrix<f64>) -> bool {
    let back = SVD::new(matrix.clone(), true, true).recompose().unwrap();
    (back - matrix).norm() < 1e-13 * matrix.norm()
}

/// Singular values, descending, with dσ_i = u_iᵀ dA v_i (simple ones only).
pub fn singular_values(matrix: &DMatrix<Dual64>) -> Vec<Dual64> {
    let svd = SVD::new(matrix.map(|v| v.re), true, true);
    let (u, v_t) = (svd.u.unwrap(), svd.v_t.unwrap());
    let slope = u.transpose() * matrix.map(|v| v.eps) * v_t.transpose();
    let mut values: Vec<Dual64> =
        (0..svd.singular_values.len()).map(|i| Dual64::new(svd.singular_values[i], slope[(i, i)])).collect();
    values.sort_by(|a, b| b.re.total_cmp(&a.re));
    values
}

/// k(J_N), Eq. (21), by the QR factors of J_Nᵀ.
pub fn condition_number<T: Scalar>(normalised_jacobian: &DMatrix<T>) -> T {
    let square = normalised_jacobian.iter().fold(T::from(0.0), |s, v| s + *v * *v);
    let inverse_trace =
        inverse_gram_diagonal(&normalised_jacobian.transpose()).into_iter().fold(T::from(0.0), |s, v| s + v);
    (square * inverse_trace).sqrt() / 6.0
}

/// Postures of `n` angles as dual numbers, with the derivative by angle `k` of them all.
pub fn duals(flat: &[f64], n: usize, k: usize) -> Vec<Vec<Dual64>> {
    let dual = |(i, v): (usize, &f64)| Dual64::new(*v, if i == k { 1.0 } else { 0.0 });
    let all: Vec<Dual64> = flat.iter().enumerate().map(dual).collect();
    all.chunks_exact(n).map(<[_]>::to_vec).collect()
}
