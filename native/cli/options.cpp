// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/options.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <sstream>

#include "cli/describe.h"
#include "shadow_layers/error.h"
#include "shadow_layers/session.h"

namespace shadow_layers::cli {
namespace {

constexpr int kUsageError = 2;

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, separator);) {
        if (!part.empty()) parts.push_back(part);
    }
    return parts;
}

int parse_whole(const std::string& text, int min, int max, const std::string& what) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value < min || value > max) {
        throw CLI::ValidationError(
            what, "'" + text + "' is no whole number from " + std::to_string(min) + " to " + std::to_string(max));
    }
    return value;
}

Size parse_size(const std::string& text) {
    const std::size_t cross = text.find('x');
    if (cross == std::string::npos)
        throw CLI::ValidationError("--resolution", "'" + text + "' is not WIDTHxHEIGHT, as 1280x720");
    return {parse_whole(text.substr(0, cross), 1, 1 << 20, "--resolution"),
            parse_whole(text.substr(cross + 1), 1, 1 << 20, "--resolution")};
}

Setting parse_setting(const std::string& text) {
    const std::size_t dot = text.find('.'), equals = text.find('=');
    if (dot == std::string::npos || equals == std::string::npos || dot == 0 || dot > equals || equals == dot + 1) {
        throw CLI::ValidationError("--set",
                                   "'" + text + "' sets nothing: write TECHNIQUE.PARAMETER=VALUE, as pcf.kernel=5");
    }
    Setting setting{text.substr(0, dot), text.substr(dot + 1, equals - dot - 1), split(text.substr(equals + 1), ','),
                    text};
    if (setting.values.empty()) throw CLI::ValidationError("--set", "'" + text + "' has no value after the '='");
    return setting;
}

// What was typed, before it is made of use.
struct Raw {
    std::vector<std::string> files, techniques, settings, map_sizes;
    std::string resolution, mode = "frame";
};

void add_session_options(CLI::App& verb, Options& options) {
    verb.add_option("--backend", options.backend, "where the maps are drawn: auto, osmesa or egl")
        ->check(CLI::IsMember({"auto", "osmesa", "egl"}))
        ->type_name("NAME");
    verb.add_option("--threads", options.threads, "CPU threads; 0 = all cores")
        ->check(CLI::Range(0, 1024))
        ->type_name("N");
    verb.add_option(
            "--shaders", options.shaders,
            "folder of the shaders (default: SHADOW_LAYERS_SHADERS, then beside the program, then the source tree)")
        ->type_name("DIR");
    verb.add_flag("--debug", options.debug, "GL debug output; an error ends the render");
}

void add_scene_options(CLI::App& verb, Options& options, Raw& raw) {
    verb.add_option("--techniques", raw.techniques,
                    "ids with commas, as sm,edsm (default: the snapshot's jobs, else all)")
        ->type_name("ID,ID")
        ->delimiter(',');
    verb.add_option("--lights", options.lights, "names of lights (default: all)")->type_name("NAME")->expected(1, -1);
    verb.add_option("--map-size", raw.map_sizes, "side of the shadow maps, in texels; bench takes several, with commas")
        ->type_name("N")
        ->delimiter(',');
    verb.add_option("--resolution", raw.resolution, "picture size (default: the file's)")->type_name("WxH");
    verb.add_option("--samples", options.samples, "per pixel, 1 to 64; 1 = the pixel's centre (default: the file's)")
        ->check(CLI::Range(1, 64))
        ->type_name("N");
    verb.add_option(
            "--set", raw.settings,
            "parameter P of technique T, as pcf.kernel=5; may be repeated; bench takes several values, with commas")
        ->type_name("T.P=V")
        ->expected(1)
        ->take_all();
    verb.add_option("--camera", options.camera, "glTF: name of the camera (default: the first)")->type_name("NAME");
}

