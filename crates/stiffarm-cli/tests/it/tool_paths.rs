//! Paths as CL data, G-code and programs of robots go in and out, and the commanded program brings the loaded tip back.

use crate::support;

use insta::assert_snapshot;
use serde_json::Value;
use support::{Folder, codes, in_lines, measurements, number, printed_sentence, sentence, unbroken};

const FORCE: &str = "--axes base --force-n 80,-200,300";

fn folder() -> Folder {
    let folder = Folder::new();
    let inputs = [
        ("freeform.apt", include_str!("../../../../xtask/inputs/freeform.apt")),
        ("freeform.mpf", include_str!("../../../../xtask/inputs/freeform.mpf")),
        ("pocket.nc", include_str!("../../../../xtask/inputs/pocket.nc")),
        ("edge.src", include_str!("../../../../xtask/inputs/edge.src")),
    ];
    for (name, text) in inputs {
        folder.write(name, text);
    }
    folder
}

fn triples(result: &Value, key: &str) -> Vec<[f64; 3]> {
    let points = result["result"]["points"].as_array().unwrap().iter();
    let triple = |point: &Value| [0, 1, 2].map(|i| number(&point[key][i]));
    points.map(triple).collect()
}

#[test]
fn the_commanded_program_brings_the_loaded_tip_back() {
    let folder = folder();
    for (path, out) in [("freeform.apt", "c.apt"), ("edge.src", "c.src")] {
        folder.ok(&format!("compensate builtin:comau prior {path} {FORCE} --output {out}"));
        let nominal = folder.json(&format!("predict builtin:comau prior {path} {FORCE}"));
        let commanded = folder.json(&format!("predict builtin:comau prior {out} {FORCE}"));
        let wanted = triples(&nominal, "tip_m");
        let (tips, shifts) = (triples(&commanded, "tip_m"), triples(&commanded, "shift_m"));
        // Of a robot's arc other points lie between the stated ones.
        let last = (tips.len() - 1, wanted.len() - 1);
        let pairs: Vec<(usize, usize)> = match path {
            "edge.src" => vec![(0, 0), last],
            _ => (1..tips.len()).zip(1..).collect(),
        };
        let stated = if path == "edge.src" { 2 } else { 9 };
        let mut exact = 0;
        for (i, nominal) in pairs {
            let off = (0..3).map(|k| (tips[i][k] + shifts[i][k] - wanted[nominal][k]).powi(2));
            let off = off.sum::<f64>().sqrt();
            // Between its points a straight move may be 0.01 mm off.
            assert!(off < 1e-5, "{path}: point {} is off by {off} m", i + 1);
            // Four decimals of a millimetre, seven of an axis.
            exact += usize::from(off < 1e-6);
        }
        assert!(exact >= stated, "{path}: {exact} points are where they should be");
    }
}

#[test]
fn what_they_say() {
    let folder = folder();
    assert_snapshot!("g_code", folder.ok("compensate builtin:comau prior pocket.nc --output c.nc --details"));
    assert_snapshot!("g_code_written", folder.read("c.nc"));
    assert_snapshot!("five_axes", folder.ok(&format!("predict builtin:comau prior freeform.mpf {FORCE}")));
}

