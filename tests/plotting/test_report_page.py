"""What the page of a real, short run does in a browser: with WebGL in software, and without WebGL.

Environment: as support.py says.
"""
import re
import shutil
import tempfile
import time
import unittest
from pathlib import Path

from browser import NO_GL, SOFTWARE_GL, Browser
from support import ROOT, Files, report, run

import h5py
import numpy as np
from result import Result
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys


SIZE = (1010, 640)  # pixels; software draws small scenes faster


class Drawn(Files):
    """What needs the scene, with one renderer: `flags` of the browser, whether it is `webgl`. None: the base of the others."""

    wanted = {"puma560_touch": ("duration=1.2",)}
    flags, webgl = None, None

    @classmethod
    def setUpClass(cls):
        if cls.flags is None:
            raise unittest.SkipTest("the base of the others")
        super().setUpClass()
        cls.page = cls.directory / "touch.html"
        assert report(cls.files["puma560_touch"], "-o", cls.page).returncode == 0
        cls.browser = Browser(*cls.flags)
        cls.addClassCleanup(cls.browser.close)
        cls.result = Result(cls.files["puma560_touch"])
        cls.addClassCleanup(cls.result.close)
        cls.browser.size(*SIZE)
        cls.browser.open(cls.page)
        assert set(cls.browser.requests()) == {cls.page.as_uri()}
        assert cls.browser.run("return osculate.scene.webgl") is cls.webgl

    def setUp(self):
        """The page as it was when it was opened: loading it anew for each test would take most of the time."""
        self.browser.size(*SIZE)
        self.browser.run("osculate.player.play(false); osculate.player.setSpeed(1); osculate.player.go(0); osculate.zoom('all');"
                         "document.activeElement.blur(); scrollTo(0, 0);")

    def tearDown(self):
        self.browser.drawn()
        self.assertEqual(self.browser.complaints(), [])
        self.assertEqual(self.browser.requests(), [])

    def time(self):
        return self.browser.run("return osculate.player.time")

    def tip(self):
        """Where the scene has the tip: from the matrices with which it is drawn."""
        self.browser.drawn()
        return np.array(self.browser.run("return osculate.scene.drawnTip()"))

    def recorded(self, t):
        times, tip = self.result.read("time"), self.result.read("trajectory/tip_position")
        return np.array([np.interp(t, times, tip[:, i]) for i in range(3)])

    def slide(self, share):
        """Drags the slider's knob."""
        slider = self.browser.find("#slider")
        width = slider.size["width"] - 16  # the knob's centre stays inside
        ActionChains(self.browser.driver).move_to_element_with_offset(slider, round((share - 0.5) * width), 0).click().perform()

    def test_scrubbing_moves_the_arm(self):
        before = self.tip()
        np.testing.assert_allclose(before, self.recorded(0), atol=1e-6)
        image = self.browser.find("#canvas").screenshot_as_png
        self.slide(0.7)
        t = self.time()
        self.assertAlmostEqual(t, 0.7 * 1.2, delta=0.05)
        after = self.tip()
        # the page moves evenly between float32 instants 0.01 s apart: 1e-4 m at accelerations of a few m/s^2
        np.testing.assert_allclose(after, self.recorded(t), atol=1e-4)
        self.assertGreater(np.linalg.norm(after - before), 0.005)
        self.assertNotEqual(self.browser.find("#canvas").screenshot_as_png, image)
        at = int(np.searchsorted(self.result.read("time"), 0.9))
        self.browser.run("osculate.player.go(arguments[0])", float(self.result.read("time")[at]))
        np.testing.assert_allclose(self.tip(), self.result.read("trajectory/tip_position")[at], atol=1e-6)
        self.assertIn("force on the tip", self.browser.find("#readout").text)

    def test_play_and_pause(self):
        self.browser.run("osculate.player.setSpeed(0.05)")
        self.browser.find("#play").click()
        self.assertEqual(self.browser.find("#play").get_attribute("aria-label"), "pause")
        for _ in range(200):
            if self.time() > 0.005:
                break
            time.sleep(0.05)
        self.assertGreater(self.time(), 0.005)
        self.browser.find("#play").click()
        t = self.time()
        time.sleep(0.15)
        self.assertEqual(self.time(), t)
        np.testing.assert_allclose(self.tip(), self.recorded(t), atol=1e-4)
        self.browser.run("osculate.player.setSpeed(50); osculate.player.play(true)")
        for _ in range(200):
            if not self.browser.run("return osculate.player.playing"):
                break
            time.sleep(0.05)
        self.assertEqual(self.time(), 1.2)  # stops at the end

    def test_layers_can_be_switched_off(self):
        names = self.browser.run("return Object.keys(osculate.scene.layers)")
        self.assertLessEqual({"floor", "axes", "path", "reference", "surface", "force", "effective_mass", "effective_inertia"}, set(names))
        self.browser.drawn()
        image = self.browser.find("#canvas").screenshot_as_png
        box = self.browser.find("[data-layer=effective_mass]")
        self.browser.run("arguments[0].scrollIntoView({block: 'center'})", box)
        box.click()
        self.browser.drawn()
        self.assertFalse(self.browser.run("return osculate.scene.layers.effective_mass.group.visible"))
        self.assertNotEqual(self.browser.find("#canvas").screenshot_as_png, image)
        box.click()

