//! Files of `refusals.toml` that the library reads by itself are refused with the code and the place that the command tells.

#[path = "../refusals/rows.rs"]
mod rows;

use rows::rows;
use std::collections::BTreeMap;
use stiffarm::{Code, Error, Result};
use stiffarm_files::builtin;
use stiffarm_files::source::{Source, read_cell, read_groups, read_measurements, read_path, read_stiffness};

/// Built-in files, and those of a row.
struct Memory(BTreeMap<String, Vec<u8>>);

impl Source for Memory {
    fn read(&self, _: &str, from: &str) -> Result<(String, Vec<u8>)> {
        let bytes = match from.strip_prefix(builtin::PREFIX) {
            Some(name) => Some(builtin::bytes(name)?.to_vec()),
            None => self.0.get(from).cloned(),
        };
        let missing = || Error::new(Code::FileRead, "There is no such file.").file(from);
        Ok((from.to_string(), bytes.ok_or_else(missing)?))
    }
}

/// `file:line:column key`, as much of it as there is.
fn place(error: &Error) -> String {
    let place = error.place();
    let numbers = [place.line, place.column].map(|number| number.map_or(String::new(), |number| format!(":{number}")));
    let [file, key] = [&place.file, &place.key].map(|part| part.as_deref().unwrap_or_default());
    format!("{file}{} {key}", numbers.concat()).trim().to_string()
}

#[test]
fn what_the_readers_refuse() {
    let mut read = 0;
    for row in rows().iter().filter(|row| row.reader.is_some()) {
        let memory = Memory(row.inputs());
        let words: Vec<&str> = row.line.split(' ').collect();
        let cell = |from: &str| read_cell(&memory, from).map(|named| named.cell);
        let refused = match row.reader.as_deref().unwrap() {
            "cell" => cell(words[1]).map(drop),
            "postures" => {
                let robot = cell(words[1]).unwrap().setup.robot;
                read_groups(&memory, &[words[2].to_string()], &robot).map(drop)
            }
            "measurements" => {
                read_measurements(&memory, &[words[2].to_string()], None, &cell(words[1]).unwrap()).map(drop)
            }
            "stiffness" => read_stiffness(&memory, words[2], &cell(words[1]).unwrap()).map(drop),
            "path" => read_path(&memory, words[3], &cell(words[1]).unwrap(), None, None, None).map(drop),
            other => panic!("{}: nothing reads {other}", row.what),
        };
        let error = refused.expect_err(&row.what);
        assert_eq!((error.code().as_str(), place(&error)), (&*row.code, row.at.clone()), "{}: {error}", row.what);
        read += 1;
    }
    assert!(read > 25, "{read}");
}
