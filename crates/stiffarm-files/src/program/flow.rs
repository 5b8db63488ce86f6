//! Statements in the order in which they run.
//!
//! The order of the file is not that of execution: a procedure runs where it is called, as often as it is called,
//! and one that nobody calls does not. Conditions and loops are not followed; the reader says so.

use super::ProgramFile;
use super::cursor::Cursor;
use super::reader::Reader;
use std::collections::HashMap;
use stiffarm::error::Result;
use stiffarm::findings::Severity;

/// Most statements that run; procedures that call each other twice grow without end.
const MOST_STATEMENTS: usize = 5_000_000;

/// How procedures stand in a language.
pub struct Procedures {
    /// The statements of a file.
    pub statements: for<'a> fn(&'a ProgramFile) -> Vec<Cursor<'a>>,
    /// Words before those that begin a procedure.
    pub scopes: &'static [&'static str],
    /// Words that begin one; a name and a bracket follow.
    pub begin: &'static [&'static str],
    /// Words that end one.
    pub end: &'static [&'static str],
    /// Words of other blocks that the same word ends.
    pub blocks: &'static [&'static str],
    /// Words behind which a procedure goes on only after an error.
    pub handlers: &'static [&'static str],
    /// Whether the first of the file is the one that is started; else it is `main`, or who is not called.
    pub first_is_main: bool,
    /// The name that a statement calls, if it is a call.
    pub call: for<'a> fn(&Cursor<'a>) -> Option<&'a str>,
}

struct Procedure<'a> {
    name: String,
    head: Cursor<'a>,
    body: Vec<Cursor<'a>>,
}

/// A program by procedures.
#[derive(Default)]
struct Flow<'a> {
    /// What stands outside of all procedures.
    outside: Vec<Cursor<'a>>,
    all: Vec<Procedure<'a>>,
    by_name: HashMap<String, usize>,
    /// What runs, by now.
    order: Vec<Cursor<'a>>,
    has_run: Vec<bool>,
}

impl Procedures {
    /// The name of the procedure that the statement begins.
    fn begins<'a>(&self, statement: &Cursor<'a>) -> Option<&'a str> {
        let mut line = statement.clone();
        while self.scopes.iter().any(|scope| line.word(scope)) {}
        if !self.begin.iter().any(|word| line.word(word)) {
            return None;
        }
        let head = line.rest().split(['(', '\n']).next()?;
        head.split_whitespace().next_back()
    }

    fn is_one_of(words: &[&str], statement: &Cursor<'_>) -> bool {
        words.iter().any(|word| statement.clone().word(word))
    }
}

/// The statements of `files` in the order in which they run; `moves` are the words of moves.
pub fn order<'a>(
    files: &[&'a ProgramFile],
    procedures: &Procedures,
    moves: &[&str],
    reader: &mut Reader<'a>,
) -> Result<Vec<Cursor<'a>>> {
    let mut flow = Flow::default();
    // What stands beside a program is known before it runs.
    for (index, file) in (0..).zip(files).collect::<Vec<_>>().into_iter().rev() {
        let statements = (procedures.statements)(file).into_iter();
        flow.sort(procedures, statements.map(|one| one.in_file(index)));
    }
    flow.has_run = vec![false; flow.all.len()];
    let outside = std::mem::take(&mut flow.outside);
    flow.run(&outside, None, procedures, &mut Vec::new(), reader)?;
    if !flow.has_run.contains(&true) {
        let started = flow.started(procedures);
        for index in &started {
            flow.enter(*index, procedures, &mut Vec::new(), reader)?;
        }
        let names = started.iter().map(|index| &flow.all[*index]);
        let moving: Vec<&Procedure<'_>> = names.filter(|procedure| procedure.has(moves)).collect();
        if let [first, .., last] = &moving[..] {
            let sentence = format!(
                "Nothing in the file calls its procedures {} to {} ({{}}): they are read in the order of the file, and \
                 the robot may drive them in another.",
                first.name, last.name
            );
            reader.remark("procedure-order", "", &first.head, Severity::Caution, sentence);
        }
    }
    for (procedure, has_run) in flow.all.iter().zip(&flow.has_run) {
        if !has_run && procedure.has(moves) {
            let sentence = format!(
                "The procedure {} ({{}}) is called by nothing that is read: its moves are no part of the path.",
                procedure.name
            );
            reader.remark("procedure-uncalled", &procedure.name, &procedure.head, Severity::Caution, sentence);
        }
    }
    Ok(flow.order)
}

