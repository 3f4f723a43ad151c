"""References to the network in files that look local, found before GDAL follows them."""

from __future__ import annotations

import html
import os
import re
from pathlib import Path

__all__ = ["NO_NETWORK", "remote_reference"]

#: Settings of GDAL under which it opens nothing over the network.
NO_NETWORK = {
    "CPL_VSIL_CURL_ALLOWED_FILENAME": "none",
    "GDAL_HTTP_PROXY": "127.0.0.1:9",
    "GDAL_HTTPS_PROXY": "127.0.0.1:9",
}

_REMOTE = re.compile(
    r"/vsi(?:curl|s3|gs|az|adls|oss|swift|hdfs|webhdfs)\w*/\S*|(?:https?|ftps?|s3|gs)://\S+|"
    r"(?:WMS|WMTS|WCS|TMS|EEDAI|PLMOSAIC):\S+",
    re.IGNORECASE,
)

#: Elements that name what is read, in VRT and in GDAL's descriptions of map services.
_SOURCES = re.compile(
    rb"<(?:\w*Filename|\w*Dataset|\w*Url|URI|GetCapabilitiesUrl)\b[^>]*>([^<]+)<", re.IGNORECASE
)
_DESCRIPTIONS = (b"<VRTDataset", b"<GDAL_WMS", b"<GDAL_WMTS", b"<WCS_GDAL", b"<GDALTileIndex")

_LARGEST_DESCRIPTION = 64 << 20
_DEEPEST = 8


def remote_reference(name: str | os.PathLike[str], depth: int = 0) -> str | None:
    """Return the first thing on the network that a raster refers to; None when all is local.

    Parameters
    ----------
    name : path or str
        A file of any suffix (a VRT may be called ``.tif``), or a name for GDAL.
    depth : int
        How many descriptions led here.
    """
    text = os.fspath(name)
    remote = _REMOTE.match(text)
    if remote and not os.path.exists(text):
        return remote[0]
    if depth > _DEEPEST or not os.path.isfile(text):
        return None
    with open(text, "rb") as stream:
        head = stream.read(4096)
        if not any(word in head for word in _DESCRIPTIONS):
            return None
        content = head + stream.read(_LARGEST_DESCRIPTION)
    for match in _SOURCES.finditer(content):
        source = html.unescape(match[1].decode("utf-8", errors="replace")).strip()
        found = _REMOTE.search(source)
        if found:
            return found[0]
        nested = Path(text).parent / source
        if "\0" not in source and nested.name:
            deeper = remote_reference(nested, depth + 1)
            if deeper is not None:
                return deeper
    return None
