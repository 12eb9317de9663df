// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "edge_map.h"
#include "engine/engine.h"

namespace shadow_layers {

/// Draws a quad along each edge with the program in use, whose vertex shader is "stages/edge_quads.vert", in the
/// order of the list. Long lists are cut, with cancel checks between the draws.
void draw_edge_quads(Engine& engine, const std::vector<MapEdge>& edges, const DrawState& state);

}  // namespace shadow_layers
