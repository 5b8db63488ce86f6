//! The faces that printed pictures are written with.

use resvg::usvg::fontdb::{Database, Source};
use resvg::usvg::{Options, Tree};
use std::collections::BTreeSet;
use std::sync::Arc;
use stiffarm::{Code, Error, Result};

/// The family that is always there.
pub const USUAL_FAMILY: &str = "DejaVu Sans";
/// Most families that a message names.
const MOST_NAMED: usize = 6;
/// Families whose letters are as wide as those of a usual one.
const STAND_INS: [(&str, &[&str]); 4] = [
    (
        "times new roman",
        &["Liberation Serif", "Tinos", "Nimbus Roman"],
    ),
    (
        "times",
        &[
            "Nimbus Roman",
            "Liberation Serif",
            "Tinos",
            "Times New Roman",
        ],
    ),
    ("arial", &["Liberation Sans", "Arimo", "Nimbus Sans"]),
    (
        "helvetica",
        &["Nimbus Sans", "Liberation Sans", "Arimo", "Arial"],
    ),
];

/// Faces of one family, and of DejaVu Sans for the characters that it lacks.
///
/// DejaVu Sans comes with the program. Fonts of the machine are looked at only
/// where a family is stated, and of these only that family is used, so that a
/// picture does not depend on what else is installed.
#[derive(Debug, Clone)]
pub struct Fonts {
    database: Arc<Database>,
    family: String,
}

impl Fonts {
    /// DejaVu Sans: the same picture on every machine.
    pub fn usual() -> Self {
        Fonts {
            database: Arc::new(own_faces()),
            family: String::new(),
        }
    }

    /// A family by its name, upper or lower case; empty for [`usual`](Self::usual).
    ///
    /// # Errors
    /// The family is not installed, or its licence does not allow to embed it.
    pub fn with_family(family: &str) -> Result<Self> {
        if family.is_empty() || is_same(family, USUAL_FAMILY) {
            return Ok(Fonts::usual());
        }
        let mut database = own_faces();
        let own = database.len();
        database.load_system_fonts();
        let named = |face: &resvg::usvg::fontdb::FaceInfo| {
            let mut names = face.families.iter();
            names
                .find(|(name, _)| is_same(name, family))
                .map(|(name, _)| name.clone())
        };
        let Some(exact) = database.faces().find_map(named) else {
            return Err(missing(family, &database));
        };
        // The faces that came first are our own.
        let others: Vec<_> = database
            .faces()
            .skip(own)
            .filter(|face| !face.families.iter().any(|(name, _)| *name == exact))
            .map(|face| face.id)
            .collect();
        for id in others {
            database.remove_face(id);
        }
        let may_embed = |id| database.with_face_data(id, may_embed).unwrap_or(false);
        if !database.faces().skip(own).all(|face| may_embed(face.id)) {
            let message = format!("The licence of the font {exact} does not allow to embed it.");
            return Err(Error::new(Code::Unsupported, message).hint(
                "choose another font, or write SVG, which names the font without holding it",
            ));
        }
        Ok(Fonts {
            database: Arc::new(database),
            family: exact,
        })
    }

    /// The family as the font itself spells it; empty for the usual one.
    pub fn family(&self) -> &str {
        &self.family
    }

    /// A picture with its text laid out in these faces.
    ///
    /// # Errors
    /// The picture is no SVG.
    pub(super) fn read(&self, svg: &str) -> Result<Tree> {
        let options = Options {
            fontdb: Arc::clone(&self.database),
            font_family: USUAL_FAMILY.to_owned(),
            ..Options::default()
        };
        Tree::from_str(svg, &options).map_err(|error| {
            Error::new(
                Code::Internal,
                format!("The picture cannot be read: {error}."),
            )
        })
    }
}

/// DejaVu Sans, regular and bold, for every family that is not there.
fn own_faces() -> Database {
    let mut database = Database::new();
    for data in [dejavu::sans::regular(), dejavu::sans::bold()] {
        database.load_font_source(Source::Binary(Arc::new(data)));
    }
    database.set_sans_serif_family(USUAL_FAMILY);
    database.set_serif_family(USUAL_FAMILY);
    database
}

fn is_same(name: &str, other: &str) -> bool {
    name.to_lowercase() == other.to_lowercase()
}

/// Whether a subset of a face may go into a document.
fn may_embed(data: &[u8], index: u32) -> bool {
    ttf_parser::Face::parse(data, index).is_ok_and(|face| {
        face.permissions() != Some(ttf_parser::Permissions::Restricted)
            && face.is_subsetting_allowed()
    })
}

/// The family is missing; what is there instead.
fn missing(family: &str, database: &Database) -> Error {
    let found: BTreeSet<&str> = database
        .faces()
        .filter_map(|face| Some(face.families.first()?.0.as_str()))
        .collect();
    let known = STAND_INS.iter().find(|(name, _)| is_same(name, family));
    let alike = known.and_then(|(_, names)| names.iter().find(|name| found.contains(**name)));
    let hint = match alike {
        Some(name) => format!("{name} is installed and has letters of the same widths"),
        None => {
            let others: Vec<&str> = found.iter().copied().take(MOST_NAMED).collect();
            let more = match found.len().saturating_sub(MOST_NAMED) {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            format!("there are {}{more}", others.join(", "))
        }
    };
    Error::new(
        Code::UnknownName,
        format!("The font {family} is not installed."),
    )
    .hint(format!(
        "{hint}; without a stated font, {USUAL_FAMILY} is used"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_family_is_named_with_what_is_there() {
        let error = Fonts::with_family("No Such Face").unwrap_err();
        assert_eq!(error.code(), Code::UnknownName);
        let text = error.to_string();
        assert!(text.contains("No Such Face is not installed"), "{text}");
        let hint = missing("Times New Roman", &own_faces());
        assert!(format!("{hint:?}").contains("there are DejaVu Sans"));
    }

    #[test]
    fn the_own_family_is_found_in_any_case() {
        assert_eq!(Fonts::with_family("dejavu sans").unwrap().family(), "");
        assert_eq!(Fonts::usual().database.len(), 2);
    }
}
