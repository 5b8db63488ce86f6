//! What a file says about its own loads: numbers in the names of states, the
//! cell's nominal load, what this robot can be loaded with at all.

use super::super::Work;
use super::super::motion::{Move, load_of};
use crate::model::implausible::{LARGEST_FORCE, payload_weight};
use crate::numerics::sample::median;
use crate::units::STANDARD_GRAVITY;

/// Numbers in names are rounded: relative tolerance.
const ROUNDED: f64 = 0.02;
/// Share of the numbered states that must agree.
const AGREEING_SHARE: f64 = 0.8;
/// Numbers in names below this may be counters.
const COUNTER: f64 = 5.0;
/// A measured force agrees with the rope's or weight's size to this (logarithm).
const SAME_FORCE: f64 = 0.1;
/// The largest load of a table over the cell's own, as people choose it.
const OF_NOMINAL: [f64; 2] = [0.2, 1.3];
/// Loads that a test is done with: at least \[N\], and in weights of the payload at most.
const SMALLEST_TEST_LOAD: f64 = 10.0;
const LARGEST_TEST_PAYLOADS: f64 = 5.0;
/// Displacements that a test gives \[m\].
const DISPLACEMENT: [f64; 2] = [5e-6, 2e-2];
/// Softness of these ranges (logarithm), and most that each may count.
const SOFT: f64 = 0.3;
const COUNTS: f64 = 8.0;
/// What is worth a word (logarithm of a likelihood).
const WORTH_NAMING: f64 = 1.0;

/// What is known of the sizes of loads and displacements.
#[derive(Debug, Clone, Default)]
pub(super) struct Sizes {
    /// Load that the table or the cell states and number in the name of the state \[N\].
    named: Vec<(f64, f64)>,
    /// Measured force and the force that load and cell let expect \[N\].
    expected: Vec<(f64, f64)>,
    /// Largest load of the table over the cell's.
    of_nominal: Option<f64>,
    /// Median load \[N\].
    load: f64,
    /// Largest plausible load \[N\].
    most: f64,
    /// Median displacement \[m\].
    displacement: f64,
}

/// The number in a state's name in newtons, where there is one: `up-500`,
/// `51kg`, `0.5 kN`.
pub(super) fn number_in(name: &str) -> Option<f64> {
    let start = name.find(|c: char| c.is_ascii_digit())?;
    let rest = &name[start..];
    let end = rest.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(rest.len());
    let value: f64 = rest[..end].trim_end_matches('.').parse().ok()?;
    let unit: String =
        rest[end..].trim_start_matches([' ', '_']).chars().take_while(|c| c.is_ascii_alphabetic()).collect();
    let factor = match unit.to_ascii_lowercase().as_str() {
        "kg" | "kgf" | "kp" => STANDARD_GRAVITY,
        "lb" | "lbs" | "lbf" => super::super::units::POUND,
        "kn" => 1e3,
        _ => 1.0,
    };
    (value > 0.0).then_some(value * factor)
}

impl Sizes {
    /// Sizes in `moves` of `work`.
    pub fn of(work: &Work, moves: &[Move]) -> Self {
        let mut out = Sizes::default();
        let mut loads = Vec::new();
        let mut typed_largest = 0.0_f64;
        let nominal = work.setup().load.each().filter_map(|l| l.size());
        let nominal = nominal.fold(0.0, f64::max);
        let strongest = moves.iter().map(|m| m.wrench.force.norm()).fold(0.0, f64::max);
        for one in moves {
            let state = work.sheet.at((one.posture, one.state));
            let case_setup = work.setup().of_state(&state.name).ok();
            let case_size = case_setup.and_then(|setup| setup.load.size());
            let force = one.wrench.force.norm();
            let size = match state.wrench {
                Some(_) => force,
                None => load_of(work, state).unwrap_or(force),
            };
            if size <= 0.0 {
                continue;
            }
            loads.push(size);
            if let Some(number) = number_in(&state.name).filter(|v| *v >= COUNTER) {
                out.named.push((size, number));
            }
            if state.wrench.is_some() {
                let reference = work.sheet.at((one.posture, one.reference)).load;
                let listed = state.load.map(|l| l - reference.unwrap_or(0.0));
                // Without the table's word only the strongest state has the whole load.
                let whole = case_size.filter(|_| force > 0.9 * strongest);
                if let Some(expected) = listed.or(whole).filter(|e| *e > 0.0) {
                    out.expected.push((force, expected));
                }
            } else if state.load.is_some() {
                typed_largest = typed_largest.max(size);
            }
        }
        if nominal > 0.0 && typed_largest > 0.0 {
            out.of_nominal = Some(typed_largest / nominal);
        }
        let weight = payload_weight(&work.setup().robot);
        out.most = weight.map_or(LARGEST_FORCE, |weight| LARGEST_TEST_PAYLOADS * weight);
        if !loads.is_empty() {
            out.load = median(&loads);
            let sizes: Vec<f64> =
                moves.iter().map(|m| (m.shift.norm_squared() * 3.0 / m.shift.len() as f64).sqrt()).collect();
            out.displacement = median(&sizes);
        }
        out
    }

