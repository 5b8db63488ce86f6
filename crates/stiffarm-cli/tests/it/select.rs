//! Every way of `stiffarm select` to work keeps its words, its files and its promises.

use crate::support;

use insta::assert_snapshot;
use serde_json::Value;
use support::{
    Folder, HEADING, in_lines, number, one_point_cell, paragraphs, printed_sentence, replaced, without_numbers,
};

const GROUP: &str = "builtin:comau-group1";

/// The words of a transcript without its numbers: another platform's rounding
/// may lead a search to another plan, but never to other words.
fn words(folder: &Folder, line: &str) -> String {
    let ran = folder.run(line);
    assert_eq!(ran.code, Some(0), "{line}\n{}", ran.err);
    let mut text = format!("$ stiffarm {line}\n");
    // Whether a posture happens to be near a singularity is a matter of the plan.
    let said = ran.out.lines().filter(|l| !l.contains("to a singularity") && !l.contains("but move there"));
    for row in said {
        text += &(without_numbers(row) + "\n");
    }
    text
}

/// What is said above the first table, without its numbers.
fn verdict(printed: &str) -> String {
    without_numbers(printed.split("\n\n").next().unwrap())
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a / b - 1.0).abs() < tolerance, "{a} {b}");
}

#[test]
fn from_group_1() {
    let folder = Folder::new();
    let line = "select builtin:comau --index expected-error --initial builtin:comau-group1 --output plan.csv --sheet sheet.csv";
    assert_snapshot!(folder.transcript(line));
    assert_eq!(folder.names(), ["plan.csv", "sheet.csv"]);
    // The plan is read back, and the sheet has a row per posture and point.
    folder.ok("evaluate builtin:comau plan.csv");
    assert_eq!(folder.read("sheet.csv").lines().count(), 1 + 6 * 2 * 4);
}

#[test]
fn a_global_search_and_its_certificate() {
    let folder = Folder::new();
    assert_snapshot!(words(
        &folder,
        "select builtin:comau-reference --index expected-error -n 3 --rounds 1 --output plan.csv"
    ));
    // The same number from the plan that was written.
    let written = folder.json("evaluate builtin:comau-reference plan.csv");
    let plan = folder.json("select builtin:comau-reference --index expected-error -n 3 --rounds 1 --no-certificate");
    assert!(plan["result"]["certificate"].is_null());
    close(number(&written["result"]["groups"][0]["indices"]["expected_error"]), number(&plan["result"]["value"]), 1e-9);
}

/// Unless told otherwise: the deflection at work, as a range, with a bound, what a weight would bring, and no posture twice.
#[test]
fn the_plan_for_the_model_that_identifies() {
    let folder = Folder::new();
    let line = "select builtin:comau -n 12 --rounds 1 --output plan.csv";
    let result = folder.json(line)["result"].clone();
    assert_eq!(result["index"], "prediction");
    let value = number(&result["value"]);
    let bound = number(&result["certificate"]["bound"]);
    assert!(bound > 0.5 * value && bound < value, "{bound} {value}");
    let range = &result["evaluation"]["indices"]["prediction_range"];
    let [low, high] = [0, 1].map(|side| number(&range[side]));
    assert!(low < value && value < high, "{low} {value} {high}");
    assert!(number(&result["further_load"]["with"]) < 0.9 * value);
    assert_eq!(result["repeats"].as_array().unwrap().len(), 0);
    assert_snapshot!(in_lines(verdict(&folder.ok(&format!("{line} --force")))), @r"
    The deflection of the tip at work can be expected to be predicted with an RMS error of # mm (# mm to
    # mm where what gives way beyond the axes is a third or three times as large as expected). No plan
    of as many postures can be below # mm. Least sure will be joint #: ± # % in what identify prints,
    systematic errors included. Measuring them takes # minutes, at an assumed # minutes a posture
    ([time]). A weight of # kg hung in the same postures as well (a second `[[load.case]]`, # minutes
    more) would bring the error of the deflection at work from # mm to # mm.
    ");
    // The load chosen too: by the index that can.
    let line = "select builtin:comau -n 3 --rounds 1 --no-certificate --largest-load-n 600";
    assert_eq!(folder.json(line)["result"]["index"], "expected_error");
}

