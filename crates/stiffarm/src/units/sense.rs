//! How large a number can be and still be meant, by the unit that ends its name.
//!
//! Keys of cell files, headings of tables and options of the command all end in their
//! unit, so one table serves them all. Its limits are far beyond every robot; they keep
//! slips of the pen out of results and every square of a number finite. What is possible
//! and yet not meant is for [`check`](crate::plan::check::check) and for
//! [`implausible`](crate::model::implausible) to say.

/// Numbers without unit beyond this are slips of the pen.
pub const LARGEST_NUMBER: f64 = 1e9;

/// What the numbers of a unit can be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sense {
    /// How names with this unit end, behind an underscore.
    suffix: &'static str,
    /// The quantity with its article, for messages.
    quantity: &'static str,
    /// The unit, for messages.
    unit: &'static str,
    /// Where a number above zero is needed, the smallest one.
    pub smallest: f64,
    /// From here on a number is no longer meant, whatever its sign.
    pub limit: f64,
}

const fn sense(suffix: &'static str, quantity: &'static str, unit: &'static str, smallest: f64, limit: f64) -> Sense {
    Sense { suffix, quantity, unit, smallest, limit }
}

#[rustfmt::skip]
const TABLE: [Sense; 36] = [
    sense("mm", "A length", "mm", 1e-6, 1e6),
    sense("m", "A length", "m", 1e-9, 1e3),
    sense("um", "A length", "µm", 1e-3, 1e9),
    sense("in", "A length", "in", 1e-7, 4e4),
    sense("axial_depth_mm", "A depth of cut", "mm", 1e-6, 1e3),
    sense("radial_depth_mm", "A width of cut", "mm", 1e-6, 1e3),
    sense("diameter_mm", "A diameter", "mm", 1e-6, 1e3),
    sense("posture_common_mm", "A shift common to a posture", "mm", 1e-6, 1e3),
    sense("std_mm", "A standard deviation", "mm", 1e-6, 1e3),
    sense("tolerance_mm", "A tolerance", "mm", 1e-6, 1e4),
    sense("mm2", "A variance", "mm²", 1e-18, 1e6),
    sense("um_per_m", "A length per length", "µm/m", 1e-6, 1e6),
    sense("n", "A force", "N", 1e-6, 1e6),
    sense("kn", "A force", "kN", 1e-9, 1e3),
    sense("nm", "A moment", "N·m", 1e-6, 1e6),
    sense("nmm", "A moment", "N·mm", 1e-3, 1e9),
    sense("deg", "An angle", "°", 1e-9, 36e3),
    sense("rad", "An angle", "rad", 1e-11, 628.0),
    sense("noise_deg", "A standard deviation", "°", 1e-9, 360.0),
    sense("step_deg", "A step", "°", 1e-6, 36e3),
    sense("mrad", "An angle", "mrad", 1e-6, 1e3),
    sense("urad", "An angle", "µrad", 1e-3, 1e6),
    sense("arcmin", "An angle", "arc-minutes", 1e-6, 3.6e3),
    sense("percent", "A share", "%", 1e-6, 1e4),
    sense("nm_per_rad", "A stiffness", "N·m/rad", 1e-3, 1e15),
    sense("n_per_m", "A stiffness", "N/m", 1e-3, 1e18),
    sense("m_per_n", "A compliance", "m/N", 1e-18, 1.0),
    sense("rad_per_nm", "A compliance", "rad/(N·m)", 1e-15, 1.0),
    sense("rad_per_n", "A compliance", "rad/N", 1e-18, 1.0),
    sense("n_per_mm2", "A cutting coefficient", "N/mm²", 1e-6, 1e5),
    sense("n_per_mm", "A cutting coefficient", "N/mm", 1e-6, 1e5),
    sense("s", "A time", "s", 1e-9, 1e12),
    sense("ms", "A time", "ms", 1e-6, 1e15),
    sense("min", "A time", "min", 1e-10, 1e11),
    sense("levels", "A factor on the variance", "", 1e-9, 1e6),
    sense("direction", "A component of a direction", "", 1e-9, LARGEST_NUMBER),
];

impl Sense {
    /// What the numbers under `name` can be: a key path of a cell file
    /// (`robot.limits_deg[2][1]`), a heading (`fx_n`) or an option (`--force-n`).
    /// `None` where its name ends in no unit.
    pub fn of(name: &str) -> Option<&'static Sense> {
        let key = name.rsplit('.').next().unwrap_or(name);
        let key = key.split('[').next().unwrap_or(key);
        let key = key.trim_start_matches('-').replace('-', "_");
        let ends = |sense: &&Sense| {
            let before = key.strip_suffix(sense.suffix);
            before.is_some_and(|before| before.is_empty() || before.ends_with('_'))
        };
        TABLE.iter().filter(ends).max_by_key(|s| s.suffix.len())
    }

    /// What may be behind a number that cannot be meant.
    pub fn hint(&self) -> Option<&'static str> {
        match self.unit {
            "mm" if self.quantity == "A length" => Some("the unit is mm: 1 m is 1000 mm"),
            "N/mm²" | "N/mm" => Some("1 N/mm² is 1 MPa = 1e6 Pa, 1 N/mm is 1000 N/m"),
            _ => None,
        }
    }

    /// Says that `value` is beyond what can be meant, where it is.
    pub fn refuse(&self, value: f64) -> Option<String> {
        (value.abs() >= self.limit).then(|| {
            let Sense { quantity, unit, .. } = self;
            let number = |value: f64| match value.abs() {
                size if (1e-3..1e9).contains(&size) => value.to_string(),
                _ => format!("{value:e}"),
            };
            let [value, limit] = [value, self.limit].map(|v| match *unit {
                "" => number(v),
                "°" => format!("{}°", number(v)),
                unit => format!("{} {unit}", number(v)),
            });
            format!("{quantity} of {value} cannot be meant: it must be below {limit}.")
        })
    }
}
