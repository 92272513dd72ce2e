// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/monitor.h"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "bindings.h"

namespace isograft::bindings {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds signal_period{50};
constexpr milliseconds repeat_period{50};

struct Progress {
    std::string stage;
    double fraction = 0.0;
};

/// What the working thread leaves for the calling one.
struct Mailbox {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<Progress> reports;
    bool finished = false;
};

/// Calls Python; on the calling thread with the interpreter's lock held only.
class Listener {
  public:
    Listener(const py::object& progress, Monitor& monitor) : progress_(progress), monitor_(monitor) {}

    /// Look for signals, then pass the reports on. After a request to stop nothing more is passed on.
    void serve(const std::deque<Progress>& reports) {
        if (stopped()) return;
        if (PyErr_CheckSignals() != 0) {
            error_ = std::make_exception_ptr(py::error_already_set());
            monitor_.cancel();
            return;
        }
        if (progress_.is_none()) return;
        const auto now = std::chrono::steady_clock::now();
        for (const Progress& report : reports) call(report);
        if (!reports.empty()) {
            last_ = reports.back();
            last_call_ = now;
        } else if (!last_.stage.empty() && now - last_call_ >= repeat_period) {
            call(last_);
            last_call_ = now;
        }
    }

    [[nodiscard]] bool stopped() const { return monitor_.cancelled(); }

    /// \throw what a callback or a signal handler raised, else Cancelled if one asked to stop.
    void rethrow() const {
        if (error_) std::rethrow_exception(error_);
        if (stopped()) throw Cancelled();
    }

  private:
    void call(const Progress& report) {
        if (stopped()) return;
        try {
            const py::object answer = progress_(report.stage, report.fraction);
            if (answer.is(py::bool_(false))) monitor_.cancel();
        } catch (...) {
            error_ = std::current_exception();
            monitor_.cancel();
        }
    }

    py::object progress_;
    Monitor& monitor_;
    Progress last_;
    std::chrono::steady_clock::time_point last_call_;
    std::exception_ptr error_;
};

}  // namespace

void run_with_progress(const py::object& progress, const std::function<void(Monitor&)>& work) {
    Mailbox mailbox;
    Monitor monitor([&mailbox](const std::string& stage, double fraction) {
        const std::lock_guard lock(mailbox.mutex);
        // A slow listener gets the newest word of every stage, not a backlog.
        if (!mailbox.reports.empty() && mailbox.reports.back().stage == stage) mailbox.reports.pop_back();
        mailbox.reports.push_back({stage, fraction});
        mailbox.changed.notify_one();
        return true;
    });
    Listener listener(progress, monitor);

    std::exception_ptr failure;
    std::thread worker([&] {
        try {
            work(monitor);
        } catch (...) {
            failure = std::current_exception();
        }
        const std::lock_guard lock(mailbox.mutex);
        mailbox.finished = true;
        mailbox.changed.notify_one();
    });

    for (bool finished = false; !finished;) {
        std::deque<Progress> reports;
        {
            const py::gil_scoped_release release;
            std::unique_lock lock(mailbox.mutex);
            mailbox.changed.wait_for(lock, signal_period, [&] { return mailbox.finished || !mailbox.reports.empty(); });
            reports.swap(mailbox.reports);
            finished = mailbox.finished;
        }
        listener.serve(reports);
    }
    {
        const py::gil_scoped_release release;
        worker.join();
    }
    listener.rethrow();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace isograft::bindings
