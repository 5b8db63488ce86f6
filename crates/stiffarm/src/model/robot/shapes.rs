//! The space that a robot's links take, as capsules.

use super::Robot;
use crate::error::{Error, Result};
use crate::model::shape::Capsule;
use nalgebra::{Isometry3, Vector3};

/// A capsule that moves with a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkCapsule {
    /// The link: 0 stands still, link i moves with joint i, counted from 1.
    pub link: usize,
    /// The capsule \[m\]: of link 0 in the base frame, of link i in the frame of
    /// joint i after its turn, which is
    /// [`Frames::links`](crate::model::kinematics::Frames::links)`()[i - 1]`.
    pub capsule: Capsule,
}

/// What is known of the shapes of the links.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Shapes {
    capsules: Vec<LinkCapsule>,
    /// Pairs of links (i < j) whose capsules may overlap.
    ignored: Vec<(usize, usize)>,
}

impl Shapes {
    /// Moves what stands still with the robot.
    pub(super) fn place(&mut self, pose: &Isometry3<f64>) {
        for shape in self.capsules.iter_mut().filter(|shape| shape.link == 0) {
            shape.capsule = shape.capsule.placed(pose);
        }
    }
}

impl Robot {
    /// The frame that the Denavit–Hartenberg row of link i ends in, T_1 … T_i, in the frame of joint i
    /// after its turn \[m\]; the base frame itself for link 0.
    pub fn row_frame(&self, link: usize) -> Isometry3<f64> {
        let row = link.checked_sub(1).and_then(|at| self.rows.get(at));
        row.map_or_else(Isometry3::identity, |row| row.after_turn(self.convention))
    }

    /// Sets the capsules around the links, and pairs of links whose capsules may
    /// overlap though nothing collides there. Neighbours (i, i + 1) always may;
    /// they need not be among the pairs.
    ///
    /// # Errors
    /// A link beyond the last joint, a pair of a link with itself, or a capsule
    /// that [`Capsule::new`] refuses.
    pub fn with_link_capsules(mut self, capsules: Vec<LinkCapsule>, ignored: Vec<(usize, usize)>) -> Result<Self> {
        let n = self.joint_count();
        let pairs = ignored.iter().flat_map(|(i, j)| [*i, *j]);
        if let Some(link) = (capsules.iter().map(|c| c.link).chain(pairs)).find(|link| *link > n) {
            return Err(Error::invalid(format!("There is no link {link}: the links of {n} joints are 0 to {n}.")));
        }
        if let Some((link, _)) = ignored.iter().find(|(i, j)| i == j) {
            return Err(Error::invalid(format!("Link {link} makes no pair with itself.")));
        }
        for shape in &capsules {
            let Capsule { a, b, radius } = shape.capsule;
            Capsule::new(a, b, radius)?;
        }
        let mut ignored: Vec<(usize, usize)> = ignored.into_iter().map(|(i, j)| (i.min(j), i.max(j))).collect();
        ignored.sort_unstable();
        ignored.dedup();
        self.shapes = Shapes { capsules, ignored };
        Ok(self)
    }

    /// Capsules around the links; none where nobody gave them.
    pub fn link_capsules(&self) -> &[LinkCapsule] {
        &self.shapes.capsules
    }

    /// Pairs of links (i < j, sorted) whose capsules may overlap though nothing
    /// collides there; neighbours are left out, theirs always may.
    pub fn ignored_pairs(&self) -> &[(usize, usize)] {
        &self.shapes.ignored
    }
}

/// A capsule of the catalogue: the link, both ends and the radius \[mm\], in the frame that the
/// Denavit–Hartenberg row of the link ends in; of link 0 in the base frame.
pub(super) type CapsuleRow = (usize, [f64; 3], [f64; 3], f64);

/// That row as a capsule \[m\]. `frame` is the frame that the row ends in, in that of the
/// joint after its turn.
pub(super) fn from_row(row: &CapsuleRow, frame: &Isometry3<f64>) -> LinkCapsule {
    let metres = |p: [f64; 3]| Vector3::from(p.map(crate::units::mm_to_m));
    let (link, a, b, radius) = *row;
    let capsule = Capsule { a: metres(a), b: metres(b), radius: crate::units::mm_to_m(radius) };
    LinkCapsule { link, capsule: capsule.placed(frame) }
}
