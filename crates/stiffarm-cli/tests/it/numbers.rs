//! A number that cannot be meant is refused with its option, one that can hardly be meant is a finding, and nothing is
//! infinite.

use crate::support::{Folder, codes, in_lines, place, replaced, sentence, unbroken};
use insta::assert_snapshot;
use serde_json::Value;
use std::collections::BTreeSet;
use std::ffi::OsString;
use stiffarm_cli::{Host, run_captured};

/// Options with numbers: what stands before the number, and behind it.
const OPTIONS: [(&str, &str); 24] = [
    ("map builtin:comau prior --plane z=", ""),
    ("map builtin:comau prior --to-mm 0,0,0 --from-mm ", ",0,0"),
    ("map builtin:comau prior --plane z=800 --rpy-deg ", ",0,0"),
    ("map builtin:comau prior --plane z=800 --force-n ", ",0,0"),
    ("map builtin:comau prior --plane z=800 --force-n 1,0,0 --moment-nm ", ",0,0"),
    ("map builtin:comau prior --plane z=800 --direction ", ",0,0"),
    ("map builtin:comau prior --place builtin:contour --yaw-deg ", ""),
    ("predict builtin:comau prior builtin:contour --axes base --force-n ", ",0,0"),
    ("predict builtin:comau prior builtin:contour --load-uncertainty-percent ", ""),
    ("predict builtin:comau prior builtin:contour --near-deg 0,0,0,0,0,", ""),
    ("predict builtin:comau prior builtin:contour --max-step-deg ", ""),
    ("simulate builtin:comau builtin:comau-group1 --levels ", ""),
    ("simulate builtin:comau builtin:comau-group1 --force-error-percent ", ""),
    ("simulate builtin:comau builtin:comau-group1 --joint-angle-error-deg ", ""),
    ("simulate builtin:comau builtin:comau-group1 --anchor-error-mm ", ""),
    ("register builtin:example-pairs --std-mm ", ""),
    ("zones builtin:comau --q-deg 0,0,0,0,0,", ""),
    ("select builtin:comau --rounds 1 --largest-load-n ", ""),
    ("select builtin:comau --rounds 1 --anchor-box-mm 0,0,0,1,1,", ""),
    ("select builtin:comau --time-limit ", ""),
    ("identify builtin:comau m.csv --confidence ", ""),
    ("identify builtin:comau m.csv --prior-std-percent ", ""),
    ("identify builtin:comau m.csv --clamped --angle-noise-deg ", ""),
    ("validate builtin:comau m.csv --folds all --tolerance-mm ", ""),
];

#[test]
fn a_number_that_cannot_be_meant_is_refused() {
    let table = b"posture,point,dx_mm,dy_mm,dz_mm\n".to_vec();
    for (before, after) in OPTIONS {
        for number in ["1e300", "nan", "inf"] {
            let line = format!("{before}{number}{after}");
            // In this process: nothing but the words counts, and there are many of them.
            let run = |line: &str| {
                let words: Vec<OsString> =
                    ["stiffarm"].into_iter().chain(line.split(' ')).map(OsString::from).collect();
                let host = Host { inputs: [("m.csv".to_string(), table.clone())].into(), ..Host::default() };
                run_captured(&words, host)
            };
            let ran = run(&line);
            assert_eq!((ran.code, ran.out.as_str()), (2, ""), "{line}\n{}", ran.err);
            assert_ne!(ran.err, "", "{line}");
            let printed: Value = serde_json::from_str(&run(&format!("{line} --json")).out).unwrap();
            let error = &printed["error"];
            let option = before.split(' ').rfind(|word| word.starts_with("--")).unwrap();
            assert_eq!((error["code"].as_str(), place(error)), (Some("usage"), option.to_string()), "{line}");
        }
    }
}

