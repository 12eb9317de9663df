// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shadow_layers::cli {

enum class Verb { Render, Bench, Info };

/// How a benchmark treats what is kept between frames.
enum class BenchMode { Frame, Warm, Cold };

struct Size {
    int width = 0, height = 0;
};

/// --set TECHNIQUE.PARAMETER=VALUE[,VALUE…]
struct Setting {
    std::string technique, parameter;
    std::vector<std::string> values;
    std::string text;  ///< as typed
};

/// The command line, checked as far as it can be without the files.
struct Options {
    Verb verb = Verb::Info;
    std::vector<std::filesystem::path> files;
    std::vector<std::string> techniques;  ///< empty: the snapshot's jobs, or all
    std::vector<std::string> lights;      ///< empty: all
    std::vector<Setting> settings;
    std::vector<int> map_sizes;
    std::optional<Size> resolution;
    std::optional<int> samples;
    std::string camera;
    std::filesystem::path out = "shadow_layers";
    std::filesystem::path json;
    std::string backend = "auto";
    int threads = 0;
    std::string shaders;
    bool debug = false;
    int repeat = 7, warm_up = 1;
    BenchMode mode = BenchMode::Frame;
    std::filesystem::path rows;  ///< bench: file of rows, in place of techniques, settings and map sizes
    bool errors = false;         ///< bench: compare with exact shadows too
    bool bits = false;           ///< bench: count the wrong bits of soft layers too
    bool rays = false;           ///< bench: time Embree's shadow rays too
};

/// Parses argv. Prints help, version or what is wrong and returns the exit code instead, where nothing is to be done.
std::optional<int> parse_options(int argc, char** argv, Options& options);

}  // namespace shadow_layers::cli
