//! What the strict checkers of the languages share: a tokenizer, and what a sound program says.
//!
//! The checkers are written from the grammars that the library's files cite, and use nothing of
//! the library: they know the subset that may be written and refuse everything else.

use stiffarm_files::program::ProgramFile;

/// What a checker found a program to do.
#[derive(Debug, Default, PartialEq)]
pub struct Parsed {
    /// Values of each move's target in the controller's order and unit, with its speed in per cent.
    pub moves: Vec<(Vec<f64>, f64)>,
    /// The text of each wait.
    pub waits: Vec<String>,
}

pub type Checked<T = Parsed> = Result<T, String>;

#[derive(Debug, Clone, PartialEq)]
pub enum Token {
    Word(String),
    /// As it is written.
    Number(String),
    Text(String),
    Sign(char),
}

/// Tokens of a line that is being consumed.
#[derive(Debug)]
pub struct Tokens {
    line: String,
    tokens: std::vec::IntoIter<Token>,
}

impl Tokens {
    /// Splits a line; `quote` surrounds texts.
    pub fn of(line: &str, quote: char) -> Checked<Tokens> {
        let chars: Vec<char> = line.chars().collect();
        let mut tokens = Vec::new();
        let mut at = 0;
        while at < chars.len() {
            let c = chars[at];
            let begin = at;
            let word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '$' || c == '#';
            let sign_of_number = c == '-' && chars.get(at + 1).is_some_and(char::is_ascii_digit);
            if c == ' ' {
                at += 1;
            } else if c == quote {
                at += 1;
                while chars.get(at).is_some_and(|c| *c != quote) {
                    at += 1;
                }
                if at == chars.len() {
                    return Err(format!("text without end: {line}"));
                }
                at += 1;
                tokens.push(Token::Text(chars[begin + 1..at - 1].iter().collect()));
            } else if c.is_ascii_digit() || sign_of_number {
                at += 1;
                while chars.get(at).is_some_and(|c| c.is_ascii_alphanumeric() || *c == '.') {
                    at += 1;
                }
                tokens.push(Token::Number(chars[begin..at].iter().collect()));
            } else if word(c) {
                while chars.get(at).is_some_and(|c| word(*c)) {
                    at += 1;
                }
                tokens.push(Token::Word(chars[begin..at].iter().collect()));
            } else {
                at += 1;
                tokens.push(Token::Sign(c));
            }
        }
        Ok(Tokens { line: line.to_string(), tokens: tokens.into_iter() })
    }

    fn wrong<T>(&self, wanted: &str, got: Option<Token>) -> Checked<T> {
        Err(format!("{wanted} expected, got {got:?}: {}", self.line))
    }

    /// The next word is exactly this.
    pub fn word(&mut self, word: &str) -> Checked<()> {
        match self.tokens.next() {
            Some(Token::Word(read)) if read == word => Ok(()),
            other => self.wrong(word, other),
        }
    }

    /// The next tokens are exactly these signs.
    pub fn signs(&mut self, signs: &str) -> Checked<()> {
        for sign in signs.chars() {
            match self.tokens.next() {
                Some(Token::Sign(read)) if read == sign => {}
                other => return self.wrong(&sign.to_string(), other),
            }
        }
        Ok(())
    }

    pub fn any_word(&mut self) -> Checked<String> {
        match self.tokens.next() {
            Some(Token::Word(read)) => Ok(read),
            other => self.wrong("a word", other),
        }
    }

    pub fn text(&mut self, longest: usize) -> Checked<String> {
        match self.tokens.next() {
            Some(Token::Text(read)) if (1..=longest).contains(&read.len()) => Ok(read),
            other => self.wrong("a text that is not too long", other),
        }
    }

    /// A number with between `fewest` and `most` decimals, none for whole ones.
    pub fn number(&mut self, fewest: usize, most: usize) -> Checked<f64> {
        let token = self.tokens.next();
        let Some(Token::Number(text)) = &token else {
            return self.wrong("a number", token);
        };
        let digits = text.trim_start_matches('-');
        let (whole, decimals) = digits.split_once('.').unwrap_or((digits, ""));
        let all = |part: &str| part.bytes().all(|b| b.is_ascii_digit());
        let plain = all(whole) && all(decimals) && !whole.is_empty();
        let dot = digits.contains('.') == (most > 0);
        let leading = whole.len() == 1 || !whole.starts_with('0');
        let zero = text.starts_with('-') && digits.bytes().all(|b| b == b'0' || b == b'.');
        if !plain || !dot || !leading || zero || !(fewest..=most).contains(&decimals.len()) {
            return self.wrong(&format!("a number with {fewest} to {most} decimals"), token);
        }
        text.parse().map_err(|_| text.clone())
    }

    /// A word or number that is exactly this text.
    pub fn exactly(&mut self, wanted: &str) -> Checked<()> {
        match self.tokens.next() {
            Some(Token::Number(read) | Token::Word(read)) if read == wanted => Ok(()),
            other => self.wrong(wanted, other),
        }
    }

    pub fn end(&mut self) -> Checked<()> {
        match self.tokens.next() {
            None => Ok(()),
            other => self.wrong("the end of the line", other),
        }
    }
}

/// The lines of a file: ASCII without tabs where not allowed, all with this end, none too long.
pub fn lines<'a>(file: &'a ProgramFile, end: &str, longest: usize) -> Checked<Vec<&'a str>> {
    let text = file.text.as_str();
    let Some(text) = text.strip_suffix(end) else {
        return Err(format!("{}: the last line has no end", file.name));
    };
    let lines: Vec<&str> = text.split(end).collect();
    for line in &lines {
        if !line.chars().all(|c| c == '\t' || (' '..='~').contains(&c)) {
            return Err(format!("a character that is not allowed: {line:?}"));
        }
        if line.len() > longest || line.ends_with(' ') {
            return Err(format!("too long, or a space at its end: {line:?}"));
        }
    }
    Ok(lines)
}

/// A name of a program.
pub fn name(name: &str, longest: usize) -> Checked<()> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let begins = name.starts_with(|c: char| c.is_ascii_alphabetic());
    if begins && name.chars().all(plain) && name.len() <= longest { Ok(()) } else { Err(format!("name {name}")) }
}

/// Fails unless it holds.
pub fn holds(it: bool, what: impl Into<String>) -> Checked<()> {
    if it { Ok(()) } else { Err(what.into()) }
}

/// The one file of most languages.
pub fn only(files: &[ProgramFile]) -> Checked<&ProgramFile> {
    match files {
        [file] => Ok(file),
        _ => Err(format!("{} files", files.len())),
    }
}
