//! Controller programs: each passes a strict checker of its language that knows nothing of the
//! library, and is read back to the same moves.

mod characters;
mod grammar;
mod inform;
mod krl;
mod ls;
mod pdl2;
mod rapid;
mod reading;
mod statements;
mod urscript;

use super::common::random::Dice;
use super::common::set_ups::panda;
use grammar::{Checked, Parsed};
use proptest::prelude::*;
use std::fmt::Write;
use stiffarm::Cell;
use stiffarm::model::posture::Posture;
use stiffarm::model::robot::Robot;
use stiffarm::plan::feasibility::forbidden;
use stiffarm_files::program::{
    Language, Program, ProgramFile, ProgramOptions, Start, Step, Stop, program_of_stops, read_program, write_program,
};

/// The six languages of controllers.
const CONTROLLERS: [Language; 6] =
    [Language::Krl, Language::Rapid, Language::Ls, Language::Inform, Language::Pdl2, Language::Urscript];

/// As different as they are on real arms, both signs.
const PULSES: [f64; 7] = [1341.38, 1341.38, -1341.38, 1000.0, 1000.0, 622.222, 1341.38];

/// What a language needs for a robot of six or seven joints.
fn options(language: Language, joints: usize) -> ProgramOptions {
    let seven = (joints == 7).then(|| vec![1, 2, 7, 3, 4, 5, 6]);
    ProgramOptions {
        controller_axes: seven,
        pulses_per_degree: (language == Language::Inform).then(|| PULSES[..joints].to_vec()),
        tool: None,
    }
}

fn check(language: Language, files: &[ProgramFile], joints: usize) -> Checked {
    match language {
        Language::Krl => krl::check(files, joints),
        Language::Rapid => rapid::check(files, joints),
        Language::Ls => ls::check(files, joints),
        Language::Inform => inform::check(files, joints),
        Language::Pdl2 => pdl2::check(files, joints),
        _ => urscript::check(files, joints),
    }
}

/// What `program` should be found to do: values in the controller's order, degrees or pulses
/// before rounding.
fn expected(language: Language, program: &Program) -> Parsed {
    let mut parsed = Parsed::default();
    for step in &program.steps {
        match step {
            Step::Wait(said) => parsed.waits.push(said.clone()),
            Step::Move(target) => {
                let mut q: Vec<f64> = target.q.iter().map(|a| a.to_degrees()).collect();
                if q.len() == 7 && language != Language::Csv {
                    // Joint 3 of the chain is axis 7.
                    let third = q.remove(2);
                    q.push(third);
                }
                if language == Language::Inform {
                    q.iter_mut().zip(PULSES).for_each(|(q, scale)| *q *= scale);
                }
                parsed.moves.push((q, f64::from(target.speed_percent)));
            }
        }
    }
    parsed
}

/// A seven-joint arm: the rows of Franka's Panda, with its limits in whole degrees.
fn seven_joints() -> Robot {
    let limits = [[-166, 166], [-101, 101], [-166, 166], [-176, -4], [-166, 166], [-1, 215], [-166, 166]];
    let limits = limits.map(|pair| pair.map(|deg| f64::from(deg).to_radians()));
    panda().with_limits(&limits).unwrap()
}

/// An angle in radians, in whole hundredths of a degree where asked.
fn rounded(angle: f64, hundredths: bool) -> f64 {
    if hundredths { ((angle.to_degrees() * 100.0).round() / 100.0).to_radians() } else { angle }
}

/// Random postures that the cell allows.
fn feasible(cell: &Cell, count: usize, hundredths: bool, seed: u64) -> Vec<Posture> {
    let mut dice = Dice::new(seed);
    let mut postures = Vec::new();
    while postures.len() < count {
        let bounds = cell.bounds.iter();
        let q: Vec<f64> = bounds.map(|b| rounded(dice.between(b[0], b[1]), hundredths)).collect();
        if forbidden(cell, &q).unwrap().is_none() {
            let name = format!("p{}", postures.len() + 1);
            postures.push(Posture { name, q });
        }
    }
    postures
}

