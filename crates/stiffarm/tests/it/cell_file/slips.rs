//! Every mistake in a cell file is reported with its place.

use super::*;

#[test]
fn byte_order_mark_and_carriage_returns_leave_the_places_right() {
    let wrong = FULL.replace("magnitude_n = 500", "magnitude = 500");
    for text in [
        wrong.clone(),
        wrong.replace('\n', "\r\n"),
        format!("\u{feff}{wrong}"),
        format!("\u{feff}{}", wrong.replace('\n', "\r\n")),
    ] {
        let error = parse_cell_bytes(text.as_bytes(), "cell.toml").unwrap_err();
        let place = error.place();
        assert_eq!((place.line, place.column), (Some(28), Some(1)));
        assert_eq!(place.key.as_deref(), Some("load.magnitude"));
        let span = place.span.clone().unwrap_or_default();
        assert_eq!(&text[span], "magnitude");
    }
    let first_line = format!("\u{feff}{}", FULL.replace("format = 1", "format = 1, 2"));
    let error = parse_cell(&first_line, "cell.toml").unwrap_err();
    assert_eq!(error.place().column, Some(11), "{error}");
    let marked = format!("\u{feff}{}", FULL.replace('\n', "\r\n"));
    assert_eq!(
        parse_cell(&marked, "a").unwrap(),
        parse_cell(FULL, "b").unwrap()
    );
}

