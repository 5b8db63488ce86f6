//! The text of a URDF, its faults with their places, and what urdf-rs makes of it.

use super::tags::{Tag, tags};
use crate::error::{Code, Error, Result, did_you_mean};
use crate::units::Sense;
use std::ops::Range;

/// A text with its elements.
pub(super) struct Source<'a> {
    file: &'a str,
    text: &'a str,
    tags: Vec<Tag<'a>>,
}

/// Attributes that are numbers: element, attribute, how many, and the unit by the end of
/// a name.
#[rustfmt::skip]
const NUMBERS: [(&str, &str, usize, &str); 16] = [
    ("origin", "xyz", 3, "m"),
    ("origin", "rpy", 3, "rad"),
    ("axis", "xyz", 3, "direction"),
    ("limit", "lower", 1, ""),
    ("limit", "upper", 1, ""),
    ("limit", "effort", 1, ""),
    ("limit", "velocity", 1, ""),
    ("mimic", "multiplier", 1, ""),
    ("mimic", "offset", 1, ""),
    ("box", "size", 3, "m"),
    ("cylinder", "radius", 1, "m"),
    ("cylinder", "length", 1, "m"),
    ("capsule", "radius", 1, "m"),
    ("capsule", "length", 1, "m"),
    ("sphere", "radius", 1, "m"),
    ("mesh", "scale", 3, ""),
];

/// Attributes that elements must have.
const REQUIRED: [(&str, &str); 14] = [
    ("link", "name"),
    ("joint", "name"),
    ("joint", "type"),
    ("parent", "link"),
    ("child", "link"),
    ("axis", "xyz"),
    ("mimic", "joint"),
    ("box", "size"),
    ("cylinder", "radius"),
    ("cylinder", "length"),
    ("capsule", "radius"),
    ("capsule", "length"),
    ("sphere", "radius"),
    ("mesh", "filename"),
];

/// Parts of links and joints that say nothing of kinematics and collisions; their faults
/// are none here.
const LEFT_OUT: [&str; 5] = [
    "visual",
    "inertial",
    "dynamics",
    "calibration",
    "safety_controller",
];

/// True for elements that are not read, with all that is in them.
fn is_left_out(tag: &Tag<'_>) -> bool {
    match tag.depth {
        0 => false,
        1 => tag.name != "link" && tag.name != "joint",
        _ => LEFT_OUT.contains(&tag.name),
    }
}

/// Joint types of URDF.
const JOINT_TYPES: [&str; 7] = [
    "revolute",
    "continuous",
    "prismatic",
    "fixed",
    "floating",
    "planar",
    "spherical",
];

impl<'a> Source<'a> {
    /// Reads the elements.
    ///
    /// # Errors
    /// Text that is no XML, or XML that is no URDF.
    pub(super) fn new(text: &'a str, file: &'a str) -> Result<Self> {
        let mut source = Source {
            file,
            text,
            tags: Vec::new(),
        };
        source.tags = tags(text).map_err(|(message, at)| {
            let error = source.error(Code::Urdf, at..at, message);
            error.hint("a URDF is an XML text: <robot name=\"…\"> … </robot>")
        })?;
        source.check_kind()?;
        for tag in source.read_tags() {
            source.check(tag)?;
        }
        Ok(source)
    }

    /// An error at the bytes `span`.
    fn error(&self, code: Code, span: Range<usize>, message: impl Into<String>) -> Error {
        let error = Error::new(code, message).file(self.file);
        error.span(self.text, span)
    }

    /// An error at an element `kind` of this name, for example `joint` `elbow`.
    pub(super) fn error_at(
        &self,
        kind: &str,
        name: &str,
        code: Code,
        message: impl Into<String>,
    ) -> Error {
        let own = |tag: &&Tag| tag.depth == 1 && tag.name == kind;
        let named = |tag: &&Tag| tag.attribute("name") == Some(name);
        match self.tags.iter().filter(own).find(named) {
            Some(tag) => self.error(code, tag.span.clone(), message),
            None => Error::new(code, message).file(self.file),
        }
    }

    /// The file's name.
    pub(super) fn file(&self) -> &str {
        self.file
    }

    /// Whether joint `name` gives limits.
    pub(super) fn has_limits(&self, name: &str) -> bool {
        let joint = self.tags.iter().find(|tag| {
            tag.depth == 1 && tag.name == "joint" && tag.attribute("name") == Some(name)
        });
        joint.is_some_and(|joint| {
            let inside = |tag: &&Tag| joint.span.contains(&tag.span.start);
            let limits = self.tags.iter().filter(inside).find(|t| t.name == "limit");
            limits.is_some_and(|limit| {
                limit.attribute("lower").is_some() || limit.attribute("upper").is_some()
            })
        })
    }

