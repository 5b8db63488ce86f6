//! What `compensate` says: the path to command, and what it leaves.

use super::at_work::{AtWork, WorkPoint, band_table, dominant, principal_table, wrench};
use super::points::{
    KEY_ROWS, all_points, along_axes, extreme_places, features_section, heading, how_found, largest_first,
};
use crate::path::{along, compensation_figure};
use crate::path_components::{PathShift, path_components_figure};
use crate::summary::{Block, Context, DataTable, Number, Quantity, Section, Summarise, Summary, Text};
use stiffarm::Result;
use stiffarm::ask::compensate::Compensated;
use stiffarm::findings::visible;
use stiffarm::model::stiffness::Model;
use stiffarm::work::compensate::Compensation;

impl<O> Summarise<O> for Compensated {
    fn summary(&self, _options: &O, context: &Context<'_>) -> Result<Summary> {
        let result = &self.compensation;
        let count = result.points.len();
        let what_was_done = Text::new(format!(
            "The path of {count} points was changed so that the loaded tool follows the nominal path."
        ));
        let verdict = [what_was_done.then(how_found(&self.postures)), conclusion(result), next_step(result)];
        let order = largest_first(result.points.iter().map(|p| p.correction_size_m));
        let key = corrections(
            result,
            "The largest corrections, each with the ± of the deflection that it makes up for",
            &order[..count.min(KEY_ROWS)],
        );
        let mut sections = Vec::new();
        if context.pictures {
            sections.push(cell_section(context, result)?);
            sections.push(path_section(context, result));
        }
        sections.extend(features_section(&self.features));
        sections.extend(band_section(result));
        sections.extend(stiffness_section(result));
        sections
            .push(all_points(context, "The corrections", count, |caption, rows| corrections(result, caption, rows)));
        Ok(context.summary(self.every_finding(), "Compensated path", verdict, Some(key), sections))
    }
}

fn conclusion(result: &Compensation) -> Text {
    let mm = |length: f64| Number::new(length).of(Quantity::LENGTH);
    let text = Text::new("Without correction the tool bends away by ")
        .number(mm(result.uncompensated_rms_m))
        .words(" (RMS), at most ")
        .number(mm(result.uncompensated_max_m));
    let Some(beyond) = result.beyond_uncertainty else {
        return text.words("; nothing says how much of that the correction takes away on the real arm.");
    };
    let text = text.words("; with it ").number(Number::new(result.error_rms_m).of(Quantity::LENGTH));
    let text = match result.expected_factor {
        Some(factor) if factor < 1.0 => text
            .words(" (RMS) are to be expected, ")
            .number(Number::computed(1.0 / factor).significant(2))
            .words(" times more"),
        Some(factor) => {
            text.words(" (RMS) are to be expected, ").number(Number::new(factor).significant(2)).words(" times less")
        }
        None => text.words(" (RMS) are to be expected"),
    };
    let count = result.loaded();
    let points = if count == result.points.len() { "points" } else { "points under load" };
    if beyond == count {
        text.words(format!(". The correction is larger than its own uncertainty at all {count} {points}."))
    } else {
        text.words(". The correction is larger than its own uncertainty at ")
            .number(Number::count(beyond))
            .words(format!(" of {count} {points}."))
    }
}

fn next_step(result: &Compensation) -> Text {
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
        Some(beyond) if 2 * beyond < result.loaded() => {
            Text::new("Do not command this path yet: the stiffness is not known well enough. Measure more postures; ")
                .code("stiffarm select")
                .words(" chooses those that help most.")
        }
        Some(_) => Text::new("Command the path that ")
            .code("--output commanded.csv")
            .words(" writes, on a test piece first, and measure it."),
    }
}

fn corrections(result: &Compensation, caption: &str, rows: &[usize]) -> DataTable {
    let point = |row: usize| &result.points[rows[row]];
    let part = |row: usize, axis: usize| Some(Number::new(point(row).correction_m[axis]));
    let names = rows.iter().map(|i| visible(&result.points[*i].point));
    let names = names.map(|name| name.into_owned());
    let table = DataTable::of(caption, heading(rows.len(), result.points.len()), names)
        .numbers("deflection without", Quantity::LENGTH, |row| Some(Number::new(point(row).uncompensated_m)))
        .numbers("correction", Quantity::LENGTH, |row| Some(Number::new(point(row).correction_size_m)));
    along_axes(table, part).numbers("± total", Quantity::LENGTH, |row| Some(Number::new(point(row).band?.size_m[3])))
}

fn cell_section(context: &Context<'_>, result: &Compensation) -> Result<Section> {
    let extremes = result.extremes.iter().flat_map(|e| [e.best, e.worst]);
    let extremes: Vec<_> = extremes.collect();
    let points = result.points.iter().enumerate().map(|(i, point)| WorkPoint {
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
        always_shown: extremes.iter().map(|e| e.at).collect(),
    };
    work.section(
        context,
        "The nominal path; in colour, how the tool would bend away from it without correction; thin, what is \
         commanded instead. The slider exaggerates both. Where the tip bends least and most, an ellipsoid shows how it \
         gives way.",
    )
}

fn path_section(context: &Context<'_>, result: &Compensation) -> Section {
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

fn band_section(result: &Compensation) -> Option<Section> {
    let i = *largest_first(result.points.iter().map(|p| p.uncompensated_m)).first()?;
    let band = result.points[i].band?;
    let name = visible(&result.points[i].point);
    let caption = format!("What the ± is made of at point {name}, where the tip bends most");
    let table = band_table(caption, &band);
    let model = if result.residual_max_m < 1e-9 {
        Text::new("By the model itself nothing is left (below 10⁻⁶ mm): ")
    } else {
        Text::new("By the model itself ")
            .number(Number::new(result.residual_max_m).of(Quantity::LENGTH.digits(2)))
            .words(" are left at most: ")
    };
    let text = model.words(format!(
        "what the real arm leaves is the uncertainty of the deflection, most of it from {}, and whatever the model \
         leaves out.",
        dominant(band.size_m)
    ));
    let blocks = vec![Block::Text(text), Block::Table(table)];
    Some(Section::new("how-sure", "What is left, and how sure that is", blocks))
}

fn stiffness_section(result: &Compensation) -> Option<Section> {
    let extremes = result.extremes?;
    let places = extreme_places(&extremes, |at| Some(result.points.get(at)?.point.to_string()));
    let table = Block::Table(principal_table(&places));
    let title = "Which way the tip gives way";
    Some(Section::new("stiffness", title, vec![table]))
}