#[test]
fn only_indices_with_a_bound_have_a_certificate() {
    let folder = Folder::new();
    let of = |cell: &str, index: &str| {
        folder.json(&format!("select builtin:{cell} -n 3 --rounds 1 --index {index}"))["result"]["certificate"].clone()
    };
    for (cell, index) in [("comau-reference", "d"), ("comau", "task")] {
        let efficiency = number(&of(cell, index)["efficiency"]);
        assert!((0.9..=1.0).contains(&efficiency), "{index}: {efficiency}");
    }
    assert!(of("comau-reference", "o3").is_null());
    let out = folder.ok("select builtin:comau-reference -n 3 --rounds 1 --index condition");
    assert!(!out.contains("of what is possible"), "{out}");
}

/// The classical group of the default cell has joint 2 at 20 % and more.
#[test]
fn errors_beyond_the_first_order_are_a_caution() {
    let folder = Folder::new();
    let line = "select builtin:comau --initial builtin:comau-group1 --index classical --output plan.csv";
    let caution = "caution: A joint's relative standard error is above 10 %";
    for line in [line, "evaluate builtin:comau plan.csv"] {
        let out = folder.ok(line);
        assert!(out.contains(caution), "{out}");
    }
    let sound = folder.ok("evaluate builtin:comau builtin:comau-group1");
    assert!(!sound.contains(caution), "{sound}");
}

#[test]
fn the_next_postures_beside_those_measured() {
    let folder = Folder::new();
    let line = "select builtin:comau-reference --given builtin:comau-group1 --add 2 --rounds 2 --output new.csv --sheet sheet.csv --sheet-of displacements";
    assert_snapshot!(words(&folder, line));
    assert_eq!(folder.read("new.csv").lines().count(), 3);

    // The sheet, filled in, is read together with what was measured before.
    folder.ok(&format!("simulate builtin:comau-reference {GROUP} --runs 1 --levels 1 --measurements old-readings.csv"));
    folder.ok("simulate builtin:comau-reference new.csv --runs 1 --levels 1 --measurements new-readings.csv");
    let sheet = folder.read("sheet.csv");
    let readings = folder.read("new-readings.csv");
    assert_eq!(sheet.lines().count(), 1 + 2 * 4);
    let mut filled = folder.read("old-readings.csv");
    for (blank, read) in sheet.lines().zip(readings.lines()).skip(1) {
        let mut fields: Vec<&str> = blank.split(',').collect();
        assert_eq!(fields[3..6], ["", "", ""]);
        let read: Vec<&str> = read.split(',').collect();
        fields[3..6].copy_from_slice(&read[3..6]);
        filled += &(fields.join(",") + "\n");
    }
    folder.write("readings.csv", filled);
    let identified = folder.json("identify builtin:comau-reference readings.csv");
    assert_eq!(identified["result"]["joints"].as_array().unwrap().len(), 6);
    let only_old = folder.json("identify builtin:comau-reference old-readings.csv");
    let freedom = |value: &Value| number(&value["result"]["degrees_of_freedom"]);
    assert_eq!(freedom(&identified) - freedom(&only_old), 2.0 * 4.0 * 3.0);
}

#[test]
fn a_sheet_asks_for_what_will_be_read() {
    let folder = Folder::new();
    let select = "select builtin:comau --initial builtin:comau-group1 --max-iterations 1 --index d";
    folder.ok(&format!("{select} --sheet sheet.csv --states preload,up-250,down-250 --drift --base-reflector"));
    // Five states, four points and the base.
    assert_eq!(folder.read("sheet.csv").lines().count(), 1 + 6 * 5 * 5);
    folder.ok(&format!("{select} --sheet old.csv --sheet-of displacements --states up,down"));
    let sheet = folder.read("old.csv");
    assert!(sheet.starts_with("posture,state,point,dx_mm,dy_mm,dz_mm,q1_deg,"), "{sheet}");
    assert_eq!(sheet.lines().count(), 1 + 6 * 2 * 4);
}

