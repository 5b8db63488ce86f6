//! Arms of a structural code, as seven compliances at the base and the frames of the robot's rows: what the mixed model
//! knows of them from twelve postures under one rope. `bench/structural_arms.py` counts it on all of them.

use crate::common::prelude::*;
use crate::set_up::days::{structural_at, structure};
use stiffarm::Control;
use stiffarm::ask::identify::{Identified, IdentifiedOptions};
use stiffarm::ask::predict::{PredictOptions, PredictionInputs};
use stiffarm::estimate::mixed::MixedFit;
use stiffarm::estimate::saved::Saved;
use stiffarm::estimate::systematic::{SystematicSource, mixed_systematic_errors};
use stiffarm::estimate::validate::cross_validate_mixed;
use stiffarm::internals::{MixedModel, measured_system};
use stiffarm::model::elastic::{ElasticSizing, KnownElement, beams, elastic_effects};
use stiffarm::model::load::LoadCase;
use stiffarm::model::observation::{ElasticClass, RowPart};
use stiffarm::plan::select::random_group;

const ARMS: [&str; 3] = ["realistic", "links_half", "arm_0"];

/// An arm with the joints of the default cell's prior.
struct Arm {
    springs: Vec<Matrix6<f64>>,
    axes: DVector<f64>,
}

fn arms(cell: &Cell) -> impl Iterator<Item = (&'static str, Arm)> {
    let axes = compliance_of(cell.require_prior().unwrap());
    ARMS.into_iter().map(move |name| {
        let (springs, axes) = (structure(name), axes.clone());
        (name, Arm { springs, axes })
    })
}

impl Arm {
    /// Displacement of the measuring points at a posture under a load, base axes.
    fn bent(&self, cell: &Cell, terms: &PostureTerms) -> Vec<Vector3<f64>> {
        let joints = terms.block(&cell.setup.robot) * &self.axes;
        let beyond = structural_at(terms, &self.springs, 1.0).into_iter();
        beyond.enumerate().map(|(a, beyond)| beyond + joints.fixed_rows::<3>(3 * a)).collect()
    }

    /// Displacements under the loads of the cell at random postures, with its noise.
    fn measured(&self, cell: &Cell, postures: usize, seed: u64) -> Vec<MeasuredPosture> {
        let group = random_group(cell, StartKind::Uniform, postures, seed, 0).unwrap();
        let mut dice = Dice::new(seed);
        let mut normal = || (0..12).map(|_| dice.between(0.0, 1.0)).sum::<f64>() - 6.0;
        let std = cell.noise.displacement_std();
        let mut out = Vec::new();
        for posture in numbered(group) {
            for (i, setup) in cell.setup.cases().iter().enumerate() {
                let terms = PostureTerms::new(setup, &posture.q, None).unwrap();
                let displacements = self.bent(cell, &terms).into_iter().enumerate().map(|(a, value)| {
                    let noise = Vector3::new(normal(), normal(), normal()) * std;
                    Displacement::new(a, value + noise)
                });
                let mut measured = MeasuredPosture::new(posture.clone(), displacements.collect());
                if let Some(case) = cell.setup.load.cases().get(i) {
                    measured.state.clone_from(&case.name);
                }
                out.push(measured);
            }
        }
        out
    }
}

