"""Time and memory of the main job: a DEM of a million cells, the paper's GLMN, 12 levels.

    python benchmarks/cost/speed.py [--size 1000] [--dem FILE] [--design GLMN] [--levels 12]
        [--cold]

Prints the seconds to import ``wavelet_core`` and what analyses, the seconds of ``analyse()`` in a
process that has run it before (warm) and, with ``--cold``, in one that must compile everything
first, and the peak memory above what the input mesh itself needs, per vertex. The terrain is
synthetic (hills of all sizes and a little noise) unless a DEM is given. It measures; it does not
judge.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np
import psutil


def fractal_terrain(size):
    """Return ``(size, size)`` elevations with a power spectrum like that of hills."""
    rng = np.random.default_rng(0)
    frequency = np.hypot(np.fft.fftfreq(size)[:, None], np.fft.rfftfreq(size)[None, :])
    frequency[0, 0] = np.inf
    spectrum = np.fft.rfft2(rng.standard_normal((size, size))) / frequency**1.9
    surface = np.fft.irfft2(spectrum, s=(size, size))
    return 500 + 100 * surface / surface.std() + 0.05 * rng.standard_normal((size, size))


def read_elevation(path):
    """Return the elevations of a raster's first band, NaN where there is none."""
    import rasterio

    with rasterio.open(path) as dataset:
        return dataset.read(1, masked=True).astype(float).filled(np.nan)


class PeakMemory:
    """Largest resident memory of this process while the block runs, in bytes above its start."""

    def __enter__(self):
        self._process = psutil.Process()
        self._start = self._process.memory_info().rss
        self._largest = self._start
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._watch)
        self._thread.start()
        return self

    def _watch(self):
        while not self._done.wait(0.002):
            self._largest = max(self._largest, self._process.memory_info().rss)

    def __exit__(self, *exception):
        self._done.set()
        self._thread.join()
        self.bytes = self._largest - self._start


def run_once(arguments):
    """Analyse in this process; return figures."""
    start = time.perf_counter()
    import wavelet_core

    assert wavelet_core.analyse  # whose modules are imported when it is first used
    imported = time.perf_counter() - start
    elevation = read_elevation(arguments.dem) if arguments.dem else fractal_terrain(arguments.size)
    n_rows, n_columns = elevation.shape
    mesh = wavelet_core.TriangleMesh.from_grid(
        elevation, x=np.arange(n_columns), y=np.arange(n_rows)[::-1]
    )
    options = {
        "partition": arguments.partition,
        "prediction": arguments.design,
        "signal": arguments.signal,
    }
    start = time.perf_counter()
    pyramid = wavelet_core.analyse(mesh, levels=arguments.levels, **options)
    first = time.perf_counter() - start
    seconds, cpu_seconds = [], []
    for _ in range(arguments.repeat):
        del pyramid
        with PeakMemory() as memory:
            start, cpu_start = time.perf_counter(), time.process_time()
            pyramid = wavelet_core.analyse(mesh, levels=arguments.levels, **options)
            seconds.append(time.perf_counter() - start)
            cpu_seconds.append(time.process_time() - cpu_start)
    start = time.perf_counter()
    finest = pyramid.synthesise()
    synthesis = time.perf_counter() - start
    error = float(np.abs(finest.vertices[:, 2] - mesh.vertices[:, 2]).max())
    return {
        "import_seconds": imported,
        "first_seconds": first,
        "warm_seconds": min(seconds),
        "warm_cpu_seconds": min(cpu_seconds),
        "synthesis_seconds": synthesis,
        "n_vertices": mesh.n_vertices,
        "n_coarse": pyramid.n_vertices(0),
        "n_levels": pyramid.n_levels,
        "peak_bytes_per_vertex": memory.bytes / mesh.n_vertices,
        "reconstruction_error": error,
    }


def run_in_new_process(arguments, cache_folder):
    """Return the figures of a process of its own, with compiled code kept in ``cache_folder``."""
    command = [sys.executable, __file__, "--worker", *arguments]
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache_folder}
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if run.returncode:
        sys.exit(run.stderr)
    return json.loads(run.stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, default=1000, help="rows and columns")
    parser.add_argument("--dem", help="a raster instead of the synthetic terrain")
    parser.add_argument("--design", default="GLMN")
    parser.add_argument("--partition", default="quadric")
    parser.add_argument("--signal", default="z", choices=["z", "xyz"])
    parser.add_argument("--levels", type=int, default=12)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--cold", action="store_true", help="also time the compilation")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.worker:
        print(json.dumps(run_once(arguments)))
        return
    passed_on = [word for word in sys.argv[1:] if word != "--cold"]
    with tempfile.TemporaryDirectory() as folder:
        cold = run_in_new_process(passed_on, folder)
        warm = run_in_new_process(passed_on, folder)
    print(
        f"{warm['n_vertices']:,} vertices, {arguments.design}, {arguments.partition}, signal "
        f"{arguments.signal}, {warm['n_levels']} levels down to {warm['n_coarse']:,}; "
        f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}"
    )
    print(f"import wavelet_core       {warm['import_seconds']:8.2f} s")
    print(f"analyse, warm             {warm['warm_seconds']:8.2f} s   best of {arguments.repeat}")
    print(f"                          {warm['warm_cpu_seconds']:8.2f} s   of processor time")
    print(f"analyse, new process      {warm['first_seconds']:8.2f} s   compiled code from the disk")
    if arguments.cold:
        print(f"analyse, first run ever   {cold['first_seconds']:8.2f} s   compiling included")
    print(f"synthesise                {warm['synthesis_seconds']:8.2f} s")
    print(f"peak memory of analyse    {warm['peak_bytes_per_vertex']:8.0f} bytes a vertex")
    print(f"reconstruction error      {warm['reconstruction_error']:8.1e} in the unit of z")


if __name__ == "__main__":
    main()
