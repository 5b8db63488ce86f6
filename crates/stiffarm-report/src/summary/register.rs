//! What `register` says: where the tracker stands, and which points disagree.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::summary::{Block, Context, DataTable, Form, Number, Quantity, Section, Summarise, Summary, Text};
use stiffarm::Result;
use stiffarm::findings::{Severity, visible};
use stiffarm::measure::registration::RegistrationRecord;
use stiffarm::units::rad_to_deg;

/// Roll, pitch and yaw: at the end of ten metres as fine as [`Quantity::LENGTH`].
const ANGLE: Quantity = Quantity::new("deg", 1.0, Form::Decimals(7));
/// A turn, from rad.
const TURN: Quantity = Quantity::new("mrad", 1e3, Form::Significant(2));
/// Places of the points, from m.
const PLACE: Quantity = Quantity::new("mm", 1e3, Form::Decimals(0));

impl<O> Summarise<O> for RegistrationRecord {
    fn summary(&self, _options: &O, context: &Context<'_>) -> Result<Summary> {
        let registration = self;
        let mm = |length: f64| Number::new(length).of(Quantity::LENGTH);
        let what_was_done = Text::new(format!(
            "The tracker was registered to the robot's base by {} points given in both frames.",
            registration.pairs.len()
        ));
        let conclusion = Text::new("The points agree within ")
            .number(mm(registration.rms_m))
            .words(" (RMS); a coordinate scatters by ")
            .number(mm(registration.residual_std_m))
            .words(format!(", from {} degrees of freedom", registration.degrees_of_freedom));
        let conclusion = match registration.known_std_m {
            Some(known_std) => conclusion.words(", where ").number(mm(known_std)).words(" are given."),
            None => conclusion.words("."),
        };
        let is_serious = registration.findings.iter().any(|f| f.severity == Severity::Serious);
        let next_step = if is_serious {
            Text::default()
                .strong("Settle what is marked serious first")
                .words(": the points at the top of the table, then register again.")
        } else {
            Text::new("Save it with ")
                .code("--output registration.json")
                .words(" and give it to the readings with ")
                .code("--registration")
                .words("; or copy the transform into [tracker] of the cell.")
        };
        let sections = vec![
            transform(registration, is_serious).in_summary(),
            uncertainty(registration).in_summary(),
            Section::new("residuals", "Point by point", vec![Block::Figure(figure(registration))]),
        ];
        let heading = "Registration of the tracker";
        let key = residuals(registration);
        Ok(context.summary(
            registration.findings.clone(),
            heading,
            [what_was_done, conclusion, next_step],
            Some(key),
            sections,
        ))
    }
}

/// A pair's name as it is shown.
fn name(registration: &RegistrationRecord, i: usize) -> String {
    let pair = registration.pairs.get(i);
    pair.map_or_else(String::new, |name| visible(name).into_owned())
}

/// How far a point is off \[m\].
fn distance(registration: &RegistrationRecord, i: usize) -> f64 {
    let squares = registration.residuals_m[i].iter().map(|c| c * c);
    squares.sum::<f64>().sqrt()
}

/// What is left at each point, the largest first.
fn residuals(registration: &RegistrationRecord) -> DataTable {
    let mut order: Vec<usize> = (0..registration.residuals_m.len()).collect();
    order.sort_by(|a, b| distance(registration, *b).total_cmp(&distance(registration, *a)));
    let names = order.iter().map(|i| name(registration, *i));
    let caption = "Base position minus transformed tracker position, the largest first";
    let mut table = DataTable::of(caption, "point", names);
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        table = table.numbers(axis, Quantity::LENGTH, |row| Some(Number::new(registration.residuals_m[order[row]][k])));
    }
    table.numbers("distance", Quantity::LENGTH, |row| Some(Number::computed(distance(registration, order[row]))))
}

/// The lines of the cell file.
fn transform(registration: &RegistrationRecord, is_serious: bool) -> Section {
    let line = |key: &str, values: [f64; 3], quantity: Quantity| {
        let numbers = values.map(|value| Number::new(value).of(quantity.bare()));
        Text::new(format!("{key} = [")).numbers(numbers).words("]")
    };
    let lines = vec![
        Text::new("[tracker]"),
        line("xyz_mm", registration.translation_m, Quantity::LENGTH),
        line("rpy_deg", registration.roll_pitch_yaw.map(rad_to_deg), ANGLE),
    ];
    let title = if is_serious {
        "Base frame from tracker frame; not to be used before the serious finding is settled"
    } else {
        "Base frame from tracker frame, for the cell file"
    };
    Section::new("transform", title, vec![Block::Lines(lines)])
}

/// Standard errors of the transform, and the point that a turn leaves where it is.
fn uncertainty(registration: &RegistrationRecord) -> Section {
    let rows = ["shift of the centroid [mm]", "turn [mrad]"];
    let mut table = DataTable::of("Standard errors, base axes", "", rows);
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        table = table.words(axis, |row| {
            let i = 3 * row + k;
            let error = Number::computed(registration.covariance[i][i].max(0.0).sqrt());
            let quantity = [Quantity::LENGTH.digits(2), TURN][row];
            error.of(quantity.bare()).into()
        });
    }
    let centroid = registration.centroid_m.map(|m| Number::new(m).of(PLACE.bare()));
    let about = Text::new("The turn acts about the centroid of the points, (").numbers(centroid).words(") mm.");
    let blocks = vec![Block::Table(table), Block::Text(about)];
    Section::new("uncertainty", "Uncertainty", blocks)
}

fn figure(registration: &RegistrationRecord) -> Figure {
    let all = 0..registration.residuals_m.len();
    Figure::one(
        "registration",
        "What the registration leaves at each point",
        "Distance between a point's base position and its transformed tracker position. One point far above the \
         others is mistaken or moved.",
        Panel::new(
            "",
            Axis::categorical("point", all.clone().map(|i| name(registration, i))),
            Axis::linear("distance", "mm").from_zero(),
            vec![Series::new(
                "residual",
                Style::Bars,
                all.clone().map(|i| i as f64).collect(),
                all.map(|i| 1e3 * distance(registration, i)).collect(),
            )],
        ),
    )
}
