//! Sentences in which numbers keep what they are.

use super::Number;
use stiffarm::findings::Finding;

/// A sentence or two in which numbers keep what they are.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Text(pub Vec<Piece>);

/// A piece of a text.
#[derive(Debug, Clone, PartialEq)]
pub enum Piece {
    /// Words.
    Words(String),
    /// Words that matter most.
    Strong(String),
    /// What one types, or a name from a file.
    Code(String),
    /// Words that lead to an anchor of the page.
    Link(String, String),
    /// Words that say how something differs from what stands beside it.
    Different(String),
    /// A number with its unit.
    Number(Number),
}

impl Text {
    /// A text to begin with.
    pub fn new(words: impl Into<String>) -> Self {
        Text(vec![Piece::Words(words.into())])
    }

    /// With more words.
    #[must_use]
    pub fn words(mut self, words: impl Into<String>) -> Self {
        self.0.push(Piece::Words(words.into()));
        self
    }

    /// With words that matter most.
    #[must_use]
    pub fn strong(mut self, words: impl Into<String>) -> Self {
        self.0.push(Piece::Strong(words.into()));
        self
    }

    /// With another text behind it.
    #[must_use]
    pub fn then(mut self, text: Text) -> Self {
        self.0.extend(text.0);
        self
    }

    /// With something that one types.
    #[must_use]
    pub fn code(mut self, words: impl Into<String>) -> Self {
        self.0.push(Piece::Code(words.into()));
        self
    }

    /// With words that lead to an anchor of the page.
    #[must_use]
    pub fn link(mut self, words: impl Into<String>, anchor: impl Into<String>) -> Self {
        self.0.push(Piece::Link(words.into(), anchor.into()));
        self
    }

    /// With a number.
    #[must_use]
    pub fn number(mut self, number: Number) -> Self {
        self.0.push(Piece::Number(number));
        self
    }

    /// With numbers, a comma between them.
    #[must_use]
    pub fn numbers(mut self, numbers: impl IntoIterator<Item = Number>) -> Self {
        for (i, number) in numbers.into_iter().enumerate() {
            if i > 0 {
                self = self.words(", ");
            }
            self = self.number(number);
        }
        self
    }

    /// Whether it says a finding, which then need not stand beside it.
    pub fn says(&self, finding: &Finding) -> bool {
        self.plain().contains(&finding.sentence)
    }

    /// As a line of a file: with a minus that programs read.
    pub fn line(&self) -> String {
        self.plain().replace('−', "-")
    }

    /// As one line of plain text.
    pub fn plain(&self) -> String {
        let pieces = self.0.iter().map(|piece| match piece {
            Piece::Words(words)
            | Piece::Strong(words)
            | Piece::Code(words)
            | Piece::Link(words, _)
            | Piece::Different(words) => words.clone(),
            Piece::Number(number) => number.text(),
        });
        pieces.collect()
    }
}

/// `1 posture`, `6 postures`.
pub fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

impl From<&str> for Text {
    fn from(words: &str) -> Self {
        Text::new(words)
    }
}

impl From<String> for Text {
    fn from(words: String) -> Self {
        Text::new(words)
    }
}

impl From<Number> for Text {
    fn from(number: Number) -> Self {
        Text(vec![Piece::Number(number)])
    }
}