/// Random postures within the limits of a robot.
fn within(robot: &Robot, count: usize, hundredths: bool, seed: u64) -> Vec<Posture> {
    let mut dice = Dice::new(seed);
    let posture = |number: usize| {
        let limits = robot.joints().iter().map(|joint| joint.limits);
        let q = limits.map(|l| rounded(dice.between(l[0], l[1]), hundredths));
        Posture { name: format!("p{}", number + 1), q: q.collect() }
    };
    (0..count).map(posture).collect()
}

/// A program with everything in it: a start, ways, texts before a move.
fn program(language: Language, postures: &[Posture]) -> Program {
    let mut stops: Vec<Stop> =
        postures.iter().map(|posture| Stop::new(posture.clone(), "measure unloaded, loaded, unloaded-2")).collect();
    if let [first, second, ..] = postures {
        let half = first.q.iter().zip(&second.q).map(|(a, b)| 0.5 * (a + b));
        // A way has as many digits as its postures.
        let via = half.map(|angle| rounded(angle, true)).collect();
        stops[1].via.push(Posture { name: "p1-p2".into(), q: via });
        stops[1].before.push("Unhook the rope before this move".into());
    }
    let home = Posture { name: "home".into(), q: postures[0].q.iter().map(|a| rounded(0.5 * a, true)).collect() };
    let start = Start { back: Vec::new(), posture: home };
    let header = vec!["Generated motion program.".to_string(), format!("plan sha256 {}", "a1".repeat(32))];
    program_of_stops(language.name_for("plan a"), header, &stops, Some(&start), 10)
}

#[test]
fn the_way_back_to_the_start_has_via_postures_too() {
    let posture = |name: &str, angle: f64| Posture { name: name.into(), q: vec![angle; 6] };
    let start = Start { posture: posture("home", 0.0), back: vec![posture("over", 0.1), posture("under", 0.2)] };
    let stops = [Stop::new(posture("1", 0.3), "measure")];
    let program = program_of_stops("plan", vec![], &stops, Some(&start), 10);
    let names: Vec<&str> = program.moves().map(|target| target.name.as_str()).collect();
    assert_eq!(names, ["home", "1", "over", "under", "home"]);
}

/// Written, checked and read back: all three agree.
fn agrees(language: Language, program: &Program, joints: usize, hundredths: bool) {
    let options = options(language, joints);
    let files = write_program(program, language, &options).unwrap();
    assert_eq!(files, write_program(program, language, &options).unwrap());
    let parsed = check(language, &files, joints).unwrap_or_else(|e| panic!("{language:?}: {e}\n{}", files[0].text));
    let wanted = expected(language, program);
    // Half of the last digit: of pulses, of degrees.
    let digit = match (language, hundredths) {
        (Language::Inform, _) => 0.5 + 1e-6,
        (_, true) => 1e-6,
        (Language::Ls, false) => 0.5e-3 + 1e-9,
        (_, false) => 0.5e-4 + 1e-6,
    };
    assert_eq!(parsed.waits, wanted.waits, "{language:?}");
    assert_eq!(parsed.moves.len(), wanted.moves.len(), "{language:?}");
    for ((q, speed), (planned, percent)) in parsed.moves.iter().zip(&wanted.moves) {
        assert_eq!(speed, percent, "{language:?}");
        for (a, b) in q.iter().zip(planned) {
            assert!((a - b).abs() <= digit, "{language:?}: {a} {b}");
        }
    }
    let read = read_program(&files, language, &options, joints).unwrap();
    assert_eq!(read.name, program.name);
    assert_eq!(read.steps.len(), program.steps.len());
    for (read, step) in read.steps.iter().zip(&program.steps) {
        match (read, step) {
            (Step::Wait(read), Step::Wait(said)) => assert_eq!(read, said),
            (Step::Move(read), Step::Move(target)) => {
                assert_eq!(
                    (&read.name, read.kind, read.speed_percent),
                    (&target.name, target.kind, target.speed_percent)
                );
                for (j, (a, b)) in read.q.iter().zip(&target.q).enumerate() {
                    let tolerance = match language {
                        Language::Inform => 0.51 / 600.0,
                        _ => digit,
                    };
                    assert!((a - b).to_degrees().abs() <= tolerance, "{language:?} joint {j}: {a} {b}");
                }
            }
            _ => panic!("{language:?}: {read:?} {step:?}"),
        }
    }
}

