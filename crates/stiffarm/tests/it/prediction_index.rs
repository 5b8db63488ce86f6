//! The index `prediction` against a second, plain implementation over dual numbers that
//! solves the mixed-model equations by orthogonalisation instead of kriging, and against
//! all groups of a list.

use crate::common::model::{Model, duals, inverse_r};
use crate::common::prelude::*;
use num_dual::{Dual64, DualNum};
use stiffarm::ask::select::{SelectInputs, SelectOptions, plan};
use stiffarm::internals::elastic_effects;
use stiffarm::model::cell::Task;
use stiffarm::model::elastic::{ElasticSizes, ElasticSizing, ElasticSource, KnownElement, beams};
use stiffarm::model::load::LoadCase;
use stiffarm::model::observation::{ExtraTerm, Setup};
use stiffarm::plan::certificate::{CertificateOptions, certify};
use stiffarm::plan::select::{GlobalOptions, select};

const POSTURES: usize = 4;

/// Rows of the readings \[Ψ/k, B\] over their noise, with one row per random effect.
fn equations(model: &Model, postures: &[Vec<Dual64>], sizes: [f64; 3]) -> DMatrix<Dual64> {
    let n = model.joint_count();
    let white = model.posture_covariance().cholesky().unwrap().l();
    let white = white.try_inverse().unwrap();
    let blocks: Vec<DMatrix<Dual64>> = postures
        .iter()
        .map(|q| {
            let (psi, springs) = (model.psi(q), model.spring_columns(q, sizes));
            DMatrix::from_fn(psi.nrows(), n + springs.ncols(), |i, j| {
                (0..=i).fold(Dual64::from(0.0), |sum, l| {
                    let entry = if j < n { psi[(l, j)] / model.prior[j] } else { springs[(l, j - n)] };
                    sum + entry * white[(i, l)]
                })
            })
        })
        .collect();
    let (height, unknowns) = blocks[0].shape();
    let readings = height * blocks.len();
    DMatrix::from_fn(readings + unknowns - n, unknowns, |i, j| {
        if i < readings {
            blocks[i / height][(i % height, j)]
        } else {
            Dual64::from(if i - readings + n == j { 1.0 } else { 0.0 })
        }
    })
}

/// Work that no cell states: forces as large as the largest of its loads along each axis, at the tip, at random postures.
fn anywhere(cell: &Cell) -> Vec<Task> {
    let tip = cell.setup.tool.tcp();
    let postures = random_group(cell, StartKind::Uniform, 20, 1, 0x5747).unwrap();
    let each = postures.into_iter().flat_map(|q| {
        let force = |setup: &Setup| {
            let terms = PostureTerms::new(setup, &q, None).unwrap();
            terms.wrench().force.norm()
        };
        let size = cell.setup.cases().iter().map(force).fold(0.0, f64::max);
        (0..3).map(move |axis| Task {
            name: String::new(),
            q: q.clone(),
            wrench: Wrench::force(Vector3::ith(axis, size)),
            axes: Axes::Base,
            tip,
        })
    });
    each.collect()
}

/// The shifts of the tip at tasks and anywhere, half and half, by the same unknowns.
fn targets(model: &Model, cell: &Cell, sizes: [f64; 3]) -> DMatrix<f64> {
    let n = model.joint_count();
    let mut rows = Vec::new();
    for work in [model.tasks.clone(), anywhere(cell)] {
        let share = (2.0 * work.len() as f64).sqrt();
        for task in &work {
            let work = model.at_work(task);
            let (psi, springs) = (work.psi(&task.q), work.spring_columns(&task.q, sizes));
            for i in 0..3 {
                let fixed = (0..n).map(|j| psi[(i, j)] / model.prior[j]);
                let random = springs.row(i).iter().copied().collect::<Vec<f64>>();
                rows.push(fixed.chain(random).map(|v| v / share).collect::<Vec<f64>>());
            }
        }
    }
    DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
}

