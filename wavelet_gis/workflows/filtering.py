"""Pyramid to filtered pyramid, in the units of its input: noise taken out, scales changed."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from wavelet_core import (
    OptionError,
    Progress,
    Pyramid,
    TriangleMesh,
    analyse,
    band_gains,
    denoise,
    level_spacings,
    relifted,
)
from wavelet_core.filtering.denoise import N_PYRAMIDS
from wavelet_core.filtering.gains import channel_index, require_order
from wavelet_core.filtering.noise.model import Noise, RangeOption
from wavelet_core.filtering.noise.white import estimate_noise
from wavelet_core.lifting.spacings import mesh_spacing
from wavelet_core.progress import part_of
from wavelet_gis.errors import TerrainWarning
from wavelet_gis.io.formats import PYRAMID_SUFFIX, suffix_of
from wavelet_gis.model.attributes.categories import category_gains
from wavelet_gis.model.attributes.lines import line_labels
from wavelet_gis.model.dem import Dem
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.notes import warn
from wavelet_gis.workflows.options import HoldsPyramid, metre_of, pyramid_of, require_levels
from wavelet_gis.workflows.reconstruct import Reconstruction, reconstruct
from wavelet_gis.workflows.save import Layers, write_pyramid_file

__all__ = [
    "Filtered",
    "chosen_gains",
    "denoised",
    "filter_pyramid",
    "with_level_gains",
    "with_sizes",
]

#: By how much a level in random order is wider than the finer one, at least, and how many levels
#: are built at most to reach a size.
_GROWTH, _MOST_LEVELS = 1.08, 80
#: Options that describe the noise, beside its deviation.
NOISE_OPTIONS = ("noise_range", "local_noise", "outliers", "stripes")


@dataclass(frozen=True, slots=True)
class Filtered:
    """A filtered pyramid.

    Attributes
    ----------
    before, geo : GeoPyramid
        As it was given, and filtered.
    finest_before, finest : TriangleMesh
        Their finest meshes, in the working frame.
    sigmas : dict of str to float
        Standard deviation of the noise taken out of each channel, in the input's unit.
    gains : dict of int to float
        What the details of each level were multiplied by; levels that are not listed stayed.
    n_pyramids : int or None
        How many pyramids denoising averaged; None where no noise was taken out.
    """

    before: GeoPyramid
    geo: GeoPyramid
    finest_before: TriangleMesh
    finest: TriangleMesh
    sigmas: dict[str, float]
    gains: dict[int, float] | None
    n_pyramids: int | None

    @property
    def changes(self) -> tuple[str, ...]:
        """One line for each thing that was done."""
        return self.geo.history[len(self.before.history) :]

    def change(self) -> tuple[float, float]:
        """Return root mean square and largest change of z, in the input's unit."""
        moved = self.finest.vertices[:, 2] - self.finest_before.vertices[:, 2]
        moved = moved / self.before.frame.z_scale
        rms = float(np.sqrt(np.mean(moved**2))) if len(moved) else 0.0
        return rms, float(np.abs(moved).max(initial=0.0))

    def restored(self) -> Reconstruction:
        """Return the filtered form of what the pyramid was made from."""
        return reconstruct(self.geo, finest=self.finest)

    def difference(self) -> Dem:
        """Return the filtered DEM minus the original one, for a pyramid of a raster."""
        from wavelet_gis.products.level_raster import surface_difference

        return surface_difference(self.before, self.geo, (self.finest_before, self.finest))

    def write(
        self,
        path: str | os.PathLike[str],
        *,
        layers: Layers = "auto",
        progress: Progress | None = None,
    ) -> None:
        """Write it as a pyramid file, or as what the input was, by the suffix.

        See `wavelet_gis.workflows.save.save`.
        """
        if suffix_of(path) == PYRAMID_SUFFIX:
            write_pyramid_file(path, self.geo, layers, progress)
        else:
            self.restored().write(path)

    def figures(self) -> dict[str, Any]:
        """Return what was done, and how much changed, as JSON-able values."""
        rms, largest = self.change()
        figures: dict[str, Any] = {}
        if self.n_pyramids is not None:
            figures.update(sigma=self.sigmas, n_pyramids=self.n_pyramids)
        if self.gains is not None:
            figures["gains"] = self.gains
        return {**figures, "rms_change": rms, "largest_change": largest}


