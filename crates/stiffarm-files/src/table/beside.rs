//! What may stand in a row of measurements beside its names, lengths and angles: a row of facts each. Readers, writers
//! and sheets go by it, and so do errors and the keys of `[columns]`.

use super::quantity::Quantity;
use nalgebra::Vector3;
use stiffarm::model::load::Wrench;
use stiffarm::model::measurement::Reading;

/// A quantity of a row, in the order in which they are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum RowQuantity {
    /// From where the tracker read.
    Station,
    /// Force of the state.
    Force,
    /// Its moment.
    Moment,
    /// Force of rope, cylinder or weight in the state.
    Load,
    /// When it was read.
    Time,
    /// Expanded uncertainty of the coordinates, 95 %.
    Expanded,
    /// Temperature of the air.
    Temperature,
}

/// What a row has to say.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct RowContents<'a> {
    pub(super) station: Option<&'a str>,
    pub(super) wrench: Option<Wrench>,
    pub(super) load: Option<f64>,
    /// Time of a displacement; a reading has its own.
    pub(super) time: Option<f64>,
    pub(super) reading: Option<&'a Reading>,
}

/// What stands in the fields of a quantity: a name, or as many numbers as it has columns, in SI units.
enum Field<'a> {
    Name(&'a str),
    Numbers(Vector3<f64>),
}

/// All that is said of one of them.
struct Facts {
    /// Names of its columns without unit.
    stems: &'static [&'static str],
    quantity: Quantity,
    /// Its components together.
    group: &'static str,
    /// Whether displacements may have it, as readings may.
    of_displacements: bool,
    /// What its numbers are called where they are never below zero.
    size: Option<&'static str>,
    get: for<'a> fn(&RowContents<'a>) -> Option<Field<'a>>,
    /// Takes it into a reading; `None` for what belongs to a posture or a state.
    set: Option<fn(&mut Reading, Vector3<f64>)>,
}

/// A single number.
fn one(value: f64) -> Field<'static> {
    Field::Numbers(Vector3::new(value, 0.0, 0.0))
}

impl RowQuantity {
    pub(super) const ALL: [RowQuantity; 7] = [
        RowQuantity::Station,
        RowQuantity::Force,
        RowQuantity::Moment,
        RowQuantity::Load,
        RowQuantity::Time,
        RowQuantity::Expanded,
        RowQuantity::Temperature,
    ];

    fn facts(self) -> Facts {
        let facts = |stems, quantity, group| Facts {
            stems,
            quantity,
            group,
            of_displacements: false,
            size: None,
            get: |_| None,
            set: None,
        };
        match self {
            RowQuantity::Station => Facts {
                get: |contents| contents.station.map(Field::Name),
                ..facts(&["station"], Quantity::Name, "station")
            },
            RowQuantity::Force => Facts {
                of_displacements: true,
                get: |contents| contents.wrench.map(|wrench| Field::Numbers(wrench.force)),
                ..facts(&["fx", "fy", "fz"], Quantity::Force, "force")
            },
            RowQuantity::Moment => Facts {
                of_displacements: true,
                get: |contents| contents.wrench.map(|wrench| Field::Numbers(wrench.moment)),
                ..facts(&["mx", "my", "mz"], Quantity::Moment, "moment")
            },
            RowQuantity::Load => {
                Facts { get: |contents| contents.load.map(one), ..facts(&["load"], Quantity::Force, "load") }
            }
            RowQuantity::Time => Facts {
                of_displacements: true,
                get: |contents| contents.time.or_else(|| contents.reading?.time).map(one),
                set: Some(|reading, value| reading.time = Some(value.x)),
                ..facts(&["time"], Quantity::Time, "time")
            },
            RowQuantity::Expanded => Facts {
                size: Some("An uncertainty"),
                get: |contents| contents.reading?.expanded.map(Field::Numbers),
                set: Some(|reading, value| reading.expanded = Some(value)),
                ..facts(&["u95x", "u95y", "u95z"], Quantity::Length, "uncertainty")
            },
            RowQuantity::Temperature => Facts {
                get: |contents| contents.reading?.temperature.map(one),
                set: Some(|reading, value| reading.temperature = Some(value.x)),
                ..facts(&["temperature"], Quantity::Temperature, "temperature")
            },
        }
    }

    /// Whether a table of displacements may have it, as one of readings may.
    pub(super) fn is_of_displacements(self) -> bool {
        self.facts().of_displacements
    }

    /// Names of its columns without unit, what they hold, and what they are together.
    pub(super) fn columns(self) -> (&'static [&'static str], Quantity, &'static str) {
        let facts = self.facts();
        (facts.stems, facts.quantity, facts.group)
    }

    /// What a column of this name without unit holds.
    pub(super) fn quantity_of(stem: &str) -> Option<Quantity> {
        let mut all = RowQuantity::ALL.into_iter().map(RowQuantity::facts);
        let matching = all.find(|facts| facts.stems.contains(&stem));
        matching.map(|facts| facts.quantity)
    }

    /// What to do where some of its columns are missing.
    pub(super) fn hint(self) -> String {
        let group = self.facts().group;
        format!("give all three components of the {group}, or none")
    }

    /// What its numbers are called where they are never below zero.
    pub(super) fn size(self) -> Option<&'static str> {
        self.facts().size
    }

    /// How a reading takes what its row says of it; `None` for what belongs to a posture or a state.
    pub(super) fn setter(self) -> Option<fn(&mut Reading, Vector3<f64>)> {
        self.facts().set
    }

    /// Whether a row says something of it.
    pub(super) fn is_in(self, contents: &RowContents<'_>) -> bool {
        (self.facts().get)(contents).is_some()
    }

    /// What stands in its fields, empty where there is no value.
    pub(super) fn texts(self, contents: &RowContents<'_>) -> Vec<String> {
        let facts = self.facts();
        let unit = facts.quantity.units().first();
        let text = |value: f64| unit.map_or(value, |unit| unit.shortest(value)).to_string();
        match (facts.get)(contents) {
            None => vec![String::new(); facts.stems.len()],
            Some(Field::Name(name)) => vec![name.to_string()],
            Some(Field::Numbers(all)) => {
                let components = all.iter().take(facts.stems.len());
                components.map(|value| text(*value)).collect()
            }
        }
    }
}
