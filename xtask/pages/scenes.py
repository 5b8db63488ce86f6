"""Scenes in 3D on a page: postures step, groups toggle, the slider and the views work, by mouse and by keyboard, and the
picture changes with them."""

import io
import itertools
import statistics

from PIL import Image, ImageChops

from finding import Finding

NEXT, PREVIOUS = 'button[data-step="next"]', 'button[data-step="previous"]'
SELECT = 'select[data-control="posture"]'
SLIDER = 'input[type="range"][data-control="deflection"]'
TOGGLE, VIEW = 'input[type="checkbox"][data-group-toggle]', "button[data-view]"

# Pixels that must differ by more than a shade where a picture has changed.
PIXELS, SHADE = 30, 12
# Changes of more postures than these are followed by their number alone: a picture in software takes a second.
PICTURES = 8
# So many postures are stepped through, forward and back: more show nothing new.
STEPS = 60
# Tabs from the start of a page to its first scene and through it.
TABS = 1500
# Shared machines draw slowly; the median is for the record and fails only far beyond what a person notices.
FRAME_MS = 200

# Marks each scene and the smallest element that holds it together with its controls.
MARK = """() => [...document.querySelectorAll('div.scene')].map((scene, i) => {
    scene.dataset.testScene = i;
    let e = scene;
    while (e !== document.body && !e.querySelector('button[data-step]')) e = e.parentElement;
    e.setAttribute(`data-test-controls-${i}`, '');
    return scene.id;
})"""


class Scene:
    """A scene with its controls."""

    def __init__(self, opened, index, name):
        page = opened.page
        self.page, self.patience, self.name = page, opened.patience, name or f"number {index}"
        self.element = page.locator(f'[data-test-scene="{index}"]')
        self.controls = page.locator(f"[data-test-controls-{index}]")

    def get(self, name):
        return self.element.get_attribute(f"data-{name}")

    def control(self, selector):
        return self.controls.locator(selector)

    def clicked(self, selector, times):
        """Where the scene is after each of so many clicks, with no picture between them."""
        loop = """(button, [scene, times]) => Array.from({ length: times }, () => {
            button.click();
            return [scene.dataset.group, scene.dataset.posture]; })"""
        scene = self.element.element_handle()
        places = self.control(selector).first.evaluate(loop, [scene, times])
        return [(int(group or 0), int(posture or 0)) for group, posture in places]

    def wait(self, name, accept, what):
        """Until the attribute is accepted."""
        value = None
        for _ in range(round(100 * self.patience)):
            value = self.get(name)
            if accept(value):
                return value
            self.page.wait_for_timeout(50)
        raise Finding(f"scene {self.name}: {what} leaves data-{name} at {value!r}")

    def picture(self):
        """What the drawing shows, without words beside it: its canvas where there is one."""
        drawn = self.element.locator("canvas, svg")
        boxes = [(b["width"] * b["height"], i) for i in range(drawn.count()) if (b := drawn.nth(i).bounding_box())]
        # Layers of equal size lie over each other; the picture of one shows them all.
        target = drawn.nth(max(boxes)[1]) if boxes else self.element
        return Image.open(io.BytesIO(target.screenshot(animations="allow"))).convert("RGB")

    def settled(self):
        self.page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def changed(self, before, what):
        """The picture after a change; it may take the page a moment."""
        for _ in range(round(20 * self.patience)):
            self.settled()
            now = self.picture()
            if differ(before, now):
                return now
            self.page.wait_for_timeout(100)
        raise Finding(f"scene {self.name}: {what} does not change the picture")


def differ(before, now):
    if before.size != now.size:
        return True
    shades = ImageChops.difference(before, now).convert("L").histogram()
    return sum(shades[SHADE:]) > PIXELS


def all_of(opened):
    names = opened.page.evaluate(MARK)
    return [Scene(opened, i, name) for i, name in enumerate(names)]


def ready(opened):
    """Each scene is drawn, and its picture is not of one colour."""
    found = all_of(opened)
    if opened.expected.scene and not found:
        raise Finding("no div.scene")
    for scene in found:
        scene.element.scroll_into_view_if_needed()
        for _ in range(round(600 * opened.patience)):
            if scene.get("ready") == "true":
                break
            opened.page.wait_for_timeout(50)
        else:
            raise Finding(f"scene {scene.name}: data-ready is {scene.get('ready')!r} and stays so")
        scene.settled()
        colours = scene.picture().getcolors(1 << 24)
        if len(colours) < 8 or max(n for n, _ in colours) > 0.995 * sum(n for n, _ in colours):
            raise Finding(f"scene {scene.name} is empty")
    if found:
        opened.note(f"{len(found)} scenes")


