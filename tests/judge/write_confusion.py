"""Writes the confusion matrix of `osculate judge` into docs/judge.md: write_confusion.py PROGRAM PAGE"""
import pathlib
import re
import subprocess
import sys

program, page = sys.argv[1], pathlib.Path(sys.argv[2])
made = subprocess.run([program], stdout=subprocess.PIPE, text=True)
text = page.read_text()
page.write_text(re.sub(r"(?<=<!-- confusion -->\n).*(?=<!-- end -->)", lambda _: "\n" + made.stdout + "\n", text, flags=re.DOTALL))
sys.exit(made.returncode)
