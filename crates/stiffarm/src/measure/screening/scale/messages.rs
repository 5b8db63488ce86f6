//! The suspicions about scales in words: what it looks like, the factor, where to look.

use super::super::units::{DISPLACEMENTS, ENTRIES, FORCES, MOMENTS, PRIORS, Unit};
use super::super::{Cause, Evidence, Suspicion};
use crate::findings::list;
use crate::model::cell::Cell;
use crate::units::m_to_mm;

/// A factor as people know it: `9.81`, `4.448`, `1000`, `25.4`, `1/9.81`.
pub(super) fn number(factor: f64) -> String {
    let digits = |f: f64| match f {
        f if (f - 9.806_65).abs() < 1e-3 => "9.81".to_string(),
        f if f >= 1000.0 || (f - f.round()).abs() < 1e-9 => format!("{f:.0}"),
        f if f >= 10.0 => format!("{f:.1}"),
        f => format!("{f:.3}"),
    };
    if factor < 1.0 {
        format!("1/{}", digits(1.0 / factor))
    } else {
        digits(factor)
    }
}

/// How many times too small or large a stiffness is, with two digits.
fn times(ratio: f64) -> String {
    let (size, word) = if ratio < 1.0 {
        (1.0 / ratio, "below")
    } else {
        (ratio, "above")
    };
    let digits = if size < 9.95 { 1 } else { 0 };
    format!("{size:.digits$} times {word}")
}

/// What is typed, and the factor on it: `kilograms (kgf), factor 9.81`.
fn typed(s: &Suspicion) -> String {
    let units: &[Unit] = match s.cause {
        Cause::LoadUnits => &FORCES,
        Cause::LoadEntry => &ENTRIES,
        Cause::MomentUnits => &MOMENTS,
        Cause::PriorUnits => &PRIORS,
        _ => &DISPLACEMENTS,
    };
    let factor = s.factor.unwrap_or(1.0);
    let mut units = units.iter();
    let found = units.find(|u| (u.factor / factor - 1.0).abs() < 1e-6);
    found.map_or("another unit", |u| u.typed).to_string()
}

/// A scale beside others that explain alike.
pub(in super::super) fn phrase(s: &Suspicion) -> String {
    let (typed, factor) = (typed(s), number(s.factor.unwrap_or(1.0)));
    let what = match s.cause {
        Cause::LoadUnits => "loads typed in ",
        Cause::PriorUnits => "a prior stiffness ",
        Cause::DisplacementUnits if s.postures.is_empty() => "displacements in ",
        _ => "",
    };
    format!("{what}{typed}, factor {factor}")
}

/// What says where loads stand.
fn where_loads_stand(cell: &Cell) -> &'static str {
    match (&cell.sensor, cell.setup.load.size()) {
        (Some(_), _) => "fx_n, fy_n, fz_n (N) and mx_nm, my_nm, mz_nm (N·m)",
        (None, Some(_)) => "load_n and load.magnitude_n (N)",
        _ => "the forces of the table and [load] (N)",
    }
}