/// Twelve postures under one rope: the default model predicts other loads several times better than the axes, inside its
/// bands, k is what reproduces the arm, and no sound posture is called outlying.
#[test]
fn other_loads_are_predicted_as_well_as_the_one_measured() {
    let cell = default_cell();
    let (mut square, mut of_axes, mut inside, mut count) = (0.0, 0.0, 0, 0);
    let (mut holds, mut joints, mut outlying) = (0, 0, 0);
    for (i, (name, arm)) in arms(&cell).enumerate() {
        let measured = arm.measured(&cell, 12, 40 + i as u64);
        let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
        let mixed = MixedFit::new(&fit).unwrap();
        let predictor = mixed.compliance();
        let axes = fit.compliance().unwrap();
        let spread = predictor.spread.as_ref().unwrap();
        let (mut information, mut right) = (DMatrix::zeros(6, 6), DVector::zeros(6));
        let mut dice = Dice::new(i as u64);
        for q in random_group(&cell, StartKind::Uniform, 200, 9, 0).unwrap() {
            let force = dice.vector(600.0);
            let rope = PostureTerms::new(&cell.setup, &q, None).unwrap();
            let at = rope.measuring_points()[0];
            let moved = Wrench { force, moment: (at - rope.loading_point()).cross(&force) };
            let terms = PostureTerms::new(&cell.setup, &q, Some(&moved)).unwrap();
            let columns = terms.block_with(&cell.setup.robot, &predictor.extra).rows(0, 3).into_owned();
            let truth = arm.bent(&cell, &terms)[0];
            let error = &columns * &predictor.values - truth;
            let variance = &columns * &spread.covariance * columns.transpose();
            square += error.norm_squared();
            of_axes += (columns.columns(0, 6) * axes.values.rows(0, 6) - truth).norm_squared();
            count += 3;
            // Two standard errors, and the doubt about the sizes.
            inside += (0..3).filter(|i| error[*i].abs() < 2.3 * variance[(*i, *i)].sqrt()).count();
            let psi = rope.block(&cell.setup.robot);
            let bent = arm.bent(&cell, &rope);
            let bent = DVector::from_iterator(12, bent.iter().flat_map(|p| p.data.0[0]));
            information += psi.tr_mul(&psi);
            right += psi.tr_mul(&bent);
        }
        let truth = information.try_inverse().unwrap() * right;
        let identified = Identified::new(&fit, &IdentifiedOptions::default(), Control::default()).unwrap();
        for (joint, h) in identified.identification.estimates.joints.iter().zip(truth.iter()) {
            let [low, high] = joint.interval;
            let held = low.is_some_and(|low| low <= 1.0 / h) && high.is_none_or(|high| 1.0 / h <= high);
            holds += usize::from(held);
            joints += 1;
        }
        let said = &identified.diagnosis.unwrap().findings;
        outlying += said.iter().filter(|f| f.code.starts_with("outlying")).count();
        println!("{name}: {square:e} {of_axes:e}");
    }
    let rms = |square: f64| 1e3 * (square / (count as f64 / 3.0)).sqrt();
    println!("{} {} {inside}/{count} {holds}/{joints} {outlying}", rms(square), rms(of_axes));
    assert!(rms(square) < 0.06, "{}", rms(square));
    assert!(rms(square) < 0.25 * rms(of_axes), "{}", rms(of_axes));
    assert!(inside as f64 > 0.85 * count as f64, "{inside} of {count}");
    assert!(holds + 1 >= joints, "{holds} of {joints}");
    assert_eq!(outlying, 0);
}

