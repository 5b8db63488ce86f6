//! What `compensate` says: the path to command, and what it leaves.

use super::at_work::{AtWork, WorkPoint, band_table, dominant, principal_table, wrench};
use super::points::{
    KEY_ROWS, all_points, along_axes, extreme_places, features_section, heading, how_found,
    largest_first,
};
use crate::path::{along, compensation_figure};
use crate::path_components::{PathShift, path_components_figure};
use crate::tell::{Block, DataTable, Given, Number, Quantity, Section, Telling, Text, Told};
use stiffarm::Result;
use stiffarm::ask::compensate::Compensated;
use stiffarm::findings::visible;
use stiffarm::model::stiffness::Model;
use stiffarm::work::compensate::Compensation;

impl Telling for Compensation {
    fn told(&self, context: &Given<'_>) -> Result<Told> {
        let result = self;
        let count = result.points.len();
        let done = Text::new(format!(
            "The path of {count} points was changed so that the loaded tool follows the path that is wanted."
        ));
        let verdict = [
            done.then(how_found(context)),
            came(context, result),
            next(result),
        ];
        let order = largest_first(result.points.iter().map(|p| p.correction_size_m));
        let key = corrections(
            context,
            result,
            "The largest corrections, each with the ± of the deflection that it makes up for",
            &order[..count.min(KEY_ROWS)],
        );
        let mut sections = Vec::new();
        if context.pictures {
            sections.push(cell_section(context, result)?);
            sections.push(path_section(context, result));
        }
        sections.extend(features_section(context));
        sections.extend(band_section(context, result));
        sections.extend(stiffness_section(context, result));
        sections.push(all_points(
            context,
            "The corrections",
            count,
            |caption, rows| corrections(context, result, caption, rows),
        ));
        Ok(context.told("Compensated path", verdict, Some(key), sections))
    }
}

impl Telling for Compensated {
    fn told(&self, context: &Given<'_>) -> Result<Told> {
        self.compensation.told(context)
    }
}

fn came(context: &Given<'_>, result: &Compensation) -> Text {
    let mm = |below: &str| context.number(below).mm().decimals(3);
    let text = Text::new("Without it the tool bends away by ")
        .number(mm("/uncompensated_rms_m"))
        .words(" (RMS), at most ")
        .number(mm("/uncompensated_max_m"));
    let Some(beyond) = result.beyond_uncertainty else {
        return text
            .words("; nothing says how much of that the correction takes away on the real arm.");
    };
    let text = text.words("; with it ").number(mm("/error_rms_m"));
    let text = match result.expected_factor {
        Some(factor) if factor < 1.0 => text
            .words(" (RMS) are to be expected, ")
            .number(Number::new("", Some(1.0 / factor)).significant(2))
            .words(" times more"),
        Some(_) => text
            .words(" (RMS) are to be expected, ")
            .number(context.number("/expected_factor").significant(2))
            .words(" times less"),
        None => text.words(" (RMS) are to be expected"),
    };
    let count = result.loaded();
    let points = if count == result.points.len() {
        "points"
    } else {
        "points under load"
    };
    if beyond == count {
        text.words(format!(
            ". The correction is larger than its own uncertainty at all {count} {points}."
        ))
    } else {
        text.words(". The correction is larger than its own uncertainty at ")
            .number(context.number("/beyond_uncertainty").decimals(0))
            .words(format!(" of {count} {points}."))
    }
}

fn next(result: &Compensation) -> Text {
    if result.uncompensated_rms_m == 0.0 {
        return Text::new("Give the path its forces, in its own columns or in ")
            .code("[work]")
            .words(" of the cell: without them there is nothing to correct.");
    }
    if result.objections().next().is_some() {
        return Text::new("Do not command this path before what is said here is settled; ")
            .code("--beyond-data")
            .words(" writes it all the same.");
    }
    match result.beyond_uncertainty {
        None => Text::new("Identify the joint stiffness first: ")
            .code("stiffarm identify cell.toml readings.csv --output k.json")
            .words(" says how sure it is, and so whether this correction helps."),
        Some(beyond) if 2 * beyond < result.loaded() => Text::new(
            "Do not command this path yet: the stiffness is not known well enough. Measure more postures; ",
        )
        .code("stiffarm select")
        .words(" chooses those that help most."),
        Some(_) => Text::new("Command the path that ")
            .code("--output commanded.csv")
            .words(" writes, on a test piece first, and measure it."),
    }
}