def filter_pyramid(
    data: HoldsPyramid | GeoPyramid,
    *,
    gains: Iterable[tuple[int, float]] | dict[int, float] = (),
    levels: tuple[int, int] | None = None,
    metres: tuple[float, float] | None = None,
    drop_coarse: bool = False,
    denoise: bool | float = False,
    n_pyramids: int | None = None,
    channels: Sequence[str] | None = None,
    noise_range: RangeOption = 0.0,
    local_noise: bool = False,
    outliers: bool = False,
    stripes: str | None = None,
    progress: Progress | None = None,
) -> Filtered:
    """Return a pyramid with noise taken out, then chosen scales damped, boosted or isolated.

    Parameters
    ----------
    data : Analysis, Filtered or GeoPyramid
        The pyramid.
    gains, levels, metres
        See `chosen_gains`. Where the levels of the pyramid are no bands of sizes, `metres` goes by
        those of another that is built for it; see `with_sizes`.
    drop_coarse : bool
        Leave out the coarsest surface too, so that the details remain by themselves.
    denoise : bool or float
        Whether noise is taken out; a number is its standard deviation, in the input's unit, which
        is estimated otherwise.
    n_pyramids : int, optional
        How many pyramids in random order are averaged, 4 by default; 0 thresholds the details of
        one.
    channels : sequence of str, optional
        Which to take noise from; by default z.
    noise_range : float or "estimate"
        Distance at which the correlation of the noise has fallen to 1/e, in metres where the CRS
        names its unit, else in its own; 0 for white noise.
    local_noise : bool
        Whether the noise differs by place, and is measured there.
    outliers : bool
        Whether values that stand out of their ring are replaced before all else.
    stripes : str, optional
        Take out an offset for each of the ``"rows"`` or ``"columns"`` of a raster, or for each
        value of a dimension of points, such as the flight lines of ``"point_source_id"``.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    Filtered
        Each of the two finest meshes has been synthesised once.

    Raises
    ------
    OptionError
        Nothing to do, a pyramid without levels, bounds in the wrong order, levels or channels that
        are not there, options of noise without denoising; nothing has been computed yet.
    Cancelled
        ``progress`` returned False.
    """
    geo = pyramid_of(data)
    single = list(gains.items() if isinstance(gains, dict) else gains)
    asks_scales = bool(single) or levels is not None or metres is not None or drop_coarse
    is_estimated = isinstance(denoise, bool | np.bool_)
    asks_denoising = not is_estimated or bool(denoise)
    of_noise = {
        "noise_range": noise_range != 0.0,
        "local_noise": local_noise,
        "outliers": outliers,
        "stripes": stripes is not None,
        "n_pyramids": n_pyramids is not None,
        "channels": channels is not None,
    }
    _require_work(of_noise, asks_scales=asks_scales, asks_denoising=asks_denoising)
    n_pyramids = N_PYRAMIDS if n_pyramids is None else n_pyramids
    require_levels(geo)
    if metres is not None:
        require_order(*metres, "metres")
    builds_levels = metres is not None and not _has_sizes(geo, metres)
    wanted = chosen_gains(geo, single, levels=levels, metres=None if builds_levels else metres)
    changed, sigmas = geo, dict[str, float]()
    finest_before = geo.pyramid.synthesise()
    # the surface is worked out anew at the end: quickly beside the noise, slowly beside sizes
    middle = (0.7 if builds_levels else 0.95) if asks_denoising else 0.0
    last = 0.95 if asks_denoising else 0.75
    if asks_denoising:
        changed, sigmas = denoised(
            changed,
            None if is_estimated else float(denoise),
            channels=("z",) if channels is None else channels,
            n_pyramids=n_pyramids,
            noise_range=noise_range,
            local_noise=local_noise,
            outliers=outliers,
            stripes=stripes,
            finest=finest_before,
            progress=part_of(progress, 0.0, middle),
        )
    if builds_levels:
        assert metres is not None
        changed = with_sizes(
            changed, metres, drop_coarse=drop_coarse, progress=part_of(progress, middle, last)
        )
    if wanted or (asks_scales and not builds_levels):
        changed = with_level_gains(changed, wanted, drop_coarse=drop_coarse and not builds_levels)
    return Filtered(
        before=geo,
        geo=changed,
        finest_before=finest_before,
        finest=changed.pyramid.synthesise(),
        sigmas=sigmas,
        gains=wanted if asks_scales and (wanted or not builds_levels) else None,
        n_pyramids=n_pyramids if asks_denoising else None,
    )


