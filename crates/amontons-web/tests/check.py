"""Opens the page in headless Chromium and uses it: python3 check.py PAGE SUMMARY [--pictures DIR]

SUMMARY is the `summary.json` of a run of the paper's case by the program, with 16 cells and 16 steps: the page must give
its numbers. Fails if the page has an error, asks for another file, is wider than a narrow screen, or does not answer to
its controls.
"""

import argparse
import json
import os
import sys
import urllib.parse

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../tests/report"))
from browser import Browser, Page  # noqa: E402

NARROW, WIDE = 360, 1100
# What the program and the page may differ by: they round differently, since one has fused products.
AGREE = 1e-9


class Check:
    def __init__(self, page):
        self.page, self.count = page, 0
        self.settle()

    def that(self, holds, what):
        if not holds:
            raise SystemExit(f"the page: {what}")
        self.count += 1

    def settle(self):
        """Waits until everything that was asked for is there."""
        self.page.frame()
        self.page.wait("document.documentElement.dataset.ready === 'yes'")
        self.page.wait("[...document.images].every((image) => image.complete)")

    def set(self, selector, value):
        self.page.value(f"(() => {{ const node = document.querySelector({selector!r}); node.value = {json.dumps(value)};"
                        " node.dispatchEvent(new Event('input', { bubbles: true })); })()")
        self.settle()

    def click(self, selector):
        self.page.value(f"document.querySelector({selector!r}).click()")
        self.settle()

    def text(self, selector):
        return self.page.value(f"document.querySelector({selector!r}).textContent").strip()

    def picture(self, name):
        """What an image shows, as text."""
        return self.page.value(f"""(async () => {{
            const image = document.querySelector('#{name} img');
            const canvas = new OffscreenCanvas(400, 300), pen = canvas.getContext('2d');
            pen.drawImage(image, 0, 0, 400, 300);
            const {{ data }} = pen.getImageData(0, 0, 400, 300);
            let sum = 0; const colors = new Set();
            for (let i = 0; i < data.length; i += 4) {{
              sum = (sum * 31 + data[i] + 7 * data[i + 1] + 13 * data[i + 2]) % 1000003;
              colors.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
            }}
            return [sum, colors.size]; }})()""")

    def summary(self):
        return self.page.value("shown.summary")


def numbers(value, path=()):
    """The numbers of a summary by their path, without those that are of the machine and of the way of solving."""
    if isinstance(value, dict):
        for key, below in value.items():
            if key not in ("seconds", "solver", "memory", "machine", "findings", "threads", "version", "unknowns", "residual_max"):
                yield from numbers(below, (*path, key))
    elif isinstance(value, list):
        for i, below in enumerate(value):
            yield from numbers(below, (*path, i))
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path, value


def same_numbers(check, of_program):
    """The page and the program give the same numbers."""
    of_page = dict(numbers(check.summary()["final"]))
    of_program = dict(numbers(of_program["final"]))
    check.that(len(of_program) > 20 and of_page.keys() == of_program.keys(), "the summary has other numbers than the program's")
    for path, value in of_program.items():
        size = max(abs(value), 1e-3)
        check.that(abs(of_page[path] - value) <= AGREE * size, f"{path} is {of_page[path]}, the program has {value}")


def licences(check, page):
    """The foot of the page leads to the licences of its libraries, which are in the file beside it."""
    name = check.page.value("document.querySelector('footer #licences').getAttribute('href')")
    beside = os.path.join(os.path.dirname(os.path.abspath(page)), urllib.parse.unquote(name))
    check.that(os.path.isfile(beside), f"the foot leads to {name}, which is not beside the page")
    with open(beside, encoding="utf-8") as file:
        text = file.read()
    # A library of the page, the standard library, and texts.
    for part in ("\nfaer ", "\nstd ", "Text 1\n", "Permission is hereby granted"):
        check.that(part in text, f"the licences lack {part.strip()!r}")


