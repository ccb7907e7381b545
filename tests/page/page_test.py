#!/usr/bin/python3
"""report.html in headless Chromium: page_test.py KERF SOURCES. Exit code 77, with the reason, where there is no browser."""

import csv
import html.parser
import importlib.util
import json
import math
import os
import pathlib
import re
import shutil
import sys
import tempfile
import unittest

here = pathlib.Path(__file__).resolve().parent


def missing():
    if importlib.util.find_spec("selenium") is None:
        return "python3-selenium is not installed"
    for program, package in (("chromium", "chromium"), ("chromedriver", "chromium-driver")):
        if shutil.which(program) is None:
            return f"{package} is not installed"
    return None


if reason := missing():
    if sys.executable != "/usr/bin/python3" and os.path.exists("/usr/bin/python3"):  # Debian's modules are there
        os.execv("/usr/bin/python3", ["/usr/bin/python3", *sys.argv])
    print(f"skipped: {reason}")
    sys.exit(77)

sys.path.insert(0, str(here))
from browser import Browser  # noqa: E402
import pages  # noqa: E402

kerf, sources = sys.argv[1], pathlib.Path(sys.argv[2])
largest = 1.5e6

# Distinct colors of a canvas, a share of which is drawn.
colors_of = """
const c = arguments[0], probe = document.createElement("canvas");
probe.width = 200; probe.height = 120;
const context = probe.getContext("2d");
context.drawImage(c, 0, 0, 200, 120);
const d = context.getImageData(0, 0, 200, 120).data, seen = new Set();
let drawn = 0;
for (let i = 0; i < d.length; i += 4) if (d[i + 3] > 0) { ++drawn; seen.add(d[i] << 16 | d[i + 1] << 8 | d[i + 2]); }
return [seen.size, drawn / (d.length / 4)];
"""

# Texts whose contrast against what lies behind them is below 4.5 (3 for large ones).
low_contrast = """
const parse = (text) => { const m = text.match(/[\\d.]+/g).map(Number); return { rgb: m.slice(0, 3), a: m.length > 3 ? m[3] : 1 }; };
const light = (rgb) => { const [r, g, b] = rgb.map((v) => { v /= 255; return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; }); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
const out = [];
let looked = 0;
for (const e of document.querySelectorAll("main *")) {
  const own = [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
  if (!own || ["SCRIPT", "STYLE", "NOSCRIPT", "OPTION"].includes(e.tagName) || e.getClientRects().length === 0) continue;
  const style = getComputedStyle(e);
  const ink = parse(e instanceof SVGElement ? style.fill : style.color).rgb;
  let behind = e, paper = null;
  while (behind && !paper) { const p = parse(getComputedStyle(behind).backgroundColor); if (p.a > 0.99) paper = p.rgb; behind = behind.parentElement; }
  paper = paper || [255, 255, 255];
  const [a, b] = [light(ink), light(paper)].sort((x, y) => y - x), ratio = (a + 0.05) / (b + 0.05);
  const large = parseFloat(style.fontSize) >= 24 || (parseFloat(style.fontSize) >= 18.6 && style.fontWeight >= 700);
  ++looked;
  if (ratio < (large ? 3 : 4.5)) out.push(`${e.tagName}.${e.className}: ${ratio.toFixed(2)} "${e.textContent.trim().slice(0, 30)}"`);
}
return [looked, out];
"""


class Text(html.parser.HTMLParser):
    """What is there without scripts: cells of tables, and the rest."""

    def __init__(self, text):
        super().__init__()
        self.cells, self.skip, self.inside = [], 0, False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.skip += tag in ("script", "style")
        if tag in ("td", "th"):
            self.inside = True
            self.cells.append("")

    def handle_endtag(self, tag):
        self.skip -= tag in ("script", "style")
        if tag in ("td", "th"):
            self.inside = False

    def handle_data(self, data):
        if self.inside and not self.skip:
            self.cells[-1] += data


class PageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="kerf_pages_"))
        cls.cracked = pages.cracked(kerf, sources / "cases", cls.folder)
        cls.beam = pages.designed(kerf, cls.folder)
        cls.strange = pages.strange(kerf, cls.folder)
        cls.browser = Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        shutil.rmtree(cls.folder)

    def setUp(self):
        self.browser.size(1400)
        self.browser.scheme("light")

    def show(self, folder, part=""):
        """The renderer for browsers without a GPU, as this one; `#webgl` takes an imitation of one."""
        self.browser.open(folder / "report.html", part)

    def quiet(self):
        # What the imitation of a GPU says of itself (#webgl, below) is not said by the page.
        said = [m for m in self.browser.messages() if "GL Driver Message" not in m]
        self.assertEqual(said, [])
        others = [url for url in self.browser.requests() if not url.split("#")[0].endswith("/report.html")]
        self.assertEqual(others, [])

    def all_pages(self):
        return {"cracked": self.cracked, "beam": self.beam, **self.strange}

    def test_no_message_no_request_not_large(self):
        for name, folder in self.all_pages().items():
            for part in ("", "#webgl"):
                with self.subTest(name=name, part=part):
                    self.show(folder, part)
                    self.assertEqual(self.browser.ask("return document.documentElement.dataset.ready"), "1")
                    self.quiet()
            self.assertLess((folder / "report.html").stat().st_size, largest)

    def test_the_page_of_every_case_is_small(self):
        """Of the state on the mesh that the case asks for; map, outlines of designs and tables add less than a half."""
        for case in sorted((sources / "cases").glob("*.toml")):
            out = self.folder / "small" / case.stem
            pages.run(kerf, "solve", case, "-o", out, "--quiet", "--set", "output.vtk=false", "--set", "output.png=false")
            self.assertLess((out / "report.html").stat().st_size, largest / 1.5, case.stem)

    def test_figures_are_drawn(self):
        kinds = set()
        for part in ("", "#webgl"):
            self.show(self.cracked, part)
            for id in ("stress", "map"):
                canvas = self.browser.driver.find_element("css selector", f"#{id} canvas.field")
                count, share = self.browser.ask(colors_of, canvas)
                self.assertGreater(count, 30)
                self.assertGreater(share, 0.15)
            kinds.add(self.browser.ask("return document.getElementById('map').dataset.renderer"))
            self.assertGreaterEqual(self.browser.ask("return document.querySelectorAll('.u-wrap canvas').length"), 4)
        self.assertIn("canvas", kinds)
        if "webgl" not in kinds:
            print("note: this Chromium has no WebGL2; only the canvas was tried")
        self.show(self.beam)
        for css in ("#design canvas.field", "#stress canvas.field"):
            count, share = self.browser.ask(colors_of, self.browser.driver.find_element("css selector", css))
            self.assertGreater(share, 0.1)

    def test_both_renderers_agree(self):
        pictures = []
        for part in ("", "#webgl"):
            self.show(self.cracked, part)
            pictures.append(self.browser.ask("""
                const c = document.querySelector("#map canvas.field"), p = document.createElement("canvas");
                p.width = 60; p.height = 40;
                p.getContext("2d").drawImage(c, 0, 0, 60, 40);
                return [...p.getContext("2d").getImageData(0, 0, 60, 40).data];"""))
        apart = [abs(a - b) for a, b in zip(*pictures)]
        self.assertLess(sum(apart) / len(apart), 8)

    def rows_of_map(self):
        with open(self.cracked / "map.csv") as file:
            return [{k: float(v) if v else math.nan for k, v in row.items()} for row in csv.DictReader(file)]

    def test_hover_says_what_map_csv_says(self):
        for part in ("", "#webgl"):
            self.show(self.cracked, part)
            rows = self.rows_of_map()
            free = [i for i, r in enumerate(rows) if r["masked"] == 0 and math.isfinite(r["topological_derivative"])]
            for corner in (free[len(free) // 7], free[len(free) // 2], free[-len(free) // 9]):
                row = rows[corner]
                x, y = self.browser.ask("""
                    const f = window.kerf.figures[1];
                    f.root.scrollIntoView({ block: "center" });
                    const r = f.front.getBoundingClientRect(), p = f.toScreen(arguments[0], arguments[1]);
                    return [r.left + p[0], r.top + p[1]];""", row["x"], row["y"])
                self.browser.mouse("mouseMoved", x, y)
                self.browser.settle()
                said = self.browser.ask("return { ...document.querySelector('#map .readout').dataset }")
                for key, column in (("x", "x"), ("y", "y"), ("value", "topological_derivative")):
                    self.assertLessEqual(abs(float(said[key]) - row[column]), 1e-6 * max(1, abs(row[column])), (corner, key))
                text = self.browser.ask("return document.querySelector('#map .readout').value")
                self.assertIn("error bar", text)
        self.quiet()

    def test_masked_places_say_why(self):
        self.show(self.cracked)
        rows = self.rows_of_map()
        masked = next(i for i, r in enumerate(rows) if r["masked"] == 1)
        said = self.browser.ask("""
            const f = window.kerf.figures[1];
            f.show(f.valueAt(f.points[2 * arguments[0]], f.points[2 * arguments[0] + 1], 1e-9));
            return f.readout.value;""", masked)
        self.assertRegex(said, r"masked: .* from (the boundary|a crack|another material), nearer than 4 radii")

    def test_zoom_pan_and_controls(self):
        self.show(self.cracked)
        b = self.browser
        b.ask("window.kerf.figures[1].root.scrollIntoView({ block: 'center' })")
        left, top, width, height = b.ask("const r = window.kerf.figures[1].front.getBoundingClientRect(); return [r.left, r.top, r.width, r.height]")
        x, y = round(left + width / 3), round(top + height / 3)
        zoom = lambda: b.ask("return window.kerf.figures[1].zoom")
        place = lambda: b.ask("return window.kerf.figures[1].toBody(arguments[0], arguments[1])", x - left, y - top)
        before, under = zoom(), place()
        b.mouse("mouseWheel", x, y, deltaX=0, deltaY=-240)
        b.settle()
        self.assertGreater(zoom(), 1.2 * before)
        for now, then in zip(place(), under):
            self.assertAlmostEqual(now, then, places=6)  # what is under the pointer stays there
        b.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
        b.mouse("mouseMoved", x + 40, y + 25, button="left", buttons=1)
        b.mouse("mouseReleased", x + 40, y + 25, button="left", clickCount=1)
        b.settle()
        self.assertNotAlmostEqual(place()[0], under[0])
        far = zoom()
        points = lambda d: [{"x": x - d, "y": y}, {"x": x + d, "y": y}]
        b.command("Input.dispatchTouchEvent", type="touchStart", touchPoints=points(30))
        b.command("Input.dispatchTouchEvent", type="touchMove", touchPoints=points(60))
        b.command("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        b.settle()
        self.assertGreater(zoom(), 1.5 * far)
        # Fields, scale, clipping, displacements.
        said = b.ask("""
            const f = window.kerf.figures[0], set = (e, v, kind = "change") => { e.value = v; e.dispatchEvent(new Event(kind)); };
            set(f.select, "von_mises");
            const linear = f.scale.kind;
            set(f.kind, "log");
            const log = f.scale.kind;
            set(f.clip, "0.05");
            const clipped = [f.scale.low, f.scale.high];
            f.drawNow();
            const words = f.beyondText.textContent;
            set(f.from, "0.5"); set(f.to, "2");
            const typed = [f.scale.low, f.scale.high];
            set(f.slider, "0", "input");
            const none = f.deform;
            set(f.slider, "100", "input");
            return { linear, log, clipped, words, typed, none, most: f.deform };""")
        self.assertEqual((said["linear"], said["log"]), ("linear", "log"))
        self.assertRegex(said["words"], r"(4\.\d|5) % of the area lies below .* (4\.\d|5) % of the area lies above")
        self.assertEqual(said["typed"], [0.5, 2])
        self.assertEqual(said["none"], 0)
        self.assertGreater(said["most"], 0)
        self.quiet()

    def test_tab_order_and_keys(self):
        self.show(self.cracked)
        b = self.browser
        b.ask("document.activeElement.blur(); window.scrollTo(0, 0)")
        order = []
        for _ in range(60):
            b.press("Tab")
            order.append(b.ask("""
                const all = [...document.querySelectorAll("*")], e = document.activeElement;
                return e === document.body ? null : [all.indexOf(e), e.tagName, e.getAttribute("aria-label") || e.labels?.[0]?.textContent || e.textContent.trim().slice(0, 20)];"""))
            if order[-1] is None:
                order.pop()
                break
        places = [o[0] for o in order]
        self.assertEqual(places, sorted(places), "the order of the page")
        self.assertEqual(len(places), len(set(places)), "no trap")
        for place, tag, name in order:
            self.assertTrue(name, f"{tag} has a name")
        tags = [o[1] for o in order]
        for tag in ("BUTTON", "SELECT", "INPUT", "CANVAS", "SUMMARY"):
            self.assertIn(tag, tags)
        self.assertEqual(tags.count("CANVAS"), 2)
        b.ask("const f = window.kerf.figures[0]; f.front.focus(); f.front.scrollIntoView()")
        b.press("ArrowRight")
        b.settle()
        self.assertRegex(b.ask("return window.kerf.figures[0].readout.value"), r"x .*, y .*: .* = ")
        zoom = b.ask("return window.kerf.figures[0].zoom")
        b.press("+", "Equal", text="+")
        self.assertGreater(b.ask("return window.kerf.figures[0].zoom"), zoom)
        b.press("0", "Digit0", text="0")
        self.assertAlmostEqual(b.ask("return window.kerf.figures[0].zoom"), zoom)

    def test_contrast(self):
        for folder in (self.cracked, self.beam):
            for scheme in ("light", "dark"):
                self.browser.scheme(scheme)
                self.show(folder)
                self.browser.ask("for (const d of document.querySelectorAll('details')) d.open = true")
                looked, low = self.browser.ask(low_contrast)
                self.assertGreater(looked, 60)
                self.assertEqual(low, [], scheme)

    def test_dark_mode_is_dark(self):
        self.browser.scheme("dark")
        self.show(self.cracked)
        paper = self.browser.ask("return getComputedStyle(document.body).backgroundColor")
        self.assertLess(max(map(int, re.findall(r"\d+", paper)[:3])), 60)
        self.browser.ask("document.getElementById('theme').click()")
        paper = self.browser.ask("return getComputedStyle(document.body).backgroundColor")
        self.assertGreater(min(map(int, re.findall(r"\d+", paper)[:3])), 240)

    def test_no_sideways_scroll(self):
        for width in (320, 1400):
            self.browser.size(width, 700)
            for name, folder in self.all_pages().items():
                with self.subTest(name=name, width=width):
                    self.show(folder)
                    self.browser.ask("for (const d of document.querySelectorAll('details')) d.open = true")
                    self.browser.settle()
                    wide, there = self.browser.ask("return [document.documentElement.scrollWidth, document.documentElement.clientWidth]")
                    beyond = self.browser.ask("""
                        return [...document.querySelectorAll("main *")].filter((e) => !e.closest(".scroll") && e.getBoundingClientRect().right > arguments[0])
                          .map((e) => `${e.tagName}.${e.className} ${e.getBoundingClientRect().right} ${e.textContent.slice(0, 30)}`)""", there)
                    self.assertLessEqual(wide, there, beyond)

    def test_alt_texts_state_the_finding(self):
        self.show(self.cracked)
        result = json.loads((self.cracked / "result.json").read_text())
        label = self.browser.ask("return document.querySelector('#map canvas.front').getAttribute('aria-label')")
        self.assertIn("least", label)
        shown = f"{result['map']['min']['value']:.5g}".lstrip("-").rstrip("0")
        self.assertIn(shown[:5], label)
        for text in self.browser.ask("return [...document.querySelectorAll('canvas[role=img], .u-wrap')].map((e) => e.getAttribute('aria-label'))"):
            self.assertRegex(text, r"\d")

    def test_tables_without_scripts(self):
        cells = Text((self.cracked / "report.html").read_text()).cells
        for wanted in ("largest opening", "estimated error", "holds", "min", "KKT residual"):
            self.assertIn(wanted, cells)
        self.browser.command("Emulation.setScriptExecutionDisabled", value=True)
        try:
            self.browser.driver.get((self.cracked / "report.html").as_uri())
            tree = self.browser.command("DOMSnapshot.captureSnapshot", computedStyles=[])
            self.assertIn("The figures are drawn by a script", " ".join(tree["strings"]))
        finally:
            self.browser.command("Emulation.setScriptExecutionDisabled", value=False)

    def test_what_is_no_number(self):
        said = {}
        for name, folder in self.strange.items():
            self.show(folder)
            said[name] = self.browser.ask("return window.kerf.figures.map((f) => f.beyondText.textContent)")
        self.assertEqual(said["not a number"], ["There are no values to draw."] * 2)
        self.assertIn("Values from 1 to 3.", said["one triangle"][0])
        self.assertIn("Values from 1 to 3.", said["partly not a number"][0])
        self.show(self.strange["partly not a number"])
        text = self.browser.ask("const f = window.kerf.figures[1]; f.show(f.valueAt(1.5, 0.25)); return f.readout.value")
        self.assertIn("no value", text)

    def test_the_design_has_a_slider(self):
        self.show(self.beam)
        first, last = self.browser.ask("""
            const s = document.getElementById("iteration"), said = () => document.querySelector("#design .readout").value;
            const last = said();
            s.value = "0"; s.dispatchEvent(new Event("input"));
            return [said(), last];""")
        self.assertTrue(first.startswith("iteration 0: objective"), first)
        with open(self.beam / "history.csv") as file:
            row = next(csv.DictReader(file))
        self.assertIn(f"{float(row['objective']):.4g}"[:4], first)
        self.assertNotEqual(first, last)

    def test_paper_is_light_and_open(self):
        self.browser.scheme("dark")
        self.show(self.cracked)
        pdf = self.browser.command("Page.printToPDF", printBackground=True)["data"]
        self.assertGreater(len(pdf), 30000)
        self.quiet()

    def test_report_makes_the_page_again(self):
        page = self.cracked / "report.html"
        before = page.read_text()
        page.unlink()
        pages.run(kerf, "report", self.cracked, "--quiet")
        again = page.read_text()
        times = lambda text: re.sub(r"<b>[^<]*</b><span>seconds</span>|<h2>Time</h2>.*?</details>", "", text, flags=re.S)
        self.assertEqual(times(again), times(before))
        pages.run(kerf, "report", self.cracked, "--quiet")
        self.assertEqual(page.read_text(), again)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=1)
