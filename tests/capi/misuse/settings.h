/* Settings of bakers. */
#ifndef SETTINGS_H
#define SETTINGS_H

#include "table.h"

#include <math.h>

static void settings_and_estimates(LightovenScene scene) {
    const LightovenScene no_scene = {0};
    SIZED(LightovenEstimate, estimate);
    SIZED(LightovenFrameSettings, frames);
    SIZED(LightovenBakeSettings, settings);
    REFUSED(lightoven_frame_settings_default(NULL), INVALID_ARGUMENT, "settings is NULL");
    WRONG_SIZES(frames, lightoven_frame_settings_default(&frames));
    REFUSED(lightoven_bake_settings_default(NULL), INVALID_ARGUMENT, "settings is NULL");
    WRONG_SIZES(settings, lightoven_bake_settings_default(&settings));
    REFUSED(lightoven_estimate_memory(no_scene, NULL, &estimate), INVALID_ARGUMENT, "scene is the null handle");
    REFUSED(lightoven_estimate_memory(scene, NULL, NULL), INVALID_ARGUMENT, "estimate is NULL");
    WRONG_SIZES(settings, lightoven_estimate_memory(scene, &settings, &estimate));
    WRONG_SIZES(estimate, lightoven_estimate_memory(scene, NULL, &estimate));
}

static void bakers_are_described(LightovenGpu gpu, LightovenScene scene) {
    LightovenBaker baker = {0};
    const LightovenScene no_scene = {0};
    SIZED(LightovenBakeSettings, settings);
    LIGHTOVEN(lightoven_bake_settings_default(&settings));
    REFUSED(lightoven_baker_create(gpu, scene, NULL, NULL), INVALID_ARGUMENT, "place is NULL");
    REFUSED(lightoven_baker_create(gpu, no_scene, NULL, &baker), INVALID_ARGUMENT, "scene is the null handle");
    const LightovenGpu no_gpu = {scene.id};
    REFUSED(lightoven_baker_create(no_gpu, scene, NULL, &baker), INVALID_ARGUMENT, "there is no GPU");
    LightovenScene gone = {0};
    LIGHTOVEN(lightoven_scene_create(&scene_desc, &gone));
    LIGHTOVEN(lightoven_scene_destroy(gone));
    REFUSED(lightoven_baker_create(gpu, gone, NULL, &baker), INVALID_ARGUMENT, "was destroyed");
    WRONG_SIZES(settings, lightoven_baker_create(gpu, scene, &settings, &baker));
    settings.reserved = 4;
    REFUSED(lightoven_baker_create(gpu, scene, &settings, &baker), INVALID_ARGUMENT, "'reserved' of the settings is 4");
    if (baker.id != 0) {
        fail("lightoven_baker_create", "wrote a handle, and failed");
    }
}

/* By the baker, and by what tells of its memory beforehand. */
#define BOTH_REFUSE(status, words)                                                                                     \
    REFUSED(lightoven_baker_create(gpu, scene, &settings, &baker), status, words);                                     \
    REFUSED(lightoven_estimate_memory(scene, &settings, &estimate), status, words)
#define WITH(member, value, status, words)                                                                             \
    settings = good, settings.member = value;                                                                          \
    BOTH_REFUSE(status, words)
#define WITHIN(member, value, status, words)                                                                           \
    frames = good_frames, frames.member = value;                                                                       \
    BOTH_REFUSE(status, words)

static void ranges(LightovenGpu gpu, LightovenScene scene) {
    LightovenBaker baker = {0};
    SIZED(LightovenEstimate, estimate);
    SIZED(LightovenFrameSettings, frames);
    SIZED(LightovenBakeSettings, settings);
    LIGHTOVEN(lightoven_frame_settings_default(&frames));
    LIGHTOVEN(lightoven_bake_settings_default(&settings));
    const LightovenFrameSettings good_frames = frames;
    const LightovenBakeSettings good = settings;
    WITH(resolution, 0, INVALID_SETTINGS, "1 to 16384");
    WITH(resolution, UINT32_MAX, INVALID_SETTINGS, "1 to 16384");
    WITH(texels_per_unit, -1, INVALID_SETTINGS, "texels per unit");
    WITH(bounces, 16385, INVALID_SETTINGS, "limited to 16385; allowed is a limit of 0 to 16384");
    WITH(bounces, 4000000000, INVALID_SETTINGS, "limited to 4000000000");
    WITH(sampling, 4, INVALID_ARGUMENT, "sampling is 4; allowed is 0 to 3");
    WITH(aimed_by, 3, INVALID_ARGUMENT, "3; allowed is 0 to 2");
    WITH(error, 3, INVALID_ARGUMENT, "3; allowed is 0 to 2");
    settings = good, settings.sampling = LIGHTOVEN_SAMPLING_MIXTURE, settings.cosine_share = 2;
    BOTH_REFUSE(INVALID_SETTINGS, "mixture is 2");
    settings.cosine_share = NAN;
    BOTH_REFUSE(INVALID_SETTINGS, "mixture is NaN");
    settings = good, settings.frames = &frames, settings.bounces = 2;
    BOTH_REFUSE(INVALID_SETTINGS, "limited to 2; allowed within frames is no limit");
    settings.bounces = LIGHTOVEN_ALL_BOUNCES;
    WRONG_SIZES(frames, lightoven_baker_create(gpu, scene, &settings, &baker));
    WITHIN(decay_threshold, 1, INVALID_SETTINGS, "decay");
    WITHIN(frames_in_flight, 9, INVALID_SETTINGS, "1 to 8");
    WITHIN(clock, 2, INVALID_ARGUMENT, "clock is 2");
    WITHIN(measured_by, 2, INVALID_ARGUMENT, "measured by is 2");
    WITHIN(quanta, 65, INVALID_SETTINGS, "1 to 64");
    if (baker.id != 0) {
        fail("lightoven_baker_create", "wrote a handle, and failed");
    }
    if (estimate.most_bytes != 0) {
        fail("lightoven_estimate_memory", "wrote an estimate, and failed");
    }
}

static void settings_are_checked(LightovenGpu gpu, LightovenScene scene) {
    settings_and_estimates(scene);
    bakers_are_described(gpu, scene);
    ranges(gpu, scene);
}

#endif
