//! The files that are made from the code, as one JSON object, path to text: what `cargo xtask generate` writes.

use std::collections::BTreeMap;
use stiffarm_files::envelope::to_json;

fn main() -> stiffarm::Result<()> {
    let mut files = BTreeMap::new();
    let words = ["stiffarm", "docs", "errors"].map(Into::into);
    let errors = stiffarm_cli::run_captured(&words, Default::default());
    assert_eq!(errors.code, 0, "{}", errors.err);
    files.insert("docs/errors.md".to_string(), errors.out);
    let words = stiffarm_files::tool_path::gcode_page();
    files.insert("docs/gcode.md".to_string(), words);
    for (name, text) in stiffarm_cli::schemas()? {
        if name == "cell" {
            // Where people and editors read it.
            files.insert("docs/cell.schema.json".to_string(), text.clone());
        }
        files.insert(format!("crates/stiffarm-cli/schemas/{name}.json"), text);
    }
    print!("{}", to_json(&files)?);
    Ok(())
}
