//! Classes of what gives way beyond the joint axes.

use serde::{Deserialize, Serialize};

/// What gives way beyond the joint axes and scatters alike: entries of general springs, then what an arm is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ElasticClass {
    /// Shifts by forces \[m/N\].
    Shift,
    /// Turns by moments, but for the joint's own axis \[rad/(N·m)\].
    Turn,
    /// Shifts by moments and turns by forces \[rad/N\].
    Coupling,
    /// Tilts of the joints' bearings and of the base \[rad/(N·m)\].
    Bearing,
    /// Bending and twist of the links along the robot's rows \[rad/(N·m) per m\].
    Beam,
    /// Bearings, links and base of which a drawing gives the stiffness: of any size.
    Drawing,
}

impl ElasticClass {
    /// Those whose sizes readings tell, in the order of results.
    pub const ALL: [ElasticClass; 5] =
        [ElasticClass::Shift, ElasticClass::Turn, ElasticClass::Coupling, ElasticClass::Bearing, ElasticClass::Beam];
    /// Those of the entries of general springs.
    pub const ENTRIES: [ElasticClass; 3] = [ElasticClass::Shift, ElasticClass::Turn, ElasticClass::Coupling];

    /// The class of an entry: rows and columns 0 to 2 are shifts and forces, 3 to 5 turns
    /// and moments.
    pub fn of(row: usize, column: usize) -> Self {
        match (row < 3, column < 3) {
            (true, true) => ElasticClass::Shift,
            (false, false) => ElasticClass::Turn,
            _ => ElasticClass::Coupling,
        }
    }

    /// Unit of its compliances.
    pub fn unit(self) -> &'static str {
        match self {
            ElasticClass::Shift => "m/N",
            ElasticClass::Turn | ElasticClass::Bearing | ElasticClass::Drawing => "rad/(N·m)",
            ElasticClass::Coupling => "rad/N",
            ElasticClass::Beam => "rad/(N·m) per m",
        }
    }
}
