//! The text of a URDF: its elements, their attributes, and faults with their places.

use super::xml::{commands, parsed};
use roxmltree::{Document, Node};
use std::ops::Range;
use stiffarm::error::{Code, Error, Result};
use stiffarm::units::Sense;

/// An element.
pub(super) type Element<'s> = Node<'s, 's>;

/// A text with its elements.
pub(super) struct Source<'a> {
    file: &'a str,
    text: &'a str,
    /// Bytes before the first element or declaration: XML allows none, people leave an empty line there.
    blank: usize,
    document: Document<'a>,
}

impl<'a> Source<'a> {
    /// Reads the elements.
    ///
    /// # Errors
    /// Text that is no XML, or XML that is no URDF.
    pub(super) fn new(text: &'a str, file: &'a str) -> Result<Self> {
        let body = text.trim_start_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
        let blank = text.len() - body.len();
        let document = parsed(body).map_err(|(error, at)| {
            let at = blank + at;
            error.file(file).span(text, at..at)
        })?;
        let source = Source { file, text, blank, document };
        source.check_kind(body)?;
        Ok(source)
    }

    fn check_kind(&self, body: &str) -> Result<()> {
        let has_commands = |node: &Element<'_>| {
            let is_command = || body[node.range().start..].starts_with("<xacro:");
            node.is_element() && is_command() || node.attributes().any(|a| a.value().contains("${"))
        };
        if let Some(node) = self.document.descendants().find(has_commands) {
            return Err(self.placed(commands(), node.range()));
        }
        let root = self.root();
        match root.tag_name().name() {
            "robot" => Ok(()),
            name => {
                let message = format!("The outermost element is <{name}>, not <robot>.");
                Err(self.error(root, Code::Urdf, message))
            }
        }
    }

    /// The outermost element.
    pub(super) fn root(&self) -> Element<'_> {
        self.document.root_element()
    }

    /// The file's name.
    pub(super) fn file(&self) -> &str {
        self.file
    }

    fn placed(&self, error: Error, span: Range<usize>) -> Error {
        let span = span.start + self.blank..span.end + self.blank;
        error.file(self.file).span(self.text, span)
    }

    /// An error at an element.
    pub(super) fn error(&self, element: Element<'_>, code: Code, message: impl Into<String>) -> Error {
        self.placed(Error::new(code, message), element.range())
    }

    /// An error at an element `kind` of this name, for example `joint` `elbow`.
    pub(super) fn error_at(&self, kind: &str, name: &str, code: Code, message: impl Into<String>) -> Error {
        let named = |element: &Element<'_>| element.attribute("name") == Some(name);
        match self.children(self.root(), kind).find(named) {
            Some(element) => self.error(element, code, message),
            None => Error::new(code, message).file(self.file),
        }
    }

    /// The elements `name` right inside another one. What is of another name space than the root is none of URDF.
    pub(super) fn children<'s>(&'s self, element: Element<'s>, name: &str) -> impl Iterator<Item = Element<'s>> {
        let space = self.root().tag_name().namespace();
        element.children().filter(move |n| n.has_tag_name(name) && n.tag_name().namespace() == space)
    }

    /// The element `name` right inside another one, where there is one.
    ///
    /// # Errors
    /// A second one.
    pub(super) fn child<'s>(&'s self, element: Element<'s>, name: &str) -> Result<Option<Element<'s>>> {
        let mut children = self.children(element, name);
        let first = children.next();
        match children.next() {
            Some(second) => {
                let message = format!("<{}> has <{name}> twice.", element.tag_name().name());
                Err(self.error(second, Code::Duplicate, message))
            }
            None => Ok(first),
        }
    }

    /// An attribute that an element must have.
    ///
    /// # Errors
    /// It is not there, or empty.
    pub(super) fn required<'s>(&self, element: Element<'s>, name: &str) -> Result<&'s str> {
        let value = element.attribute(name).filter(|value| !value.is_empty());
        value.ok_or_else(|| self.missing(element, name))
    }

    fn missing(&self, element: Element<'_>, name: &str) -> Error {
        let message = format!("<{}> has no {name}.", element.tag_name().name());
        self.error(element, Code::Urdf, message)
    }

    /// The numbers of an attribute, where it is there. `unit` is the end of a name with that unit, or empty.
    ///
    /// # Errors
    /// Not `N` numbers, one that is not finite, or that cannot be meant.
    pub(super) fn numbers<const N: usize>(
        &self,
        element: Element<'_>,
        name: &str,
        unit: &str,
    ) -> Result<Option<[f64; N]>> {
        let Some(attribute) = element.attribute_node(name) else {
            return Ok(None);
        };
        let refused = |code, message: String| {
            let key = format!("{} {name}", element.tag_name().name());
            let error = Error::new(code, message).key(key);
            Err(self.placed(error, attribute.range_value()))
        };
        let words: Vec<&str> = attribute.value().split_whitespace().collect();
        let Ok(words) = <[&str; N]>::try_from(words) else {
            let many = match N {
                1 => "one number".to_string(),
                n => format!("{n} numbers"),
            };
            let message = format!("This must be {many}, got \"{}\".", attribute.value());
            return refused(Code::Urdf, message);
        };
        // URDF 1.2 may write no limit as infinity.
        let may_be_infinite = element.has_tag_name("limit");
        let sense = Sense::of(unit).filter(|_| !unit.is_empty());
        let mut values = [0.0; N];
        for (value, word) in values.iter_mut().zip(words) {
            match word.parse::<f64>() {
                Ok(number) if number.is_finite() => *value = number,
                Ok(number) if number.is_infinite() && may_be_infinite => *value = number,
                Ok(_) => {
                    let message = format!("\"{word}\" is not a finite number.");
                    return refused(Code::NotFinite, message);
                }
                Err(_) => return refused(Code::Urdf, format!("\"{word}\" is not a number.")),
            }
            if let Some(message) = sense.and_then(|sense| sense.refuse(*value)) {
                return refused(Code::InvalidValue, message);
            }
        }
        Ok(Some(values))
    }

    /// Numbers that an element must have, as [`Source::numbers`].
    pub(super) fn required_numbers<const N: usize>(
        &self,
        element: Element<'_>,
        name: &str,
        unit: &str,
    ) -> Result<[f64; N]> {
        let numbers = self.numbers(element, name, unit)?;
        numbers.ok_or_else(|| self.missing(element, name))
    }

    /// One number of an attribute, as [`Source::numbers`].
    pub(super) fn number(&self, element: Element<'_>, name: &str, unit: &str) -> Result<Option<f64>> {
        Ok(self.numbers(element, name, unit)?.map(|[value]| value))
    }
}