    /// How well the names and the cell's own load agree with loads `factor`
    /// times what is typed: logarithm of a likelihood, zero or below.
    pub fn stated(&self, factor: f64) -> f64 {
        let mut out = 0.0;
        if let Some(ratio) = self.of_nominal {
            out -= outside(ratio * factor, OF_NOMINAL);
        }
        if !self.expected.is_empty() {
            let logs: Vec<f64> =
                self.expected.iter().map(|(force, expected)| (factor * force / expected).ln()).collect();
            out -= ((median(&logs) / SAME_FORCE).powi(2) / 2.0).min(COUNTS);
        }
        out
    }

    /// True where most numbers in names are `factor` times the loads.
    pub fn is_named(&self, factor: f64) -> bool {
        let agree = |(load, number): &&(f64, f64)| (factor * load / number).ln().abs() < ROUNDED;
        let count = self.named.iter().filter(agree).count();
        count > 0 && count as f64 >= AGREEING_SHARE * self.named.len() as f64
    }

    /// What says that loads and displacements are these multiples of what is typed.
    pub fn reasons(&self, load: f64, displacement: f64) -> Vec<String> {
        let mut out = Vec::new();
        if load != 1.0 && self.is_named(load) {
            let ratios: Vec<f64> = self.named.iter().map(|(size, number)| number / size).collect();
            let of_loads = match median(&ratios) {
                times if times < 0.1 => format!("1/{} of", short(1.0 / times)),
                times => format!("{} times", short(times)),
            };
            out.push(format!("the numbers in the names of states ({of_loads} the loads)"));
        }
        if self.stated(load) - self.stated(1.0) > WORTH_NAMING {
            out.push("the load that cell or table states".to_string());
        }
        let plausible = |load, displacement| self.plausible(load, displacement);
        if plausible(load, displacement) - plausible(1.0, 1.0) > WORTH_NAMING {
            out.push(if load < 1.0 {
                format!("{} N, more than such a robot can carry", short(self.load))
            } else if load > 1.0 {
                format!("{} N, which hardly bends such a robot", short(self.load))
            } else {
                format!("{} mm, which no such load moves it by", short(1e3 * self.displacement))
            });
        }
        out
    }

    /// How plausible loads and displacements of these multiples of what is typed are.
    pub fn plausible(&self, load: f64, displacement: f64) -> f64 {
        if self.load <= 0.0 {
            return 0.0;
        }
        -outside(self.load * load, [SMALLEST_TEST_LOAD, self.most])
            - outside(self.displacement * displacement, DISPLACEMENT)
    }
}

/// Two digits of a size.
fn short(size: f64) -> String {
    match size {
        s if s >= 10.0 => format!("{s:.0}"),
        s if s >= 1.0 => format!("{s:.1}"),
        s => format!("{s:.2}"),
    }
}

/// Zero within a range, growing with the square of the distance outside.
fn outside(value: f64, range: [f64; 2]) -> f64 {
    let distance = match value {
        v if v < range[0] => (range[0] / v).ln(),
        v if v > range[1] => (v / range[1]).ln(),
        _ => return 0.0,
    };
    ((distance / SOFT).powi(2) / 2.0).min(COUNTS)
}
