//! One robot as an entry of the data file.

use super::doubts;
use super::json::Json;

/// Published stiffness belongs to the library: its name there, for the robots that have some.
const STIFFNESS: &[(&str, &str)] = &[("kuka_kr500_r2800_2", "KR500_STIFFNESS")];

/// A transform closer to whole quarter turns than this is one [-].
const NOISE: f64 = 1e-12;

/// The fields of the robot `name`, all but its capsules.
///
/// # Errors
/// A key that is missing or holds something else.
pub fn fields(name: &str, robot: &Json, urdf: &str) -> Result<String, String> {
    let brand = string(robot, &["brand"])?;
    let model = string(robot, &["model"])?;
    let remark = string(robot, &["pendant_note"])?;
    let coupling = rows(robot, &["theta_from_pendant", "C"])?;
    let offset = numbers(robot, &["theta_from_pendant", "offset_rad"])?;
    let dh = rows(robot, &["dh"])?;
    let n = dh.len();
    if dh.iter().any(|row| row.len() != 4) || offset.len() != n || coupling.len() != n {
        return Err("dh, offsets and C are not of one size".to_string());
    }
    let mut out = String::new();
    let mut line = |text: String| out += &format!("        {text}\n");
    line(format!("key: {:?},", name.replace('_', "-")));
    line(format!("brand: {brand:?},"));
    line(format!("name: {:?},", format!("{brand} {model}")));
    line(format!(
        "payload: {},",
        quantity(robot, "payload_kg", "payload_source")?
    ));
    line(format!("reach: {},", reach(robot)?));
    for (field, key) in [
        ("source", "repository"),
        ("file", "file"),
        ("commit", "commit"),
        ("licence", "licence"),
    ] {
        line(format!("{field}: {:?},", string(robot, &["source", key])?));
    }
    line(format!("pendant: {:?},", doubts::pendant(remark)));
    let remarks = at(robot, &["doubts"])?.list().ok_or("doubts is no list")?;
    let remarks: Option<Vec<&str>> = remarks.iter().map(Json::text).collect();
    let doubts = doubts::of(name, &remarks.ok_or("a doubt is no text")?, remark);
    if !doubts.is_empty() {
        line("doubts: &[".to_string());
        for (about, sentence) in doubts {
            line(format!(
                "    Doubt {{ about: DoubtAbout::{about}, sentence: {sentence:?} }},"
            ));
        }
        line("],".to_string());
    }
    if let Some((_, set)) = STIFFNESS.iter().find(|(robot, _)| *robot == name) {
        line(format!("stiffness: {set},"));
    }
    line("rows: &[".to_string());
    for (row, offset) in dh.iter().zip(&offset) {
        let row = [
            degrees(row[0]),
            millimetres(row[1]),
            millimetres(row[3]),
            degrees(*offset),
        ];
        line(format!("    {row:?},"));
    }
    line("],".to_string());
    let entries: Vec<String> = entries(&coupling)
        .iter()
        .map(|e| format!("{e:?}"))
        .collect();
    line(format!("coupling: &[{}],", entries.join(", ")));
    line("limits_deg: &[".to_string());
    for limits in limits(robot)? {
        line(format!("    {limits:?},"));
    }
    line("],".to_string());
    let speeds = numbers(robot, &["joint_velocity_deg_s"])?;
    // A description that has no speeds writes zeros.
    if speeds.iter().all(|v| *v > 0.0) {
        line(format!("speeds_deg_s: &{speeds:?},"));
    }
    let controller_base = controller_base(urdf)?;
    let poses = [
        ("base", pose(&rows(robot, &["base_transform"])?)),
        ("flange", pose(&rows(robot, &["tool"])?)),
        ("controller_base", controller_base),
    ];
    for (field, pose) in poses {
        if pose != [0.0; 6] {
            line(format!("{field}: {pose:?},"));
        }
    }
    Ok(out)
}