def denoised(
    geo: GeoPyramid,
    sigma: float | None = None,
    *,
    channels: Sequence[str] = ("z",),
    n_pyramids: int = N_PYRAMIDS,
    noise_range: RangeOption = 0.0,
    local_noise: bool = False,
    outliers: bool = False,
    stripes: str | None = None,
    finest: TriangleMesh | None = None,
    progress: Progress | None = None,
) -> tuple[GeoPyramid, dict[str, float]]:
    """Return the pyramid with the noise taken out, and the noise that was taken for it.

    Parameters
    ----------
    geo : GeoPyramid
        What is filtered.
    sigma : float, optional
        Standard deviation of the noise, in the input's unit; by default estimated.
    channels : sequence of str
        Which to take it from.
    n_pyramids : int
        How many pyramids in random order are averaged; 0 thresholds the details of one.
    noise_range, local_noise, outliers
        As for `wavelet_core.denoise`; the range in metres where the CRS names its unit, else in
        its own. Not with thresholds.
    stripes : str, optional
        See `wavelet_gis.model.attributes.lines.line_labels`. Not with thresholds.
    finest : TriangleMesh, optional
        The pyramid's finest mesh, where it has been synthesised already.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    GeoPyramid
        With one more line of history.
    dict of str to float
        Standard deviation of the noise in each channel, in the input's unit.

    Raises
    ------
    OptionError
        An unknown channel or a negative number, or lines that are not there; nothing has been
        computed yet.
    """
    has_kind = noise_range != 0.0 or local_noise or outliers or stripes is not None
    _require_noise(geo, channels, n_pyramids, has_kind=has_kind)
    lines = None
    if stripes is not None:
        finest = geo.pyramid.synthesise() if finest is None else finest
        lines = line_labels(geo.origin, finest, stripes)
    reach = noise_range if noise_range == "estimate" else noise_range * metre_of(geo)
    pyramid, sigmas, described = geo.pyramid, dict[str, float](), []
    for k, name in enumerate(channels):
        mesh = pyramid.synthesise() if k > 0 or finest is None else finest
        unit = geo.frame.z_scale if name == "z" else 1.0
        given = None if sigma is None else sigma * unit
        part = part_of(progress, k / len(channels), (k + 1) / len(channels))
        if n_pyramids == 0:
            noise = Noise(_noise_of(pyramid, mesh, name) if given is None else given)
            pyramid = pyramid.denoised(noise.sigma, channels=[name], finest=mesh, progress=part)
        else:
            found: dict[str, Noise] = {}
            clean = denoise(
                mesh,
                given,
                n_pyramids=n_pyramids,
                channels=[name],
                locked=pyramid.locked,
                noise_range=reach,
                local_noise=local_noise,
                outliers=outliers,
                lines=lines,
                found=found,
                progress=part,
            )
            noise, pyramid = found[name], relifted(pyramid, clean)
            _note_outliers(geo.source_name, name, noise)
            if noise.is_rough:
                _warn_of_roughness(geo.source_name, name, noise.sigma / unit, noise_range)
        sigmas[name] = noise.sigma / unit
        described.append(f"{name} {_in_file(noise, unit, metre_of(geo)).describe()}")
    how = f"average of {n_pyramids} pyramids" if n_pyramids else "thresholds"
    line = f"denoised by {how}, standard deviation of the noise: {'; '.join(described)}"
    return geo.with_pyramid(pyramid, line), sigmas


