//! Shapes of kind "mesh": the solids of the cell contain the mesh where the keys put it.

use super::*;
use crate::common::random::Dice;
use nalgebra::{Rotation3, Vector3};
use stiffarm::model::shape::Solid;
use stiffarm_files::cell::parse_cell_with;

/// A ragged surface as OBJ in mm, and its corners.
fn mesh() -> (String, Vec<Vector3<f64>>) {
    let mut dice = Dice::new(5);
    let corners: Vec<Vector3<f64>> = (0..40)
        .map(|_| {
            let mut within = |half: f64| dice.between(-half, half);
            Vector3::new(within(300.0), within(200.0), 150.0 + within(100.0)).map(f64::round)
        })
        .collect();
    let mut text = String::new();
    for c in &corners {
        text += &format!("v {} {} {}\n", c.x, c.y, c.z);
    }
    for i in 1..corners.len() - 1 {
        text += &format!("f {i} {} {}\n", i + 1, i + 2);
    }
    (text, corners)
}

fn inside(solid: &Solid, point: &Vector3<f64>) -> bool {
    match solid {
        Solid::Capsule(capsule) => capsule.distance_to(point) < 1e-9,
        Solid::Block { pose, half } => {
            let local = pose.inverse_transform_point(&(*point).into());
            local.coords.abs().zip_map(half, |v, h| v - h).max() < 1e-9
        }
        other => panic!("{other:?}"),
    }
}

const SHAPE: &str = "kind = \"mesh\"\nfile = \"parts/plate.obj\"\nunit = \"mm\"\n\
                     xyz_mm = [100, -200, 300]\nrpy_deg = [20, -30, 40]\n";

#[test]
fn solids_contain_the_mesh_where_it_is_placed() -> Check {
    let (text, corners) = mesh();
    let cell = format!("{FULL}\n[[obstacle]]\nname = \"plate\"\n{SHAPE}\n[[tool.shape]]\nname = \"gripper\"\n{SHAPE}");
    let read = |file: &str| {
        assert_eq!(file, "parts/plate.obj");
        Ok(text.clone().into_bytes())
    };
    let cell = parse_cell_with(&cell, "cell.toml", &read)?;
    let [roll, pitch, yaw] = [20.0_f64, -30.0, 40.0].map(f64::to_radians);
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw)
        * Rotation3::from_axis_angle(&Vector3::y_axis(), pitch)
        * Rotation3::from_axis_angle(&Vector3::x_axis(), roll);
    let part = |name: &str| {
        let part = cell.scene.parts().iter().find(|part| part.name == name);
        part.unwrap_or_else(|| panic!("{name}"))
    };
    for (name, most) in [("plate", 24), ("gripper", 4)] {
        let solids = &part(name).solids;
        assert!((1..=most).contains(&solids.len()), "{name}: {}", solids.len());
        // Corners, and points between those of a triangle.
        for triangle in corners.windows(3) {
            let middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
            for p in [triangle[0], triangle[1], triangle[2], middle] {
                let at = (turn * p + Vector3::new(100.0, -200.0, 300.0)) * 1e-3;
                assert!(solids.iter().any(|s| inside(s, &at)), "{name}: {at}");
            }
        }
    }
    assert!(part("gripper").solids.iter().all(|s| matches!(s, Solid::Capsule(_))));
    Ok(())
}

#[test]
fn the_text_alone_is_not_enough() {
    let text = format!("{FULL}\n[[obstacle]]\nname = \"plate\"\n{SHAPE}");
    let error = parse_cell(&text, "cell.toml").unwrap_err();
    insta::assert_snapshot!(error, @"
    cell.toml:111:8: obstacle[1].file: parts/plate.obj: Only the text of the cell is read here, not the files that it names.
      hint: read it with `parse_cell_with`, or give capsules instead: `stiffarm capsules`
    ");
}
