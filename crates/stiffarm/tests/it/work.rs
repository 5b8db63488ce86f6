//! `[work]` of the cell file: each slip is named with its place, and what may be left out may be.

use crate::common::cases::{shown, slip};
use crate::common::prelude::*;
use stiffarm::model::process::Process;

type Check = Result<(), Box<dyn std::error::Error>>;

const CELL: &str = "\
format = 1
[robot]
catalogue = \"comau-nj165-3.0\"
[tool]
loading_point_mm = [200, 0, 250]
[[tool.measuring_point]]
name = \"1\"
position_mm = [150, 0, 200]
[load]
kind = \"measured\"
";

const FORCE: &str = "\
[work]
tip_mm = [0, 0, 350]
[work.force]
force_n = [-200, 150, 100]
axes = \"path\"
";

const MILLING: &str = "\
[work]
workpiece_mm = [1500, 0, 600]
[work.milling]
teeth = 2
diameter_mm = 16
axial_depth_mm = 3
radial_depth_mm = 8
feed_per_tooth_mm = 0.1
direction = \"down\"
k_tc_n_per_mm2 = 800
k_rc_n_per_mm2 = 200
";

#[test]
fn what_may_be_left_out_of_the_work() -> Check {
    let cell = parse_cell(&format!("{CELL}{FORCE}"), "cell.toml")?;
    let tool = &cell.setup.tool;
    assert_eq!(cell.work.tip(tool), Isometry3::translation(0.0, 0.0, 0.35));
    assert_eq!(cell.work.workpiece, Isometry3::identity());
    let Some(Process::Constant(load, None)) = cell.work.process else {
        panic!("a constant load");
    };
    assert_eq!(load.force.as_slice(), [-200.0, 150.0, 100.0]);
    assert_eq!(load.moment, Vector3::zeros());
    assert_eq!(load.axes, ForceAxes::Path);

    let cell = parse_cell(&format!("{CELL}{MILLING}"), "cell.toml")?;
    assert_eq!(cell.work.tip, None);
    assert_eq!(cell.work.workpiece, Isometry3::translation(1.5, 0.0, 0.6));
    let Some(Process::Milling(milling)) = cell.work.process else {
        panic!("milling");
    };
    let k = milling.coefficients;
    assert_eq!((k.k_ac, k.k_te, k.k_re, k.k_ae), (0.0, 0.0, 0.0, 0.0));

    // Only turned: the tip stays at the TCP, the workpiece at the base.
    let turned = "[work]\ntip_rpy_deg = [0, 90, 0]\nworkpiece_rpy_deg = [0, 0, 90]\n";
    let cell = parse_cell(&format!("{CELL}{turned}"), "cell.toml")?;
    let tip = cell.work.tip(&cell.setup.tool);
    assert_eq!(tip.translation.vector, cell.setup.tool.tcp());
    assert!((tip.rotation * Vector3::z() - Vector3::x()).norm() < 1e-15);
    assert_eq!(cell.work.workpiece.translation.vector, Vector3::zeros());
    assert_eq!(cell.work.process, None);

    for (word, axes) in ForceAxes::NAMES {
        let text = format!("{CELL}{FORCE}").replace("path", word);
        let load = parse_cell(&text, "cell.toml")?.work.process.ok_or("none")?;
        assert_eq!(load.load().load.axes, axes);
    }
    Ok(())
}

