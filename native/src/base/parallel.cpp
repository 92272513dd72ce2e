// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
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

constexpr std::chrono::milliseconds patience{50};

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

// Every task adds `part` to the progress.
void run(int count, int threads, const std::function<void(int index, int worker)>& task, Monitor& monitor,
         double part) {
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
                monitor.add(part);
            } catch (...) {
                failure.note(i);
                stop.store(true, std::memory_order_relaxed);
            }
        }
    };
    std::mutex mutex;
    std::condition_variable ended;
    const int others = std::min(worker_count(threads), std::max(1, count)) - 1;
    int running = others;
    std::vector<std::thread> helpers;
    for (int w = 1; w <= others; ++w) {
        helpers.emplace_back([&, w] {
            work(w);
            const std::lock_guard lock(mutex);
            --running;
            ended.notify_one();
        });
    }
    work(0);
    // The others' progress is told from here too.
    for (bool waiting = true; waiting;) {
        {
            std::unique_lock lock(mutex);
            waiting = !ended.wait_for(lock, patience, [&] { return running == 0; });
        }
        try {
            monitor.check();
        } catch (...) {
            failure.note(count);
            stop.store(true, std::memory_order_relaxed);
        }
    }
    for (auto& helper : helpers) helper.join();
    if (failure.exception) std::rethrow_exception(failure.exception);
}

}  // namespace

void parallel_for(int count, int threads, const std::function<void(int index, int worker)>& task, Monitor& monitor,
                  const char* stage, double from, double to) {
    monitor.report(stage, from);
    run(count, threads, task, monitor, (to - from) / std::max(1, count));
    monitor.report(stage, to);
}

void parallel_for(int count, int threads, const std::function<void(int index, int worker)>& task, Monitor& monitor) {
    run(count, threads, task, monitor, 0.0);
}

}  // namespace isograft
