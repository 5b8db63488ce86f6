//! What `check` says: what to know about a cell before anybody measures in it.

use super::described::beside_arm;
use super::postures::coarse;
use crate::cell::usual_posture;
use crate::summary::{Block, Context, DataTable, Form, Number, Quantity, Section, Summarise, Summary, Text, counted};
use stiffarm::Result;
use stiffarm::findings::{Finding, Severity, codes, list, minutes, visible};
use stiffarm::model::cell::{Cell, LimitKind, LimitedPoints, Measure, MeasuringTime, Noise, Side};
use stiffarm::model::load::{Axes, Load, Wrench};
use stiffarm::model::posture::PostureGroup;
use stiffarm::plan::check::CellCheck;
use stiffarm::units::{rad_to_shortest_deg, rounded, with_minus};

impl<O> Summarise<O> for CellCheck {
    fn summary(&self, _options: &O, context: &Context<'_>) -> Result<Summary> {
        let check = self;
        let what_was_done = Text::new("The cell was looked at in ")
            .number(Number::count(check.postures_sampled))
            .words(" postures spread over its bounds; ")
            .number(Number::count(check.postures_within_limits))
            .words(" of them meet its limits.");
        let of = |severity: Severity| check.findings.iter().filter(move |f| f.severity == severity);
        let cautions = of(Severity::Caution).count();
        let left_out = check.findings.iter().filter(|f| f.code == codes::JOINT_LEFT_OUT);
        let left_out: Vec<_> = left_out.map(|f| visible(&f.subject)).collect();
        let conclusion = if check.is_serious() {
            Text::default().strong("The cell cannot be used as it is.")
        } else if cautions > 0 {
            let things = counted(cautions, "thing");
            let but = if left_out.is_empty() { String::new() } else { format!(", but not for {}", list(&left_out)) };
            Text::new(format!("The cell can be used{but}; {things} to look at."))
        } else if check.findings.iter().all(|f| f.code == codes::ONE_LOAD) {
            Text::default().strong("Nothing to complain about.")
        } else {
            Text::new("The cell can be used; see the notes.")
        };
        let one_load = check.findings.iter().find(|f| f.code == codes::ONE_LOAD);
        let conclusion = match one_load {
            Some(finding) if !check.is_serious() => conclusion.words(format!(" {}", visible(&finding.sentence))),
            _ => conclusion,
        };
        let next_step = if check.is_serious() {
            Text::new("Correct the cell file, and check it again.")
        } else {
            Text::new("Choose the postures to measure with ").code("stiffarm select").words(".")
        };
        let mut sections = Vec::new();
        if let Some(cell) = context.cell {
            sections.push(Section::new("set-up", "Set-up", vec![Block::Table(setup(cell))]).in_summary());
            if context.pictures {
                let group =
                    if cell.validation.is_empty() { vec![usual_posture(cell)?] } else { cell.validation.clone() };
                let group = PostureGroup { name: "the cell".to_string(), postures: group };
                sections.push(context.cell_section(&[group], "The cell as its file describes it.")?);
            }
        }
        // It stands in the verdict.
        let notes = of(Severity::Note).filter(|f| f.code != codes::ONE_LOAD);
        let notes: Vec<Finding> = notes.cloned().collect();
        if !notes.is_empty() {
            let notes = vec![Block::Findings(notes)];
            sections.push(Section::new("notes", "Notes", notes).in_summary());
        }
        let key = joints(context, check);
        let heading = "The cell before measuring".to_string();
        let mut summary = context.summary(
            check.findings.clone(),
            heading,
            [what_was_done, conclusion, next_step],
            Some(key),
            sections,
        );
        // They stand in a section of their own.
        summary.findings.retain(|finding| finding.severity != Severity::Note);
        Ok(summary)
    }
}

