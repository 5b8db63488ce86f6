//! The tables of a study: for CSV files and for the page.

use super::figures::illustration;
use super::published::published_for;
use super::table::{Cell, Table};
use stiffarm::estimate::simulate::{ElasticGroup, ElasticSimulation};
use stiffarm::plan::index::Index;
use stiffarm::plan::select::Selection;
use stiffarm::study::Study;
use stiffarm::units::rad_to_shortest_deg;

/// All tables of a study.
pub fn tables(study: &Study) -> Vec<Table> {
    let mut out = vec![indices(study), expected(study)];
    out.extend(study.groups.iter().map(|g| {
        let mut table = Table::new(
            &format!("postures-{}", super::figures::slug(&g.name)),
            format!("Postures of {}, controller angles.", g.name),
            std::iter::once("posture".to_string())
                .chain((1..=study.joints.len()).map(|j| format!("q{j}_deg")))
                .collect(),
        );
        for (p, q) in g.postures.iter().enumerate() {
            let angles = q.iter().map(|a| Cell::from(rad_to_shortest_deg(*a)));
            table.rows.push(row((p + 1).to_string(), angles));
        }
        table
    }));
    out.extend([illustration_case(study), simulation(study), starts(study), stiffness(study)]);
    out.extend(validation(study));
    out.extend(study.elastic.as_ref().map(elastic));
    out
}

/// Groups on arms that give way beyond their joint axes.
fn elastic(simulation: &ElasticSimulation) -> Table {
    let headings = [
        "group",
        "axes [mm]",
        "mixed [mm]",
        "expected [mm]",
        "bands hold, axes [%]",
        "bands hold, mixed [%]",
        "k holds, axes [%]",
        "k holds, mixed [%]",
    ];
    let mut table = Table::new(
        "elastic",
        format!(
            "RMS error of a predicted deflection {} with the joint axes alone and with the mixed model, {} runs of \
             each group with springs beyond the axes drawn anew; expected: the index prediction, which knows their \
             sizes. Share of the components of deflections inside their bands, and of intervals of k that hold the \
             true one.",
            if simulation.predicted_tasks {
                "at the tasks of the cell"
            } else {
                "at random postures inside the cell's limits"
            },
            simulation.runs
        ),
        headings.into_iter().map(String::from).collect(),
    );
    let levels = |group: &ElasticGroup| group.levels.first().cloned();
    for (group, level) in simulation.groups.iter().filter_map(|g| Some((g, levels(g)?))) {
        let mm = |value: Option<f64>| Cell::from(value.map(|v| 1e3 * v));
        let (axes, mixed) = (&level.axes, level.mixed.as_ref());
        let cells = vec![
            mm(Some(axes.prediction_rms_m)),
            mm(mixed.map(|m| m.prediction_rms_m)),
            mm(level.expected_prediction_m),
            Cell::percent(axes.band_share),
            Cell::percent(mixed.and_then(|m| m.band_share)),
            Cell::percent(axes.mean_interval_share()),
            Cell::percent(mixed.and_then(|m| m.mean_interval_share())),
        ];
        table.rows.push(row(group.name.as_str(), cells));
    }
    table
}

/// A row from its name and its cells.
fn row(name: impl Into<Cell>, cells: impl IntoIterator<Item = Cell>) -> Vec<Cell> {
    std::iter::once(name.into()).chain(cells).collect()
}

fn with_groups(first: &str, study: &Study) -> Vec<String> {
    std::iter::once(first.to_string()).chain(study.groups.iter().map(|g| g.name.clone())).collect()
}

fn indices(study: &Study) -> Table {
    let mut table = Table::new("indices", "Every index of each group.", with_groups("index", study));
    for index in Index::ALL {
        let (unit, factor) = index.shown_in();
        let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
        let name = format!("{}{unit}", index.as_str());
        let values = study.groups.iter().map(|g| g.evaluation.indices.get(index).map(|value| factor * value).into());
        table.rows.push(row(name, values));
    }
    let mut add = |name: &str, cell: &dyn Fn(&Selection) -> Cell| {
        let cells = study.groups.iter().map(|g| g.selection.as_ref().map_or("–".into(), cell));
        table.rows.push(row(name, cells));
    };
    add("search ended", &|s| s.termination.describe().into());
    add("iterations", &|s| s.iterations.to_string().into());
    add("first-order optimality [1/rad]", &|s| s.stationarity.into());
    add("smallest margin to a limit [mm]", &|s| match s.smallest_margin_m {
        // Below a hundredth of a micrometre is on the limit.
        Some(m) if m.abs() < 1e-8 => "0 (on a limit)".into(),
        other => other.map(|m| 1e3 * m).into(),
    });
    table
}

fn expected(study: &Study) -> Table {
    let mut table = Table::new(
        "expected-deviation",
        "Expected deviation |k̂ − k|/k at variance factor 1, closed form, in %.",
        with_groups("joint", study),
    );
    for (j, joint) in study.joints.iter().enumerate() {
        let cells = study.groups.iter().map(|g| Cell::percent(g.evaluation.expected_deviation[j]));
        table.rows.push(row(joint.as_str(), cells));
    }
    let means = study.groups.iter().map(|g| Cell::percent(g.evaluation.mean_expected_deviation()));
    table.rows.push(row("mean", means));
    table
}

