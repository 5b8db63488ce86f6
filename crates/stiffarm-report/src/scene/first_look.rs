//! From where the cell is looked at first, so that nothing stands before the arm.

use crate::cell::stage::{arm, stands};
use stiffarm::model::cell::Cell;
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::shape::{Solid, nearest};
use stiffarm::nalgebra::Vector3;

/// Tilt of the perspective \[rad\], as the viewer has it.
const TILT: f64 = 0.419;
/// Turns of it that are tried \[deg\]: those of the printed pictures first, then what is like them.
const TURNS: [f64; 11] = [32.0, 12.0, 55.0, -15.0, -40.0, 80.0, -65.0, 110.0, 145.0, 180.0, 215.0];
/// Postures that are looked at.
const MOST: usize = 30;
/// Share of the points that must come into sight for another turn than the usual one.
const WORTH: f64 = 0.1;

/// Turn of the first look \[rad\]; `None` for the usual one.
pub(super) fn first_look(cell: &Cell, all: &[PostureTerms]) -> Option<f64> {
    let standing = cell.scene.parts().iter().filter(|part| stands(part));
    let solids: Vec<&Solid> =
        standing.flat_map(|part| &part.solids).filter(|solid| !matches!(solid, Solid::HalfSpace { .. })).collect();
    let postures = all.iter().step_by(all.len().div_ceil(MOST).max(1));
    let points: Vec<Vector3<f64>> = postures.flat_map(seen_of).collect();
    let far = 4.0 * cell.setup.robot.length();
    let hidden = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let toward = Vector3::new(sin * TILT.cos(), -cos * TILT.cos(), TILT.sin());
        let is_hidden = |point: &&Vector3<f64>| {
            let eye = *point + toward * far;
            solids.iter().any(|solid| nearest(solid, point, &eye).distance < 0.0)
        };
        points.iter().filter(is_hidden).count()
    };
    let usual = hidden(TURNS[0]);
    let others = TURNS[1..].iter().map(|turn| (hidden(*turn), *turn));
    let (least, turn) = others.min_by_key(|(count, _)| *count)?;
    let gained = usual.saturating_sub(least) as f64;
    (gained > WORTH * points.len() as f64).then(|| turn.to_radians())
}

/// What should be seen of a posture: its joints, what is between them, the tool's points.
fn seen_of(terms: &PostureTerms) -> Vec<Vector3<f64>> {
    let mut points = arm(terms);
    let between: Vec<_> = points.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    points.extend(between);
    points.extend(terms.measuring_points());
    points.push(*terms.loading_point());
    points
}
