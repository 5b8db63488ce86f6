//! What the file's values are read from: unknown keys and values of the wrong kind, with their places.

use super::RawCell;
use crate::cell::source::Source;
use crate::cell::value::{Fixed, Number, Spanned};
use std::marker::PhantomData;
use std::ops::Range;
use stiffarm::error::{Code, Error, did_you_mean};
use toml::de::{DeTable, DeValue};

/// A value of the file and its key path; list entries count from 1.
pub(in crate::cell) struct Node<'v> {
    pub value: &'v toml::Spanned<DeValue<'v>>,
    pub path: String,
}

/// A table of the format: its path without indices, whether it is an array of tables, and the keys it knows.
pub(in crate::cell) struct Table {
    path: String,
    is_array: bool,
    keys: &'static [&'static str],
}

/// What a value of the file is read as.
pub(in crate::cell) trait Value: Sized {
    /// What must stand there, as messages name it.
    const KIND: &'static str;

    /// Nothing where it is something else, which is noted.
    fn read(node: &Node<'_>, reading: &mut Reading<'_>) -> Option<Self>;

    /// Adds the tables it is made of, this one of key `path` first.
    fn tables(path: &str, is_array: bool, all: &mut Vec<Table>) {
        let _ = (path, is_array, all);
    }
}

pub(super) const TABLE: &str = "a table";

