//! The study on measured readings predicts a simulated arm to its noise, and the measured FANUC, and nothing of the
//! postures to be predicted reaches the model.

use crate::common::cases::refusals;
use crate::common::prelude::*;
use stiffarm::study::{Choice, MeasuredStudy, MeasuredStudyOptions, measured_study};

fn options() -> MeasuredStudyOptions {
    with(|o: &mut MeasuredStudyOptions| {
        o.splits = runs(5) as usize;
        o.pool = Some(9);
        o.counts = vec![4];
        o.indices = vec![Index::ExpectedError, Index::Prediction];
    })
}

fn simulated() -> (Cell, Measured) {
    let cell = stiffarm_files::builtin::cell("comau").unwrap();
    let plan = random_group(&cell, StartKind::Uniform, 13, 3, 0).unwrap();
    let postures = numbered(plan);
    let readings = simulated_readings(&cell, &postures, 1).unwrap();
    let measured = prepare(&cell, readings, &Default::default()).unwrap();
    (cell, measured)
}

fn run(cell: &Cell, measured: &Measured) -> MeasuredStudy {
    measured_study(cell, measured, &options(), Control::default()).unwrap()
}

/// All displacements of the third posture moved.
fn moved(measured: &Measured, by: Vector3<f64>) -> Measured {
    let mut out = measured.clone();
    let states = out.postures.iter_mut().filter(|m| m.posture.name == "3");
    for displacement in states.flat_map(|m| &mut m.displacements) {
        displacement.value += by;
    }
    out
}

/// Where the third posture is to be predicted, its readings change nothing but the error
/// there: the mean squares with it moved to and fro differ by the squared motion alone.
/// Where it stays in the pool unchosen they change nothing at all.
#[test]
fn nothing_of_the_test_reaches_choice_or_model() {
    let (cell, measured) = simulated();
    let by = Vector3::new(2e-3, -1e-3, 5e-4);
    let studies = [Vector3::zeros(), by, -by].map(|by| run(&cell, &moved(&measured, by)));
    let test = studies[0].posture_count - studies[0].pool_count;
    // Mean over the rows of the test postures, of which the third posture's moved.
    let expected = 2.0 * by.norm_squared() / (3 * test) as f64;
    let squares = |c: usize, split: usize| studies.each_ref().map(|s| s.choices[c].errors_m[split].unwrap().powi(2));
    let is_tested = |c: usize, split: usize| {
        let [plain, to, fro] = squares(c, split);
        (to + fro - 2.0 * plain - expected).abs() < 1e-6 * expected
    };
    let whole: Vec<usize> =
        (0..studies[0].choices.len()).filter(|c| studies[0].choices[*c].choice == Choice::Pool).collect();
    assert_eq!(whole.len(), 2);
    let (mut tested, mut unmoved) = (0, 0);
    for split in 0..studies[0].split_count {
        let outside = is_tested(whole[0], split);
        tested += usize::from(outside);
        for c in 0..studies[0].choices.len() {
            if outside {
                assert!(is_tested(c, split), "choice {c}, split {split}");
                continue;
            }
            let [plain, to, fro] = squares(c, split);
            let same = plain == to && plain == fro;
            unmoved += usize::from(same);
            assert!(same || (plain != to && plain != fro), "choice {c}, split {split}");
        }
    }
    assert!(tested > 0 && tested < studies[0].split_count, "{tested}");
    assert!(unmoved > 0);
}

#[test]
fn an_arm_of_joint_springs_is_predicted_to_its_noise() {
    let (cell, measured) = simulated();
    let study = run(&cell, &measured);
    assert_eq!((study.posture_count, study.pool_count, study.split_count), (13, 9, options().splits));
    // Two readings behind each displacement.
    let noise = (2.0 * cell.noise.reading_variance).sqrt();
    for choice in &study.choices {
        assert_eq!(choice.errors_m.len(), study.split_count);
        assert_eq!(choice.missing, 0, "{choice:?}");
        let expected = match choice.choice {
            Choice::Index(Index::ExpectedError | Index::Prediction) | Choice::Pool => 2.0,
            _ => 6.0,
        };
        assert!(
            choice.mean_m > 0.8 * noise && choice.mean_m < expected * noise,
            "{} with {:?}: {} against {noise}",
            choice.choice.as_str(),
            choice.model,
            choice.mean_m
        );
    }
    let again = run(&cell, &measured);
    assert_eq!(again, study);
}

#[test]
fn what_cannot_be_split_is_said() {
    let (cell, measured) = simulated();
    let with = |change: fn(&mut MeasuredStudyOptions)| {
        measured_study(&cell, &measured, &changed(options(), change), Control::default())
    };
    let rows = [
        ("a pool of all that were measured", Code::TooFewData, with(|o| o.pool = Some(13))),
        ("a choice of more than the pool", Code::TooFewData, with(|o| o.counts = vec![10])),
        ("a choice of none", Code::InvalidValue, with(|o| o.counts = vec![0, 4])),
        ("no split", Code::InvalidValue, with(|o| o.splits = 0)),
        ("sizes that are no numbers", Code::InvalidValue, with(|o| o.size_factor = f64::NAN)),
    ];
    insta::assert_snapshot!("split_refusals", refusals(rows));
}

/// The order that an independent study found (docs/measured.md holds 100 splits).
#[test]
fn chosen_for_prediction_six_postures_beat_the_whole_pool() {
    let (cell, measured) = crate::common::readings::measured_robot();
    let mut options = MeasuredStudyOptions::default();
    options.splits = 12;
    options.pool = Some(30);
    options.counts = vec![6];
    let study = measured_study(&cell, &measured, &options, Control::default()).unwrap();
    let error = |choice, model| {
        let count = if choice == Choice::Pool { 30 } else { 6 };
        study.get(count, choice, model).unwrap().mean_m
    };
    let (axes, mixed) = (ElasticChoice::Axes, ElasticChoice::Mixed);
    let prediction = error(Choice::Index(Index::Prediction), mixed);
    let whole = error(Choice::Pool, axes);
    assert!((0.20e-3..0.24e-3).contains(&whole), "{whole}");
    assert!(prediction < whole, "{prediction} against {whole}");
    assert!(prediction < error(Choice::Random, mixed));
    assert!(error(Choice::Random, axes) < error(Choice::Index(Index::Novel), axes));
    assert!(error(Choice::Pool, mixed) < 0.15e-3);
    assert!(study.prior_guessed);
    let codes: Vec<&str> = study.findings.iter().map(|f| f.code.as_str()).collect();
    assert_eq!(codes, ["best-choice", "worse-than-random", "guessed-prior"]);
}
