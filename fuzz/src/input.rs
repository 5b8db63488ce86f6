//! One input: a file for a reader, a command line with its files for a command.

/// Begins the line of a command in an input written down.
const LINE: &str = "$ stiffarm";
/// Begins and ends the line before a file.
const FILE: (&str, &str) = ("=== ", " ===");

/// What a target runs on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Input {
    /// The content of a file.
    File(Vec<u8>),
    /// The words of a command line, and the files that its words of the same names mean.
    Command {
        /// Words after the program's name.
        words: Vec<String>,
        /// Names and texts.
        files: Vec<(String, String)>,
    },
}

impl Input {
    /// How many bytes it has.
    pub fn size(&self) -> usize {
        match self {
            Input::File(bytes) => bytes.len(),
            Input::Command { words, files } => {
                let words: usize = words.iter().map(String::len).sum();
                words + files.iter().map(|(_, text)| text.len()).sum::<usize>()
            }
        }
    }

    /// As a file of `fuzz/regressions` holds it.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Input::Command { words, files } = self else {
            let Input::File(bytes) = self else {
                return Vec::new();
            };
            return bytes.clone();
        };
        let mut text = LINE.to_string();
        for word in words {
            // A word on a line of its own: it may hold anything else.
            text += &format!("\n{}", word.replace('\\', "\\\\").replace('\n', "\\n"));
        }
        for (name, content) in files {
            text += &format!("\n{}{name}{}\n{content}", FILE.0, FILE.1);
        }
        text.into_bytes()
    }

    /// The input that [`Input::to_bytes`] wrote.
    pub fn from_bytes(bytes: &[u8], is_command: bool) -> Self {
        if !is_command {
            return Input::File(bytes.to_vec());
        }
        let text = String::from_utf8_lossy(bytes);
        let mut sections: Vec<(String, Vec<&str>)> = Vec::new();
        let mut words = Vec::new();
        for line in text.split('\n').skip(1) {
            let name = line.strip_prefix(FILE.0).and_then(|l| l.strip_suffix(FILE.1));
            match (name, sections.last_mut()) {
                (Some(name), _) => sections.push((name.to_string(), Vec::new())),
                (None, Some((_, lines))) => lines.push(line),
                (None, None) => words.push(line.replace("\\n", "\n").replace("\\\\", "\\")),
            }
        }
        let files = sections.into_iter();
        Input::Command { words, files: files.map(|(name, lines)| (name, lines.join("\n"))).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_input_is_written_and_read() {
        let input = Input::Command {
            words: vec!["check".into(), "a b".into(), "c.toml".into()],
            files: vec![("c.toml".into(), "x = 1\n\n".into()), ("d".into(), String::new())],
        };
        assert_eq!(Input::from_bytes(&input.to_bytes(), true), input);
        let file = Input::File(vec![0, 255]);
        assert_eq!(Input::from_bytes(&file.to_bytes(), false), file);
    }
}
