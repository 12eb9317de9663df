// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/render_run.h"

#include <algorithm>
#include <optional>

#include "frame/clay.h"
#include "frame/pixel_filter.h"
#include "lights/facing.h"
#include "session/caster_check.h"
#include "session/layer_sum.h"
#include "session/light_cache.h"
#include "session/request_check.h"
#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

// Sums of many-sample layers held at once. More jobs than that are worked in several passes over the samples.
constexpr std::size_t kSumBytes = std::size_t{256} << 20;

/// What is told of the views of a position.
std::vector<MapView> describe_views(const LightSample& position) {
    std::vector<MapView> views;
    for (const LightView& view : position.views) {
        MapView& told = views.emplace_back();
        told.perspective = view.perspective;
        told.face = position.cube ? int(view.face) : -1;
        for (int i = 0; i < 2; ++i) {
            const double half = 1 / view.lc_from_ls[i][i];
            told.corner[i] = half * (view.perspective ? view.lc_from_ls[2][i] : -view.lc_from_ls[3][i]) - half;
            told.texel_size[i] = 2 * half / view.size_texels;
        }
        told.view_from_world = view.ls_from_ws;
    }
    return views;
}

std::size_t region_pixels(const PixelRect& region) { return std::size_t(region.width) * std::size_t(region.height); }

/// Calls body(region pixel, frame pixel) for the region's pixels.
template <class Body>
void for_each_pixel(const Frame& frame, const Body& body) {
    const auto overscan = std::size_t(frame.overscan_px);
    for (std::size_t y = 0, pixel = 0; y < std::size_t(frame.region.height); ++y) {
        std::size_t from = (y + overscan) * std::size_t(frame.width) + overscan;
        for (std::size_t x = 0; x < std::size_t(frame.region.width); ++x) body(pixel++, from++);
    }
}

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
          maker_(
              engine, pool,
              {request.scene, request.camera, request.width, request.height, resolved_.region, resolved_.overscan_px}),
          lights_(engine, request.samples > 1),
          records_(resolved_.jobs.size()) {}

    FrameResult run();

private:
    struct Batch {
        std::size_t begin, end;
    };
    std::vector<Batch> cut_batches() const;
    void run_sample(const Batch& batch, std::size_t sample);
    void run_job(std::size_t job, std::size_t sample, SampleFrames& frames, LayerSum& sum);
    void fill_layer(std::size_t job, SampleFrames& frames, LayerSum& sum, std::size_t sample);
    void answer_unshadowed(const ResolvedJob& job, const Frame& frame, const std::vector<LightSample>& positions,
                           LayerSum& sum);
    void deliver(std::size_t job, LayerSum& sum);
    void add_frame(const Frame& frame, std::size_t sample);
    void add_aux(const Frame& frame);
    bool is_first_of_light(std::size_t job) const;
    void tell_progress(const std::string& text);

    Engine& engine_;
    TechniqueSet& techniques_;
    const RenderRequest& request_;
    const RenderOutlet& outlet_;
    ResolvedRequest resolved_;
    std::vector<glm::dvec2> offsets_;
    FrameMaker maker_;
    LightCache lights_;
    StageRecord frame_record_;
    std::vector<StageRecord> records_;
    std::vector<std::vector<MapView>> views_;
    std::vector<std::unique_ptr<LayerSum>> sums_;
    std::optional<ClayPicture> clay_;
    FrameResult result_;
    std::size_t steps_done_ = 0;
};

