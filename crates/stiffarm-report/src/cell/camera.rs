//! How a view looks at the cell.

use crate::scene::first_look::{TURN, toward};
use stiffarm::nalgebra::Vector3;

/// The camera of the perspective stands this many times as far away as the scene is large.
const AWAY: f64 = 3.5;
/// What is nearer to the camera than this share of its distance is cut off.
const NEAREST: f64 = 0.15;

/// Axes of a view in the base frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Camera {
    right: Vector3<f64>,
    up: Vector3<f64>,
    /// From the scene to who looks.
    toward: Vector3<f64>,
    /// What the perspective looks at, and from how far \[m\].
    eye: Option<(Vector3<f64>, f64)>,
}

impl Camera {
    /// From the side: x to the right, z up.
    pub(super) fn side() -> Self {
        Camera { right: Vector3::x(), up: Vector3::z(), toward: -Vector3::y(), eye: None }
    }

    /// From above: x to the right, y up.
    pub(super) fn above() -> Self {
        Camera { right: Vector3::x(), up: Vector3::y(), toward: Vector3::z(), eye: None }
    }

    /// In perspective, at something of this size around `centre`.
    pub(super) fn perspective(centre: Vector3<f64>, size: f64) -> Self {
        let toward = toward(TURN);
        let right = Vector3::z().cross(&toward).normalize();
        Camera { right, up: toward.cross(&right), toward, eye: Some((centre, AWAY * size.max(1e-3))) }
    }

    /// True where lengths keep their proportions.
    pub(super) fn is_flat(&self) -> bool {
        self.eye.is_none()
    }

    /// Direction of `v` in the picture.
    pub(super) fn flat(&self, v: &Vector3<f64>) -> [f64; 2] {
        [self.right.dot(v), self.up.dot(v)]
    }

    /// How near a point is to who looks \[m\]; what is farther is drawn before.
    pub(super) fn nearness(&self, p: &Vector3<f64>) -> f64 {
        match &self.eye {
            None => self.toward.dot(p),
            Some((centre, distance)) => {
                let eye = centre + self.toward * *distance;
                -(p - eye).norm()
            }
        }
    }

    /// Where a point is in the picture; `None` behind who looks.
    pub(super) fn point(&self, p: &Vector3<f64>) -> Option<[f64; 2]> {
        match &self.eye {
            None => Some(self.flat(p)),
            Some((centre, distance)) => {
                let off = p - centre;
                let before = distance - self.toward.dot(&off);
                (before >= NEAREST * distance * 0.999).then(|| self.flat(&off).map(|v| v * distance / before))
            }
        }
    }

    /// The visible part of a line in the picture.
    pub(super) fn segment(&self, a: &Vector3<f64>, b: &Vector3<f64>) -> Option<[[f64; 2]; 2]> {
        let Some((centre, distance)) = &self.eye else {
            return Some([self.flat(a), self.flat(b)]);
        };
        let room = |p: &Vector3<f64>| distance * (1.0 - NEAREST) - self.toward.dot(&(p - centre));
        let (from, to) = (room(a), room(b));
        let meet = || a + (b - a) * (from / (from - to));
        let (a, b) = match (from >= 0.0, to >= 0.0) {
            (true, true) => (*a, *b),
            (true, false) => (*a, meet()),
            (false, true) => (meet(), *b),
            (false, false) => return None,
        };
        Some([self.point(&a)?, self.point(&b)?])
    }

    /// Centre, radius and axes of the circle that is a sphere's outline.
    pub(super) fn rim(&self, centre: &Vector3<f64>, radius: f64) -> (Vector3<f64>, f64, [Vector3<f64>; 2]) {
        let Some((middle, distance)) = &self.eye else {
            return (*centre, radius, [self.right, self.up]);
        };
        let to_eye = middle + self.toward * *distance - centre;
        let away = to_eye.norm().max(1.001 * radius);
        let unit = to_eye / away;
        let share = radius / away;
        let across = self.up.cross(&unit);
        let right = across.try_normalize(1e-9).unwrap_or(self.right);
        (centre + unit * (radius * share), radius * (1.0 - share * share).max(0.0).sqrt(), [right, unit.cross(&right)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forward_is_right_and_up_is_up() {
        for camera in [Camera::side(), Camera::perspective(Vector3::zeros(), 2.0)] {
            let x = camera.point(&Vector3::x()).unwrap();
            let z = camera.point(&Vector3::z()).unwrap();
            assert!(x[0] > 0.5 && z[1] > 0.5, "{x:?} {z:?}");
        }
        let y = Camera::above().point(&Vector3::y()).unwrap();
        assert_eq!(y, [0.0, 1.0]);
    }

    #[test]
    fn what_is_behind_the_camera_is_cut_off() {
        let camera = Camera::perspective(Vector3::zeros(), 1.0);
        let behind = camera.toward * 50.0;
        assert_eq!(camera.point(&behind), None);
        let [from, to] = camera.segment(&Vector3::zeros(), &behind).unwrap();
        assert!(from.iter().chain(&to).all(|v| v.is_finite()));
        assert_eq!(camera.segment(&behind, &(behind * 2.0)), None);
    }

    #[test]
    fn near_things_are_larger_and_nearer() {
        let camera = Camera::perspective(Vector3::zeros(), 1.0);
        let near = camera.toward * 1.0;
        let wide = |at: Vector3<f64>| {
            let [a, b] = [at, at + camera.right].map(|p| camera.point(&p).unwrap());
            b[0] - a[0]
        };
        assert!(wide(near) > wide(-near));
        assert!(camera.nearness(&near) > camera.nearness(&-near));
    }
}
