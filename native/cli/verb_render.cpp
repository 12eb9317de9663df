// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cstdio>
#include <set>

#include "cli/describe.h"
#include "cli/interrupt.h"
#include "cli/jobs.h"
#include "cli/progress.h"
#include "cli/verbs.h"
#include "io/image_writer.h"
#include "io/whole_file.h"
#include "shadow_layers/error.h"
#include "shadow_layers/names.h"

namespace shadow_layers::cli {
namespace {

// Names of one kind (EXR layers, files), made unique by a number.
class Namer {
public:
    std::string make(const std::string& wished) {
        std::string name = wished;
        for (int number = 2; !given_.insert(name).second; ++number) name = wished + "~" + std::to_string(number);
        return name;
    }

private:
    std::set<std::string> given_;
};

// Dots separate layers and channels in EXR files.
std::string clean_for_exr(std::string text) {
    for (char& c : text) {
        if (c == '.' || (static_cast<unsigned char>(c) < 32)) c = '_';
    }
    return text;
}

std::string clean_for_files(std::string text) {
    for (char& c : text) {
        if (static_cast<unsigned char>(c) < 33 || std::string_view("<>:\"/\\|?*.").find(c) != std::string_view::npos)
            c = '_';
    }
    return text.empty() ? "layer" : text.substr(0, 80);
}

// One output of one job: where it goes.
struct PlannedOutput {
    std::size_t job = 0;
    OutputSpec spec;
    std::string channel, picture;
};

// The layers of a render on their way to the files. A layer is written and dropped as it comes.
class RenderFiles {
public:
    RenderFiles(const Options& options, const io::SceneFile& file, const RenderRequest& request,
                const SessionInfo& info)
        : options_(options), file_(file), request_(request), info_(info) {
        const std::string view_layer = file.source.value("view_layer", std::string());
        view_layer_ = view_layer.empty() ? "ViewLayer" : clean_for_exr(view_layer);
        frame_ = file.source.value("frame", 1);
        layers_ = nlohmann::json::array();
        plan();
    }

    void write_layer(Layer&& layer) {
        const LayerJob& job = request_.jobs[layer.job];
        const Light& light = request_.scene->lights[job.light];
        for (; next_ < outputs_.size() && outputs_[next_].job == layer.job; ++next_) {
            const PlannedOutput& output = outputs_[next_];
            const Image& image = layer.channels.at(output.spec.id);
            exr_->write(image);
            io::write_png(options_.out / output.picture, image);
            layers_.push_back({{"light", light.name},
                               {"light_kind", get_name(light.kind)},
                               {"technique", job.technique},
                               {"frame", frame_},
                               {"view_layer", view_layer_},
                               {"settings", parameters_to_json(layer.parameters)},
                               {"time_ms", cpu_times_to_json(layer.stats)},
                               {"gl_ms", gl_times_to_json(layer.stats)},
                               {"total_ms", round_ms(layer.stats.total_ms)},
                               {"counters", layer.stats.counters},
                               {"output", output.spec.id},
                               {"file", kExrName},
                               {"channel", output.channel},
                               {"picture", output.picture}});
        }
    }

