/* A bake at a stretch, and what tells of it. */
#ifndef STRETCH_H
#define STRETCH_H

#include "table.h"

#include <pthread.h>

typedef struct Within {
    LightovenBaker baker;
    LightovenStatus inside, elsewhere, left_out;
    int text_is_its_own;
} Within;

static void *elsewhere(void *pointer) {
    Within *within = pointer;
    SIZED(LightovenStatistics, statistics);
    within->text_is_its_own = strcmp(lightoven_last_error(), "") == 0;
    within->elsewhere = lightoven_baker_statistics(within->baker, &statistics);
    size_t length;
    within->left_out = lightoven_baker_left_out(within->baker, 0, NULL, 0, &length, NULL);
    return NULL;
}

/* Another call on the same baker, by the same thread and by another. */
static int32_t call_again(const LightovenProgress *progress, void *pointer) {
    (void)progress;
    Within *within = pointer;
    within->inside = lightoven_baker_destroy(within->baker);
    pthread_t thread;
    if (pthread_create(&thread, NULL, elsewhere, within) != 0 || pthread_join(thread, NULL) != 0) {
        fail("pthread_create", "failed");
    }
    return 1;
}

static void stops_are_checked(LightovenBaker baker) {
    SIZED(LightovenStop, stop);
    uint32_t end = 7;
    REFUSED(lightoven_baker_bake(baker, NULL, NULL, NULL, NULL), INVALID_ARGUMENT, "stop is NULL");
    REFUSED(lightoven_baker_bake(baker, &stop, NULL, NULL, &end), INVALID_SETTINGS, "never end");
    WRONG_SIZES(stop, lightoven_baker_bake(baker, &stop, NULL, NULL, &end));
    REFUSED(lightoven_baker_bake_until(baker, NULL, NULL, NULL, NULL), INVALID_ARGUMENT, "stop is NULL");
    REFUSED(lightoven_baker_bake_until(baker, &stop, NULL, NULL, &end), INVALID_SETTINGS, "never end");
    WRONG_SIZES(stop, lightoven_baker_bake_until(baker, &stop, NULL, NULL, &end));
    stop.error = -1;
    REFUSED(lightoven_baker_bake(baker, &stop, NULL, NULL, &end), INVALID_SETTINGS, "error to reach is -1");
    stop.error = 0, stop.samples = UINT32_MAX;
    REFUSED(lightoven_baker_bake(baker, &stop, NULL, NULL, &end), INVALID_SETTINGS, "samples is 4294967295");
    stop.samples = 64;
    uint32_t *const beside = (uint32_t *)(void *)((char *)&end + 1);
    REFUSED(lightoven_baker_bake(baker, &stop, NULL, NULL, beside), INVALID_ARGUMENT, "no multiple of 4");
    REFUSED(lightoven_baker_bake_until(baker, &stop, NULL, NULL, beside), INVALID_ARGUMENT, "no multiple of 4");
    if (end != 7) {
        fail("lightoven_baker_bake", "wrote an end, and failed");
    }
}

static void one_call_at_a_time(LightovenBaker baker) {
    SIZED(LightovenStop, stop);
    stop.samples = 64;
    uint32_t end = 7;
    Within within = {baker, LIGHTOVEN_STATUS_OK, LIGHTOVEN_STATUS_OK, LIGHTOVEN_STATUS_OK, 0};
    WORKS(lightoven_baker_bake(baker, &stop, call_again, &within, &end));
    const LightovenStatus in_use = LIGHTOVEN_STATUS_IN_USE;
    if (end != LIGHTOVEN_END_INTERRUPTED || within.inside != in_use || within.elsewhere != in_use ||
        within.left_out != in_use || !within.text_is_its_own ||
        !strstr(lightoven_last_error(), "in use by another call")) {
        fail("a call within a call", lightoven_last_error());
    }
}

