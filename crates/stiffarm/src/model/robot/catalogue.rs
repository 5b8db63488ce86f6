//! Robots that ship with the program, with sources and doubts.

use super::{DhConvention, DhRow, Robot};
use crate::error::{Code, Error, Result, did_you_mean};
use crate::units::deg_to_rad;
use nalgebra::{DMatrix, Isometry3};
use std::f64::consts::{FRAC_PI_2, PI};

/// A published set of joint stiffness values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointStiffness {
    /// One value per joint \[N·m/rad\].
    pub values: &'static [f64],
    /// Where the values come from.
    pub source: &'static str,
    /// True when we have the source itself at hand.
    pub verified: bool,
}

/// A robot of the catalogue.
#[derive(Debug, Clone, Copy)]
pub struct CatalogueEntry {
    /// Short name for `[robot] catalogue = "…"`.
    pub key: &'static str,
    /// Full name.
    pub name: &'static str,
    /// Payload \[kg\], where known.
    pub payload_kg: Option<f64>,
    /// Source of the kinematics and what is doubtful about it.
    pub source: &'static str,
    /// Published joint stiffness, best first.
    pub stiffness: &'static [JointStiffness],
    convention: DhConvention,
    /// α, a, d, offset per row \[rad, m\].
    rows: &'static [[f64; 4]],
    /// Rows of C as (serial joint, controller joint, factor).
    coupling: &'static [(usize, usize, f64)],
    /// Controller limits \[deg\]; empty where unknown (±360° is used).
    limits_deg: &'static [[f64; 2]],
    base_z: f64,
}

impl CatalogueEntry {
    /// The robot's chain.
    ///
    /// # Errors
    /// None for the entries of the catalogue; the type is that of any robot.
    pub fn robot(&self) -> Result<Robot> {
        let rows: Vec<DhRow> = self
            .rows
            .iter()
            .map(|r| DhRow {
                alpha: r[0],
                a: r[1],
                d: r[2],
                offset: r[3],
            })
            .collect();
        let n = rows.len();
        let mut coupling = DMatrix::zeros(n, n);
        for &(i, j, factor) in self.coupling {
            coupling[(i, j)] = factor;
        }
        let robot = Robot::from_dh(
            self.name,
            self.convention,
            &rows,
            Isometry3::translation(0.0, 0.0, self.base_z),
        )?
        .with_coupling(coupling)?;
        if self.limits_deg.is_empty() {
            return Ok(robot);
        }
        let limits: Vec<[f64; 2]> = self.limits_deg.iter().map(|l| l.map(deg_to_rad)).collect();
        robot.with_limits(&limits)
    }

    /// Whether limits of the controller angles are known.
    pub fn has_limits(&self) -> bool {
        !self.limits_deg.is_empty()
    }
}

/// The embedded catalogue; the first entry is the default robot.
pub fn catalogue() -> &'static [CatalogueEntry] {
    &CATALOGUE
}

/// Finds an entry by its key, ignoring case.
///
/// # Errors
/// Unknown name; the hint has the nearest key.
pub fn find(key: &str) -> Result<&'static CatalogueEntry> {
    CATALOGUE
        .iter()
        .find(|e| e.key.eq_ignore_ascii_case(key))
        .ok_or_else(|| {
            let keys: Vec<&str> = CATALOGUE.iter().map(|e| e.key).collect();
            let hint = did_you_mean(key, keys.iter().copied())
                .unwrap_or_else(|| format!("known robots: {}", keys.join(", ")));
            Error::new(
                Code::UnknownName,
                format!("The catalogue has no robot \"{key}\"."),
            )
            .hint(hint)
        })
}

const SIGNS_COUPLED: &[(usize, usize, f64)] = &[
    (0, 0, -1.0),
    (1, 1, 1.0),
    (2, 1, -1.0),
    (2, 2, -1.0),
    (3, 3, -1.0),
    (4, 4, 1.0),
    (5, 5, -1.0),
];