def postures(scene):
    """How many postures the scene steps through."""
    for selector in (NEXT, PREVIOUS, SELECT):
        if scene.control(selector).count() == 0:
            raise Finding(f"scene {scene.name}: no {selector}")
    return scene.control(SELECT).first.locator("option").count()


def controls(opened):
    """Each scene has steps and views; groups can be toggled and the deflection exaggerated where the kind says so."""
    found = all_of(opened)
    for scene in found:
        postures(scene)
        if (count := scene.control(VIEW).count()) < 2:
            raise Finding(f"scene {scene.name}: {count} buttons data-view")
    groups = max((scene.control(TOGGLE).count() for scene in found), default=0)
    if opened.expected.groups > 1 and groups < opened.expected.groups:
        raise Finding(f"{groups} group toggles for {opened.expected.groups} groups")
    if opened.expected.slider and not any(scene.control(SLIDER).count() for scene in found):
        raise Finding(f"no {SLIDER}")


def place(scene):
    """Group and posture that the scene shows."""
    return int(scene.get("group") or 0), int(scene.get("posture") or 0)


def moved(scene, before, what):
    """Where the scene is once it has left `before`."""
    for _ in range(round(100 * scene.patience)):
        if (now := place(scene)) != before:
            return now
        scene.page.wait_for_timeout(20)
    raise Finding(f"scene {scene.name}: {what} does not leave posture {before}")


def steps(opened):
    """Forward through all postures and back, by mouse; then one by its name."""
    for scene in all_of(opened):
        count = postures(scene)
        scene.element.scroll_into_view_if_needed()
        # A scene opens at the first posture that violates a limit.
        scene.control(SELECT).first.select_option(index=0)
        scene.settled()
        picture, way = scene.picture(), [place(scene)]
        far = min(count, STEPS)
        by_mouse = min(far - 1, PICTURES)
        for _ in range(by_mouse):
            before = way[-1]
            scene.control(NEXT).first.click()
            way.append(moved(scene, before, NEXT))
            picture = scene.changed(picture, f"the step to posture {way[-1]}")
        # The others at once: a picture in software takes a second, and none is drawn between them.
        way += scene.clicked(NEXT, far - 1 - by_mouse)
        for (group, posture), to in itertools.pairwise(way):
            # The list may hold the postures of all groups: a step from the last of one leads to the first of the next.
            if to != (group, posture + 1) and not (to[1] == 0 and to[0] > group):
                raise Finding(f"scene {scene.name}: {NEXT} leads from posture {(group, posture)} to {to}")
        back = scene.clicked(PREVIOUS, far - 1)
        for i, (found, wanted) in enumerate(zip(back, way[-2::-1])):
            if found != wanted:
                raise Finding(f"scene {scene.name}: {PREVIOUS} leads from posture {way[-1 - i]} to {found}")
        if far > 1:
            scene.settled()
            picture = scene.picture()
            scene.control(SELECT).first.select_option(index=far - 1)
            if (chosen := moved(scene, way[0], "the list of postures")) != way[far - 1]:
                raise Finding(f"scene {scene.name}: number {far} of the list is posture {chosen}")
            scene.changed(picture, "a posture of the list")
        opened.note(f"{count} postures")


def groups(opened):
    """Each group can be hidden and shown."""
    for scene in all_of(opened):
        scene.element.scroll_into_view_if_needed()
        for index in range(min(scene.control(TOGGLE).count(), 4)):
            toggle = scene.control(TOGGLE).nth(index)
            group = toggle.get_attribute("data-group-toggle")
            picture = scene.picture()
            for _ in range(2):
                before = scene.get("shown-groups") or ""
                was_shown = group in before.split()
                toggle.focus()
                opened.page.keyboard.press("Space")
                told = f"the toggle of group {group}"
                scene.wait("shown-groups", lambda v: (group in (v or "").split()) != was_shown, told)
                picture = scene.changed(picture, told)