/// Defines tables of the file: structs whose fields are all optional, `key: type [what its schema has beside the
/// type]`, and the name that the schema has for the table.
macro_rules! tables {
    ($($(#[$of_table:meta])* struct $name:ident as $title:tt {
        $($(#[$of_key:meta])* $key:ident: $kind:ty $([$($schema:tt)*])?,)*
    })*) => {$(
        $(#[$of_table])*
        #[derive(Debug)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = $title, deny_unknown_fields))]
        pub(in crate::cell) struct $name {
            $(
                $(#[$of_key])*
                $(#[cfg_attr(feature = "schema", schemars($($schema)*))])?
                pub $key: Option<$kind>,
            )*
        }

        const _: () = {
            use crate::cell::raw::read::{Node, Reading, TABLE, Table, Value, add_table, join};

            impl Value for $name {
                const KIND: &'static str = TABLE;

                fn read(node: &Node<'_>, reading: &mut Reading<'_>) -> Option<Self> {
                    let table = reading.table(node, &[$(stringify!($key)),*])?;
                    Some($name { $($key: reading.key(node, table, stringify!($key)),)* })
                }

                fn tables(path: &str, is_array: bool, all: &mut Vec<Table>) {
                    if add_table(path, is_array, &[$(stringify!($key)),*], all) {
                        $(<$kind as Value>::tables(&join(path, stringify!($key)), false, all);)*
                    }
                }
            }
        };
    )*};
}

/// Notes a table; false where no format has tables that deep, as of load cases in load cases.
pub(super) fn add_table(path: &str, is_array: bool, keys: &'static [&'static str], all: &mut Vec<Table>) -> bool {
    let is_one = path.matches('.').count() < 2;
    if is_one {
        let path = path.to_string();
        all.push(Table { path, is_array, keys });
    }
    is_one
}

/// A file that is being read.
pub(in crate::cell) struct Reading<'s> {
    source: &'s Source<'s>,
    /// What is wrong with it.
    pub errors: Vec<Error>,
    /// Key paths of what was read, each before those inside it.
    pub paths: Vec<(Range<usize>, String)>,
}

impl<'s> Reading<'s> {
    pub(in crate::cell) fn of(source: &'s Source<'s>) -> Self {
        Reading { source, errors: Vec::new(), paths: Vec::new() }
    }

    /// The value of a key of a table, where it is there and can be read.
    pub(super) fn key<T: Value>(&mut self, node: &Node<'_>, table: &DeTable<'_>, name: &str) -> Option<T> {
        self.inner(table.get(name)?, join(&node.path, name))
    }

    /// What stands inside another value.
    pub(super) fn inner<T: Value>(&mut self, value: &toml::Spanned<DeValue<'_>>, path: String) -> Option<T> {
        self.paths.push((value.span(), path.clone()));
        T::read(&Node { value, path }, self)
    }

    /// The keys of a table, those that it does not know noted.
    pub(super) fn table<'v>(&mut self, node: &Node<'v>, keys: &'static [&'static str]) -> Option<&'v DeTable<'v>> {
        let Some(table) = node.value.get_ref().as_table() else {
            let path = &node.path;
            let hint = || format!("write [{path}] on a line of its own, and its keys below it");
            return self.wrong(node, TABLE, (!path.ends_with(']')).then(hint));
        };
        for (key, _) in table {
            let name = key.get_ref().as_ref();
            if !keys.contains(&name) {
                let error = self.unknown_key(name, key.span(), &node.path, keys);
                self.errors.push(error);
            }
        }
        Some(table)
    }

    fn unknown_key(&self, name: &str, span: Range<usize>, table: &str, keys: &'static [&'static str]) -> Error {
        let here = without_indices(table);
        let elsewhere = || {
            let mut all = Vec::new();
            RawCell::tables("", false, &mut all);
            let mut owners = all.iter().filter(|table| table.keys.contains(&name));
            // A table inside this one is meant before any other with such a key.
            let inside = |table: &&Table| !here.is_empty() && table.path.starts_with(&here);
            let owner = owners.clone().find(inside).or_else(|| owners.next())?;
            Some(match (owner.path.as_str(), owner.is_array) {
                ("", _) => {
                    format!("{name} stands at the top of the file, before the first [table]")
                }
                (path, true) => format!("{name} belongs in [[{path}]]"),
                (path, false) => format!("{name} belongs in [{path}]"),
            })
        };
        let hint = elsewhere()
            .or_else(|| did_you_mean(name, keys.iter().copied()))
            .unwrap_or_else(|| format!("known keys here: {}", keys.join(", ")));
        let message = format!("The format has no key \"{name}\" here.");
        let source = self.source;
        source.error_at(Code::UnknownKey, &join(table, name), span, message).hint(hint)
    }

    /// Notes that something else stands there.
    pub(super) fn wrong<T>(&mut self, node: &Node<'_>, expected: &str, hint: Option<String>) -> Option<T> {
        let kind = match node.value.get_ref() {
            DeValue::String(_) => "text",
            DeValue::Float(_) if expected == i64::KIND => "a number with a decimal point",
            DeValue::Integer(_) | DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => bool::KIND,
            DeValue::Datetime(_) => "a date or time",
            DeValue::Array(_) => "a list",
            DeValue::Table(_) => TABLE,
        };
        let message = format!("This is {kind}; it must be {expected}.");
        self.note(Code::WrongType, node, message, hint)
    }

    fn note<T>(&mut self, code: Code, node: &Node<'_>, message: impl Into<String>, hint: Option<String>) -> Option<T> {
        let error = self.source.error_at(code, &node.path, node.value.span(), message);
        self.errors.push(error.hint_if(hint));
        None
    }

    /// A number, where `value` can hold it.
    fn number<T>(&mut self, node: &Node<'_>, value: Option<T>) -> Option<T> {
        value.or_else(|| {
            let message = "The number is too large to be read.";
            self.note(Code::NotFinite, node, message, None)
        })
    }
}

impl Value for f64 {
    const KIND: &'static str = "a number";

    fn read(node: &Node<'_>, reading: &mut Reading<'_>) -> Option<Self> {
        match node.value.get_ref() {
            DeValue::Integer(integer) => {
                let (digits, radix) = (integer.as_str(), integer.radix());
                let signed = i64::from_str_radix(digits, radix).map(|number| number as f64);
                let any = signed.or_else(|_| u64::from_str_radix(digits, radix).map(|n| n as f64));
                reading.number(node, any.ok())
            }
            DeValue::Float(float) => {
                let text = float.as_str();
                let number = text.parse().ok();
                // Infinity is refused where its key is known; a number of many digits is none.
                let meant = |n: &f64| !n.is_infinite() || text.contains("inf");
                reading.number(node, number.filter(meant))
            }
            DeValue::String(text) if text.trim().parse::<f64>().is_ok() => {
                reading.wrong(node, Self::KIND, Some("write the number without quotes".into()))
            }
            _ => reading.wrong(node, Self::KIND, None),
        }
    }
}

