//! Triangles of a COLLADA file.
//!
//! mesh-loader 0.1 reads this format, too, but places parts wrongly where nodes lie in turned nodes,
//! and a part that is placed twice only once; capsules around that would not contain the mesh.

use nalgebra::{Matrix4, Rotation3, Unit, Vector3};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashMap;

/// Nodes within nodes; more are taken for a circle.
const DEEPEST: usize = 100;
/// Triangles of all parts together.
const MOST_TRIANGLES: usize = 20_000_000;

/// Corners of each triangle in the frame of the scene \[m\]. Which axis the file calls up is left aside, as in robot
/// descriptions.
///
/// # Errors
/// What cannot be read, in words that follow "cannot be read:".
pub(super) fn triangles(bytes: &[u8]) -> Result<Vec<[Vector3<f64>; 3]>, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "it is not UTF-8".to_string())?;
    let options = ParsingOptions { allow_dtd: false, ..Default::default() };
    let text = text.trim_start_matches('\u{feff}');
    let document = Document::parse_with_options(text, options).map_err(|e| e.to_string())?;
    if document.root_element().tag_name().name() != "COLLADA" {
        return Err("it has no element COLLADA".to_string());
    }
    let mut scene = Scene { ids: HashMap::new(), parts: HashMap::new(), out: Vec::new() };
    for node in document.descendants() {
        if let Some(id) = node.attribute("id") {
            scene.ids.insert(id, node);
        }
    }
    let unit = document.descendants().find(|n| n.has_tag_name_of("unit")).and_then(|n| n.attribute("meter"));
    let unit: f64 = unit.map_or(Ok(1.0), |text| text.trim().parse().map_err(|_| format!("its unit is \"{text}\"")))?;
    if !(unit.is_finite() && unit > 0.0) {
        return Err("its unit is not above zero".to_string());
    }
    let shown = document.descendants().find(|n| n.has_tag_name_of("instance_visual_scene"));
    let shown = match shown {
        Some(instance) => Some(scene.target(instance)?),
        None => document.descendants().find(|n| n.has_tag_name_of("visual_scene")),
    };
    let frame = Matrix4::new_scaling(unit);
    match shown {
        Some(root) => scene.place(root, &frame, 0)?,
        None => {
            let parts = document.descendants();
            for part in parts.filter(|n| n.has_tag_name_of("geometry")) {
                scene.add(part, &frame)?;
            }
        }
    }
    Ok(scene.out)
}

trait Tag {
    fn has_tag_name_of(&self, name: &str) -> bool;
}

impl Tag for Node<'_, '_> {
    /// Whatever the name space.
    fn has_tag_name_of(&self, name: &str) -> bool {
        self.is_element() && self.tag_name().name() == name
    }
}

struct Scene<'a, 'i> {
    ids: HashMap<&'a str, Node<'a, 'i>>,
    /// Triangles of each part, in its own frame.
    parts: HashMap<roxmltree::NodeId, Vec<[Vector3<f64>; 3]>>,
    out: Vec<[Vector3<f64>; 3]>,
}

fn numbers(node: Node<'_, '_>) -> Result<Vec<f64>, String> {
    let words = node.text().unwrap_or_default().split_ascii_whitespace();
    words.map(|word| word.parse().map_err(|_| format!("\"{word}\" is not a number"))).collect()
}

fn exactly<const N: usize>(node: Node<'_, '_>) -> Result<[f64; N], String> {
    let values = numbers(node)?;
    let count = values.len();
    values.try_into().map_err(|_| format!("{} has {count} numbers instead of {N}", node.tag_name().name()))
}

fn children<'a, 'i: 'a>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |n| n.has_tag_name_of(name))
}

