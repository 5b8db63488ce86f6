//! What is not the same in how results were made.

use crate::order::in_order;
use crate::page::{DataTable, Part, Text};

/// Inputs, seed and options that are not the same in all results.
pub(super) fn made_differently(parts: &[(usize, &Part)]) -> DataTable {
    let names = parts.iter().map(|(_, part)| part.name.clone());
    let headings = std::iter::once("made with".to_string()).chain(names);
    let mut table = DataTable::new("How they were made differently", headings);
    let mut add = |name: String, values: Vec<String>| {
        if values.iter().any(|value| *value != values[0]) {
            table.row(name, values.into_iter().map(Text::from));
        }
    };
    let seed = |part: &Part| {
        let seed = part.provenance.seed;
        seed.map_or_else(|| "–".to_string(), |seed| seed.to_string())
    };
    add("version".to_string(), parts.iter().map(|(_, p)| p.provenance.version.clone()).collect());
    add("seed".to_string(), parts.iter().map(|(_, p)| seed(p)).collect());
    let inputs = |part: &Part| part.provenance.inputs.clone();
    let options = |part: &Part| part.provenance.options.clone();
    for (word, list) in [("input", &inputs as &dyn Fn(&Part) -> Vec<(String, String)>), ("option", &options)] {
        let lists: Vec<_> = parts.iter().map(|(_, part)| list(part)).collect();
        for name in names_of(&lists) {
            let values = lists.iter().map(|list| {
                let pair = list.iter().find(|(key, _)| key == name);
                let value = pair.map_or("–", |(_, value)| value.as_str());
                match word {
                    // Enough of a hash to tell files apart.
                    "input" => value.chars().take(12).collect(),
                    _ => value.to_string(),
                }
            });
            add(format!("{word} {name}"), values.collect());
        }
    }
    table
}

/// Names in any of several lists, each once, in order.
fn names_of(lists: &[Vec<(String, String)>]) -> Vec<&String> {
    in_order(lists.iter().flatten().map(|(name, _)| name))
}
