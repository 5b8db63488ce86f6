//! Comments of CL data that say something.

use super::statement::goes_on;
use super::{State, System};
use crate::program::Cursor;
use stiffarm::findings::Severity;

/// Lines that belong to no statement.
#[derive(Default)]
pub(super) struct Comment {
    /// The next line is a part of what was passed.
    pub goes_on: bool,
    /// Text of a frame that Creo gives in a comment, and the line where it begins.
    frame: Option<(String, usize)>,
    /// The first of them.
    first: Option<String>,
}

impl Comment {
    /// Whether a line is a comment, or the rest of what does not count.
    pub fn takes(&mut self, line: &Cursor<'_>, state: &mut State<'_, '_>) -> bool {
        let rest = line.rest();
        let number = line.line_number();
        let text = rest.strip_prefix("$$");
        if std::mem::take(&mut self.goes_on) {
            self.goes_on = goes_on(rest);
        } else if let Some(note) = text.and_then(|text| text.strip_prefix("->")) {
            // These alone go on behind `$`.
            self.goes_on = goes_on(note);
            state.system = state.system.or(Some(System::Creo));
            if note.trim_start().starts_with("CSYS") {
                self.frame = Some((String::new(), number));
            }
        } else if let Some(text) = text {
            if text.contains("Pro/CLfile") {
                state.system = Some(System::Creo);
            }
            return true;
        } else {
            return false;
        }
        if let Some((frame, begin)) = &mut self.frame {
            frame.extend(rest.chars().filter(|c| c.is_ascii_digit() || "-.,".contains(*c)));
            if !self.goes_on {
                let (frame, begin) = (std::mem::take(frame), *begin);
                self.frame = None;
                let frame = frame.trim_start_matches(['-', ',']).to_string();
                if *self.first.get_or_insert_with(|| frame.clone()) != frame {
                    state.builder.remark("set-up", "", begin, Severity::Caution, || {
                        "The frame that the file names in comments (`CSYS`) is another one ({}): all points are read \
                         in one frame."
                            .to_string()
                    });
                }
            }
        }
        true
    }
}
