//! `[load]` and `[[load.case]]`: the kind of load and the keys that belong to it.

use super::raw::RawLoad;
use super::source::Source;
use super::value::{HasSpan, Spanned, Text};
use nalgebra::Vector3;
use stiffarm::error::{Code, Result, did_you_mean};
use stiffarm::model::load::{Axes, Load, LoadCase, Wrench};
use stiffarm::model::measurement::Role;
use stiffarm::model::robot::Robot;
use stiffarm::units::STANDARD_GRAVITY;

/// The kinds of load, and the keys that each of them has beside `kind`.
const KINDS: [(&str, &[&str]); 6] = [
    ("rope", &["magnitude_n", "anchor_mm"]),
    ("cylinder", &["magnitude_n", "acts", "anchor_mm", "direction", "axes"]),
    ("weight", &["magnitude_n", "mass_kg"]),
    ("wrench", &["force_n", "moment_nm", "axes"]),
    ("measured", &[]),
    ("cases", &["case"]),
];

/// What stands instead of a key where no kind has it beside the others that are given; `{}` is the force of the mass.
const INSTEAD: [(&str, &str); 7] = [
    ("mass_kg", "a mass on a rope pulls with its weight: magnitude_n = {}"),
    ("magnitude_n", "give the force as force_n = [x, y, z] in newtons"),
    (
        "anchor_mm",
        "remove it; where a rope or cylinder pulls, kind = \"rope\" or kind = \"cylinder\" takes it with magnitude_n",
    ),
    ("direction", "remove it: anchor_mm or force_n gives the direction"),
    ("acts", "remove it: it is what a cylinder does"),
    ("force_n", "give the size of the force as magnitude_n"),
    ("moment_nm", "remove it; a moment belongs to kind = \"wrench\", with force_n"),
];

/// The two kinds of axes of a wrench.
const AXES_HINT: &str = "axes = \"base\" (fixed) or axes = \"tool\" (turning with the flange)";

/// What every load case has beside the keys of its kind.
const OF_A_CASE: [&str; 2] = ["name", "loading_point_mm"];

/// A table that describes a load.
struct Table<'a> {
    source: &'a Source<'a>,
    at: &'a Spanned<RawLoad>,
}

/// The load of `robot`, whose direction of gravity a weight follows.
pub(super) fn load(source: &Source<'_>, table: &Option<Spanned<RawLoad>>, robot: &Robot) -> Result<Load> {
    let hint =
        "add a table [load] with kind = \"rope\", \"cylinder\", \"weight\", \"wrench\", \"measured\" or \"cases\"";
    let at = source.required_table(table, "load", hint)?;
    let table = Table { source, at };
    let (kind, keys) = table.kind("")?;
    table.refuse_foreign_keys(kind, keys, &[])?;
    match kind {
        "cases" => Ok(Load::Cases(table.cases(robot)?)),
        _ => table.single(kind, robot),
    }
}