#[test]
fn one_posture_more_is_the_default() {
    let line = "select builtin:comau --given builtin:comau-group1 --rounds 1 --no-certificate";
    let value = Folder::new().json(line);
    assert_eq!(value["result"]["posture_names"], serde_json::json!(["7"]));
}

#[test]
fn given_postures_that_leave_a_joint_undetermined_are_completed() {
    let folder = Folder::new();
    folder.write("one-point.toml", one_point_cell());
    folder.write("one.csv", format!("{HEADING}1,-35,-10,-95,10,15,-20\n"));
    assert_snapshot!(in_lines(verdict(&folder.ok("select one-point.toml --given one.csv --add 3 --rounds 1"))), @r"
    The deflection of the tip at work can be expected to be predicted with an RMS error of # mm (# mm to
    # mm where what gives way beyond the axes is a third or three times as large as expected); the given
    postures alone cannot determine every joint. Least sure will be joint #: ± # % in what identify
    prints, systematic errors included. Measuring them takes # minutes, at an assumed # minutes a
    posture ([time]). A weight of # kg hung in the same postures as well (a second `[[load.case]]`, #
    minutes more) would bring the error of the deflection at work from # mm to # mm.
    ");
}

#[test]
fn the_postures_least_worth_their_time() {
    let folder = Folder::new();
    let line = "select builtin:comau --given builtin:comau-group1 --drop 2 --output stay.csv --sheet sheet.csv";
    assert_snapshot!(folder.transcript(line));
    assert_eq!(folder.read("sheet.csv").lines().count(), 1 + 4 * 2 * 4);
    // Without a number, one is left out.
    let one = folder.json("select builtin:comau --given builtin:comau-group1 --drop");
    assert_eq!(one["result"]["dropped"].as_array().unwrap().len(), 1);
    assert_eq!(one["options"]["mode"], "drop");
}

#[test]
fn the_curve_of_the_number_of_postures() {
    let folder = Folder::new();
    let line = "select builtin:comau-reference --index expected-error --curve -n 4 --rounds 2 --output curve.csv";
    assert_snapshot!(words(&folder, line));
    let sizes = folder.json(&line.replace(" --output curve.csv", ""))["result"]["sizes"].clone();
    let sizes = sizes.as_array().unwrap();
    assert_eq!(sizes.len(), 4);
    let csv = folder.read("curve.csv");
    let rows: Vec<Vec<&str>> = csv.lines().map(|l| l.split(',').collect()).collect();
    assert_eq!(rows[0], ["postures", "expected_error", "gain", "bound", "efficiency"]);
    assert_eq!(rows.len(), 5);
    assert_eq!(rows[4][1].parse::<f64>().unwrap(), number(&sizes[3]["value"]));
    // Sizes that cannot be are said, and another index has its own column.
    let out = folder.ok("select builtin:comau-reference --curve -n 2 --rounds 1 --index drop-one");
    assert_snapshot!(printed_sentence(&out, "–: so few"), @"–: so few postures cannot determine every joint.");
    folder.ok("select builtin:comau-reference --curve -n 2 --rounds 1 --index d --output d.csv");
    assert!(folder.read("d.csv").starts_with("postures,d,expected_error,gain"));
}

#[test]
fn what_wrong_assumptions_would_change() {
    let folder = Folder::new();
    let line = "select builtin:comau-reference -n 3 --rounds 1 --no-certificate --sensitivity";
    let mut text = words(&folder, line);
    // Whether it stands is a matter of the plan.
    let begin = "If assumptions are wrong\n";
    let at = text.find(begin).unwrap() + begin.len();
    let end = at + text[at..].find("\n\n").unwrap();
    text.replace_range(at..end, "[…]");
    assert_snapshot!(text);
    let priors = folder.json(line)["result"]["sensitivity"]["priors"].clone();
    assert_eq!(priors.as_array().unwrap().len(), 12);
    let out = folder.ok("select builtin:comau-reference -n 3 --rounds 1 --index o3 --sensitivity");
    assert_snapshot!(printed_sentence(&out, "The index does not"), @"The index does not use the prior stiffness.");
}

