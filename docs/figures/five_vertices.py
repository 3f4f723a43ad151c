"""Drawings of the smallest pyramid that shows everything: a square and its middle.

All numbers in the drawings come from the core, run on these five vertices.
"""

from __future__ import annotations

import io

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from wavelet_core import TriangleMesh, analyse

INK, FAINT, ODD, EVEN, FACE = "#23302b", "#8a938c", "#b3402a", "#1f5f8b", "#e9efe6"

MESH = TriangleMesh(
    np.array([[0, 0, 1.0], [2, 0, 2.0], [2, 2, 3.0], [0, 2, 2.0], [1, 1, 5.0]]),
    np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]),
)
PYRAMID = analyse(MESH, levels=1)


def drawings() -> dict[str, str]:
    """Return the SVG of each drawing by its name."""
    made = (tin, one_ring, collapse, predict, update)
    return {f"five-{function.__name__.replace('_', '-')}": function() for function in made}


def tin() -> str:
    """Draw the five vertices in plan and from the side."""
    figure, (plan, side) = plt.subplots(
        1, 2, figsize=(8, 3.4), subplot_kw=None, gridspec_kw={"width_ratios": [1, 1.2]}
    )
    faces_of(plan, MESH)
    heights_of(plan, MESH)
    plan.set_title("in plan: four triangles", color=INK)
    side.remove()
    solid = figure.add_subplot(1, 2, 2, projection="3d")
    x, y, z = MESH.vertices.T
    solid.plot_trisurf(x, y, z, triangles=MESH.faces, color=FACE, edgecolor=INK, linewidth=1)
    solid.view_init(elev=22, azim=-65)
    solid.set_box_aspect((2, 2, 1.4))
    solid.set_axis_off()
    solid.set_title("as a surface", color=INK)
    return svg_of(figure)


def one_ring() -> str:
    """Draw the middle as odd vertex, its one-ring as even ones."""
    figure, axes = plt.subplots(figsize=(3.6, 3.4))
    faces_of(axes, MESH)
    step = PYRAMID.filters(0)
    dots(axes, MESH.vertices[step.even], EVEN, "even: kept")
    dots(axes, MESH.vertices[step.odd], ODD, "odd: goes")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.02), ncols=2, frameon=False)
    return svg_of(figure)


def collapse() -> str:
    """Draw the collapse of the middle onto a corner."""
    figure, (before, after) = plt.subplots(1, 2, figsize=(7, 3.4))
    faces_of(before, MESH)
    odd = int(PYRAMID.filters(0).odd[0])
    target = int(PYRAMID.steps[0].target[0])
    before.annotate(
        "", MESH.vertices[target, :2] + 0.12, MESH.vertices[odd, :2],
        arrowprops={"arrowstyle": "-|>", "color": ODD, "lw": 2.2},
    )  # fmt: skip
    dots(before, MESH.vertices[[odd]], ODD)
    before.set_title("half-edge collapse", color=INK)
    faces_of(after, PYRAMID[0])
    heights_of(after, MESH, PYRAMID.vertex_ids(0))
    after.set_title("two triangles are left", color=INK)
    return svg_of(figure)


def predict() -> str:
    """Draw the cut along the diagonal: what is predicted, and the detail."""
    figure, axes = plt.subplots(figsize=(6.4, 3.2))
    ends = [0, 2]
    along = np.array([0.0, 2 * np.sqrt(2)])
    coarse = MESH.vertices[ends, 2]
    step = PYRAMID.filters(0)
    predicted = float((step.prediction @ MESH.vertices[step.even, 2])[0])
    detail = float(PYRAMID.detail(0).vectors[0, 0])
    middle = np.sqrt(2)
    axes.plot(
        [0, middle, along[1]], [coarse[0], MESH.vertices[4, 2], coarse[1]], color=FAINT, ls=":"
    )
    axes.plot(along, coarse, color=EVEN, lw=2)
    axes.plot(along, coarse, "o", color=EVEN, ms=9)
    axes.plot(middle, MESH.vertices[4, 2], "o", color=ODD, ms=9)
    axes.plot(middle, predicted, "o", mfc="white", mec=ODD, ms=9)
    axes.annotate(
        "", (middle, MESH.vertices[4, 2] - 0.12), (middle, predicted + 0.12),
        arrowprops={"arrowstyle": "<|-|>", "color": ODD},
    )  # fmt: skip
    axes.text(
        middle + 0.1, (predicted + MESH.vertices[4, 2]) / 2, f"detail w = {detail:g}", color=ODD
    )
    axes.text(middle + 0.12, predicted - 0.42, f"predicted: ½·1 + ½·3 = {predicted:g}", color=INK)
    for place, height in zip(along, coarse, strict=True):
        axes.text(place, height - 0.55, f"{height:g}", ha="center", color=EVEN)
    axes.text(
        middle, MESH.vertices[4, 2] + 0.25, f"{MESH.vertices[4, 2]:g}", ha="center", color=ODD
    )
    axes.set_ylim(-0.2, 6.1)
    axes.set_axis_off()
    return svg_of(figure)


def update() -> str:
    """Draw what each corner takes up of the detail, before and after."""
    figure, axes = plt.subplots(figsize=(6.4, 3.4))
    even = PYRAMID.filters(0).even
    before, after = MESH.vertices[even, 2], PYRAMID[0].vertices[:, 2]
    integrals = PYRAMID.integrals(0)
    place = np.arange(len(even))
    axes.bar(place, before, 0.55, color=EVEN, label="before the update")
    axes.bar(place, after - before, 0.55, bottom=before, color=ODD, label="U w, taken up")
    for k in place:
        axes.text(k, after[k] + 0.08, f"{after[k]:.3f}", ha="center", color=INK)
    axes.set_xticks(place, [f"vertex {v}\nζ = {z:g}" for v, z in zip(even, integrals, strict=True)])
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.set_yticks([])
    axes.tick_params(length=0, colors=INK)
    total = float(integrals @ after)
    axes.set_title(f"Σ ζ s = {total:g} = {MESH.vertices[:, 2].sum():g}, the sum before", color=INK)
    axes.legend(frameon=False, loc="upper left")
    axes.set_ylim(0, 5)
    return svg_of(figure)


def faces_of(axes, mesh):
    axes.triplot(*mesh.vertices[:, :2].T, mesh.faces, color=INK, lw=1.3)
    axes.tripcolor(
        *mesh.vertices[:, :2].T, mesh.faces, facecolors=np.zeros(mesh.n_faces),
        cmap=mpl.colors.ListedColormap([FACE]), zorder=0,
    )  # fmt: skip
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set(xlim=(-0.4, 2.4), ylim=(-0.4, 2.4))


def heights_of(axes, mesh, vertices=None):
    for v in range(mesh.n_vertices) if vertices is None else vertices:
        x, y, z = mesh.vertices[v]
        axes.text(
            x + (0.14 if x > 0 else -0.14), y + (0.16 if y > 0 else -0.18), f"{z:g}",
            ha="center", va="center", color=INK, fontsize=12,
        )  # fmt: skip


def dots(axes, vertices, colour, label=None):
    axes.plot(vertices[:, 0], vertices[:, 1], "o", ms=11, color=colour, label=label)


def svg_of(figure) -> str:
    """Return the drawing as SVG: the same text each time, so that Sphinx sees what has changed."""
    stream = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": "five", "svg.fonttype": "path"}):
        figure.savefig(stream, format="svg", bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)
    return stream.getvalue()
