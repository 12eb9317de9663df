// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/soft_visibility.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>

#include "lights/light_shape.h"
#include "lights/sample_pattern.h"
#include "scene/bounds.h"
#include "scene/inner_occluders.h"
#include "shadow_layers/error.h"
#include "visibility/caster_tree.h"
#include "visibility/sample_sets.h"
#include "visibility/soft_block.h"
#include "visibility/soft_light.h"

namespace shadow_layers {
namespace {

/// Where receivers lie, and how many.
struct PartBounds {
    Bounds box;
    double largest = 0;  ///< coordinate of any, relative to the picture's origin
    std::size_t count = 0;

    void add(const glm::dvec3& place, double coordinate) {
        box.add(place);
        largest = std::max(largest, coordinate);
        ++count;
    }
    void add(const PartBounds& other) {
        box.add(other.box);
        largest = std::max(largest, other.largest);
        count += other.count;
    }
};

constexpr int kShifts = 16;
constexpr std::size_t kRowBlock = 8;
constexpr std::size_t kMostTreeBytes = std::size_t{8} << 30;
// Rounding of a float position on each axis, turned into other axes.
constexpr double kPlaceRounding = 1.8 / 16777216;

std::vector<std::vector<LightSample>> make_sample_lists(const Light& light, const SoftSettings& settings) {
    const int count = settings.light_samples;
    const std::vector<LightSample> samples = sample_light_shape(light, count, settings.pattern);
    if (!settings.is_rotated || samples.size() == 1) return {samples};
    std::vector<std::vector<LightSample>> lists;
    for (const PatternShift& shift : find_pattern_shifts(settings.pattern, count, kShifts))
        lists.push_back(sample_light_shape(light, count, settings.pattern, shift));
    return lists;
}

std::shared_ptr<const BoxTree> get_tree(Engine& engine, const Mesh& mesh) {
    return engine.mesh_data().get_for_mesh<BoxTree>(mesh, [&](const std::shared_ptr<const BoxTree>& other) {
        std::shared_ptr<const BoxTree> tree;
        if (other) tree = refit_mesh_tree(*other, mesh, &engine.threads());
        return tree ? tree : make_mesh_tree(mesh, &engine.threads());
    });
}

std::shared_ptr<const InnerOccluders> get_inner_occluders(Engine& engine, const Mesh& mesh) {
    return engine.mesh_data().get_for_mesh<InnerOccluders>(
        mesh, [&](const auto&) { return make_inner_occluders(mesh, &engine.threads()); });
}

class SoftRun {
public:
    SoftRun(Engine& engine, const Frame& frame, const Light& light, const SoftSettings& settings)
        : engine_(engine),
          frame_(frame),
          light_(light),
          settings_(settings),
          samples_(frame, light, make_sample_lists(light, settings)),
          rule_(frame, samples_.centre()) {}

    std::vector<float> run() {
        std::vector<float> visibility(frame_.pixel_count());
        {
            const auto timer = engine_.time_stage("caster_trees");
            place_receivers(visibility);
            for (SoftPart& part : parts_) make_part(part);
        }
        const auto timer = engine_.time_stage("soft_visibility");
        trace(visibility);
        count();
        return visibility;
    }

private:
    /// Answers what needs no casters, and finds for each frame of the light where its receivers lie.
    void place_receivers(std::vector<float>& visibility) {
        std::vector<LightFrame> frames = make_light_frames(light_, samples_.centre(), frame_.origin_ws);
        for (LightFrame& frame : frames) align_with_edges(*frame_.scene, light_, frame);
        stances_.assign(frame_.pixel_count(), {});
        const std::size_t blocks = (std::size_t(frame_.height) + kRowBlock - 1) / kRowBlock;
        std::vector<std::vector<PartBounds>> bounds(blocks, std::vector<PartBounds>(frames.size()));
        engine_.threads().parallel_for(std::size_t(frame_.height), kRowBlock, [&](std::size_t begin, std::size_t end) {
            std::vector<PartBounds>& here = bounds[begin / kRowBlock];
            const std::size_t width = std::size_t(frame_.width);
            for (std::size_t pixel = begin * width; pixel < end * width; ++pixel)
                visibility[pixel] = place_receiver(pixel, frames, here);
        });
        for (std::size_t i = 0; i < frames.size(); ++i) {
            SoftPart& part = parts_.emplace_back();
            part.frame = frames[i];
            PartBounds all;
            for (const auto& block : bounds) all.add(block[i]);
            part.receivers = all.box;
            part.largest_rel = all.largest;
            receiver_count_ += all.count;
        }
    }

