//! Faults of scale, planted one at a time, and whether they are named.

use super::experiments::Kind::{self, RopeAlone, RopeLoads, Sensor, WeightLoads};
use super::experiments::{Dice, Sound, scale_loads};
use stiffarm::findings::Severity;
use stiffarm::measure::screening::{Cause, Evidence, Suspicion, screen, screen_displacements};
use stiffarm::model::load::Load;

use Plant::{
    Anchor, Angles, Coordinates, Entry, Forces, LoadingPoint, Moments, Posture, Prior, Table, TableAndCell, Tool,
};

/// N in a kilogram-force and in a pound-force.
const KG: f64 = 9.806_65;
const LBF: f64 = 0.453_592_37 * KG;
const INCH: f64 = 25.4;
const RADIAN: f64 = 180.0 / std::f64::consts::PI;

/// A fault of the list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fault {
    /// Its name in the table.
    pub name: &'static str,
    /// Experiments it is planted in.
    pub kind: Kind,
    plant: Plant,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Plant {
    /// Loads of the table (or forces and moments of the sensor) typed this many times too small.
    Table(f64),
    /// Likewise, and the cell's own load with them; no number in a name.
    TableAndCell(f64),
    /// The load of one state typed this many times too small.
    Entry(f64),
    /// All loads of one posture.
    Posture(f64),
    /// Moments this many times too large.
    Moments(f64),
    /// Forces alone this many times too small.
    Forces(f64),
    /// Coordinates of all states, or of one, this many times too small.
    Coordinates(f64, bool),
    /// Displacements, of all postures or of one, this many times too small.
    Displacements(f64, bool),
    /// The tool's measuring points this many times too close.
    Tool(f64),
    /// The anchor this many times too near.
    Anchor(f64),
    /// The loading point this many times too near to the flange.
    LoadingPoint(f64),
    /// Angles typed in radians, or in degrees under a heading in radians.
    Angles(f64),
    /// The prior this many times too small.
    Prior(f64),
    /// Load cases exchanged, in all postures or in one.
    Cases(bool),
}

const fn fault(name: &'static str, kind: Kind, plant: Plant) -> Fault {
    Fault { name, kind, plant }
}

/// Every fault.
pub const FAULTS: [Fault; 33] = [
    fault("kg for N, table and cell alike", RopeLoads, TableAndCell(KG)),
    fault("kg for N, the cell's load alone", RopeAlone, TableAndCell(KG)),
    fault("kg for N, displacements", Kind::Displacements, TableAndCell(KG)),
    fault("kg for N, load_n", RopeLoads, Table(KG)),
    fault("kg for N, load_n of weights", WeightLoads, Table(KG)),
    fault("kg for N, sensor", Sensor, Table(KG)),
    fault("kg for N, sensor's forces alone", Sensor, Forces(KG)),
    fault("kg for N, load cases", Kind::Cases, TableAndCell(KG)),
    fault("lbf for N, table and cell alike", RopeLoads, TableAndCell(LBF)),
    fault("lbf for N, load_n", RopeLoads, Table(LBF)),
    fault("lbf for N, sensor", Sensor, Table(LBF)),
    fault("kN for N, table and cell alike", WeightLoads, TableAndCell(1e3)),
    fault("kN for N, load_n", RopeLoads, Table(1e3)),
    fault("kN for N, sensor", Sensor, Table(1e3)),
    fault("one load, 50 for 500", RopeLoads, Entry(10.0)),
    fault("one load, 5000 for 500", RopeLoads, Entry(0.1)),
    fault("one weight, 50 for 500", WeightLoads, Entry(10.0)),
    fault("one load in kg", RopeLoads, Entry(KG)),
    fault("one posture's loads in lbf", RopeLoads, Posture(LBF)),
    fault("one posture's sensor in kg", Sensor, Posture(KG)),
    fault("moments in N·mm", Sensor, Moments(1e3)),
    fault("coordinates in m", RopeLoads, Coordinates(1e3, true)),
    fault("coordinates in inches", Sensor, Coordinates(INCH, true)),
    fault("coordinates of one state in inches", RopeLoads, Coordinates(INCH, false)),
    fault("displacements in m", Kind::Displacements, Plant::Displacements(1e3, true)),
    fault("displacements in inches", Kind::Displacements, Plant::Displacements(INCH, true)),
    fault("displacements in µm", Kind::Displacements, Plant::Displacements(1e-3, true)),
    fault("one posture in inches", Kind::Displacements, Plant::Displacements(INCH, false)),
    fault("tool points in inches", RopeLoads, Tool(INCH)),
    fault("anchor in m", RopeLoads, Anchor(1e3)),
    fault("angles in radians", RopeLoads, Angles(RADIAN)),
    fault("prior in N·m/deg", RopeLoads, Prior(RADIAN)),
    fault("load cases exchanged", Kind::Cases, Plant::Cases(true)),
];