FrameResult RenderRun::run() {
    engine_.begin_render();
    techniques_.begin_render();
    const PixelRect& region = resolved_.region;
    result_.camera_position = glm::dvec3(request_.camera.world_from_camera[3]);
    result_.coverage = {region.width, region.height, 1, std::vector<float>(region_pixels(region), 0.0f)};
    if (request_.combined) clay_.emplace(region.width, region.height);
    sums_.resize(resolved_.jobs.size());
    views_.resize(resolved_.jobs.size());
    for (const Batch& batch : cut_batches()) {
        for (std::size_t sample = 0; sample < offsets_.size(); ++sample) run_sample(batch, sample);
        lights_.clear();
    }
    for (float& value : result_.coverage.data) value /= float(offsets_.size());
    if (clay_) result_.combined = clay_->take();
    engine_.check_gl("the end of the render");
    result_.warnings = engine_.take_warnings();
    frame_record_.count("mesh_data_bytes", std::int64_t(engine_.mesh_data().bytes()));
    result_.stats = frame_record_.stats();
    return std::move(result_);
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
    if (batch.begin == 0) tell_progress("frame");
    SampleFrames frames(maker_, offsets_[sample]);
    if (batch.begin == 0) add_frame(frames.centre(), sample);
    frame_record_.add_total_ms(clock.elapsed_ms());
    lights_.begin_sample(frames.centre());
    for (std::size_t job = batch.begin; job < batch.end; ++job) {
        auto& sum = sums_[job];
        if (!sum)
            sum = std::make_unique<LayerSum>(engine_.threads(), *resolved_.jobs[job].descriptor, request_.samples);
        run_job(job, sample, frames, *sum);
        if (sample + 1 == offsets_.size()) {
            deliver(job, *sum);
            sum.reset();
        }
    }
    engine_.set_record(nullptr);
}

void RenderRun::run_job(std::size_t job, std::size_t sample, SampleFrames& frames, LayerSum& sum) {
    const ResolvedJob& resolved = resolved_.jobs[job];
    const Light& light = request_.scene->lights[resolved.light];
    tell_progress("light \"" + light.name + "\", " + resolved.descriptor->label);
    engine_.set_record(&records_[job]);
    const WallClock clock;
    fill_layer(job, frames, sum, sample);
    records_[job].add_total_ms(clock.elapsed_ms());
    engine_.set_record(&frame_record_);
    if (!clay_ || !is_first_of_light(job)) return;
    const WallClock clay_clock;
    {
        const auto timer = engine_.time_stage("clay");
        clay_->add_light(engine_.threads(), frames.centre(), light, sum.visibility(), 1.0f / float(offsets_.size()));
    }
    frame_record_.add_total_ms(clay_clock.elapsed_ms());
}

void RenderRun::fill_layer(std::size_t job, SampleFrames& frames, LayerSum& sum, std::size_t sample) {
    const ResolvedJob& resolved = resolved_.jobs[job];
    const Light& light = request_.scene->lights[resolved.light];
    const Frame& frame = frames.centre();
    Technique& technique = techniques_.get(resolved.descriptor->id);
    technique.prepare(engine_, resolved.parameters);
    const bool is_last_use = sample + 1 == offsets_.size() &&
                             (job + 1 == resolved_.jobs.size() || resolved_.jobs[job + 1].light != resolved.light);
    const auto positions = lights_.get(resolved.light, resolved.needs, is_last_use);
    if (sample == 0) {
        views_[job] = describe_views(positions->front());
        warn_of_open_casters(engine_, *resolved.descriptor, *request_.scene, light);
    }
    sum.begin_sample(frame);
    const auto has_views = [](const LightSample& position) { return !position.views.empty(); };
    const bool is_seen = resolved.needs.map_size == 0 || std::any_of(positions->begin(), positions->end(), has_views);
    if (light.casts_shadow && is_seen)
        technique.render(engine_, {frame, frames, light, *positions, resolved.parameters}, sum);
    else
        answer_unshadowed(resolved, frame, *positions, sum);
    engine_.check_gl(resolved.descriptor->id.c_str());
    const auto timer = engine_.time_stage("layer_sum");
    sum.end_sample();
}

