#!/usr/bin/env python3
"""Check what README.md, CONTRIBUTING.md and docs/ show: snippets run, cards are those of a deck, links lead
somewhere, modules and sources in comments exist.

usage: test_documents.py KJOINT WORK_DIR [LIBRARY]     (needs all of tools/requirements.txt)

Without LIBRARY, the shared libkjoint_c, the snippets of the Python module are left out.
"""
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).parents[2]
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "tests" / "README.md",
             *sorted((ROOT / "docs").glob("**/*.md"))]


def run(words, work):
    return subprocess.run(words, cwd=work, capture_output=True, text=True, check=False)


def snippets(work):
    """Python blocks that fail, or neither say nor draw anything, in a folder with slider_crank.h5."""
    for document in DOCUMENTS:
        for code in re.findall(r"```python\n(.*?)```", document.read_text(), re.S):
            if re.search("^(from|import) kjoint", code, re.M) and "KJOINT_LIBRARY" not in os.environ:
                continue
            done = run([sys.executable, "-c", code], work)
            if done.returncode != 0 or not (done.stdout or ".plot(" in code):
                yield f"{document.name}: a snippet fails or says nothing\n{code}{done.stderr}"


def cards():
    """Cards in README.md that are not those of the slider-crank."""
    deck = (ROOT / "decks" / "slider_crank_0000.rad").read_text()
    for block in re.findall(r"```\n(/PROP.*?)```", (ROOT / "README.md").read_text(), re.S):
        if block not in deck:
            yield f"README.md: cards that no deck has\n{block}"


def anchors(document):
    """Names that the headings of a document give, as a forge makes them."""
    headings = re.findall(r"^#+ (.*)$", document.read_text(), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def links():
    """Links to files or headings that do not exist."""
    for document in DOCUMENTS:
        for target in re.findall(r"\]\(([^):]+)\)", document.read_text()):
            path, _, anchor = target.partition("#")
            other = document.parent / path if path else document
            if not other.exists():
                yield f"{document.name}: no file {target}"
            elif anchor and anchor not in anchors(other):
                yield f"{document.name}: no heading {target}"


def citations():
    """Sources in comments that name a section of docs/theory that does not exist."""
    for path in sorted((ROOT / "src").rglob("*.f90")):
        for name, numbers in re.findall(r"docs/theory/(\w+\.md) (\d[\d., to]*)", path.read_text()):
            page = ROOT / "docs" / "theory" / name
            sections = re.findall(r"^#+ (\d+(?:\.\d+)*)", page.read_text(), re.M) if page.exists() else []
            for number in re.findall(r"\d+(?:\.\d+)*", numbers):
                if number not in sections:
                    yield f"{path.name}: no section {number} in docs/theory/{name}"


def names():
    """Modules, names of the C interface and files in documents that the source does not have."""
    modules = {path.stem for path in (ROOT / "src").rglob("*.*")}
    header = (ROOT / "include" / "kjoint.h").read_text()
    for document in DOCUMENTS:
        quoted = sorted(set(re.findall(r"`([\w./]+)`", document.read_text())))
        for name in quoted:
            if name.startswith("kj_") and name.split(".")[0] not in modules and name not in header:
                yield f"{document.name}: no {name}"
            if re.match("(src|tests|tools|docs|python|include)/[a-z_0-9./]+$", name) and not (ROOT / name).exists():
                yield f"{document.name}: no file {name}"


def main(kjoint, folder, library=None):
    work = pathlib.Path(folder).resolve()
    work.mkdir(parents=True, exist_ok=True)
    os.environ.update(MPLCONFIGDIR=str(work), MPLBACKEND="Agg", PYTHONPATH=str(ROOT / "python"))
    if library:
        os.environ["KJOINT_LIBRARY"] = str(pathlib.Path(library).resolve())
    deck = ROOT / "decks" / "slider_crank_0000.rad"
    program = pathlib.Path(kjoint).resolve()
    subprocess.run([program, "run", "-q", deck], cwd=work, check=True)
    problems = [*snippets(work), *cards(), *links(), *citations(), *names()]
    print("\n".join(problems) or "all snippets, cards, links, sources and names are well")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) in (3, 4) else __doc__)
