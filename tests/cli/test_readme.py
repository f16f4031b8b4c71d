#!/usr/bin/env python3
"""Run the commands that README.md shows: each line of a ```sh block that begins with `kjoint `.

usage: test_readme.py KJOINT

They run in order, in one folder that holds a copy of decks/; all must succeed, but for lines that
end with a comment `# exit N`. Lines that begin with tools/ are left to continuous integration.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(os.environ.get("KJOINT_SOURCE_DIR", pathlib.Path(__file__).parents[2]))


def commands(text):
    """Command lines of the sh blocks, and the exit code each announces."""
    for block in re.findall(r"```(?:sh|bash|console)\n(.*?)```", text, re.S):
        for line in block.replace("\\\n", " ").splitlines():
            line = line.strip().removeprefix("$ ").replace("build/release/kjoint", "kjoint")
            if line.startswith("kjoint "):
                code = re.search(r"# exit (\d+)", line)
                yield line.split(" #")[0].strip(), int(code.group(1)) if code else 0


def main(kjoint):
    status, n = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        (work / "bin").mkdir()
        (work / "bin" / "kjoint").symlink_to(pathlib.Path(kjoint).resolve())
        shutil.copytree(SOURCE / "decks", work / "decks")
        path = f"{work / 'bin'}{os.pathsep}{os.environ['PATH']}"
        for line, code in commands((SOURCE / "README.md").read_text()):
            done = subprocess.run(line, shell=True, cwd=work, env={**os.environ, "PATH": path},
                                  capture_output=True, text=True, check=False)
            n += 1
            if done.returncode != code:
                status = 1
                print(f"exit {done.returncode}, not {code}: {line}\n{done.stdout}{done.stderr}")
    print(f"{n} commands of the README run")
    return status or n == 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) == 2 else __doc__)
