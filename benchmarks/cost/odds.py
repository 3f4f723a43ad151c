"""Fit the odds that a vertex goes, by which the answers of a pyramid file are sorted.

    python benchmarks/cost/odds.py FILE...

Every DEM or cloud is analysed. Of each question it is kept what a reader knows (the entry of every
table of `wavelet_core.partition.questions`) and the answer. Printed are the bytes of all answers,
compressed as in a file: with classes by forecasts alone, as before format 4; with the tables as
they are; with tables fitted to the other files by logistic regression; and at the end the tables
fitted to all files.
"""

from __future__ import annotations

import argparse
import lzma
import sys
import warnings
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

import wavelet_gis as wg
from wavelet_core.lifting import recorded
from wavelet_core.partition import questions as q
from wavelet_gis.io.pyramid.codecs.array_codec import WRITTEN_LZMA_FILTERS

TABLES = ("forecast", "round", "neighbours", "integral", "lead")
#: Entries of each table, those for nothing, untouched and no choice at the end.
SIZES = (
    len(q.ODDS_BY_FORECAST) + 1,
    len(q.ODDS_BY_ROUND),
    len(q.ODDS_BY_NEIGHBOURS),
    len(q.ODDS_BY_INTEGRAL) + 1,
    len(q.ODDS_BY_LEAD) + 1,
)
#: Of each file so many questions are fitted to.
MOST = 60_000
#: Sixteenths of a natural logarithm.
UNIT = 16
#: Weight of the squares of the odds in the fit.
RIDGE = 1.0


class Listener(q.Writer):
    """Keeps what was known at each question, the class by forecast, and the answer."""

    def __init__(self) -> None:
        super().__init__()
        LISTENERS.append(self)
        self.known: list[np.ndarray] = []
        self.former: list[np.ndarray] = []
        self.answered: list[np.ndarray] = []

    def going(self, classes, answers):
        """Keep the answers in the order of the questions."""
        self.answered.append(answers)
        return super().going(classes, answers)


LISTENERS: list[Listener] = []


def listening(classes_by_odds):
    """Return what gives classes by odds and tells the listener what they are worked out of."""

    def classes_of(sight, forecasts, bounds):
        by_odds = classes_by_odds(sight, forecasts, bounds)
        by_forecast = q._classes_by_forecast(sight, forecasts, bounds)

        def classes(asked, is_first):
            listener = LISTENERS[-1]
            known = entries(sight, forecasts, bounds, asked, is_first)
            found = by_odds(asked, is_first)
            if not np.array_equal(found, classes_of_odds(known, in_use())):
                raise SystemExit("this script finds other classes than the package")
            listener.known.append(known)
            listener.former.append(by_forecast(asked, is_first))
            return found

        return classes

    return classes_of


def entries(sight, forecasts, bounds, asked, is_first):
    """Return the place in each table, (n_asked, 5)."""
    best, second, n_around = (of_all[asked].astype(int) for of_all in forecasts)
    octave = (best - bounds.middle) // q.CODES_IN_OCTAVE + SIZES[0] // 2 - 1
    octave = np.where(best == 0, SIZES[0] - 1, np.clip(octave, 0, SIZES[0] - 2))
    codes = q.upper_halves(sight.integrals[asked]).astype(int)
    quarter = (codes - bounds.integral) // (q.CODES_IN_OCTAVE // 4) + SIZES[3] // 2 - 1
    quarter = np.where(codes == q._UNTOUCHED, SIZES[3] - 1, np.clip(quarter, 0, SIZES[3] - 2))
    lead = np.maximum(second - best, 0) // (q.CODES_IN_OCTAVE // 2)
    lead = np.where(second == q.NO_FORECAST, SIZES[4] - 1, np.minimum(lead, SIZES[4] - 2))
    later = np.full(len(asked), int(not is_first))
    neighbours = np.clip(n_around - 3, 0, SIZES[2] - 1)
    return np.stack([octave, later, neighbours, quarter, lead], axis=1).astype(np.uint8)


