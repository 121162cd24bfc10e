/* A bake within frames, and changes. */
#ifndef FRAMES_H
#define FRAMES_H

#include "table.h"

static void frames_are_recorded(const Engine *engine, LightovenBaker baker) {
    SIZED(LightovenFrameReport, report);
    REFUSED(lightoven_baker_record(baker, NULL, 1, &report), INVALID_ARGUMENT, "command buffer is VK_NULL_HANDLE");
    WRONG_SIZES(report, lightoven_baker_record(baker, engine->commands, 1, &report));
    SIZED(LightovenTimelinePoint, point);
    REFUSED(lightoven_baker_submit(baker, 1, NULL, 1, NULL, 0, NULL), INVALID_ARGUMENT, "point to wait for is NULL");
    REFUSED(lightoven_baker_submit(baker, 1, NULL, 0, &point, 1, NULL), INVALID_ARGUMENT, "signal 0 is VK_NULL_HANDLE");
    size_t count = 1;
    WRONG_COUNTS(count, lightoven_baker_submit(baker, 1, &point, count, NULL, 0, NULL), "point to wait for is");
    WRONG_COUNTS(count, lightoven_baker_submit(baker, 1, NULL, 0, &point, count, NULL), "point to signal is");
    WRONG_SIZES(point, lightoven_baker_submit(baker, 1, &point, 1, NULL, 0, NULL));
    WRONG_SIZES(report, lightoven_baker_submit(baker, 1, NULL, 0, NULL, 0, &report));
    REFUSED(lightoven_baker_complete(baker, 99, NULL), INVALID_SETTINGS, "99");
    SIZED(LightovenStop, stop);
    stop.samples = 1;
    REFUSED(lightoven_baker_bake(baker, &stop, NULL, NULL, NULL), INVALID_SETTINGS, "not baked at a stretch");
    REFUSED(lightoven_baker_bake_until(baker, &stop, NULL, NULL, NULL), INVALID_SETTINGS, "not baked at a stretch");
}

static const LightovenSky white = {sizeof white, NULL, 0, 0, {1, 1, 1}, LIGHTOVEN_SKY_KIND_CONSTANT};
static const double at_origin[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

static void things_change(LightovenBaker baker) {
    const double flat[12] = {0};
    const float dark[3] = {-1, 0, 0};
    LightovenLight light = lights[0];
    LightovenSky sky = white;
    REFUSED(lightoven_baker_set_transform(baker, 2, NULL), INVALID_ARGUMENT, "transform is NULL");
    REFUSED(lightoven_baker_set_transform(baker, 2, flat), INVALID_SETTINGS, "invertible");
    REFUSED(lightoven_baker_set_transform(baker, 0, at_origin), INVALID_SETTINGS, "declared static");
    REFUSED(lightoven_baker_set_transform(baker, UINT32_MAX, at_origin), INVALID_SETTINGS, "4294967295");
    REFUSED(lightoven_baker_set_present(baker, 2, 2), INVALID_ARGUMENT, "is 2; allowed is 0 to 1");
    REFUSED(lightoven_baker_set_present(baker, 9, 0), INVALID_SETTINGS, "9");
    REFUSED(lightoven_baker_set_light(baker, 0, NULL), INVALID_ARGUMENT, "light is NULL");
    WRONG_SIZES(light, lightoven_baker_set_light(baker, 0, &light));
    REFUSED(lightoven_baker_set_light(baker, 3, &light), INVALID_SETTINGS, "light");
    light.intensity[1] = -1;
    REFUSED(lightoven_baker_set_light(baker, 0, &light), INVALID_SCENE, "intensity of light 'bulb'");
    REFUSED(lightoven_baker_set_emission(baker, 0, NULL), INVALID_ARGUMENT, "radiance is NULL");
    REFUSED(lightoven_baker_set_emission(baker, 0, dark), INVALID_SCENE, "emission");
    REFUSED(lightoven_baker_set_emission(baker, 3, (const float[3]){0}), INVALID_SETTINGS, "3");
    REFUSED(lightoven_baker_set_sky(baker, NULL), INVALID_ARGUMENT, "sky is NULL");
    WRONG_SIZES(sky, lightoven_baker_set_sky(baker, &sky));
    sky.radiance[2] = -1;
    REFUSED(lightoven_baker_set_sky(baker, &sky), INVALID_SCENE, "sky");
}

static void the_rest_changes(LightovenBaker baker) {
    const LightovenScene no_scene = {0};
    REFUSED(lightoven_baker_set_scene(baker, no_scene), INVALID_ARGUMENT, "scene is the null handle");
    LightovenScene gone = {0};
    LIGHTOVEN(lightoven_scene_create(&scene_desc, &gone));
    LIGHTOVEN(lightoven_scene_destroy(gone));
    REFUSED(lightoven_baker_set_scene(baker, gone), INVALID_ARGUMENT, "was destroyed");
    double samples = 0;
    REFUSED(lightoven_baker_samples_per_texel(baker, 1, NULL), INVALID_ARGUMENT, "samples' place is NULL");
    WORKS(lightoven_baker_samples_per_texel(baker, 1000000, &samples));
    REFUSED(lightoven_baker_set_learning(baker, 2), INVALID_ARGUMENT, "learning is 2");
}

/* Nothing was done by all that was refused. */
static void a_frame_is_the_first(Engine *engine, LightovenBaker baker) {
    SIZED(LightovenFrameTiming, timing);
    LightovenFrameReport report = record_frame(engine, baker, 0);
    WRONG_SIZES(timing, lightoven_baker_complete(baker, report.frame, &timing));
    WORKS(lightoven_baker_complete(baker, report.frame, &timing));
    if (report.frame != 1 || report.rays != 0) {
        fail("frames", "were begun by calls that were refused");
    }
}

static void no_frames_are_left(const Engine *engine, LightovenScene scene, LightovenBaker baker) {
    double samples = 0;
    REFUSED(lightoven_baker_record(baker, engine->commands, 1, NULL), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_submit(baker, 1, NULL, 0, NULL, 0, NULL), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_complete(baker, 1, NULL), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_transform(baker, 2, at_origin), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_present(baker, 2, 1), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_light(baker, 0, &lights[0]), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_emission(baker, 0, (const float[3]){0}), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_sky(baker, &white), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_scene(baker, scene), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_samples_per_texel(baker, 1, &samples), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_time(baker, 1), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_set_learning(baker, 1), INVALID_ARGUMENT, "was destroyed");
}

static void within_frames(Engine *engine, LightovenScene scene) {
    LightovenBaker baker = {0};
    SIZED(LightovenFrameSettings, frames);
    SIZED(LightovenBakeSettings, settings);
    LIGHTOVEN(lightoven_frame_settings_default(&frames));
    LIGHTOVEN(lightoven_bake_settings_default(&settings));
    settings.resolution = 16, settings.frames = &frames;
    WORKS(lightoven_baker_create(engine->gpu, scene, &settings, &baker));
    frames_are_recorded(engine, baker);
    things_change(baker);
    the_rest_changes(baker);
    a_frame_is_the_first(engine, baker);
    WORKS(lightoven_baker_destroy(baker));
    no_frames_are_left(engine, scene, baker);
}

#endif
