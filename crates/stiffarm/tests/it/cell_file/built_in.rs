//! The cells that come with the library hold the published values, digit by digit.

use super::*;
use stiffarm::Code;

/// Zhang et al. 2021, Table 1 \[deg\].
const TABLE_1: [[f64; 2]; 6] =
    [[-90.0, 90.0], [-60.0, 40.0], [-180.0, -40.0], [-180.0, 180.0], [-90.0, 90.0], [-180.0, 180.0]];

/// Zhang et al. 2021, Table 5 \[deg\].
const TABLE_5: [[f64; 6]; 3] = [
    [12.81, 33.07, -126.36, 72.81, -67.88, 24.27],
    [-22.25, -34.46, -109.53, -94.38, 49.16, 186.07],
    [-61.35, -10.10, -119.99, -272.36, -55.71, -110.56],
];

/// What the default and the reference cell share: the reference cell's robot,
/// tool and load (`cell-comau.json` of the reference numbers), and the paper's tables.
fn check_comau(cell: &Cell) {
    let robot = &cell.setup.robot;
    assert_eq!(robot.name(), "COMAU SMART5 NJ 165-3.0");
    for (bound, degrees) in cell.bounds.iter().zip(TABLE_1) {
        assert_eq!(*bound, degrees.map(f64::to_radians));
    }
    assert_eq!(cell.prior.as_deref(), Some(&TABLE_2[..]));
    assert_eq!(cell.characteristic_length, Some(0.773));
    let tool = &cell.setup.tool;
    assert_eq!(tool.loading_point.as_slice(), [0.20, 0.0, 0.25]);
    let points = [("1", [0.15, 0.0, 0.2]), ("2", [0.0, 0.15, 0.2]), ("3", [-0.15, 0.0, 0.2]), ("4", [0.0, -0.15, 0.2])];
    assert_eq!(tool.point_count(), points.len());
    for (point, (name, position)) in tool.measuring_points.iter().zip(points) {
        assert_eq!(point.name, name);
        assert_eq!(point.position.as_slice(), position);
    }
    assert!(!tool.has_sensor && tool.series_compliance.is_none());
    let Load::Rope { anchor, magnitude } = &cell.setup.load else {
        panic!("the load is a rope, not {:?}", cell.setup.load);
    };
    assert_eq!(anchor.as_slice(), [1.8, 0.0, 0.0]);
    assert_eq!(*magnitude, 500.0);
    // Section IV.A: 9.23e-5 mm².
    assert_close(cell.noise.reading_variance, 9.23e-11);
    assert_eq!(cell.noise.readings_per_displacement, 1);
    assert_eq!(cell.noise.posture_common_std, 0.0);
}

#[test]
fn the_default_cell_holds_the_published_values() -> Check {
    let cell = builtin::cell("comau")?;
    check_comau(&cell);
    assert_eq!(builtin::cell_names()[0], "comau");
    let limits = &cell.limits;
    let corners = limits.tool_box.ok_or("no box")?;
    assert_eq!(corners[0].as_slice(), [0.9, -1.9, 0.3]);
    assert_eq!(corners[1].as_slice(), [3.0, 1.9, 3.0]);
    assert_eq!(limits.floor, None);
    assert_eq!(limits.keep_out_radius, Some(0.9));
    assert_eq!(limits.wrist_height, Some(0.3));
    assert_eq!(limits.rope_length, Some([0.8, 3.4]));
    assert_eq!(cell.validation.len(), TABLE_5.len());
    for (i, (posture, degrees)) in cell.validation.iter().zip(TABLE_5).enumerate() {
        assert_eq!(posture.name, format!("V{}", i + 1));
        assert_eq!(posture.q, degrees.map(f64::to_radians));
    }
    // The tasks' tool points down onto the table, inside the limits (the rope
    // is no part of the work).
    assert_eq!(cell.tasks, common::tasks());
    let mut work = cell.clone();
    work.limits.rope_length = None;
    for task in &cell.tasks {
        let terms = PostureTerms::new(&cell.setup, &task.q, None)?;
        assert!(terms.frames().direction(&nalgebra::Vector3::z()).z < -0.85);
        let margin = work.margins().smallest(&terms).ok_or("no limits")?;
        assert!(margin.margin > 0.05, "{}: {margin:?}", task.name);
    }
    Ok(())
}

#[test]
fn the_reference_cell_has_joint_bounds_only() -> Check {
    let cell = builtin::cell("comau-reference")?;
    check_comau(&cell);
    assert!(cell.limits.is_empty());
    assert!(cell.validation.is_empty());
    assert!(cell.tasks.is_empty());
    Ok(())
}

