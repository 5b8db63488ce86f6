//! A robot of the catalogue as JSON shows it.

use serde::Serialize;
use stiffarm::Result;
use stiffarm::model::robot::{self, CatalogueEntry, DhConvention};
use stiffarm::units::{m_to_mm, m_to_shortest_mm, rad_to_shortest_deg, roll_pitch_yaw, rounded};

#[derive(Serialize)]
pub(super) struct Robot {
    pub(super) key: &'static str,
    pub(super) brand: &'static str,
    pub(super) name: &'static str,
    pub(super) payload_kg: Option<f64>,
    pub(super) payload_source: Option<&'static str>,
    pub(super) reach_mm: Option<f64>,
    pub(super) reach_source: Option<&'static str>,
    pub(super) joint_count: usize,
    /// `modified` (Craig) or `standard`.
    pub(super) dh_convention: DhConvention,
    /// α, a, d, offset.
    pub(super) dh_deg_mm_mm_deg: Vec<[f64; 4]>,
    /// C of θ = offset + C q.
    pub(super) theta_from_q: Vec<Vec<f64>>,
    /// Frame 0 of the rows in the base frame: x, y, z, turns about x, then y, then z.
    pub(super) base_mm_deg: [f64; 6],
    /// The flange in the last frame of the rows.
    pub(super) flange_mm_deg: [f64; 6],
    /// The controller's base frame in the base frame.
    pub(super) controller_base_mm_deg: [f64; 6],
    /// How the pendant's angles are known.
    pub(super) pendant: &'static str,
    /// `null` where they are not known.
    pub(super) limits_deg: Option<Vec<[f64; 2]>>,
    /// `null` where they are not known.
    pub(super) speeds_deg_per_s: Option<&'static [f64]>,
    pub(super) source: &'static str,
    pub(super) file: &'static str,
    pub(super) commit: &'static str,
    pub(super) licence: &'static str,
    pub(super) doubts: Vec<Doubt>,
    pub(super) stiffness: Vec<Stiffness>,
    /// Around the links, for collisions; empty where not known.
    pub(super) capsules: Vec<LinkCapsule>,
    /// Pairs of links whose capsules may overlap, beside neighbours.
    pub(super) capsules_ignored_pairs: Vec<(usize, usize)>,
    /// What the capsules leave out or make too large.
    pub(super) capsules_remark: &'static str,
}

#[derive(Serialize)]
pub(super) struct LinkCapsule {
    /// 0 stands still, link i moves with joint i.
    pub(super) link: usize,
    /// In the frame of the link's joint after its turn, of link 0 in the base frame.
    pub(super) from_mm: [f64; 3],
    pub(super) to_mm: [f64; 3],
    pub(super) radius_mm: f64,
}

#[derive(Serialize)]
pub(super) struct Doubt {
    pub(super) about: &'static str,
    pub(super) sentence: &'static str,
}

#[derive(Serialize)]
pub(super) struct Stiffness {
    pub(super) values_nm_per_rad: &'static [f64],
    pub(super) source: &'static str,
    pub(super) verified: bool,
}

/// The entry with its units in the keys.
pub(super) fn describe(entry: &CatalogueEntry) -> Result<Robot> {
    let robot = entry.robot()?;
    let limits = robot.joints().iter().map(|j| j.limits.map(rad_to_shortest_deg)).collect();
    let stiffness = entry.stiffness.iter().map(|set| Stiffness {
        values_nm_per_rad: set.values,
        source: set.source,
        verified: set.verified,
    });
    let rows = entry.dh_rows();
    let rows = rows.iter().map(|row| {
        [
            rad_to_shortest_deg(row.alpha),
            m_to_shortest_mm(row.a),
            m_to_shortest_mm(row.d),
            rad_to_shortest_deg(row.offset),
        ]
    });
    let coupling = robot.coupling().row_iter();
    let doubts = entry.doubts.iter().map(|doubt| Doubt { about: doubt.about.as_str(), sentence: doubt.sentence });
    Ok(Robot {
        key: entry.key,
        brand: entry.brand,
        name: entry.name,
        payload_kg: entry.payload_kg(),
        payload_source: entry.payload.map(|(_, source)| source),
        reach_mm: entry.reach_m().map(m_to_shortest_mm),
        reach_source: entry.reach.map(|(_, source)| source),
        joint_count: robot.joint_count(),
        dh_convention: entry.convention,
        dh_deg_mm_mm_deg: rows.collect(),
        theta_from_q: coupling.map(|row| row.iter().copied().collect()).collect(),
        base_mm_deg: six(&entry.base()),
        flange_mm_deg: six(&entry.flange()),
        controller_base_mm_deg: six(robot.controller_base()),
        pendant: entry.pendant,
        limits_deg: entry.has_limits().then_some(limits),
        speeds_deg_per_s: (!entry.speeds_deg_s.is_empty()).then_some(entry.speeds_deg_s),
        source: entry.source,
        file: entry.file,
        commit: entry.commit,
        licence: entry.licence,
        doubts: doubts.collect(),
        stiffness: stiffness.collect(),
        capsules: robot.link_capsules().iter().map(capsule).collect(),
        capsules_ignored_pairs: robot.ignored_pairs().to_vec(),
        capsules_remark: entry.capsules_remark,
    })
}

fn capsule(shape: &robot::LinkCapsule) -> LinkCapsule {
    // To 1e-9 mm: the ends went through a frame.
    let mm = |m: f64| rounded(m_to_mm(m), 9);
    let point = |p: &nalgebra::Vector3<f64>| [p.x, p.y, p.z].map(mm);
    LinkCapsule {
        link: shape.link,
        from_mm: point(&shape.capsule.a),
        to_mm: point(&shape.capsule.b),
        radius_mm: mm(shape.capsule.radius),
    }
}

/// A pose as x, y, z \[mm\] and turns about fixed x, then y, then z \[deg\].
fn six(pose: &nalgebra::Isometry3<f64>) -> [f64; 6] {
    let p = &pose.translation.vector;
    let [x, y, z] = [p.x, p.y, p.z].map(|v| m_to_shortest_mm(v) + 0.0);
    // To 1e-9 deg: the turns went through a quaternion.
    let angle = |rad: f64| rounded(rad.to_degrees(), 9);
    let [a, b, c] = roll_pitch_yaw(&pose.rotation).map(angle);
    [x, y, z, a, b, c]
}