#[test]
fn programs_of_6_and_50_postures_are_sound_and_read_back() {
    let cell = stiffarm_files::builtin::cell("comau").unwrap();
    let seven = seven_joints();
    for (count, hundredths, seed) in [(6, true, 1), (50, true, 2), (6, false, 3), (50, false, 4)] {
        let six = feasible(&cell, count, hundredths, seed);
        let arm_of_seven = within(&seven, count, hundredths, seed);
        for language in CONTROLLERS {
            agrees(language, &program(language, &six), 6, hundredths);
            if language != Language::Urscript {
                agrees(language, &program(language, &arm_of_seven), 7, hundredths);
            }
        }
    }
}

#[test]
fn a_table_is_read_back_to_the_last_bit() {
    let robot = seven_joints();
    let mut written = program(Language::Csv, &within(&robot, 50, true, 9));
    let Step::Move(first) = &mut written.steps[1] else { panic!() };
    first.name = "Größe \"A\", #1".to_string();
    written.header.clear();
    let files = write_program(&written, Language::Csv, &ProgramOptions::default()).unwrap();
    let read = read_program(&files, Language::Csv, &ProgramOptions::default(), 7).unwrap();
    assert_eq!(read, written);
}

/// A small program of each language.
fn small() -> Program {
    let posture = |name: &str, q: [f64; 6]| Posture { name: name.into(), q: q.map(f64::to_radians).into() };
    let postures =
        [posture("p1", [10.0, -20.0, 95.5, 0.0, 45.25, -180.0]), posture("p2", [-10.0, 0.0, 80.0, 5.0, 30.0, 0.0])];
    program(Language::Ls, &postures)
}

/// The same as it is written in this language.
fn written(language: Language) -> (Program, Vec<ProgramFile>) {
    let mut program = small();
    program.name = language.name_for("plan");
    let files = write_program(&program, language, &options(language, 6)).unwrap();
    (program, files)
}

#[test]
fn snapshots_of_a_small_program() {
    for language in Language::ALL {
        let (_, files) = written(language);
        let mut shown = String::new();
        for file in &files {
            let ends = if file.text.contains("\r\n") { "CR LF" } else { "LF" };
            writeln!(shown, "== {} ({ends})\n{}", file.name, file.text.replace("\r\n", "\n")).unwrap();
        }
        insta::assert_snapshot!(format!("program_{}", language.as_str()), shown);
    }
}

/// Files with line `at` of file `file` replaced.
fn with_line(files: &[ProgramFile], file: usize, at: usize, new: Option<String>) -> Vec<ProgramFile> {
    let mut files = files.to_vec();
    let end = if files[file].text.contains("\r\n") { "\r\n" } else { "\n" };
    let mut lines: Vec<String> = files[file].text.split(end).map(String::from).collect();
    match new {
        Some(new) => lines[at] = new,
        None => {
            lines.remove(at);
        }
    }
    files[file].text = lines.join(end);
    files
}

/// Where the comment of a line begins, if it has one.
fn is_comment(language: Language, line: &str) -> bool {
    let line = line.trim_start();
    match language {
        Language::Krl => line.starts_with("; "),
        Language::Rapid => line.starts_with('!'),
        Language::Ls => line.split_once(':').is_some_and(|(_, rest)| rest.trim_start().starts_with('!')),
        // Comments with a text are checked.
        Language::Inform => line.starts_with('\'') && !line.starts_with("'>"),
        Language::Pdl2 => line.starts_with("--"),
        _ => line.starts_with('#'),
    }
}