#[test]
fn a_load_that_can_hardly_be_meant_is_a_finding() {
    let folder = Folder::new();
    let load = "--axes base --force-n";
    let mut sentences = BTreeSet::new();
    for command in [
        format!("compensate builtin:comau prior builtin:contour {load}"),
        format!("predict builtin:comau prior builtin:contour {load}"),
        "map builtin:comau prior --plane z=800 --steps 5 --force-n".to_string(),
    ] {
        let line = format!("{command} 200000,0,0");
        let ran = folder.run(&line);
        assert_eq!(ran.code, Some(1), "{command}\n{}{}", ran.out, ran.err);
        // The whole result is there, and what is wrong with it.
        let findings = folder.json(&line)["result"]["findings"].clone();
        assert!(codes(&findings).contains(&"implausible-load"), "{command}\n{findings}");
        let said = sentence(&findings, "implausible-load");
        assert!(unbroken(&ran.out).contains(&format!("SERIOUS: {said}")), "{said}\n{}", ran.out);
        sentences.insert(said.to_string());
        folder.ok(&format!("{command} 300,0,0"));
    }
    assert_eq!(sentences.len(), 1);
    let said = sentences.pop_first().unwrap();
    assert_snapshot!(in_lines(&said), @r"
    A load of 2.0000e5 N can hardly be meant: the payload of COMAU SMART5 NJ 165-3.0 weighs 1618 N, and
    no process pushes with 5 times that. Check its unit (N, N·m).
    ");
    let line = format!("compensate builtin:comau prior builtin:contour {load} 200000,0,0 --beyond-data --output -");
    let ran = folder.run(&line);
    assert_eq!(ran.code, Some(1));
    assert_eq!([&ran.out, &ran.err].map(|text| unbroken(text).contains(&said)), [false, true], "{}", ran.err);
}

/// What three small counts multiply to is said before the work, in one line.
#[test]
fn work_that_outgrows_its_counts_says_so_first() {
    let folder = Folder::new();
    let line = "map builtin:comau prior --plane z=4000 --steps 40,40,1 --free-turn=72";
    let ran = folder.run(line);
    assert_eq!(
        ran.err,
        "note: 115200 positions and turns of the tip to look at; this takes a while, and Ctrl-C stops it\n"
    );
    assert_eq!(folder.run(&format!("{line} --quiet")).err, "");
    assert_eq!(folder.run("map builtin:comau prior --plane z=800 --steps 5").err, "");
}

#[test]
fn a_joint_that_is_held_stays_where_it_is() {
    let folder = Folder::new();
    let cell = include_str!("../../../../cells/comau.toml");
    let held = replaced(cell, "[-60, 40]", "[20, 20]");
    folder.write("held.toml", &held);
    folder.ok("check held.toml");
    for line in [
        "select held.toml --rounds 1 -n 4 --output plan.csv --force",
        "select held.toml --rounds 1 -n 4 --index novel --no-certificate --output plan.csv --force",
        "select held.toml --space-filling -n 4 --output plan.csv --force",
    ] {
        folder.ok(line);
        let plan = folder.read("plan.csv");
        let held = plan.lines().skip(1).map(|row| row.split(',').nth(2));
        assert!(held.eq([Some("20"); 4]), "{line}\n{plan}");
    }
    folder.ok("zones held.toml --steps 5 --output-dir zones");
    assert!(!folder.read("zones/zones.svg").contains("NaN"));
    // Every joint held: nothing to choose, and it says so.
    let all = ["[-90, 90]", "[-180, -40]", "[-180, 180]"];
    let text = all
        .iter()
        .zip(["[0, 0]", "[-90, -90]", "[30, 30]"])
        .fold(held, |text, (range, place)| text.replace(range, place));
    folder.write("held.toml", text);
    let ran = folder.run("select held.toml --rounds 1");
    assert_eq!((ran.code, ran.out.as_str()), (Some(1), ""), "{}", ran.err);
    assert_snapshot!(ran.err, @r"
    not-identifiable

      × 6 postures with this load cannot determine joint 4 and joint 6.
      help: add postures that differ, or measuring points, or move the load off the joint's axis
    ");
}
