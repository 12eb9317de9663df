// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Why edsm's wrong pixels are wrong, as a Markdown table (tests/support/edsm_causes.h says what they mean):
//
//     edsm_causes SCENE.npz ... [--map-size 1024,512] [--resolution 1280x720]
//
// Per scene and map size, over all lights: wrong pixels in a million of those that the casters decide, and how many of
// them have each cause.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "io/scene_file.h"
#include "support/edsm_examiner.h"

using namespace shadow_layers;
using namespace shadow_layers::testing;

namespace {

struct Options {
    std::vector<std::string> files;
    std::vector<std::int64_t> map_sizes;
    int width = 1280, height = 720;
};

/// Part of the wrong pixels that the replay may not find wrong: roundings.
constexpr double kMostNotReplayed = 0.01;

[[noreturn]] void stop(const std::string& text) {
    std::fprintf(stderr, "edsm_causes: %s\n", text.c_str());
    std::exit(2);
}

Options read_options(int count, char** words) {
    Options options;
    std::string sizes = "1024,512";
    for (int k = 1; k < count; ++k) {
        const std::string word = words[k];
        if (word.rfind("--", 0) != 0) {
            options.files.push_back(word);
            continue;
        }
        if (k + 1 >= count) stop("\"" + word + "\" needs a value or is not known");
        const std::string value = words[++k];
        if (word == "--map-size")
            sizes = value;
        else if (word != "--resolution")
            stop("\"" + word + "\" is not known");
        else if (std::sscanf(value.c_str(), "%dx%d", &options.width, &options.height) != 2)
            stop("\"" + value + "\" is not WIDTHxHEIGHT");
    }
    std::istringstream list(sizes);
    for (std::string size; std::getline(list, size, ',');) {
        options.map_sizes.push_back(std::atoi(size.c_str()));
        if (options.map_sizes.back() < 1) stop("\"" + size + "\" is no map size");
    }
    if (options.files.empty()) stop("no scene is given");
    return options;
}

EDSMCauses add_up(TechniqueRunner& runner, const SceneView& view, std::int64_t map_size) {
    const truth::RayOracle oracle(view.scene);
    EDSMCauses sum;
    for (std::size_t light = 0; light < view.scene->lights.size(); ++light)
        sum += count_edsm_causes(runner, view, oracle, parameters({{"map_size", map_size}}), light);
    return sum;
}

void print_row(const std::string& scene, std::int64_t map_size, const EDSMCauses& causes) {
    const double scale = 1e6 / double(std::max<std::size_t>(1, causes.compared));
    std::printf("| %s | %lld | %.0f |", scene.c_str(), static_cast<long long>(map_size), double(causes.wrong) * scale);
    for (const std::size_t part : causes.by_cause) std::printf(" %.0f |", double(part) * scale);
    std::printf("\n");
    if (causes.not_replayed)
        std::fprintf(stderr, "%s, %lld: %zu of %zu wrong pixels are not wrong in the replay\n", scene.c_str(),
                     static_cast<long long>(map_size), causes.not_replayed, causes.wrong);
    std::fflush(stdout);
}

}  // namespace

int main(int count, char** words) {
    const Options options = read_options(count, words);
    std::printf("| scene | map | wrong |");
    for (int k = 0; k < kEDSMCauseCount; ++k) std::printf(" %s |", get_name(EDSMCause(k)));
    std::printf("\n|");
    for (int k = 0; k < 3 + kEDSMCauseCount; ++k) std::printf(" --- |");
    std::printf("\n");
    TechniqueRunner runner;
    bool is_replayed = true;
    for (const std::string& file : options.files) {
        io::SceneFile read = io::read_scene_file(file);
        io::set_resolution(read, options.width, options.height);
        SceneView view;
        view.scene = read.scene, view.camera = read.camera;
        view.width = read.width, view.height = read.height;
        const std::string name = std::filesystem::path(file).stem().string();
        for (const std::int64_t size : options.map_sizes) {
            const EDSMCauses causes = add_up(runner, view, size);
            print_row(name, size, causes);
            is_replayed = is_replayed && double(causes.not_replayed) <= kMostNotReplayed * double(causes.wrong) + 2;
        }
    }
    if (!is_replayed) stop("the replay is not the technique: its causes are not to be believed");
    return 0;
}
