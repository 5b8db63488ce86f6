//! Where results are written.

use std::path::PathBuf;

/// A place to write to that was checked beforehand.
#[derive(Debug, Clone)]
pub enum Target {
    /// Standard output.
    Stdout,
    /// A file.
    File {
        /// Where it is.
        path: PathBuf,
        /// True where it may take the place of another.
        force: bool,
    },
    /// A device or pipe: written in place.
    Device(PathBuf),
}
