//! Files that are no text, by how they begin: each is told by its name, with the way to a table.

use stiffarm::error::{Code, Error};

/// What a kind of file is, where in it which bytes stand, and what to do.
struct Kind {
    at: usize,
    bytes: &'static [u8],
    what: &'static str,
    hint: &'static str,
}

const AS_TABLE: &str = "export what was measured as CSV and give that";

#[rustfmt::skip]
const KINDS: [Kind; 17] = [
    // The number of the block of parameters, 0x50, and zeros somewhere behind.
    Kind { at: 1, bytes: b"\x50", what: "a binary file of motion capture (C3D)", hint: "export the trajectories as CSV \
        from the program that recorded them" },
    Kind { at: 0, bytes: b"%PDF", what: "a PDF", hint: AS_TABLE },
    Kind { at: 0, bytes: b"PK\x03\x04", what: "an archive (ZIP)", hint: "unpack it" },
    Kind { at: 0, bytes: b"\xd0\xcf\x11\xe0", what: "a file of old Office programs", hint: AS_TABLE },
    Kind { at: 0, bytes: b"\x1f\x8b", what: "a compressed file (gzip)", hint: "unpack it" },
    Kind { at: 0, bytes: b"7z\xbc\xaf", what: "an archive (7z)", hint: "unpack it" },
    Kind { at: 0, bytes: b"\x89HDF", what: "a file of HDF5 or MATLAB 7.3", hint: AS_TABLE },
    Kind { at: 0, bytes: b"MATLAB 5.0 MAT-file", what: "a file of MATLAB (.mat)", hint: "write the table with \
        writetable(…, \"readings.csv\")" },
    Kind { at: 0, bytes: b"\x93NUMPY", what: "an array of NumPy (.npy)", hint: "write it with numpy.savetxt and a \
        heading" },
    Kind { at: 0, bytes: b"SQLite format 3", what: "a database (SQLite)", hint: AS_TABLE },
    Kind { at: 0, bytes: b"PAR1", what: "a table of Apache Parquet", hint: AS_TABLE },
    Kind { at: 0, bytes: b"TDSm", what: "a recording of LabVIEW (TDMS)", hint: AS_TABLE },
    Kind { at: 0, bytes: b"#ROSBAG", what: "a recording of ROS (bag)", hint: "write the topic as CSV: rostopic echo -b \
        FILE -p TOPIC" },
    Kind { at: 0, bytes: b"\x89MCAP", what: "a recording of ROS (MCAP)", hint: AS_TABLE },
    Kind { at: 0, bytes: b"ASTM-E57", what: "a cloud of points (E57)", hint: "give the centres of the reflectors \
        instead, as CSV" },
    Kind { at: 0, bytes: b"\x89PNG", what: "a picture (PNG)", hint: "give the numbers as CSV" },
    Kind { at: 0, bytes: b"\xff\xd8\xff", what: "a picture (JPEG)", hint: "give the numbers as CSV" },
];

/// Bytes of the beginning in which a binary file has a zero, and a text has none.
const BEGINNING: usize = 512;

/// What a file that cannot be text is, where its beginning tells.
pub(super) fn refused(bytes: &[u8]) -> Option<Error> {
    let beginning = &bytes[..bytes.len().min(BEGINNING)];
    if !beginning.contains(&0) && std::str::from_utf8(bytes).is_ok() {
        return None;
    }
    let is_so = |kind: &&Kind| {
        let has_signature = bytes.get(kind.at..).is_some_and(|rest| rest.starts_with(kind.bytes));
        // One letter alone is little.
        has_signature && (kind.at == 0 || beginning.contains(&0))
    };
    let kind = KINDS.iter().find(is_so)?;
    let message = format!("This is {}, not text.", kind.what);
    Some(Error::new(Code::Unsupported, message).hint(kind.hint))
}