#[test]
fn the_checkers_find_every_line_and_every_sign_that_is_missing() {
    for language in CONTROLLERS {
        let (_, files) = written(language);
        let sound = check(language, &files, 6).unwrap();
        let differs = |broken: &[ProgramFile]| {
            check(language, broken, 6) != Ok(Parsed { moves: sound.moves.clone(), waits: sound.waits.clone() })
        };
        let mut tried = 0;
        for (f, file) in files.iter().enumerate() {
            let lines: Vec<&str> = file.text.lines().collect();
            for (l, line) in lines.iter().enumerate() {
                if is_comment(language, line) {
                    continue;
                }
                assert!(differs(&with_line(&files, f, l, None)), "{language:?} without line: {line}");
                for (at, sign) in line.char_indices().filter(|(_, c)| "()[]{}\"';:,=%#/!&$".contains(*c)) {
                    let mut new = line.to_string();
                    new.remove(at);
                    assert!(
                        differs(&with_line(&files, f, l, Some(new))),
                        "{language:?} without {sign} at {at}: {line}"
                    );
                    tried += 1;
                }
                let again = format!("{line}\n{line}");
                assert!(differs(&with_line(&files, f, l, Some(again))), "{language:?} twice: {line}");
            }
        }
        assert!(tried > 50, "{language:?} {tried}");
    }
}

#[test]
fn the_checkers_find_wrong_counts_names_and_characters() {
    let broken = |language: Language, old: &str, new: &str| {
        let mut program = small();
        program.name = language.name_for("plan");
        let mut files = write_program(&program, language, &options(language, 6)).unwrap();
        let file = files.iter_mut().find(|file| file.text.contains(old)).unwrap();
        file.text = file.text.replacen(old, new, 1);
        assert!(check(language, &files, 6).is_err(), "{language:?}: {old} -> {new}");
    };
    broken(Language::Ls, "LINE_COUNT\t= ", "LINE_COUNT\t= 1");
    broken(Language::Ls, "MESSAGE[Cell", "MESSAGE[Cellllllllllllllllllllll");
    broken(Language::Ls, "J P[2]", "J P[3]");
    broken(Language::Ls, "J1= ", "J7= ");
    broken(Language::Inform, "///NPOS 5", "///NPOS 6");
    broken(Language::Inform, "MOVJ C00001", "MOVJ C00009");
    broken(Language::Inform, "VJ=5.00", "VJ=5");
    broken(Language::Krl, "PTP XP2", "PTP XP9");
    broken(Language::Krl, "A4 0.00,", "");
    broken(Language::Krl, "#VEL_PTP,5", "#VEL_PTP,0");
    broken(Language::Rapid, "9E9,9E9]", "9E9]");
    broken(Language::Rapid, "MoveAbsJ jp1,v1000,fine", "MoveAbsJ jp1,v1000,z10");
    broken(Language::Pdl2, "MOVE JOINT TO {", "MOVE LINEAR TO {");
    broken(Language::Pdl2, "-20.00", "-20,00");
    broken(Language::Urscript, "blocking=True", "blocking=False");
    broken(Language::Urscript, "Unhook", "Unhöök");
}

proptest! {
    #![proptest_config(super::common::cases(48))]

    #[test]
    fn any_names_and_texts_give_sound_programs(
        names in prop::collection::vec("\\PC{1,60}", 2),
        task in ".{0,200}",
        plan in ".{0,60}",
        before in ".{0,80}",
    ) {
        for language in CONTROLLERS {
            let posture = |name: &str, a: f64| Posture { name: name.to_string(), q: vec![a.to_radians(); 6] };
            let mut stops = [Stop::new(posture(&names[0], 1.5), task.clone()), Stop::new(posture(&names[1], -2.25), task.clone())];
            stops[0].before.push(before.clone());
            let name = language.name_for(&plan);
            prop_assert!(language.check_name(&name).is_ok(), "{}", name);
            let program = program_of_stops(name, vec![plan.clone()], &stops, None, 100);
            let options = options(language, 6);
            let files = write_program(&program, language, &options).unwrap();
            let parsed = check(language, &files, 6);
            prop_assert!(parsed.is_ok(), "{:?} {:?}\n{}", language, parsed, files[0].text);
            let read = read_program(&files, language, &options, 6).unwrap();
            prop_assert_eq!(read.moves().count(), 2);
            let tolerance = match language {
                Language::Inform => 2e-5,
                Language::Urscript => 1e-8,
                _ => 1e-9,
            };
            for (read, target) in read.moves().zip(program.moves()) {
                for (a, b) in read.q.iter().zip(&target.q) {
                    prop_assert!((a - b).abs() < tolerance);
                }
            }
        }
    }
}
