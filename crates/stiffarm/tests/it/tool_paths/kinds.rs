//! What a path is written in is told by its ending, by what stands in it, or by the caller.

use stiffarm::Code;
use stiffarm_files::program::Language;
use stiffarm_files::tool_path::{Kind, LANGUAGES, PathLanguage, recognised};

const GCODE: &str = "%\nO1234 (PART)\nN10 G90 G54\nN20 G0 X1. Y2. Z3.\n";

#[test]
fn endings_that_say_nothing_are_looked_into() {
    let robot = |language| Some(Kind::Robot(language));
    let rows = [
        ("a.ptp", GCODE, Some(Kind::Gcode), true),
        ("a.txt", GCODE, Some(Kind::Gcode), true),
        ("standard input", "N1G1X1Y2\n", Some(Kind::Gcode), true),
        // The ending says it.
        ("a.nc", GCODE, Some(Kind::Gcode), false),
        ("a.mpf", GCODE, Some(Kind::Gcode), false),
        ("a.txt", "PARTNO A\nFROM / 0, 0, 50\nGOTO / 0, 0, 1\n", Some(Kind::Apt), true),
        ("a.txt", "TOOL PATH/A,TOOL,T1\n", Some(Kind::Apt), true),
        ("a.txt", "partno a\nGoto/0,0,1\n", Some(Kind::Apt), true),
        ("a.txt", "MODULE a\nENDMODULE\n", robot(Language::Rapid), true),
        ("a.txt", "/PROG  A\n/MN\n", robot(Language::Ls), true),
        ("a.txt", "/JOB\n//NAME A\n", robot(Language::Inform), true),
        ("a.txt", "/job\n//NAME A\n", robot(Language::Inform), true),
        ("a.txt", "&ACCESS RVP\nDEF a ( )\n", robot(Language::Krl), true),
        ("a.txt", "def a():\n  movel(p[0,0,0,0,0,0])\nend\n", robot(Language::Urscript), true),
        // Tables.
        ("a.txt", "x_mm;y_mm;z_mm\n1;2;3\n", None, false),
        ("a.csv", GCODE, None, false),
        ("a", "point x_mm\nG1 2\n", None, false),
        ("a.txt", "GLOBAL X1\n", None, false),
        ("a.txt", "", None, false),
    ];
    let mut report = String::new();
    for (name, text, kind, is_said) in rows {
        let (recognised, finding) = recognised(name, text.as_bytes(), None).unwrap();
        assert_eq!((recognised, finding.is_some()), (kind, is_said), "{name}: {text}");
        let sentence = finding.map_or("nothing is said".to_string(), |finding| finding.sentence);
        report += &format!("{name}: {}: {sentence}\n", text.lines().next().unwrap_or_default());
    }
    insta::assert_snapshot!("recognised_paths", report);
}

#[test]
fn the_caller_decides() {
    for (_, _, language) in LANGUAGES {
        let wanted = match language {
            PathLanguage::Table => None,
            PathLanguage::Program(kind) => Some(*kind),
        };
        let outcome = recognised("a.nc", GCODE.as_bytes(), Some(*language)).unwrap();
        assert_eq!(outcome, (wanted, None));
    }
}

#[test]
fn a_heidenhain_program_is_refused_whatever_its_ending() {
    for name in ["part.h", "part.txt", "part.nc", "part.cnc"] {
        let error = recognised(name, b"0  BEGIN PGM PART MM\n1  L X+10 R0 FMAX\n", None).unwrap_err();
        assert_eq!((error.code(), error.place().line), (Code::Unsupported, Some(1)));
    }
}