const CATALOGUE: [CatalogueEntry; 4] = [
    CatalogueEntry {
        key: "comau-nj165-3.0",
        name: "COMAU SMART5 NJ 165-3.0",
        payload_kg: Some(165.0),
        source: "Kinematics: RobotKinematicsCatalogue 1.1.2 (PyPI), cross-checked against the \
                 CNR-STIIMA NJ220 URDF (same 830/400/1175/250/230; d4 = 1.444 m rests on the catalogue \
                 alone). Axis 3 is coupled to axis 2 in the controller convention: stated for the family, \
                 not for this very model; Table 1's bounds and Table 5's flange heights of Zhang et al. \
                 2021 agree with it.",
        stiffness: &[
            JointStiffness {
                values: &[950e3, 3000e3, 900e3, 250e3, 200e3, 150e3],
                source: "Zhang et al. 2021, doi:10.1109/ACCESS.2021.3073671, Table 2 (simulation)",
                verified: true,
            },
            JointStiffness {
                values: &[852_300.0, 4763e3, 1312e3, 213e3, 272e3, 173e3],
                source: "Zhang et al. 2021, doi:10.1109/ACCESS.2021.3073671, Table 6, Group 3 (experiment)",
                verified: true,
            },
        ],
        convention: DhConvention::Modified,
        rows: &[
            [0.0, 0.0, 0.83, 0.0],
            [-FRAC_PI_2, 0.4, 0.0, -FRAC_PI_2],
            [0.0, 1.175, 0.0, -FRAC_PI_2],
            [-FRAC_PI_2, 0.25, 1.444, 0.0],
            [FRAC_PI_2, 0.0, 0.0, 0.0],
            [-FRAC_PI_2, 0.0, 0.23, PI],
        ],
        coupling: SIGNS_COUPLED,
        limits_deg: &[
            [-180.0, 180.0],
            [-75.0, 95.0],
            [-230.0, -10.0],
            [-720.0, 720.0],
            [-125.0, 125.0],
            [-720.0, 720.0],
        ],
        base_z: 0.0,
    },
    CatalogueEntry {
        key: "fanuc-r2000ic-165f",
        name: "FANUC R-2000iC/165F",
        payload_kg: Some(165.0),
        source: "Kinematics as used with the measured data set of \
                 longton2001-pixel/breakthrough-surge-suppression-in-high-speed-robotic-drilling (MIT); the \
                 geometry equals the catalogue entry of RobotKinematicsCatalogue. Joint limits are not in \
                 that source. No published stiffness: identify it from the data.",
        stiffness: &[],
        convention: DhConvention::Modified,
        rows: &[
            [0.0, 0.0, 0.67, 0.0],
            [-FRAC_PI_2, 0.312, 0.0, -FRAC_PI_2],
            [0.0, 1.075, 0.0, 0.0],
            [-FRAC_PI_2, 0.225, 1.28, 0.0],
            [FRAC_PI_2, 0.0, 0.0, 0.0],
            [-FRAC_PI_2, 0.0, 0.215, 0.0],
        ],
        coupling: &[
            (0, 0, 1.0),
            (1, 1, 1.0),
            (2, 1, -1.0),
            (2, 2, -1.0),
            (3, 3, -1.0),
            (4, 4, -1.0),
            (5, 5, -1.0),
        ],
        limits_deg: &[],
        base_z: 0.0,
    },
    CatalogueEntry {
        key: "kuka-kr240-2",
        name: "KUKA KR240-2 / KR270-2",
        payload_kg: Some(240.0),
        source: "Kinematics: RobotKinematicsCatalogue 1.1.2 (KUKA_KR240_2). Joint limits are not in that \
                 source.",
        stiffness: &[JointStiffness {
            values: &[3.8e6, 6.6e6, 3.9e6, 0.56e6, 0.66e6, 0.47e6],
            source: "usually quoted from the COROUSSO project / Dumas, Caro et al. 2011; the paper itself \
                     was not at hand",
            verified: false,
        }],
        convention: DhConvention::Modified,
        rows: &[
            [0.0, 0.0, 0.75, 0.0],
            [-FRAC_PI_2, 0.35, 0.0, 0.0],
            [0.0, 1.25, 0.0, -FRAC_PI_2],
            [-FRAC_PI_2, -0.055, 1.1, 0.0],
            [FRAC_PI_2, 0.0, 0.0, 0.0],
            [-FRAC_PI_2, 0.0, 0.23, PI],
        ],
        coupling: &[
            (0, 0, -1.0),
            (1, 1, 1.0),
            (2, 2, 1.0),
            (3, 3, -1.0),
            (4, 4, 1.0),
            (5, 5, -1.0),
        ],
        limits_deg: &[],
        base_z: 0.0,
    },
    CatalogueEntry {
        key: "kuka-kr500-r2830",
        name: "KUKA KR500 R2830 MT",
        payload_kg: Some(500.0),
        source: "GBT-ADL/Interactive-Coupling-Simulation-for-Robotic-Milling, Robot_Model.m; d6 includes an \
                 87 mm spindle. Doubt: the offsets put the arm upright at q2 = 0 while the limits follow the \
                 maker's convention (upright at A2 = −90°, A3 = 90°), so compare a pose with the pendant \
                 before use.",
        stiffness: &[JointStiffness {
            values: &[2.3e6, 8.6e6, 2.8e6, 3.0e6, 0.2e6, 0.9e6],
            source: "the same file (experimental modal analysis); another source gives 6.5e6, 7.6e6, 3.08e6 \
                     for joints 1 to 3: published stiffness of one model differs threefold",
            verified: false,
        }],
        convention: DhConvention::Standard,
        rows: &[
            [-FRAC_PI_2, 0.5, 0.479, 0.0],
            [0.0, 1.3, 0.0, -FRAC_PI_2],
            [-FRAC_PI_2, 0.055, 0.0, PI],
            [FRAC_PI_2, 0.0, -1.025, 0.0],
            [-FRAC_PI_2, 0.0, 0.0, 0.0],
            [PI, 0.0, -0.377, PI],
        ],
        coupling: &[
            (0, 0, 1.0),
            (1, 1, 1.0),
            (2, 2, 1.0),
            (3, 3, 1.0),
            (4, 4, 1.0),
            (5, 5, 1.0),
        ],
        limits_deg: &[
            [-185.0, 185.0],
            [-130.0, 20.0],
            [-100.0, 144.0],
            [-350.0, 350.0],
            [-120.0, 120.0],
            [-350.0, 350.0],
        ],
        base_z: 0.566,
    },
];

impl Robot {
    /// A robot of the catalogue by its key, for example `comau-nj165-3.0`.
    ///
    /// # Errors
    /// There is no robot of this key.
    pub fn from_catalogue(key: &str) -> Result<Robot> {
        find(key)?.robot()
    }
}
