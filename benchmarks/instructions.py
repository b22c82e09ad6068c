"""Instructions of one call, counted by callgrind: each batch of a program is counted alone, so start-up cancels."""

import pathlib
import platform
import re
import shutil
import subprocess
import tempfile

BATCH = "osculate_counted_batch"


def why_not():
    """The reason why nothing can be counted here, or None."""
    if not shutil.which("valgrind"):
        return "valgrind is not installed"
    if platform.machine() != "x86_64" or "avx2" not in pathlib.Path("/proc/cpuinfo").read_text().split():
        return "the counts are of an x86-64 processor with AVX2 (the mathematical library asks for it at run time)"
    return None


def build_of(program):
    """What the counts of bench_core depend on: compiler and flags."""
    return subprocess.run([program, "--build"], capture_output=True, text=True, check=True).stdout.strip()


def count(program, *arguments):
    """{(call, arm): instructions of one call} of a program that prints "CALL ARM COUNT" for each batch, in order."""
    with tempfile.TemporaryDirectory() as folder:
        command = ["valgrind", "--tool=callgrind", f"--toggle-collect={BATCH}", f"--dump-after={BATCH}",
                   f"--callgrind-out-file={folder}/out", str(program), *arguments]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(done.stderr)
        counts = {}
        for number, line in enumerate(done.stdout.splitlines(), 1):
            call, arm, times = line.split()
            text = pathlib.Path(f"{folder}/out.{number}").read_text()
            total = int(re.search(r"^(?:totals|summary): (\d+)", text, re.MULTILINE)[1])
            counts[call, arm] = round(total / int(times))
        return counts
