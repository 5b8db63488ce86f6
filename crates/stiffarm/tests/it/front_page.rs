//! The crate's front page shows the example, to the letter.

#[test]
fn the_first_doc_example_is_the_main_job() {
    let page = include_str!("../../src/lib.rs");
    let example = include_str!("../../examples/main_job.rs");
    let (_, from_fence) = page.split_once("//! ```\n").unwrap();
    let (shown, _) = from_fence.split_once("//! ```\n").unwrap();
    let lines = shown.lines().map(|line| {
        let line = line.strip_prefix("//!").unwrap();
        line.strip_prefix(' ').unwrap_or(line)
    });
    let code = example.lines().skip_while(|line| !line.starts_with("use "));
    assert!(lines.eq(code.clone()));
    let counted = code.filter(|l| !l.trim().is_empty() && !l.trim().starts_with("//"));
    assert!(counted.count() <= 20);
}