#[test]
fn the_measured_fanuc_cell() -> Check {
    let cell = builtin::cell("fanuc-r2000ic")?;
    assert_eq!(cell.setup.robot.name(), "FANUC R-2000iC/165F");
    assert_eq!(cell.setup.load, Load::Measured);
    // tcp_in_flange_m of the data set's robot description.
    let tcp = [0.0069, 0.2453, 0.3193];
    assert_eq!(cell.setup.tool.point_count(), 1);
    assert_eq!(cell.setup.tool.measuring_points[0].name, "TCP");
    assert_eq!(cell.setup.tool.tcp(), cell.setup.tool.loading_point);
    for (read, expected) in cell.setup.tool.tcp().iter().zip(tcp) {
        assert_close(*read, expected);
    }
    assert_eq!(cell.prior, None);
    assert_eq!(cell.characteristic_length, None);
    let range: Vec<[f64; 2]> = cell.bounds.iter().map(|b| b.map(f64::to_degrees)).collect();
    assert_close(range[0][0], -125.0);
    assert_close(range[5][1], 240.0);
    Ok(())
}

/// The rows of the published files side by side, digit by digit.
#[test]
#[ignore = "needs STIFFARM_REFERENCE_DATA"]
fn the_measured_readings_are_as_published() -> Check {
    let folder = common::reference_folder().join("fanuc_r2000ic");
    let read = |name: &str| std::fs::read_to_string(folder.join(name));
    let parts = [read("joint_angles.csv")?, read("forces.csv")?, read("deltaX.csv")?];
    let rows = parts.each_ref().map(|text| text.lines().skip(1));
    let [angles, forces, shifts] = rows;
    let published = (1..).zip(angles.zip(forces.zip(shifts)));
    let published: Vec<String> =
        published.map(|(i, (q, (f, d)))| format!("{i},TCP,{},{},{}", q.trim(), f.trim(), d.trim())).collect();
    let text = std::str::from_utf8(builtin::bytes("fanuc-r2000ic-readings")?)?;
    let table: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
    let heading = "posture,point,q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,fx_n,fy_n,fz_n,dx_m,dy_m,dz_m";
    assert_eq!(table[0], heading);
    assert_eq!(table[1..], published);
    Ok(())
}

#[test]
fn group_1_is_in_bounds_and_inside_the_limits() -> Check {
    let cell = builtin::cell("comau")?;
    let group = builtin::postures("comau-group1", &cell.setup.robot)?;
    // cell-comau.json of the reference numbers, without its rounding.
    let degrees = [
        [-35.0, -10.0, -95.0, 10.0, 15.0, -20.0],
        [-20.0, 15.0, -110.0, -15.0, -10.0, 25.0],
        [-5.0, -25.0, -80.0, 5.0, 20.0, 10.0],
        [10.0, 5.0, -100.0, -20.0, -15.0, -30.0],
        [25.0, -20.0, -115.0, 15.0, 10.0, 0.0],
        [40.0, 10.0, -75.0, -5.0, -20.0, 30.0],
    ];
    assert_eq!(group.len(), degrees.len());
    let mut smallest = f64::INFINITY;
    for (posture, degrees) in group.iter().zip(degrees) {
        assert_eq!(posture.q, degrees.map(f64::to_radians));
        let terms = PostureTerms::new(&cell.setup, &posture.q, None)?;
        let margin = cell.margins().smallest(&terms).ok_or("no limits")?;
        smallest = smallest.min(margin.margin);
    }
    // "Group 1 satisfies it with 0.039 m to spare" (method, section 10).
    assert!((smallest - 0.039).abs() < 5e-4, "{smallest}");
    Ok(())
}

#[test]
fn copies_for_the_reader_are_the_built_in_files() -> Check {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../cells");
    for file in std::fs::read_dir(&folder)? {
        let file = file?;
        let name = file.file_name().into_string().map_err(|_| "no text")?;
        let key = name.trim_end_matches(".toml").trim_end_matches(".csv");
        assert_eq!(std::fs::read(file.path())?, builtin::bytes(key)?, "{name}");
    }
    let files = std::fs::read_dir(folder)?.count();
    assert_eq!(files, builtin::names().len(), "every copy is built in");
    Ok(())
}

#[test]
fn unknown_built_in_names_are_answered_with_the_nearest() -> Check {
    let robot = builtin::cell("comau")?.setup.robot;
    let errors = [builtin::cell("comua").unwrap_err(), builtin::postures("group", &robot).unwrap_err()];
    assert_eq!(errors.each_ref().map(|error| error.code()), [Code::UnknownName; 2]);
    insta::assert_snapshot!(errors.map(|error| error.to_string()).join("\n"), @r#"
    There is no built-in cell "comua".
      hint: did you mean "comau"?
    There is no built-in posture group "group".
      hint: built in: comau-group1
    "#);
    Ok(())
}
