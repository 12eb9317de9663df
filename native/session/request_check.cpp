// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/request_check.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shadow_layers/error.h"
#include "shadow_layers/names.h"

namespace shadow_layers {
namespace {

constexpr int kMostSamples = 64;
constexpr double kWidestFilterPx = 16;

[[noreturn]] void refuse(const std::string& text) { throw InputError(text); }

void check_map(const ResolvedJob& job, const gl::Limits& limits) {
    const int limit = std::min(limits.max_texture_size, limits.max_viewport_size);
    const long long side = (long long)(job.needs.map_size) + 2LL * job.needs.map_border_texels;
    if (side > limit)
        refuse("technique \"" + job.descriptor->id + "\": map_size " + std::to_string(job.needs.map_size) +
               " with a border of " + std::to_string(job.needs.map_border_texels) +
               " texels on each side is beyond this driver's limit of " + std::to_string(limit) +
               " texels; use a smaller map_size");
}

ResolvedJob resolve_job(const RenderRequest& request, const LayerJob& job,
                        const std::vector<TechniqueDescriptor>& descriptors) {
    const auto& lights = request.scene->lights;
    if (job.light >= lights.size())
        refuse("a job asks for light " + std::to_string(job.light) + ", but the scene has " +
               std::to_string(lights.size()) + " lights");
    ResolvedJob resolved;
    resolved.light = job.light;
    resolved.descriptor = &find_technique_descriptor(descriptors, job.technique);
    const Light& light = lights[job.light];
    const auto& kinds = resolved.descriptor->lights;
    if (std::find(kinds.begin(), kinds.end(), light.kind) == kinds.end())
        refuse("technique \"" + job.technique + "\" does not serve " + get_name(light.kind) + " lights (light \"" +
               light.name + "\")");
    resolved.parameters = resolve_parameters(*resolved.descriptor, job.parameters);
    if (resolved.descriptor->needs) resolved.needs = resolved.descriptor->needs(resolved.parameters);
    return resolved;
}

void check_picture(const RenderRequest& request, const ResolvedRequest& resolved, const gl::Limits& limits) {
    const int limit = std::min(limits.max_texture_size, limits.max_viewport_size);
    const PixelRect& r = resolved.region;
    if (r.x < 0 || r.y < 0 || r.width < 1 || r.height < 1 || r.width > request.width - r.x ||
        r.height > request.height - r.y)
        refuse("region " + std::to_string(r.x) + ", " + std::to_string(r.y) + ", " + std::to_string(r.width) + "x" +
               std::to_string(r.height) + " is not inside the picture of " + std::to_string(request.width) + "x" +
               std::to_string(request.height));
    int largest_px = 0;
    for (const ResolvedJob& job : resolved.jobs) largest_px = std::max(largest_px, job.needs.overscan_px);
    const long long overscan = 2LL * largest_px;
    if (r.width + overscan > limit || r.height + overscan > limit)
        refuse("a picture of " + std::to_string(r.width) + "x" + std::to_string(r.height) + " with an overscan of " +
               std::to_string(largest_px) + " pixels is beyond this driver's limit of " + std::to_string(limit) +
               "; render it in regions");
}

}  // namespace

ResolvedRequest resolve_request(const RenderRequest& request, const gl::Limits& limits,
                                const std::vector<TechniqueDescriptor>& descriptors) {
    if (!request.scene) refuse("the request has no scene");
    validate(*request.scene);
    validate(request.camera);
    if (request.width < 1 || request.height < 1)
        refuse("a picture of " + std::to_string(request.width) + "x" + std::to_string(request.height) +
               " pixels: both sides must be at least 1");
    if (request.samples < 1 || request.samples > kMostSamples)
        refuse("samples is " + std::to_string(request.samples) + "; give 1 to " + std::to_string(kMostSamples));
    if (!(request.filter.width_px > 0 && request.filter.width_px <= kWidestFilterPx))
        refuse("the pixel filter's width is " + std::to_string(request.filter.width_px) +
               " px; give more than 0 and at most " + std::to_string(int(kWidestFilterPx)));
    for (const std::string& aux : request.aux) {
        constexpr std::array<const char*, 4> kKnown = {"position", "normal", "ids", "depth"};
        if (std::find(kKnown.begin(), kKnown.end(), aux) == kKnown.end())
            refuse("there is no auxiliary output \"" + aux + "\"; there are: position, normal, ids, depth");
    }
    ResolvedRequest resolved;
    const PixelRect& r = request.region;
    const bool is_whole = r.x == 0 && r.y == 0 && r.width == 0 && r.height == 0;
    resolved.region = is_whole ? PixelRect{0, 0, request.width, request.height} : r;
    for (const LayerJob& job : request.jobs) {
        resolved.jobs.push_back(resolve_job(request, job, descriptors));
        check_map(resolved.jobs.back(), limits);
        const int overscan_px = resolved.jobs.back().needs.overscan_px;
        resolved.overscan_px = resolved.jobs.size() == 1 ? overscan_px : std::min(resolved.overscan_px, overscan_px);
    }
    check_picture(request, resolved, limits);
    return resolved;
}

}  // namespace shadow_layers
