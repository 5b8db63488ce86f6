//! What of a prediction's error lies in directions that no reading has loaded, and what one further load would leave of
//! it.
//!
//! With the random effects in units of their prior, u = P^(1/2) v, readings leave of v the covariance C_v ≤ I. Along
//! eigenvectors of C_v the posterior is uncorrelated; those of which more than half of the prior variance is left have
//! been told by no reading. The part of a row s of a prediction in such a direction w is cov(s x, w)²/var w, with
//! whatever the joint axes make up for in it; the parts of all directions and what the axes scatter beside them add up
//! to the variance of s x. What a further load leaves is the covariance after its rows, C − C Xᵀ(V + X C Xᵀ)⁻¹X C, the
//! sizes held: it needs no reading.

use super::doubt::MOST_SWEEPS;
use super::means::scattered;
use super::unlike::{WorkRows, further_loads, loaded, never_turned};
use crate::error::Result;
use crate::estimate::compliance::{IdentifiedCompliance, Spread};
use crate::estimate::freedom::SizeDoubt;
use crate::estimate::saved::{Saved, SeenLoad};
use crate::findings::{Finding, codes, length, list};
use crate::model::cell::Cell;
use crate::model::elastic::ElasticClass;
use crate::model::load::Wrench;
use crate::model::observation::{PostureTerms, Setup, places};
use crate::model::posture::is_same_posture;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Share of a direction's prior variance that is left where readings told nothing of it.
const UNTOLD_VARIANCE: f64 = 0.5;
/// Share of an error's variance from such directions beyond which they rule it.
const RULING_SHARE: f64 = 0.5;
/// Errors below this share of the deflections are no reason to measure again.
const LARGE_ERROR_SHARE: f64 = 0.01;
/// Share of the error that a further load has to take away to be worth a word.
const HELPING_SHARE: f64 = 0.25;
/// A weight is simpler to hang than another load is to make: others have to leave less than this share of what it
/// leaves.
const SIMPLER_SHARE: f64 = 0.8;
/// Places that are named at most.
const MOST_PLACES: usize = 2;
/// A second place is named where it has this share of the first.
const SECOND_PLACE_SHARE: f64 = 0.5;

/// What the sentence says in numbers, RMS over the points \[m\].
struct NeverLoaded {
    /// Error of all kinds.
    error: f64,
    /// The part of it from directions that no reading has loaded.
    untold: f64,
    /// The further load in the measured postures that is worth most, in words, and what it would leave.
    best: Option<(String, f64)>,
    /// Where most of it is, in words.
    places: Vec<String>,
}

/// Says it where such directions rule the error of a prediction.
///
/// # Errors
/// Postures that are none of the robot.
pub(crate) fn never_loaded(cell: &Cell, saved: &Saved, work: &[WorkRows]) -> Result<Option<Finding>> {
    let spread = saved.predictor.spread.as_ref();
    let Some((spread, doubt)) = spread.and_then(|spread| Some((spread, spread.doubt.as_ref()?))) else {
        return Ok(None);
    };
    if work.is_empty() || saved.loads.is_empty() {
        return Ok(None);
    }
    let seen = seen(cell, &saved.loads)?;
    let Some(numbers) = numbers_of(cell, saved, (spread, doubt), work, &seen)? else {
        return Ok(never_turned(cell, saved, work, &seen));
    };
    let remedy = match &numbers.best {
        Some((load, left)) if *left < (1.0 - HELPING_SHARE) * numbers.error => {
            format!("{load} in the same postures would leave {}.", length(*left))
        }
        _ => "No one further load in the same postures would take much of that away: choose other postures, too."
            .to_string(),
    };
    let sentence = format!(
        "Of the {} (RMS) by which these displacements may be off, {} lie in directions in which no reading has loaded \
         the arm, most of all in {}. {remedy}",
        length(numbers.error),
        length(numbers.untold),
        list(&numbers.places),
    );
    Ok(Some(Finding::caution(codes::NEVER_LOADED, "load", sentence)))
}

