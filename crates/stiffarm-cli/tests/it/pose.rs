//! `stiffarm pose`: poses of postures, postures of poses, and what is refused.

use crate::support;

use support::{Folder, codes, is_narrow};

const POSTURES: &str = "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg
home,0,-90,90,0,0,0
P2,30,-60,70,20,-40,200
";

/// A KUKA with two postures.
fn kuka() -> Folder {
    let folder = Folder::new();
    folder.ok("init --robot kuka-kr210-r2700-2 --output-dir cell");
    folder.write("postures.csv", POSTURES);
    folder
}

#[test]
fn poses_of_a_kuka_and_back() {
    let folder = kuka();
    let line = "pose cell/cell.toml postures.csv --output poses.csv";
    let printed = folder.ok(line);
    is_narrow(&printed);
    insta::assert_snapshot!("pose_kuka", printed.replace('\\', "/"));
    insta::assert_snapshot!("pose_kuka_table", folder.read("poses.csv"));
    let back = folder.ok("pose cell/cell.toml --poses poses.csv --output back.csv");
    is_narrow(&back);
    insta::assert_snapshot!("pose_kuka_from", back.replace('\\', "/"));
    // The postures that the poses were made of are among those found.
    let rows = folder.read("back.csv");
    let is_there = |q: [f64; 6]| {
        rows.lines().skip(1).any(|row| {
            let angles = row.split(',').skip(1).map(|v| v.parse::<f64>().unwrap());
            angles.zip(q).all(|(a, b)| (a - b).abs() < 1e-4)
        })
    };
    assert!(is_there([0.0, -90.0, 90.0, 0.0, 0.0, 0.0]));
    assert!(is_there([30.0, -60.0, 70.0, 20.0, -40.0, 200.0]));
    // Other commands read the table.
    folder.ok("evaluate cell/cell.toml back.csv");
}

#[test]
fn every_convention_goes_there_and_back() {
    let folder = kuka();
    for convention in ["kuka", "abb", "fanuc", "comau", "yaskawa", "staubli", "ur", "matrix"] {
        for rest in ["", " --point tip --frame cell"] {
            let options = format!("--convention {convention}{rest} --force");
            let printed = folder.ok(&format!("pose cell/cell.toml postures.csv --output poses.csv {options}"));
            is_narrow(&printed);
            let line = format!("pose cell/cell.toml --poses poses.csv {options}");
            is_narrow(&folder.ok(&line));
            let poses = folder.json(&line);
            let postures = poses["result"]["poses"][1]["postures"].as_array().unwrap();
            let wanted = [30.0, -60.0, 70.0, 20.0, -40.0, 200.0];
            let is_wanted = postures.iter().any(|posture| {
                let q = posture["q_deg"].as_array().unwrap().iter();
                q.zip(wanted).all(|(a, b)| (a.as_f64().unwrap() - b).abs() < 1e-5)
            });
            assert!(is_wanted, "{line}");
        }
    }
}

#[test]
fn the_frame_is_the_controllers() {
    let folder = Folder::new();
    folder.ok("init --robot fanuc-m10ia --output-dir fanuc");
    folder.ok("init --robot ur5e --output-dir ur");
    folder.write("zero.csv", POSTURES.replace("-90,90", "0,0").replace("-60,70", "-60,30"));
    let height = |options: &str| {
        let line = format!("pose fanuc/cell.toml zero.csv {options}");
        let value = folder.json(&line);
        value["result"]["postures"][0]["flange"]["position_mm"][2].as_f64().unwrap()
    };
    assert!((height("") + 450.0 - height("--frame cell")).abs() < 1e-9);
    let findings = folder.json("pose fanuc/cell.toml zero.csv")["result"]["findings"].clone();
    assert_eq!(codes(&findings), ["robot-doubt"]);
    let ur = folder.ok("pose ur/cell.toml zero.csv");
    is_narrow(&ur);
    insta::assert_snapshot!("pose_ur", ur.replace('\\', "/"));
}

