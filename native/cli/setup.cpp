// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// What the verbs have in common.
#include <cstdio>
#include <cstdlib>

#include "cli/verbs.h"
#include "shadow_layers/error.h"

namespace shadow_layers::cli {
namespace {

namespace fs = std::filesystem;

bool is_shader_dir(const fs::path& folder) {
    std::error_code ignored;
    return fs::is_directory(folder / "shared", ignored);
}

}  // namespace

std::string find_shader_dir(const Options& options) {
    // One that was asked for is used or refused, never silently replaced.
    const char* variable = std::getenv("SHADOW_LAYERS_SHADERS");
    const std::string asked = !options.shaders.empty() ? options.shaders : variable ? variable : "";
    if (!asked.empty()) {
        if (is_shader_dir(asked)) return asked;
        throw FileError("the shader folder '" + asked + "' (" +
                        (options.shaders.empty() ? "SHADOW_LAYERS_SHADERS" : "--shaders") +
                        ") does not exist, or holds no shaders (no folder 'shared' in it)");
    }
    std::error_code ignored;
    const fs::path beside = fs::read_symlink("/proc/self/exe", ignored).parent_path();
    const fs::path places[] = {beside / "shaders", beside / ".." / "share" / "shadow_layers" / "shaders",
                               SHADOW_LAYERS_SOURCE_SHADERS};
    std::string tried;
    for (const fs::path& place : places) {
        if (is_shader_dir(place)) return place.string();
        tried += "\n  " + place.string();
    }
    throw FileError("no folder of shaders was found; give one with --shaders. Tried:" + tried);
}

SessionOptions make_session_options(const Options& options) {
    SessionOptions session;
    session.backend = options.backend;
    session.threads = options.threads;
    session.shader_dir = find_shader_dir(options);
    session.debug = options.debug;
    return session;
}

io::SceneFile open_scene_file(const fs::path& path, const Options& options) {
    io::SceneFile file = io::read_scene_file(path, {options.camera});
    if (options.resolution) io::set_resolution(file, options.resolution->width, options.resolution->height);
    if (options.samples) file.samples = *options.samples;
    for (const std::string& warning : file.warnings) {
        std::fprintf(stderr, "warning: %s: %s\n", path.filename().c_str(), warning.c_str());
    }
    return file;
}

RenderRequest make_request(const io::SceneFile& file) {
    RenderRequest request;
    request.scene = file.scene;
    request.camera = file.camera;
    request.width = file.width;
    request.height = file.height;
    request.region = file.region;
    request.samples = file.samples;
    request.filter = file.filter;
    return request;
}

std::size_t count_triangles(const Scene& scene) {
    std::size_t count = 0;
    for (const Instance& instance : scene.instances) count += scene.meshes[instance.mesh]->triangles.size();
    return count;
}

}  // namespace shadow_layers::cli