impl Table<'_> {
    /// A key that must be there.
    fn required<'v, T>(&self, value: &'v Option<T>, name: &str, hint: &str) -> Result<&'v T> {
        self.source.required(self.at, value, name, hint)
    }

    /// The kind of load that is given, which is not `without`, and its keys.
    fn kind(&self, without: &str) -> Result<(&'static str, &'static [&'static str])> {
        let source = self.source;
        let kinds: Vec<&(&str, &[&str])> = KINDS.iter().filter(|(k, _)| *k != without).collect();
        let names: Vec<String> = kinds.iter().map(|(name, _)| format!("\"{name}\"")).collect();
        let hint = format!("kind is one of {}", names.join(", "));
        let kind = self.required(&self.at.get().kind, "kind", &hint)?;
        match kinds.iter().find(|(name, _)| name == kind.get()) {
            Some((name, keys)) => Ok((name, keys)),
            None => {
                let message = format!("Loads of kind \"{}\" are not known.", kind.get());
                let nearest = did_you_mean(kind.get(), kinds.iter().map(|(name, _)| *name));
                let error = source.error(Code::InvalidValue, kind, message);
                Err(error.hint(nearest.unwrap_or(hint)))
            }
        }
    }

    /// A load of one of the kinds that are not several.
    fn single(&self, kind: &str, robot: &Robot) -> Result<Load> {
        match kind {
            "rope" => self.rope(),
            "cylinder" => self.cylinder(),
            "weight" => Ok(Load::Weight { magnitude: self.weight()?, direction: *robot.gravity_direction() }),
            "wrench" => self.wrench(),
            _ => Ok(Load::Measured),
        }
    }

    /// `[[load.case]]`: each has a name, a kind, and may have a loading point of its own.
    fn cases(&self, robot: &Robot) -> Result<Vec<LoadCase>> {
        let hint = "add [[load.case]] with name and kind for each load that a posture is measured under";
        let list = self.required(&self.at.get().case, "case", hint)?;
        let mut cases: Vec<LoadCase> = Vec::new();
        for at in list.get() {
            let source = self.source;
            let case = Table { source, at }.case(robot, &cases)?;
            cases.push(case);
        }
        if cases.len() < 2 {
            let message = "Load cases are several, and fewer than two are given.";
            let key = self.source.path_in(self.at, "case");
            let error = self.source.error_at(Code::TooFewData, &key, list.span(), message);
            return Err(error.hint("add another [[load.case]], or put the only load into [load]"));
        }
        Ok(cases)
    }

    fn case(&self, robot: &Robot, others: &[LoadCase]) -> Result<LoadCase> {
        let (source, raw) = (self.source, self.at.get());
        let hint = "give the load case a name: name = \"left\"";
        let raw_name = self.required(&raw.name, "name", hint)?;
        let other_names = others.iter().map(|case| case.name.as_str());
        let name = source.unique_name(raw_name, other_names)?;
        // States of readings are told by these names.
        let refused = |message: String| {
            let error = source.error(Code::InvalidValue, raw_name, message);
            Err(error.hint("states of readings are named after load cases: \"left\", or \"left-2\" for another time"))
        };
        if Role::of(&name) != Role::Loaded {
            return refused(format!("\"{name}\" names a state without load, not a load case."));
        }
        let taken = |case: &&LoadCase| {
            let new_case = LoadCase { name: name.clone(), ..(*case).clone() };
            case.is_of(&name) || new_case.is_of(&case.name)
        };
        if let Some(other) = others.iter().find(taken) {
            return refused(format!("\"{name}\" and \"{}\" cannot be told apart as names of states.", other.name));
        }
        let (kind, keys) = self.kind("cases")?;
        if kind == "measured" {
            let message = "A load case is known before it is measured.";
            let span = raw.kind.as_ref().map_or(self.at.span(), Spanned::span);
            let key = source.path_in(self.at, "kind");
            let error = source.error_at(Code::Conflict, &key, span, message);
            return Err(error.hint("set [load] kind = \"measured\" and give the forces with the readings"));
        }
        self.refuse_foreign_keys(kind, keys, &OF_A_CASE)?;
        let loading_point = source.optional(&raw.loading_point_mm, Source::vector)?;
        Ok(LoadCase { name, load: self.single(kind, robot)?, loading_point })
    }

    /// A key of another kind of load would be ignored; that is refused.
    fn refuse_foreign_keys(&self, kind: &str, keys: &[&str], more: &[&str]) -> Result<()> {
        let is_known = |key: &str| key == "kind" || keys.contains(&key) || more.contains(&key);
        self.source.refuse_others(self.at, is_known, |key| {
            // Another kind is a way only where it has what else is given, too.
            let present_keys = self.source.keys(self.at);
            let takes = |keys: &[&str]| {
                let mut load_keys = present_keys.iter().filter(|(_, other)| keys_of_a_load(other));
                load_keys.all(|(_, other)| keys.contains(other))
            };
            let owners = KINDS.iter().filter(|(_, keys)| keys.contains(&key) && takes(keys));
            let owners: Vec<String> = owners.map(|(name, _)| format!("\"{name}\"")).collect();
            let instead = INSTEAD.iter().find(|(refused, _)| *refused == key);
            let hint = match (&owners[..], instead) {
                ([], Some((_, hint))) => {
                    let mass = self.at.get().mass_kg.as_ref();
                    let force = mass.and_then(|mass| self.source.positive(mass).ok());
                    let force = force.map(|kg| format!("{:.1}", kg * STANDARD_GRAVITY));
                    hint.replace("{}", force.as_deref().unwrap_or("9.80665 · kg"))
                }
                (owners, _) => of_owners(key, owners),
            };
            (format!("A load of kind \"{kind}\" has no {key}."), hint)
        })
    }

    fn magnitude(&self) -> Result<f64> {
        let hint = "give the force in newtons: magnitude_n = 500";
        let value = self.required(&self.at.get().magnitude_n, "magnitude_n", hint)?;
        self.source.positive(value)
    }

    /// The force of a weight, given as such or by its mass.
    fn weight(&self) -> Result<f64> {
        let (source, raw) = (self.source, self.at.get());
        let Some(mass) = &raw.mass_kg else {
            return self.magnitude();
        };
        if raw.magnitude_n.is_some() {
            let message = "The weight is given twice: magnitude_n is there already.";
            let error = source.error(Code::Conflict, mass, message);
            return Err(error.hint("keep one of magnitude_n and mass_kg"));
        }
        Ok(source.positive(mass)? * STANDARD_GRAVITY)
    }

    fn rope(&self) -> Result<Load> {
        let (source, raw) = (self.source, self.at.get());
        let magnitude = self.magnitude()?;
        let hint = "give the rope's fixed end: anchor_mm = [x, y, z] in the base frame";
        let anchor = source.vector(self.required(&raw.anchor_mm, "anchor_mm", hint)?)?;
        Ok(Load::Rope { anchor, magnitude })
    }

    /// A cylinder or screw: towards or away from its other end, or along a direction.
    fn cylinder(&self) -> Result<Load> {
        let (source, raw) = (self.source, self.at.get());
        let size = self.magnitude()?;
        let hint = "acts = \"pulls\" or acts = \"pushes\": what the cylinder does to the robot";
        let acts = self.required(&raw.acts, "acts", hint)?;
        let magnitude = match acts.get().as_str() {
            "pulls" => size,
            "pushes" => -size,
            other => {
                let message = format!("A cylinder \"pulls\" or \"pushes\", got \"{other}\".");
                let nearest = did_you_mean(other, ["pulls", "pushes"]);
                let error = source.error(Code::InvalidValue, acts, message);
                return Err(error.hint(nearest.unwrap_or_else(|| hint.to_string())));
            }
        };
        let ways = "give its other end (anchor_mm = [x, y, z], base frame), or the direction of its pull \
                (direction = [x, y, z] with axes) where it is guided";
        let list = match (&raw.anchor_mm, &raw.direction) {
            (Some(_), Some(direction)) => {
                let message = "The cylinder's line is given twice: anchor_mm is there already.";
                let error = source.error(Code::Conflict, direction, message);
                return Err(error.hint("keep one of anchor_mm and direction"));
            }
            (Some(anchor), None) => {
                if let Some(axes) = &raw.axes {
                    let message = "A cylinder with anchor_mm has no axes: the anchor is in the base frame.";
                    let error = source.error(Code::Conflict, axes, message);
                    return Err(error.hint("remove it, or give direction instead of anchor_mm"));
                }
                let anchor = source.vector(anchor)?;
                return Ok(Load::Rope { anchor, magnitude });
            }
            (None, list) => self.required(list, "direction", ways)?,
        };
        let Some(direction) = source.vector(list)?.try_normalize(0.0) else {
            let message = "The direction is zero.";
            let error = source.error(Code::InvalidValue, list, message);
            return Err(error.hint("give the direction of the cylinder's pull, of any length: direction = [0, 0, 1]"));
        };
        let raw_axes = self.required(&raw.axes, "axes", AXES_HINT)?;
        Ok(Load::Constant { wrench: Wrench::force(direction * magnitude), axes: axes(source, raw_axes)? })
    }

    fn wrench(&self) -> Result<Load> {
        let (source, raw) = (self.source, self.at.get());
        let hint = "give the force on the robot: force_n = [x, y, z] in newtons";
        let raw_force = self.required(&raw.force_n, "force_n", hint)?;
        let force = source.vector(raw_force)?;
        let moment = source.optional(&raw.moment_nm, Source::vector)?;
        let moment = moment.unwrap_or_default();
        if force == Vector3::zeros() && moment == Vector3::zeros() {
            let message = "Force and moment are zero: nothing loads the robot.";
            return Err(source.error(Code::InvalidValue, raw_force, message));
        }
        let raw_axes = self.required(&raw.axes, "axes", AXES_HINT)?;
        let axes = axes(source, raw_axes)?;
        Ok(Load::Constant { wrench: Wrench { force, moment }, axes })
    }
}

/// True for a key that says what a load is, not what kind or name it has.
fn keys_of_a_load(key: &str) -> bool {
    KINDS.iter().any(|(_, keys)| keys.contains(&key))
}

/// Where the kinds that have a key stand, to which it belongs.
fn of_owners(key: &str, owners: &[String]) -> String {
    match owners {
        [] if key == "loading_point_mm" => "it belongs into [tool], or into one of several [[load.case]]".to_string(),
        [] => "it belongs into [[load.case]], with [load] kind = \"cases\"".to_string(),
        _ => format!("remove it, or set kind = {}", owners.join(" or ")),
    }
}

/// The axes of a wrench.
pub(super) fn axes(source: &Source<'_>, raw_axes: &Text) -> Result<Axes> {
    match raw_axes.get().as_str() {
        "base" => Ok(Axes::Base),
        "tool" => Ok(Axes::Tool),
        other => {
            let message = format!("Axes \"{other}\" are not known.");
            let error = source.error(Code::InvalidValue, raw_axes, message);
            Err(error.hint(AXES_HINT))
        }
    }
}
