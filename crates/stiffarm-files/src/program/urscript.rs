//! Universal Robots' URScript: a function in a `.script`.
//!
//! Grammar: Universal Robots, *The URScript Programming Language* (G5 and e-Series, 2009–2021): `movej(q, a, v)`
//! takes six joint angles in radians, an acceleration in rad/s² and the speed of the leading joint in
//! rad/s; without a blend radius it ends at rest. `popup(…, blocking=True)` waits until it is
//! confirmed. Comments begin with `#`.
//!
//! LF: the controller runs Linux.

use super::characters::said;
use super::cursor::{Cursor, lines};
use super::dialect::{Angles, Dialect, Moves, PoseForm, Syntax};
use super::flow::Procedures;
use super::move_target::{Motion, MoveTarget};
use super::reader::Reader;
use super::text::fixed;
use stiffarm::error::Result;
use stiffarm::model::pose::Convention;
use stiffarm::model::robot::Controller;
use stiffarm::units::{deg_to_rad, rad_to_deg};

/// Speed at 100 per cent \[deg/s\], that of `movej` where none is stated.
const FULL_SPEED: f64 = 60.0;
/// \[rad/s²\]; `movej` has 1.4 where none is stated.
const ACCELERATION: f64 = 0.5;

pub const URSCRIPT: Dialect = Dialect {
    name: "urscript",
    title: "URScript",
    controller: Some(Controller::Ur),
    axes: [6, 6],
    speed_of: "60 deg/s of the fastest joint",
    longest_name: 60,
    reserved: "and break continue def elif else end false for global halt if join kill local loop movej not \
               or pass popup return run sec sync thread true while xor",
    syntax: Some(Syntax {
        files: &[("script", FUNCTION)],
        line_end: "\n",
        marker: |named| format!("  # {named}"),
        movement: |to| {
            // Of the degrees that stand beside them; two more decimals than those need.
            let radians = to.values.iter().map(|value| deg_to_rad(value.parse().unwrap_or(f64::NAN)));
            let radians: Vec<String> = radians.map(|angle| fixed(angle, 8)).collect();
            let speed = deg_to_rad(FULL_SPEED) * f64::from(to.speed_percent) / 100.0;
            let radians = radians.join(", ");
            vec![
                format!("  # [{}] deg", to.values.join(", ")),
                format!("  movej([{radians}], a={ACCELERATION}, v={speed:.4})"),
            ]
        },
        wait: |text| {
            let said = said(text, usize::MAX).concat();
            vec![format!("  popup(\"{said}\", title=\"stiffarm\", blocking=True)")]
        },
        read,
        joint_move: "movej",
        other_moves: &[
            "movel",
            "movep",
            "movec",
            "optimovej",
            "optimovel",
            "servoj",
            "servoc",
            "servop",
            "speedj",
            "speedl",
            "speed_loop",
            "mc_add_linear",
            "mc_add_circular",
            "mc_add_path",
            "mc_run_motion",
            "track_conveyor_linear",
            "track_conveyor_circular",
            "path_offset_enable",
            "path_offset_set",
            "freedrive_mode",
            "teach_mode",
            "tool_contact",
        ],
        branches: &["while", "if", "elif", "for", "thread", "force_mode", "screw_driving", "move_until_contact"],
        procedures: Some(PROCEDURES),
        poses: Some(PoseForm {
            convention: Convention::Ur,
            unit: 1.0,
            degrees: false,
            before: &[],
            decimals: [7, 8],
            in_base: true,
            null_frames: &[],
            turns_on_the_way: false,
            moves: Some(Moves {
                template: FUNCTION,
                frames: ["", ""],
                most: usize::MAX,
                lines: |to| {
                    vec![match to.number {
                        1 => {
                            let radians = to.angles.iter().map(|angle| deg_to_rad(angle.parse().unwrap_or(f64::NAN)));
                            let radians: Vec<String> = radians.map(|angle| fixed(angle, 8)).collect();
                            format!("  movej([{}], a={ACCELERATION}, v=0.1)", radians.join(", "))
                        }
                        _ => format!(
                            "  movel(p[{}], a={ACCELERATION}, v={}, r=0.0005)",
                            to.pose.join(", "),
                            fixed(to.speed_mm_s / 1e3, 5)
                        ),
                    }]
                },
                point: |_| Vec::new(),
            }),
        }),
        missing_point: "The program has no joint position",
        comment: "#",
        angle_words: &["movej"],
        angles: Angles::After("["),
        ..Syntax::USUAL
    }),
    ..Dialect::USUAL
};

const FUNCTION: &str = "\
def {name}():
  # {header}
{body}
end
";

const PROCEDURES: Procedures = Procedures {
    statements: |file| lines(file).collect(),
    scopes: &[],
    begin: &["def"],
    end: &["end"],
    blocks: &["if", "while", "for", "thread", "sec"],
    handlers: &[],
    first_is_main: false,
    call,
};

/// `name(…)`.
fn call<'a>(statement: &Cursor<'a>) -> Option<&'a str> {
    let mut line = statement.clone();
    let name = line.identifier().ok()?;
    line.passes("(").then_some(name)
}

/// The words of moves of a tool path.
const MOVES: [(&str, Motion); 4] =
    [("movel", Motion::Linear), ("movep", Motion::Linear), ("movec", Motion::Circular), ("movej", Motion::Joint)];