/// Every slip: what is replaced in [`FULL`] by what.
const SLIPS: &[(&str, &str)] = &[
    // Format and syntax.
    ("format = 1\n", ""),
    ("format = 1", "format = 2\nnovelty = true"),
    ("format = 1", "format = 0"),
    ("format = 1", "format = \"1\""),
    ("format = 1", "format = 1.0"),
    ("name = \"full\"", "name = full"),
    ("name = \"full\"", "name = \"full"),
    ("magnitude_n = 500", "magnitude_n = 500,5"),
    ("magnitude_n = 500", "magnitude_n = 500\nmagnitude_n = 600"),
    ("[noise]", "[load]"),
    // Unknown keys.
    ("magnitude_n = 500", "magnitude = 500"),
    (
        "magnitude_n = 500",
        "magnitude_n = 500\nbox_min_mm = [0, 0, 0]",
    ),
    ("[noise]", "[nose]"),
    ("[noise]", "[traker]"),
    ("[noise]", "[sensor]"),
    ("position_mm = [0, 150, 200]", "position_m = [0, 0.15, 0.2]"),
    ("origin_mm", "\"origin mm\""),
    ("q_deg = [12.5, 90]", "q_rad = [0.2, 1.5]"),
    ("name = \"full\"", "name = \"full\"\nmagnitude_n = 3"),
    // Missing keys.
    (FULL, "format = 1\n"),
    (
        FULL,
        "format = 1\n[robot]\ncatalogue = \"comau-nj165-3.0\"\n",
    ),
    ("dh_modified = [[0, 0, 830, 0], [-90, 400, 0, -90]]\n", ""),
    ("loading_point_mm = [200, 0, 250]\n", ""),
    ("position_mm = [0, 150, 200]\n", ""),
    ("name = \"b\"\n", ""),
    ("rotational_nm_per_rad = [3e5, 3e5, 4e5]\n", ""),
    ("kind = \"rope\"\n", ""),
    ("magnitude_n = 500\n", ""),
    ("anchor_mm = [1800, 0, 0]\n", ""),
    ("box_min_mm = [900, -1900, 300]\n", ""),
    ("name = \"V1\"\n", ""),
    ("turn_std_rad_per_nm = 1.4e-7\n", ""),
    ("[elastic]\n", "[elastic]\nshift_m_per_n = 9e-8\n"),
    ("shift_std_m_per_n = 9e-8", "shift_std_m_per_n = -9e-8"),
    ("shift_std_m_per_n = 9e-8", "shift_std_m_per_n = nan"),
    ("shift_std_m_per_n = 9e-8", "shift_std_m_per_n = 90"),
    ("coupling_std_rad_per_n = 0", "coupling_std_rad_per_n = inf"),
    // Values of the wrong kind.
    ("magnitude_n = 500", "magnitude_n = \"500\""),
    ("magnitude_n = 500", "magnitude_n = \"much\""),
    ("magnitude_n = 500", "magnitude_n = true"),
    ("magnitude_n = 500", "magnitude_n = 1979-05-27"),
    ("anchor_mm = [1800, 0, 0]", "anchor_mm = 1800"),
    (
        "position_mm = [0, 150, 200]",
        "position_mm = [0, \"150\", 200]",
    ),
    ("q_deg = [[-90, 90], [-60, 40]]", "q_deg = [-90, 90]"),
    ("name = \"b\"", "name = 2"),
    ("has_sensor = true", "has_sensor = \"yes\""),
    (
        "readings_per_displacement = 2",
        "readings_per_displacement = 1.5",
    ),
    (
        "readings_per_displacement = 2",
        "readings_per_displacement = 99999999999999999999",
    ),
    (
        "[limits]\nbox_min_mm = [900, -1900, 300]",
        "[[limits]]\nbox_min_mm = [900, -1900, 300]",
    ),
    ("[[validation.posture]]", "[validation.posture]"),
    (FULL, "format = 1\nnoise = 3\n"),
    (FULL, "format = 1\nload = [\"rope\", 500]\n"),
    (FULL, "format = 1\ntool.measuring_point = [[\"a\", 1]]\n"),
    // Numbers.
    ("magnitude_n = 500", "magnitude_n = nan"),
    ("anchor_mm = [1800, 0, 0]", "anchor_mm = [1800, -inf, 0]"),
    ("magnitude_n = 500", "magnitude_n = 1e999"),
    ("magnitude_n = 500", "magnitude_n = 1e40"),
    ("magnitude_n = 500", "magnitude_n = -500"),
    ("magnitude_n = 500", "magnitude_n = 0"),
    ("variance_mm2 = 1e-4", "variance_mm2 = -1e-4"),
    ("posture_common_mm = 0.01", "posture_common_mm = -0.01"),
    (
        "readings_per_displacement = 2",
        "readings_per_displacement = 3",
    ),
    (
        "characteristic_length_mm = 500",
        "characteristic_length_mm = 0",
    ),
    (
        "prior_nm_per_rad = [1e6, 3e6]",
        "prior_nm_per_rad = [1e6, 0]",
    ),
    (
        "rotational_nm_per_rad = [3e5, 3e5, 4e5]",
        "rotational_nm_per_rad = [3e5, -3e5, 4e5]",
    ),
    ("down = [0, 0, -2]", "down = [0, 0, 0]"),
    ("keep_out_radius_mm = 900", "keep_out_radius_mm = 0"),
    (
        "rope_length_mm = [800, 3400]",
        "rope_length_mm = [-1, 3400]",
    ),
    // Lengths of lists.
    (
        "loading_point_mm = [200, 0, 250]",
        "loading_point_mm = [200, 250]",
    ),
    ("q_deg = [[-90, 90], [-60, 40]]", "q_deg = [[-90, 90]]"),
    (
        "q_deg = [[-90, 90], [-60, 40]]",
        "q_deg = [[-90, 90], [-60, 0, 40]]",
    ),
    ("q_deg = [12.5, 90]", "q_deg = [12, 5, 90]"),
    ("prior_nm_per_rad = [1e6, 3e6]", "prior_nm_per_rad = [1e6]"),
    (
        "dh_modified = [[0, 0, 830, 0], ",
        "dh_modified = [[0, 0, 830], ",
    ),
    (
        "dh_modified = [[0, 0, 830, 0], [-90, 400, 0, -90]]",
        "dh_modified = []",
    ),
    (
        "theta_from_q = [[-1, 0], [0, 1]]",
        "theta_from_q = [[-1, 0]]",
    ),
    (
        "theta_from_q = [[-1, 0], [0, 1]]",
        "theta_from_q = [[-1, 0], [0]]",
    ),
    ("joint_names = [\"A1\", \"A2\"]", "joint_names = [\"A1\"]"),
    ("down = [0, 0, -2]", "base_rpy_deg = [90]"),
    // Ranges, limits, names.
    (
        "q_deg = [[-90, 90], [-60, 40]]",
        "q_deg = [[90, -90], [-60, 40]]",
    ),
    (
        "q_deg = [[-90, 90], [-60, 40]]",
        "q_deg = [[-90, 90], [-80, 40]]",
    ),
    (
        "q_deg = [[-90, 90], [-60, 40]]",
        "q_deg = [[-90, 171], [-60, 40]]",
    ),
    ("q_deg = [12.5, 90]", "q_deg = [12.5, 95.1]"),
    (
        "limits_deg = [[-170, 170], [-75, 95]]",
        "limits_deg = [[-170, 170], [95, -75]]",
    ),
    (
        "box_max_mm = [3000, 1900, 3000]",
        "box_max_mm = [3000, 1900, 300]",
    ),
    (
        "rope_length_mm = [800, 3400]",
        "rope_length_mm = [3400, 800]",
    ),
    (
        "theta_from_q = [[-1, 0], [0, 1]]",
        "theta_from_q = [[1, 1], [1, 1]]",
    ),
    ("down = [0, 0, -2]", "elastic_from_theta = [[0, 0], [0, 1]]"),
    ("name = \"b\"", "name = \"a\""),
    ("name = \"b\"", "name = \"Base\""),
    ("name = \"b\"", "name = \"base-2\""),
    ("name = \"b\"", "name = \"Base left\""),
    ("name = \"b\"", "name = \" b\""),
    ("name = \"b\"", "name = \"\""),
    ("name = \"b\"", "name = \"b\\nc\""),
    (
        "joint_names = [\"A1\", \"A2\"]",
        "joint_names = [\"A1\", \"A1\"]",
    ),
    // Tasks.
    ("tip_mm = [0, 10, 350]", "tip_m = [0, 0.01, 0.35]"),
    ("tip_mm = [0, 10, 350]", "magnitude_n = 300"),
    ("tip_mm = [0, 10, 350]", "tip_mm = [0, 350]"),
    ("q_deg = [100, -70]\n", ""),
    ("q_deg = [100, -70]", "q_deg = [100, -70, 20]"),
    ("q_deg = [100, -70]", "q_deg = [100, -76]"),
    ("force_n = [300, -150, 0]\n", ""),
    ("force_n = [300, -150, 0]", "force_n = 300"),
    ("force_n = [0, 0, 400]", "force_n = [0, 0, 0]"),
    ("moment_nm = [0, 0, 12]", "moment_nm = [0, 0, nan]"),
    ("axes = \"tool\"", "axes = \"world\""),
    ("name = \"milling\"", "name = \"task 2\""),
    ("name = \"milling\"", "name = \"\""),
    ("[[task]]\nname", "[task]\nname"),
    ("[[task]]\nname", "[[tasks]]\nname"),
    // Sensor, tracker, uncertainty.
    ("mount = \"base\"\n", ""),
    ("mount = \"base\"", "mount = \"flanges\""),
    ("mount = \"base\"", "mount = \"wall\""),
    ("reports = \"by_robot\"\n", ""),
    ("reports = \"by_robot\"", "reports = \"by_the_robot\""),
    ("reports = \"by_robot\"", "reports = -1"),
    ("xyz_mm = [1800, 0, -30]\n", ""),
    ("rpy_deg = [180, 0, 90]\n", ""),
    ("rpy_deg = [180, 0, 90]", "rpy_deg = [180, 90]"),
    ("rpy_deg = [180, 0, 90]", "rpy_rad = [3.14, 0, 1.57]"),
    ("xyz_mm = [3500, -1200, 900]\n", ""),
    ("rpy_deg = [0, 0, 150]\n", ""),
    ("range_um = 10\n", ""),
    ("range_um = 10", "range_um = 0"),
    ("range_um = 10", "range_mm = 0.01"),
    ("range_um_per_m = 0.4", "range_um_per_m = -0.4"),
    ("angle_urad = 3\n", ""),
    ("angle_urad = 3", "angle_urad = nan"),
    ("range_um = 10\nrange_um_per_m = 0.4\nangle_urad = 3\n", ""),
    ("force_scale_percent = 0.5", "force_scale_percent = -0.5"),
    ("force_scale_percent = 0.5", "force_scale = 0.005"),
    (
        "lost_motion_arcmin = 0.2",
        "lost_motion_arcmin = [0.2, 0.3]",
    ),
    (
        "base_tilt_stiffness_nm_per_rad = 1e8",
        "base_tilt_stiffness_nm_per_rad = 0",
    ),
    // Headings of another software.
    ("x_mm = \"Center X\"", "x_cm = \"Center X\""),
    ("x_mm = \"Center X\"", "x = \"Center X\""),
    ("x_mm = \"Center X\"", "postrue = \"Center X\""),
    ("x_mm = \"Center X\"", "q3_deg = \"A3\""),
    ("x_mm = \"Center X\"", "temperature = \"T\""),
    ("x_mm = \"Center X\"", "x_mm = \"\""),
    ("x_mm = \"Center X\"", "x_mm = \"name\""),
    ("x_mm = \"Center X\"", "x_mm = \"Comment\""),
    ("x_mm = \"Center X\"", "x_mm = 3"),
    ("x_mm = \"Center X\"", "x_mm = [\"Center X\"]"),
    ("x_mm = \"Center X\"", "x_mm = \"Center X\"\nX_mm = \"X\""),
    (
        "ignore = [\"Comment\", \"Target type\"]",
        "ignore = \"Comment\"",
    ),
    (
        "ignore = [\"Comment\", \"Target type\"]",
        "ignore = [\"Comment\", 3]",
    ),
    (
        "ignore = [\"Comment\", \"Target type\"]",
        "ignore = [\"Comment\", \"comment\"]",
    ),
    (
        "ignore = [\"Comment\", \"Target type\"]",
        "ignored = [\"Comment\"]",
    ),
    (FULL, "format = 1\ncolumns = [\"x_mm\"]\n"),
    // Contradictions.
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]\n[limits]\nbox_min_mm = [900, -1900, 300]\n\
         box_max_mm = [3000, 1900, 3000]\nfloor_mm = 10\nkeep_out_radius_mm = 900\nwrist_height_mm = 300\n\
         rope_length_mm = [800, 3400]",
        "kind = \"weight\"\nmagnitude_n = 500",
    ),
    ("[robot]", "[robot]\ncatalogue = \"comau-nj165-3.0\""),
    ("name = \"two joints\"", "dh_standard = [[0, 0, 830, 0]]"),
    (
        "dh_modified = [[0, 0, 830, 0], [-90, 400, 0, -90]]",
        "catalogue = \"comau\"",
    ),
    (
        "down = [0, 0, -2]",
        "base_z_mm = 500\nbase_xyz_mm = [0, 0, 500]",
    ),
    ("kind = \"rope\"", "kind = \"ropes\""),
    ("kind = \"rope\"", "kind = \"gravitation\""),
    ("kind = \"rope\"", "kind = \"weight\""),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"measured\"\nforce_n = [1, 0, 0]",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"measured\"",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"wrench\"\naxes = \"base\"",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"wrench\"\nforce_n = [1, 0, 0]",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"wrench\"\nforce_n = [1, 0, 0]\naxes = \"world\"",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"wrench\"\nforce_n = [0, 0, 0]\naxes = \"base\"",
    ),
    // The displacement under the load.
    ("rope_length_mm = [800, 3400]", "displacement_mm = [3, 0.2]"),
    (
        "rope_length_mm = [800, 3400]",
        "displacement_mm = [-0.2, 3]",
    ),
    ("rope_length_mm = [800, 3400]", "displacement_mm = 3"),
    (
        "rope_length_mm = [800, 3400]",
        "displacement_m = [2e-4, 3e-3]",
    ),
    // A cylinder.
    ("kind = \"rope\"", "kind = \"rope\"\nacts = \"pushes\""),
    ("kind = \"rope\"", "kind = \"cylinder\""),
    ("kind = \"rope\"", "kind = \"cylinder\"\nacts = \"push\""),
    ("kind = \"rope\"", "kind = \"cylinder\"\nacts = \"twists\""),
    ("kind = \"rope\"", "kind = \"cylinder\"\nacts = 1"),
    (
        "kind = \"rope\"\nmagnitude_n = 500",
        "kind = \"cylinder\"\nacts = \"pushes\"\nmagnitude_n = -500",
    ),
    (
        "kind = \"rope\"",
        "kind = \"cylinder\"\nacts = \"pushes\"\ndirection = [0, 0, 1]",
    ),
    (
        "kind = \"rope\"",
        "kind = \"cylinder\"\nacts = \"pushes\"\naxes = \"base\"",
    ),
    (
        "kind = \"rope\"",
        "kind = \"cylinder\"\nacts = \"pushes\"\nmass_kg = 3",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"cylinder\"\nacts = \"pushes\"\nmagnitude_n = 500",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"cylinder\"\nacts = \"pushes\"\nmagnitude_n = 500\ndirection = [0, 0, 0]\naxes = \"base\"",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"cylinder\"\nacts = \"pushes\"\nmagnitude_n = 500\ndirection = [0, 0, 1]",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"cylinder\"\nacts = \"pushes\"\nmagnitude_n = 500\ndirection = [0, 0, 1]\naxes = \"world\"",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"cylinder\"\nacts = \"pushes\"\nmagnitude_n = 500\ndirection = [0, 0, 1]\naxes = \"tool\"",
    ),
];

