"""No file may grow beyond a limit (the system then refuses writes, as on a full disk): the writer stops with the reason,
and what it wrote before is recovered. Usage: test_full_disk.py WRITER"""
import os
import subprocess
import sys
import tempfile

from known_rows import TIME_CHUNK, check_fixed, check_rows, open_file, recover


def run(writer, path, rows, limit):
    return subprocess.run([writer, "run", path, str(rows), "0", str(limit)], capture_output=True, text=True, timeout=60)


def refused_while_recording(writer, directory):
    for limit in (60_000, 200_000, 203_000, 777_777):
        path = f"{directory}/limited{limit}.h5"
        failed = run(writer, path, 0, limit)
        assert failed.returncode == 4, failed
        assert failed.stderr.startswith(path + ": cannot write '") and ": File too large; " in failed.stderr, failed.stderr
        assert "osculate recover" in failed.stderr
        told = int(failed.stdout.split()[-1])
        recovered = recover(writer, path, path + ".recovered")
        assert recovered.returncode == 0, recovered.stderr
        with open_file(path + ".recovered") as file:
            check_fixed(file)
            rows, steps = check_rows(file)
            assert rows >= told // TIME_CHUNK * TIME_CHUNK > 0, (rows, told)
            assert steps >= 0


def refused_at_creation(writer, directory):
    path = f"{directory}/tiny.h5"
    failed = run(writer, path, 0, 5_000)
    assert failed.returncode == 4 and path in failed.stderr and "File too large" in failed.stderr, failed
    assert not os.path.exists(path) and not os.path.exists(path + ".tmp")


def refused_at_the_end(writer, directory):
    """The rows fit, the verdict does not: the unfinished file keeps the name."""
    path = f"{directory}/end.h5"
    assert run(writer, path, 1280, 10**9).returncode == 0
    size = os.path.getsize(path)
    os.remove(path)
    failed = run(writer, path, 1280, size - 200)
    assert failed.returncode == 4 and "File too large; " in failed.stderr, failed
    assert not os.path.exists(path + ".tmp")
    with open_file(path) as file:
        assert file.attrs["status"] == "running"
        assert check_rows(file) == (1280, 427)
    assert recover(writer, path, path + ".recovered").returncode == 0
    with open_file(path + ".recovered") as file:
        assert file.attrs["status"] == "recovered"
        assert check_rows(file) == (1280, 427)


def main(writer):
    with tempfile.TemporaryDirectory() as directory:
        refused_while_recording(writer, directory)
        refused_at_creation(writer, directory)
        refused_at_the_end(writer, directory)
    print("full disk: ok")


main(sys.argv[1])