def controls(check):
    names = check.page.value("shown.pictures")
    check.that(names == ["deformed", "temperature", "von-mises", "contact", "history"], f"the pictures are {names}")
    before = {name: check.picture(name) for name in names}
    check.that(all(colors > 3 for _, colors in before.values()), f"a picture is empty: {before}")
    check.that(before == {name: check.picture(name) for name in names}, "a picture changes by itself")
    # Friction, the foundation, the mesh and the time each change what they have to change.
    force = check.summary()["final"]["contact"]["force"]
    check.set("#friction", "0.6")
    check.that(check.text("output[for=friction]") == "0.6", "the slider does not tell its value")
    check.that(check.summary()["final"]["contact"]["force"] != force, "friction does not change the force")
    check.that(check.picture("contact") != before["contact"], "friction does not change the picture of the contact")
    check.that("contact.friction" in check.page.value("shown.case") or "0.6" in check.page.value("shown.case"), "the case is not the one that was run")
    warm = check.picture("temperature")
    check.set("#foundation", "10")
    check.that(check.picture("temperature") != warm, "the foundation does not change the temperatures")
    check.that(check.summary()["final"]["temperature_max"] > 0.2, "a hot foundation does not heat the body")
    late = check.picture("temperature")
    check.set("#frame", "4")
    check.that(check.text(".time output") == "t = 0.25" and check.picture("temperature") != late, "the time does not move the pictures")
    check.set("#cells", "8")
    check.that("steps" in check.text("#state") or check.summary()["steps"] == 8, "the mesh does not follow its choice")
    # From the keyboard.
    check.page.value("document.querySelector('#friction').focus()")
    check.page.key("ArrowRight")
    check.settle()
    check.that(check.text("output[for=friction]") == "0.61", "the slider does not answer to the keyboard")


def faults(check):
    """A case with a fault is refused with its line, and what was solved before stays; one's own case is run as it is."""
    text = check.page.value("document.querySelector('#case').value")
    headline = check.text("#rows")
    spoiled = text.replace("poisson = 0.1", "poison = 0.1")
    check.set("#case", spoiled)
    check.set("#friction", "0.5")
    check.that(check.page.value("document.querySelector('#case').value") == spoiled, "a slider writes over what was typed")
    headline = check.text("#rows")
    check.click("#run")
    error = check.text("#error")
    check.that("case.toml:" in error and "poison: " in error and "expected" in error, f"the fault is told as {error!r}")
    check.that(check.text("#rows") == headline, "a fault takes away what was solved")
    check.set("#case", text.replace("poisson = 0.1", "poisson = 0.3").replace('name = "paper"', 'name = "mine"'))
    check.click("#run")
    check.that(check.text("#error") == "" and "mine" in check.text("#state"), f"one's own case is not run: {check.text('#error')}")
    check.that(check.page.value("document.querySelector('#friction').disabled"), "sliders of the paper's case stay in use")
    check.click("#back")
    check.that("paper" in check.text("#state"), "there is no way back")
    # A run can be stopped, and the page goes on.
    check.page.value("document.querySelector('#stop').disabled = false; document.querySelector('#stop').click()")
    check.settle()
    check.that("stopped" in check.text("#error"), "a run cannot be stopped")
    check.set("#friction", "0.3")
    check.that(check.text("#error") == "", "after a stop the page does not go on")


def quiet(check):
    check.that(not check.page.errors, f"the page has errors: {check.page.errors[:2]}")
    others = [r for r in check.page.requests if r != check.page.address and not r.startswith(("data:", "blob:"))]
    check.that(not others, f"the page asks for {others}")


def narrow(check):
    width = check.page.value("document.documentElement.scrollWidth")
    check.that(width <= NARROW, f"the page is {width} wide on a screen of {NARROW}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page")
    parser.add_argument("summary")
    parser.add_argument("--pictures", help="folder for photographs of the page")
    options = parser.parse_args()
    with open(options.summary) as file:
        of_program = json.load(file)
    count = 0
    with Browser() as browser:
        for width, dark in ((WIDE, False), (NARROW, True)):
            page = Page(browser, options.page, width, 900, dark=dark)
            check = Check(page)
            same_numbers(check, of_program)
            licences(check, options.page)
            if width == NARROW:
                narrow(check)
            if options.pictures:
                os.makedirs(options.pictures, exist_ok=True)
                page.screenshot(os.path.join(options.pictures, f"page-{width}.png"))
            controls(check)
            faults(check)
            if width == NARROW:
                narrow(check)
            quiet(check)
            count += check.count
            page.close()
    print(f"{options.page}: {count} checks hold")


if __name__ == "__main__":
    main()
