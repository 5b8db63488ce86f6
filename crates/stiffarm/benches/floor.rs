//! How far the novel index's value and gradient (6 postures × 4 points) are
//! from the floor that the number of operations and this machine's measured
//! arithmetic rate set, and where the time goes.
//!
//! `cargo bench -p stiffarm --bench floor`

use std::hint::black_box;
use std::time::Instant;
use stiffarm::plan::characteristic_length::with_characteristic_length;
use stiffarm::plan::index::{Index, IndexFunction};
use stiffarm_files::builtin;

const POSTURES: f64 = 6.0;
/// Postures are worked on four at a time, so six cost as much as eight.
const LANES_USED: f64 = 8.0;

/// Additions and multiplications of one posture with six joints, counted from
/// the formulas of the kernel; a 3-vector product is 5, a cross product 9.
struct Stage {
    what: &'static str,
    operations: f64,
}

fn stages() -> Vec<Stage> {
    let n = 6.0;
    let triangle = n * (n + 1.0) / 2.0;
    // One set of columns' derivative: two prefix sums over the joints.
    let columns = n * (5.0 + 1.0 + 9.0 + 3.0) * 2.0;
    let axes = n * (5.0 + 1.0 + 9.0 + 3.0);
    vec![
        Stage { what: "sines and cosines", operations: n * 48.0 },
        Stage {
            // Shift 18, placement about one axis 30, turn 18, angle 2.
            what: "joint frames",
            operations: n * (18.0 + 30.0 + 18.0 + 2.0),
        },
        Stage {
            // Three points, the rope, its columns and torques.
            what: "points, load and torques",
            operations: 3.0 * 18.0 + 16.0 + n * (3.0 + 9.0 + 5.0),
        },
        Stage {
            // Moments' root 45, columns 30, blocks 7, lower triangle of BᵀB.
            what: "information",
            operations: 45.0 + n * (12.0 + 3.0 + 15.0 + 7.0) + triangle * 11.0,
        },
        Stage {
            // Columns and norm, Gram–Schmidt 6 × 6, inverse of R with its norm.
            what: "k(J_N)",
            operations: n * (15.0 + 12.0) + 432.0 + 56.0 * 2.0 + 42.0,
        },
        Stage {
            // TᵀT, T(TᵀT), times Qᵀ.
            what: "k(J_N), derivative",
            operations: 112.0 + 252.0 + 36.0 + n * 6.0 * 13.0 + columns,
        },
        Stage {
            // B A, its shares, columns, turning axes.
            what: "information, derivative",
            operations: n * (n * 12.0 + 6.0 + 11.0 + 7.0) + n * 18.0 + columns + axes,
        },
        Stage { what: "torques and load, derivative", operations: n * (6.0 + 9.0 + 6.0) * 2.0 + 32.0 + n * 6.0 + axes },
    ]
}

/// Of the group, not of a posture: tridiagonal form with its transformation,
/// about 25 rotations of the QL iteration, and the derivative from the vectors.
fn eigen_operations() -> f64 {
    let n: f64 = 6.0;
    8.0 / 3.0 * n.powi(3) + 25.0 * (15.0 + 6.0 * n) + 2.0 * n.powi(3)
}

const CHAINS: usize = 8;

#[inline(always)]
fn multiply_and_add(x: &mut [[f64; 4]; CHAINS], rounds: usize) {
    for _ in 0..rounds {
        for chain in x.iter_mut() {
            for lane in chain.iter_mut() {
                *lane = *lane * 0.999_999 + 1e-7;
            }
        }
    }
}

/// The same instructions the kernel may use, and no others.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn multiply_and_add_avx2(x: &mut [[f64; 4]; CHAINS], rounds: usize) {
    multiply_and_add(x, rounds);
}

fn best_of(mut run: impl FnMut()) -> f64 {
    (0..200)
        .map(|_| {
            let begin = Instant::now();
            run();
            begin.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

/// Multiplications and additions per second in independent chains, four lanes
/// wide: the most that arithmetic without dependencies reaches.
fn arithmetic_rate() -> f64 {
    const ROUNDS: usize = 20_000;
    let mut x = [[1.0; 4]; CHAINS];
    let seconds = best_of(|| {
        let x = black_box(&mut x);
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has what the function asks for.
            #[allow(unsafe_code)]
            return unsafe { multiply_and_add_avx2(x, ROUNDS) };
        }
        multiply_and_add(x, ROUNDS);
    });
    (2 * 4 * CHAINS * ROUNDS) as f64 / seconds
}

/// The same for one number at a time, where each step waits for the one before.
fn dependent_rate() -> f64 {
    const ROUNDS: usize = 100_000;
    let mut x = 1.0_f64;
    let seconds = best_of(|| {
        for _ in 0..ROUNDS {
            x = black_box(x * 0.999_999 + 1e-7);
        }
    });
    (2 * ROUNDS) as f64 / seconds
}

fn measure(index: Index, gradient: bool) -> f64 {
    const TIMES: usize = 1000;
    let cell = builtin::cell("comau-reference").and_then(with_characteristic_length).expect("the built-in cell");
    let mut function = IndexFunction::new(&cell, index, 6).expect("an index");
    let q: Vec<f64> = (0..36)
        .map(|i| {
            let [low, high] = cell.bounds[i % 6];
            low + (high - low) * (i as f64 * 0.618_034).fract()
        })
        .collect();
    let mut slope = vec![0.0; q.len()];
    let seconds = best_of(|| {
        for _ in 0..TIMES {
            if gradient {
                black_box(function.smoothed(black_box(&q), 100.0, &mut slope));
            } else {
                black_box(function.value(black_box(&q)));
            }
        }
    });
    seconds / TIMES as f64 * 1e6
}

fn main() {
    let (wide, dependent) = (arithmetic_rate(), dependent_rate());
    let per_posture: f64 = stages().iter().map(|s| s.operations).sum();
    println!("operations of one posture");
    for stage in stages() {
        println!("  {:<30} {:>6.0}", stage.what, stage.operations);
    }
    println!("  {:<30} {per_posture:>6.0}", "together");
    println!("operations of the group (eigenvalues) {:.0}", eigen_operations());
    println!("arithmetic rate, four lanes, independent: {:.2} Gop/s", wide / 1e9);
    println!("arithmetic rate, one number, dependent:   {:.2} Gop/s", dependent / 1e9);
    let lanes = LANES_USED * per_posture / wide * 1e6;
    let ideal = POSTURES * per_posture / wide * 1e6;
    let eigen = eigen_operations() / (wide / 4.0) * 1e6;
    let floor = ideal + eigen;
    println!("floor: {floor:.2} µs = {ideal:.2} postures + {eigen:.2} eigenvalues, at one lane's rate");
    println!("  with eight lanes for six postures: {:.2} µs", lanes + eigen);
    let rows = [
        ("novel", Index::Novel),
        ("condition", Index::Condition),
        ("expected error", Index::ExpectedError),
        ("classical", Index::Classical),
    ];
    println!("measured                 value   with gradient");
    let mut novel = 0.0;
    for (name, index) in rows {
        let (value, gradient) = (measure(index, false), measure(index, true));
        if index == Index::Novel {
            novel = gradient;
        }
        println!("  {name:<20} {value:>6.2} µs {gradient:>8.2} µs");
    }
    println!("novel with gradient: {:.2} times the floor", novel / floor);
}
