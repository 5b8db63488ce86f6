//! The paper's own figures, as facts to stand beside ours.
//!
//! The raw readings behind Tables 6 and 7 are not published, so nobody can
//! recompute them.

/// The paper.
pub const PAPER: &str = "Zhang, Guo, Sun, Sun, Method of Postures Selection for Industrial Robot Joint Stiffness \
                         Identification, IEEE Access 2021, doi:10.1109/ACCESS.2021.3073671";

/// Tables 4, 6 and 7 of the paper; columns are its Groups 1 to 3.
#[derive(Debug, Clone, Copy)]
pub struct PublishedTables {
    /// Table 4: deviation rates of the illustration case \[%\], joint by joint.
    pub deviation_percent: [[f64; 3]; 6],
    /// Table 6: identified joint stiffness \[N·m/rad\], joint by joint.
    pub stiffness: [[f64; 3]; 6],
    /// Table 7: relative translational deflections \[mm\], rows 1-1 … 3-4.
    pub deflection_mm: [[f64; 3]; 12],
}

/// The paper's tables when `robot` is the one of the paper.
pub fn published_for(robot: &str) -> Option<&'static PublishedTables> {
    (robot == "COMAU SMART5 NJ 165-3.0").then_some(&PUBLISHED)
}

static PUBLISHED: PublishedTables = PublishedTables {
    deviation_percent: [
        [0.726, 0.339, 0.268],
        [1.413, 9.845, 0.820],
        [0.251, 0.488, 0.002],
        [7.304, 2.259, 2.075],
        [2.712, 2.236, 0.045],
        [3.242, 2.364, 0.469],
    ],
    stiffness: [
        [1_243_000.0, 1_516_000.0, 852_300.0],
        [1_704_000.0, 5_554_000.0, 4_763_000.0],
        [621_000.0, 1_701_000.0, 1_312_000.0],
        [561_000.0, 671_000.0, 213_000.0],
        [184_000.0, 189_000.0, 272_000.0],
        [413_000.0, 102_500.0, 173_000.0],
    ],
    deflection_mm: [
        [0.558, 0.403, 0.233],
        [0.571, 0.428, 0.192],
        [0.825, 0.449, 0.215],
        [0.868, 0.506, 0.223],
        [0.461, 0.264, 0.168],
        [0.487, 0.302, 0.266],
        [0.519, 0.212, 0.168],
        [0.534, 0.262, 0.206],
        [0.753, 0.628, 0.213],
        [0.737, 0.548, 0.319],
        [0.653, 0.660, 0.253],
        [0.653, 0.590, 0.287],
    ],
};
