"""Write plugin/i18n/terrain_wavelets.ts, the template of translations, from the plugin's source.

What dialogs show of the tables of ``wavelet_core`` and ``wavelet_gis`` is in it too.
A translation is a file of the same form beside it, terrain_wavelets_de.ts for German, which this
script brings up to date too: what was translated stays, what is new is marked unfinished. To begin
another, make an empty one of that name, run this, and fill it with Qt Linguist. ``make plugin``
compiles them (to what ``lrelease`` would make), and the plugin loads that of the user's language.
(Qt's own tools would put each class into a context of its own; here there is one for all.)
"""

from __future__ import annotations

import ast
import struct
import sys
from pathlib import Path
from xml.etree import ElementTree
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

    names = ("PARTITIONS", "NORMS", "PREDICTIONS", "UPDATES", "SIGNALS", "QUADRICS", "COSTS")
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


def template(translations: dict[str, str] | None = None, language: str = "") -> str:
    """Return the template, or a translation with the texts that are known, as Qt's XML."""
    known = translations or {}
    attribute = f' language="{language}"' if language else ""
    lines = ['<?xml version="1.0" encoding="utf-8"?>', "<!DOCTYPE TS>"]
    lines += [f'<TS version="2.1"{attribute}>', "<context>", f"  <name>{CONTEXT}</name>"]
    for name, texts in all_strings().items():
        for text in texts:
            is_known = text in known
            kind = "" if is_known else ' type="unfinished"'
            lines += [
                "  <message>",
                f'    <location filename="../../{name}"/>',
                f"    <source>{escape(text)}</source>",
                f"    <translation{kind}>{escape(known.get(text, ''))}</translation>",
                "  </message>",
            ]
    return "\n".join([*lines, "</context>", "</TS>", ""])


def translated(source: str) -> dict[str, str]:
    """Return the finished messages of a translation: text to translation."""
    if not source.strip():
        return {}
    found = {}
    for message in ElementTree.fromstring(source).iter("message"):
        text, translation = message.findtext("source"), message.find("translation")
        if text and translation is not None and translation.get("type") != "unfinished":
            found[text] = translation.text or ""
    return found


def compiled(messages: dict[str, str]) -> bytes:
    """Return messages as Qt loads them: hashes in order, and where each message is."""
    places, content = [], b""
    for text, translation in messages.items():
        places.append((_hash(text.encode()), len(content)))
        for tag, value in (
            (3, translation.encode("utf-16-be")),
            (8, b""),
            (6, text.encode()),
            (7, CONTEXT.encode()),
        ):
            content += struct.pack(">BI", tag, len(value)) + value
        content += b"\x01"
    index = b"".join(struct.pack(">II", *place) for place in sorted(places))
    file = bytes.fromhex("3cb86418caef9c95cd211cbf60a1bddd")
    for tag, section in ((0x42, index), (0x69, content)):
        file += struct.pack(">BI", tag, len(section)) + section
    return file


def _hash(text: bytes) -> int:
    """Return the ELF hash of a text, by which Qt finds it."""
    h = 0
    for byte in text:
        h = ((h << 4) + byte) & 0xFFFFFFFF
        high = h & 0xF0000000
        h = (h ^ (high >> 24)) & ~high & 0xFFFFFFFF
    return h or 1


if __name__ == "__main__":
    TEMPLATE.write_text(template(), encoding="utf-8")
    for path in sorted(TEMPLATE.parent.glob("terrain_wavelets_*.ts")):
        language = path.stem.rpartition("_")[2]
        known = translated(path.read_text("utf-8"))
        path.write_text(template(known, language), encoding="utf-8")
        print(path.relative_to(ROOT))
    print(TEMPLATE.relative_to(ROOT))
