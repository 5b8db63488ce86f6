"""Fills a reading sheet with the readings of a simulated experiment, as a person would, and checks that
`stiffarm identify` makes the same of it as of the readings themselves.

    python fill.py openpyxl|libreoffice STIFFARM FOLDER

The sheet is filled by openpyxl or by LibreOffice Calc (through UNO, so that its protection holds). The last line
says what was compared. Exit code 1: the results differ.
"""

import csv
import json
import pathlib
import subprocess
import sys
import time

CELL = "builtin:comau"
STATES = "up-250,up-500,down-250"
NAMES = ("posture", "state", "point")


def run(stiffarm, *arguments):
    """Runs the command; findings (exit code 1) are no failure here."""
    done = subprocess.run([stiffarm, *arguments], capture_output=True, text=True, encoding="utf-8")
    if done.returncode not in (0, 1):
        sys.exit(f"stiffarm {' '.join(arguments)} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def readings_by_name(path):
    """The readings, repeats in their order: what to write into which column, by posture, state and point."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    readings = {}
    for row in rows:
        name = tuple(row[n] for n in NAMES)
        readings.setdefault(name, []).append({k: rounded(v) for k, v in row.items() if k not in NAMES})
    return readings


def rounded(text):
    """To six decimals, as a tracker shows: spreadsheets keep 15 to 17 digits, each its own number of them."""
    return repr(round(float(text), 6)) if text else ""


def rows_to_fill(planned, readings):
    """Row numbers from 2, names and values: planned rows first, repeats in the rows below."""
    if missing := readings.keys() - set(planned):
        sys.exit(f"no row in the sheet for {sorted(missing)}")
    for number, name in enumerate(planned, 2):
        yield number, name, readings[name][0]
    repeats = [(name, more) for name, values in readings.items() for more in values[1:]]
    for number, (name, values) in enumerate(repeats, len(planned) + 2):
        yield number, name, values


def check_made(book):
    """The sheet is what docs/readings.md says of it."""
    table, page = book.worksheets[0], book.worksheets[1]
    assert table.protection.sheet and not table.protection.password, "protected, without a password"
    assert table.freeze_panes == "D2", table.freeze_panes
    assert all(cell.protection.locked for row in table["A1:C9"] for cell in row), "the plan is locked"
    assert not table.column_dimensions["A"].protection.locked, "rows below are open"
    kinds = [(str(v.sqref).split(":")[0], v.type) for v in table.data_validations.dataValidation]
    lists = [place for place, kind in kinds if kind == "list"]
    assert lists == ["A2", "B2", "C2"] and len(kinds) == table.max_column, kinds
    assert (page.title, str(page.page_setup.paperSize)) == ("Print", page.PAPERSIZE_A4), page.title


def fill_openpyxl(sheet, filled, readings):
    import openpyxl

    book = openpyxl.load_workbook(sheet)
    check_made(book)
    table = book.worksheets[0]
    headings = [cell.value for cell in table[1]]
    planned = [tuple(cell.value for cell in row[:3]) for row in table.iter_rows(min_row=2)]
    for number, name, values in rows_to_fill(planned, readings):
        for heading, value in values.items():
            cell = table.cell(number, headings.index(heading) + 1)
            assert number > len(planned) + 1 or not cell.protection.locked, f"{cell.coordinate} is protected"
            cell.value = float(value) if value else None
        for column, text in enumerate(name, 1):
            if number > len(planned) + 1:
                table.cell(number, column).value = text
    book.save(filled)


def fill_libreoffice(sheet, filled, readings):
    import uno
    from com.sun.star.beans import PropertyValue
    from com.sun.star.connection import NoConnectException

    folder = filled.parent.resolve()
    pipe = "stiffarm-sheets"
    profile = (folder / "profile").as_uri()
    office = subprocess.Popen(
        ["soffice", "--headless", "--norestore", f"-env:UserInstallation={profile}", f"--accept=pipe,name={pipe};urp;"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        local = uno.getComponentContext()
        resolver = local.ServiceManager.createInstanceWithContext("com.sun.star.bridge.UnoUrlResolver", local)
        for _ in range(120):
            try:
                context = resolver.resolve(f"uno:pipe,name={pipe};urp;StarOffice.ComponentContext")
                break
            except NoConnectException:
                time.sleep(0.5)
        else:
            sys.exit("LibreOffice did not start within a minute")
        desktop = context.ServiceManager.createInstanceWithContext("com.sun.star.frame.Desktop", context)

        def option(name, value):
            made = PropertyValue()
            made.Name, made.Value = name, value
            return made

        book = desktop.loadComponentFromURL(sheet.resolve().as_uri(), "_blank", 0, (option("Hidden", True),))
        table = book.Sheets.getByIndex(0)
        headings = []
        while text := table.getCellByPosition(len(headings), 0).String:
            headings.append(text)
        planned = []
        while table.getCellByPosition(0, len(planned) + 1).String:
            row = len(planned) + 1
            planned.append(tuple(table.getCellByPosition(column, row).String for column in range(3)))
        for number, name, values in rows_to_fill(planned, readings):
            for heading, value in values.items():
                cell = table.getCellByPosition(headings.index(heading), number - 1)
                if value:
                    cell.setValue(float(value))
                    assert cell.getValue() == float(value), f"{heading} of row {number} is protected"
            for column, text in enumerate(name):
                if number > len(planned) + 1:
                    table.getCellByPosition(column, number - 1).setString(text)
        book.storeToURL(filled.resolve().as_uri(), (option("FilterName", "Calc MS Excel 2007 XML"),))
        book.close(True)
        desktop.terminate()
    finally:
        office.terminate()
        office.wait(30)


def write_ordered(path, readings):
    """The readings as text in the order of the sheet: sums in another order differ in their last digits."""
    headings = [*NAMES, *next(iter(readings.values()))[0]]
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(headings)
        for _, name, values in rows_to_fill(list(readings), readings):
            writer.writerow([*name, *values.values()])


def result(stiffarm, measurements):
    """What identify says, without the names and sums of its inputs and the seal over them."""
    found = json.loads(run(stiffarm, "identify", CELL, str(measurements), "--json"))
    return {key: value for key, value in found.items() if key not in ("inputs", "seal")}


def main():
    by, stiffarm, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    folder.mkdir(parents=True, exist_ok=True)
    plan, sheet, readings = folder / "plan.csv", folder / "sheet.xlsx", folder / "readings.csv"
    run(stiffarm, "select", CELL, "--rounds", "1", "--output", str(plan), "--sheet", str(sheet),
        "--states", STATES, "--drift", "--base-reflector", "--force")
    run(stiffarm, "simulate", CELL, str(plan), "--runs", "2", "--readings", str(readings), "--force")
    filled = folder / f"filled-{by}.xlsx"
    known = readings_by_name(readings)
    {"openpyxl": fill_openpyxl, "libreoffice": fill_libreoffice}[by](sheet, filled, known)
    count = sum(map(len, known.values()))
    ordered = folder / "ordered.csv"
    write_ordered(ordered, known)
    wanted, found = result(stiffarm, ordered), result(stiffarm, filled)
    if wanted != found:
        (folder / "wanted.json").write_text(json.dumps(wanted, indent=1))
        (folder / "found.json").write_text(json.dumps(found, indent=1))
        sys.exit(f"identify makes something else of the filled sheet: compare {folder}/wanted.json and found.json")
    print(f"{count} rows filled by {by}: identify gives the same result as from the readings as text, digit for digit")


if __name__ == "__main__":
    main()
