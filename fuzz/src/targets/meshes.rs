//! Meshes: STL, OBJ and COLLADA.

use super::Verdict;
use super::readers::bytes;
use crate::input::Input;
use crate::mutate::{Grammar, mutate, mutate_bytes};
use crate::oracle::{error_is_sound, is_finite};
use crate::random::Random;
use stiffarm::model::shape::capsules_of_mesh;
use stiffarm_files::builtin;
use stiffarm_files::mesh::parse_mesh;

const COLLADA: &str = r##"<COLLADA><asset><unit meter="0.01"/></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array>
<technique_common><accessor source="#a" count="4" stride="3"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 0 2 3</p></triangles>
<polylist count="1"><input semantic="VERTEX" source="#v" offset="1"/><vcount>4</vcount><p>0 0 0 1 0 2 0 3</p></polylist>
</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node id="n"><rotate>0 0 1 90</rotate>
<node><translate>1 0 0</translate><scale>2 1 1</scale><instance_geometry url="#g"/></node></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"##;

/// The kinds that a name may say.
const NAMES: [&str; 3] = ["input.stl", "input.obj", "input.dae"];

fn corners() -> [[f32; 3]; 6] {
    let (o, x, y, z) = ([0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.7, 0.0], [0.0, 0.0, 0.4]);
    [o, x, y, o, y, z]
}

fn text_stl() -> String {
    let mut text = "solid a\n".to_string();
    for triangle in corners().chunks(3) {
        text += "facet normal 0 0 1\nouter loop\n";
        for [x, y, z] in triangle {
            text += &format!("vertex {x} {y} {z}\n");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid a\n"
}

fn binary_stl() -> Vec<u8> {
    let mut out = vec![0; 80];
    out.extend(2_u32.to_le_bytes());
    for triangle in corners().chunks(3) {
        out.extend([0; 12]);
        let values = triangle.iter().flatten();
        out.extend(values.flat_map(|v| v.to_le_bytes()));
        out.extend([0; 2]);
    }
    out
}

/// A mesh with other bytes, numbers or lines.
pub fn make(random: &mut Random) -> Input {
    let obj = builtin::mesh_text("spindle.obj").unwrap_or_default();
    let text = match random.below(4) {
        0 => return Input::File(mutate_bytes(&binary_stl(), random)),
        1 => text_stl(),
        2 => obj.to_string(),
        _ => COLLADA.to_string(),
    };
    Input::File(if random.one_in(2) {
        mutate_bytes(text.as_bytes(), random)
    } else {
        mutate(text.as_bytes(), Grammar::Table, random)
    })
}

/// Every kind takes it or says why not, and a mesh of millimetres has capsules around it.
pub fn check(input: &Input) -> Verdict {
    let mut accepted = false;
    for name in NAMES {
        match parse_mesh(bytes(input), name, 1e-3) {
            Ok(mesh) => {
                accepted = true;
                is_finite(&mesh)?;
                let count = mesh.vertices.len();
                if mesh.triangles.iter().flatten().any(|v| *v >= count) {
                    return Err("a corner that the mesh has not".to_string());
                }
                let capsules = capsules_of_mesh(&mesh, 1);
                is_finite(&capsules)?;
                let holds = |p| capsules.iter().any(|c| c.distance_to(p) <= 0.0);
                // Far out, coordinates have too few digits.
                let meant = mesh.vertices.iter().all(|v| v.amax() < 1e3);
                if meant && !mesh.vertices.iter().all(holds) {
                    return Err("a corner is in no capsule".to_string());
                }
            }
            Err(error) => error_is_sound(&error)?,
        }
    }
    Ok(accepted)
}
