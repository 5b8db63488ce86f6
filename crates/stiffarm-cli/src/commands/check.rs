//! `stiffarm check`: what to know about a cell before anybody measures.

use super::finding_line;
use crate::args::CheckArgs;
use crate::files::picture::check_picture_name;
use crate::files::{only_target, write_all};
use crate::input::Line;
use crate::numbers::{NONE, coarse_mm, mm, optional, significant, stiffness};
use crate::output::Exit;
use crate::session::Session;
use crate::table::{Table, green, title};
use std::fmt::Write;
use stiffarm::files::source::{NamedCell, Source};
use stiffarm::findings::Finding;
use stiffarm::model::cell::{Cell, Noise};
use stiffarm::model::load::{Axes, Load, Wrench};
use stiffarm::model::posture::Posture;
use stiffarm::plan::check::{CellCheck, check};
use stiffarm::units::{m_to_mm, rad_to_shortest_deg};
use stiffarm::{Code, Error, Result};
use stiffarm_report::{Full, cell_drawing, render_drawing, usual_posture};

/// Value of `--posture` that draws none in full.
const ALL: &str = "all";

/// A check has no options.
#[derive(serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {}

/// Checks the cell, and draws it where that is asked for.
pub fn run(session: &Session, args: &CheckArgs) -> Result<Exit> {
    args.figure.as_deref().map(check_picture_name).transpose()?;
    let target = only_target(session, args.figure.as_deref(), args.force)?;
    let named = session.read_cell(&args.cell)?;
    let (postures, full) = match &target {
        Some(_) => pictured(session, args, &named.cell)?,
        None => (Vec::new(), Full::None),
    };
    let result = check(&named.cell)?;
    let exit = Exit::finding(result.is_serious());
    let on_stdout = target.as_ref().is_some_and(|target| target.is_stdout());
    let mut written = String::new();
    if let Some(target) = target {
        let drawing = cell_drawing(&named.cell, &postures, full)?;
        write_all(session, &[(target, render_drawing(&drawing))])?;
        if !session.has_failed() && !on_stdout && !drawing.notes.is_empty() {
            let notes = drawing.notes.iter().map(|note| format!("{}\n", note.text));
            written = title("Picture") + &notes.collect::<String>();
        }
    }
    let text = || table(&named, &result) + &written;
    match on_stdout {
        true => session.remark(&text()),
        false => session.show(&session.envelope("check", None, Options {}, &result), text)?,
    }
    Ok(exit)
}

/// The postures of the picture, and which of them is drawn in full.
fn pictured(session: &Session, args: &CheckArgs, cell: &Cell) -> Result<(Vec<Posture>, Full)> {
    let given = match &args.postures {
        Some(from) => session.read_postures("postures", from, &cell.setup.robot)?,
        None if args.posture.is_none() => return Ok((vec![usual_posture(cell)?], Full::Number(0))),
        None => cell.validation.clone(),
    };
    let Some(wanted) = args.posture.as_deref() else {
        return Ok((given, Full::Tightest));
    };
    if given.is_empty() {
        let message = "The cell has no validation postures to draw.";
        let error = Error::new(Code::MissingKey, message).key("--posture");
        return Err(error.hint("name a file of postures with --postures"));
    }
    if wanted == ALL {
        return Ok((given, Full::None));
    }
    let number = given.iter().position(|posture| posture.name == wanted);
    match number {
        Some(number) => Ok((given, Full::Number(number))),
        None => {
            let names: Vec<&str> = given.iter().map(|p| p.name.as_str()).collect();
            let message = format!("There is no posture {wanted}.");
            let error = Error::new(Code::UnknownName, message).key("--posture");
            Err(error.hint(format!("the postures are {}, or all", names.join(", "))))
        }
    }
}

fn table(named: &NamedCell, check: &CellCheck) -> String {
    let mut out = named.line();
    out += &findings(check);
    out += &title("Set-up");
    out += &setup(&named.cell);
    out += &title("Joints");
    out += &joints(&named.cell, check);
    if !named.cell.is_unlimited() {
        let (within, of) = (check.postures_within_limits, check.postures_sampled);
        let _ = writeln!(
            out,
            "\n{within} of {of} postures spread over the bounds meet the limits."
        );
    }
    out
}

fn findings(check: &CellCheck) -> String {
    if check.findings.is_empty() {
        return format!("{}\n", green("nothing to complain about"));
    }
    // The serious ones first, else in the order of the checks.
    let mut all: Vec<&Finding> = check.findings.iter().collect();
    all.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    all.into_iter().map(finding_line).collect()
}

/// `x, y, z` in millimetres.
fn point<'a>(position: impl IntoIterator<Item = &'a f64>) -> String {
    let mm: Vec<String> = position.into_iter().map(|m| coarse_mm(*m)).collect();
    mm.join(", ")
}