/// The numbers behind it; `None` where such directions do not rule the error, or it does not matter.
///
/// # Errors
/// As [`never_loaded`].
fn numbers_of(
    cell: &Cell,
    saved: &Saved,
    (spread, doubt): (&Spread, &SizeDoubt),
    work: &[WorkRows],
    seen: &[PostureTerms],
) -> Result<Option<NeverLoaded>> {
    let predictor = &saved.predictor;
    let count: usize = work.iter().map(|point| point.rows.nrows()).sum();
    let mut rows = DMatrix::zeros(count, predictor.values.len());
    let mut at = 0;
    for point in work {
        rows.rows_mut(at, point.rows.nrows()).copy_from(&point.rows);
        at += point.rows.nrows();
    }
    let sum = |of: fn(&WorkRows) -> f64| work.iter().map(of).sum::<f64>();
    let (squares, other) = (sum(|point| point.squares), sum(|point| point.other));
    let with = &rows * &spread.covariance;
    let untold = (&with * untold_directions(spread, doubt)).norm_squared();
    let error = with.dot(&rows) + other;
    if untold <= RULING_SHARE * error || error <= LARGE_ERROR_SHARE * LARGE_ERROR_SHARE * squares {
        return Ok(None);
    }
    // Of a point: three rows each.
    let rms = |sum: f64| (3.0 * sum / count as f64).sqrt();
    let places = places_of(cell, predictor, spread, doubt, &with, work, seen);
    let loads = further_loads(cell, saved.largest_force.unwrap_or_default()).into_iter();
    let left = loads.map(|(load, setup)| {
        // A rope whose anchor is where it pulls is no load.
        let after = after(spread, &setup, predictor, &saved.loads).ok();
        (load, after.map(|after| rms((&rows * after).dot(&rows) + other)))
    });
    Ok(Some(NeverLoaded { error: rms(error), untold: rms(untold), best: best(left), places }))
}

/// The further load that is worth most by what each leaves, the weight first; `None` leaves what is no load.
fn best(mut left: impl Iterator<Item = (String, Option<f64>)>) -> Option<(String, f64)> {
    let weight = left.next().and_then(|(load, left)| Some((load, left?)));
    let others = left.filter_map(|(load, left)| Some((load, left?)));
    let other = others.min_by(|a, b| a.1.total_cmp(&b.1));
    match (weight, other) {
        (Some(weight), Some(other)) if other.1 < SIMPLER_SHARE * weight.1 => Some(other),
        (Some(weight), _) => Some(weight),
        (None, other) => other,
    }
}

/// Columns d, each over the root of the variance of dᵀx, of the directions of which readings told less than half.
fn untold_directions(spread: &Spread, doubt: &SizeDoubt) -> DMatrix<f64> {
    let root = doubt.prior.map(|p| if p > 0.0 { 1.0 / p.sqrt() } else { 0.0 });
    let n = root.len();
    let mut relative = DMatrix::from_fn(n, n, |i, j| spread.covariance[(i, j)] * root[i] * root[j]);
    scattered(&mut relative, &doubt.means);
    relative = relative.transpose();
    scattered(&mut relative, &doubt.means);
    // Numbers that are not finite have none.
    let finite = relative.iter().all(|v| v.is_finite());
    let eigen = finite.then(|| SymmetricEigen::try_new(relative, f64::EPSILON, MOST_SWEEPS));
    let Some(eigen) = eigen.flatten() else {
        return DMatrix::zeros(n, 0);
    };
    let untold = (0..n).filter(|i| eigen.eigenvalues[*i] > UNTOLD_VARIANCE);
    let columns = untold.map(|i| eigen.eigenvectors.column(i) / eigen.eigenvalues[i].sqrt());
    let mut columns = match columns.collect::<Vec<_>>() {
        none if none.is_empty() => return DMatrix::zeros(n, 0),
        columns => DMatrix::from_columns(&columns).transpose(),
    };
    scattered(&mut columns, &doubt.means);
    let mut columns = columns.transpose();
    for (mut row, root) in columns.row_iter_mut().zip(root.iter()) {
        row *= *root;
    }
    columns
}

/// The arm under each load that was measured.
fn seen(cell: &Cell, loads: &[SeenLoad]) -> Result<Vec<PostureTerms>> {
    let terms = |load: &SeenLoad| {
        let mut setup = cell.setup.clone();
        setup.tool.loading_point = load.at_m.into();
        let wrench = Wrench { force: load.force_n.into(), moment: load.moment_nm.into() };
        PostureTerms::new(&setup, &load.q, Some(&wrench))
    };
    loads.iter().map(terms).collect()
}

