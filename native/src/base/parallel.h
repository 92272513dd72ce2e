// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "isograft/monitor.h"

namespace isograft {

/// Number of workers for `requested` threads; 0 means all cores.
int worker_count(int requested);

/// Call task(index, worker) for every index in [0, count), on up to `threads` workers.
///
/// Each index runs once, in any order: results go into slots of their own and are reduced in index order by the caller,
/// so that they do not depend on the number of threads. The calling thread is worker 0 and reports progress,
/// [from, to] of the call's whole, to `monitor` under the name `stage`.
/// An exception in a task ends the loop; the one of the lowest index that ran is passed on.
/// \throw Cancelled if `monitor` asks for it.
void parallel_for(int count, int threads, const std::function<void(int index, int worker)>& task, Monitor& monitor,
                  const char* stage, double from, double to);

/// The same without a part of the progress of its own, so that a task of parallel_for() may call it.
void parallel_for(int count, int threads, const std::function<void(int index, int worker)>& task, Monitor& monitor);

}  // namespace isograft
