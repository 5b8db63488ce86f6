//! A small strict reader of JSON: this program uses the standard library alone.

use std::iter::Peekable;
use std::str::CharIndices;

/// A value; an object keeps the order of its keys.
#[derive(Debug, Clone, PartialEq)]
pub enum Json {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Json>),
    Object(Vec<(String, Json)>),
}

impl Json {
    /// Reads a whole text.
    ///
    /// # Errors
    /// What is wrong, and at which byte.
    pub fn parse(text: &str) -> Result<Json, String> {
        let mut reader = Reader {
            text,
            rest: text.char_indices().peekable(),
        };
        let value = reader.value()?;
        reader.blanks();
        match reader.rest.next() {
            None => Ok(value),
            Some((at, c)) => Err(format!("'{c}' after the end, at byte {at}")),
        }
    }

    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&Json> {
        match self {
            Json::Object(pairs) => pairs.iter().find(|(k, _)| k == key).map(|(_, v)| v),
            _ => None,
        }
    }

    pub fn number(&self) -> Option<f64> {
        match self {
            Json::Number(value) => Some(*value),
            _ => None,
        }
    }

    pub fn text(&self) -> Option<&str> {
        match self {
            Json::Text(text) => Some(text),
            _ => None,
        }
    }

    pub fn list(&self) -> Option<&[Json]> {
        match self {
            Json::List(values) => Some(values),
            _ => None,
        }
    }

    /// A list of numbers.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        self.list()?.iter().map(Json::number).collect()
    }

    /// A list of lists of numbers.
    pub fn rows(&self) -> Option<Vec<Vec<f64>>> {
        self.list()?.iter().map(Json::numbers).collect()
    }
}

struct Reader<'t> {
    text: &'t str,
    rest: Peekable<CharIndices<'t>>,
}

