//! G-code is read as its control drives it: units, inches, rotary axes, cycles, and what is not followed.

use super::{Check, axes, cell_with, codes, positions, read, read_with, rounded, stated, unit};
use nalgebra::Vector3;
use std::f64::consts::PI;
use stiffarm::findings::Severity;
use stiffarm_files::table::{PathFormat, PathKind, read_path, write_path};

#[test]
fn words_are_modal_and_may_have_blanks() -> Check {
    let text = "%\nO100 (POCKET)\nN10 G21 G90 G17 G40 G54\nN20 T1 M6\nN30 G0 X   4.310 Y-2.\nG43 Z5 H1\n\
                n40 g1 z-1.5 F300 ; plunge\nX10 (along) Y +3\n\nY.5\n/ Z5\nM30\n%\n";
    let path = read("a.nc", text)?;
    let expected = [[4.31, -2.0, 5.0], [4.31, -2.0, -1.5], [10.0, 3.0, -1.5], [10.0, 0.5, -1.5], [10.0, 0.5, 5.0]];
    let points = stated(&path);
    assert_eq!(rounded(&points), expected);
    let rapid: Vec<bool> = points.iter().map(|point| point.rapid).collect();
    assert_eq!(rapid, [true, false, false, false, false]);
    let lines: Vec<Option<usize>> = points.iter().map(|point| point.line).collect();
    assert_eq!(lines, [6, 7, 8, 10, 11].map(Some));
    assert!(points[0].load.is_some_and(|load| load.force == Vector3::zeros()));
    assert_eq!(points[1].load, None);
    assert!(axes(&points).iter().all(|axis| (axis - Vector3::z()).norm() < 1e-12));
    assert_eq!(codes(&path), ["optional-blocks"]);
    Ok(())
}

#[test]
fn inches_and_steps() -> Check {
    let path = read("a.ngc", "G20 G90\n#<rate>=1000\nG0 X0 Y0 Z1 F#<rate> S[100*2]\nG91 G1 X1 Z-.5\nX1\nG90 X0\n")?;
    let expected = [[0.0, 0.0, 25.4], [25.4, 0.0, 12.7], [50.8, 0.0, 12.7], [0.0, 0.0, 12.7]];
    assert_eq!(rounded(&stated(&path)), expected);
    Ok(())
}

#[test]
fn inches_that_no_word_names_are_said() -> Check {
    let program = |head: &str, speed: &str, numbers: [&str; 6]| {
        let [lift, above, depth, plunge, far, feed] = numbers;
        format!(
            "%\nO1001 (BRACKET)\n{head}G90 G17 G40\nT1 M6\n{speed}\nG54\nG0 X-1 Y-.5\nG43 H1 Z{lift}\nZ{above}\n\
             G1 Z{depth} F{plunge}\nX{far} F{feed}\nY2.125\nX-1\nG0 Z{lift}\nM30\n%\n"
        )
    };
    let said = |text: &str| -> Result<Option<String>, Box<dyn std::error::Error>> {
        let findings = read("a.nc", text)?.findings;
        let first = findings.into_iter().find(|f| f.code == "maybe-inches");
        Ok(first.map(|finding| finding.sentence))
    };
    let inches = ["1.", ".1", "-.25", "10.", "3.375", "40."];
    let fine = ["1.", ".1", "-.0625", "5.", "3.3755", "12.5"];
    insta::assert_snapshot!(said(&program("", "S5000 M3", inches))?.unwrap(), @"The program names no unit and is read in millimetres: its cuts span 4.375 × 2.625 × 0.000 mm, with feeds up to 40 mm/min (0.0080 mm for a turn of the spindle). If these are inches, write G20 at its head; G21 settles it otherwise (line 8).");
    // Where no speed is known, the decimals speak.
    assert!(said(&program("", "", fine).replace("Y2.125", "Y2.1255"))?.is_some());
    assert_eq!(said(&program("", "", inches))?, None);
    for word in ["G20\n", "G21\n", "G71\n"] {
        assert_eq!(said(&program(word, "S5000 M3", inches))?, None);
    }
    // Millimetres: a steel part, a small one, an engraving, a plate.
    for (speed, numbers) in [
        ("S800 M3", ["50", "2", "-1", "30", "8", "60"]),
        ("(1/4 INCH END MILL)\nS10000 M3", ["10", "2", "-.5", "100", "6.5", "250"]),
        ("S24000 M3", ["2", ".5", "-.1", "120", "12", "300"]),
        ("S20000 M3", ["5", "1", "-.2", "60", "20", "150"]),
        ("S6000 M3", ["50", "5", "-3", "200", "180", "1200"]),
        ("", ["5", "1", "-.5", "50", "10", "60"]),
    ] {
        assert_eq!(said(&program("", speed, numbers))?, None, "{speed} {numbers:?}");
    }
    Ok(())
}

