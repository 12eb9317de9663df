// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/scene_file.h"

#include <algorithm>
#include <cctype>

#include "shadow_layers/error.h"

namespace shadow_layers::io {

SceneFile read_scene_file(const std::filesystem::path& path, const ReadOptions& options) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    std::error_code failure;
    if (!std::filesystem::exists(path, failure)) {
        throw FileError("'" + path.string() + "': no such file" + (failure ? " (" + failure.message() + ")" : ""));
    }
    if (std::filesystem::is_directory(path)) throw FileError("'" + path.string() + "' is a folder, not a scene file");
    if (extension == ".npz") return read_snapshot(path);
    if (extension == ".gltf" || extension == ".glb") return read_gltf(path, options);
    if (extension == ".obj") return read_obj(path);
    throw FileError("'" + path.string() + "': unknown kind of file '" + extension +
                    "'; give a snapshot (.npz), glTF 2.0 (.gltf, .glb) or OBJ (.obj)");
}

void set_resolution(SceneFile& file, int width, int height) {
    CameraWindow& window = file.camera.window;
    const double window_width = window.right - window.left, window_height = window.top - window.bottom;
    const double pixel_width = window_width / file.width, pixel_height = window_height / file.height;
    const double scale = std::max(window_width / (pixel_width * width), window_height / (pixel_height * height));
    const double half_width = 0.5 * scale * pixel_width * width, half_height = 0.5 * scale * pixel_height * height;
    const double x = 0.5 * (window.left + window.right), y = 0.5 * (window.bottom + window.top);
    window = {x - half_width, x + half_width, y - half_height, y + half_height};
    file.width = width;
    file.height = height;
    file.region = {};
}

}  // namespace shadow_layers::io