#[test]
fn the_load_chosen_with_the_postures_goes_into_the_cell() {
    let folder = Folder::new();
    let line = "select builtin:comau -n 4 --rounds 2 --no-certificate --output plan.csv --anchor-box-mm 1600,-300,0,2000,300,0 \
                --loading-point-box-mm 150,-50,200,250,50,300 --largest-load-n 650";
    assert_snapshot!(words(&folder, line));
    folder.write("builtin.toml", stiffarm_files::builtin::cell_text("comau").unwrap());
    let out = folder.ok(&format!("{line} --force"));
    let mut cell = folder.read("builtin.toml");
    for key in ["loading_point_mm", "magnitude_n", "anchor_mm"] {
        let chosen = out.lines().find(|l| l.trim_start().starts_with(key)).unwrap();
        let old = cell.lines().find(|l| l.starts_with(key)).unwrap().to_string();
        cell = cell.replace(&old, chosen.trim());
    }
    folder.write("cell.toml", cell);
    let value = folder.json(&format!("{line} --force"))["result"]["value"].clone();
    let evaluated = folder.json("evaluate cell.toml plan.csv");
    // The lines are rounded to a tenth of a millimetre.
    close(number(&evaluated["result"]["groups"][0]["indices"]["expected_error"]), number(&value), 2e-3);
}

#[test]
fn evenly_spread_postures_as_a_baseline() {
    let folder = Folder::new();
    let line = "select builtin:comau --space-filling -n 8 --seed 3 --output even.csv --sheet sheet.csv";
    assert_snapshot!(words(&folder, line));
    assert_eq!(folder.read("sheet.csv").lines().count(), 1 + 8 * 2 * 4);
}

#[test]
fn the_best_of_a_list_is_written_and_proved() {
    let folder = Folder::new();
    folder.ok("select builtin:comau --space-filling -n 14 --output even.csv");
    let line =
        "select builtin:comau --index expected-error --candidates even.csv -n 4 --output chosen.csv --sheet sheet.csv";
    assert_snapshot!(words(&folder, line));
    let chosen = folder.read("chosen.csv");
    let listed = folder.read("even.csv");
    assert_eq!(chosen.lines().count(), 5);
    assert!(chosen.lines().all(|line| listed.contains(line)), "{chosen}");
    let result =
        folder.json("select builtin:comau --index expected-error --candidates even.csv -n 4")["result"].clone();
    assert_eq!(result["exact"], true);
    let evaluated = folder.json("evaluate builtin:comau chosen.csv");
    let value = &evaluated["result"]["groups"][0]["indices"]["expected_error"];
    close(number(value), number(&result["value"]), 1e-12);
}