fn setup(cell: &Cell) -> String {
    let tool = &cell.setup.tool;
    let mut lines = vec![
        ("robot", cell.setup.robot.name().to_string()),
        (
            "loading point",
            format!("({}) mm, flange axes", point(&tool.loading_point)),
        ),
    ];
    for measuring in &tool.measuring_points {
        let what = format!(
            "{}: ({}) mm, flange axes",
            measuring.name,
            point(&measuring.position)
        );
        lines.push(("measuring point", what));
    }
    let sensor = match (tool.has_sensor, tool.series_compliance.is_some()) {
        (true, true) => Some("between flange and reflectors, compliance known"),
        (true, false) => Some("between flange and reflectors, compliance unknown"),
        (false, true) => Some("none, but a known compliance between flange and reflectors"),
        (false, false) => None,
    };
    lines.extend(sensor.map(|sensor| ("force sensor", sensor.to_string())));
    for case in cell.setup.load.cases() {
        let at = case.loading_point.as_ref();
        let at = at.map_or(String::new(), |at| {
            format!(", at ({}) mm, flange axes", point(at))
        });
        lines.push((
            "load case",
            format!("{}: {}{at}", case.name, load(&case.load)),
        ));
    }
    if !cell.setup.load.has_cases() {
        lines.push(("load", load(&cell.setup.load)));
    }
    lines.push(("limits", limits(cell)));
    lines.push(("noise", noise(&cell.noise)));
    let length = match cell.characteristic_length {
        Some(length) => format!("{} mm", coarse_mm(length)),
        None => "computed where it is needed".to_string(),
    };
    lines.push(("characteristic length", length));
    if !cell.validation.is_empty() {
        let names: Vec<&str> = cell.validation.iter().map(|p| p.name.as_str()).collect();
        lines.push(("validation postures", names.join(", ")));
    }
    for task in &cell.tasks {
        let what = format!(
            "{}: {}; tip ({}) mm, flange axes",
            task.name,
            wrench(&task.wrench, task.axes),
            point(&task.tip)
        );
        lines.push(("task", what));
    }
    let width = lines.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    lines
        .iter()
        .map(|(name, what)| format!("{name:<width$}  {what}\n"))
        .collect()
}

fn noise(noise: &Noise) -> String {
    let readings = match noise.readings_per_displacement {
        1 => "1 reading".to_string(),
        count => format!("{count} readings"),
    };
    let common = match noise.posture_common_std {
        std if std > 0.0 => format!("; {} mm common to the points of a posture", mm(std)),
        _ => String::new(),
    };
    format!(
        "{} mm per displacement component ({readings} of {} mm){common}",
        mm(noise.displacement_std()),
        mm(noise.reading_variance.sqrt())
    )
}

fn load(load: &Load) -> String {
    match load {
        Load::Rope { anchor, magnitude } => {
            let way = if *magnitude < 0.0 {
                "away from"
            } else {
                "towards"
            };
            format!(
                "{}, {} N {way} the anchor ({}) mm, base axes",
                load.line(),
                magnitude.abs(),
                point(anchor)
            )
        }
        Load::Weight { magnitude, .. } => format!("weight, {magnitude} N along gravity"),
        Load::Constant { wrench: w, axes } => wrench(w, *axes),
        Load::Measured => "measured with each displacement".to_string(),
        Load::Cases(cases) => format!("{} load cases", cases.len()),
    }
}

fn wrench(wrench: &Wrench, axes: Axes) -> String {
    let list = |values: &[f64]| {
        let values: Vec<String> = values.iter().map(|v| significant(*v, 4)).collect();
        values.join(", ")
    };
    let moment = match wrench.moment.norm() > 0.0 {
        true => format!(", moment ({}) N·m", list(wrench.moment.as_slice())),
        false => String::new(),
    };
    let axes = match axes {
        Axes::Base => "base",
        Axes::Tool => "tool",
    };
    format!(
        "force ({}) N{moment}, {axes} axes",
        list(wrench.force.as_slice())
    )
}

fn limits(cell: &Cell) -> String {
    let (limits, line) = (&cell.limits, cell.setup.load.line());
    let mut parts = Vec::new();
    if let Some([low, high]) = &limits.tool_box {
        parts.push(format!("box ({}) to ({}) mm", point(low), point(high)));
    }
    if let Some(floor) = limits.floor {
        parts.push(format!("tool above {} mm", coarse_mm(floor)));
    }
    if let Some(radius) = limits.keep_out_radius {
        parts.push(format!("{} mm clear of axis 1", coarse_mm(radius)));
    }
    if let Some(height) = limits.wrist_height {
        parts.push(format!("wrist above {} mm", coarse_mm(height)));
    }
    if let Some([short, long]) = limits.rope_length {
        parts.push(format!(
            "{line} {} to {} mm",
            coarse_mm(short),
            coarse_mm(long)
        ));
    }
    if let Some(moved) = cell.scene.displacement() {
        let least = moved
            .smallest
            .map(|least| format!("{} to ", significant(m_to_mm(least), 3)));
        parts.push(format!(
            "displacement {}{} mm",
            least.unwrap_or_else(|| "up to ".to_string()),
            moved
                .largest
                .map_or_else(|| "any".to_string(), |most| significant(m_to_mm(most), 3))
        ));
    }
    if parts.is_empty() {
        "none".to_string()
    } else {
        parts.join("; ")
    }
}

fn joints(cell: &Cell, check: &CellCheck) -> String {
    let mut table = Table::new([
        "joint",
        "bounds [deg]",
        "machine limits [deg]",
        "prior k [N·m/rad]",
        "largest torque [N·m]",
        "largest share of a displacement [mm]",
    ]);
    let range = |range: [f64; 2]| {
        let [low, high] = range.map(rad_to_shortest_deg);
        format!("{low} to {high}")
    };
    for (j, (joint, excitation)) in cell
        .setup
        .robot
        .joints()
        .iter()
        .zip(&check.joints)
        .enumerate()
    {
        table.row([
            joint.name.clone(),
            cell.bounds.get(j).map_or_else(String::new, |b| range(*b)),
            range(joint.limits),
            cell.prior
                .as_ref()
                .map_or_else(|| NONE.to_string(), |prior| stiffness(prior[j])),
            optional(excitation.largest_torque_nm, 3),
            optional(excitation.largest_displacement_m.map(m_to_mm), 3),
        ]);
    }
    table.to_string()
}
