//! Three robots of the catalogue by products of 4 × 4 matrices, with the capsules read from the
//! catalogue's text.

use super::distance::Shape;
use crate::common::model::{M4, rot_x, rot_z, shift, times};
use crate::common::prelude::*;

const TEXT: &str = include_str!("../../../data/robots.toml");

/// A pose as a 4 × 4 matrix.
#[derive(Debug, Clone, Copy)]
pub struct Frame(M4<f64>);

fn rot_y(a: f64) -> M4<f64> {
    let (s, c) = a.sin_cos();
    [[c, 0.0, s, 0.0], [0.0, 1.0, 0.0, 0.0], [-s, 0.0, c, 0.0], [0.0, 0.0, 0.0, 1.0]]
}

impl Frame {
    /// At `at`, turned about the fixed x, then y, then z axis.
    pub fn of_pose(at: [f64; 3], turns: [f64; 3]) -> Self {
        let turned = times(&times(&rot_z(turns[2]), &rot_y(turns[1])), &rot_x(turns[0]));
        Frame(times(&shift(at[0], at[1], at[2]), &turned))
    }

    pub fn times(&self, other: &Frame) -> Frame {
        Frame(times(&self.0, &other.0))
    }

    pub fn origin(&self) -> Vector3<f64> {
        Vector3::from_fn(|i, _| self.0[i][3])
    }

    pub fn axis(&self, axis: usize) -> Vector3<f64> {
        Vector3::from_fn(|i, _| self.0[i][axis])
    }

    pub fn direction(&self, v: &[f64; 3]) -> Vector3<f64> {
        (0..3).fold(Vector3::zeros(), |sum, i| sum + self.axis(i) * v[i])
    }

    pub fn point(&self, v: &[f64; 3]) -> Vector3<f64> {
        self.origin() + self.direction(v)
    }
}

/// What the checker knows of a robot.
#[derive(Debug, Clone)]
pub struct Arm {
    pub key: &'static str,
    /// Reach \[m\], for sizes of what stands around.
    pub reach: f64,
    rows: Vec<[f64; 4]>,
    coupling: DMatrix<f64>,
    base: M4<f64>,
    flange: M4<f64>,
    /// The machine's limits \[deg\].
    pub limits: Vec<[f64; 2]>,
    /// Link and capsule, in the frame its row ends in, of link 0 in the base frame.
    pub capsules: Vec<(usize, Shape)>,
    pub ignored: Vec<(usize, usize)>,
}

/// Frames of an arm at one posture.
#[derive(Debug, Clone)]
pub struct Reached {
    /// The robot's own base, then the end of each row.
    pub links: Vec<Frame>,
    /// A point on the axis of each joint, and its direction.
    pub axes: Vec<(Vector3<f64>, Vector3<f64>)>,
    pub flange: Frame,
}

impl Arm {
    /// # Panics
    /// A key that the catalogue does not have.
    pub fn new(key: &'static str) -> Self {
        let entry = find_in_catalogue(key).unwrap();
        assert_eq!(entry.convention, DhConvention::Modified);
        let robot = entry.robot().unwrap();
        let rows = entry.dh_rows();
        let text = TEXT.split(&format!("key = \"{key}\"")).nth(1).unwrap();
        let text = text.split("[[robot]]").next().unwrap();
        let capsules = numbers_after(text, "capsules = [");
        let capsules = capsules.chunks_exact(8).map(|c| {
            let shape = Shape::Capsule { from: [c[1], c[2], c[3]], to: [c[4], c[5], c[6]], radius: c[7] };
            (c[0] as usize, shape)
        });
        let ignored = numbers_after(text, "ignored_pairs = [");
        let limits = numbers_after(text, "limits_deg = [");
        let matrix = |pose: nalgebra::Matrix4<f64>| std::array::from_fn(|i| std::array::from_fn(|j| pose[(i, j)]));
        Arm {
            key,
            reach: entry.reach_m().unwrap(),
            rows: rows.iter().map(|r| [r.alpha, r.a, r.d, r.offset]).collect(),
            coupling: robot.coupling().clone(),
            base: matrix(entry.base().to_homogeneous()),
            flange: matrix(entry.flange().to_homogeneous()),
            limits: limits.chunks_exact(2).map(|l| [l[0], l[1]]).collect(),
            capsules: capsules.collect(),
            ignored: ignored.chunks_exact(2).map(|p| (p[0] as usize, p[1] as usize)).collect(),
        }
    }

    pub fn joint_count(&self) -> usize {
        self.rows.len()
    }

    /// Serial angles of controller angles \[rad\], without the rows' offsets.
    pub fn serial(&self, q: &[f64]) -> Vec<f64> {
        (0..q.len()).map(|i| (0..q.len()).map(|j| self.coupling[(i, j)] * q[j]).sum()).collect()
    }

    /// At serial angles \[rad\], on a base that stands at `mount`.
    pub fn at(&self, mount: &Frame, serial: &[f64]) -> Reached {
        let mut links = vec![*mount];
        let mut axes = Vec::new();
        let mut frame = times(&mount.0, &self.base);
        for (&[alpha, a, d, offset], angle) in self.rows.iter().zip(serial) {
            frame = times(&times(&frame, &rot_x(alpha)), &shift(a, 0.0, 0.0));
            axes.push((Frame(frame).origin(), Frame(frame).axis(2)));
            frame = times(&times(&frame, &rot_z(angle + offset)), &shift(0.0, 0.0, d));
            links.push(Frame(frame));
        }
        Reached { flange: Frame(times(&frame, &self.flange)), links, axes }
    }
}

/// The numbers from `heading` to the end of its list.
fn numbers_after(text: &str, heading: &str) -> Vec<f64> {
    let Some(list) = text.split(heading).nth(1) else {
        return Vec::new();
    };
    let mut depth = 1;
    let end = list.find(|c| {
        depth += i32::from(c == '[') - i32::from(c == ']');
        depth == 0
    });
    let is_number = |c: char| c.is_ascii_digit() || c == '-' || c == '.';
    list[..end.unwrap()]
        .split(|c| !is_number(c))
        .filter(|word| !word.is_empty())
        .map(|word| word.parse().unwrap())
        .collect()
}