def asked_of(path):
    """Return the entries of all questions about a file, the classes by forecast, the answers."""
    LISTENERS.clear()
    wg.analyse(wg.open(path), measure=False)
    parts = [[np.concatenate(getattr(one, name)) for one in LISTENERS if one.answered]
             for name in ("known", "former", "answered")]  # fmt: skip
    return tuple(np.concatenate(part) for part in parts)


def one_hot(known):
    """Return a column for each entry of each table."""
    columns = [known[:, [i]] == np.arange(size) for i, size in enumerate(SIZES)]
    return np.concatenate([*columns, np.ones((len(known), 1), dtype=bool)], axis=1).astype(float)


def fitted(samples):
    """Return the odds of all entries and the constant, by logistic regression with a ridge."""
    known, answers = (np.concatenate(part) for part in zip(*samples, strict=True))
    columns, sign = one_hot(known), np.where(answers, 1.0, -1.0)

    def loss(odds):
        margin = sign * (columns @ odds)
        slope = -sign / (1.0 + np.exp(margin))
        ridge = odds * (np.arange(len(odds)) < len(odds) - 1) * RIDGE
        return np.logaddexp(0.0, -margin).sum() + 0.5 * odds @ ridge, slope @ columns + ridge

    found = minimize(loss, np.zeros(columns.shape[1]), jac=True, method="L-BFGS-B")
    return np.rint(UNIT * found.x).astype(int)


def in_use():
    """Return the odds of all entries and the constant, as they are."""
    return np.array([
        *q.ODDS_BY_FORECAST, q.ODDS_OF_NOTHING, *q.ODDS_BY_ROUND, *q.ODDS_BY_NEIGHBOURS,
        *q.ODDS_BY_INTEGRAL, q.ODDS_OF_UNTOUCHED, *q.ODDS_BY_LEAD, q.ODDS_OF_NO_CHOICE, q.ODDS,
    ])  # fmt: skip


def n_bytes(classes, answers):
    """Return how many bytes answers take, class by class."""
    bits = np.packbits(answers[np.argsort(classes, kind="stable")]).tobytes()
    return len(lzma.compress(bits, lzma.FORMAT_RAW, filters=WRITTEN_LZMA_FILTERS))


def classes_of_odds(known, odds):
    """Return the classes of questions."""
    starts = np.concatenate([[0], np.cumsum(SIZES)[:-1]])
    total = odds[known.astype(int) + starts].sum(axis=1) + odds[-1]
    return np.clip(total // q.ODDS_IN_CLASS + q.N_GOING_CLASSES // 2, 0, q.N_GOING_CLASSES - 1)


def main() -> None:
    """Print the bytes by file, and the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", type=Path)
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    recorded.Writer = Listener
    q._classes_by_odds = listening(q._classes_by_odds)
    rng = np.random.default_rng(0)
    asked, samples = {}, {}
    for path in arguments.files:
        known, former, answers = asked[path.name] = asked_of(path)
        chosen = rng.permutation(len(answers))[:MOST]
        samples[path.name] = known[chosen], answers[chosen]
    print("| data | questions | by forecasts, bytes | by odds | by odds fitted to the others |")
    print("|---|---|---|---|---|")
    for name, (known, former, answers) in asked.items():
        before = n_bytes(former, answers)
        sizes = [n_bytes(classes_of_odds(known, in_use()), answers)]
        others = [sample for other, sample in samples.items() if other != name]
        if others:
            sizes.append(n_bytes(classes_of_odds(known, fitted(others)), answers))
        cells = " | ".join(f"{size:,} ({size / before:.3f})" for size in sizes)
        print(f"| {name} | {len(answers):,} | {before:,} | {cells} |", flush=True)
    odds, start = fitted(list(samples.values())), 0
    for name, size in zip(TABLES, SIZES, strict=True):
        print(f"{name}: {odds[start : start + size].tolist()}")
        start += size
    print(f"constant: {odds[-1]}")


if __name__ == "__main__":
    sys.exit(main())
