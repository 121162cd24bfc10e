/* Settings of bakers. */
#ifndef SETTINGS_H
#define SETTINGS_H

#include "table.h"

static void settings_are_checked(LightovenGpu gpu, LightovenScene scene) {
    LightovenBaker baker = {0};
    const LightovenScene no_scene = {0};
    SIZED(LightovenEstimate, estimate);
    SIZED(LightovenFrameSettings, frames);
    SIZED(LightovenBakeSettings, settings);
    REFUSED(lightoven_frame_settings_default(NULL), INVALID_ARGUMENT, "settings is NULL");
    WRONG_SIZES(frames, lightoven_frame_settings_default(&frames));
    REFUSED(lightoven_bake_settings_default(NULL), INVALID_ARGUMENT, "settings is NULL");
    WRONG_SIZES(settings, lightoven_bake_settings_default(&settings));
    LIGHTOVEN(lightoven_frame_settings_default(&frames));
    LIGHTOVEN(lightoven_bake_settings_default(&settings));
    const LightovenFrameSettings good_frames = frames;
    const LightovenBakeSettings good = settings;
    REFUSED(lightoven_estimate_memory(no_scene, NULL, &estimate), INVALID_ARGUMENT, "scene is the null handle");
    REFUSED(lightoven_estimate_memory(scene, NULL, NULL), INVALID_ARGUMENT, "estimate is NULL");
    WRONG_SIZES(settings, lightoven_estimate_memory(scene, &settings, &estimate));
    WRONG_SIZES(estimate, lightoven_estimate_memory(scene, NULL, &estimate));

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
#define WITH(member, value, status, words)                                                                             \
    settings = good, settings.member = value;                                                                          \
    REFUSED(lightoven_baker_create(gpu, scene, &settings, &baker), status, words)
    WITH(resolution, 0, INVALID_SETTINGS, "1 to 16384");
    WITH(resolution, UINT32_MAX, INVALID_SETTINGS, "1 to 16384");
    WITH(texels_per_unit, -1, INVALID_SETTINGS, "texels per unit");
    WITH(bounces, 16385, INVALID_SETTINGS, "limited to 16385; allowed is a limit of 0 to 16384");
    WITH(bounces, 4000000000, INVALID_SETTINGS, "limited to 4000000000");
    WITH(sampling, 4, INVALID_ARGUMENT, "sampling is 4; allowed is 0 to 3");
    WITH(aimed_by, 3, INVALID_ARGUMENT, "3; allowed is 0 to 2");
    WITH(error, 3, INVALID_ARGUMENT, "3; allowed is 0 to 2");
    settings = good, settings.sampling = LIGHTOVEN_SAMPLING_MIXTURE, settings.cosine_share = 2;
    REFUSED(lightoven_baker_create(gpu, scene, &settings, &baker), INVALID_SETTINGS, "mixture is 2");
    settings = good, settings.frames = &frames, settings.bounces = 2;
    REFUSED(lightoven_baker_create(gpu, scene, &settings, &baker), INVALID_SETTINGS, "bounces");
    settings.bounces = LIGHTOVEN_ALL_BOUNCES;
    WRONG_SIZES(frames, lightoven_baker_create(gpu, scene, &settings, &baker));
#define WITHIN(member, value, status, words)                                                                           \
    frames = good_frames, frames.member = value;                                                                       \
    REFUSED(lightoven_baker_create(gpu, scene, &settings, &baker), status, words)
    WITHIN(decay_threshold, 1, INVALID_SETTINGS, "decay");
    WITHIN(frames_in_flight, 9, INVALID_SETTINGS, "1 to 8");
    WITHIN(clock, 2, INVALID_ARGUMENT, "clock is 2");
    WITHIN(measured_by, 2, INVALID_ARGUMENT, "measured by is 2");
    WITHIN(quanta, 65, INVALID_SETTINGS, "1 to 64");
    if (baker.id != 0) {
        fail("lightoven_baker_create", "wrote a handle, and failed");
    }
}

#endif