pub(super) fn at<'j>(robot: &'j Json, path: &[&str]) -> Result<&'j Json, String> {
    let found = path.iter().try_fold(robot, |json, key| json.get(key));
    found.ok_or_else(|| format!("{} is missing", path.join(".")))
}

pub(super) fn string<'j>(robot: &'j Json, path: &[&str]) -> Result<&'j str, String> {
    at(robot, path)?
        .text()
        .ok_or_else(|| format!("{} is no text", path.join(".")))
}

pub(super) fn numbers(robot: &Json, path: &[&str]) -> Result<Vec<f64>, String> {
    at(robot, path)?
        .numbers()
        .ok_or_else(|| format!("{} is no list of numbers", path.join(".")))
}

fn rows(robot: &Json, path: &[&str]) -> Result<Vec<Vec<f64>>, String> {
    at(robot, path)?
        .rows()
        .ok_or_else(|| format!("{} is no list of rows", path.join(".")))
}

/// `Some((value, "source"))`, or `None` where it is not known.
fn quantity(robot: &Json, key: &str, source: &str) -> Result<String, String> {
    Ok(match at(robot, &[key])?.number() {
        Some(value) => format!("Some(({value:?}, {:?}))", string(robot, &[source])?),
        None => "None".to_string(),
    })
}

/// The maker's reach, else the one that the lengths give.
fn reach(robot: &Json) -> Result<String, String> {
    let stated = quantity(robot, "reach_m", "reach_source")?;
    if stated != "None" {
        return Ok(stated);
    }
    Ok(
        match at(robot, &["reach_wrist_centre_computed_m"])?.number() {
            Some(value) => {
                format!(
                    "Some(({value:?}, \"to the wrist centre, computed as a1 + a2 + hypot(a3, d4)\"))"
                )
            }
            None => stated,
        },
    )
}

/// Radians as the shortest degrees that mean the same to 1e-12 deg.
fn degrees(rad: f64) -> f64 {
    rounded(rad.to_degrees(), 1e12)
}

/// Metres as the shortest millimetres that mean the same to 1e-9 mm.
pub(super) fn millimetres(m: f64) -> f64 {
    rounded(1e3 * m, 1e9)
}

fn rounded(value: f64, scale: f64) -> f64 {
    // Adding zero turns −0 into 0.
    (value * scale).round() / scale + 0.0
}

/// Entries of C that are not zero.
fn entries(coupling: &[Vec<f64>]) -> Vec<(usize, usize, f64)> {
    let rows = coupling.iter().enumerate();
    rows.flat_map(|(i, row)| row.iter().enumerate().map(move |(j, c)| (i, j, *c)))
        .filter(|(_, _, c)| *c != 0.0)
        .collect()
}

/// Limits of the pendant's angles \[deg\] from those of the description's, q_urdf = M q + offset.
///
/// Where joint 3 is coupled to joint 2 they are those at joint 2 = 0; a doubt says so.
fn limits(robot: &Json) -> Result<Vec<[f64; 2]>, String> {
    let own = rows(robot, &["joint_limits_deg"])?;
    let m = rows(robot, &["pendant_to_urdf", "M"])?;
    let offset = numbers(robot, &["pendant_to_urdf", "offset_rad"])?;
    let limit = |(j, own): (usize, &Vec<f64>)| -> Option<[f64; 2]> {
        let (sign, offset) = (*m.get(j)?.get(j)?, offset.get(j)?.to_degrees());
        let pendant = |angle: f64| rounded((angle - offset) / sign, 1e9);
        let ends = [pendant(*own.first()?), pendant(*own.get(1)?)];
        Some([ends[0].min(ends[1]), ends[0].max(ends[1])])
    };
    let limits: Option<Vec<[f64; 2]>> = own.iter().enumerate().map(limit).collect();
    limits.ok_or_else(|| "limits and pendant_to_urdf are not of one size".to_string())
}