impl Reader<'_> {
    fn blanks(&mut self) {
        while self.rest.next_if(|(_, c)| " \t\r\n".contains(*c)).is_some() {}
    }

    fn expect(&mut self, wanted: char) -> Result<(), String> {
        match self.rest.next() {
            Some((_, c)) if c == wanted => Ok(()),
            Some((at, c)) => Err(format!("'{c}' instead of '{wanted}', at byte {at}")),
            None => Err(format!("the text ends where '{wanted}' should stand")),
        }
    }

    /// Whether the list or object goes on after a comma, or ends with `end`.
    fn goes_on(&mut self, end: char) -> Result<bool, String> {
        self.blanks();
        match self.rest.next() {
            Some((_, ',')) => Ok(true),
            Some((_, c)) if c == end => Ok(false),
            Some((at, c)) => Err(format!("'{c}' instead of ',' or '{end}', at byte {at}")),
            None => Err(format!("the text ends before '{end}'")),
        }
    }

    fn value(&mut self) -> Result<Json, String> {
        self.blanks();
        match self.rest.peek() {
            Some((_, '"')) => self.string().map(Json::Text),
            Some((_, '[')) => self.list(),
            Some((_, '{')) => self.object(),
            Some(_) => self.word(),
            None => Err("the text ends where a value should stand".to_string()),
        }
    }

    fn list(&mut self) -> Result<Json, String> {
        self.expect('[')?;
        self.blanks();
        let mut values = Vec::new();
        if self.rest.next_if(|(_, c)| *c == ']').is_some() {
            return Ok(Json::List(values));
        }
        loop {
            values.push(self.value()?);
            if !self.goes_on(']')? {
                return Ok(Json::List(values));
            }
        }
    }

    fn object(&mut self) -> Result<Json, String> {
        self.expect('{')?;
        self.blanks();
        let mut pairs: Vec<(String, Json)> = Vec::new();
        if self.rest.next_if(|(_, c)| *c == '}').is_some() {
            return Ok(Json::Object(pairs));
        }
        loop {
            self.blanks();
            let key = self.string()?;
            self.blanks();
            self.expect(':')?;
            let value = self.value()?;
            if pairs.iter().any(|(k, _)| *k == key) {
                return Err(format!("the key \"{key}\" appears twice"));
            }
            pairs.push((key, value));
            if !self.goes_on('}')? {
                return Ok(Json::Object(pairs));
            }
        }
    }

    fn string(&mut self) -> Result<String, String> {
        self.expect('"')?;
        let mut out = String::new();
        loop {
            match self.rest.next() {
                Some((_, '"')) => return Ok(out),
                Some((at, '\\')) => out.push(self.escaped(at)?),
                Some((at, c)) if c < ' ' => {
                    return Err(format!("a control character in a string, at byte {at}"));
                }
                Some((_, c)) => out.push(c),
                None => return Err("a string has no end".to_string()),
            }
        }
    }

    /// What stands behind a backslash; pairs of surrogates do not occur and are refused.
    fn escaped(&mut self, at: usize) -> Result<char, String> {
        let wrong = || format!("no such escape, at byte {at}");
        let (_, c) = self.rest.next().ok_or_else(wrong)?;
        Ok(match c {
            '"' | '\\' | '/' => c,
            'n' => '\n',
            't' => '\t',
            'r' => '\r',
            'b' => '\u{8}',
            'f' => '\u{c}',
            'u' => {
                let mut code = 0;
                for _ in 0..4 {
                    let digit = self.rest.next().and_then(|(_, c)| c.to_digit(16));
                    code = 16 * code + digit.ok_or_else(wrong)?;
                }
                char::from_u32(code).ok_or_else(wrong)?
            }
            _ => return Err(wrong()),
        })
    }

    /// A number, `true`, `false` or `null`.
    fn word(&mut self) -> Result<Json, String> {
        let start = self.rest.peek().map_or(self.text.len(), |(at, _)| *at);
        let inside = |c: char| c.is_ascii_alphanumeric() || "+-.".contains(c);
        while self.rest.next_if(|(_, c)| inside(*c)).is_some() {}
        let end = self.rest.peek().map_or(self.text.len(), |(at, _)| *at);
        let word = &self.text[start..end];
        match word {
            "null" => return Ok(Json::Null),
            "true" => return Ok(Json::Bool(true)),
            "false" => return Ok(Json::Bool(false)),
            _ => {}
        }
        let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
        let bare = word.strip_prefix('-').unwrap_or(word);
        let leading_zero = bare.starts_with('0') && digit(bare.chars().nth(1));
        let ends_well = digit(word.chars().last()) && !bare.contains(".e") && !bare.contains(".E");
        match word.parse::<f64>() {
            Ok(value)
                if value.is_finite()
                    && digit(bare.chars().next())
                    && !leading_zero
                    && ends_well =>
            {
                Ok(Json::Number(value))
            }
            _ => Err(format!("no value, at byte {start}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Json;

    #[test]
    fn values_are_read() {
        let text = r#" {"a": [1, -2.5e-3, 0], "b": {"c": null, "d": true}, "e": "ä\n\u00e4\"", "f": [], "g": {}} "#;
        let json = Json::parse(text).unwrap();
        assert_eq!(
            json.get("a").and_then(Json::numbers),
            Some(vec![1.0, -0.0025, 0.0])
        );
        assert_eq!(json.get("b").and_then(|b| b.get("c")), Some(&Json::Null));
        assert_eq!(
            json.get("b").and_then(|b| b.get("d")),
            Some(&Json::Bool(true))
        );
        assert_eq!(json.get("e").and_then(Json::text), Some("ä\nä\""));
        assert_eq!(json.get("f").and_then(Json::rows), Some(vec![]));
        assert_eq!(json.get("g"), Some(&Json::Object(vec![])));
        assert_eq!(json.get("h"), None);
    }

    #[test]
    fn what_is_no_json_is_refused() {
        for text in [
            "",
            "[1,]",
            "[1 2]",
            "{\"a\":1,}",
            "{\"a\":1,\"a\":2}",
            "{a:1}",
            "nan",
            "Infinity",
            "1e999",
            "01",
            "1.",
            "+1",
            ".5",
            "tru",
            "\"a",
            "\"\\x\"",
            "\"\\ud800\"",
            "[1] 2",
            "[",
        ] {
            assert!(Json::parse(text).is_err(), "{text}");
        }
    }
}
