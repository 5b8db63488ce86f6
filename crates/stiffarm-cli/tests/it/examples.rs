//! Every example of every help runs, in the order of the helps, in one folder.

use crate::support;

use support::Folder;

/// Commands that `stiffarm --help` lists, and the hidden one.
fn commands(folder: &Folder) -> Vec<String> {
    let help = folder.ok("--help");
    // What it is, how it is called, and the commands by groups.
    let list = help.split("\n\n").nth(2).unwrap();
    assert!(list.starts_with("Plan:"), "{list}");
    // Names stand two spaces from the edge, wrapped descriptions further in.
    let named = list.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let mut names: Vec<String> = named.map(|line| line.split_whitespace().next().unwrap().to_string()).collect();
    names.push("docs".to_string());
    names
}

/// What a person reads fits 80 columns; objects, generated pages and lines to copy are what they are.
fn fits(line: &str, out: &str) {
    let is_for_people = !["--json", "schema", "docs", "completions", "man"].iter().any(|word| line.contains(word));
    for shown in out.lines().filter(|_| is_for_people) {
        let width = shown.chars().count();
        assert!(width <= 80 || shown.contains(" = ["), "{line}: {width}: {shown}");
    }
}

#[test]
fn every_help_ends_with_examples_and_they_run() {
    let folder = Folder::new();
    let names = commands(&folder);
    assert!(names.len() >= 13, "{names:?}");
    for name in &names {
        let help = folder.ok(&format!("{name} --help"));
        let (_, examples) =
            help.rsplit_once("\n\nExamples:\n").unwrap_or_else(|| panic!("{name}: no examples\n{help}"));
        let typed = |line: &&str| line.starts_with("  $") || line.starts_with("      ");
        for line in examples.lines().filter(typed) {
            assert!(line.len() <= 80, "too wide: {line}");
        }
        // As in a shell, a line that ends in a backslash goes on.
        let joined = examples.replace("\\\n", " ");
        let lines: Vec<String> = joined
            .lines()
            .filter_map(|line| line.trim().strip_prefix("$ stiffarm "))
            .map(|line| line.split_whitespace().collect::<Vec<&str>>().join(" "))
            .collect();
        assert!(!lines.is_empty(), "{name}: {examples}");
        for line in &lines {
            assert!(line.starts_with(name.as_str()), "{name}: {line}");
            let out = folder.ok(line);
            assert!(!out.is_empty() || line.contains("--output"), "{line}");
            fits(line, &out);
        }
    }
}

#[test]
fn the_generated_pages_hold_every_command_and_every_code() {
    let folder = Folder::new();
    let names = commands(&folder);
    let page = folder.ok("docs commands");
    let page: Vec<serde_json::Value> = serde_json::from_str(&page).unwrap();
    let described: Vec<&str> = page.iter().map(|c| c["name"].as_str().unwrap()).collect();
    for name in names {
        // Python has no use for these.
        let is_left_out = ["docs", "completions", "man"].contains(&name.as_str());
        assert_ne!(described.contains(&name.as_str()), is_left_out, "{name}");
    }
    let errors = folder.ok("docs errors");
    for code in stiffarm::Code::ALL {
        assert!(errors.contains(&format!("| `{}` |", code.as_str())), "{code:?}");
    }
}
