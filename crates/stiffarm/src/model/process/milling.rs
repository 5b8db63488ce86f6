//! Mean load of a milling cut, from its depths, feed and specific cutting forces.
//!
//! The linear edge model of Y. Altintas, *Manufacturing Automation*, 2nd ed.,
//! Cambridge University Press 2012, chapter 2, doi:10.1017/CBO9780511843723; its
//! coefficients: E. Budak, Y. Altintas, E. J. A. Armarego, *Prediction of Milling
//! Force Coefficients From Orthogonal Cutting Data*, J. Manuf. Sci. Eng. 118
//! (1996), doi:10.1115/1.2831014. The means are derived here in the axes of the
//! path ([`ForceAxes::Path`]), which are not those of the book.
//!
//! Limits: an end mill with straight or helical teeth of one pitch, whose feed is
//! across its axis (no plunging, no ball end, no lead angle), small against its
//! radius; no runout, no chatter, no deflection of tool or robot that changes the
//! chip. What a tooth does beyond the mean makes vibration, no static deflection.

use super::{ForceAxes, TipLoad};
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};

/// How the teeth meet the workpiece. The cutter turns clockwise, seen from the
/// spindle towards the workpiece: positively about the path's z.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MillingDirection {
    /// Up or conventional milling: teeth move with the feed where they cut, and
    /// the chip begins thin. The workpiece lies on the path's −y side: to the
    /// left, seen from the spindle along the feed.
    Up,
    /// Down or climb milling: teeth move against the feed where they cut, and
    /// the chip ends thin. The workpiece lies on the path's +y side: to the
    /// right, seen from the spindle along the feed.
    Down,
}

/// Specific cutting forces: of a chip thickness h and a depth b of cut the tooth
/// meets the tangential force (k_tc h + k_te) b, and likewise the radial and the
/// axial one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CuttingCoefficients {
    /// Tangential, of the chip's area, against the tooth's motion \[Pa\].
    pub k_tc: f64,
    /// Radial, of the chip's area, from the tooth to the tool axis \[Pa\].
    pub k_rc: f64,
    /// Axial, of the chip's area \[Pa\]: above zero where it pulls the tool out of
    /// the spindle, towards +z of the path, as a right-hand helix does.
    pub k_ac: f64,
    /// Tangential, of the edge's length \[N/m\].
    pub k_te: f64,
    /// Radial, of the edge's length \[N/m\].
    pub k_re: f64,
    /// Axial, of the edge's length \[N/m\], signed as `k_ac`.
    pub k_ae: f64,
}

/// A milling cut with a cylindrical cutter, which turns clockwise seen from the
/// spindle and whose tip frame lies in the middle of its end face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Milling {
    /// Number of teeth.
    pub teeth: u32,
    /// Diameter of the cutter \[m\].
    pub diameter: f64,
    /// Depth of cut along the tool axis \[m\].
    pub axial_depth: f64,
    /// Width of cut across feed and tool axis \[m\]; at most the diameter, which
    /// is a full slot.
    pub radial_depth: f64,
    /// Feed per tooth \[m\].
    pub feed_per_tooth: f64,
    /// On which side the workpiece lies; without meaning in a full slot.
    pub direction: MillingDirection,
    /// Specific cutting forces.
    pub coefficients: CuttingCoefficients,
}

impl Milling {
    /// Immersion angles φ at which a tooth enters and leaves the cut \[rad\]. φ
    /// turns with the cutter, positively about the path's z; it is 0 at −y, π/2 in
    /// the direction of the feed and π at +y, so that the chip thickness is
    /// h = feed per tooth · sin φ.
    pub fn immersion(&self) -> [f64; 2] {
        // The width of cut R − R cos φ is counted from the side where h is zero.
        let cosine = 1.0 - 2.0 * self.radial_depth / self.diameter;
        let angle = cosine.clamp(-1.0, 1.0).acos();
        match self.direction {
            MillingDirection::Up => [0.0, angle],
            MillingDirection::Down => [PI - angle, PI],
        }
    }

    /// Force and moment on the robot's tool at the tip in the axes of the path,
    /// mean over a turn of the cutter, which is that over a tooth period:
    /// `teeth`/2π times the integral of one tooth's load from entry to exit.
    ///
    /// With the directions e_r = (sin φ, −cos φ, 0) from the tool axis to the tooth
    /// and e_t = (cos φ, sin φ, 0) of its motion, the element of a tooth at height
    /// w above the tip puts dF = (−k_t e_t − k_r e_r + k_a z) dw on the tool, at
    /// R e_r − w z, where k_t = k_tc h + k_te, and so on. A helix shifts this along
    /// the turn and leaves the mean as it is.
    ///
    /// Its signs: force x mostly below zero (the feed is resisted) but above it in
    /// shallow climb milling, where the tooth pulls the tool along; y of the
    /// tangential forces below zero; z that of `k_ac`; moment about z below zero,
    /// against the cutter's turn. Moments about x and y come from the height of
    /// the cut above the tip and from axial forces beside the tool axis.
    pub fn mean_load(&self) -> TipLoad {
        let [entry, exit] = self.immersion();
        let k = &self.coefficients;
        let change = |f: fn(f64) -> f64| f(exit) - f(entry);
        // Integrals from entry to exit.
        let angle = exit - entry;
        let sine = -change(f64::cos);
        let cosine = change(f64::sin);
        let sine_squared = 0.5 * angle - 0.25 * change(|phi| (2.0 * phi).sin());
        let sine_cosine = 0.5 * change(|phi| phi.sin().powi(2));

        let h = self.feed_per_tooth;
        // Each of ∫ k, ∫ k sin φ, ∫ k cos φ with k = k_c h sin φ + k_e.
        let plain = |chip: f64, edge: f64| chip * h * sine + edge * angle;
        let with_sine = |chip: f64, edge: f64| chip * h * sine_squared + edge * sine;
        let with_cosine = |chip: f64, edge: f64| chip * h * sine_cosine + edge * cosine;

        let share = f64::from(self.teeth) * self.axial_depth / TAU;
        let radius = 0.5 * self.diameter;
        let force = Vector3::new(
            -with_cosine(k.k_tc, k.k_te) - with_sine(k.k_rc, k.k_re),
            -with_sine(k.k_tc, k.k_te) + with_cosine(k.k_rc, k.k_re),
            plain(k.k_ac, k.k_ae),
        ) * share;
        // R e_r × (k_a z − k_t e_t): e_r × z = −e_t, e_r × e_t = z.
        let at_the_radius =
            Vector3::new(-with_cosine(k.k_ac, k.k_ae), -with_sine(k.k_ac, k.k_ae), -plain(k.k_tc, k.k_te))
                * (share * radius);
        // The forces act on average half the axial depth above the tip.
        let middle = Vector3::new(0.0, 0.0, -0.5 * self.axial_depth);
        TipLoad { force, moment: at_the_radius + middle.cross(&force), axes: ForceAxes::Path }
    }
}
