//! The elements of an XML text with their places.
//!
//! urdf-rs reads the values, but says nowhere where a fault stands, overlooks
//! numbers that are none, and takes the stack it needs for elements inside
//! elements without end. What it is given has been through here.

use std::ops::Range;

/// Elements inside elements.
const DEEPEST: usize = 50;

/// Attributes of an element.
const MOST_ATTRIBUTES: usize = 50;

/// An element.
#[derive(Debug)]
pub(super) struct Tag<'t> {
    pub(super) name: &'t str,
    /// Names and values as they are written.
    pub(super) attributes: Vec<(&'t str, &'t str)>,
    /// From the first byte of its start to the last of its end.
    pub(super) span: Range<usize>,
    /// Elements around it.
    pub(super) depth: usize,
}

impl Tag<'_> {
    /// The value of an attribute as it is written.
    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        let mut attributes = self.attributes.iter();
        attributes.find(|(n, _)| *n == name).map(|(_, v)| *v)
    }
}

/// What is wrong, and the byte it stands at.
pub(super) type Fault = (String, usize);

/// The elements of `text` in the order of their starts; the first is the root.
///
/// # Errors
/// Text that is no XML.
pub(super) fn tags(text: &str) -> Result<Vec<Tag<'_>>, Fault> {
    let mut tags: Vec<Tag<'_>> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    let mut at = 0;
    while let Some(found) = text[at..].find('<') {
        let start = at + found;
        let rest = &text[start..];
        if let Some(length) = skipped(rest).map_err(|message| (message, start))? {
            at = start + length;
            continue;
        }
        if let Some(name) = rest.strip_prefix("</") {
            let length = name.find('>').ok_or_else(|| unclosed("tag", start))?;
            let name = name[..length].trim();
            at = start + length + 3;
            let Some(last) = open.pop() else {
                return Err((format!("</{name}> ends no element."), start));
            };
            if tags[last].name != name {
                let message = format!("</{name}> stands where </{}> must.", tags[last].name);
                return Err((message, start));
            }
            tags[last].span.end = at;
            continue;
        }
        if open.is_empty() && !tags.is_empty() {
            return Err(("A second element stands outside the first.".into(), start));
        }
        let (tag, is_empty, end) = opening(text, start, open.len())?;
        at = end;
        if !is_empty {
            open.push(tags.len());
        }
        if open.len() > DEEPEST {
            let message = format!("More than {DEEPEST} elements stand inside each other.");
            return Err((message, start));
        }
        tags.push(tag);
    }
    match open.last() {
        Some(last) => {
            let tag = &tags[*last];
            Err((format!("<{}> is not closed.", tag.name), tag.span.start))
        }
        None if tags.is_empty() => Err(("The text has no XML elements.".into(), 0)),
        None => Ok(tags),
    }
}

fn unclosed(what: &str, at: usize) -> Fault {
    (format!("A {what} begins here and does not end."), at)
}

/// Bytes of a comment, declaration, instruction or verbatim text at the start.
fn skipped(rest: &str) -> Result<Option<usize>, String> {
    let kinds = [
        ("<!--", "-->", "comment"),
        ("<![CDATA[", "]]>", "text"),
        ("<?", "?>", "instruction"),
        ("<!", ">", "declaration"),
    ];
    let Some((start, end, what)) = kinds.iter().find(|(start, ..)| rest.starts_with(start)) else {
        return Ok(None);
    };
    let length = rest[start.len()..].find(end);
    let length = length.ok_or_else(|| unclosed(what, 0).0)?;
    Ok(Some(start.len() + length + end.len()))
}

/// The start of an element at `start`, whether it is its end, too, and where it ends.
fn opening(text: &str, start: usize, depth: usize) -> Result<(Tag<'_>, bool, usize), Fault> {
    let in_name = |c: char| !c.is_whitespace() && !"/>=\"'<".contains(c);
    let word = |at: usize| {
        let rest = &text[at..];
        &rest[..rest.find(|c| !in_name(c)).unwrap_or(rest.len())]
    };
    let name = word(start + 1);
    if name.is_empty() {
        return Err(("< must be followed by a name.".into(), start));
    }
    let mut at = start + 1 + name.len();
    let mut attributes: Vec<(&str, &str)> = Vec::new();
    loop {
        let rest = text[at..].trim_start();
        at = text.len() - rest.len();
        let is_empty = rest.starts_with("/>");
        if is_empty || rest.starts_with('>') {
            let end = at + 1 + usize::from(is_empty);
            let tag = Tag {
                name,
                attributes,
                span: start..end,
                depth,
            };
            return Ok((tag, is_empty, end));
        }
        let key = word(at);
        if key.is_empty() {
            return Err((format!("<{name}> does not end."), start));
        }
        let rest = text[at + key.len()..].trim_start();
        let value = rest.strip_prefix('=').map(str::trim_start);
        let quote = value.and_then(|v| v.chars().next());
        let (Some(value), Some(quote @ ('"' | '\''))) = (value, quote) else {
            let message = format!("{key} needs a value in quotes: {key}=\"…\".");
            return Err((message, at));
        };
        let length = value[1..].find(quote);
        let length = length.ok_or_else(|| (format!("The value of {key} does not end."), at))?;
        let value_at = text.len() - value.len() + 1;
        let value = &value[1..][..length];
        if value.contains('<') {
            return Err((format!("The value of {key} does not end."), at));
        }
        if attributes.iter().any(|(other, _)| *other == key) {
            return Err((format!("{key} is given twice."), at));
        }
        if attributes.len() == MOST_ATTRIBUTES {
            let message = format!("<{name}> has more than {MOST_ATTRIBUTES} attributes.");
            return Err((message, at));
        }
        attributes.push((key, value));
        at = value_at + length + 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_have_their_places() {
        let text =
            "<?xml version='1.0'?><!-- <a> --><r x='1' y = \"2>\">\n<a/><b><![CDATA[<c>]]></b></r>";
        let found = tags(text).unwrap();
        let seen: Vec<(&str, usize)> = found.iter().map(|t| (t.name, t.depth)).collect();
        assert_eq!(seen, [("r", 0), ("a", 1), ("b", 1)]);
        assert_eq!(found[0].attribute("y"), Some("2>"));
        assert_eq!(&text[found[1].span.clone()], "<a/>");
        assert_eq!(&text[found[2].span.clone()], "<b><![CDATA[<c>]]></b>");
        assert_eq!(found[0].span.end, text.len());
    }

    #[test]
    fn what_is_no_xml_is_said() {
        let deep = "<a>".repeat(100_000);
        for text in [
            "",
            "hello",
            "<",
            "<a",
            "<a>",
            "<a></b>",
            "</a>",
            "<a/><b/>",
            "<a b>",
            "<a b=c/>",
            "<a b='c/>",
            "<a b='1' b='2'/>",
            "<!-- <a/>",
            "<a b='ß",
            "<ß",
            "<a><![CDATA[</a>",
            &deep,
        ] {
            let (message, at) = tags(text).map(|_| ()).unwrap_err();
            assert!(
                message.ends_with('.') && text.is_char_boundary(at),
                "{text}"
            );
        }
    }
}
