//! Robots that ship with the program, with sources and doubts.
//!
//! Those with published stiffness stand in `published`; the
//! geometry of the others is data, `data/robots.rs`, made by `cargo xtask robots`
//! from public robot descriptions.

use super::Robot;
use super::entry::{CatalogueEntry, Doubt, DoubtAbout};
use super::published::{KR500_STIFFNESS, PUBLISHED};
use crate::error::{Code, Error, Result, did_you_mean};
use std::sync::LazyLock;

/// Geometry from public robot descriptions.
static DESCRIBED: &[CatalogueEntry] = include!("../../../data/robots.rs");

static CATALOGUE: LazyLock<Vec<CatalogueEntry>> = LazyLock::new(|| [PUBLISHED, DESCRIBED].concat());

/// The embedded catalogue; the first entry is the default robot.
pub fn catalogue() -> &'static [CatalogueEntry] {
    &CATALOGUE
}

/// The key of a robot that is no longer in the catalogue, and what to do about it.
const REMOVED: (&str, &str) = (
    "kuka-kr500-r2830",
    "its angles were not the pendant's; use kuka-kr500-r2800-2, or dh_standard with rows of your own for the R2830",
);

/// A second name of a robot, and its key.
const ALIAS: (&str, &str) = ("fanuc-r2000ic-165f", "fanuc-r2000ic165f");

/// Finds an entry by its key, or by a second name that it had, ignoring case.
///
/// # Errors
/// Unknown name; the hint has the nearest key.
pub fn find(key: &str) -> Result<&'static CatalogueEntry> {
    let own = match key.eq_ignore_ascii_case(ALIAS.0) {
        true => ALIAS.1,
        false => key,
    };
    let found = catalogue().iter().find(|e| e.key.eq_ignore_ascii_case(own));
    found.ok_or_else(|| {
        let keys = catalogue().iter().map(|e| e.key);
        let hint = match key.eq_ignore_ascii_case(REMOVED.0) {
            true => REMOVED.1.to_string(),
            false => did_you_mean(key, keys)
                .unwrap_or_else(|| "`stiffarm robots` lists the robots".to_string()),
        };
        Error::new(
            Code::UnknownName,
            format!("The catalogue has no robot \"{key}\"."),
        )
        .hint(hint)
    })
}

impl Robot {
    /// A robot of the catalogue by its key, for example `comau-nj165-3.0`.
    ///
    /// # Errors
    /// There is no robot of this key.
    pub fn from_catalogue(key: &str) -> Result<Robot> {
        find(key)?.robot()
    }
}