#[test]
fn features_keep_to_a_tolerance_or_not() {
    let folder = folder();
    folder.write("m.csv", measurements());
    folder.ok("identify builtin:comau m.csv --elastic axes --output k.json");
    let line = "builtin:comau k.json pocket.nc --tolerance-mm 0.6 --details";
    let [compensated, predicted] = ["compensate", "predict"].map(|command| folder.ok(&format!("{command} {line}")));
    let section = compensated.split("\n\n").skip_while(|part| !part.starts_with("Features")).take(2);
    assert_snapshot!("features", section.collect::<Vec<_>>().join("\n\n"));
    let said = [(compensated, "note: Compensated"), (predicted, "caution: It does not surely")];
    assert_snapshot!(said.map(|(printed, begin)| printed_sentence(&printed, begin)).join("\n"), @r"
    note: Compensated, the path keeps to its tolerance of 0.600 mm.
    caution: It does not surely keep to its tolerance: POCKET 40 X 30, 2 MM DEEP: 1.329 ± 0.036 mm of 0.600 mm, fails.
    ");
    let line = "predict builtin:comau k.json pocket.nc --tolerance-mm 0";
    assert_snapshot!(folder.each_refused(&[(line, "usage", "--tolerance-mm")]), @r"
    $ stiffarm predict builtin:comau k.json pocket.nc --tolerance-mm 0
    usage

      × --tolerance-mm: The tolerance must be above 0 mm, got 0 mm.
    ");
}

#[test]
fn a_base_elsewhere_withholds_the_program() {
    let folder = folder();
    let text = folder.read("edge.src");
    folder.write("off.src", text.replace("BAS (#BASE,1)", "$BASE={X 0,Y 0,Z 500,A 0,B 0,C 0}"));
    let line = format!("compensate builtin:comau prior off.src {FORCE}");
    let findings = folder.json(&line)["result"]["postures"]["findings"].clone();
    assert_eq!(codes(&findings)[0], "program-frame", "{findings}");
    assert_snapshot!(in_lines(sentence(&findings, "program-frame")), @r"
    The base $BASE (line 5) of the program lies 1737.8 mm and 0.00° from the workpiece frame of the cell
    ([work] workpiece_mm): the robot goes elsewhere than the cell says.
    ");
    let ran = folder.run(&format!("{line} --output c.src"));
    assert_eq!(ran.code, Some(1));
    assert!(unbroken(&ran.out).contains(sentence(&findings, "program-frame")), "{}", ran.out);
    assert!(!folder.path("c.src").exists());
    folder.ok(&format!("compensate builtin:comau prior edge.src {FORCE} --output c.src"));
}

#[test]
fn points_of_a_dat_are_written_beside_it() {
    let folder = folder();
    let frame = "A 0,B 0,C 180,S 2,T 35";
    folder.write("named.src", "DEF named ( )\nLIN XP1 C_DIS\nLIN XP2 C_DIS\nEND\n");
    folder.write(
        "named.dat",
        format!("DECL E6POS XP1={{X 0,Y 0,Z 0,{frame}}}\nDECL E6POS XP2={{X 40,Y 0,Z 0,{frame}}}\n"),
    );
    folder.ok(&format!("compensate builtin:comau prior named.src {FORCE} --output go.src"));
    assert_eq!(folder.read("go.src"), folder.read("named.src"));
    let (was, is) = (folder.read("named.dat"), folder.read("go.dat"));
    assert!(is != was && is.lines().count() == 2 && is.lines().all(|line| line.ends_with(",S 2,T 35}")), "{is}");
    // Neither of the two is written where one is there already.
    std::fs::remove_file(folder.path("go.src")).unwrap();
    let line = format!("compensate builtin:comau prior named.src {FORCE} --output go.src");
    assert_snapshot!(folder.each_refused(&[(line.as_str(), "file-exists", "go.dat")]), @r"
    $ stiffarm compensate builtin:comau prior named.src --axes base --force-n 80,-200,300 --output go.src
    file-exists

      × go.dat: The file exists already.
      help: add --force to overwrite it, or choose another name
    ");
    assert!(!folder.path("go.src").exists());
}

#[test]
fn a_new_program_of_linear_moves() {
    let folder = folder();
    folder.ok("init --robot kuka-kr500-r2800-2 --output-dir kuka");
    let cell = folder.read("kuka/cell.toml");
    folder.write("kuka/cell.toml", cell + "\n[work]\ntip_mm = [0, 0, 300]\nworkpiece_mm = [1700, 0, 800]\n");
    let line = "compensate kuka/cell.toml prior pocket.nc --axes path --force-n -100,50,80 --beyond-data";
    folder.ok(&format!("{line} --write krl --speed-mm-s 30 --tool 3 --base 2 --output pocket.src"));
    let program = folder.read("pocket.src");
    for expected in ["DEF pocket ( )", "BAS (#TOOL,3)", "BAS (#BASE,2)", "$VEL.CP=0.03000", "PTP {A1 ", "LIN {X "] {
        assert!(program.contains(expected), "{expected} is missing in\n{program}");
    }
    folder.ok("predict kuka/cell.toml prior pocket.src --axes path --force-n -100,50,80");
    let refused = [
        format!("{line} --write rapid --output pocket.mod"),
        format!("{line} --write krl --output pocket.nc --force"),
        format!("{line} --write krl --speed-mm-s 0 --output x.src"),
        format!("{line} --write poses --output x.src"),
        format!("{line} --output x.csv"),
        "predict kuka/cell.toml prior nothing.cls".to_string(),
    ];
    assert_snapshot!("refused", refused.map(|line| folder.refused(&line)).join("\n"));
}

/// A table of a force in base axes, whose other rows have the load of their feature in path axes.
const TABLE: &str = "x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg,fx_n,fy_n,fz_n,feature\n\
    0,0,0,180,0,0,10,0,0,A\n50,0,5,180,0,0,,,,B\n100,0,0,180,0,0,,,,B\n";
const CELL: &str = "format = 1\nrobot.catalogue = 'kuka-kr500-r2800-2'\nload = { kind = 'measured' }\n\
    tool = { loading_point_mm = [200, 0, 250], measuring_point = [{ name = '1', position_mm = [0, 0, 300] }] }\n\
    [work]\ntip_mm = [0, 0, 300]\nworkpiece_mm = [1700, 100, 800]\n\
    [[work.feature]]\nname = 'B'\nforce = { force_n = [-90, 50, 0], axes = 'path' }\n";

fn own_cell() -> Folder {
    let folder = folder();
    folder.write("cell.toml", CELL);
    folder.write("k.json", "{\"stiffness_nm_per_rad\": [4e6, 4e6, 3e6, 6e5, 5e5, 3e5]}");
    folder.write("path.csv", TABLE);
    folder
}

#[test]
fn a_commanded_table_has_the_loads_that_its_rows_were_given() {
    let folder = own_cell();
    folder.ok("compensate cell.toml k.json path.csv --axes base --beyond-data --output c.csv");
    let nominal = folder.json("predict cell.toml k.json path.csv --axes base");
    // Without the cell's feature: all is in the table.
    folder.write("cell.toml", CELL.split("[[work.feature]]").next().unwrap());
    let written = folder.json("predict cell.toml k.json c.csv");
    let forces = [&nominal, &written].map(|result| triples(result, "force_n"));
    for (nominal, written) in forces[0].iter().flatten().zip(forces[1].iter().flatten()) {
        // The commanded tool is turned by what the loaded one gives way.
        assert!((nominal - written).abs() < 0.1, "{nominal} {written}");
    }
    assert_eq!(forces[0][0], [10.0, 0.0, 0.0]);
    assert!(forces[0][1][1].abs() > 40.0);
}

#[test]
fn a_log_is_an_input_of_the_result() {
    let folder = own_cell();
    folder.write("path.csv", TABLE.replace("10,0,0,A", ",,,A"));
    folder.write("log.csv", "along_mm,fx_n,fy_n,fz_n\n0,0,20,0\n110,0,130,0\n");
    let result = folder.json("predict cell.toml k.json path.csv --log log.csv --axes base");
    assert_eq!(result["inputs"]["log"].as_str().map(str::len), Some(64));
    // 50.2 mm to the second point and as far to the third; the last has the mean of the last quarter.
    let way = 5.0_f64.hypot(50.0);
    let forces = triples(&result, "force_n");
    for (force, middle) in forces.iter().zip([0.25 * way, way, 1.75 * way]) {
        assert!((force[1] - 20.0 - middle).abs() < 1e-6, "{force:?}");
    }
}
