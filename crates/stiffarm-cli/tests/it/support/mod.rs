//! A folder of its own for each test, and the command run inside it.
#![allow(dead_code, reason = "each test file uses its own part")]

use serde_json::Value;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

static FOLDERS: AtomicUsize = AtomicUsize::new(0);

/// A temporary folder; it goes when the test is over.
pub struct Folder(PathBuf);

impl Folder {
    /// An empty folder.
    pub fn new() -> Self {
        let number = FOLDERS.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("stiffarm-test-{}-{number}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    /// A folder with one file.
    pub fn with(name: &str, content: impl AsRef<[u8]>) -> Self {
        let folder = Folder::new();
        folder.write(name, content);
        folder
    }

    /// A file's path in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Writes a file into it.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    /// Text of a file in it.
    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Names in it, sorted.
    pub fn names(&self) -> Vec<String> {
        self.names_in("")
    }

    /// Names in a folder of it, sorted.
    pub fn names_in(&self, name: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(name)).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Runs `stiffarm` with the words of `line` in this folder.
    pub fn run(&self, line: &str) -> Ran {
        self.run_with(line, b"")
    }

    /// As [`Folder::run`], with this on standard input.
    pub fn run_with(&self, line: &str, input: &[u8]) -> Ran {
        let mut child = command(&self.0)
            .args(line.split_whitespace())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // A command that ends before it reads closes the pipe.
        let _ = child.stdin.take().unwrap().write_all(input);
        let output = child.wait_with_output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Ran { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }

    /// Runs a line, and gives the transcript.
    pub fn transcript(&self, line: &str) -> String {
        self.run(line).transcript(line)
    }

    /// Runs a line that must end well, and gives what it printed.
    pub fn ok(&self, line: &str) -> String {
        let ran = self.run(line);
        assert_eq!(ran.code, Some(0), "{line}\n{}{}", ran.out, ran.err);
        ran.out
    }

    /// Runs a line that must be refused before any work, and gives the reason.
    pub fn refused(&self, line: &str) -> String {
        let ran = self.run(line);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{line}\n{}", ran.err);
        ran.err
    }

    /// The error of a line that must be refused before any work, as `--json` prints it.
    pub fn error(&self, line: &str) -> Value {
        let ran = self.run(&format!("{line} --json"));
        assert_eq!((ran.code, ran.err.as_str()), (Some(2), ""), "{line}\n{}", ran.out);
        let printed: Value = serde_json::from_str(&ran.out).unwrap_or_else(|e| panic!("{line}: {e}\n{}", ran.out));
        printed["error"].clone()
    }

    /// Lines that must be refused before any work, each with the code of its error and the error's [`place`]. Gives all
    /// that is said of them.
    pub fn each_refused(&self, rows: &[(&str, &str, &str)]) -> String {
        let mut said = String::new();
        let mut errors = Vec::new();
        for (line, ..) in rows {
            let error = self.error(line);
            errors.push((*line, error["code"].as_str().unwrap().to_string(), place(&error)));
            said += &format!("$ stiffarm {line}\n{}\n", self.refused(line));
        }
        let errors: Vec<(&str, &str, &str)> = errors.iter().map(|(line, code, at)| (*line, &**code, &**at)).collect();
        assert_eq!(errors, rows);
        said
    }

    /// Transcripts of lines that must be refused before any work; with `--json` the error is on standard output.
    pub fn refusals<'a>(&self, lines: impl IntoIterator<Item = &'a str>) -> String {
        let mut report = String::new();
        for line in lines {
            let ran = self.run(line);
            assert_eq!(ran.code, Some(2), "{line}\n{}{}", ran.out, ran.err);
            let printed = if line.ends_with("--json") { &ran.err } else { &ran.out };
            assert_eq!(printed, "", "{line} printed a part of a result");
            report += &ran.transcript(line).replace("-- standard error\n", "");
            report.push('\n');
        }
        report
    }

    /// Runs a line with `--json` and gives the object it printed.
    pub fn json(&self, line: &str) -> Value {
        let ran = self.run(&format!("{line} --json"));
        assert_eq!(ran.err, "", "{line}");
        serde_json::from_str(&ran.out).unwrap_or_else(|e| panic!("{line}: {e}\n{}", ran.out))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// What `line` writes into a file, which it names `out`.
fn written(line: &str, out: &str, input: &[(&str, &str)]) -> String {
    let folder = Folder::new();
    input.iter().for_each(|(name, text)| folder.write(name, text));
    folder.ok(line);
    folder.read(out)
}

/// Displacements of one simulated run at Group 1 of the default cell.
pub fn measurements() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    let line = "simulate builtin:comau builtin:comau-group1 --runs 1 --levels 1 --measurements m.csv";
    TEXT.get_or_init(|| written(line, "m.csv", &[]))
}

/// Its readings.
pub fn readings() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    let line = "simulate builtin:comau builtin:comau-group1 --runs 1 --levels 1 --readings r.csv";
    TEXT.get_or_init(|| written(line, "r.csv", &[]))
}

/// What `identify` makes of the displacements, with covariance and common-mode errors.
pub fn stiffness() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    let line = "identify builtin:comau m.csv --output k.json";
    TEXT.get_or_init(|| written(line, "k.json", &[("m.csv", measurements())]))
}

/// What `identify --brief` makes of the readings.
pub fn brief_stiffness() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    let line = "identify builtin:comau r.csv --brief --output k.json";
    TEXT.get_or_init(|| written(line, "k.json", &[("r.csv", readings())]))
}

