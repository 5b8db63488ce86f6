//! What `predict` says: how far the loaded tool bends away, and how sure that is.

use super::at_work::{AtWork, FORCE, WorkPoint, band_table, dominant, principal_table, wrench};
use super::points::{KEY_ROWS, all_points, extreme_places, features_section, heading, how_found, largest_first};
use super::postures::DEGREES;
use crate::level::level;
use crate::path::{along, prediction_figure};
use crate::path_components::{PathShift, path_components_figure};
use crate::point_deflection::{PointDeflection, point_deflection_figure};
use crate::summary::{Block, Context, DataTable, Form, Number, Quantity, Section, Summarise, Summary, Text};
use stiffarm::Result;
use stiffarm::ask::predict::{PredictOptions, Predicted};
use stiffarm::findings::{codes, visible};
use stiffarm::work::predict::{POINT_COLUMNS, PointMeasure, PointPrediction, Prediction};

/// Points whose stiffness matrices are shown.
const MATRICES: usize = 2;
/// An entry of such a matrix: newtons per millimetre and per milliradian alike.
const STIFFNESS: Quantity = Quantity::new("", 1e-3, Form::Significant(5));
/// Entries of a matrix below this share of the largest are rounding.
const ROUNDING: f64 = 1e-12;

impl Summarise<PredictOptions> for Predicted {
    fn summary(&self, options: &PredictOptions, context: &Context<'_>) -> Result<Summary> {
        let prediction = &self.prediction;
        let work = What { is_path: self.postures.is_some(), is_cell_load: options.cell_load };
        let findings = self.every_finding();
        // Directions that no reading has loaded rule the ±.
        let is_untold = findings.iter().any(|f| f.code == codes::NEVER_LOADED);
        let order = largest_first(prediction.points.iter().map(|p| p.deflection_m));
        let worst = order.first().copied();
        let verdict = [
            what_was_done(self, &work),
            conclusion(prediction, worst, is_untold),
            next_step(prediction, &work, worst, is_untold),
        ];
        let shown = &order[..order.len().min(KEY_ROWS)];
        let caption = "Deflection of the tool tip where it is largest";
        let key = points_table(prediction, caption, shown);
        let mut sections = Vec::new();
        if context.pictures {
            sections.push(cell_section(context, prediction, &work)?);
            sections.push(path_section(context, prediction, &work));
        }
        sections.extend(features_section(&self.features));
        sections.extend(matrices_section(prediction));
        sections.extend(worst.and_then(|worst| band_section(prediction, worst)));
        sections.extend(stiffness_section(prediction));
        let count = prediction.points.len();
        sections.push(all_points(context, "The points", count, |caption, rows| {
            with_columns(prediction, rows, points_table(prediction, caption, rows), true)
        }));
        Ok(context.summary(findings, "Predicted deflection", verdict, Some(key), sections))
    }
}

/// What was predicted.
struct What {
    /// Points of a path, and not tasks of the cell.
    is_path: bool,
    /// The cell's own load at its loading point.
    is_cell_load: bool,
}

impl What {
    fn name(&self) -> &'static str {
        match (self.is_path, self.is_cell_load) {
            (true, _) => "path",
            (false, true) => "postures",
            (false, false) => "tasks",
        }
    }
}

fn what_was_done(predicted: &Predicted, what: &What) -> Text {
    let count = predicted.prediction.points.len();
    let points = match (what.is_path, what.is_cell_load, count) {
        (true, _, 1) => "at one point of the path".to_string(),
        (true, _, count) => format!("at {count} points of the path"),
        (false, true, 1) => "at one posture under the load of the identification".to_string(),
        (false, true, count) => {
            format!("at {count} postures under the load of the identification")
        }
        (false, false, 1) => "at the one task of the cell".to_string(),
        (false, false, count) => format!("at the {count} tasks of the cell"),
    };
    Text::new(format!("The deflection of the tool tip was predicted {points}, each under its own load."))
        .then(predicted.postures.as_ref().map_or_else(Text::default, how_found))
}

fn conclusion(prediction: &Prediction, worst: Option<usize>, is_untold: bool) -> Text {
    let mm = |length: f64| Number::new(length).of(Quantity::LENGTH);
    let text = Text::new("The tool bends away by ")
        .number(mm(prediction.deflection_rms_m))
        .words(" (RMS), at most ")
        .number(mm(prediction.deflection_max_m));
    let at = format!(" at point {}", visible(&prediction.deflection_max_point));
    let band = worst.and_then(|i| Some((prediction.points[i].band?, prediction.confidence?)));
    match band {
        None => text.words(format!("{at}; nothing says how sure that is.")),
        Some((band, confidence)) => text.words(" ").number(mm(band.size_m[3]).plus_minus()).words(format!(
            " ({} %){at}; most of the ± comes from {}.",
            level(confidence),
            if is_untold { "loads that were never applied" } else { dominant(band.size_m) }
        )),
    }
}