#[test]
fn every_slip_is_reported_with_its_place() {
    let mut report = String::new();
    for (from, to) in SLIPS {
        assert!(FULL.contains(from), "{from}");
        let text = FULL.replacen(from, to, 1);
        let error = match parse_cell(&text, "cell.toml") {
            Ok(_) => panic!("accepted: {to}"),
            Err(error) => error,
        };
        let shown = if to.is_empty() {
            format!("without {}", from.trim_end())
        } else {
            to.trim_end().replace('\n', "; ")
        };
        report += &format!("» {shown}\n[{}] {error}\n\n", error.code().as_str());
    }
    insta::assert_snapshot!("cell_slips", report);
}

#[test]
fn numbers_too_large_and_too_small_are_said_shortly() {
    let error = |to: &str| {
        let text = FULL.replacen("magnitude_n = 500", to, 1);
        parse_cell(&text, "cell.toml").unwrap_err().to_string()
    };
    let large = error("magnitude_n = 99999999999999999999");
    assert!(large.contains("too large to be read"), "{large}");
    let small = error("magnitude_n = 1e-320");
    assert!(small.contains("1e-320 is too small to be meant"), "{small}");
    // Where zero is a number as any other, it is that.
    let text = FULL.replacen(
        "anchor_mm = [1800, 0, 0]",
        "anchor_mm = [1800, 1e-320, 0]",
        1,
    );
    assert_ne!(text, FULL);
    assert_eq!(
        parse_cell(&text, "a").unwrap(),
        parse_cell(FULL, "b").unwrap()
    );
}