def slider(opened):
    """The slider exaggerates the deflection, and the picture follows."""
    for scene in all_of(opened):
        if not scene.control(SLIDER).count():
            continue
        scene.element.scroll_into_view_if_needed()
        scene.control(SLIDER).first.focus()
        opened.page.keyboard.press("Home")
        scene.settled()
        opened.page.wait_for_timeout(100)
        low, picture = scene.get("exaggeration"), scene.picture()
        opened.page.keyboard.press("End")
        high = scene.wait("exaggeration", lambda v: v != low, "the slider")
        if not float(high) > float(low):
            raise Finding(f"scene {scene.name}: the slider goes from {low} to {high}")
        scene.changed(picture, "the slider")


# Points of the tool, load and arrows of the posture shown, in shares of the picture: 0 to 1 is inside.
# The page that was written by hand says it itself.
DRAWN = """id => {
    const { picture, orbit, drawn } = window.stiffarm.scenes[id];
    if (drawn) return drawn();
    const seen = [...picture.points, picture.loadingPoint];
    if (picture.anchor.visible) seen.push(picture.anchor);
    for (const arrow of [picture.force, ...picture.residuals]) if (arrow.group.visible) seen.push(arrow.head);
    orbit.camera.updateMatrixWorld();
    return seen.map(one => { one.updateWorldMatrix(true, false);
        const p = one.position.clone().setFromMatrixPosition(one.matrixWorld).project(orbit.camera);
        return [(p.x + 1) / 2, (1 - p.y) / 2]; });
}"""
# View, posture and place of the first point outside; all of them at once, so that no picture is drawn between them.
OUTSIDE = """(controls, [id, most, slider, view, select]) => {
    const drawn = %s, of = selector => [...controls.querySelectorAll(selector)];
    const tell = (e, value) => { e.value = value; for (const name of ['input', 'change']) e.dispatchEvent(new Event(name, { bubbles: true })); };
    of(slider).slice(0, 1).forEach(e => tell(e, '0'));
    const list = of(select)[0], start = list.options[0].value;
    let outside = null;
    of(view).forEach((button, v) => {
        button.click();
        [...list.options].slice(0, most).forEach((option, p) => {
            tell(list, option.value);
            const point = drawn(id).find(([x, y]) => !(0.01 < x && x < 0.99 && 0.01 < y && y < 0.99));
            if (point) outside ??= [v, p, ...point];
        });
    });
    of(view)[0].click();
    tell(list, start);
    return outside;
}""" % DRAWN
# Windows whose pictures are wide, nearly square, and high.
WINDOWS = ((1440, 900), (820, 1180), (390, 844))
# So many postures of a scene are looked at in each window.
LOOKED_AT = 40


def inside(opened):
    """Whatever the posture, the view and the window, points, load and arrows are in the picture."""
    page = opened.page
    try:
        for width, height in WINDOWS:
            page.set_viewport_size({"width": width, "height": height})
            page.wait_for_timeout(200)
            for scene in all_of(opened):
                sought = [scene.name, LOOKED_AT, SLIDER, VIEW, SELECT]
                outside = scene.controls.evaluate(OUTSIDE, sought)
                if outside:
                    view, posture, x, y = outside
                    raise Finding(f"scene {scene.name}: in a window of {width}, view {view}, something of "
                                  f"posture {posture} is at {x:.2f}, {y:.2f} of the picture")
    finally:
        page.set_viewport_size({"width": 1440, "height": 900})


def arrows_follow(opened):
    """Arrows at the measuring points go with them as the slider moves the arm."""
    off = """id => { const { picture, apart } = window.stiffarm.scenes[id];
        if (apart) return apart();
        const shown = picture.residuals.filter(one => one.group.visible);
        return shown.map(one => Math.min(...picture.points.map(p => p.position.distanceTo(one.group.position))) / picture.size); }"""
    for scene in all_of(opened):
        if not scene.control(SLIDER).count() or not scene.control('input[data-toggle="arrows"]').count():
            continue
        for times in ("min", "max"):
            scene.control(SLIDER).first.evaluate("(e, end) => { e.value = e[end]; e.dispatchEvent(new Event('input')); }", times)
            far = max(opened.page.evaluate(off, scene.name), default=0)
            if far > 1e-3:
                raise Finding(f"scene {scene.name}: with the slider at its {times} an arrow begins off its point")
        scene.control(SLIDER).first.evaluate("e => { e.value = '0'; e.dispatchEvent(new Event('input')); }")


