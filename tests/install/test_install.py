"""An installed copy, moved to another place, as a project outside the tree meets it.

Arguments: build directory, C++ compiler. Environment: OSCULATE_SOURCE_DIR."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

ROOT = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"])
BUILD, COMPILER = pathlib.Path(sys.argv.pop(1)), sys.argv.pop(1)
HERE = pathlib.Path(__file__).resolve().parent
EPS = 2.0**-52
JOINTS = 6  # of the PUMA 560
VERSION_PROGRAM = """#include <cstdio>
#include <string>
namespace osculate {
std::string version_text();
}
int main() { std::printf("%s\\n", osculate::version_text().c_str()); }
"""
VERSION_PROJECT = """cmake_minimum_required(VERSION 3.25)
project(version LANGUAGES CXX)
find_package(osculate REQUIRED)
add_executable(version main.cpp)
target_link_libraries(version PRIVATE osculate::osculate)
"""


def call(*command, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, **more)
    if done.returncode != 0:
        raise AssertionError(f"{command} ended with {done.returncode}:\n{done.stdout}\n{done.stderr}")
    return done.stdout


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.folder = pathlib.Path(holder.name)
        cls.first = cls.folder / "first place"
        cls.prefix = cls.folder / "second place"
        call("cmake", "--install", BUILD, "--prefix", cls.first)
        cls.first.rename(cls.prefix)
        cls.program = cls.prefix / "bin" / "osculate"
        cls.model = cls.prefix / "share" / "osculate" / "models" / "puma560.urdf"
        cls.controller = cls.built(HERE / "consumer", "controller")

    @classmethod
    def built(cls, source, name):
        to = cls.folder / name
        call("cmake", "-G", "Ninja", "-S", source, "-B", to, f"-DCMAKE_PREFIX_PATH={cls.prefix}",
             f"-DCMAKE_CXX_COMPILER={COMPILER}", "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror")
        call("cmake", "--build", to)
        return to / name

    def run_controller(self, samples):
        missed, torques = call(self.controller, self.model, "tool0", samples).splitlines()
        return float(missed.split()[-1]), [float(word) for word in torques.split()[1:]]

    def terms(self):
        q = ",".join(["0.5"] * JOINTS)
        return json.loads(call(self.program, "terms", self.model, "--tip", "tool0", "--q", q, "--u", "0,0,0,10,0,0", "--json"))

    def test_the_first_torque_is_the_programs(self):
        # The command of the first sample: 0.1 m along x at a stiffness of 100 / s^2.
        wanted = self.terms()
        torques = self.run_controller(1)[1]
        self.assertEqual(len(torques), JOINTS)
        allowed = 8 * EPS * wanted["cond_Omega"] * max(map(abs, wanted["recursive"]["T"]))
        for ours, theirs in zip(torques, wanted["recursive"]["T"]):
            self.assertLessEqual(abs(ours - theirs), allowed)

    def test_the_tip_accelerates_as_commanded(self):
        # What is added up is |Omega| |F|, in which gravity and the command are large; both are known to eps times
        # Omega's condition, which changes little over 0.1 m.
        missed = self.run_controller(1000)[0]
        terms = self.terms()
        forces = np.max(np.abs(terms["recursive"]["Omega"]) @ np.abs(terms["recursive"]["F"]))
        self.assertGreater(missed, 0)
        self.assertLessEqual(missed, 8 * EPS * terms["cond_Omega"] * forces)

    def test_the_loop_allocates_nothing(self):
        if not shutil.which("valgrind"):
            self.skipTest("valgrind is not installed")

        def allocations(samples):
            done = subprocess.run(["valgrind", self.controller, self.model, "tool0", str(samples)], capture_output=True,
                                  text=True, check=True)
            return int(re.search(r"total heap usage: ([\d,]+) allocs", done.stderr)[1].replace(",", ""))

        once = allocations(1)
        self.assertGreater(once, 100)  # the URDF file is read
        self.assertEqual(allocations(50), once)

    def test_the_whole_library_by_cmake_and_by_pkg_config(self):
        source = self.folder / "version_source"
        source.mkdir()
        (source / "main.cpp").write_text(VERSION_PROGRAM)
        (source / "CMakeLists.txt").write_text(VERSION_PROJECT)
        expected = call(self.program, "--version").strip()
        self.assertTrue(expected.startswith("osculate "))
        self.assertEqual(call(self.built(source, "version")).strip(), expected)

        third = self.folder / "third"  # without the blank, which many users of pkg-config do not quote
        shutil.copytree(self.prefix / "lib", third / "lib")
        environment = dict(os.environ, PKG_CONFIG_PATH=str(third / "lib" / "pkgconfig"))
        flags = call("pkg-config", "--cflags", "--libs", "--static", "osculate", env=environment).split()
        self.assertNotIn(str(self.prefix), " ".join(flags))
        by_hand = self.folder / "by_hand"
        call(COMPILER, source / "main.cpp", *flags, "-o", by_hand)
        self.assertEqual(call(by_hand).strip(), expected)

    def test_nothing_names_the_machine_it_was_built_on(self):
        places = [str(place).encode() for place in (ROOT, BUILD, self.first)]
        files = [path for path in self.prefix.rglob("*") if path.is_file()]
        self.assertGreater(len(files), 100)
        wrong = [str(path) for path in files for place in places if place in path.read_bytes()]
        self.assertEqual(wrong, [])
        for path in files:
            if path.read_bytes().startswith(b"\x7fELF"):
                self.assertNotRegex(call("readelf", "-d", path), r"\((RPATH|RUNPATH)\)")

    def test_experiments_find_their_models(self):
        experiment = self.prefix / "share" / "osculate" / "experiments" / "puma560_circle.yaml"
        self.assertIn("fine", call(self.program, "check", experiment))

    def test_the_python_module(self):
        places = list(self.prefix.glob("lib/python3*/dist-packages"))
        if not places:
            self.skipTest("the module is not built")
        self.assertTrue((places[0] / "osculate" / "py.typed").exists())
        code = "import osculate, sys; print(osculate.version()); print(osculate.__file__)"
        shown = call("/usr/bin/python3", "-c", code, env=dict(os.environ, PYTHONPATH=str(places[0])))
        self.assertTrue(shown.startswith(call(self.program, "--version").strip()))
        self.assertIn(str(places[0]), shown)


class Page(unittest.TestCase):
    def test_the_page_shows_the_files_of_this_test(self):
        page = (ROOT / "docs" / "in-your-controller.md").read_text()
        for language, name in (("cpp", "main.cpp"), ("cmake", "CMakeLists.txt")):
            shown = re.findall(rf"```{language}\n(.*?)```", page, re.DOTALL)
            self.assertEqual(shown, [(HERE / "consumer" / name).read_text()])

    def test_the_program_is_short(self):
        self.assertLessEqual(len((HERE / "consumer" / "main.cpp").read_text().splitlines()), 40)


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=1))
