//! The verdict on the measured readings, in the order in which one acts.

use super::shown;
use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::summary::{Block, DataTable, Number, Quantity, Section, Text};
use stiffarm::ask::identify::Reduced;
use stiffarm::findings::{Severity, list, visible};
use stiffarm::measure::reduction::UnloadedRegistration;
use stiffarm::measure::screening::{Screening, Suspicion};

/// What was found about the readings; `None` where nothing is worth a word.
pub(in crate::summary) fn section(screening: Option<&Screening>, readings: Option<&Reduced>) -> Option<Section> {
    let mut blocks = Vec::new();
    if let Some(screening) = screening.filter(|s| !s.suspicions.is_empty()) {
        blocks.push(Block::Table(suspicions(screening)));
    }
    if let Some(readings) = readings {
        blocks.push(Block::Table(checks(readings)));
        let registration = readings.reduction.registration.as_ref();
        blocks.extend(registration.filter(|r| r.postures.len() > 1).map(|r| Block::Figure(registration_figure(r))));
    }
    let title = "The readings: what to correct, what to know";
    (!blocks.is_empty()).then(|| Section::new("readings", title, blocks))
}

/// What is likely wrong, one row each, the first to be corrected first.
fn suspicions(screening: &Screening) -> DataTable {
    let all = &screening.suspicions;
    let weight = |i: &usize| screening.findings.get(*i).map(|f| f.severity);
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by_key(|i| std::cmp::Reverse(weight(i)));
    DataTable::of(
        "What is likely wrong with the table, in the order to correct it",
        "likely cause",
        order.iter().map(|i| cause(&all[*i])),
    )
    .words("weight", |row| match weight(&order[row]) {
        Some(Severity::Serious) => Text::default().strong("serious"),
        Some(Severity::Caution) => "caution".into(),
        _ => "note".into(),
    })
    .words("where", |row| place(&all[order[row]]).into())
    .words("lines", |row| {
        let lines: Vec<String> = all[order[row]].lines.iter().map(usize::to_string).collect();
        shortened(&lines).into()
    })
    .numbers("misfit as read", Quantity::LENGTH, |row| all[order[row]].before_m.map(Number::new))
    .numbers("misfit corrected", Quantity::LENGTH, |row| all[order[row]].after_m.map(Number::new))
}

/// The stable name of a cause as words.
fn cause(suspicion: &Suspicion) -> String {
    let name = serde_json::to_string(&suspicion.cause).unwrap_or_default();
    name.trim_matches('"').replace('_', " ")
}

/// Posture, state and points of a suspicion.
fn place(suspicion: &Suspicion) -> String {
    let part = |word: &str, names: &[String]| {
        let names = shown(names);
        (!names.is_empty()).then(|| {
            let word = match names.len() {
                2.. if !word.is_empty() => format!("{word}s"),
                _ => word.to_string(),
            };
            format!("{word} {}", shortened(&names)).trim().to_string()
        })
    };
    let parts = [
        part("posture", &suspicion.postures),
        part("state", &suspicion.states),
        part("point", &suspicion.points),
        // Their names say what they are.
        part("", &suspicion.joints),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    if parts.is_empty() { "the whole table".to_string() } else { parts.join(", ") }
}

/// A list of which a long middle is left out.
pub(super) fn shortened(names: &[String]) -> String {
    match names {
        [] => "–".to_string(),
        [first, second, .., last] if names.len() > 6 => {
            format!("{first}, {second}, …, {last} ({})", names.len())
        }
        names => list(names),
    }
}

/// What else the readings say of the day: one row per check.
fn checks(readings: &Reduced) -> DataTable {
    let mut table = DataTable::new(
        "What the readings say of the measurement itself",
        ["check", "found [mm]", "by noise alone [mm]", "what it means"],
    );
    let mm = |length: f64| Text::from(Number::new(length).of(Quantity::LENGTH.bare()));
    let reduction = &readings.reduction;
    if let Some(registration) = &reduction.registration {
        let left: Vec<String> =
            registration.postures.iter().filter(|p| !p.used).map(|p| visible(&p.posture).into_owned()).collect();
        let how = if registration.given {
            "the tracker's place is as given; the unloaded points check it".to_string()
        } else {
            format!(
                "the tracker's place comes from the unloaded points of {} of {} postures",
                registration.postures.len() - left.len(),
                registration.postures.len()
            )
        };
        let how = if left.is_empty() { how } else { format!("{how}; {} disagrees", shortened(&left)) };
        let turn = registration.turn_standard_error_rad.into_iter().flatten();
        let how = match turn.reduce(f64::max) {
            Some(turn) => {
                let turn = Number::computed(1e3 * turn).significant(2).unit("mrad");
                format!("{how}; turn known to {}", turn.text())
            }
            None => how,
        };
        let cells = [mm(registration.rms_m), "–".into(), how.into()];
        table.row("registration, RMS from the kinematic model", cells);
    }
    if let Some(repeats) = &reduction.repeatability {
        let mut how =
            format!("scatter of one reading along an axis, from {} degrees of freedom", repeats.degrees_of_freedom);
        if repeats.identical_readings > 0 {
            how += &format!("; {} readings repeat another to the last digit", repeats.identical_readings);
        }
        let cells = [mm(repeats.std_m), "–".into(), how.into()];
        table.row("repeatability", cells);
    }
    if let Some(drift) = &reduction.drift {
        let how = match drift.significance {
            Some(p) if p < 1e-3 => "more than noise; a straight line in time is taken off, look for its cause",
            _ => "no more than noise; a straight line in time is taken off",
        };
        let cells = [mm(drift.rms_m), mm(drift.expected_rms_m), how.into()];
        table.row("drift within a posture, RMS along an axis", cells);
    }
    let motion = reduction.base_motion.iter();
    let largest = motion.max_by(|a, b| a.largest_correction_m.total_cmp(&b.largest_correction_m));
    if let Some(largest) = largest {
        let how = format!(
            "largest correction, at posture {}, {:.1} times what noise gives; it is taken off the displacements",
            visible(&largest.posture),
            largest.times_noise
        );
        let cells = [mm(largest.largest_correction_m), mm(largest.noise_m), how.into()];
        table.row("motion of the base", cells);
    }
    table
}

/// How the unloaded points of each posture fit the kinematic model.
fn registration_figure(registration: &UnloadedRegistration) -> Figure {
    let postures = &registration.postures;
    let bars = |label: &str, used: bool| {
        let drawn = postures.iter().enumerate().filter(|(_, p)| p.used == used);
        let (x, y) = drawn.map(|(i, p)| (i as f64, 1e3 * p.rms_m)).unzip();
        Series::new(label, Style::Bars, x, y)
    };
    let mut series = vec![bars("used", true)];
    if postures.iter().any(|p| !p.used) {
        series.push(bars("left out: disagrees with the others", false));
    }
    let names = postures.iter().map(|p| visible(&p.posture).into_owned());
    Figure::one(
        "registration",
        "Unloaded points against the kinematic model",
        "RMS distance between where the unloaded measuring points are and where the angles put them. One posture far \
         above the others has wrong angles or exchanged rows; all of them large is the calibration of the robot.",
        Panel::new("", Axis::categorical("posture", names), Axis::linear("RMS distance", "mm").from_zero(), series),
    )
}
