"""Pages of real, short runs: where their links are, and their numbers against the file.

Environment: as support.py says.
"""
import base64
import json
import math
import re
import subprocess
import unittest

from support import PROGRAM, ROOT, Files, report, run

import h5py
import numpy as np
from experiment_text import base_moves, duration, experiment, model_link, obstacles, surface
from kinematics import COORDINATES, NoArm, placed, read_arm, to_quaternions
from report import verdict_table
from report_data import BINS, FRAMES, page_data, thinned
from result import Result

EXPERIMENTS = ROOT / "experiments"
LIMIT = 5e6  # bytes of a page of a run of 10 s


def arm_of(result):
    text = experiment(result)
    return read_arm(result.read("provenance/model"), model_link(text, "base"), model_link(text, "tip"))


def numbers(packed):
    return np.frombuffer(base64.b64decode(packed["data"]), dtype="<" + packed["type"])


def data_of(page):
    """What the page's program reads."""
    return json.loads(re.search(r"window\.osculate = \{data: (.*)\};</script>", page.read_text()).group(1))


class Frames(Files):
    short = ("duration=0.3", "verify.shadow=false", "verify.every=1000000")
    fixed = ("puma560_circle", "prismatic_arm_waypoints", "mobile_arm_lissajous", "satellite_arm_tumble", "chain60_reach", "ur5e_circle")
    wanted = dict.fromkeys((*fixed, "arm7_moving_base"), short)

    def test_the_computed_tip_is_the_recorded_one(self):
        """Revolute, prismatic, planar and floating joints, fixed ones between, and sixty joints in a row."""
        for name in self.fixed:
            with self.subTest(name):
                result = self.open(name)
                arm = arm_of(result)
                positions, rotations = arm.frames(result.read("trajectory/joint_position"))
                recorded = result.read("trajectory/tip_position")
                self.assertGreater(len(recorded), 5)
                # each joint adds a rounding of a length of a metre or two; 1e-12 is a thousand of them
                np.testing.assert_allclose(positions[:, -1], recorded, rtol=0, atol=1e-12)
                turned = to_quaternions(rotations[:, -1])
                along = np.abs(np.sum(turned * result.read("trajectory/tip_orientation"), axis=1))
                np.testing.assert_allclose(along, 1, rtol=0, atol=1e-12)

    def test_links_in_between_are_where_the_program_has_them(self):
        """Every link in turn as the tip of `osculate terms`: its position and rotation."""
        for name, model in (("prismatic_arm_waypoints", "prismatic_arm"), ("mobile_arm_lissajous", "mobile_arm"), ("ur5e_circle", "ur5e_like")):
            result = self.open(name)
            arm, q = arm_of(result), result.read("trajectory/joint_position")[-1:]
            positions, rotations = arm.frames(q)
            ends = np.cumsum([COORDINATES[link.type] for link in arm.links])
            for at, link in enumerate(arm.links):
                if ends[at] == 0 or link.type == "fixed":
                    continue
                words = ",".join(repr(float(value)) for value in q[0, : ends[at]])
                command = [PROGRAM, "terms", str(ROOT / "models" / f"{model}.urdf"), "--base", arm.links[0].name, "--tip", link.name, "--q", words, "--json"]
                tip = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)["tip"]
                np.testing.assert_allclose(positions[0, at], tip["position"], rtol=0, atol=1e-12, err_msg=link.name)
                np.testing.assert_allclose(rotations[0, at], tip["rotation"], rtol=0, atol=1e-12, err_msg=link.name)

    def test_a_moving_base_is_found_from_the_tip(self):
        result = self.open("arm7_moving_base")
        self.assertTrue(base_moves(experiment(result)))
        arm, q, tip = arm_of(result), result.read("trajectory/joint_position"), result.read("trajectory/tip_position")
        positions, rotations = placed(arm, q, tip, result.read("trajectory/tip_orientation"))
        np.testing.assert_allclose(positions[:, -1], tip, rtol=0, atol=1e-12)
        np.testing.assert_allclose(positions[0, 0], 0, atol=1e-12)  # base frame at t = 0
        np.testing.assert_allclose(rotations[0, 0], np.eye(3), atol=1e-12)
        # vx of the base follows amplitude sin(2 pi t / period), as the experiment says
        t = result.read("time")
        np.testing.assert_allclose(positions[:, 0, 0], 0.05 * np.sin(2 * np.pi * t / 5), rtol=0, atol=1e-9)
        fixed, _ = arm.frames(q)
        for i in range(1, len(arm.links)):  # a rigid motion of the whole arm
            np.testing.assert_allclose(np.linalg.norm(positions[:, i] - positions[:, 0], axis=1), np.linalg.norm(fixed[:, i], axis=1), atol=1e-12)

    def test_texts_without_an_arm(self):
        urdf = (ROOT / "models" / "puma560.urdf").read_text()
        for text, base, tip, words in ((urdf[:500], None, None, "not XML"), (urdf, "base_link", "link99", "no link 'link99'"),
                                       (urdf, "link3", "link1", "does not hang on"),
                                       (urdf.replace('type="revolute"', 'type="screw"'), None, None, "unknown type 'screw'")):
            with self.assertRaisesRegex(NoArm, words):
                read_arm(text, base, tip)