/// A robot of one's own cannot say where its pendant counts heights from: a maker that counts from axis 2 is named.
#[test]
fn a_height_that_the_pendant_counts_otherwise_is_named() {
    let folder = Folder::new();
    let rows = "joint,alpha_deg,a_mm,d_mm,offset_deg,low_deg,high_deg\n1,0,0,450,0,-170,170\n\
                2,-90,150,0,-90,-90,160\n3,0,600,0,0,-180,180\n4,-90,200,640,0,-190,190\n\
                5,90,0,0,0,-140,140\n6,-90,0,100,180,-360,360\n";
    folder.write("rows.csv", rows);
    folder.ok("init --dh rows.csv --output-dir own");
    let cell = folder.read("own/cell.toml");
    folder.write("zero.csv", POSTURES.replace("-90,90", "0,0"));
    for (maker, counted) in [("fanuc", true), ("yaskawa", true), ("kuka", false)] {
        let key = format!("[robot]\ncontroller = \"{maker}\"\n");
        folder.write("own/cell.toml", cell.replacen("[robot]\n", &key, 1));
        let printed = folder.ok("pose own/cell.toml zero.csv");
        is_narrow(&printed);
        let printed = printed.split_whitespace().collect::<Vec<_>>().join(" ");
        let said = "from the height of axis 2, 450 mm above the frame of these poses";
        assert_eq!(printed.contains(said), counted, "{printed}");
        let printed = folder.ok("pose own/cell.toml zero.csv --frame cell");
        assert!(!printed.contains("the pendant is"), "{printed}");
    }
}

/// Postures that differ by full turns are counted for each pose and branch, whatever the
/// poses' names.
#[test]
fn turns_are_counted_for_each_pose() {
    let folder = Folder::new();
    folder.ok("init --robot ur10e --output-dir cell");
    let pose = "600,200,500,0.1,0.2,0.3";
    folder.write("poses.csv", format!("posture,x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad\nP,{pose}\nP-1.5,{pose}\n"));
    let json = folder.ok("pose cell/cell.toml --poses poses.csv --json");
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let printed = folder.ok("pose cell/cell.toml --poses poses.csv");
    let mut branches = 0;
    for pose in json["result"]["poses"].as_array().unwrap() {
        let name = pose["name"].as_str().unwrap();
        let all = pose["postures"].as_array().unwrap();
        let last = all.last().unwrap()["branch"].as_u64().unwrap();
        for branch in 1..=last {
            let count = all.iter().filter(|p| p["branch"] == branch).count();
            let row = format!("{name}-{branch} ");
            let line = printed.lines().rfind(|l| l.starts_with(&row)).unwrap();
            assert!(line.ends_with(&format!(" {count}")), "{line}: {count}");
            branches += 1;
        }
    }
    assert!(branches >= 4, "{branches}");
}

#[test]
fn a_pose_without_a_posture_is_a_finding() {
    let folder = kuka();
    folder
        .write("poses.csv", "posture,x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\nfar,9000,0,0,0,0,0\nnear,1765,0,1910,0,90,0\n");
    let line = "pose cell/cell.toml --poses poses.csv";
    let ran = folder.run(line);
    assert_eq!(ran.code, Some(1));
    insta::assert_snapshot!("pose_without_posture", ran.transcript(line).replace('\\', "/"));
    let ran = folder.run(&format!("{line} --json"));
    assert_eq!(ran.code, Some(1));
    let value: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!(value["result"]["findings"][0]["code"], "pose-without-posture");
    assert_eq!(value["result"]["poses"][0]["postures"], serde_json::json!([]));
}

#[test]
fn what_is_refused() {
    let folder = kuka();
    folder.write("missing.csv", "x_mm,y_mm,z_mm,a_deg,b_deg\n1,2,3,0,0\n");
    folder.write("empty.csv", "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n");
    folder.write("quaternion.csv", "x_mm,y_mm,z_mm,q1,q2,q3,q4\n1,2,3,0.5,0,0,0\n");
    folder.write("word.csv", "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n1,2,3,nan,0,0\n");
    folder.write("vector.csv", "x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad\n1,2,3,0,90,0\n");
    let report = folder.refusals([
        "pose cell/cell.toml",
        "pose cell/cell.toml postures.csv --convention euler",
        "pose cell/cell.toml postures.csv --poses missing.csv",
        "pose cell/cell.toml --poses missing.csv",
        "pose cell/cell.toml --poses empty.csv",
        "pose cell/cell.toml --poses word.csv",
        "pose cell/cell.toml --poses quaternion.csv --convention abb",
        "pose cell/cell.toml --poses quaternion.csv",
        "pose cell/cell.toml --poses vector.csv --convention ur",
    ]);
    insta::assert_snapshot!("pose_refused", report.replace('\\', "/"));
}
