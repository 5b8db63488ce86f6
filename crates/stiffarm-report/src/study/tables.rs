//! The tables of a study: for CSV files and for the page.

use super::figures::illustration;
use super::published::published_for;
use stiffarm::index::Index;
use stiffarm::study::Study;

/// A table: file name stem, caption, headings, rows of text.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Stem of the CSV file.
    pub id: String,
    /// What it shows.
    pub caption: String,
    /// Headings, units included.
    pub headings: Vec<String>,
    /// Rows; every row has one cell per heading.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    fn new(id: &str, caption: impl Into<String>, headings: Vec<String>) -> Self {
        Table {
            id: id.into(),
            caption: caption.into(),
            headings,
            rows: Vec::new(),
        }
    }

    /// The table as CSV, LF line ends, cells quoted where needed.
    pub fn csv(&self) -> String {
        let line = |cells: &[String]| {
            let quoted: Vec<String> = cells
                .iter()
                .map(|c| match c.contains([',', '"', '\n']) {
                    true => format!("\"{}\"", c.replace('"', "\"\"")),
                    false => c.clone(),
                })
                .collect();
            quoted.join(",") + "\n"
        };
        let mut out = line(&self.headings);
        for row in &self.rows {
            out.push_str(&line(row));
        }
        out
    }

    /// The table as Markdown.
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | ").replace('\n', " "));
        let mut out = line(&self.headings);
        out.push('|');
        for (i, _) in self.headings.iter().enumerate() {
            out.push_str(if i == 0 { ":--|" } else { "--:|" });
        }
        out.push('\n');
        for row in &self.rows {
            out.push_str(&line(row));
        }
        out
    }
}

/// Number with four significant digits, `–` where there is none.
pub(super) fn significant(value: Option<f64>) -> String {
    let Some(v) = value.filter(|v| v.is_finite()) else {
        return "–".into();
    };
    if v == 0.0 {
        return "0".into();
    }
    let magnitude = v.abs().log10().floor() as i32;
    match magnitude {
        -4..4 => format!("{v:.decimals$}", decimals = (3 - magnitude) as usize),
        4..9 => {
            let unit = 10f64.powi(magnitude - 3);
            format!("{:.0}", (v / unit).round() * unit)
        }
        _ => format!("{v:.3e}"),
    }
}

pub(super) fn percent(value: Option<f64>) -> String {
    significant(value.map(|v| 100.0 * v))
}

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
        for (p, q) in g.postures_deg.iter().enumerate() {
            let cells = q.iter().map(|a| a.to_string());
            table
                .rows
                .push(std::iter::once((p + 1).to_string()).chain(cells).collect());
        }
        table
    }));
    out.extend([
        illustration_case(study),
        simulation(study),
        starts(study),
        stiffness(study),
    ]);
    out.extend(validation(study));
    out
}

/// A table of the study by its identifier.
pub(super) fn find<'a>(tables: &'a [Table], id: &str) -> Option<&'a Table> {
    tables.iter().find(|t| t.id == id)
}

fn with_groups(first: &str, study: &Study) -> Vec<String> {
    std::iter::once(first.to_string())
        .chain(study.groups.iter().map(|g| g.name.clone()))
        .collect()
}

fn indices(study: &Study) -> Table {
    let mut table = Table::new(
        "indices",
        "Every index of each group; expected_error, worst_joint, drop_one and d in %.",
        with_groups("index", study),
    );
    for index in Index::ALL {
        let fraction = matches!(
            index,
            Index::ExpectedError | Index::WorstJoint | Index::DropOne | Index::D
        );
        let mut row = vec![format!(
            "{}{}",
            index.as_str(),
            if fraction { " [%]" } else { "" }
        )];
        for group in &study.groups {
            let value = group.evaluation.indices.get(index);
            row.push(if fraction {
                percent(value)
            } else {
                significant(value)
            });
        }
        table.rows.push(row);
    }
    let selection = |f: &dyn Fn(&stiffarm::select::Selection) -> String| -> Vec<String> {
        study
            .groups
            .iter()
            .map(|g| g.selection.as_ref().map_or("–".into(), f))
            .collect()
    };
    let mut add = |name: &str, cells: Vec<String>| {
        table
            .rows
            .push(std::iter::once(name.to_string()).chain(cells).collect());
    };
    add(
        "search ended",
        selection(&|s| s.termination.describe().to_string()),
    );
    add("iterations", selection(&|s| s.iterations.to_string()));
    add(
        "first-order optimality [1/rad]",
        selection(&|s| significant(s.stationarity)),
    );
    add(
        "smallest margin to a limit [mm]",
        selection(&|s| match s.smallest_margin_m {
            // Below a nanometre is on the limit.
            Some(m) if m.abs() < 1e-8 => "0 (on a limit)".into(),
            other => significant(other.map(|m| 1e3 * m)),
        }),
    );
    table
}

