//! The suspicions about scales in words: what it looks like, the factor, where to look.

use super::super::{Cause, Evidence, Suspicion};
use super::units::{DISPLACEMENTS, ENTRIES, FORCES, MOMENTS, PRIORS, Unit};
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

/// What is typed, of the table of units it stands in.
fn typed(units: &[Unit], s: &Suspicion) -> &'static str {
    let factor = s.factor.unwrap_or(1.0);
    let found = units
        .iter()
        .find(|u| (u.factor / factor - 1.0).abs() < 1e-6);
    found.map_or("another unit", |u| u.typed)
}

/// What says where loads stand.
fn where_loads_stand(cell: &Cell) -> &'static str {
    match (&cell.sensor, cell.setup.load.size()) {
        (Some(_), _) => "fx_n, fy_n, fz_n (N) and mx_nm, my_nm, mz_nm (N·m)",
        (None, Some(_)) => "load_n and load.magnitude_n (N)",
        _ => "the forces of the table and [load] (N)",
    }
}

fn also(s: &Suspicion) -> String {
    match s.alternatives.len() {
        0 => String::new(),
        _ => format!(
            " It would also be explained by {}.",
            s.alternatives.join("; or by ")
        ),
    }
}

fn misfits(s: &Suspicion) -> String {
    let Some([before, after]) = s.misfits else {
        return String::new();
    };
    let percent = |f: f64| format!("{:.0} %", 100.0 * f);
    format!(
        "{} of the displacement is left unexplained, as it stands {}",
        percent(after),
        percent(before)
    )
}

/// The stiffness beside what is known beforehand.
fn beside(cell: &Cell, s: &Suspicion) -> String {
    let what = match cell.prior {
        Some(_) => "the prior",
        None => "what robots of this class have",
    };
    let ratio = s.ratio.unwrap_or(1.0);
    format!(
        "As typed, the joint stiffness comes out {} {what}, all joints alike",
        times(ratio)
    )
}

fn rests_on(s: &Suspicion) -> String {
    match s.evidence {
        Some(Evidence::Prior) => {
            " Only this comparison speaks for it: look at the numbers before relying on the result."
                .to_string()
        }
        Some(Evidence::File) => {
            format!(" The file itself says so too: {}.", list(&s.confirmed_by))
        }
        _ => String::new(),
    }
}

/// The sentence of a suspicion about a scale; `opening` is its place at the
/// beginning of a sentence.
pub(in super::super) fn sentence(cell: &Cell, s: &Suspicion, opening: &str) -> String {
    let factor = number(s.factor.unwrap_or(1.0));
    match s.cause {
        Cause::LoadUnits if s.evidence == Some(Evidence::Readings) => format!(
            "The forces are {factor} times too small for the moments, by the stated loading point: they seem to be in \
             {}. Give {}.",
            typed(&FORCES, s),
            where_loads_stand(cell)
        ),
        Cause::LoadUnits => format!(
            "The loads look like {}: factor {factor}. {}.{}{} Check {}{}.",
            typed(&FORCES, s),
            beside(cell, s),
            rests_on(s),
            also(s),
            where_loads_stand(cell),
            match factor.as_str() {
                // The heading says kilonewtons, or the cell's load is a thousand times too large.
                "1/1000" => ", and whether a heading says kn (load_kn, fx_kn) above numbers in newtons",
                _ => "",
            }
        ),
        Cause::LoadEntry => {
            let place = if s.postures.is_empty() {
                format!("State {}, in every posture", list(&s.states))
            } else {
                opening.to_string()
            };
            format!(
                "{place}: what is typed as load looks like {}: factor {factor}. With it {}.{} Check {} there.",
                typed(&ENTRIES, s),
                misfits(s),
                also(s),
                where_loads_stand(cell)
            )
        }
        Cause::MomentUnits => format!(
            "The moments seem to be {}: with {factor} times what is typed they are the forces times their lever about \
             the sensor. Give mx_nm, my_nm, mz_nm in N·m, or name the columns mx_nmm, my_nmm, mz_nmm.",
            typed(&MOMENTS, s)
        ),
        Cause::DisplacementUnits if s.evidence == Some(Evidence::Readings) => format!(
            "{opening}: the displacements look like {}: factor {factor}. With it {}.{} Correct the rows.",
            typed(&DISPLACEMENTS, s),
            misfits(s),
            also(s)
        ),
        Cause::DisplacementUnits => format!(
            "The displacements look like {}: factor {factor}. {}.{}{} Check dx_mm, dy_mm, dz_mm.",
            typed(&DISPLACEMENTS, s),
            beside(cell, s),
            rests_on(s),
            also(s)
        ),
        Cause::PriorUnits => format!(
            "The prior stiffness looks like it is {}: factor {factor}. {}.{}{} Check stiffness.prior_nm_per_rad.",
            typed(&PRIORS, s),
            beside(cell, s),
            rests_on(s),
            also(s)
        ),
        Cause::AnchorUnits => format!(
            "The displacements point to another direction of the load: with load.anchor_mm times {factor}, {}. Check \
             the unit of load.anchor_mm (mm).",
            misfits(s)
        ),
        Cause::LoadingPointUnits if s.evidence == Some(Evidence::File) => format!(
            "The loading point lies {:.2} mm from the flange's origin, and no measuring point is near: it looks like \
             metres typed as millimetres, factor {factor}. Check tool.loading_point_mm (mm).",
            m_to_mm(s.off_m.unwrap_or_default())
        ),
        Cause::LoadingPointUnits => format!(
            "The displacements point to another loading point: with tool.loading_point_mm times {factor}, {}. Check the \
             unit of tool.loading_point_mm (mm).",
            misfits(s)
        ),
        Cause::RobotUnits => format!(
            "The robot's reach is {} times that of the readings, while the tool is right: check the unit of the \
             robot's lengths (robot.dh rows in mm).",
            number(1.0 / s.factor.unwrap_or(1.0))
        ),
        Cause::ExchangedLoadCases => {
            let place = if s.postures.is_empty() {
                "In the whole table".to_string()
            } else {
                format!("In posture {}", list(&s.postures))
            };
            format!(
                "{place} the load cases {} are exchanged: with the names the other way {}. Correct the names in the \
                 column state, or the loads of [load].",
                list(&s.states),
                misfits(s)
            )
        }
        Cause::Radians => format!(
            "The joint angles seem to be radians under a heading in degrees: with them converted {}. Convert them.",
            misfits(s)
        ),
        Cause::Degrees => "The joint angles seem to be degrees under a heading in radians: read so, the arm is where \
                           the readings have it. Name the columns q1_deg and so on, or convert them."
            .to_string(),
        _ => String::new(),
    }
}
