//! Robots with published stiffness.

use super::entry::{CatalogueEntry, JointStiffness};

const COMAU: CatalogueEntry = CatalogueEntry {
    key: "comau-nj165-3.0",
    brand: "Comau",
    name: "COMAU SMART5 NJ 165-3.0",
    payload: Some((165.0, "from model name")),
    reach: Some((3.0, "from model name")),
    source: "Kinematics: RobotKinematicsCatalogue 1.1.2 (PyPI), cross-checked against the \
             CNR-STIIMA NJ220 URDF (same 830/400/1175/250/230; d4 = 1.444 m rests on the catalogue \
             alone). Axis 3 is coupled to axis 2 in the controller convention: stated for the family, \
             not for this very model; Table 1's bounds and Table 5's flange heights of Zhang et al. \
             2021 agree with it.",
    pendant: "q3 is coupled to q2, as in RobotKinematicsCatalogue 1.1.2.",
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
    rows: &[
        [0.0, 0.0, 830.0, 0.0],
        [-90.0, 400.0, 0.0, -90.0],
        [0.0, 1175.0, 0.0, -90.0],
        [-90.0, 250.0, 1444.0, 0.0],
        [90.0, 0.0, 0.0, 0.0],
        [-90.0, 0.0, 230.0, 180.0],
    ],
    coupling: &[
        (0, 0, -1.0),
        (1, 1, 1.0),
        (2, 1, -1.0),
        (2, 2, -1.0),
        (3, 3, -1.0),
        (4, 4, 1.0),
        (5, 5, -1.0),
    ],
    limits_deg: &[
        [-180.0, 180.0],
        [-75.0, 95.0],
        [-230.0, -10.0],
        [-720.0, 720.0],
        [-125.0, 125.0],
        [-720.0, 720.0],
    ],
    ..CatalogueEntry::UNKNOWN
};

const KR240: CatalogueEntry = CatalogueEntry {
    key: "kuka-kr240-2",
    brand: "KUKA",
    name: "KUKA KR240-2 / KR270-2",
    payload: Some((240.0, "from model name")),
    reach: Some((2.7, "datasheet knowledge, not looked up")),
    source: "Kinematics: RobotKinematicsCatalogue 1.1.2 (KUKA_KR240_2). Joint limits are not in that \
             source.",
    pendant: "A1 is positive clockwise seen from above; at A2 = -90 and A3 = 90 the upper arm is upright and the \
              forearm level.",
    stiffness: &[JointStiffness {
        values: &[3.8e6, 6.6e6, 3.9e6, 0.56e6, 0.66e6, 0.47e6],
        source: "usually quoted from the COROUSSO project / Dumas, Caro et al. 2011; the paper itself \
                 was not at hand",
        verified: false,
    }],
    rows: &[
        [0.0, 0.0, 750.0, 0.0],
        [-90.0, 350.0, 0.0, 0.0],
        [0.0, 1250.0, 0.0, -90.0],
        [-90.0, -55.0, 1100.0, 0.0],
        [90.0, 0.0, 0.0, 0.0],
        [-90.0, 0.0, 230.0, 180.0],
    ],
    coupling: &[
        (0, 0, -1.0),
        (1, 1, 1.0),
        (2, 2, 1.0),
        (3, 3, -1.0),
        (4, 4, 1.0),
        (5, 5, -1.0),
    ],
    ..CatalogueEntry::UNKNOWN
};

/// The first is the default robot.
pub(super) const PUBLISHED: &[CatalogueEntry] = &[COMAU, KR240];

/// Published of an arm beside the KR 500 R2800-2, of the same payload: an order
/// of magnitude for it.
pub(super) const KR500_STIFFNESS: &[JointStiffness] = &[JointStiffness {
    values: &[2.3e6, 8.6e6, 2.8e6, 3.0e6, 0.2e6, 0.9e6],
    source: "of another arm of this payload, the KR500 R2830 MT: \
             GBT-ADL/Interactive-Coupling-Simulation-for-Robotic-Milling, Robot_Model.m (experimental modal \
             analysis); another source gives 6.5e6, 7.6e6, 3.08e6 for its joints 1 to 3: published stiffness of \
             one model differs threefold",
    verified: false,
}];
