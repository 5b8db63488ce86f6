//! The folder of the reference data.

use std::ffi::OsString;
use std::path::PathBuf;

/// Names the folder of the reference data; the tests read it, and their `#[ignore]` reason names it.
pub const REFERENCE_VARIABLE: &str = "STIFFARM_REFERENCE_DATA";

/// The folder that `value` names, absolute because `cargo test` starts every test in its package's folder; otherwise
/// why there is none.
pub fn reference_folder(value: Option<OsString>) -> Result<PathBuf, String> {
    let Some(value) = value.filter(|value| !value.is_empty()) else {
        return Err(format!("{REFERENCE_VARIABLE} is not set"));
    };
    match std::path::absolute(&value) {
        Ok(folder) if folder.is_dir() => Ok(folder),
        _ => Err(format!("{REFERENCE_VARIABLE} is `{}`, which is no folder", value.display())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reference_folder_must_exist_and_becomes_absolute() {
        let unset = "STIFFARM_REFERENCE_DATA is not set".to_string();
        assert_eq!(reference_folder(None), Err(unset.clone()));
        assert_eq!(reference_folder(Some("".into())), Err(unset));
        assert_eq!(
            reference_folder(Some("no/such/folder".into())).unwrap_err(),
            "STIFFARM_REFERENCE_DATA is `no/such/folder`, which is no folder"
        );
        let folder = reference_folder(Some("src".into())).unwrap();
        assert!(folder.is_absolute() && folder.ends_with("src"));
    }
}