#[test]
fn a_tool_in_metres_is_told_where_a_shape_swallows_it() {
    let mut text = stiffarm::files::builtin::cell_text("comau-shapes")
        .unwrap()
        .to_string();
    for (mm, m) in [
        ("[150, 0, 200]", "[0.15, 0, 0.2]"),
        ("[0, 150, 200]", "[0, 0.15, 0.2]"),
        ("[-150, 0, 200]", "[-0.15, 0, 0.2]"),
        ("[0, -150, 200]", "[0, -0.15, 0.2]"),
    ] {
        assert!(text.contains(mm));
        text = text.replacen(mm, m, 1);
    }
    let error = parse_cell(&text, "cell.toml").unwrap_err();
    assert!(error.message().contains("inside \"spindle\""), "{error}");
    let hint = error.hint_text().unwrap();
    assert_eq!(
        hint,
        "the point lies 0.250 mm from the flange: is it in metres? The unit is mm."
    );
}

#[test]
fn bytes_that_are_not_utf8() {
    let mut report = String::new();
    for bytes in [
        &b"format = 1\nname = \"Pr\xfcfstand\"\n"[..],
        b"\xff\xfef\0o\0\x00\xdc",
    ] {
        let error = parse_cell_bytes(bytes, "cell.toml").unwrap_err();
        report += &format!("[{}] {error}\n\n", error.code().as_str());
    }
    insta::assert_snapshot!("cell_encoding", report);
}
