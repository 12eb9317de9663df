// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/options.h"
#include "io/scene_file.h"
#include "shadow_layers/session.h"

namespace shadow_layers::cli {

// Each does all that was asked for, or throws an Error.
void run_render(const Options& options);
void run_bench(const Options& options);
void run_info(const Options& options);

/// The folder of the shaders: --shaders, then SHADOW_LAYERS_SHADERS, then beside the program, then the source tree.
/// FileError naming all that were tried.
std::string find_shader_dir(const Options& options);

SessionOptions make_session_options(const Options& options);

/// The file with --resolution, --samples and --camera applied; its warnings go to standard error.
io::SceneFile open_scene_file(const std::filesystem::path& path, const Options& options);

RenderRequest make_request(const io::SceneFile& file);

std::size_t count_triangles(const Scene& scene);

}  // namespace shadow_layers::cli