def contrast(one, other):
    """Ratio of luminances of two CSS colours, WCAG 2."""
    def luminance(text):
        parts = np.array([float(word) for word in re.findall(r"[\d.]+", text)[:3]]) / 255
        linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
        return linear @ [0.2126, 0.7152, 0.0722]
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


class WithWebGL(Drawn):
    """In software, and all that does not depend on the renderer."""

    flags, webgl = SOFTWARE_GL, True

    def test_plots_follow_the_time(self):
        t = float(self.result.read("time")[60])
        self.browser.run("osculate.player.go(arguments[0])", t)
        self.browser.drawn()
        wanted = np.linalg.norm(self.result.read("trajectory/pose_error")[60, 3:])
        first = self.browser.find(".plot .legend b").text
        self.assertAlmostEqual(float(first) / wanted, 1, delta=2e-3)
        lefts = self.browser.run("return osculate.plots.map(p => [parseFloat(p.cursor.style.left), p.graph.toDomXCoord(arguments[0])])", t)
        self.assertGreater(len(lefts), 9)
        for left, right in lefts:
            self.assertAlmostEqual(left, right, delta=0.01)
        plot = self.browser.find(".plot .drawing")  # a click in a plot sets the time for all
        self.browser.run("arguments[0].scrollIntoView({block: 'center'})", plot)
        ActionChains(self.browser.driver).move_to_element_with_offset(plot, 40, 0).click().perform()
        self.assertNotEqual(self.time(), t)
        wanted = self.browser.run("const p = osculate.plots[0]; return p.graph.toDataXCoord(p.drawing.clientWidth / 2 + 40)")
        self.assertAlmostEqual(self.time(), wanted, delta=0.02)
        self.browser.find("[data-zoom=in]").click()
        windows = self.browser.run("return osculate.plots.map(p => p.graph.xAxisRange())")
        for low, high in windows:
            self.assertAlmostEqual(high - low, 0.6, delta=1e-6)
        self.browser.find("[data-zoom=all]").click()
        self.assertEqual(self.browser.run("return osculate.plots[2].graph.xAxisRange()"), [0, 1.2])

    def test_keys(self):
        times = self.result.read("time")
        self.browser.press(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
        self.assertEqual(self.time(), times[3])
        self.browser.press(Keys.ARROW_LEFT)
        self.assertEqual(self.time(), times[2])
        ActionChains(self.browser.driver).key_down(Keys.SHIFT).send_keys(Keys.ARROW_RIGHT).key_up(Keys.SHIFT).perform()
        self.assertAlmostEqual(self.time(), times[2] + 1.2 / 50, delta=1e-12)
        self.browser.press(Keys.END)
        self.assertEqual(self.time(), 1.2)
        self.browser.press(Keys.HOME)
        self.assertEqual(self.time(), 0)
        speed = self.browser.run("return osculate.player.speed")
        self.browser.press("-")
        self.assertLess(self.browser.run("return osculate.player.speed"), speed)
        self.browser.press(" ")
        self.assertTrue(self.browser.run("return osculate.player.playing"))
        self.browser.press(" ")
        self.assertFalse(self.browser.run("return osculate.player.playing"))
        reached = set()  # by Tab alone, from the top
        self.browser.run("document.querySelector('.skip').focus()")
        for _ in range(60):
            self.browser.press(Keys.TAB)
            reached.add(self.browser.run("const e = document.activeElement; return e.id || e.dataset.view || e.dataset.layer || e.className"))
        self.assertLessEqual({"when", "free", "force", "surface", "play", "slider", "speed"}, reached | self.reach_the_end())

    def reach_the_end(self):
        """What Tab reaches backwards from the page's end: the controls of the time."""
        reached = set()
        self.browser.run("document.getElementById('speed').focus()")
        for _ in range(3):
            reached.add(self.browser.run("return document.activeElement.id"))
            ActionChains(self.browser.driver).key_down(Keys.SHIFT).send_keys(Keys.TAB).key_up(Keys.SHIFT).perform()
        return reached

    def test_a_verdict_row_leads_to_its_worst_instant(self):
        button = self.browser.find("button.when[data-claim=kinematics]")
        button.click()
        row = self.result.verdicts()["kinematics"]
        self.assertEqual(self.time(), row.at_time)
        self.browser.drawn()
        shown = self.browser.run("const p = osculate.plots.find(p => p.choice); return [p.plot.title, p.values[0].textContent]")
        self.assertEqual(shown[0], "claim kinematics")
        self.assertAlmostEqual(float(shown[1]) / row.worst, 1, delta=0.01)

    def test_widths_and_themes(self):
        for width in (390, 820, 1280):
            self.browser.size(width, 844)
            for dark in (False, True):
                self.browser.dark(dark)
                self.browser.drawn()
                wide, body = self.browser.run("return [document.documentElement.scrollWidth, document.body.scrollWidth]")
                self.assertLessEqual(max(wide, body), width)
                cut = self.browser.run(  # parts that stick out of the page without scrolling it
                    "return [...document.querySelectorAll('body *')].filter(e => e.getClientRects().length && "
                    "e.getBoundingClientRect().right > innerWidth + 1 && !e.closest('svg, pre, .legend, .hidden, .keys')).map(e => e.className || e.tagName)")
                self.assertEqual(cut, [], width)
                colours = self.browser.run("const s = getComputedStyle(document.body); return [s.backgroundColor, s.color]")
                self.assertGreater(contrast(*colours), 7, (width, dark))
                small = self.browser.run("const s = getComputedStyle(document.querySelector('.facts')); return s.color")
                self.assertGreater(contrast(colours[0], small), 4.5)
        self.browser.dark(False)


class WithoutWebGL(Drawn):
    """The same page on a machine that cannot do WebGL: the scene is drawn as SVG."""

    flags, webgl = NO_GL, False

    def test_the_drawing_says_so(self):
        self.assertIn("without WebGL", self.browser.find("#view-caption").text)
        self.browser.drawn()
        self.assertGreater(self.browser.run("return document.querySelectorAll('#canvas svg path').length"), 20)


class Unfinished(unittest.TestCase):
    """Pages of runs that stopped, and of files without a verdict, still open."""

    def test_they_open(self):
        directory = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, directory)
        stopped, cut = directory / "stopped.h5", directory / "cut.h5"
        straight = ("initial.q=[0, 0, 0, 0, 0, 0]", "duration=0.05")
        self.assertEqual(run(ROOT / "experiments" / "puma560_circle.yaml", stopped, *straight), 3)
        self.assertEqual(run(ROOT / "experiments" / "arm7_posture.yaml", cut, "duration=0.1", "verify.shadow=false"), 0)
        with h5py.File(cut, "r+") as file:
            for name in ("verdict", "timing", "measured", "global_error"):
                file.pop(name, None)
            file.attrs["status"] = "recovered"
            del file.attrs["verdict"]
        with Browser(*NO_GL) as browser:
            for file, words in ((stopped, "run failed"), (cut, "run recovered, no verdict")):
                page = file.with_suffix(".html")
                done = report(file)
                self.assertEqual((done.returncode, done.stdout), (0, f"{page}\n"), done.stderr)
                browser.open(page)
                browser.drawn()
                self.assertIn(words, browser.find(".badge").text)
                self.assertEqual(browser.complaints(), [])
            self.assertIn("no verdict", browser.find("#verdict").text)


if __name__ == "__main__":
    unittest.main()
