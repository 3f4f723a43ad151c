"""The pages of docs/ as HTML, for the zip of the plugin: what the *Help* button opens.

Only the Markdown that those pages use is known: headings, paragraphs, lists, tables, code, links,
emphasis. Pictures stay away; their place tells what they show.
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterator

STYLE = (
    "body{font-family:sans-serif;max-width:50em;margin:2em auto;padding:0 1em;line-height:1.5}"
    "table{border-collapse:collapse}td,th{border:1px solid #bbb;padding:.2em .5em}"
    "pre,code{background:#f3f3f3}pre{padding:.6em;overflow:auto}"
)


def page(text: str) -> str:
    """Return a page of Markdown as a page of HTML."""
    title = re.search(r"^# (.+)$", text, re.MULTILINE)
    text = re.sub(r"<!--.*?-->\n?", "", text, flags=re.DOTALL)
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f"<title>{html.escape(title[1] if title else 'Terrain Wavelets')}</title>"
        f"<style>{STYLE}</style></head><body>\n" + "\n".join(_blocks(text)) + "\n</body></html>\n"
    )


def _blocks(text: str) -> Iterator[str]:
    # Code first: what is in it is no Markdown.
    for k, part in enumerate(re.split(r"^```.*$", text, flags=re.MULTILINE)):
        if k % 2:
            yield f"<pre>{html.escape(part.strip())}</pre>"
            continue
        for block in re.split(r"\n\s*\n", part.strip("\n")):
            lines = block.strip("\n").splitlines()
            while lines and (heading := re.match(r"(#+) (.+)", lines[0])):
                level, words = len(heading[1]), heading[2]
                anchor = re.sub(r"[^a-z0-9]+", "-", words.lower()).strip("-")
                yield f'<h{level} id="{anchor}">{_inline(words)}</h{level}>'
                del lines[0]
            if lines:
                yield _block(lines)


def _block(lines: list[str]) -> str:
    if lines[0].startswith("|"):
        rows = [[c.strip() for c in re.split(r"(?<!\\)\|", r.strip().strip("|"))] for r in lines]
        body = [_row(row, "td") for row in rows[2:]]
        return f"<table>{_row(rows[0], 'th')}{''.join(body)}</table>"
    mark = re.match(r"\s*(-|\d+\.) ", lines[0])
    if mark:
        kind = "ul" if mark[1] == "-" else "ol"
        items = re.split(r"^\s*(?:-|\d+\.) ", "\n".join(lines), flags=re.MULTILINE)[1:]
        return f"<{kind}>" + "".join(f"<li>{_inline(item)}</li>" for item in items) + f"</{kind}>"
    return f"<p>{_inline(' '.join(lines))}</p>"


def _row(cells: list[str], tag: str) -> str:
    return "<tr>" + "".join(f"<{tag}>{_inline(cell)}</{tag}>" for cell in cells) + "</tr>"


def _inline(text: str) -> str:
    parts = re.split(r"(`[^`]+`)", text)
    for k, part in enumerate(parts):
        if k % 2:
            parts[k] = f"<code>{html.escape(part[1:-1])}</code>"
            continue
        part = html.escape(part, quote=False)
        part = re.sub(r"!\[([^\]]*)\]\([^)]*\)", r"<em>[\1]</em>", part)
        part = re.sub(r"\[([^\]]+)\]\(([^)]+)\)", _link, part)
        part = re.sub(r"\*\*(.+?)\*\*", r"<b>\1</b>", part)
        parts[k] = re.sub(r"(?<![\w*])\*([^*\s][^*]*?)\*(?!\w)", r"<i>\1</i>", part)
    return "".join(parts)


def _link(found: re.Match[str]) -> str:
    words, target = found[1], found[2]
    if re.match(r"https?:", target):
        return f'<a href="{html.escape(target)}">{words}</a>'
    page_name, _, anchor = target.partition("#")
    if page_name and (not page_name.endswith(".md") or "made/" in page_name):
        return words  # a file that is not in the zip
    href = page_name.rpartition("/")[2].replace(".md", ".html") + ("#" + anchor if anchor else "")
    return f'<a href="{href}">{words}</a>'
