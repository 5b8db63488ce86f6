//! Tables are read as people and other programs lay them out, and what was forgotten in them is named.

use super::*;
use crate::common::cases::slip;
use stiffarm::findings::codes;

const HEADING: &str = "posture,state,point,x_mm,y_mm,z_mm,q1_deg,q2_deg\n";

const WHOLE: &str = "\
posture,state,point,x_mm,y_mm,z_mm,q1_deg,q2_deg
P1,unloaded,left,1500.125,-200.5,900.25,12.5,-30
P1,unloaded,right,1350.5,-50.25,900.5,12.5,-30
P1,loaded,left,1500.25,-200.75,899.5,12.5,-30
P1,loaded,right,1350.75,-50.5,899.75,12.5,-30
";

fn same(text: &str) -> Check {
    let table = readings(text, &rope_cell()).map_err(|error| format!("{text}{error}"))?;
    assert_eq!(
        without_lines(ReadingTable { remarks: Vec::new(), ..table }),
        without_lines(readings(WHOLE, &rope_cell())?),
        "{text}"
    );
    Ok(())
}

#[test]
fn a_unit_may_stand_behind_any_sign() -> Check {
    for sign in [
        "X / mm",
        "X [mm]",
        "x_(mm)",
        "x (mm)",
        "x in mm",
        "x/mm",
        "X, mm",
        "x_[mm]",
        "x mm",
        "x..mm.",
        "x.mm",
        "X\u{a0}/\u{a0}mm",
    ] {
        let of = |axis: &str| {
            let other = sign.replacen(['x', 'X'], axis, 1);
            if other.contains(',') { format!("\"{other}\"") } else { other }
        };
        let heading = HEADING.replace("x_mm", &of("x")).replace("y_mm", &of("y")).replace("z_mm", &of("z"));
        same(&WHOLE.replace(HEADING, &heading))?;
    }
    // A unit that we do not have is none, and a word is no unit.
    for other in ["x / cm", "x mm max", "x1 / mm"] {
        let error = readings(&WHOLE.replace("x_mm", other), &rope_cell()).unwrap_err();
        assert_eq!(error.code(), stiffarm::Code::TableHeading, "{other}: {error}");
    }
    Ok(())
}

#[test]
fn numbers_as_typesetters_and_spreadsheets_write_them() -> Check {
    for minus in ['\u{2212}', '\u{2013}', '\u{fe63}'] {
        same(&WHOLE.replace(",-", &format!(",{minus}")))?;
    }
    for blank in ["\u{202f}", "\u{a0}", "\u{2009}", "'", "\u{2019}"] {
        same(&WHOLE.replace("1500.", &format!("1{blank}500.")).replace("1350.", &format!("1{blank}350.")))?;
    }
    same(&WHOLE.replace("-200.5", "\u{2212}\u{202f}200.5"))?;
    let semicolons = WHOLE.replace(',', ";").replace('.', ",");
    same(&semicolons.replace(";1500,", ";1\u{202f}500,"))?;
    // Commas separate, and each number with a fraction stands in quotation marks.
    let quoted = |text: &str| -> String {
        let field = |field: &str| {
            if field.contains('.') { format!("\"{}\"", field.replace('.', ",")) } else { field.to_string() }
        };
        let line = |line: &str| line.split(',').map(field).collect::<Vec<_>>().join(",") + "\n";
        text.lines().map(line).collect()
    };
    same(&quoted(WHOLE))?;
    // Not where one has a point, or a comma may part thousands.
    let cell = rope_cell();
    let mixed = quoted(WHOLE).replace("\"900,25\"", "900.25");
    assert_eq!(readings(&mixed, &cell).unwrap_err().code(), stiffarm::Code::DecimalComma);
    let thousands = "P1,unloaded,left,\"1,408\",2,3,0,0\nP1,loaded,left,\"1,408\",2,3,0,0\n";
    let error = readings(&format!("{HEADING}{thousands}"), &cell).unwrap_err();
    assert_eq!(error.code(), stiffarm::Code::DecimalComma, "{error}");
    // A blank at a place where no thousands end parts two numbers.
    let mut report = String::new();
    for wrong in ["15\u{202f}00.125", "1\u{202f}50.125", "1500\u{202f}125"] {
        report += &slip(wrong, readings(&WHOLE.replace("1500.125", wrong), &cell));
    }
    insta::assert_snapshot!("blanks_in_numbers", report);
    Ok(())
}

