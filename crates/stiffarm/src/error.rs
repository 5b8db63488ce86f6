//! The one error type of the library: what is wrong, where, what to do.

use std::borrow::Cow;
use std::fmt;
use std::ops::Range;

/// Result with this library's [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Makes [`Code`] of its rows: the kind, its stable name, and what it means in the words of `docs/errors.md`.
macro_rules! codes {
    ($($kind:ident $name:literal $meaning:literal;)*) => {
        /// Kind of an error; stable names for scripts, listed in `docs/errors.md`.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Code {
            $(#[doc = $meaning] $kind,)*
        }

        impl Code {
            /// Every code, in the order of the documentation.
            pub const ALL: [Code; [$($name),*].len()] = [$(Code::$kind),*];

            /// Stable name, as in the `code` of a JSON error.
            pub fn as_str(self) -> &'static str {
                match self {
                    $(Code::$kind => $name,)*
                }
            }

            /// One sentence for the documentation.
            pub fn meaning(self) -> &'static str {
                match self {
                    $(Code::$kind => $meaning,)*
                }
            }
        }
    };
}

codes! {
    FileRead "file-read" "A file could not be opened or read.";
    FileWrite "file-write" "A file could not be written.";
    FileExists "file-exists" "The output exists, and nothing is overwritten unless asked for.";
    Encoding "encoding" "The text is not valid UTF-8.";
    TomlSyntax "toml-syntax" "The cell file is not valid TOML.";
    Urdf "urdf" "A URDF cannot be read: not XML, or an element is missing or wrong.";
    UnknownKey "unknown-key" "The cell file has a key the format does not know.";
    MissingKey "missing-key" "A key that must be there is missing.";
    WrongType "wrong-type" "A value is of the wrong kind.";
    InvalidValue "invalid-value" "A value is not allowed.";
    NotFinite "not-finite" "NaN or infinity where a finite number is needed.";
    Conflict "conflict" "Keys, columns or options exclude each other.";
    TableHeading "table-heading" "A table's heading lacks a column or has one nobody knows.";
    TableRow "table-row" "A row of a table cannot be read.";
    DecimalComma "decimal-comma" "A decimal comma in a comma-separated table: the columns cannot be told apart.";
    Duplicate "duplicate" "The same name or row appears twice.";
    UnknownName "unknown-name" "A name (robot, point, built-in) is not defined.";
    Dimension "dimension" "Lengths of two inputs do not fit each other.";
    OutsideLimits "outside-limits" "A joint angle lies outside the machine's limits.";
    Unreachable "unreachable" "No posture of the arm holds the flange at the pose; the distance is named.";
    Unsupported "unsupported" "The robot or set-up is not supported by this version.";
    ResultFile "result-file" "A saved result cannot be used here.";
    Program "program" "A controller program cannot be read, or holds a move that does not go to stated joint angles.";
    TooFewData "too-few-data" "Nothing to work with: no postures, no displacements, or all excluded.";
    Registration "registration" "The point pairs determine no registration: on a line, mirrored, or in different \
        units.";
    NotIdentifiable "not-identifiable" "The postures and the load cannot determine every joint; the joints are named.";
    Numerical "numerical" "A numerical routine did not converge on finite input.";
    Interrupted "interrupted" "Stopped by the user (Ctrl-C).";
    Usage "usage" "Wrong use of the command line.";
    Internal "internal" "A fault of the program itself; please report it.";
}

impl Code {
    /// True where no input can be blamed: the fault is the library's own.
    pub fn is_internal(self) -> bool {
        matches!(self, Code::Internal | Code::Numerical)
    }
}

/// Place of an error: file, 1-based line and column, key path, byte span.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Location {
    /// File name as the user gave it, or `builtin:…`.
    pub file: Option<String>,
    /// Line, counted from 1.
    pub line: Option<usize>,
    /// Column in characters, counted from 1.
    pub column: Option<usize>,
    /// Key path in a cell file, or column name in a table.
    pub key: Option<String>,
    /// Byte range in the file's text.
    pub span: Option<Range<usize>>,
}

/// What is wrong, where, and what to do about it.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{}", DisplayError(.0))]
pub struct Error(Box<Inner>);

#[derive(Debug, Clone)]
struct Inner {
    code: Code,
    message: String,
    place: Location,
    hint: Option<String>,
}

struct DisplayError<'a>(&'a Inner);

impl fmt::Display for DisplayError<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = &self.0.place;
        if let Some(file) = &place.file {
            write!(f, "{file}:")?;
            if let Some(line) = place.line {
                write!(f, "{line}:")?;
                if let Some(column) = place.column {
                    write!(f, "{column}:")?;
                }
            }
            write!(f, " ")?;
        }
        if let Some(key) = &place.key {
            write!(f, "{key}: ")?;
        }
        write!(f, "{}", self.0.message)?;
        if let Some(hint) = &self.0.hint {
            write!(f, "\n  hint: {hint}")?;
        }
        Ok(())
    }
}

