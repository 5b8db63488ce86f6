//! What the descriptions' remarks say to somebody who uses the robot, in plain words: `words.json` has them.

use serde::Deserialize;

/// What `words.json` holds.
#[derive(Deserialize)]
pub struct Words {
    remarks: Vec<Remark>,
    /// How the pendant's angles are known: the first text is in the remark, the second says it.
    pendant: Vec<[String; 2]>,
    /// Doubts about the pendant's angles themselves, by what the remark says.
    angles: Vec<[String; 2]>,
    /// What other sources say against a description: robot, what it is about, and the sentence.
    elsewhere: Vec<[String; 3]>,
    /// What capsules leave out: the first text is in the names of the parts, the second says it.
    left_out: Vec<[String; 2]>,
    /// What makes capsules larger than the links, by robot.
    too_large: Vec<[String; 2]>,
}

/// A remark that contains the text becomes these doubts; none where it concerns nothing that is shipped.
#[derive(Deserialize)]
struct Remark {
    remark: String,
    doubts: Vec<Doubt>,
}

/// A name of the library's `DoubtAbout`, and the sentence.
type Doubt = (String, String);

impl Words {
    pub fn read() -> Self {
        serde_json::from_str(include_str!("words.json")).expect("a test reads it")
    }

    /// The doubts about the robot `name`.
    pub fn doubts(&self, name: &str, remarks: &[String], pendant: &str) -> Vec<Doubt> {
        let mut doubts = Vec::new();
        for remark in remarks {
            match self.remarks.iter().find(|r| remark.contains(&r.remark)) {
                Some(phrase) => doubts.extend(phrase.doubts.iter().cloned()),
                // Nothing is lost: a remark nobody has put into words stands as it is.
                None => doubts.push(("geometry".to_string(), remark.clone())),
            }
        }
        let angles = self.angles.iter().filter(|[text, _]| pendant.contains(text));
        doubts.extend(angles.map(|[_, said]| ("angles".to_string(), said.clone())));
        let elsewhere = self.elsewhere.iter().filter(|[robot, ..]| robot == name);
        doubts.extend(elsewhere.map(|[_, about, said]| (about.clone(), said.clone())));
        doubts
    }

    /// How the pendant's angles are known, in plain words.
    pub fn pendant<'a>(&'a self, remark: &'a str) -> &'a str {
        let phrase = self.pendant.iter().find(|[text, _]| remark.contains(text));
        phrase.map_or(remark, |[_, said]| said)
    }

    /// What the capsules of the robot `name` leave out, and where they are larger than its links.
    pub fn capsules(&self, name: &str, not_covered: &[String]) -> String {
        let parts = not_covered.join(", ");
        let phrase = self.left_out.iter().find(|[text, _]| parts.contains(text));
        let left_out = match phrase {
            Some([_, said]) => said.clone(),
            None if parts.is_empty() => String::new(),
            // Nothing is lost: parts nobody has put into words keep their names.
            None => format!("No capsule holds {parts}."),
        };
        let too_large = self.too_large.iter().find(|[robot, _]| robot == name);
        let too_large = too_large.map(|[_, said]| said.as_str()).unwrap_or_default();
        format!("{left_out} {too_large}").trim().to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remark_nobody_put_into_words_is_kept() {
        let (words, new) = (Words::read(), "Something new.".to_string());
        let doubts = words.doubts("x", std::slice::from_ref(&new), "as they are");
        assert_eq!(doubts, [("geometry".to_string(), new)]);
        assert_eq!(words.pendant("as they are"), "as they are");
    }
}
