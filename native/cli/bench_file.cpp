// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// A timed render is a whole frame with one technique: its wall time includes the frame. Rows take turns, round after
// round, so that a slow moment of the machine falls on all of them and ratios stay fair.
#include "cli/bench_file.h"

#include <algorithm>
#include <chrono>
#include <ctime>

#include "cli/bench_errors.h"
#include "cli/jobs.h"
#include "cli/verbs.h"
#include "shadow_layers/error.h"

namespace shadow_layers::cli {
namespace {

using Clock = std::chrono::steady_clock;

// How far camera and lights move from one timed render to the next: too little to be seen, enough for new keys.
constexpr double kCameraStepPx = 1e-3, kLightStepRadians = 1e-5;
// The part of a file's time that goes to rounds where errors are measured too; for the progress line alone.
constexpr double kTimedPart = 0.7;

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

/// The row whose rays are the most work: rays go to the samples that its technique takes.
const BenchRow& find_most_samples(const std::vector<BenchRow>& rows) {
    const auto samples = [](const BenchRow& row) {
        return find_technique_descriptor(row.technique).needs(row.resolved).light_samples;
    };
    return *std::max_element(rows.begin(), rows.end(),
                             [&](const BenchRow& a, const BenchRow& b) { return samples(a) < samples(b); });
}

/// Said before hours of measuring, not after.
void check_bits_can_be_told(const std::vector<BenchRow>& rows) {
    for (const BenchRow& row : rows) {
        const TechniqueDescriptor& technique = find_technique_descriptor(row.technique);
        if (technique.needs(row.resolved).shifts_samples)
            throw InputError("--bits casts rays to the same samples of the light from all pixels, but \"" +
                             row.technique +
                             "\" takes others at each of them with pattern = rotated; measure it with pattern = fixed");
    }
}

}  // namespace

void BenchStop::request() {
    requested_ = true;
    const std::lock_guard lock(mutex_);
    if (session_) session_->cancel();
}

void BenchStop::watch(Session* session) {
    const std::lock_guard lock(mutex_);
    session_ = session;
}

void BenchStop::check() const {
    if (requested_) throw Cancelled();
}

FileBench::FileBench(const Options& options, const std::filesystem::path& path, BenchStop& stop)
    : options_(options), path_(path), stop_(stop), file_(open_scene_file(path, options)) {
    const std::vector<std::uint32_t> lights = choose_lights(file_, options.lights);
    light_count_ = lights.size();
    if (options.rays) rays_ = std::make_unique<RayBench>(options.threads);
    try {
        rows_ = make_bench_rows(options, file_, lights);
    } catch (const InputError& error) {
        if (options.rows.empty()) throw InputError("'" + path.string() + "': " + error.what());
        throw;
    }
    if (options.bits) check_bits_can_be_told(rows_);
}

FileBench::~FileBench() { close_session(); }

void FileBench::open_session() {
    session_ = std::make_unique<Session>(make_session_options(options_));
    info_ = session_->info();
    stop_.watch(session_.get());
    stop_.check();
}

void FileBench::close_session() {
    stop_.watch(nullptr);
    session_.reset();
}

void FileBench::run(Progress& progress, double fraction_start, double fraction_end) {
    const std::string name = path_.filename().string();
    const bool compares = options_.errors || options_.bits;
    const double timed = compares ? kTimedPart : 1.0;
    const auto tell = [&](double fraction, const std::string& text) {
        progress.update(fraction_start + fraction * (fraction_end - fraction_start), name + ": " + text);
    };
    const int rounds = options_.warm_up + options_.repeat;
    for (int round = 0; round < rounds; ++round) {
        for (BenchRow& row : rows_) {
            stop_.check();
            const double done = (round + double(&row - rows_.data()) / double(rows_.size())) / rounds;
            tell(timed * done, row.technique + ", round " + std::to_string(round + 1));
            if (options_.mode == BenchMode::Cold) close_session();
            if (!session_) open_session();
            render(row, round >= options_.warm_up);
        }
        if (rays_ && round >= options_.warm_up) {
            stop_.check();
            rays_->measure(*session_, make_next_request(find_most_samples(rows_)));
        }
    }
    if (!compares) return;
    measure_errors(*session_, rows_, {options_.errors, options_.bits}, options_.threads, stop_.flag(),
                   [&](double fraction) { tell(timed + (1 - timed) * fraction, "errors"); });
}

/// Every render of every row differs from all before, or a row would find the maps of the one before it.
RenderRequest FileBench::make_next_request(const BenchRow& row) {
    RenderRequest request = row.request;
    if (options_.mode == BenchMode::Frame) move_a_trifle(request, ++step_);
    return request;
}

void FileBench::render(BenchRow& row, bool counts) {
    const RenderRequest request = make_next_request(row);
    std::map<std::string, double> cpu, gl;
    const auto add = [&](const RenderStats& stats, const std::string& prefix) {
        for (const StageTime& time : stats.times) {
            cpu[prefix + time.stage] += time.cpu_ms;
            if (time.gl_ms >= 0) gl[prefix + time.stage] += time.gl_ms;
        }
    };
    double layers_ms = 0;
    std::map<std::string, std::int64_t> counters;
    const std::clock_t processor_start = std::clock();
    const Clock::time_point start = Clock::now();
    const FrameResult result = session_->render(request, [&](Layer&& layer) {
        layers_ms += layer.stats.total_ms;
        add(layer.stats, "");
        for (const auto& [name, count] : layer.stats.counters) counters[name] += count;
    });
    const double render_ms = elapsed_ms(start);
    const double processor_ms = 1e3 * double(std::clock() - processor_start) / CLOCKS_PER_SEC;
    add(result.stats, "frame: ");
    if (!counts) return;
    row.render_ms.push_back(render_ms);
    row.processor_ms.push_back(processor_ms);
    row.frame_ms.push_back(result.stats.total_ms);
    row.layers_ms.push_back(layers_ms);
    for (const auto& [stage, ms] : cpu) {
        row.cpu_ms[stage].push_back(ms);
        const auto own = gl.find(stage);
        row.stage_ms[stage].push_back(own == gl.end() ? ms : std::max(ms, own->second));
    }
    for (const auto& [stage, ms] : gl) row.gl_ms[stage].push_back(ms);
    row.counters = std::move(counters);
}

}  // namespace shadow_layers::cli
