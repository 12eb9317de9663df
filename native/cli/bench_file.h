// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>

#include "cli/bench_rays.h"
#include "cli/bench_rows.h"
#include "cli/progress.h"
#include "io/scene_file.h"
#include "shadow_layers/session.h"

namespace shadow_layers::cli {

/// Lets another thread end the benchmark, whichever session it uses at the time.
class BenchStop {
public:
    void request();
    void watch(Session* session);  ///< null: none
    void check() const;            ///< throws Cancelled
    const std::atomic<bool>& flag() const { return requested_; }

private:
    std::atomic<bool> requested_{false};
    std::mutex mutex_;
    Session* session_ = nullptr;
};

/// The benchmark of one scene file: its rows, rendered in turns.
class FileBench {
public:
    /// Reads the file and makes the rows. FileError, InputError.
    FileBench(const Options& options, const std::filesystem::path& path, BenchStop& stop);
    ~FileBench();

    /// Times all rows, round by round, then measures their errors if asked for. Throws Cancelled.
    void run(Progress& progress, double fraction_start, double fraction_end);

    const std::filesystem::path& path() const { return path_; }
    const io::SceneFile& file() const { return file_; }
    const std::vector<BenchRow>& rows() const { return rows_; }
    /// Embree's, if they were asked for.
    const RayBench* rays() const { return rays_.get(); }
    std::size_t light_count() const { return light_count_; }
    const SessionInfo& info() const { return info_; }

private:
    void open_session();
    void close_session();
    RenderRequest make_next_request(const BenchRow& row);
    void render(BenchRow& row, bool counts);

    const Options& options_;
    std::filesystem::path path_;
    BenchStop& stop_;
    io::SceneFile file_;
    std::size_t light_count_ = 0;
    std::vector<BenchRow> rows_;
    std::unique_ptr<Session> session_;
    std::unique_ptr<RayBench> rays_;
    SessionInfo info_;
    int step_ = 0;
};

}  // namespace shadow_layers::cli