fn expected(study: &Study) -> Table {
    let mut table = Table::new(
        "expected-deviation",
        "Expected deviation |k̂ − k|/k at variance factor 1, closed form, in %.",
        with_groups("joint", study),
    );
    for (j, joint) in study.joints.iter().enumerate() {
        let cells = study
            .groups
            .iter()
            .map(|g| percent(g.evaluation.expected_deviation[j]));
        table
            .rows
            .push(std::iter::once(joint.clone()).chain(cells).collect());
    }
    let mean = study
        .groups
        .iter()
        .map(|g| percent(g.evaluation.mean_expected_deviation()));
    table
        .rows
        .push(std::iter::once("mean".to_string()).chain(mean).collect());
    table
}

fn illustration_case(study: &Study) -> Table {
    let published = published_for(&study.robot);
    let cases = illustration(study);
    let mut headings = vec!["joint".to_string()];
    headings.extend(cases.iter().map(|(name, _)| (*name).to_string()));
    if published.is_some() {
        headings.extend((1..=3).map(|g| format!("paper, Group {g}")));
    }
    let mut table = Table::new(
        "illustration-case",
        "Deviation rates of one run at variance factor 1, in % (Table 4).",
        headings,
    );
    for (j, joint) in study.joints.iter().enumerate() {
        let mut row = vec![joint.clone()];
        row.extend(
            cases
                .iter()
                .map(|(_, level)| percent(Some(level.first_run_deviation[j]))),
        );
        if let Some(published) = published {
            row.extend(
                published.deviation_percent[j]
                    .iter()
                    .map(|v| significant(Some(*v))),
            );
        }
        table.rows.push(row);
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
        format!(
            "Deviation |k̂ − k|/k over {} runs (Fig. 8).",
            study.simulation.runs
        ),
        headings.map(String::from).to_vec(),
    );
    for group in &study.simulation.groups {
        for level in &group.levels {
            for (j, joint) in study.joints.iter().enumerate() {
                let number = |v: &[f64]| format!("{}", 100.0 * v[j]);
                table.rows.push(vec![
                    group.name.clone(),
                    format!("{}", level.variance_factor),
                    joint.clone(),
                    number(&level.mean_deviation),
                    number(&level.standard_error),
                    number(&level.median_deviation),
                    number(&level.expected_deviation),
                    level.beyond_first_order[j].to_string(),
                ]);
            }
        }
    }
    table
}

fn starts(study: &Study) -> Table {
    let headings = [
        "initial groups",
        "index",
        "improved on the start",
        "median mean expected deviation [%]",
    ];
    let mut table = Table::new(
        "other-starts",
        "How often each index improves on its start, and the median outcome.",
        headings.map(String::from).to_vec(),
    );
    for kind in &study.starts.kinds {
        for row in &kind.rows {
            table.rows.push(vec![
                kind.kind.clone(),
                row.index
                    .map_or("(start)".into(), |i| i.as_str().replace('_', " ")),
                row.index.map_or("–".into(), |_| {
                    format!("{} of {}", row.improved, kind.count)
                }),
                percent(row.median),
            ]);
        }
    }
    table
}

fn stiffness(study: &Study) -> Table {
    let published = published_for(&study.robot);
    let mut headings = vec!["joint".to_string(), "truth".to_string()];
    headings.extend(study.groups.iter().map(|g| g.name.clone()));
    if published.is_some() {
        headings.extend((1..=3).map(|g| format!("paper, Group {g}")));
    }
    let mut table = Table::new(
        "stiffness",
        "Joint stiffness identified from one simulated measurement, N·m/rad (Table 6), with the 95 % interval.",
        headings,
    );
    for (j, joint) in study.joints.iter().enumerate() {
        let mut row = vec![joint.clone(), significant(Some(study.stiffness[j]))];
        for group in &study.groups {
            let estimate = group.identification.as_ref().map(|i| &i.joints[j]);
            row.push(
                match estimate.and_then(|e| Some((e.stiffness?, e.interval))) {
                    Some((k, [Some(low), Some(high)])) => {
                        format!(
                            "{} ({}–{})",
                            significant(Some(k)),
                            significant(Some(low)),
                            significant(Some(high))
                        )
                    }
                    Some((k, _)) => significant(Some(k)),
                    None => "–".into(),
                },
            );
        }
        if let Some(published) = published {
            row.extend(published.stiffness[j].iter().map(|v| significant(Some(*v))));
        }
        table.rows.push(row);
    }
    table
}

fn validation(study: &Study) -> Option<Table> {
    let first = study.groups.iter().find_map(|g| g.validation.as_ref())?;
    let published =
        published_for(&study.robot).filter(|p| p.deflection_mm.len() == first.points.len());
    let mut headings = with_groups("measuring point", study);
    if published.is_some() {
        headings.extend((1..=3).map(|g| format!("paper, Group {g}")));
    }
    let mut table = Table::new(
        "validation",
        "Relative translational deflection δb of Eq. (22), mm (Table 7).",
        headings,
    );
    for (i, point) in first.points.iter().enumerate() {
        let mut row = vec![point.label.clone()];
        row.extend(
            study
                .groups
                .iter()
                .map(|g| significant(g.validation.as_ref().map(|v| 1e3 * v.points[i].deviation_m))),
        );
        if let Some(published) = published {
            row.extend(
                published.deflection_mm[i]
                    .iter()
                    .map(|v| significant(Some(*v))),
            );
        }
        table.rows.push(row);
    }
    Some(table)
}
