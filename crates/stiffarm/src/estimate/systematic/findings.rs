//! The common errors in sentences.

use super::{SystematicErrors, SystematicSource};
use crate::estimate::quantity::facts;
use crate::findings::{Finding, Severity, length, list, percent};
use crate::measure::Measured;

/// Readings that leave less than this of a size have bounded it.
const BOUNDED: f64 = 0.9;
/// Readings that show this many times the size contradict it.
const CONTRADICTED: f64 = 1.5;

/// What reflectors on the base have shown of its motion.
#[derive(Debug, Clone, Copy, PartialEq)]
enum BaseSeen {
    /// Nothing.
    No,
    /// Its shift.
    Shift,
    /// Shift and turn, in every posture.
    Turn,
}

/// What the readings are against which a source stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ReadingReference {
    base: BaseSeen,
    /// True where every displacement is against a preload.
    against_preload: bool,
}

impl ReadingReference {
    /// Of these readings.
    pub fn of(measured: &Measured) -> Self {
        ReadingReference { base: BaseSeen::of(measured), against_preload: measured.is_against_preload() }
    }
}

impl BaseSeen {
    /// What they have shown of these readings.
    fn of(measured: &Measured) -> Self {
        let motion = measured.reduction.as_ref().map(|r| r.base_motion.as_slice());
        match motion.unwrap_or_default() {
            [] => BaseSeen::No,
            all if all.iter().all(|m| m.turn_removed) => BaseSeen::Turn,
            _ => BaseSeen::Shift,
        }
    }
}

impl SystematicSource {
    /// The source in words.
    fn what(&self) -> &'static str {
        facts::named(&self.name).map_or("source", |facts| facts.what)
    }

    /// Its size in words.
    fn how_much(&self) -> String {
        match (self.unit.as_str(), self.name.as_str()) {
            _ if self.free => "identified beside the stiffness".to_string(),
            _ if self.doubtful => "as far off as the readings want it".to_string(),
            (_, "springs") => "with or without bearings and beams".to_string(),
            ("1", _) => percent(self.size),
            ("m", _) => format!("{} an axis", length(self.size)),
            ("N", _) => format!("{:.1} N an axis", self.size),
            ("rad", "lost-motion") => format!("{:.2} arc-minutes each joint", 60.0 * self.size.to_degrees()),
            ("rad", _) => format!("{:.2} mrad an axis", 1e3 * self.size),
            _ if self.size > 0.0 => format!("{:.1e} N·m/rad", 1.0 / self.size),
            _ => "rigid".to_string(),
        }
    }

    fn words(&self) -> String {
        format!("{} ({})", self.what(), self.how_much())
    }

    /// What would make it smaller.
    fn remedy(&self, seen: ReadingReference) -> &'static str {
        match (self.name.as_str(), seen.base) {
            ("lost-motion", _) if seen.against_preload => {
                "declare what the joints have as [uncertainty] lost_motion_arcmin; the preload keeps it out of k, and \
                 at work it acts again"
            }
            ("base-tilt", BaseSeen::Shift) => {
                "the reflectors on the base show its shift, not its tilt; three apart show that too"
            }
            ("base-tilt", BaseSeen::Turn) => {
                "the reflectors on the base have taken its tilt off; declare a stiffer base"
            }
            _ => facts::named(&self.name).map_or("", |facts| facts.better),
        }
    }
}

/// What matters.
pub(super) fn findings(systematic: &SystematicErrors, seen: ReadingReference) -> Vec<Finding> {
    let mut out = Vec::new();
    if let Some(force) = systematic.sources.first() {
        let assumed = if force.declared { "" } else { " (assumed)" };
        let message = format!(
            "A force that is read {} too large{assumed} makes every k {0} too large and shows in no residual.",
            percent(force.size)
        );
        let code = "force-scale";
        out.push(Finding::note(code, "uncertainty", message));
    }
    out.extend(systematic.sources.iter().filter_map(|source| seen_of(source, seen)));
    for source in &systematic.sources {
        let joints = largest_for(systematic, source);
        if !joints.is_empty() {
            let message = format!(
                "Of the systematic errors that the readings leave, {} is the largest for {}: {}.",
                source.words(),
                list(&joints),
                source.remedy(seen)
            );
            let code = "largest-common-error";
            out.push(Finding::note(code, &source.name, message));
        }
    }
    for (j, name) in systematic.joints.iter().enumerate() {
        let all = |source: &&SystematicSource| source.bounded[j].is_some_and(|b| b >= 1.0);
        if let Some(source) = systematic.sources.iter().find(all) {
            let message =
                format!("The {} can explain all of the give of {name}: {}.", source.words(), source.remedy(seen));
            let code = "common-error-explains-all";
            out.push(Finding::caution(code, name, message));
        }
    }
    out.extend(dominating(systematic, seen));
    let assumed = systematic.sources.iter().filter(|s| !s.declared);
    let assumed: Vec<String> = assumed.map(SystematicSource::words).collect();
    if !assumed.is_empty() {
        let message = format!("Assumed, not declared in [uncertainty]: {}.", list(&assumed));
        let code = "assumed-uncertainty";
        out.push(Finding::note(code, "uncertainty", message));
    }
    out
}