    void finish(const FrameResult& result) {
        exr_->write(result.combined);
        exr_->write(result.coverage);
        exr_->finish();
        io::write_png(options_.out / kCombinedName, result.combined);
        for (const std::string& warning : result.warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
        write_json(result);
        std::printf("%zu layers are in %s, listed in %s\n", layers_.size(), options_.out.c_str(), json_path().c_str());
    }

private:
    static constexpr const char *kExrName = "layers.exr", *kCombinedName = "combined.png";

    std::filesystem::path json_path() const {
        return options_.json.empty() ? options_.out / "render.json" : options_.json;
    }

    void plan() {
        Namer layer_names, file_names;
        layer_names.make("Combined");
        layer_names.make("Coverage");
        file_names.make("combined");
        std::vector<io::ExrLayer> layers;
        for (std::size_t j = 0; j < request_.jobs.size(); ++j) {
            const LayerJob& job = request_.jobs[j];
            const TechniqueDescriptor& technique = find_technique_descriptor(job.technique);
            const std::string& light = request_.scene->lights[job.light].name;
            for (const OutputSpec& spec : technique.outputs) {
                const std::string tail = spec.id == "visibility" ? "" : " " + spec.id;
                io::ExrLayer layer = make_layer(
                    layer_names.make("Shadow " + clean_for_exr(light) + " " + technique.id + tail), spec.channels);
                layer.metadata["shadow_layers.light"] = light;
                layer.metadata["shadow_layers.technique"] = technique.id;
                layer.metadata["shadow_layers.output"] = spec.id;
                layer.metadata["shadow_layers.settings"] =
                    parameters_to_json(resolve_parameters(technique, job.parameters)).dump();
                outputs_.push_back({j, spec, io::get_channel_list(layer),
                                    file_names.make(clean_for_files(light + "_" + technique.id +
                                                                    (tail.empty() ? "" : "_" + spec.id))) +
                                        ".png"});
                layers.push_back(std::move(layer));
            }
        }
        layers.push_back(make_layer("Combined", 4));
        layers.push_back(make_layer("Coverage", 1));
        const PixelRect& region = request_.region;
        const PixelRect whole = region.width > 0 ? region : PixelRect{0, 0, request_.width, request_.height};
        exr_ = std::make_unique<io::ExrWriter>(options_.out / kExrName, request_.width, request_.height, whole,
                                               std::move(layers));
    }

    io::ExrLayer make_layer(const std::string& name, int channels) const {
        io::ExrLayer layer{view_layer_ + "." + name, channels, {}};
        layer.metadata["shadow_layers.version"] = std::string(version()) + " (" + revision() + ")";
        layer.metadata["shadow_layers.gl"] = info_.backend + ": " + info_.gl_renderer;
        layer.metadata["shadow_layers.samples"] = std::to_string(request_.samples);
        return layer;
    }

    /// x, y, width, height of what was rendered; an empty region in the request stands for the whole picture.
    static std::array<int, 4> region_of(const RenderRequest& request) {
        const PixelRect& region = request.region;
        if (region.width == 0 && region.height == 0) return {0, 0, request.width, request.height};
        return {region.x, region.y, region.width, region.height};
    }

    void write_json(const FrameResult& result) const {
        nlohmann::json document = versions_to_json(info_);
        document["schema"] = "shadow-layers-render";
        document["schema_version"] = 1;
        document["file"] = options_.files.front().filename().string();
        document["scene"] = file_.source.value("scene", "");
        document["camera"] = options_.camera;
        document["source"] = file_.source;
        std::vector<std::string> warnings = file_.warnings;
        warnings.insert(warnings.end(), result.warnings.begin(), result.warnings.end());
        document["frames"] = nlohmann::json::array({{{"frame", frame_},
                                                     {"view_layer", view_layer_},
                                                     {"camera", options_.camera},
                                                     {"resolution", {request_.width, request_.height}},
                                                     {"region", region_of(request_)},
                                                     {"samples", request_.samples},
                                                     {"triangles", count_triangles(*request_.scene)},
                                                     {"instances", request_.scene->instances.size()},
                                                     {"time_ms", cpu_times_to_json(result.stats)},
                                                     {"gl_ms", gl_times_to_json(result.stats)},
                                                     {"total_ms", round_ms(result.stats.total_ms)},
                                                     {"warnings", warnings},
                                                     {"file", kExrName},
                                                     {"coverage_channel", view_layer_ + ".Coverage.X"},
                                                     {"picture", kCombinedName}}});
        document["layers"] = layers_;
        io::write_whole_file(json_path(), document.dump(1) + "\n");
    }

    const Options& options_;
    const io::SceneFile& file_;
    const RenderRequest& request_;
    const SessionInfo& info_;
    std::string view_layer_;
    int frame_ = 1;
    std::vector<PlannedOutput> outputs_;
    std::size_t next_ = 0;
    std::unique_ptr<io::ExrWriter> exr_;
    nlohmann::json layers_;
};

}  // namespace

void run_render(const Options& options) {
    io::SceneFile file = open_scene_file(options.files.front(), options);
    RenderRequest request = make_request(file);
    const std::size_t said = file.warnings.size();
    request.jobs = make_jobs(file, options, file.warnings);
    for (std::size_t i = said; i < file.warnings.size(); ++i)
        std::fprintf(stderr, "warning: %s\n", file.warnings[i].c_str());
    io::make_output_folder(options.out);
    const HeldSignals signals;
    Session session(make_session_options(options));
    const Interrupt interrupt(signals, [&] { session.cancel(); });
    RenderFiles files(options, file, request, session.info());
    Progress progress;
    const FrameResult result = session.render(
        request, [&](Layer&& layer) { files.write_layer(std::move(layer)); },
        [&](double fraction, const std::string& text) { progress.update(fraction, text); });
    progress.clear();
    files.finish(result);
}

}  // namespace shadow_layers::cli
