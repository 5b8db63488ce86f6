//! A program out of the files of a language: lines that are looked for, one after the other.

use super::cursor::{Cursor, lines};
use super::dialect::{Dialect, Syntax};
use super::flow;
use super::reader::{Reader, only};
use super::{Program, ProgramFile, ProgramOptions};
use stiffarm::error::{Code, Error, Result};

/// Reads a program of `joints` joints.
pub fn read(
    files: &[ProgramFile],
    dialect: &'static Dialect,
    syntax: &Syntax,
    options: &ProgramOptions,
    joints: usize,
) -> Result<Program> {
    let mut reader = Reader::new(options, joints, dialect.axis_name);
    read_lines(in_order(files, dialect, syntax)?, syntax, &mut reader)?;
    reader.program(syntax.missing_point)
}

/// Reads the lines of `files`; those of a path in the order in which they run.
pub fn read_lines<'a>(files: Vec<&'a ProgramFile>, syntax: &Syntax, reader: &mut Reader<'a>) -> Result<()> {
    match syntax.procedures.as_ref().filter(|_| reader.is_path) {
        Some(procedures) => {
            let moves = [&[syntax.joint_move], syntax.other_moves].concat();
            let order = flow::order(&files, procedures, &moves, reader)?;
            order.into_iter().try_for_each(|line| read_line(line, syntax, reader))
        }
        None => (0..).zip(files).try_for_each(|(index, file)| {
            lines(file).try_for_each(|line| read_line(line.in_file(index), syntax, reader))
        }),
    }
}

fn read_line<'a>(mut line: Cursor<'a>, syntax: &Syntax, reader: &mut Reader<'a>) -> Result<()> {
    if (syntax.read)(&mut line, reader)? {
        return Ok(());
    }
    let is_next = |word: &&&str| line.clone().word(word);
    if let Some(word) = syntax.branches.iter().find(is_next) {
        reader.passes_over(&line, word);
    } else if let Some(word) = syntax.other_moves.iter().find(is_next) {
        let joint_move = syntax.joint_move;
        let message = if reader.is_path {
            format!("{word} is a move that is not read here.")
        } else {
            format!("{word} does not move to joint angles, as {joint_move} does.")
        };
        return Err(line.wrong_here(message));
    }
    Ok(())
}

/// The files in the order of the language.
fn in_order<'a>(files: &'a [ProgramFile], dialect: &Dialect, syntax: &Syntax) -> Result<Vec<&'a ProgramFile>> {
    let title = dialect.title;
    if syntax.files.len() == 1 {
        return Ok(vec![only(files, title)?]);
    }
    let extensions = syntax.files.iter().map(|(extension, _)| format!(".{extension}"));
    let extensions: Vec<String> = extensions.collect();
    let of = |extension: &String| {
        let mut files = files.iter();
        let matching = files.find(|file| file.name.to_ascii_lowercase().ends_with(extension));
        matching.ok_or_else(|| {
            let parts = extensions.join(" and a ");
            let message = format!("A program in {title} is a {parts}; there is no {extension}.");
            Error::new(Code::Usage, message).hint("give all its files")
        })
    };
    extensions.iter().map(of).collect()
}