def views(opened):
    """Each view is another picture."""
    for scene in all_of(opened):
        buttons = scene.control(VIEW)
        scene.element.scroll_into_view_if_needed()
        buttons.first.click()
        scene.settled()
        opened.page.wait_for_timeout(200)
        picture = scene.picture()
        for index in range(1, buttons.count()):
            name = buttons.nth(index).get_attribute("data-view")
            buttons.nth(index).click()
            picture = scene.changed(picture, f"the view {name}")
        buttons.first.click()


FOCUSED = """() => { const e = document.activeElement;
    if (!e || e === document.body) return null;
    return [e.matches('[data-test-controls-0] *'), %s.find(s => e.matches(s)) ?? null]; }"""


def keyboard(opened):
    """Tab reaches the controls of the first scene, and they work by keys alone."""
    found = all_of(opened)
    if not found:
        return
    scene, page = found[0], opened.page
    wanted = [s for s in (NEXT, PREVIOUS, SELECT, SLIDER, TOGGLE, VIEW) if scene.control(s).count()]
    # From the first posture every control has somewhere to go.
    several = postures(scene) > 1
    if several:
        scene.control(SELECT).first.select_option(index=0)
        scene.wait("posture", lambda v: v == "0", "the list of postures")
    missing = set(wanted)
    query = FOCUSED % str(wanted)
    page.evaluate("() => { document.activeElement?.blur(); getSelection().removeAllRanges(); scrollTo(0, 0); }")
    for _ in range(TABS):
        if not missing:
            return
        page.keyboard.press("Tab")
        inside, which = page.evaluate(query) or (False, None)
        if inside and which in missing:
            press(scene, which, several)
            missing.discard(which)
    raise Finding(f"scene {scene.name}: Tab does not reach {', '.join(sorted(missing))}")


def press(scene, which, several):
    """Works the control that has the focus, and turns it back where others need that."""
    keys = scene.page.keyboard
    told = f"{which} by keyboard"
    if which in (NEXT, PREVIOUS, SELECT) and several:
        # `previous` may come before `next` in the page: it needs a posture to come from.
        if which == PREVIOUS and scene.get("posture") == "0":
            scene.control(SELECT).first.select_option(index=1)
            scene.wait("posture", lambda v: v == "1", "the list of postures")
            scene.control(PREVIOUS).first.focus()
        if which != PREVIOUS and scene.get("posture") != "0":
            scene.control(SELECT).first.select_option(index=0)
            scene.wait("posture", lambda v: v == "0", "the list of postures")
            scene.control(which).first.focus()
        before = scene.get("posture")
        keys.press("ArrowDown" if which == SELECT else "Enter")
        scene.wait("posture", lambda v: v != before, told)
    elif which == SLIDER:
        keys.press("Home")
        before = scene.get("exaggeration")
        keys.press("ArrowRight")
        scene.wait("exaggeration", lambda v: v != before, told)
    elif which == TOGGLE:
        for _ in range(2):
            before = scene.get("shown-groups")
            keys.press("Space")
            scene.wait("shown-groups", lambda v, b=before: v != b, told)
    elif which == VIEW:
        keys.press("Enter")


def frame_time(opened):
    """Stepping stays quick on the largest page."""
    if opened.expected.frame_ms is None:
        return
    page, scene = opened.page, all_of(opened)[0]
    scene.element.scroll_into_view_if_needed()
    page.evaluate("() => { window.stiffarm.measure = true; }")
    scene.control(SELECT).first.select_option(index=0)
    scene.settled()
    times = []
    for _ in range(min(postures(scene), STEPS) - 1):
        before = place(scene)
        scene.control(NEXT).first.click()
        moved(scene, before, NEXT)
        scene.settled()
        times.append(page.evaluate("id => window.stiffarm?.scenes?.[id]?.frameMs ?? null", scene.name))
    if not times or None in times:
        raise Finding(f"window.stiffarm.scenes[{scene.name!r}].frameMs is not there")
    median, longest = statistics.median(times), max(times)
    opened.note(f"a step takes {median:.1f} ms in the median of {len(times)}, {longest:.1f} ms at most; "
                f"{opened.expected.frame_ms:g} ms are wanted")
    if not median <= FRAME_MS:
        raise Finding(f"a step takes {median:.1f} ms in the median, more than {FRAME_MS} ms")