void convert(const Raw& raw, Options& options) {
    for (const std::string& file : raw.files) options.files.emplace_back(file);
    for (const std::string& id : raw.techniques) {
        find_technique_descriptor(id);  // InputError lists the known ones
        if (std::find(options.techniques.begin(), options.techniques.end(), id) == options.techniques.end()) {
            options.techniques.push_back(id);
        }
    }
    for (const std::string& text : raw.settings) options.settings.push_back(parse_setting(text));
    for (const std::string& text : raw.map_sizes)
        options.map_sizes.push_back(parse_whole(text, 1, 1 << 20, "--map-size"));
    if (!raw.resolution.empty()) options.resolution = parse_size(raw.resolution);
    if (options.verb == Verb::Render && options.files.size() > 1) {
        throw CLI::ValidationError("FILE", "render takes one file, not '" + raw.files[1] + "' too");
    }
    if (options.verb != Verb::Bench) {
        for (const Setting& setting : options.settings) {
            if (setting.values.size() > 1)
                throw CLI::ValidationError("--set", "'" + setting.text + "': several values are for bench");
        }
        if (options.map_sizes.size() > 1) throw CLI::ValidationError("--map-size", "several sizes are for bench");
    }
    if (!options.rows.empty() && (!raw.techniques.empty() || !raw.settings.empty() || !raw.map_sizes.empty())) {
        throw CLI::ValidationError("--rows",
                                   "names techniques and settings itself: leave --techniques, --set and --map-size");
    }
    options.mode = raw.mode == "warm" ? BenchMode::Warm : raw.mode == "cold" ? BenchMode::Cold : BenchMode::Frame;
}

}  // namespace

std::optional<int> parse_options(int argc, char** argv, Options& options) {
    CLI::App app(
        "Shadows of every light as image layers, without Blender.\nReads snapshots (.npz), glTF 2.0 (.gltf, .glb) "
        "and OBJ (.obj).",
        "shadowcore");
    app.require_subcommand(1);
    app.set_version_flag("--version", std::string(version()) + " (" + revision() + ")");
    app.footer(
        "Exit code 0: everything asked for was written. 1: it was not, and the last line says why. 2: the command "
        "line is wrong.\n\n" +
        describe_techniques());
    Raw raw;

    CLI::App& render = *app.add_subcommand("render", "layers of a file to EXR and PNG");
    render.add_option("FILE", raw.files, "scene file")->required()->expected(1, -1)->type_name("");
    add_scene_options(render, options, raw);
    render.add_option("--out", options.out, "folder (default: shadow_layers)")->type_name("DIR");
    render.add_option("--json", options.json, "the list of results (default: render.json in DIR)")->type_name("FILE");
    add_session_options(render, options);

    CLI::App& bench = *app.add_subcommand("bench", "times of each technique by stage: medians, spread and ratio to sm");
    bench.add_option("FILE", raw.files, "scene files")->required()->expected(1, -1)->type_name("");
    add_scene_options(bench, options, raw);
    bench.add_option("--repeat", options.repeat, "timed renders of each setting (default: 7)")
        ->check(CLI::Range(1, 10000))
        ->type_name("N");
    bench.add_option("--warm-up", options.warm_up, "renders before those that count (default: 1)")
        ->check(CLI::Range(0, 1000))
        ->type_name("N");
    bench
        .add_option(
            "--caches", raw.mode,
            "frame: meshes stay, camera and lights move a trifle each time, as in an animation (default); warm: the "
            "same frame again; cold: a fresh session each time, shaders compiled within the time")
        ->check(CLI::IsMember({"frame", "warm", "cold"}))
        ->type_name("MODE");
    bench
        .add_option("--rows", options.rows,
                    "JSON list of {\"technique\": ID, \"settings\": {P: V}, \"name\": TEXT}, in place of "
                    "--techniques, --set and --map-size")
        ->type_name("FILE");
    bench.add_flag("--errors", options.errors, "measure each row against exact shadows too (rays, by Embree)");
    bench.add_flag(
        "--bits", options.bits,
        "count what each soft row gets wrong of its pixels' light samples, by rays in double to the same ones");
    bench.add_flag(
        "--rays", options.rays,
        "time Embree too, in the same rounds: its scene's build and its shadow rays, one place a pixel, to as "
        "many samples of the light as the row with most takes");
    bench.add_option("--json", options.json, "the records")->type_name("FILE");
    add_session_options(bench, options);

    CLI::App& info = *app.add_subcommand("info", "version, GL renderer, limits, techniques with their parameters");
    info.add_option("--json", options.json, "the same as JSON")->type_name("FILE");
    add_session_options(info, options);

    try {
        const std::string first = argc > 1 ? argv[1] : "";
        if (!first.empty() && first[0] != '-' && first != "render" && first != "bench" && first != "info") {
            throw CLI::ValidationError("VERB", "'" + first + "' is none of render, bench and info");
        }
        app.parse(argc, argv);
        options.verb = render.parsed() ? Verb::Render : bench.parsed() ? Verb::Bench : Verb::Info;
        convert(raw, options);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : kUsageError;
    }
    return std::nullopt;
}

}  // namespace shadow_layers::cli
