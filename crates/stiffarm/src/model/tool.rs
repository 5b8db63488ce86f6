//! Tool: loading point, measuring points, and what lies between flange and reflectors.

use crate::error::{Code, Error, Result};
use nalgebra::{Matrix6, Vector3, Vector6};

/// A named point in flange axes \[m\].
#[derive(Debug, Clone, PartialEq)]
pub struct NamedPoint {
    /// Name used in tables.
    pub name: String,
    /// Position in flange axes \[m\].
    pub position: Vector3<f64>,
}

/// A known compliance between flange and reflectors (force sensor, adapter):
/// the part beyond it turns and shifts under the load, and that motion is not
/// the joints'. Its share of each displacement is known and subtracted.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesCompliance {
    /// Where the compliance is lumped, in flange axes \[m\].
    pub origin: Vector3<f64>,
    /// 6 × 6, flange axes, from \[F; M\] at the origin to \[shift; rotation\]:
    /// blocks \[m/N\], \[m/(N·m)\], \[rad/N\], \[rad/(N·m)\].
    pub matrix: Matrix6<f64>,
}

impl SeriesCompliance {
    /// Diagonal compliance from translational \[N/m\] and rotational \[N·m/rad\] stiffness.
    ///
    /// # Errors
    /// A stiffness that is not positive.
    pub fn from_stiffness(origin: Vector3<f64>, translational: [f64; 3], rotational: [f64; 3]) -> Result<Self> {
        let stiffness = [translational, rotational].concat();
        if stiffness.iter().any(|k| k.is_nan() || *k <= 0.0) {
            return Err(Error::invalid("Each stiffness of the series compliance must be above zero."));
        }
        let diagonal = Vector6::from_iterator(stiffness.iter().map(|k| 1.0 / k));
        Ok(SeriesCompliance { origin, matrix: Matrix6::from_diagonal(&diagonal) })
    }
}

/// The end-effector: where it is loaded and where it is measured. They differ
/// (paper, Fig. 3); one is never used for the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Tool {
    /// Loading point in flange axes \[m\].
    pub loading_point: Vector3<f64>,
    /// Measuring points in flange axes; the first is the TCP (Section IV.B).
    pub measuring_points: Vec<NamedPoint>,
    /// True when a force sensor sits between flange and reflectors.
    pub has_sensor: bool,
    /// Known compliance of that sensor and the adapter, if any.
    pub series_compliance: Option<SeriesCompliance>,
}

impl Tool {
    /// The same tool loaded at another point, flange axes \[m\]; `None` changes nothing.
    #[must_use]
    pub(crate) fn loaded_at(&self, point: Option<Vector3<f64>>) -> Self {
        Tool { loading_point: point.unwrap_or(self.loading_point), ..self.clone() }
    }

    /// A rigid tool, points in flange axes \[m\]: where it is loaded, and its
    /// measuring points by name, the TCP first.
    ///
    /// # Errors
    /// No measuring point, two of one name, or a coordinate that is not finite.
    pub fn new<N: Into<String>>(
        loading_point: Vector3<f64>,
        measuring_points: impl IntoIterator<Item = (N, Vector3<f64>)>,
    ) -> Result<Self> {
        let points = measuring_points.into_iter();
        let measuring_points: Vec<NamedPoint> =
            points.map(|(name, position)| NamedPoint { name: name.into(), position }).collect();
        let all = measuring_points.iter().map(|p| &p.position);
        if all.chain([&loading_point]).any(|p| p.iter().any(|v| !v.is_finite())) {
            let message = "A point of the tool is not a finite number.";
            return Err(Error::new(Code::NotFinite, message));
        }
        let twice = |i: usize| measuring_points[..i].iter().any(|p| p.name == measuring_points[i].name);
        if measuring_points.is_empty() || (0..measuring_points.len()).any(twice) {
            return Err(Error::invalid("A tool needs at least one measuring point, and each a name of its own."));
        }
        Ok(Tool { loading_point, measuring_points, has_sensor: false, series_compliance: None })
    }

    /// The tool centre point: measuring point 1, flange axes \[m\].
    pub fn tcp(&self) -> Vector3<f64> {
        self.measuring_points[0].position
    }

    /// Number of measuring points m.
    pub fn point_count(&self) -> usize {
        self.measuring_points.len()
    }

    /// Index of a measuring point by name.
    pub fn point_index(&self, name: &str) -> Option<usize> {
        self.measuring_points.iter().position(|p| p.name == name)
    }
}
