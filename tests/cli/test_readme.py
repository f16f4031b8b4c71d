#!/usr/bin/env python3
"""Run the commands that README.md and docs/howto.md show: each line of a ```sh block that begins with `kjoint `.

usage: test_readme.py KJOINT

They run in order, in one folder that holds a copy of decks/; all must succeed, but for lines that
end with a comment `# exit N`. A ```text block right behind is what the last line must print; `...` stands for
anything. Lines that begin with tools/ are left to continuous integration.
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
    """Command lines of the sh blocks, the exit code each announces, and what the last one prints."""
    for block, told in re.findall(r"```(?:sh|bash|console)\n(.*?)```(?:\n+```text\n(.*?)```)?", text, re.S):
        found = []
        for line in block.replace("\\\n", " ").splitlines():
            line = line.strip().removeprefix("$ ").replace("build/release/kjoint", "kjoint")
            if line.startswith("kjoint "):
                code = re.search(r"# exit (\d+)", line)
                found.append([line.split(" #")[0].strip(), int(code.group(1)) if code else 0, ""])
        if found:
            found[-1][2] = told
        yield from found


def prints(told, shown):
    """The text is what is told, where `...` stands for anything."""
    pattern = ".*".join(re.escape(part) for part in told.strip().split("..."))
    return re.fullmatch(pattern, shown.strip(), re.S) is not None


def main(kjoint):
    status, n = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        (work / "bin").mkdir()
        (work / "bin" / "kjoint").symlink_to(pathlib.Path(kjoint).resolve())
        shutil.copytree(SOURCE / "decks", work / "decks")
        documents = [SOURCE / "README.md", SOURCE / "docs" / "howto.md"]
        path = f"{work / 'bin'}{os.pathsep}{os.environ['PATH']}"
        for line, code, told in [c for d in documents for c in commands(d.read_text())]:
            done = subprocess.run(line, shell=True, cwd=work, capture_output=True, text=True, check=False,
                                  env={**os.environ, "PATH": path, "KJOINT_PYTHON": sys.executable})
            n += 1
            if done.returncode != code:
                status = 1
                print(f"exit {done.returncode}, not {code}: {line}\n{done.stdout}{done.stderr}")
            elif told and not prints(told, done.stdout):
                status = 1
                print(f"{line} prints\n{done.stdout}\nnot\n{told}")
    print(f"{n} commands of README and howto run")
    return status or n == 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) == 2 else __doc__)
