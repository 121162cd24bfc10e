/* An engine in C: bakes at a stretch, and within 30 frames in which the square moves. engine FOLDER BACKEND */
#include "scene.h"

static void path_in(char *path, size_t size, const char *folder, const char *name) {
    snprintf(path, size, "%s/%s", folder, name);
}

static int32_t count_calls(const LightovenProgress *progress, void *calls) {
    if (progress->struct_size != sizeof *progress || progress->fraction < 0 || progress->fraction > 1) {
        fail("progress", "is none");
    }
    *(int *)calls += 1;
    return 0;
}

/* What the baker does without, a line each. */
static void write_left_out(LightovenBaker baker, uint32_t count, const char *path) {
    FILE *file = fopen(path, "w");
    if (!file) {
        fail(path, "cannot be written");
    }
    for (uint32_t index = 0; index < count; index++) {
        char words[256];
        uint64_t bytes = 0;
        size_t length = 0;
        LIGHTOVEN(lightoven_baker_left_out(baker, index, words, sizeof words, &length, &bytes));
        LIGHTOVEN(lightoven_baker_left_out(baker, index, words, sizeof words, NULL, NULL));
        if (length != strlen(words) || fprintf(file, "%s: %llu\n", words, (unsigned long long)bytes) < 0) {
            fail(path, "cannot be written");
        }
    }
    if (fclose(file) != 0) {
        fail(path, "cannot be written");
    }
}

/* How rays were sent. */
static void check_sampling(const LightovenStatistics *done) {
    const float shares = done->cosine_share + done->source_share + done->sky_share;
    const uint64_t rays = done->cosine_rays + done->source_rays + done->sky_rays;
    if (shares < .999f || shares > 1.001f || rays != done->rays || done->cosine_rays == 0 || done->source_rays == 0) {
        fail("the rays", "are not those that were traced");
    }
    if (done->source_seen <= 0 || done->source_seen > 1 || done->evenness <= 0 || done->evenness > 1 || done->power <= 0) {
        fail("what rays are aimed at", "is not told");
    }
    if (done->most_samples != 128 || done->area <= 0 || done->pyramids == 0 || done->unaimed_texels != 0 || done->dark) {
        fail("the statistics", "are not those of the bake");
    }
    if (done->bvh_ns == 0 || done->gbuffer_ns == 0 || done->bake_ns == 0 || done->compile_ns == 0) {
        fail("the times", "are not told");
    }
}

static void bake(Engine *engine, LightovenScene scene, const char *folder) {
    SIZED(LightovenBakeSettings, settings);
    LIGHTOVEN(lightoven_bake_settings_default(&settings));
    settings.resolution = 64;
    settings.seed = 7;
    SIZED(LightovenEstimate, estimate);
    LIGHTOVEN(lightoven_estimate_memory(scene, &settings, &estimate));
    const int sized = estimate.width == 64 && estimate.height == 64 && estimate.covered_texels > 1000;
    if (!sized || estimate.held_bytes < 64 * 64 * 16 || estimate.most_bytes <= estimate.held_bytes) {
        fail("the estimate", "is none");
    }
    LightovenBaker baker = {0};
    LIGHTOVEN(lightoven_baker_create(engine->gpu, scene, &settings, &baker));
    SIZED(LightovenStop, stop);
    stop.samples = 128;
    int calls = 0;
    uint32_t end = LIGHTOVEN_END_INTERRUPTED;
    LIGHTOVEN(lightoven_baker_bake(baker, &stop, count_calls, &calls, &end));
    if (calls == 0 || end != LIGHTOVEN_END_FINISHED) {
        fail("bake", "did not finish, or told nothing");
    }
    char path[4096];
    path_in(path, sizeof path, folder, "still.bin");
    write_pixels(baker, path);
    path_in(path, sizeof path, folder, "still.exr");
    LIGHTOVEN(lightoven_baker_write_exr(baker, path));
    SIZED(LightovenStatistics, statistics);
    LIGHTOVEN(lightoven_baker_statistics(baker, &statistics));
    check_sampling(&statistics);
    path_in(path, sizeof path, folder, "left_out.txt");
    write_left_out(baker, statistics.left_out_count, path);
    printf("a stretch: %.0f samples a texel, %llu rays, estimated error %.2f %%, %.1f KiB\n",
           statistics.samples_per_texel, (unsigned long long)statistics.rays, 100 * statistics.estimated_error,
           (double)estimate.most_bytes / 1024);
    LIGHTOVEN(lightoven_baker_destroy(baker));
}

static void frames(Engine *engine, LightovenScene scene, const char *folder) {
    SIZED(LightovenFrameSettings, within);
    LIGHTOVEN(lightoven_frame_settings_default(&within));
    within.clock = LIGHTOVEN_CLOCK_ENGINE;
    within.quanta = 1;
    SIZED(LightovenBakeSettings, settings);
    LIGHTOVEN(lightoven_bake_settings_default(&settings));
    settings.resolution = 64;
    settings.frames = &within;
    LightovenBaker baker = {0};
    LIGHTOVEN(lightoven_baker_create(engine->gpu, scene, &settings, &baker));
    LIGHTOVEN(lightoven_baker_set_learning(baker, 0));
    SIZED(LightovenAtlas, atlas);
    SIZED(LightovenAtlasRect, rect);
    LIGHTOVEN(lightoven_baker_atlas(baker, &atlas));
    LIGHTOVEN(lightoven_baker_atlas_rect(baker, 2, &rect));
    if (atlas.width != 64 || atlas.rect_count != 3 || !atlas.shared || rect.scale[0] != 64 || rect.offset[1] != 0) {
        fail("the atlas", "is laid out otherwise");
    }
    uint64_t rays = 0, sweeps = 0;
    for (int frame = 0; frame < 30; frame++) {
        change_scene(baker, frame);
        LightovenFrameReport report = record_frame(engine, baker, 1000000000);
        rays += report.rays;
        sweeps = report.sweeps;
    }
    char path[4096];
    path_in(path, sizeof path, folder, "frames.bin");
    write_pixels(baker, path);
    printf("30 frames: %llu rays, %llu sweeps\n", (unsigned long long)rays, (unsigned long long)sweeps);
    LIGHTOVEN(lightoven_baker_destroy(baker));
}

int main(int count, char **arguments) {
    if (count != 3) {
        fail("arguments", "FOLDER BACKEND");
    }
    Engine engine;
    create_engine(&engine, (uint32_t)atoi(arguments[2]));
    LightovenScene scene = {0};
    LIGHTOVEN(lightoven_scene_create(&scene_desc, &scene));
    bake(&engine, scene, arguments[1]);
    frames(&engine, scene, arguments[1]);
    LIGHTOVEN(lightoven_scene_destroy(scene));
    destroy_engine(&engine);
    return 0;
}