impl Value for i64 {
    const KIND: &'static str = "a whole number";

    fn read(node: &Node<'_>, reading: &mut Reading<'_>) -> Option<Self> {
        let Some(integer) = node.value.get_ref().as_integer() else {
            return reading.wrong(node, Self::KIND, None);
        };
        let number = i64::from_str_radix(integer.as_str(), integer.radix());
        reading.number(node, number.ok())
    }
}

impl Value for bool {
    const KIND: &'static str = "true or false";

    fn read(node: &Node<'_>, reading: &mut Reading<'_>) -> Option<Self> {
        let value = node.value.get_ref().as_bool();
        value.or_else(|| reading.wrong(node, Self::KIND, None))
    }
}

impl Value for String {
    const KIND: &'static str = "text in quotes";

    fn read(node: &Node<'_>, reading: &mut Reading<'_>) -> Option<Self> {
        let text = node.value.get_ref().as_str().map(str::to_string);
        text.or_else(|| reading.wrong(node, Self::KIND, None))
    }
}

impl<T: Value> Value for Vec<T> {
    const KIND: &'static str = "a list in brackets";

    /// An entry that can't be read is left out, and noted.
    fn read(node: &Node<'_>, reading: &mut Reading<'_>) -> Option<Self> {
        let path = &node.path;
        if let Some(entries) = node.value.get_ref().as_array() {
            let entries = entries.iter().enumerate();
            let read = entries.filter_map(|(i, entry)| reading.inner(entry, format!("{path}[{}]", i + 1)));
            return Some(read.collect());
        }
        if T::KIND == TABLE {
            let hint = format!("write [[{}]] once for each, and its keys below it", without_indices(path));
            return reading.wrong(node, "an array of tables", Some(hint));
        }
        let nested = "a list of lists is needed here: [[…], […]]";
        reading.wrong(node, Self::KIND, path.ends_with(']').then(|| nested.into()))
    }

    fn tables(path: &str, _: bool, all: &mut Vec<Table>) {
        T::tables(path, true, all);
    }
}

impl<T: Value> Value for Spanned<T> {
    const KIND: &'static str = T::KIND;

    fn read(node: &Node<'_>, reading: &mut Reading<'_>) -> Option<Self> {
        let value = T::read(node, reading)?;
        let span = node.value.span();
        Some(Spanned { span, value })
    }

    fn tables(path: &str, is_array: bool, all: &mut Vec<Table>) {
        T::tables(path, is_array, all);
    }
}

impl<U> Value for Number<U> {
    const KIND: &'static str = f64::KIND;

    fn read(node: &Node<'_>, reading: &mut Reading<'_>) -> Option<Self> {
        let at = Spanned::read(node, reading)?;
        let unit = PhantomData;
        Some(Number { at, unit })
    }
}

impl<const N: usize, U> Value for Fixed<N, U> {
    const KIND: &'static str = Vec::<f64>::KIND;

    fn read(node: &Node<'_>, reading: &mut Reading<'_>) -> Option<Self> {
        Spanned::read(node, reading).map(Fixed)
    }
}

/// Key path of `name` below `path`, with quotes where TOML needs them.
pub(super) fn join(path: &str, name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let name = if !name.is_empty() && name.chars().all(bare) { name.to_string() } else { format!("{name:?}") };
    if path.is_empty() { name } else { format!("{path}.{name}") }
}

/// The path of the table of the format that a table of the file is one of.
fn without_indices(path: &str) -> String {
    let parts = path.split('.').map(|part| part.split('[').next().unwrap_or(part));
    parts.collect::<Vec<_>>().join(".")
}
