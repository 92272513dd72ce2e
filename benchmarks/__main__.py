# SPDX-License-Identifier: GPL-3.0-or-later
"""Run the chosen pairs; print, keep and sum up what comes back."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from benchmarks.children import run_child, stop_children
from benchmarks.options import Options, parse_options, requests_of
from benchmarks.results import Results


def run(options: Options) -> int:
    requests = requests_of(options)
    results = Results(options.output, options.described())
    logs = options.output / "logs"
    logs.mkdir(parents=True, exist_ok=True)
    print(f"{len(requests)} runs, results in {options.output}", flush=True)
    with ThreadPoolExecutor(options.jobs) as pool:
        futures = {pool.submit(run_child, request, options.limit, logs): request for request in requests}
        try:
            for future in as_completed(futures):
                row = future.result()
                if row["status"] != "skipped":
                    results.add(row)
        except KeyboardInterrupt:
            for future in futures:
                future.cancel()
            stop_children()
            print("stopped; the rows so far are kept", file=sys.stderr)
            return 130
        finally:
            results.write()
    print()
    print(results.summary())
    print(f"\n{options.output / 'results.md'}, {options.output / 'results.json'}")
    return 0


if __name__ == "__main__":
    sys.exit(run(parse_options(sys.argv[1:], Path(__file__).resolve().parent.parent)))
