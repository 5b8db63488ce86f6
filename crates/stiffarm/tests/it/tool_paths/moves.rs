//! New programs of linear moves read back as the points that they were written from.

use super::{Check, apart, stated};
use crate::common::set_ups::path_point;
use stiffarm::model::cell::Cell;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::path::{PathPoint, PathTarget};
use stiffarm::{Code, Error};
use stiffarm_files::cell::parse_cell;
use stiffarm_files::program::Language;
use stiffarm_files::tool_path::{Kind, MoveOptions, PosedPoint, read_tool_path, write_moves};

/// Robots of the catalogue with a posture each \[deg\], and the language of their controllers.
const ROBOTS: [(&str, Language, [f64; 6]); 4] = [
    ("kuka-kr500-r2800-2", Language::Krl, [10.0, -70.0, 110.0, 5.0, 45.0, 20.0]),
    ("abb-irb6640", Language::Rapid, [10.0, 20.0, 10.0, 5.0, 45.0, 20.0]),
    ("fanuc-r2000ic165f", Language::Ls, [10.0, 10.0, -20.0, 5.0, -60.0, 20.0]),
    ("ur10e", Language::Urscript, [10.0, -80.0, 100.0, -110.0, -90.0, 20.0]),
];

fn cell(robot: &str) -> Cell {
    let text = format!(
        "format = 1\nrobot.catalogue = '{robot}'\n\
         tool = {{ loading_point_mm = [200, 0, 250], measuring_point = [{{ name = '1', position_mm = [0, 0, 300] }}] }}\n\
         load = {{ kind = 'measured' }}\n[work]\ntip_mm = [10, 0, 300]\ntip_rpy_deg = [0, 30, 0]\n\
         workpiece_mm = [900, -200, 412.25]\nworkpiece_rpy_deg = [10, -20, 35]\n"
    );
    parse_cell(&text, "cell.toml").unwrap()
}

/// Five postures a little apart, and the poses of the tip there.
fn points(cell: &Cell, q: &[f64; 6]) -> (Vec<Vec<f64>>, Vec<PathPoint>) {
    let robot = &cell.setup.robot;
    let postures = (0..5).map(|k| {
        let q = q.iter().enumerate();
        q.map(|(j, q)| (q + 0.3 * f64::from(k) * (1.0 + j as f64)).to_radians()).collect::<Vec<f64>>()
    });
    let postures: Vec<Vec<f64>> = postures.collect();
    let points = postures.iter().zip(1..).map(|(q, number)| {
        let frames = Frames::new(robot, q);
        let pose = frames.flange() * cell.work.tip(&cell.setup.tool);
        path_point(number, PathTarget::Pose(pose))
    });
    let points = points.collect();
    (postures, points)
}

fn posed<'a>(q: &'a [Vec<f64>], points: &[PathPoint]) -> Vec<PosedPoint<'a>> {
    let pairs = q.iter().zip(points).map(|(q, point)| match &point.target {
        PathTarget::Pose(pose) => (*pose, q.as_slice()),
        _ => panic!("the points are poses"),
    });
    pairs.collect()
}

fn options(name: &str) -> MoveOptions {
    MoveOptions { name: name.to_string(), header: vec!["A test".to_string()], speed_mm_s: 20.0, tool: None, base: None }
}

#[test]
fn what_is_written_is_read_as_the_same_path() -> Check {
    let mut shown = String::new();
    for (robot, language, q) in ROBOTS {
        let cell = cell(robot);
        let (q, points) = points(&cell, &q);
        let text = write_moves(language, &cell, &posed(&q, &points), &options("PART"))?;
        let name = format!("part.{}", language.as_str());
        let read = read_tool_path(Kind::Robot(language), (&name, text.as_bytes()), None, &cell)?;
        // The first is a joint move.
        let (position, angle) = apart(&stated(&read), &points[1..]);
        let (length, turn) = if language == Language::Ls { (1e-6, 3e-5) } else { (1e-7, 3e-7) };
        assert!(position < length && angle < turn, "{robot}: {position} m, {angle} rad\n{text}");
        shown += &format!("== {name}\n{}", text.replace('\r', ""));
    }
    insta::assert_snapshot!(shown);
    Ok(())
}

#[test]
fn what_cannot_be_written_is_refused() {
    let (robot, language, q) = ROBOTS[0];
    let cell = cell(robot);
    let (q, points) = points(&cell, &q);
    let code = |language, options: &MoveOptions| {
        let written = write_moves(language, &cell, &posed(&q, &points), options);
        written.map_err(|error: Error| error.code()).err()
    };
    assert_eq!(code(Language::Rapid, &options("part")), Some(Code::Conflict));
    assert_eq!(code(Language::Pdl2, &options("part")), Some(Code::Unsupported));
    assert_eq!(code(language, &options("9 part")), Some(Code::InvalidValue));
    let still = MoveOptions { speed_mm_s: 0.0, ..options("part") };
    assert_eq!(code(language, &still), Some(Code::InvalidValue));
    assert_eq!(code(language, &options("part")), None);
}
