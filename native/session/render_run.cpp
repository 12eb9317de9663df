// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/render_run.h"

#include "frame/pixel_filter.h"
#include "session/caster_check.h"
#include "session/frame_pictures.h"
#include "session/frame_set.h"
#include "session/layer_sum.h"
#include "session/light_render.h"
#include "session/map_views.h"
#include "session/request_check.h"
#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

// Sums of many-sample layers held at once. More jobs than that are worked in several passes over the samples.
constexpr std::size_t kSumBytes = std::size_t{256} << 20;

class RenderRun {
public:
    RenderRun(Engine& engine, const std::shared_ptr<FramePool>& pool, TechniqueSet& techniques,
              const RenderRequest& request, const RenderOutlet& outlet)
        : engine_(engine),
          techniques_(techniques),
          request_(request),
          outlet_(outlet),
          resolved_(resolve_request(request, engine.limits(), techniques.descriptors())),
          offsets_(make_sample_offsets(request.filter, request.samples)),
          frames_(engine, pool, request, resolved_.region),
          pictures_(engine.threads(), request, resolved_.region),
          records_(resolved_.jobs.size()),
          views_(resolved_.jobs.size()),
          sums_(resolved_.jobs.size()) {}

    FrameResult run();

private:
    struct Batch {
        std::size_t begin, end;
    };
    std::vector<Batch> cut_batches() const;
    void run_sample(const Batch& batch, std::size_t sample);
    void run_job(std::size_t job, std::size_t sample, LayerSum& sum);
    void fill_layer(std::size_t job, FrameSet::Part& part, LayerSum& sum, std::size_t sample);
    FrameSet::Part& get_frames(int overscan_px);
    void deliver(std::size_t job, LayerSum& sum);
    bool is_last_use(std::size_t job, std::size_t sample) const;
    bool is_first_of_light(std::size_t job) const;
    void begin_step(const std::string& text);

    Engine& engine_;
    TechniqueSet& techniques_;
    const RenderRequest& request_;
    const RenderOutlet& outlet_;
    ResolvedRequest resolved_;
    std::vector<glm::dvec2> offsets_;
    FrameSet frames_;
    LightRender light_render_;
    FramePictures pictures_;
    StageRecord frame_record_;
    std::vector<StageRecord> records_;
    std::vector<std::vector<MapView>> views_;
    std::vector<std::unique_ptr<LayerSum>> sums_;
    std::size_t steps_begun_ = 0;
};

FrameResult RenderRun::run() {
    engine_.begin_render();
    techniques_.begin_render();
    for (const Batch& batch : cut_batches()) {
        for (std::size_t sample = 0; sample < offsets_.size(); ++sample) run_sample(batch, sample);
        frames_.clear_lights();
    }
    FrameResult result;
    result.camera_position = glm::dvec3(request_.camera.world_from_camera[3]);
    pictures_.finish(result);
    engine_.check_gl("the end of the render");
    result.warnings = engine_.take_warnings();
    frame_record_.count("mesh_data_bytes", std::int64_t(engine_.mesh_data().bytes()));
    result.stats = frame_record_.stats();
    return result;
}

std::vector<RenderRun::Batch> RenderRun::cut_batches() const {
    std::vector<Batch> batches;
    Batch batch{0, 0};
    std::size_t bytes = 0;
    for (std::size_t job = 0; job < resolved_.jobs.size(); ++job) {
        const std::size_t needed = LayerSum::bytes_needed(*resolved_.jobs[job].descriptor, resolved_.region);
        // With one sample a layer is delivered before the next one starts.
        if (request_.samples > 1 && bytes + needed > kSumBytes && batch.end > batch.begin) {
            batches.push_back(batch);
            batch.begin = job;
            bytes = 0;
        }
        bytes += needed;
        batch.end = job + 1;
    }
    batches.push_back(batch);  // also without jobs: the frame itself is wanted
    return batches;
}

void RenderRun::run_sample(const Batch& batch, std::size_t sample) {
    engine_.set_record(&frame_record_);
    const WallClock clock;
    if (batch.begin == 0) begin_step("frame");
    frames_.begin_sample(offsets_[sample]);
    const Frame& frame = frames_.get(resolved_.overscan_px).frames->centre();
    if (batch.begin == 0) pictures_.add_frame(frame, sample);
    frame_record_.add_total_ms(clock.elapsed_ms());
    for (std::size_t job = batch.begin; job < batch.end; ++job) {
        auto& sum = sums_[job];
        if (!sum)
            sum = std::make_unique<LayerSum>(engine_.threads(), *resolved_.jobs[job].descriptor, request_.samples);
        run_job(job, sample, *sum);
        if (sample + 1 == offsets_.size()) {
            deliver(job, *sum);
            sum.reset();
        }
    }
    engine_.set_record(nullptr);
}