/// The joints with what the load does to them.
fn joints(context: &Context<'_>, check: &CellCheck) -> DataTable {
    let robot = context.cell.map(|cell| cell.setup.robot.joints());
    let range = |range: [f64; 2]| {
        let [low, high] = range.map(|angle| with_minus(rad_to_shortest_deg(angle).to_string()));
        Text::from(format!("{low} to {high}"))
    };
    let names = check.joints.iter();
    let names = names.map(|joint| visible(&joint.name).into_owned());
    DataTable::of("The joints, and the most that the load does to each", "joint", names)
        .words(
            "",
            |j| {
                if check.joints[j].determined { Text::default() } else { Text::default().strong("not determined") }
            },
        )
        .words("bounds [°]", |j| {
            let bounds = context.cell.and_then(|cell| cell.bounds.get(j));
            bounds.map_or_else(Text::default, |bounds| range(*bounds))
        })
        .words("machine limits [°]", |j| {
            let joint = robot.and_then(|joints| joints.get(j));
            joint.map_or_else(Text::default, |joint| range(joint.limits))
        })
        .numbers("prior k", Quantity::STIFFNESS, |j| {
            let prior = context.cell?.prior.as_ref()?;
            Some(Number::computed(*prior.get(j)?))
        })
        .numbers("torque", Quantity::TORQUE, |j| Some(Number::new(check.joints[j].largest_torque_nm)))
        .numbers("share of a displacement", Quantity::new("mm", 1e3, Form::Significant(3)), |j| {
            Some(Number::new(check.joints[j].largest_displacement_m))
        })
}

/// The set-up, a row for each part.
fn setup(cell: &Cell) -> DataTable {
    let tool = &cell.setup.tool;
    let flange = |position: &[f64]| format!("({}) mm, flange axes", point(position));
    let mut rows: Vec<(&str, String)> =
        vec![("robot", cell.setup.robot.name().to_string()), ("loading point", flange(tool.loading_point.as_slice()))];
    rows.extend(tool.measuring_points.iter().map(|measuring| {
        let at = flange(measuring.position.as_slice());
        ("measuring point", format!("{}: {at}", measuring.name))
    }));
    let sensor = match (tool.has_sensor, tool.series_compliance.is_some()) {
        (true, true) => Some("between flange and reflectors, compliance known"),
        (true, false) => Some("between flange and reflectors, compliance unknown"),
        (false, true) => Some("none, but a known compliance between flange and reflectors"),
        (false, false) => None,
    };
    rows.extend(sensor.map(|sensor| ("force sensor", sensor.to_string())));
    for case in cell.setup.load.cases() {
        let at = case.loading_point.as_ref();
        let at = at.map_or(String::new(), |at| format!(", at {}", flange(at.as_slice())));
        rows.push(("load case", format!("{}: {}{at}", case.name, load(&case.load))));
    }
    if !cell.setup.load.has_cases() {
        rows.push(("load", load(&cell.setup.load)));
    }
    rows.extend(beside_arm(cell));
    rows.push(("limits", limits(cell)));
    rows.push(("noise", noise(&cell.noise)));
    let length = match cell.characteristic_length {
        Some(length) => coarse(length).text(),
        None => "computed where it is needed".to_string(),
    };
    rows.push(("characteristic length", length));
    rows.push(("measuring", measuring(cell)));
    if !cell.validation.is_empty() {
        let names: Vec<&str> = cell.validation.iter().map(|p| p.name.as_str()).collect();
        rows.push(("validation postures", names.join(", ")));
    }
    rows.extend(cell.tasks.iter().map(|task| {
        let tip = flange(task.tip.as_slice());
        let wrench = wrench(&task.wrench, task.axes);
        ("task", format!("{}: {wrench}; tip {tip}", task.name))
    }));
    let names = rows.iter().map(|(name, _)| *name);
    DataTable::of("What the cell file describes", "part", names)
        .words("what it is", |row| visible(&rows[row].1).into_owned().into())
}

/// `x, y, z` in millimetres.
fn point(position: &[f64]) -> String {
    let digits: Vec<String> = position.iter().map(|m| coarse(*m).digits()).collect();
    digits.join(", ")
}