def _require_work(of_noise: dict[str, bool], *, asks_scales: bool, asks_denoising: bool) -> None:
    """Refuse to change nothing, and options of denoising without it."""
    if not asks_scales and not asks_denoising:
        raise OptionError(
            "nothing to change; give {0}, {1}, {2} or {3}.", "gains", "levels", "metres", "denoise"
        )
    in_vain = [name for name, is_given in of_noise.items() if is_given]
    if in_vain and not asks_denoising:
        raise OptionError("{0} is for {1}; give {1} too, or leave {0} out.", in_vain[0], "denoise")


def _require_noise(
    geo: GeoPyramid, channels: Sequence[str], n_pyramids: int, *, has_kind: bool
) -> None:
    """Refuse channels without noise, and noise of a kind that thresholds do not know."""
    for name in channels:
        channel_index(geo.pyramid.channels, name)
        if name in geo.categories:
            raise OptionError(
                "{name} is a category and has no noise; name another channel.",
                "channels",
                name=name,
            )
    if n_pyramids == 0 and has_kind:
        raise OptionError(
            "thresholds assume white noise; leave out {0}, {1}, {2} and {3}, or average one or "
            "more pyramids with {4}.",
            *NOISE_OPTIONS,
            "n_pyramids",
        )


def _in_file(noise: Noise, unit: float, metre: float) -> Noise:
    """Return noise in the units of the input."""
    return replace(
        noise,
        sigma=noise.sigma / unit,
        rounding=noise.rounding._replace(step=noise.rounding.step / unit),
        reach=noise.reach / metre,
        stripes=noise.stripes and noise.stripes.in_unit(unit),
    )


def _warn_of_roughness(source: str, channel: str, sigma: float, noise_range: RangeOption) -> None:
    """Warn that noise and relief could not be separated."""
    kind = "white, since its range cannot be found in it either, and " if noise_range else ""
    warn(
        TerrainWarning,
        "relief_as_fine_as_the_mesh",
        "{name}: {channel} has relief as fine as the mesh, which cannot be separated from "
        "noise; the noise is taken to be {kind}that of the flattest places, {sigma:.4g} ({0} names "
        "another)",
        "denoise",
        stacklevel=4,
        name=source,
        channel=channel,
        kind=kind,
        sigma=sigma,
    )


def _note_outliers(source: str, channel: str, noise: Noise) -> None:
    """Warn of values that denoising passes through, since no noise is like them."""
    if noise.n_standing_out:
        warn(
            TerrainWarning,
            "outliers_left",
            "{name}: outliers of {channel}, values that stand out from their neighbours far above "
            "the noise, are left as they are ({n_values} here; {0} replaces them)",
            "outliers",
            stacklevel=4,
            name=source,
            n_values=noise.n_standing_out,
            channel=channel,
        )


def chosen_gains(
    geo: GeoPyramid,
    gains: Iterable[tuple[int, float]] = (),
    *,
    levels: tuple[int, int] | None = None,
    metres: tuple[float, float] | None = None,
) -> dict[int, float]:
    """Return the gain of each level that a range of levels and single gains ask for together.

    Parameters
    ----------
    geo : GeoPyramid
        Whose levels.
    gains : iterable of (level, gain)
        They multiply what the range gives.
    levels : (int, int), optional
        Keep the details of these levels only.
    metres : (float, float), optional
        Instead: keep details of this size on the ground only, in metres where the CRS names its
        unit, else in its own. Levels in random order are bands of sizes.

    Raises
    ------
    OptionError
        Bounds in the wrong order, a level without details, or a band by levels and by lengths.
    """
    if levels is not None and metres is not None:
        raise OptionError("{0} and {1} exclude each other; give one.", "levels", "metres")
    chosen: dict[int, float] = {}
    if metres is not None:
        unit = metre_of(geo)
        chosen = band_gains(geo.pyramid, lengths=(metres[0] * unit, metres[1] * unit))
    elif levels is not None:
        chosen = band_gains(geo.pyramid, levels=levels)
    for level, gain in gains:
        geo.pyramid.require_details(level)
        chosen[level] = gain * chosen.get(level, 1.0)
    return chosen


