//! Small .xlsx workbooks, cell by cell: a ZIP archive whose files are stored
//! as they are.

/// A cell: text or number, or what else a spreadsheet may hold.
#[derive(Clone, Copy)]
pub enum Cell<'a> {
    Empty,
    Text(&'a str),
    Number(f64),
    Date,
    Duration,
    True,
    Fault,
    /// A formula with the value that the program left for it.
    Formula(&'a str),
}

/// A table of comma-separated text as cells; what reads as a number is one.
pub fn cells(text: &str) -> Vec<Vec<Cell<'_>>> {
    let cell = |field| match str::parse(field) {
        Ok(number) => Cell::Number(number),
        Err(_) if str::is_empty(field) => Cell::Empty,
        Err(_) => Cell::Text(field),
    };
    let lines = text.lines();
    lines.map(|line| line.split(',').map(cell).collect()).collect()
}

/// A workbook of sheets by name.
pub fn workbook(sheets: &[(&str, Vec<Vec<Cell<'_>>>)]) -> Vec<u8> {
    workbook_with(sheets, "")
}

/// A workbook of sheets by name, with more rows at the end of each as XML.
pub fn workbook_with(sheets: &[(&str, Vec<Vec<Cell<'_>>>)], more: &str) -> Vec<u8> {
    workbook_of("", sheets, more)
}

/// The same with properties of the workbook as XML.
pub fn workbook_of(properties: &str, sheets: &[(&str, Vec<Vec<Cell<'_>>>)], more: &str) -> Vec<u8> {
    let mut files = Vec::new();
    let (mut list, mut relations) = (String::new(), String::new());
    const RELATION: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    for (i, (name, rows)) in sheets.iter().enumerate() {
        let n = i + 1;
        list += &format!("<sheet name=\"{name}\" sheetId=\"{n}\" r:id=\"r{n}\"/>");
        relations +=
            &format!("<Relationship Id=\"r{n}\" Type=\"{RELATION}/worksheet\" Target=\"worksheets/sheet{n}.xml\"/>");
        let mut data = String::new();
        for (r, row) in rows.iter().enumerate() {
            data += &format!("<row r=\"{}\">", r + 1);
            for (c, cell) in row.iter().enumerate() {
                data += &xml(&place(r, c), *cell);
            }
            data += "</row>";
        }
        let sheet = format!("<worksheet xmlns=\"{MAIN}\"><sheetData>{data}{more}</sheetData></worksheet>");
        files.push((format!("xl/worksheets/sheet{n}.xml"), sheet));
    }
    relations += &format!("<Relationship Id=\"rs\" Type=\"{RELATION}/styles\" Target=\"styles.xml\"/>");
    let package = "http://schemas.openxmlformats.org/package/2006";
    files.push(("[Content_Types].xml".to_string(), format!("<Types xmlns=\"{package}/content-types\"/>")));
    files.push((
        "xl/workbook.xml".to_string(),
        format!("<workbook xmlns=\"{MAIN}\" xmlns:r=\"{RELATION}\">{properties}<sheets>{list}</sheets></workbook>"),
    ));
    files.push((
        "_rels/.rels".to_string(),
        format!(
            "<Relationships xmlns=\"{package}/relationships\">\
             <Relationship Id=\"r1\" Type=\"{RELATION}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
        ),
    ));
    files.push((
        "xl/_rels/workbook.xml.rels".to_string(),
        format!("<Relationships xmlns=\"{package}/relationships\">{relations}</Relationships>"),
    ));
    files.push((
        "xl/styles.xml".to_string(),
        format!(
            "<styleSheet xmlns=\"{MAIN}\"><cellXfs count=\"3\"><xf numFmtId=\"0\"/><xf numFmtId=\"14\"/>\
             <xf numFmtId=\"46\"/></cellXfs></styleSheet>"
        ),
    ));
    zip(&files)
}

/// `A1` of row and column from 0.
pub fn place(row: usize, column: usize) -> String {
    let mut letters = String::new();
    let mut rest = column + 1;
    while rest > 0 {
        rest -= 1;
        letters.insert(0, char::from(b'A' + (rest % 26) as u8));
        rest /= 26;
    }
    format!("{letters}{}", row + 1)
}

fn xml(place: &str, cell: Cell<'_>) -> String {
    match cell {
        Cell::Empty => String::new(),
        Cell::Text(text) => {
            let text = text.replace('&', "&amp;").replace('<', "&lt;");
            format!("<c r=\"{place}\" t=\"inlineStr\"><is><t>{text}</t></is></c>")
        }
        Cell::Number(number) => format!("<c r=\"{place}\"><v>{number}</v></c>"),
        Cell::Date => format!("<c r=\"{place}\" s=\"1\"><v>46000</v></c>"),
        Cell::Duration => format!("<c r=\"{place}\" s=\"2\"><v>0.25</v></c>"),
        Cell::True => format!("<c r=\"{place}\" t=\"b\"><v>1</v></c>"),
        Cell::Formula(value) => format!("<c r=\"{place}\"><f>2*125</f><v>{value}</v></c>"),
        Cell::Fault => format!("<c r=\"{place}\" t=\"e\"><v>#DIV/0!</v></c>"),
    }
}

/// A ZIP archive of stored files.
fn zip(files: &[(String, String)]) -> Vec<u8> {
    let entry = |(name, text): &(String, String)| Entry {
        name: name.clone(),
        packed: text.as_bytes().to_vec(),
        method: 0,
        size: text.len() as u32,
    };
    archive(&files.iter().map(entry).collect::<Vec<_>>())
}

/// A file in an archive, as it is packed: method 0 as it is, 8 deflated.
pub struct Entry {
    pub name: String,
    pub packed: Vec<u8>,
    pub method: u16,
    /// What the archive says that it unpacks to.
    pub size: u32,
}

/// A ZIP archive (PKWARE's APPNOTE.TXT, 4.3).
pub fn archive(entries: &[Entry]) -> Vec<u8> {
    let (mut archive, mut directory) = (Vec::new(), Vec::new());
    for Entry { name, packed, method, size } in entries {
        let start = archive.len() as u32;
        let mut about = Vec::new();
        // Version, flags, method, time, date.
        for word in [20u16, 0, *method, 0, 0x21] {
            about.extend(word.to_le_bytes());
        }
        for word in [crc32(packed), packed.len() as u32, *size] {
            about.extend(word.to_le_bytes());
        }
        about.extend((name.len() as u16).to_le_bytes());
        about.extend(0u16.to_le_bytes());
        archive.extend(b"PK\x03\x04");
        archive.extend(&about);
        archive.extend(name.as_bytes());
        archive.extend(packed);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&about);
        // Comment, disk, attributes.
        directory.extend([0; 10]);
        directory.extend(start.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let (start, length) = (archive.len() as u32, directory.len() as u32);
    archive.extend(directory);
    archive.extend(b"PK\x05\x06\x00\x00\x00\x00");
    for count in [entries.len() as u16; 2] {
        archive.extend(count.to_le_bytes());
    }
    archive.extend(length.to_le_bytes());
    archive.extend(start.to_le_bytes());
    archive.extend([0; 2]);
    archive
}

fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
        }
    }
    !crc
}

/// `runs` times 258 of the letter A, deflated to two bits for each run (RFC 1951):
/// a code of one bit for a repeated byte, codes of two for the letter and the end.
pub fn deflated_letters(runs: usize) -> Vec<u8> {
    let mut bits = Bits::default();
    // The last block, with codes of its own: 286 letters and lengths, 1
    // distance, 18 lengths of codes.
    for (value, count) in [(1, 1), (2, 2), (29, 5), (0, 5), (14, 4)] {
        bits.push(value, count);
    }
    // Lengths of the codes of 16, 17, 18, 0, 8, …, 2, 14, 1: 18 has one bit, 2 and 1 two.
    for length in [0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2] {
        bits.push(length, 3);
    }
    // 18 is 0, 1 is 10 and 2 is 11, first bit first.
    let zeros = |bits: &mut Bits, count: u32| {
        bits.push(0, 1);
        bits.push(count - 11, 7);
    };
    let (one, two) = (0b01, 0b11);
    zeros(&mut bits, 65);
    bits.push(two, 2);
    zeros(&mut bits, 138);
    zeros(&mut bits, 52);
    bits.push(two, 2);
    zeros(&mut bits, 28);
    bits.push(one, 2);
    bits.push(one, 2);
    // The letter is 10, the end 11, a run of 258 from one byte before 0 and 0.
    bits.push(0b01, 2);
    for _ in 0..runs {
        bits.push(0, 2);
    }
    bits.push(0b11, 2);
    bits.bytes
}

#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    used: u32,
}

impl Bits {
    /// The lowest `count` bits of `value`, lowest first.
    fn push(&mut self, value: u32, count: u32) {
        for i in 0..count {
            if self.used.is_multiple_of(8) {
                self.bytes.push(0);
            }
            let last = self.bytes.len() - 1;
            self.bytes[last] |= ((value >> i & 1) as u8) << (self.used % 8);
            self.used += 1;
        }
    }
}
