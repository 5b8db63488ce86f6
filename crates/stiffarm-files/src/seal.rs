//! The seal of a saved result: hashes that hold whatever a program makes of layout, order of
//! keys and spelling of numbers, and break with any value.

use super::table::sha256_hex;
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt;
use stiffarm::error::{Code, Error, Result};

/// Key path of what later commands calculate with.
pub(super) const SECTION: &str = "result.sealed";
/// Key of the seal.
const SEAL: &str = "seal";
/// Key of the words that make the result again: those of a command line or of a call from Python, so that
/// one result has one seal.
const ARGUMENTS: &str = "arguments";

/// What a saved result was when it was written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Seal {
    /// SHA-256 of all of the file but the seal and `arguments`: of its values, not of their layout.
    pub file: String,
    /// The same of `result.sealed`, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sealed: Option<String>,
}

/// The way to the section.
#[derive(Default, Deserialize)]
struct Parts {
    #[serde(default)]
    result: Section,
}

#[derive(Default, Deserialize)]
struct Section {
    #[serde(default)]
    sealed: Option<Node>,
}

impl Seal {
    fn of(mut all: BTreeMap<String, Node>, parts: Parts) -> Self {
        all.remove(ARGUMENTS);
        Seal { file: sha256_hex(&Node::object(all).0), sealed: parts.result.sealed.map(|node| sha256_hex(&node.0)) }
    }

    /// The seal of a result by its text.
    ///
    /// # Errors
    /// A text that is no JSON.
    pub(super) fn of_text(text: &str) -> Result<Self> {
        let all = serde_json::from_str(text).map_err(|e| {
            let message = format!("The result cannot be sealed: {e}.");
            Error::new(Code::Internal, message)
        })?;
        let parts = serde_json::from_str(text);
        Ok(Seal::of(all, parts.unwrap_or_default()))
    }
}

/// Takes the seal off a saved result.
///
/// # Errors
/// No seal, or one that does not fit: something was changed after it was written.
pub(super) fn unseal(json: &mut Value) -> Result<()> {
    let fault = |message: &str| Error::new(Code::ResultFile, message);
    let seal = json.as_object_mut().and_then(|map| map.remove(SEAL));
    let Some(Ok(seal)) = seal.map(serde_json::from_value::<Seal>) else {
        let message = "This result has no seal: an earlier version wrote it, or the seal was taken out.";
        return Err(fault(message).key(SEAL).hint("make it again with this version, for a stiffness: identify again"));
    };
    let all = BTreeMap::deserialize(&*json).map_err(|e| fault(&format!("{e}.")))?;
    let computed = Seal::of(all, Parts::deserialize(&*json).unwrap_or_default());
    let changed = match (computed.sealed != seal.sealed, computed.file != seal.file) {
        (true, _) => fault("What is calculated with was changed after it was written.").key(SECTION),
        (_, true) if computed.sealed.is_some() => fault(
            "The file was changed after it was written, beside what is calculated with: its numbers no longer belong \
             together.",
        ),
        (_, true) => fault("The file was changed after it was written: its numbers no longer belong together."),
        _ => return Ok(()),
    };
    Err(changed
        .hint("take the file as the command wrote it, or make it again; layout and order of its keys may be others"))
}

/// A value in one spelling: bytes that end where the value ends. Lists and objects are
/// their hash, keys in order; numbers are 64 bits, 1 and 1.0 the same.
struct Node(Vec<u8>);

impl Node {
    fn text(out: &mut Vec<u8>, text: &str) {
        out.push(b's');
        out.extend((text.len() as u64).to_be_bytes());
        out.extend(text.as_bytes());
    }

    fn hashed(kind: u8, bytes: &[u8]) -> Self {
        let mut out = vec![kind];
        out.extend(sha256_hex(bytes).as_bytes());
        Node(out)
    }

    fn object(entries: BTreeMap<String, Node>) -> Self {
        let mut all = Vec::new();
        for (key, Node(value)) in entries {
            Node::text(&mut all, &key);
            all.extend(value);
        }
        Node::hashed(b'{', &all)
    }

    fn number(value: f64) -> Self {
        let mut out = vec![b'd'];
        // Adding zero turns −0 into 0.
        out.extend((value + 0.0).to_bits().to_be_bytes());
        Node(out)
    }
}

impl<'d> Deserialize<'d> for Node {
    fn deserialize<D: Deserializer<'d>>(from: D) -> std::result::Result<Self, D::Error> {
        from.deserialize_any(NodeVisitor)
    }
}

struct NodeVisitor;

impl<'d> Visitor<'d> for NodeVisitor {
    type Value = Node;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_unit<E>(self) -> std::result::Result<Node, E> {
        Ok(Node(vec![b'n']))
    }

    fn visit_bool<E>(self, value: bool) -> std::result::Result<Node, E> {
        Ok(Node(vec![if value { b't' } else { b'f' }]))
    }

    fn visit_i64<E>(self, value: i64) -> std::result::Result<Node, E> {
        Ok(Node::number(value as f64))
    }

    fn visit_u64<E>(self, value: u64) -> std::result::Result<Node, E> {
        Ok(Node::number(value as f64))
    }

    fn visit_f64<E>(self, value: f64) -> std::result::Result<Node, E> {
        Ok(Node::number(value))
    }

    fn visit_str<E>(self, value: &str) -> std::result::Result<Node, E> {
        let mut out = Vec::new();
        Node::text(&mut out, value);
        Ok(Node(out))
    }

    fn visit_seq<A: SeqAccess<'d>>(self, mut items: A) -> std::result::Result<Node, A::Error> {
        let mut all = Vec::new();
        while let Some(Node(item)) = items.next_element()? {
            all.extend(item);
        }
        Ok(Node::hashed(b'[', &all))
    }

    fn visit_map<A: MapAccess<'d>>(self, mut entries: A) -> std::result::Result<Node, A::Error> {
        let mut sorted = BTreeMap::new();
        while let Some((key, value)) = entries.next_entry::<String, Node>()? {
            sorted.insert(key, value);
        }
        Ok(Node::object(sorted))
    }
}
