//! The page of `predict`: how far the loaded tool bends away, and how sure that is.

use super::at_work::{
    AtWork, WorkPoint, along, band_table, dominant, norm, principal_table, wrench,
};
use super::points::{all_points, extreme_rows, largest_first};
use crate::path::{PathCurvePoint, path_figure};
use crate::path_components::{PathShift, path_components_figure};
use crate::point_deflection::{PointDeflection, point_deflection_figure};
use crate::tell::Given;
use crate::tell::{Block, DataTable, Section, Text, Told};
use stiffarm::Result;
use stiffarm::findings::visible;
use stiffarm::work::predict::Prediction;

/// Rows of the key table.
const KEY_ROWS: usize = 5;

/// What a result says of `predict`.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    let prediction: Prediction = context.saved.result()?;
    let work = What::of(context);
    let verdict = [
        done(&prediction, &work),
        came(context, &prediction),
        next(&prediction, &work),
    ];
    let order = largest_first(prediction.points.iter().map(|p| p.deflection_m));
    let caption = "Deflection of the tool tip where it is largest, with its total ±";
    let key = points_table(
        context,
        &prediction,
        caption,
        &order[..order.len().min(KEY_ROWS)],
    );
    let mut sections = vec![
        cell_section(context, &prediction, &work)?,
        path_section(&prediction, &work),
    ];
    sections.extend(band_section(context, &prediction));
    sections.extend(stiffness_section(context, &prediction));
    sections.push(all_points(
        "The points",
        prediction.points.len(),
        |caption, rows| points_table(context, &prediction, caption, rows),
    ));
    Ok(context.told(
        "Predicted deflection".to_string(),
        verdict,
        Some(key),
        sections,
    ))
}

/// What was predicted.
struct What {
    /// Points of a path, and not tasks of the cell.
    is_path: bool,
    /// The cell's own load at its loading point.
    is_cell_load: bool,
}

impl What {
    fn of(context: &Given<'_>) -> Self {
        let json = &context.saved.json;
        let is_cell_load = json["options"]["load_at"] == "loading_point";
        What {
            is_path: !json["result"]["postures"].is_null(),
            is_cell_load,
        }
    }

    fn name(&self) -> &'static str {
        match (self.is_path, self.is_cell_load) {
            (true, _) => "path",
            (false, true) => "postures",
            (false, false) => "tasks",
        }
    }
}

fn done(prediction: &Prediction, what: &What) -> Text {
    let count = prediction.points.len();
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
    Text::new(format!(
        "The deflection of the tool tip was predicted {points}, each under its own load."
    ))
}

/// The point of the largest deflection.
fn worst(prediction: &Prediction) -> Option<usize> {
    let sizes = prediction.points.iter().map(|p| p.deflection_m);
    largest_first(sizes).first().copied()
}

fn came(context: &Given<'_>, prediction: &Prediction) -> Text {
    let number = |below: &str| context.number(below).mm().decimals(3);
    let text = Text::new("The tool bends away by ")
        .number(number("/deflection_rms_m"))
        .words(" (RMS), at most ")
        .number(number("/deflection_max_m"));
    let at = format!(" at point {}", visible(&prediction.deflection_max_point));
    let worst = worst(prediction);
    let band = worst.and_then(|i| Some((i, prediction.points[i].band?, prediction.confidence?)));
    match band {
        None => text.words(format!("{at}; nothing says how sure that is.")),
        Some((i, band, confidence)) => text
            .words(" ")
            .number(number(&format!("/points/{i}/band/size_m/3")).plus_minus())
            .words(format!(
                " ({} %){at}; most of the ± comes from {}.",
                (1000.0 * confidence).round() / 10.0,
                dominant(band.size_m)
            )),
    }
}

