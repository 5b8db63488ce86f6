//! The page of a study, in Markdown, built like the paper's Section IV.

use super::figures::{figures, slug};
use super::markdown::{cell, fenced, text};
use super::published::{PAPER, published_for};
use super::table::{Table, percent, significant};
use super::tables::{find, starts_summary, stiffness_side_by_side, tables};
use crate::figure::Figure;
use crate::figure::drawing::Drawing;
use std::fmt::Write;
use stiffarm::study::{Study, StudyGroup};
use stiffarm::units::rad_to_shortest_deg;

/// The postures of a group to a thousandth of a degree; the CSV file beside
/// the page has every digit.
fn rounded_postures(group: &StudyGroup, joints: &[String]) -> String {
    let mut out = String::from("\n| posture |");
    for j in 1..=joints.len() {
        let _ = write!(out, " q{j} [°] |");
    }
    let _ = write!(out, "\n|:--|{}\n", "--:|".repeat(joints.len()));
    for (p, q) in group.postures.iter().enumerate() {
        let _ = write!(out, "| {} |", p + 1);
        for angle in q {
            let _ = write!(out, " {:.3} |", rad_to_shortest_deg(*angle));
        }
        out.push('\n');
    }
    out
}

/// Runs of each level: those asked for, or the fewest that were made.
fn runs_made(study: &Study) -> usize {
    let levels = study.simulation.groups.iter().flat_map(|g| &g.levels);
    let fewest = levels.map(|level| level.runs).min();
    fewest.unwrap_or(study.simulation.runs)
}

pub(super) fn write_table(out: &mut String, table: &Table) {
    let _ = write!(
        out,
        "\n{}\n\n*{}*\n",
        table.markdown(),
        text(&table.caption)
    );
}

/// A figure that stands beside the page, with its caption.
pub(super) fn write_picture(out: &mut String, figure: &Figure) {
    write_image(out, &figure.id, &figure.title, &figure.caption);
}

fn write_image(out: &mut String, id: &str, title: &str, caption: &str) {
    let _ = write!(
        out,
        "\n![{}]({id}.svg)\n\n*{}*\n",
        text(title),
        text(caption)
    );
}