/// ln of the index: ½ ln tr(T (XᵀX)⁻¹ Tᵀ).
fn ln_index(model: &Model, rows: &DMatrix<f64>, postures: &[Vec<Dual64>], sizes: [f64; 3]) -> Dual64 {
    let inverse = inverse_r(&equations(model, postures, sizes));
    let mut trace = Dual64::from(0.0);
    for i in 0..rows.nrows() {
        for j in 0..inverse.ncols() {
            let entry = (0..=j).fold(Dual64::from(0.0), |s, k| s + inverse[(k, j)] * rows[(i, k)]);
            trace += entry * entry;
        }
    }
    trace.ln() * 0.5
}

/// A random cell and group that determine every joint.
fn determined(dice: &mut Dice, n: usize, case: usize) -> (Model, Vec<Vec<f64>>) {
    loop {
        // The last: a cylinder that pushes.
        let kind = if case < 6 { case % 4 } else { 4 };
        let model = dice.model(n, kind, case % 2 == 1, case % 3 == 1);
        let postures = dice.postures(n, POSTURES);
        let indices = evaluate(&model.cell(), "", &postures).unwrap().indices;
        if indices.scaled_condition.is_some_and(|c| c < 1e3) {
            return (model, postures);
        }
    }
}

#[test]
fn values_and_gradients_are_those_of_the_mixed_model_equations() {
    let mut dice = Dice::new(77);
    let (mut worst, mut worst_value) = (0.0_f64, 0.0_f64);
    for (case, n) in [6, 6, 6, 6, 5, 7, 6].into_iter().enumerate() {
        let (model, postures) = determined(&mut dice, n, case);
        let mut cell = model.cell();
        let typical = ElasticSizes::typical(&cell.setup, &model.prior).unwrap();
        cell.elastic = Some(match case % 2 {
            0 => typical,
            // One class gives nothing.
            _ => ElasticSizes { shift: 3.0 * typical.shift, turn: 0.5 * typical.turn, coupling: 0.0 },
        });
        let (elastic, source) = cell.elastic_sizes().unwrap();
        let indices = evaluate(&cell, "", &postures).unwrap().indices;
        assert_eq!(indices.prediction_sizes, Some(source));
        let shown = indices.prediction.unwrap();
        let sizes = [elastic.shift, elastic.turn, elastic.coupling];
        let rows = targets(&model, &cell, sizes);
        let flat = postures.concat();
        let mut function = IndexFunction::new(&cell, Index::Prediction, POSTURES).unwrap();
        let mut gradient = vec![0.0; flat.len()];
        let ours = function.smoothed(&flat, 1.0, &mut gradient);
        let by_dual: Vec<Dual64> =
            (0..flat.len()).map(|k| ln_index(&model, &rows, &duals(&flat, n, k), sizes)).collect();
        for value in [ours.exact, ours.objective, shown.ln(), function.value(&flat)] {
            let error = (value - by_dual[0].re).abs();
            assert!(error < 1e-10, "case {case}: {value} against {}", by_dual[0].re);
            worst_value = worst_value.max(error);
        }
        let scale = by_dual.iter().fold(1e-3_f64, |m, g| m.max(g.eps.abs()));
        for (k, (ours, golden)) in gradient.iter().zip(&by_dual).enumerate() {
            let error = (ours - golden.eps).abs() / scale;
            assert!(error < 1e-10, "case {case} angle {k}: {ours} against {}, scale {scale}", golden.eps);
            worst = worst.max(error);
        }
    }
    println!("worst gradient {worst:.1e}, worst value {worst_value:.1e}");
}

/// Every group of `count` of `of` positions.
fn groups(of: usize, count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    let mut out = Vec::new();
    for last in count - 1..of {
        for mut rest in groups(last, count - 1) {
            rest.push(last);
            out.push(rest);
        }
    }
    out
}

/// A list of candidates in the default cell, some under forces of their own.
fn list(cell: &Cell, count: usize, seed: u64, measured: bool) -> Vec<Candidate> {
    let mut dice = Dice::new(seed);
    random_group(cell, StartKind::Uniform, count, seed, 0)
        .unwrap()
        .into_iter()
        .enumerate()
        .map(|(i, q)| Candidate {
            wrench: (measured && i % 3 > 0).then(|| Wrench::force(dice.vector(300.0))),
            ..Candidate::new(i.to_string(), q)
        })
        .collect()
}

