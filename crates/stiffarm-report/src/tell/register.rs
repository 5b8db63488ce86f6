//! The page of `register`: where the tracker stands, and which points disagree.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::tell::Given;
use crate::tell::{Block, DataTable, Number, Section, Text, Told};
use stiffarm::Result;
use stiffarm::findings::{Severity, visible};
use stiffarm::measure::registration::RegistrationRecord;

/// What a result says of `register`.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    let found: RegistrationRecord = context.saved.result()?;
    let mm = |below: &str| context.number(below).mm().decimals(4);
    let done = Text::new(format!(
        "The tracker was registered to the robot's base by {} points that both know.",
        found.pairs.len()
    ));
    let came = Text::new("The points agree within ")
        .number(mm("/rms_m"))
        .words(" (RMS); a coordinate scatters by ")
        .number(mm("/residual_std_m"))
        .words(format!(
            ", from {} degrees of freedom.",
            found.degrees_of_freedom
        ));
    let serious = found
        .findings
        .iter()
        .any(|f| f.severity == Severity::Serious);
    let next = match serious {
        true => Text::default()
            .strong("Settle what is marked serious first")
            .words(": the points at the top of the table, then register again."),
        false => Text::new("Give it to the readings: ")
            .code("--registration")
            .words(" of identify and validate reads this file; or copy the transform into [tracker] of the cell."),
    };
    let size = |i: &usize| {
        let squares = found.residuals_m[*i].iter().map(|c| c * c);
        squares.sum::<f64>().sqrt()
    };
    let mut order: Vec<usize> = (0..found.residuals_m.len()).collect();
    order.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let mut key = DataTable::new(
        "Base position minus transformed tracker position, the largest first",
        ["point", "x [mm]", "y [mm]", "z [mm]", "distance [mm]"],
    );
    for i in order {
        let axis = |k: usize| Text::from(mm(&format!("/residuals_m/{i}/{k}")).bare());
        let distance = Number::new("", Some(size(&i))).mm().bare().decimals(4);
        let cells = [axis(0), axis(1), axis(2), distance.into()];
        key.row(name(&found, i), cells);
    }
    let all = 0..found.residuals_m.len();
    let figure = Figure {
        id: "registration".into(),
        title: "What the registration leaves at each point".into(),
        caption: "Distance between a point's base position and its transformed tracker position. One point far above the \
                  others is mistaken or moved."
            .into(),
        columns: 1,
        panels: vec![Panel {
            title: String::new(),
            x: Axis::categorical("point", all.clone().map(|i| name(&found, i))),
            y: Axis::linear("distance", "mm").from_zero(),
            series: vec![Series::new(
                "residual",
                Style::Bars,
                all.clone().map(|i| i as f64).collect(),
                all.map(|i| 1e3 * size(&i)).collect(),
            )],
            equal_aspect: false,
        }],
    };
    let mut table = DataTable::new("Base frame from tracker frame", ["", "x", "y", "z"]);
    let row = |below: &str, of: &dyn Fn(Number) -> Number| {
        [0, 1, 2].map(|k| Text::from(of(context.number(&format!("{below}/{k}")))))
    };
    table.row(
        "origin [mm]",
        row("/translation_m", &|n| n.mm().bare().decimals(4)),
    );
    table.row(
        "roll, pitch, yaw [deg]",
        row("/rpy_deg", &|n| n.decimals(7)),
    );
    let sections = vec![
        Section::new("residuals", "Point by point", vec![Block::Figure(figure)]),
        Section::new("transform", "The transform", vec![Block::Table(table)]),
    ];
    let heading = "Registration of the tracker".to_string();
    Ok(context.told(heading, [done, came, next], Some(key), sections))
}

/// A pair's name as it is shown.
fn name(found: &RegistrationRecord, i: usize) -> String {
    let own = found.pairs.get(i);
    own.map_or_else(String::new, |name| visible(name).into_owned())
}