/// Covariance of the unknowns after each of the postures was measured under the load of `setup`.
fn after(spread: &Spread, setup: &Setup, predictor: &IdentifiedCompliance, loads: &[SeenLoad]) -> Result<DMatrix<f64>> {
    let mut covariance = spread.covariance.clone();
    for (i, load) in loads.iter().enumerate() {
        if loads[..i].iter().any(|other| is_same_posture(&other.q, &load.q)) {
            continue;
        }
        let terms = PostureTerms::new(setup, &load.q, None)?;
        let rows = terms.block_with(&setup.robot, &predictor.extra);
        let with = &covariance * rows.transpose();
        let mut innovation = &rows * &with;
        for i in 0..innovation.nrows() {
            innovation[(i, i)] += spread.sigma.powi(2);
            for j in (i % 3..innovation.nrows()).step_by(3) {
                innovation[(i, j)] += spread.shift.powi(2);
            }
        }
        // Without any noise nothing is to be gained.
        if let Some(factor) = innovation.cholesky() {
            covariance -= &with * factor.solve(&with.transpose());
        }
    }
    Ok(covariance)
}

/// Places whose knowledge would take away most of the variance behind `with` = S C, in words, with what loads them at
/// work and loaded them in the readings.
fn places_of(
    cell: &Cell,
    predictor: &IdentifiedCompliance,
    spread: &Spread,
    doubt: &SizeDoubt,
    with: &DMatrix<f64>,
    work: &[WorkRows],
    seen: &[PostureTerms],
) -> Vec<String> {
    let robot = &cell.setup.robot;
    let springs = predictor.values.len() - predictor.extra.len();
    let class = |i: usize| doubt.classes.iter().position(|class| class.contains(&i));
    let shift = ElasticClass::Shift as usize;
    // How much of the variance is known with the effects that `of` picks: of these, those that are anything.
    let explained = |of: &dyn Fn(usize) -> bool| {
        let effects = (springs..predictor.values.len()).filter(|i| of(*i) && doubt.prior[*i] > 0.0);
        let effects: Vec<usize> = effects.collect();
        let root: DVector<f64> = DVector::from_iterator(effects.len(), effects.iter().map(|i| doubt.prior[*i].sqrt()));
        let relative = DMatrix::from_fn(effects.len(), effects.len(), |a, b| {
            spread.covariance[(effects[a], effects[b])] / (root[a] * root[b]) + if a == b { 1e-9 } else { 0.0 }
        });
        let across = DMatrix::from_fn(effects.len(), with.nrows(), |a, r| with[(r, effects[a])] / root[a]);
        relative.cholesky().map_or(0.0, |factor| factor.solve(&across).dot(&across))
    };
    let is_at = |i: usize, place: Option<usize>| predictor.extra[i - springs].joint() == place;
    let mut all: Vec<(Option<usize>, f64)> =
        places(robot.joint_count()).map(|place| (place, explained(&|i| is_at(i, place)))).collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    let few = all.iter().take(MOST_PLACES);
    let named = few.filter(|(_, part)| *part > SECOND_PLACE_SHARE * all[0].1);
    let mut out = Vec::new();
    for (place, _) in named {
        let of_shift = explained(&|i| is_at(i, *place) && class(i) == Some(shift));
        let of_turn = explained(&|i| is_at(i, *place) && class(i) != Some(shift));
        let name = match place {
            None => "the base".to_string(),
            Some(j) => format!("{} and its link", robot.joints()[*j].name),
        };
        out.push(format!("{name}{}", loaded(*place, of_shift > of_turn, work, seen)));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::best;

    #[test]
    fn ropes_are_held_against_the_weight_alone() {
        let of = |left: [Option<f64>; 3]| best(["weight", "first", "second"].map(String::from).into_iter().zip(left));
        let named = |name: &str, left: f64| Some((name.to_string(), left));
        assert_eq!(of([Some(3.0), Some(2.9), Some(2.5)]), named("weight", 3.0));
        assert_eq!(of([Some(3.0), Some(2.9), Some(2.0)]), named("second", 2.0));
        // Without a weight the rope that leaves least is the best, however little less it leaves.
        assert_eq!(of([None, Some(2.9), Some(2.8)]), named("second", 2.8));
        assert_eq!(of([None, None, None]), None);
    }
}
