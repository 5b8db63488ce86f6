"""Makes faro-style.xlsx: a made-up export with titles, dates as a spreadsheet keeps them, and the table on
the second worksheet. Needs openpyxl 3.1; the numbers are those of the other files of this folder."""

import csv
import datetime
import pathlib

import openpyxl

HERE = pathlib.Path(__file__).parent
START = datetime.datetime(2026, 11, 23, 13, 58, 40)
SECONDS = [0, 12.5, 61, 75.25, 1260, 1272.5, 1320, 1334.75]

book = openpyxl.Workbook()
book.active.title = "Info"
book.active.append(["Project", "made up"])
sheet = book.create_sheet("Points")
sheet.append(["Readings of a laser tracker"])
sheet.append([])
sheet.append(["Feature", "Actual X", "Actual Y", "Actual Z", "Measured at"])
with open(HERE / "spatialanalyzer-comma.txt", newline="") as file:
    lines = [row for row in csv.reader(file) if not row[0].startswith("//")]
for (posture, state, point, *position), seconds in zip(lines, SECONDS):
    moment = START + datetime.timedelta(seconds=seconds)
    sheet.append([f"{posture}|{state}|{point}", *map(float, position), moment])
book.save(HERE / "faro-style.xlsx")