/// The page. `cell_picture` is that of [`cell_picture`](super::cell_picture), `command` the command
/// line that repeats the study; figures are referred to as `<id>.svg` beside the page.
pub fn page(study: &Study, cell_picture: Option<&Drawing>, version: &str, command: &str) -> String {
    let tables = tables(study);
    let pictures = figures(study);
    let mut out = String::new();
    let table = |out: &mut String, id: &str| {
        if let Some(t) = find(&tables, id) {
            write_table(out, t);
        }
    };
    let picture = |out: &mut String, id: &str| {
        if let Some(f) = pictures.iter().find(|f| f.id == id) {
            write_picture(out, f);
        }
    };
    let finding = |out: &mut String, code: &str| {
        for f in study.findings.iter().filter(|f| f.code == code) {
            let _ = write!(out, "\n{}\n", text(&f.sentence));
        }
    };

    let _ = write!(
        out,
        "# Posture selection study: {}\n\nThe study of Section IV of the paper [1] on this cell, computed by stiffarm \
         {version}. Every number here is simulated unless it is marked as the paper's.\n",
        text(&study.cell)
    );
    // Before any number: what follows is not the whole study.
    for f in study.findings.iter().filter(|f| f.code == "interrupted") {
        let _ = write!(
            out,
            "\n> **Stopped.** {} The command under \"How this was made\" makes the whole study.\n",
            text(&f.sentence)
        );
    }
    out.push_str("\n## In short\n");
    for code in [
        "undetermined-joints",
        "no-selection",
        "no-noise",
        "unknown-limits",
        "recommended-index",
        "paper-order",
        "first-order-means",
        "other-starts",
    ] {
        for f in study.findings.iter().filter(|f| f.code == code) {
            let _ = write!(out, "\n- {}", text(&f.sentence));
        }
    }
    out.push('\n');
    picture(&mut out, "expected-deviation");
    table(&mut out, "expected-deviation");

    let _ = write!(
        out,
        "\n## A. Numerical simulations\n\n### Set-up\n\nRobot: {}. True joint stiffness{}: {} N·m/rad. \
         Displacement noise at variance factor 1: {} µm per axis. Characteristic length of Eq. (20): {}.\n",
        text(&study.robot),
        if published_for(&study.robot).is_some() {
            " (Table 2)"
        } else {
            ""
        },
        study
            .stiffness
            .iter()
            .map(|k| significant(Some(*k)))
            .collect::<Vec<_>>()
            .join(", "),
        significant(Some(1e6 * study.noise_std_m)),
        study
            .characteristic_length_m
            .map_or("none".into(), |l| format!(
                "{} mm",
                significant(Some(1e3 * l))
            )),
    );
    out.push_str(
        "\n### Groups of postures\n\nGroup 1 is the initial group. Each other group is selected from it under one \
         index (Section III.B), within the bounds of the joints and the limits of the cell. `classical` is max k(J_N), \
         `condition` is cond(Ψ), `novel` is their product; `scaled` is max k(J_N) × cond(Ψ·diag(1/k)); \
         `expected_error` is the RMS relative standard error of the joint stiffness. O1 to O5 are larger-is-better.\n",
    );
    table(&mut out, "indices");
    for group in &study.groups {
        picture(&mut out, &format!("postures-{}", slug(&group.name)));
        out.push_str(&rounded_postures(group, &study.joints));
    }
    if let Some(drawing) = cell_picture {
        out.push_str("\n### In the cell\n");
        write_image(&mut out, &drawing.id, &drawing.title, &drawing.caption);
    }
    out.push_str("\n### An illustration case\n\nOne run of the simulation at variance factor 1; a single run is luck, the averages below are not.\n");
    table(&mut out, "illustration-case");
    if published_for(&study.robot).is_some() {
        out.push_str(
            "\nThe paper's columns are its own groups, which it shows only as pictures; ours start from another Group 1, \
             so the columns are beside each other for scale, not for equality.\n",
        );
    }
    let _ = write!(
        out,
        "\n### Averages over {} runs at {} noise levels\n",
        runs_made(study),
        study.options.simulation.variance_factors.len()
    );
    picture(&mut out, "deviation-by-noise");
    finding(&mut out, "beyond-first-order");
    out.push_str("\n### The bound of Eq. (19)\n");
    finding(&mut out, "error-bound");
    out.push_str("\n| group | cond(Ψ) | bound of Eq. (19) on the relative error of H [%] | expected relative error of H [%] |\n|:--|--:|--:|--:|\n");
    for g in &study.groups {
        let _ = writeln!(
            out,
            "| {} | {} | {} | {} |",
            cell(&g.name),
            significant(g.evaluation.indices.condition),
            percent(g.error_bound.and_then(|b| b.bound)),
            percent(g.expected_relative_norm)
        );
    }
    if !study.starts.kinds.is_empty() {
        out.push_str("\n### Other initial groups\n");
        finding(&mut out, "other-starts");
        picture(&mut out, "other-starts");
        write_table(&mut out, &starts_summary(study));
    }
    if study
        .classical_q1
        .as_ref()
        .is_some_and(|range| range.matters())
    {
        out.push_str("\n### The classical group is a range over q1\n");
        finding(&mut out, "classical-q1");
        picture(&mut out, "classical-q1");
    }
    if study.elastic.is_some() {
        out.push_str("\n### An arm that gives way beyond its joint axes\n");
        finding(&mut out, "beyond-axes");
        table(&mut out, "elastic");
    }
    out.push_str("\n### The model\n");
    finding(&mut out, "model-order");

    out.push_str(
        "\n## B. Identification and validation, simulated\n\nEach group is measured once with tracker noise and \
         identified. The noise is the only error here, so this shows what the tracker allows, not what an experiment \
         reaches, and each column is one draw: differences of the size of the intervals are luck.\n",
    );
    write_table(&mut out, &stiffness_side_by_side(study));
    if published_for(&study.robot).is_some() {
        out.push_str(
            "\nThe paper's columns are its experiment (Table 6): there the true stiffness is unknown, and its three \
             groups differ up to fourfold. Its raw readings are not published, so they cannot be recomputed.\n",
        );
    }
    let validated = study.groups.iter().any(|g| g.validation.is_some());
    if validated {
        out.push_str("\nThe validation postures took no part in the identification.\n");
    }
    picture(&mut out, "validation");
    table(&mut out, "validation");
    finding(&mut out, "validation-limit");
    if validated && published_for(&study.robot).is_some() {
        out.push_str(
            "\nThe paper measured 0.17 to 0.87 mm: model error, not tracker noise, dominated that experiment.\n",
        );
    }

    let _ = write!(
        out,
        "\n## How this was made\n\nstiffarm {version}, seed {}, {} runs per level, {} other initial groups, {} draws of \
         q1, at most {} iterations per selection. Repeat it with\n\n{}\n\nAll numbers are in \
         `study.json` and, table by table, in the CSV files beside this page.\n\n[1] {PAPER}.\n",
        study.options.simulation.seed,
        runs_made(study),
        study.starts.kinds.iter().map(|k| k.count).sum::<usize>(),
        study.classical_q1.as_ref().map_or(0, |r| r.draws),
        study.options.max_iterations,
        fenced(command),
    );
    out
}
