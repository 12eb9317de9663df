// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Times of each technique with each setting, on all chosen lights, and how far they are from exact shadows.
#include "cli/bench_errors.h"
#include "cli/bench_file.h"
#include "cli/bench_report.h"
#include "cli/describe.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/verbs.h"
#include "io/whole_file.h"
#include "shadow_layers/error.h"

namespace shadow_layers::cli {
namespace {

const char* mode_name(BenchMode mode) {
    return mode == BenchMode::Warm ? "warm" : mode == BenchMode::Cold ? "cold" : "frame";
}

// Said before hours of measuring, not after.
void check_output(const std::filesystem::path& path) {
    if (!path.empty()) io::TemporaryFile{path};  // removed at once
}

}  // namespace

void run_bench(const Options& options) {
    if ((options.errors || options.bits) && !can_measure_errors())
        throw InputError(
            "--errors, --bits: this shadowcore was built without Embree; build it with SHADOW_LAYERS_EMBREE=ON");
    check_output(options.json);
    nlohmann::json document = nlohmann::json::object(), records = nlohmann::json::array(),
                   rays = nlohmann::json::array();
    const HeldSignals signals;
    BenchStop stop;
    const Interrupt interrupt(signals, [&] { stop.request(); });
    Progress progress;
    const double share = 1.0 / double(options.files.size());
    for (std::size_t i = 0; i < options.files.size(); ++i) {
        FileBench bench(options, options.files[i], stop);
        bench.run(progress, double(i) * share, double(i + 1) * share);
        progress.clear();
        print_bench(bench, options);
        if (i == 0) {
            document = versions_to_json(bench.info());
            document["threads"] = bench.info().threads;
        }
        for (auto& record : bench_to_json(bench)) records.push_back(std::move(record));
        for (auto& record : rays_to_json(bench)) rays.push_back(std::move(record));
    }
    document["schema"] = "shadow-layers-bench";
    document["schema_version"] = 2;
    document["caches"] = mode_name(options.mode);
    document["warm_up"] = options.warm_up;
    document["repeat"] = options.repeat;
    document["records"] = std::move(records);
    document["rays"] = std::move(rays);
    if (!options.json.empty()) io::write_whole_file(options.json, document.dump(1) + "\n");
}

}  // namespace shadow_layers::cli
