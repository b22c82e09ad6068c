"""No file may grow beyond a limit, or the file system is full: the writer stops with the reason, and what it wrote before
is recovered. The same for a target that cannot be written at all. Usage: test_full_disk.py WRITER"""
import os
import shutil
import subprocess
import sys
import tempfile

from known_rows import TIME_CHUNK, check_fixed, check_rows, open_file, recover


def run(writer, path, rows, limit):
    return subprocess.run([writer, "run", path, str(rows), "0", str(limit)], capture_output=True, text=True, timeout=60)


def refused_while_recording(writer, directory):
    for limit in (80_000, 200_000, 203_000, 777_777):
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


# $1: the writer, $2: where recovered files go. A file system of 600 kB that nobody else sees.
SMALL_FILE_SYSTEM = """
mkdir -p "$2/small" && mount -t tmpfs -o size=600k tmpfs "$2/small" || exit 77
"$1" run "$2/small/run.h5" 0 0 > "$2/told"; echo "$?" > "$2/code"
"$1" recover "$2/small/run.h5" "$2/recovered.h5" || exit 1
mount -o remount,ro "$2/small" && "$1" run "$2/small/other.h5" 10 0; echo "$?" >> "$2/code"
"""


def full_file_system(writer, directory):
    """Needs the right to mount. Returns whether that is there."""
    if os.geteuid() != 0:
        return False
    command = ["unshare", "--mount", "sh", "-c", SMALL_FILE_SYSTEM, "sh", os.path.abspath(writer), directory]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    if done.returncode == 77 or "unshare failed" in done.stderr:
        return False
    assert done.returncode == 0, done
    full, read_only = done.stderr.splitlines()
    assert full.startswith(f"{directory}/small/run.h5: cannot write '") and "No space left on device; " in full, full
    assert f"osculate recover {directory}/small/run.h5" in full, full
    assert read_only.startswith(f"{directory}/small/other.h5: cannot create") and "Read-only file system" in read_only, read_only
    with open(f"{directory}/code") as codes:
        assert codes.read().split() == ["4", "4"]
    with open(f"{directory}/told") as told, open_file(f"{directory}/recovered.h5") as file:
        assert file.attrs["status"] == "recovered"
        rows, _ = check_rows(file)
        assert rows >= int(told.read().split()[-1]) // TIME_CHUNK * TIME_CHUNK > 0
    return True


def directory_vanishes(writer, directory):
    """The rows go on into a file that no longer has a name; the end says so."""
    gone = f"{directory}/gone"
    os.mkdir(gone)
    process = subprocess.Popen([writer, "run", f"{gone}/run.h5", "2000", "20000"], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    process.stdout.readline()
    shutil.rmtree(gone)
    _, message = process.communicate(timeout=60)
    assert process.returncode == 4, message
    assert message.startswith(f"{gone}/run.h5: was replaced or removed"), message


def main(writer):
    with tempfile.TemporaryDirectory() as directory:
        refused_while_recording(writer, directory)
        refused_at_creation(writer, directory)
        refused_at_the_end(writer, directory)
        directory_vanishes(writer, directory)
        mounted = full_file_system(writer, directory)
    print("full disk: ok" + ("" if mounted else "; without a full file system of its own, which needs the right to mount"))


main(sys.argv[1])
