// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench_errors.h"

#include <cmath>
#include <tuple>

#include "shadow_layers/error.h"
#ifdef SHADOW_LAYERS_EMBREE
#include "truth/exact_layers.h"
#endif

namespace shadow_layers::cli {

void ErrorSum::add(const std::vector<float>& layer, const std::vector<float>& truth,
                   const std::vector<std::uint8_t>& comparable) {
    for (std::size_t pixel = 0; pixel < comparable.size(); ++pixel) {
        if (!comparable[pixel]) continue;
        ++pixels_;
        // A value that is not a number is as wrong as can be.
        const bool usable = std::isfinite(layer[pixel]);
        const double difference = usable ? double(layer[pixel]) - double(truth[pixel]) : 1.0;
        wrong_ += !usable || (layer[pixel] >= 0.5f) != (truth[pixel] >= 0.5f);
        absolute_ += std::abs(difference);
        squared_ += difference * difference;
        signed_ += difference;
        border_.add(double(layer[pixel]), double(truth[pixel]));
    }
}

LayerErrors ErrorSum::compute() const {
    if (pixels_ == 0) return {};
    const double count = double(pixels_);
    return {.pixels = pixels_,
            .mean_absolute = absolute_ / count,
            .root_mean_square = std::sqrt(squared_ / count),
            .bias = signed_ / count,
            .wrong_fraction = double(wrong_) / count,
            .border_pixels = border_.pixels(),
            .border_mean_absolute = border_.compute_mean()};
}

#ifdef SHADOW_LAYERS_EMBREE
namespace {

// A truth that several rows may share. Of a filtered one in texels, the map's size belongs to it.
using TruthKey = std::tuple<std::uint32_t, TruthKind, double, double, int>;

class RowTruths {
public:
    RowTruths(const RenderRequest& request, int threads, const std::atomic<bool>& cancelled)
        : exact_(request.scene, request.camera, request.width, request.height, threads, cancelled) {}

    const std::vector<float>& find(std::uint32_t light, const TruthSpec& spec, int map_size) {
        const bool in_map = spec.kind == TruthKind::Filtered && !(spec.footprint_world > 0);
        const TruthKey key(light, spec.kind, in_map ? spec.footprint_texels : 0,
                           spec.kind == TruthKind::Filtered ? spec.footprint_world : 0, in_map ? map_size : 0);
        const auto found = truths_.find(key);
        return found != truths_.end() ? found->second
                                      : truths_.emplace(key, exact_.compute(light, spec, map_size)).first->second;
    }

    const std::vector<std::uint8_t>& find_comparable(std::uint32_t light) {
        const auto found = comparable_.find(light);
        return found != comparable_.end() ? found->second
                                          : comparable_.emplace(light, exact_.find_comparable(light)).first->second;
    }

private:
    truth::ExactLayers exact_;
    std::map<TruthKey, std::vector<float>> truths_;
    std::map<std::uint32_t, std::vector<std::uint8_t>> comparable_;
};

}  // namespace

bool can_measure_errors() { return true; }

void measure_errors(Session& session, std::vector<BenchRow>& rows, int threads, const std::atomic<bool>& cancelled,
                    const std::function<void(double)>& tell) {
    RowTruths truths(rows.front().request, threads, cancelled);
    for (BenchRow& row : rows) {
        tell(double(&row - rows.data()) / double(rows.size()));
        if (cancelled) throw Cancelled();
        RenderRequest request = row.request;
        request.samples = 1;
        request.region = {};
        std::vector<Layer> layers;
        session.render(request, [&](Layer&& layer) { layers.push_back(std::move(layer)); });
        const TechniqueDescriptor& technique = find_technique_descriptor(row.technique);
        const auto map_size = row.resolved.all().find("map_size");
        const int texels = map_size == row.resolved.all().end() ? 1024 : int(std::get<std::int64_t>(map_size->second));
        RowErrors errors;
        errors.truth = find_truth(technique, row.resolved);
        ErrorSum hard, own;
        for (const Layer& layer : layers) {
            const std::uint32_t light = request.jobs[layer.job].light;
            const std::vector<float>& visibility = layer.channels.at("visibility").data;
            hard.add(visibility, truths.find(light, {}, texels), truths.find_comparable(light));
            own.add(visibility, truths.find(light, errors.truth, texels), truths.find_comparable(light));
        }
        errors.hard = hard.compute();
        errors.own = own.compute();
        row.errors = errors;
    }
}
#else
bool can_measure_errors() { return false; }

void measure_errors(Session&, std::vector<BenchRow>&, int, const std::atomic<bool>&,
                    const std::function<void(double)>&) {
    throw InputError("--errors: this shadowcore was built without Embree; build it with SHADOW_LAYERS_EMBREE=ON");
}
#endif

}  // namespace shadow_layers::cli
