"""Opens the pages that stiffarm writes in Chromium and Firefox and checks them.

    python pages.py --stiffarm FILE --folder FOLDER [--chromium FILE] [--firefox FILE]
                    [--look FOLDER] [--only KIND,… | --all] [--gallery FOLDER]

Dear checks run where a page shows them something new, as `covering.py` says; with --only and --all everywhere.
One line for each check: `ok`, `FAILED` or `SKIPPED`, then page and check. The last line is
`pages: N passed, N failed, N skipped`. Exit code 1: a check failed.
"""

import argparse
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

from PIL import Image
from playwright.sync_api import Error, sync_playwright

import checks
import covering
import kinds
import look
import sample
from finding import Finding

# WebGL in software, as machines without a display have it. Everything else of a page is drawn without it: that takes
# half the time of drawing it through WebGL's software too.
DRAWING = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-gpu-compositing"]


class Tally:
    """Prints what came of each check and counts."""

    def __init__(self):
        self.passed = self.failed = self.skipped = 0

    def __call__(self, page, check, why, note=""):
        if why is None:
            self.passed += 1
            print(f"ok {page}: {check}{f' ({note})' if note else ''}", flush=True)
        else:
            self.failed += 1
            # One line, whatever a page answers.
            print(f"FAILED {page}: {check}: {' '.join(why.split())}", flush=True)

    def skip(self, page, why, fix):
        self.skipped += 1
        print(f"SKIPPED {page}: {why}; fix: {fix}", flush=True)


def check_page(window, tally, name, file, results, expected, only=checks.CHECKS, cover=None):
    """All checks, or `only` some, or those that `cover` does not spare, on one page; those after one that failed still run."""
    try:
        opened = checks.Opened(window, file, results, expected, whole=cover is None)
        spared = cover.spared(opened.page) if cover else ()
    except Error as error:
        tally(name, "opens", str(error))
        return
    for check, function in checks.CHECKS.items():
        if check not in only or check in spared:
            continue
        opened.notes.clear()
        try:
            function(opened)
            tally(name, check, None, ", ".join(opened.notes))
        except (Finding, Error) as finding:
            tally(name, check, str(finding))


def check_kinds(window, tally, maker, wanted, cover):
    """Makes the pages and checks them; returns those made."""
    made = []
    for kind in kinds.KINDS:
        if wanted and kind.name not in wanted:
            continue
        start = time.monotonic()
        try:
            pages, results = maker.make(kind)
        except kinds.NotMade as why:
            if kind.may_be_refused and why.code == 2:
                tally(kind.name, "is refused", None)
                continue
            tally(kind.name, "is made", str(why))
            continue
        tally(kind.name, "is made", None, f"{time.monotonic() - start:.1f} s with the command itself")
        results = checks.load(results)
        check_page(window, tally, kind.name, pages[0], results, kind.expected, cover=cover)
        made.append((kind.name, pages[0]))
        # `report` on the result must say the same as `--report` of the command did.
        if len(pages) > 1 and pages[1].read_bytes() != pages[0].read_bytes():
            check_page(window, tally, f"{kind.name} by report", pages[1], results, kind.expected, checks.BRIEF)
    return made


def firefox(tally, program, page, name):
    """Firefox draws the page: its picture has the wanted width and is no empty sheet."""
    with tempfile.TemporaryDirectory() as profile:
        target = pathlib.Path(profile) / "page.png"
        words = ["--headless", "--no-remote", "--profile", profile, "--window-size=1440,900", "--screenshot", str(target)]
        try:
            subprocess.run([program, *words, page.resolve().as_uri()], capture_output=True, timeout=120, check=True)
            picture = Image.open(target).convert("RGB")
        except (OSError, subprocess.SubprocessError) as error:
            tally(name, "opens in Firefox", str(error), "")
            return None
        picture.load()
    shades = picture.convert("L").histogram()
    alike = max(shades) / sum(shades)
    wrong = None
    if picture.size != (1440, 900):
        wrong = f"the picture has {picture.size[0]} by {picture.size[1]} pixels"
    elif alike > 0.98 or sum(n > 0 for n in shades) < 16:
        wrong = f"the picture is empty: {alike:.1%} of it has one shade"
    tally(name, "opens in Firefox", wrong, f"{alike:.0%} of one shade")
    return picture


def main():
    parser = argparse.ArgumentParser()
    for name in ("stiffarm", "folder"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    for name in ("chromium", "firefox", "look", "only", "gallery"):
        parser.add_argument(f"--{name}")
    parser.add_argument("--all", action="store_true")
    options = parser.parse_args()
    tally = Tally()
    folder = options.folder / "made"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)

    made = []
    maker = kinds.Maker(options.stiffarm, folder)
    there = maker.has_report()
    if options.chromium:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=options.chromium, args=DRAWING)
            wanted = options.only.split(",") if options.only else []
            if options.gallery:
                chosen = [kind for kind in kinds.KINDS if kind.name in (wanted or kinds.GALLERY)]
                made = [(kind.name, maker.make(kind)[0][0]) for kind in chosen]
                look.gallery(browser, made, pathlib.Path(options.gallery), kinds.GALLERY_POSTURES)
                browser.close()
                print(f"pages: {len(made)} passed, 0 failed, 0 skipped")
                return 0
            window = checks.Window(browser)
            if not wanted or "sample" in wanted:
                sample.check(window, folder, tally)
            if there:
                cover = None if wanted or options.all else covering.Covering()
                made = check_kinds(window, tally, maker, wanted, cover)
                if cover:
                    print(f"of {len(made)} kinds, {cover.told()}", flush=True)
            if options.look:
                look.at(browser, made or [("sample", folder / "sample.html")], pathlib.Path(options.look))
            browser.close()
    if not there:
        tally.skip("pages of stiffarm", "this stiffarm has no command report", "build a version that has it")
    if options.firefox:
        # One page of each: all of them have one script, and Firefox takes seconds to start.
        blank = folder / "blank.html"
        blank.write_text("<!doctype html><title>blank</title>", encoding="utf-8")
        if not made:
            page = folder / "sample.html"
            shutil.copy(sample.HERE / "sample.html", page)
            made = [("sample", page)]
        noticed = []
        firefox(lambda page, check, why, note: noticed.append(why), options.firefox, blank, "blank")
        tally("sample", "an empty page in Firefox", None if noticed[0] else "not noticed")
        for name, page in made if options.look else made[:1]:
            picture = firefox(tally, options.firefox, page, name)
            if options.look and picture:
                picture.save(pathlib.Path(options.look) / f"{name}-firefox.png")
    print(f"pages: {tally.passed} passed, {tally.failed} failed, {tally.skipped} skipped")
    return 1 if tally.failed else 0


if __name__ == "__main__":
    sys.exit(main())
