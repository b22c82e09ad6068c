"""The pictures of the experiments: the script's table, the files, the READMEs that show them, and one picture really made.

Environment: OSCULATE (the program), OSCULATE_SOURCE_DIR (the project's root).
"""
import contextlib
import io
import re
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from support import FIGURES, ROOT, SWEEP_FIGURES

import gallery
from PIL import Image
from result import open_result

EXPERIMENTS = {file.stem: file.read_text() for file in sorted((ROOT / "experiments").glob("*.yaml"))}
FOLDER = ROOT / "docs" / "pictures"
LARGEST, ALL_TOGETHER = 40_000, 1_600_000  # bytes


class Table(unittest.TestCase):
    def test_every_experiment_has_a_row_and_every_row_an_experiment(self):
        self.assertEqual(sorted(gallery.PICTURES), sorted(EXPERIMENTS))

    def test_every_figure_exists_and_is_one_of_a_sweep_where_the_experiment_is_one(self):
        for name, picture in gallery.PICTURES.items():
            swept = re.search(r"^sweep:", EXPERIMENTS[name], re.MULTILINE)
            self.assertIn(picture.figure, SWEEP_FIGURES if swept else FIGURES, name)


class Files(unittest.TestCase):
    def test_there_is_a_picture_of_each_experiment_and_no_other(self):
        self.assertEqual(sorted(file.name for file in FOLDER.iterdir()), [f"{name}.png" for name in EXPERIMENTS])

    def test_pictures_are_small_and_of_one_width(self):
        sizes = {file.name: file.stat().st_size for file in FOLDER.iterdir()}
        for name, size in sizes.items():
            with Image.open(FOLDER / name) as image:
                self.assertEqual((image.format, image.width), ("PNG", gallery.WIDTH), name)
            self.assertLess(size, LARGEST, name)
        self.assertLess(sum(sizes.values()), ALL_TOGETHER)

    def test_each_row_of_the_table_of_experiments_shows_its_own_picture(self):
        text = (ROOT / "experiments" / "README.md").read_text()
        rows = re.findall(r"^\| \[(\w+)\.yaml\].*\| (.*) \|$", text, re.MULTILINE)
        self.assertEqual(sorted(name for name, _ in rows), sorted(EXPERIMENTS))
        for name, cell in rows:
            self.assertEqual(re.findall(r'src="\.\./docs/pictures/(\w+)\.png"', cell), [name])

    def test_the_first_readme_shows_pictures_that_exist_and_links_to_their_experiments(self):
        text = (ROOT / "README.md").read_text()
        shown = re.findall(r'<a href="experiments/(\w+)\.yaml"><img src="docs/pictures/(\w+)\.png"', text)
        self.assertEqual(text.count("docs/pictures/"), len(shown))
        self.assertIn(len(shown), range(4, 7))
        for target, name in shown:
            self.assertEqual(target, name)
            self.assertIn(name, EXPERIMENTS)


class Made(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def short(self, name, **changes):
        return mock.patch.dict(gallery.PICTURES, {name: gallery.PICTURES[name]._replace(settings=("duration=0.3",), **changes)})

    def make(self, *names):
        said, complained = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(complained):
            code = gallery.main([*names, "-o", str(self.folder / "new")])
        return code, said.getvalue(), complained.getvalue()

    def test_a_picture_of_a_short_run(self):
        path = self.folder / "new" / "puma560_circle.png"
        with self.short("puma560_circle"):
            self.assertEqual(self.make("puma560_circle"), (0, f"{path}\n", ""))
        with Image.open(path) as image:
            planned = gallery.PICTURES["puma560_circle"].height
            self.assertEqual((image.format, image.width), ("PNG", gallery.WIDTH))
            self.assertLessEqual(abs(image.height - planned), 4)
            colours = image.convert("RGB").getcolors()
        self.assertGreater(len(colours), 8)
        self.assertIn((255, 255, 255), [colour for _, colour in colours])
        self.assertLess(path.stat().st_size, LARGEST)

    def test_nothing_but_the_panel_is_seen_and_it_has_its_labels(self):
        file = self.folder / "short.h5"
        picture = gallery.PICTURES["puma560_sampled"]._replace(settings=("duration=0.3",))
        self.assertEqual(gallery.run("puma560_sampled", picture, file)[0], 0)
        with open_result(file) as result:
            figure = FIGURES["departure"](result)
        kept = gallery.alone(figure, "missed linear")
        self.assertEqual([axes for axes in figure.axes if axes.get_visible()], kept)
        self.assertEqual(len(kept), 1)
        self.assertEqual(kept[0].get_xlabel(), "time [s]")
        self.assertEqual(" ".join(kept[0].get_ylabel().split()), "missed linear acceleration [m/s²]")

    def test_a_panel_that_is_not_there_is_named(self):
        with self.short("puma560_sampled", panel="no such"):
            code, said, complained = self.make("puma560_sampled")
        self.assertEqual((code, said), (2, ""))
        self.assertEqual(complained, "gallery.py: puma560_sampled: no picture: no panel begins with 'no such'\n")

    def test_an_experiment_that_does_not_come_out_as_expected_is_named(self):
        with self.short("puma560_singular"):  # too short to become singular, which it expects
            code, said, complained = self.make("puma560_singular")
        self.assertEqual(code, 1)
        self.assertIn("puma560_singular.png", said)
        self.assertIn("gallery.py: puma560_singular: exit code 1", complained)

    def test_unknown_names_are_refused(self):
        with self.assertRaises(SystemExit) as refused:
            self.make("puma560_circel")
        self.assertEqual(refused.exception.code, 2)


if __name__ == "__main__":
    unittest.main()