/// Where an error is: `file:line:column key`, as much of it as there is.
pub fn place(error: &Value) -> String {
    let file = ["file", "line", "column"].map(|part| match &error[part] {
        Value::Null => String::new(),
        Value::String(name) => name.replace('\\', "/"),
        number => format!(":{number}"),
    });
    format!("{} {}", file.concat(), error["key"].as_str().unwrap_or_default()).trim().to_string()
}

/// Codes of findings, in their order.
pub fn codes(findings: &Value) -> Vec<&str> {
    let findings = findings.as_array().unwrap_or_else(|| panic!("{findings} are no findings"));
    findings.iter().map(|finding| finding["code"].as_str().unwrap()).collect()
}

/// The sentence of the finding with this code.
pub fn sentence<'a>(findings: &'a Value, code: &str) -> &'a str {
    let finding = findings.as_array().into_iter().flatten().find(|finding| finding["code"] == code);
    let finding = finding.unwrap_or_else(|| panic!("no {code} among {findings}"));
    finding["sentence"].as_str().unwrap()
}

/// Printed text as it was before its lines were broken.
pub fn unbroken(printed: &str) -> String {
    printed.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A long sentence in lines of at most 100 characters, for a snapshot.
pub fn in_lines(text: impl AsRef<str>) -> String {
    let mut lines = vec![String::new()];
    for word in text.as_ref().split_whitespace() {
        let line = lines.last_mut().unwrap();
        match line.chars().count() {
            0 => line.push_str(word),
            width if width + 1 + word.chars().count() <= 100 => *line += &format!(" {word}"),
            _ => lines.push(word.to_string()),
        }
    }
    lines.join("\n")
}

/// Text on one line with `#` for its numbers: another platform, or another moment, may give others.
pub fn without_numbers(text: &str) -> String {
    let masked = |word: &str| {
        let inner = word.trim_matches(|c: char| "()[],;:.°".contains(c));
        match inner.replace('−', "-").parse::<f64>() {
            Ok(_) => word.replacen(inner, "#", 1),
            Err(_) => word.to_string(),
        }
    };
    text.split_whitespace().map(masked).collect::<Vec<_>>().join(" ")
}

/// The sentence in printed text that begins so, to its full stop.
pub fn printed_sentence(printed: &str, begin: &str) -> String {
    let text = unbroken(printed);
    let at = text.find(begin).unwrap_or_else(|| panic!("nothing begins with {begin:?}:\n{printed}"));
    let end = text[at..].find(". ").map_or(text.len(), |end| at + end + 1);
    text[at..end].to_string()
}

/// The paragraphs of a section of a page, one a line, without their markup.
pub fn paragraphs(page: &str, section: &str) -> String {
    let (_, rest) = page.split_once(&format!("id=\"{section}\"")).unwrap_or_else(|| panic!("no section {section}"));
    let section = rest.split("</section>").next().unwrap();
    let paragraph = |part: &str| {
        let begins = [" ", ">", "re>", "re "].iter().any(|end| part.starts_with(end));
        let inside = &part[part.find('>')? + 1..part.find("</p").filter(|_| begins)?];
        Some(without_tags(inside) + "\n")
    };
    section.split("<p").skip(1).filter_map(paragraph).collect()
}

/// The findings of a page, as they stand in its lists.
pub fn listed(page: &str) -> Vec<String> {
    let items = page.split("<li class=").skip(1).filter_map(|part| part.split_once('>'));
    items.map(|(_, text)| without_tags(text.split("</li>").next().unwrap())).collect()
}

/// Text of a piece of a page.
fn without_tags(html: &str) -> String {
    let mut in_tag = false;
    let shown = html.chars().filter(|c| {
        in_tag = *c == '<' || (in_tag && *c != '>');
        !in_tag && *c != '>'
    });
    unbroken(&shown.collect::<String>())
}

/// How many cells in three dimensions a page shows.
pub fn scenes(page: &str) -> usize {
    page.matches("<div class=\"scene\"").count()
}

/// First line of a table of postures of six joints.
pub const HEADING: &str = "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n";

/// The text with `from`, which stands in it, replaced wherever it stands.
pub fn replaced(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replace(from, to)
}

/// The default cell with one measuring point instead of four: three rows for six joints.
pub fn one_point_cell() -> String {
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    let (start, end) = (cell.find("[[tool.measuring_point]]\nname = \"2\"").unwrap(), cell.find("[load]").unwrap());
    format!("{}{}", &cell[..start], &cell[end..])
}

/// No line is too wide for a terminal.
pub fn is_narrow(text: &str) {
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
}

/// The blocks of a page between lines of three backquotes: language and text.
pub fn blocks(page: &str) -> Vec<(&str, &str)> {
    let inside = page.split("```").skip(1).step_by(2);
    inside.filter_map(|block| block.split_once('\n')).collect()
}

/// The command in a folder, in surroundings that are always the same.
pub fn command(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stiffarm"));
    command.current_dir(folder).env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE").env("TERM", "dumb");
    command
}

/// `base` times the factor that `STIFFARM_TEST_RUNS` asks for, as in the library's tests.
pub fn runs(base: u64) -> u64 {
    let factor = match std::env::var("STIFFARM_TEST_RUNS") {
        Ok(text) => text.parse().expect("STIFFARM_TEST_RUNS must be a number"),
        Err(_) => 1.0,
    };
    ((base as f64 * factor).round() as u64).max(1)
}

/// A script of the shell in a folder, in the surroundings of [`command`].
pub fn shell(folder: &Path, script: &str) -> Command {
    let mut shell = Command::new("sh");
    shell
        .current_dir(folder)
        .args(["-c", script])
        .env_remove("NO_COLOR")
        .env_remove("CLICOLOR_FORCE")
        .env("TERM", "dumb")
        .stdin(Stdio::null());
    shell
}

/// What a run left behind.
pub struct Ran {
    /// Exit code.
    pub code: Option<i32>,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl Ran {
    /// The run as a transcript.
    pub fn transcript(&self, line: &str) -> String {
        let mut text = format!("$ stiffarm {line}\n{}", self.out);
        if !self.err.is_empty() {
            text += &format!("-- standard error\n{}", self.err);
        }
        text += &format!("-- exit code {}\n", self.code.unwrap_or(-1));
        redact(&text)
    }
}

/// A number in a result.
pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The text without what differs from version to version.
pub fn redact(text: &str) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let text = text.replace(&format!("\"stiffarm\": \"{version}\""), "\"stiffarm\": \"[version]\"");
    text.replace(&format!("stiffarm {version}"), "stiffarm [version]")
}

/// JSON with the last digits of its numbers and its hashes taken off, so that
/// a snapshot outlives a different rounding and a comment in a cell.
pub fn rounded(value: &Value) -> Value {
    match value {
        Value::Number(number) => match number.as_f64() {
            Some(v) if number.is_f64() => {
                let short: f64 = format!("{v:.4e}").parse().unwrap();
                Value::from(short)
            }
            _ => value.clone(),
        },
        Value::Array(items) => items.iter().map(rounded).collect(),
        Value::Object(entries) => entries.iter().map(|(key, v)| (key.clone(), rounded(v))).collect(),
        Value::String(text) if text.len() == 64 && text.bytes().all(|b| b.is_ascii_hexdigit()) => "[sha256]".into(),
        other => other.clone(),
    }
}

/// A block about the origin as a text STL.
pub fn block(size: [f64; 3]) -> String {
    let corner = |i: usize| {
        let at = |axis: usize| (i >> axis & 1) as f64 * size[axis] - 0.5 * size[axis];
        format!("vertex {} {} {}\n", at(0), at(1), at(2))
    };
    let sides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let facet = |corners: [usize; 3]| {
        let corners: String = corners.into_iter().map(corner).collect();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    let facets: String = sides.iter().flat_map(|[a, b, c, d]| [facet([*a, *b, *c]), facet([*a, *c, *d])]).collect();
    format!("solid block\n{facets}endsolid block\n")
}
