//! `[elastic]`: how much gives way beyond the joint axes.

use super::raw::RawElastic;
use super::source::Source;
use super::value::{List, Number, Spanned};
use stiffarm::error::{Code, Result};
use stiffarm::model::elastic::{ElasticSizes, KnownElement, beams};
use stiffarm::model::observation::ExtraTerm;
use stiffarm::model::robot::Robot;

const HINT: &str = "[elastic] needs all three of shift_std_m_per_n, turn_std_rad_per_nm and coupling_std_rad_per_n or \
                    none: give them as identify --elastic mixed prints them; without them they are typical of an arm \
                    like this";

/// Factor of a stiffness that a drawing or a catalogue gives.
const FACTOR: f64 = 1.5;

/// The sizes: all three or none.
pub(super) fn elastic(source: &Source<'_>, table: &Spanned<RawElastic>) -> Result<Option<ElasticSizes>> {
    let raw = table.get();
    let all = [
        (&raw.shift_std_m_per_n, "shift_std_m_per_n"),
        (&raw.turn_std_rad_per_nm, "turn_std_rad_per_nm"),
        (&raw.coupling_std_rad_per_n, "coupling_std_rad_per_n"),
    ];
    if all.iter().all(|(value, _)| value.is_none()) {
        return Ok(None);
    }
    let size = |(value, name): (&Option<Number>, &str)| source.not_negative(source.required(table, value, name, HINT)?);
    let [shift, turn, coupling] = all.map(size);
    Ok(Some(ElasticSizes { shift: shift?, turn: turn?, coupling: coupling? }))
}

/// Bearings, links and base of which the stiffness is given.
pub(super) fn known_elements(
    source: &Source<'_>,
    table: &Spanned<RawElastic>,
    robot: &Robot,
) -> Result<Vec<KnownElement>> {
    let raw = table.get();
    let factor = match &raw.stiffness_factor {
        None => FACTOR,
        Some(raw_factor) => {
            let factor = source.positive(raw_factor)?;
            if factor <= 1.0 {
                let message = format!("The factor must be above 1, got {factor}.");
                let error = source.error(Code::InvalidValue, raw_factor, message);
                return Err(error.hint("2: the stiffness may as well be twice or half as large"));
            }
            factor
        }
    };
    let (joints, beams) = (robot.joint_count(), beams(robot));
    let mut out = Vec::new();
    if let Some(value) = &raw.base_tilt_nm_per_rad {
        let stiffness = source.positive(value)?;
        out.push(KnownElement::new(ExtraTerm::BaseTilt, stiffness, factor));
    }
    let beam = |twist: bool| {
        let beams = &beams;
        move |joint: usize| -> Vec<ExtraTerm> {
            let is_own = |term: &&ExtraTerm| match term {
                ExtraTerm::Beam { joint: j, twist: t, .. } => (*j, *t) == (joint, twist),
                _ => false,
            };
            beams.iter().filter(is_own).copied().collect()
        }
    };
    let mut add = |list: &Option<List>, of: &dyn Fn(usize) -> Vec<ExtraTerm>| -> Result<()> {
        let Some(list) = list else { return Ok(()) };
        source.count(list, joints, "numbers", "one per joint")?;
        let values = source.each(list, Source::not_negative)?;
        for ((j, stiffness), place) in values.into_iter().enumerate().zip(list.get()) {
            if stiffness == 0.0 {
                continue;
            }
            let terms = of(j);
            if terms.is_empty() {
                let joint = &robot.joints()[j].name;
                let message = format!("The link behind {joint} has no length: nothing bends there.");
                return Err(source.error(Code::InvalidValue, place, message).hint("give 0 for it"));
            }
            let elements = terms.into_iter().map(|term| KnownElement::new(term, stiffness, factor));
            out.extend(elements);
        }
        Ok(())
    };
    add(&raw.bearing_tilt_nm_per_rad, &|j| vec![ExtraTerm::JointTilt(j)])?;
    add(&raw.link_bending_nm2, &beam(false))?;
    add(&raw.link_twist_nm2, &beam(true))?;
    if out.is_empty()
        && let Some(factor) = &raw.stiffness_factor
    {
        let message = "A factor of a stiffness is given, and no stiffness of a bearing, a link or the base.";
        let error = source.error(Code::InvalidValue, factor, message);
        return Err(
            error.hint("give bearing_tilt_nm_per_rad, link_bending_nm2, link_twist_nm2 or base_tilt_nm_per_rad")
        );
    }
    Ok(out)
}
