"""What must hold of a page that stiffarm writes. Each check is a function of an [`Opened`] page that raises [`Finding`];
`CHECKS` lists them in the order in which they run on one page."""

import dataclasses
import json
import pathlib

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Error

import numbers_shown
import scenes
from covering import LEAVE_OUT, ROWS
from finding import Finding

MEGABYTE = 1e6


@dataclasses.dataclass
class Expected:
    """What a page of a kind must have. `commands` are those of its results, in their order."""

    commands: list
    numbers: int = 10
    scene: bool = True
    groups: int = 1
    slider: bool = True
    names: list = dataclasses.field(default_factory=list)
    megabytes: float = 8
    frame_ms: float | None = None


class Window:
    """Where pages are opened one after the other: a window for each costs more than most checks."""

    def __init__(self, browser):
        self.browser, self.context = browser, None
        self.errors, self.requests, self.dialogs = [], [], []
        self.renew()

    def renew(self):
        """Another window, after a page that this one may not get rid of."""
        if self.context:
            self.context.close()
        self.context = self.browser.new_context()
        self.page = self.context.new_page()
        self.page.set_default_timeout(30_000)
        self.page.on("console", lambda m: self.errors.append(m.text) if m.type == "error" else None)
        self.page.on("pageerror", lambda e: self.errors.append(str(e)))
        self.page.on("request", lambda r: self.requests.append(r.url))
        self.page.on("websocket", lambda w: self.requests.append(w.url))
        self.page.on("dialog", self._dialog)

    def _dialog(self, dialog):
        self.dialogs.append(f"{dialog.type} `{dialog.message}`")
        dialog.dismiss()

    def show(self, url):
        """Opens it as if it were the first, with an empty page before it, so that nothing of another goes on."""
        try:
            self.page.goto("about:blank")
        except Error:
            self.renew()
        self.page.set_viewport_size({"width": 1440, "height": 900})
        self.page.emulate_media(color_scheme="light")
        self.page.mouse.move(0, 0)
        for told in (self.errors, self.requests, self.dialogs):
            told.clear()
        self.page.goto(url, wait_until="load")


class Opened:
    """A page opened from disk, with everything that it said and asked for."""

    def __init__(self, window, file, results, expected, patience=1.0, whole=True):
        self.file = pathlib.Path(file)
        self.url = self.file.resolve().as_uri()
        self.results = results
        # Factor on the times that a check waits for something to happen.
        self.patience = patience
        self.expected = expected
        # Whether axe looks at every row of long tables.
        self.whole = whole
        self.notes = []
        window.show(self.url)
        self.page, self.errors, self.requests, self.dialogs = window.page, window.errors, window.requests, window.dialogs

    def note(self, text):
        """A figure for the record, printed beside the check."""
        self.notes.append(text)


def size(opened):
    """The file is no larger than it may be."""
    size = opened.file.stat().st_size / MEGABYTE
    opened.note(f"{size:.2f} MB")
    if size > opened.expected.megabytes:
        raise Finding(f"{size:.2f} MB, more than {opened.expected.megabytes:g} MB")


QUIET_SOURCES = ("'none'", "'unsafe-inline'", "'unsafe-eval'", "'wasm-unsafe-eval'", "data:", "blob:")


def policy(opened):
    """The page itself forbids every request."""
    metas = opened.page.locator('head meta[http-equiv="Content-Security-Policy"]')
    if metas.count() == 0:
        raise Finding("no <meta http-equiv=\"Content-Security-Policy\"> in the head")
    directives = [d.split() for d in metas.first.get_attribute("content").split(";") if d.strip()]
    if ["default-src", "'none'"] not in directives:
        raise Finding("Content-Security-Policy without `default-src 'none'`")
    for name, *sources in directives:
        for source in sources:
            if source not in QUIET_SOURCES and not source.startswith(("'sha256-", "'sha384-", "'sha512-")):
                raise Finding(f"Content-Security-Policy allows {source} in {name}")