/// A 4 × 4 matrix as x, y, z \[mm\] and turns about fixed x, then y, then z \[deg\].
fn pose(matrix: &[Vec<f64>]) -> [f64; 6] {
    let r = |i: usize, j: usize| {
        let value = matrix[i][j];
        let whole = value.round();
        // Adding zero turns −0 into 0, which matters to atan2.
        if (value - whole).abs() < NOISE {
            whole + 0.0
        } else {
            value
        }
    };
    let roll = r(2, 1).atan2(r(2, 2));
    let pitch = (-r(2, 0)).atan2(r(2, 1).hypot(r(2, 2)));
    // Yaw is what is left once this roll is undone.
    let (sine, cosine) = roll.sin_cos();
    let yaw = (sine * r(0, 2) - cosine * r(0, 1)).atan2(cosine * r(1, 1) - sine * r(1, 2));
    [
        millimetres(r(0, 3)),
        millimetres(r(1, 3)),
        millimetres(r(2, 3)),
        degrees(roll),
        degrees(pitch),
        degrees(yaw),
    ]
}

/// The controller's base frame, which these descriptions call `base`, in `base_link`; the same where there is none.
fn controller_base(urdf: &str) -> Result<[f64; 6], String> {
    let mut joints = urdf
        .split("<joint")
        .skip(1)
        .filter_map(|rest| rest.split("</joint>").next());
    let Some(joint) = joints.find(|joint| joint.contains("<child link=\"base\"/>")) else {
        return Ok([0.0; 6]);
    };
    if !joint.contains("<parent link=\"base_link\"/>") {
        return Err("the frame base does not hang on base_link".to_string());
    }
    let origin = joint
        .split("<origin")
        .nth(1)
        .and_then(|rest| rest.split("/>").next());
    let attribute = |name: &str| -> Result<[f64; 3], String> {
        let start = format!("{name}=\"");
        let text = origin.and_then(|o| o.split(start.as_str()).nth(1)?.split('"').next());
        let mut values = [0.0; 3];
        for (value, word) in values
            .iter_mut()
            .zip(text.unwrap_or("0 0 0").split_whitespace())
        {
            *value = word
                .parse()
                .map_err(|_| format!("{name} of the frame base: {word}"))?;
        }
        Ok(values)
    };
    let [x, y, z] = attribute("xyz")?.map(millimetres);
    let [roll, pitch, yaw] = attribute("rpy")?.map(degrees);
    Ok([x, y, z, roll, pitch, yaw])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_have_no_noise_of_rounding() {
        let quarter = vec![
            vec![6.1e-17, -6.1e-17, 1.0, 0.0],
            vec![6.1e-17, -1.0, -6.1e-17, 2.9e-17],
            vec![1.0, 6.1e-17, -6.1e-17, 0.14],
            vec![0.0, 0.0, 0.0, 1.0],
        ];
        assert_eq!(pose(&quarter), [0.0, 0.0, 140.0, 0.0, -90.0, 180.0]);
    }

    #[test]
    fn limits_become_the_pendants() {
        let text = r#"{"joint_limits_deg": [[-10, 20], [-45, 85]],
            "pendant_to_urdf": {"M": [[-1, 0], [0, 1]], "offset_rad": [0, 1.5707963267948966]}}"#;
        let robot = Json::parse(text).unwrap();
        assert_eq!(limits(&robot).unwrap(), [[-20.0, 10.0], [-135.0, -5.0]]);
    }

    #[test]
    fn the_controllers_base_is_read_from_the_description() {
        let urdf = r#"<joint name="a" type="fixed"><origin rpy="0 0 3.141592653589793" xyz="0 0 0.67"/>
            <parent link="base_link"/><child link="base"/></joint>"#;
        assert_eq!(
            controller_base(urdf).unwrap(),
            [0.0, 0.0, 670.0, 0.0, 0.0, 180.0]
        );
        assert_eq!(controller_base("<robot/>").unwrap(), [0.0; 6]);
    }
}
