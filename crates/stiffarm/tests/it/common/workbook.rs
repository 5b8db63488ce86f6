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
}

/// A table of comma-separated text as cells; what reads as a number is one.
pub fn cells(text: &str) -> Vec<Vec<Cell<'_>>> {
    let cell = |field| match str::parse(field) {
        Ok(number) => Cell::Number(number),
        Err(_) if str::is_empty(field) => Cell::Empty,
        Err(_) => Cell::Text(field),
    };
    let lines = text.lines();
    lines
        .map(|line| line.split(',').map(cell).collect())
        .collect()
}

/// A workbook of sheets by name.
pub fn workbook(sheets: &[(&str, Vec<Vec<Cell<'_>>>)]) -> Vec<u8> {
    workbook_with(sheets, "")
}

/// A workbook of sheets by name, with more rows at the end of each as XML.
pub fn workbook_with(sheets: &[(&str, Vec<Vec<Cell<'_>>>)], more: &str) -> Vec<u8> {
    let mut files = Vec::new();
    let (mut list, mut relations) = (String::new(), String::new());
    const RELATION: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    for (i, (name, rows)) in sheets.iter().enumerate() {
        let n = i + 1;
        list += &format!("<sheet name=\"{name}\" sheetId=\"{n}\" r:id=\"r{n}\"/>");
        relations += &format!(
            "<Relationship Id=\"r{n}\" Type=\"{RELATION}/worksheet\" Target=\"worksheets/sheet{n}.xml\"/>"
        );
        let mut data = String::new();
        for (r, row) in rows.iter().enumerate() {
            data += &format!("<row r=\"{}\">", r + 1);
            for (c, cell) in row.iter().enumerate() {
                data += &xml(&place(r, c), *cell);
            }
            data += "</row>";
        }
        let sheet =
            format!("<worksheet xmlns=\"{MAIN}\"><sheetData>{data}{more}</sheetData></worksheet>");
        files.push((format!("xl/worksheets/sheet{n}.xml"), sheet));
    }
    relations +=
        &format!("<Relationship Id=\"rs\" Type=\"{RELATION}/styles\" Target=\"styles.xml\"/>");
    let package = "http://schemas.openxmlformats.org/package/2006";
    files.push((
        "[Content_Types].xml".to_string(),
        format!("<Types xmlns=\"{package}/content-types\"/>"),
    ));
    files.push((
        "xl/workbook.xml".to_string(),
        format!(
            "<workbook xmlns=\"{MAIN}\" xmlns:r=\"{RELATION}\"><sheets>{list}</sheets></workbook>"
        ),
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
        Cell::Fault => format!("<c r=\"{place}\" t=\"e\"><v>#DIV/0!</v></c>"),
    }
}

/// A ZIP archive of stored files (PKWARE's APPNOTE.TXT, 4.3).
fn zip(files: &[(String, String)]) -> Vec<u8> {
    let (mut archive, mut directory) = (Vec::new(), Vec::new());
    for (name, text) in files {
        let start = archive.len() as u32;
        let length = text.len() as u32;
        let mut about = Vec::new();
        // Version, flags, method, time, date.
        for word in [20u16, 0, 0, 0, 0x21] {
            about.extend(word.to_le_bytes());
        }
        for word in [crc32(text.as_bytes()), length, length] {
            about.extend(word.to_le_bytes());
        }
        about.extend((name.len() as u16).to_le_bytes());
        about.extend(0u16.to_le_bytes());
        archive.extend(b"PK\x03\x04");
        archive.extend(&about);
        archive.extend(name.as_bytes());
        archive.extend(text.as_bytes());
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
    for count in [files.len() as u16; 2] {
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
