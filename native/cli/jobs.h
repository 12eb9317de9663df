// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "cli/options.h"
#include "io/scene_file.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers::cli {

/// The value of a parameter as it was typed. InputError naming parameter, text and type.
ParameterValue parse_value(const std::string& technique, const ParameterSpec& spec, const std::string& text);

/// The lights asked for, as indices. InputError listing the file's lights for an unknown name.
std::vector<std::uint32_t> choose_lights(const io::SceneFile& file, const std::vector<std::string>& names);

/// The jobs of a render: lights by techniques, or the snapshot's own jobs where neither is given; with the parameters
/// of the snapshot under those of the command line, checked. Techniques that do not serve a light go to `warnings`.
/// InputError if none is left.
std::vector<LayerJob> make_jobs(const io::SceneFile& file, const Options& options, std::vector<std::string>& warnings);

/// The techniques that are offered to users, or those of the command line.
std::vector<std::string> choose_techniques(const Options& options);

/// All combinations of the values given by --set and --map-size for a technique (bench).
std::vector<ParameterValues> make_grid(const std::string& technique, const Options& options);

}  // namespace shadow_layers::cli
