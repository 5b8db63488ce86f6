//! Errors as people and machines read them.

use crate::Captured;
use crate::excerpt::excerpt;
use crate::screen::{plain, rendered};
use crate::session::Session;
use crate::table::paint;
use anstyle::AnsiColor;
use clap::error::{ContextKind, ContextValue};
use serde::Serialize;
use std::cell::RefCell;
use std::error::Error as _;
use std::io::Write;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use stiffarm::{Code, Error, Result};
use stiffarm_files::envelope::to_json;

/// A byte order mark, which editors don't show either.
const MARK: char = '\u{feff}';

/// What `--json` prints instead of a result.
#[derive(Serialize)]
struct ErrorObject<'a> {
    error: ErrorBody<'a>,
}

#[derive(Serialize)]
struct ErrorBody<'a> {
    code: &'static str,
    message: &'a str,
    file: Option<&'a str>,
    line: Option<usize>,
    column: Option<usize>,
    key: Option<&'a str>,
    hint: Option<&'a str>,
}

/// Exit code for an error: 2 bad input or usage, 1 a finding, 3 our own fault,
/// 130 interrupted.
pub fn exit_code(code: Code) -> u8 {
    match code {
        Code::NotIdentifiable => 1,
        Code::Interrupted => 130,
        code if code.is_internal() => 3,
        _ => 2,
    }
}

/// Prints an error and gives its exit code.
pub fn report(session: &Session, error: &Error) -> u8 {
    if session.json {
        // A reader that has gone needs no error.
        let _ = session.print_exact(&json(error));
    } else {
        session.print_error(&to_text(session, error));
    }
    exit_code(error.code())
}

/// As [`report`], always as text on standard error: a result stands on standard output.
pub fn report_beside(session: &Session, error: &Error) -> u8 {
    if let Some(captured) = &session.captured {
        captured.borrow_mut().failure = Some(json(error));
    }
    session.print_error(&to_text(session, error));
    exit_code(error.code())
}

/// The error with the option of `command` for the field of the library that it is about, where the command has one of
/// that name: `tolerance_mm` is `--tolerance-mm`. What it says of fields in backticks it says of the options, and a
/// value that is not allowed is a wrong use of the command line.
pub fn into_option_error(error: Error, command: &clap::Command) -> Error {
    let option = |field: &str| {
        let long = field.replace('_', "-");
        let mut options = command.get_arguments().filter_map(clap::Arg::get_long);
        options.any(|name| name == long).then(|| format!("--{long}"))
    };
    let place = error.place();
    let field = place.key.as_deref().filter(|_| place.file.is_none());
    let Some(key) = field.and_then(option) else {
        return error;
    };
    let said = |text: &str| {
        let parts = text.split('`').enumerate().map(|(i, part)| match option(part) {
            Some(option) if i % 2 == 1 => option,
            _ if i % 2 == 1 => format!("`{part}`"),
            _ => part.to_string(),
        });
        parts.collect::<String>()
    };
    let code = match error.code() {
        Code::InvalidValue => Code::Usage,
        code => code,
    };
    let renamed = Error::new(code, said(error.message())).key(key);
    renamed.hint_if(error.hint_text().map(said))
}