/// The index of a group by the library's own evaluation, under the cell's load.
fn value(cell: &Cell, index: Index, list: &[Candidate], group: &[usize]) -> Option<f64> {
    let postures: Vec<&Vec<f64>> = group.iter().map(|p| &list[*p].q).collect();
    evaluate(cell, "", &postures).unwrap().indices.get(index)
}

#[test]
fn the_best_group_of_a_list_is_the_best_of_all_groups() {
    let mut cell = builtin::cell("comau").unwrap();
    let task = |q: &[f64], force: [f64; 3]| Task {
        name: "task".into(),
        q: q.to_vec(),
        wrench: Wrench::force(force),
        axes: Axes::Base,
        tip: cell.setup.tool.tcp(),
    };
    let work = random_group(&cell, StartKind::Uniform, 3, 9, 1).unwrap();
    cell.tasks = vec![
        task(&work[0], [100.0, 0.0, -300.0]),
        task(&work[1], [0.0, 200.0, 50.0]),
        task(&work[2], [-150.0, 80.0, 0.0]),
    ];
    let list = list(&cell, 11, 4, false);
    let all = groups(list.len(), 3);
    assert_eq!(all.len(), 165);
    for index in Index::ALL {
        let sign = if index.larger_is_better() { -1.0 } else { 1.0 };
        let best = all
            .iter()
            .filter_map(|group| Some((sign * value(&cell, index, &list, group)?, group)))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .unwrap();
        let options = CandidateOptions::default();
        let selection = select_candidates(&cell, index, 3, &list, &options, Control::default()).unwrap();
        let error = (sign * selection.value / best.0 - 1.0).abs();
        assert!(error < 1e-8, "{index:?}: {} against {}", selection.value, sign * best.0);
        assert_eq!(&selection.chosen, best.1, "{index:?}");
        assert!(selection.exact && selection.efficiency == Some(1.0), "{index:?}");

        // The bound alone must hold for every group.
        let mut options = CandidateOptions::default();
        options.groups = Some(0);
        let bounded = select_candidates(&cell, index, 3, &list, &options, Control::default()).unwrap();
        let convex = [Index::ExpectedError, Index::D, Index::Task, Index::Prediction, Index::O1];
        assert_eq!(bounded.bound.is_some(), convex.contains(&index), "{index:?}");
        if let Some(bound) = bounded.bound {
            assert!(sign * bound <= best.0 * (1.0 + sign * 1e-9), "{index:?}");
            let efficiency = bounded.efficiency.unwrap();
            println!("{}: {efficiency:.3} certified without comparing", index.as_str());
            assert!(efficiency > 0.2 && efficiency <= 1.0 + 1e-9, "{index:?}");
        }
    }
}

#[test]
fn wrenches_of_their_own_count() {
    let mut cell = builtin::cell("comau").unwrap();
    let list = list(&cell, 9, 12, true);
    // A load that only measurements give: nothing but the candidates' wrenches is known.
    let measured: Vec<Candidate> = list.iter().filter(|c| c.wrench.is_some()).cloned().collect();
    cell.setup.load = Load::Measured;
    for index in [Index::ExpectedError, Index::Prediction] {
        let options = CandidateOptions::default();
        let select = |list: &[Candidate]| select_candidates(&cell, index, 3, list, &options, Control::default());
        let selection = select(&measured).unwrap();
        assert!(selection.exact);
        // Twice the force at all postures: the errors of k halve, the choice stays.
        let mut doubled = measured.clone();
        for candidate in &mut doubled {
            let wrench = candidate.wrench.as_mut().unwrap();
            wrench.force *= 2.0;
        }
        if index == Index::ExpectedError {
            let twice = select(&doubled).unwrap();
            assert_eq!(twice.chosen, selection.chosen);
            assert!((twice.value * 2.0 / selection.value - 1.0).abs() < 1e-9);
        }
        let error = select(&list).unwrap_err();
        assert_eq!(error.code(), Code::MissingKey);
    }
    let none =
        select_candidates(&cell, Index::ExpectedError, 10, &measured, &CandidateOptions::default(), Control::default());
    assert_eq!(none.unwrap_err().code(), Code::TooFewData);
}

