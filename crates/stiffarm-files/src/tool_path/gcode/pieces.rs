//! How a block is written as several straight moves.

use super::effect::{Effect, Feeds, Mode};
use super::words::Word;
use super::{Block, State};
use crate::tool_path::Divided;

impl State<'_, '_> {
    /// Keeps how a block would be written as several straight moves; behind the points `waits` it waits as `wait` says.
    pub(super) fn pieces(
        &mut self,
        block: &Block<'_, '_>,
        points: std::ops::Range<usize>,
        is_whole: bool,
        (waits, wait): (Vec<usize>, String),
    ) {
        let (words, text) = (block.words, &block.file.text);
        let begins = words.iter().map(|word| word.place.position()).min();
        let begins = begins.unwrap_or(0);
        let ends = words.iter().map(|word| word.end).max().unwrap_or(begins);
        let is_inverse = self.feeds == Feeds::Inverse;
        let is_kept = |word: &Word<'_>| match word.letter {
            b'N' | b'X'..=b'Z' | b'I'..=b'K' | b'R' => false,
            b'A'..=b'C' => word.index != 3,
            b'G' => !word.row.is_some_and(|row| matches!(row.effect, Effect::Moves(_))),
            b'F' => !is_inverse,
            b'P' | b'Q' | b'L' => matches!(self.mode, Some(Mode::Rapid | Mode::Feed)),
            0 => !word.is(Effect::Turns),
            _ => true,
        };
        // What stops or ends does so behind the move, and G9 at its end.
        let is_last = |word: &Word<'_>| {
            word.is(Effect::Stops) || word.is(Effect::Ends) || word.letter == b'G' && word.number.value == 9.0
        };
        let (mut end, mut last) = (String::new(), String::new());
        for word in words.iter().filter(|word| is_kept(word)) {
            let side = if is_last(word) { &mut last } else { &mut end };
            *side += &format!(" {}", word.text(text));
        }
        // Comments between words are behind them then.
        let comments = &block.beside.comments;
        if comments.trim_start().starts_with('(') && text[begins..ends].contains('(') {
            end += comments;
        }
        self.builder.divided.push(Divided {
            points,
            is_whole,
            text: begins..ends,
            first: block.word(b'N').map_or_else(String::new, |word| format!("{} ", word.text(text))),
            others: if block.beside.is_optional { "/" } else { "" },
            begin: "G1".to_string(),
            begin_rapid: "G0",
            end,
            last,
            waits,
            wait,
            inverse: block.value(b'F').filter(|_| is_inverse),
        });
    }
}