#[test]
fn rows_of_means_and_remarks_below_the_readings_are_left_out() -> Check {
    let mut report = String::new();
    for below in [
        "Mean,,,1425.4,-125.5,900.1,,\nStd. dev.,,,75.1,75.2,0.4,,\n",
        "Mittelwert,,,1425.4,-125.5,900.1,,\n\u{3c3},,,75.1,75.2,0.4,,\n",
        ",,mean,1425.4,-125.5,900.1,,\n",
        "Measured by M. Fischer on Monday\n",
        ",,,,,,,\nMeasured by M. Fischer,,,,,,,\nDoor open\n",
    ] {
        let text = format!("{WHOLE}{below}");
        same(&text)?;
        let table = readings(&text, &rope_cell())?;
        let said: Vec<&str> = table.remarks.iter().map(|r| r.code.as_str()).collect();
        assert_eq!(said, [codes::ROWS_LEFT_OUT], "{below}");
        report += &format!("» {}\n{}\n\n", below.trim_end(), table.remarks[0].sentence);
    }
    insta::assert_snapshot!("rows_left_out", report);
    // A row between the readings, a posture of that name, a row that is not complete: not silently.
    let mean = "Mean,unloaded,left,1500,-200,900,12.5,-30\nMean,loaded,left,1500,-200,899,12.5,-30\n";
    assert_eq!(readings(&format!("{WHOLE}{mean}"), &rope_cell())?.postures.len(), 2);
    let second = WHOLE.replace("P1,loaded,left", "Door open\nP1,loaded,left");
    assert!(readings(&second, &rope_cell()).is_err());
    assert!(readings(&format!("{WHOLE}P1,,,,,,,\n"), &rope_cell()).is_err());
    assert!(readings(&format!("{WHOLE}P2,,,1,2,3,,\n"), &rope_cell()).is_err());
    Ok(())
}

#[test]
fn names_and_loads_in_the_first_row_of_a_group_hold_for_all_of_it() -> Check {
    for text in [
        WHOLE
            .replace("\nP1,unloaded,right", "\n,,right")
            .replace("\nP1,loaded,", "\n,loaded,")
            .replace("\n,loaded,right", "\n,,right"),
        WHOLE
            .replace("unloaded,right", ",right")
            .replace("loaded,right", ",right")
            .replace("900.5,12.5,-30", "900.5,,")
            .replace("5,899.75,12.5,-30", "5,899.75,,"),
    ] {
        same(&text)?;
        let table = readings(&text, &rope_cell())?;
        assert_eq!(table.remarks[0].code, codes::CARRIED_DOWN);
    }
    // A wrench once per state, as its first row has it.
    let cell = cell_with("kind = 'measured'", "");
    let forces = |rest: &str| {
        let rows = WHOLE.lines().skip(1).zip([",0,0,0", ",0,0,0", ",1,2,-500", rest]);
        let rows: String = rows.map(|(row, force)| format!("{row}{force}\n")).collect();
        format!("{},fx_n,fy_n,fz_n\n{rows}", HEADING.trim_end())
    };
    let once = readings(&forces(",,,"), &cell)?;
    let whole = readings(&forces(",1,2,-500"), &cell)?;
    assert_eq!(once.postures, whole.postures);
    assert_eq!(
        once.remarks[0].sentence,
        "fx_n, fy_n and fz_n stand in the first row of a group alone: the rows below have the same (lines 5)."
    );
    // One that was forgotten, and groups that do not begin where an outer one does.
    let mut report = String::new();
    for (from, to) in
        [("P1,loaded,right", "P1,,right"), ("P1,loaded,right", ",loaded,right"), ("P1,unloaded,left", ",unloaded,left")]
    {
        report += &slip(to, readings(&WHOLE.replace(from, to), &rope_cell()));
    }
    report += &slip("a force without its other components", readings(&forces(",1,,"), &cell));
    insta::assert_snapshot!("forgotten_in_a_group", report);
    Ok(())
}

#[test]
fn a_position_of_zeros_and_a_lost_decimal_sign_are_named_by_their_rows() {
    let more = "P1,unloaded-2,left,1500.126,-200.5,900.25,12.5,-30\nP1,unloaded-2,right,1350.5,-50.25,900.5,12.5,-30\n";
    let text = format!("{WHOLE}{more}");
    let mut report = String::new();
    for (from, to) in [
        ("1500.25,-200.75,899.5", "0,0,0"),
        ("1350.75,-50.5,899.75", "0.0,0.000,0"),
        ("1500.25,", "150025,"),
        ("-50.5,899.75", "-50.5,89975"),
        ("-200.75", "-20075"),
        ("1500.25,-200.75,899.5", "150025,-20075,8995"),
        ("1350.75", "1.35075"),
    ] {
        assert!(text.contains(from));
        let error = readings(&text.replace(from, to), &rope_cell()).unwrap_err();
        report += &format!("» {to}\n[{}] {error}\n", error.code().as_str());
        // With two readings of the point alone, too, where the place tells which is wrong.
        let short = WHOLE.replace(from, to);
        match readings(&short, &rope_cell()) {
            Err(error) => report += &format!("of two: {error}\n"),
            Ok(_) => report += "of two: read\n",
        }
    }
    // Of postures whose rows do not stand together each is named once.
    let others = WHOLE.lines().skip(1).map(|line| line.replacen("P1", "P2", 1) + "\n");
    let two = text.clone() + &others.collect::<String>() + "P1,loaded-2,left,0,0,0,12.5,-30\n";
    let error = readings(&two.replace("1500.25,-200.75,899.5", "0,0,0"), &rope_cell()).unwrap_err();
    assert!(error.message().ends_with("of posture P1, P2."), "{error}");
    insta::assert_snapshot!("no_readings", report);
    // A dial that was set to zero reads zeros, and another point is no lost sign.
    let dial = WHOLE.replace("1500.125,-200.5,900.25", "0,0,0").replace("1500.25,-200.75,899.5", "0.1,0.2,-0.7");
    assert!(readings(&dial, &rope_cell()).is_ok());
    let swapped = text.replace("1500.25,-200.75,899.5", "1350.75,-50.5,899.75");
    assert!(readings(&swapped, &rope_cell()).is_ok());
}
