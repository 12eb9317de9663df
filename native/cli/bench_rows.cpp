// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench_rows.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/describe.h"
#include "cli/jobs.h"
#include "cli/verbs.h"
#include "shadow_layers/error.h"

namespace shadow_layers::cli {
namespace {

constexpr const char* kReference = "sm";

nlohmann::json read_json(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw FileError("'" + path.string() + "' (--rows) cannot be read: is it there?");
    try {
        return nlohmann::json::parse(stream);
    } catch (const nlohmann::json::exception& error) {
        throw InputError("'" + path.string() + "' (--rows) is no JSON: " + error.what());
    }
}

ParameterValue convert_value(const std::string& id, const nlohmann::json& value) {
    if (value.is_boolean()) return value.get<bool>();
    if (value.is_number_integer()) return value.get<std::int64_t>();
    if (value.is_number()) return value.get<double>();
    if (value.is_string()) return value.get<std::string>();
    throw InputError("setting '" + id + "' is " + value.dump() + ", neither a number, a text nor true or false");
}

BenchRow convert_row(const nlohmann::json& entry) {
    if (!entry.is_object()) throw InputError("it is " + entry.dump() + ", not {\"technique\": ..., \"settings\": ...}");
    for (const auto& [key, value] : entry.items()) {
        if (key != "name" && key != "technique" && key != "settings")
            throw InputError("it has '" + key + "'; known are name, technique and settings");
    }
    if (!entry.contains("technique") || !entry["technique"].is_string()) throw InputError("it names no technique");
    BenchRow row;
    row.technique = entry["technique"].get<std::string>();
    const nlohmann::json settings = entry.value("settings", nlohmann::json::object());
    if (!settings.is_object()) throw InputError("its settings are " + settings.dump() + ", not {\"kernel\": 3, ...}");
    for (const auto& [id, value] : settings.items()) row.given.set(id, convert_value(id, value));
    if (entry.contains("name")) {
        if (!entry["name"].is_string()) throw InputError("its name is " + entry["name"].dump() + ", no text");
        row.name = entry["name"].get<std::string>();
    }
    return row;
}

std::vector<BenchRow> read_rows(const std::filesystem::path& path) {
    const nlohmann::json document = read_json(path);
    if (!document.is_array()) throw InputError("'" + path.string() + "' (--rows) is not a list of rows");
    std::vector<BenchRow> rows;
    for (const nlohmann::json& entry : document) {
        try {
            rows.push_back(convert_row(entry));
            BenchRow& row = rows.back();
            row.resolved = resolve_parameters(find_technique_descriptor(row.technique), row.given);
        } catch (const InputError& error) {
            throw InputError("'" + path.string() + "', row " + std::to_string(&entry - &document.front() + 1) + ": " +
                             error.what());
        }
    }
    return rows;
}

std::vector<BenchRow> make_grid_rows(const Options& options) {
    std::vector<BenchRow> rows;
    for (const std::string& id : choose_techniques(options)) {
        for (const ParameterValues& given : make_grid(id, options)) {
            BenchRow row;
            row.technique = id;
            row.given = given;
            row.resolved = resolve_parameters(find_technique_descriptor(id), given);
            rows.push_back(std::move(row));
        }
    }
    return rows;
}

}  // namespace

std::vector<BenchRow> make_bench_rows(const Options& options, const io::SceneFile& file,
                                      const std::vector<std::uint32_t>& lights) {
    std::vector<BenchRow> rows = options.rows.empty() ? make_grid_rows(options) : read_rows(options.rows);
    for (BenchRow& row : rows) {
        const std::vector<LightKind>& served = find_technique_descriptor(row.technique).lights;
        if (row.name.empty()) row.name = row.given.all().empty() ? "defaults" : parameters_to_json(row.given).dump();
        row.request = make_request(file);
        row.request.combined = false;
        for (const std::uint32_t light : lights) {
            if (std::find(served.begin(), served.end(), file.scene->lights[light].kind) != served.end())
                row.request.jobs.push_back({light, row.technique, row.given});
        }
    }
    std::erase_if(rows, [](const BenchRow& row) { return row.request.jobs.empty(); });
    if (rows.empty()) throw InputError("there is nothing to measure: no technique serves any of the lights");
    return rows;
}

const BenchRow* find_reference_row(const std::vector<BenchRow>& rows, const BenchRow& row) {
    const BenchRow* first = nullptr;
    for (const BenchRow& other : rows) {
        if (other.technique != kReference || other.request.jobs.size() != row.request.jobs.size()) continue;
        const auto mine = row.resolved.all().find("map_size"), its = other.resolved.all().find("map_size");
        if (mine != row.resolved.all().end() && its != other.resolved.all().end() && mine->second == its->second)
            return &other;
        if (!first) first = &other;
    }
    return first;
}

std::vector<double> compute_ratios(const std::vector<double>& row_ms, const std::vector<double>& reference_ms) {
    std::vector<double> ratios;
    for (std::size_t round = 0; round < std::min(row_ms.size(), reference_ms.size()); ++round) {
        if (reference_ms[round] > 0) ratios.push_back(row_ms[round] / reference_ms[round]);
    }
    return ratios;
}

}  // namespace shadow_layers::cli
