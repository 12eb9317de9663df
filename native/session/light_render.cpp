// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/light_render.h"

#include <span>

#include "lights/facing.h"
#include "lights/light_shape.h"

namespace shadow_layers {
namespace {

LightTask make_task(const LightJob& job, const LightSample& sample) {
    return {job.frame, job.frames, job.light, sample, job.parameters, job.picture_sample};
}

/// Can the technique find a shadow there? Not without a receiver that is turned to the light.
bool has_receivers(const LightJob& job, const LightSample& sample) {
    return job.needs.map_size == 0 || job.needs.sees_moved_frames || !sample.views.empty();
}

/// The layer without any shadow. Channels other than the visibility are 0 then.
void answer_unshadowed(Engine& engine, const LightJob& job, std::span<const LightSample> samples,
                       LayerOutputs& outputs) {
    const auto timer = engine.time_stage("unshadowed");
    for (const OutputSpec& output : job.descriptor.outputs) {
        Image image{job.frame.width, job.frame.height, output.channels, {}};
        image.data.assign(job.frame.pixel_count() * std::size_t(output.channels), 0.0f);
        if (output.id == "visibility")
            fill_unoccluded_visibility(job.frame, job.light, samples, image.data, &engine.threads());
        outputs.set(output.id, std::move(image));
    }
}

/// Of all samples that stand for the light.
void answer_unshadowed(Engine& engine, const LightJob& job, LayerOutputs& outputs) {
    answer_unshadowed(engine, job, sample_light_shape(job.light, job.needs.light_samples, job.needs.light_pattern),
                      outputs);
}

}  // namespace

/// Adds up what the technique sets for one sample after the other.
class LightRender::MeanOutputs final : public LayerOutputs {
public:
    MeanOutputs(Engine& engine, const LightJob& job, LightRender& owner) : engine_(engine), job_(job), owner_(owner) {
        owner_.mean_.begin(engine_, job_.frame);
    }

    void begin_sample(const LightSample& sample) { sample_ = &sample; }

    void set(const std::string& channel, const gl::Texture& texture) override {
        if (channel == "visibility")
            owner_.mean_.add(engine_, job_.frame, job_.light, *sample_, texture);
        else
            add(channel, texture.download<float>());
    }
    void set(const std::string& channel, Image image) override {
        if (channel == "visibility")
            set(channel, owner_.upload_.put(engine_, image));
        else
            add(channel, image.data);
    }

    void finish(int count, LayerOutputs& outputs) {
        outputs.set("visibility", owner_.mean_.finish(engine_, job_.frame));
        for (const OutputSpec& output : job_.descriptor.outputs) {
            const auto found = sums_.find(output.id);
            if (found == sums_.end()) continue;
            for (float& value : found->second) value /= float(count);
            outputs.set(output.id, Image{job_.frame.width, job_.frame.height, output.channels, found->second});
        }
    }

private:
    void add(const std::string& channel, const std::vector<float>& values) {
        std::vector<float>& sum = sums_[channel];
        sum.resize(values.size());
        for (std::size_t i = 0; i < values.size(); ++i) sum[i] += values[i];
    }

    Engine& engine_;
    const LightJob& job_;
    LightRender& owner_;
    const LightSample* sample_ = nullptr;
    std::map<std::string, std::vector<float>> sums_;
};

void LightRender::render(Engine& engine, Technique& technique, const LightJob& job, const LightSamples& samples,
                         LayerOutputs& outputs) {
    if (job.needs.light_samples > 1 && !job.needs.samples_itself) engine.count("light_samples", samples.count);
    if (!job.light.casts_shadow) return answer_unshadowed(engine, job, outputs);
    if (samples.count > 1) return render_many(engine, technique, job, samples, outputs);
    const auto sample = samples.get(0);
    if (has_receivers(job, *sample))
        technique.render(engine, make_task(job, *sample), outputs);
    else
        answer_unshadowed(engine, job, outputs);
}

void LightRender::render_many(Engine& engine, Technique& technique, const LightJob& job, const LightSamples& samples,
                              LayerOutputs& outputs) {
    MeanOutputs mean(engine, job, *this);
    bool is_seen = false;
    for (int i = 0; i < samples.count; ++i) {
        engine.check_cancelled();
        engine.set_progress_part(double(i) / samples.count, double(i + 1) / samples.count);
        engine.tell_progress(0);
        const auto sample = samples.get(i);
        mean.begin_sample(*sample);
        if (has_receivers(job, *sample)) {
            technique.render(engine, make_task(job, *sample), mean);
            is_seen = true;
        } else {
            answer_unshadowed(engine, job, std::span(sample.get(), 1), mean);
        }
        engine.limit_queue();  // or the maps of all samples would be held until the last is drawn
    }
    engine.set_progress_part(0, 1);
    if (is_seen)
        mean.finish(samples.count, outputs);
    else
        answer_unshadowed(engine, job, outputs);
}

}  // namespace shadow_layers