/// Very many postures: the covariance of all their readings would be a hundred gigabytes.
#[test]
fn very_many_postures_take_no_more_room_than_their_unknowns() {
    let cell = stiffarm_files::builtin::cell("comau").unwrap();
    let all = random_group(&cell, StartKind::Uniform, 20_000, 3, 1).unwrap();
    let of = |count: usize| evaluate(&cell, "many", &all[..count]).unwrap().indices;
    let value = |count: usize| of(count).prediction.unwrap();
    // 170 are the last of which all rows are kept.
    let (below, above) = (value(170), value(171));
    assert!(above <= below && above > 0.98 * below, "{above} {below}");
    let many = of(20_000);
    // What the load never bends stays unknown, however many postures there are.
    let least = many.prediction.unwrap();
    let root = (20_000f64 / 170.0).sqrt();
    assert!(least < below && least > 1.2 * below / root, "{least} {below}");
    // What is expected of the joints falls with the root of the number.
    let few = of(1_000);
    let ratio = few.expected_error.unwrap() / many.expected_error.unwrap();
    assert!((ratio / 20.0_f64.sqrt() - 1.0).abs() < 0.1, "{ratio}");
    let (a, b) = (many.drop_one.unwrap(), many.expected_error.unwrap());
    assert!(a >= b && a < 1.001 * b, "{a} {b}");
}

