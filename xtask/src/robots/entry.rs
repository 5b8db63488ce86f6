//! One robot as an entry of the data file.

use serde::Deserialize;

use super::words::Words;

/// A transform closer to whole quarter turns than this is one [-].
const NOISE: f64 = 1e-12;

/// A robot of the descriptions.
#[derive(Deserialize)]
pub struct Robot {
    brand: String,
    model: String,
    payload_kg: Option<f64>,
    payload_source: Option<String>,
    reach_m: Option<f64>,
    reach_source: Option<String>,
    reach_wrist_centre_computed_m: Option<f64>,
    source: RobotSource,
    pendant_note: String,
    doubts: Vec<String>,
    /// Rows of alpha, a, offset and d.
    dh: Vec<[f64; 4]>,
    theta_from_pendant: Theta,
    joint_limits_deg: Vec<[f64; 2]>,
    pendant_to_urdf: Urdf,
    joint_velocity_deg_s: Vec<f64>,
    base_transform: [[f64; 4]; 4],
    tool: [[f64; 4]; 4],
}

#[derive(Deserialize)]
struct RobotSource {
    repository: String,
    file: String,
    commit: String,
    licence: String,
}

/// theta = offset + C q of the pendant's angles q.
#[derive(Deserialize)]
struct Theta {
    #[serde(rename = "C")]
    coupling: Vec<Vec<f64>>,
    offset_rad: Vec<f64>,
}

/// The description's angles, M q + offset of the pendant's angles q.
#[derive(Deserialize)]
struct Urdf {
    #[serde(rename = "M")]
    matrix: Vec<Vec<f64>>,
    offset_rad: Vec<f64>,
}

/// The fields of the robot `name`, all but its capsules.
///
/// # Errors
/// What does not fit together.
pub fn fields(name: &str, robot: &Robot, urdf: &str, words: &Words) -> Result<String, String> {
    let (dh, theta) = (&robot.dh, &robot.theta_from_pendant);
    if theta.offset_rad.len() != dh.len() || theta.coupling.len() != dh.len() {
        return Err("dh, offsets and C are not of one size".to_string());
    }
    let mut out = String::new();
    let mut line = |text: String| out += &format!("{text}\n");
    line(format!("key = {:?}", name.replace('_', "-")));
    line(format!("brand = {:?}", robot.brand));
    line(format!("name = {:?}", format!("{} {}", robot.brand, robot.model)));
    let payload = robot.payload_kg.zip(robot.payload_source.as_ref());
    if let Some((kg, source)) = payload {
        line(format!("payload = [{kg:?}, {source:?}]"));
    }
    // The maker's reach, else the one that the lengths give.
    let computed = "to the wrist centre, computed as a1 + a2 + hypot(a3, d4)";
    let stated = robot.reach_m.zip(robot.reach_source.as_deref());
    let reach = stated.or(robot.reach_wrist_centre_computed_m.map(|m| (m, computed)));
    if let Some((m, source)) = reach {
        line(format!("reach = [{m:?}, {source:?}]"));
    }
    line(format!("source = {:?}", robot.source.repository));
    line(format!("file = {:?}", robot.source.file));
    line(format!("commit = {:?}", robot.source.commit));
    line(format!("licence = {:?}", robot.source.licence));
    let remark = &robot.pendant_note;
    line(format!("pendant = {:?}", words.pendant(remark)));
    let doubts = words.doubts(name, &robot.doubts, remark);
    if !doubts.is_empty() {
        line("doubts = [".to_string());
        for (about, sentence) in doubts {
            line(format!("    {{ about = {about:?}, sentence = {sentence:?} }},"));
        }
        line("]".to_string());
    }
    line("rows = [".to_string());
    for ([alpha, a, _, d], offset) in dh.iter().zip(&theta.offset_rad) {
        let (alpha, offset) = (degrees(*alpha), degrees(*offset));
        let row = [alpha, millimetres(*a), millimetres(*d), offset];
        line(format!("    {row:?},"));
    }
    line("]".to_string());
    let coupling = entries(&theta.coupling);
    line(format!("coupling = {}", arrays(format!("{coupling:?}"))));
    line("limits_deg = [".to_string());
    for limits in limits(&robot.joint_limits_deg, &robot.pendant_to_urdf)? {
        line(format!("    {limits:?},"));
    }
    line("]".to_string());
    // A description that has no speeds writes zeros.
    let speeds = &robot.joint_velocity_deg_s;
    if speeds.iter().all(|v| *v > 0.0) {
        line(format!("speeds_deg_s = {speeds:?}"));
    }
    for (field, pose) in [
        ("base", pose(&robot.base_transform)),
        ("flange", pose(&robot.tool)),
        ("controller_base", controller_base(urdf)?),
    ] {
        if pose != [0.0; 6] {
            line(format!("{field} = {pose:?}"));
        }
    }
    Ok(out)
}