    float place_receiver(std::size_t pixel, const std::vector<LightFrame>& frames, std::vector<PartBounds>& bounds) {
        if (!samples_.is_candidate(pixel)) return 1.0f;
        const SoftLight::Stance stance = samples_.find_stance(pixel);
        if (stance.is_decided()) return stance.get_decided();
        const glm::dvec3 place(frame_.positions_rel[pixel]);
        std::size_t part = 0;
        if (frames.size() > 1)
            part = std::size_t(
                find_cube_face((place + frame_.origin_ws - samples_.centre().position_ws) * samples_.centre().axes_ws));
        stances_[pixel].part = std::uint8_t(part) & 0x7f;
        stances_[pixel].is_lit_by_all = stance.is_lit_by_all();
        bounds[part].add(place * frames[part].axes,
                         std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)}));
        return 1.0f;
    }

    void make_part(SoftPart& part) {
        if (part.receivers.is_empty()) return;
        engine_.check_cancelled();
        const glm::dvec3 middle = 0.5 * (part.receivers.min + part.receivers.max);
        part.frame.origin_rel = part.frame.axes * middle;
        part.receivers.min -= middle, part.receivers.max -= middle;
        if (!part.frame.directional)
            part.frame.centre = part.frame.from_rel(samples_.centre().position_ws - frame_.origin_ws);
        part.largest_place = std::max(glm::length(part.receivers.max), 1e-30);
        part.place_error = kPlaceRounding * part.largest_rel;
        const double distance = glm::length(part.frame.centre) + part.largest_place;
        for (std::size_t list = 0; list < samples_.list_count(); ++list)
            part.sets.emplace_back(samples_.samples(list), part.frame, frame_.origin_ws, distance);
        part.set_sample_box();
        const soft_kernel::Shaft shaft = make_shaft(part, part.receivers);
        std::vector<TreeCaster> casters, inner;
        const Scene& scene = *frame_.scene;
        for (const std::uint32_t i : find_shaft_casters(scene, light_, frame_.origin_ws, part.frame, shaft,
                                                        part.widening(), engine_.threads())) {
            const std::shared_ptr<const Mesh>& mesh = scene.meshes[scene.instances[i].mesh];
            casters.push_back({i, mesh, get_tree(engine_, *mesh), i});
            if (may_lie_inside(scene.instances[i], *mesh)) continue;
            const auto occluders = get_inner_occluders(engine_, *mesh);
            if (occluders->mesh) inner.push_back({i, occluders->mesh, occluders->tree, soft_kernel::kNoChild});
        }
        check_memory(casters);
        const auto make_tree = [&](const std::vector<TreeCaster>& from) {
            return std::make_unique<CasterTree>(scene, frame_.origin_ws, part.frame, shaft, from, part.widening(),
                                                engine_.threads());
        };
        part.tree = make_tree(casters);
        part.inner_tree = make_tree(inner);
    }

    void check_memory(const std::vector<TreeCaster>& casters) const {
        std::size_t bytes = 0;
        for (const TreeCaster& caster : casters) bytes += CasterTree::bytes_needed(*caster.tree);
        if (bytes <= kMostTreeBytes) return;
        throw InputError("technique \"soft\", light \"" + light_.name + "\": its casters' trees would take " +
                         std::to_string(bytes >> 20) + " MiB, more than the " + std::to_string(kMostTreeBytes >> 20) +
                         " MiB allowed; let fewer instances cast shadows, or use another technique");
    }

    /// Is the light, or a part of it, in the box round the instance? Then its inner occluders prove nothing.
    bool may_lie_inside(const Instance& instance, const Mesh& mesh) const {
        if (samples_.centre().directional) return false;
        const Bounds box = transform_bounds(mesh.bounds, instance.world_from_object);
        const glm::dvec3 nearest = glm::clamp(samples_.centre().position_ws, box.min, box.max);
        return glm::distance(nearest, samples_.centre().position_ws) <= samples_.radius() * (1 + 1e-6);
    }

    void trace(std::vector<float>& visibility) {
        const int columns = (frame_.width + kBlockSide - 1) / kBlockSide;
        const int rows = (frame_.height + kBlockSide - 1) / kBlockSide;
        const std::size_t blocks = std::size_t(columns) * std::size_t(rows);
        std::atomic<std::size_t> done{0};
        engine_.threads().parallel_for(blocks, 1, [&](std::size_t i, std::size_t) {
            engine_.cancel_token().check();
            SoftBlock block({frame_, samples_, parts_, stances_, rule_, light_.kind == LightKind::Area,
                             settings_.is_rotated ? settings_.picture_sample : 0},
                            int(i) % columns * kBlockSide, int(i) / columns * kBlockSide);
            block.trace(visibility);
            {
                const std::lock_guard lock(counts_mutex_);
                counts_.add(block.counts());
            }
            engine_.tell_progress(double(++done) / double(blocks));
        });
    }

    void count() {
        std::size_t tree_bytes = 0;
        for (const SoftPart& part : parts_)
            if (part.tree) tree_bytes += part.tree->byte_size() + part.inner_tree->byte_size();
        engine_.count("receivers", std::int64_t(receiver_count_));
        engine_.count("light_samples", std::int64_t(samples_.sample_count()));
        engine_.count("tree_bytes", std::int64_t(tree_bytes));
        engine_.count("node_tests", std::int64_t(counts_.nodes));
        engine_.count("leaf_tests", std::int64_t(counts_.leaves));
        engine_.count("open_pairs", std::int64_t(counts_.settled));
        engine_.count("lit_blocks", std::int64_t(counts_.lit_blocks));
        engine_.count("dark_blocks", std::int64_t(counts_.dark_blocks));
    }

    Engine& engine_;
    const Frame& frame_;
    const Light& light_;
    const SoftSettings settings_;
    const SoftLight samples_;
    const OcclusionRule rule_;
    std::vector<SoftPart> parts_;
    std::vector<PixelStance> stances_;
    std::size_t receiver_count_ = 0;
    std::mutex counts_mutex_;
    SoftCounts counts_;
};

}  // namespace

std::vector<float> compute_soft_visibility(Engine& engine, const Frame& frame, const Light& light,
                                           const SoftSettings& settings) {
    return SoftRun(engine, frame, light, settings).run();
}

}  // namespace shadow_layers
