//! From where the cell is looked at first, so that nothing stands before the arm.

use super::arm::Arm;
use super::data::{BodyKind, Scene};
use stiffarm::model::shape::{Solid, nearest};
use stiffarm::nalgebra::Vector3;

/// Sideways turn of the printed perspective from the side view, and its tilt from above \[deg\], as the viewer has it.
pub(crate) const TURN: f64 = 32.0;
const TILT: f64 = 24.0;
/// Turns that are tried \[deg\]: the usual one first, then what is like it.
const TURNS: [f64; 11] = [TURN, 12.0, 55.0, -15.0, -40.0, 80.0, -65.0, 110.0, 145.0, 180.0, 215.0];
/// Postures that are looked at.
const MOST: usize = 30;
/// Share of the points that must come into sight for another turn than the usual one.
const WORTH: f64 = 0.1;

/// Turn of the first look \[rad\]; `None` for the usual one.
pub(super) fn first_look(scene: &Scene, robot_length: f64, arms: &[Arm<'_>]) -> Option<f64> {
    let standing = scene.bodies.iter().filter(|body| body.kind == BodyKind::Standing);
    let solids: Vec<&Solid> =
        standing.flat_map(|body| &body.solids).filter(|solid| !matches!(solid, Solid::HalfSpace { .. })).collect();
    let arms = arms.iter().step_by(arms.len().div_ceil(MOST).max(1));
    let points: Vec<Vector3<f64>> = arms.flat_map(seen_of).collect();
    let far = 4.0 * robot_length;
    let hidden = |degrees: f64| {
        let toward = toward(degrees);
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
fn seen_of(arm: &Arm<'_>) -> Vec<Vector3<f64>> {
    let mut points = arm.points();
    points.extend(arm.skeleton().windows(2).map(|pair| 0.5 * (pair[0] + pair[1])));
    points
}

/// From the scene to who looks in perspective, at this turn \[deg\].
pub(crate) fn toward(turn: f64) -> Vector3<f64> {
    let (turn, tilt) = (turn.to_radians(), TILT.to_radians());
    Vector3::new(turn.sin() * tilt.cos(), -turn.cos() * tilt.cos(), tilt.sin())
}
