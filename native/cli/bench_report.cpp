// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench_report.h"

#include <cstdio>

#include "cli/describe.h"
#include "cli/statistics.h"
#include "cli/verbs.h"
#include "shadow_layers/names.h"

namespace shadow_layers::cli {
namespace {

using nlohmann::json;

json spread_to_json(const std::vector<double>& samples) {
    return {{"median", round_ms(compute_median(samples))},
            {"min", round_ms(compute_quantile(samples, 0))},
            {"quartile_1", round_ms(compute_quantile(samples, 0.25))},
            {"quartile_3", round_ms(compute_quantile(samples, 0.75))},
            {"max", round_ms(compute_quantile(samples, 1))},
            {"count", samples.size()}};
}

json medians_to_json(const std::map<std::string, std::vector<double>>& times) {
    json result = json::object();
    for (const auto& [stage, samples] : times) result[stage] = round_ms(compute_median(samples));
    return result;
}

json spreads_to_json(const std::map<std::string, std::vector<double>>& times) {
    json result = json::object();
    for (const auto& [stage, samples] : times) result[stage] = spread_to_json(samples);
    return result;
}

// Median of the ratios round by round; null where there is nothing to compare with.
json ratio_to_json(const std::vector<double>& ratios) { return ratios.empty() ? json() : json(compute_median(ratios)); }

json stage_ratios_to_json(const BenchRow& row, const BenchRow& reference) {
    json result = json::object();
    for (const auto& [stage, samples] : row.stage_ms) {
        const auto its = reference.stage_ms.find(stage);
        if (its == reference.stage_ms.end() || its->second.size() != samples.size()) continue;
        const std::vector<double> ratios = compute_ratios(samples, its->second);
        if (!ratios.empty()) result[stage] = compute_median(ratios);
    }
    return result;
}

json errors_to_json(const LayerErrors& errors) {
    return {{"pixels", errors.pixels},
            {"mean_absolute", errors.mean_absolute},
            {"root_mean_square", errors.root_mean_square},
            {"bias", errors.bias},
            {"wrong_fraction", errors.wrong_fraction},
            {"border_pixels", errors.border_pixels},
            {"border_mean_absolute", errors.border_pixels > 0 ? json(errors.border_mean_absolute) : json()}};
}

json sample_errors_to_json(const SampleErrors& errors) {
    return {{"light_samples", errors.light_samples},     {"bits", errors.bits},
            {"wrong_bits", errors.wrong_bits},           {"wrong_pixels", errors.wrong_pixels},
            {"penumbra_pixels", errors.penumbra_pixels}, {"ties", errors.ties}};
}

json row_errors_to_json(const RowErrors& errors) {
    return {{"truth", get_name(errors.truth.kind)},
            {"truth_standard_error", errors.truth_standard_error ? json(*errors.truth_standard_error) : json()},
            {"footprint_texels", errors.truth.footprint_texels},
            {"footprint_world", errors.truth.footprint_world},
            {"own", errors_to_json(errors.own)},
            {"hard", errors_to_json(errors.hard)}};
}

std::string ratio_text(const std::vector<double>& ratios) {
    if (ratios.empty()) return "-";
    char text[32];
    std::snprintf(text, sizeof text, "%.3f", compute_median(ratios));
    return text;
}

void print_row(const BenchRow& row, const BenchRow* reference) {
    const std::vector<double> none;
    std::printf("  %-10s %-34s %10.2f  (%7.2f, %7.2f) %9.2f %9.2f %8s", row.technique.c_str(), row.name.c_str(),
                compute_median(row.render_ms), compute_quantile(row.render_ms, 0.25),
                compute_quantile(row.render_ms, 0.75), compute_median(row.frame_ms), compute_median(row.layers_ms),
                ratio_text(compute_ratios(row.render_ms, reference ? reference->render_ms : none)).c_str());
    if (row.errors) {
        std::printf("  %8.4f %% of %s, %8.4f %% wrong", 100 * row.errors->own.mean_absolute,
                    get_name(row.errors->truth.kind), 100 * row.errors->hard.wrong_fraction);
        if (row.errors->truth.kind == TruthKind::Pixel)
            std::printf(", border %.5f", row.errors->own.border_mean_absolute);
    }
    if (row.bits)
        std::printf("  %zu wrong bits of %zu (%zu ties)", row.bits->wrong_bits, row.bits->bits, row.bits->ties);
    std::printf("\n");
    for (const auto& [stage, times] : row.cpu_ms) {
        const auto gl = row.gl_ms.find(stage);
        std::printf("  %-10s   %-32s %10.2f", "", stage.c_str(), compute_median(times));
        if (gl != row.gl_ms.end()) std::printf("  GL %.2f", compute_median(gl->second));
        std::printf("\n");
    }
}

void print_rays(const RayBench& rays) {
    for (const RayRow& row : rays.rows())
        std::printf("  %-10s %-34s list %.2f, build %.2f, packets %.2f, stream %.2f, %zu rays\n", "embree",
                    row.name.c_str(), compute_median(row.list_ms), compute_median(row.build_ms),
                    compute_median(row.packets_ms), compute_median(row.stream_ms), row.rays);
}

}  // namespace

void print_bench(const FileBench& bench, const Options& options) {
    const io::SceneFile& file = bench.file();
    std::printf("%s: %zu triangles, %dx%d, %zu light(s), %d sample(s), %s; medians of %d in ms (quartiles)\n",
                bench.path().filename().c_str(), count_triangles(*file.scene), file.width, file.height,
                bench.light_count(), file.samples, bench.info().gl_renderer.c_str(), options.repeat);
    std::printf("  %-10s %-34s %10s %19s %9s %9s %8s%s\n", "", "settings", "render", "", "frame", "layers", "ratio",
                options.errors ? "  error" : "");
    for (const BenchRow& row : bench.rows()) print_row(row, find_reference_row(bench.rows(), row));
    if (bench.rays()) print_rays(*bench.rays());
    std::fflush(stdout);
}

json rays_to_json(const FileBench& bench) {
    json list = json::array();
    if (!bench.rays()) return list;
    for (const RayRow& row : bench.rays()->rows())
        list.push_back({{"file", bench.path().filename().string()},
                        {"name", row.name},
                        {"list_ms", spread_to_json(row.list_ms)},
                        {"build_ms", spread_to_json(row.build_ms)},
                        {"packets_ms", spread_to_json(row.packets_ms)},
                        {"stream_ms", spread_to_json(row.stream_ms)},
                        {"trace_ms", spread_to_json(row.trace_ms)},
                        {"processor_ms", spread_to_json(row.processor_ms)},
                        {"receivers", row.receivers},
                        {"rays", row.rays}});
    return list;
}

json bench_to_json(const FileBench& bench) {
    const io::SceneFile& file = bench.file();
    json list = json::array();
    for (const BenchRow& row : bench.rows()) {
        const BenchRow* reference = find_reference_row(bench.rows(), row);
        const std::vector<double> none;
        const auto ratios = compute_ratios(row.render_ms, reference ? reference->render_ms : none);
        const auto layers = compute_ratios(row.layers_ms, reference ? reference->layers_ms : none);
        list.push_back({{"file", bench.path().filename().string()},
                        {"name", row.name},
                        {"technique", row.technique},
                        {"settings", parameters_to_json(row.resolved)},
                        {"resolution", {file.width, file.height}},
                        {"samples", file.samples},
                        {"triangles", count_triangles(*file.scene)},
                        {"lights", bench.light_count()},
                        {"render_ms", spread_to_json(row.render_ms)},
                        {"processor_ms", spread_to_json(row.processor_ms)},
                        {"frame_ms", spread_to_json(row.frame_ms)},
                        {"layers_ms", spread_to_json(row.layers_ms)},
                        {"time_ms", medians_to_json(row.cpu_ms)},
                        {"stage_ms", spreads_to_json(row.stage_ms)},
                        {"gl_ms", medians_to_json(row.gl_ms)},
                        {"counters", row.counters},
                        {"ratio_to_sm", ratio_to_json(ratios)},
                        {"ratio_to_sm_spread", ratios.empty() ? json() : spread_to_json(ratios)},
                        {"layers_ratio_to_sm", ratio_to_json(layers)},
                        {"stage_ratio_to_sm", reference ? stage_ratios_to_json(row, *reference) : json::object()},
                        {"errors", row.errors ? row_errors_to_json(*row.errors) : json()},
                        {"bits", row.bits ? sample_errors_to_json(*row.bits) : json()}});
    }
    return list;
}

}  // namespace shadow_layers::cli
