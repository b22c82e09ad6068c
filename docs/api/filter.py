"""Doxygen's input filter: the comment at the top of a header is about the file, one at the end of a line about what
stands before it. Writes the changed file to stdout, line by line."""
import re
import sys

TRAILING = re.compile(r"^(.*\S)(\s*)(?<![:/])//( [^/].*)$")
CONTINUED = re.compile(r"^(\s+)//( .*)$")


def lines(text):
    top, column = True, None
    for number, line in enumerate(text.splitlines()):
        if top and re.match(r"//( |$)", line):
            yield ("/// @file\n///" if number == 0 else "///") + line[2:]
            continue
        top = False
        trailing, continued = TRAILING.match(line), CONTINUED.match(line)
        if continued and column is not None and len(continued[1]) == column:
            yield f"{continued[1]}///<{continued[2]}"
        elif trailing and not trailing[1].lstrip().startswith("//"):
            column = len(trailing[1] + trailing[2])
            yield f"{trailing[1]}{trailing[2]}///<{trailing[3]}"
        else:
            column = None
            yield re.sub(r"/\* (.*?) \*/(?=[,}]| })", r"/**< \1 */", line)


if sys.argv[1].endswith(".md"):
    sys.stdout.write(open(sys.argv[1], encoding="utf-8").read())
else:
    sys.stdout.write("\n".join(lines(open(sys.argv[1], encoding="utf-8").read())) + "\n")
