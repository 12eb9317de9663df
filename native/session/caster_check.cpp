// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/caster_check.h"

#include <algorithm>

#include "lights/view_casters.h"

namespace shadow_layers {

void warn_of_open_casters(Engine& engine, const TechniqueDescriptor& technique, const Scene& scene,
                          const Light& light) {
    if (technique.meshes != CasterMeshes::Closed || !light.casts_shadow) return;
    std::vector<bool> is_done(scene.meshes.size());
    for (const Instance& instance : scene.instances) {
        if (is_done[instance.mesh] || !casts_for(light, instance)) continue;
        is_done[instance.mesh] = true;
        const Mesh& mesh = *scene.meshes[instance.mesh];
        const auto& closed = engine.mesh_data().get_edges(mesh, &engine.threads()).adjacency->component_closed;
        const auto open = std::count(closed.begin(), closed.end(), 0);
        if (open == 0) continue;
        engine.warn("technique \"" + technique.id + "\" needs closed meshes, but " + std::to_string(open) + " of " +
                    std::to_string(closed.size()) + " parts of mesh \"" + mesh.name +
                    "\" are open: their shadows may be wrong; close the mesh or choose another technique");
    }
}

}  // namespace shadow_layers
