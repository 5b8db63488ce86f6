//! Lines of a table as text.

/// One line of a table, with quotation marks where a field needs them.
pub(crate) fn line(fields: &[String]) -> String {
    separated(fields, ',')
}

/// The same with columns separated by `separator`: a comma, a semicolon or a tab.
pub(super) fn separated(fields: &[String], separator: char) -> String {
    let quoted = |field: &String| {
        let mut special = vec![separator, '"', '\n', '\r'];
        if separator == ',' {
            special.push(';');
        }
        // A name that begins with # would make its line a comment.
        if field.contains(special.as_slice()) || field.starts_with('#') {
            format!("\"{}\"", field.replace('"', "\"\""))
        } else {
            field.clone()
        }
    };
    let fields: Vec<String> = fields.iter().map(quoted).collect();
    fields.join(separator.to_string().as_str()) + "\n"
}
