// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench_errors.h"

#include <algorithm>
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

/// What float sums of up to 1024 samples lose; less than one of them brings.
constexpr double kSumRounding = 2e-5;

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
                                      : truths_.emplace(key, compute(light, spec, map_size)).first->second;
    }

    /// Mean standard error of a soft truth, over the pixels that have one.
    double find_standard_error(std::uint32_t light) { return standard_errors_.at(light); }

    /// Adds the wrong bits of a soft layer that took these samples, of the frame with these ids.
    void count_bits(const Layer& layer, std::uint32_t light, const TechniqueNeeds& needs, const IdImage& ids,
                    SampleErrors& errors) {
        const auto parts = exact_.compute_at_samples(light, needs.light_samples, needs.light_pattern, ids);
        const std::vector<float>& visibility = layer.channels.at("visibility").data;
        errors.light_samples = needs.light_samples;
        for (std::size_t pixel = 0; pixel < parts.size(); ++pixel) {
            const truth::LitPart& part = parts[pixel];
            const double value = std::isfinite(visibility[pixel]) ? double(visibility[pixel]) : -1;
            const double gap = std::max(part.least - value, value - part.most);
            errors.bits += std::size_t(part.bits);
            errors.ties += std::size_t(part.ties);
            errors.penumbra_pixels += part.decided > 0 && part.decided < 1;
            if (gap <= kSumRounding) continue;
            ++errors.wrong_pixels;
            errors.wrong_bits += std::size_t(std::ceil((gap - kSumRounding) / part.step));
        }
    }

    const std::vector<std::uint8_t>& find_comparable(std::uint32_t light) {
        const auto found = comparable_.find(light);
        return found != comparable_.end() ? found->second
                                          : comparable_.emplace(light, exact_.find_comparable(light)).first->second;
    }

private:
    std::vector<float> compute(std::uint32_t light, const TruthSpec& spec, int map_size) {
        if (spec.kind != TruthKind::Soft) return exact_.compute(light, spec, map_size);
        truth::SoftTruth soft = exact_.compute_soft(light);
        double sum = 0;
        std::size_t count = 0;
        for (const float error : soft.standard_error) sum += double(error), count += error > 0;
        standard_errors_[light] = count > 0 ? sum / double(count) : 0;
        return std::move(soft.mean);
    }

    truth::ExactLayers exact_;
    std::map<std::uint32_t, double> standard_errors_;
    std::map<TruthKey, std::vector<float>> truths_;
    std::map<std::uint32_t, std::vector<std::uint8_t>> comparable_;
};

RowErrors compare_layers(RowTruths& truths, const BenchRow& row, const std::vector<Layer>& layers) {
    const auto map_size = row.resolved.all().find("map_size");
    const int texels = map_size == row.resolved.all().end() ? 1024 : int(std::get<std::int64_t>(map_size->second));
    RowErrors errors;
    errors.truth = find_truth(find_technique_descriptor(row.technique), row.resolved);
    ErrorSum hard, own;
    double standard_error = 0;
    for (const Layer& layer : layers) {
        const std::uint32_t light = row.request.jobs[layer.job].light;
        const std::vector<float>& visibility = layer.channels.at("visibility").data;
        hard.add(visibility, truths.find(light, {}, texels), truths.find_comparable(light));
        own.add(visibility, truths.find(light, errors.truth, texels), truths.find_comparable(light));
        if (errors.truth.kind == TruthKind::Soft)
            standard_error += truths.find_standard_error(light) / double(layers.size());
    }
    if (errors.truth.kind == TruthKind::Soft) errors.truth_standard_error = standard_error;
    errors.hard = hard.compute();
    errors.own = own.compute();
    return errors;
}

}  // namespace

bool can_measure_errors() { return true; }

void measure_errors(Session& session, std::vector<BenchRow>& rows, const ErrorKinds& kinds, int threads,
                    const std::atomic<bool>& cancelled, const std::function<void(double)>& tell) {
    RowTruths truths(rows.front().request, threads, cancelled);
    for (BenchRow& row : rows) {
        tell(double(&row - rows.data()) / double(rows.size()));
        if (cancelled) throw Cancelled();
        RenderRequest request = row.request;
        request.samples = 1;
        request.region = {};
        request.aux = {"ids"};
        std::vector<Layer> layers;
        const FrameResult frame = session.render(request, [&](Layer&& layer) { layers.push_back(std::move(layer)); });
        if (kinds.pictures) row.errors = compare_layers(truths, row, layers);
        const TechniqueDescriptor& technique = find_technique_descriptor(row.technique);
        if (!kinds.bits || find_truth(technique, row.resolved).kind != TruthKind::Soft) continue;
        row.bits.emplace();
        for (const Layer& layer : layers)
            truths.count_bits(layer, request.jobs[layer.job].light, technique.needs(row.resolved), frame.ids,
                              *row.bits);
    }
}
#else
bool can_measure_errors() { return false; }

void measure_errors(Session&, std::vector<BenchRow>&, const ErrorKinds&, int, const std::atomic<bool>&,
                    const std::function<void(double)>&) {
    throw InputError(
        "--errors, --bits: this shadowcore was built without Embree; build it with SHADOW_LAYERS_EMBREE=ON");
}
#endif

}  // namespace shadow_layers::cli
