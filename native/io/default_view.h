// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/scene_file.h"

namespace shadow_layers::io {

/// Axis-aligned bounds of all instances in world space; finite vertices only.
struct WorldBounds {
    glm::dvec3 low{0.0}, high{0.0};
    bool empty = true;
    glm::dvec3 centre() const { return 0.5 * (low + high); }
    double radius() const { return 0.5 * glm::length(high - low); }
};
WorldBounds compute_world_bounds(const Scene& scene);

/// For files without a camera: looks at the bounds from above and aside, +Y up, so that their sphere just fits.
void add_default_camera(SceneFile& file);

/// For files without a light: a sun from over the viewer's left shoulder.
void add_default_light(SceneFile& file);

/// A rigid frame: the axes of `matrix` made orthonormal (its -Z kept, then its Y). False if they are degenerate.
bool make_rigid(glm::dmat4& matrix);

/// A rigid frame at `eye` whose -Z points to `target`, +Y up.
glm::dmat4 look_at(const glm::dvec3& eye, const glm::dvec3& target);

}  // namespace shadow_layers::io
