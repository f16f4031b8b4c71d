#!/usr/bin/env python3
"""The notebooks of examples/notebooks run from top to bottom. usage: test_notebooks.py FOLDER

Exit code 77: nbclient or ipykernel is not installed."""
import importlib.util
import pathlib
import sys
import tempfile


def main(folder):
    if not all(importlib.util.find_spec(name) for name in ("nbclient", "ipykernel")):
        print("nbclient or ipykernel is not installed")
        return 77
    import nbclient
    import nbformat
    books = sorted(pathlib.Path(folder).glob("*.ipynb"))
    for path in books:
        book = nbformat.read(path, 4)
        with tempfile.TemporaryDirectory() as work:
            nbclient.NotebookClient(book, timeout=600, resources={"metadata": {"path": work}}).execute()
        shown = sum(bool(cell.outputs) for cell in book.cells if cell.cell_type == "code")
        print(f"{path.name}: {len(book.cells)} cells, {shown} show something")
    return 0 if books else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
