//! The stiffness that a drawing gives of bearings, links and base arrives as compliance with its uncertainty; slips are
//! named with their place.

use super::{Check, assert_close};
use crate::common::cases::{shown, slip};
use stiffarm::model::observation::ExtraTerm;
use stiffarm_files::cell::parse_cell;

const CELL: &str = "format = 1\nrobot.catalogue = 'comau-nj165-3.0'\n\
    tool = { loading_point_mm = [200, 0, 250], measuring_point = [{ name = '1', position_mm = [0, 0, 200] }] }\n\
    load = { kind = 'measured' }\n[elastic]\n";

#[test]
fn a_drawing_arrives_as_compliances_with_their_uncertainty() -> Check {
    let keys = "bearing_tilt_nm_per_rad = [2e7, 0, 1e7, 0, 0, 0]\nlink_bending_nm2 = [0, 1e7, 0, 0, 0, 0]\n\
                base_tilt_nm_per_rad = 1e8\nstiffness_factor = 2\n";
    let cell = parse_cell(&format!("{CELL}{keys}"), "cell.toml")?;
    assert_eq!(cell.elastic, None);
    let elements = &cell.known_elements;
    let of = |term: ExtraTerm| elements.iter().find(|element| element.term == term);
    for (term, compliance) in
        [(ExtraTerm::BaseTilt, 1e-8), (ExtraTerm::JointTilt(0), 5e-8), (ExtraTerm::JointTilt(2), 1e-7)]
    {
        let element = of(term).ok_or("missing")?;
        assert_close(element.compliance, compliance);
        // Half of what lies between twice and half as soft.
        assert_close(element.std, 0.75 * compliance);
    }
    // The link behind joint 2 has one part.
    assert_eq!(elements.len(), 4);
    assert!(matches!(elements[3].term, ExtraTerm::Beam { joint: 1, twist: false, .. }));
    assert_close(elements[3].compliance, 1e-7);
    Ok(())
}

#[test]
fn slips_in_a_drawing_are_named_with_their_place() {
    let mut report = String::new();
    for (keys, key) in [
        ("bearing_tilt_nm_per_rad = [1e7]\n", "elastic.bearing_tilt_nm_per_rad"),
        ("link_bending_nm2 = [0, 1e7, 0, 0, 1e6, 0]\n", "elastic.link_bending_nm2[5]"),
        ("link_twist_nm2 = [0, -1e7, 0, 0, 0, 0]\n", "elastic.link_twist_nm2[2]"),
        ("base_tilt_nm_per_rad = 0\n", "elastic.base_tilt_nm_per_rad"),
        ("base_tilt_nm_per_rad = 1e8\nstiffness_factor = 1\n", "elastic.stiffness_factor"),
        ("stiffness_factor = 2\n", "elastic.stiffness_factor"),
        ("turn_std_rad_per_nm = 1e-7\n", "elastic.shift_std_m_per_n"),
    ] {
        let error = parse_cell(&format!("{CELL}{keys}"), "cell.toml").unwrap_err();
        assert_eq!(error.place().key.as_deref(), Some(key), "{keys}: {error}");
        report += &slip::<()>(&shown("", keys), Err(error));
    }
    insta::assert_snapshot!("drawing_slips", report);
}