#[test]
fn measured_postures_are_chosen_under_their_wrenches() {
    let folder = Folder::new();
    folder.ok("select builtin:comau --space-filling -n 9 --output even.csv");
    folder.ok("simulate builtin:comau even.csv --runs 1 --levels 1 --readings tracked.csv");
    for index in ["expected-error", "prediction"] {
        let from = |table: &str| {
            let line = format!("select builtin:comau --candidates {table} -n 4 --index {index}");
            folder.json(&line)["result"].clone()
        };
        let (measured, planned) = (from("tracked.csv"), from("even.csv"));
        // The rope pulls as the cell says, but for the noise of nothing: the same choice.
        assert_eq!(measured["posture_names"], planned["posture_names"], "{index}");
        assert_eq!(measured["exact"], true);
    }
    let line = "select builtin:comau --candidates tracked.csv -n 4 --index prediction";
    assert_snapshot!(in_lines(verdict(&folder.ok(line))), @r"
    The deflection of the tip at work can be expected to be predicted with an RMS error of # mm. No
    other choice of as many candidates is better.
    ");
    let refused = folder.each_refused(&[
        ("select builtin:comau --candidates tracked.csv -n 10", "too-few-data", ""),
        ("select builtin:comau --candidates missing.csv -n 2", "file-read", "missing.csv"),
        ("select builtin:comau --candidates even.csv --given even.csv", "usage", "--candidates"),
    ]);
    assert_snapshot!("candidates_refused", refused);
}

#[test]
fn a_study_on_measurements_writes_its_folder() {
    let folder = Folder::new();
    folder.ok("select builtin:comau --space-filling -n 10 --output even.csv");
    folder.ok("simulate builtin:comau even.csv --runs 1 --levels 1 --readings tracked.csv");
    let line = "study builtin:comau --measured tracked.csv --splits 3 --pool 7 --choose 4,5 --indices d,prediction";
    let out = folder.ok(line);
    assert_snapshot!(in_lines(printed_sentence(&out, "10 measured postures of")), @r"
    10 measured postures of COMAU SMART5 NJ 165-3.0 were split 3 times into a pool of 7 and 3 to be
    predicted; postures were chosen from the pool by chance and by index, and predicted the others.
    ");
    let json: serde_json::Value = serde_json::from_str(&folder.read("study/study.json")).unwrap();
    let choices = json["result"]["choices"].as_array().unwrap();
    // Chance and two indices for two numbers of postures, and the pool; two models.
    assert_eq!(choices.len(), 2 * (2 * 3 + 1));
    let table = folder.read("study/measured-choices.csv");
    assert_eq!(table.lines().count(), 1 + choices.len());
    assert!(folder.read("study/measured-choices.svg").starts_with("<svg"));
    let choices = paragraphs(&folder.read("study/report.html"), "r0-choices");
    assert_snapshot!(in_lines(without_numbers(choices.lines().find(|line| line.contains("standard error")).unwrap())), @r"
    The measured displacements have an RMS of # mm. An index knows angles and wrenches but no reading.
    Joint stiffness, or the mixed model with its sizes, is identified from the chosen postures alone and
    predicts the others. The index prediction takes the pool&#39;s own postures for the work to be done.
    Splits share postures: standard errors are those of the mean over splits, not over robots.
    ");
    let before = folder.read("study/study.json");
    let again = folder.ok(&format!("{line} --force"));
    assert_eq!((folder.read("study/study.json"), again), (before, out));
    let refused = folder.each_refused(&[
        ("study builtin:comau --measured tracked.csv --pool 10 --choose 4 --output-dir never", "too-few-data", ""),
        ("study builtin:comau --measured tracked.csv --pool 5 --choose 6 --output-dir never", "too-few-data", ""),
        ("study builtin:comau --measured tracked.csv --splits 0 --output-dir never", "usage", "--splits"),
        ("study builtin:comau --measured tracked.csv --choose 0 --output-dir never", "usage", "--choose"),
        ("study builtin:comau --measured tracked.csv --indices best --output-dir never", "unknown-name", ""),
        ("study builtin:comau --measured tracked.csv --size-factor 0 --output-dir never", "usage", "--size-factor"),
        ("study builtin:comau --measured tracked.csv --runs 10 --output-dir never", "usage", "--measured"),
        ("study builtin:comau --splits 3", "usage", ""),
    ]);
    assert_snapshot!("study_of_readings_refused", refused);
    assert!(!folder.path("never").exists());
}

#[test]
fn a_posture_that_is_planned_twice_is_said_so() {
    let folder = Folder::new();
    let line = "select builtin:comau --index expected-error -n 7 --no-certificate --rounds 1";
    let result = folder.json(line)["result"].clone();
    let repeats = result["repeats"].as_array().unwrap();
    let postures = result["postures_deg"].as_array().unwrap();
    let names = result["posture_names"].as_array().unwrap();
    let angles = |name: &Value| -> Vec<f64> {
        let at = names.iter().position(|n| n == name).unwrap();
        postures[at].as_array().unwrap().iter().map(number).collect()
    };
    assert!(!repeats.is_empty(), "{result}");
    for same in repeats {
        let same = same.as_array().unwrap();
        let first = angles(&same[0]);
        for other in &same[1..] {
            let apart = angles(other).iter().zip(&first).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart <= 0.5, "{apart}");
        }
    }
    let out = folder.ok(line);
    assert_snapshot!(in_lines(printed_sentence(&out, "Some postures are the same")), @r"
    Some postures are the same on purpose, listed with the moves: measured again, they tell more than
    another one; drive away in between.
    ");
    let line = "select builtin:comau --index prediction --largest-load-n 600";
    assert_snapshot!(folder.each_refused(&[(line, "unsupported", "")]), @r"
    $ stiffarm select builtin:comau --index prediction --largest-load-n 600
    unsupported

      × The load cannot be chosen together with the postures under the index prediction.
      help: choose the load under task or expected_error, put it into the cell, then select by prediction
    ");
    // An index that counts more than noise does not repeat itself.
    let spread = folder.json("select builtin:comau -n 7 --no-certificate --rounds 1 --index prediction");
    assert_eq!(spread["result"]["repeats"].as_array().unwrap().len(), 0);
}

/// The help names every index there is.
#[test]
fn help_names_every_index() {
    let folder = Folder::new();
    let help = folder.ok("select --help").replace('\n', " ");
    for index in stiffarm::Index::ALL {
        let name = index.as_str().replace('_', "-");
        assert!(help.contains(&name), "{name}\n{help}");
    }
}

/// Without a second load, and with one: how many postures, under what, and what else the time would give.
#[test]
fn minutes_instead_of_a_number_of_postures() {
    let folder = Folder::new();
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    let loads = "kind = \"cases\"\n[[load.case]]\nname = \"rope\"\nkind = \"rope\"\nmagnitude_n = 500\n\
        anchor_mm = [1800, 0, 0]\n[[load.case]]\nname = \"weight\"\nkind = \"weight\"\nmass_kg = 50\n";
    let one = "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]\n";
    folder.write("both.toml", replaced(cell, one, loads));
    folder.write("slow.toml", format!("{cell}\n[time]\nposture_min = 6\n"));
    let line = "--minutes 24 --rounds 1 --no-certificate";
    let mut said = Vec::new();
    for cell in ["builtin:comau", "both.toml", "slow.toml"] {
        let printed = folder.ok(&format!("select {cell} {line}"));
        let in_the_same_time = printed_sentence(&printed, "In the same time");
        let (begin, _) = in_the_same_time.split_once(" would give ").unwrap();
        said.push(format!("{cell}: {} {begin}", printed_sentence(&printed, "Measuring")));
    }
    let printed = folder.ok("select builtin:comau -n 3 --rounds 1 --no-certificate");
    said.push(format!("3 postures: {}", printed_sentence(&printed, "Measuring them")));
    let printed = folder.ok("check both.toml");
    said.push(printed.lines().find(|line| line.starts_with("measuring  ")).unwrap().to_string());
    assert_snapshot!(said.join("\n"), @r"
    builtin:comau: Measuring 8 postures takes 24 minutes, at an assumed 3 minutes a posture ([time]). In the same time 6 postures, a weight of 51 kg hung in each as well (a second `[[load.case]]`),
    both.toml: Measuring 6 postures under rope and then weight takes 24 minutes, at an assumed 4 minutes a posture ([time]). In the same time 8 postures under rope
    slow.toml: Measuring 4 postures takes 24 minutes. In the same time 3 postures, a weight of 51 kg hung in each as well (a second `[[load.case]]`),
    3 postures: Measuring them takes 9 minutes, at an assumed 3 minutes a posture ([time]).
    measuring              4 minutes a posture (assumed: [time])
    ");
    let refused = folder.each_refused(&[
        ("select builtin:comau --minutes 2", "invalid-value", ""),
        ("select builtin:comau --minutes 20 -n 3", "usage", "--minutes"),
        ("select builtin:comau --minutes -1", "usage", "--minutes"),
        ("select builtin:comau -n 3 --index d --repeats", "conflict", "--repeats"),
    ]);
    assert_snapshot!("minutes_refused", refused);
}