/// What frames take is view_info of the frame, not of the layer that happens to be the first to want them.
FrameSet::Part& RenderRun::get_frames(int overscan_px) {
    const WallClock clock;
    FrameSet::Part& part = frames_.get(overscan_px);
    frame_record_.add_total_ms(clock.elapsed_ms());
    return part;
}

void RenderRun::run_job(std::size_t job, std::size_t sample, LayerSum& sum) {
    const ResolvedJob& resolved = resolved_.jobs[job];
    const Light& light = request_.scene->lights[resolved.light];
    begin_step("light \"" + light.name + "\", " + resolved.descriptor->label);
    FrameSet::Part& part = get_frames(resolved.needs.overscan_px);
    engine_.set_record(&records_[job]);
    const WallClock clock;
    fill_layer(job, part, sum, sample);
    records_[job].add_total_ms(clock.elapsed_ms());
    engine_.set_record(&frame_record_);
    if (!pictures_.has_clay() || !is_first_of_light(job)) return;
    const WallClock clay_clock;
    {
        const auto timer = engine_.time_stage("clay");
        pictures_.add_light(frames_.get(resolved_.overscan_px).frames->centre(), light, sum.visibility());
    }
    frame_record_.add_total_ms(clay_clock.elapsed_ms());
}

void RenderRun::fill_layer(std::size_t job, FrameSet::Part& part, LayerSum& sum, std::size_t sample) {
    const ResolvedJob& resolved = resolved_.jobs[job];
    const Light& light = request_.scene->lights[resolved.light];
    Technique& technique = techniques_.get(resolved.descriptor->id);
    technique.prepare(engine_, resolved.parameters);
    SampleFrames& frames = *part.frames;
    LightSamples samples = part.lights.get(resolved.light, resolved.needs);
    if (sample == 0) {
        warn_of_open_casters(engine_, *resolved.descriptor, *request_.scene, light);
        samples.get = [this, job, get = std::move(samples.get)](int index) {
            auto light_sample = get(index);
            if (index == 0) views_[job] = describe_views(*light_sample);
            return light_sample;
        };
    }
    sum.begin_sample(frames.centre());
    light_render_.render(
        engine_, technique,
        {frames.centre(), frames, light, *resolved.descriptor, resolved.parameters, resolved.needs, int(sample)},
        samples, sum);
    if (is_last_use(job, sample)) frames_.forget(resolved.light);
    engine_.check_gl(resolved.descriptor->id.c_str());
    const auto timer = engine_.time_stage("layer_sum");
    sum.end_sample();
}

bool RenderRun::is_last_use(std::size_t job, std::size_t sample) const {
    const auto& jobs = resolved_.jobs;
    return sample + 1 == offsets_.size() && (job + 1 == jobs.size() || jobs[job + 1].light != jobs[job].light);
}

void RenderRun::deliver(std::size_t job, LayerSum& sum) {
    Layer layer;
    layer.job = std::uint32_t(job);
    layer.parameters = resolved_.jobs[job].parameters;
    layer.channels = sum.take();
    layer.views = std::move(views_[job]);
    layer.stats = records_[job].stats();
    outlet_.deliver(std::move(layer));
    engine_.check_cancelled();
}

bool RenderRun::is_first_of_light(std::size_t job) const {
    for (std::size_t i = 0; i < job; ++i)
        if (resolved_.jobs[i].light == resolved_.jobs[job].light) return false;
    return true;
}

/// Tells of the step that begins, and of its parts as whatever works on it tells the engine.
void RenderRun::begin_step(const std::string& text) {
    const double begin = double(steps_begun_++), steps = double(offsets_.size() * (resolved_.jobs.size() + 1));
    if (outlet_.progress) {
        outlet_.progress(begin / steps, text);
        engine_.set_progress([=, this](double fraction) { outlet_.progress((begin + fraction) / steps, text); });
    }
    engine_.check_cancelled();
}

}  // namespace

FrameResult run_render(Engine& engine, const std::shared_ptr<FramePool>& pool, TechniqueSet& techniques,
                       const RenderRequest& request, const RenderOutlet& outlet) {
    struct Reset {
        Engine& engine;
        ~Reset() {
            engine.set_record(nullptr);
            engine.set_progress(nullptr);
        }
    } reset{engine};
    engine.take_warnings();
    engine.drop_errors();
    try {
        return RenderRun(engine, pool, techniques, request, outlet).run();
    } catch (...) {
        // Work that a cancel breaks off may fail in other ways first: pictures that are half done, memory, the driver.
        engine.cancel_token().check();
        throw;
    }
}

}  // namespace shadow_layers