/// Points lie on the circle, chords within the tolerance, in the sense asked for.
fn check_arc(text: &str, centre: [f64; 3], radius: f64, sweep: f64, plane: [usize; 2]) -> Check {
    let path = read("a.nc", text)?;
    let all = positions(&path);
    let centre = Vector3::from(centre);
    let polar = |p: &[f64; 3]| {
        let off = Vector3::from(*p) - centre;
        (off[plane[0]].hypot(off[plane[1]]), off[plane[1]].atan2(off[plane[0]]))
    };
    let mut turned = 0.0;
    for pair in all.windows(2) {
        let ((r, from), (_, to)) = (polar(&pair[0]), polar(&pair[1]));
        assert!((r - radius).abs() < 2e-3, "{text}: radius {r}");
        let step = (to - from + PI).rem_euclid(2.0 * PI) - PI;
        assert!(step * sweep > 0.0, "{text}: the wrong way round");
        assert!(radius * (1.0 - (step / 2.0).cos()) < 0.0101, "{text}: a chord is too long");
        turned += step;
    }
    assert!((turned - sweep).abs() < 1e-4, "{text}: {turned} of {sweep}");
    Ok(())
}

#[test]
fn arcs_with_centre_and_with_radius() -> Check {
    let start = "G21 G90 G17 G0 X10 Y0 Z0\n";
    let arc = |block: &str| format!("{start}{block}\n");
    let quarter = PI / 2.0;
    check_arc(&arc("G3 X0 Y10 I-10 J0"), [0.0; 3], 10.0, quarter, [0, 1])?;
    check_arc(&arc("G2 X0 Y10 I-10"), [0.0; 3], 10.0, -3.0 * quarter, [0, 1])?;
    check_arc(&arc("G3 X0 Y10 R10"), [0.0; 3], 10.0, quarter, [0, 1])?;
    check_arc(&arc("G2 X0 Y10 R-10"), [0.0; 3], 10.0, -3.0 * quarter, [0, 1])?;
    check_arc(&arc("G2 X0 Y10 CR=10"), [10.0, 10.0, 0.0], 10.0, -quarter, [0, 1])?;
    check_arc(&arc("G3 I-10"), [0.0; 3], 10.0, 2.0 * PI, [0, 1])?;
    check_arc(&arc("G90.1 G3 X0 Y10 I0 J0"), [0.0; 3], 10.0, quarter, [0, 1])?;
    // ZX and YZ planes run z to x and y to z.
    check_arc(&arc("G18 G3 X0 Z-10 I-10 K0"), [0.0; 3], 10.0, quarter, [2, 0])?;
    check_arc("G90 G0 X0 Y10 Z0\nG19 G2 Y0 Z-10 J-10 K0\n", [0.0; 3], 10.0, -quarter, [1, 2])
}

#[test]
fn a_helix_rises_evenly() -> Check {
    let path = read("a.nc", "G90 G0 X10 Y0 Z0\nG3 X-10 Y0 Z6 I-10 J0\n")?;
    let all = positions(&path);
    let count = all.len() - 1;
    for (k, point) in all.iter().enumerate() {
        assert!((point[2] - 6.0 * k as f64 / count as f64).abs() < 1e-6);
    }
    assert_eq!(all[count], [-10.0, 0.0, 6.0]);
    Ok(())
}

