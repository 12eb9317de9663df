// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Shadow volumes on any mesh: every triangle casts a volume, sides of neighbours cancel by their signed multiplicity,
// and a receiver's volumes are counted on the camera's ray behind it. Based on: C. Everitt, M. Kilgard, Practical and
// robust stenciled shadow volumes, 2002 (count behind the receiver, caps at infinity); B. Kim, K. Kim, G. Turk, A
// shadow-volume algorithm for opaque and transparent nonmanifold casters, 2008 (multiplicities). Differences: the
// polygons are drawn by this technique's own rasteriser in double, in homogeneous pixel coordinates, because a GL snaps
// corners to the raster and clips at the near plane; what lies behind the receiver is decided by the polygon's plane,
// not by a depth; counts have 32 bits. Fails: nothing known, but for time: many silhouette edges make long thin sides
// over the whole picture.
#include "techniques/sv/sv.h"

#include "techniques/common_parameters.h"
#include "techniques/sv/volume_count.h"

namespace shadow_layers {
namespace {

class ShadowVolumes final : public Technique {
public:
    void prepare(Engine&, const ParameterValues&) override {}

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        VolumeCounter counter(engine, task.frame, task.light, task.sample);
        outputs.set("visibility", Image{task.frame.width, task.frame.height, 1, counter.compute_visibility()});
    }
};

}  // namespace

TechniqueDescriptor describe_sv() {
    return {
        .id = "sv",
        .label = "Shadow Volumes",
        .summary = "Shadow volumes: receivers count the volumes behind silhouettes that they lie in; any mesh, no maps",
        .reference = "Everitt02",
        .limits = "Many silhouette edges cost time: each makes a side across the picture",
        .needs = [](const ParameterValues&) { return TechniqueNeeds{}; },
    };
}

std::unique_ptr<Technique> make_sv() { return std::make_unique<ShadowVolumes>(); }

}  // namespace shadow_layers
