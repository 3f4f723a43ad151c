"""Remake the tables and pictures of ``docs/science/paper-experiments.md``.

    python -m benchmarks.paper [DATA_FOLDER] [--only rmse,salience,noise,frequency,readings]
                               [--autzen-points 100000]

Autzen is thinned to ``--autzen-points`` because twelve designs of all its ten million points take
hours; give 11000000 for the whole of it. Figures are kept in ``benchmarks/paper/results.json``,
so that experiments can be run one by one.
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


def rmse_samples(data, n_points):
    """Yield the clouds of Figs. 5-7, one in memory at a time."""
    folder = data / "clouds"
    yield clouds.classed(folder / "Topography.laz", "Fig. 5, forest")
    yield clouds.classed(folder / "ign_semis_2023_0292_6833_289k.laz", "Fig. 5 (280,000)")
    cropped = clouds.autzen(folder / "autzen_full_10M.laz", "Fig. 6 (9 M)", n_points, DENSE_SHARE)
    yield clouds.Sample("autzen_cropped", cropped.figure, cropped.mesh, cropped.note)
    whole = clouds.autzen(folder / "autzen_full_10M.laz", "Fig. 7 (11.5 M)", n_points, 1.0)
    yield clouds.Sample("autzen_whole", whole.figure, whole.mesh, whole.note)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", nargs="?", default="../shared/data", type=Path)
    parser.add_argument("--only", default=",".join(EXPERIMENTS))
    parser.add_argument("--autzen-points", type=int, default=100_000)
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")  # of the input files; they are told elsewhere
    store = HERE / "results.json"
    results = json.loads(store.read_text()) if store.exists() else {}
    pictures = DOCS / "images" / "paper"
    pictures.mkdir(parents=True, exist_ok=True)

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
            samples = list(rmse_samples(arguments.data, arguments.autzen_points))
            results[name] = readings.run(samples[:2] + samples[3:], arguments.data)
        elif name == "rmse":
            for sample in rmse_samples(arguments.data, arguments.autzen_points):
                results.setdefault(name, {})[sample.name] = rmse.run(sample, pictures)
                keep()
        keep()


if __name__ == "__main__":
    main()
