//! `[elastic]`: how much gives way beyond the joint axes.

use super::raw::{At, Number, RawElastic};
use super::source::Source;
use stiffarm::error::Result;
use stiffarm::model::elastic::ElasticSizes;

const HINT: &str = "[elastic] needs all three of shift_std_m_per_n, turn_std_rad_per_nm and coupling_std_rad_per_n, as \
                    identify --elastic mixed prints them; without the table they are typical of an arm like this";

/// The sizes: all three or none.
pub(super) fn elastic(source: &Source<'_>, table: &At<RawElastic>) -> Result<ElasticSizes> {
    let raw = table.get();
    let size = |value: &Option<Number>, name: &str| {
        source.not_negative(source.required(table, value, name, HINT)?)
    };
    Ok(ElasticSizes {
        shift: size(&raw.shift_std_m_per_n, "shift_std_m_per_n")?,
        turn: size(&raw.turn_std_rad_per_nm, "turn_std_rad_per_nm")?,
        coupling: size(&raw.coupling_std_rad_per_n, "coupling_std_rad_per_n")?,
    })
}
