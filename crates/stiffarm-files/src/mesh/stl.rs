//! Triangles of an STL file, binary or text.
//!
//! Which of the two it is, its length says: a binary file counts its triangles. What its head says decides
//! nothing, as many programs begin binary files with "solid", too, some of them with line ends behind it.

/// Bytes before the triangles of a binary file: 80 of any kind, and their number.
const HEAD: usize = 84;
/// Bytes of a triangle: its normal, its corners, and two of any kind.
const TRIANGLE: usize = 50;

/// Triangles by their corners, in the unit of the file.
pub(super) type Triangles = Vec<[[f64; 3]; 3]>;

/// Corners of each triangle.
///
/// # Errors
/// What cannot be read, in words that follow "cannot be read:".
pub(super) fn triangles(bytes: &[u8]) -> Result<Triangles, String> {
    if let Some(triangles) = binary(bytes) {
        return Ok(triangles.chunks_exact(TRIANGLE).map(corners).collect());
    }
    if is_text(bytes) {
        return text(&String::from_utf8_lossy(bytes));
    }
    Err(match counted(bytes) {
        None => "it is too short".to_string(),
        Some(count) => {
            let available = (bytes.len() - HEAD) / TRIANGLE;
            format!("it says {count} triangles and has bytes for {available}")
        }
    })
}

/// Whether these are the bytes of an STL file, whatever its name.
pub(super) fn is_one(bytes: &[u8]) -> bool {
    binary(bytes).is_some_and(|triangles| !triangles.is_empty()) || is_text(bytes)
}

/// How many triangles a binary file says it has.
fn counted(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEAD - 4..HEAD)?.try_into().ok()?;
    Some(u64::from(u32::from_le_bytes(count)))
}

/// The triangles of a binary file. Behind them there may be less than one more, such as a line end,
/// and nothing but zeros: then none is lost.
fn binary(bytes: &[u8]) -> Option<&[u8]> {
    let body = bytes.get(HEAD..)?;
    let length = usize::try_from(counted(bytes)?).ok()?.checked_mul(TRIANGLE)?;
    let (triangles, rest) = body.split_at_checked(length)?;
    let holds_none = rest.len() < TRIANGLE || rest.iter().all(|byte| *byte == 0);
    holds_none.then_some(triangles)
}

fn corners(triangle: &[u8]) -> [[f64; 3]; 3] {
    let number = |i: usize| {
        let bytes = std::array::from_fn(|byte| triangle[4 * i + byte]);
        f64::from(f32::from_le_bytes(bytes))
    };
    [3, 6, 9].map(|corner| [number(corner), number(corner + 1), number(corner + 2)])
}

/// A text begins with "solid", and has no byte that is zero where a binary file has its count.
fn is_text(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let start = bytes.trim_ascii_start();
    let word = start.get(..5);
    word.is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && !bytes.iter().take(HEAD).any(|byte| *byte == 0)
}

/// Corners of a text, word by word; normals say nothing that the corners do not.
fn text(text: &str) -> Result<Triangles, String> {
    let mut triangles = Vec::new();
    let mut corners = Vec::new();
    let open = || "its end is missing (no endsolid)".to_string();
    let mut is_closed = false;
    // One that is cut off may end within a word.
    if !text.to_ascii_lowercase().contains("endsolid") {
        return Err(open());
    }
    // Lines end in LF, CR LF or CR.
    for line in text.trim_start_matches('\u{feff}').split(['\n', '\r']) {
        let mut words = line.split_whitespace();
        while let Some(word) = words.next() {
            match word.to_ascii_lowercase().as_str() {
                "vertex" => {
                    let numbers = words.by_ref().take(3).map(|word| word.parse().ok());
                    let corner = numbers.collect::<Option<Vec<f64>>>();
                    let corner = corner.and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
                    corners.push(corner.ok_or_else(|| format!("\"{}\" is not a corner of a triangle", line.trim()))?);
                }
                "endfacet" => {
                    let triangle = <[_; 3]>::try_from(std::mem::take(&mut corners));
                    triangles
                        .push(triangle.map_err(|other| format!("a facet has {} corners and not three", other.len()))?);
                }
                "normal" => {
                    let _ = words.nth(2);
                }
                "facet" | "outer" | "loop" | "endloop" => {}
                // A name, or what a program says of itself, to the end of the line.
                name @ ("solid" | "endsolid") => {
                    is_closed = name == "endsolid";
                    break;
                }
                _ if triangles.is_empty() && corners.is_empty() => break,
                _ => return Err(format!("\"{}\" is not a line of an STL", line.trim())),
            }
        }
    }
    if is_closed && corners.is_empty() { Ok(triangles) } else { Err(open()) }
}
