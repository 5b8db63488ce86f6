//! Texts are written in characters that every controller shows.

use super::*;
use stiffarm_files::internals::{plain, wrapped};

#[test]
fn texts_keep_what_can_be_shown() {
    assert_eq!(plain("Größe \"A\";\n45°"), "Groesse _A__ 45 deg");
    assert_eq!(wrapped("measure unloaded, loaded", 10), ["measure", "unloaded,", "loaded"]);
    assert_eq!(wrapped("abcdefghij kl", 4), ["abcd", "efgh", "ij", "kl"]);
    assert_eq!(wrapped("", 4), [""]);
}

proptest! {
    #[test]
    fn lines_are_short_and_together_the_text(text in ".{0,120}", width in 1usize..40) {
        let lines = wrapped(&text, width);
        prop_assert!(lines.iter().all(|line| line.len() <= width));
        prop_assert!(lines.iter().all(|line| line.chars().all(|c| c.is_ascii_alphanumeric() || " .,:?()+-/=_#".contains(c))));
        let letters = |text: &str| text.replace(' ', "");
        prop_assert_eq!(letters(&lines.concat()), letters(&plain(&text)));
    }
}

#[test]
fn no_number_is_minus_nothing() {
    for language in Language::ALL {
        let mut program = small();
        let Step::Move(first) = &mut program.steps[1] else { panic!() };
        first.q[0] = -1e-12;
        let files = write_program(&program, language, &options(language, 6)).unwrap();
        for word in files[0].text.split(|c: char| !"-.0123456789".contains(c)) {
            let is_nothing = word.starts_with('-') && word.contains('0');
            assert!(!is_nothing || word.contains(|c| ('1'..='9').contains(&c)), "{word}");
        }
    }
}