/// Faults beside the list.
pub const OTHERS: [Fault; 5] = [
    fault("loading point in m", RopeLoads, LoadingPoint(1e3)),
    fault("load cases of one posture exchanged", Kind::Cases, Plant::Cases(false)),
    fault("angles of displacements in radians", Kind::Displacements, Angles(RADIAN)),
    fault("prior in N·m per minute of arc", Sensor, Prior(60.0 * RADIAN)),
    fault("prior in N·mm/rad", RopeLoads, Prior(1e-3)),
];

/// What must be found.
pub struct Expected {
    causes: Vec<Cause>,
    factor: Option<f64>,
    posture: Option<String>,
    state: Option<String>,
}

impl Fault {
    /// Plants the fault.
    pub fn plant(&self, sound: &mut Sound, dice: &mut Dice) -> Expected {
        let expect = |cause: Cause, factor: f64| Expected {
            causes: vec![cause],
            factor: Some(factor),
            posture: None,
            state: None,
        };
        let posture = dice.below(sound.table.postures.len());
        let name = sound.table.postures[posture].posture.name.clone();
        match self.plant {
            Plant::Table(f) => {
                each_load(sound, |_, _| 1.0 / f);
                expect(Cause::LoadUnits, f)
            }
            Plant::TableAndCell(f) => {
                each_load(sound, |_, _| 1.0 / f);
                scale_loads(&mut sound.cell.setup.load, 1.0 / f);
                unname(sound);
                expect(Cause::LoadUnits, f)
            }
            Plant::Entry(f) => {
                let states = &sound.table.postures[posture].states;
                let loaded: Vec<usize> = (0..states.len())
                    .filter(|s| !states[*s].state.contains("load-") && is_loaded(&states[*s].state))
                    .chain((0..states.len()).filter(|s| is_loaded(&states[*s].state)))
                    .collect();
                let s = loaded[dice.below(loaded.len())];
                let state = states[s].state.clone();
                each_load(sound, |p, at| if (p, at) == (posture, s) { 1.0 / f } else { 1.0 });
                Expected { posture: Some(name), state: Some(state), ..expect(Cause::LoadEntry, f) }
            }
            Plant::Posture(f) => {
                each_load(sound, |p, _| if p == posture { 1.0 / f } else { 1.0 });
                Expected { posture: Some(name), ..expect(Cause::LoadEntry, f) }
            }
            Plant::Moments(f) => {
                for state in sound.table.postures.iter_mut().flat_map(|p| &mut p.states) {
                    if let Some(wrench) = &mut state.wrench {
                        wrench.moment *= f;
                    }
                }
                expect(Cause::MomentUnits, 1.0 / f)
            }
            Plant::Forces(f) => {
                for state in sound.table.postures.iter_mut().flat_map(|p| &mut p.states) {
                    if let Some(wrench) = &mut state.wrench {
                        wrench.force /= f;
                    }
                }
                expect(Cause::LoadUnits, f)
            }
            Plant::Coordinates(f, all) => {
                let state = dice.below(sound.table.postures[posture].states.len());
                for (p, row) in sound.table.postures.iter_mut().enumerate() {
                    for (s, state_of) in row.states.iter_mut().enumerate() {
                        if all || (p, s) == (posture, state) {
                            state_of.readings.iter_mut().for_each(|r| r.position /= f);
                        }
                    }
                }
                Expected { posture: (!all).then_some(name), ..expect(Cause::Units, 1.0 / f) }
            }
            Plant::Displacements(f, all) => {
                let measured = sound.displacements.iter_mut().flatten();
                for measurement in measured.filter(|m| all || m.posture.name == name) {
                    measurement.displacements.iter_mut().for_each(|d| d.value /= f);
                }
                Expected { posture: (!all).then_some(name), ..expect(Cause::DisplacementUnits, f) }
            }
            Plant::Tool(f) => {
                for point in &mut sound.cell.setup.tool.measuring_points {
                    point.position /= f;
                }
                Expected { factor: Some(f), ..expect(Cause::ToolUnits, f) }
            }
            Plant::Anchor(f) => {
                if let Load::Rope { anchor, .. } = &mut sound.cell.setup.load {
                    *anchor /= f;
                }
                expect(Cause::AnchorUnits, f)
            }
            Plant::LoadingPoint(f) => {
                sound.cell.setup.tool.loading_point /= f;
                expect(Cause::LoadingPointUnits, f)
            }
            Plant::Angles(f) => {
                for row in &mut sound.table.postures {
                    row.posture.q.iter_mut().for_each(|q| *q /= f);
                }
                for measurement in sound.displacements.iter_mut().flatten() {
                    measurement.posture.q.iter_mut().for_each(|q| *q /= f);
                }
                Expected { factor: None, ..expect(Cause::Radians, f) }
            }
            Plant::Prior(f) => {
                for k in sound.cell.prior.iter_mut().flatten() {
                    *k /= f;
                }
                expect(Cause::PriorUnits, f)
            }
            Plant::Cases(all) => {
                for (p, row) in sound.table.postures.iter_mut().enumerate() {
                    for state in row.states.iter_mut().filter(|_| all || p == posture) {
                        state.state = match state.state.as_str() {
                            "left" => "right".to_string(),
                            "right" => "left".to_string(),
                            other => other.to_string(),
                        };
                    }
                }
                Expected { factor: None, posture: (!all).then_some(name), ..expect(Cause::ExchangedLoadCases, 1.0) }
            }
        }
    }
}

