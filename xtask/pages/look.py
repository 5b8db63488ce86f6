"""Pictures of the pages for people to look at."""

import io
import shutil
import subprocess

from PIL import Image

SIZES = [(1440, 900), (820, 1180), (390, 844)]


def at(browser, pages, folder):
    """Whole pages in three widths, light and dark, and as printed on A4, in pictures where pdftoppm is."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, page in pages:
        for scheme in ("light", "dark"):
            for width, height in SIZES:
                context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme)
                tab = opened(context, page)
                whole(tab, width, folder / f"{name}-{width}-{scheme}.png")
                context.close()
        context = browser.new_context(viewport={"width": 1440, "height": 900})
        tab = opened(context, page)
        file = folder / f"{name}.pdf"
        tab.pdf(path=file, format="A4", print_background=True, prefer_css_page_size=True)
        context.close()
        if shutil.which("pdftoppm"):
            subprocess.run(["pdftoppm", "-r", "70", "-png", file, folder / f"{name}-a4"], check=True)
        print(f"pictures of {name} in {folder}", flush=True)


# Chromium repeats what lies beyond some 8,000 px when it takes a page in one piece.
PIECE = 4000


def whole(tab, width, file):
    """A picture of the whole page, taken in pieces."""
    height = tab.evaluate("() => document.documentElement.scrollHeight")
    out = Image.new("RGB", (width, height))
    for top in range(0, height, PIECE):
        clip = {"x": 0, "y": top, "width": width, "height": min(PIECE, height - top)}
        piece = tab.screenshot(full_page=True, clip=clip)
        out.paste(Image.open(io.BytesIO(piece)).convert("RGB"), (0, top))
    out.save(file)


def gallery(browser, pages, folder, postures):
    """Two pictures of each page for the documentation: its beginning, and the cell in 3D at a posture."""
    folder.mkdir(parents=True, exist_ok=True)
    context = browser.new_context(viewport={"width": 1120, "height": 1000}, color_scheme="light")
    for name, page in pages:
        tab = opened(context, page)
        # The scene redraws with smooth edges once nothing moves.
        tab.wait_for_timeout(1500)
        tab.screenshot(path=folder / f"{name}.png")
        scene = tab.locator("div.scene").first
        if scene.count():
            scene.scroll_into_view_if_needed()
            scene.locator("select").first.select_option(index=postures.get(name, 1) - 1)
            tab.wait_for_timeout(1500)
            scene.screenshot(path=folder / f"{name}-cell.png")
        tab.close()
        for picture in folder.glob(f"{name}*.png"):
            # 128 colours are enough for a page, and a third of the size.
            Image.open(picture).convert("RGB").quantize(128, dither=Image.Dither.NONE).save(picture, optimize=True)
        print(f"ok {name}: pictures of the gallery", flush=True)
    context.close()


def opened(context, page):
    """The page with every scene drawn, at its top."""
    tab = context.new_page()
    tab.goto(page.resolve().as_uri(), wait_until="load")
    scenes = tab.locator("div.scene")
    for index in range(scenes.count()):
        scenes.nth(index).scroll_into_view_if_needed()
        for _ in range(600):
            if scenes.nth(index).get_attribute("data-ready") == "true":
                break
            tab.wait_for_timeout(50)
    tab.evaluate("() => scrollTo(0, 0)")
    tab.wait_for_timeout(300)
    return tab