/// What springs alone would say is a source of common error: half of the change to the likelier of two models without
/// bearings and beams, fitted here with their common means as columns of their own. Where nothing gives way beyond the axes
/// there is no such source.
#[test]
fn what_an_arm_is_made_of_is_a_source_of_error() {
    let cell = default_cell();
    let robot = &cell.setup.robot;
    for (i, (name, arm)) in arms(&cell).enumerate() {
        let measured = arm.measured(&cell, 8, 70 + i as u64);
        let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
        let mixed = MixedFit::new(&fit).unwrap();
        let errors = mixed_systematic_errors(&mixed).unwrap();
        let mut parts = errors.posterior.parts.iter();
        let part = parts.find(|part| part.source == "springs").unwrap();
        let predictor = mixed.compliance();
        let springs = &predictor.values + 2.0 * DVector::from_column_slice(&part.response);
        let likelier = ElasticSizing::ALL
            .map(|sizing| springs_alone(robot, &fit, &measured, sizing))
            .into_iter()
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let (_, likeliest) = likelier.unwrap();
        let size = likeliest.rows(0, 6).amax();
        for ((value, expected), term) in springs.iter().skip(6).zip(likeliest.iter().skip(6)).zip(&predictor.extra) {
            let far = (value - expected).abs();
            assert!(far < 2e-3 * expected.abs().max(0.1 * size), "{name} {term:?}: {value:e} {expected:e}");
        }
        for (value, expected) in springs.iter().zip(likeliest.iter()).take(6) {
            assert!((value / expected - 1.0).abs() < 1e-3, "{name}: {value:e} {expected:e}");
        }
    }
    let rigid = Arm { springs: vec![Matrix6::zeros(); 7], axes: compliance_of(cell.require_prior().unwrap()) };
    let fit = Fit::new(&cell, rigid.measured(&cell, 8, 3), &IdentifyOptions::default()).unwrap();
    let errors = mixed_systematic_errors(&MixedFit::new(&fit).unwrap()).unwrap();
    let source = errors.sources.iter().find(|source| source.name == "springs");
    let change = |source: &SystematicSource| source.change.iter().flatten().fold(0.0, |a, b| b.abs().max(a));
    assert!(source.is_none_or(|source| change(source) < 0.002), "{source:#?}");
}

/// −2 ln L of springs alone, and all unknowns of the mixed model with them.
fn springs_alone(robot: &Robot, fit: &Fit, measured: &[MeasuredPosture], sizing: ElasticSizing) -> (f64, DVector<f64>) {
    let axes = &fit.compliance().unwrap().values;
    let weights = IdentifyOptions::default().weights;
    let system = measured_system(fit.cell(), measured, &[], weights).unwrap();
    let effects = elastic_effects(robot, axes.as_slice(), sizing);
    let terms: Vec<ExtraTerm> = effects.iter().map(|effect| effect.0).collect();
    let blocks: Vec<DMatrix<f64>> = measured
        .iter()
        .map(|reading| {
            let terms_there = PostureTerms::new(&fit.cell().setup, &reading.posture.q, None).unwrap();
            terms_there.block_with(robot, &terms)
        })
        .collect();
    let rows: Vec<_> = blocks.iter().flat_map(|block| block.row_iter()).collect();
    let columns = DMatrix::from_rows(&rows);
    let is_positive = |term: &ExtraTerm| matches!(term, ExtraTerm::Spring { row, column, .. } if row == column);
    // Each class with its mean as a further column.
    let (mut random, mut classes, mut origins) = (Vec::new(), Vec::new(), Vec::new());
    for class in ElasticClass::ENTRIES {
        let (from, mut mean) = (random.len(), DVector::zeros(columns.nrows()));
        for (i, (term, of_class, scale)) in effects.iter().enumerate().filter(|(_, effect)| effect.1 == class) {
            let column = columns.column(6 + i) * *scale;
            if is_positive(term) {
                mean += &column;
            }
            assert_eq!(*of_class, class);
            random.push(column);
            origins.push(Some(i));
        }
        random.push(mean);
        origins.push(None);
        classes.push(from..random.len());
    }
    let model = MixedModel::new(&system, &DMatrix::from_columns(&random), classes.clone()).unwrap();
    let (gamma, sizes, value) = model.best().unwrap();
    let (solution, ..) = model.solve(gamma, &sizes, &[]).unwrap();
    let mut out = DVector::zeros(6 + effects.len());
    out.rows_mut(0, 6).copy_from(&solution.rows(0, 6));
    for class in classes {
        let mean = solution[6 + class.end - 1];
        for k in class {
            if let Some(i) = origins[k] {
                let (term, _, scale) = &effects[i];
                out[6 + i] = scale * (solution[6 + k] + if is_positive(term) { mean } else { 0.0 });
            }
        }
    }
    (value, out)
}

