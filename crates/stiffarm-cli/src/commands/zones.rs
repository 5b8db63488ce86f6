//! `stiffarm zones`: maps of dexterity and of the influence of K_C.

use super::with_length;
use crate::args::ZonesArgs;
use crate::files::{check_folder, write_folder};
use crate::input::Line;
use crate::numbers::{optional_percent, percent, significant};
use crate::output::Exit;
use crate::progress::{Progress, announce};
use crate::session::Session;
use crate::table::{Table, title, yellow};
use serde::Serialize;
use stiffarm::Result;
use stiffarm::plan::zones::{MapRange, ZoneOptions, Zones, zones};
use stiffarm::units::{deg_to_rad, m_to_mm, rad_to_shortest_deg};
use stiffarm_report::{render_svg, zones_figure, zones_table};

/// Files of the folder.
const FILES: [&str; 2] = ["zones.svg", "zones.csv"];

/// From so many postures on, their number is said before.
const MANY: usize = 100_000;

/// Options of the result.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// Angles per axis of the map.
    pub steps: usize,
    /// L of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
}

/// Maps the zones.
pub fn run(session: &Session, args: &ZonesArgs) -> Result<Exit> {
    let mut named = session.read_cell(&args.cell)?;
    if let Some(folder) = &args.output_dir {
        check_folder(session, folder, FILES, args.force)?;
    }
    let (cell, length_line) = with_length(named.cell);
    named.cell = cell;
    let q = (!args.q_deg.is_empty()).then(|| args.q_deg.iter().copied().map(deg_to_rad).collect());
    let mut options = ZoneOptions::default();
    options.steps = args.steps;
    options.q = q;
    announce(
        session,
        args.steps.saturating_mul(args.steps),
        MANY,
        "postures to look at",
    );
    let progress = Progress::new(session, "mapping zones");
    let result = progress.watch(|control| zones(&named.cell, &options, control))?;
    drop(progress);
    let envelope = session.envelope(
        "zones",
        None,
        Options {
            steps: args.steps,
            characteristic_length_m: named.cell.characteristic_length,
        },
        &result,
    );
    let mut written = String::new();
    if let Some(folder) = &args.output_dir {
        let texts = [
            render_svg(&zones_figure(&result)),
            zones_table(&result).csv(),
        ];
        let files = FILES.map(String::from).into_iter().zip(texts).collect();
        write_folder(session, folder, files, args.force)?;
        if !session.has_failed() {
            written = format!("\nwrote {} to {}\n", FILES.join(" and "), folder.display());
        }
    }
    session.show(&envelope, || {
        let length = named.cell.characteristic_length.unwrap_or_default();
        let length = match length_line.is_empty() {
            true => format!("characteristic length: {:.1} mm\n", m_to_mm(length)),
            false => length_line.clone(),
        };
        named.line() + &length + &table(&result) + &written
    })?;
    Ok(Exit::Done)
}

/// An angle \[rad\] in degrees, without digits nobody set.
fn degrees(angle: f64) -> String {
    format!(
        "{}°",
        (rad_to_shortest_deg(angle) * 100.0).round() / 100.0 + 0.0
    )
}

fn table(zones: &Zones) -> String {
    let held: Vec<String> = zones
        .held
        .iter()
        .enumerate()
        .filter_map(|(j, q)| q.map(|q| format!("q{} = {}", j + 1, degrees(q))))
        .collect();
    let ends = |angles: &[f64]| match angles {
        [low, .., high] => format!("{} to {}", degrees(*low), degrees(*high)),
        _ => String::new(),
    };
    let mut out = format!(
        "map: {} from {}, {} from {}, {} × {} postures with {}\n",
        zones.joints[0],
        ends(&zones.q2),
        zones.joints[1],
        ends(&zones.q3),
        zones.q2.len(),
        zones.q3.len(),
        held.join(", ")
    );
    out += &format!(
        "{} of {} postures meet the limits of the cell.\n",
        zones.within_limits, zones.postures
    );
    out += &title("Ranges over the map, and the best posture");
    let mut table = Table::new(["quantity", "smallest", "median", "largest", "best posture"]);
    let best = zones.best.as_ref();
    let range = |range: Option<MapRange>, show: &dyn Fn(Option<f64>) -> String| {
        let value = |pick: fn(MapRange) -> f64| show(range.map(pick));
        [
            value(|r| r.smallest),
            value(|r| r.median),
            value(|r| r.largest),
        ]
    };
    let plain = |v: Option<f64>| v.map_or_else(|| "-".to_string(), |v| significant(v, 3));
    let mut row = |name: &str, ends: [String; 3], best: String| {
        table.row([vec![name.to_string()], ends.to_vec(), vec![best]].concat());
    };
    row(
        "dexterity 1/k(J_N)",
        range(zones.inverse_condition_range, &plain),
        plain(best.map(|b| b.inverse_condition)),
    );
    row(
        "translation with against without K_C [%]",
        range(zones.translation_range, &optional_percent),
        best.map_or_else(|| "-".to_string(), |b| percent(b.translation_deviation)),
    );
    row(
        "rotation with against without K_C [%]",
        range(zones.rotation_range, &optional_percent),
        best.map_or_else(|| "-".to_string(), |b| percent(b.rotation_deviation)),
    );
    out += &table.to_string();
    out += &match best {
        Some(best) => {
            let q: Vec<String> = best.best_q.iter().map(|q| degrees(*q)).collect();
            let range = |range: [f64; 2]| ends(&range);
            let share = |zone: usize| match zone {
                1 => "1 posture".to_string(),
                count => format!("{count} postures"),
            };
            format!(
                "\nbest zone: {} {}, {} {} ({}): 1/k(J_N) in the map's upper quarter, both deviations in its \
                 lower half\nits most dexterous posture: {}\n",
                zones.joints[0],
                range(best.q2),
                zones.joints[1],
                range(best.q3),
                share(best.posture_count),
                q.join(", ")
            )
        }
        None => format!(
            "\n{}\n",
            yellow("no zone: no posture of the map is both dexterous and little touched by K_C")
        ),
    };
    out
}