/// Without shadows, or without a receiver that is turned to the light, there is nothing for a technique to find.
/// Channels other than the visibility are 0 then.
void RenderRun::answer_unshadowed(const ResolvedJob& job, const Frame& frame, const std::vector<LightSample>& positions,
                                  LayerSum& sum) {
    const auto timer = engine_.time_stage("unshadowed");
    for (const OutputSpec& output : job.descriptor->outputs) {
        Image image{frame.width, frame.height, output.channels, {}};
        image.data.assign(frame.pixel_count() * std::size_t(output.channels), 0.0f);
        if (output.id == "visibility")
            fill_unoccluded_visibility(frame, request_.scene->lights[job.light], positions, image.data,
                                       &engine_.threads());
        sum.set(output.id, std::move(image));
    }
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

void RenderRun::add_frame(const Frame& frame, std::size_t sample) {
    for_each_pixel(frame, [&](std::size_t pixel, std::size_t from) {
        result_.coverage.data[pixel] += float(frame.coverage[from]);
    });
    if (clay_) clay_->add_surface(engine_.threads(), frame, 1.0f / float(offsets_.size()));
    if (sample == 0) add_aux(frame);
}

void RenderRun::add_aux(const Frame& frame) {
    const PixelRect& region = resolved_.region;
    const glm::vec3 forward(-glm::dvec3(frame.camera.world_from_camera[2]));
    for (const std::string& name : request_.aux) {
        const int channels = name == "depth" ? 1 : name == "ids" ? 2 : 3;
        Image image{region.width, region.height, channels, {}};
        image.data.resize(region_pixels(region) * std::size_t(channels));
        for_each_pixel(frame, [&](std::size_t pixel, std::size_t from) {
            float* out = image.data.data() + pixel * std::size_t(channels);
            const PixelIds& ids = frame.ids[from];
            const bool is_empty = ids.instance == kNoId;
            const glm::vec3& value = name == "normal" ? frame.normals[from] : frame.positions_rel[from];
            if (name == "depth")
                out[0] = glm::dot(frame.positions_rel[from], forward);
            else if (name == "ids")
                out[0] = is_empty ? -1.0f : float(ids.instance), out[1] = is_empty ? -1.0f : float(ids.triangle);
            else
                out[0] = value.x, out[1] = value.y, out[2] = value.z;
        });
        result_.aux[name] = std::move(image);
    }
}

bool RenderRun::is_first_of_light(std::size_t job) const {
    for (std::size_t i = 0; i < job; ++i)
        if (resolved_.jobs[i].light == resolved_.jobs[job].light) return false;
    return true;
}

void RenderRun::tell_progress(const std::string& text) {
    const std::size_t steps = offsets_.size() * (resolved_.jobs.size() + 1);
    if (outlet_.progress) outlet_.progress(double(steps_done_) / double(steps), text);
    ++steps_done_;
    engine_.check_cancelled();
}

}  // namespace

TechniqueSet::TechniqueSet(std::vector<TechniqueEntry> entries) : entries_(std::move(entries)) {
    for (const TechniqueEntry& entry : entries_) descriptors_.push_back(entry.describe());
}

Technique& TechniqueSet::get(const std::string& id) {
    Made& made = made_[id];
    made.last_render = render_;
    for (std::size_t i = 0; i < entries_.size() && !made.technique; ++i)
        if (descriptors_[i].id == id) made.technique = entries_[i].make();
    return *made.technique;
}

void TechniqueSet::begin_render() {
    ++render_;
    std::erase_if(made_, [&](const auto& entry) { return entry.second.last_render + kKeptRenders < render_; });
}

FrameResult run_render(Engine& engine, const std::shared_ptr<FramePool>& pool, TechniqueSet& techniques,
                       const RenderRequest& request, const RenderOutlet& outlet) {
    struct Reset {
        Engine& engine;
        ~Reset() { engine.set_record(nullptr); }
    } reset{engine};
    engine.take_warnings();
    engine.drop_errors();
    return RenderRun(engine, pool, techniques, request, outlet).run();
}

}  // namespace shadow_layers
