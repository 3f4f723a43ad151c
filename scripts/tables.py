"""Write the tables of docs/ that list filters, partitions and formats, from the tables in the code.

Between ``<!-- table: NAME -->`` and ``<!-- end -->`` a page holds what this script puts there; the
tests hold the pages against it.

    python3 scripts/tables.py
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MARKED = re.compile(r"(<!-- table: ([\w-]+) -->\n).*?(<!-- end -->)", re.DOTALL)


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [header, ["---"] * len(header), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def filters(name: str) -> str:
    """Return the table of the predictions or of the updates."""
    import wavelet_core

    rows = {"predictions": wavelet_core.PREDICTIONS, "updates": wavelet_core.UPDATES}[name]
    return table(
        ("name", "short", "what it is", "source"),
        (
            (f"`{row.name}`", f"`{row.short}`", row.help, row.equation or "beyond the paper")
            for row in rows.values()
        ),
    )


def partitions(name: str) -> str:
    """Return the table of the partitions."""
    import wavelet_core

    return table(
        ("name", "which vertices go", "options of its own", "source"),
        (
            (
                f"`{row.name}`",
                row.help,
                ", ".join(f"`{option}`" for option in row.options) or "-",
                row.equation or "beyond the paper",
            )
            for row in wavelet_core.PARTITIONS.values()
        ),
    )


def meshes(name: str) -> str:
    """Return the table of the mesh formats."""
    from wavelet_gis.io.formats import MESH_FORMATS

    return table(
        ("mesh", "suffix", "used by", "needs"),
        ((row.name, f"`{row.suffix}`", row.used_by, row.package or "-") for row in MESH_FORMATS),
    )


#: Which function makes which table.
TABLES = {
    "predictions": filters,
    "updates": filters,
    "partitions": partitions,
    "meshes": meshes,
}


def renewed(page: str) -> str:
    """Return the text of a page with its tables made anew."""
    return MARKED.sub(lambda found: found[1] + TABLES[found[2]](found[2]) + found[3], page)


def main() -> None:
    """Rewrite the pages and name those that changed."""
    sys.path.insert(0, str(ROOT))
    for path in sorted((ROOT / "docs").glob("*/*.md")):
        old = path.read_text(encoding="utf-8")
        new = renewed(old)
        if new != old:
            path.write_text(new, encoding="utf-8")
            print(path.relative_to(ROOT))


if __name__ == "__main__":
    main()