impl<'a, 'i: 'a> Scene<'a, 'i> {
    /// What an attribute such as url="#part" means.
    fn named(&self, node: Node<'a, 'i>, attribute: &str) -> Result<Node<'a, 'i>, String> {
        let name = node.attribute(attribute).unwrap_or_default();
        let target = name.strip_prefix('#').and_then(|id| self.ids.get(id));
        target.copied().ok_or_else(|| format!("there is no \"{name}\" in it"))
    }

    fn target(&self, node: Node<'a, 'i>) -> Result<Node<'a, 'i>, String> {
        self.named(node, "url")
    }

    /// Adds what is in a node, whose parent's frame is `frame`.
    fn place(&mut self, node: Node<'a, 'i>, frame: &Matrix4<f64>, depth: usize) -> Result<(), String> {
        if depth > DEEPEST {
            return Err("its nodes are in a circle".to_string());
        }
        let mut node_frame = *frame;
        for child in node.children().filter(Node::is_element) {
            match child.tag_name().name() {
                "matrix" => node_frame *= Matrix4::from_row_slice(&exactly::<16>(child)?),
                "translate" => node_frame *= Matrix4::new_translation(&exactly::<3>(child)?.into()),
                "scale" => node_frame *= Matrix4::new_nonuniform_scaling(&exactly::<3>(child)?.into()),
                "rotate" => {
                    let [x, y, z, deg] = exactly::<4>(child)?;
                    // About no axis nothing turns.
                    if let Some(axis) = Unit::try_new(Vector3::new(x, y, z), 1e-12) {
                        let turn = Rotation3::from_axis_angle(&axis, stiffarm::units::deg_to_rad(deg));
                        node_frame *= turn.to_homogeneous();
                    }
                }
                name @ ("lookat" | "skew" | "instance_controller") => {
                    return Err(format!("it has <{name}>"));
                }
                _ => {}
            }
        }
        for child in node.children().filter(Node::is_element) {
            match child.tag_name().name() {
                "node" => self.place(child, &node_frame, depth + 1)?,
                "instance_node" => self.place(self.target(child)?, &node_frame, depth + 1)?,
                "instance_geometry" => self.add(self.target(child)?, &node_frame)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn add(&mut self, part: Node<'a, 'i>, frame: &Matrix4<f64>) -> Result<(), String> {
        if !self.parts.contains_key(&part.id()) {
            let triangles = self.part(part)?;
            self.parts.insert(part.id(), triangles);
        }
        let triangles = &self.parts[&part.id()];
        if self.out.len() + triangles.len() > MOST_TRIANGLES {
            return Err(format!("it has more than {MOST_TRIANGLES} triangles"));
        }
        let place = |p: Vector3<f64>| (frame * p.push(1.0)).xyz();
        self.out.extend(triangles.iter().map(|corners| corners.map(place)));
        Ok(())
    }

    /// The triangles of a part in its own frame.
    fn part(&self, part: Node<'a, 'i>) -> Result<Vec<[Vector3<f64>; 3]>, String> {
        let mut out = Vec::new();
        for mesh in children(part, "mesh") {
            for primitive in mesh.children().filter(Node::is_element) {
                let name = primitive.tag_name().name();
                match name {
                    "triangles" | "polylist" | "polygons" => self.polygons(primitive, &mut out)?,
                    "tristrips" | "trifans" => return Err(format!("it has <{name}>")),
                    _ => {}
                }
            }
        }
        Ok(out)
    }

    fn polygons(&self, primitive: Node<'a, 'i>, out: &mut Vec<[Vector3<f64>; 3]>) -> Result<(), String> {
        let mut stride = 0;
        let mut corners = None;
        for input in children(primitive, "input") {
            let offset = input.attribute("offset").unwrap_or("0");
            let offset: usize =
                offset.parse().ok().filter(|o| *o < 100).ok_or_else(|| format!("\"{offset}\" is not an offset"))?;
            stride = stride.max(offset + 1);
            if input.attribute("semantic") == Some("VERTEX") {
                corners = Some((offset, self.positions(self.named(input, "source")?)?));
            }
        }
        let (offset, positions) = corners.ok_or("its triangles have no corners")?;
        let mut sizes = None;
        for vcount in children(primitive, "vcount") {
            sizes = Some(numbers(vcount)?);
        }
        for p in children(primitive, "p") {
            let indices = numbers(p)?;
            let corners: Option<Vec<Vector3<f64>>> = indices
                .chunks(stride)
                .map(|chunk| {
                    let index = chunk.get(offset)?;
                    let whole = *index >= 0.0 && index.fract() == 0.0;
                    whole.then(|| positions.get(*index as usize).copied())?
                })
                .collect();
            let corners = corners.ok_or("a triangle has a corner that is not there")?;
            let mut rest = &corners[..];
            let sizes: Vec<usize> = match (&sizes, primitive.tag_name().name()) {
                (Some(sizes), _) => sizes.iter().map(|s| *s as usize).collect(),
                (None, "polygons") => vec![rest.len()],
                (None, _) => vec![3; rest.len() / 3],
            };
            for size in sizes {
                let Some((polygon, after)) = rest.split_at_checked(size) else {
                    return Err("a polygon has a corner that is not there".to_string());
                };
                rest = after;
                for pair in polygon.get(1..).unwrap_or_default().windows(2) {
                    out.push([polygon[0], pair[0], pair[1]]);
                }
            }
            if !rest.is_empty() {
                return Err("some corners belong to no triangle".to_string());
            }
        }
        Ok(())
    }

    /// Points of `<vertices>`, or of a `<source>` itself.
    fn positions(&self, vertices: Node<'a, 'i>) -> Result<Vec<Vector3<f64>>, String> {
        let source = if vertices.has_tag_name_of("vertices") {
            let input = children(vertices, "input")
                .find(|n| n.attribute("semantic") == Some("POSITION"))
                .ok_or("its corners have no positions")?;
            self.named(input, "source")?
        } else {
            vertices
        };
        let array = children(source, "float_array").next();
        let values = numbers(array.ok_or("its corners have no numbers")?)?;
        let accessor = source.descendants().find(|n| n.has_tag_name_of("accessor")).and_then(|n| n.attribute("stride"));
        let stride: usize = accessor.unwrap_or("3").parse().unwrap_or(0);
        if !(3..100).contains(&stride) {
            return Err("its corners do not have three coordinates".to_string());
        }
        Ok(values.chunks_exact(stride).map(|p| Vector3::new(p[0], p[1], p[2])).collect())
    }
}
