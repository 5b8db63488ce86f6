//! The page to print for a day at the robot: each posture with its picture and boxes to tick.

use crate::cell::{Full, cell_drawing};
use crate::figure::svg::{escape, render_drawing};
use std::fmt::Write;
use stiffarm::Result;
use stiffarm::findings::list;
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::ReadingTarget;
use stiffarm::model::posture::Posture;
use stiffarm::model::robot::{Controller, Robot};
use stiffarm::units::{rad_to_deg, with_minus};
use stiffarm_files::table::{Sheet, SheetRow};

/// A4 with a margin; every posture begins a page.
const STYLE: &str = "@page{size:A4;margin:14mm}\
body{font:11pt Helvetica,Arial,'DejaVu Sans',sans-serif;color:#222;max-width:182mm;margin:auto}\
h1{font-size:15pt;margin:0 0 2mm}h2{font-size:13pt;margin:0 0 2mm}\
section{break-after:page}section:last-of-type{break-after:auto}\
table{border-collapse:collapse;margin:3mm 0}th,td{border:0.3mm solid #888;padding:1mm 2.5mm;text-align:left}\
td.n{text-align:right;font-variant-numeric:tabular-nums}td.t{text-align:center;font-size:14pt;line-height:1}\
tr{break-inside:avoid}svg{width:100%;height:auto;max-height:165mm;display:block;margin:2mm auto}";

/// The plan of `sheet` as an HTML page for A4 paper: for each posture the angles to drive to,
/// to 0.01°, a picture of the cell there, and a box for each reading in measuring order.
///
/// # Errors
/// As [`cell_drawing`].
pub fn plan_page(cell: &Cell, sheet: &Sheet) -> Result<String> {
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta \
         charset=\"utf-8\"><title>{0}</title>\n<style>{STYLE}</style></head>\n<body>\n",
        escape(&cell.name)
    );
    let groups: Vec<&[SheetRow]> = sheet.rows.chunk_by(|a, b| a.posture.name == b.posture.name).collect();
    for (number, rows) in (1..).zip(&groups) {
        let posture = &rows[0].posture;
        out += "<section>\n";
        if number == 1 {
            let _ = writeln!(
                out,
                "<h1>{}</h1>\n<p>{}. Date: ____________ Operator: ____________________</p>",
                escape(&cell.name),
                escape(cell.setup.robot.name())
            );
        }
        let _ = writeln!(out, "<h2>Posture {} ({number} of {})</h2>", escape(&posture.name), groups.len());
        if let Some(station) = &rows[0].station {
            let _ = writeln!(out, "<p>Tracker at station {}</p>", escape(station));
        }
        angles(&mut out, &cell.setup.robot, &posture.q);
        let drawing = cell_drawing(cell, std::slice::from_ref(posture), Full::Number(0))?;
        out += &render_drawing(&drawing);
        readings(&mut out, rows);
        hidden(&mut out, cell, posture);
        out += "</section>\n";
    }
    out += "</body>\n</html>\n";
    Ok(out)
}

/// The angles under the names that the pendant has for the axes.
fn angles(out: &mut String, robot: &Robot, q: &[f64]) {
    *out += "<table><tr>";
    // Where a seventh axis stands, and what it is called, differs from arm to arm.
    let pendant = robot.controller().filter(|_| q.len() <= 6);
    let pendant = pendant.filter(|c| *c != Controller::Other);
    for (axis, joint) in robot.joints().iter().enumerate() {
        let name = pendant.map_or_else(|| joint.name.clone(), |pendant| pendant.axis_name(axis));
        let _ = write!(out, "<th>{} [°]</th>", escape(&name));
    }
    *out += "</tr><tr>";
    for angle in q {
        let shown = with_minus(format!("{:.2}", rad_to_deg(*angle)));
        let _ = write!(out, "<td class=\"n\">{shown}</td>");
    }
    *out += "</tr></table>\n";
}

/// The points that have no box, since the tracker does not see them.
fn hidden(out: &mut String, cell: &Cell, posture: &Posture) {
    let points = &cell.setup.tool.measuring_points;
    let hidden = cell.hidden_points(&posture.q).into_iter();
    let names: Vec<&str> = hidden.map(|point| points[point].name.as_str()).collect();
    if !names.is_empty() {
        let _ = writeln!(out, "<p>Hidden from the tracker: point {}.</p>", escape(&list(&names)));
    }
}

/// A line for each state, a box for each point.
fn readings(out: &mut String, rows: &[SheetRow]) {
    let has_loads = rows.iter().any(|row| row.load.is_some());
    let states: Vec<&[SheetRow]> = rows.chunk_by(|a, b| a.state == b.state).collect();
    *out += "<table><tr><th>state</th>";
    if has_loads {
        *out += "<th>load [N]</th>";
    }
    for row in states.first().copied().unwrap_or_default() {
        let word = if ReadingTarget::is_base_name(&row.point) { "" } else { "point " };
        let _ = write!(out, "<th>{word}{}</th>", escape(&row.point));
    }
    *out += "</tr>\n";
    for state in states {
        let _ = write!(out, "<tr><td>{}</td>", escape(&state[0].state));
        if has_loads {
            let load = state[0].load.map_or_else(String::new, |load| load.to_string());
            let _ = write!(out, "<td class=\"n\">{load}</td>");
        }
        *out += &"<td class=\"t\">☐</td>".repeat(state.len());
        *out += "</tr>\n";
    }
    *out += "</table>\n";
}