/// What is expected of an arm without declared sizes, several loads at each posture, and the sizes a third and three times
/// as large, against least squares on the columns of the elements that `identify` fits.
#[test]
fn expected_arms_are_made_of_what_identify_fits() {
    const SIZES: [f64; 5] = [0.0005, 0.005, 0.002, 0.06, 0.5];
    let mut cell = default_cell();
    let rope = cell.setup.load.clone();
    // Bearing, link and base of a drawing, the base much stiffer than expected; the last time all entries are declared.
    let beam = beams(&cell.setup.robot)[0];
    let drawing = [
        KnownElement::new(ExtraTerm::JointTilt(1), 8e6, 1.5),
        KnownElement::new(beam, 3e6, 1.2),
        KnownElement::new(ExtraTerm::BaseTilt, 1e9, 1.5),
    ];
    let declared = ElasticSizes { shift: 3e-8, turn: 5e-8, coupling: 2e-8 };
    let cases = [(false, false, None), (true, false, None), (false, true, None), (true, true, Some(declared))];
    let mut promised = Vec::new();
    for (several, drawn, sizes) in cases {
        cell.setup.load = rope.clone();
        cell.elastic = sizes;
        cell.known_elements = if drawn { drawing.to_vec() } else { Vec::new() };
        if several {
            let case = |name: &str, load: Load, loading_point| LoadCase { name: name.into(), load, loading_point };
            let weight = Load::Weight { magnitude: 300.0, direction: -Vector3::z() };
            let eye = Some(Vector3::new(0.1, 0.05, 0.2));
            let cases = vec![case("rope", rope.clone(), None), case("weight", weight, eye)];
            cell.setup.load = Load::Cases(cases);
        }
        let robot = &cell.setup.robot;
        let prior = cell.prior.clone().unwrap();
        let give: Vec<f64> = prior.iter().map(|k| 1.0 / k).collect();
        let c = give.iter().map(|h| h.ln()).sum::<f64>() / 6.0;
        let (c, length) = (c.exp(), robot.length() + cell.setup.tool.tcp().norm());
        let units = [c * length * length, c, c * length, c, c / length];
        // Term, standard deviation, class where its size is expected and not known, whether it scatters about a mean.
        let mut effects: Vec<(ExtraTerm, f64, Option<usize>, bool)> = Vec::new();
        for (term, class, scale) in elastic_effects(robot, &give, ElasticSizing::ByJoint) {
            let positive = match term {
                ExtraTerm::Spring { row, column, .. } => row == column,
                _ => true,
            };
            let class = class as usize;
            match sizes {
                _ if cell.known_elements.iter().any(|element| element.term == term) => {}
                None => effects.push((term, scale * SIZES[class] * units[class], Some(class), positive)),
                Some(sizes) => {
                    // Alike in all joints, none of the elements: its class is that of the entry.
                    let size = [sizes.shift, sizes.turn, sizes.coupling];
                    let scale = if positive { 1.0 } else { 0.5f64.sqrt() };
                    let entry = size.get(class).map(|size| (term, scale * size, Some(class), false));
                    effects.extend(entry);
                }
            }
        }
        let stated = cell.known_elements.iter().map(|element| (element.term, element.std, None, false));
        effects.extend(stated);
        let columns = |setup: &Setup, terms: &PostureTerms, factor: f64| {
            let all: Vec<ExtraTerm> = effects.iter().map(|(term, ..)| *term).collect();
            let mut rows = terms.block_with(&setup.robot, &all);
            let mut means = DMatrix::zeros(rows.nrows(), 5);
            for (j, h) in give.iter().enumerate() {
                rows.column_mut(j).scale_mut(*h);
            }
            for (e, (_, size, class, positive)) in effects.iter().enumerate() {
                let mut column = rows.column_mut(6 + e);
                column *= size * class.map_or(1.0, |_| factor);
                if let (Some(class), true) = (class, positive) {
                    let mut mean = means.column_mut(*class);
                    mean += column;
                }
            }
            let width = rows.ncols();
            let mut rows = rows.resize_horizontally(width + 5, 0.0);
            rows.columns_mut(width, 5).copy_from(&means);
            rows
        };
        let group = random_group(&cell, StartKind::Uniform, 5, 3, 0).unwrap();
        let std = cell.noise.displacement_std();
        let value = |factor: f64| {
            let mut rows: Vec<DMatrix<f64>> = Vec::new();
            for q in &group {
                for setup in cell.setup.cases() {
                    let terms = PostureTerms::new(&setup, q, None).unwrap();
                    rows.push(columns(&setup, &terms, factor) / std);
                }
            }
            let unknowns = rows[0].ncols();
            let mut prior_rows = DMatrix::zeros(unknowns - 6, unknowns);
            prior_rows.columns_mut(6, unknowns - 6).fill_with_identity();
            rows.push(prior_rows);
            let height = rows.iter().map(|r| r.nrows()).sum();
            let mut all = DMatrix::zeros(height, unknowns);
            let mut from = 0;
            for r in &rows {
                all.rows_mut(from, r.nrows()).copy_from(r);
                from += r.nrows();
            }
            let inverse = all.qr().r().try_inverse().unwrap();
            let mut square = 0.0;
            for kind in [cell.tasks.clone(), anywhere(&cell)] {
                for task in &kind {
                    let setup = task.setup(robot);
                    let terms = PostureTerms::new(&setup, &task.q, None).unwrap();
                    let scaled = columns(&setup, &terms, factor) * &inverse;
                    square += scaled.norm_squared() / (2.0 * kind.len() as f64);
                }
            }
            square.sqrt()
        };
        assert_eq!(cell.noise.common_weight(cell.setup.tool.point_count()), 0.0);
        let indices = evaluate(&cell, "", &group).unwrap().indices;
        let near = |ours: f64, golden: f64| {
            let error = (ours / golden - 1.0).abs();
            assert!(error < 1e-8, "several loads {several}, drawing {drawn}: {ours} {golden}");
        };
        near(indices.prediction.unwrap(), value(1.0));
        near(indices.prediction_range.unwrap()[0], value(1.0 / 3.0));
        near(indices.prediction_range.unwrap()[1], value(3.0));
        let source = match sizes {
            None => ElasticSource::Typical,
            Some(_) => ElasticSource::Declared,
        };
        assert_eq!(indices.prediction_sizes, Some(source));
        promised.push(indices.prediction.unwrap());

        // The searches' own form, and its gradient.
        let mut function = IndexFunction::new(&cell, Index::Prediction, 5).unwrap();
        let flat = group.concat();
        let (log, gradient) = function.log_and_gradient(&flat);
        near(log.exp(), value(1.0));
        for k in [0, 8, 15, 22, 29] {
            let step = 1e-5;
            let at = |sign: f64| {
                let mut x = flat.clone();
                x[k] += sign * step;
                x
            };
            let slope = (function.value(&at(1.0)) - function.value(&at(-1.0))) / (2.0 * step);
            assert!((slope - gradient[k]).abs() < 1e-6 * (1.0 + slope.abs()), "{slope} {}", gradient[k]);
        }
    }
    // What is known need not be measured.
    assert!(promised[2] < 0.999 * promised[0], "{promised:?}");
}

