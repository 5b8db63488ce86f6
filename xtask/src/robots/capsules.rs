//! The capsules around a robot's links, and what there is to say of them.

use super::entry::{at, millimetres, numbers, string};
use super::json::Json;

/// What capsules leave out: the first text is in the names of the parts, the second says it.
const LEFT_OUT: &[(&str, &str)] = &[
    (
        "cylinder",
        "Cylinder and piston of the balancer are in no capsule.",
    ),
    (
        "lever_a",
        "The levers of the parallelogram are in no capsule.",
    ),
    ("hand", "The hand and its fingers are in no capsule."),
];

/// What makes capsules larger than the links, by robot.
const TOO_LARGE: &[(&str, &str)] = &[(
    "kuka_kr300_r2800_2_mt",
    "The capsules of link 2 are too large: their source is a convex hull 1.21 m wide where the KR 500's is 0.47 m.",
)];

/// The fields `capsules`, `ignored_pairs` and `capsules_remark` of the robot `name`.
///
/// # Errors
/// A key that is missing or holds something else.
pub fn fields(name: &str, capsules: &Json, distances: &Json) -> Result<String, String> {
    let own = at(capsules, &[name])?;
    let mut out = "        capsules: &[\n".to_string();
    let Json::Object(links) = at(own, &["links"])? else {
        return Err("links is no object".into());
    };
    for (link, shape) in links {
        let link: usize = link.parse().map_err(|_| format!("link {link}"))?;
        let list = at(shape, &["capsules"])?.list();
        for capsule in list.ok_or("capsules is no list")? {
            let end = |key: &str| -> Result<[f64; 3], String> {
                let point: Vec<f64> = numbers(capsule, &[key])?
                    .into_iter()
                    .map(millimetres)
                    .collect();
                point.try_into().map_err(|_| format!("{key} is no point"))
            };
            let radius = at(capsule, &["radius"])?.number().ok_or("no radius")?;
            let row = (link, end("a")?, end("b")?, millimetres(radius));
            out += &format!("            {row:?},\n");
        }
    }
    out += "        ],\n";
    let mut ignored = Vec::new();
    for list in [
        "capsules_always_overlap",
        "capsules_overlap_but_meshes_never_in_samples",
    ] {
        let pairs = at(distances, &[name, "pair_lists", list])?.list();
        for pair in pairs.ok_or_else(|| format!("{list} is no list"))? {
            let pair = pair.text().and_then(|text| text.split_once('-'));
            let pair =
                pair.and_then(|(i, j)| Some((i.parse::<usize>().ok()?, j.parse::<usize>().ok()?)));
            ignored.push(pair.ok_or_else(|| format!("{list} holds something else"))?);
        }
    }
    ignored.sort_unstable();
    if !ignored.is_empty() {
        out += &format!("        ignored_pairs: &{ignored:?},\n");
    }
    let remark = remark(name, own)?;
    if !remark.is_empty() {
        out += &format!("        capsules_remark: {remark:?},\n");
    }
    Ok(out)
}

/// What the capsules leave out or make too large, in plain words.
fn remark(name: &str, own: &Json) -> Result<String, String> {
    let parts = at(own, &["not_covered"])?.list();
    let parts = parts.ok_or("not_covered is no list")?;
    let parts: Vec<&str> = parts
        .iter()
        .map(|part| string(part, &["link"]))
        .collect::<Result<_, _>>()?;
    let names = parts.join(", ");
    let known = LEFT_OUT.iter().find(|(text, _)| names.contains(text));
    let left_out = match known {
        Some((_, said)) => (*said).to_string(),
        None if parts.is_empty() => String::new(),
        // Nothing is lost: parts nobody has put into words keep their names.
        None => format!("No capsule holds {names}."),
    };
    let too_large = TOO_LARGE.iter().find(|(robot, _)| *robot == name);
    let too_large = too_large.map(|(_, said)| *said).unwrap_or_default();
    Ok(format!("{left_out} {too_large}").trim().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn capsules_become_rows_in_millimetres() {
        let capsules = r#"{"x": {"not_covered": [{"link": "door"}], "links": {
            "1": {"capsules": [{"a": [0.001, 0, -0.25001], "b": [0, 0, 1], "radius": 0.1}]}}}}"#;
        let distances = r#"{"x": {"pair_lists": {"capsules_always_overlap": ["2-4"],
            "capsules_overlap_but_meshes_never_in_samples": ["0-2"]}}}"#;
        let [capsules, distances] = [capsules, distances].map(|t| Json::parse(t).unwrap());
        assert_eq!(
            fields("x", &capsules, &distances).unwrap(),
            "        capsules: &[\n            \
             (1, [1.0, 0.0, -250.01], [0.0, 0.0, 1000.0], 100.0),\n        ],\n        \
             ignored_pairs: &[(0, 2), (2, 4)],\n        \
             capsules_remark: \"No capsule holds door.\",\n"
        );
        assert!(fields("y", &capsules, &distances).is_err());
    }
}
