//! Numbers as programs have them, and how many of them a way needs.

use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::{PI, TAU};
use stiffarm::model::pose::Convention;
use stiffarm::units::{deg_to_rad, rad_to_deg};

/// Which points of `way`, whose first is its start, a way in straight moves has to pass to keep within
/// `tolerance` of all of them, its end included, and how far they are off without; none where it may go
/// straight to the end. Of their numbers the first three count; `at` says how far along it they are.
pub(super) fn bends(way: &[[f64; 10]], at: &[f64], tolerance: f64) -> (Vec<usize>, f64) {
    let (mut corners, mut open) = (Vec::new(), vec![(0, way.len() - 1)]);
    let mut most: f64 = 0.0;
    while let Some((from, to)) = open.pop() {
        let off = |k: usize| {
            let share = (at[k] - at[from]) / (at[to] - at[from]);
            let of = |i: usize| way[k][i] - way[from][i] - share * (way[to][i] - way[from][i]);
            Vector3::from_fn(|i, _| of(i)).norm()
        };
        let farthest = (from + 1..to).max_by(|a, b| off(*a).total_cmp(&off(*b)));
        let Some(k) = farthest.filter(|k| off(*k) > tolerance) else {
            continue;
        };
        most = most.max(off(k));
        corners.push(k);
        open.extend([(from, k), (k, to)]);
    }
    if !corners.is_empty() {
        corners.push(way.len() - 1);
        corners.sort_unstable();
    }
    (corners, most)
}

/// The numbers of `rotation`, of those that mean it the nearest to `old`.
pub(super) fn near(convention: Convention, degrees: bool, old: &[f64], rotation: &UnitQuaternion<f64>) -> Vec<f64> {
    let to_file = |angle: f64| if degrees { rad_to_deg(angle) } else { angle };
    let from_file = |number: f64| if degrees { deg_to_rad(number) } else { number };
    let numbers = convention.numbers(rotation);
    if old.iter().any(|number| number.is_nan()) {
        return numbers.into_iter().map(to_file).collect();
    }
    let distance = |numbers: &Vec<f64>| {
        let pairs = numbers.iter().zip(old);
        pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>()
    };
    let all: Vec<Vec<f64>> = match convention {
        Convention::Abb => {
            let other = numbers.iter().map(|number| -number).collect();
            vec![numbers, other]
        }
        Convention::Ur => {
            let vector = Vector3::from_column_slice(&numbers);
            let axis = vector.try_normalize(1e-9);
            let other = axis.map(|axis| (vector - TAU * axis).as_slice().to_vec());
            [Some(numbers), other].into_iter().flatten().collect()
        }
        _ => {
            // Turns about fixed x, y, z; KUKA's stand the other way round.
            let is_reversed = convention == Convention::Kuka;
            let order = |mut turns: [f64; 3]| {
                if is_reversed {
                    turns.reverse();
                }
                turns
            };
            let old: Vec<f64> = old.iter().map(|number| from_file(*number)).collect();
            let [x, _, _] = order([old[0], old[1], old[2]]);
            let [roll, pitch, yaw] = order([numbers[0], numbers[1], numbers[2]]);
            // Near a pitch of a quarter turn the first turn is free: that of before.
            let steep_turns = {
                let r = (rotation * UnitQuaternion::from_euler_angles(x, 0.0, 0.0).inverse()).to_rotation_matrix();
                [x, (-r[(2, 0)]).atan2(r[(2, 2)]), (-r[(0, 1)]).atan2(r[(1, 1)])]
            };
            let is_steep = pitch.cos().abs() < 1e-5;
            let all =
                if is_steep { vec![steep_turns] } else { vec![[roll, pitch, yaw], [roll + PI, PI - pitch, yaw + PI]] };
            let whole = |turns: [f64; 3]| {
                let turns = order(turns).into_iter().zip(&old);
                turns.map(|(turn, old)| to_file(turn + TAU * ((old - turn) / TAU).round())).collect()
            };
            all.into_iter().map(whole).collect()
        }
    };
    let nearest = all.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.unwrap_or_default()
}

/// Decimals of a number's text; `None` where it has an exponent.
pub(super) fn decimals_of(text: &str) -> Option<usize> {
    if text.contains(['e', 'E']) { None } else { Some(text.split_once('.').map_or(0, |(_, fraction)| fraction.len())) }
}