/// A posture whose load was half as large again as stated, among those of arms that bend beyond their axes.
#[test]
fn a_wrong_load_is_named_on_an_arm_that_bends() {
    let cell = default_cell();
    for (i, (name, arm)) in arms(&cell).enumerate() {
        let mut measured = arm.measured(&cell, 12, 60 + i as u64);
        measured[4].displacements.iter_mut().for_each(|d| d.value *= 1.5);
        let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
        let identified = Identified::new(&fit, &IdentifiedOptions::default(), Control::default()).unwrap();
        let said = identified.diagnosis.unwrap().findings;
        let named: Vec<&str> =
            said.iter().filter(|f| f.code == "outlying-posture").map(|f| f.subject.as_str()).collect();
        assert_eq!(named, ["posture 5"], "{name}: {said:#?}");
    }
}

/// What `identify` saves of an arm.
fn saved(cell: &Cell, arm: &Arm, postures: usize, seed: u64) -> Saved {
    let measured = arm.measured(cell, postures, seed);
    let fit = Fit::new(cell, &measured, &IdentifyOptions::default()).unwrap();
    let mut wanted = IdentifiedOptions::default();
    wanted.brief = true;
    let identified = Identified::new(&fit, &wanted, Control::default()).unwrap();
    Saved::new(identified.sealed.unwrap(), None, "k.json")
}

/// Forces in all directions at the tip in other postures, or the cell's own load there.
fn work(cell: &Cell, by_cell: bool) -> Vec<LoadedPosture> {
    let mut dice = Dice::new(3);
    let postures = random_group(cell, StartKind::Uniform, 40, 9, 0).unwrap();
    let postures = postures.into_iter().enumerate().map(|(i, q)| {
        let wrench = match by_cell {
            true => *PostureTerms::new(&cell.setup, &q, None).unwrap().wrench(),
            false => Wrench::force(dice.vector(600.0)),
        };
        LoadedPosture::new(i.to_string(), q, wrench)
    });
    postures.collect()
}

/// What is said of loads that were never applied: code and sentence.
fn said(cell: &Cell, saved: &Saved, by_cell: bool) -> Option<(String, String)> {
    let loaded = PredictionInputs { cell: cell.clone(), postures: work(cell, by_cell), summary: None };
    let request = PredictOptions { cell_load: by_cell, ..PredictOptions::default() };
    let predicted = request.predict(&loaded, saved, Control::default()).unwrap();
    let findings = predicted.prediction.findings.into_iter();
    let mut never_loaded = findings.filter(|f| f.code.starts_with("never-"));
    never_loaded.next().map(|f| (f.code, f.sentence))
}

/// The cell with a weight after the rope in each posture.
fn with_weight(cell: &Cell) -> Cell {
    let weight = Load::Weight { magnitude: 500.0, direction: -Vector3::z() };
    let cases = [("rope", cell.setup.load.clone()), ("weight", weight)];
    let case = |(name, load): (&str, Load)| LoadCase { name: name.to_string(), load, loading_point: None };
    let mut both = cell.clone();
    both.setup.load = Load::Cases(cases.map(case).to_vec());
    both
}