/// The sentence of a suspicion about a scale; `opening` is its place at the beginning of a sentence.
pub(in super::super) fn sentence(cell: &Cell, s: &Suspicion, opening: &str) -> String {
    let factor = number(s.factor.unwrap_or(1.0));
    let (typed, where_loads_stand) = (typed(s), where_loads_stand(cell));
    let percent = |i: usize| s.misfits.map_or(0.0, |misfits| 100.0 * misfits[i]);
    let misfits = format!(
        "{:.0} % of the displacement is left unexplained, as it stands {:.0} %",
        percent(1),
        percent(0)
    );
    let also = match s.alternatives.join("; or by ") {
        none if none.is_empty() => none,
        others => format!(" It would also be explained by {others}."),
    };
    let rests_on = match s.evidence {
        Some(Evidence::Prior) => {
            " Only this comparison speaks for it: look at the numbers before relying on the result."
                .to_string()
        }
        Some(Evidence::File) => {
            format!(" The file itself says so too: {}.", list(&s.confirmed_by))
        }
        _ => String::new(),
    };
    // The stiffness beside what is known beforehand, for what is on everything.
    let beside = match cell.prior {
        Some(_) => "the prior",
        None => "what robots of this class have",
    };
    let beside = format!(
        "factor {factor}. As typed, the joint stiffness comes out {} {beside}, all joints alike.{rests_on}{also}",
        times(s.ratio.unwrap_or(1.0))
    );
    match s.cause {
        Cause::LoadUnits if s.evidence == Some(Evidence::Readings) => format!(
            "The forces are {factor} times too small for the moments, by the stated loading point: they seem to be in \
             {typed}. Give {where_loads_stand}."
        ),
        Cause::LoadUnits => {
            // The heading says kilonewtons, or the cell's load is a thousand times too large.
            let heading = match factor.as_str() {
                "1/1000" => ", and whether a heading says kn (load_kn, fx_kn) above numbers in newtons",
                _ => "",
            };
            format!("The loads look like {typed}: {beside} Check {where_loads_stand}{heading}.")
        }
        Cause::LoadEntry => {
            let place = match s.postures.len() {
                0 => format!("State {}, in every posture", list(&s.states)),
                _ => opening.to_string(),
            };
            format!(
                "{place}: what is typed as load looks like {typed}: factor {factor}. With it {misfits}.{also} Check \
                 {where_loads_stand} there."
            )
        }
        Cause::MomentUnits => format!(
            "The moments seem to be {typed}: with {factor} times what is typed they are the forces times their lever about \
             the sensor. Give mx_nm, my_nm, mz_nm in N·m, or name the columns mx_nmm, my_nmm, mz_nmm."
        ),
        Cause::DisplacementUnits if s.evidence == Some(Evidence::Readings) => format!(
            "{opening}: the displacements look like {typed}: factor {factor}. With it {misfits}.{also} Correct the rows."
        ),
        Cause::DisplacementUnits => {
            format!("The displacements look like {typed}: {beside} Check dx_mm, dy_mm, dz_mm.")
        }
        Cause::PriorUnits => format!(
            "The prior stiffness looks like it is {typed}: {beside} Check stiffness.prior_nm_per_rad."
        ),
        Cause::AnchorUnits => format!(
            "The displacements point to another direction of the load: with load.anchor_mm times {factor}, {misfits}. Check \
             the unit of load.anchor_mm (mm)."
        ),
        Cause::LoadingPointUnits if s.evidence == Some(Evidence::File) => {
            let away = m_to_mm(s.off_m.unwrap_or_default());
            format!(
                "The loading point lies {away:.2} mm from the flange's origin, and no measuring point is near: it looks \
                 like metres typed as millimetres, factor {factor}. Check tool.loading_point_mm (mm)."
            )
        }
        Cause::LoadingPointUnits => format!(
            "The displacements point to another loading point: with tool.loading_point_mm times {factor}, {misfits}. Check \
             the unit of tool.loading_point_mm (mm)."
        ),
        Cause::RobotUnits => format!(
            "The robot's reach is {} times that of the readings, while the tool is right: check the unit of the robot's \
             lengths (robot.dh rows in mm).",
            number(1.0 / s.factor.unwrap_or(1.0))
        ),
        Cause::ExchangedLoadCases => {
            let place = match s.postures.len() {
                0 => "In the whole table".to_string(),
                _ => format!("In posture {}", list(&s.postures)),
            };
            let cases = list(&s.states);
            format!(
                "{place} the load cases {cases} are exchanged: with the names the other way {misfits}. Correct the names in \
                 the column state, or the loads of [load]."
            )
        }
        Cause::Radians => format!(
            "The joint angles seem to be radians under a heading in degrees: with them converted {misfits}. Convert them."
        ),
        Cause::Degrees => "The joint angles seem to be degrees under a heading in radians: read so, the arm is where \
                           the readings have it. Name the columns q1_deg and so on, or convert them."
            .to_string(),
        _ => String::new(),
    }
}
