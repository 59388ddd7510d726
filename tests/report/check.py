"""Opens reports in a browser, as their readers do: python3 check.py REPORT... [--pictures DIR]

Fails if a page has an error, asks for another file, is wider than a narrow screen, or does not answer: the slider
moves the pictures, pictures and charts tell values to pointer and keyboard, a body in space turns.
"""

import argparse
import os

from browser import Browser, Page

NARROW, WIDE = 360, 1100

# A number for what a canvas shows.
PICTURE = """(selector) => { const canvas = document.querySelector(selector);
  const pen = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
  pen.drawImage(canvas, 0, 0);
  const { data } = pen.getImageData(0, 0, canvas.width, canvas.height);
  let sum = 0, colors = new Set();
  for (let i = 0; i < data.length; i += 4) {
    sum = (sum * 31 + data[i] + 7 * data[i + 1] + 13 * data[i + 2]) % 1000003;
    colors.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
  }
  return { sum, colors: colors.size }; }"""
CENTER = """(selector) => { const node = document.querySelector(selector);
  node.scrollIntoView({ block: "center" });
  const box = node.getBoundingClientRect();
  return [box.left, box.top, box.width, box.height]; }"""


class Check:
    def __init__(self, page, name):
        self.page, self.name, self.count = page, name, 0

    def that(self, holds, what):
        if not holds:
            raise SystemExit(f"{self.name}: {what}")
        self.count += 1

    def has(self, selector):
        return self.page.value(f"document.querySelector({selector!r}) !== null")

    def picture(self, selector):
        self.page.frame()
        return self.page.value(f"({PICTURE})({selector!r})")

    def text(self, selector):
        return self.page.value(f"document.querySelector({selector!r}).textContent").strip()

    def place(self, selector):
        box = self.page.value(f"({CENTER})({selector!r})")
        self.page.frame()
        return box

    def focus(self, selector):
        self.page.value(f"document.querySelector({selector!r}).focus()")

    def choose(self, selector, index):
        self.page.value(f"(() => {{ const choice = document.querySelector({selector!r}); choice.value = {index};"
                        f" choice.dispatchEvent(new Event('change')); }})()")
        self.page.frame()

    def quiet(self):
        self.that(not self.page.errors, f"the page has errors: {self.page.errors[:2]}")
        others = [r for r in self.page.requests if r != self.page.address and not r.startswith("data:")]
        self.that(not others, f"the page asks for {others}")

    def slider(self):
        """The slider goes to the first snapshot by the keyboard and moves what the pictures show."""
        if not self.has("#frame"):
            return
        canvas = next(filter(self.has, ("#body .view canvas", "#contact .map canvas", "#contact .view canvas")), None)
        before, text = canvas and self.picture(canvas), self.text(".time output")
        path = "document.querySelector('#body .chart path')?.getAttribute('d')"
        line = self.page.value(path)
        self.focus("#frame")
        self.page.key("Home")
        self.that(self.text(".time output") != text, "the slider does not change the time")
        if canvas:
            self.that(self.picture(canvas)["sum"] != before["sum"], f"the slider does not move {canvas}")
        elif line:
            self.that(self.page.value(path) != line, "the slider does not move the profile")
        self.page.key("End")
        self.that(self.text(".time output") == text, "the slider does not come back")
        if canvas:
            self.that(self.picture(canvas) == before, "the same time is another picture")

    def body(self):
        canvas = "#body .view canvas"
        if not self.has(canvas):
            return
        left, top, width, height = self.place(canvas)
        self.that(self.picture(canvas)["colors"] > 20, "the body has no colours")
        # Somewhere on the picture there is the body.
        places = [(x, y) for y in (0.5, 0.4, 0.6, 0.3, 0.7) for x in (0.5, 0.4, 0.6, 0.3, 0.7)]
        for x, y in places:
            self.page.mouse("mouseMoved", left + x * width, top + y * height)
            if self.text("#body .read"):
                break
        self.that(any(c.isdigit() for c in self.text("#body .read")), "the body tells no value")
        if self.has("#body canvas.turns"):
            before = self.picture(canvas)
            self.page.mouse("mousePressed", left + width / 2, top + height / 2, buttons=1)
            self.page.mouse("mouseMoved", left + width / 2 + 80, top + height / 2 + 20, buttons=1)
            self.page.mouse("mouseReleased", left + width / 2 + 80, top + height / 2 + 20)
            turned = self.picture(canvas)
            self.that(turned["sum"] != before["sum"], "the body does not turn")
            self.focus(canvas)
            self.page.key("ArrowRight")
            self.that(self.picture(canvas)["sum"] != turned["sum"], "the body does not turn by keys")
        for index in range(1, self.page.value("document.querySelectorAll('#body .view option').length")):
            before = self.picture(canvas)
            self.choose("#body .view select", index)
            self.that(self.picture(canvas)["sum"] != before["sum"], f"field {index} looks like the one before")

    def charts(self):
        for part in ("#history", "#probes", "#contact", "#body"):
            svg = f"{part} .chart > svg"
            if not self.has(svg):
                continue
            self.focus(svg)
            self.page.key("ArrowRight")
            first = self.text(f"{part} .chart .read")
            self.page.key("End")
            self.that(any(c.isdigit() for c in first), f"{part} tells no value")
            is_one = self.page.value(f"document.querySelectorAll({svg!r}).length") == 0
            self.that(is_one or self.text(f"{part} .chart .read") != "", f"{part} tells no last value")
            self.page.value(f"document.querySelector('{part} .chart details').open = true")
            self.page.wait(f"document.querySelectorAll('{part} .chart details td').length > 0")
            self.count += 1

    def fits(self, width):
        found = self.page.value("document.documentElement.scrollWidth")
        self.that(found <= width, f"the page is {found} wide on a screen of {width}")

    def names(self):
        """Everything that is drawn or pressed has a name for those who cannot see it."""
        bare = self.page.value("""[...document.querySelectorAll("canvas[role=img], svg[role=img], img, button, select, input")]
          .filter((node) => !(node.getAttribute("aria-label") || node.alt || node.textContent.trim() || node.closest("label")))
          .map((node) => node.outerHTML.slice(0, 80))""")
        self.that(not bare, f"without a name: {bare}")


def check(browser, path, pictures):
    name = os.path.basename(os.path.dirname(os.path.abspath(path)))
    count = 0
    for width, dark in ((WIDE, False), (NARROW, False), (WIDE, True)):
        page = Page(browser, path, width, 800, dark)
        tests = Check(page, f"{name} at a width of {width}")
        tests.quiet()
        tests.fits(width)
        tests.names()
        if pictures:
            page.screenshot(os.path.join(pictures, f"{name}-{width}{'-dark' if dark else ''}.png"))
        tests.slider()
        tests.body()
        tests.charts()
        tests.quiet()
        tests.fits(width)
        count += tests.count
        page.close()
    print(f"{name}: {count} checks")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("reports", nargs="+")
    parser.add_argument("--pictures", help="folder for pictures of the pages")
    arguments = parser.parse_args()
    if arguments.pictures:
        os.makedirs(arguments.pictures, exist_ok=True)
    with Browser() as browser:
        for path in arguments.reports:
            check(browser, path, arguments.pictures)


main()
