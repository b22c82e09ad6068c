"""Arrows point one way: no file includes a header of a layer that its own layer must not see, and third parties stay
behind their fences."""
import pathlib
import re
import sys
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2] / "src"

# What each layer may include, besides itself.
SEES = {
    "scalar": set(),
    "input": set(),
    "plugin": {"input"},
    "spatial": {"scalar"},
    "model": {"scalar", "input"},
    "recursion": {"scalar", "spatial", "model"},
    "reference": {"scalar", "model"},
    "control": {"input", "plugin", "scalar", "spatial", "model", "recursion", "reference"},
    "simulation": {"scalar", "spatial", "model", "recursion", "control", "reference"},
    "verification": {"scalar", "spatial", "model", "recursion", "reference", "control", "simulation"},
    "paper": {"scalar", "spatial", "model", "recursion", "reference"},
    "record": {"input"},
    "judge": {"input", "model", "reference", "control", "record"},
    "jury": {"scalar", "model", "recursion", "reference", "control", "simulation", "verification"},
    "experiment": {"input", "plugin", "scalar", "model", "reference", "recursion", "control", "simulation", "verification", "record", "spatial"},
    "cli": {"input", "scalar", "model", "reference", "control", "simulation", "verification", "record", "experiment", "paper", "judge", "jury"},
    "python": {"input", "scalar", "spatial", "model", "recursion", "reference", "control", "simulation", "verification",
               "record", "experiment", "judge"},
}
# Sight that a layer has for these files alone: a law must not lean on the oracle that checks it.
ONLY_FOR = {
    ("control", "reference"): {"control/textbook_laws.cpp", "control/null_space.cpp", "control/user_law.cpp"},
    ("simulation", "reference"): {"simulation/dense_plant.hpp"},
}
# The dense side must not see fault.hpp either: a seeded fault may change no bit of it.
FORBIDDEN_FILES = {"reference": {"scalar/fault.hpp"}, "model": {"scalar/fault.hpp"}}
FENCES = {
    r"(cvode|arkode|sundials|nvector|sunlinsol|sunmatrix|sunnonlinsol)[/_]": {
        "simulation/integrator.cpp", "simulation/small_vector.hpp"},
    r"(hdf5|H5)": {"record"},
    r"(urdf_|urdf/|console_bridge)": {"model/urdf.cpp"},
    r"yaml-cpp": {"experiment/yaml_parse.cpp"},
    r"CLI/": {"cli/program.cpp"},
    r"(pybind11|Python)": {"python"},
    r"osculate/controller": {"plugin", "control/user_law.cpp"},
    r"dlfcn": {"plugin/shared_library.cpp", "jury/engines.cpp"},
    r"boost/": {"scalar/rational.cpp", "scalar/quad.hpp"},
    r"quadmath": {"scalar/quad.hpp"},
}


def includes(text):
    return re.findall(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', text, re.MULTILINE)


def faults_of(layer, name, text):
    """Each include of `text`, a file of `layer` called `name`, that breaks a rule."""
    out = []
    for bracket, target in includes(text):
        if bracket == '"':
            other = target.split("/")[0]
            if other not in SEES:
                out.append(f"{name}: {target} belongs to no layer")
            elif other != layer and other not in SEES[layer]:
                out.append(f"{name}: {layer} must not see {target}")
            elif name not in ONLY_FOR.get((layer, other), {name}):
                out.append(f"{name}: only {sorted(ONLY_FOR[layer, other])} may see {target}")
            elif target in FORBIDDEN_FILES.get(layer, ()):
                out.append(f"{name}: {layer} must not see {target}")
        for pattern, allowed in FENCES.items():
            if bracket == "<" and re.match(pattern, target) and not ({name, layer} & allowed):
                out.append(f"{name}: {target} is fenced in {sorted(allowed)}")
    return out


class Layers(unittest.TestCase):
    def test_every_include_points_down(self):
        files = [p for p in SOURCE.glob("*/*") if p.suffix in (".hpp", ".cpp")]
        self.assertGreater(len(files), 40)
        wrong = []
        for path in files:
            name = f"{path.parent.name}/{path.name}"
            wrong += faults_of(path.parent.name, name, path.read_text())
        self.assertEqual(wrong, [])

    def test_the_check_can_fail(self):
        self.assertTrue(faults_of("spatial", "spatial/map.hpp", '#include "recursion/sweeps.hpp"\n'))
        self.assertTrue(faults_of("reference", "reference/dense.hpp", '#include "spatial/map.hpp"\n'))
        self.assertTrue(faults_of("reference", "reference/dense.hpp", '#include "scalar/fault.hpp"\n'))
        self.assertTrue(faults_of("control", "control/law.cpp", "#include <cvode/cvode.h>\n"))
        self.assertTrue(faults_of("control", "control/law.cpp", '#include "reference/dense.hpp"\n'))
        self.assertEqual(faults_of("control", "control/null_space.cpp", '#include "reference/dense.hpp"\n'), [])
        self.assertEqual(faults_of("control", "control/law.cpp", '#include "control/reference.hpp"\n'), [])
        self.assertTrue(faults_of("cli", "cli/main.cpp", "#include <hdf5.h>\n"))
        self.assertEqual(faults_of("simulation", "simulation/integrator.cpp", "#include <arkode/arkode_erkstep.h>\n"), [])


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=1))