#[test]
fn five_axes_as_vectors() -> Check {
    let text = "TRAORI\nG0 X0 Y0 Z50 A3=0 B3=0 C3=1\nG1 X10 A3=0.6 B3=0 C3=0.8\nX20\nTRAFOOF\n";
    let path = read("a.mpf", text)?;
    let expected = [unit(0.0, 0.0, 1.0), unit(0.6, 0.0, 0.8), unit(0.6, 0.0, 0.8)];
    assert!(axes(&stated(&path)).iter().zip(expected).all(|(a, b)| (a - b).norm() < 1e-12));
    let text = "G43.5 H1\nG0 X0 Y0 Z50 I0 J0 K1\nG1 X10 I0 J-0.6 K0.8\nX20\nG49\n";
    let path = read("a.nc", text)?;
    assert!((axes(&stated(&path))[2] - unit(0.0, -0.6, 0.8)).norm() < 1e-12);
    Ok(())
}

/// Against the rotation matrices of a head C-A and of a table A-C, written out.
#[test]
fn five_axes_as_angles() -> Check {
    let (a, c) = (30_f64.to_radians(), 50_f64.to_radians());
    let text = "G43.4 H1\nG0 X0 Y0 Z50 A0 C0\nG1 X10 A30 C50\n";
    let head = cell_with("rotary_axes = ['C', 'A']\n");
    let path = read_with("a.nc", text, &head)?;
    let expected = Vector3::new(c.sin() * a.sin(), -c.cos() * a.sin(), a.cos());
    assert!((axes(&stated(&path))[1] - expected).norm() < 1e-12);
    // The table turns the workpiece by A, on it by C: the tool in the workpiece turns back.
    let table = cell_with("rotary_axes = ['-C', '-A']\n");
    let path = read_with("a.nc", text, &table)?;
    let expected = Vector3::new(c.sin() * a.sin(), c.cos() * a.sin(), a.cos());
    assert!((axes(&stated(&path))[1] - expected).norm() < 1e-12);
    Ok(())
}

