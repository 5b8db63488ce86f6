//! Tilts and the flange of a robot of rows stand where its rows say.

use super::*;
use crate::common::cases::refusals;
use nalgebra::{Isometry3, Matrix4, Translation3, UnitQuaternion, Vector3};
use stiffarm::Code;
use stiffarm::model::kinematics::Frames;

/// A cell of two rows with `keys` in `[robot]`.
fn with_keys(keys: &str) -> stiffarm::Result<Cell> {
    let text = format!(
        "format = 1\n[robot]\n{keys}\n[tool]\nloading_point_mm = [0, 0, 0]\n\
         [[tool.measuring_point]]\nname = '1'\nposition_mm = [0, 0, 0]\n\
         [load]\nkind = 'weight'\nmagnitude_n = 5\n"
    );
    parse_cell(&text, "cell.toml")
}

const ROWS: &str = "dh_modified = [[0, 100, 200, 10], [5, 300, 400, 20]]";

#[test]
fn tilts_and_the_flange_stand_where_their_rows_say() -> Check {
    let keys = "tilts_deg = [0, 7]\nflange_xyz_mm = [10, 20, 30]\nflange_rpy_deg = [40, 50, 60]";
    let robot = with_keys(&format!("{ROWS}\n{keys}"))?.setup.robot;
    let about = |axis, degrees: f64| {
        let turn = UnitQuaternion::from_axis_angle(&axis, degrees.to_radians());
        Isometry3::from_parts(Translation3::identity(), turn)
    };
    let shift = |x, y, z| Isometry3::translation(x, y, z);
    let (x, y, z) = (Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis());
    let expected = shift(0.1, 0.0, 0.0)
        * about(z, 10.0 + 11.0)
        * shift(0.0, 0.0, 0.2)
        * about(x, 5.0)
        * shift(0.3, 0.0, 0.0)
        * about(y, 7.0)
        * about(z, 20.0 + 12.0)
        * shift(0.0, 0.0, 0.4)
        * shift(0.01, 0.02, 0.03)
        * about(z, 60.0)
        * about(y, 50.0)
        * about(x, 40.0);
    let q = [11.0_f64.to_radians(), 12.0_f64.to_radians()];
    let flange: Matrix4<f64> = Frames::new(&robot, &q).flange().to_homogeneous();
    assert!((flange - expected.to_homogeneous()).amax() < 1e-15);
    Ok(())
}

#[test]
fn tilts_need_rows_and_one_number_each() {
    let standard = ROWS.replace("modified", "standard");
    let rows = [
        ("one tilt of two", Code::Dimension, with_keys(&format!("{ROWS}\ntilts_deg = [1]"))),
        ("a tilt that is no number", Code::NotFinite, with_keys(&format!("{ROWS}\ntilts_deg = [0, nan]"))),
        ("tilts of standard rows", Code::Conflict, with_keys(&format!("{standard}\ntilts_deg = [0, 0]"))),
        ("tilts without rows", Code::Conflict, with_keys("catalogue = 'ur5e'\ntilts_deg = [0]")),
        ("two angles of a flange", Code::Dimension, with_keys(&format!("{ROWS}\nflange_rpy_deg = [1, 2]"))),
    ];
    insta::assert_snapshot!("slips_in_tilts", refusals(rows));
}
