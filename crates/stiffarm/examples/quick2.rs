use std::time::Instant;
use stiffarm::{builtin, index::{Index, IndexFunction}, optimise::with_characteristic_length, optimise::smooth::*};
use stiffarm::select::*;
fn main() {
    let cell = with_characteristic_length(builtin::cell("comau-reference").unwrap()).unwrap();
    let n = 6; let count = 6;
    let lower: Vec<f64> = cell.bounds.iter().map(|b| b[0]).cycle().take(n*count).collect();
    let upper: Vec<f64> = cell.bounds.iter().map(|b| b[1]).cycle().take(n*count).collect();
    for index in [Index::ExpectedError, Index::Novel] {
      for (opt, red) in [(1e-5,1e-9),(1e-3,1e-6),(1e-2,1e-4)] {
        let stages: &[f64] = if index == Index::Novel { &[10.0, 100.0, 1000.0] } else { &[1.0] };
        let mut f = IndexFunction::new(&cell, index, count).unwrap();
        let mut values = vec![]; let mut evals = 0; let mut inner = 0.0;
        let t = Instant::now();
        for s in 0..200 {
            let q: Vec<f64> = random_group(&cell, StartKind::Uniform, count, 7, s).unwrap().concat();
            let mut x = q; 
            for p in stages {
                let sol = minimise_smooth(|x: &[f64], g: &mut [f64]| { f.smoothed(x, *p, g).objective }, &lower, &upper, &x, SmoothOptions { max_iterations: 300, optimality: opt, reduction: red });
                evals += sol.evaluations; x = sol.x;
            }
            values.push(f.value(&x).exp());
        }
        let total = t.elapsed().as_secs_f64();
        let mut g = vec![0.0; 36];
        let x: Vec<f64> = random_group(&cell, StartKind::Uniform, count, 7, 3).unwrap().concat();
        let t = Instant::now(); for _ in 0..10000 { f.smoothed(&x, 300.0, &mut g); } inner = t.elapsed().as_secs_f64()/1e4*1e6;
        values.sort_by(f64::total_cmp);
        println!("{index:?} opt {opt}: {:.2} ms per start, {} evals per start, {:.2} us per eval (function {:.2}); min {:.6} q10 {:.5} med {:.5}", total/200.0*1e3, evals/200, total/evals as f64*1e6, inner, values[0], values[20], values[100]);
      }
    }
}
