"""The checks on a page that was written by hand (`sample.html`): all of them accept it, and of each way to break it the
check that is there for it notices it."""

import pathlib

from checks import CHECKS, Expected, Opened
from finding import Finding

HERE = pathlib.Path(__file__).resolve().parent
RESULT = {
    "result": {
        "joints": [
            {"stiffness": 2500000.5, "std": 0.0125},
            {"stiffness": 1234567},
            {"stiffness": None},
            {"stiffness": -0.000123},
            {"stiffness": 3.1e6},
        ]
    }
}
NAME = "</script><img src=x onerror=alert(1)> \"quoted\" & more"
EXPECTED = Expected(commands=["identify"], numbers=6, groups=2, names=[NAME], frame_ms=50)

POLICY = """<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:">"""
END = "</main>"

# What is broken, the check that must notice it, what is replaced, and by what.
BROKEN = [
    ("a message of an error", "no console error", "draw(); scene", "console.error('broken'); draw(); scene"),
    ("an exception", "no console error", "</body>", "<script>undefined.x</script></body>"),
    ("a script that the page forbids itself", "no console error", END, "<script src='x.js'></script>" + END),
    ("a picture from the network", "no network request", POLICY, "<link rel='icon' href='http://127.0.0.1:9/x.png'><img alt='' src='http://127.0.0.1:9/x.png'>"),
    ("another file", "no network request", POLICY, "<img alt='' src='other.png'>"),
    ("a dialog", "no dialog", "draw(); scene", "alert(1); draw(); scene"),
    ("no policy", "policy", POLICY, ""),
    ("a policy that allows a server", "policy", "img-src data:", "img-src https: data:"),
    ("a policy without a default", "policy", "default-src 'none'", "object-src 'none'"),
    ("no verdict", "frame", 'id="verdict"', 'id="summary"'),
    ("another command", "frame", 'data-command="identify"', 'data-command="select"'),
    ("no title", "frame", "<title>A sample of a page</title>", ""),
    ("a wrong text", "numbers", ">2.50<", ">2.49<"),
    ("a wrong unit", "numbers", ">±1.25 %<", ">±0.0125<"),
    ("a wrong sign", "numbers", "&#8722;0.12", "0.12"),
    ("a wrong power", "numbers", "<sup>6</sup>", "<sup>5</sup>"),
    ("a wrong value", "numbers", 'data-value="1234567"', 'data-value="1234568"'),
    ("a number for null", "numbers", ">–<", ">0.0<"),
    ("too few numbers", "numbers", 'data-value="3.1e6"', ""),
    ("a name that has become an element", "names", "&lt;img src=x onerror=alert(1)&gt;", "<img src=x onerror=alert(1)>"),
    ("a name that is not there", "names", "&amp; more", ""),
    ("one id twice", "charts", '<g id="s0">', '<g id="cell">'),
    ("a chart without a caption", "charts", "<figcaption>Residuals of each posture in mm</figcaption>", ""),
    ("a chart without its data", "charts", "<td>0.02</td>", ""),
    ("a legend entry that does nothing", "legend", 'style.display = on ? "" : "none"', "blur()"),
    ("a scene that is never ready", "scene ready", 'scene.dataset.ready = "true"', ""),
    ("an empty scene", "scene ready", "function draw() {", "function draw() { return;"),
    ("a step button that does nothing", "steps", "Number(scene.dataset.posture) + 1", "Number(scene.dataset.posture)"),
    ("a step back that does nothing", "steps", "Number(scene.dataset.posture) - 1", "Number(scene.dataset.posture)"),
    ("a step that changes no picture", "steps", "40 * p + 20", "20"),
    ("no list of postures", "controls", 'data-control="posture"', ""),
    ("a toggle that does nothing", "groups", "[data-group-toggle]:checked", "[data-group-toggle]"),
    ("a toggle that changes no picture", "groups", "50 * Number(g || 9)", "0 * g"),
    ("a toggle too few", "controls", 'data-group-toggle="1"', ""),
    ("a slider that does nothing", "slider", "scene.dataset.exaggeration = e.target.value", ""),
    ("a slider that changes no picture", "slider", "30 + Number(scene.dataset.exaggeration)", "30"),
    ("no slider", "controls", 'data-control="deflection"', ""),
    ("one view alone", "controls", '<button type="button" data-view="top">Top</button>', ""),
    ("a point beside the picture", "inside", "0.1 * (1 +", "0.4 * (1 +"),
    ("arrows off their points", "arrows", "apart: () => [0]", "apart: () => [0.1]"),
    ("views that are one", "views", "view = i", "view = 0"),
    ("a button that Tab passes by", "keyboard", 'data-step="next">', 'data-step="next" tabindex="-1">'),
    ("a button that takes no keys", "keyboard", "data-step=\"next\"]').onclick", "data-step=\"next\"]').onpointerdown"),
    ("slow steps", "frame time", "performance.now() - start", "500"),
    ("no time of a step", "frame time", "scenes: { cell: { frameMs: 0 } }", "scenes: {}"),
    ("a table too wide for a telephone", "width", '<div class="wide"', '<div style="width: 600px"'),
    ("a button without a name", "axe", 'data-step="next">Next<', 'data-step="next"><'),
    ("grey on grey in the dark alone", "axe", "--ink: #eeeeee", "--ink: #333333"),
    ("a picture without a name", "axe", ' aria-label="Residuals"', ""),
    ("a row unlike many before it", "axe", "0.02</td></tr>", f"0.02</td></tr>{'<tr><td>0.02</td></tr>' * 30}<tr><td><button></button></td></tr>"),
    ("too large a file", "size", "</body>", f"<!--{'x' * 8_000_000}--></body>"),
]


def check(window, folder, report):
    """Opens them all and tells `report` what came of it."""
    good = (HERE / "sample.html").read_text(encoding="utf-8")
    page = folder / "sample.html"
    page.write_text(good, encoding="utf-8")
    opened = Opened(window, page, [RESULT], EXPECTED)
    for name, function in CHECKS.items():
        try:
            function(opened)
            report("sample", name, None)
        except Finding as finding:
            report("sample", name, f"a good page is not accepted: {finding}")
    missing = CHECKS.keys() - {check for _, check, _, _ in BROKEN}
    report("sample", "every check is tried", f"not {', '.join(missing)}" if missing else None)
    for what, name, old, new in BROKEN:
        if good.count(old) < 1:
            report("sample", what, f"there is no {old!r} in sample.html")
            continue
        page = folder / "broken.html"
        page.write_text(good.replace(old, new), encoding="utf-8")
        opened = Opened(window, page, [RESULT], EXPECTED, patience=0.15, whole=False)
        try:
            CHECKS[name](opened)
        except Finding:
            report("sample", what, None)
        else:
            report("sample", what, f"not noticed by the check `{name}`")
