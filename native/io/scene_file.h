// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shadow_layers/request.h"

namespace shadow_layers::io {

/// What a scene file holds, ready to be rendered.
struct SceneFile {
    std::shared_ptr<Scene> scene = std::make_shared<Scene>();
    Camera camera;
    int width = 1280, height = 720;  ///< full picture, pixels
    PixelRect region;                ///< empty = whole
    int samples = 1;
    PixelFilter filter;
    std::vector<LayerJob> jobs;                        ///< snapshots only; else empty
    std::vector<std::string> warnings;                 ///< what was left out or assumed, each once
    nlohmann::json source = nlohmann::json::object();  ///< where it comes from, as the file says
};

/// Options for files that lack something.
struct ReadOptions {
    std::string camera;  ///< glTF: name of the camera's node; empty = the first
};

/// Reads a snapshot (.npz), glTF 2.0 (.gltf, .glb) or OBJ (.obj) by its extension. A file without a camera gets one
/// that frames its bounds, one without lights a sun; both are named in the warnings.
/// Throws FileError naming file, member and remedy; InputError for a scene that is well written but wrong.
SceneFile read_scene_file(const std::filesystem::path& path, const ReadOptions& options = {});

SceneFile read_snapshot(const std::filesystem::path& path);
SceneFile read_gltf(const std::filesystem::path& path, const ReadOptions& options = {});
SceneFile read_obj(const std::filesystem::path& path);

/// Another picture size. Pixels keep their shape, and all that was seen stays in the picture: the window grows
/// in one direction, about its centre. The region becomes the whole.
void set_resolution(SceneFile& file, int width, int height);

}  // namespace shadow_layers::io