impl Error {
    /// An error with its code and a full sentence.
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        Error(Box::new(Inner { code, message: readable(message.into()), place: Location::default(), hint: None }))
    }

    /// A value that cannot be meant ([`Code::InvalidValue`]), with a full sentence.
    pub fn invalid(message: impl Into<String>) -> Self {
        Error::new(Code::InvalidValue, message)
    }

    /// Adds what the user can do, where there is something.
    #[must_use]
    pub fn hint_if(mut self, hint: Option<impl Into<String>>) -> Self {
        let hint = hint.map(|hint| readable(hint.into()));
        self.0.hint = hint.or(self.0.hint);
        self
    }

    /// Adds what the user can do.
    #[must_use]
    pub fn hint(self, hint: impl Into<String>) -> Self {
        self.hint_if(Some(hint))
    }

    /// Adds the key path or column name.
    #[must_use]
    pub fn key(mut self, key: impl Into<String>) -> Self {
        self.0.place.key = Some(readable(key.into()));
        self
    }

    /// Adds the file's name.
    #[must_use]
    pub fn file(mut self, file: impl Into<String>) -> Self {
        self.0.place.file = Some(file.into());
        self
    }

    /// Adds line and column, both counted from 1.
    #[must_use]
    pub fn line(mut self, line: usize, column: Option<usize>) -> Self {
        self.0.place.line = Some(line);
        self.0.place.column = column;
        self
    }

    /// Adds the line, where there is one.
    #[must_use]
    pub(crate) fn in_line(self, line: Option<usize>) -> Self {
        match line {
            Some(line) => self.line(line, None),
            None => self,
        }
    }

    /// Adds a byte span of `text`, with the line and column it starts at.
    #[must_use]
    pub fn span(mut self, text: &str, span: Range<usize>) -> Self {
        let mut start = span.start.min(text.len());
        while !text.is_char_boundary(start) {
            start -= 1;
        }
        let before = &text[..start];
        let line = before.matches('\n').count() + 1;
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        self.0.place.line = Some(line);
        // A byte order mark takes no column: editors don't show it.
        let in_line = before[line_start..].trim_start_matches('\u{feff}');
        self.0.place.column = Some(in_line.chars().count() + 1);
        self.0.place.span = Some(start..span.end.clamp(start, text.len()));
        self
    }

    /// The kind of error.
    pub fn code(&self) -> Code {
        self.0.code
    }

    /// The sentence, without place and hint.
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// Where the fault lies.
    pub fn place(&self) -> &Location {
        &self.0.place
    }

    /// What to do, if we know.
    pub fn hint_text(&self) -> Option<&str> {
        self.0.hint.as_deref()
    }
}

/// True for a character that a reader does not see, or that changes how others
/// are shown: controls, line separators, marks of direction, fillers, tags.
pub fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}'
            | '\u{180b}'..='\u{180f}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{3164}' | '\u{feff}' | '\u{ffa0}' | '\u{fff0}'..='\u{fffb}'
            | '\u{e0000}'..='\u{e0fff}')
}

/// Text with its hidden characters in letters, `\u{202e}`, on one line.
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_hidden) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| match c {
        '\n' | '\r' | '\t' => c.escape_default().to_string(),
        c if is_hidden(c) => c.escape_unicode().to_string(),
        c => c.to_string(),
    };
    Cow::Owned(text.chars().map(shown).collect())
}

/// Bytes of a sentence. A field that stands in one may be as long as its file.
const LONGEST: usize = 4000;

/// A sentence as it can be read: what it quotes from a file has its hidden characters in
/// letters, its own line ends stay.
fn readable(text: String) -> String {
    let text = cut(text);
    if !text.chars().any(|c| is_hidden(c) && c != '\n') {
        return text;
    }
    let lines: Vec<Cow<'_, str>> = text.split('\n').map(visible).collect();
    cut(lines.join("\n"))
}

/// A text whose middle is left out where it is too long to be read.
fn cut(text: String) -> String {
    if text.len() <= LONGEST {
        return text;
    }
    let (mut left, mut right) = (LONGEST / 2, text.len() - LONGEST / 2);
    while !text.is_char_boundary(left) {
        left -= 1;
    }
    while !text.is_char_boundary(right) {
        right += 1;
    }
    format!("{} … {}", &text[..left], &text[right..])
}

/// Bytes of a name that may be a slip of a known one.
const LONGEST_NAME: usize = 100;

/// Letters of the beginning of a name that tell which is meant.
const BEGINNING: usize = 3;

/// `did you mean "…"?` for those of `names` that begin with `name`, else for the nearest to it.
pub fn did_you_mean<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    if name.len() > LONGEST_NAME {
        return None;
    }
    let lower = name.to_lowercase();
    let names: Vec<&str> = names.into_iter().collect();
    let begins = |k: &&&str| k.to_lowercase().starts_with(&lower);
    let longer = names.iter().filter(begins);
    let longer: Vec<String> = longer.map(|k| format!("\"{k}\"")).collect();
    if let (Some((last, others)), true) = (longer.split_last(), lower.chars().count() >= BEGINNING) {
        return Some(match others {
            [] => format!("did you mean {last}?"),
            others => format!("did you mean {} or {last}?", others.join(", ")),
        });
    }
    names
        .into_iter()
        .map(|k| (strsim::damerau_levenshtein(&lower, &k.to_lowercase()), k))
        .filter(|(distance, k)| {
            // Half of the letters must be right, or it is no slip of this one.
            let letters = lower.chars().count().max(k.chars().count());
            *distance <= 2.max(k.chars().count() / 3) && 2 * *distance <= letters
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, k)| format!("did you mean \"{k}\"?"))
}