class Contents(Files):
    wanted = {"puma560_circle": ("duration=10",), "puma560_touch": ("duration=1.2",), "puma560_obstacle": ("duration=0.1",)}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.page = cls.directory / "circle.html"
        done = report(cls.files["puma560_circle"], "-o", cls.page)
        assert (done.returncode, done.stdout, done.stderr) == (0, f"{cls.page}\n", ""), done
        cls.text = cls.page.read_text()

    def test_one_small_page_that_asks_for_nothing(self):
        self.assertLess(len(self.text.encode()), LIMIT)
        own = re.sub(r"<script>.*?</script>", "", self.text, flags=re.S)
        self.assertEqual(re.findall(r'(?:src|href|action)="(?!#|data:,)[^"]*"', own), [])
        self.assertIn("default-src 'none'", own)
        self.assertNotIn("@import", own)

    def test_the_verdict_comes_first_and_holds_the_file_s_rows(self):
        self.assertLess(self.text.index('class="verdict"'), self.text.index('id="canvas"'))
        rows = re.findall(r'<tr class="(\w+)"><th scope="row">(.*?)</th>(.*?)</tr>', self.text)
        verdicts = self.open("puma560_circle").verdicts()
        self.assertEqual([name for _, name, _ in rows], list(verdicts))
        for kind, name, cells in rows:
            row = verdicts[name]
            self.assertEqual(kind, {1: "pass", 0: "fail", -1: "none"}[row.result])
            self.assertIn(row.equation, cells)
            if row.result == -1:
                self.assertIn(row.reason, cells)
                continue
            for key, value in (("worst", row.worst), ("bound", row.bound)):
                self.assertEqual(float(re.search(rf'data-label="{key}">(.*?)<', cells).group(1)), float(f"{value:.2e}"))
            self.assertEqual(float(re.search(r'data-time="(.*?)"', cells).group(1)), row.at_time)
            self.assertEqual(int(re.search(r'data-label="undecided">(\d+)', cells).group(1)), row.undecided_steps)

    def test_expectations_are_named(self):
        file = self.directory / "expected.h5"
        self.assertNotIn("see expect", self.text)
        for settings, code, words in ((("expect.fails=[omega]",), 1, "what the experiment expects did not come"),
                                      (("initial.q=[0, 0, 0, 0, 0, 0]", "expect.stop=singular"), 0, "The experiment expects this outcome")):
            self.assertEqual(run(EXPERIMENTS / "puma560_circle.yaml", file, "duration=0.05", *settings), code)
            with Result(file) as result:
                self.assertIn(words, verdict_table(result))

    def test_configuration_and_provenance_are_complete(self):
        unescaped = self.text.replace("&quot;", '"').replace("&#x27;", "'").replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
        with h5py.File(self.files["puma560_circle"]) as file:
            for name, data in file["provenance"].items():
                self.assertIn(data.asstr()[()].strip(), unescaped, name)

    def test_numbers_of_the_page_are_those_of_the_file(self):
        data, result = data_of(self.page), self.open("puma560_circle")
        time, tip = result.read("time"), result.read("trajectory/tip_position")
        np.testing.assert_array_equal(numbers(data["motion"]["time"]), time)
        links = len(data["motion"]["links"])
        drawn = numbers(data["motion"]["positions"]).reshape(len(time), links, 3)[:, -1]
        np.testing.assert_allclose(drawn, tip, rtol=0, atol=1e-7)  # float32 of lengths below 2 m
        titles = {plot["title"]: plot for plot in data["plots"]}
        torque = titles["joint torque"]
        self.assertEqual((torque["unit"], torque["names"]), ("N m", result.read("joint")))
        np.testing.assert_allclose(numbers(torque["y"]).reshape(6, -1), result.read("trajectory/joint_torque").T, rtol=1e-6)
        np.testing.assert_array_equal(numbers(torque["x"]), time)
        claims = [plot["title"].split()[1] for plot in data["plots"] if plot["group"] == "claim"]
        self.assertEqual(claims, [name for name, row in result.verdicts().items() if row.result != -1])
        self.assertTrue(all(plot["unit"] for plot in data["plots"]))

    def test_surroundings_and_force(self):
        data, _, distance = page_data(self.open("puma560_touch"))
        self.assertLess(distance, 1e-12)
        self.assertEqual(data["motion"]["surface"], {"type": "plane", "point": [0, 0, 0.7], "normal": [0, 0, 1]})
        touching = self.open("puma560_touch").read("contact/pressure").max()
        self.assertGreater(touching, 1)  # N: the run does touch
        force = numbers(data["motion"]["force"]).reshape(-1, 3)
        np.testing.assert_allclose(force, self.open("puma560_touch").read("trajectory/tip_force")[:, 3:], rtol=1e-6)
        self.assertEqual(len(data["touching"]), 1)
        text = experiment(self.open("puma560_obstacle"))
        self.assertEqual(obstacles(text), [{"centre": [0.5, 0.02, 0.74], "radius": 0.04}])
        self.assertIsNone(surface(text))
        self.assertEqual(duration(text), 0.1)

    def test_thinning_keeps_every_extreme(self):
        time = np.linspace(0, 1, 50021)
        values = np.stack([np.sin(900 * time), np.where(time > 0.5, np.nan, time)], axis=1)
        values[31234, 0] = 7  # a single peak
        short_time, short = thinned(time, values)
        self.assertEqual(len(short_time), 2 * BINS)
        self.assertTrue((np.diff(short_time) >= 0).all())
        self.assertEqual((short_time[0], short_time[-1]), (0, 1))
        self.assertEqual(np.max(short[:, 0]), 7)
        peak = int(np.argmax(short[:, 0]))
        self.assertLess(abs(short_time[peak] - time[31234]), 2 / BINS)
        self.assertTrue(np.isin(short[np.isfinite(short)], values[np.isfinite(values)]).all())
        self.assertTrue(np.isnan(short[short_time > 0.51, 1]).all())
        same_time, same = thinned(time[:100], values[:100])
        np.testing.assert_array_equal(same, values[:100])
        np.testing.assert_array_equal(same_time, time[:100])

    def test_a_long_run_is_thinned_and_the_page_says_so(self):
        file = self.directory / "long.h5"
        self.assertEqual(run(EXPERIMENTS / "puma560_circle.yaml", file, "duration=25", "verify.shadow=false"), 0)
        with Result(file) as result:
            data, remarks, _ = page_data(result)
            self.assertEqual(len(numbers(data["motion"]["time"])), FRAMES)
            self.assertIn(f"drawn at {FRAMES} of {len(result.read('time'))} recorded instants", remarks[0])
            self.assertIn(f"of each of {BINS} stretches", remarks[1])

    def test_shapes_of_the_model_are_drawn_and_meshes_named(self):
        shapes = ('<visual><origin xyz="0.1 0 0" rpy="0 0 1.5"/><geometry><box size="0.2 0.1 0.3"/></geometry></visual>'
                  '<visual><geometry><cylinder radius="0.05" length="0.4"/></geometry></visual>'
                  '<visual><geometry><sphere radius="0.06"/></geometry></visual><visual><geometry><mesh filename="a.stl"/></geometry></visual>')
        urdf = (ROOT / "models" / "puma560.urdf").read_text().replace('<link name="link2">', f'<link name="link2">{shapes}')
        (self.directory / "drawn.urdf").write_text(urdf)
        file = self.directory / "drawn.h5"
        self.assertEqual(run(EXPERIMENTS / "puma560_circle.yaml", file, f"model.urdf={self.directory}/drawn.urdf", "duration=0.05"), 0)
        with Result(file) as result:
            data, remarks, _ = page_data(result)
        link = next(link for link in data["motion"]["links"] if link["name"] == "link2")
        self.assertEqual([(visual["shape"], visual["size"]) for visual in link["visuals"]],
                         [("box", (0.2, 0.1, 0.3)), ("cylinder", (0.05, 0.4)), ("sphere", (0.06,))])
        np.testing.assert_allclose(link["visuals"][0]["rotation"], [math.cos(0.75), 0, 0, math.sin(0.75)], atol=1e-15)
        self.assertTrue(any("1 visuals of the model are meshes" in remark for remark in remarks))

    def test_what_is_refused(self):
        file = self.files["puma560_circle"]
        empty = self.directory / "empty"
        empty.mkdir(exist_ok=True)
        done = report(file, "-o", self.directory / "none.html", OSCULATE_JAVASCRIPT=str(empty))
        self.assertEqual((done.returncode, done.stdout), (4, ""))
        self.assertIn("Install the Debian package libjs-three", done.stderr)
        self.assertFalse((self.directory / "none.html").exists())
        done = report(file, "-o", self.directory / "absent" / "page.html")
        self.assertEqual(done.returncode, 4)
        self.assertIn("cannot write the page", done.stderr)
        done = report(self.directory / "absent.h5")
        self.assertEqual(done.returncode, 2)
        self.assertIn("no such file", done.stderr)
        done = report(file, "-o", file)
        self.assertEqual(done.returncode, 2)
        sweep = self.directory / "sweep.h5"
        (self.directory / "sweep.yaml").write_text(
            f"model: {{urdf: {ROOT}/models/puma560.urdf, base: base_link, tip: tool0}}\ninitial: {{q: [0, -0.8, 0.4, 0, 0.9, 0]}}\n"
            "reference: {type: hold}\ncontroller: {law: operational_space, gains: {stiffness: 100, damping: 20}}\nduration: 0.02\n"
            "sweep: {key: plant.payload.mass, values: [0, 1]}\n")
        run(self.directory / "sweep.yaml", sweep, verb="sweep")
        done = report(sweep)
        self.assertEqual(done.returncode, 2)
        self.assertIn("the file of a sweep", done.stderr)


if __name__ == "__main__":
    unittest.main()