/// What is replaced in which text by what.
const SLIPS: &[(&str, &str, &str)] = &[
    // Forces.
    (FORCE, "axes = \"path\"\n", ""),
    (FORCE, "axes = \"path\"", "axes = \"bsae\""),
    (FORCE, "axes = \"path\"", "axes = \"world\""),
    (FORCE, "axes = \"path\"", "axes = 3"),
    (FORCE, "force_n = [-200, 150, 100]\n", ""),
    (FORCE, "[-200, 150, 100]", "[0, 0, 0]"),
    (FORCE, "[-200, 150, 100]", "[-200, 150]"),
    (FORCE, "[-200, 150, 100]", "[-200, nan, 100]"),
    (FORCE, "force_n", "force_kn"),
    (FORCE, "[work.force]\n", ""),
    (FORCE, "[work.force]", "force = 500\n[work.forces]"),
    (FORCE, "tip_mm = [0, 0, 350]", "tip_mm = 350"),
    (FORCE, "tip_mm = [0, 0, 350]", "tip_m = [0, 0, 0.35]"),
    (FORCE, "tip_mm = [0, 0, 350]", "tip_rpy_deg = [0, 0]"),
    (FORCE, "tip_mm = [0, 0, 350]", "workpeice_mm = [0, 0, 350]"),
    (FORCE, "axes = \"path\"\n", "axes = \"path\"\n[work.milling]\nteeth = 2\n"),
    // Features.
    (FORCE, "[work.force]", "feature = [{ name = 'A' }]\n[work.force]"),
    (FORCE, "[work.force]", "[[work.feature]]\ntolerance_mm = 0.1\n[work.force]"),
    (FORCE, "[work.force]", "[[work.feature]]\nname = 'A'\ntolerance_mm = 0\n[work.force]"),
    (
        FORCE,
        "[work.force]",
        "feature = [{ name = 'A', tolerance_mm = 1 }, { name = 'A', tolerance_mm = 2 }]\n[work.force]",
    ),
    (FORCE, "[work.force]", "[[work.feature]]\nname = 'A'\n[work.feature.force]\nforce_n = [1, 2, 3]\n[work.force]"),
    (
        FORCE,
        "[work.force]",
        "[[work.feature]]\nname = 'A'\nforce = { force_n = [1, 2, 3], axes = 'tool' }\nmilling = { teeth = 2 }\n[work.force]",
    ),
    // Milling.
    (MILLING, "teeth = 2\n", ""),
    (MILLING, "teeth = 2", "teeth = 0"),
    (MILLING, "teeth = 2", "teeth = 2.5"),
    (MILLING, "diameter_mm = 16", "diameter_mm = -16"),
    (MILLING, "diameter_mm", "diameter"),
    (MILLING, "axial_depth_mm = 3", "axial_depth_mm = 0"),
    (MILLING, "axial_depth_mm = 3\n", ""),
    (MILLING, "radial_depth_mm = 8", "radial_depth_mm = 16.5"),
    (MILLING, "radial_depth_mm = 8\n", ""),
    (MILLING, "feed_per_tooth_mm = 0.1", "feed_per_tooth_mm = 0.0001"),
    (MILLING, "feed_per_tooth_mm = 0.1", "feed_per_tooth_mm = 100"),
    (
        MILLING,
        "diameter_mm = 16\naxial_depth_mm = 3\nradial_depth_mm = 8\nfeed_per_tooth_mm = 0.1",
        "diameter_mm = 1\naxial_depth_mm = 3\nradial_depth_mm = 0.5\nfeed_per_tooth_mm = 0.6",
    ),
    (MILLING, "feed_per_tooth_mm = 0.1", "feed_per_tooth_m = 0.0001"),
    (MILLING, "feed_per_tooth_mm = 0.1\n", ""),
    (MILLING, "direction = \"down\"\n", ""),
    (MILLING, "direction = \"down\"", "direction = \"climb\""),
    (MILLING, "direction = \"down\"", "direction = \"dwon\""),
    (MILLING, "k_tc_n_per_mm2 = 800\n", ""),
    (MILLING, "k_tc_n_per_mm2 = 800", "k_tc_n_per_mm2 = 800e6"),
    (MILLING, "k_tc_n_per_mm2 = 800", "k_tc_n_per_mm2 = 0"),
    (MILLING, "k_rc_n_per_mm2 = 200\n", ""),
    (MILLING, "k_rc_n_per_mm2 = 200", "k_rc_n_per_mm2 = inf"),
    (MILLING, "k_rc_n_per_mm2 = 200", "k_rc_n_per_mm2 = 200\nk_te_n_per_mm = -20"),
    (MILLING, "k_rc_n_per_mm2", "k_rc"),
];

#[test]
fn every_slip_in_the_work_is_reported_with_its_place() {
    let mut report = String::new();
    for (text, from, to) in SLIPS {
        assert!(text.contains(from), "{from}");
        let text = CELL.to_string() + &text.replacen(from, to, 1);
        report += &slip(&shown(from, to), parse_cell(&text, "cell.toml"));
    }
    insta::assert_snapshot!("work_slips", report);
}
