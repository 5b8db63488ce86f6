"""Writes readings.xlsx: a small table of raw readings as a spreadsheet saves it.

Python's standard library only (zipfile), so the file owes nothing to the reader under test. Run in this folder:

    python3 make_readings.py
"""

import zipfile

HEADING = ["Posture", "State", "Name", "Center X", "Center Y", "Center Z", "load_n", "Timestamp", "q1_deg", "q2_deg"]
# Text, numbers, an empty cell (None), a date (("date", serial number)), a formula with its value (("formula", f, v)).
ROWS = [
    [1, "unloaded", "left", 1500.125, -200.5, 900.25, None, ("date", 46000.5), 12.5, -30],
    [1, "unloaded", "right", 1350.0625, -50.25, 900.5, None, ("date", 46000.5), 12.5, -30],
    [1, "up-250", "left", 1500.25, -200.75, ("formula", "900.25-0.75", 899.5), 250, ("date", 46000.5), 12.5, -30],
    [1, "up-250", "right", 1350.1875, -50.5, 899.75, 250, ("date", 46000.5), 12.5, -30],
    [1, "up-500", "left", 1500.375, -201, 898.75, 500, ("date", 46000.5), 12.5, -30],
    [1, "up-500", "left", 1500.3750001, -201, 898.75, 500, ("date", 46000.5), 12.5, -30],
    [1, "up-500", "base", 0.5, 0.25, 0.125, 500, ("date", 46000.5), 12.5, -30],
]
MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
RELATIONS = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"
HEAD = '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'

strings = []


def cell(row, column, value):
    place = f'{chr(ord("A") + column)}{row}'
    if value is None:
        return ""
    if isinstance(value, str):
        if value not in strings:
            strings.append(value)
        return f'<c r="{place}" t="s"><v>{strings.index(value)}</v></c>'
    if isinstance(value, tuple) and value[0] == "date":
        return f'<c r="{place}" s="1"><v>{value[1]}</v></c>'
    if isinstance(value, tuple):
        return f'<c r="{place}"><f>{value[1]}</f><v>{value[2]}</v></c>'
    return f'<c r="{place}"><v>{value!r}</v></c>'


def sheet(rows):
    """Rows by number; the heading need not be the first."""
    lines = [
        f'<row r="{r}">{"".join(cell(r, c, value) for c, value in enumerate(values))}</row>'
        for r, values in rows
    ]
    return f'{HEAD}<worksheet xmlns="{MAIN}"><sheetData>{"".join(lines)}</sheetData></worksheet>'


first = sheet([(1, ["# exported by the tracker's software"]), (3, HEADING)] + list(enumerate(ROWS, 4)))
second = sheet([(1, ["Remarks"]), (2, ["The door was open."])])
texts = "".join(f"<si><t>{text}</t></si>" for text in strings)
files = {
    "[Content_Types].xml": f'<Types xmlns="{PACKAGE}/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="xml" ContentType="application/vnd.openxmlformats-officedocument.spreadsheetml.worksheet+xml"/>'
    '<Override PartName="/xl/workbook.xml" '
    'ContentType="application/vnd.openxmlformats-officedocument.spreadsheetml.sheet.main+xml"/>'
    '<Override PartName="/xl/styles.xml" '
    'ContentType="application/vnd.openxmlformats-officedocument.spreadsheetml.styles+xml"/>'
    '<Override PartName="/xl/sharedStrings.xml" '
    'ContentType="application/vnd.openxmlformats-officedocument.spreadsheetml.sharedStrings+xml"/></Types>',
    "_rels/.rels": f'<Relationships xmlns="{PACKAGE}/relationships">'
    f'<Relationship Id="rId1" Type="{RELATIONS}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
    "xl/workbook.xml": f'<workbook xmlns="{MAIN}" xmlns:r="{RELATIONS}"><sheets>'
    '<sheet name="Readings" sheetId="1" r:id="rId1"/><sheet name="Remarks" sheetId="2" r:id="rId2"/>'
    "</sheets></workbook>",
    "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{PACKAGE}/relationships">'
    f'<Relationship Id="rId1" Type="{RELATIONS}/worksheet" Target="worksheets/sheet1.xml"/>'
    f'<Relationship Id="rId2" Type="{RELATIONS}/worksheet" Target="worksheets/sheet2.xml"/>'
    f'<Relationship Id="rId3" Type="{RELATIONS}/styles" Target="styles.xml"/>'
    f'<Relationship Id="rId4" Type="{RELATIONS}/sharedStrings" Target="sharedStrings.xml"/></Relationships>',
    "xl/styles.xml": f'<styleSheet xmlns="{MAIN}"><fonts count="1"><font/></fonts><fills count="1"><fill/></fills>'
    '<borders count="1"><border/></borders><cellStyleXfs count="1"><xf/></cellStyleXfs>'
    '<cellXfs count="2"><xf numFmtId="0"/><xf numFmtId="22" applyNumberFormat="1"/></cellXfs></styleSheet>',
    "xl/sharedStrings.xml": f'<sst xmlns="{MAIN}" count="{len(strings)}" uniqueCount="{len(strings)}">{texts}</sst>',
    "xl/worksheets/sheet1.xml": first,
    "xl/worksheets/sheet2.xml": second,
}
with zipfile.ZipFile("readings.xlsx", "w", zipfile.ZIP_DEFLATED) as archive:
    for name, text in files.items():
        # A fixed date: the same bytes on every day.
        entry = zipfile.ZipInfo(name, date_time=(2026, 1, 1, 0, 0, 0))
        entry.compress_type = zipfile.ZIP_DEFLATED
        archive.writestr(entry, text if text.startswith("<?xml") else HEAD + text)
