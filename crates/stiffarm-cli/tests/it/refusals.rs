//! Every line of `refusals.toml` is refused with its code and its place, before anything is written; one snapshot holds what
//! is said of all of them.

use crate::support;

#[path = "../../../stiffarm/tests/refusals/rows.rs"]
mod rows;

use insta::assert_snapshot;
use rows::rows;
use support::{Folder, place};

#[test]
fn what_the_command_refuses() {
    let mut said = String::new();
    for row in rows() {
        let folder = Folder::new();
        let inputs = row.inputs();
        inputs.iter().for_each(|(name, bytes)| folder.write(name, bytes));
        let error = folder.error(&row.line);
        assert_eq!((error["code"].as_str(), place(&error)), (Some(&*row.code), row.at), "{}: {error}", row.what);
        said += &format!("{}\n$ stiffarm {}\n{}\n", row.what, row.line, folder.refused(&row.line));
        assert!(folder.names().iter().eq(inputs.keys()), "{}: {:?}", row.what, folder.names());
    }
    assert_snapshot!(said);
}
