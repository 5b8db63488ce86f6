//! Denavit–Hartenberg rows that are given in the wrong convention are doubted.

use crate::common::prelude::*;
use stiffarm::model::robot::{CatalogueEntry, catalogue};
use stiffarm::plan::check::robot_doubts;
use stiffarm_files::table::read_dh_rows;

/// Modified rows α [deg], a, d [mm], offset [deg] as their makers' sheets and public models have them; the last two are in no
/// catalogue.
const ARMS: [(&str, [[f64; 4]; 6]); 4] = [
    ("FANUC R-2000iC/165F", six([670.0, 312.0, 1075.0, 225.0, 1280.0, 215.0])),
    ("COMAU NJ 165-3.0", six([830.0, 400.0, 1175.0, 250.0, 1444.0, 230.0])),
    ("KUKA KR 210 R2700 extra", six([675.0, 350.0, 1150.0, -41.0, 1200.0, 215.0])),
    ("ABB IRB 6700-205/2.80", six([780.0, 320.0, 1280.0, 200.0, 1182.5, 200.0])),
];

const fn six([d1, a2, a3, a4, d4, d6]: [f64; 6]) -> [[f64; 4]; 6] {
    [
        [0.0, 0.0, d1, 0.0],
        [-90.0, a2, 0.0, -90.0],
        [0.0, a3, 0.0, 0.0],
        [-90.0, a4, d4, 0.0],
        [90.0, 0.0, 0.0, 0.0],
        [-90.0, 0.0, d6, 180.0],
    ]
}

/// The same arm's standard rows, which end in `last`, α [deg] and a [mm].
fn standard(modified: &[[f64; 4]], last: [f64; 2]) -> Vec<[f64; 4]> {
    let between = modified.iter().skip(1).map(|row| [row[0], row[1]]);
    let along = modified.iter().map(|row| [row[2], row[3]]);
    let rows = between.chain([last]).zip(along);
    rows.map(|([alpha, a], [d, offset])| [alpha, a, d, offset]).collect()
}

/// Reads rows as `convention` means them: `refused`, `doubted`, or nothing is said.
fn said(rows: &[[f64; 4]], convention: DhConvention) -> &'static str {
    let mut text = "joint,alpha_deg,a_mm,d_mm,offset_deg\n".to_string();
    for (j, [alpha, a, d, offset]) in rows.iter().enumerate() {
        text += &format!("{},{alpha},{a},{d},{offset}\n", j + 1);
    }
    let other = convention.other().name();
    match read_dh_rows(text.as_bytes(), "rows.csv", "mine", convention) {
        Err(error) => {
            let hint = error.hint_text().unwrap_or_default();
            assert!(hint.contains(&format!("dh_{other}")), "{error}");
            "refused"
        }
        Ok(robot) => {
            let doubts = robot_doubts(&robot.robot().unwrap());
            match doubts.iter().find(|f| f.code == "dh-convention") {
                Some(finding) => {
                    assert!(finding.sentence.contains(&format!("robot.dh_{other}")));
                    "doubted"
                }
                None => "",
            }
        }
    }
}

/// An arm's rows as a calibration leaves them.
fn calibrated(rows: &[[f64; 4]], seed: u64) -> Vec<[f64; 4]> {
    let mut dice = Dice::new(seed);
    let mut off = |row: &[f64; 4]| {
        let by = [0.05, 0.8, 0.8, 0.05];
        std::array::from_fn(|i| row[i] + dice.between(-by[i], by[i]))
    };
    rows.iter().map(&mut off).collect()
}

#[test]
fn the_wrong_convention_is_named() {
    let (modified, standard_rows) = (DhConvention::Modified, DhConvention::Standard);
    for (name, rows) in ARMS {
        let plain = standard(&rows, [0.0, 0.0]);
        // A tool in the last row; a robot on a slope in the first.
        let with_tool = standard(&rows, [90.0, 150.0]);
        let mut on_slope = rows;
        on_slope[0] = [30.0, 200.0, rows[0][2], 0.0];
        for (form, rows, convention, expected) in [
            ("as written", rows.to_vec(), modified, "refused"),
            ("as written", plain.clone(), standard_rows, "refused"),
            ("calibrated", calibrated(&rows, 1), modified, "refused"),
            ("calibrated", calibrated(&plain, 2), standard_rows, "refused"),
            ("on a slope", on_slope.to_vec(), modified, "doubted"),
            ("with its tool", with_tool.clone(), standard_rows, "doubted"),
            ("with its tool, calibrated", calibrated(&with_tool, 3), standard_rows, "doubted"),
        ] {
            assert_eq!(said(&rows, convention), "", "{name} {form}");
            assert_eq!(said(&rows, convention.other()), expected, "{name} {form}");
        }
    }
}

/// The catalogue's robots written out, in either convention.
#[test]
fn the_right_convention_is_not_doubted() {
    let written = |entry: &CatalogueEntry| -> Vec<[f64; 4]> {
        let rows = entry.dh_rows();
        let row = |r: &DhRow| [r.alpha.to_degrees(), 1e3 * r.a, 1e3 * r.d, r.offset.to_degrees()];
        rows.iter().map(row).collect()
    };
    for entry in catalogue() {
        let rows = written(entry);
        assert_eq!(said(&rows, DhConvention::Modified), "", "{}", entry.key);
        let rows = standard(&rows, [0.0, 0.0]);
        assert_eq!(said(&rows, DhConvention::Standard), "", "{}", entry.key);
        assert!(entry.robot().unwrap().like_in_other_convention().is_none());
    }
    let panda = panda();
    assert!(panda.like_in_other_convention().is_none());
    assert!(ur10(0.0).like_in_other_convention().is_none());
}