/// Prints what clap says: help and version on standard output, usage errors on
/// standard error, or as JSON where the line asks for it.
pub fn usage(stop: &clap::Error, json_wanted: bool, captured: Option<&RefCell<Captured>>) -> u8 {
    let cause = stop.source().and_then(|cause| cause.downcast_ref::<Error>());
    if let Some(cause) = cause {
        let cause = cause.clone().key(argument(stop).unwrap_or_default());
        let [out, err] = match json_wanted {
            true => [json(&cause), String::new()],
            false => [String::new(), draw(&cause, |_| None)],
        };
        match captured {
            Some(captured) => {
                captured.borrow_mut().out += &out;
                captured.borrow_mut().err += &plain(&err);
            }
            // A reader that has gone needs no error.
            None => {
                let _ = std::io::stdout().write_all(out.as_bytes());
                let _ = anstream::stderr().write_all(rendered(&err).as_bytes());
            }
        }
        return exit_code(cause.code());
    }
    let code = u8::try_from(stop.exit_code()).unwrap_or(2);
    if let Some(captured) = captured {
        let mut captured = captured.borrow_mut();
        match (stop.use_stderr(), json_wanted) {
            (false, _) => captured.out += &stop.render().to_string(),
            (true, false) => captured.err += &rendered(&stop.render().to_string()),
            (true, true) => captured.out += &json(&usage_error(stop)),
        }
        return code;
    }
    if !json_wanted || !stop.use_stderr() {
        let text = stop.render().to_string();
        // A reader that has gone needs no help.
        let _ = if text == rendered(&text) {
            stop.print()
        } else {
            // A word of the line that is more than letters, without clap's styles.
            std::io::stderr().write_all(rendered(&text).as_bytes())
        };
        return code;
    }
    let _ = std::io::stdout().write_all(json(&usage_error(stop)).as_bytes());
    code
}

/// The option that clap speaks of.
fn argument(stop: &clap::Error) -> Option<&str> {
    match stop.get(ContextKind::InvalidArg)? {
        // "--index <NAME>"
        ContextValue::String(text) => text.split(' ').next(),
        _ => None,
    }
}

/// What clap says about a line, as an error of ours.
fn usage_error(stop: &clap::Error) -> Error {
    let text = stop.render().to_string();
    let joined = |paragraph: &str| paragraph.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut paragraphs = text.trim().split("\n\n").map(joined);
    let message = paragraphs.next().unwrap_or_default();
    let hint: Vec<String> = paragraphs.filter(|p| !p.starts_with("For more information")).collect();
    let error = Error::new(Code::Usage, message.trim_start_matches("error: "));
    let error = match argument(stop) {
        Some(option) => error.key(option),
        None => error,
    };
    error.hint_if((!hint.is_empty()).then(|| hint.join("; ")))
}

/// Runs `work` without the text that a panic prints: [`catch_panic`] says it better.
pub fn without_panic_text<T>(work: impl FnOnce() -> T) -> T {
    std::panic::set_hook(Box::new(|_| {}));
    let done = work();
    let _ = std::panic::take_hook();
    done
}

/// Runs `work`; a panic becomes an error of its own kind.
///
/// # Errors
/// Those of `work`, and [`Code::Internal`] where it panics.
pub fn catch_panic<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    let ran = catch_unwind(AssertUnwindSafe(work));
    ran.unwrap_or_else(|payload| {
        let said = payload
            .downcast_ref::<String>()
            .map(String::as_str)
            .or_else(|| payload.downcast_ref::<&str>().copied())
            .unwrap_or("no message");
        Err(Error::new(Code::Internal, format!("The program has failed: {said}."))
            .hint("this is a fault of stiffarm, not of your files; please report it with the command you ran"))
    })
}

fn json(error: &Error) -> String {
    let place = error.place();
    let object = ErrorObject {
        error: ErrorBody {
            code: error.code().as_str(),
            message: error.message(),
            file: place.file.as_deref(),
            line: place.line,
            column: place.column,
            key: place.key.as_deref(),
            hint: error.hint_text(),
        },
    };
    to_json(&object).unwrap_or_default()
}

/// The error with the lines of the file it is about, where a command goes on after it.
pub fn to_text(session: &Session, error: &Error) -> String {
    draw(error, |file| session.text_of(file))
}