impl<'a> Procedure<'a> {
    /// Whether it has a statement that begins with one of these words.
    fn has(&self, words: &[&str]) -> bool {
        let mut body = self.body.iter();
        body.any(|statement| Procedures::is_one_of(words, statement))
    }
}

impl<'a> Flow<'a> {
    /// Takes the statements apart into procedures and what is outside of them.
    fn sort(&mut self, procedures: &Procedures, statements: impl Iterator<Item = Cursor<'a>>) {
        // Procedures that are open, with their open blocks; and where one handles errors.
        let mut open: Vec<(usize, usize)> = Vec::new();
        let mut handles = false;
        for statement in statements {
            if let Some(name) = procedures.begins(&statement) {
                self.by_name.insert(name.to_ascii_uppercase(), self.all.len());
                open.push((self.all.len(), 0));
                handles = false;
                self.all.push(Procedure { name: name.to_string(), head: statement, body: Vec::new() });
            } else if let Some((index, blocks)) = open.last_mut() {
                let ends = Procedures::is_one_of(procedures.end, &statement);
                if ends && *blocks == 0 {
                    open.pop();
                    continue;
                }
                if ends {
                    *blocks -= 1;
                } else if Procedures::is_one_of(procedures.blocks, &statement) {
                    *blocks += 1;
                }
                handles |= Procedures::is_one_of(procedures.handlers, &statement);
                if !handles {
                    self.all[*index].body.push(statement);
                }
            } else {
                self.outside.push(statement);
            }
        }
    }

    /// The procedures that are started where nothing outside of them calls one.
    fn started(&self, procedures: &Procedures) -> Vec<usize> {
        let main = self.by_name.get("MAIN").copied();
        let first = procedures.first_is_main && !self.all.is_empty();
        if let Some(main) = main.or(first.then_some(0)) {
            return vec![main];
        }
        let mut is_called = vec![false; self.all.len()];
        for (at, procedure) in self.all.iter().enumerate() {
            let called = procedure.body.iter().filter_map(|one| self.called(one, procedures));
            for other in called.filter(|other| *other != at) {
                is_called[other] = true;
            }
        }
        let free: Vec<usize> = (0..self.all.len()).filter(|at| !is_called[*at]).collect();
        // Procedures that call each other in a circle have none that is first.
        if free.is_empty() { (0..self.all.len()).take(1).collect() } else { free }
    }

    fn called(&self, statement: &Cursor<'a>, procedures: &Procedures) -> Option<usize> {
        let name = (procedures.call)(statement)?;
        self.by_name.get(&name.to_ascii_uppercase()).copied()
    }

    fn enter(
        &mut self,
        index: usize,
        procedures: &Procedures,
        open: &mut Vec<usize>,
        reader: &mut Reader<'a>,
    ) -> Result<()> {
        let head = self.all[index].head.clone();
        if open.contains(&index) {
            reader.passes_over(&head, &format!("The procedure {}, which calls itself,", self.all[index].name));
            return Ok(());
        }
        open.push(index);
        self.has_run[index] = true;
        let body = std::mem::take(&mut self.all[index].body);
        self.order.push(head.clone());
        let run = self.run(&body, Some(&head), procedures, open, reader);
        self.all[index].body = body;
        open.pop();
        run
    }

    fn run(
        &mut self,
        body: &[Cursor<'a>],
        head: Option<&Cursor<'a>>,
        procedures: &Procedures,
        open: &mut Vec<usize>,
        reader: &mut Reader<'a>,
    ) -> Result<()> {
        for statement in body {
            match self.called(statement, procedures) {
                Some(index) => {
                    self.enter(index, procedures, open, reader)?;
                    // What follows belongs to the caller again.
                    self.order.extend(head.cloned());
                }
                None => self.order.push(statement.clone()),
            }
            if self.order.len() > MOST_STATEMENTS {
                let message = "Calls of procedures make more than 5 000 000 statements of this.";
                return Err(statement.wrong(message));
            }
        }
        Ok(())
    }
}
