"""GNU Octave loads the groups of a result file with its own `load`, and finds the numbers that h5py finds.
Usage: test_octave.py, with OSCULATE and OSCULATE_SOURCE_DIR set. Skipped where octave-cli is not installed."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy as np

GROUPS = ("time", "step_time", "trajectory", "operational_space", "energy", "verification", "solver")
SCRIPT = """
result = load('-hdf5', '{file}', {groups});
function show(name, value)
  if isstruct(value)
    names = fieldnames(value);
    for i = 1:numel(names) show([name '/' names{{i}}], value.(names{{i}})); end
  else
    printf('%s %d', name, ndims(value)); printf(' %d', size(value)); printf(' %.17g', value(:)); printf('\\n');
  end
end
names = fieldnames(result);
for i = 1:numel(names) show(names{{i}}, result.(names{{i}})); end
"""


def main():
    octave = shutil.which("octave-cli")
    if not octave:
        print("skipped: octave-cli is not installed")
        sys.exit(77)
    experiment = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"]) / "experiments/puma560_circle.yaml"
    with tempfile.TemporaryDirectory() as folder:
        file = f"{folder}/run.h5"
        subprocess.run([os.environ["OSCULATE"], "run", experiment, "-o", file, "--quiet", "--set", "duration=0.3"],
                       check=True, stdout=subprocess.DEVNULL)
        script = pathlib.Path(folder) / "show.m"
        script.write_text(SCRIPT.format(file=file, groups=", ".join(f"'{group}'" for group in GROUPS)))
        shown = subprocess.run([octave, script], capture_output=True, text=True, timeout=120)
        assert shown.returncode == 0, shown.stderr
        compared = 0
        with h5py.File(file) as result:
            for line in shown.stdout.splitlines():
                name, rank, *numbers = line.split()
                sizes = tuple(int(n) for n in numbers[:int(rank)])
                values = np.array([float(x) for x in numbers[int(rank):]])
                expected = result[name][:]
                # Octave's first index runs fastest, and a vector is a matrix of one column or row.
                assert sizes == expected.shape[::-1] or sorted(sizes) == sorted((1, *expected.shape)), (name, sizes)
                np.testing.assert_array_equal(values, expected.ravel().astype(float), err_msg=name)
                compared += 1
            expected_names = [f"{g}/{v}" for g in GROUPS[2:] for v in result[g]]
        assert compared == len(expected_names) + 2, (compared, len(expected_names))
    print(f"octave: {compared} variables")


main()