fn next_step(prediction: &Prediction, what: &What, worst: Option<usize>, is_untold: bool) -> Text {
    if prediction.deflection_rms_m == 0.0 {
        return Text::new("Give the path its forces, in its own columns or in ").code("[work]").words(" of the cell.");
    }
    let Some(band) = worst.and_then(|i| prediction.points[i].band) else {
        return Text::new("Predict with an identified stiffness, so that the deflection has a ±: ")
            .code("stiffarm identify cell.toml readings.csv --output k.json")
            .words(" writes it.");
    };
    if band.size_m[3] > 0.5 * prediction.deflection_max_m {
        let [statistical, common, load, _] = band.size_m;
        let text = Text::new("The ± is large beside the deflection: ");
        return if load >= statistical.max(common) {
            text.words("measure the force at work and state its uncertainty with ")
                .code("--load-uncertainty-percent")
                .words(".")
        } else if common >= statistical {
            text.words("make the largest common error smaller that ")
                .code("stiffarm identify --details")
                .words(" names.")
        } else if is_untold {
            text.words("measure the same postures under another load, too, and identify from both.")
        } else {
            text.words("measure more postures; ").code("stiffarm select").words(" chooses those that help most.")
        };
    }
    if what.is_cell_load {
        return Text::new("Measure these postures and compare: ")
            .code("stiffarm validate")
            .words(" says whether the model holds.");
    }
    Text::new("Where that is too much, ")
        .code("stiffarm compensate")
        .words(" gives the path to command instead, and ")
        .code("stiffarm map --place")
        .words(" looks for a stiffer place for the workpiece.")
}

fn points_table(prediction: &Prediction, caption: &str, rows: &[usize]) -> DataTable {
    let names = rows.iter().map(|i| name(&prediction.points[*i]));
    let table = DataTable::of(caption, heading(rows.len(), prediction.points.len()), names);
    with_columns(prediction, rows, table, false)
}

/// The table with its columns, or with those of the details.
fn with_columns(prediction: &Prediction, rows: &[usize], table: DataTable, details: bool) -> DataTable {
    let columns = POINT_COLUMNS.iter().filter(|column| !column.heading.is_empty() && column.is_detail == details);
    columns.fold(table, |table, column| {
        let quantity = match column.measure {
            PointMeasure::Length => Quantity::LENGTH,
            PointMeasure::Turn => DEGREES,
            PointMeasure::Force => FORCE,
            PointMeasure::Moment => Quantity::TORQUE,
        };
        table.numbers(column.heading, quantity, |row| {
            let number = (column.at)(&prediction.points[rows[row]])?;
            // A part of the ± that is not there is none.
            let is_said = number > 0.0 || !details;
            is_said.then(|| Number { is_of_result: !column.key.is_empty(), ..Number::new(number) })
        })
    })
}

/// The name of a point as it is shown.
fn name(point: &PointPrediction) -> String {
    visible(&point.point).into_owned()
}

fn cell_section(context: &Context<'_>, prediction: &Prediction, what: &What) -> Result<Section> {
    let extremes = prediction.extremes.iter().flat_map(|e| [e.best, e.worst]);
    let extremes: Vec<_> = extremes.collect();
    let points = prediction.points.iter().enumerate().map(|(i, point)| {
        let of_point = point.stiffness.as_ref().map(|s| s.principal);
        let of_extreme = extremes.iter().find(|e| e.at == i).map(|e| e.principal);
        WorkPoint {
            name: point.point.to_string(),
            q: point.q.clone(),
            tip_m: point.tip_m,
            wrench: wrench(point.force_n, point.moment_nm),
            shift_m: point.shift_m,
            correction_m: None,
            principal: of_point.or(of_extreme),
        }
    });
    let work = AtWork {
        groups: vec![(what.name(), points.collect())],
        stiffness: &prediction.stiffness_nm_per_rad,
        model: prediction.model,
        at_tip: !what.is_cell_load,
        path: what.is_path.then_some("path"),
        always_shown: extremes.iter().map(|e| e.at).collect(),
    };
    let explained = if what.is_path {
        "Step through the postures along the path; its colour is the deflection, and the slider exaggerates it. \
             Where the tip bends least and most, an ellipsoid shows how it gives way."
    } else {
        "Step through the postures and let the arm bend; where the tip bends least and most, an ellipsoid shows how \
             it gives way."
    };
    work.section(context, explained)
}

fn path_section(context: &Context<'_>, prediction: &Prediction, what: &What) -> Section {
    if what.is_path { along_path(context, prediction) } else { point_by_point(prediction) }
}