/// A rope to one anchor gives the base no moment about the line to it. Predictions under other loads say so, with what a
/// weight would leave where it rules them; those under the rope do not, nor those after the weight.
#[test]
fn loads_that_were_never_applied_are_said() {
    let cell = default_cell();
    let axes = compliance_of(cell.require_prior().unwrap());
    let mut report = String::new();
    for (name, postures, ruled) in [("links_half", 6, true), ("realistic", 12, false)] {
        let springs = structure(name);
        let arm = Arm { springs, axes: axes.clone() };
        let rope = saved(&cell, &arm, postures, 41);
        let (code, sentence) = said(&cell, &rope, false).unwrap();
        assert_eq!(code, if ruled { "never-loaded" } else { "never-turned" });
        report += &format!("{name}: {sentence}\n");
        let dense = dense(&cell, &rope, &work(&cell, false));
        let numbers = sentence.split(" mm").flat_map(|s| s.rsplit(' ').next());
        let numbers: Vec<f64> = numbers.filter_map(|s| s.parse().ok()).collect();
        assert_eq!(numbers.len(), if ruled { 3 } else { 0 }, "{sentence}");
        for (said, computed) in numbers.iter().zip(dense) {
            assert!((said - 1e3 * computed).abs() < 6e-4, "{sentence} {dense:?}");
        }
        assert_eq!(said(&cell, &rope, true), None);
        let both = saved(&with_weight(&cell), &arm, postures, 41);
        assert_eq!(said(&cell, &both, false), None);
    }
    insta::assert_snapshot!(report, @"
    links_half: Of the 0.064 mm (RMS) by which these displacements may be off, 0.054 mm lie in directions in which no reading has loaded the arm, most of all in the base (turned about x with 775 N·m here, 0 N·m in the readings) and joint 1 and its link. A weight of 500 N hung in the same postures would leave 0.033 mm.
    realistic: No reading has turned the base about x (0 N·m, here 775 N·m RMS): what it gives way there is taken from what the rest of the arm does, and a base that is softer that way is not in the bands. A weight of 500 N hung in the same postures would turn it with 495 N·m.
    ");
}

/// RMS error of the shifts of the tip, its part from directions of which readings told less than half, and the error after
/// a weight in the same postures, from dense matrices [m].
fn dense(cell: &Cell, saved: &Saved, work: &[LoadedPosture]) -> [f64; 3] {
    let (extra, spread) = (&saved.predictor.extra, saved.predictor.spread.as_ref().unwrap());
    let (robot, doubt, covariance) = (&cell.setup.robot, spread.doubt.as_ref().unwrap(), &spread.covariance);
    let mut setup = cell.setup.clone();
    setup.tool.loading_point = setup.tool.measuring_points[0].position;
    let rows: Vec<DMatrix<f64>> = work
        .iter()
        .map(|posture| {
            let terms = PostureTerms::new(&setup, &posture.q, Some(&posture.wrench)).unwrap();
            terms.block_with(robot, extra).rows(0, 3).into_owned()
        })
        .collect();
    let error = |covariance: &DMatrix<f64>| {
        let squares = rows.iter().map(|rows| (rows * covariance * rows.transpose()).trace());
        (squares.sum::<f64>() / work.len() as f64).sqrt()
    };
    // Prior covariance of the effects that are anything, by its definition: a class by itself and its common mean.
    let free: Vec<usize> = (0..covariance.ncols()).filter(|i| doubt.prior[*i] > 0.0).collect();
    let mean = |i: usize| doubt.means.iter().position(|mean| mean.contains(&i));
    let prior = DMatrix::from_fn(free.len(), free.len(), |a, b| {
        let (i, j) = (free[a], free[b]);
        let shared = f64::from(u8::from(mean(i).is_some() && mean(i) == mean(j)));
        (shared + f64::from(u8::from(i == j))) * (doubt.prior[i] * doubt.prior[j]).sqrt()
    });
    let root = prior.cholesky().unwrap().l().try_inverse().unwrap();
    let block = covariance.select_rows(&free).select_columns(&free);
    let eigen = (&root * block * root.transpose()).symmetric_eigen();
    let mut untold = 0.0;
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        let along = covariance.select_columns(&free) * root.transpose() * vector;
        let parts = rows.iter().map(|rows| (rows * &along).norm_squared() / value);
        untold += if *value > 0.5 { parts.sum::<f64>() } else { 0.0 };
    }
    // All readings under the weight at once.
    let weight = with_weight(cell).setup.cases().remove(1);
    let count = 12 * saved.loads.len();
    let mut further = DMatrix::zeros(count, covariance.ncols());
    let mut noise = DMatrix::identity(count, count) * spread.sigma.powi(2);
    for (p, load) in saved.loads.iter().enumerate() {
        let terms = PostureTerms::new(&weight, &load.q, None).unwrap();
        further.rows_mut(12 * p, 12).copy_from(&terms.block_with(robot, extra));
        let shared = DMatrix::from_fn(12, 12, |i, j| f64::from(u8::from(i % 3 == j % 3)) * spread.shift.powi(2));
        let mut block = noise.view_mut((12 * p, 12 * p), (12, 12));
        block += shared;
    }
    let with = covariance * further.transpose();
    let after = covariance - &with * (noise + further * &with).try_inverse().unwrap() * with.transpose();
    [error(covariance), (untold / work.len() as f64).sqrt(), error(&after)]
}

