//! The inner loops of selection and identification.
//!
//! `cargo bench -p stiffarm --bench kernels`

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Translation3;
use std::hint::black_box;
use stiffarm::Control;
use stiffarm::internals::Minimax;
use stiffarm::internals::information::Factor;
use stiffarm::internals::optimise::Options;
use stiffarm::model::cell::Cell;
use stiffarm::model::inverse::InverseKinematics;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::observation::{Rows, observation_matrix};
use stiffarm::plan::characteristic_length::with_characteristic_length;
use stiffarm::plan::index::{Index, IndexFunction, evaluate};
use stiffarm::plan::select::{GlobalOptions, StartKind, random_group, select, select_from};
use stiffarm_files::builtin;

fn cell(name: &str) -> Cell {
    with_characteristic_length(builtin::cell(name).expect("a built-in cell")).expect("a length")
}

fn group(cell: &Cell, count: usize) -> Vec<Vec<f64>> {
    random_group(cell, StartKind::Uniform, count, 1, 0).expect("postures inside the limits")
}

/// Value, and value with gradient, of a group's index.
fn indices(c: &mut Criterion) {
    let cell = cell("comau-reference");
    for index in [Index::Novel, Index::ExpectedError, Index::DropOne] {
        let mut benches = c.benchmark_group(format!("index/{}", index.as_str()));
        for count in [6, 10, 20, 50] {
            let q = group(&cell, count).concat();
            let mut function = IndexFunction::new(&cell, index, count).expect("an index");
            let mut gradient = vec![0.0; q.len()];
            benches.throughput(Throughput::Elements(count as u64));
            benches.bench_function(BenchmarkId::new("value", count), |b| {
                b.iter(|| function.value(black_box(&q)));
            });
            benches.bench_function(BenchmarkId::new("gradient", count), |b| {
                b.iter(|| function.smoothed(black_box(&q), 100.0, &mut gradient));
            });
        }
        let q = group(&cell, 6).concat();
        let mut function = IndexFunction::new(&cell, index, 6).expect("an index");
        let mut parts = Minimax::default();
        benches.bench_function("every component's gradient/6", |b| {
            b.iter(|| function.evaluate_into(black_box(&q), &mut parts));
        });
    }
}

/// What every shown number goes through.
fn shown(c: &mut Criterion) {
    let cell = cell("comau");
    let group = group(&cell, 6);
    c.bench_function("evaluate/6 postures", |b| {
        b.iter(|| evaluate(&cell, "", black_box(&group)));
    });
    let psi = observation_matrix(&cell.setup, &group, Rows::Translations).expect("a matrix");
    c.bench_function("factor/72 x 6", |b| b.iter(|| Factor::new(black_box(&psi))));
}

/// Postures of a pose: all, the nearest, one branch a millimetre further.
fn inverse(c: &mut Criterion) {
    let robot = cell("comau").setup.robot;
    let inverse = InverseKinematics::new(&robot);
    let q = [0.3, 0.2, -1.9, 0.7, 0.8, -0.4];
    let pose = *Frames::new(&robot, &q).flange();
    let next = Translation3::new(1e-3, 0.0, 0.0) * pose;
    c.bench_function("inverse/branches", |b| {
        b.iter(|| inverse.branches(black_box(&pose)));
    });
    c.bench_function("inverse/nearest", |b| {
        b.iter(|| inverse.nearest(black_box(&next), &q));
    });
    c.bench_function("inverse/follow", |b| {
        b.iter(|| inverse.follow(black_box(&next), &q));
    });
}

/// Whole selections.
fn selections(c: &mut Criterion) {
    let mut benches = c.benchmark_group("select");
    benches.sample_size(10);
    let control = Control::default();
    for name in ["comau-reference", "comau"] {
        let cell = cell(name);
        let start = group(&cell, 6);
        for index in [Index::Novel, Index::ExpectedError] {
            benches.bench_function(format!("local/{name}/{}", index.as_str()), |b| {
                b.iter(|| select_from(&cell, index, &start, Options::default(), control));
            });
            let mut options = GlobalOptions::default();
            options.rounds = Some(1);
            benches.bench_function(format!("one global round/{name}/{}", index.as_str()), |b| {
                b.iter(|| select(&cell, index, 6, &options, control));
            });
        }
    }
}

criterion_group!(benches, indices, shown, inverse, selections);
criterion_main!(benches);