/// Postures and tasks are no path: nothing is along them.
fn point_by_point(prediction: &Prediction) -> Section {
    let points = prediction.points.iter().map(|point| PointDeflection {
        name: visible(&point.point).into_owned(),
        shift_m: point.shift_m,
        size_m: point.deflection_m,
        half_width_m: point.band.map(|band| {
            let [x, y, z] = band.total_m;
            [x, y, z, band.size_m[3]]
        }),
    });
    let points: Vec<PointDeflection> = points.collect();
    let figure = point_deflection_figure(&points, prediction.confidence);
    Section::new("path", "Point by point", vec![Block::Figure(figure)])
}

fn along_path(context: &Context<'_>, prediction: &Prediction) -> Section {
    let points = &prediction.points;
    let lengths = along(points.iter().map(|p| p.tip_m));
    let shifts = points.iter().zip(lengths);
    let shifts = shifts.map(|(point, along_m)| PathShift {
        along_m,
        shift_m: point.shift_m,
        half_width_m: point.band.map(|band| band.total_m),
    });
    let caption = "The same deflection by its components in base axes: a part comes out wrong where its surface lies \
                   across them.";
    let workpiece = context.cell.map(|cell| &cell.work.workpiece);
    let blocks = vec![
        Block::Figure(prediction_figure(prediction, workpiece)),
        Block::Figure(path_components_figure(
            &shifts.collect::<Vec<_>>(),
            "deflection",
            prediction.confidence,
            caption.to_string(),
        )),
    ];
    Section::new("path", "Along the path", blocks)
}

fn band_section(prediction: &Prediction, worst: usize) -> Option<Section> {
    let band = prediction.points[worst].band?;
    let name = name(&prediction.points[worst]);
    let caption = format!("What the ± is made of at point {name}, where the tip bends most");
    let table = band_table(caption, &band);
    let text = Text::new(format!("Most of the ± comes from {}. ", dominant(band.size_m)))
        .words("Over all points the errors that the bands stand for are ")
        .number(Number::new(prediction.error_rms_m).of(Quantity::LENGTH))
        .words(" (RMS, all axes together). The bands know what the identification knows: what the model leaves out, ")
        .code("stiffarm validate")
        .words(" shows on readings kept out.");
    let blocks = vec![Block::Text(text), Block::Table(table)];
    Some(Section::new("how-sure", "How sure that is", blocks))
}

fn stiffness_section(prediction: &Prediction) -> Option<Section> {
    let extremes = prediction.extremes?;
    let places = extreme_places(&extremes, |at| Some(prediction.points.get(at)?.point.to_string()));
    let words = "A force along the softest axis moves the tip most; turning the workpiece so that forces act along a \
                 stiffer one helps as much as a stiffer place.";
    let blocks = vec![Block::Text(words.into()), Block::Table(principal_table(&places))];
    Some(Section::new("stiffness", "Which way the tip gives way", blocks))
}

/// The Cartesian stiffness of the first points, where it was asked for.
fn matrices_section(prediction: &Prediction) -> Option<Section> {
    let points = prediction.points.iter();
    let points = points.filter_map(|p| Some((name(p), p.stiffness.as_deref()?)));
    let mut blocks = Vec::new();
    for (name, stiffness) in points.take(MATRICES) {
        let axes = (format!("point {name}"), stiffness.principal);
        blocks.push(Block::Table(principal_table(&[axes])));
        let both = [("K, Eq. (2)", &stiffness.matrix), ("K with K_C of this load", &stiffness.matrix_with_k_c)];
        blocks.extend(both.map(|(what, matrix)| match matrix {
            Some(matrix) => {
                let units = "N/mm, N/mrad; N·m/mm, N·m/mrad";
                let caption = format!("{what}, at point {name} [{units}]");
                Block::Table(matrix_table(caption, matrix))
            }
            None => Block::Text(format!("{what}: none, point {name} is singular.").into()),
        }));
    }
    (!blocks.is_empty()).then(|| Section::new("matrices", "Stiffness matrices of the tip", blocks).in_summary())
}

fn matrix_table(caption: String, matrix: &[[f64; 6]; 6]) -> DataTable {
    let largest = matrix.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
    let table = DataTable::of(caption, "", ["Fx", "Fy", "Fz", "Mx", "My", "Mz"]);
    let axes = ["x", "y", "z", "about x", "about y", "about z"].into_iter();
    axes.enumerate().fold(table, |table, (column, heading)| {
        table.numbers(heading, STIFFNESS, |row| {
            let value = matrix[row][column];
            Some(if value.abs() < ROUNDING * largest { Number::computed(0.0) } else { Number::new(value) })
        })
    })
}