def frame_of_page(opened):
    """A language, a title, the command of each result, a verdict."""
    found = opened.page.evaluate(
        """() => ({
            language: document.documentElement.lang, title: document.title.trim(),
            main: [...document.querySelectorAll('main')].map(m => m.dataset.command ?? null),
            sections: [...document.querySelectorAll('main section[data-command]')]
                .map(s => [s.dataset.command, s.dataset.result ?? null]),
            verdict: document.querySelector('section#verdict')?.innerText.trim() ?? null,
        })"""
    )
    if not found["language"] or not found["title"]:
        raise Finding("no lang or no <title>")
    if len(found["main"]) != 1:
        raise Finding(f"{len(found['main'])} elements <main>")
    commands = opened.expected.commands
    if len(commands) == 1:
        if found["main"] != commands:
            raise Finding(f"<main data-command> is {found['main'][0]!r}, not {commands[0]!r}")
    else:
        wanted = [[command, str(index)] for index, command in enumerate(commands)]
        # A result may have several sections; each result must have one, and none may be of another command.
        if any(w not in found["sections"] for w in wanted) or any(s not in wanted for s in found["sections"]):
            raise Finding(f"sections {found['sections']} of results {wanted}")
    if len(found["verdict"] or "") < 40:
        raise Finding(f"section#verdict says {found['verdict']!r}")


def numbers(opened):
    """The numbers on the page are those of the results."""
    opened.note(numbers_shown.check(opened.page, opened.results, opened.expected.numbers))


def charts(opened):
    """Charts have a caption and their data behind them; ids are unique."""
    problems = opened.page.evaluate(
        """() => {
            const problems = [], seen = new Set();
            for (const e of document.querySelectorAll('[id]')) {
                if (seen.has(e.id)) problems.push(`id ${e.id} twice`);
                seen.add(e.id);
            }
            for (const svg of document.querySelectorAll('svg[data-figure]')) {
                // A scene shows its drawing on paper, and where it cannot draw.
                if (svg.closest('.scene')) continue;
                const name = svg.dataset.figure, figure = svg.closest('figure');
                if (!figure) { problems.push(`chart ${name} outside <figure>`); continue; }
                if (!figure.querySelector('figcaption')?.textContent.trim())
                    problems.push(`chart ${name} without caption`);
                const next = figure.nextElementSibling;
                const table = figure.querySelector('details table')
                    ?? (next?.matches('details') ? next.querySelector('table') : null);
                // A drawing of things has no data.
                if (!svg.closest('.sheet') && (!table || table.querySelectorAll('td').length === 0))
                    problems.push(`chart ${name} without a table of its data`);
                // Of the forms for narrow and for wide screens one is seen.
                const forms = [...figure.querySelectorAll('svg[data-figure]')];
                const size = one => { const box = one.getBoundingClientRect(); return box.width >= 50 && box.height >= 30; };
                const shown = forms.filter(one => one.dataset.figure === name && size(one)).length;
                if (!svg.closest('details:not([open])') && shown !== 1)
                    problems.push(`chart ${name} is seen ${shown} times`);
            }
            return problems;
        }"""
    )
    if problems:
        raise Finding("; ".join(problems[:5]))
    opened.note(f"{opened.page.locator('svg[data-figure]').count()} charts")


def legend(opened):
    """Entries of legends put their series out, and back, by keyboard."""
    toggles = opened.page.locator("[data-toggle-series]").locator("visible=true")
    for index in range(min(toggles.count(), 6)):
        toggle = toggles.nth(index)
        name = toggle.get_attribute("data-toggle-series")
        if toggle.evaluate("e => e.tagName !== 'BUTTON' && e.getAttribute('role') !== 'button'"):
            raise Finding(f"legend entry {name} is no button")
        figure = "e => (e.closest('svg[data-figure]') ?? document.body.querySelector('svg[data-figure]'))?.outerHTML"
        pressed, picture = toggle.get_attribute("aria-pressed"), toggle.evaluate(figure)
        toggle.focus()
        opened.page.keyboard.press("Enter")
        opened.page.wait_for_timeout(50)
        if toggle.get_attribute("aria-pressed") == pressed or toggle.evaluate(figure) == picture:
            raise Finding(f"legend entry {name} changes nothing")
        opened.page.keyboard.press("Enter")