fn illustration_case(study: &Study) -> Table {
    // The paper's rows are those of all six joints.
    let published = published_for(&study.robot).filter(|_| study.joints.len() == 6);
    let cases = illustration(study);
    let mut headings = vec!["joint".to_string()];
    headings.extend(cases.iter().map(|(name, _)| (*name).to_string()));
    if published.is_some() {
        headings.extend((1..=3).map(|g| format!("paper, Group {g}")));
    }
    let mut table =
        Table::new("illustration-case", "Deviation rates of one run at variance factor 1, in % (Table 4).", headings);
    for (j, joint) in study.joints.iter().enumerate() {
        let ours = cases.iter().map(|(_, level)| Cell::percent(Some(level.first_run_deviation[j])));
        let theirs = published.iter().flat_map(|p| p.deviation_percent[j]).map(Cell::from);
        table.rows.push(row(joint.as_str(), ours.chain(theirs)));
    }
    table
}

fn simulation(study: &Study) -> Table {
    let headings = [
        "group",
        "variance_factor",
        "joint",
        "mean_deviation_percent",
        "standard_error_percent",
        "median_deviation_percent",
        "expected_deviation_percent",
        "beyond_first_order",
    ];
    let mut table = Table::new(
        "simulation",
        format!("Deviation |k̂ − k|/k over {} runs (Fig. 8).", study.simulation.runs),
        headings.map(String::from).to_vec(),
    );
    for group in &study.simulation.groups {
        for level in &group.levels {
            for (j, joint) in study.joints.iter().enumerate() {
                let percent = |v: &[f64]| Cell::percent(Some(v[j]));
                table.rows.push(vec![
                    group.name.as_str().into(),
                    level.variance_factor.into(),
                    joint.as_str().into(),
                    percent(&level.mean_deviation),
                    percent(&level.standard_error),
                    percent(&level.median_deviation),
                    percent(&level.expected_deviation),
                    level.beyond_first_order[j].to_string().into(),
                ]);
            }
        }
    }
    table
}

/// Name of a row of the other initial groups.
pub(crate) fn index_name(index: Option<Index>) -> String {
    index.map_or("(start)".into(), Index::in_words)
}

/// Every initial group with what each index makes of it.
fn starts(study: &Study) -> Table {
    let headings = ["initial groups", "number", "index", "mean expected deviation [%]"];
    let mut table = Table::new(
        "other-starts",
        "Mean expected deviation after selection from each other initial group.",
        headings.map(String::from).to_vec(),
    );
    for kind in &study.starts.kinds {
        for start in &kind.rows {
            for (number, value) in start.mean_expected_deviation.iter().enumerate() {
                table.rows.push(vec![
                    kind.kind.as_str().into(),
                    (number + 1).to_string().into(),
                    index_name(start.index).into(),
                    Cell::percent(*value),
                ]);
            }
        }
    }
    table
}

/// Identified stiffness, one row per group and joint.
fn stiffness(study: &Study) -> Table {
    let headings = ["group", "joint", "truth [N·m/rad]", "k [N·m/rad]", "low [N·m/rad]", "high [N·m/rad]"];
    let mut table = Table::new(
        "stiffness",
        "Joint stiffness identified from one simulated measurement, with the 95 % interval by the scatter of the \
         readings.",
        headings.map(String::from).to_vec(),
    );
    for group in &study.groups {
        for (j, joint) in study.joints.iter().enumerate() {
            let estimate = group.identification.as_ref().map(|i| &i.estimates.joints[j]);
            let [low, high] = estimate.map_or([None, None], |e| e.interval);
            table.rows.push(vec![
                group.name.as_str().into(),
                joint.as_str().into(),
                study.stiffness[j].into(),
                estimate.and_then(|e| e.stiffness).into(),
                low.into(),
                high.into(),
            ]);
        }
    }
    table
}

fn validation(study: &Study) -> Option<Table> {
    let first = study.groups.iter().find_map(|g| g.validation.as_ref())?;
    let published = published_for(&study.robot).filter(|p| p.deflection_mm.len() == first.points.len());
    let mut headings = with_groups("measuring point", study);
    if published.is_some() {
        headings.extend((1..=3).map(|g| format!("paper, Group {g}")));
    }
    let mut table =
        Table::new("validation", "Relative translational deflection δb of Eq. (22), mm (Table 7).", headings);
    for (i, point) in first.points.iter().enumerate() {
        let ours =
            study.groups.iter().map(|g| Cell::Number(g.validation.as_ref().map(|v| 1e3 * v.points[i].deviation_m)));
        let theirs = published.iter().flat_map(|p| p.deflection_mm[i]).map(Cell::from);
        table.rows.push(row(point.label.as_str(), ours.chain(theirs)));
    }
    Some(table)
}