fn read<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    if line.passes("#") {
        reader.comment(line.rest());
    } else if line.word("def") {
        reader.named(line.identifier()?);
    } else if line.word("popup") {
        line.expect("(")?;
        reader.say(line.quoted('"')?);
        if line.rest().contains("blocking=True") {
            reader.wait();
        }
    } else if let Some(motion) = line.motion(if reader.is_path { &MOVES } else { &[] }) {
        line.expect("(")?;
        reader.move_to(line, motion, move_target)?;
        reader.at_feed(feed(line.rest()));
        let rest: String = line.rest().split_whitespace().collect();
        if motion == Motion::Circular
            && (rest.contains("mode=1") || rest.split(',').nth(4).is_some_and(|mode| mode.starts_with('1')))
        {
            return Err(line.wrong_here("An arc that turns the tool along with it (mode=1) is not read here."));
        }
    } else if reader.is_path && line.word("set_tcp") {
        line.expect("(")?;
        let number = line.line_number();
        match move_target(line, reader)? {
            MoveTarget::Pose(pose) => {
                reader.frames.insert("TCP".to_string(), vec![*pose]);
                reader.takes(0, "TCP", number);
            }
            MoveTarget::Label(_, name) => {
                // A pose that has a name.
                let target = reader.target_of(&name);
                let factors = match target {
                    Some(MoveTarget::Pose(pose)) => vec![(**pose).clone()],
                    _ => Vec::new(),
                };
                reader.frames.insert(name.to_ascii_uppercase(), factors);
                reader.takes(0, name, number);
            }
            _ => {}
        }
    } else if reader.is_path && assigns(line, reader)? {
    } else if let Some((name, _)) = line.assigned().filter(|_| reader.is_path) {
        let name = name.split('[').next().unwrap_or_default();
        reader.sets(line, name);
    } else if line.word("movej") {
        let start = line.clone();
        line.expect("(")?;
        line.expect("[")?;
        let q = line.list(reader.joints, |line, _| {
            let place = line.clone();
            let angle = line.number()?;
            if angle.abs() > 1e3 {
                return Err(place.wrong("This is not a joint angle in radians."));
            }
            Ok(angle)
        })?;
        line.expect("]")?;
        reader.speed = 100;
        while line.passes(",") {
            reader.speed = parameter(line)?.unwrap_or(reader.speed);
        }
        line.expect(")")?;
        line.end()?;
        let target = reader.angles(&q);
        reader.go(start, target);
    } else {
        return Ok(false);
    }
    Ok(true)
}

/// The feed behind the pose of `movel(p[…], a, v, t)` \[m/s\]; a time takes its place.
fn feed(rest: &str) -> Option<f64> {
    let end = rest.find([')', '#']).unwrap_or(rest.len());
    let parts = rest[..end].split(',').map(str::trim).skip(1);
    let mut parameters = [None; 3];
    for (at, part) in parts.enumerate() {
        let (name, value) = part.split_once('=').unwrap_or(("", part));
        let named = ["a", "v", "t"].iter().position(|key| *key == name.trim());
        if let Some(number) = parameters.get_mut(named.unwrap_or(at)).filter(|_| named.is_some() || name.is_empty()) {
            *number = value.trim().parse::<f64>().ok();
        }
    }
    parameters[1].filter(|_| parameters[2].is_none_or(|time| time == 0.0))
}

/// `name = p[…]`, with or without `global`.
fn assigns<'a>(line: &mut Cursor<'a>, reader: &mut Reader<'a>) -> Result<bool> {
    let _ = line.word("global") || line.word("local");
    let mut next = line.clone();
    let Ok(name) = next.identifier() else {
        return Ok(false);
    };
    if !next.passes("=") || !next.clone().passes("p[") && !next.clone().passes("[") {
        return Ok(false);
    }
    let mut whole = next.clone();
    if move_target(&mut whole, reader).is_err() || !whole.is_done() && !whole.passes("#") {
        // It is calculated.
        return Ok(false);
    }
    *line = next;
    let target = move_target(line, reader)?;
    reader.point(name, target);
    Ok(true)
}

/// `p[x, y, z, rx, ry, rz]`, `[q1, …]`, or the name of a pose.
fn move_target<'a>(line: &mut Cursor<'a>, reader: &Reader<'a>) -> Result<MoveTarget<'a>> {
    if line.passes("p[") {
        let mut numbers = [None; 7];
        for (at, number) in numbers.iter_mut().take(6).enumerate() {
            if at > 0 {
                line.expect(",")?;
            }
            *number = Some(line.placed()?);
        }
        line.expect("]")?;
        return Ok(MoveTarget::Pose(reader.pose(numbers, line)));
    }
    if line.passes("[") {
        let q = line.list(reader.joints, |line, _| line.number())?;
        line.expect("]")?;
        return Ok(reader.angles(&q));
    }
    line.label()
}

/// `a=…`, or `v=…` as a speed in per cent.
fn parameter(line: &mut Cursor<'_>) -> Result<Option<u8>> {
    let mut place = line.clone();
    let key = line.identifier()?;
    line.expect("=")?;
    let value = line.number()?;
    let percent = (rad_to_deg(value) / FULL_SPEED * 100.0).round();
    match key {
        "v" if (1.0..=100.0).contains(&percent) => Ok(Some(percent as u8)),
        "v" => Err(place.wrong_here(format!("The speed must lie between 1 and 100 per cent of {FULL_SPEED} deg/s."))),
        "a" => Ok(None),
        "t" | "r" if value == 0.0 => Ok(None),
        _ => Err(place.wrong_here(format!("`{key}` is not read here: the move has a time, or does not end at rest."))),
    }
}