/// What is believed of postures whose approach the cell gives.
pub(super) fn reached_from_load() -> Finding {
    let message = "Each posture is taken as reached from the side of its load ([route] approach_deg): no reading shows \
                   lost motion, and none bounds it. Take the key out if they were not.";
    let code = "reached-from-load";
    Finding::note(code, "route.approach_deg", message)
}

/// What is believed of readings under a preload alone.
pub(super) fn not_read_unloaded() -> Finding {
    let message = "Differences are against a preload, and nothing was read unloaded before it: no reading shows lost \
                   motion, which acts again at work, and none bounds it. Read the points unloaded too.";
    let code = "lost-motion-not-seen";
    Finding::note(code, "preload", message)
}

/// What the readings say of a size.
fn seen_of(source: &SystematicSource, seen: ReadingReference) -> Option<Finding> {
    let remaining = source.remaining.filter(|_| !source.free)?;
    let (code, severity, message) = match remaining {
        left if left < BOUNDED => (
            "size-bounded",
            Severity::Note,
            format!("The readings bound {}: they leave {} of that.", source.words(), percent(left)),
        ),
        more if more > CONTRADICTED => (
            "size-contradicted",
            Severity::Caution,
            format!(
                "The residuals look like {:.1} times the {} that is {}: {}.",
                more,
                source.words(),
                if source.declared { "declared" } else { "assumed" },
                source.remedy(seen)
            ),
        ),
        _ => return None,
    };
    Some(Finding::new(code, severity, &source.name, message))
}

/// Joints for which a source is the largest, with what it leaves.
fn largest_for(systematic: &SystematicErrors, source: &SystematicSource) -> Vec<String> {
    let names = systematic.joints.iter().zip(&systematic.uncertainty).enumerate();
    names
        .filter(|(_, (_, uncertainty))| uncertainty.largest_source.as_ref() == Some(&source.name))
        .filter_map(|(j, (name, _))| Some(format!("{name} ({})", percent(source.bounded[j]?))))
        .collect()
}

/// Joints whose systematic errors are larger than the scatter of the readings.
fn dominating(systematic: &SystematicErrors, seen: ReadingReference) -> Option<Finding> {
    let (mut names, mut sources) = (Vec::new(), Vec::new());
    for (j, name) in systematic.joints.iter().enumerate() {
        let (Some(common), Some(statistical)) = (systematic.combined[j], systematic.statistical[j]) else {
            continue;
        };
        if common > statistical {
            names.push(name.as_str());
            sources.extend(systematic.uncertainty[j].largest_source.as_deref());
        }
    }
    let mut largest: Vec<&SystematicSource> = systematic.sources.iter().collect();
    let count = |s: &SystematicSource| sources.iter().filter(|name| **name == s.name).count();
    largest.sort_by_key(|source| std::cmp::Reverse(count(source)));
    let first = largest.first()?;
    if names.is_empty() {
        return None;
    }
    let all = names.len() == systematic.joints.len();
    let message = format!(
        "Systematic errors are larger than the scatter of the readings for {}. Largest for most: {}; {}.",
        if all { "every joint".to_string() } else { list(&names) },
        first.words(),
        first.remedy(seen)
    );
    let code = "common-error-dominates";
    // It stands on most sound experiments, and the table of the joints has it: what to do first is another's word.
    Some(Finding::note(code, "uncertainty", message))
}
