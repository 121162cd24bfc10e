// An engine in C++17: bakes a glTF file that it has in memory, and 30 frames that it submits beside its own. engine FOLDER BACKEND
// GLTF
#include "scene.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

void check(LightovenStatus status) {
    if (status != LIGHTOVEN_STATUS_OK) {
        throw std::runtime_error(std::string(lightoven_status_name(status)) + ": " + lightoven_last_error());
    }
}

template <typename T> T sized() {
    T value{};
    value.struct_size = sizeof value;
    return value;
}

/// A handle that is destroyed with its owner.
template <typename T, LightovenStatus (*destroy)(T)> class Owned {
  public:
    Owned() = default;
    Owned(const Owned &) = delete;
    Owned &operator=(const Owned &) = delete;
    ~Owned() { check(destroy(handle)); }
    T *place() { return &handle; }
    operator T() const { return handle; }

  private:
    T handle{};
};

using Scene = Owned<LightovenScene, lightoven_scene_destroy>;
using Baker = Owned<LightovenBaker, lightoven_baker_destroy>;

using Progress = std::function<bool(const LightovenProgress &)>;

std::int32_t call(const LightovenProgress *progress, void *user) {
    return (*static_cast<Progress *>(user))(*progress) ? 0 : 1;
}

std::vector<char> read(const std::filesystem::path &path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void bake(const Engine &engine, const std::filesystem::path &gltf, const std::filesystem::path &folder) {
    const auto bytes = read(gltf);
    const auto beside = gltf.parent_path().string(), name = gltf.stem().string();
    Scene scene;
    check(lightoven_scene_read_gltf_memory(bytes.data(), bytes.size(), name.c_str(), beside.c_str(), nullptr,
                                           scene.place()));
    auto settings = sized<LightovenBakeSettings>();
    check(lightoven_bake_settings_default(&settings));
    settings.resolution = 64;
    Baker baker;
    check(lightoven_baker_create(engine.gpu, scene, &settings, baker.place()));

    auto stop = sized<LightovenStop>();
    stop.samples = 1 << 20;
    int calls = 0;
    std::uint64_t first_ns = 0, last_ns = 0;
    Progress breaks_off = [&](const LightovenProgress &progress) {
        first_ns = calls == 0 ? progress.elapsed_ns : first_ns;
        last_ns = progress.elapsed_ns;
        return ++calls < 3;
    };
    std::uint32_t end = LIGHTOVEN_END_FINISHED;
    check(lightoven_baker_bake(baker, &stop, call, &breaks_off, &end));
    if (end != LIGHTOVEN_END_INTERRUPTED || calls != 3) {
        throw std::runtime_error("the bake was not broken off");
    }
    // On from there, its clock too, with a look in between.
    const auto before_ns = std::exchange(last_ns, 0);
    calls = 0;
    stop.samples = 64;
    check(lightoven_baker_bake_until(baker, &stop, call, &breaks_off, nullptr));
    if (calls == 0 || first_ns < before_ns) {
        throw std::runtime_error("the time of all calls is less than that of one");
    }
    std::vector<float> seen(4 * 64 * 64);
    check(lightoven_baker_read_back(baker, seen.data(), seen.size() / 4));
    check(lightoven_baker_bake_until(baker, &stop, nullptr, nullptr, &end));
    if (end != LIGHTOVEN_END_FINISHED) {
        throw std::runtime_error("the bake did not finish");
    }
    write_pixels(baker, (folder / "gltf.bin").c_str());
    check(lightoven_baker_write_png(baker, (folder / "gltf.png").c_str()));
}

/// A mesh that is placed twice: each place has a rectangle of the light map.
void place_twice(const Engine &engine) {
    const std::vector<LightovenInstance> twice{instances[0], instances[0], instances[1]};
    auto desc = scene_desc;
    desc.instances = twice.data();
    desc.instance_count = twice.size();
    Scene scene;
    check(lightoven_scene_create(&desc, scene.place()));
    auto settings = sized<LightovenBakeSettings>();
    check(lightoven_bake_settings_default(&settings));
    settings.resolution = 128;
    Baker baker;
    check(lightoven_baker_create(engine.gpu, scene, &settings, baker.place()));
    auto atlas = sized<LightovenAtlas>();
    check(lightoven_baker_atlas(baker, &atlas));
    auto one = sized<LightovenAtlasRect>(), other = one;
    check(lightoven_baker_atlas_rect(baker, 0, &one));
    check(lightoven_baker_atlas_rect(baker, 1, &other));
    const bool apart = one.offset[0] != other.offset[0] || one.offset[1] != other.offset[1];
    if (atlas.shared || atlas.rect_count != 3 || !apart || one.scale[0] <= 0) {
        throw std::runtime_error("the atlas is laid out otherwise");
    }
}

/// A cache that is none is left aside, and the log says so.
void damage_the_cache(const Engine &engine, const std::vector<std::string> &messages) {
    auto desc = describe_device(&engine, LIGHTOVEN_BACKEND_SOFTWARE);
    desc.pipeline_cache = "none";
    desc.pipeline_cache_size = 4;
    LightovenGpu gpu{};
    const auto before = messages.size();
    check(lightoven_gpu_create(&desc, &gpu));
    check(lightoven_gpu_destroy(gpu));
    if (messages.size() != before + 1 || messages.back().find("pipeline cache") == std::string::npos) {
        throw std::runtime_error("the log did not say that the pipeline cache is damaged");
    }
}

/// Frames beside which the baker's own submissions run, in order by the timeline.
void frames(const Engine &engine, const std::filesystem::path &folder) {
    Scene scene;
    check(lightoven_scene_create(&scene_desc, scene.place()));
    auto within = sized<LightovenFrameSettings>();
    check(lightoven_frame_settings_default(&within));
    within.clock = LIGHTOVEN_CLOCK_ENGINE;
    within.quanta = 1;
    auto settings = sized<LightovenBakeSettings>();
    check(lightoven_bake_settings_default(&settings));
    settings.resolution = 64;
    settings.frames = &within;
    Baker baker;
    check(lightoven_baker_create(engine.gpu, scene, &settings, baker.place()));
    check(lightoven_baker_set_learning(baker, 0));
    const auto budget = std::chrono::nanoseconds(std::chrono::seconds(1));
    for (std::uint64_t frame = 0; frame < 30; frame++) {
        change_scene(baker, static_cast<int>(frame));
        if (frame == 15) {
            check(lightoven_baker_set_scene(baker, scene));
        }
        const LightovenTimelinePoint wait{sizeof wait, engine.timeline, frame},
            signal{sizeof signal, engine.timeline, frame + 1};
        auto report = sized<LightovenFrameReport>();
        check(lightoven_baker_submit(baker, static_cast<std::uint64_t>(budget.count()), &wait, 1, &signal, 1, &report));
        VkSemaphoreWaitInfo info{};
        info.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO;
        info.semaphoreCount = 1;
        info.pSemaphores = &engine.timeline;
        info.pValues = &signal.value;
        VULKAN(engine.vkWaitSemaphores(engine.device, &info, UINT64_MAX));
        auto timing = sized<LightovenFrameTiming>();
        check(lightoven_baker_complete(baker, report.frame, &timing));
        if (timing.measured_by == LIGHTOVEN_MEASURE_NOTHING || timing.frame != report.frame) {
            throw std::runtime_error("the frame was not measured");
        }
    }
    write_pixels(baker, (folder / "submitted.bin").c_str());
}

} // namespace

int main(int count, char **arguments) {
    if (count != 4) {
        fail("arguments", "FOLDER BACKEND GLTF");
    }
    std::vector<std::string> messages;
    const auto receive_text = [](std::uint32_t, const char *text, void *user) {
        static_cast<std::vector<std::string> *>(user)->emplace_back(text);
    };
    try {
        check(lightoven_set_log(receive_text, &messages));
        Engine engine;
        create_engine(&engine, static_cast<std::uint32_t>(std::stoul(arguments[2])));
        bake(engine, arguments[3], arguments[1]);
        frames(engine, arguments[1]);
        place_twice(engine);
        damage_the_cache(engine, messages);
        destroy_engine(&engine);
        check(lightoven_set_log(nullptr, nullptr));
    } catch (const std::exception &error) {
        fail("engine", error.what());
    }
    for (const auto &message : messages) {
        std::printf("logged: %s\n", message.c_str());
    }
    return 0;
}