/// Short searches: no posture is as good as another, one more round gains little, and the bound holds.
#[test]
fn plans_hold_no_posture_twice_and_keep_their_bound() {
    let cell = default_cell();
    let mut options = GlobalOptions::default();
    options.rounds = Some(1);
    for count in [3, 12] {
        let selection = select(&cell, Index::Prediction, count, &options, Control::default()).unwrap();
        for (p, a) in selection.group.iter().enumerate() {
            let apart = |b: &Vec<f64>| {
                let furthest = a.iter().zip(b).map(|(a, b)| (a - b).abs());
                furthest.fold(0.0, f64::max) >= 15f64.to_radians()
            };
            assert!(selection.group[..p].iter().all(apart), "posture {p} of {count}");
        }
        let random = random_group(&cell, StartKind::Uniform, count, 7, 0).unwrap();
        let random = evaluate(&cell, "", &random).unwrap().indices.prediction.unwrap();
        assert!(selection.value < 0.7 * random, "{} {random}", selection.value);
        let certificate =
            certify(&cell, Index::Prediction, &selection.group, &CertificateOptions::default(), Control::default())
                .unwrap();
        let efficiency = certificate.efficiency.unwrap();
        println!("{count}: {} of {}, {efficiency:.3}", certificate.bound, selection.value);
        assert!(efficiency < 1.0 && (count < 12 || efficiency > 0.55), "{efficiency}");
    }
}

/// A wrist the other way round has the same axes and the same Ψ, but what gives way beyond the axes bends otherwise.
#[test]
fn a_plan_is_driven_as_it_was_found() {
    let mut cell = default_cell();
    cell.tasks.clear();
    let options = with(|o: &mut SelectOptions| {
        (o.rounds, o.count) = (Some(1), Some(5));
        (o.no_certificate, o.angle_step_deg) = (true, 0.0);
    });
    let inputs = SelectInputs::default();
    let planned = plan(&cell, &inputs, &options, &mut |_| {}, Control::default()).unwrap();
    let selection = &planned.result.selection;
    let searched = selection.improvements.last().unwrap().value.unwrap();
    assert!(selection.value <= searched * (1.0 + 1e-9), "{} {searched}", selection.value);
    let flipped = |q: &[f64]| {
        let mut q = q.to_vec();
        let turned = |angle: f64| if angle > 0.0 { angle - PI } else { angle + PI };
        (q[3], q[4], q[5]) = (turned(q[3]), -q[4], turned(q[5]));
        q
    };
    let group: Vec<Vec<f64>> = planned.postures.iter().map(|p| p.q.clone()).collect();
    let value = |group: &[Vec<f64>], index| evaluate(&cell, "group", group).unwrap().indices.get(index).unwrap();
    let other: Vec<Vec<f64>> = group.iter().map(|q| flipped(q)).collect();
    let same = value(&other, Index::ExpectedError) / value(&group, Index::ExpectedError);
    assert!((same - 1.0).abs() < 1e-9, "{same}");
    let other = value(&other, Index::Prediction) / value(&group, Index::Prediction);
    assert!((other - 1.0).abs() > 1e-3, "{other}");
}