def with_level_gains(
    geo: GeoPyramid, gains: dict[int, float], *, drop_coarse: bool = False
) -> GeoPyramid:
    """Return the pyramid with the details of each level multiplied.

    Parameters
    ----------
    geo : GeoPyramid
        What is filtered.
    gains : dict of int to float
        By level; others keep 1. Categories, such as classes, stay as they are.
    drop_coarse : bool
        Leave out the coarsest surface too, so that the details remain by themselves.
    """
    channels, categories = geo.pyramid.channels, geo.categories
    coarse = [0.0 if drop_coarse and name not in categories else 1.0 for name in channels]
    pyramid = geo.pyramid.with_gains(category_gains(gains, channels, categories), coarse)
    named = ", ".join(f"{level}={gain:g}" for level, gain in sorted(gains.items()))
    line = f"gains {named or 'unchanged'}" + ", without the coarse surface" * drop_coarse
    return geo.with_pyramid(pyramid, line)


def with_sizes(
    geo: GeoPyramid,
    metres: tuple[float, float],
    *,
    drop_coarse: bool = False,
    progress: Progress | None = None,
) -> GeoPyramid:
    """Return the pyramid of the terrain in which only details of some sizes are left.

    Its own levels need not be bands of sizes: another pyramid, in random order, is built for that.

    Parameters
    ----------
    geo : GeoPyramid
        What is filtered.
    metres : (float, float)
        Smallest and largest size that stays, in metres where the CRS names its unit, else in its
        own.
    drop_coarse : bool
        Leave out what is larger than all details too.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    OptionError
        Bounds in the wrong order.
    """
    low, high = metres[0] * metre_of(geo), metres[1] * metre_of(geo)
    finest = geo.pyramid.synthesise()
    largest = max(bound for bound in (low, high, 0.0) if bound < float("inf"))
    spacing = mesh_spacing(finest)
    n_levels = 1
    if largest > spacing > 0:
        n_levels += min(int(np.log(largest / spacing) / np.log(_GROWTH)), _MOST_LEVELS)
    by_size = analyse(
        finest,
        levels=n_levels,
        partition="random",
        prediction="plane",
        locked=geo.pyramid.locked,
        progress=progress,
    )
    gains = band_gains(by_size, lengths=(low, high), is_empty_fine=True)
    channels, categories = by_size.channels, geo.categories
    coarse = [0.0 if drop_coarse and name not in categories else 1.0 for name in channels]
    filtered = by_size.with_gains(category_gains(gains, channels, categories), coarse)
    line = f"sizes of {metres[0]:g} to {metres[1]:g} kept, by a pyramid in random order"
    line += ", without the coarse surface" * drop_coarse
    return geo.with_pyramid(relifted(geo.pyramid, filtered.synthesise()), line)


def _has_sizes(geo: GeoPyramid, metres: tuple[float, float]) -> bool:
    """Return whether the levels of a pyramid are bands of sizes, and one is within bounds."""
    if geo.pyramid.parameters.get("partition") != "random":
        return False
    sizes = level_spacings(geo.pyramid)[1:] / metre_of(geo)
    return bool(((metres[0] <= sizes) & (sizes <= metres[1])).any())


def _noise_of(pyramid: Pyramid, finest: TriangleMesh, channel: str) -> float:
    column = channel_index(pyramid.channels, channel)
    return estimate_noise(finest, pyramid.columns_of(finest)[:, column])