/// Bearings, links and base as the drawing of such an arm may have them, none of them exact.
fn drawing(cell: &Cell, links: f64, factor: f64) -> Vec<KnownElement> {
    let per_radian = f64::to_degrees(1.0) * 60.0;
    let bearings = [4900.0, 4900.0, 2940.0, 1176.0, 931.0, 372.0].into_iter();
    let bearings =
        bearings.enumerate().map(|(j, k)| KnownElement::new(ExtraTerm::JointTilt(j), k * per_radian, factor));
    // E I and G J of tubes and boxes along each row: the column, and the links.
    let beams = beams(&cell.setup.robot).into_iter().filter_map(|term| {
        let ExtraTerm::Beam { joint, part, twist } = term else {
            return None;
        };
        let shares = match (joint, part) {
            (0, RowPart::Axis) => [2.5e8, 2e8],
            (0, _) => [7e7, 4.5e7],
            (1, _) => [1e7, 8e6],
            (2, _) => [3.3e7, 2.1e7],
            (3, _) => [4e6, 3e6],
            _ => [1.2e6, 1e6],
        };
        let stiffness = shares[usize::from(twist)] * links;
        Some(KnownElement::new(term, stiffness, factor))
    });
    let base = KnownElement::new(ExtraTerm::BaseTilt, 1.1e8, factor);
    bearings.chain(beams).chain([base]).collect()
}

/// What a drawing says of bearings and base counts beside the readings: values and predictions are those of the equations
/// with one more reading of each, and other loads are predicted better from few postures.
#[test]
fn a_drawing_counts_beside_the_readings() {
    let mut cell = default_cell();
    let axes = compliance_of(cell.require_prior().unwrap());
    let (mut with, mut without) = (0.0, 0.0);
    for (i, name) in ARMS.into_iter().enumerate() {
        let arm = Arm { springs: structure(name), axes: axes.clone() };
        let measured = arm.measured(&cell, 6, 40 + i as u64);
        let links = if name == "links_half" { 0.5 } else { 1.0 };
        for elements in [Vec::new(), drawing(&cell, links, 1.5)] {
            cell.known_elements = elements;
            let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
            let mixed = MixedFit::new(&fit).unwrap();
            let values = &mixed.compliance().values;
            let mut setup = cell.setup.clone();
            setup.tool.loading_point = setup.tool.measuring_points[0].position;
            let mut sum = 0.0;
            for posture in work(&cell, false) {
                let terms = PostureTerms::new(&setup, &posture.q, Some(&posture.wrench)).unwrap();
                let columns = terms.block_with(&cell.setup.robot, &mixed.compliance().extra);
                let bend = columns.rows(0, 3) * values;
                sum += (bend - arm.bent(&cell, &terms)[0]).norm_squared();
            }
            if cell.known_elements.is_empty() {
                without += sum;
            } else {
                with += sum;
                // The unit of what is known is the noise that the readings show without it, a hair off.
                let dense = dense_values(&cell, &measured, &mixed);
                let off = (values - &dense).amax() / dense.amax();
                assert!(off < 1e-3, "{off:e}");
            }
        }
    }
    assert!(with < 0.7 * without, "{with:e} {without:e}");
}