def names_stay_text(opened):
    """Names of other people are text: nothing of them becomes an element or runs."""
    if opened.page.locator("img[src=x], [onerror]").count():
        raise Finding("a name has become an element of the page")
    # innerHTML of a template reads no script, so this is what a person can find on the page.
    text = opened.page.evaluate(
        """() => { const main = document.body.cloneNode(true);
            for (const e of main.querySelectorAll('script, style')) e.remove();
            return main.textContent; }"""
    )
    for name in opened.expected.names:
        if name not in text:
            raise Finding(f"the name {name!r} is not on the page")


def width(opened):
    """At no width does the page scroll sideways, with all details open."""
    page = opened.page
    page.evaluate("() => document.querySelectorAll('details').forEach(d => d.open = true)")
    try:
        for width, height in ((1440, 900), (820, 1180), (390, 844)):
            page.set_viewport_size({"width": width, "height": height})
            page.wait_for_timeout(200)
            found = page.evaluate(
                """() => { const wide = document.scrollingElement.scrollWidth;
                    if (wide <= innerWidth + 1) return null;
                    const boxed = e => { for (let p = e.parentElement; p && p !== document.body; p = p.parentElement)
                        if (getComputedStyle(p).overflowX !== 'visible') return true; return false; };
                    const e = [...document.body.querySelectorAll('*')].find(
                        e => e.getBoundingClientRect().right > innerWidth + 1 && !boxed(e));
                    return [wide, e ? `${e.tagName.toLowerCase()}#${e.id}.${e.className.baseVal ?? e.className}` : '?'];
                }"""
            )
            if found:
                raise Finding(f"{found[0]} pixels wide in a window of {width}; the first to stick out is {found[1]}")
    finally:
        page.set_viewport_size({"width": 1440, "height": 900})
        page.evaluate("() => document.querySelectorAll('details').forEach(d => d.open = false)")


AXE = Axe()


def accessible(opened):
    """axe finds nothing serious or critical, in light and in dark, with all details open."""
    page = opened.page
    page.evaluate("() => document.querySelectorAll('details').forEach(d => d.open = true)")
    if not opened.whole:
        page.evaluate(LEAVE_OUT, ROWS)
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        page.wait_for_timeout(300)
        response = AXE.run(page).response
        grave = [v for v in response["violations"] if v["impact"] in ("serious", "critical")]
        if grave:
            told = [f"{v['id']} ({v['impact']}) at {v['nodes'][0]['target'][0]}, {len(v['nodes'])} times" for v in grave]
            raise Finding(f"in {scheme}: " + "; ".join(told))
    page.emulate_media(color_scheme="light")
    page.evaluate("() => document.querySelectorAll('details').forEach(d => d.open = false)")


def no_error(opened):
    """Nothing went wrong while all of this was done."""
    if opened.errors:
        raise Finding(f"{len(opened.errors)}, the first: {opened.errors[0][:300]}")


def no_request(opened):
    """Nothing but the page was asked for."""
    others = [u for u in opened.requests if u.split("#")[0] != opened.url and not u.startswith(("data:", "blob:"))]
    if others:
        raise Finding(f"{len(others)}, the first: {others[0][:200]}")


def no_dialog(opened):
    """No name opened a dialog."""
    if opened.dialogs:
        raise Finding(opened.dialogs[0])


# The last three judge what the page did while the others ran.
CHECKS = {
    "size": size,
    "policy": policy,
    "frame": frame_of_page,
    "numbers": numbers,
    "names": names_stay_text,
    "charts": charts,
    "legend": legend,
    "scene ready": scenes.ready,
    "controls": scenes.controls,
    "steps": scenes.steps,
    "groups": scenes.groups,
    "slider": scenes.slider,
    "views": scenes.views,
    "inside": scenes.inside,
    "arrows": scenes.arrows_follow,
    "keyboard": scenes.keyboard,
    "frame time": scenes.frame_time,
    "width": width,
    "axe": accessible,
    "no console error": no_error,
    "no network request": no_request,
    "no dialog": no_dialog,
}

# What a second page of the same result is asked.
BRIEF = ("size", "policy", "frame", "numbers", "names", "scene ready", "no console error", "no network request", "no dialog")


def load(results):
    """The results as JSON."""
    return [json.loads(pathlib.Path(r).read_text(encoding="utf-8")) for r in results]
