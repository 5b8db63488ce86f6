"""Which checks run on which page. All pages share one script and one style sheet, so that the same content shows the same
faults on each: a dear check runs on a page only where that has content that no page before had."""

# The dear checks, each with what it looks at. The others run on every page.
LOOKS = {
    # What the entries of a legend put out lies in its figure.
    "legend": "figure:has([data-toggle-series]) *",
    # What is drawn and told of a posture, a load and a group comes from the data of the scene.
    "steps": "div.scene *",
    "groups": "div.scene *",
    "slider": "div.scene *",
    "views": "div.scene *",
    "inside": "div.scene *",
    # The keys go through everything that takes the focus, and work the controls of the scene.
    "keyboard": "a, button, input, select, summary, [tabindex]",
    # Any element may be too wide, without a name or hard to read; what a scene draws of its data is in its elements.
    "width": "body :not(script)",
    "axe": "body :not(script)",
}

# The kinds of content among the elements that a selector finds: tag, class, role, type, what is drawn or worked. Of the data of a scene
# each key that has a value, and words that are values: obstacles and arrows are no elements.
SHAPES = """selector => {
    const shapes = new Set();
    const read = (value, path) => {
        if (value === null) return;
        if (typeof value === 'object')
            for (const key in value) { if (key !== 'name') read(value[key], `${path}/${Array.isArray(value) ? '' : key}`); }
        else shapes.add(/^[a-z-]+$/.test(value) ? `${path}=${value}` : path);
    };
    for (const e of document.querySelectorAll(selector)) {
        if (e.matches('script[type="application/json"]')) read(JSON.parse(e.textContent), '');
        else {
            const { figure, control, toggle, step, view } = e.dataset;
            shapes.add([e.localName, e.getAttribute('class'), e.getAttribute('role'), e.type, figure, control, toggle, step, view].join());
        }
    }
    return [...shapes];
}"""


# Leaves out the rows of a table that are made of the same elements as this many before them: most of a page are the data
# behind its charts.
ROWS = 20
LEAVE_OUT = """rows => {
    const shape = e => [e.localName, e.getAttribute('class'), e.getAttribute('style'), e.getAttribute('role')].join();
    for (const body of document.querySelectorAll('tbody')) {
        const seen = {};
        for (const row of [...body.rows]) {
            const key = [row, ...row.querySelectorAll('*')].map(shape).join(';');
            seen[key] = (seen[key] ?? 0) + 1;
            if (seen[key] > rows) row.remove();
        }
    }
}"""


class Covering:
    """The content that each check has seen so far."""

    def __init__(self):
        self.seen = {check: set() for check in LOOKS}
        self.runs = dict.fromkeys(LOOKS, 0)

    def spared(self, page):
        """The checks to which this page shows nothing new."""
        spared = []
        shapes = {look: set(page.evaluate(SHAPES, look)) for look in set(LOOKS.values())}
        for check, seen in self.seen.items():
            new = shapes[LOOKS[check]] - seen
            seen |= new
            if new:
                self.runs[check] += 1
            else:
                spared.append(check)
        return spared

    def told(self):
        return ", ".join(f"{check} saw {runs}" for check, runs in self.runs.items())
