"""For tools/site: examples in docstrings become blocks of code."""
import re

import griffe


class Examples(griffe.Extension):
    """Fences around paragraphs of >>> lines."""

    def on_instance(self, *, obj, **_):
        if obj.docstring:
            obj.docstring.value = re.sub(r"(?m)^>>> (?:.+\n?)+", lambda found: f"```pycon\n{found.group().rstrip()}\n```\n",
                                         obj.docstring.value)
