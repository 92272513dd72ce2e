# SPDX-License-Identifier: GPL-3.0-or-later
"""Run the chosen pairs; print, keep and sum up what comes back."""

from __future__ import annotations

import signal
import sys
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from benchmarks import cancelling, composing, scaling
from benchmarks.children import run_child, stop_children
from benchmarks.options import Options, largest_first, parse_options, requests_of
from benchmarks.results import Results


def run(options: Options) -> int:
    results = Results(options.output, options.described(), order=options.order, fresh=options.fresh)
    aside = results.set_aside(options.builds, options.settings)
    if aside:
        print(f"{aside} rows of another build or with other settings are set aside")
    asked = requests_of(options)
    requests = [request for request in asked if not results.has(request)]
    if options.jobs > 1:
        requests = largest_first(requests)
    logs = options.output / "logs"
    for folder in (logs, options.output / "maps"):
        folder.mkdir(parents=True, exist_ok=True)
    print(
        f"{len(requests)} runs, {len(asked) - len(requests)} measured already; results in {options.output}", flush=True
    )
    # Ended from outside it takes its children along, as on Ctrl-C.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
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


def main(arguments: list[str]) -> int:
    root = Path(__file__).resolve().parent.parent
    if "--cancel" in arguments:
        return cancelling.main([argument for argument in arguments if argument != "--cancel"], root)
    if "--compose" in arguments:
        return composing.main([argument for argument in arguments if argument != "--compose"], root)
    if "--scaling" in arguments:
        return scaling.main([argument for argument in arguments if argument != "--scaling"], root)
    return run(parse_options(arguments, root))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