    /// The elements that are read: not those that say nothing here, nor what is in them.
    fn read_tags(&self) -> impl Iterator<Item = &Tag<'a>> {
        let mut until = 0;
        self.tags.iter().filter(move |tag| {
            if tag.span.start < until {
                return false;
            }
            let read = !is_left_out(tag);
            if !read {
                until = tag.span.end;
            }
            read
        })
    }

    fn check_kind(&self) -> Result<()> {
        let commands = |tag: &&Tag| {
            tag.name.starts_with("xacro:") || tag.attributes.iter().any(|(_, v)| v.contains("${"))
        };
        if let Some(tag) = self.tags.iter().find(commands) {
            let message = "The file has commands of xacro, which must be carried out first.";
            let error = self.error(Code::Unsupported, tag.span.clone(), message);
            return Err(
                error.hint("name the file ….xacro, or expand it yourself: xacro FILE > robot.urdf")
            );
        }
        match self.tags.first() {
            Some(root) if root.name != "robot" => {
                let message = format!("The outermost element is <{}>, not <robot>.", root.name);
                Err(self.error(Code::Urdf, root.span.clone(), message))
            }
            _ => Ok(()),
        }
    }

    fn check(&self, tag: &Tag<'_>) -> Result<()> {
        let at = |code: Code, message: String| self.error(code, tag.span.clone(), message);
        for (name, attribute) in REQUIRED {
            if tag.name == name && tag.attribute(attribute).is_none_or(str::is_empty) {
                let message = format!("<{name}> has no {attribute}.");
                return Err(at(Code::Urdf, message));
            }
        }
        // From version 1.2 on, what is left out has no limit.
        let has_version = |root: &Tag| root.attribute("version").is_some();
        if tag.name == "limit"
            && tag.attribute("velocity").is_none()
            && !self.tags.first().is_some_and(has_version)
        {
            let error = at(Code::Urdf, "<limit> has no velocity.".to_string());
            return Err(error.hint("a <limit> has lower, upper, effort and velocity"));
        }
        if tag.name == "origin" && tag.attribute("quat_xyzw").is_some() {
            let message = "An origin with quat_xyzw is not supported.".to_string();
            return Err(at(Code::Unsupported, message).hint("write its rotation as rpy"));
        }
        if let Some(kind) = tag.attribute("type").filter(|_| tag.name == "joint")
            && !JOINT_TYPES.contains(&kind)
        {
            let error = at(Code::Urdf, format!("There is no joint type \"{kind}\"."));
            let hint = did_you_mean(kind, JOINT_TYPES);
            return Err(error.hint(hint.unwrap_or_else(|| JOINT_TYPES.join(", "))));
        }
        let own = NUMBERS.iter().filter(|(name, ..)| tag.name == *name);
        for (name, attribute, count, unit) in own {
            let Some(text) = tag.attribute(attribute) else {
                continue;
            };
            let key = format!("{name} {attribute}");
            let words: Vec<&str> = text.split_whitespace().collect();
            if words.len() != *count {
                let message = format!("This must be {count} numbers, got \"{text}\".");
                let message = message.replace("1 numbers", "one number");
                return Err(at(Code::Urdf, message).key(key));
            }
            for word in words {
                let value: f64 = word.parse().map_err(|_| {
                    at(Code::Urdf, format!("\"{word}\" is not a number.")).key(key.clone())
                })?;
                // URDF 1.2 may write no limit as infinity.
                if !value.is_finite() && *name != "limit" || value.is_nan() {
                    let message = format!("\"{word}\" is not a finite number.");
                    return Err(at(Code::NotFinite, message).key(key));
                }
                let sense = Sense::of(unit).filter(|_| !unit.is_empty());
                if let Some(message) = sense.and_then(|sense| sense.refuse(value)) {
                    return Err(at(Code::InvalidValue, message).key(key));
                }
            }
        }
        Ok(())
    }

    /// The robot as urdf-rs reads it from what is left of the text.
    ///
    /// # Errors
    /// Elements that lack something.
    pub(super) fn robot(&self) -> Result<urdf_rs::Robot> {
        let mut text = String::with_capacity(self.text.len());
        let mut at = 0;
        for tag in &self.tags {
            if tag.span.start >= at && is_left_out(tag) {
                text += &self.text[at..tag.span.start];
                at = tag.span.end;
            }
        }
        text += &self.text[at..];
        urdf_rs::read_from_string(&text).map_err(|error| {
            let said = error.to_string();
            let said = said.trim_start_matches("custom: ");
            let message = format!("The URDF cannot be read: {said}.");
            let error = Error::new(Code::Urdf, message).file(self.file);
            let missing = said.strip_prefix("missing field `");
            match missing.and_then(|rest| rest.split('`').next()) {
                Some("parent" | "child") => error.hint("a <joint> has a <parent> and a <child>"),
                _ => error,
            }
        })
    }
}
