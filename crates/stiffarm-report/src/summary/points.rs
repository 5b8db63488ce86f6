//! What results about many points share: those where something is largest, all of them, and places in words.

use super::at_work::GivesWay;
use crate::summary::{Block, Context, DataTable, Number, Quantity, Section, Text};
use stiffarm::findings::visible;
use stiffarm::units::{m_to_mm, rad_to_deg, rounded, with_minus};
use stiffarm::work::features::{Feature, Verdict};
use stiffarm::work::posture_path::{Origin, PosturePathSummary};
use stiffarm::work::predict::PathExtremes;

/// Rows of the table of those points where something is largest.
pub(super) const KEY_ROWS: usize = 12;
/// Most rows of the table of all points, on a page and in a terminal.
const ROWS: [usize; 2] = [200, 40];

/// Places of values, the largest first.
pub(super) fn largest_first(sizes: impl Iterator<Item = f64>) -> Vec<usize> {
    let mut sizes: Vec<(usize, f64)> = sizes.enumerate().collect();
    sizes.sort_by(|a, b| b.1.total_cmp(&a.1));
    sizes.into_iter().map(|(i, _)| i).collect()
}

/// Adds the components of a length along the base's axes; `at` gives one by row and axis.
pub(super) fn along_axes(table: DataTable, at: impl Fn(usize, usize) -> Option<Number>) -> DataTable {
    let axes = ["along x", "along y", "along z"].into_iter().enumerate();
    axes.fold(table, |table, (axis, heading)| table.numbers(heading, Quantity::LENGTH, |row| at(row, axis)))
}

/// Heading of the points' names, of which `shown` of `count` are in the table of the largest.
pub(super) fn heading(shown: usize, count: usize) -> &'static str {
    if shown == KEY_ROWS && count > shown { "worst points" } else { "point" }
}

/// All of `count` points in a folded table, of very many some evenly along the path; `table` takes a caption and
/// the points.
pub(super) fn all_points(
    context: &Context<'_>,
    summary: &str,
    count: usize,
    table: impl FnOnce(&str, &[usize]) -> DataTable,
) -> Section {
    let [on_page, in_words] = ROWS;
    let most = if context.pictures { on_page } else { in_words };
    let (caption, rows): (String, Vec<usize>) = if count <= most {
        ("All points in their order".to_string(), (0..count).collect())
    } else {
        (
            format!("{most} of the {count} points, evenly along the path; the result's file has all"),
            (0..most).map(|i| i * (count - 1) / (most - 1)).collect(),
        )
    };
    let table = Block::Table(table(&caption, &rows));
    let details = Block::Details(summary.to_string(), vec![table]);
    Section::new("points", "Points", vec![details])
}

/// How the features of a path come out, where the result says so.
pub(super) fn features_section(features: &[Feature]) -> Option<Section> {
    if features.is_empty() {
        return None;
    }
    let verdict = |verdict: Option<Verdict>| Text::new(verdict.map_or("", Verdict::word));
    let names = features.iter();
    let names = names.map(|feature| visible(&feature.name).into_owned());
    let table = DataTable::of("Deviation of each feature, largest over its points", "feature", names)
        .words("worst point", |row| visible(&features[row].worst).into_owned().into())
        .numbers("across feed", Quantity::LENGTH, |row| Some(Number::new(features[row].across_max_m)))
        .numbers("± total", Quantity::LENGTH, |row| features[row].half_width_m.map(Number::new))
        .numbers("tolerance", Quantity::LENGTH, |row| features[row].tolerance_m.map(Number::new))
        .words("verdict", |row| verdict(features[row].verdict))
        .numbers("compensated", Quantity::LENGTH, |row| features[row].compensated_m.map(Number::new))
        .words("then", |row| verdict(features[row].compensated_verdict))
        .numbers("along feed", Quantity::LENGTH, |row| Some(Number::new(features[row].feed_max_m)))
        .numbers("cross", Quantity::LENGTH, |row| Some(Number::new(features[row].cross_max_m)))
        .numbers("tool axis", Quantity::LENGTH, |row| Some(Number::new(features[row].axis_max_m)));
    let words = "What lies across the feed changes the shape of the part, what lies along it does not. Compensated is \
                 what may be left: the residual with its ±.";
    let blocks = vec![Block::Text(words.into()), Block::Table(table)];
    Some(Section::new("features", "Features", blocks))
}

/// The places of the principal axes where the tip bends most and least; `name` is that of a point.
pub(super) fn extreme_places(extremes: &PathExtremes, name: impl Fn(usize) -> Option<String>) -> Vec<GivesWay> {
    let (best, worst) = (&extremes.best, &extremes.worst);
    let both = [("bends most", worst), ("bends least", best)];
    // Of equals there is one.
    let apart = if best.at == worst.at { 1 } else { 2 };
    let places = both.into_iter().take(apart).filter_map(|(words, extreme)| {
        let name = format!("{words}, point {}", visible(&name(extreme.at)?));
        Some((name, extreme.principal))
    });
    places.collect()
}

/// How the postures of a path were found, as a sentence behind another one.
pub(super) fn how_found(postures: &PosturePathSummary) -> Text {
    let how = match postures.origin {
        Origin::Given => " The joint angles are as given",
        Origin::ClosedForm => " The postures come from inverse kinematics in closed form",
        Origin::Numeric => " The postures come from inverse kinematics, iterated",
    };
    let step = Number::new(rad_to_deg(postures.largest_step));
    Text::new(how).words(", with steps of a joint up to ").number(step.significant(3).unit("°")).words(".")
}

/// Where a tip or a workpiece is: `x = 1425.0, y = −814.3, z = 800.0 mm`.
pub(super) fn position(at_m: [f64; 3]) -> Text {
    let mut text = Text::default();
    for (axis, name) in ["x = ", ", y = ", ", z = "].into_iter().enumerate() {
        let number = Number::new(at_m[axis]).of(Quantity::PLACE);
        let number = if axis < 2 { number.bare() } else { number };
        text = text.words(name).number(number);
    }
    text
}

/// Ends of a region along x, y and z \[m\]: `x 900 to 3000 mm, z = 800 mm`.
pub(super) fn region(ends_m: [[f64; 2]; 3]) -> String {
    let mm = |m: f64| with_minus(rounded(m_to_mm(m), 1).to_string());
    let words = ["x", "y", "z"].into_iter().zip(ends_m);
    let words = words.map(|(name, [low, high])| {
        if high > low { format!("{name} {} to {} mm", mm(low), mm(high)) } else { format!("{name} = {} mm", mm(low)) }
    });
    words.collect::<Vec<_>>().join(", ")
}

/// Three components with four digits: `(0, −0.5, 1)`.
pub(super) fn vector(components: [f64; 3]) -> String {
    let parts = components.map(|c| {
        let digits = if c.abs() < 1e-9 { "0".to_string() } else { Number::computed(c).digits() };
        if digits.contains('.') && !digits.contains('e') {
            digits.trim_end_matches('0').trim_end_matches('.').to_string()
        } else {
            digits
        }
    });
    format!("({})", parts.join(", "))
}