/// What a posture takes, and what was set up before it.
fn measuring(cell: &Cell) -> String {
    let (time, load) = (&cell.time, &cell.setup.load);
    let anchors = match time.of(0, load) {
        none if none <= 0.0 => String::new(),
        some => format!(", and {} for further anchors", minutes(some)),
    };
    let assumed = match *time == MeasuringTime::default() {
        true => " (assumed: [time])",
        false => "",
    };
    format!("{} a posture{anchors}{assumed}", minutes(time.of_posture(load)))
}

fn noise(noise: &Noise) -> String {
    let length = |m: f64| Number::computed(m).of(Quantity::LENGTH).text();
    let common = match noise.posture_common_std {
        std if std > 0.0 => format!("; {} common to the points of a posture", length(std)),
        _ => String::new(),
    };
    format!(
        "{} per displacement component ({} of {}){common}",
        length(noise.displacement_std()),
        counted(noise.readings_per_displacement as usize, "reading"),
        length(noise.reading_variance.sqrt())
    )
}

fn load(load: &Load) -> String {
    match load {
        Load::Rope { anchor, magnitude } => {
            let way = if *magnitude < 0.0 { "away from" } else { "towards" };
            format!(
                "{}, {} N {way} the anchor ({}) mm, base axes",
                load.line(),
                force(magnitude.abs()),
                point(anchor.as_slice())
            )
        }
        Load::Weight { magnitude, .. } => format!("weight, {} N along gravity", force(*magnitude)),
        Load::Constant { wrench: w, axes } => wrench(w, *axes),
        Load::Measured => "measured with each displacement".to_string(),
        Load::Cases(cases) => counted(cases.len(), "load case"),
    }
}

/// A force \[N\] with the digits that kilograms of a weight leave.
fn force(newton: f64) -> String {
    with_minus(rounded(newton, 3).to_string())
}

fn wrench(wrench: &Wrench, axes: Axes) -> String {
    let list = |values: &[f64]| {
        let digits = values.iter().map(|v| Number::computed(*v).digits());
        digits.collect::<Vec<String>>().join(", ")
    };
    let moment = if wrench.moment.norm() > 0.0 {
        format!(", moment ({}) N·m", list(wrench.moment.as_slice()))
    } else {
        String::new()
    };
    let axes = match axes {
        Axes::Base => "base",
        Axes::Tool => "tool",
    };
    let force = list(wrench.force.as_slice());
    format!("force ({force}) N{moment}, {axes} axes")
}

fn limits(cell: &Cell) -> String {
    let (limits, line) = (&cell.limits, cell.setup.load.line());
    let length = |m: f64| coarse(m).text();
    let mut parts = Vec::new();
    if let Some([low, high]) = &limits.tool_box {
        let [low, high] = [low, high].map(|corner| point(corner.as_slice()));
        parts.push(format!("box ({low}) to ({high}) mm"));
    }
    let others = limits.on_points();
    for limit in others.filter(|limit| limit.kind != LimitKind::ToolBox) {
        let points = match limit.of {
            LimitedPoints::Wrist => "wrist",
            _ => "tool",
        };
        let at = length(limit.at);
        parts.push(match (limit.measure, limit.side) {
            (Measure::Axis(_), Side::AtLeast) => format!("{points} above {at}"),
            (Measure::Axis(_), Side::AtMost) => format!("{points} below {at}"),
            (Measure::FromAxis1, Side::AtLeast) => format!("{at} clear of axis 1"),
            (Measure::FromAxis1, Side::AtMost) => format!("{points} within {at} of axis 1"),
        });
    }
    if let Some([short, long]) = limits.rope_length {
        parts.push(format!("{line} {} to {}", coarse(short).digits(), length(long)));
    }
    if let Some(moved) = cell.scene.displacement() {
        let number = |m: f64| Number::computed(1e3 * m).significant(3).digits();
        let least = moved.smallest.map(|least| format!("{} to ", number(least)));
        let most = moved.largest.map_or_else(|| "any".to_string(), number);
        parts.push(format!("displacement {}{most} mm", least.unwrap_or_else(|| "up to ".to_string())));
    }
    if parts.is_empty() { "none".to_string() } else { parts.join("; ") }
}
