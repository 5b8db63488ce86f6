//! The measured robot of the reference data as a table of measurements.

use std::path::{Path, PathBuf};

use crate::files;
use crate::run::Failure;

/// Files of the reference data, and what their columns are called in a table of measurements.
const PARTS: [(&str, &str); 3] = [
    (
        "joint_angles.csv",
        "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad",
    ),
    ("forces.csv", "fx_n,fy_n,fz_n"),
    ("deltaX.csv", "dx_m,dy_m,dz_m"),
];

/// The folder of the robot in the reference data, otherwise why there is none.
pub fn folder(reference: Result<PathBuf, String>) -> Result<PathBuf, String> {
    let folder = reference?.join("fanuc_r2000ic");
    match folder.is_dir() {
        true => Ok(folder),
        false => Err(format!("there is no `{}`", folder.display())),
    }
}

/// Writes the table made from the files in `folder`.
pub fn write(folder: &Path, target: &Path) -> Result<(), Failure> {
    let mut parts = Vec::new();
    for (name, _) in PARTS {
        parts.push(files::text(&folder.join(name))?);
    }
    let table = table(&parts).ok_or_else(|| {
        Failure::internal(
            format!(
                "the files in `{}` have different numbers of rows",
                folder.display()
            ),
            "check the folder that STIFFARM_REFERENCE_DATA names, or unset it",
        )
    })?;
    files::write(target, table)
}

/// The rows of all parts side by side below one heading, numbered as postures.
fn table(parts: &[String]) -> Option<String> {
    let rows: Vec<Vec<&str>> = parts.iter().map(|p| p.lines().skip(1).collect()).collect();
    let count = rows.first()?.len();
    if rows.iter().any(|rows| rows.len() != count) {
        return None;
    }
    let headings = PARTS.map(|(_, columns)| columns);
    let mut table = format!("posture,point,{}\n", headings.join(","));
    for i in 0..count {
        let row: Vec<&str> = rows.iter().map(|rows| rows[i].trim()).collect();
        table += &format!("{},TCP,{}\n", i + 1, row.join(","));
    }
    Some(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_put_side_by_side() {
        let parts = ["q\n1,2\n3,4\r\n", "f\n5\n6\n", "d\n7\n8\n"].map(String::from);
        assert_eq!(
            table(&parts).unwrap(),
            "posture,point,q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,fx_n,fy_n,fz_n,dx_m,dy_m,dz_m\n\
             1,TCP,1,2,5,7\n2,TCP,3,4,6,8\n"
        );
        assert_eq!(table(&["q\n1\n", "f\n", "d\n7\n"].map(String::from)), None);
    }
}