/// Tuples as arrays.
pub fn arrays(text: String) -> String {
    text.replace('(', "[").replace(')', "]")
}

/// Radians as the shortest degrees that mean the same to 1e-12 deg.
fn degrees(rad: f64) -> f64 {
    rounded(rad.to_degrees(), 1e12)
}

/// Metres as the shortest millimetres that mean the same to 1e-9 mm.
pub fn millimetres(m: f64) -> f64 {
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
fn limits(described: &[[f64; 2]], urdf: &Urdf) -> Result<Vec<[f64; 2]>, String> {
    let limit = |(j, range): (usize, &[f64; 2])| -> Option<[f64; 2]> {
        let sign = urdf.matrix.get(j)?.get(j)?;
        let offset = urdf.offset_rad.get(j)?.to_degrees();
        let ends = range.map(|angle| rounded((angle - offset) / sign, 1e9));
        Some([ends[0].min(ends[1]), ends[0].max(ends[1])])
    };
    let limits: Option<Vec<[f64; 2]>> = described.iter().enumerate().map(limit).collect();
    limits.ok_or_else(|| "limits and pendant_to_urdf are not of one size".to_string())
}

/// A 4 × 4 matrix as x, y, z \[mm\] and turns about fixed x, then y, then z \[deg\].
fn pose(matrix: &[[f64; 4]; 4]) -> [f64; 6] {
    let r = |i: usize, j: usize| {
        let value = matrix[i][j];
        let whole = value.round();
        // Adding zero turns −0 into 0, which matters to atan2.
        if (value - whole).abs() < NOISE { whole + 0.0 } else { value }
    };
    let roll = r(2, 1).atan2(r(2, 2));
    let pitch = (-r(2, 0)).atan2(r(2, 1).hypot(r(2, 2)));
    // Yaw is what is left once this roll is undone.
    let (sine, cosine) = roll.sin_cos();
    let yaw = (sine * r(0, 2) - cosine * r(0, 1)).atan2(cosine * r(1, 1) - sine * r(1, 2));
    [millimetres(r(0, 3)), millimetres(r(1, 3)), millimetres(r(2, 3)), degrees(roll), degrees(pitch), degrees(yaw)]
}

/// The controller's base frame, which these descriptions call `base`, in `base_link`; the same where there is none.
fn controller_base(urdf: &str) -> Result<[f64; 6], String> {
    let mut joints = urdf.split("<joint").skip(1).filter_map(|rest| rest.split("</joint>").next());
    let Some(joint) = joints.find(|joint| joint.contains("<child link=\"base\"/>")) else {
        return Ok([0.0; 6]);
    };
    if !joint.contains("<parent link=\"base_link\"/>") {
        return Err("the frame base does not hang on base_link".to_string());
    }
    let origin = joint.split("<origin").nth(1).and_then(|rest| rest.split("/>").next());
    let attribute = |name: &str| -> Result<[f64; 3], String> {
        let start = format!("{name}=\"");
        let text = origin.and_then(|o| o.split(start.as_str()).nth(1)?.split('"').next());
        let words = text.unwrap_or("0 0 0").split_whitespace();
        let values: Result<Vec<f64>, _> = words.map(str::parse).collect();
        let values = values.ok().and_then(|values| values.try_into().ok());
        values.ok_or_else(|| format!("{name} of the frame base"))
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
        let quarter = [
            [6.1e-17, -6.1e-17, 1.0, 0.0],
            [6.1e-17, -1.0, -6.1e-17, 2.9e-17],
            [1.0, 6.1e-17, -6.1e-17, 0.14],
            [0.0, 0.0, 0.0, 1.0],
        ];
        assert_eq!(pose(&quarter), [0.0, 0.0, 140.0, 0.0, -90.0, 180.0]);
    }

    #[test]
    fn limits_become_the_pendants() {
        let text = r#"{"M": [[-1, 0], [0, 1]], "offset_rad": [0, 1.5707963267948966]}"#;
        let urdf = serde_json::from_str(text).unwrap();
        let described = [[-10.0, 20.0], [-45.0, 85.0]];
        let pendant = [[-20.0, 10.0], [-135.0, -5.0]];
        assert_eq!(limits(&described, &urdf).unwrap(), pendant);
    }

    #[test]
    fn the_controllers_base_is_read_from_the_description() {
        let urdf = r#"<joint name="a" type="fixed"><origin rpy="0 0 3.141592653589793" xyz="0 0 0.67"/>
            <parent link="base_link"/><child link="base"/></joint>"#;
        assert_eq!(controller_base(urdf).unwrap(), [0.0, 0.0, 670.0, 0.0, 0.0, 180.0]);
        assert_eq!(controller_base("<robot/>").unwrap(), [0.0; 6]);
    }
}