/// The error with the lines of the file it is about.
fn draw(error: &Error, text_of: impl Fn(&str) -> Option<String>) -> String {
    let place = error.place();
    let text = place.file.as_deref().and_then(text_of);
    let shown = text.filter(|text| !text.trim().is_empty());
    let shown = shown.and_then(|text| Some((span(error, &text)?, text)));
    let mut message = error.message().to_string();
    if shown.is_none() {
        message = match &place.key {
            Some(key) => format!("{key}: {message}"),
            None => message,
        };
        message = match (&place.file, place.line, place.column) {
            (Some(file), Some(line), Some(column)) => format!("{file}:{line}:{column}: {message}"),
            (Some(file), Some(line), None) => format!("{file}:{line}: {message}"),
            (Some(file), None, _) => format!("{file}: {message}"),
            (None, ..) => message,
        };
    }
    let (red, cyan) = (AnsiColor::Red.on_default(), AnsiColor::Cyan.on_default());
    let code = paint(red, error.code().as_str());
    let message = message.replace('\n', "\n    ");
    let mut out = format!("{code}\n\n  {} {message}\n", paint(red, "×"));
    if let Some((span, text)) = shown {
        let bare = text.trim_start_matches(MARK);
        let mark = text.len() - bare.len();
        let span = span.start.saturating_sub(mark)..span.end.saturating_sub(mark);
        let file = place.file.as_deref().unwrap_or_default();
        out += &excerpt(file, bare, span, place.key.as_deref());
    }
    if let Some(hint) = error.hint_text() {
        out += &format!("{}{hint}\n", paint(cyan, "  help: "));
    }
    out
}

/// Bytes of `text` that the error is about: its own span, else the field of a
/// table that begins at its line and column.
fn span(error: &Error, text: &str) -> Option<Range<usize>> {
    let place = error.place();
    if let Some(span) = &place.span {
        return (span.end <= text.len()).then(|| span.clone());
    }
    let line = text.split_inclusive('\n').nth(place.line?.checked_sub(1)?)?;
    let start = line.as_ptr() as usize - text.as_ptr() as usize;
    let bare = line.trim_start_matches(MARK);
    let mark = line.len() - bare.len();
    let content = bare.trim_end_matches(['\n', '\r']);
    let Some(column) = place.column else {
        return Some(start + mark..start + mark + content.len());
    };
    let at = content.char_indices().nth(column.checked_sub(1)?).map_or(content.len(), |(at, _)| at);
    let field = &content[at..];
    let length = field.find([',', ';', '\t']).unwrap_or(field.len());
    Some(start + mark + at..start + mark + at + length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_field_of_a_table_is_found_behind_a_byte_order_mark_and_umlauts() {
        let text = "\u{feff}posture,q1_deg\r\nä,12x\r\n";
        let at = |line, column| {
            let error = Error::new(Code::TableRow, "x").line(line, column);
            span(&error, text).map(|span| text[span].to_string())
        };
        assert_eq!(at(1, Some(1)).as_deref(), Some("posture"));
        assert_eq!(at(2, Some(3)).as_deref(), Some("12x"));
        assert_eq!(at(2, None).as_deref(), Some("ä,12x"));
        assert_eq!(at(9, Some(1)), None);
    }

    #[test]
    fn a_field_of_the_library_is_an_option_of_the_command() {
        let command = clap::Command::new("x").args(["near-deg", "axes"].map(|long| clap::Arg::new(long).long(long)));
        let wrong = Error::invalid("Wrong `axes`, not `tool`.").hint("give `near_deg`");
        let key = |e: &Error| e.place().key.clone();
        let usage = into_option_error(wrong.clone().key("near_deg"), &command);
        assert_eq!(key(&usage).as_deref(), Some("--near-deg"));
        assert_eq!(usage.code(), Code::Usage);
        let said = (usage.message(), usage.hint_text());
        assert_eq!(said, ("Wrong --axes, not `tool`.", Some("give --near-deg")));
        // A key of a file is no option, nor is what the command does not have.
        for other in [wrong.clone().key("axes").file("cell.toml"), wrong.key("rounds")] {
            let same = into_option_error(other.clone(), &command);
            let parts = |e: &Error| (e.code(), key(e), e.message().to_string());
            assert_eq!(parts(&same), parts(&other));
        }
    }

    #[test]
    fn a_panic_becomes_an_error_of_its_own_kind() {
        let fault = catch_panic(|| -> Result<()> { panic!("index {} out of range", 7) }).unwrap_err();
        assert_eq!((fault.code(), exit_code(fault.code())), (Code::Internal, 3));
        assert!(fault.message().contains("index 7 out of range"));
        assert!(catch_panic(|| Ok(1)).is_ok());
    }
}
