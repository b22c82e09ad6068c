"""The schema of experiment files agrees with the reader and with docs/experiment-file.md; --write writes the page's
tables. Values are read as YAML 1.2 reads them, like editors do: 1e-10 is a number, yes is a text."""
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys
import unittest

import jsonschema
import yaml

PROGRAM = os.environ["OSCULATE"]
ROOT = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"])
PAGE = ROOT / "docs" / "experiment-file.md"
BASE = ROOT / "experiments" / "puma560_circle.yaml"
BLOCK = re.compile(r"<!-- keys of (\w+): .*?<!-- end of keys -->\n", re.DOTALL)


class Loader(yaml.SafeLoader):
    """YAML 1.2, core schema."""
    yaml_implicit_resolvers = {}


Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile(r"^(true|false)$"), list("tf"))
Loader.add_implicit_resolver("tag:yaml.org,2002:null", re.compile(r"^(~|null|)$"), ["~", "n", ""])
Loader.add_implicit_resolver("tag:yaml.org,2002:int", re.compile(r"^[-+]?[0-9]+$"), list("-+0123456789"))
Loader.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(r"^[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?$"),
                             list("-+.0123456789"))
Loader.add_constructor("tag:yaml.org,2002:float", lambda loader, node: float(node.value))
Loader.add_constructor("tag:yaml.org,2002:int", lambda loader, node: int(node.value))


def read(text):
    return yaml.load(text, Loader)


def call(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=120)


def schema():
    return json.loads(call("schema").stdout)


def forms(node):
    """A schema and what stands in its anyOf."""
    yield node
    for branch in node.get("anyOf", []):
        yield from forms(branch)


def maps(node, path=""):
    """(path, type or None, keys) of every map whose keys are fixed."""
    for form in forms(node):
        if "properties" in form:
            kind = form["properties"].get("type", {}).get("const")
            yield path, kind, form["properties"]
            for key, below in form["properties"].items():
                yield from maps(below, f"{path}.{key}" if path else key)


def changed(path, value):
    """The base experiment with one setting changed as --set does, read as an editor reads it."""
    document = read(BASE.read_text())
    *around, last = path.split(".")
    here = document
    for key in around:
        if not isinstance(here.get(key), dict):
            here[key] = {}
        here = here[key]
    here[last] = read(value)
    return document


class Schema(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.schema = schema()
        jsonschema.Draft7Validator.check_schema(cls.schema)
        cls.validator = jsonschema.Draft7Validator(cls.schema)

    def test_every_experiment_is_valid(self):
        files = sorted((ROOT / "experiments").glob("*.yaml"))
        self.assertGreater(len(files), 40)
        for file in files:
            faults = [f"{file.name}: {list(e.path)}: {e.message}" for e in self.validator.iter_errors(read(file.read_text()))]
            self.assertEqual(faults, [])

    def test_an_experiment_without_its_required_sections_is_not(self):
        for missing in ("model", "initial", "controller"):
            document = read(BASE.read_text())
            del document[missing]
            self.assertFalse(self.validator.is_valid(document), missing)

    def test_every_map_has_the_keys_that_its_reader_names(self):
        """The reader's message about an unknown key lists the known ones."""
        seen = {}
        for path, kind, properties in maps(self.schema):
            seen.setdefault((path, kind), set()).update(properties)
        self.assertGreater(len(seen), 30)

        def named(place):
            path, kind = place
            sets = ["--set", f"{path}={{type: {kind}, zzqq: 1}}" if kind else f"{path}.zzqq=1" if path else "zzqq=1"]
            if not kind and ".friction" not in path and path:
                sets = ["--set", f"{path}={{zzqq: 1}}"]
            return place, call("check", BASE, *sets).stderr

        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for place, said in pool.map(named, [p for p in seen if "[" not in p[0]]):
                listed = re.search(r"unknown key '[\w.]*zzqq': the keys here are (.*)\.", said)
                self.assertIsNotNone(listed, f"{place}: {said}")
                self.assertEqual(set(re.split(", | or ", listed[1])), seen[place], place)

    def test_what_the_reader_refuses_by_type_the_schema_refuses(self):
        places = []
        for path, kind, properties in maps(self.schema):
            if kind is None:
                places += [f"{path}.{key}" if path else key for key in properties]
        trials = [(p, v) for p in dict.fromkeys(places) for v in ("zzqq", "[zzqq]", "{zzqq: 1}", "[[1]]", "true")]
        self.assertGreater(len(trials), 300)

        def trial(both):
            path, value = both
            done = call("check", BASE, "--set", f"{path}={value}")
            return path, value, done.returncode, done.stderr

        by_both = 0
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for path, value, code, said in pool.map(trial, trials):
                valid = self.validator.is_valid(changed(path, value))
                own = re.search(rf"--set \S+?=.*?: (unknown key '{re.escape(path)}\.|{re.escape(path)}(\[\d+\])* = )", said)
                if own:
                    self.assertFalse(valid, f"the schema accepts {path}={value}, the reader says {said}")
                    by_both += 1
                if not valid:
                    self.assertEqual(code, 2, f"the schema refuses {path}={value}, the reader does not")
        self.assertGreater(by_both, 200)

    def test_numbers_out_of_range(self):
        for path, value in (("integrator.rtol", "1e-15"), ("duration", "0"), ("output.interval", "-1"), ("verify.every", "0"),
                            ("verify.every", "1.5"), ("controller.singularity.threshold", "1"), ("initial.q", "[]")):
            done = call("check", BASE, "--set", f"{path}={value}")
            self.assertEqual(done.returncode, 2, path)
            if value != "[]":  # how many numbers a list has depends on the arm
                self.assertFalse(self.validator.is_valid(changed(path, value)), path)

    def test_numbers_in_range(self):
        for path, value in (("integrator.rtol", "1e-14"), ("verify.every", "step"), ("verify.every", "7"),
                            ("integrator.atol", "{position: 1e-9}"), ("integrator.atol", "1e-9"), ("plant", "~"),
                            ("controller.effort_limit", "none"), ("plant.mass_scale", "[1, 1, 1, 1, 1, 1]")):
            self.assertEqual(call("check", BASE, "--set", f"{path}={value}").returncode, 0, path)
            self.assertTrue(self.validator.is_valid(changed(path, value)), path)


class Page(unittest.TestCase):
    def test_the_page_has_the_tables(self):
        made = {m[1]: m[0] for m in BLOCK.finditer(call("schema", "--markdown").stdout)}
        there = {m[1]: m[0] for m in BLOCK.finditer(PAGE.read_text())}
        self.assertGreater(len(made), 8)
        self.assertEqual(there, made, "docs/experiment-file.md is out of date: ./dev schema")


def write():
    made = {m[1]: m[0] for m in BLOCK.finditer(call("schema", "--markdown").stdout)}
    PAGE.write_text(BLOCK.sub(lambda m: made[m[1]], PAGE.read_text()))


if __name__ == "__main__":
    write() if sys.argv[1:] == ["--write"] else unittest.main()
