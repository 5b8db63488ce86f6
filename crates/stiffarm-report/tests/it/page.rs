//! A page keeps names as text, ids unique, and says of each number where it comes from.

use stiffarm::findings::{Finding, Severity};
use stiffarm_report::page::{Block, DataTable, Number, Outcome, Page, Part, Provenance, Section, Text, render_page};
use stiffarm_report::summary::Quantity;
use stiffarm_report::{Axis, Figure, Panel, Series, Style};

const HOSTILE: &str = "</script><img src=x onerror=alert(1)>\"'&amp;\u{202e}\u{1b}[31m";

fn figure(id: &str, label: &str) -> Figure {
    Figure {
        id: id.into(),
        title: label.into(),
        caption: format!("About {label}."),
        columns: 1,
        panels: vec![Panel {
            title: label.into(),
            x: Axis::categorical("joint", [label, "joint 2"]),
            y: Axis::linear("deviation", "%"),
            series: vec![
                Series::new(label, Style::Bars, vec![0.0, 1.0], vec![2.0, 3.5]),
                Series::new("theory", Style::Dashed, vec![0.0, 1.0], vec![2.5, 3.0]),
            ],
            equal_aspect: false,
        }],
    }
}

fn part(name: &str) -> Part {
    let mut key = DataTable::new(format!("Key of {name}"), ["joint", "k [10⁶ N·m/rad]", "said"]);
    let number = Number::new(942_757.625).of(Quantity::STIFFNESS.bare());
    key.row(name, [number.decimals(3).into(), Text::new("").strong(name)]);
    let missing = Number::new(None).of(Quantity::STIFFNESS);
    key.row("joint 2", [missing.into(), Text::new("").code(name)]);
    Part {
        command: "identify".into(),
        heading: format!("Stiffness of {name}"),
        name: name.into(),
        outcome: Outcome::Caution,
        verdict: [
            Text::from(name),
            Text::new("It bends by ").number(Number::new(1.25e-4).of(Quantity::LENGTH).plus_minus()),
            Text::from("Measure on."),
        ],
        warnings: vec![
            Finding::new("a", Severity::Caution, name, format!("`{name}` is odd.")),
            Finding::new("b", Severity::Serious, name, "It is wrong."),
        ],
        key: Some(key),
        sections: vec![
            Section::new("one", name, vec![Block::Figure(figure("f", name)), Block::Text(name.into())]),
            Section::new("two", "Two", vec![Block::Details(name.into(), vec![Block::Figure(figure("g", name))])]),
            Section::new("three", "Three", vec![Block::Figures(vec![figure("h", name), figure("i", name)])]),
        ],
        provenance: Provenance {
            version: "0.1.0".into(),
            seed: Some(1),
            command_line: format!("stiffarm identify {name}"),
            inputs: vec![(name.into(), "ab".into())],
            options: vec![(name.into(), name.into())],
        },
    }
}

fn page(parts: Vec<Part>) -> Page {
    Page { title: HOSTILE.into(), subtitle: HOSTILE.into(), comparison: None, parts }
}

/// Values of an attribute, in order.
fn attributes<'a>(html: &'a str, name: &str) -> Vec<&'a str> {
    let begin = format!(" {name}=\"");
    let values = html.match_indices(&begin).map(|(at, _)| {
        let rest = &html[at + begin.len()..];
        &rest[..rest.find('"').unwrap()]
    });
    values.collect()
}

#[test]
fn names_of_other_people_stay_text() {
    let html = render_page(&page(vec![part(HOSTILE)]));
    assert!(!html.contains("<img"));
    assert!(html.contains("&lt;/script&gt;&lt;img src=x onerror=alert(1)&gt;"));
    for hidden in ['\u{1b}', '\u{202e}'] {
        let at = html.find(hidden).map(|at| &html[at.saturating_sub(200)..at]);
        assert_eq!(at, None, "{hidden:?}");
    }
    // One script, the page's own, and it ends where it ends.
    assert_eq!(html.matches("<script").count(), 1);
    assert_eq!(html.matches("</script").count(), 1);
}

#[test]
fn ids_are_unique_and_links_lead_somewhere() {
    let html = render_page(&page(vec![part("a"), part("b")]));
    let mut ids = attributes(&html, "id");
    for link in attributes(&html, "href") {
        assert!(ids.contains(&&link[1..]), "{link}");
    }
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count);
}

#[test]
fn numbers_of_the_result_keep_their_full_value() {
    let html = render_page(&page(vec![part("a")]));
    let numbers: Vec<&str> =
        html.split("<span class=\"n\"").skip(1).map(|rest| rest.split_once("</").unwrap().0).collect();
    insta::assert_snapshot!(numbers.join("\n"), @r#"
    data-value="0.000125" data-factor="1000">± 0.1250 mm
    data-value="942757.625" data-factor="0.000001">0.943
    data-value="null" data-factor="0.000001">–
    "#);
    let several = render_page(&page(vec![part("a"), part("b")]));
    assert_eq!(attributes(&several, "data-command"), ["report", "identify", "identify"]);
    assert_eq!(attributes(&several, "data-result"), ["0", "1"]);
}

#[test]
fn what_is_serious_stands_before_the_key_table_and_cautions_behind() {
    let html = render_page(&page(vec![part("a")]));
    let at = |words: &str| html.find(words).unwrap();
    assert!(at("It is wrong.") < at("Key of a"));
    assert!(at("Key of a") < at("<code class=\"short\">a</code> is odd."));
    assert_eq!(html.matches("Look at the cautions").count(), 1);
}

#[test]
fn nothing_is_asked_of_the_network() {
    let html = render_page(&page(vec![part("a")]));
    assert!(html.contains("default-src 'none'"));
    for word in ["src=\"http", "href=\"http", "@import", "url(", "fetch("] {
        assert!(!html.contains(word), "{word}");
    }
}

#[test]
fn a_chart_has_a_form_for_narrow_screens_and_its_data_behind() {
    let html = render_page(&page(vec![part("a")]));
    let charts = attributes(&html, "data-figure");
    assert_eq!(charts, ["f", "f", "g", "g", "h", "h", "i", "i"]);
    assert_eq!(html.matches("<summary>Data of this figure</summary>").count(), 4);
    assert!(html.contains("data-toggle-series=\"theory\" role=\"button\" tabindex=\"0\" aria-pressed=\"true\""));
    let mut tips = attributes(&html, "data-tip");
    tips.sort_unstable();
    tips.dedup();
    assert_eq!(tips, ["a · a: 2 %", "a · joint 2: 3.5 %", "theory · a: 2.5 %", "theory · joint 2: 3 %"]);
}