/// All unknowns from normal equations with the prior of the effects and the known elements, at the sizes of `mixed`.
fn dense_values(cell: &Cell, measured: &[MeasuredPosture], mixed: &MixedFit) -> DVector<f64> {
    let predictor = mixed.compliance();
    let spread = predictor.spread.as_ref().unwrap();
    let (doubt, count) = (spread.doubt.as_ref().unwrap(), predictor.values.len());
    let springs = count - predictor.extra.len();
    let shared = DMatrix::from_fn(12, 12, |i, j| f64::from(u8::from(i % 3 == j % 3)));
    let noise = DMatrix::identity(12, 12) * spread.sigma.powi(2) + shared * spread.shift.powi(2);
    let weight = noise.try_inverse().unwrap();
    let (mut left, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
    for reading in measured {
        let terms = PostureTerms::new(&cell.setup, &reading.posture.q, None).unwrap();
        let rows = terms.block_with(&cell.setup.robot, &predictor.extra);
        let values = reading.displacements.iter().flat_map(|d| d.value.data.0[0]);
        let weighed = rows.transpose() * &weight;
        left += &weighed * &rows;
        right += weighed * DVector::from_iterator(12, values);
    }
    let free: Vec<usize> = (0..count).filter(|i| *i < springs || doubt.prior[*i] > 0.0).collect();
    let mean = |i: usize| doubt.means.iter().position(|mean| mean.contains(&i));
    let random: Vec<usize> = free.iter().copied().filter(|i| *i >= springs).collect();
    let prior = DMatrix::from_fn(random.len(), random.len(), |a, b| {
        let (i, j) = (random[a], random[b]);
        let shared = f64::from(u8::from(mean(i).is_some() && mean(i) == mean(j)));
        (shared + f64::from(u8::from(i == j))) * (doubt.prior[i] * doubt.prior[j]).sqrt()
    });
    let precision = prior.try_inverse().unwrap();
    for (a, i) in random.iter().enumerate() {
        for (b, j) in random.iter().enumerate() {
            left[(*i, *j)] += precision[(a, b)];
        }
    }
    for element in &cell.known_elements {
        let i = springs + predictor.extra.iter().position(|term| *term == element.term).unwrap();
        left[(i, i)] += element.std.powi(-2);
        right[i] += element.compliance * element.std.powi(-2);
    }
    let scale = DVector::from_iterator(free.len(), free.iter().map(|i| left[(*i, *i)].sqrt()));
    let scaled = DMatrix::from_fn(free.len(), free.len(), |a, b| left[(free[a], free[b])] / (scale[a] * scale[b]));
    let solved = scaled.cholesky().unwrap().solve(&right.select_rows(&free).component_div(&scale));
    let mut out = DVector::zeros(count);
    for (a, i) in free.iter().enumerate() {
        out[*i] = solved[a] / scale[a];
    }
    out
}

/// What `validate` promises of compensation is what new postures have under the same load, however well the model predicts:
/// the noise of the readings is none of its errors.
#[test]
fn validation_promises_what_new_postures_have() {
    let cell = default_cell();
    let mut ratios = Vec::new();
    for (i, (_, arm)) in arms(&cell).chain(arms(&cell)).enumerate() {
        let measured = arm.measured(&cell, 14, 70 + i as u64);
        let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
        let mixed = MixedFit::new(&fit).unwrap();
        let promised = cross_validate_mixed(&mixed, 14, None).unwrap();
        let (mut error, mut size) = (0.0, 0.0);
        for q in random_group(&cell, StartKind::Uniform, 200, 9, 0).unwrap() {
            let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
            let predictor = mixed.compliance();
            let predicted = terms.block_with(&cell.setup.robot, &predictor.extra) * &predictor.values;
            for (a, bent) in arm.bent(&cell, &terms).iter().enumerate() {
                error += (predicted.fixed_rows::<3>(3 * a) - bent).norm_squared();
                size += bent.norm_squared();
            }
        }
        ratios.push(promised.compensation_factor.unwrap() / (size / error).sqrt());
    }
    ratios.sort_by(f64::total_cmp);
    let median = (ratios[2] + ratios[3]) / 2.0;
    assert!((0.7..1.4).contains(&median), "{ratios:?}");
}