fn is_loaded(state: &str) -> bool {
    !state.starts_with("unloaded") && !state.starts_with("preload")
}

/// Multiplies loads and wrenches by what `factor` says for posture and state; three
/// digits after the point are typed.
fn each_load(sound: &mut Sound, factor: impl Fn(usize, usize) -> f64) {
    for (p, row) in sound.table.postures.iter_mut().enumerate() {
        for (s, state) in row.states.iter_mut().enumerate() {
            let factor = factor(p, s);
            state.load = state.load.map(|l| (l * factor * 1e3).round() / 1e3);
            if let Some(wrench) = &mut state.wrench {
                wrench.force *= factor;
                wrench.moment *= factor;
            }
        }
    }
    for (p, measurement) in sound.displacements.iter_mut().flatten().enumerate() {
        if let Some(wrench) = &mut measurement.wrench {
            wrench.force *= factor(p, 1);
            wrench.moment *= factor(p, 1);
        }
    }
}

/// Takes the numbers out of the names of states.
fn unname(sound: &mut Sound) {
    for state in sound.table.postures.iter_mut().flat_map(|p| &mut p.states) {
        for (prefix, name) in [("load-", "full"), ("up-", "up-some"), ("down-", "down-some")] {
            if state.state.starts_with(prefix) {
                state.state = name.to_string();
            }
        }
    }
    sound.is_named = false;
}

/// How a fault came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Named, and nothing else beside it.
    Alone,
    /// Named first, with other explanations.
    First,
    /// Among the explanations named.
    Among,
    /// Something else was said.
    Wrong,
    /// Nothing was said.
    Silent,
}

/// What screening says, and how that compares with what must be found.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The outcome.
    pub outcome: Outcome,
    /// It rests on the prior alone.
    pub by_prior: bool,
    /// The right finding is serious.
    pub is_serious: bool,
    /// Other findings beside it.
    pub beside: usize,
    /// All sentences.
    pub said: String,
}

/// Screens an experiment.
pub fn findings(sound: &Sound) -> (Vec<Suspicion>, Vec<stiffarm::findings::Finding>) {
    let screening = match &sound.displacements {
        Some(measured) => screen_displacements(&sound.cell, measured),
        None => screen(&sound.cell, &sound.table, None),
    };
    let screening = screening.expect("a screening");
    (screening.suspicions, screening.findings)
}

/// Screens an experiment with a fault.
pub fn judge(sound: &Sound, expected: &Expected) -> Judged {
    let (suspicions, findings) = findings(sound);
    let said: Vec<&str> = findings.iter().map(|f| f.sentence.as_str()).collect();
    let place = |s: &Suspicion| {
        expected.posture.as_ref().is_none_or(|p| s.postures == [p.clone()])
            && expected.state.as_ref().is_none_or(|st| s.states.is_empty() || s.states == [st.clone()])
    };
    let same = |f: f64| expected.factor.is_none_or(|e| (f / e - 1.0).abs() < 1e-4);
    let right = |s: &&Suspicion| {
        expected.causes.contains(&s.cause) && place(s) && (expected.factor.is_none() || s.factor.is_some_and(same))
    };
    let number = |f: f64| match f {
        f if (f - KG).abs() < 1e-3 => "factor 9.81".to_string(),
        f if (f - LBF).abs() < 1e-3 => "factor 4.448".to_string(),
        f if f < 1.0 => format!("factor 1/{:.0}", 1.0 / f),
        f if (f - RADIAN).abs() < 1e-3 => "factor 57.3".to_string(),
        f if f == INCH => "factor 25.4".to_string(),
        f => format!("factor {f:.0}"),
    };
    let factor_text = expected.factor.map(number).unwrap_or_default();
    let among =
        |s: &&Suspicion| place(s) && s.factor.is_some() && s.alternatives.iter().any(|a| a.ends_with(&factor_text));
    let first = suspicions.iter().position(|s| right(&s));
    let second = suspicions.iter().position(|s| among(&s));
    let outcome = match (first, second, suspicions.len()) {
        (Some(i), _, _) if suspicions[i].alternatives.is_empty() => Outcome::Alone,
        (Some(_), _, _) => Outcome::First,
        (None, Some(_), _) => Outcome::Among,
        (None, None, 0) => Outcome::Silent,
        (None, None, _) => Outcome::Wrong,
    };
    let index = first.or(second);
    Judged {
        outcome,
        by_prior: index.is_some_and(|i| suspicions[i].evidence == Some(Evidence::Prior)),
        is_serious: index.is_some_and(|i| findings[i].severity == Severity::Serious),
        beside: suspicions.len() - usize::from(index.is_some()),
        said: said.join(" | "),
    }
}
