// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "cli/bench_file.h"

namespace shadow_layers::cli {

/// The table of a finished benchmark, on standard output.
void print_bench(const FileBench& bench, const Options& options);

/// One record per row: settings, spread of the times, by stage too, ratios to sm, counters, errors.
nlohmann::json bench_to_json(const FileBench& bench);

/// One record for each way that Embree was asked; empty without --rays.
nlohmann::json rays_to_json(const FileBench& bench);

}  // namespace shadow_layers::cli