fn next(prediction: &Prediction, what: &What) -> Text {
    if prediction.deflection_rms_m == 0.0 {
        return Text::new("Give the path its forces, in its own columns or in ")
            .code("[work]")
            .words(" of the cell.");
    }
    let Some(band) = worst(prediction).and_then(|i| prediction.points[i].band) else {
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
        } else {
            text.words("measure more postures; ")
                .code("stiffarm select")
                .words(" chooses those that help most.")
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

fn points_table(
    context: &Given<'_>,
    prediction: &Prediction,
    caption: &str,
    rows: &[usize],
) -> DataTable {
    let headings = [
        "point",
        "deflection [mm]",
        "± total [mm]",
        "x [mm]",
        "y [mm]",
        "z [mm]",
        "force [N]",
    ];
    let mut table = DataTable::new(caption, headings);
    for &i in rows {
        let at = |below: &str| {
            let number = context.number(&format!("/points/{i}{below}"));
            Text::from(number.mm().bare().decimals(3))
        };
        let point = &prediction.points[i];
        let force = crate::tell::Number::new("", Some(norm(point.force_n)));
        let cells = [
            at("/deflection_m"),
            at("/band/size_m/3"),
            at("/shift_m/0"),
            at("/shift_m/1"),
            at("/shift_m/2"),
            force.decimals(0).into(),
        ];
        table.row(visible(&point.point).into_owned(), cells);
    }
    table
}

fn cell_section(context: &Given<'_>, prediction: &Prediction, what: &What) -> Result<Section> {
    let extremes = prediction.extremes.iter().flat_map(|e| [e.best, e.worst]);
    let extremes: Vec<_> = extremes.collect();
    let points = prediction.points.iter().enumerate().map(|(i, point)| {
        let own = point.stiffness.as_ref().map(|s| s.principal);
        let of_extreme = extremes.iter().find(|e| e.at == i).map(|e| e.principal);
        WorkPoint {
            name: point.point.to_string(),
            q: point.q.clone(),
            tip_m: point.tip_m,
            wrench: wrench(point.force_n, point.moment_nm),
            shift_m: point.shift_m,
            principal: own.or(of_extreme),
        }
    });
    let work = AtWork {
        groups: vec![(what.name(), points.collect())],
        stiffness: &prediction.stiffness_nm_per_rad,
        model: prediction.model,
        at_tip: !what.is_cell_load,
        path: what.is_path.then_some("path"),
        kept: extremes.iter().map(|e| e.at).collect(),
    };
    let explained = match what.is_path {
        true => {
            "Step through the postures along the path; its colour is the deflection, and the slider exaggerates it. \
             Where the tip bends least and most, an ellipsoid shows how it gives way."
        }
        false => {
            "Step through the postures and let the arm bend; where the tip bends least and most, an ellipsoid shows how \
             it gives way."
        }
    };
    work.section(context, explained)
}

fn path_section(prediction: &Prediction, what: &What) -> Section {
    match what.is_path {
        true => along_path(prediction),
        false => point_by_point(prediction),
    }
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

fn along_path(prediction: &Prediction) -> Section {
    let points = &prediction.points;
    let lengths = along(points.iter().map(|p| p.tip_m));
    let curve = points
        .iter()
        .zip(&lengths)
        .map(|(point, along)| PathCurvePoint {
            along_m: *along,
            deflection_m: point.deflection_m,
            half_width_m: point.band.map(|band| band.size_m[3]),
            left_m: None,
        });
    let curve: Vec<PathCurvePoint> = curve.collect();
    let shifts = points.iter().zip(&lengths).map(|(point, along)| PathShift {
        along_m: *along,
        shift_m: point.shift_m,
        half_width_m: point.band.map(|band| band.total_m),
    });
    let shifts: Vec<PathShift> = shifts.collect();
    let caption = "The same deflection by its components in base axes: a part comes out wrong where its surface lies \
                   across them.";
    let blocks = vec![
        Block::Figure(path_figure(&curve, prediction.confidence)),
        Block::Figure(path_components_figure(
            &shifts,
            "deflection",
            prediction.confidence,
            caption.to_string(),
        )),
    ];
    Section::new("path", "Along the path", blocks)
}

fn band_section(context: &Given<'_>, prediction: &Prediction) -> Option<Section> {
    let i = worst(prediction)?;
    let band = prediction.points[i].band?;
    let name = visible(&prediction.points[i].point);
    let caption = format!("What the ± is made of at point {name}, where the tip bends most");
    let table = band_table(context, caption, &format!("/points/{i}/band"));
    let text = Text::new(format!("Most of the ± comes from {}. ", dominant(band.size_m)))
        .words("Over all points the errors that the bands stand for are ")
        .number(context.number("/error_rms_m").mm().decimals(3))
        .words(
            " (RMS, all axes together). The bands know what the identification knows: what the model leaves out, ",
        )
        .code("stiffarm validate")
        .words(" shows on readings kept out.");
    let blocks = vec![Block::Text(text), Block::Table(table)];
    Some(Section::new("how-sure", "How sure that is", blocks))
}

fn stiffness_section(context: &Given<'_>, prediction: &Prediction) -> Option<Section> {
    let extremes = prediction.extremes?;
    let rows = extreme_rows(&extremes, |at| {
        Some(prediction.points.get(at)?.point.to_string())
    });
    let words = "A force along the softest axis moves the tip most; turning the workpiece so that forces act along a \
                 stiffer one helps as much as a stiffer place.";
    let blocks = vec![
        Block::Text(words.into()),
        Block::Table(principal_table(context, &rows)),
    ];
    Some(Section::new(
        "stiffness",
        "Which way the tip gives way",
        blocks,
    ))
}
