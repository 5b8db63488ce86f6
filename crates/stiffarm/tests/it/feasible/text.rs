//! A random cell as the text of a `cell.toml`.

use super::cases::{Case, Pull};
use super::distance::Shape;
use std::fmt::Write;

impl Case {
    /// The text.
    pub fn text(&self) -> String {
        let mut out = String::from("format = 1\nname = \"random\"\n\n[robot]\n");
        let mut line = |text: String| writeln!(out, "{text}").unwrap();
        let reach = 1e3 * self.arm.reach;
        line(format!("catalogue = \"{}\"", self.arm.key));
        line(format!("characteristic_length_mm = {}", (0.3 * reach).round()));
        if let Some((at, turns)) = &self.mount {
            line(format!("base_xyz_mm = {at:?}\nbase_rpy_deg = {turns:?}"));
        }
        if let Some(torques) = &self.torques {
            line(format!("torque_limits_nm = {:?}", torques.largest));
        }
        if self.own_capsules {
            for (link, shape) in &self.arm.capsules {
                // Its kind goes without saying.
                let keys = keys(shape).replace("kind = \"capsule\"\n", "");
                line(format!("[[robot.shape]]\nlink = {link}\n{keys}"));
            }
        }
        line(format!("[bounds]\nq_deg = {:?}", self.bounds));
        line(format!("[tool]\nloading_point_mm = {:?}\nhas_sensor = false", self.loading));
        if let Some((mass, centre)) = self.torques.as_ref().and_then(|t| t.mass) {
            line(format!("mass_kg = {mass}\ncentre_of_mass_mm = {centre:?}"));
        }
        for (i, point) in self.points.iter().enumerate() {
            line(format!("[[tool.measuring_point]]\nname = \"{}\"", i + 1));
            line(format!("position_mm = {:?}", point.position));
            if let Some((axis, acceptance)) = &point.facing {
                line(format!("axis = {axis:?}"));
                if let Some(angle) = acceptance {
                    line(format!("acceptance_deg = {angle}"));
                }
            }
        }
        for (table, shapes) in [("tool.shape", &self.tool), ("obstacle", &self.obstacles)] {
            for (name, shape) in shapes {
                line(format!("[[{table}]]\nname = \"{name}\"\n{}", keys(shape)));
            }
        }
        for (i, station) in self.stations.iter().enumerate() {
            line(format!("[[tracker.station]]\nname = \"S{i}\"\nposition_mm = {station:?}"));
        }
        line("[load]".to_string());
        let several = self.loads.len() > 1;
        if several {
            line("kind = \"cases\"".to_string());
        }
        for (number, load) in self.loads.iter().enumerate() {
            if several {
                line(format!("[[load.case]]\nname = \"L{number}\""));
            }
            line(pull(&load.pull));
            if let Some(at) = load.at {
                line(format!("loading_point_mm = {at:?}"));
            }
        }
        let optional =
            |name: &str, value: Option<String>| value.map_or(String::new(), |value| format!("{name} = {value}\n"));
        let limits = &self.limits;
        let corner = |i: usize| limits.corners.map(|c| format!("{:?}", c[i]));
        line(format!(
            "[limits]\n{}{}{}{}{}{}",
            optional("box_min_mm", corner(0)),
            optional("box_max_mm", corner(1)),
            optional("floor_mm", limits.floor.map(|v| v.to_string())),
            optional("keep_out_radius_mm", limits.keep_out.map(|v| v.to_string())),
            optional("wrist_height_mm", limits.wrist.map(|v| v.to_string())),
            optional("rope_length_mm", limits.rope.map(|v| format!("{v:?}"))),
        ));
        let clearance = &self.clearance;
        let ignore = (!clearance.ignore.is_empty()).then(|| format!("{:?}", clearance.ignore));
        line(format!(
            "[clearance]\n{}{}{}{}{}{}{}{}",
            optional("shapes_mm", clearance.shapes.map(|v| v.to_string())),
            optional("rope_mm", clearance.rope.map(|v| v.to_string())),
            optional("rope_free_mm", clearance.free.map(|v| format!("{v:?}"))),
            optional("rope_axis", clearance.cone.map(|c| format!("{:?}", c.0))),
            optional("rope_cone_deg", clearance.cone.map(|c| c.1.to_string())),
            optional("sight_mm", clearance.sight.map(|v| v.to_string())),
            optional("visible_points", clearance.visible.map(|v| v.to_string())),
            optional("ignore", ignore),
        ));
        line("[stiffness]\nprior_nm_per_rad = [9e5, 2e6, 8e5, 3e5, 2e5, 1e5]".to_string());
        line(format!("[[task]]\nname = \"cut\"\nq_deg = {:?}\nforce_n = [40, -90, 60]", self.task));
        out
    }
}

fn keys(shape: &Shape) -> String {
    match shape {
        Shape::Box { center, size, rpy } => {
            format!("kind = \"box\"\ncenter_mm = {center:?}\nsize_mm = {size:?}\nrpy_deg = {rpy:?}\n")
        }
        Shape::Cylinder { from, to, radius } => {
            format!("kind = \"cylinder\"\nfrom_mm = {from:?}\nto_mm = {to:?}\nradius_mm = {radius}\n")
        }
        Shape::Capsule { from, to, radius } => {
            format!("kind = \"capsule\"\nfrom_mm = {from:?}\nto_mm = {to:?}\nradius_mm = {radius}\n")
        }
        Shape::Floor(z) => format!("kind = \"floor\"\nz_mm = {z}\n"),
        Shape::Ceiling(z) => format!("kind = \"ceiling\"\nz_mm = {z}\n"),
        Shape::Wall { point, normal } => {
            format!("kind = \"wall\"\npoint_mm = {point:?}\nnormal = {normal:?}\n")
        }
    }
}

fn pull(pull: &Pull) -> String {
    match pull {
        Pull::Rope { anchor, magnitude } => {
            let (kind, size) = if *magnitude < 0.0 {
                ("\"cylinder\"\nacts = \"pushes\"", -magnitude)
            } else {
                ("\"rope\"", *magnitude)
            };
            format!("kind = {kind}\nmagnitude_n = {size}\nanchor_mm = {anchor:?}")
        }
        Pull::Weight { magnitude } => format!("kind = \"weight\"\nmagnitude_n = {magnitude}"),
        Pull::Wrench { force, moment } => {
            format!("kind = \"wrench\"\nforce_n = {force:?}\nmoment_nm = {moment:?}\naxes = \"base\"")
        }
    }
}
