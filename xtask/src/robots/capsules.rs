//! The capsules around a robot's links, and what there is to say of them.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::entry::{arrays, millimetres};
use super::words::Words;

/// What `capsules.json` says of a robot.
#[derive(Deserialize)]
pub struct Capsules {
    links: BTreeMap<usize, Link>,
    not_covered: Vec<Part>,
}

#[derive(Deserialize)]
struct Link {
    capsules: Vec<Capsule>,
}

#[derive(Deserialize)]
struct Capsule {
    a: [f64; 3],
    b: [f64; 3],
    radius: f64,
}

#[derive(Deserialize)]
struct Part {
    link: String,
}

/// What `distances.json` says of a robot.
#[derive(Deserialize)]
pub struct Distances {
    pair_lists: Pairs,
}

/// Pairs of links, as `2-4`.
#[derive(Deserialize)]
struct Pairs {
    capsules_always_overlap: Vec<String>,
    capsules_overlap_but_meshes_never_in_samples: Vec<String>,
}

/// The fields `capsules`, `ignored_pairs` and `capsules_remark` of the robot `name`.
///
/// # Errors
/// Something else than a pair of links.
pub fn fields(name: &str, capsules: &Capsules, distances: &Distances, words: &Words) -> Result<String, String> {
    let mut out = "capsules = [\n".to_string();
    for (link, shape) in &capsules.links {
        for Capsule { a, b, radius } in &shape.capsules {
            let ends = [a, b].map(|end| end.map(millimetres));
            let row = (link, ends[0], ends[1], millimetres(*radius));
            out += &format!("    {},\n", arrays(format!("{row:?}")));
        }
    }
    out += "]\n";
    let lists = &distances.pair_lists;
    let mut ignored = Vec::new();
    for pair in (lists.capsules_always_overlap.iter()).chain(&lists.capsules_overlap_but_meshes_never_in_samples) {
        let links = pair.split_once('-');
        let links = links.and_then(|(i, j)| Some((i.parse().ok()?, j.parse().ok()?)));
        let links: (usize, usize) = links.ok_or_else(|| format!("{pair} is no pair of links"))?;
        ignored.push(links);
    }
    ignored.sort_unstable();
    if !ignored.is_empty() {
        let ignored = arrays(format!("{ignored:?}"));
        out += &format!("ignored_pairs = {ignored}\n");
    }
    let parts: Vec<String> = capsules.not_covered.iter().map(|part| part.link.clone()).collect();
    let remark = words.capsules(name, &parts);
    if !remark.is_empty() {
        out += &format!("capsules_remark = {remark:?}\n");
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn capsules_become_rows_in_millimetres() {
        let capsules = r#"{"not_covered": [{"link": "door"}], "links": {
            "1": {"capsules": [{"a": [0.001, 0, -0.25001], "b": [0, 0, 1], "radius": 0.1}]}}}"#;
        let distances = r#"{"pair_lists": {"capsules_always_overlap": ["2-4"],
            "capsules_overlap_but_meshes_never_in_samples": ["0-2"]}}"#;
        let capsules = serde_json::from_str(capsules).unwrap();
        let distances = serde_json::from_str(distances).unwrap();
        assert_eq!(
            fields("x", &capsules, &distances, &Words::read()).unwrap(),
            "capsules = [\n    [1, [1.0, 0.0, -250.01], [0.0, 0.0, 1000.0], 100.0],\n]\n\
             ignored_pairs = [[0, 2], [2, 4]]\ncapsules_remark = \"No capsule holds door.\"\n"
        );
    }
}
