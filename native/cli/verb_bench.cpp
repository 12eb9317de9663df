// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Times of each technique with each setting, on all chosen lights. A timed render is a whole frame with one technique:
// its wall time includes the frame. Settings take turns, round after round, so that a slow moment of the machine
// falls on all of them and ratios stay fair.
#include <chrono>
#include <cstdio>
#include <memory>

#include "cli/describe.h"
#include "cli/jobs.h"
#include "cli/progress.h"
#include "cli/statistics.h"
#include "cli/verbs.h"
#include "io/whole_file.h"
#include "shadow_layers/error.h"

namespace shadow_layers::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kReference = "sm";
// How far camera and lights move from one timed render to the next: too little to be seen, enough for new keys.
constexpr double kCameraStepPx = 1e-3, kLightStepRadians = 1e-5;

// One row of the table: a technique with its settings, and what was measured.
struct Row {
    std::string technique;
    ParameterValues given, resolved;
    RenderRequest request;
    std::vector<double> render_ms, frame_ms, layers_ms;
    std::map<std::string, std::vector<double>> cpu_ms, gl_ms;  // by stage: "frame: ..." or the layer's stage
    std::map<std::string, std::int64_t> counters;              // summed over the lights
    double median = 0, ratio = 0;
};

double elapsed_ms(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// The next frame of an animation in which next to nothing happens: meshes stay, all else is made anew.
void move_a_trifle(RenderRequest& request, int step) {
    auto scene = std::make_shared<Scene>(*request.scene);
    const double angle = kLightStepRadians * step;
    const glm::dmat4 roll(glm::dvec4(std::cos(angle), std::sin(angle), 0, 0),
                          glm::dvec4(-std::sin(angle), std::cos(angle), 0, 0), glm::dvec4(0, 0, 1, 0),
                          glm::dvec4(0, 0, 0, 1));
    const glm::dvec3 camera(request.camera.world_from_camera[3]);
    for (Light& light : scene->lights) {
        // A sun has no place; others move across their direction, by a part of their distance to the camera.
        const double distance = glm::length(glm::dvec3(light.world_from_light[3]) - camera);
        light.world_from_light[3] += light.world_from_light[0] * (distance * angle);
        light.world_from_light = light.world_from_light * roll;
    }
    request.scene = std::move(scene);
    CameraWindow& window = request.camera.window;
    const double shift = kCameraStepPx * step * (window.right - window.left) / request.width;
    window.left += shift;
    window.right += shift;
}

class FileBench {
public:
    FileBench(const Options& options, const std::filesystem::path& path, double fraction_start, double fraction_end)
        : options_(options),
          path_(path),
          file_(open_scene_file(path, options)),
          fraction_start_(fraction_start),
          fraction_end_(fraction_end) {
        make_rows();
    }

    void run(Progress& progress) {
        const int rounds = options_.warm_up + options_.repeat;
        for (int round = 0; round < rounds; ++round) {
            for (Row& row : rows_) {
                const double done = (round + double(&row - rows_.data()) / double(rows_.size())) / rounds;
                progress.update(
                    fraction_start_ + done * (fraction_end_ - fraction_start_),
                    path_.filename().string() + ": " + row.technique + ", round " + std::to_string(round + 1));
                render(row, round);
            }
        }
        evaluate();
    }

    void print() const {
        std::printf("%s: %zu triangles, %dx%d, %zu light(s), %d sample(s), %s; medians of %d in ms (quartiles)\n",
                    path_.filename().c_str(), count_triangles(*file_.scene), file_.width, file_.height, light_count_,
                    file_.samples, info_.gl_renderer.c_str(), options_.repeat);
        std::printf("  %-8s %-34s %10s %19s %9s %9s %8s\n", "", "settings", "render", "", "frame", "layers", "ratio");
        for (const Row& row : rows_) {
            const std::string given = row.given.all().empty() ? "defaults" : parameters_to_json(row.given).dump();
            std::printf("  %-8s %-34s %10.2f  (%7.2f, %7.2f) %9.2f %9.2f %8s\n", row.technique.c_str(), given.c_str(),
                        row.median, compute_quantile(row.render_ms, 0.25), compute_quantile(row.render_ms, 0.75),
                        compute_median(row.frame_ms), compute_median(row.layers_ms), ratio_text(row.ratio).c_str());
            for (const auto& [stage, times] : row.cpu_ms) {
                const auto gl = row.gl_ms.find(stage);
                std::printf("  %-8s   %-32s %10.2f", "", stage.c_str(), compute_median(times));
                if (gl != row.gl_ms.end()) std::printf("  GL %.2f", compute_median(gl->second));
                std::printf("\n");
            }
        }
    }

    nlohmann::json records() const {
        nlohmann::json list = nlohmann::json::array();
        for (const Row& row : rows_) {
            list.push_back({{"file", path_.filename().string()},
                            {"technique", row.technique},
                            {"settings", parameters_to_json(row.resolved)},
                            {"resolution", {file_.width, file_.height}},
                            {"samples", file_.samples},
                            {"triangles", count_triangles(*file_.scene)},
                            {"lights", light_count_},
                            {"render_ms", spread(row.render_ms)},
                            {"frame_ms", spread(row.frame_ms)},
                            {"layers_ms", spread(row.layers_ms)},
                            {"time_ms", medians(row.cpu_ms)},
                            {"gl_ms", medians(row.gl_ms)},
                            {"counters", row.counters},
                            {"ratio_to_sm", row.ratio > 0 ? nlohmann::json(row.ratio) : nlohmann::json()}});
        }
        return list;
    }

    const SessionInfo& info() const { return info_; }

private:
    static std::string ratio_text(double ratio) {
        if (ratio <= 0) return "-";
        char text[32];
        std::snprintf(text, sizeof text, "%.3f", ratio);
        return text;
    }

    static nlohmann::json spread(const std::vector<double>& samples) {
        return {{"median", round_ms(compute_median(samples))},
                {"min", round_ms(compute_quantile(samples, 0))},
                {"quartile_1", round_ms(compute_quantile(samples, 0.25))},
                {"quartile_3", round_ms(compute_quantile(samples, 0.75))},
                {"max", round_ms(compute_quantile(samples, 1))},
                {"count", samples.size()}};
    }

    static nlohmann::json medians(const std::map<std::string, std::vector<double>>& times) {
        nlohmann::json json = nlohmann::json::object();
        for (const auto& [stage, samples] : times) json[stage] = round_ms(compute_median(samples));
        return json;
    }

    void make_rows() {
        const std::vector<std::uint32_t> lights = choose_lights(file_, options_.lights);
        light_count_ = lights.size();
        for (const std::string& id : choose_techniques(options_)) {
            const TechniqueDescriptor& technique = find_technique_descriptor(id);
            for (const ParameterValues& given : make_grid(id, options_)) {
                Row row;
                row.technique = id;
                row.given = given;
                row.resolved = resolve_parameters(technique, given);
                row.request = make_request(file_);
                row.request.combined = false;
                for (const std::uint32_t light : lights) {
                    const LightKind kind = file_.scene->lights[light].kind;
                    if (std::find(technique.lights.begin(), technique.lights.end(), kind) != technique.lights.end()) {
                        row.request.jobs.push_back({light, id, given});
                    }
                }
                if (!row.request.jobs.empty()) rows_.push_back(std::move(row));
            }
        }
        if (rows_.empty()) throw InputError("'" + path_.string() + "': no technique serves any of its lights");
    }

    void render(Row& row, int round) {
        RenderRequest request = row.request;
        if (options_.mode == BenchMode::Cold || !session_) {
            session_.reset();
            session_ = std::make_unique<Session>(make_session_options(options_));
            info_ = session_->info();
        }
        // Every render of every row differs from all before, or a row would find the maps of the one before it.
        if (options_.mode == BenchMode::Frame) move_a_trifle(request, ++step_);
        std::map<std::string, double> cpu, gl;
        const auto add = [&](const RenderStats& stats, const std::string& prefix) {
            for (const StageTime& time : stats.times) {
                cpu[prefix + time.stage] += time.cpu_ms;
                if (time.gl_ms >= 0) gl[prefix + time.stage] += time.gl_ms;
            }
        };
        double layers_ms = 0;
        std::map<std::string, std::int64_t> counters;
        const Clock::time_point start = Clock::now();
        const FrameResult result = session_->render(request, [&](Layer&& layer) {
            layers_ms += layer.stats.total_ms;
            add(layer.stats, "");
            for (const auto& [name, count] : layer.stats.counters) counters[name] += count;
        });
        const double render_ms = elapsed_ms(start);
        add(result.stats, "frame: ");
        if (round < options_.warm_up) return;
        row.render_ms.push_back(render_ms);
        row.frame_ms.push_back(result.stats.total_ms);
        row.layers_ms.push_back(layers_ms);
        for (const auto& [stage, ms] : cpu) row.cpu_ms[stage].push_back(ms);
        for (const auto& [stage, ms] : gl) row.gl_ms[stage].push_back(ms);
        row.counters = std::move(counters);
    }

    // The reference is sm with the same map size and lights, else the first sm there is.
    const Row* find_reference(const Row& row) const {
        const Row* first = nullptr;
        for (const Row& other : rows_) {
            if (other.technique != kReference || other.request.jobs.size() != row.request.jobs.size()) continue;
            const auto& sizes = other.resolved.all();
            const auto mine = row.resolved.all().find("map_size"), its = sizes.find("map_size");
            const bool same = mine != row.resolved.all().end() && its != sizes.end() && mine->second == its->second;
            if (same) return &other;
            if (!first) first = &other;
        }
        return first;
    }

    void evaluate() {
        for (Row& row : rows_) row.median = compute_median(row.render_ms);
        for (Row& row : rows_) {
            const Row* reference = find_reference(row);
            row.ratio = reference && reference->median > 0 ? row.median / reference->median : 0;
        }
    }

    const Options& options_;
    std::filesystem::path path_;
    io::SceneFile file_;
    double fraction_start_, fraction_end_;
    std::size_t light_count_ = 0;
    std::vector<Row> rows_;
    std::unique_ptr<Session> session_;
    SessionInfo info_;
    int step_ = 0;
};

const char* mode_name(BenchMode mode) {
    return mode == BenchMode::Warm ? "warm" : mode == BenchMode::Cold ? "cold" : "frame";
}

}  // namespace

void run_bench(const Options& options) {
    nlohmann::json document = nlohmann::json::object(), records = nlohmann::json::array();
    Progress progress;
    for (std::size_t i = 0; i < options.files.size(); ++i) {
        FileBench bench(options, options.files[i], double(i) / options.files.size(),
                        double(i + 1) / options.files.size());
        bench.run(progress);
        progress.clear();
        bench.print();
        std::fflush(stdout);
        if (i == 0) document = versions_to_json(bench.info());
        for (const auto& record : bench.records()) records.push_back(record);
    }
    document["schema"] = "shadow-layers-bench";
    document["schema_version"] = 1;
    document["caches"] = mode_name(options.mode);
    document["warm_up"] = options.warm_up;
    document["repeat"] = options.repeat;
    document["records"] = std::move(records);
    if (!options.json.empty()) io::write_whole_file(options.json, document.dump(1) + "\n");
}

}  // namespace shadow_layers::cli