/// What docs/paths.md says of a table whose A carries its C: Rz(-90°) Rx(-30°) z.
#[test]
fn the_order_of_rotary_axes_is_that_in_which_they_carry_each_other() -> Check {
    let text = "G43.4 H1\nG0 X0 Y0 Z50 A0 C0\nG1 X10 A30 C90\n";
    let carried = read_with("a.nc", text, &cell_with("rotary_axes = ['-C', '-A']\n"))?;
    assert!((axes(&stated(&carried))[1] - Vector3::new(0.5, 0.0, 0.75_f64.sqrt())).norm() < 1e-12);
    let other = read_with("a.nc", text, &cell_with("rotary_axes = ['-A', '-C']\n"))?;
    assert!((axes(&stated(&other))[1] - Vector3::new(0.0, 0.5, 0.75_f64.sqrt())).norm() < 1e-12);
    // `check` shows a pose that tells the two apart.
    let shown = ["['-C', '-A']", "['-A', '-C']", "['C', 'A']", "['-B', 'A']"].map(|axes| {
        let cell = cell_with(&format!("rotary_axes = {axes}\n"));
        cell.work.shown_tool_axis().unwrap().sentence
    });
    insta::assert_snapshot!(shown.join("\n"), @"
    At C70 A30 of G-code the tool axis, from the tip to the spindle, is (0.470, 0.171, 0.866) in the workpiece: hold it against the machine.
    At A30 C70 of G-code the tool axis, from the tip to the spindle, is (0.000, 0.500, 0.866) in the workpiece: hold it against the machine.
    At C70 A30 of G-code the tool axis, from the tip to the spindle, is (0.470, -0.171, 0.866) in the workpiece: hold it against the machine.
    At B40 A30 of G-code the tool axis, from the tip to the spindle, is (-0.557, -0.500, 0.663) in the workpiece: hold it against the machine.
    ");
    assert!(cell_with("").work.shown_tool_axis().is_none());
    Ok(())
}

#[test]
fn names_that_a_table_cannot_hold_are_changed() -> Check {
    let text = "G90 G0 X0 Y0 Z5\n(=1+1)\nG1 X1\n(-2+3)\nX2\n(\u{1b}[31mred)\nX3\n(@)\nX4\n(- 3 mm)\nX5\n";
    let path = read("a.nc", text)?;
    let names: Vec<String> =
        stated(&path).iter().map(|point| point.feature.as_deref().unwrap_or_default().to_string()).collect();
    assert_eq!(names, ["", "1+1", "2+3", "_[31mred", "_[31mred", "- 3 mm"]);
    assert_eq!(codes(&path), ["feature-name"]);
    let cell = cell_with("");
    let format = PathFormat::new(PathKind::ToolAxes, &cell).holding(&path.points, &cell);
    let table = write_path(&format, &path.points)?;
    let again = read_path(table.as_bytes(), "a.csv", &cell, None)?;
    assert_eq!(again.points.len(), path.points.len());
    Ok(())
}

#[test]
fn what_is_not_followed_is_said() -> Check {
    let text = "G90 G54 G0 X0 Y0 Z5\nG84 X10 Y10 Z-5 R2\nX20\nG80\nG1 Z0\nG28 X0\nG1 Y5\nG1 X0 Y5 Z0\n\
                G55\nG64 P0.01\nG777\nWAITM(1)\n";
    let path = read("a.nc", text)?;
    assert_eq!(
        codes(&path),
        ["work-offset", "cycle", "not-followed", "not-followed", "position-unknown", "machine-place"]
    );
    insta::assert_snapshot!(path.findings[0].sentence, @"The work offset changes within the program (line 9): the cell has one workpiece frame.");
    Ok(())
}

/// What becomes of blocks behind `G90 G0 X0 Y0 Z5`, `G1 X1 F100`: the points that are stated, or `refused`, and codes of
/// findings that are more than notes.
fn becomes(blocks: &str) -> String {
    let text = format!("G90 G0 X0 Y0 Z5\nG1 X1 F100\n{blocks}\n");
    match read("a.mpf", &text) {
        Err(_) => "refused".to_string(),
        Ok(path) => {
            let points = rounded(&path.points);
            let mut shown: Vec<String> = points[2..].iter().map(|p| format!("{},{},{}", p[0], p[1], p[2])).collect();
            let said = path.findings.iter().filter(|finding| finding.severity > Severity::Note);
            shown.extend(said.map(|finding| finding.code.clone()));
            shown.join(" ")
        }
    }
}

/// Words of controls that LinuxCNC does not have. Siemens: SINUMERIK 840D sl, Programming Guide; FANUC: Series 30i
/// Operator's Manual; Haas, Okuma, slicers.
#[test]
fn words_of_other_controls_lose_no_move() {
    let rows = [
        // The rest of a block behind a word of several letters counts.
        ("CFTCP G1 X2 Y3", "2,3,5"),
        ("G1 X2 Y3 SPOS=90 Z4", "2,3,4"),
        ("G1 X2 SPOS[1]=90 Y3", "2,3,5"),
        ("MSG(\"G1 (X9)\") G1 X2", "2,0,5"),
        ("CYCLE832(0.01,1) G1 X2", "2,0,5"),
        ("G1 X2 S1=5000 M1=3", "2,0,5"),
        ("G1 X2 M2=3\nX3", "2,0,5 3,0,5"),
        ("G1 X2 WAITM(1)", "refused"),
        ("WAITM(1)\nG1 X2", "2,0,5 not-followed"),
        // Words that say where the tool is in another way.
        ("L100", "refused"),
        ("G1 X2 A2=10 B2=20 C2=0", "refused"),
        ("G1 X1=2", "refused"),
        ("G2 X3 Y0 I1 J0 TURN=0.5", "refused"),
        ("G1 X=IC(2)", "refused"),
        ("G1 X2 CR=5", "refused"),
        ("G1 X2 ,R5", "refused"),
        ("G1 X2 RND=5", "refused"),
        ("CYCLE800(1,\"A\")", "refused"),
        ("CYCLE800()\nG1 X2", "2,0,5"),
        ("TRANS\nG1 X2", "2,0,5"),
        ("TRANS X2", "refused"),
        ("DIAMON", "refused"),
        ("R1=5 G1 X2", "2,0,5"),
        ("DEF REAL X1=5\nG1 X2", "2,0,5"),
        ("G1 X=R1", "refused"),
        ("GOTOF END1", "refused"),
        ("IF[#1 EQ 2]GOTO10", "refused"),
        ("GOTO10", "refused"),
        // Drilling in a way of the control.
        ("CYCLE81(10,0,2,-5)\nG1 X2\nG1 X2 Y0 Z0\nX3", "2,0,0 3,0,0 position-unknown"),
        // Waiting times and limits are no points.
        ("G4 F2\nG1 X2", "2,0,5"),
        ("G4 X1.5\nG1 Y2", "1,2,5"),
        ("G4 X1.5 Y2", "refused"),
        ("G22 X9 Y9 I1\nG1 X2", "2,0,5"),
        ("G26 X9 Y9\nG1 X2", "2,0,5"),
        // Frames.
        ("G54\nG1 X2", "2,0,5"),
        ("G15 H2\nG1 X2", "2,0,5 work-offset"),
        ("G54.1 P1\nG1 X2\nG54.1 P2\nX3", "2,0,5 3,0,5 work-offset"),
        ("G92 S2000\nG1 X2", "2,0,5"),
        ("G92 E0\nG1 X2 E1.5", "2,0,5"),
        ("G92.1\nG1 X2", "refused"),
        ("G58 X5", "refused"),
        // Arcs of which I, J, K may be the tool axis.
        ("G43.5 H1\nG2 X3 Y0 I1 J0", "refused"),
        // Several switches of optional blocks.
        ("/2 G1 X2", "2,0,5"),
        ("N10 ANFANG: G1 X2", "2,0,5"),
        ("ANFANG: G1 X2", "2,0,5"),
    ];
    let outcomes: Vec<(&str, String)> = rows.iter().map(|(blocks, _)| (*blocks, becomes(blocks))).collect();
    let wanted: Vec<(&str, String)> = rows.iter().map(|(blocks, wanted)| (*blocks, wanted.to_string())).collect();
    assert_eq!(outcomes, wanted);
}

/// A hole at the place where the tool stands, without any depth, is no move; steps below the last digit end.
#[test]
fn cycles_without_a_way_end() {
    assert_eq!(becomes("G99 G82 X1 Y0 Z5 R5 P1\nG80\nG1 X2"), "2,0,5");
    let hole = "G99 G83 Z999.9999999999 R1000 Q0.00000000000002\nG80\nG1 X2 Y0 Z5";
    assert!(becomes(hole).ends_with("2,0,5"));
}

#[test]
fn offsets_are_held_against_the_first_of_every_control() -> Check {
    let path = read("a.nc", "G90 G55 G0 X0 Y0 Z5\nG1 X1\n")?;
    assert!(codes(&path).is_empty());
    let later = read("a.nc", "G90 G0 X0 Y0 Z5\nG1 X1\nG55 X2\n")?;
    assert_eq!(codes(&later), ["work-offset"]);
    let reset = read("a.nc", "G92.1\nG90 G0 X0 Y0 Z5\nG1 X1\n")?;
    assert!(codes(&reset).is_empty());
    Ok(())
}

#[test]
fn every_word_stands_in_the_table_once() {
    let page = stiffarm_files::tool_path::gcode_page();
    let words = page.lines().filter_map(|line| line.strip_prefix("| ")?.split(" | ").next());
    let mut words: Vec<&str> =
        words.flat_map(|words| words.split(' ')).filter(|word| !matches!(*word, "words" | "to")).collect();
    let count = words.len();
    words.sort_unstable();
    words.dedup();
    assert!(count > 250 && words.len() == count, "{} of {count}", words.len());
}
