"""Remake the tables and pictures of ``docs/science/paper-experiments.md``.

    python -m benchmarks.paper [DATA_FOLDER] [--only rmse,salience,noise,frequency,readings]
                               [--clouds NAME,...] [--resume]
                               [--autzen-points 11000000] [--readings-points 1000000]

Twelve designs of all of Autzen's ten million points take hours: ``--autzen-points`` thins it, and
``--readings-points`` does for the 36 designs of the other readings. Figures are kept in
``benchmarks/paper/results.json``, so that experiments can be run one by one, and ``--resume`` goes
on with ``rmse`` and ``readings`` that were interrupted.
"""

import argparse
import json
import warnings
from pathlib import Path

from . import clouds, frequency, page, readings, rmse, salience

HERE = Path(__file__).resolve().parent
DOCS = HERE.parent.parent / "docs"
PAGE = DOCS / "science" / "paper-experiments.md"
EXPERIMENTS = ("frequency", "salience", "noise", "rmse", "readings")
#: The paper's dense set has 9 M points; Autzen's first 9 M of 10.65 M along y stand for it.
DENSE_SHARE = 9.0 / 10.65
#: The clouds of Figs. 5-7, and those of them on which the other readings are tried.
CLOUDS = ("Topography", "ign_semis_2023_0292_6833_289k", "autzen_cropped", "autzen_whole")
READ_CLOUDS = ("Topography", "ign_semis_2023_0292_6833_289k", "autzen_whole")


def samples(data, names, n_points):
    """Yield clouds, one in memory at a time."""
    folder = data / "clouds"
    figures = dict(zip(CLOUDS[:2], ("Fig. 5, forest", "Fig. 5 (280,000)"), strict=True))
    for name in names:
        if name in figures:
            yield clouds.classed(folder / f"{name}.laz", figures[name])
            continue
        figure, share = {
            "autzen_cropped": ("Fig. 6 (9 M)", DENSE_SHARE),
            "autzen_whole": ("Fig. 7 (11.5 M)", 1.0),
        }[name]
        path = folder / "autzen_full_10M.laz"
        yield clouds.autzen(name, path, figure, n_points, share)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", nargs="?", default="../shared/data", type=Path)
    parser.add_argument("--only", default=",".join(EXPERIMENTS))
    parser.add_argument("--clouds", default=",".join(CLOUDS))
    parser.add_argument("--autzen-points", type=int, default=11_000_000)
    parser.add_argument("--readings-points", type=int, default=1_000_000)
    parser.add_argument("--resume", action="store_true")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")  # of the input files; they are told elsewhere
    store = HERE / "results.json"
    results = json.loads(store.read_text()) if store.exists() else {}
    pictures = DOCS / "images" / "paper"
    pictures.mkdir(parents=True, exist_ok=True)
    names = arguments.clouds.split(",")

    def keep():
        store.write_text(json.dumps(results, indent=1))
        if PAGE.exists():
            page.fill(PAGE, results)

    for name in arguments.only.split(","):
        print(name, flush=True)
        if name == "frequency":
            results[name] = frequency.run(arguments.data, pictures)
        elif name == "salience":
            results[name] = salience.run(arguments.data, pictures)
        elif name == "noise":
            results[name] = salience.run_noise(arguments.data)
        elif name == "readings":
            known = results.setdefault(name, {})
            if not arguments.resume:
                forget(known.get("clouds", {}), names)
                known.pop("sharp", None)
            chosen = [one for one in READ_CLOUDS if one in names]
            read = samples(arguments.data, chosen, arguments.readings_points)
            readings.run(read, arguments.data, known, keep)
        elif name == "rmse":
            known = results.setdefault(name, {})
            if not arguments.resume:
                forget(known, names)
            for sample in samples(arguments.data, names, arguments.autzen_points):
                rmse.run(sample, known.setdefault(sample.name, {}), keep)
                rmse.draw_levels(sample, pictures / f"levels-{sample.name}.png")
        keep()
    draw(results, pictures)


def forget(known, names):
    """Take out what is known of some clouds."""
    for name in names:
        known.pop(name, None)


def draw(results, pictures):
    """Draw the curves of every cloud whose designs have all been run."""
    read = results.get("readings", {}).get("clouds", {})
    for name, one in results.get("rmse", {}).items():
        if "GLMN_z" in one:
            same = read.get(name, {}).get("n_vertices") == one["n_vertices"]
            rmse.draw_errors(name, one, read[name]["readings"] if same else {}, pictures)


if __name__ == "__main__":
    main()