fn corrections(
    context: &Given<'_>,
    result: &Compensation,
    caption: &str,
    rows: &[usize],
) -> DataTable {
    let point = |row: usize| &result.points[rows[row]];
    let at = |row: usize, below: &str, value: f64| {
        Some(context.valued(&format!("/points/{}/{below}", rows[row]), value))
    };
    let part = |row: usize, axis: usize| {
        let value = point(row).correction_m[axis];
        at(row, &format!("correction_m/{axis}"), value)
    };
    let names = rows.iter().map(|i| visible(&result.points[*i].point));
    let names = names.map(|name| name.into_owned());
    let table = DataTable::of(caption, heading(rows.len(), result.points.len()), names)
        .numbers("deflection without", Quantity::LENGTH, |row| {
            at(row, "uncompensated_m", point(row).uncompensated_m)
        })
        .numbers("correction", Quantity::LENGTH, |row| {
            at(row, "correction_size_m", point(row).correction_size_m)
        });
    along_axes(table, part).numbers("± total", Quantity::LENGTH, |row| {
        at(row, "band/size_m/3", point(row).band?.size_m[3])
    })
}

fn cell_section(context: &Given<'_>, result: &Compensation) -> Result<Section> {
    let extremes = result.extremes.iter().flat_map(|e| [e.best, e.worst]);
    let extremes: Vec<_> = extremes.collect();
    let points = result
        .points
        .iter()
        .enumerate()
        .map(|(i, point)| WorkPoint {
            name: point.point.to_string(),
            q: point.nominal.clone(),
            tip_m: point.tip_m,
            wrench: wrench(point.force_n, point.moment_nm),
            shift_m: point.uncompensated_shift_m,
            correction_m: Some(point.correction_m),
            principal: extremes.iter().find(|e| e.at == i).map(|e| e.principal),
        });
    let work = AtWork {
        groups: vec![("path", points.collect())],
        stiffness: &result.stiffness_nm_per_rad,
        model: Model::Equilibrium,
        at_tip: true,
        path: Some("path"),
        kept: extremes.iter().map(|e| e.at).collect(),
    };
    work.section(
        context,
        "The path that is wanted; in colour, how the tool would bend away from it without correction; thin, what is \
         commanded instead. The slider exaggerates both. Where the tip bends least and most, an ellipsoid shows how it \
         gives way.",
    )
}

fn path_section(context: &Given<'_>, result: &Compensation) -> Section {
    let lengths = along(result.points.iter().map(|p| p.tip_m));
    let shifts = result.points.iter().zip(lengths);
    let shifts = shifts.map(|(point, along_m)| PathShift {
        along_m,
        shift_m: point.correction_m,
        half_width_m: point.band.map(|band| band.total_m),
    });
    let caption = "What the command adds to the path, base axes, with the ± of the deflection that it makes up for: \
                   where the band reaches across zero the correction may as well harm.";
    let workpiece = context.cell.map(|cell| &cell.work.workpiece);
    let blocks = vec![
        Block::Figure(compensation_figure(result, workpiece)),
        Block::Figure(path_components_figure(
            &shifts.collect::<Vec<_>>(),
            "correction",
            result.confidence,
            caption.to_string(),
        )),
    ];
    Section::new("path", "Along the path", blocks)
}

fn band_section(context: &Given<'_>, result: &Compensation) -> Option<Section> {
    let i = *largest_first(result.points.iter().map(|p| p.uncompensated_m)).first()?;
    let band = result.points[i].band?;
    let name = visible(&result.points[i].point);
    let caption = format!("What the ± is made of at point {name}, where the tip bends most");
    let table = band_table(context, caption, &format!("/points/{i}/band"), &band);
    let model = if result.residual_max_m < 1e-9 {
        Text::new("By the model itself nothing is left (below 10⁻⁶ mm): ")
    } else {
        Text::new("By the model itself ")
            .number(context.number("/residual_max_m").mm().significant(2))
            .words(" are left at most: ")
    };
    let text = model.words(format!(
        "what the real arm leaves is the uncertainty of the deflection, most of it from {}, and whatever the model leaves out.",
        dominant(band.size_m)
    ));
    let blocks = vec![Block::Text(text), Block::Table(table)];
    Some(Section::new(
        "how-sure",
        "What is left, and how sure that is",
        blocks,
    ))
}

fn stiffness_section(context: &Given<'_>, result: &Compensation) -> Option<Section> {
    let extremes = result.extremes?;
    let places = extreme_places(&extremes, |at| {
        Some(result.points.get(at)?.point.to_string())
    });
    let table = Block::Table(principal_table(context, &places));
    let title = "Which way the tip gives way";
    Some(Section::new("stiffness", title, vec![table]))
}