static void layouts_and_statistics(LightovenBaker baker) {
    SIZED(LightovenLightMap, map);
    SIZED(LightovenStatistics, statistics);
    size_t length = 0;
    REFUSED(lightoven_baker_light_map(baker, NULL), INVALID_ARGUMENT, "light map is NULL");
    WRONG_SIZES(map, lightoven_baker_light_map(baker, &map));
    SIZED(LightovenAtlas, atlas);
    SIZED(LightovenAtlasRect, rect);
    REFUSED(lightoven_baker_atlas(baker, NULL), INVALID_ARGUMENT, "atlas is NULL");
    WRONG_SIZES(atlas, lightoven_baker_atlas(baker, &atlas));
    REFUSED(lightoven_baker_atlas_rect(baker, 0, NULL), INVALID_ARGUMENT, "rectangle is NULL");
    REFUSED(lightoven_baker_atlas_rect(baker, 3, &rect), INVALID_ARGUMENT, "no instance 3: the scene has 3");
    WRONG_SIZES(rect, lightoven_baker_atlas_rect(baker, 0, &rect));
    REFUSED(lightoven_baker_statistics(baker, NULL), INVALID_ARGUMENT, "statistics is NULL");
    WRONG_SIZES(statistics, lightoven_baker_statistics(baker, &statistics));
    /* As it was before it told of sampling: the rest stays as it is. */
    statistics.struct_size = 64, statistics.most_samples = -5;
    WORKS(lightoven_baker_statistics(baker, &statistics));
    if (statistics.texels == 0 || statistics.most_samples != -5) {
        fail("lightoven_baker_statistics", "wrote more than there was room for, or nothing");
    }
    REFUSED(lightoven_baker_left_out(baker, 1000, NULL, 0, &length, NULL), INVALID_ARGUMENT, "no part left out 1000");
    REFUSED(lightoven_baker_left_out(baker, 0, NULL, 0, NULL, NULL), INVALID_ARGUMENT, "both");
    REFUSED(lightoven_baker_left_out(baker, 0, NULL, 0, &length, (void *)1), INVALID_ARGUMENT, "no multiple of 8");
    uint64_t bytes = UINT64_MAX;
    WORKS(lightoven_baker_left_out(baker, 0, NULL, 0, NULL, &bytes));
    if (bytes == UINT64_MAX) {
        fail("lightoven_baker_left_out", "wrote no bytes");
    }
    REFUSED(lightoven_baker_warning(baker, 1000, NULL, 0, NULL), INVALID_ARGUMENT, "there is no warning 1000");
}

static void outputs(LightovenBaker baker) {
    float pixels[16 * 16 * 4];
    REFUSED(lightoven_baker_read_back(baker, NULL, 256), INVALID_ARGUMENT, "pixels is NULL");
    REFUSED(lightoven_baker_read_back(baker, pixels, 0), INVALID_ARGUMENT, "0; allowed is 16 x 16 = 256");
    REFUSED(lightoven_baker_read_back(baker, pixels, SIZE_MAX), INVALID_ARGUMENT, "18446744073709551615; allowed");
    REFUSED(lightoven_baker_write_exr(baker, NULL), INVALID_ARGUMENT, "path is NULL");
    REFUSED(lightoven_baker_write_exr(baker, "no/folder/a.exr"), IO, "no/folder");
    REFUSED(lightoven_baker_write_exr(baker, "\xc3\x28"), INVALID_ARGUMENT, "not UTF-8");
    REFUSED(lightoven_baker_write_png(baker, NULL), INVALID_ARGUMENT, "path is NULL");
    REFUSED(lightoven_baker_write_png(baker, ""), IO, "'': the path is empty");
    REFUSED(lightoven_baker_write_exr(baker, "/dev/null"), IO, "it exists and is not a file");
    REFUSED(lightoven_baker_write_png(baker, "new.png/"), IO, "'new.png/': it ends without a file's name");
    /* What only frames have. */
    const double at[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    REFUSED(lightoven_baker_set_transform(baker, 2, at), INVALID_SETTINGS, "within frames does");
    REFUSED(lightoven_baker_set_time(baker, 1), INVALID_SETTINGS, "within frames does");
    REFUSED(lightoven_baker_set_learning(baker, 1), INVALID_SETTINGS, "within frames does");
    REFUSED(lightoven_baker_complete(baker, 1, NULL), INVALID_SETTINGS, "within frames does");
}

static void nothing_is_left(LightovenBaker baker) {
    SIZED(LightovenStop, stop);
    stop.samples = 64;
    SIZED(LightovenLightMap, map);
    SIZED(LightovenStatistics, statistics);
    SIZED(LightovenAtlas, atlas);
    SIZED(LightovenAtlasRect, rect);
    size_t length = 0;
    float pixels[16 * 16 * 4];
    const LightovenBaker null = {0};
    WORKS(lightoven_baker_destroy(null));
    REFUSED(lightoven_baker_destroy(baker), INVALID_ARGUMENT, "there is no baker");
    REFUSED(lightoven_baker_bake(baker, &stop, NULL, NULL, NULL), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_bake_until(baker, &stop, NULL, NULL, NULL), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_light_map(baker, &map), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_statistics(baker, &statistics), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_atlas(baker, &atlas), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_atlas_rect(baker, 0, &rect), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_warning(baker, 0, NULL, 0, NULL), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_left_out(baker, 0, NULL, 0, &length, NULL), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_read_back(baker, pixels, 256), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_write_exr(baker, "a.exr"), INVALID_ARGUMENT, "was destroyed");
    REFUSED(lightoven_baker_write_png(baker, "a.png"), INVALID_ARGUMENT, "was destroyed");
}

static void at_a_stretch(LightovenGpu gpu, LightovenScene scene) {
    LightovenBaker baker = {0};
    SIZED(LightovenBakeSettings, settings);
    LIGHTOVEN(lightoven_bake_settings_default(&settings));
    settings.resolution = 16;
    WORKS(lightoven_baker_create(gpu, scene, &settings, &baker));
    REFUSED(lightoven_gpu_destroy(gpu), IN_USE, "its bakers");
    stops_are_checked(baker);
    one_call_at_a_time(baker);
    layouts_and_statistics(baker);
    outputs(baker);
    WORKS(lightoven_baker_destroy(baker));
    nothing_is_left(baker);
}

#endif
