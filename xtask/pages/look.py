"""Pictures of the pages for people to look at."""

import shutil
import subprocess

SIZES = [(1440, 900), (820, 1180), (390, 844)]


def at(browser, pages, folder):
    """Whole pages in three widths, light and dark, and as printed on A4, in pictures where pdftoppm is."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, page in pages:
        for scheme in ("light", "dark"):
            for width, height in SIZES:
                context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme)
                tab = opened(context, page)
                tab.screenshot(path=folder / f"{name}-{width}-{scheme}.png", full_page=True)
                context.close()
        context = browser.new_context(viewport={"width": 1440, "height": 900})
        tab = opened(context, page)
        file = folder / f"{name}.pdf"
        tab.pdf(path=file, format="A4", print_background=True, prefer_css_page_size=True)
        context.close()
        if shutil.which("pdftoppm"):
            subprocess.run(["pdftoppm", "-r", "70", "-png", file, folder / f"{name}-a4"], check=True)
        print(f"pictures of {name} in {folder}", flush=True)


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
