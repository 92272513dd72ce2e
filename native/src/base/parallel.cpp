// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

namespace isograft {

int worker_count(int requested) {
    if (requested > 0) return requested;
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

namespace {

struct Failure {
    std::mutex mutex;
    int index = std::numeric_limits<int>::max();
    std::exception_ptr exception;

    void note(int at) {
        const std::lock_guard lock(mutex);
        if (at >= index) return;
        index = at;
        exception = std::current_exception();
    }
};

}  // namespace

void parallel_for(int count, int threads, const std::function<void(int index, int worker)>& task, Monitor& monitor,
                  const char* stage, double from, double to) {
    std::atomic<int> next{0};
    std::atomic<bool> stop{false};
    Failure failure;
    const auto work = [&](int worker) {
        while (!stop.load(std::memory_order_relaxed)) {
            const int i = next.fetch_add(1, std::memory_order_relaxed);
            if (i >= count) return;
            try {
                monitor.check();
                task(i, worker);
                if (worker == 0) monitor.report(stage, from + (to - from) * i / count);
            } catch (...) {
                failure.note(i);
                stop.store(true, std::memory_order_relaxed);
            }
        }
    };
    std::vector<std::thread> others;
    const int workers = std::min(worker_count(threads), std::max(1, count));
    for (int w = 1; w < workers; ++w) others.emplace_back(work, w);
    work(0);
    for (auto& thread : others) thread.join();
    if (failure.exception) std::rethrow_exception(failure.exception);
    monitor.report(stage, to);
}

}  // namespace isograft
