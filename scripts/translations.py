"""Write plugin/i18n/terrain_wavelets.ts, the template of translations, from the plugin's source.

What dialogs show of the tables of ``wavelet_core`` and ``wavelet_gis`` is in it too.
To translate into German, say: copy the template to terrain_wavelets_de.ts, fill it with Qt Linguist
and compile it with ``lrelease`` to terrain_wavelets_de.qm beside it; the plugin loads it by itself.
(Qt's own tools would put each class into a context of its own; here there is one for all.)
"""

from __future__ import annotations

import ast
import sys
from pathlib import Path
from xml.sax.saxutils import escape

ROOT = Path(__file__).resolve().parent.parent
TEMPLATE = ROOT / "plugin" / "i18n" / "terrain_wavelets.ts"
CONTEXT = "TerrainWavelets"


def strings_of(source: str, name: str) -> list[str]:
    """Return the texts that a module hands to ``tr``, in order.

    Raises
    ------
    ValueError
        A text that is put together at run time, which no translation can match.
    """
    found = []
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.Call):
            continue
        function = node.func
        called = getattr(function, "attr", getattr(function, "id", None))
        if called != "tr" or not node.args:
            continue
        argument = node.args[0]
        if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
            found.append(argument.value)
        elif not isinstance(argument, ast.Attribute):  # of a row of a table, see table_strings
            raise ValueError(f"{name}:{node.lineno} hands tr() a text that is no literal")
    return found


def table_strings() -> dict[str, list[str]]:
    """Return the texts of the rows that dialogs show, by the table they are in."""
    sys.path.insert(0, str(ROOT))
    import wavelet_core
    from wavelet_gis.io.formats import MESH_FORMATS

    names = ("PARTITIONS", "NORMS", "PREDICTIONS", "UPDATES", "SIGNALS")
    found = {name: [row.help for row in getattr(wavelet_core, name).values()] for name in names}
    return {**found, "MESH_FORMATS": [row.used_by for row in MESH_FORMATS]}


def all_strings() -> dict[str, list[str]]:
    """Return the texts of every module of the plugin, each text in the first that has it."""
    seen: set[str] = set()
    by_module = {}
    for path in sorted((ROOT / "plugin").rglob("*.py")):
        name = str(path.relative_to(ROOT))
        texts = [
            t for t in dict.fromkeys(strings_of(path.read_text("utf-8"), name)) if t not in seen
        ]
        seen.update(texts)
        by_module[name] = sorted(texts)
    for name, texts in table_strings().items():
        by_module[name] = sorted({text for text in texts if text not in seen})
        seen.update(texts)
    return by_module


def template() -> str:
    """Return the template as Qt's translation XML."""
    lines = ['<?xml version="1.0" encoding="utf-8"?>', "<!DOCTYPE TS>", '<TS version="2.1">']
    lines += ["<context>", f"  <name>{CONTEXT}</name>"]
    for name, texts in all_strings().items():
        for text in texts:
            lines += [
                "  <message>",
                f'    <location filename="../../{name}"/>',
                f"    <source>{escape(text)}</source>",
                '    <translation type="unfinished"></translation>',
                "  </message>",
            ]
    return "\n".join([*lines, "</context>", "</TS>", ""])


if __name__ == "__main__":
    TEMPLATE.write_text(template(), encoding="utf-8")
    print(TEMPLATE.relative_to(ROOT))
